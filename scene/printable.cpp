#include "scene/printable.hpp"

#include <cstdint>

namespace lumo::scene {
namespace {

struct Decoded {
    uint32_t code = 0;
    size_t size = 0;  // 0 where the bytes are not UTF-8
};

Decoded decode_utf8(std::string_view text) {
    const auto byte = [&](size_t i) { return uint32_t(uint8_t(text[i])); };
    const uint32_t first = byte(0);
    if (first < 0x80) return {first, 1};
    const size_t size = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
    if (first < 0xc2 || first > 0xf4 || text.size() < size) return {};
    uint32_t code = first & (0xffu >> (size + 1));
    for (size_t i = 1; i < size; ++i) {
        if ((byte(i) & 0xc0) != 0x80) return {};
        code = code << 6 | (byte(i) & 0x3f);
    }
    constexpr uint32_t smallest[] = {0, 0, 0x80, 0x800, 0x10000};
    const bool surrogate = code >= 0xd800 && code < 0xe000;
    if (code < smallest[size] || code > 0x10ffff || surrogate) return {};
    return {code, size};
}

bool is_shown(uint32_t code) {
    const bool control = code < 0x20 || (code >= 0x7f && code < 0xa0);
    const bool line_break = code == 0x2028 || code == 0x2029;
    const bool direction = code == 0x61c || code == 0x200e || code == 0x200f ||
                           (code >= 0x202a && code <= 0x202e) || (code >= 0x2066 && code <= 0x2069);
    return !control && !line_break && !direction;
}

}  // namespace

std::string printable(std::string_view text, size_t max_bytes) {
    std::string shown;
    while (!text.empty()) {
        const Decoded next = decode_utf8(text);
        const size_t size = next.size ? next.size : 1;
        if (shown.size() + size > max_bytes) return shown + "…";
        if (next.size && is_shown(next.code))
            shown += text.substr(0, size);
        else
            shown += '?';
        text.remove_prefix(size);
    }
    return shown;
}

}  // namespace lumo::scene
