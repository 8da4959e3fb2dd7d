// Adds what was drawn into a picture of its own.
layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform sampler2D share;
layout(binding = 1, rgba32f) LUMO_READ_WRITE uniform image2D radiance;

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(radiance)))) return;
    vec3 sum = imageLoad(radiance, pixel).rgb + texelFetch(share, pixel, 0).rgb;
    imageStore(radiance, pixel, vec4(max(sum, vec3(0)), 1));
}
