// The rays of one order projected on spherical harmonics, and their irradiance; both are added to the sums over orders.
const int atmosphere_binding = 0;
#include "atmosphere/air.glsl"
#include "atmosphere/directions.glsl"

layout(local_size_x = 64) in;

layout(push_constant) uniform Push {
    ivec2 size;        // of the tables: suns, altitudes
    ivec2 directions;  // zeniths, azimuths
    int first_row;
    int rows;
    int first_layer;
    int layers;        // that follow
    int order;
} push;

layout(binding = 1, rgba32f) writeonly uniform image2DArray moments;
layout(binding = 2, rgba32f) LUMO_READ_WRITE uniform image2DArray sum;
layout(binding = 5, std430) readonly buffer Rays { vec4 data[]; } rays;

// (l - m)! / (l + m)! and what else makes the harmonics of degree l and order m orthonormal, twice.
float normalisation(int l, int m) {
    float factor = (m == 0 ? 1.0 : 2.0) * float(2 * l + 1) / (4.0 * pi);
    for (int i = l - m + 1; i <= l + m; ++i) factor /= float(i);
    return factor;
}

// P_lm, without the sign of Condon and Shortley.
float legendre(int l, int m, float mu) {
    float sine = sqrt(max(1.0 - mu * mu, 0.0));
    float value = 1.0;
    for (int i = 0; i < m; ++i) value *= float(2 * i + 1) * sine;
    float before = 0.0;
    for (int i = m; i < l; ++i) {
        float next = (float(2 * i + 1) * mu * value - float(i + m) * before) / float(i + 1 - m);
        before = value;
        value = next;
    }
    return value;
}

void main() {
    int i = int(gl_GlobalInvocationID.x);
    int texels = push.size.x * push.rows;
    if (i >= texels * push.layers) return;
    int texel = i % texels;
    int layer = push.first_layer + i / texels;
    bool irradiance = layer == (air.degree + 1) * (air.degree + 2) / 2;
    int m = 0;
    int l = layer;
    while (l > air.degree - m && !irradiance) {
        l -= air.degree - m + 1;
        m += 1;
    }
    l += m;

    ivec2 at = ivec2(texel % push.size.x, push.first_row + texel / push.size.x);
    float altitude = altitude_at(float(at.y) / float(push.size.y - 1));
    int ray = texel * push.directions.x * push.directions.y;
    float step_cosine = 2.0 * cos(float(m) * pi / float(push.directions.y));
    vec4 value = vec4(0);
    for (int j = 0; j < push.directions.x; ++j) {
        Zenith direction = zenith(j, altitude);
        // cos(m phi) from azimuth to azimuth: the sum of its neighbours is step_cosine times the middle one.
        float cosine = cos(float(m) * azimuth(0, push.directions.y));
        float before = cosine;
        vec4 ring = vec4(0);
        for (int k = 0; k < push.directions.y; ++k) {
            ring += cosine * rays.data[ray];
            float next = step_cosine * cosine - before;
            before = cosine;
            cosine = next;
            ray += 1;
        }
        float basis = irradiance ? (direction.level_up ? direction.mu : 0.0) : legendre(l, m, direction.mu);
        value += basis * direction.weight * ring;
    }
    value *= 2.0 * pi / float(push.directions.y);
    if (!irradiance) value *= normalisation(l, m);
    ivec3 place = ivec3(at, layer);
    imageStore(moments, place, value);
    imageStore(sum, place, push.order == 1 ? value : imageLoad(sum, place) + value);
}
