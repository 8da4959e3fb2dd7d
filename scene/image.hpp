// Images in memory, and the one place where image files are read and written: PNG, JPEG, HDR and EXR, and what a
// module that is found at run time adds (image_module.hpp).
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

/// Reads PNG, JPEG or a module's format as four channels of 8 bits (missing alpha is 255, 16-bit samples are rounded,
/// palette and grey are expanded). No colour conversion. Errors: io, invalid_file, unsupported, limit.
Result<Image8> read_image8(const std::filesystem::path& file, const ImageLimits& limits = {});

/// The same for PNG and JPEG only, whatever module there is: for files from outside that may hold nothing else.
Result<Image8> decode_image8(std::span<const std::byte> bytes, const std::string& name,
                             const ImageLimits& limits = {});

/// Reads HDR (RGBE), EXR or a module's format as float with the file's own channels in RGB(A) order; of an EXR the
/// layer without a name, or else the first. Also reads PNG and JPEG, as value / 255 without colour conversion. Errors:
/// io, invalid_file, unsupported, limit.
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

/// Reads every layer of an EXR file of one flat part, in the naming of write_exr: the layer without a name first, the
/// others by name. Half floats and integers become floats of the same value. The pixels are those of the data window.
Result<std::vector<ExrLayer>> read_exr(const std::filesystem::path& file, const ImageLimits& limits = {});

}  // namespace lumo::scene
