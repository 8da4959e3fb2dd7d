// Pictures in files, and what is between two of them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "reference/metrics.hpp"
#include "rhi/error.hpp"
#include "samples/lumo/options.hpp"
#include "scene/image.hpp"
#include "techniques/frame/render.hpp"

namespace lumo::program {

/// What one file holds: linear layers, or one display-referred picture with sRGB values over 255.
struct Picture {
    bool display = false;
    std::vector<scene::ExrLayer> layers = {};
};

/// .hdr or .exr (linear), anything else as display-referred. Errors: those of scene/image.hpp.
Result<Picture> read_picture(const std::filesystem::path& file);

/// `display` goes to .png, layers to .exr. Errors: those of scene/image.hpp.
Result<void> write_picture(const std::filesystem::path& file, const Picture& picture);

/// A frame's layers as a file holds them: one layer without a name, several by their names. `renamed` are the
/// names in their order.
Picture picture_of(const std::vector<frame::LayerImage>& layers, const std::vector<std::string>& names);

struct LayerComparison {
    std::string layer;  ///< empty for plain channels
    reference::Comparison figures = {};
};

/// Layer by layer, by the parity of DESIGN.md section 5. Errors: invalid_argument (kinds, layers or sizes that
/// differ; `subject` names the two).
Result<std::vector<LayerComparison>> compare(const Picture& a, const Picture& b, ParityChoice rule,
                                             const std::string& subject);

/// For .png false colours of the first layer, for .exr |a − b| of every layer; both hold the same.
Result<void> write_difference(const std::filesystem::path& file, const Picture& a, const Picture& b);

/// That a picture can be written to the file, before any work is done for it: .png or .exr, in a folder that
/// exists. Errors: invalid_argument, io.
Result<void> check_output(const std::filesystem::path& file);

}  // namespace lumo::program
