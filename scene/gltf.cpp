#include "scene/gltf.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <iterator>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include "scene/gltf_accessor.hpp"
#include "scene/gltf_bytes.hpp"
#include "scene/gltf_document.hpp"
#include "scene/gltf_mesh.hpp"
#include "scene/printable.hpp"

namespace lumo::scene {
namespace {

using gltf::Document;

constexpr float luminous_efficacy =
    683;  // lm/W, of monochromatic light at 540 THz: the definition of the candela

template <class T>
T vector_of(const std::vector<double>& numbers, T otherwise) {
    if (numbers.size() != size_t(T::length())) return otherwise;
    for (int i = 0; i < T::length(); ++i) otherwise[i] = typename T::value_type(numbers[size_t(i)]);
    return otherwise;
}

double number_of(const tinygltf::Value& object, const char* name, double otherwise) {
    return object.Has(name) ? object.Get(name).GetNumberAsDouble() : otherwise;
}

glm::vec2 vec2_of(const tinygltf::Value& object, const char* name, glm::vec2 otherwise) {
    if (!object.Has(name)) return otherwise;
    const tinygltf::Value& pair = object.Get(name);
    return {float(pair.Get(0).GetNumberAsDouble()), float(pair.Get(1).GetNumberAsDouble())};
}

// KHR_texture_transform: T * R * S, rotation counter-clockwise with v pointing down.
glm::mat3 uv_transform_of(const tinygltf::Value& extension) {
    const glm::vec2 offset = vec2_of(extension, "offset", glm::vec2(0));
    const glm::vec2 scale = vec2_of(extension, "scale", glm::vec2(1));
    const float angle = float(number_of(extension, "rotation", 0));
    const float c = std::cos(angle), s = std::sin(angle);
    return glm::mat3(scale.x * c, scale.x * -s, 0, scale.y * s, scale.y * c, 0, offset.x, offset.y, 1);
}

// KHR_texture_transform may name another set than the slot itself.
template <class Info>
int uv_set_of(const Info& info) {
    const auto found = info.extensions.find("KHR_texture_transform");
    return found == info.extensions.end() ? info.texCoord
                                          : int(number_of(found->second, "texCoord", info.texCoord));
}

TextureSampler sampler_of(const tinygltf::Sampler& sampler) {
    constexpr int linear_mipmap_nearest = TINYGLTF_TEXTURE_FILTER_LINEAR_MIPMAP_NEAREST;
    TextureSampler result;
    if (sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST) result.magnification = Filter::nearest;
    switch (sampler.minFilter) {
        case TINYGLTF_TEXTURE_FILTER_NEAREST:
            result.minification = Filter::nearest;
            result.mip = std::nullopt;
            break;
        case TINYGLTF_TEXTURE_FILTER_LINEAR:
            result.mip = std::nullopt;
            break;
        case TINYGLTF_TEXTURE_FILTER_NEAREST_MIPMAP_NEAREST:
            result.minification = Filter::nearest;
            result.mip = Filter::nearest;
            break;
        case linear_mipmap_nearest:
            result.mip = Filter::nearest;
            break;
        case TINYGLTF_TEXTURE_FILTER_NEAREST_MIPMAP_LINEAR:
            result.minification = Filter::nearest;
            break;
        default:
            break;
    }
    const auto wrap = [](int code) {
        if (code == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE) return Wrap::clamp_to_edge;
        return code == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? Wrap::mirrored_repeat : Wrap::repeat;
    };
    result.wrap_u = wrap(sampler.wrapS);
    result.wrap_v = wrap(sampler.wrapT);
    return result;
}

bool is_finite(const glm::dmat4& m) {
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row)
            if (!std::isfinite(float(m[column][row]))) return false;
    return true;
}

class Loader {
  public:
    Loader(Document& document, gltf::Bytes& bytes, const Limits& limits, const GltfOptions& options)
        : document_(document),
          model_(document.model),
          bytes_(bytes),
          limits_(limits),
          light_scale_(options.photometric ? 1 / luminous_efficacy : 1),
          meshes_(document, bytes, limits, scene_) {}

    Result<Scene> load();

