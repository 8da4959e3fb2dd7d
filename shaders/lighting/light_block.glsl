// The light of a frame. The includer defines LIGHT, the block's binding.
layout(std140, binding = LIGHT) uniform Light {
    vec3 sun_irradiance;  // on a plane facing it, W/m²; its direction is the shadow map's
    vec3 environment;     // radiance from outside the scene, W/m²/sr
} light;
