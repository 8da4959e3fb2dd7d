#include "scene/gpu_scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <fmt/format.h>
#include <map>
#include <tuple>

#include "scene/mips.hpp"

namespace lumo::scene {
namespace {

// The next three mirror shaders/common/geometry.glsl and material.glsl.

struct StoredVertex {
    glm::vec3 position;
    float uv0_x;
    glm::vec3 normal;
    float uv0_y;
    glm::vec4 tangent;
    glm::vec2 uv1;
    std::array<uint16_t, 4> color;
};
static_assert(sizeof(StoredVertex) == 64);

struct StoredInstance {
    glm::vec4 world_from_object[3];
    glm::vec4 world_from_normal[3];
};
static_assert(sizeof(StoredInstance) == 96);

enum Role : uint32_t { base_color, metallic_roughness, normal, occlusion, emission, role_count };
constexpr uint32_t flag_unlit = 0x100;
constexpr uint32_t flag_normal_mapped = 0x200;

struct alignas(material_stride) StoredMaterial {
    glm::vec4 base_color;
    glm::vec3 emission;
    float alpha_cutoff;
    float metallic;
    float roughness;
    float normal_scale;
    float occlusion_strength;
    uint32_t flags;
    uint32_t padding[3];
    glm::vec4 uv_rows[2 * role_count];
};
static_assert(sizeof(StoredMaterial) == material_stride && offsetof(StoredMaterial, uv_rows) == 64);

StoredVertex stored(const Vertex& v) {
    StoredVertex s{v.position, v.uv0.x, v.normal, v.uv0.y, v.tangent, v.uv1, {}};
    for (int c = 0; c < 4; ++c)
        s.color[size_t(c)] = uint16_t(std::lround(65535 * std::clamp(v.color[c], 0.0f, 1.0f)));
    return s;
}

bool mirrors(const glm::mat4& m) { return glm::determinant(glm::dmat3(m)) < 0; }

StoredInstance stored(const glm::mat4& world_from_object) {
    const glm::dmat3 m(world_from_object);
    // The inverse transpose times the determinant, whose magnitude is of no use: scaled away, tiny and huge
    // instances stay within float's range.
    glm::dmat3 normals(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
    const double handedness = mirrors(world_from_object) ? -1 : 1;
    double largest = 0;
    for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r) largest = std::max(largest, std::abs(normals[c][r]));
    if (largest > 0) normals *= handedness / largest;
    StoredInstance s{};
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 4; ++c) s.world_from_object[r][c] = world_from_object[c][r];
        for (int c = 0; c < 3; ++c) s.world_from_normal[r][c] = float(normals[c][r]);
    }
    s.world_from_normal[0].w = float(handedness);
    return s;
}

/// The texture slots of a material that are of use, by role.
std::array<const TextureSlot*, role_count> slots(const Material& m, bool diffuse) {
    const auto slot = [](const std::optional<TextureSlot>& s) { return s ? &*s : nullptr; };
    std::array<const TextureSlot*, role_count> result{};
    result[base_color] = slot(m.base_color_texture);
    if (m.emits()) result[emission] = slot(m.emission_texture);
    if (diffuse || m.unlit) return result;
    result[metallic_roughness] = slot(m.metallic_roughness_texture);
    result[normal] = slot(m.normal_texture);
    result[occlusion] = slot(m.occlusion_texture);
    return result;
}

StoredMaterial stored(const Material& m, bool diffuse) {
    const auto used = slots(m, diffuse);
    StoredMaterial s{};
    s.base_color = m.base_color;
    s.emission = m.emission;
    s.alpha_cutoff = m.alpha_mode == AlphaMode::mask ? m.alpha_cutoff : 0;
    s.metallic = diffuse ? 0 : m.metallic;
    s.roughness = diffuse ? 1 : m.roughness;
    s.normal_scale = m.normal_scale;
    s.occlusion_strength = m.occlusion_strength;
    s.flags = (m.unlit ? flag_unlit : 0) | (used[normal] ? flag_normal_mapped : 0);
    for (uint32_t role = 0; role < role_count; ++role) {
        const glm::mat3 uv = used[role] ? used[role]->uv_transform : glm::mat3(1);
        if (used[role] && used[role]->uv_set == 1) s.flags |= 1u << role;
        for (int row = 0; row < 2; ++row)
            s.uv_rows[2 * role + uint32_t(row)] = {uv[0][row], uv[1][row], uv[2][row], 0};
    }
    return s;
}

