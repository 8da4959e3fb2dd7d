// Names: of files, and of what scenes hold.
#pragma once

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fmt/format.h>
#include <string>
#include <string_view>

#include "scene/scene.hpp"

namespace lumo::program {

/// In lower case, with its dot.
inline std::string extension_of(const std::filesystem::path& file) {
    std::string extension = file.extension().string();
    std::ranges::transform(extension, extension.begin(),
                           [](unsigned char c) { return char(std::tolower(c)); });
    return extension;
}

/// NAME.EXT as NAME.TAG.EXT; itself without a tag.
inline std::filesystem::path tagged(const std::filesystem::path& file, std::string_view tag) {
    if (tag.empty()) return file;
    std::filesystem::path name = file.stem();
    name += fmt::format(".{}", tag);
    name += file.extension();
    return file.parent_path() / name;
}

/// As a shell takes it: quoted where it has to be.
inline std::string shell_argument(const std::string& text) {
    constexpr std::string_view plain =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_=+,.:/";
    if (!text.empty() && text.find_first_not_of(plain) == std::string::npos) return text;
    std::string quoted = "'";
    for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return quoted + "'";
}

inline std::string_view to_string(scene::LightKind kind) {
    switch (kind) {
        case scene::LightKind::directional:
            return "directional";
        case scene::LightKind::point:
            return "point";
        case scene::LightKind::spot:
            break;
    }
    return "spot";
}

inline std::string_view to_string(scene::AlphaMode mode) {
    switch (mode) {
        case scene::AlphaMode::opaque:
            return "OPAQUE";
        case scene::AlphaMode::mask:
            return "MASK";
        case scene::AlphaMode::blend:
            break;
    }
    return "BLEND";
}

}  // namespace lumo::program
