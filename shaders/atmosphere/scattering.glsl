// Light scattered toward the eye along a ray, by the tables. Include after atmosphere/columns.glsl; takes the bindings
// atmosphere_binding + 2 and + 3. Light is relative to the sun's irradiance.

// Layers, as functions of the sun's zenith angle and of altitude: 0 to 3, what molecules send on, see scattered_again();
// 4, the sky's irradiance on a level plane; from first_aerosol_layer on, what aerosols send on into air.directions
// zenith angles, once for each of air.degree + 1 cosines of multiples of the azimuth. Light of several orders together,
// without what forward_light() adds.
layout(binding = atmosphere_binding + 2) uniform sampler2DArray air_light;
// What these leave out of the aerosols' forward peak: rows of peaks() and of its irradiance.
layout(binding = atmosphere_binding + 3) uniform sampler2D air_peaks;

const int irradiance_layer = 4;
const int first_aerosol_layer = 5;

vec2 light_place(float altitude, float mu_sun) {
    return texel_centred(vec2(sun_place(mu_sun), altitude_place(altitude)), vec2(textureSize(air_light, 0).xy));
}

vec4 light_layer(vec2 place, int layer) { return textureLod(air_light, vec3(place, float(layer)), 0.0); }

// The part of the aerosols' phase function, convolved with itself 0 to 3 times, that has degrees above air.degree; row 1:
// its irradiance on a plane, nu being between the plane's normal and the peak.
vec4 peaks(float nu, int row) {
    vec2 place = vec2(sqrt(max(0.5 - 0.5 * nu, 0.0)), float(row));
    return textureLod(air_peaks, texel_centred(place, vec2(textureSize(air_peaks, 0))), 0.0);
}

// Light of the sun that aerosols scattered 1, 2 or 3 times by so little each time that it comes from where the sun is, as
// far as it has degrees above air.degree: it is these peaks, times powers of the depth to the sun over factorials.
const vec3 all_forward = vec3(1.0, 1.0 / 2.0, 1.0 / 6.0);

// It is so where aerosols are about; far above them none comes from above the sun, and all of it is in the tables.
vec4 forward_of(vec4 depth, vec3 peak, float density) {
    return density / (density + 0.01) * depth * (peak.x + depth * (peak.y + depth * peak.z));
}

vec4 forward_light(float altitude, float mu_sun, vec3 peak) {
    float visible = sun_visibility(altitude, mu_sun);
    if (visible <= 0.0) return vec4(0);
    vec3 to_sun = columns_to_sun(altitude, mu_sun);
    return visible * transmittance_of(to_sun) *
           forward_of(air.mie_scattering * to_sun.y, peak, densities(altitude).y);
}

vec4 sky_irradiance_at(float altitude, float mu_sun, vec3 forward) {
    vec4 irradiance = light_layer(light_place(altitude, mu_sun), irradiance_layer);
    if (forward != vec3(0)) irradiance += forward_light(altitude, mu_sun, forward * peaks(mu_sun, 1).xyz);
    return max(irradiance, vec4(0));
}

// Light per km and steradian that the air at a point sends on in a direction, of what was scattered or reflected before
// and is in the tables; that of aerosols may be less than nothing where they scatter less forward than forward_light().
// Convolution with a phase function is one factor for each degree of spherical harmonics (Funk and Hecke); that of
// molecules has the degrees 0 and 2, about the vertical and even in the azimuth from the sun.
vec4 scattered_again(float altitude, float mu, float mu_sun, float nu, vec2 density) {
    vec2 place = light_place(altitude, mu_sun);
    float sine_squared = max(1.0 - mu * mu, 0.0);
    float sine = sqrt(sine_squared);
    float sun_sine = sqrt(max(1.0 - mu_sun * mu_sun, 0.0));
    float toward_sun = clamp((nu - mu * mu_sun) / max(sun_sine, 1e-4), -sine, sine);  // sine times cosine of the azimuth
    vec4 by_molecules = light_layer(place, 0) + light_layer(place, 1) * (1.5 * mu * mu - 0.5) +
                        light_layer(place, 2) * (mu * toward_sun) +
                        light_layer(place, 3) * (2.0 * toward_sun * toward_sun - sine_squared);
    vec4 sum = air.rayleigh_scattering * density.x * max(by_molecules, vec4(0));
    if (density.y > 1e-7) {
        float direction = direction_place(mu) * float(air.directions - 1);
        int below = min(int(direction), air.directions - 2);
        float above = direction - float(below);
        float cosine = clamp(toward_sun / max(sine, 1e-4), -1.0, 1.0);
        float harmonic = 1.0;
        float harmonic_before = cosine;
        int layer = first_aerosol_layer + below;
        vec4 by_aerosols = vec4(0);
        for (int m = 0; m <= air.degree; ++m) {
            by_aerosols += harmonic * mix(light_layer(place, layer), light_layer(place, layer + 1), above);
            float next = 2.0 * cosine * harmonic - harmonic_before;
            harmonic_before = harmonic;
            harmonic = next;
            layer += air.directions;
        }
        sum += air.mie_scattering * density.y * by_aerosols;
    }
    return sum;
}

