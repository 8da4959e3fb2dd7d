// The decoders and encoders behind scene/image.hpp, a file each. They pass on exceptions (of memory, of their
// libraries): image.cpp makes errors of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "rhi/error.hpp"
#include "scene/image.hpp"

namespace lumo::scene::codec {

/// An image file in memory.
struct Source {
    std::span<const std::byte> bytes;
    std::string name;  ///< printable; what errors call it
    ImageLimits limits;
};

/// An image as its header describes it, before anything is allocated for it.
struct Header {
    uint64_t width = 0;
    uint64_t height = 0;
    uint64_t bytes_per_pixel = 4;  ///< decoded
    uint64_t least_bytes = 0;      ///< what a file of this size has at least
};

/// Holds a header to the limits, and to the size of the file. Errors: invalid_file, limit.
Result<void> check(const Header& header, const Source& source);

/// What is damaged: invalid_file, with the reason.
tl::unexpected<Error> damaged(const Source& source, const std::string& reason);

/// The number in `size` bytes, 1 to 4, from `at` on, all of which are there.
uint32_t big_endian(std::span<const std::byte> bytes, size_t at, size_t size);

/// Samples of 0 to 255 as floats of 0 to 1.
ImageF to_float(const Image8& from);

/// 16-bit samples become 8 bits by rounding, or floats of 0 to 1. 1 to 4 channels.
Result<Image8> decode_png8(const Source& source);
Result<ImageF> decode_png_float(const Source& source);
std::vector<std::byte> encode_png(const Image8& image);

/// 1 or 3 channels; CMYK becomes RGB as the product of each colour and key.
Result<Image8> decode_jpeg(const Source& source);

/// 3 channels.
Result<ImageF> decode_hdr(const Source& source);

Result<std::vector<ExrLayer>> decode_exr(const Source& source);
std::vector<std::byte> encode_exr(std::span<const ExrLayer> layers);

/// Any other format, by the module of scene/image_module.hpp. Errors: unsupported (also where there is no module).
Result<Image8> decode_other8(const Source& source);
Result<ImageF> decode_other_float(const Source& source);

}  // namespace lumo::scene::codec
