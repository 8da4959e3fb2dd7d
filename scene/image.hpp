// Images in memory, and the one place where image files are read and written.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "rhi/error.hpp"

namespace lumo::scene {

/// A raster of interleaved channels. Row 0 is the top row, as in image files.
template <class T>
struct Image {
    uint32_t width = 0;
    uint32_t height = 0;
    uint32_t channels = 4;
    std::vector<T> values = {};  ///< width * height * channels

    size_t offset(uint32_t x, uint32_t y) const { return (size_t(y) * width + x) * channels; }
    const T* at(uint32_t x, uint32_t y) const { return values.data() + offset(x, y); }
    T* at(uint32_t x, uint32_t y) { return values.data() + offset(x, y); }
};

using Image8 = Image<uint8_t>;  ///< display-referred or data, 0 to 255
using ImageF = Image<float>;    ///< linear, unbounded

/// What bounds the decoding of an image that comes from outside.
struct ImageLimits {
    uint32_t max_side = 16384;               ///< pixels
    uint64_t max_bytes = uint64_t(1) << 30;  ///< of decoded pixels
};

/// Reads PNG or JPEG as four channels of 8 bits (missing alpha is 255, 16-bit samples are rounded, palette
/// and grey are expanded). No colour conversion. Errors: io, invalid_file, limit.
Result<Image8> read_image8(const std::filesystem::path& file, const ImageLimits& limits = {});
Result<Image8> decode_image8(std::span<const std::byte> bytes, const std::string& name,
                             const ImageLimits& limits = {});

/// Reads HDR (RGBE) or EXR as float with the file's own channels in RGB(A) order. Also reads PNG and JPEG, as
/// value / 255 without colour conversion. Errors: io, invalid_file, limit.
Result<ImageF> read_image_float(const std::filesystem::path& file, const ImageLimits& limits = {});

/// Writes an 8-bit PNG of 1, 3 or 4 channels.
Result<void> write_png(const std::filesystem::path& file, const Image8& image);

/// One named group of channels in an EXR file; an empty name makes plain R, G, B, A channels.
struct ExrLayer {
    std::string name = {};
    ImageF image = {};
};

/// Writes float32 EXR. All layers have the same size. Channels are NAME.R, NAME.G, …; one channel is NAME.Y.
Result<void> write_exr(const std::filesystem::path& file, std::span<const ExrLayer> layers);

/// Reads every layer of an EXR file, in the naming of write_exr.
Result<std::vector<ExrLayer>> read_exr(const std::filesystem::path& file, const ImageLimits& limits = {});

}  // namespace lumo::scene
