// The parameters of an atmosphere, and rays through it. Include once per program; takes the binding atmosphere_binding.
//
// Points are given by altitude and never by radius, so that nothing cancels near the ground in single precision: with R
// the ground's radius and r = R + h, a ray from h with the cosine mu to the vertical has at distance d the altitude
// h + (d² + 2 r mu d) / (r + r(d)). Lengths are in km. A vec4 has a component for each of up to four wavelengths.
#include "common/constants.glsl"

const int max_nodes = 16;

layout(binding = atmosphere_binding, std140) uniform Atmosphere {
    vec4 rayleigh_scattering;  // per km, at the ground
    vec4 mie_scattering;
    vec4 mie_extinction;
    vec4 ozone_extinction;     // per km, at the peak
    vec4 sun_irradiance;       // W/m²/nm, above the air
    vec4 ground_albedo;
    vec4 ozone;                // altitudes of bottom, peak and top
    vec4 sun_places;           // middle, spread, first and last place: see sun_place()
    vec4 column_shape;         // of each species: see columns_upward(); w: spread of the cosines
    vec2 scale_heights;        // of molecules and aerosols
    float radius_ground;
    float height;              // of the air
    float sun_radius;          // angular
    float mie_g;
    int orders;                // 1: no light is scattered twice
    int degree;                // of azimuths in the tables
    int directions;            // zenith angles in the tables
    int nodes;                 // of a piece of a ray
    vec4 quadrature[max_nodes / 2];  // of Gauss and Legendre on [0, 1]: node, weight, node, weight
} air;

float radius_at(float altitude) { return air.radius_ground + altitude; }

struct RayPoint {
    float altitude;
    float mu;  // cosine between the ray and the vertical
};

RayPoint ray_after(RayPoint from, float distance) {
    float r = radius_at(from.altitude);
    float change = distance * (distance + 2.0 * r * from.mu);
    float r_there = sqrt(max(r * r + change, 0.0));
    return RayPoint(clamp(from.altitude + change / (r + r_there), 0.0, air.height),
                    clamp((r * from.mu + distance) / r_there, -1.0, 1.0));
}

// The part of a ray that is in the air.
struct AirPath {
    float entry;   // distance from the ray's start
    RayPoint at;   // there
    float extent;  // up to the ground or to the top; 0 where the ray never meets air
    bool ground;
};

// A ray that touches the ground does not end there.
AirPath air_path(RayPoint from) {
    AirPath path = AirPath(0.0, RayPoint(max(from.altitude, 0.0), from.mu), 0.0, false);
    bool meets = true;
    if (from.altitude > air.height) {
        float b = radius_at(from.altitude) * from.mu;
        float outside = (from.altitude - air.height) * (radius_at(from.altitude) + radius_at(air.height));
        float root = sqrt(max(b * b - outside, 0.0));
        meets = b < 0.0 && root > 0.0;
        path.entry = meets ? outside / (root - b) : 0.0;
        path.at = RayPoint(air.height, -root / radius_at(air.height));
    }
    float b = radius_at(path.at.altitude) * path.at.mu;
    float above = path.at.altitude * (2.0 * air.radius_ground + path.at.altitude);
    if (b < 0.0 && b * b > above) {
        path.extent = above / (sqrt(b * b - above) - b);
        path.ground = true;
    } else {
        float below = (air.height - path.at.altitude) * (radius_at(path.at.altitude) + radius_at(air.height));
        float root = sqrt(b * b + below);
        path.extent = b < 0.0 ? root - b : below > 0.0 ? below / (b + root) : 0.0;
    }
    if (!meets) path.extent = 0.0;
    path.ground = path.ground && meets;
    return path;
}

// The lowest altitude of a ray that falls and does not meet the ground.
float perigee_altitude(RayPoint from) {
    float drop = radius_at(from.altitude) * from.mu * from.mu / (1.0 + sqrt((1.0 - from.mu) * (1.0 + from.mu)));
    return max(from.altitude - drop, 0.0);
}

// Cosine between the vertical and the geometric horizon.
float horizon_mu(float altitude) {
    return -sqrt(altitude * (2.0 * air.radius_ground + altitude)) / radius_at(altitude);
}

// The part of the sun's disc above the geometric horizon (Bruneton 2017, GetTransmittanceToSun).
float sun_visibility(float altitude, float mu_sun) {
    float half_width = max(air.sun_radius * air.radius_ground / radius_at(altitude), 1e-7);
    return smoothstep(-half_width, half_width, mu_sun - horizon_mu(altitude));
}

// Of molecules and aerosols, relative to the ground.
vec2 densities(float altitude) { return exp(-altitude / air.scale_heights); }

float ozone_density(float altitude) {
    return max(min((altitude - air.ozone.x) / (air.ozone.y - air.ozone.x),
                   (air.ozone.z - altitude) / (air.ozone.z - air.ozone.y)),
               0.0);
}

vec2 quadrature_node(int i) {
    vec4 pair = air.quadrature[i >> 1];
    return (i & 1) == 0 ? pair.xy : pair.zw;
}

// Per steradian; nu is the cosine between the directions in which light travels before and after.
float rayleigh_phase(float nu) { return 3.0 / (16.0 * pi) * (1.0 + nu * nu); }

// Cornette and Shanks 1992.
float mie_phase(float nu) {
    float g = air.mie_g;
    float base = 1.0 + g * g - 2.0 * g * nu;
    return 3.0 / (8.0 * pi) * (1.0 - g * g) / (2.0 + g * g) * (1.0 + nu * nu) / (base * sqrt(base));
}

// Where the tables of scattered light have the sun: in the sine of half its zenith angle, densely where it sets.
float sun_place(float mu_sun) {
    float x = sqrt(max(0.5 - 0.5 * mu_sun, 0.0)) - air.sun_places.x;
    float place = x / (air.sun_places.y + abs(x));
    return clamp((place - air.sun_places.z) / (air.sun_places.w - air.sun_places.z), 0.0, 1.0);
}
float mu_sun_at(float place) {
    float y = mix(air.sun_places.z, air.sun_places.w, place);
    float sine = clamp(air.sun_places.x + air.sun_places.y * y / (1.0 - abs(y)), 0.0, 1.0);
    return 1.0 - 2.0 * sine * sine;
}
// And altitudes: densely at the ground.
float altitude_place(float altitude) { return sqrt(clamp(altitude / air.height, 0.0, 1.0)); }
float altitude_at(float place) { return air.height * place * place; }
// And directions, by the angle to the vertical: twice as densely at the level as on average.
float direction_place(float mu) {
    float x = 1.0 - acos(clamp(mu, -1.0, 1.0)) * (2.0 / pi);
    return 0.5 + x / (1.0 + abs(x));
}

// Places 0 and 1 are the centres of the first and the last texel.
vec2 texel_centred(vec2 place, vec2 size) { return (place * (size - 1.0) + 0.5) / size; }
