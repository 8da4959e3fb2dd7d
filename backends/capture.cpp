#include "backends/capture.hpp"

#include <array>
#include <dlfcn.h>
#include <renderdoc_app.h>
#include <utility>

namespace lumo::backends {
namespace {

using Functions = RENDERDOC_API_1_4_0;

Functions& functions(void* renderdoc) { return *static_cast<Functions*>(renderdoc); }

tl::unexpected<Error> not_captured(std::string message) {
    return fail(ErrorKind::unsupported, "RenderDoc", std::move(message),
                "run the program under it: renderdoccmd capture -w PROGRAM ...");
}

/// Null unless something loaded it before.
void* find_renderdoc() {
    void* library = dlopen("librenderdoc.so", RTLD_NOW | RTLD_NOLOAD);
    if (!library) return nullptr;
    void* found = nullptr;
    const auto get_api = reinterpret_cast<pRENDERDOC_GetAPI>(dlsym(library, "RENDERDOC_GetAPI"));
    if (get_api) get_api(eRENDERDOC_API_Version_1_4_0, &found);
    dlclose(library);  // whoever loaded it keeps it
    return found;
}

}  // namespace

Result<Capture> Capture::start() {
    void* renderdoc = find_renderdoc();
    if (!renderdoc) return not_captured("it is not loaded into this process");
    functions(renderdoc).StartFrameCapture(nullptr, nullptr);
    if (!functions(renderdoc).IsFrameCapturing()) return not_captured("it sees no device");
    return Capture(renderdoc);
}

Result<void> Capture::finish(const std::filesystem::path& file) {
    Functions& api = functions(std::exchange(renderdoc_, nullptr));
    if (!api.EndFrameCapture(nullptr, nullptr)) return not_captured("it could not capture the frame");
    std::array<char, 4096> name{};
    uint32_t size = name.size();
    const uint32_t captures = api.GetNumCaptures();
    if (captures == 0 || !api.GetCapture(captures - 1, name.data(), &size, nullptr))
        return not_captured("it wrote no capture");
    std::error_code error;
    std::filesystem::copy_file(name.data(), file, std::filesystem::copy_options::overwrite_existing, error);
    if (error)
        return fail(ErrorKind::io, file.string(), "cannot be written: " + error.message(),
                    "check that its folder exists and may be written to");
    std::filesystem::remove(name.data(), error);
    return {};
}

Capture::Capture(Capture&& other) noexcept : renderdoc_(std::exchange(other.renderdoc_, nullptr)) {}

Capture::~Capture() {
    if (renderdoc_) functions(renderdoc_).DiscardFrameCapture(nullptr, nullptr);
}

}  // namespace lumo::backends
