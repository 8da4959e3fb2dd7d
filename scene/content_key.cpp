#include "scene/content_key.hpp"

#include <bit>
#include <span>

namespace lumo::scene {
namespace {

using Key = rhi::KeyBuilder;

void add(Key& key, float value) { key.add(uint64_t(std::bit_cast<uint32_t>(value))); }

void add(Key& key, const std::optional<float>& value) {
    key.add(uint64_t(value.has_value()));
    if (value) add(key, *value);
}

/// Numbers, vectors and matrices of floats, and structures of nothing but floats or 32-bit integers: no padding.
template <class T>
void add_values(Key& key, const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    key.add(std::as_bytes(std::span(&value, 1)));
}
template <class T>
void add_values(Key& key, const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    key.add(std::as_bytes(std::span(values)));
}

static_assert(sizeof(Vertex) == sizeof(float[18]) && sizeof(Primitive) == sizeof(uint32_t[3]));

// A member more of any of these does not compile here: add it, if it changes how the scene looks.

void add(Key& key, const std::optional<TextureSlot>& slot) {
    key.add(uint64_t(slot.has_value()));
    if (!slot) return;
    const auto& [texture, uv_set, uv_transform] = *slot;
    key.add(texture).add(uv_set);
    add_values(key, uv_transform);
}

void add(Key& key, const Material& material) {
    const auto& [name, base_color, metallic, roughness, emission, normal_scale, occlusion_strength,
                 base_color_texture, metallic_roughness_texture, normal_texture, occlusion_texture,
                 emission_texture, alpha_mode, alpha_cutoff, double_sided, unlit] = material;
    add_values(key, base_color);
    add_values(key, emission);
    for (const float value : {metallic, roughness, normal_scale, occlusion_strength, alpha_cutoff})
        add(key, value);
    for (const auto* slot : {&base_color_texture, &metallic_roughness_texture, &normal_texture,
                             &occlusion_texture, &emission_texture})
        add(key, *slot);
    key.add(uint64_t(alpha_mode)).add(uint64_t(double_sided)).add(uint64_t(unlit));
}

void add(Key& key, const Texture& texture) {
    const auto& [image, sampler] = texture;
    const auto& [magnification, minification, mip, wrap_u, wrap_v] = sampler;
    key.add(image).add(uint64_t(magnification)).add(uint64_t(minification));
    key.add(mip ? 1 + uint64_t(*mip) : 0).add(uint64_t(wrap_u)).add(uint64_t(wrap_v));
}

void add(Key& key, const Light& light) {
    const auto& [name, kind, intensity, position, direction, range, inner_cone_angle, outer_cone_angle] =
        light;
    key.add(uint64_t(kind));
    for (const glm::vec3& vector : {intensity, position, direction}) add_values(key, vector);
    for (const float value : {range, inner_cone_angle, outer_cone_angle}) add(key, value);
}

void add(Key& key, const Atmosphere& atmosphere) {
    const auto& [wavelengths_nm, radius_ground_km, radius_top_km, sun_irradiance, sun_angular_radius_deg,
                 rayleigh, mie, ozone, ground_albedo] = atmosphere;
    for (const Spectrum* spectrum : {&wavelengths_nm, &sun_irradiance, &ground_albedo})
        add_values(key, *spectrum);
    for (const double value : {radius_ground_km, radius_top_km, sun_angular_radius_deg})
        add_values(key, value);
    key.add(uint64_t(rayleigh.has_value())).add(uint64_t(mie.has_value())).add(uint64_t(ozone.has_value()));
    if (rayleigh) {
        const auto& [scattering_per_km, scale_height_km] = *rayleigh;
        add_values(key, scattering_per_km);
        add_values(key, scale_height_km);
    }
    if (mie) {
        const auto& [scattering_per_km, extinction_per_km, scale_height_km, g] = *mie;
        add_values(key, scattering_per_km);
        add_values(key, extinction_per_km);
        for (const double value : {scale_height_km, g}) add_values(key, value);
    }
    if (ozone) {
        const auto& [extinction_per_km, bottom_km, peak_km, top_km] = *ozone;
        add_values(key, extinction_per_km);
        for (const double value : {bottom_km, peak_km, top_km}) add_values(key, value);
    }
}

void add(Key& key, const std::optional<Sky>& sky) {
    key.add(uint64_t(sky.has_value()));
    if (!sky) return;
    const auto& [atmosphere, direction_to_sun, altitude_km] = *sky;
    add(key, atmosphere);
    add_values(key, direction_to_sun);
    add_values(key, altitude_km);
}

void add(Key& key, const Image8& image) {
    key.add(image.width).add(image.height).add(image.channels);
    add_values(key, image.values);
}

}  // namespace

rhi::CacheKey content_key(const Scene& scene) {
    const auto& [name, vertices, indices, meshes, instances, materials, textures, images, lights, cameras,
                 environment_radiance, environment_map, sky, warnings] = scene;
    Key key;
    add_values(key, vertices);
    add_values(key, indices);
    key.add(meshes.size());
    for (const Mesh& mesh : meshes) add_values(key, mesh.primitives);
    key.add(instances.size());
    for (const auto& [mesh, world_from_object] : instances) {
        key.add(mesh);
        add_values(key, world_from_object);
    }
    const auto add_all = [&](const auto& list) {
        key.add(list.size());
        for (const auto& each : list) add(key, each);
    };
    add_all(materials);
    add_all(textures);
    add_all(images);
    add_all(lights);
    add_values(key, environment_radiance);
    key.add(environment_map.width).add(environment_map.height);
    add_values(key, environment_map.values);
    add(key, sky);
    return key.key();
}

rhi::CacheKey content_key(const Camera& camera) {
    const auto& [name, position, target, up, vertical_fov, near_plane, far_plane, orthographic_height] =
        camera;
    Key key;
    for (const glm::vec3& vector : {position, target, up}) add_values(key, vector);
    for (const float value : {vertical_fov, near_plane, far_plane}) add(key, value);
    add(key, orthographic_height);
    return key.key();
}

}  // namespace lumo::scene
