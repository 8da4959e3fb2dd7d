// Light of the emitters that are lit by one by one, and what of it gets through the voxels. The includer has the block
// Gather and the volumes of cones/gather.glsl, and the block `emitters`.

// Paths to emitters join points that are so many voxels off their surfaces.
const float lift = 1.5;

// A path is taken as blocked, without a step in what gets through, below this part.
const float min_visible = 0.01;

// The part of the light between two points that nothing stops. In grid space.
float trace_visibility(vec3 from, vec3 to) {
    vec3 path = to - from;
    float length = sqrt(inner(path, path));
    vec3 direction = path / max(length, 1e-6);
    float widest = max(abs(direction.x), max(abs(direction.y), abs(direction.z)));
    float transmittance = 1.0;
    float distance = 0.5;
    while (transmittance >= min_visible && distance < length) {
        float opacity;
        do {
            opacity = sample_finest(voxel_radiance, (from + direction * distance) / gather.resolution).a;
            transmittance *= max(1.0 - opacity, 0.0);
            distance += 1.0;
        } while (opacity > 0.0 && transmittance >= min_visible && distance < length);
        // Through empty space by ever coarser levels, and back down to where there is something.
        int level = opacity == 0.0 ? 1 : 0;
        while (level > 0 && distance < length) {
            vec3 uvw = (from + direction * distance) / gather.resolution;
            if (coarser_opacity(voxel_radiance, voxel_radiance_directions, uvw, level, gather.resolution) > 0.0) {
                level -= 1;
            } else {
                // At least half a voxel of the level is empty on each side; the finest filter reaches half a voxel over
                // it. Whole steps: whether a sample was barely empty does not move those that follow.
                distance += max(floor((0.5 * exp2(float(level)) - 0.5) / widest), 1.0);
                level = min(level + 1, 4);
            }
        }
    }
    return max(transmittance - min_visible, 0.0) / (1.0 - min_visible);
}

// An emitter as a sphere's cap, of which the length of the mean normal is the mean of 1 and the cosine to its rim.
struct Cap {
    vec3 center;    // of the sphere
    float radius;
    vec3 axis;
    float flatness;
};

Cap cap_of(EmitterCell emitter) {
    float flatness = min(sqrt(inner(emitter.normal.xyz, emitter.normal.xyz)), 1.0);
    // Its mean position lies between the sphere's centre and its top as the mean normal does.
    float radius = sqrt(emitter.position_spread.w / max(1.0 - flatness * flatness, 1e-3));
    return Cap(emitter.position_spread.xyz - radius * emitter.normal.xyz, radius,
               emitter.normal.xyz / max(flatness, 1e-6), flatness);
}

// The middle of what it shows in a direction, lifted off its voxels.
vec3 seen_point(Cap cap, vec3 direction) {
    float rim_cosine = 2.0 * cap.flatness - 1.0;
    float rim_sine = sqrt(max(1.0 - rim_cosine * rim_cosine, 0.0));
    float cosine = inner(cap.axis, direction);
    vec3 outward = cap.axis;
    if (rim_cosine < 0.0 || cosine < rim_sine) {
        // It goes beyond the horizon of what is seen of the sphere: between that and the near side of its rim.
        float sine = sqrt(max(1.0 - cosine * cosine, 0.0));
        vec3 aside = cap.axis - cosine * direction;
        vec3 horizon = aside * inversesqrt(max(inner(aside, aside), 1e-12));
        float near_cosine = cosine * rim_cosine + sine * rim_sine;
        float near_sine = sine * rim_cosine - cosine * rim_sine;
        // The near side may go beyond it too.
        outward = near_cosine > 0.0 ? unit(near_cosine * direction + (1.0 + near_sine) * horizon) : direction;
    }
    return cap.center + (cap.radius + lift) * outward;
}

// Irradiance on a surface from an emitter, W/m², if nothing stands before it, and where a path to it ends, in grid space.
struct EmitterLight {
    vec3 irradiance;
    vec3 end;
};