rhi::SamplerDesc sampler_desc(const TextureSampler& s) {
    const auto filter = [](Filter f) {
        return f == Filter::nearest ? rhi::FilterMode::nearest : rhi::FilterMode::linear;
    };
    const auto address = [](Wrap wrap) {
        switch (wrap) {
            case Wrap::repeat:
                return rhi::AddressMode::repeat;
            case Wrap::mirrored_repeat:
                return rhi::AddressMode::mirrored_repeat;
            case Wrap::clamp_to_edge:
                break;
        }
        return rhi::AddressMode::clamp_to_edge;
    };
    // No anisotropy: how it samples is each driver's own.
    return {.magnification = filter(s.magnification),
            .minification = filter(s.minification),
            .mip = filter(s.mip.value_or(Filter::nearest)),
            .address_u = address(s.wrap_u),
            .address_v = address(s.wrap_v),
            .max_lod = s.mip ? 1000.0f : 0.0f};
}

Result<rhi::Buffer> upload(rhi::Device& device, std::string name, rhi::BufferUsage usage,
                           std::span<const std::byte> bytes) {
    const uint64_t limit = device.info().limits.max_storage_bytes;
    if (bytes.size() > limit)
        return fail(ErrorKind::limit, name,
                    fmt::format("{} bytes are more than the {} that a shader of this device can read",
                                bytes.size(), limit));
    auto buffer = device.create_buffer(
        {.name = std::move(name), .size = std::max<uint64_t>(bytes.size(), 256), .usage = usage});
    if (!buffer || bytes.empty()) return buffer;
    if (auto done = device.upload(buffer->slice(0, bytes.size()), bytes); !done)
        return tl::unexpected(std::move(done.error()));
    return buffer;
}

/// Makes textures and samplers, each once for all materials that want the same.
class Textures {
  public:
    Textures(rhi::Device& device, const Scene& scene) : device_(device), scene_(scene) {}

    Result<rhi::Sampled<rhi::Dimension::d2>> neutral(uint8_t r, uint8_t g, uint8_t b) {
        const auto [known, fresh] = neutrals_.try_emplace({r, g, b}, textures.size());
        if (fresh) {
            const Image8 texel{1, 1, 4, {r, g, b, 255}};
            if (auto made = add(texel, "material.neutral", Encoding::linear, {}); !made)
                return tl::unexpected(std::move(made.error()));
        }
        return with_sampler(known->second, {});
    }

    Result<rhi::Sampled<rhi::Dimension::d2>> get(const TextureSlot& slot, Encoding encoding,
                                                 std::optional<float> alpha_cutoff) {
        const Texture& texture = scene_.textures[slot.texture];
        const bool opaque = !alpha_cutoff || !has_alpha(texture.image);
        const auto key = std::tuple(texture.image, encoding, opaque ? -1.0f : *alpha_cutoff);
        const auto [known, fresh] = images_.try_emplace(key, textures.size());
        if (fresh) {
            const std::string name = fmt::format("material.image{}{}", texture.image,
                                                 encoding == Encoding::srgb ? ".color" : ".data");
            if (auto made = add(scene_.images[texture.image], name, encoding,
                                opaque ? std::optional<float>() : alpha_cutoff);
                !made)
                return tl::unexpected(std::move(made.error()));
        }
        return with_sampler(known->second, texture.sampler);
    }

    std::vector<rhi::Texture> textures;
    std::vector<rhi::Sampler> samplers;

  private:
    bool has_alpha(uint32_t image) const {
        const std::vector<uint8_t>& values = scene_.images[image].values;
        for (size_t i = 3; i < values.size(); i += 4)
            if (values[i] != 255) return true;
        return false;
    }

