#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>
#include <optional>

#include "samples/lumo/commands.hpp"
#include "samples/lumo/input.hpp"
#include "samples/lumo/names.hpp"
#include "scene/printable.hpp"
#include "techniques/frame/plan.hpp"

namespace lumo::program {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const glm::vec3& v) { return {v.x, v.y, v.z}; }

uint64_t primitive_count(const scene::Scene& scene) {
    uint64_t count = 0;
    for (const scene::Mesh& mesh : scene.meshes) count += mesh.primitives.size();
    return count;
}

Json counts_of(const scene::Scene& scene) {
    return {{"triangles", scene.triangle_count()}, {"vertices", scene.vertices.size()},
            {"meshes", scene.meshes.size()},       {"primitives", primitive_count(scene)},
            {"instances", scene.instances.size()}, {"materials", scene.materials.size()},
            {"textures", scene.textures.size()},   {"images", scene.images.size()},
            {"lights", scene.lights.size()},       {"cameras", scene.cameras.size()}};
}

Json material_of(const scene::Material& material, const scene::Scene& scene) {
    Json textures = Json::object();
    const auto texture = [&](const char* role, const std::optional<scene::TextureSlot>& slot) {
        if (slot) textures[role] = scene.textures[slot->texture].image;
    };
    texture("base_color", material.base_color_texture);
    texture("metallic_roughness", material.metallic_roughness_texture);
    texture("normal", material.normal_texture);
    texture("occlusion", material.occlusion_texture);
    texture("emission", material.emission_texture);

    Json json{{"name", material.name},
              {"alpha_mode", to_string(material.alpha_mode)},
              {"double_sided", material.double_sided},
              {"unlit", material.unlit},
              {"base_color",
               {material.base_color.r, material.base_color.g, material.base_color.b, material.base_color.a}},
              {"metallic", material.metallic},
              {"roughness", material.roughness},
              {"emission", to_json(material.emission)},
              {"images", textures}};
    if (material.alpha_mode == scene::AlphaMode::mask) json["alpha_cutoff"] = material.alpha_cutoff;
    return json;
}

Json light_of(const scene::Light& light) {
    Json json{{"name", light.name}, {"kind", to_string(light.kind)}, {"intensity", to_json(light.intensity)}};
    if (light.kind != scene::LightKind::point) json["direction"] = to_json(light.direction);
    if (light.kind != scene::LightKind::directional) json["position"] = to_json(light.position);
    return json;
}

Json camera_of(const scene::Camera& camera) {
    Json json{
        {"name", camera.name}, {"position", to_json(camera.position)}, {"target", to_json(camera.target)}};
    if (camera.orthographic_height)
        json["orthographic_height"] = *camera.orthographic_height;
    else
        json["vertical_fov"] = glm::degrees(camera.vertical_fov);
    return json;
}

Json plan_of(const frame::Plan& plan) {
    Json needed = Json::array(), left_out = Json::array();
    for (const frame::PlanItem& item : plan.items)
        (item.needed ? needed : left_out).push_back({{"what", item.what}, {"why", item.why}});
    return {{"needed", needed}, {"left_out", left_out}};
}

Json report_of(const Options& options, const scene::Scene& scene, const frame::Plan& plan) {
    Json json{{"scene", options.scene}, {"counts", counts_of(scene)}, {"bounds", nullptr}};
    if (const scene::Bounds bounds = world_bounds(scene); !bounds.empty())
        json["bounds"] = {{"min", to_json(bounds.min)}, {"max", to_json(bounds.max)}};
    json["environment_radiance"] = to_json(scene.environment_radiance);
    json["sky"] = nullptr;
    if (scene.sky)
        json["sky"] = {{"direction_to_sun", to_json(scene.sky->direction_to_sun)},
                       {"altitude_km", scene.sky->altitude_km},
                       {"wavelengths_nm", scene.sky->atmosphere.wavelengths_nm}};
    json["materials"] = Json::array();
    for (const scene::Material& material : scene.materials)
        json["materials"].push_back(material_of(material, scene));
    json["images"] = Json::array();
    for (const scene::Image8& image : scene.images)
        json["images"].push_back({{"width", image.width}, {"height", image.height}});
    json["lights"] = Json::array();
    for (const scene::Light& light : scene.lights) json["lights"].push_back(light_of(light));
    json["cameras"] = Json::array();
    for (const scene::Camera& camera : scene.cameras) json["cameras"].push_back(camera_of(camera));
    json["warnings"] = warnings_of(scene);
    json["plan"] = plan_of(plan);
    return json;
}

