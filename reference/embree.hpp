// Embree, found at run time: its library is four times as large as all others together, and what traces no ray on the
// CPU does without it.
#pragma once

#include <embree3/rtcore.h>

#include "rhi/error.hpp"

namespace lumo::reference {

/// The functions of Embree that are called, each without its "rtc".
struct Embree {
    decltype(&rtcNewDevice) new_device = nullptr;
    decltype(&rtcReleaseDevice) release_device = nullptr;
    decltype(&rtcGetDeviceError) get_device_error = nullptr;
    decltype(&rtcNewScene) new_scene = nullptr;
    decltype(&rtcReleaseScene) release_scene = nullptr;
    decltype(&rtcSetSceneFlags) set_scene_flags = nullptr;
    decltype(&rtcCommitScene) commit_scene = nullptr;
    decltype(&rtcNewGeometry) new_geometry = nullptr;
    decltype(&rtcReleaseGeometry) release_geometry = nullptr;
    decltype(&rtcSetSharedGeometryBuffer) set_shared_geometry_buffer = nullptr;
    decltype(&rtcSetGeometryUserData) set_geometry_user_data = nullptr;
    decltype(&rtcSetGeometryInstancedScene) set_geometry_instanced_scene = nullptr;
    decltype(&rtcSetGeometryTransform) set_geometry_transform = nullptr;
    decltype(&rtcCommitGeometry) commit_geometry = nullptr;
    decltype(&rtcAttachGeometryByID) attach_geometry_by_id = nullptr;
    decltype(&rtcIntersect1) intersect1 = nullptr;
    decltype(&rtcOccluded1) occluded1 = nullptr;
};

/// Loads the library, which stays loaded. Errors: unsupported, if there is none.
Result<Embree> load_embree();

}  // namespace lumo::reference
