#include "scene/image.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <string_view>

#include "scene/file.hpp"
#include "scene/image_codec.hpp"
#include "scene/printable.hpp"

namespace lumo::scene {
namespace codec {

Result<void> check(const Header& header, const Source& source) {
    const ImageLimits& limits = source.limits;
    if (header.width == 0 || header.height == 0)
        return fail(ErrorKind::invalid_file, source.name, "has no pixels", "write the image again");
    if (header.width > limits.max_side || header.height > limits.max_side)
        return fail(ErrorKind::limit, source.name,
                    fmt::format("is {} x {} pixels, beyond the limit of {} a side", header.width,
                                header.height, limits.max_side),
                    "make it smaller");
    if (header.width * header.height > limits.max_bytes / std::max<uint64_t>(header.bytes_per_pixel, 1))
        return fail(
            ErrorKind::limit, source.name,
            fmt::format("has {} x {} pixels of {} bytes, beyond the {} bytes that are left of the limit",
                        header.width, header.height, header.bytes_per_pixel, limits.max_bytes),
            "make it smaller");
    if (source.bytes.size() < header.least_bytes)
        return fail(ErrorKind::invalid_file, source.name,
                    fmt::format("says {} x {} pixels, but has only {} bytes", header.width, header.height,
                                source.bytes.size()),
                    "write the image again");
    return {};
}

tl::unexpected<Error> damaged(const Source& source, const std::string& reason) {
    return fail(ErrorKind::invalid_file, source.name, "cannot be decoded: " + reason,
                "write the image again");
}

uint32_t big_endian(std::span<const std::byte> bytes, size_t at, size_t size) {
    uint32_t value = 0;
    for (size_t i = 0; i < size; ++i) value = value << 8 | std::to_integer<uint32_t>(bytes[at + i]);
    return value;
}

ImageF to_float(const Image8& from) {
    ImageF to{.width = from.width, .height = from.height, .channels = from.channels};
    to.values.resize(from.values.size());
    std::ranges::transform(from.values, to.values.begin(),
                           [](uint8_t value) { return float(value) * (1.0f / 255); });
    return to;
}

}  // namespace codec

namespace {

using codec::Source;

enum class Format { png, jpeg, hdr, exr, other };

// The content decides, never the extension.
Format format_of(std::span<const std::byte> bytes) {
    const auto starts_with = [&](std::string_view magic) {
        return bytes.size() >= magic.size() &&
               std::equal(magic.begin(), magic.end(), bytes.begin(),
                          [](char a, std::byte b) { return std::byte(uint8_t(a)) == b; });
    };
    if (starts_with("\x89PNG\r\n\x1a\n")) return Format::png;
    if (starts_with("\xff\xd8\xff")) return Format::jpeg;
    if (starts_with("#?")) return Format::hdr;
    if (starts_with("\x76\x2f\x31\x01")) return Format::exr;
    return Format::other;
}

template <class Function>
auto guarded(const std::string& name, Function function) -> decltype(function()) {
    try {
        return function();
    } catch (const std::bad_alloc&) {
        return fail(ErrorKind::out_of_memory, name, "does not fit into memory", "make it smaller");
    } catch (const std::exception& exception) {
        return fail(ErrorKind::invalid_file, name, "cannot be decoded: " + printable(exception.what()),
                    "write the image again");
    }
}

// Grey is expanded, and missing alpha is 255.
Result<Image8> to_rgba(Image8 from, const Source& source) {
    if (from.channels == 4) return from;
    if (from.channels > 4)
        return fail(ErrorKind::unsupported, source.name, fmt::format("has {} channels", from.channels));
    const codec::Header header{.width = from.width, .height = from.height, .bytes_per_pixel = 4};
    if (const auto checked = codec::check(header, source); !checked) return tl::unexpected(checked.error());
    Image8 to{.width = from.width, .height = from.height, .channels = 4};
    const size_t count = size_t(from.width) * from.height;
    const bool grey = from.channels < 3;
    const bool has_alpha = from.channels == 2;
    to.values.resize(count * 4);
    for (size_t i = 0; i < count; ++i) {
        const uint8_t* in = from.values.data() + i * from.channels;
        uint8_t* out = to.values.data() + i * 4;
        for (size_t c = 0; c < 3; ++c) out[c] = in[grey ? 0 : c];
        out[3] = has_alpha ? in[1] : 255;
    }
    return to;
}

// The layer without a name, or else the first.
ImageF main_layer(std::vector<ExrLayer> layers) {
    const auto unnamed = std::ranges::find(layers, std::string(), &ExrLayer::name);
    return std::move((unnamed == layers.end() ? layers.begin() : unnamed)->image);
}

Result<Image8> decode8(const Source& source, bool others) {
    const auto rgba = [&](Image8 image) { return to_rgba(std::move(image), source); };
    const Format format = format_of(source.bytes);
    if (format == Format::png) return codec::decode_png8(source).and_then(rgba);
    if (format == Format::jpeg) return codec::decode_jpeg(source).and_then(rgba);
    if (others && format == Format::other) return codec::decode_other8(source).and_then(rgba);
    return fail(ErrorKind::unsupported, source.name, "is neither PNG nor JPEG", "convert it");
}

Result<ImageF> decode_float(const Source& source) {
    switch (format_of(source.bytes)) {
        case Format::png:
            return codec::decode_png_float(source);
        case Format::jpeg:
            return codec::decode_jpeg(source).map(codec::to_float);
        case Format::hdr:
            return codec::decode_hdr(source);
        case Format::exr:
            return codec::decode_exr(source).map(main_layer);
        case Format::other:
            return codec::decode_other_float(source);
    }
    return ImageF{};
}

template <class Decode>
auto read_image(const std::filesystem::path& file, const ImageLimits& limits, Decode decode)
    -> decltype(decode(Source{})) {
    const std::string name = printable(file.string());
    return guarded(name, [&]() -> decltype(decode(Source{})) {
        const Result<std::vector<std::byte>> bytes = read_file(file);
        if (!bytes) return tl::unexpected(bytes.error());
        return decode(Source{*bytes, name, limits});
    });
}

template <class T>
bool is_whole(const Image<T>& image) {
    return image.width > 0 && image.height > 0 &&
           image.values.size() == size_t(image.width) * image.height * image.channels;
}

// Why the layers cannot be in one file, if so.
Result<void> check_layers(const std::string& name, std::span<const ExrLayer> layers) {
    if (layers.empty()) return fail(ErrorKind::invalid_argument, name, "has no layer to write");
    const ImageF& first = layers[0].image;
    std::vector<std::string_view> names;
    for (const ExrLayer& layer : layers) {
        const ImageF& image = layer.image;
        if (!is_whole(image) || image.width != first.width || image.height != first.height)
            return fail(ErrorKind::invalid_argument, name,
                        fmt::format("layer '{}' is {} x {}, the first is {} x {}", printable(layer.name),
                                    image.width, image.height, first.width, first.height),
                        "give every layer the same size");
        if (image.channels < 1 || image.channels > 4)
            return fail(ErrorKind::invalid_argument, name,
                        fmt::format("layer '{}' has {} channels", printable(layer.name), image.channels),
                        "give 1 to 4");
        names.push_back(layer.name);
    }
    std::ranges::sort(names);
    if (std::ranges::adjacent_find(names) != names.end())
        return fail(ErrorKind::invalid_argument, name, "two layers have the same name", "name every layer");
    return {};
}

}  // namespace

Result<Image8> decode_image8(std::span<const std::byte> bytes, const std::string& name,
                             const ImageLimits& limits) {
    const Source source{bytes, printable(name), limits};
    return guarded(source.name, [&] { return decode8(source, false); });
}

Result<Image8> read_image8(const std::filesystem::path& file, const ImageLimits& limits) {
    return read_image(file, limits, [](const Source& source) { return decode8(source, true); });
}

Result<ImageF> read_image_float(const std::filesystem::path& file, const ImageLimits& limits) {
    return read_image(file, limits, decode_float);
}

Result<std::vector<ExrLayer>> read_exr(const std::filesystem::path& file, const ImageLimits& limits) {
    return read_image(file, limits, [](const Source& source) -> Result<std::vector<ExrLayer>> {
        if (format_of(source.bytes) != Format::exr)
            return fail(ErrorKind::invalid_file, source.name, "is not an EXR file");
        return codec::decode_exr(source);
    });
}

Result<void> write_png(const std::filesystem::path& file, const Image8& image) {
    const std::string name = printable(file.string());
    const bool channels_fit = image.channels == 1 || image.channels == 3 || image.channels == 4;
    if (!channels_fit || !is_whole(image))
        return fail(ErrorKind::invalid_argument, name,
                    fmt::format("cannot hold {} x {} pixels of {} channels in {} bytes as PNG", image.width,
                                image.height, image.channels, image.values.size()),
                    "give 1, 3 or 4 channels");
    return guarded(name, [&] { return write_file(file, codec::encode_png(image)); });
}

Result<void> write_exr(const std::filesystem::path& file, std::span<const ExrLayer> layers) {
    const std::string name = printable(file.string());
    if (auto checked = check_layers(name, layers); !checked) return checked;
    return guarded(name, [&] { return write_file(file, codec::encode_exr(layers)); });
}

}  // namespace lumo::scene