  private:
    struct PlacedCamera {
        int source = 0;           // index into the file's cameras
        bool is_endless = false;  // still needs a far plane
        Camera camera = {};
    };

    // The parent of each node, or -1.
    Result<std::vector<int>> parents() const;
    Result<std::vector<int>> root_nodes(const std::vector<int>& parents);
    Result<glm::dmat4> local_transform(int node);
    void check_cameras();

    Result<void> add_tree(int root);
    Result<void> add_node(int node, const glm::dmat4& world);
    Result<void> add_instance(int node, const glm::dmat4& world);
    void add_camera(int node, const glm::dmat4& world);
    void add_light(int node, const glm::dmat4& world);
    void finish_cameras();
    void check_undrawn_meshes();
    void warn_of_unused_images();

    Result<std::optional<uint32_t>> mesh(int index);
    Result<uint32_t> material(int index);
    Result<Material> make_material(int index);
    template <class Info>
    Result<std::optional<TextureSlot>> slot(const Info& info, const std::string& where);
    Result<std::optional<uint32_t>> texture(int index);
    Result<uint32_t> image(int index);
    void check_texture_coordinates(const tinygltf::Primitive& primitive, const std::string& where);

    void warn(std::string text) { document_.warnings.add(std::move(text)); }
    tl::unexpected<Error> invalid(std::string message) const {
        return fail(ErrorKind::invalid_file, document_.file, std::move(message), "export the file again");
    }
    static std::string named(const char* array, int index, const std::string& name) {
        return name.empty() ? fmt::format("{}[{}]", array, index)
                            : fmt::format("{}[{}] ('{}')", array, index, printable(name, 60));
    }
    std::string node_name(int node) const { return named("nodes", node, model_.nodes[size_t(node)].name); }

