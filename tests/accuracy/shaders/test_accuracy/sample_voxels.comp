// What a ray meets at given places: voxels/sample.glsl of either storage.
#include "voxels/sample.glsl"

layout(local_size_x = 64) in;

struct Place {
    vec3 uvw;
    float lod;
    vec3 direction;  // unit length
    float opacity;   // set: of octree_opacity, at the level below lod
    vec4 value;      // set
};

layout(push_constant) uniform Push {
    uint count;
    float resolution;
} push;

layout(binding = 0) uniform sampler3D base;
layout(binding = 1) uniform sampler3D directions;
layout(binding = 2, std430) LUMO_READ_WRITE buffer Places { Place data[]; } places;

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= push.count) return;
    Place place = places.data[i];
    places.data[i].value =
        sample_volume(base, directions, place.uvw, facing_of(place.direction), place.lod, push.resolution);
    places.data[i].opacity = octree_levels > 0 ? octree_opacity(base, directions, place.uvw, min(int(place.lod), octree_levels)) : 0.0;
}
