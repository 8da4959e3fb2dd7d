// The rays of each zenith angle multiplied with the cosines of multiples of the azimuth and integrated over it.
#include "common/constants.glsl"

layout(local_size_x = 64) in;

layout(push_constant) uniform Push {
    int rings;     // of rays
    int azimuths;  // over half a turn
    int degree;
} push;

layout(binding = 0, std430) readonly buffer Rays { vec4 data[]; } rays;
layout(binding = 1, std430) writeonly buffer Rings { vec4 data[]; } rings;  // degrees are adjacent

void main() {
    int i = int(gl_GlobalInvocationID.x);
    if (i >= push.rings * (push.degree + 1)) return;
    int ray = i / (push.degree + 1) * push.azimuths;
    float m = float(i % (push.degree + 1));
    // From azimuth to azimuth: the sum of a cosine's neighbours is twice_step times it.
    float twice_step = 2.0 * cos(m * pi / float(push.azimuths));
    float cosine = cos(0.5 * m * pi / float(push.azimuths));
    float before = cosine;
    vec4 sum = vec4(0);
    for (int k = 0; k < push.azimuths; ++k) {
        sum += cosine * rays.data[ray + k];
        float next = twice_step * cosine - before;
        before = cosine;
        cosine = next;
    }
    rings.data[i] = sum * (2.0 * pi / float(push.azimuths));
}
