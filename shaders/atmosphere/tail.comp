// The orders beyond the last: a geometric series in the ratio of the last two, which is the same in all of light.
layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0, rgba32f) readonly uniform image2DArray last;
layout(binding = 1, rgba32f) readonly uniform image2DArray before;
layout(binding = 2, rgba32f) LUMO_READ_WRITE uniform image2DArray sum;

const int irradiance_layer = 4;
const float most = 0.98;

void main() {
    ivec3 size = imageSize(sum);
    ivec3 at = ivec3(gl_GlobalInvocationID);
    if (any(greaterThanEqual(at, size))) return;
    ivec3 mean = ivec3(at.xy, at.z == irradiance_layer ? at.z : 0);
    vec4 denominator = imageLoad(before, mean);
    vec4 ratio = clamp(imageLoad(last, mean) / max(denominator, vec4(1e-37)), vec4(0), vec4(most));
    imageStore(sum, at, imageLoad(sum, at) + imageLoad(last, at) * ratio / (1.0 - ratio));
}
