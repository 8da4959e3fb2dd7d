#include "scene/gltf_document.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <string_view>

#include "scene/file.hpp"
#include "scene/gltf_check.hpp"
#include "scene/printable.hpp"

namespace lumo::scene::gltf {
namespace {

using nlohmann::json;

constexpr std::string_view export_again = "export the file again";
constexpr std::array<std::string_view, 5> supported_extensions = {
    "KHR_lights_punctual", "KHR_materials_emissive_strength", "KHR_materials_unlit", "KHR_mesh_quantization",
    "KHR_texture_transform"};

struct Container {
    std::span<const std::byte> json;
    std::optional<std::span<const std::byte>> binary;
};

uint32_t read_u32(std::span<const std::byte> bytes, uint64_t at) {
    uint32_t value = 0;
    for (uint64_t i = 0; i < 4; ++i) value |= std::to_integer<uint32_t>(bytes[at + i]) << (8 * i);
    return value;
}

// glTF 2.0, section 4, "GLB File Format Specification".
Result<Container> read_glb(std::span<const std::byte> bytes, const std::string& file, Warnings& warnings) {
    constexpr uint32_t magic = 0x46546c67, json_type = 0x4e4f534a, binary_type = 0x004e4942;
    constexpr uint64_t header_size = 12, chunk_header_size = 8;
    const auto invalid = [&](std::string message) {
        return fail(ErrorKind::invalid_file, file, std::move(message), std::string(export_again));
    };
    if (bytes.size() < header_size)
        return invalid(fmt::format("has {} bytes, less than a GLB header", bytes.size()));
    if (read_u32(bytes, 0) != magic)
        return invalid(fmt::format("begins with {:#010x}, not GLB's magic", read_u32(bytes, 0)));
    if (read_u32(bytes, 4) != 2)
        return fail(ErrorKind::unsupported, file, fmt::format("is GLB version {}", read_u32(bytes, 4)),
                    "convert it to version 2");
    const uint64_t length = read_u32(bytes, 8);
    if (length > bytes.size())
        return invalid(fmt::format("has {} bytes, but its GLB header says {}", bytes.size(), length));
    if (length < bytes.size())
        warnings.add(fmt::format("{} bytes follow the end of the GLB", bytes.size() - length));

    Container container;
    uint64_t at = header_size;
    for (int number = 0; at < length; ++number) {
        if (length - at < chunk_header_size)
            return invalid(
                fmt::format("GLB chunk {} has {} bytes, less than a chunk header", number, length - at));
        const uint64_t chunk_length = read_u32(bytes, at);
        const uint32_t type = read_u32(bytes, at + 4);
        at += chunk_header_size;
        if (chunk_length > length - at)
            return invalid(
                fmt::format("GLB chunk {} says {} bytes, but {} follow", number, chunk_length, length - at));
        if (chunk_length % 4 != 0)
            warnings.add(fmt::format("GLB chunk {} has {} bytes, not a multiple of 4", number, chunk_length));
        const std::span<const std::byte> chunk = bytes.subspan(at, chunk_length);
        at += chunk_length;
        if ((number == 0) != (type == json_type))
            return invalid(fmt::format("GLB chunk {} has type {:#010x}: the first and no other must be JSON",
                                       number, type));
        if (type == json_type) {
            container.json = chunk;
        } else if (type == binary_type) {
            if (number != 1)
                return invalid(fmt::format("GLB chunk {} is binary: only the second may be", number));
            container.binary = chunk;
        } else {
            warnings.add(
                fmt::format("GLB chunk {} has the unknown type {:#010x} and is ignored", number, type));
        }
    }
    if (container.json.empty()) return invalid("has no JSON in its GLB");
    return container;
}

bool is_glb(const std::filesystem::path& file, std::span<const std::byte> bytes) {
    std::string extension = file.extension().string();
    std::ranges::transform(extension, extension.begin(),
                           [](char c) { return c >= 'A' && c <= 'Z' ? char(c + 32) : c; });
    return extension == ".glb" || (bytes.size() >= 4 && std::memcmp(bytes.data(), "glTF", 4) == 0);
}

struct JsonExtent {
    int64_t depth = 0;   // objects and arrays open at once at most
    int64_t values = 1;  // at least as many as there are
};

// What parsing will cost, without parsing; of text that is not JSON it says something of no use.
JsonExtent json_extent(std::string_view text) {
    JsonExtent extent;
    int64_t open = 0;
    bool in_string = false;
    for (size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (in_string) {
            if (c == '\\') ++i;
            if (c == '"') in_string = false;
            continue;
        }
        if (c == '"') in_string = true;
        if (c == '{' || c == '[') extent.depth = std::max(extent.depth, ++open);
        if (c == '}' || c == ']') --open;
        extent.values += c == ',' || c == '{' || c == '[';
    }
    return extent;
}

Result<json> parse_json(std::span<const std::byte> bytes, const std::string& file, const Limits& limits,
                        Warnings& warnings) {
    if (bytes.size() > limits.max_json_bytes)
        return fail(
            ErrorKind::limit, file,
            fmt::format("has {} bytes of JSON, beyond the limit of {}", bytes.size(), limits.max_json_bytes),
            "keep geometry in binary buffers");
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (text.starts_with("\xef\xbb\xbf")) warnings.add("the JSON begins with a byte order mark");
    const JsonExtent extent = json_extent(text);
    if (extent.depth > int64_t(limits.max_json_depth))
        return fail(ErrorKind::limit, file,
                    fmt::format("nests its JSON {} deep, beyond the limit of {}", extent.depth,
                                limits.max_json_depth),
                    std::string(export_again));
    if (extent.values > int64_t(limits.max_json_values))
        return fail(ErrorKind::limit, file,
                    fmt::format("has {} values in its JSON, beyond the limit of {}", extent.values,
                                limits.max_json_values),
                    "keep geometry in binary buffers");
    try {
        return json::parse(text.begin(), text.end());
    } catch (const json::exception& exception) {
        std::string_view what = exception.what();
        if (const size_t bracket = what.find("] "); bracket != what.npos) what.remove_prefix(bracket + 2);
        return fail(ErrorKind::invalid_file, file, "is not valid JSON: " + printable(what),
                    std::string(export_again));
    }
}

// The member if it is there and is of this type: what is not is found by check_document.
const std::string* string_member(const json& object, std::string_view name) {
    if (!object.is_object()) return nullptr;
    const auto found = object.find(name);
    return found == object.end() ? nullptr : found->get_ptr<const std::string*>();
}

std::vector<std::string> string_list(const json& document, std::string_view name) {
    std::vector<std::string> list;
    if (!document.is_object() || !document.contains(name)) return list;
    for (const json& entry : document[std::string(name)])
        if (entry.is_string()) list.push_back(entry.get<std::string>());
    return list;
}

struct Version {
    uint32_t major = 0, minor = 0;
};

std::optional<Version> parse_version(std::string_view text) {
    Version version;
    const auto major = std::from_chars(text.begin(), text.end(), version.major);
    if (major.ec != std::errc() || major.ptr == text.end() || *major.ptr != '.') return std::nullopt;
    const auto minor = std::from_chars(major.ptr + 1, text.end(), version.minor);
    if (minor.ec != std::errc() || minor.ptr != text.end()) return std::nullopt;
    return version;
}

Result<void> check_version(const json& document, const std::string& file, Warnings& warnings) {
    if (!document.is_object() || !document.contains("asset")) return {};
    const json& asset = document["asset"];
    for (const std::string_view member : {"version", "minVersion"}) {
        const std::string* text = string_member(asset, member);
        if (!text) continue;
        const std::string named = fmt::format("asset.{} is '{}'", member, printable(*text, 40));
        const auto version = parse_version(*text);
        if (!version)
            return fail(ErrorKind::invalid_file, file, named + ", not two numbers",
                        std::string(export_again));
        if (version->major != 2 || (member == "minVersion" && version->minor > 0))
            return fail(ErrorKind::unsupported, file, named + "; lumo reads 2.0", "convert it to glTF 2.0");
        if (version->minor > 0) warnings.add(named + "; it is read as 2.0");
    }
    return {};
}

Result<void> check_extensions(const json& document, const std::string& file, Warnings& warnings) {
    const auto lacking = [](const std::string& name) {
        return std::ranges::find(supported_extensions, std::string_view(name)) == supported_extensions.end();
    };
    const std::vector<std::string> used = string_list(document, "extensionsUsed");
    for (const std::string& name : string_list(document, "extensionsRequired")) {
        if (lacking(name))
            return fail(
                ErrorKind::unsupported, file,
                fmt::format("requires the extension {}, which lumo does not have", printable(name, 80)),
                fmt::format("export it with no more than {}", fmt::join(supported_extensions, ", ")));
        if (std::ranges::find(used, name) == used.end())
            warnings.add(
                fmt::format("extension {} is required but not in extensionsUsed", printable(name, 80)));
    }
    for (auto name = used.begin(); name != used.end(); ++name) {
        if (lacking(*name))
            warnings.add(fmt::format("extension {} is used, which lumo does not have: it is ignored",
                                     printable(*name, 80)));
        if (std::find(used.begin(), name, *name) != name)
            warnings.add(fmt::format("extension {} is named twice in extensionsUsed", printable(*name, 80)));
    }
    return {};
}

std::vector<BufferSource> take_buffers(const json& document) {
    std::vector<BufferSource> buffers;
    if (!document.contains("buffers")) return buffers;
    for (const json& entry : document["buffers"]) {
        BufferSource buffer{.uri = {}, .byte_length = entry["byteLength"].get<uint64_t>()};
        if (const std::string* uri = string_member(entry, "uri")) buffer.uri = *uri;
        buffers.push_back(std::move(buffer));
    }
    return buffers;
}

std::vector<ImageSource> take_images(const json& document) {
    std::vector<ImageSource> images;
    if (!document.contains("images")) return images;
    for (const json& entry : document["images"]) {
        ImageSource image;
        image.name = entry.value("name", "");
        image.mime_type = entry.value("mimeType", "");
        image.buffer_view = entry.value("bufferView", -1);
        if (const std::string* uri = string_member(entry, "uri")) image.uri = *uri;
        images.push_back(std::move(image));
    }
    return images;
}

Result<tinygltf::Model> parse_model(json document, const std::string& file) {
    for (const char* member : {"buffers", "images"}) document.erase(member);
    // tinygltf refuses indices whose accessor has no buffer view, which glTF reads as zeros: they get one,
    // and lose it again below.
    json& views = document["bufferViews"];
    const size_t view_count = views.size();
    views.push_back({{"buffer", 0}, {"byteLength", 1}});
    if (document.contains("accessors"))
        for (json& accessor : document["accessors"])
            if (!accessor.contains("bufferView")) accessor["bufferView"] = view_count;

    tinygltf::Model model;
    tinygltf::TinyGLTF parser;
    std::string errors, ignored;
    const std::string text = document.dump();
    document = nullptr;  // tinygltf is about to make its own
    if (!parser.LoadASCIIFromString(&model, &errors, &ignored, text.c_str(), unsigned(text.size()), "",
                                    tinygltf::NO_REQUIRE))
        return fail(ErrorKind::invalid_file, file, "cannot be parsed: " + printable(errors),
                    std::string(export_again));
    model.bufferViews.pop_back();
    for (tinygltf::Accessor& accessor : model.accessors)
        if (accessor.bufferView == int(view_count)) accessor.bufferView = -1;
    return model;
}

}  // namespace

Result<Document> read_document(const std::filesystem::path& file, const Limits& limits) {
    Document document;
    document.file = printable(file.string());
    const bool may_be_glb = file.extension() != ".gltf";
    auto bytes = read_file(file, may_be_glb ? limits.max_buffer_bytes : limits.max_json_bytes);
    if (!bytes) return tl::unexpected(bytes.error());
    document.bytes = std::move(*bytes);
    document.folder = file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");

    Container container{.json = document.bytes, .binary = {}};
    if (is_glb(file, document.bytes)) {
        auto glb = read_glb(document.bytes, document.file, document.warnings);
        if (!glb) return tl::unexpected(glb.error());
        container = *glb;
    }
    document.binary_chunk = container.binary;

    auto parsed = parse_json(container.json, document.file, limits, document.warnings);
    if (!parsed) return tl::unexpected(parsed.error());
    for (const auto check : {check_version, check_extensions})
        if (auto checked = check(*parsed, document.file, document.warnings); !checked)
            return tl::unexpected(checked.error());
    if (auto checked = check_document(*parsed, document.file, limits, document.warnings); !checked)
        return tl::unexpected(checked.error());
    document.buffers = take_buffers(*parsed);
    document.images = take_images(*parsed);
    auto model = parse_model(std::move(*parsed), document.file);
    if (!model) return tl::unexpected(model.error());
    document.model = std::move(*model);
    return document;
}

}  // namespace lumo::scene::gltf
