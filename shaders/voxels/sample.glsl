// What a ray meets at a place among the voxels and at a scale: premultiplied values; a: opacity per voxel of path.
//
// In a dense volume the base has level 0, and isotropic mips; the directions have the anisotropic mips from 1 on, in the
// layout of voxels/mip_directional.comp. In an octree both are pools of bricks (voxels/octree.glsl): the base those of
// level 0, the directions those of the other levels, isotropic or not.
#include "voxels/octree.glsl"

layout(constant_id = 23) const bool anisotropic = false;   // mips in six directions
layout(constant_id = 25) const bool whole_levels = false;  // every level that is asked for is a whole number

// The octree's. One place in every program that samples voxels, out of the way of its other bindings.
layout(binding = 31) uniform usampler3D voxel_nodes;

// Which of the six directions a ray sees, and how far it goes along each while it goes one voxel; first the one along
// which it goes farthest.
struct Facing {
    ivec3 slots;
    vec3 lengths;
};

Facing facing_of(vec3 direction) {
    Facing facing = Facing(ivec3(0, 2, 4) + ivec3(lessThan(direction, vec3(0))), abs(direction));
    vec3 lengths = facing.lengths;
    if (lengths.y > lengths.x && lengths.y >= lengths.z) {
        facing = Facing(facing.slots.yzx, lengths.yzx);
    } else if (lengths.z > lengths.x) {
        facing = Facing(facing.slots.zxy, lengths.zxy);
    }
    return facing;
}

// What the three directions that a ray sees hold at one place.
struct Seen {
    vec4 along[3];
};

// Optical depths add along a path, opacities do not: a wall that is opaque along one axis stays so for a slanted ray.
struct Depth {
    float sum;
    vec3 color;  // times depth
};

void add_depth(inout Depth depth, vec4 stored, float length) {
    // The cap keeps the depth of an opaque voxel finite.
    const float most_opaque = 0.996;
    float part = -length * log(1.0 - min(stored.a, most_opaque));
    depth.sum += part;
    depth.color += part * stored.rgb / max(stored.a, 1e-4);
}

vec4 value_of(Depth depth) {
    float opacity = 1.0 - exp(-depth.sum);
    return depth.sum > 0.0 ? vec4(depth.color / depth.sum, 1) * opacity : vec4(0);
}

vec4 combine(Seen seen, Facing facing) {
    Depth depth = Depth(0.0, vec3(0));
    for (int axis = 0; axis < 3; ++axis) add_depth(depth, seen.along[axis], facing.lengths[axis]);
    return value_of(depth);
}

vec4 sample_directions(sampler3D directions, vec3 uvw, Facing facing, float lod, float resolution) {
    // Half a texel of the coarser level that is filtered keeps neighbours in the atlas apart.
    float margin = exp2(ceil(lod)) / resolution;
    float x = margin < 0.5 ? clamp(uvw.x, margin, 1.0 - margin) : 0.5;
    Depth depth = Depth(0.0, vec3(0));
    int axis = 0;
    bool empty;
    // What is empty one way is so every way: along most of a path one look is enough. A loop, since both sides of a branch
    // are run on software drivers.
    do {
        vec4 stored = textureLod(directions, vec3((float(facing.slots.x) + x) / 6.0, uvw.yz), lod);
        add_depth(depth, stored, facing.lengths.x);
        empty = stored.a == 0.0;
        facing = Facing(facing.slots.yzx, facing.lengths.yzx);
        ++axis;
    } while (!empty && axis < 3);
    return value_of(depth);
}

// A place in a brick's pool, in texels; `there` is false where there is nothing but empty voxels.
struct InBrick {
    vec3 texel;
    bool there;
};

InBrick find_brick(vec3 uvw, int level) {
    int side = octree_side(level);
    vec3 place = clamp(uvw * float(side) - 0.5, vec3(0), vec3(side - 1));
    ivec3 node = ivec3(place) / brick_voxels;
    int slot = node_slot(voxel_nodes, node, level);
    return InBrick(vec3(brick_texel(slot, level)) + (place - vec3(node * brick_voxels)) + 0.5, slot >= 0);
}

vec4 sample_brick(sampler3D pool, InBrick place) {
    return place.there ? textureLod(pool, place.texel / vec3(textureSize(pool, 0)), 0.0) : vec4(0);
}

Seen sample_brick_directions(sampler3D pool, InBrick place, Facing facing) {
    Seen seen = Seen(vec4[3](vec4(0), vec4(0), vec4(0)));
    if (place.there) {
        vec3 to_uvw = 1.0 / vec3(textureSize(pool, 0));
        float width = float(brick_side << bricks_a_row_log2(1));
        for (int axis = 0; axis < 3; ++axis) {
            vec3 texel = place.texel + vec3(float(facing.slots[axis]) * width, 0, 0);
            seen.along[axis] = textureLod(pool, texel * to_uvw, 0.0);
        }
    }
    return seen;
}