// `position` in grid space; `normal`: the hemisphere's axis, unit length.
EmitterLight emitter_light(EmitterCell emitter, vec3 position, vec3 normal) {
    vec3 path = emitter.position_spread.xyz - position;
    float squared = max(inner(path, path), 1e-6);
    vec3 direction = path * inversesqrt(squared);
    float spread = emitter.position_spread.w;
    Cap cap = cap_of(emitter);
    float flatness = cap.flatness;
    // Of a disk, the mean squared distance from its centre is half the square of its radius.
    float radius = sqrt(2.0 * spread);
    // What of it lies above the horizon, times the cosine there, of a sphere.
    float cosine = inner(normal, direction);
    float sine = min(radius * inversesqrt(squared), 1.0);
    if (abs(cosine) < sine) cosine = (cosine + sine) * (cosine + sine) / (4.0 * sine);
    // The part of its area that it shows, foreshortened: the mean of max(0, u), u the cosine between surface and
    // path, taken as uniform about its mean and as wide as of a sphere's cap, seen from its axis or from the side.
    // Where a voxel's surface lies in it is not known: what is not clearly in front of a plane is in it.
    float front = -inner(emitter.normal.xyz, path);
    float mean = front * inversesqrt(squared);
    float along = min(mean * mean / max(flatness * flatness, 1e-6), 1.0);
    float side = flatness > 0.5 ? 4.0 * flatness * (1.0 - flatness) : 1.0;
    float width = sqrt(mix(side, (1.0 - flatness) * (1.0 - flatness), along));
    float shown = abs(mean) < width ? (mean + width) * (mean + width) / (4.0 * width)
                                    : max(mean, 0.0) * smoothstep(0.5, 1.5, front);
    // What bends outward does not light itself.
    vec3 outside = position - cap.center;
    shown *= smoothstep(0.5, 1.5, sqrt(inner(outside, outside)) - cap.radius);
    float form = shown * max(cosine, 0.0) / max(squared + 2.0 * spread * flatness, spread);
    return EmitterLight(emitter.flux.rgb * form, seen_point(cap, -direction));
}

float sum_of(EmitterLight light) { return light.irradiance.r + light.irradiance.g + light.irradiance.b; }

// Paths to emitters at a place of a pattern; a number of emitters takes so many bits.
const int emitter_paths = 4;
const int emitter_bits = 5;

// Irradiance on a surface from the emitters that are lit by one by one, W/m². As gather_irradiance; in a pattern each place
// asks for some of them alone what stands before them, the more often the brighter they are, so that the mean over the
// pattern is that of all.
vec3 emitter_irradiance(vec3 position, vec3 geometric_normal, vec3 normal, uint turn) {
    bool some = whole_levels && emitters.count > emitter_paths;
    float total = 0.0;
    for (int i = 0; some && i < emitters.count; ++i) total += sum_of(emitter_light(emitters.data[i], position, normal));
    float paths_per_light = float(emitter_paths) / max(total, 1e-30);
    float passed = (float(turn % uint(turns)) + 0.5) / float(turns);
    uint chosen = 0u;  // a number for each path
    for (int i = 0; some && i < emitters.count; ++i) {
        uint first = uint(passed);
        passed += sum_of(emitter_light(emitters.data[i], position, normal)) * paths_per_light;
        uint ones = ((1u << emitter_bits * int(passed)) - (1u << emitter_bits * int(first))) / ((1u << emitter_bits) - 1u);
        chosen |= uint(i) * ones;
    }
    vec3 sum = vec3(0);
    int paths = some ? emitter_paths : emitters.count;
    for (int i = 0; i < paths; ++i) {
        int number = some ? int(chosen >> (emitter_bits * i) & ((1u << emitter_bits) - 1u)) : i;
        EmitterLight light = emitter_light(emitters.data[number], position, normal);
        float part = some ? 1.0 / (max(sum_of(light), 1e-30) * paths_per_light) : 1.0;
        if (light.irradiance != vec3(0))
            sum += part * light.irradiance * trace_visibility(position + lift * geometric_normal, light.end);
    }
    return sum;
}
