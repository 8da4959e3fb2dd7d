#include "scene/gltf_check.hpp"

#include <cfloat>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <set>
#include <string_view>
#include <vector>

#include "scene/printable.hpp"

namespace lumo::scene::gltf {
namespace {

using nlohmann::json;

constexpr double largest_int = 2147483647;         // what tinygltf keeps in an int
constexpr double largest_size = 9007199254740992;  // 2^53: exact as a double

enum class Kind { object, map, array, index, integer, number, boolean, string };

struct Member;

struct Shape {
    Kind kind = Kind::object;
    double min = -FLT_MAX;
    double max = FLT_MAX;
    double step = 0;                           // of which a number is a multiple, where not 0
    bool clamp = false;                        // a number outside its range is a warning
    std::string_view into = {};                // an index's array, as a JSON pointer
    std::vector<double> codes = {};            // the integers allowed, where not empty
    std::vector<std::string_view> words = {};  // the strings allowed, where not empty
    size_t count = 0;                          // of an array's elements, where fixed
    std::vector<Shape> element = {};           // one, of an array or map
    std::vector<Member> members = {};          // of an object
    // Pairs of an object's members: the first must not be without the second, or not with it.
    std::vector<std::pair<std::string_view, std::string_view>> needs = {};
    std::vector<std::pair<std::string_view, std::string_view>> exclusive = {};
};

struct Member {
    std::string_view name;
    Shape shape;
    bool required = false;
};

constexpr bool required = true;

Shape object(std::vector<Member> members) { return {.members = std::move(members)}; }
Shape list(Shape element) { return {.kind = Kind::array, .element = {std::move(element)}}; }
Shape map_of(Shape element) { return {.kind = Kind::map, .element = {std::move(element)}}; }
Shape index(std::string_view into) {
    return {.kind = Kind::index, .min = 0, .max = largest_int, .into = into};
}
Shape integer(double min, double max = largest_int) {
    return {.kind = Kind::integer, .min = min, .max = max};
}
Shape one_of(std::vector<double> codes) { return {.kind = Kind::integer, .codes = std::move(codes)}; }
Shape one_of_words(std::vector<std::string_view> words) {
    return {.kind = Kind::string, .words = std::move(words)};
}
Shape number(double min = -FLT_MAX, double max = FLT_MAX) {
    return {.kind = Kind::number, .min = min, .max = max};
}
Shape factor(double min, double max) { return {.kind = Kind::number, .min = min, .max = max, .clamp = true}; }
Shape numbers(size_t count, Shape element = number()) {
    return {.kind = Kind::array, .count = count, .element = {std::move(element)}};
}
Shape boolean() { return {.kind = Kind::boolean}; }
Shape text() { return {.kind = Kind::string}; }

// glTF 2.0, appendix "JSON Schema Reference", and the schemas of the extensions that lumo has. animations,
// skins and morph targets are not drawn and not looked into.
Shape document_shape() {
    const Shape texture_transform = object(
        {{"offset", numbers(2)}, {"rotation", number()}, {"scale", numbers(2)}, {"texCoord", integer(0)}});
    const auto texture_info = [&](std::vector<Member> more = {}) {
        std::vector<Member> members = {
            {"index", index("/textures"), required},
            {"texCoord", integer(0)},
            {"extensions", object({{"KHR_texture_transform", texture_transform}})}};
        members.insert(members.end(), more.begin(), more.end());
        return object(std::move(members));
    };
    const Shape sparse_indices = object({{"bufferView", index("/bufferViews"), required},
                                         {"byteOffset", integer(0)},
                                         {"componentType", one_of({5121, 5123, 5125}), required}});
    const Shape sparse_values =
        object({{"bufferView", index("/bufferViews"), required}, {"byteOffset", integer(0)}});
    const Shape sparse = object({{"count", integer(1), required},
                                 {"indices", sparse_indices, required},
                                 {"values", sparse_values, required}});
    Shape accessor = object({
        {"name", text()},
        {"bufferView", index("/bufferViews")},
        {"byteOffset", integer(0, largest_size)},
        {"componentType", one_of({5120, 5121, 5122, 5123, 5125, 5126}), required},
        {"normalized", boolean()},
        {"count", integer(1, largest_size), required},
        {"type", one_of_words({"SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"}), required},
        {"min", list(number())},
        {"max", list(number())},
        {"sparse", sparse},
    });
    accessor.needs = {{"byteOffset", "bufferView"}};
    const Shape buffer =
        object({{"name", text()}, {"uri", text()}, {"byteLength", integer(1, largest_size), required}});
    Shape byte_stride = integer(4, 252);
    byte_stride.step = 4;
    const Shape buffer_view = object({
        {"name", text()},
        {"buffer", index("/buffers"), required},
        {"byteOffset", integer(0, largest_size)},
        {"byteLength", integer(1, largest_size), required},
        {"byteStride", byte_stride},
        {"target", one_of({34962, 34963})},
    });
    Shape image = object(
        {{"name", text()}, {"uri", text()}, {"mimeType", text()}, {"bufferView", index("/bufferViews")}});
    image.needs = {{"bufferView", "mimeType"}};
    image.exclusive = {{"uri", "bufferView"}};
    const Shape texture =
        object({{"name", text()}, {"sampler", index("/samplers")}, {"source", index("/images")}});
    const Shape sampler = object({
        {"name", text()},
        {"magFilter", one_of({9728, 9729})},
        {"minFilter", one_of({9728, 9729, 9984, 9985, 9986, 9987})},
        {"wrapS", one_of({33071, 33648, 10497})},
        {"wrapT", one_of({33071, 33648, 10497})},
    });
    const Shape unit = factor(0, 1);
    const Shape metallic_roughness = object({
        {"baseColorFactor", numbers(4, unit)},
        {"baseColorTexture", texture_info()},
        {"metallicFactor", unit},
        {"roughnessFactor", unit},
        {"metallicRoughnessTexture", texture_info()},
    });
    const Shape material = object({
        {"name", text()},
        {"pbrMetallicRoughness", metallic_roughness},
        {"normalTexture", texture_info({{"scale", number()}})},
        {"occlusionTexture", texture_info({{"strength", unit}})},
        {"emissiveTexture", texture_info()},
        {"emissiveFactor", numbers(3, unit)},
        {"alphaMode", one_of_words({"OPAQUE", "MASK", "BLEND"})},
        {"alphaCutoff", factor(0, FLT_MAX)},
        {"doubleSided", boolean()},
        {"extensions",
         object({{"KHR_materials_unlit", object({})},
                 {"KHR_materials_emissive_strength", object({{"emissiveStrength", factor(0, FLT_MAX)}})}})},
    });
    const Shape primitive = object({
        {"attributes", map_of(index("/accessors")), required},
        {"indices", index("/accessors")},
        {"material", index("/materials")},
        {"mode", integer(0, 6)},
    });
    const Shape mesh = object({{"name", text()}, {"primitives", list(primitive), required}});
    Shape node = object({
        {"name", text()},
        {"camera", index("/cameras")},
        {"children", list(index("/nodes"))},
        {"skin", index("/skins")},
        {"matrix", numbers(16)},
        {"mesh", index("/meshes")},
        {"rotation", numbers(4)},
        {"scale", numbers(3)},
        {"translation", numbers(3)},
        {"extensions",
         object({{"KHR_lights_punctual",
                  object({{"light", index("/extensions/KHR_lights_punctual/lights"), required}})}})},
    });
    node.needs = {{"skin", "mesh"}, {"weights", "mesh"}};
    node.exclusive = {{"matrix", "translation"}, {"matrix", "rotation"}, {"matrix", "scale"}};
    const Shape perspective = object({{"aspectRatio", number()},
                                      {"yfov", number(), required},
                                      {"zfar", number()},
                                      {"znear", number(), required}});
    const Shape orthographic = object({{"xmag", number(), required},
                                       {"ymag", number(), required},
                                       {"zfar", number(), required},
                                       {"znear", number(), required}});
    Shape camera = object({{"name", text()},
                           {"type", one_of_words({"perspective", "orthographic"}), required},
                           {"perspective", perspective},
                           {"orthographic", orthographic}});
    camera.exclusive = {{"perspective", "orthographic"}};
    constexpr double right_angle = std::numbers::pi / 2;
    const Shape light = object({
        {"name", text()},
        {"type", one_of_words({"directional", "point", "spot"}), required},
        {"color", numbers(3, factor(0, FLT_MAX))},
        {"intensity", factor(0, FLT_MAX)},
        {"range", factor(0, FLT_MAX)},
        {"spot",
         object({{"innerConeAngle", factor(0, right_angle)}, {"outerConeAngle", factor(0, right_angle)}})},
    });
    return object({
        {"asset",
         object({{"version", text(), required},
                 {"minVersion", text()},
                 {"generator", text()},
                 {"copyright", text()}}),
         required},
        {"scene", index("/scenes")},
        {"scenes", list(object({{"name", text()}, {"nodes", list(index("/nodes"))}}))},
        {"nodes", list(node)},
        {"meshes", list(mesh)},
        {"accessors", list(accessor)},
        {"bufferViews", list(buffer_view)},
        {"buffers", list(buffer)},
        {"materials", list(material)},
        {"textures", list(texture)},
        {"images", list(image)},
        {"samplers", list(sampler)},
        {"cameras", list(camera)},
        {"extensionsUsed", list(text())},
        {"extensionsRequired", list(text())},
        {"extensions", object({{"KHR_lights_punctual", object({{"lights", list(light), required}})}})},
    });
}

std::string type_name(const json& value) {
    if (value.is_object()) return "an object";
    if (value.is_array()) return "an array";
    if (value.is_string()) return "the string '" + printable(value.get_ref<const std::string&>(), 40) + "'";
    return value.dump();
}

class Checker {
  public:
    Checker(const json& document, Warnings& warnings) : warnings_(warnings) {
        for (const auto& item : document.items())
            if (item.value().is_array()) sizes_["/" + item.key()] = item.value().size();
        const json::json_pointer lights("/extensions/KHR_lights_punctual/lights");
        if (document.contains(lights) && document.at(lights).is_array())
            sizes_[lights.to_string()] = document.at(lights).size();
        const auto used = document.find("extensionsUsed");
        if (used == document.end() || !used->is_array()) return;
        for (const json& name : *used)
            if (name.is_string()) declared_.insert(name.get<std::string>());
    }

