// Linear Rec. 709 and sRGB (IEC 61966-2-1).

float luminance(vec3 color) { return dot(color, vec3(0.2126, 0.7152, 0.0722)); }

// Linear [0, 1] to the encoded value.
vec3 srgb_encode(vec3 linear) {
    vec3 curve = 1.055 * pow(max(linear, vec3(0.0031308)), vec3(1 / 2.4)) - 0.055;
    return mix(curve, 12.92 * linear, lessThanEqual(linear, vec3(0.0031308)));
}

// Its inverse.
vec3 srgb_decode(vec3 encoded) {
    vec3 curve = pow((max(encoded, vec3(0.04045)) + 0.055) / 1.055, vec3(2.4));
    return mix(curve, encoded / 12.92, lessThanEqual(encoded, vec3(0.04045)));
}