    Document& document_;
    const tinygltf::Model& model_;
    gltf::Bytes& bytes_;
    const Limits& limits_;
    float light_scale_;
    Scene scene_;
    gltf::MeshBuilder meshes_;
    std::map<int, std::optional<uint32_t>> mesh_indices_;  // from the file's to the scene's
    std::map<int, uint32_t> material_indices_;
    std::map<int, uint32_t> image_indices_;
    std::map<int, std::optional<uint32_t>> texture_indices_;
    std::vector<bool> camera_is_valid_;
    std::vector<PlacedCamera> cameras_;
    uint64_t image_bytes_left_ = 0;
};

Result<Scene> Loader::load() {
    scene_.name = printable(std::filesystem::path(document_.file).stem().string());
    image_bytes_left_ = limits_.images.max_bytes;
    check_cameras();
    const auto parent_of = parents();
    if (!parent_of) return tl::unexpected(parent_of.error());
    const auto roots = root_nodes(*parent_of);
    if (!roots) return tl::unexpected(roots.error());
    for (const int root : *roots)
        if (auto added = add_tree(root); !added) return tl::unexpected(added.error());
    finish_cameras();
    check_undrawn_meshes();
    warn_of_unused_images();
    if (scene_.instances.empty()) warn("there is nothing to draw");
    scene_.warnings = document_.warnings.take();
    return std::move(scene_);
}

Result<std::vector<int>> Loader::parents() const {
    std::vector<int> parent_of(model_.nodes.size(), -1);
    for (int node = 0; node < int(parent_of.size()); ++node)
        for (const int child : model_.nodes[size_t(node)].children) {
            if (parent_of[size_t(child)] >= 0)
                return invalid(fmt::format("{} is a child of nodes[{}] and of nodes[{}]", node_name(child),
                                           parent_of[size_t(child)], node));
            parent_of[size_t(child)] = node;
        }
    // Walks up from each node until a root, an earlier walk or, in a loop, this walk itself.
    std::vector<int> walk_of(parent_of.size(), -1);
    for (int start = 0; start < int(parent_of.size()); ++start) {
        if (walk_of[size_t(start)] >= 0) continue;
        int node = start;
        for (; node >= 0 && walk_of[size_t(node)] < 0; node = parent_of[size_t(node)])
            walk_of[size_t(node)] = start;
        if (node >= 0 && walk_of[size_t(node)] == start)
            return invalid(fmt::format("{} is its own ancestor", node_name(node)));
    }
    return parent_of;
}

Result<std::vector<int>> Loader::root_nodes(const std::vector<int>& parent_of) {
    std::vector<int> roots;
    if (model_.scenes.empty()) {
        for (int node = 0; node < int(parent_of.size()); ++node)
            if (parent_of[size_t(node)] < 0) roots.push_back(node);
        if (!roots.empty()) warn("the file has no scene: all of its nodes are drawn");
        return roots;
    }
    if (model_.scenes.size() > 1)
        warn(fmt::format("of {} scenes only scenes[{}] is drawn", model_.scenes.size(),
                         std::max(model_.defaultScene, 0)));
    const int index = std::max(model_.defaultScene, 0);
    std::vector<bool> is_listed(parent_of.size());
    for (const int node : model_.scenes[size_t(index)].nodes) {
        if (parent_of[size_t(node)] >= 0)
            return invalid(fmt::format("scenes[{}] has {}, which is a child of nodes[{}]", index,
                                       node_name(node), parent_of[size_t(node)]));
        if (is_listed[size_t(node)])
            warn(fmt::format("scenes[{}] has {} more than once", index, node_name(node)));
        else
            roots.push_back(node);
        is_listed[size_t(node)] = true;
    }
    return roots;
}

Result<glm::dmat4> Loader::local_transform(int index) {
    const tinygltf::Node& node = model_.nodes[size_t(index)];
    if (node.matrix.size() == 16) {
        glm::dmat4 m;
        for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = node.matrix[size_t(i)];
        if (glm::dvec4(m[0][3], m[1][3], m[2][3], m[3][3]) != glm::dvec4(0, 0, 0, 1))
            return invalid(node_name(index) + " has a matrix whose last row is not 0 0 0 1");
        const glm::dvec3 x(m[0]), y(m[1]), z(m[2]);
        const auto leans = [](glm::dvec3 a, glm::dvec3 b) {
            return std::abs(glm::dot(a, b)) > 1e-3 * glm::length(a) * glm::length(b);
        };
        if (leans(x, y) || leans(x, z) || leans(y, z)) warn(node_name(index) + " has a matrix that shears");
        return m;
    }
    const glm::dvec3 translation = vector_of(node.translation, glm::dvec3(0));
    const glm::dvec3 scale = vector_of(node.scale, glm::dvec3(1));
    const glm::dvec4 q = vector_of(node.rotation, glm::dvec4(0, 0, 0, 1));
    const double length = glm::length(q);
    if (length == 0) return invalid(node_name(index) + " has a rotation of length 0");
    if (std::abs(length - 1) > 1e-3)
        warn(fmt::format("{} has a rotation of length {}: normalized", node_name(index), length));
    const glm::dquat rotation(q.w / length, q.x / length, q.y / length, q.z / length);
    return glm::scale(glm::translate(glm::dmat4(1), translation) * glm::mat4_cast(rotation), scale);
}

Result<void> Loader::add_tree(int root) {
    struct Step {
        int node;
        uint32_t depth;
        glm::dmat4 parent;
    };
    std::vector<Step> steps = {{root, 1, glm::dmat4(1)}};
    while (!steps.empty()) {
        const Step step = steps.back();
        steps.pop_back();
        if (step.depth > limits_.max_node_depth)
            return fail(ErrorKind::limit, document_.file,
                        fmt::format("{} is deeper than the limit of {} nodes", node_name(step.node),
                                    limits_.max_node_depth),
                        "flatten the node tree");
        const auto local = local_transform(step.node);
        if (!local) return tl::unexpected(local.error());
        const glm::dmat4 world = step.parent * *local;
        if (!is_finite(world)) return invalid(node_name(step.node) + " has a transform that is not finite");
        if (auto added = add_node(step.node, world); !added) return added;
        const std::vector<int>& children = model_.nodes[size_t(step.node)].children;
        std::transform(children.rbegin(), children.rend(), std::back_inserter(steps), [&](int child) {
            return Step{child, step.depth + 1, world};
        });
    }
    return {};
}

Result<void> Loader::add_node(int index, const glm::dmat4& world) {
    const tinygltf::Node& node = model_.nodes[size_t(index)];
    if (node.skin >= 0) warn(node_name(index) + " is skinned: it stands at rest");
    if (node.mesh >= 0)
        if (auto added = add_instance(index, world); !added) return added;
    if (node.camera >= 0 && camera_is_valid_[size_t(node.camera)]) add_camera(index, world);
    if (node.extensions.contains("KHR_lights_punctual")) add_light(index, world);
    return {};
}

Result<void> Loader::add_instance(int index, const glm::dmat4& world) {
    const auto placed = mesh(model_.nodes[size_t(index)].mesh);
    if (!placed) return tl::unexpected(placed.error());
    if (!*placed) return {};
    // As the renderer will invert it, and relative to its scale, so that small things are kept.
    const glm::mat4 m(world);
    const glm::vec3 x(m[0]), y(m[1]), z(m[2]);
    const float volume = glm::length(x) * glm::length(y) * glm::length(z);
    const float determinant = glm::dot(glm::cross(x, y), z);
    if (!(std::abs(determinant) > 1e-6f * volume) || !std::isfinite(1 / determinant)) {
        warn(node_name(index) + " has a transform that cannot be inverted: its mesh is not drawn");
        return {};
    }
    if (scene_.instances.size() >= limits_.max_instances)
        return fail(ErrorKind::limit, document_.file,
                    fmt::format("has more instances of meshes than the limit of {}", limits_.max_instances),
                    "merge meshes");
    scene_.instances.push_back({.mesh = **placed, .world_from_object = m});
    return {};
}

void Loader::check_cameras() {
    for (int i = 0; i < int(model_.cameras.size()); ++i) {
        const tinygltf::Camera& camera = model_.cameras[size_t(i)];
        const bool is_perspective = camera.type == "perspective";
        const auto& p = camera.perspective;
        const auto& o = camera.orthographic;
        std::string wrong;
        if (is_perspective && !(p.yfov > 0 && p.yfov < std::numbers::pi))
            wrong = fmt::format("yfov {}", p.yfov);
        else if (is_perspective && !(p.znear > 0))
            wrong = fmt::format("znear {}", p.znear);
        else if (is_perspective && p.zfar != 0 && !(p.zfar > p.znear))
            wrong = fmt::format("zfar {} and znear {}", p.zfar, p.znear);
        else if (!is_perspective && (o.xmag == 0 || o.ymag == 0))
            wrong = fmt::format("xmag {} and ymag {}", o.xmag, o.ymag);
        else if (!is_perspective && !(o.znear >= 0 && o.zfar > o.znear))
            wrong = fmt::format("zfar {} and znear {}", o.zfar, o.znear);
        if (!wrong.empty())
            warn(fmt::format("{} has {} and is left out", named("cameras", i, camera.name), wrong));
        camera_is_valid_.push_back(wrong.empty());
    }
}

void Loader::add_camera(int index, const glm::dmat4& world) {
    const tinygltf::Node& node = model_.nodes[size_t(index)];
    const tinygltf::Camera& source = model_.cameras[size_t(node.camera)];
    const glm::dvec3 forward = -glm::dvec3(world[2]), up(world[1]);
    if (!(glm::length(glm::cross(forward, up)) > 0)) {
        warn(node_name(index) + " has a transform that leaves its camera no direction: it is left out");
        return;
    }
    Camera camera{.name = printable(source.name.empty() ? node.name : source.name),
                  .position = glm::vec3(world[3]),
                  .target = glm::vec3(glm::dvec3(world[3]) + glm::normalize(forward)),
                  .up = glm::vec3(glm::normalize(up))};
    const bool is_perspective = source.type == "perspective";
    if (is_perspective) {
        camera.vertical_fov = float(source.perspective.yfov);
        camera.near_plane = float(source.perspective.znear);
        camera.far_plane = float(source.perspective.zfar);
    } else {
        camera.orthographic_height = float(2 * std::abs(source.orthographic.ymag));
        camera.near_plane = float(source.orthographic.znear);
        camera.far_plane = float(source.orthographic.zfar);
    }
    cameras_.push_back({node.camera, is_perspective && source.perspective.zfar == 0, std::move(camera)});
}

// In the file's order, so that its indices name them.
void Loader::finish_cameras() {
    std::ranges::stable_sort(cameras_, {}, &PlacedCamera::source);
    const Bounds bounds = cameras_.empty() ? Bounds{} : world_bounds(scene_);
    for (PlacedCamera& placed : cameras_) {
        Camera& camera = placed.camera;
        if (placed.is_endless) {
            const glm::vec3 reach = bounds.empty() ? glm::vec3(0)
                                                   : glm::max(glm::abs(bounds.min - camera.position),
                                                              glm::abs(bounds.max - camera.position));
            camera.far_plane = std::max({1000.0f, 2 * glm::length(reach), 2 * camera.near_plane});
        }
        scene_.cameras.push_back(std::move(camera));
    }
}

void Loader::add_light(int index, const glm::dmat4& world) {
    const tinygltf::Value& extension = model_.nodes[size_t(index)].extensions.at("KHR_lights_punctual");
    const tinygltf::Light& source = model_.lights[size_t(extension.Get("light").GetNumberAsInt())];
    const glm::dvec3 forward = -glm::dvec3(world[2]);
    Light light;
    light.name = printable(source.name.empty() ? model_.nodes[size_t(index)].name : source.name);
    light.kind = source.type == "point"  ? LightKind::point
                 : source.type == "spot" ? LightKind::spot
                                         : LightKind::directional;
    if (light.kind != LightKind::point) {
        if (!(glm::length(forward) > 0)) {
            warn(node_name(index) + " has a transform that leaves its light no direction: it is left out");
            return;
        }
        light.direction = glm::vec3(glm::normalize(forward));
    }
    light.intensity = vector_of(source.color, glm::vec3(1)) * float(source.intensity) * light_scale_;
    light.position = glm::vec3(world[3]);
    light.range = float(source.range);
    light.inner_cone_angle = float(source.spot.innerConeAngle);
    light.outer_cone_angle = float(source.spot.outerConeAngle);
    if (light.kind == LightKind::spot && light.inner_cone_angle >= light.outer_cone_angle) {
        warn(fmt::format(
            "the light of {} has an inner cone of {} in an outer one of {}: its edge is made sharp",
            node_name(index), light.inner_cone_angle, light.outer_cone_angle));
        light.inner_cone_angle = light.outer_cone_angle;
    }
    scene_.lights.push_back(std::move(light));
}

Result<std::optional<uint32_t>> Loader::mesh(int index) {
    if (const auto found = mesh_indices_.find(index); found != mesh_indices_.end()) return found->second;
    const tinygltf::Mesh& source = model_.meshes[size_t(index)];
    Mesh mesh{.name = printable(source.name)};
    for (size_t i = 0; i < source.primitives.size(); ++i) {
        const tinygltf::Primitive& primitive = source.primitives[i];
        const std::string where = fmt::format("{}.primitives[{}]", named("meshes", index, source.name), i);
        const auto material_index = material(primitive.material);
        if (!material_index) return tl::unexpected(material_index.error());
        const Material& material = scene_.materials[*material_index];
        std::optional<TangentUv> normal_map;
        if (const auto& slot = material.normal_texture)
            normal_map = TangentUv{.uv_set = slot->uv_set, .uv_transform = slot->uv_transform};
        auto added = meshes_.add(primitive, where, normal_map);
        if (!added) return tl::unexpected(added.error());
        if (!*added) continue;
        check_texture_coordinates(primitive, where);
        (*added)->material = *material_index;
        mesh.primitives.push_back(**added);
    }
    std::optional<uint32_t> placed;
    if (!mesh.primitives.empty()) {
        placed = uint32_t(scene_.meshes.size());
        scene_.meshes.push_back(std::move(mesh));
    }
    mesh_indices_.emplace(index, placed);
    return placed;
}

void Loader::check_texture_coordinates(const tinygltf::Primitive& primitive, const std::string& where) {
    if (primitive.material < 0) return;
    const tinygltf::Material& material = model_.materials[size_t(primitive.material)];
    const auto check = [&](const auto& info) {
        const std::string attribute = fmt::format("TEXCOORD_{}", uv_set_of(info));
        if (info.index >= 0 && !primitive.attributes.contains(attribute))
            warn(fmt::format("{} has no {}, which its material's textures need: zeros are used", where,
                             attribute));
    };
    check(material.pbrMetallicRoughness.baseColorTexture);
    check(material.pbrMetallicRoughness.metallicRoughnessTexture);
    check(material.normalTexture);
    check(material.occlusionTexture);
    check(material.emissiveTexture);
}

Result<uint32_t> Loader::material(int index) {
    if (const auto found = material_indices_.find(index); found != material_indices_.end())
        return found->second;
    auto made = make_material(index);
    if (!made) return tl::unexpected(made.error());
    const uint32_t placed = uint32_t(scene_.materials.size());
    scene_.materials.push_back(std::move(*made));
    material_indices_.emplace(index, placed);
    return placed;
}

Result<Material> Loader::make_material(int index) {
    if (index < 0) return Material{.name = "default"};
    const tinygltf::Material& source = model_.materials[size_t(index)];
    const auto& pbr = source.pbrMetallicRoughness;
    const std::string name = named("materials", index, source.name);
    Material material{.name = printable(source.name)};
    material.base_color = vector_of(pbr.baseColorFactor, glm::vec4(1));
    material.metallic = float(pbr.metallicFactor);
    material.roughness = float(pbr.roughnessFactor);
    float strength = light_scale_;
    if (const auto found = source.extensions.find("KHR_materials_emissive_strength");
        found != source.extensions.end())
        strength *= float(number_of(found->second, "emissiveStrength", 1));
    material.emission = vector_of(source.emissiveFactor, glm::vec3(0)) * strength;
    material.normal_scale = float(source.normalTexture.scale);
    material.occlusion_strength = float(source.occlusionTexture.strength);
    material.alpha_mode = source.alphaMode == "MASK"    ? AlphaMode::mask
                          : source.alphaMode == "BLEND" ? AlphaMode::blend
                                                        : AlphaMode::opaque;
    material.alpha_cutoff = float(source.alphaCutoff);
    material.double_sided = source.doubleSided;
    material.unlit = source.extensions.contains("KHR_materials_unlit");

    const auto set = [&](std::optional<TextureSlot>& target, const auto& info,
                         const char* member) -> Result<void> {
        auto found = slot(info, name + "." + member);
        if (!found) return tl::unexpected(found.error());
        target = *found;
        return {};
    };
    for (auto result :
         {set(material.base_color_texture, pbr.baseColorTexture, "baseColorTexture"),
          set(material.metallic_roughness_texture, pbr.metallicRoughnessTexture, "metallicRoughnessTexture"),
          set(material.normal_texture, source.normalTexture, "normalTexture"),
          set(material.occlusion_texture, source.occlusionTexture, "occlusionTexture"),
          set(material.emission_texture, source.emissiveTexture, "emissiveTexture")})
        if (!result) return tl::unexpected(result.error());
    return material;
}

template <class Info>
Result<std::optional<TextureSlot>> Loader::slot(const Info& info, const std::string& where) {
    if (info.index < 0) return std::nullopt;
    const int uv_set = uv_set_of(info);
    TextureSlot slot;
    if (const auto found = info.extensions.find("KHR_texture_transform"); found != info.extensions.end())
        slot.uv_transform = uv_transform_of(found->second);
    if (uv_set > 1) {
        warn(fmt::format("{} reads TEXCOORD_{}, and lumo only 0 and 1: the texture is left out", where,
                         uv_set));
        return std::nullopt;
    }
    slot.uv_set = uint32_t(uv_set);
    const auto index = texture(info.index);
    if (!index) return tl::unexpected(index.error());
    if (!*index) {
        warn(fmt::format("{} has no image that lumo reads: it is left out", where));
        return std::nullopt;
    }
    slot.texture = **index;
    return slot;
}

Result<std::optional<uint32_t>> Loader::texture(int index) {
    if (const auto found = texture_indices_.find(index); found != texture_indices_.end())
        return found->second;
    const tinygltf::Texture& source = model_.textures[size_t(index)];
    std::optional<uint32_t> placed;
    if (source.source >= 0) {
        const auto image_index = image(source.source);
        if (!image_index) return tl::unexpected(image_index.error());
        const Texture texture{.image = *image_index,
                              .sampler = source.sampler >= 0
                                             ? sampler_of(model_.samplers[size_t(source.sampler)])
                                             : TextureSampler{}};
        const auto same = std::ranges::find_if(scene_.textures, [&](const Texture& other) {
            return other.image == texture.image && other.sampler == texture.sampler;
        });
        placed = uint32_t(same - scene_.textures.begin());
        if (same == scene_.textures.end()) scene_.textures.push_back(texture);
    }
    texture_indices_.emplace(index, placed);
    return placed;
}

Result<uint32_t> Loader::image(int index) {
    if (const auto found = image_indices_.find(index); found != image_indices_.end()) return found->second;
    const gltf::ImageSource& source = document_.images[size_t(index)];
    const std::string name = named("images", index, source.name);
    const auto bytes = bytes_.image(size_t(index));
    if (!bytes) return tl::unexpected(bytes.error());
    const ImageLimits limits{.max_side = limits_.images.max_side, .max_bytes = image_bytes_left_};
    auto decoded = decode_image8(*bytes, name, limits);
    if (!decoded) {
        Error error = decoded.error();
        error.message = error.subject + " " + error.message;
        error.subject = document_.file;
        return tl::unexpected(std::move(error));
    }
    const std::string_view actual =
        std::to_integer<uint8_t>((*bytes)[0]) == 0x89 ? "image/png" : "image/jpeg";
    if (!source.mime_type.empty() && source.mime_type != actual)
        warn(
            fmt::format("{} is {}, but its mimeType is '{}'", name, actual, printable(source.mime_type, 60)));
    image_bytes_left_ -= decoded->values.size();
    const uint32_t placed = uint32_t(scene_.images.size());
    scene_.images.push_back(std::move(*decoded));
    image_indices_.emplace(index, placed);
    return placed;
}

// What no node draws harms nothing, but a fault in it is worth a word, as long as that costs little.
void Loader::check_undrawn_meshes() {
    Limits limits = limits_;
    limits.max_vertices = uint64_t(1) << 20;
    limits.max_indices = uint64_t(1) << 22;
    Scene undrawn;
    gltf::MeshBuilder builder(document_, bytes_, limits, undrawn);
    int faults_left = 16;
    for (int index = 0; index < int(model_.meshes.size()); ++index) {
        if (mesh_indices_.contains(index)) continue;
        const tinygltf::Mesh& mesh = model_.meshes[size_t(index)];
        for (size_t i = 0; i < mesh.primitives.size(); ++i) {
            const std::string where = fmt::format("{}.primitives[{}]", named("meshes", index, mesh.name), i);
            const auto added = builder.add(mesh.primitives[i], where, std::nullopt);
            check_texture_coordinates(mesh.primitives[i], where);
            if (added) continue;
            if (added.error().kind == ErrorKind::limit || faults_left-- == 0) return;
            warn(added.error().message + "; no node draws it");
        }
    }
}

void Loader::warn_of_unused_images() {
    const size_t unused = document_.images.size() - image_indices_.size();
    if (unused > 0) warn(fmt::format("{} images are of no material that is drawn and were not read", unused));
}

Result<Scene> load(const std::filesystem::path& file, const Limits& limits, const GltfOptions& options) {
    auto document = gltf::read_document(file, limits);
    if (!document) return tl::unexpected(document.error());
    auto bytes = gltf::Bytes::load(*document, limits);
    if (!bytes) return tl::unexpected(bytes.error());
    if (auto checked = gltf::check_accessors(*document, limits); !checked)
        return tl::unexpected(checked.error());
    gltf::check_values(*document, *bytes);
    return Loader(*document, *bytes, limits, options).load();
}

}  // namespace

Result<Scene> load_gltf(const std::filesystem::path& file, const Limits& limits, const GltfOptions& options) {
    try {
        return load(file, limits, options);
    } catch (const std::bad_alloc&) {
        return fail(ErrorKind::out_of_memory, printable(file.string()), "does not fit into memory",
                    "simplify the scene");
    } catch (const std::exception& exception) {
        return fail(ErrorKind::invalid_file, printable(file.string()),
                    std::string("cannot be read: ") + printable(exception.what()), "export the file again");
    }
}

}  // namespace lumo::scene
