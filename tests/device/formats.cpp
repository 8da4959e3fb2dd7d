// Every format that a device can sample: bytes go in and out unchanged, and a shader reads what they mean.
#include <cmath>
#include <glm/vec4.hpp>

#include "shaders/test_rhi/sample_d2.hpp"
#include "shaders/test_rhi/sample_d2_sint.hpp"
#include "shaders/test_rhi/sample_d2_uint.hpp"
#include "tests/device/texels.hpp"
#include "tests/support/device_test.hpp"

namespace lumo::rhi {
namespace {

using namespace testing_support;
using namespace shaders::test_rhi;
using enum Dimension;

struct FormatTest : DeviceTest {
    template <class P, class Texel>
    std::vector<Texel> sample(const Texture& from, const std::vector<glm::vec4>& points, uint32_t mip) {
        Buffer at = buffer_with(points);
        Buffer results = buffer(points.size() * sizeof(Texel));
        const Sampler nearest = nearest_sampler();
        run(compute<P>(),
            {.source = {from.view<d2>(), nearest}, .Points = at.slice(), .Results = results.slice()},
            {.count = uint32_t(points.size()), .lod = float(mip)}, {groups_for(uint32_t(points.size()), 64)});
        return contents<Texel>(results);
    }
    std::vector<Color> sample(const Texture& from, uint32_t mip) {
        const Extent whole = mip_extent(from.desc().extent, mip);
        std::vector<glm::vec4> points;
        for (uint32_t y = 0; y < whole.height; ++y)
            for (uint32_t x = 0; x < whole.width; ++x)
                points.emplace_back((float(x) + 0.5f) / float(whole.width),
                                    (float(y) + 0.5f) / float(whole.height), 0, 0);
        std::vector<Color> colors;
        const auto keep = [&](const auto& texels) {
            for (const auto& t : texels)
                colors.push_back({double(t.r), double(t.g), double(t.b), double(t.a)});
        };
        switch (format_info(from.desc().format).kind) {
            case FormatKind::uint:
                keep(sample<sample_d2_uint, glm::uvec4>(from, points, mip));
                break;
            case FormatKind::sint:
                keep(sample<sample_d2_sint, glm::ivec4>(from, points, mip));
                break;
            default:
                keep(sample<sample_d2, glm::vec4>(from, points, mip));
        }
        return colors;
    }
};
INSTANTIATE_TEST_SUITE_P(Device, FormatTest, both_apis, api_name);

std::vector<Format> all_formats() {
    std::vector<Format> formats;
    for (int i = 1; i < format_count; ++i) formats.push_back(Format(i));
    return formats;
}

TEST_P(FormatTest, TheOnesThatLumoNeedsAreThere) {
    const auto able = [&](Format format, FormatCaps caps) {
        for (int bit = 1; bit < 128; bit <<= 1)
            if (has(caps, FormatCaps(bit)) && !has(device().format_caps(format), FormatCaps(bit)))
                return false;
        return true;
    };
    const FormatCaps draw = FormatCaps::sampled | FormatCaps::attachment;
    EXPECT_TRUE(able(Format::rgba8_unorm,
                     draw | FormatCaps::linear_filter | FormatCaps::storage | FormatCaps::blend));
    EXPECT_TRUE(able(Format::rgba8_srgb, draw | FormatCaps::linear_filter));
    EXPECT_TRUE(able(Format::rgba16_float, draw | FormatCaps::linear_filter | FormatCaps::storage));
    EXPECT_TRUE(able(Format::rgba32_float, draw | FormatCaps::storage));
    EXPECT_TRUE(able(Format::r32_uint, draw | FormatCaps::storage | FormatCaps::storage_atomic));
    EXPECT_FALSE(able(Format::r32_float, FormatCaps::storage_atomic)) << "on either API";
    EXPECT_TRUE(able(Format::d32_float, draw));
    EXPECT_FALSE(able(Format::d32_float, FormatCaps::linear_filter)) << "nothing may rely on filtered depth";
    EXPECT_FALSE(able(Format::rgba8_srgb, FormatCaps::storage));
    EXPECT_EQ(device().format_caps(Format::undefined), FormatCaps::none);
}

TEST_P(FormatTest, BytesGoInAndOutUnchangedAndMeanWhatTheyShould) {
    int tried = 0;
    for (Format format : all_formats()) {
        const FormatInfo& info = format_info(format);
        if (!has(device().format_caps(format), FormatCaps::sampled)) continue;
        ++tried;
        const TextureDesc desc{
            .name = std::string(info.name), .format = format, .extent = {20, 12, 1}, .mips = 3};
        Texture made = texture(desc);
        for (uint32_t mip = 0; mip < desc.mips; ++mip) {
            const TextureRegion region = whole_mip(desc, mip);
            const auto bytes =
                random_texels(format, region_bytes(format, region) / info.bytes_per_block, 17 + mip);
            must(device().upload(made, region, bytes));
            ASSERT_EQ(must(device().download(made, region)), bytes) << info.name << ", mip " << mip;
            if (info.block_side > 1) continue;
            const std::vector<Color> read = sample(made, mip);
            for (size_t i = 0; i < read.size(); ++i) {
                const Color expected = decode(format, &bytes[i * info.bytes_per_block]);
                // Drivers may take sRGB from tables of 8 bits.
                const double tolerance = info.kind == FormatKind::srgb ? 2e-3 : 1e-6;
                for (size_t c = 0; c < 4; ++c)
                    ASSERT_NEAR(read[i][c], expected[c], tolerance) << info.name << ", texel " << i;
            }
        }
    }
    EXPECT_GE(tried, 18);
}

TEST_P(FormatTest, PartsOfFormatsWithOddRowsArePlacedRight) {
    // Rows of 1, 2, 3, 6 bytes, which an API may align.
    for (Format format : {Format::r8_unorm, Format::rg8_unorm, Format::r16_float}) {
        Texture made = texture({.name = "odd", .format = format, .extent = {7, 5, 1}});
        const uint32_t size = format_info(format).bytes_per_block;
        auto whole = random_texels(format, 35, 5);
        must(device().upload(made, whole_mip(made.desc()), whole));
        const auto part = random_texels(format, 9, 6);
        must(device().upload(made, {.x = 3, .y = 1, .extent = {3, 3, 1}}, part));
        for (size_t y = 0; y < 3; ++y)
            std::copy_n(&part[y * 3 * size], 3 * size, &whole[((y + 1) * 7 + 3) * size]);
        EXPECT_EQ(must(device().download(made, whole_mip(made.desc()))), whole);
        const auto read = must(device().download(made, {.x = 3, .y = 1, .extent = {3, 3, 1}}));
        EXPECT_EQ(read, part);
    }
}

/// Bits of a block, lowest first.
struct Bits {
    std::array<uint8_t, 16> bytes{};
    uint32_t at = 0;

