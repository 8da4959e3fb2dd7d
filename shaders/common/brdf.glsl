// The reflection of lumo's surfaces. Specular: GGX, Smith, Schlick as in UE4 (Karis, Real Shading in Unreal Engine 4,
// 2013). Diffuse: Burley, Physically-Based Shading at Disney, 2012. Directions are unit vectors away from the
// surface; roughness is perceptual, alpha = roughness². BRDFs are in 1/sr, without the cosine.

#include "common/constants.glsl"

// Below it the highlight of a point-like light is narrower than float and pixels resolve.
const float min_roughness = 0.045;

struct Surface {
    vec3 diffuse;      // base colour of the non-metal part
    vec3 specular;     // reflectance at normal incidence
    float roughness;
};

Surface make_surface(vec3 base_color, float metallic, float roughness) {
    return Surface(base_color * (1 - metallic), mix(vec3(0.04), base_color, metallic),
                   max(roughness, min_roughness));
}

float pow5(float x) { return x * x * x * x * x; }

// Karis 2013, equation 3. The squared sine of the angle between n and h comes by itself, because 1 - n_h² has lost
// the digits that a narrow highlight is made of.
float ggx_distribution(float alpha, float n_h, float sine_squared) {
    float a2 = alpha * alpha;
    float d = max(a2 * n_h * n_h + sine_squared, a2);  // never below a2, but where h has no direction
    return a2 / (pi * d * d);
}

// Karis 2013, equation 4, divided by 4 (n·l) (n·v) of the microfacet model; k is the one for analytic lights.
float smith_visibility(float roughness, float n_l, float n_v) {
    float k = (roughness + 1) * (roughness + 1) / 8;
    return 0.25 / ((n_l * (1 - k) + k) * (n_v * (1 - k) + k));
}

// Schlick's fifth power in place of Karis' exponential fit to it (equation 5), which misses 1 at grazing angles.
vec3 schlick_fresnel(vec3 f0, float v_h) { return f0 + (1 - f0) * pow5(1 - v_h); }

vec3 specular_brdf(Surface surface, float n_l, float n_v, float n_h, float sine_squared, float v_h) {
    return ggx_distribution(surface.roughness * surface.roughness, n_h, sine_squared) *
           smith_visibility(surface.roughness, n_l, n_v) * schlick_fresnel(surface.specular, v_h);
}

// Burley 2012, section 5.3. The model gains energy where it is rough: with roughness 1 a white surface reflects 1.04
// of the light of a furnace at n·v = 1, 1.06 at 0.5 and 1.38 at 0.1; with roughness 0.5, 1.01, 1.01 and 1.02.
vec3 burley_brdf(Surface surface, float n_l, float n_v, float v_h) {
    float grazing = 2 * surface.roughness * v_h * v_h - 0.5;
    return surface.diffuse / pi * (1 + grazing * pow5(1 - n_l)) * (1 + grazing * pow5(1 - n_v));
}

// The BRDF times the cosine of the light; 0 for light from below. A view from below the shading normal, which normal
// maps make possible, is taken as grazing.
vec3 reflect_direct(Surface surface, vec3 normal, vec3 to_eye, vec3 to_light, bool lambert) {
    float n_l = clamp(dot(normal, to_light), 0, 1);
    if (n_l == 0) return vec3(0);
    if (lambert) return surface.diffuse / pi * n_l;
    float n_v = clamp(dot(normal, to_eye), 1e-4, 1);
    vec3 sum = to_eye + to_light;
    vec3 half_vector = sum * inversesqrt(max(dot(sum, sum), 1e-12));
    float n_h = clamp(dot(normal, half_vector), 0, 1);
    float v_h = clamp(dot(to_eye, half_vector), 0, 1);
    vec3 sine = cross(normal, half_vector);
    return (burley_brdf(surface, n_l, n_v, v_h) + specular_brdf(surface, n_l, n_v, n_h, dot(sine, sine), v_h)) *
           n_l;
}
