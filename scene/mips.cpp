#include "scene/mips.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace lumo::scene {
namespace {

using Image16 = Image<uint16_t>;  // linear

std::array<uint16_t, 256> make_decode_table() {
    std::array<uint16_t, 256> table;
    for (int i = 0; i < 256; ++i) {
        const double v = i / 255.0;
        const double linear = v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
        table[size_t(i)] = uint16_t(std::lround(linear * 65535));
    }
    return table;
}

std::vector<uint8_t> make_encode_table() {
    std::vector<uint8_t> table(65536);
    for (int i = 0; i < 65536; ++i) {
        const double v = i / 65535.0;
        const double encoded = v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
        table[size_t(i)] = uint8_t(std::lround(encoded * 255));
    }
    return table;
}

Image16 decode(const Image8& image, Encoding encoding) {
    static const std::array<uint16_t, 256> srgb = make_decode_table();
    Image16 out{image.width, image.height, 4, std::vector<uint16_t>(image.values.size())};
    for (size_t i = 0; i < image.values.size(); ++i) {
        const uint8_t value = image.values[i];
        out.values[i] = encoding == Encoding::srgb && i % 4 != 3 ? srgb[value] : uint16_t(value * 257);
    }
    return out;
}

Image8 encode(const Image16& image, Encoding encoding) {
    static const std::vector<uint8_t> srgb = make_encode_table();
    Image8 out{image.width, image.height, 4, std::vector<uint8_t>(image.values.size())};
    for (size_t i = 0; i < image.values.size(); ++i) {
        const uint16_t value = image.values[i];
        out.values[i] = encoding == Encoding::srgb && i % 4 != 3 ? srgb[value] : uint8_t((value + 128) / 257);
    }
    return out;
}

/// The texels of a longer row that one texel of the row below covers, with weights that sum to the longer
/// row's length. A halved and rounded-down row makes texels 2 to 3 wide, which touch at most 4.
struct Span {
    uint32_t first = 0;
    uint32_t count = 0;
    std::array<uint32_t, 4> weights{};
};

std::vector<Span> spans(uint32_t length, uint32_t halved) {
    std::vector<Span> result(halved);
    for (uint64_t i = 0; i < halved; ++i) {
        const uint64_t begin = i * length;
        const uint64_t end = begin + length;
        Span& span = result[i];
        span.first = uint32_t(begin / halved);
        for (uint64_t texel = span.first; texel * halved < end; ++texel) {
            const uint64_t left = std::max(begin, texel * halved);
            const uint64_t right = std::min(end, (texel + 1) * halved);
            span.weights[span.count++] = uint32_t(right - left);
        }
    }
    return result;
}

Image16 half(const Image16& image) {
    Image16 out{std::max(image.width / 2, 1u), std::max(image.height / 2, 1u), 4, {}};
    out.values.resize(size_t(out.width) * out.height * 4);
    const std::vector<Span> columns = spans(image.width, out.width);
    const std::vector<Span> rows = spans(image.height, out.height);
    const uint64_t total = std::max<uint64_t>(image.values.size() / 4, 1);
    for (uint32_t y = 0; y < out.height; ++y) {
        for (uint32_t x = 0; x < out.width; ++x) {
            std::array<uint64_t, 4> sum{};
            for (uint32_t j = 0; j < rows[y].count; ++j) {
                const uint16_t* texel = image.at(columns[x].first, rows[y].first + j);
                for (uint32_t i = 0; i < columns[x].count; ++i) {
                    const uint64_t weight = uint64_t(rows[y].weights[j]) * columns[x].weights[i];
                    for (size_t c = 0; c < 4; ++c) sum[c] += weight * *texel++;
                }
            }
            for (size_t c = 0; c < 4; ++c) out.at(x, y)[c] = uint16_t((sum[c] + total / 2) / total);
        }
    }
    return out;
}

/// For each alpha, the part of the texels that have at least this much.
std::array<double, 257> coverage(const Image8& image) {
    std::array<size_t, 256> histogram{};
    for (size_t i = 3; i < image.values.size(); i += 4) ++histogram[image.values[i]];
    std::array<double, 257> result{};
    size_t covered = 0;
    for (size_t alpha = 256; alpha-- > 0;) {
        covered += histogram[alpha];
        result[alpha] = double(covered) / (double(image.values.size()) / 4);
    }
    return result;
}

/// Scales the alpha so that the part `wanted` reaches `cutoff`, in 1 to 255; leaves it alone where it does
/// already.
void keep_coverage(Image8& image, double wanted, size_t cutoff) {
    const std::array<double, 257> parts = coverage(image);
    size_t threshold = cutoff;
    while (threshold > 1 && parts[threshold] < wanted) --threshold;
    while (threshold < 255 && parts[threshold] > wanted) ++threshold;
    if (threshold > 1 && parts[threshold - 1] - wanted < wanted - parts[threshold]) --threshold;
    if (threshold == cutoff) return;
    for (size_t i = 3; i < image.values.size(); i += 4) {
        const size_t scaled = (image.values[i] * cutoff + threshold - 1) / threshold;
        image.values[i] = uint8_t(std::min(scaled, size_t(255)));
    }
}

}  // namespace

std::vector<Image8> lower_mips(const Image8& image, Encoding encoding, std::optional<float> alpha_cutoff) {
    std::vector<Image8> mips;
    if (image.values.empty()) return mips;
    const size_t cutoff = size_t(std::clamp(std::ceil(255 * alpha_cutoff.value_or(0.5f)), 1.0f, 255.0f));
    const double wanted = alpha_cutoff ? coverage(image)[cutoff] : 0;
    Image16 level = decode(image, encoding);
    while (level.width > 1 || level.height > 1) {
        level = half(level);
        mips.push_back(encode(level, encoding));
        if (alpha_cutoff) keep_coverage(mips.back(), wanted, cutoff);
    }
    return mips;
}

}  // namespace lumo::scene