const float free_paths = 4.0;

// x if it lies in (from, to), else to.
float nearer(float from, float x, float to) { return x > from && x < to ? x : to; }

// The roots of a x² + 2 b x + c, or -1.
vec2 roots(float a, float b, float c) {
    float discriminant = b * b - a * c;
    float q = -(b + (b < 0.0 ? -1.0 : 1.0) * sqrt(max(discriminant, 0.0)));
    if (discriminant < 0.0 || q == 0.0) return vec2(-1);
    return vec2(c / q, a > 0.0 ? q / a : -1.0);
}

// Light from the first `length` km of a path: of the sun's, with `first`; of forward_light(), times `forward`; and, with
// `again`, of what the tables hold. By Gauss and Legendre over pieces that end at the perigee, where the sun's
// disc touches the horizon, and in thick air some free paths from the start; each with t = L u² from its lower end,
// where the air is.
vec4 light_along(AirPath path, float length, float mu_sun, float nu, bool first, vec3 forward, bool again) {
    float ground = air.radius_ground;
    float r = radius_at(path.at.altitude);
    float r_sun = r * mu_sun;
    ColumnsAlong along = columns_along(path);

    // The disc's place above the horizon is r_sun + nu d + sqrt(r(d)² - R²) = c for c = -alpha R, alpha R.
    vec4 cuts = vec4(-1);
    bool sunlit = first || forward != vec3(0);
    if (sunlit) {
        for (int i = 0; i < 2; ++i) {
            float rest = (i == 0 ? -1.0 : 1.0) * air.sun_radius * ground - r_sun;
            vec2 found = roots(1.0 - nu * nu, r * path.at.mu + nu * rest, path.at.altitude * (r + ground) - rest * rest);
            if (i == 0) cuts.xy = found; else cuts.zw = found;
        }
    }
    vec2 density_at_start = densities(path.at.altitude);
    vec4 extinction =
        air.rayleigh_scattering * density_at_start.x + air.mie_extinction * density_at_start.y;
    float most = max(max(extinction.x, extinction.y), max(extinction.z, extinction.w));
    float seen = most * length > 2.0 * free_paths ? free_paths / most : 0.0;
    vec3 peak = forward != vec3(0) ? forward * peaks(nu, 0).yzw : vec3(0);
    float rayleigh = first ? rayleigh_phase(nu) : 0.0;
    float mie = first ? mie_phase(nu) : 0.0;

    vec4 sum = vec4(0);
    float begin = 0.0;
    for (int piece = 0; piece < 7 && begin < length; ++piece) {
        float from = begin + 1e-5 * length;
        float end = nearer(from, along.perigee, length);
        end = nearer(from, cuts.x, end);
        end = nearer(from, cuts.y, end);
        end = nearer(from, cuts.z, end);
        end = nearer(from, cuts.w, end);
        end = nearer(from, seen, end);
        bool rising = 0.5 * (begin + end) > along.perigee;
        for (int i = 0; i < air.nodes; ++i) {
            vec2 node = quadrature_node(i);
            float t = (end - begin) * node.x * node.x;
            float distance = rising ? begin + t : end - t;
            RayPoint at = ray_after(path.at, distance);
            float mu_sun_there = clamp((r_sun + nu * distance) / radius_at(at.altitude), -1.0, 1.0);
            vec2 density = densities(at.altitude);
            vec3 columns = columns_to(along, at, distance);
            vec4 source = vec4(0);
            float visible = sunlit ? sun_visibility(at.altitude, mu_sun_there) : 0.0;
            if (visible > 0.0) {
                vec3 to_sun = columns_to_sun(at.altitude, mu_sun_there);
                source = visible * transmittance_of(to_sun) *
                         (air.rayleigh_scattering * (density.x * rayleigh) +
                          air.mie_scattering * density.y *
                              (mie + forward_of(air.mie_scattering * to_sun.y, peak, density.y)));
            }
            if (again) source += scattered_again(at.altitude, at.mu, mu_sun_there, nu, density);
            sum += 2.0 * node.x * node.y * (end - begin) * transmittance_of(columns) * max(source, vec4(0));
        }
        begin = end;
    }
    return sum;
}