    const std::map<std::string, size_t, std::less<>>& array_sizes() const { return sizes_; }

    // What is wrong, if anything; then path_ says where.
    std::optional<std::string> check(json& value, const Shape& shape) {
        switch (shape.kind) {
            case Kind::object:
                return check_object(value, shape);
            case Kind::map:
                return check_map(value, shape);
            case Kind::array:
                return check_array(value, shape);
            case Kind::index:
            case Kind::integer:
                return check_integer(value, shape);
            case Kind::number:
                return check_number(value, shape);
            case Kind::boolean:
                if (!value.is_boolean()) return "is " + type_name(value) + ", not true or false";
                return std::nullopt;
            case Kind::string:
                return check_string(value, shape);
        }
        return std::nullopt;
    }

    std::string path() const { return path_.empty() ? "the document" : printable(path_); }

  private:
    std::optional<std::string> check_object(json& value, const Shape& shape) {
        if (!value.is_object()) return "is " + type_name(value) + ", not an object";
        const bool extensions = path_.ends_with("extensions");
        for (const auto& [one, other] : shape.needs)
            if (value.contains(one) && !value.contains(other))
                warnings_.add(fmt::format("{} has {} without {}", path(), one, other));
        for (const auto& [one, other] : shape.exclusive)
            if (value.contains(one) && value.contains(other))
                warnings_.add(fmt::format("{} has both {} and {}; only {} counts", path(), one, other, one));
        for (const Member& member : shape.members)
            if (member.required && !value.contains(member.name))
                return fmt::format("lacks '{}', which it must have", member.name);
        for (auto item = value.begin(); item != value.end();) {
            const size_t length = path_.size();
            const std::string& name = item.key();
            enter(name);
            const auto member = std::ranges::find(shape.members, std::string_view(name), &Member::name);
            if (extensions && !declared_.contains(name))
                warnings_.add(path() + " is not declared in extensionsUsed");
            if (member == shape.members.end()) {
                if (name == "extensions")
                    warn_of_undeclared(*item);
                else if (!extensions && name != "extras")
                    warn_of_unknown(name);
                item = value.erase(item);
            } else {
                if (auto wrong = check(*item, member->shape)) return wrong;
                ++item;
            }
            path_.resize(length);
        }
        return std::nullopt;
    }