    Result<void> add(const Image8& image, const std::string& name, Encoding encoding,
                     std::optional<float> alpha_cutoff) {
        const uint32_t limit = device_.info().limits.max_texture_side_2d;
        if (std::max(image.width, image.height) > limit)
            return fail(ErrorKind::limit, name,
                        fmt::format("{}x{} texels are more than this device's {} a side", image.width,
                                    image.height, limit));
        const rhi::Extent extent{image.width, image.height};
        auto texture = device_.create_texture({
            .name = name,
            .format = encoding == Encoding::srgb ? rhi::Format::rgba8_srgb : rhi::Format::rgba8_unorm,
            .extent = extent,
            .mips = rhi::full_mips(extent),
        });
        if (!texture) return tl::unexpected(std::move(texture.error()));

        rhi::Commands commands = device_.begin();
        {
            rhi::Pass pass = commands.pass("scene.upload");
            const auto upload_mip = [&](const Image8& level, uint32_t mip) {
                pass.upload(*texture, rhi::whole_mip(texture->desc(), mip),
                            std::as_bytes(std::span(level.values)));
            };
            upload_mip(image, 0);
            uint32_t mip = 0;
            for (const Image8& level : lower_mips(image, encoding, alpha_cutoff)) upload_mip(level, ++mip);
        }
        // Waiting keeps the staging memory of a large scene to one texture's worth.
        if (auto done = device_.wait(device_.submit(std::move(commands))); !done) return done;
        textures.push_back(std::move(*texture));
        return {};
    }

    Result<rhi::Sampled<rhi::Dimension::d2>> with_sampler(size_t texture, const TextureSampler& sampler) {
        const auto known = std::ranges::find(sampler_keys_, sampler);
        const size_t index = size_t(known - sampler_keys_.begin());
        if (known == sampler_keys_.end()) {
            auto made = device_.create_sampler(sampler_desc(sampler));
            if (!made) return tl::unexpected(std::move(made.error()));
            samplers.push_back(std::move(*made));
            sampler_keys_.push_back(sampler);
        }
        return rhi::Sampled<rhi::Dimension::d2>(textures[texture].view<rhi::Dimension::d2>(),
                                                samplers[index].handle());
    }

    rhi::Device& device_;
    const Scene& scene_;
    std::map<std::tuple<uint8_t, uint8_t, uint8_t>, size_t> neutrals_;
    std::map<std::tuple<uint32_t, Encoding, float>, size_t> images_;
    std::vector<TextureSampler> sampler_keys_;
};

Result<MaterialTextures> material_textures(Textures& textures, const Material& material, bool diffuse) {
    const auto used = slots(material, diffuse);
    const auto texture = [&](Role role, Encoding encoding, uint8_t r, uint8_t g, uint8_t b) {
        if (!used[role]) return textures.neutral(r, g, b);
        std::optional<float> cutoff;
        if (role == base_color && material.alpha_mode == AlphaMode::mask && material.base_color.a > 0)
            cutoff = material.alpha_cutoff / material.base_color.a;
        return textures.get(*used[role], encoding, cutoff);
    };
    auto color = texture(base_color, Encoding::srgb, 255, 255, 255);
    if (!color) return tl::unexpected(std::move(color.error()));
    auto metal = texture(metallic_roughness, Encoding::linear, 255, 255, 255);
    if (!metal) return tl::unexpected(std::move(metal.error()));
    auto bumps = texture(normal, Encoding::linear, 128, 128, 255);
    if (!bumps) return tl::unexpected(std::move(bumps.error()));
    auto open = texture(occlusion, Encoding::linear, 255, 255, 255);
    if (!open) return tl::unexpected(std::move(open.error()));
    auto glow = texture(emission, Encoding::srgb, 255, 255, 255);
    if (!glow) return tl::unexpected(std::move(glow.error()));
    return MaterialTextures{*color, *metal, *bumps, *open, *glow};
}

/// Where each mesh's instances lie among the sorted ones: the plain ones, then the mirrored.
struct InstanceRange {
    uint32_t first = 0;
    uint32_t plain = 0;
    uint32_t mirrored = 0;
};

Bounds bounds_of(const Scene& scene, const Primitive& primitive) {
    Bounds box;
    for (uint32_t i = 0; i < primitive.index_count; ++i)
        box.add(scene.vertices[scene.indices[primitive.first_index + i]].position);
    return box;
}

/// Of the world bounds of a box in several places.
glm::vec3 center_of(const Bounds& box, std::span<const glm::mat4> places) {
    Bounds world;
    for (const glm::mat4& m : places)
        for (int corner = 0; corner < 8; ++corner)
            world.add(m * glm::vec4(corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
                                    corner & 4 ? box.max.z : box.min.z, 1));
    return 0.5f * (world.min + world.max);
}

}  // namespace

