// What a ray meets at given places: voxels/sample.glsl of either storage.
#include "voxels/sample.glsl"

layout(local_size_x = 64) in;

struct Place {
    vec3 uvw;
    float lod;
    vec3 direction;  // unit length
    float opacity;   // set: of coarser_opacity, at the level below lod; below 1 of sample_finest
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
    Facing facing = facing_of(place.direction);
    vec4 finest = sample_finest(base, place.uvw);
    vec4 value = sample_volume(base, directions, place.uvw, facing, place.lod, push.resolution);
    if (whole_levels) {
        value = place.lod < 1.0 ? finest
                                : sample_coarser(base, directions, place.uvw, facing, place.lod, push.resolution);
    }
    places.data[i].value = value;
    places.data[i].opacity =
        place.lod < 1.0 ? finest.a : coarser_opacity(base, directions, place.uvw, int(place.lod), push.resolution);
}