    std::optional<std::string> check_map(json& value, const Shape& shape) {
        if (!value.is_object()) return "is " + type_name(value) + ", not an object";
        for (auto item = value.begin(); item != value.end(); ++item) {
            const size_t length = path_.size();
            enter(item.key());
            if (auto wrong = check(*item, shape.element[0])) return wrong;
            path_.resize(length);
        }
        return std::nullopt;
    }

    std::optional<std::string> check_array(json& value, const Shape& shape) {
        if (!value.is_array()) return "is " + type_name(value) + ", not an array";
        if (shape.count > 0 && value.size() != shape.count)
            return fmt::format("has {} elements, not {}", value.size(), shape.count);
        if (value.empty()) warnings_.add(path() + " is empty");
        for (size_t i = 0; i < value.size(); ++i) {
            const size_t length = path_.size();
            path_ += fmt::format("[{}]", i);
            if (auto wrong = check(value[i], shape.element[0])) return wrong;
            path_.resize(length);
        }
        return std::nullopt;
    }

    std::optional<std::string> check_integer(json& value, const Shape& shape) {
        if (!value.is_number()) return "is " + type_name(value) + ", not an integer";
        const double number = value.get<double>();
        if (number != std::floor(number)) return fmt::format("is {}, not an integer", number);
        if (!shape.codes.empty()) {
            if (std::ranges::find(shape.codes, number) == shape.codes.end())
                return fmt::format("is {}, not one of {}", number, fmt::join(shape.codes, ", "));
        } else if (number < shape.min || number > shape.max) {
            return fmt::format("is {}, not within {} and {}", number, shape.min, shape.max);
        }
        if (shape.step > 0 && std::fmod(number, shape.step) != 0)
            return fmt::format("is {}, not a multiple of {}", number, shape.step);
        if (shape.kind == Kind::index) {
            const auto array = sizes_.find(shape.into);
            const size_t size = array == sizes_.end() ? 0 : array->second;
            if (number >= double(size))
                return fmt::format("is {}, but there are {} in {}", number, size, shape.into.substr(1));
        }
        if (!value.is_number_integer()) value = int64_t(number);
        return std::nullopt;
    }

