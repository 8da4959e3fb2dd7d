// Mip chains on the CPU, so that a texture has the same texels on every device.
#pragma once

#include <optional>
#include <vector>

#include "scene/image.hpp"

namespace lumo::scene {

enum class Encoding : uint8_t { linear, srgb };  ///< of the colour channels; the fourth is always linear

/// The levels below `image` down to 1x1, each side halved and rounded down. A texel is the mean, in linear
/// light, of exactly the area that it covers, within 0.52/255 in its encoding (at 16 bits between levels).
/// With `alpha_cutoff`, the alpha of a level is scaled so that as large a part of it reaches the cutoff as in
/// `image` (Castaño, Computing Alpha Mipmaps, 2010), as nearly as its texels allow. Four channels.
std::vector<Image8> lower_mips(const Image8& image, Encoding encoding,
                               std::optional<float> alpha_cutoff = {});

}  // namespace lumo::scene
