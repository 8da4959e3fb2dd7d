// Tone curves: exposed linear radiance, 0 to 65536, to display-linear Rec. 709 in [0, 1].
#include "common/color.glsl"

// Reinhard et al., Photographic Tone Reproduction for Digital Images, 2002, equation 3, on the luminance.
vec3 tonemap_reinhard(vec3 color) { return min(color / (1 + luminance(color)), 1); }

// Hable, Uncharted 2: HDR Lighting, GDC 2010, with the constants of the talk; white at 11.2.
vec3 hable_curve(vec3 x) {
    const float a = 0.15, b = 0.50, c = 0.10, d = 0.20, e = 0.02, f = 0.30;
    return (x * (a * x + c * b) + d * e) / (x * (a * x + b) + d * f) - e / f;
}
vec3 tonemap_hable(vec3 color) {
    const float exposure_bias = 2;
    return min(hable_curve(exposure_bias * color) / hable_curve(vec3(11.2)), 1);
}

// Narkowicz, ACES Filmic Tone Mapping Curve, 2015, with the 0.6 that brings it to the brightness of ACES.
vec3 tonemap_aces(vec3 color) {
    vec3 x = 0.6 * color;
    return clamp(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0, 1);
}

// Sobotka, AgX, 2022: primaries moved inward, 16.5 stops of log2 about middle grey, a sigmoid of slope 2 through
// (10 / 16.5, 0.5) with toe power 3 and shoulder power 3.25, primaries moved back, and the display's power 2.2.
// Sigmoid: y = 0.5 + s t / (1 + t^p)^(1/p) with t = 2 (x - pivot) / s; s puts the ends at 0 and 1.
float agx_sigmoid(float x) {
    const float pivot = 10.0 / 16.5;
    bool toe = x < pivot;
    float power = toe ? 3.0 : 3.25;
    float scale = toe ? -0.5122773822930714 : 0.5414641562781497;
    float t = max(2 * (x - pivot) / scale, 0);
    return 0.5 + scale * t / pow(1 + pow(t, power), 1 / power);
}
vec3 tonemap_agx(vec3 color) {
    const mat3 inset = mat3(0.842479062253094, 0.0423282422610123, 0.0423756549057051,   //
                            0.0784335999999992, 0.878468636469772, 0.0784336,            //
                            0.0792237451477643, 0.0791661274605434, 0.879142973793104);
    const mat3 outset = mat3(1.196879005120174, -0.05289685175745618, -0.05297163551444381,  //
                             -0.09802088114013681, 1.151903129904173, -0.09804345011712415,  //
                             -0.0990297440797205, -0.09896117684484336, 1.1510736726411614);
    const float first_stop = -12.47393;  // 10 below 0.18
    vec3 stops = log2(max(inset * color, vec3(exp2(first_stop))));
    vec3 x = clamp((stops - first_stop) / 16.5, 0, 1);
    vec3 display = outset * vec3(agx_sigmoid(x.r), agx_sigmoid(x.g), agx_sigmoid(x.b));
    return pow(clamp(display, 0, 1), vec3(2.2));
}
