// Light of one order that arrives at points of the tables, ray by ray; the ground's included.
const int atmosphere_binding = 0;
#include "atmosphere/air.glsl"
#include "atmosphere/columns.glsl"
#include "atmosphere/scattering.glsl"

layout(local_size_x = 64) in;

layout(push_constant) uniform Push {
    ivec2 size;       // of the tables: suns, altitudes
    ivec2 directions; // zenith angles, azimuths
    int first_row;
    int rows;
    int first;        // 1: light of order 1; 0: of the order before, as the tables have it, scattered or reflected again
    vec4 forward;     // of forward_light(), what the tables of the order before leave out
    vec4 left_out;    // and what those of this order do
} push;

// Azimuths are adjacent, then zeniths, then texels.
layout(binding = 5, std430) writeonly buffer Rays { vec4 data[]; } rays;

// Zenith angles, in three zones: below the horizon, between it and the level, and above.
layout(binding = 6, std430) readonly buffer Zeniths { vec2 data[]; } zeniths;  // node in [0, 1], zone

float zenith_mu(int i, float altitude) {
    vec2 node = zeniths.data[i];
    float horizon = horizon_mu(altitude);
    float from = node.y < 2.0 ? horizon : 0.0;
    float to = node.y < 1.0 ? -1.0 : node.y < 2.0 ? 0.0 : 1.0;
    return mix(from, to, node.x * node.x);
}

float azimuth(int i, int count) { return pi * (float(i) + 0.5) / float(count); }

void main() {
    int i = int(gl_GlobalInvocationID.x);
    int per_texel = push.directions.x * push.directions.y;
    if (i >= per_texel * push.size.x * push.rows) return;
    int texel = i / per_texel;
    int direction = i - texel * per_texel;
    ivec2 at = ivec2(texel % push.size.x, push.first_row + texel / push.size.x);
    float altitude = altitude_at(float(at.y) / float(push.size.y - 1));
    float mu_sun = mu_sun_at(float(at.x) / float(push.size.x - 1));
    float mu = zenith_mu(direction / push.directions.y, altitude);
    float sines = sqrt(max((1.0 - mu * mu) * (1.0 - mu_sun * mu_sun), 0.0));
    float nu = clamp(mu * mu_sun + sines * cos(azimuth(direction % push.directions.y, push.directions.y)), -1.0, 1.0);

    AirPath path = air_path(RayPoint(altitude, mu));
    bool first = push.first == 1;
    vec4 light = light_along(path, path.extent, mu_sun, nu, first, push.forward.xyz, !first);
    if (path.ground) {
        float ground_sun = (radius_at(altitude) * mu_sun + nu * path.extent) / air.radius_ground;
        vec4 irradiance =
            first ? max(ground_sun, 0.0) * sun_visibility(0.0, ground_sun) *
                        transmittance_of(columns_to_sun(0.0, ground_sun))
                  : sky_irradiance_at(0.0, ground_sun, push.forward.xyz);
        vec4 transmittance =
            transmittance_of(columns_to(columns_along(path), ray_after(path.at, path.extent), path.extent));
        light += transmittance * air.ground_albedo / pi * irradiance;
    }
    if (push.left_out != vec4(0)) light -= forward_light(altitude, mu_sun, push.left_out.xyz * peaks(nu, 0).xyz);
    rays.data[i] = light;
}
