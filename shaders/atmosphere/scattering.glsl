// Light scattered toward the eye along a ray, by the tables. Include after atmosphere/columns.glsl; takes the bindings
// atmosphere_binding + 2 and + 3. Light is relative to the sun's irradiance.

// Layers: moments of the light that arrives at a point from all directions, summed over the orders that are scattered
// once more; see scattered_again(). The last layer is the sky's irradiance on a level plane.
layout(binding = atmosphere_binding + 2) uniform sampler2DArray air_moments;
// What the moments leave out of the aerosols' forward peak: see peaks().
layout(binding = atmosphere_binding + 3) uniform sampler2D air_peaks;

vec2 moments_place(float altitude, float mu_sun) {
    return texel_centred(vec2(sun_place(mu_sun), altitude_place(altitude)), vec2(textureSize(air_moments, 0).xy));
}

int moments_count() { return (air.degree + 1) * (air.degree + 2) / 2; }

vec4 sky_irradiance_at(float altitude, float mu_sun) {
    return textureLod(air_moments, vec3(moments_place(altitude, mu_sun), float(moments_count())), 0.0);
}

// Light per km and steradian that the air at a point sends on in a direction, of what was scattered or reflected before.
// Spherical harmonics about the vertical, even in the azimuth from the sun: convolution with a phase function is one
// factor for each degree (Funk and Hecke). The factors of normalisation are in the moments.
vec4 scattered_again(float altitude, float mu, float mu_sun, float nu, vec2 density) {
    vec2 place = moments_place(altitude, mu_sun);
    float sine_squared = max(1.0 - mu * mu, 0.0);
    float sine = sqrt(sine_squared);
    float sun_sine = sqrt(max(1.0 - mu_sun * mu_sun, 0.0));
    float toward_sun = clamp((nu - mu * mu_sun) / max(sun_sine, 1e-4), -sine, sine);  // sin(theta) cos(phi)
    vec4 rayleigh = air.rayleigh_scattering * density.x;
    vec4 mie = air.mie_scattering * density.y;
    vec4 sum = vec4(0);
    int layer = 0;
    float azimuthal = 1.0;  // sin(theta)^m cos(m phi)
    float azimuthal_before = 0.0;
    float sectoral = 1.0;
    for (int m = 0; m <= air.degree; ++m) {
        float legendre = sectoral;  // P_lm / sin(theta)^m
        float legendre_before = 0.0;
        for (int l = m; l <= air.degree; ++l) {
            vec4 moment = textureLod(air_moments, vec3(place, float(layer)), 0.0);
            float rayleigh_moment = l == 0 ? 1.0 : l == 2 ? 0.1 : 0.0;
            sum += (rayleigh * rayleigh_moment + mie * air.mie_moments[l >> 2][l & 3]) * moment *
                   (legendre * azimuthal);
            float next = (float(2 * l + 1) * mu * legendre - float(l + m) * legendre_before) / float(l + 1 - m);
            legendre_before = legendre;
            legendre = next;
            layer += 1;
        }
        float next = (m == 0 ? 1.0 : 2.0) * toward_sun * azimuthal - sine_squared * azimuthal_before;
        azimuthal_before = azimuthal;
        azimuthal = next;
        sectoral *= float(2 * m + 1);
    }
    return max(sum, vec4(0));
}

// The part of the aerosols' phase function, convolved with itself 1 to 4 times, that has moments above air.degree: light
// that was scattered by so little each time that it came along the ray itself.
vec4 peaks(float nu) {
    vec2 size = vec2(textureSize(air_peaks, 0));
    return textureLod(air_peaks, texel_centred(vec2(sqrt(max(0.5 - 0.5 * nu, 0.0)), 0), size), 0.0);
}

// x if it lies in (from, to), else to.
float nearer(float from, float x, float to) { return x > from && x < to ? x : to; }

// The roots of a x² + 2 b x + c, or -1.
vec2 roots(float a, float b, float c) {
    float discriminant = b * b - a * c;
    float q = -(b + (b < 0.0 ? -1.0 : 1.0) * sqrt(max(discriminant, 0.0)));
    if (discriminant < 0.0 || q == 0.0) return vec2(-1);
    return vec2(c / q, a > 0.0 ? q / a : -1.0);
}

// Light from the first `length` km of a path. `first`: of order 1; `again`: of what the tables hold. By Gauss and
// Legendre over pieces that end at the perigee and where the sun's disc touches the horizon; each with t = L u² from
// its lower end, where the air is.
vec4 light_along(AirPath path, float length, float mu_sun, float nu, bool first, bool again) {
    float ground = air.radius_ground;
    float r = radius_at(path.at.altitude);
    float r_sun = r * mu_sun;
    ColumnsAlong along = columns_along(path);

    // The disc's place above the horizon is r_sun + nu d + sqrt(r(d)² - R²) = c for c = -alpha R, alpha R.
    vec4 cuts = vec4(-1);
    if (first) {
        for (int i = 0; i < 2; ++i) {
            float rest = (i == 0 ? -1.0 : 1.0) * air.sun_radius * ground - r_sun;
            vec2 found = roots(1.0 - nu * nu, r * path.at.mu + nu * rest, path.at.altitude * (r + ground) - rest * rest);
            if (i == 0) cuts.xy = found; else cuts.zw = found;
        }
    }
    vec4 peak = again ? peaks(nu) : vec4(0);
    float rayleigh = rayleigh_phase(nu);
    float mie = mie_phase(nu);

    vec4 sum = vec4(0);
    float begin = 0.0;
    for (int piece = 0; piece < 6 && begin < length; ++piece) {
        float from = begin + 1e-5 * length;
        float end = nearer(from, along.perigee, length);
        end = nearer(from, cuts.x, end);
        end = nearer(from, cuts.y, end);
        end = nearer(from, cuts.z, end);
        end = nearer(from, cuts.w, end);
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
            float visible = first ? sun_visibility(at.altitude, mu_sun_there) : 0.0;
            if (visible > 0.0) {
                vec4 depth = air.mie_scattering * columns.y;
                vec4 forward =
                    depth * (peak.x + depth * (peak.y / 2.0 + depth * (peak.z / 6.0 + depth * peak.w / 24.0)));
                source = visible * transmittance_of(columns_to_sun(at.altitude, mu_sun_there)) *
                         (air.rayleigh_scattering * (density.x * rayleigh) +
                          air.mie_scattering * density.y * (mie + forward));
            }
            if (again) source += scattered_again(at.altitude, at.mu, mu_sun_there, nu, density);
            sum += 2.0 * node.x * node.y * (end - begin) * transmittance_of(columns) * source;
        }
        begin = end;
    }
    return max(sum, vec4(0));
}
