// What a shared object with decoders of further image formats exports. PNG, JPEG, HDR and EXR need none.
//
// lumo loads the file that the environment variable LUMO_IMAGE_MODULE names; if it is not set, lumo_image_oiio.so
// beside the running program, or in ../lib/lumo from there. It is loaded when a file of another format is first read.
#pragma once

#include <cstddef>
#include <cstdint>

namespace lumo::scene {

enum class ImageSamples : uint32_t { unsigned8, float32 };

/// One image to decode. Nothing that either side owns passes to the other.
struct ImageRequest {
    const std::byte* bytes = nullptr;
    size_t size = 0;
    const char* name = nullptr;  ///< the file's; its extension is a hint
    ImageSamples samples = ImageSamples::unsigned8;

    void* receiver = nullptr;  ///< first argument of the two functions
    /// Where to put width * height * channels samples, interleaved, the top row first, alpha not multiplied into
    /// colour for unsigned8; null if that is more than the limits, or the memory, allow.
    void* (*allocate)(void* receiver, uint32_t width, uint32_t height, uint32_t channels) noexcept = nullptr;
    /// Says why the image cannot be decoded.
    void (*report)(void* receiver, const char* reason) noexcept = nullptr;
};

struct ImageModule {
    uint32_t version = 0;  ///< image_module_version that it was built with
    /// Whether the image was decoded. If not, and allocate did not refuse, the reason was reported.
    bool (*decode)(const ImageRequest& request) noexcept = nullptr;
};

inline constexpr uint32_t image_module_version = 1;

}  // namespace lumo::scene

extern "C" {
/// The one symbol of a module.
[[gnu::visibility("default")]] const lumo::scene::ImageModule* lumo_image_module();
}
