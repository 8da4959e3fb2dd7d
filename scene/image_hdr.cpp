// Radiance's RGBE pictures (G. Ward, "Real Pixels", Graphics Gems II; the layout as in Radiance's color.c and header.c).
#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

#include "scene/image_codec.hpp"

namespace lumo::scene::codec {
namespace {

// The part of the file that is not read yet.
class Input {
  public:
    explicit Input(std::span<const std::byte> bytes)
        : rest_(reinterpret_cast<const char*>(bytes.data()), bytes.size()) {}

    std::optional<std::string_view> line() {
        const size_t end = rest_.find('\n');
        if (end == std::string_view::npos) return std::nullopt;
        const std::string_view text = rest_.substr(0, end);
        rest_.remove_prefix(end + 1);
        return text;
    }

    std::optional<std::string_view> take(size_t count) {
        if (count > rest_.size()) return std::nullopt;
        const std::string_view bytes = rest_.substr(0, count);
        rest_.remove_prefix(count);
        return bytes;
    }

    std::string_view rest() const { return rest_; }

  private:
    std::string_view rest_;
};

// "-Y 512 +X 1024": the top row first, each from the left.
std::optional<Header> size_of(std::string_view line) {
    Header header{.bytes_per_pixel = 3 * sizeof(float)};
    const char* const end = line.data() + line.size();
    if (!line.starts_with("-Y ")) return std::nullopt;
    const auto height = std::from_chars(line.data() + 3, end, header.height);
    if (height.ec != std::errc() || !std::string_view(height.ptr, end).starts_with(" +X "))
        return std::nullopt;
    const auto width = std::from_chars(height.ptr + 4, end, header.width);
    if (width.ec != std::errc() || width.ptr != end) return std::nullopt;
    return header;
}

bool may_be_packed(uint64_t width) { return width >= 8 && width < 0x8000; }

// One of the four components of a row: runs (128 + length, value) and literals (length, values...).
bool unpack(Input& input, std::span<uint8_t> row) {
    while (!row.empty()) {
        const auto head = input.take(1);
        if (!head) return false;
        const size_t code = uint8_t(head->front());
        const bool run = code > 128;
        const size_t length = run ? code - 128 : code;
        if (length == 0 || length > row.size()) return false;
        const auto values = input.take(run ? 1 : length);
        if (!values) return false;
        for (size_t i = 0; i < length; ++i) row[i] = uint8_t((*values)[run ? 0 : i]);
        row = row.subspan(length);
    }
    return true;
}

// The row's four components, one after the other.
bool read_row(Input& input, std::span<uint8_t> row) {
    const size_t width = row.size() / 4;
    const std::string_view rest = input.rest();
    const bool packed = may_be_packed(width) && rest.size() >= 4 && rest[0] == 2 && rest[1] == 2 &&
                        size_t(uint8_t(rest[2])) << 8 == (width & 0xff00) &&
                        uint8_t(rest[3]) == (width & 0xff);
    if (packed) {
        input.take(4);
        return unpack(input, row.first(width)) && unpack(input, row.subspan(width, width)) &&
               unpack(input, row.subspan(2 * width, width)) && unpack(input, row.subspan(3 * width));
    }
    const auto pixels = input.take(4 * width);
    if (!pixels) return false;
    for (size_t x = 0; x < width; ++x)
        for (size_t c = 0; c < 4; ++c) row[c * width + x] = uint8_t((*pixels)[4 * x + c]);
    return true;
}

}  // namespace

Result<ImageF> decode_hdr(const Source& source) {
    Input input(source.bytes);
    auto line = input.line();
    for (; line && !line->empty(); line = input.line())
        if (line->starts_with("FORMAT=") && *line != "FORMAT=32-bit_rle_rgbe")
            return fail(ErrorKind::unsupported, source.name, "is an HDR picture, but not of RGBE",
                        "convert it");
    const auto size_line = input.line();
    if (!size_line) return damaged(source, "its header is cut off");
    auto header = size_of(*size_line);
    if (!header)
        return fail(ErrorKind::unsupported, source.name,
                    "is an HDR picture whose rows do not go as \"-Y N +X N\"",
                    "write it with the top row first");
    // A run makes 127 bytes of two at most.
    const uint64_t least_row =
        may_be_packed(header->width) ? 4 + 4 * 2 * ((header->width + 126) / 127) : 4 * header->width;
    header->least_bytes = header->height * std::min(least_row, 4 * header->width);
    if (const auto checked = check(*header, source); !checked) return tl::unexpected(checked.error());

    ImageF image{.width = uint32_t(header->width), .height = uint32_t(header->height), .channels = 3};
    image.values.resize(size_t(image.width) * image.height * 3);
    std::vector<uint8_t> row(size_t(image.width) * 4);
    for (uint32_t y = 0; y < image.height; ++y) {
        if (!read_row(input, row)) return damaged(source, "a row is cut off, or packed wrongly");
        for (uint32_t x = 0; x < image.width; ++x) {
            const uint8_t exponent = row[3 * size_t(image.width) + x];
            const float scale = exponent == 0 ? 0 : std::ldexp(1.0f, exponent - (128 + 8));
            for (size_t c = 0; c < 3; ++c) image.at(x, y)[c] = scale * float(row[c * image.width + x]);
        }
    }
    return image;
}

}  // namespace lumo::scene::codec
