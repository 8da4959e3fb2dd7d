// What a ray meets at a place in a voxel volume and at a scale: premultiplied values; a: opacity per voxel of path.
//
// The base has level 0, and isotropic mips; the directions have the anisotropic mips from 1 on, in the layout of
// voxels/mip_directional.comp.

layout(constant_id = 23) const bool anisotropic = false;  // mips in six directions

// Which of the six directions a ray sees, and how far it goes along each while it goes one voxel.
struct Facing {
    ivec3 slots;
    vec3 lengths;
};

Facing facing_of(vec3 direction) {
    return Facing(ivec3(0, 2, 4) + ivec3(lessThan(direction, vec3(0))), abs(direction));
}

vec4 sample_directions(sampler3D directions, vec3 uvw, Facing facing, float lod, float resolution) {
    // Half a texel of the coarser level that is filtered keeps neighbours in the atlas apart.
    float margin = 0.5 * exp2(ceil(lod)) / (0.5 * resolution);
    float x = margin < 0.5 ? clamp(uvw.x, margin, 1.0 - margin) : 0.5;
    // Optical depths add along a path, opacities do not: a wall that is opaque along one axis stays so for a slanted
    // ray. The cap keeps the depth of an opaque voxel finite.
    const float most_opaque = 0.996;
    float depth = 0.0;
    vec3 color = vec3(0);
    for (int axis = 0; axis < 3; ++axis) {
        vec3 place = vec3((float(facing.slots[axis]) + x) / 6.0, uvw.yz);
        vec4 stored = textureLod(directions, place, lod);
        float part = -facing.lengths[axis] * log(1.0 - min(stored.a, most_opaque));
        depth += part;
        color += part * stored.rgb / max(stored.a, 1e-4);
    }
    float opacity = 1.0 - exp(-depth);
    return depth > 0.0 ? vec4(color / depth, 1) * opacity : vec4(0);
}

vec4 sample_volume(sampler3D base, sampler3D directions, vec3 uvw, Facing facing, float lod, float resolution) {
    if (!anisotropic) return textureLod(base, uvw, lod);
    vec4 coarse = sample_directions(directions, uvw, facing, max(lod - 1.0, 0.0), resolution);
    return lod < 1.0 ? mix(textureLod(base, uvw, 0.0), coarse, lod) : coarse;
}
