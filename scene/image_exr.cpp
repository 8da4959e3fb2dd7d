// EXR by OpenEXR.
#include <ImathBox.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "scene/image_codec.hpp"
#include "scene/printable.hpp"

namespace lumo::scene::codec {
namespace {

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

// What the attributes of a header say ("The OpenEXR File Layout"), as far as memory depends on it.
struct Layout {
    uint64_t width = 0;
    uint64_t height = 0;
    uint64_t channels = 0;
    uint64_t tile_side = 0;  ///< the longer one; 0 without tiles
    uint32_t compression = 0;
};

uint64_t count_channels(std::span<const std::byte> list) {
    constexpr size_t after_name = 16;  // type, linearity and sampling
    uint64_t count = 0;
    for (size_t at = 0; at < list.size() && list[at] != std::byte(0); ++count) {
        const auto end = end_of_string(list, at);
        if (!end) break;
        at = *end + after_name;
    }
    return count;
}

// Walks the attributes of the one header, because OpenEXR allocates what each says to be its size.
std::optional<Layout> layout_of(std::span<const std::byte> bytes) {
    constexpr size_t first_attribute = 8;
    Layout layout;
    for (size_t at = first_attribute; at < bytes.size();) {
        const auto type = end_of_string(bytes, at);
        if (!type) return std::nullopt;
        if (*type == at + 1) return layout;  // an empty name ends the header
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
            layout.width = extent(0);
            layout.height = extent(4);
        } else if (name == "channels") {
            layout.channels = count_channels(bytes.subspan(data, length));
        } else if (name == "tiles" && length == 9) {
            layout.tile_side = std::max(little_endian(bytes, data), little_endian(bytes, data + 4));
        } else if (name == "compression" && length == 1) {
            layout.compression = std::to_integer<uint32_t>(bytes[data]);
        }
        at = data + length;
    }
    return std::nullopt;
}

// The compressions up to B44A make at most as much of a byte as deflate does, 1032, and a sample has two bytes at
// least. DWA has no such bound, but 256 rows a chunk at most, each with its place in the table and its header.
uint64_t least_bytes(const Layout& layout) {
    constexpr uint32_t last_bounded = 7;
    if (layout.compression > last_bounded) return layout.height / 256 * 16;
    return layout.width * layout.height * layout.channels * 2 / (layout.compression == 0 ? 1 : 1032);
}

class MemoryInput : public Imf::IStream {
  public:
    MemoryInput(std::span<const std::byte> bytes, const std::string& name)
        : Imf::IStream(name.c_str()), bytes_(bytes) {}

    bool read(char to[], int count) override {
        if (count < 0 || at_ > bytes_.size() || size_t(count) > bytes_.size() - at_)
            throw std::runtime_error("the file is cut off");
        std::memcpy(to, bytes_.data() + at_, size_t(count));
        at_ += size_t(count);
        return at_ < bytes_.size();
    }
    uint64_t tellg() override { return at_; }
    void seekg(uint64_t position) override { at_ = position; }

  private:
    std::span<const std::byte> bytes_;
    uint64_t at_ = 0;
};

class MemoryOutput : public Imf::OStream {
  public:
    MemoryOutput() : Imf::OStream("memory") {}

    void write(const char from[], int count) override {
        bytes.resize(std::max(bytes.size(), size_t(at_) + size_t(count)));
        std::memcpy(bytes.data() + at_, from, size_t(count));
        at_ += uint64_t(count);
    }
    uint64_t tellp() override { return at_; }
    void seekp(uint64_t position) override { at_ = position; }

    std::vector<std::byte> bytes;

