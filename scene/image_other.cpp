// Formats beyond those that are always there, by a module: see scene/image_module.hpp.
#include <cstdlib>
#include <dlfcn.h>
#include <filesystem>

#include "scene/image_codec.hpp"
#include "scene/image_module.hpp"
#include "scene/printable.hpp"

namespace lumo::scene::codec {
namespace {

std::filesystem::path find_module() {
    if (const char* named = std::getenv("LUMO_IMAGE_MODULE")) return named;
    std::error_code error;
    const auto folder = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
    for (const auto& place : {folder, folder / "../lib/lumo"})
        if (auto file = place / "lumo_image_oiio.so"; std::filesystem::exists(file, error)) return file;
    return {};
}

/// The module, or why there is none. It stays loaded, because its library may hold threads and thread-local memory.
tl::expected<const ImageModule*, std::string> load_module() {
    const std::filesystem::path file = find_module();
    if (file.empty()) return tl::unexpected(std::string("there is no image module beside the program"));
    void* library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!library) return tl::unexpected("the image module cannot be loaded: " + printable(dlerror()));
    const auto entry = reinterpret_cast<decltype(&lumo_image_module)>(dlsym(library, "lumo_image_module"));
    const ImageModule* module = entry ? entry() : nullptr;
    if (!module || module->version != image_module_version || !module->decode)
        return tl::unexpected(printable(file.string()) + " is no image module of this version of lumo");
    return module;
}

template <class T>
struct Receiver {
    const Source& source;
    Image<T> image = {};
    tl::expected<void, Error> outcome = {};

    static void* allocate(void* self, uint32_t width, uint32_t height, uint32_t channels) noexcept {
        auto& receiver = *static_cast<Receiver*>(self);
        try {
            const Header header{.width = width, .height = height, .bytes_per_pixel = sizeof(T) * channels};
            receiver.outcome = check(header, receiver.source);
            if (!receiver.outcome || channels == 0) return nullptr;
            receiver.image = {.width = width, .height = height, .channels = channels};
            receiver.image.values.resize(size_t(width) * height * channels);
            return receiver.image.values.data();
        } catch (const std::exception&) {
            receiver.outcome = fail(ErrorKind::out_of_memory, receiver.source.name,
                                    "does not fit into memory", "make it smaller");
            return nullptr;
        }
    }

    static void report(void* self, const char* reason) noexcept {
        auto& receiver = *static_cast<Receiver*>(self);
        // What was not recognised took no memory.
        receiver.outcome = receiver.image.values.empty()
                               ? fail(ErrorKind::unsupported, receiver.source.name,
                                      "is no image of a known format: " + printable(reason), "convert it")
                               : damaged(receiver.source, printable(reason));
    }
};

template <class T>
Result<Image<T>> decode(const Source& source, ImageSamples samples) {
    const auto module = load_module();
    if (!module)
        return fail(ErrorKind::unsupported, source.name,
                    "is none of PNG, JPEG, HDR and EXR, and " + module.error(),
                    "convert it, or name lumo_image_oiio.so by LUMO_IMAGE_MODULE");
    Receiver<T> receiver{.source = source};
    const ImageRequest request{.bytes = source.bytes.data(),
                               .size = source.bytes.size(),
                               .name = source.name.c_str(),
                               .samples = samples,
                               .receiver = &receiver,
                               .allocate = Receiver<T>::allocate,
                               .report = Receiver<T>::report};
    const bool decoded = (*module)->decode(request);
    if (!receiver.outcome) return tl::unexpected(receiver.outcome.error());
    if (!decoded || receiver.image.values.empty()) return damaged(source, "the image module gives no reason");
    return std::move(receiver.image);
}

}  // namespace

Result<Image8> decode_other8(const Source& source) {
    return decode<uint8_t>(source, ImageSamples::unsigned8);
}

Result<ImageF> decode_other_float(const Source& source) {
    return decode<float>(source, ImageSamples::float32);
}

}  // namespace lumo::scene::codec