std::string text_of(const glm::vec3& v) { return fmt::format("({:.4g}, {:.4g}, {:.4g})", v.x, v.y, v.z); }

std::string name_of(const std::string& name) { return name.empty() ? "(no name)" : scene::printable(name); }

std::string text_of(const scene::Material& material, const scene::Scene& scene) {
    std::string text = fmt::format("{}: {}", name_of(material.name), to_string(material.alpha_mode));
    if (material.alpha_mode == scene::AlphaMode::mask) text += fmt::format(" at {:g}", material.alpha_cutoff);
    if (material.double_sided) text += ", double-sided";
    if (material.unlit) text += ", unlit";
    if (material.emits()) text += ", emits " + text_of(material.emission) + " W/m²/sr";
    const auto texture = [&](const char* role, const std::optional<scene::TextureSlot>& slot) {
        if (slot) text += fmt::format(", {} {}", role, scene.textures[slot->texture].image);
    };
    texture("base colour", material.base_color_texture);
    texture("metallic-roughness", material.metallic_roughness_texture);
    texture("normal", material.normal_texture);
    texture("occlusion", material.occlusion_texture);
    texture("emission", material.emission_texture);
    return text;
}

std::string text_of(const scene::Light& light) {
    const bool directional = light.kind == scene::LightKind::directional;
    std::string text = fmt::format("{}: {}, {} {}", name_of(light.name), to_string(light.kind),
                                   text_of(light.intensity), directional ? "W/m²" : "W/sr");
    if (light.kind != scene::LightKind::point) text += ", travels " + text_of(light.direction);
    if (!directional) text += ", at " + text_of(light.position);
    return text;
}

std::string text_of(const scene::Camera& camera) {
    return fmt::format(
        "{}: at {} toward {}, {}", name_of(camera.name), text_of(camera.position), text_of(camera.target),
        camera.orthographic_height ? fmt::format("orthographic, {:.4g} m high", *camera.orthographic_height)
                                   : fmt::format("{:.4g} degrees", glm::degrees(camera.vertical_fov)));
}

/// A heading and a numbered line for each; nothing for none.
template <class T>
void print_list(const char* heading, const std::vector<T>& list, auto&& text) {
    if (list.empty()) return;
    fmt::print("\n{}\n", heading);
    for (size_t i = 0; i < list.size(); ++i) fmt::print("  {:>3}  {}\n", i, text(list[i]));
}

void print_report(const Options& options, const scene::Scene& scene, const frame::Plan& plan) {
    fmt::print("{}\n", scene::printable(options.scene));
    const Json counts = counts_of(scene);
    for (const auto& [name, count] : counts.items())
        fmt::print("  {:<12}{:>10}\n", name, count.get<uint64_t>());
    if (const scene::Bounds bounds = world_bounds(scene); !bounds.empty())
        fmt::print("  bounds      {} to {} m\n", text_of(bounds.min), text_of(bounds.max));
    if (scene.environment_radiance != glm::vec3(0))
        fmt::print("  environment {} W/m²/sr\n", text_of(scene.environment_radiance));

    if (scene.sky)
        fmt::print("  sky         sun toward {}, {:.4g} km above the planet's ground\n",
                   text_of(scene.sky->direction_to_sun), scene.sky->altitude_km);

    print_list("materials (numbers are images)", scene.materials,
               [&](const scene::Material& material) { return text_of(material, scene); });
    print_list("images", scene.images,
               [](const scene::Image8& image) { return fmt::format("{}x{}", image.width, image.height); });
    print_list("lights", scene.lights, [](const scene::Light& light) { return text_of(light); });
    print_list("cameras", scene.cameras, [](const scene::Camera& camera) { return text_of(camera); });
    print_list("warnings", warnings_of(scene), [](const std::string& line) { return line; });
    fmt::print("\na frame\n{}", to_text(plan));
}

}  // namespace

Result<int> check(const Options& options) {
    const auto scene = load_scene(options);
    if (!scene) return tl::unexpected(scene.error());
    const frame::SceneFacts facts = examine(*scene, options.frame);
    const frame::Plan plan = make_plan(facts, resolve(options.frame, facts));
    if (options.json)
        fmt::print(
            "{}\n",
            report_of(options, *scene, plan).dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
    else
        print_report(options, *scene, plan);
    return exit_done;
}

}  // namespace lumo::program