  private:
    uint64_t at_ = 0;
};

// "diffuse.R" is channel R of layer "diffuse", "R" is channel R of the layer without a name.
std::string layer_of(std::string_view name) {
    const size_t dot = name.rfind('.');
    return std::string(name.substr(0, dot == std::string_view::npos ? 0 : dot));
}

size_t rank_of(std::string_view name) {
    constexpr std::array<std::string_view, 8> order = {"R", "G", "B", "A", "X", "Y", "Z", "W"};
    return size_t(std::ranges::find(order, name.substr(name.rfind('.') + 1)) - order.begin());
}

// The channels of each layer by name, in their order in the image. The layer without a name is first.
std::map<std::string, std::vector<std::string>> layers_of(const Imf::ChannelList& channels) {
    std::map<std::string, std::vector<std::string>> layers;
    for (auto channel = channels.begin(); channel != channels.end(); ++channel)
        layers[layer_of(channel.name())].emplace_back(channel.name());
    for (auto& [layer, names] : layers) std::ranges::stable_sort(names, {}, rank_of);
    return layers;
}

Imf::Slice slice(const ImageF& image, uint32_t channel, const Imath::Box2i& window) {
    return Imf::Slice::Make(Imf::FLOAT, image.values.data() + channel, window, image.channels * sizeof(float),
                            size_t(image.width) * image.channels * sizeof(float));
}

std::string channel_name(const ExrLayer& layer, uint32_t channel) {
    const std::string prefix = layer.name.empty() ? "" : layer.name + ".";
    return prefix + (layer.image.channels == 1 ? 'Y' : "RGBA"[channel]);
}

}  // namespace

Result<std::vector<ExrLayer>> decode_exr(const Source& source) {
    constexpr uint32_t deep_or_multipart = 0x1800;
    const auto layout = source.bytes.size() < 8 ? std::nullopt : layout_of(source.bytes);
    if (!layout) return damaged(source, "its header is no EXR header, or cut off");
    if ((little_endian(source.bytes, 4) & deep_or_multipart) != 0)
        return fail(ErrorKind::unsupported, source.name, "is a deep or multi-part EXR file",
                    "write one flat part");
    const Header header{.width = layout->width,
                        .height = layout->height,
                        .bytes_per_pixel = sizeof(float) * layout->channels,
                        .least_bytes = least_bytes(*layout)};
    if (const auto checked = check(header, source); !checked) return tl::unexpected(checked.error());
    if (layout->tile_side > source.limits.max_side)
        return damaged(source, "its tiles are larger than a picture may be");

    MemoryInput input(source.bytes, source.name);
    Imf::InputFile file(input, 0);
    const Imath::Box2i window = file.header().dataWindow();
    if (uint64_t(window.size().x) + 1 != layout->width || uint64_t(window.size().y) + 1 != layout->height)
        return damaged(source, "it gives its size twice");

    std::vector<ExrLayer> layers;
    Imf::FrameBuffer pixels;
    for (const auto& [layer, names] : layers_of(file.header().channels())) {
        ImageF image{.width = uint32_t(layout->width),
                     .height = uint32_t(layout->height),
                     .channels = uint32_t(names.size())};
        image.values.resize(size_t(image.width) * image.height * image.channels);
        for (uint32_t i = 0; i < image.channels; ++i) {
            const Imf::Channel& channel = file.header().channels()[names[i].c_str()];
            if (channel.xSampling != 1 || channel.ySampling != 1)
                return fail(ErrorKind::unsupported, source.name,
                            "has channels of fewer samples than pixels (" + printable(names[i]) + ")",
                            "write every channel in full");
            pixels.insert(names[i], slice(image, i, window));
        }
        layers.push_back({layer, std::move(image)});
    }
    if (layers.empty()) return damaged(source, "it has no channels");
    file.setFrameBuffer(pixels);
    file.readPixels(window.min.y, window.max.y);
    return layers;
}

std::vector<std::byte> encode_exr(std::span<const ExrLayer> layers) {
    const ImageF& first = layers.front().image;
    Imf::Header header(int(first.width), int(first.height));
    header.compression() = Imf::ZIP_COMPRESSION;
    Imf::FrameBuffer pixels;
    for (const ExrLayer& layer : layers)
        for (uint32_t i = 0; i < layer.image.channels; ++i) {
            const std::string name = channel_name(layer, i);
            header.channels().insert(name, Imf::Channel(Imf::FLOAT));
            pixels.insert(name, slice(layer.image, i, header.dataWindow()));
        }
    MemoryOutput output;
    {
        Imf::OutputFile file(output, header, 0);
        file.setFrameBuffer(pixels);
        file.writePixels(int(first.height));
    }
    return std::move(output.bytes);
}

}  // namespace lumo::scene::codec
