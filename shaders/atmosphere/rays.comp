// Light of one order that arrives at points of the tables, ray by ray; the ground's included.
const int atmosphere_binding = 0;
#include "atmosphere/air.glsl"
#include "atmosphere/columns.glsl"
#include "atmosphere/scattering.glsl"
#include "atmosphere/directions.glsl"

layout(local_size_x = 64) in;

layout(push_constant) uniform Push {
    ivec2 size;       // of the tables: suns, altitudes
    ivec2 directions; // zeniths, azimuths
    int first_row;
    int rows;
    int order;
} push;

layout(binding = 5, std430) writeonly buffer Rays { vec4 data[]; } rays;  // azimuths, then zeniths, then texels

void main() {
    int i = int(gl_GlobalInvocationID.x);
    int per_texel = push.directions.x * push.directions.y;
    if (i >= per_texel * push.size.x * push.rows) return;
    int texel = i / per_texel;
    int direction = i - texel * per_texel;
    ivec2 at = ivec2(texel % push.size.x, push.first_row + texel / push.size.x);
    float altitude = altitude_at(float(at.y) / float(push.size.y - 1));
    float mu_sun = mu_sun_at(float(at.x) / float(push.size.x - 1));
    float mu = zenith(direction / push.directions.y, altitude).mu;
    float sines = sqrt(max((1.0 - mu * mu) * (1.0 - mu_sun * mu_sun), 0.0));
    float nu = clamp(mu * mu_sun + sines * cos(azimuth(direction % push.directions.y, push.directions.y)), -1.0, 1.0);

    AirPath path = air_path(RayPoint(altitude, mu));
    vec4 light = light_along(path, path.extent, mu_sun, nu, push.order == 1, push.order > 1);
    if (path.ground) {
        float ground_sun = (radius_at(altitude) * mu_sun + nu * path.extent) / air.radius_ground;
        vec4 irradiance =
            push.order > 1 ? sky_irradiance_at(0.0, ground_sun)
                           : max(ground_sun, 0.0) * sun_visibility(0.0, ground_sun) *
                                 transmittance_of(columns_to_sun(0.0, ground_sun));
        vec4 transmittance =
            transmittance_of(columns_to(columns_along(path), ray_after(path.at, path.extent), path.extent));
        light += transmittance * air.ground_albedo / pi * irradiance;
    }
    rays.data[i] = light;
}
