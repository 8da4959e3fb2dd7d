// lumo_image_oiio.so: TIFF, WebP, BMP, TGA and whatever else the machine's OpenImageIO reads from memory.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include "scene/image_module.hpp"

namespace {

using lumo::scene::ImageModule;
using lumo::scene::ImageRequest;
using lumo::scene::ImageSamples;

bool decode(const ImageRequest& request) {
    OIIO::Filesystem::IOMemReader memory(const_cast<std::byte*>(request.bytes), request.size);
    const bool bytes = request.samples == ImageSamples::unsigned8;
    OIIO::ImageSpec config;
    if (bytes) config.attribute("oiio:UnassociatedAlpha", 1);
    const auto input = OIIO::ImageInput::open(request.name, &config, &memory);
    if (!input) {
        request.report(request.receiver, OIIO::geterror().c_str());
        return false;
    }
    const OIIO::ImageSpec& spec = input->spec();
    if (spec.deep || spec.depth > 1 || spec.width < 1 || spec.height < 1 || spec.nchannels < 1) {
        request.report(request.receiver, "it is no flat image");
        return false;
    }
    void* to = request.allocate(request.receiver, uint32_t(spec.width), uint32_t(spec.height),
                                uint32_t(spec.nchannels));
    if (!to) return false;
    const auto type = bytes ? OIIO::TypeDesc::UINT8 : OIIO::TypeDesc::FLOAT;
    if (input->read_image(0, 0, 0, spec.nchannels, type, to)) return true;
    request.report(request.receiver, input->geterror().c_str());
    return false;
}

bool decode_without_exceptions(const ImageRequest& request) noexcept {
    try {
        return decode(request);
    } catch (const std::exception& exception) {
        request.report(request.receiver, exception.what());
        return false;
    }
}

}  // namespace

const ImageModule* lumo_image_module() {
    static constexpr ImageModule module{lumo::scene::image_module_version, decode_without_exceptions};
    return &module;
}