    void put(uint64_t value, uint32_t count) {
        for (uint32_t i = 0; i < count; ++i, ++at) bytes[at / 8] |= uint8_t((value >> i & 1) << at % 8);
    }
    std::vector<std::byte> repeat(size_t blocks, size_t size) const {
        std::vector<std::byte> all;
        for (size_t i = 0; i < blocks; ++i)
            for (size_t j = 0; j < size; ++j) all.push_back(std::byte(bytes[j]));
        return all;
    }
};

TEST_P(FormatTest, BlocksOfOneColourDecode) {
    const auto expect = [&](Format format, const Bits& block, const Color& color, double tolerance) {
        if (!has(device().format_caps(format), FormatCaps::sampled)) return;
        // 10 x 6 texels: the last blocks of rows and columns stick out.
        Texture made = texture({.name = "blocks", .format = format, .extent = {10, 6, 1}});
        must(device().upload(made, whole_mip(made.desc()),
                             block.repeat(6, format_info(format).bytes_per_block)));
        for (const Color& read : sample(made, 0))
            for (size_t c = 0; c < 4; ++c)
                ASSERT_NEAR(read[c], color[c], tolerance) << format_info(format).name << ", channel " << c;
    };
    // Both endpoints equal, all indices 0.
    Bits bc1;
    bc1.put(31u << 11 | 21u << 5 | 10u, 16);  // 5:6:5
    bc1.put(0, 16);                           // smaller: indices 0 take the first endpoint, without alpha
    const Color encoded{1, decode_srgb(21 / 63.0), decode_srgb(10 / 31.0), 1};
    expect(Format::bc1_rgba_srgb, bc1, encoded, 5e-3);

    Bits bc3;
    bc3.put(100, 8);
    bc3.put(100, 8);
    bc3.put(0, 48);
    bc3.put(31u << 11 | 21u << 5 | 10u, 16);
    expect(Format::bc3_rgba_srgb, bc3, {encoded[0], encoded[1], encoded[2], 100 / 255.0}, 5e-3);

    Bits bc4;
    bc4.put(77, 8);
    bc4.put(77, 8);
    expect(Format::bc4_r_unorm, bc4, {77 / 255.0, 0, 0, 1}, 1e-3);

    Bits bc5 = bc4;
    bc5.at = 64;
    bc5.put(200, 8);
    bc5.put(200, 8);
    expect(Format::bc5_rg_unorm, bc5, {77 / 255.0, 200 / 255.0, 0, 1}, 1e-3);

    Bits bc6;  // mode 11: endpoints of 10 bits
    bc6.put(3, 5);
    for (int endpoint = 0; endpoint < 2; ++endpoint)
        for (uint32_t channel : {512u, 256u, 0u}) bc6.put(channel, 10);
    // Unquantized to 16 bits, times 31/64, taken as a half.
    const auto half = [](uint32_t x) {
        return x == 0 ? 0.0 : decode_small_float((((x << 16) + 0x8000) >> 10) * 31 / 64, 10);
    };
    expect(Format::bc6h_rgb_float, bc6, {half(512), half(256), 0, 1}, 1e-3);

    Bits bc7;  // mode 6: endpoints of 7 bits and a shared lowest one
    bc7.put(64, 7);
    for (uint32_t channel : {100u, 50u, 25u, 90u}) {
        bc7.put(channel, 7);
        bc7.put(channel, 7);
    }
    bc7.put(3, 2);
    expect(Format::bc7_rgba_unorm, bc7, {201 / 255.0, 101 / 255.0, 51 / 255.0, 181 / 255.0}, 1e-3);
    expect(Format::bc7_rgba_srgb, bc7,
           {decode_srgb(201 / 255.0), decode_srgb(101 / 255.0), decode_srgb(51 / 255.0), 181 / 255.0}, 5e-3);
}

}  // namespace
}  // namespace lumo::rhi