Result<GpuScene> GpuScene::create(rhi::Device& device, const Scene& scene, bool diffuse_materials) {
    GpuScene gpu;
    gpu.bounds_ = world_bounds(scene);

    std::vector<const Instance*> order;
    for (const Instance& instance : scene.instances) order.push_back(&instance);
    std::ranges::stable_sort(
        order, {}, [](const Instance* i) { return std::pair(i->mesh, mirrors(i->world_from_object)); });
    std::vector<InstanceRange> ranges(scene.meshes.size());
    std::vector<glm::mat4> places;
    std::vector<StoredInstance> instances;
    for (const Instance* instance : order) {
        InstanceRange& range = ranges[instance->mesh];
        if (range.plain + range.mirrored == 0) range.first = uint32_t(instances.size());
        ++(mirrors(instance->world_from_object) ? range.mirrored : range.plain);
        places.push_back(instance->world_from_object);
        instances.push_back(stored(instance->world_from_object));
    }

    for (size_t mesh = 0; mesh < scene.meshes.size(); ++mesh) {
        const InstanceRange& range = ranges[mesh];
        for (const Primitive& primitive : scene.meshes[mesh].primitives) {
            if (primitive.index_count == 0) continue;
            const Material& material = scene.materials[primitive.material];
            const Bounds box = bounds_of(scene, primitive);
            const auto add = [&](uint32_t first, uint32_t count, bool mirrored) {
                if (count == 0) return;
                gpu.draws_.push_back({
                    .first_index = primitive.first_index,
                    .index_count = primitive.index_count,
                    .first_instance = first,
                    .instances = count,
                    .material = primitive.material,
                    .double_sided = material.double_sided,
                    .mirrored = mirrored,
                    .alpha_mode = material.alpha_mode,
                    .emits = material.emits(),
                    .unlit = material.unlit,
                    .normal_mapped = slots(material, diffuse_materials)[normal] != nullptr,
                    .center = center_of(box, std::span(places).subspan(first, count)),
                });
            };
            const uint32_t first_mirrored = range.first + range.plain;
            if (material.alpha_mode == AlphaMode::blend) {
                for (uint32_t i = 0; i < range.plain + range.mirrored; ++i)
                    add(range.first + i, 1, i >= range.plain);
            } else {
                add(range.first, range.plain, false);
                add(first_mirrored, range.mirrored, true);
            }
        }
    }
    std::ranges::stable_sort(gpu.draws_, {},
                             [](const DrawView& d) { return std::pair(d.alpha_mode, d.material); });

    std::vector<bool> drawn(scene.materials.size());
    for (const DrawView& draw : gpu.draws_) drawn[draw.material] = true;
    Textures textures(device, scene);
    std::vector<StoredMaterial> materials;
    for (size_t i = 0; i < scene.materials.size(); ++i) {
        materials.push_back(stored(scene.materials[i], diffuse_materials));
        auto set = material_textures(textures, drawn[i] ? scene.materials[i] : Material{}, diffuse_materials);
        if (!set) return tl::unexpected(std::move(set.error()));
        gpu.material_textures_.push_back(*set);
    }
    gpu.textures_ = std::move(textures.textures);
    gpu.samplers_ = std::move(textures.samplers);

    std::vector<StoredVertex> vertices;
    vertices.reserve(scene.vertices.size());
    for (const Vertex& vertex : scene.vertices) vertices.push_back(stored(vertex));

    using rhi::BufferUsage;
    const auto fill = [&](rhi::Buffer& buffer, const char* name, BufferUsage usage, const auto& data) {
        return upload(device, name, usage, std::as_bytes(std::span(data))).map([&](rhi::Buffer&& made) {
            buffer = std::move(made);
        });
    };
    return fill(gpu.vertices_, "scene.vertices", BufferUsage::storage, vertices)
        .and_then([&] {
            return fill(gpu.indices_, "scene.indices", BufferUsage::storage | BufferUsage::index,
                        scene.indices);
        })
        .and_then([&] { return fill(gpu.instances_, "scene.instances", BufferUsage::storage, instances); })
        .and_then([&] { return fill(gpu.materials_, "scene.materials", BufferUsage::uniform, materials); })
        .map([&] { return std::move(gpu); });
}

GeometryView GpuScene::view() const {
    return {vertices_.slice(),
            indices_.slice(),
            instances_.slice(),
            materials_.slice(),
            material_textures_,
            draws_,
            bounds_};
}

}  // namespace lumo::scene