vec4 sample_octree_isotropic(sampler3D base, sampler3D coarse, vec3 uvw, float lod) {
    int level = int(lod);
    float part = whole_levels ? 0.0 : lod - float(level);
    // Where a level has nothing, no finer one has.
    vec4 value = vec4(0);
    InBrick above = find_brick(uvw, part > 0.0 ? min(level + 1, octree_levels) : level);
    if (above.there) {
        InBrick here = above;
        if (part > 0.0) here = find_brick(uvw, level);
        if (level == 0) {
            value = sample_brick(base, here);
        } else {
            value = sample_brick(coarse, here);
        }
        if (part > 0.0) value = mix(value, sample_brick(coarse, above), part);
    }
    return value;
}

vec4 sample_octree_anisotropic(sampler3D base, sampler3D coarse, vec3 uvw, Facing facing, float lod) {
    int level = int(lod);
    float part = whole_levels ? 0.0 : lod - float(level);
    vec4 value = vec4(0);
    InBrick above = find_brick(uvw, part > 0.0 ? min(level + 1, octree_levels) : level);
    if (above.there) {
        InBrick here = above;
        Seen coarser = Seen(vec4[3](vec4(0), vec4(0), vec4(0)));
        if (part > 0.0) {
            here = find_brick(uvw, level);
            coarser = sample_brick_directions(coarse, above, facing);
        }
        if (level == 0) {
            value = sample_brick(base, here);
            if (part > 0.0) value = mix(value, combine(coarser, facing), part);
        } else {
            Seen seen = sample_brick_directions(coarse, here, facing);
            for (int axis = 0; axis < 3; ++axis) {
                seen.along[axis] = mix(seen.along[axis], coarser.along[axis], part);
            }
            value = combine(seen, facing);
        }
    }
    return value;
}

// Level 0 alone.
vec4 sample_finest(sampler3D base, vec3 uvw) {
    return octree_levels > 0 ? sample_brick(base, find_brick(uvw, 0)) : textureLod(base, uvw, 0.0);
}

// A level from 1 on, or what lies between two.
vec4 sample_coarser(sampler3D base, sampler3D directions, vec3 uvw, Facing facing, float lod, float resolution) {
    if (octree_levels > 0 && whole_levels) {
        InBrick place = find_brick(uvw, min(int(lod), octree_levels));
        return anisotropic ? combine(sample_brick_directions(directions, place, facing), facing)
                           : sample_brick(directions, place);
    }
    if (octree_levels > 0) {
        float within = min(lod, float(octree_levels));
        return anisotropic ? sample_octree_anisotropic(base, directions, uvw, facing, within)
                           : sample_octree_isotropic(base, directions, uvw, within);
    }
    return anisotropic ? sample_directions(directions, uvw, facing, lod - 1.0, resolution)
                       : textureLod(base, uvw, lod);
}

// Opacity at a level from 1 on, anisotropic in some direction; 0 only where the level has nothing.
float coarser_opacity(sampler3D base, sampler3D directions, vec3 uvw, int level, float resolution) {
    if (octree_levels > 0) return sample_brick(directions, find_brick(uvw, min(level, octree_levels))).a;
    if (!anisotropic) return textureLod(base, uvw, float(level)).a;
    // As sample_directions, of the first one.
    float margin = min(exp2(float(level)) / resolution, 0.5);
    return textureLod(directions, vec3(clamp(uvw.x, margin, 1.0 - margin) / 6.0, uvw.yz), float(level - 1)).a;
}

vec4 sample_volume(sampler3D base, sampler3D directions, vec3 uvw, Facing facing, float lod, float resolution) {
    if (octree_levels > 0) {
        float within = clamp(lod, 0.0, float(octree_levels));
        return anisotropic ? sample_octree_anisotropic(base, directions, uvw, facing, within)
                           : sample_octree_isotropic(base, directions, uvw, within);
    }
    if (!anisotropic) return textureLod(base, uvw, lod);
    vec4 value;
    if (lod <= 0.0) {
        value = sample_finest(base, uvw);
    } else {
        value = sample_directions(directions, uvw, facing, max(lod - 1.0, 0.0), resolution);
        // Where a level has nothing, no finer one has.
        if (lod < 1.0 && value.a > 0.0) value = mix(sample_finest(base, uvw), value, lod);
    }
    return value;
}
