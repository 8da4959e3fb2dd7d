// The only file that includes OpenImageIO.
#include "scene/image.hpp"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <memory>
#include <optional>
#include <string_view>

#include "scene/file.hpp"
#include "scene/printable.hpp"

namespace lumo::scene {
namespace {

enum class Format { png, jpeg, hdr, exr };

struct Size {
    uint64_t width = 0;
    uint64_t height = 0;
};

const char* plugin_name(Format format) {
    switch (format) {
        case Format::png:
            return "png";
        case Format::jpeg:
            return "jpeg";
        case Format::hdr:
            return "hdr";
        case Format::exr:
            return "openexr";
    }
    return "";
}

uint32_t big_endian(std::span<const std::byte> bytes, size_t at, size_t size) {
    uint32_t value = 0;
    for (size_t i = 0; i < size; ++i) value = value << 8 | std::to_integer<uint32_t>(bytes[at + i]);
    return value;
}

// The content decides, never the extension.
std::optional<Format> detect(std::span<const std::byte> bytes) {
    const auto starts_with = [&](std::string_view magic) {
        return bytes.size() >= magic.size() &&
               std::equal(magic.begin(), magic.end(), bytes.begin(),
                          [](char a, std::byte b) { return std::byte(uint8_t(a)) == b; });
    };
    if (starts_with("\x89PNG\r\n\x1a\n")) return Format::png;
    if (starts_with("\xff\xd8\xff")) return Format::jpeg;
    if (starts_with("#?")) return Format::hdr;
    if (starts_with("\x76\x2f\x31\x01")) return Format::exr;
    return std::nullopt;
}

struct Header {
    Size size;
    uint64_t least_bytes = 0;  // what a file of this size must have at least
};

// Whether the chunks lead up to the one that ends the image. A decoder that runs into the end of the bytes instead
// jumps out of OpenImageIO 2.4 by longjmp, past a string of it that then leaks.
bool png_is_whole(std::span<const std::byte> bytes) {
    for (uint64_t at = 8; at + 12 <= bytes.size(); at += 12 + uint64_t(big_endian(bytes, at, 4)))
        if (big_endian(bytes, at + 4, 4) == 0x49454e44) return true;
    return false;
}

std::optional<Header> png_header(std::span<const std::byte> bytes) {
    if (bytes.size() < 26 || big_endian(bytes, 12, 4) != 0x49484452 || !png_is_whole(bytes))
        return std::nullopt;
    const Size size{big_endian(bytes, 16, 4), big_endian(bytes, 20, 4)};
    const uint32_t depth = big_endian(bytes, 24, 1), color_type = big_endian(bytes, 25, 1);
    const uint64_t channels = color_type == 2 ? 3 : color_type == 4 ? 2 : color_type == 6 ? 4 : 1;
    // Deflate makes 1032 bytes of one at most.
    return Header{size, size.width * channels * depth / 8 * size.height / 1032};
}

uint32_t little_endian(std::span<const std::byte> bytes, size_t at) {
    uint32_t value = 0;
    for (size_t i = 4; i-- > 0;) value = value << 8 | std::to_integer<uint32_t>(bytes[at + i]);
    return value;
}

// The position after the zero that ends the string at a position, if it is in the bytes.
std::optional<size_t> end_of_string(std::span<const std::byte> bytes, size_t at) {
    const auto zero =
        std::find(bytes.begin() + std::ptrdiff_t(std::min(at, bytes.size())), bytes.end(), std::byte(0));
    if (zero == bytes.end()) return std::nullopt;
    return size_t(zero - bytes.begin()) + 1;
}

// Walks the attributes of the one header (OpenEXR, "The OpenEXR File Layout"), because OpenEXR allocates what each
// says to be its size.
std::optional<Header> exr_header(std::span<const std::byte> bytes) {
    constexpr size_t first_attribute = 8;
    std::optional<Header> header;
    for (size_t at = first_attribute; at < bytes.size();) {
        const auto type = end_of_string(bytes, at);
        if (!type) return std::nullopt;
        if (*type == at + 1) return header;  // an empty name ends the header
        const auto size = end_of_string(bytes, *type);
        if (!size || *size + 4 > bytes.size()) return std::nullopt;
        const size_t data = *size + 4, length = little_endian(bytes, *size);
        if (length > bytes.size() - data) return std::nullopt;
        const std::string_view name(reinterpret_cast<const char*>(bytes.data()) + at, *type - at - 1);
        if (name == "dataWindow" && length == 16) {
            const auto extent = [&](size_t low) {
                return uint64_t(std::max<int64_t>(int64_t(int32_t(little_endian(bytes, data + low + 8))) -
                                                      int32_t(little_endian(bytes, data + low)) + 1,
                                                  0));
            };
            header = Header{{extent(0), extent(4)}, 0};
        }
        at = data + length;
    }
    return std::nullopt;
}

// Walks the segments up to the frame header (SOF0 to SOF15 but for DHT, JPG and DAC).
std::optional<Header> jpeg_header(std::span<const std::byte> bytes) {
    for (size_t at = 2; at + 4 <= bytes.size();) {
        if (bytes[at] != std::byte(0xff)) return std::nullopt;
        const uint32_t marker = big_endian(bytes, at + 1, 1);
        if (marker == 0xff) {
            ++at;
            continue;
        }
        if (marker == 0x01 || (marker >= 0xd0 && marker <= 0xd8)) {
            at += 2;
            continue;
        }
        const bool frame =
            marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
        if (frame) {
            if (at + 9 > bytes.size()) return std::nullopt;
            const Size size{big_endian(bytes, at + 7, 2), big_endian(bytes, at + 5, 2)};
            // A block of 8 x 8 pixels takes a bit at least.
            return Header{size, size.width / 8 * (size.height / 8) / 8};
        }
        if (marker == 0xd9 || marker == 0xda) return std::nullopt;
        at += 2 + std::max(big_endian(bytes, at + 2, 2), 2u);
    }
    return std::nullopt;
}

Result<void> check_size(Size size, uint64_t bytes_per_pixel, const std::string& name,
                        const ImageLimits& limits) {
    if (size.width == 0 || size.height == 0)
        return fail(ErrorKind::invalid_file, name, "has no pixels", "write the image again");
    if (size.width > limits.max_side || size.height > limits.max_side)
        return fail(ErrorKind::limit, name,
                    fmt::format("is {} x {} pixels, beyond the limit of {} a side", size.width, size.height,
                                limits.max_side),
                    "make it smaller");
    if (size.width * size.height * bytes_per_pixel > limits.max_bytes)
        return fail(ErrorKind::limit, name,
                    fmt::format("needs {} bytes of pixels, beyond the {} that are left of the limit",
                                size.width * size.height * bytes_per_pixel, limits.max_bytes),
                    "make it smaller");
    return {};
}

// An open image. The bytes and the proxy outlive the input, which reads from them.
struct Reader {
    std::unique_ptr<OIIO::Filesystem::IOMemReader> memory;
    std::unique_ptr<OIIO::ImageInput> input;
    OIIO::ImageSpec spec;
};

Result<Reader> open(std::span<const std::byte> bytes, Format format, const std::string& name,
                    const ImageLimits& limits) {
    // Some decoders take memory for what the header says on opening, so most headers are looked at first.
    if (format != Format::hdr) {
        const auto header = format == Format::png    ? png_header(bytes)
                            : format == Format::jpeg ? jpeg_header(bytes)
                                                     : exr_header(bytes);
        if (!header)
            return fail(ErrorKind::invalid_file, name, "has no valid header or is cut off",
                        "write the image again");
        if (auto checked = check_size(header->size, 4, name, limits); !checked)
            return tl::unexpected(checked.error());
        if (bytes.size() < header->least_bytes)
            return fail(ErrorKind::invalid_file, name,
                        fmt::format("says {} x {} pixels, but has only {} bytes", header->size.width,
                                    header->size.height, bytes.size()),
                        "write the image again");
    }

    Reader reader;
    reader.input = OIIO::ImageInput::create(plugin_name(format));
    if (!reader.input) {
        OIIO::geterror();
        return fail(ErrorKind::unsupported, name,
                    fmt::format("is a {} image, which this OpenImageIO cannot read", plugin_name(format)));
    }
    reader.memory =
        std::make_unique<OIIO::Filesystem::IOMemReader>(const_cast<std::byte*>(bytes.data()), bytes.size());
    if (!reader.input->supports("ioproxy") || !reader.input->set_ioproxy(reader.memory.get()))
        return fail(ErrorKind::unsupported, name,
                    fmt::format("is a {} image, which this OpenImageIO cannot read from memory",
                                plugin_name(format)));
    OIIO::ImageSpec config;
    config.attribute("oiio:UnassociatedAlpha", 1);
    if (!reader.input->open(name, reader.spec, config))
        return fail(ErrorKind::invalid_file, name,
                    "cannot be decoded: " + printable(reader.input->geterror()), "write the image again");
    const OIIO::ImageSpec& spec = reader.spec;
    if (spec.deep || spec.depth > 1)
        return fail(ErrorKind::unsupported, name, "is a deep or volume image", "write a flat one");
    if (spec.nchannels < 1 || spec.width < 1 || spec.height < 1)
        return fail(ErrorKind::invalid_file, name, "has no pixels", "write the image again");
    return reader;
}

template <class T>
Result<std::vector<T>> read_pixels(Reader& reader, OIIO::TypeDesc type, const std::string& name) {
    const OIIO::ImageSpec& spec = reader.spec;
    std::vector<T> values(size_t(spec.width) * size_t(spec.height) * size_t(spec.nchannels));
    if (!reader.input->read_image(0, 0, 0, spec.nchannels, type, values.data()))
        return fail(ErrorKind::invalid_file, name,
                    "cannot be decoded: " + printable(reader.input->geterror()), "write the image again");
    return values;
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

Result<Image8> decode8(std::span<const std::byte> bytes, const std::string& name, const ImageLimits& limits) {
    const std::optional<Format> format = detect(bytes);
    if (format != Format::png && format != Format::jpeg)
        return fail(ErrorKind::unsupported, name, "is neither PNG nor JPEG", "convert it");
    Result<Reader> reader = open(bytes, *format, name, limits);
    if (!reader) return tl::unexpected(reader.error());
    const uint32_t channels = uint32_t(reader->spec.nchannels);
    if (channels > 4) return fail(ErrorKind::unsupported, name, fmt::format("has {} channels", channels));
    auto pixels = read_pixels<uint8_t>(*reader, OIIO::TypeDesc::UINT8, name);
    if (!pixels) return tl::unexpected(pixels.error());

    Image8 image{.width = uint32_t(reader->spec.width),
                 .height = uint32_t(reader->spec.height),
                 .channels = 4,
                 .values = {}};
    if (channels == 4) {
        image.values = std::move(*pixels);
        return image;
    }
    const size_t count = size_t(image.width) * image.height;
    const bool grey = channels < 3;
    const bool has_alpha = channels == 2;
    image.values.resize(count * 4);
    for (size_t i = 0; i < count; ++i) {
        const uint8_t* from = pixels->data() + i * channels;
        uint8_t* to = image.values.data() + i * 4;
        for (size_t c = 0; c < 3; ++c) to[c] = from[grey ? 0 : c];
        to[3] = has_alpha ? from[1] : 255;
    }
    return image;
}

// "diffuse.R" is channel R of layer "diffuse", "R" is channel R of the layer without a name.
struct ChannelName {
    std::string layer;
    std::string channel;
};

ChannelName split_channel(const std::string& name) {
    const size_t dot = name.rfind('.');
    if (dot == std::string::npos) return {"", name};
    return {name.substr(0, dot), name.substr(dot + 1)};
}

size_t channel_rank(std::string_view channel) {
    constexpr std::array<std::string_view, 8> order = {"R", "G", "B", "A", "X", "Y", "Z", "W"};
    return size_t(std::ranges::find(order, channel) - order.begin());
}

Result<std::vector<ExrLayer>> decode_exr(std::span<const std::byte> bytes, const std::string& name,
                                         const ImageLimits& limits) {
    constexpr uint32_t deep_or_multipart = 0x1800;
    if (bytes.size() < 8 || (little_endian(bytes, 4) & deep_or_multipart) != 0)
        return fail(ErrorKind::unsupported, name, "is a deep or multi-part EXR file", "write one flat part");
    Result<Reader> reader = open(bytes, Format::exr, name, limits);
    if (!reader) return tl::unexpected(reader.error());
    const OIIO::ImageSpec& spec = reader->spec;
    const size_t channel_count = size_t(spec.nchannels);
    // Twice: the pixels as the file has them, and by layer.
    if (auto checked = check_size({uint64_t(spec.width), uint64_t(spec.height)},
                                  2 * sizeof(float) * channel_count, name, limits);
        !checked)
        return tl::unexpected(checked.error());

    struct Group {
        std::string name;
        std::vector<std::pair<size_t, size_t>> channels;  // rank, index in the file
    };
    std::vector<Group> groups;
    for (size_t i = 0; i < channel_count; ++i) {
        const ChannelName channel = split_channel(spec.channelnames[i]);
        auto group = std::ranges::find(groups, channel.layer, &Group::name);
        if (group == groups.end()) group = groups.insert(groups.end(), Group{channel.layer, {}});
        group->channels.emplace_back(channel_rank(channel.channel), i);
    }

    auto pixels = read_pixels<float>(*reader, OIIO::TypeDesc::FLOAT, name);
    if (!pixels) return tl::unexpected(pixels.error());
    std::vector<ExrLayer> layers;
    for (Group& group : groups) {
        std::ranges::sort(group.channels);
        const size_t channels = group.channels.size();
        ImageF image{.width = uint32_t(spec.width),
                     .height = uint32_t(spec.height),
                     .channels = uint32_t(channels),
                     .values = {}};
        const size_t count = size_t(image.width) * image.height;
        image.values.resize(count * channels);
        for (size_t i = 0; i < count; ++i)
            for (size_t c = 0; c < channels; ++c)
                image.values[i * channels + c] = (*pixels)[i * channel_count + group.channels[c].second];
        layers.push_back({group.name, std::move(image)});
    }
    return layers;
}

Result<ImageF> decode_float(std::span<const std::byte> bytes, const std::string& name,
                            const ImageLimits& limits) {
    const std::optional<Format> format = detect(bytes);
    if (!format) return fail(ErrorKind::unsupported, name, "is none of HDR, EXR, PNG and JPEG", "convert it");
    if (*format == Format::exr) {
        auto layers = decode_exr(bytes, name, limits);
        if (!layers) return tl::unexpected(layers.error());
        const auto unnamed = std::ranges::find(*layers, std::string(), &ExrLayer::name);
        return std::move((unnamed == layers->end() ? layers->begin() : unnamed)->image);
    }
    Result<Reader> reader = open(bytes, *format, name, limits);
    if (!reader) return tl::unexpected(reader.error());
    const OIIO::ImageSpec& spec = reader->spec;
    if (auto checked = check_size({uint64_t(spec.width), uint64_t(spec.height)},
                                  sizeof(float) * uint64_t(spec.nchannels), name, limits);
        !checked)
        return tl::unexpected(checked.error());
    auto pixels = read_pixels<float>(*reader, OIIO::TypeDesc::FLOAT, name);
    if (!pixels) return tl::unexpected(pixels.error());
    return ImageF{.width = uint32_t(spec.width),
                  .height = uint32_t(spec.height),
                  .channels = uint32_t(spec.nchannels),
                  .values = std::move(*pixels)};
}

template <class T, class Decode>
Result<T> read_image(const std::filesystem::path& file, Decode decode) {
    const std::string name = printable(file.string());
    return guarded(name, [&]() -> Result<T> {
        Result<std::vector<std::byte>> bytes = read_file(file);
        if (!bytes) return tl::unexpected(bytes.error());
        return decode(std::span<const std::byte>(*bytes), name);
    });
}

Result<void> write(const std::filesystem::path& file, const char* plugin, const OIIO::ImageSpec& spec,
                   OIIO::TypeDesc type, const void* pixels) {
    const std::string name = printable(file.string());
    return guarded(name, [&]() -> Result<void> {
        const auto output = OIIO::ImageOutput::create(plugin);
        if (!output) {
            OIIO::geterror();
            return fail(ErrorKind::unsupported, name,
                        fmt::format("this OpenImageIO cannot write {}", plugin));
        }
        const bool written =
            output->open(file.string(), spec) && output->write_image(type, pixels) && output->close();
        if (!written)
            return fail(ErrorKind::io, name, "cannot be written: " + printable(output->geterror()),
                        "check that its folder exists, may be written to and has room");
        return {};
    });
}

template <class T>
bool is_whole(const Image<T>& image) {
    return image.width > 0 && image.height > 0 &&
           image.values.size() == size_t(image.width) * image.height * image.channels;
}

}  // namespace

Result<Image8> decode_image8(std::span<const std::byte> bytes, const std::string& name,
                             const ImageLimits& limits) {
    return guarded(printable(name), [&] { return decode8(bytes, printable(name), limits); });
}

Result<Image8> read_image8(const std::filesystem::path& file, const ImageLimits& limits) {
    return read_image<Image8>(
        file, [&](auto bytes, const std::string& name) { return decode8(bytes, name, limits); });
}

Result<ImageF> read_image_float(const std::filesystem::path& file, const ImageLimits& limits) {
    return read_image<ImageF>(
        file, [&](auto bytes, const std::string& name) { return decode_float(bytes, name, limits); });
}

Result<std::vector<ExrLayer>> read_exr(const std::filesystem::path& file, const ImageLimits& limits) {
    return read_image<std::vector<ExrLayer>>(
        file, [&](auto bytes, const std::string& name) -> Result<std::vector<ExrLayer>> {
            if (detect(bytes) != Format::exr)
                return fail(ErrorKind::invalid_file, name, "is not an EXR file");
            return decode_exr(bytes, name, limits);
        });
}

Result<void> write_png(const std::filesystem::path& file, const Image8& image) {
    const bool channels_fit = image.channels == 1 || image.channels == 3 || image.channels == 4;
    if (!channels_fit || !is_whole(image))
        return fail(ErrorKind::invalid_argument, printable(file.string()),
                    fmt::format("cannot hold {} x {} pixels of {} channels in {} bytes as PNG", image.width,
                                image.height, image.channels, image.values.size()),
                    "give 1, 3 or 4 channels");
    OIIO::ImageSpec spec(int(image.width), int(image.height), int(image.channels), OIIO::TypeDesc::UINT8);
    if (image.channels == 4) spec.attribute("oiio:UnassociatedAlpha", 1);
    return write(file, "png", spec, OIIO::TypeDesc::UINT8, image.values.data());
}

Result<void> write_exr(const std::filesystem::path& file, std::span<const ExrLayer> layers) {
    const std::string name = printable(file.string());
    if (layers.empty()) return fail(ErrorKind::invalid_argument, name, "has no layer to write");
    const uint32_t width = layers[0].image.width;
    const uint32_t height = layers[0].image.height;
    size_t channel_count = 0;
    std::vector<std::string> channel_names;
    for (const ExrLayer& layer : layers) {
        if (!is_whole(layer.image) || layer.image.width != width || layer.image.height != height)
            return fail(ErrorKind::invalid_argument, name,
                        fmt::format("layer '{}' is {} x {}, the first is {} x {}", printable(layer.name),
                                    layer.image.width, layer.image.height, width, height),
                        "give every layer the same size");
        const uint32_t channels = layer.image.channels;
        if (channels < 1 || channels > 4)
            return fail(ErrorKind::invalid_argument, name,
                        fmt::format("layer '{}' has {} channels", printable(layer.name), channels),
                        "give 1 to 4");
        const std::string prefix = layer.name.empty() ? "" : layer.name + ".";
        for (uint32_t c = 0; c < channels; ++c)
            channel_names.push_back(prefix +
                                    std::string(channels == 1 ? "Y" : std::string_view("RGBA").substr(c, 1)));
        channel_count += channels;
    }
    auto sorted_names = channel_names;
    std::ranges::sort(sorted_names);
    if (std::ranges::adjacent_find(sorted_names) != sorted_names.end())
        return fail(ErrorKind::invalid_argument, name, "two layers have the same name", "name every layer");

    std::vector<float> pixels(size_t(width) * height * channel_count);
    size_t first_channel = 0;
    for (const ExrLayer& layer : layers) {
        const size_t channels = layer.image.channels;
        for (size_t i = 0; i < size_t(width) * height; ++i)
            std::copy_n(layer.image.values.data() + i * channels, channels,
                        pixels.data() + i * channel_count + first_channel);
        first_channel += channels;
    }
    OIIO::ImageSpec spec(int(width), int(height), int(channel_count), OIIO::TypeDesc::FLOAT);
    spec.channelnames = channel_names;
    spec.attribute("compression", "zip");
    return write(file, "openexr", spec, OIIO::TypeDesc::FLOAT, pixels.data());
}

}  // namespace lumo::scene
