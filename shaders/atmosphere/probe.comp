// Answers questions about the sky, one an invocation.
const int atmosphere_binding = 0;
#include "atmosphere/sky.glsl"

layout(local_size_x = 64) in;

layout(push_constant) uniform Push {
    uint first;
    uint count;
} push;

struct Question {
    float altitude;
    float mu;
    float mu_sun;
    float nu;
    float distance;
    uint quantity;
    uint padding_0;
    uint padding_1;
};

layout(binding = 4, std430) readonly buffer Questions { Question data[]; } questions;
layout(binding = 5, std430) writeonly buffer Answers { vec4 data[]; } answers;

void main() {
    uint i = push.first + gl_GlobalInvocationID.x;
    if (gl_GlobalInvocationID.x >= push.count) return;
    Question q = questions.data[i];
    vec4 answer = vec4(0);
    switch (q.quantity) {
        case 0u: answer = transmittance_to_space(q.altitude, q.mu); break;
        case 1u: answer = transmittance_segment(q.altitude, q.mu, q.distance); break;
        case 2u: answer = sky_radiance(q.altitude, q.mu, q.mu_sun, q.nu, all_of_ray); break;
        case 3u: answer = sky_radiance_order1(q.altitude, q.mu, q.mu_sun, q.nu, all_of_ray); break;
        case 4u: answer = sky_radiance(q.altitude, q.mu, q.mu_sun, q.nu, q.distance); break;
        case 5u: answer = sky_irradiance(q.altitude, q.mu_sun); break;
        case 6u: answer = sun_irradiance(q.altitude, q.mu_sun); break;
    }
    answers.data[i] = answer;
}
