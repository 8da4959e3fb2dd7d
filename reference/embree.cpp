#include "reference/embree.hpp"

#include <dlfcn.h>
#include <string>

namespace lumo::reference {

Result<Embree> load_embree() {
    static_assert(RTC_VERSION_MAJOR == 3);
    constexpr const char* library_name = "libembree3.so.3";
    void* library = dlopen(library_name, RTLD_NOW | RTLD_LOCAL);
    bool complete = library != nullptr;
    const auto find = [&]<class Function>(Function& function, const char* name) {
        if (library) function = reinterpret_cast<Function>(dlsym(library, name));
        complete = complete && function;
    };
    Embree embree;
    find(embree.new_device, "rtcNewDevice");
    find(embree.release_device, "rtcReleaseDevice");
    find(embree.get_device_error, "rtcGetDeviceError");
    find(embree.new_scene, "rtcNewScene");
    find(embree.release_scene, "rtcReleaseScene");
    find(embree.set_scene_flags, "rtcSetSceneFlags");
    find(embree.commit_scene, "rtcCommitScene");
    find(embree.new_geometry, "rtcNewGeometry");
    find(embree.release_geometry, "rtcReleaseGeometry");
    find(embree.set_shared_geometry_buffer, "rtcSetSharedGeometryBuffer");
    find(embree.set_geometry_user_data, "rtcSetGeometryUserData");
    find(embree.set_geometry_instanced_scene, "rtcSetGeometryInstancedScene");
    find(embree.set_geometry_transform, "rtcSetGeometryTransform");
    find(embree.commit_geometry, "rtcCommitGeometry");
    find(embree.attach_geometry_by_id, "rtcAttachGeometryByID");
    find(embree.intersect1, "rtcIntersect1");
    find(embree.occluded1, "rtcOccluded1");
    if (complete) return embree;
    return fail(ErrorKind::unsupported, "ray tracing on the CPU",
                std::string("there is no Embree 3 (") + library_name + ")",
                "install the package libembree3-3");
}

}  // namespace lumo::reference
