// Light of the analytic lights, reflected toward the eye. The includer has CAMERA, LIGHTS and SHADOW_MAPS.
#include "common/brdf.glsl"
#include "common/camera.glsl"
#include "common/lights.glsl"

// Radiance, W/m²/sr. `geometric_normal` is that of the plane that the light falls on, `normal` shades; both unit length.
vec3 reflect_lights(Surface surface, vec3 position, vec3 geometric_normal, vec3 normal, bool diffuse_materials) {
    vec3 to_eye = direction_to_eye(position);
    vec3 radiance = vec3(0);
    for (int light = 0; light < lights.count; ++light) {
        Incident incident = incident_light(light, position);
        // However its normal is bent, a surface hides the light behind it.
        if (dot(geometric_normal, incident.to_light) <= 0) continue;
        vec3 reflected = incident.irradiance *
                         reflect_direct(surface, normal, to_eye, incident.to_light, diffuse_materials);
        if (reflected != vec3(0)) radiance += reflected * light_visibility(light, position, geometric_normal);
    }
    return radiance;
}
