// Columns of the air by their table. Include after atmosphere/air.glsl; takes the binding atmosphere_binding + 1.
// A column has the integrals of the densities of molecules, aerosols and ozone along a path, in km.
#include "atmosphere/column_shape.glsl"

layout(binding = atmosphere_binding + 1) uniform sampler2D air_columns;

// To space along a ray that rises, mu >= 0.
vec3 columns_upward(RayPoint from) {
    vec2 place = vec2(column_place(from.mu), from.altitude / air.height);
    vec3 relative = textureLod(air_columns, texel_centred(place, vec2(textureSize(air_columns, 0))), 0.0).rgb;
    return vec3(densities(from.altitude) * air.scale_heights, 1) * relative * column_flat(from.mu);
}

// The columns from a ray's start to points of it. They are differences of two columns to space, of which
// the one from the lower end is the greater.
struct ColumnsAlong {
    float perigee;  // distance to the lowest point, 0 or less for a ray that rises
    vec3 start;     // from the ray's start away from the ground
    vec3 past;      // all of the ray, where it passes its perigee
};

ColumnsAlong columns_along(AirPath path) {
    ColumnsAlong along;
    along.perigee = -radius_at(path.at.altitude) * path.at.mu;
    along.start = columns_upward(RayPoint(path.at.altitude, abs(path.at.mu)));
    along.past = path.at.mu >= 0.0
                     ? along.start
                     : 2.0 * columns_upward(RayPoint(perigee_altitude(path.at), 0.0)) - along.start;
    return along;
}

vec3 columns_to(ColumnsAlong along, RayPoint point, float distance) {
    vec3 there = columns_upward(RayPoint(point.altitude, abs(point.mu)));
    return max(distance < along.perigee ? there - along.start : along.past - there, vec3(0));
}

// To the sun. Below the horizon it is that of the horizon: the air that the visible part of the disc shines through.
vec3 columns_to_sun(float altitude, float mu_sun) {
    float mu = max(mu_sun, horizon_mu(altitude));
    vec3 upward = columns_upward(RayPoint(altitude, abs(mu)));
    if (mu < 0.0) upward = 2.0 * columns_upward(RayPoint(perigee_altitude(RayPoint(altitude, mu)), 0.0)) - upward;
    return upward;
}

vec4 transmittance_of(vec3 columns) {
    return exp(-(air.rayleigh_scattering * columns.x + air.mie_extinction * columns.y +
                 air.ozone_extinction * columns.z));
}