    std::optional<std::string> check_number(json& value, const Shape& shape) {
        if (!value.is_number()) return "is " + type_name(value) + ", not a number";
        const double number = value.get<double>();
        if (number >= shape.min && number <= shape.max) return std::nullopt;
        const std::string wrong = fmt::format("is {}, not within {} and {}", number, shape.min, shape.max);
        if (!shape.clamp) return wrong;
        warnings_.add(path() + " " + wrong + "; clamped");
        value = std::clamp(number, shape.min, shape.max);
        return std::nullopt;
    }

    std::optional<std::string> check_string(const json& value, const Shape& shape) {
        if (!value.is_string()) return "is " + type_name(value) + ", not a string";
        const auto& word = value.get_ref<const std::string&>();
        if (!shape.words.empty() &&
            std::ranges::find(shape.words, std::string_view(word)) == shape.words.end())
            return fmt::format("is '{}', not one of {}", printable(word, 40), fmt::join(shape.words, ", "));
        return std::nullopt;
    }

    void enter(const std::string& name) {
        if (!path_.empty()) path_ += '.';
        path_ += printable(name, 80);
    }

    void warn_of_unknown(const std::string& name) {
        if (name == "animations")
            warnings_.add("animations are not played: everything stands at rest");
        else if (name == "targets")
            warnings_.add(path() + ": morph targets are not drawn: the mesh stands at rest");
        else if (name == "skins")
            warnings_.add("skins are not applied: everything stands at rest");
        else if (name != "weights")
            warnings_.add(path() + " is not in glTF 2.0 and is ignored");
    }

    void warn_of_undeclared(const json& extensions) {
        if (!extensions.is_object()) {
            warnings_.add(path() + " is not an object and is ignored");
            return;
        }
        for (const auto& item : extensions.items())
            if (!declared_.contains(item.key()))
                warnings_.add(fmt::format("{}.{} is not declared in extensionsUsed", path(),
                                          printable(item.key(), 80)));
    }

    Warnings& warnings_;
    std::map<std::string, size_t, std::less<>> sizes_;  // of the arrays that indices point into
    std::set<std::string> declared_;
    std::string path_;
};

}  // namespace

Result<void> check_document(json& document, const std::string& file, const Limits& limits,
                            Warnings& warnings) {
    if (!document.is_object())
        return fail(ErrorKind::invalid_file, file,
                    "the document is " + type_name(document) + ", not an object", "export the file again");
    Checker checker(document, warnings);
    for (const auto& [name, size] : checker.array_sizes()) {
        const size_t limit = name == "/nodes" ? limits.max_nodes : limits.max_objects;
        if (size > limit)
            return fail(ErrorKind::limit, file,
                        fmt::format("{} has {} entries, beyond the limit of {}", printable(name.substr(1)),
                                    size, limit),
                        "split the file");
    }
    static const Shape shape = document_shape();
    if (const auto wrong = checker.check(document, shape))
        return fail(ErrorKind::invalid_file, file, checker.path() + " " + *wrong, "export the file again");
    return {};
}

}  // namespace lumo::scene::gltf
