// Textures of every shape: what is uploaded, copied, cleared, filtered, viewed, stored and sampled.
#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/vec4.hpp>
#include <numeric>

#include "shaders/test_rhi/copy_image.hpp"
#include "shaders/test_rhi/pack.hpp"
#include "shaders/test_rhi/sample_cube.hpp"
#include "shaders/test_rhi/sample_cube_array.hpp"
#include "shaders/test_rhi/sample_d1.hpp"
#include "shaders/test_rhi/sample_d1_array.hpp"
#include "shaders/test_rhi/sample_d2.hpp"
#include "shaders/test_rhi/sample_d2_array.hpp"
#include "shaders/test_rhi/sample_d2_uint.hpp"
#include "shaders/test_rhi/sample_d3.hpp"
#include "shaders/test_rhi/store_cube.hpp"
#include "shaders/test_rhi/store_d1.hpp"
#include "shaders/test_rhi/store_d2.hpp"
#include "shaders/test_rhi/store_d2_array.hpp"
#include "shaders/test_rhi/store_d3.hpp"
#include "shaders/test_rhi/sum_image.hpp"
#include "tests/device/texels.hpp"
#include "tests/support/device_test.hpp"

namespace lumo::rhi {
namespace {

using namespace testing_support;
using namespace shaders::test_rhi;
using enum Dimension;
using testing::Each;

constexpr TextureUsage every_use = TextureUsage::sampled | TextureUsage::storage;

struct TextureTest : DeviceTest {
    /// Samples `view` at `points` through `P`.
    template <class P, Dimension D, class Texel = glm::vec4>
    std::vector<Texel> sample(View<D> view, const Sampler& with, const std::vector<glm::vec4>& points,
                              float lod = 0) {
        Buffer at = buffer_with(points);
        Buffer results = buffer(points.size() * sizeof(Texel));
        run(compute<P>(), {.source = {view, with}, .Points = at.slice(), .Results = results.slice()},
            {.count = uint32_t(points.size()), .lod = lod}, {groups_for(uint32_t(points.size()), 64)});
        return contents<Texel>(results);
    }
    Texture filled(const TextureDesc& desc, const std::function<float(uint32_t mip, uint32_t i)>& value) {
        Texture made = texture(desc);
        for (uint32_t mip = 0; mip < desc.mips; ++mip) {
            const TextureRegion region = whole_mip(desc, mip);
            std::vector<float> texels(region_bytes(desc.format, region) / sizeof(float));
            for (uint32_t i = 0; i < texels.size(); ++i) texels[i] = value(mip, i);
            must(device().upload(made, region, bytes_of(texels)));
        }
        return made;
    }
};
INSTANTIATE_TEST_SUITE_P(Device, TextureTest, both_apis, api_name);

/// One of each shape, with mips where it can have them and sides that are no powers of two.
std::vector<TextureDesc> shapes(Format format = Format::r32_float) {
    return {
        {.name = "1D", .dimension = d1, .format = format, .extent = {13, 1, 1}, .mips = 4},
        {.name = "1D array",
         .dimension = d1_array,
         .format = format,
         .extent = {13, 1, 1},
         .layers = 3,
         .mips = 4},
        {.name = "2D", .dimension = d2, .format = format, .extent = {13, 6, 1}, .mips = 4},
        {.name = "2D array",
         .dimension = d2_array,
         .format = format,
         .extent = {13, 6, 1},
         .layers = 5,
         .mips = 4},
        {.name = "3D", .dimension = d3, .format = format, .extent = {13, 6, 5}, .mips = 4},
        {.name = "cube", .dimension = cube, .format = format, .extent = {10, 10, 1}, .layers = 6, .mips = 4},
        {.name = "cube array",
         .dimension = cube_array,
         .format = format,
         .extent = {10, 10, 1},
         .layers = 12,
         .mips = 4}};
}

TEST_P(TextureTest, EveryShapeKeepsEachMip) {
    for (const TextureDesc& desc : shapes()) {
        Texture made = filled(desc, [](uint32_t mip, uint32_t i) { return 1000.0f * float(mip) + float(i); });
        for (uint32_t mip = 0; mip < desc.mips; ++mip) {
            const std::vector<float> read = texels<float>(made, mip);
            for (uint32_t i = 0; i < read.size(); ++i)
                ASSERT_EQ(read[i], 1000.0f * float(mip) + float(i)) << desc.name << ", mip " << mip;
        }
    }
}

/// The index in a tightly packed mip, slices or layers last.
size_t index_of(const Extent& whole, uint32_t x, uint32_t y, uint32_t slice) {
    return (size_t{slice} * whole.height + y) * whole.width + x;
}

TEST_P(TextureTest, RegionsAreWrittenAndReadAlone) {
    for (const TextureDesc& desc : shapes()) {
        Texture made = filled(desc, [](uint32_t, uint32_t) { return -1.0f; });
        const Extent whole = mip_extent(desc.extent, 1);
        const bool flat = whole.height == 1;
        TextureRegion region{.mip = 1,
                             .first_layer = desc.layers > 1 ? desc.layers - 2 : 0,
                             .layers = desc.layers > 1 ? 2u : 1u,
                             .x = 1,
                             .y = flat ? 0u : 1u,
                             .z = whole.depth > 1 ? 1u : 0u,
                             .extent = {3, flat ? 1u : 2u, 1}};
        std::vector<float> part(region_bytes(desc.format, region) / 4);
        std::iota(part.begin(), part.end(), 1.0f);
        must(device().upload(made, region, bytes_of(part)));
        EXPECT_EQ(values_of<float>(must(device().download(made, region))), part) << desc.name;

        std::vector<float> expected(region_bytes(desc.format, whole_mip(desc, 1)) / 4, -1.0f);
        float value = 1;
        for (uint32_t slice = 0; slice < region.layers * region.extent.depth; ++slice)
            for (uint32_t y = 0; y < region.extent.height; ++y)
                for (uint32_t x = 0; x < region.extent.width; ++x)
                    expected[index_of(whole, region.x + x, region.y + y,
                                      region.first_layer + region.z + slice)] = value++;
        EXPECT_EQ(texels<float>(made, 1), expected) << desc.name;
        EXPECT_THAT(texels<float>(made, 0), Each(-1.0f)) << desc.name;
    }
}

TEST_P(TextureTest, RegionsAreCopiedBetweenTextures) {
    for (const TextureDesc& desc : shapes()) {
        Texture source =
            filled(desc, [](uint32_t mip, uint32_t i) { return 1000.0f * float(mip) + float(i); });
        Texture target = filled(desc, [](uint32_t, uint32_t) { return -1.0f; });
        TextureRegion from = whole_mip(desc, 1);
        from.extent.width = 3;
        TextureRegion to = from;
        to.mip = 0;
        to.x = 2;
        from.x = 1;
        Commands commands = device().begin();
        commands.pass("copy").copy(source, from, target, to);
        device().submit(std::move(commands));
        EXPECT_EQ(must(device().download(target, to)), must(device().download(source, from))) << desc.name;
        std::vector<float> rest = texels<float>(target, 0);
        EXPECT_EQ(std::ranges::count_if(rest, [](float v) { return v != -1.0f; }),
                  std::ptrdiff_t(region_bytes(desc.format, to) / 4))
            << desc.name;
    }
}

TEST_P(TextureTest, CopiesWithinATextureAndBetweenFormats) {
    const TextureDesc desc{.name = "picture", .format = Format::r32_float, .extent = {8, 4, 1}, .mips = 2};
    Texture picture = filled(desc, [](uint32_t mip, uint32_t i) { return float(i) + 100.0f * float(mip); });
    Texture words = texture({.name = "words", .format = Format::rgba8_uint, .extent = {8, 4, 1}});
    Commands commands = device().begin();
    {
        Pass pass = commands.pass("copies");
        pass.copy(picture, {.extent = {4, 4, 1}}, picture, {.x = 4, .extent = {4, 4, 1}});
        pass.copy(picture, {.mip = 1, .extent = {2, 2, 1}}, picture, {.extent = {2, 2, 1}});
        pass.copy(picture, whole_mip(desc), words, whole_mip(desc));
    }
    device().submit(std::move(commands));
    std::vector<float> expected(32);
    for (uint32_t i = 0; i < 32; ++i) expected[i] = float(i % 8 < 4 ? i : i - 4);
    expected[0] = 100;
    expected[1] = 101;
    expected[8] = 104;
    expected[9] = 105;
    EXPECT_EQ(texels<float>(picture), expected);
    EXPECT_EQ(texels<float>(words), expected) << "the bits are copied, not converted";
}

/// Centres of all texels, in the order of their memory; z counts slices for 3D, else layers.
std::vector<glm::vec4> centres(const Extent& whole, uint32_t slices, bool volume) {
    std::vector<glm::vec4> points;
    for (uint32_t z = 0; z < slices; ++z)
        for (uint32_t y = 0; y < whole.height; ++y)
            for (uint32_t x = 0; x < whole.width; ++x)
                points.emplace_back((float(x) + 0.5f) / float(whole.width),
                                    (float(y) + 0.5f) / float(whole.height),
                                    volume ? (float(z) + 0.5f) / float(slices) : float(z), 0);
    return points;
}

/// Directions through all texels of a cube, faces in the order +x -x +y -y +z -z, rows as both
/// specifications have them.
std::vector<glm::vec4> cube_centres(uint32_t side, uint32_t cubes) {
    std::vector<glm::vec4> points;
    for (uint32_t layer = 0; layer < 6 * cubes; ++layer) {
        const uint32_t which = layer / 6;
        for (uint32_t y = 0; y < side; ++y)
            for (uint32_t x = 0; x < side; ++x) {
                const float s = 2 * (float(x) + 0.5f) / float(side) - 1;
                const float t = 2 * (float(y) + 0.5f) / float(side) - 1;
                const glm::vec3 d[] = {{1, -t, -s}, {-1, -t, s}, {s, 1, t},
                                       {s, -1, -t}, {s, -t, 1},  {-s, -t, -1}};
                points.emplace_back(d[layer % 6], float(which));
            }
    }
    return points;
}

template <class Texel>
std::vector<float> reds(const std::vector<Texel>& texels) {
    std::vector<float> red;
    red.reserve(texels.size());
    for (const Texel& texel : texels) red.push_back(float(texel.r));
    return red;
}

TEST_P(TextureTest, EveryShapeIsSampledWhereItsTexelsAre) {
    const auto code = [](uint32_t mip, uint32_t i) { return 10000.0f * float(mip) + float(i); };
    const Sampler nearest = nearest_sampler();
    for (const TextureDesc& desc : shapes()) {
        Texture made = filled(desc, code);
        for (uint32_t mip = 0; mip < desc.mips; ++mip) {
            const Extent whole = mip_extent(desc.extent, mip);
            const auto points = centres(whole, whole.depth * desc.layers, desc.dimension == d3);
            std::vector<glm::vec4> results;
            const float lod = float(mip);
            switch (desc.dimension) {
                case d1:
                    results = sample<sample_d1>(made.view<d1>(), nearest, points, lod);
                    break;
                case d1_array: {
                    auto rows = points;
                    for (auto& point : rows) point.y = point.z;
                    results = sample<sample_d1_array>(made.view<d1_array>(), nearest, rows, lod);
                    break;
                }
                case d2:
                    results = sample<sample_d2>(made.view<d2>(), nearest, points, lod);
                    break;
                case d2_array:
                    results = sample<sample_d2_array>(made.view<d2_array>(), nearest, points, lod);
                    break;
                case d3:
                    results = sample<sample_d3>(made.view<d3>(), nearest, points, lod);
                    break;
                case cube:
                    results =
                        sample<sample_cube>(made.view<cube>(), nearest, cube_centres(whole.width, 1), lod);
                    break;
                default:
                    results = sample<sample_cube_array>(made.view<cube_array>(), nearest,
                                                        cube_centres(whole.width, 2), lod);
            }
            EXPECT_EQ(reds(results), texels<float>(made, mip)) << desc.name << ", mip " << mip;
        }
    }
}

TEST_P(TextureTest, ViewsShowSingleMipsAndLayers) {
    const auto code = [](uint32_t mip, uint32_t i) { return 10000.0f * float(mip) + float(i); };
    const Sampler nearest = nearest_sampler();
    const auto all = shapes();
    Texture array = filled(all[3], code);
    Texture six = filled(all[5], code);
    Texture twelve = filled(all[6], code);

    const auto layer_of = [&](const Texture& from, uint32_t mip, uint32_t first, uint32_t layers = 1) {
        TextureRegion region = whole_mip(from.desc(), mip);
        region.first_layer = first;
        region.layers = layers;
        return values_of<float>(must(device().download(from, region)));
    };
    const auto one = [](uint32_t mip, uint32_t layer) {
        return ViewRange{.first_mip = mip, .mips = 1, .first_layer = layer, .layers = 1};
    };
    const Extent half = mip_extent(all[3].extent, 1);
    EXPECT_EQ(reds(sample<sample_d2>(array.view<d2>(one(1, 3)), nearest, centres(half, 1, false))),
              layer_of(array, 1, 3));
    EXPECT_EQ(reds(sample<sample_d2_array>(
                  array.view<d2_array>({.first_mip = 1, .mips = 2, .first_layer = 2, .layers = 3}), nearest,
                  centres(mip_extent(all[3].extent, 2), 3, false), 1)),
              layer_of(array, 2, 2, 3));
    EXPECT_EQ(reds(sample<sample_d2>(six.view<d2>(one(1, 4)), nearest, centres({5, 5, 1}, 1, false))),
              layer_of(six, 1, 4));
    EXPECT_EQ(reds(sample<sample_d2_array>(six.view<d2_array>(), nearest, centres({10, 10, 1}, 6, false))),
              layer_of(six, 0, 0, 6));
    EXPECT_EQ(reds(sample<sample_cube>(twelve.view<cube>({.first_layer = 6, .layers = 6}), nearest,
                                       cube_centres(10, 1))),
              layer_of(twelve, 0, 6, 6));
}

TEST_P(TextureTest, ViewsReinterpretTexelsOfTheSameSize) {
    Texture bytes = texture({.name = "bytes",
                             .format = Format::rgba8_unorm,
                             .extent = {16, 16, 1},
                             .usage = every_use,
                             .view_formats = {Format::r32_uint, Format::rgba8_srgb}});
    const std::vector<std::byte> texels_in = random_texels(Format::rgba8_unorm, 256, 1);
    must(device().upload(bytes, whole_mip(bytes.desc()), texels_in));
    run(compute<pack>(), {bytes.mip<d2>(0, Format::r32_uint)}, {}, {2, 2});
    std::vector<uint32_t> expected = values_of<uint32_t>(texels_in);
    for (uint32_t& word : expected) word = word * 2 + 1;
    EXPECT_EQ(texels<uint32_t>(bytes), expected);

    const Sampler nearest = nearest_sampler();
    const auto points = centres({16, 16, 1}, 1, false);
    const auto words =
        sample<sample_d2_uint, d2, glm::uvec4>(bytes.view<d2>({.format = Format::r32_uint}), nearest, points);
    const auto unorm = sample<sample_d2>(bytes.view<d2>(), nearest, points);
    const auto srgb = sample<sample_d2>(bytes.view<d2>({.format = Format::rgba8_srgb}), nearest, points);
    for (size_t i = 0; i < 256; ++i) {
        const auto* texel = reinterpret_cast<const std::byte*>(&expected[i]);
        const Color plain = decode(Format::rgba8_unorm, texel);
        const Color linear = decode(Format::rgba8_srgb, texel);
        EXPECT_EQ(words[i].r, expected[i]);
        for (int c = 0; c < 4; ++c) {
            EXPECT_NEAR(unorm[i][c], plain[size_t(c)], 1e-6);
            EXPECT_NEAR(srgb[i][c], linear[size_t(c)], 2e-3) << "drivers may round sRGB";
        }
    }
}

TEST_P(TextureTest, ClearsFillMipsAndLayersAlone) {
    const auto minus = [](uint32_t, uint32_t) { return -1.0f; };
    for (const TextureDesc& desc : shapes()) {
        Texture made = filled(desc, minus);
        ViewRange range{.first_mip = 1, .mips = 2};
        Commands commands = device().begin();
        commands.pass("clear").clear(made.view(range), std::array<float, 4>{0.5f, 0, 0, 0});
        device().submit(std::move(commands));
        EXPECT_THAT(texels<float>(made, 0), Each(-1.0f)) << desc.name;
        EXPECT_THAT(texels<float>(made, 1), Each(0.5f)) << desc.name;
        EXPECT_THAT(texels<float>(made, 2), Each(0.5f)) << desc.name;
        EXPECT_THAT(texels<float>(made, 3), Each(-1.0f)) << desc.name;
    }
    Texture array = filled(shapes()[3], minus);
    Commands commands = device().begin();
    commands.pass("clear").clear(array.view({.mips = 1, .first_layer = 1, .layers = 2}),
                                 std::array<float, 4>{4});
    device().submit(std::move(commands));
    const auto read = texels<float>(array, 0);
    for (size_t i = 0; i < read.size(); ++i) {
        const size_t layer = i / (13 * 6);
        ASSERT_EQ(read[i], layer == 1 || layer == 2 ? 4.0f : -1.0f) << i;
    }
}

TEST_P(TextureTest, ClearsConvertTheirValue) {
    const auto cleared = [&](Format format, const ClearValue& value, Format as = Format::undefined) {
        TextureDesc desc{.name = "cleared", .format = format, .extent = {4, 4, 1}};
        if (as != Format::undefined) desc.view_formats = {as};
        Texture made = texture(desc);
        Commands commands = device().begin();
        commands.pass("clear").clear(made.view({.format = as}), value);
        device().submit(std::move(commands));
        return must(device().download(made, {.x = 3, .y = 2, .extent = {1, 1, 1}}));
    };
    const std::array<float, 4> color{0.25f, 0.5f, 0.75f, 1};
    const auto expect_color = [&](Format format, const std::array<float, 4>& value, double tolerance) {
        const auto bytes = cleared(format, value);
        const Color texel = decode(format, bytes.data());
        for (size_t c = 0; c < format_info(format).channels; ++c)
            EXPECT_NEAR(texel[c], value[c], tolerance) << format_info(format).name;
    };
    expect_color(Format::rgba8_unorm, color, 0.5 / 255 + 1e-6);
    expect_color(Format::rgba8_srgb, color, 0.01);
    expect_color(Format::rgb10a2_unorm, color, 0.5 / 1023 + 1e-6);
    expect_color(Format::rgba16_float, {-3, 1000, 0.5f, 0}, 0);
    expect_color(Format::r11g11b10_float, {4, 0.5f, 2, 1}, 0);
    expect_color(Format::rgba32_float, {-3, 1e9f, 0.1f, 7}, 0);
    expect_color(Format::d32_float, {0.3f}, 0);
    EXPECT_EQ(values_of<uint32_t>(cleared(Format::rgba32_uint, std::array<uint32_t, 4>{1, 2, 3, 0xffffffff})),
              (std::vector<uint32_t>{1, 2, 3, 0xffffffff}));
    EXPECT_EQ(values_of<int32_t>(cleared(Format::r32_sint, std::array<int32_t, 4>{-5})),
              std::vector<int32_t>{-5});
    EXPECT_EQ(values_of<uint16_t>(cleared(Format::r16_uint, std::array<uint32_t, 4>{65535})),
              std::vector<uint16_t>{65535});
    EXPECT_EQ(values_of<uint8_t>(cleared(Format::rgba8_uint, std::array<uint32_t, 4>{1, 2, 3, 255})),
              (std::vector<uint8_t>{1, 2, 3, 255}));
    EXPECT_EQ(values_of<uint32_t>(cleared(Format::r32_uint, ClearValue{})), std::vector<uint32_t>{0});
    EXPECT_EQ(values_of<uint32_t>(cleared(Format::rgba8_unorm, ClearValue{}, Format::r32_uint)),
              std::vector<uint32_t>{0})
        << "through a view in another format";
}

TEST_P(TextureTest, MipsAverageTheTexelsAbove) {
    for (TextureDesc desc : shapes(Format::rgba16_float)) {
        // Even sides, where halving is the plain average of two texels a side.
        desc.extent = {16, desc.extent.height > 1 ? 16u : 1u, desc.extent.depth > 1 ? 16u : 1u};
        desc.mips = 5;
        Texture made = texture(desc);
        must(device().upload(
            made, whole_mip(desc),
            random_texels(desc.format, 16 * desc.extent.height * desc.extent.depth * desc.layers, 7)));
        Commands commands = device().begin();
        commands.pass("mips").generate_mips(made);
        device().submit(std::move(commands));
        for (uint32_t mip = 1; mip < desc.mips; ++mip) {
            const Extent above = mip_extent(desc.extent, mip - 1), own = mip_extent(desc.extent, mip);
            const auto from = must(device().download(made, whole_mip(desc, mip - 1)));
            const auto to = must(device().download(made, whole_mip(desc, mip)));
            const uint32_t slices = own.depth * desc.layers;
            const uint32_t fine_slices = above.depth > 1 ? 2 : 1;
            double worst = 0;
            for (uint32_t z = 0; z < slices; ++z)
                for (uint32_t y = 0; y < own.height; ++y)
                    for (uint32_t x = 0; x < own.width; ++x) {
                        Color mean{};
                        const uint32_t rows = above.height > 1 ? 2 : 1;
                        for (uint32_t k = 0; k < fine_slices * rows * 2; ++k) {
                            const size_t at = index_of(above, 2 * x + k % 2, rows * y + k / 2 % rows,
                                                       fine_slices * z + k / (2 * rows));
                            const Color texel = decode(desc.format, &from[at * 8]);
                            for (size_t c = 0; c < 4; ++c) mean[c] += texel[c] / (fine_slices * rows * 2);
                        }
                        const Color texel = decode(desc.format, &to[index_of(own, x, y, z) * 8]);
                        for (size_t c = 0; c < 4; ++c) worst = std::max(worst, std::abs(texel[c] - mean[c]));
                    }
            EXPECT_LT(worst, 2e-3) << desc.name << ", mip " << mip;
        }
    }
}

TEST_P(TextureTest, ImagesOfEveryShapeAreStored) {
    const auto expect_stored = [&](const TextureDesc& desc, uint32_t mip, const Texture& made, float base) {
        const Extent whole = mip_extent(desc.extent, mip);
        const auto read = texels<float>(made, mip);
        for (uint32_t z = 0; z < whole.depth * desc.layers; ++z)
            for (uint32_t y = 0; y < whole.height; ++y)
                for (uint32_t x = 0; x < whole.width; ++x)
                    ASSERT_EQ(read[index_of(whole, x, y, z)], base + float(x + 16 * y + 256 * z))
                        << desc.name << ", mip " << mip;
    };
    for (TextureDesc desc : shapes()) {
        desc.usage = every_use;
        if (desc.dimension == cube_array || desc.dimension == d1_array) continue;  // no shader here has them
        Texture made = texture(desc);
        for (uint32_t mip = 0; mip < desc.mips; ++mip) {
            const Extent whole = mip_extent(desc.extent, mip);
            const glm::uvec3 size{whole.width, whole.height, whole.depth * desc.layers};
            const Groups groups{groups_for(size.x, 4), groups_for(size.y, 4), groups_for(size.z, 4)};
            const float base = 0.5f + float(mip);
            switch (desc.dimension) {
                case d1:
                    run(compute<store_d1>(), {made.mip<d1>(mip)}, {size, base}, groups);
                    break;
                case d2:
                    run(compute<store_d2>(), {made.mip<d2>(mip)}, {size, base}, groups);
                    break;
                case d3:
                    run(compute<store_d3>(), {made.mip<d3>(mip)}, {size, base}, groups);
                    break;
                case d2_array:
                    run(compute<store_d2_array>(), {made.mip<d2_array>(mip)}, {size, base}, groups);
                    break;
                default:
                    run(compute<store_cube>(), {made.mip<cube>(mip)}, {size, base}, groups);
            }
        }
        for (uint32_t mip = 0; mip < desc.mips; ++mip) expect_stored(desc, mip, made, 0.5f + float(mip));
    }
}

TEST_P(TextureTest, OneLayerOfAnArrayIsStored) {
    TextureDesc desc = shapes()[3];
    desc.usage = every_use;
    Texture made = filled(desc, [](uint32_t, uint32_t) { return -1.0f; });
    run(compute<store_d2>(), {made.view<d2>({.first_mip = 1, .mips = 1, .first_layer = 2, .layers = 1})},
        {{6, 3, 1}, 0}, {2, 1, 1});
    const auto read = texels<float>(made, 1);
    for (uint32_t layer = 0; layer < 5; ++layer)
        for (uint32_t i = 0; i < 18; ++i) {
            const uint32_t stored = i % 6 + 16 * (i / 6);
            ASSERT_EQ(read[layer * 18 + i], layer == 2 ? float(stored) : -1.0f);
        }
}

TEST_P(TextureTest, ImagesAreRead) {
    Texture source = texture({.name = "source",
                              .format = Format::rgba32_float,
                              .extent = {9, 7, 1},
                              .usage = TextureUsage::storage});
    Texture target = texture({.name = "target",
                              .format = Format::rgba32_float,
                              .extent = {9, 7, 1},
                              .usage = TextureUsage::storage});
    const auto bytes = random_texels(Format::rgba32_float, 63, 3);
    must(device().upload(source, whole_mip(source.desc()), bytes));
    run(compute<copy_image>(), {source.mip<d2>(0), target.mip<d2>(0)}, {}, {2, 1});
    auto expected = values_of<glm::vec4>(bytes);
    for (glm::vec4& texel : expected) texel = {texel.w, texel.z, texel.y, texel.x};
    EXPECT_EQ(texels<glm::vec4>(target), expected);
}

TEST_P(TextureTest, ImageAtomicsAddUp) {
    const TextureDesc desc{.name = "counts",
                           .dimension = d3,
                           .format = Format::r32_uint,
                           .extent = {5, 3, 2},
                           .usage = TextureUsage::storage};
    Texture counts = texture(desc);
    const auto pipeline = compute<sum_image>();
    Commands commands = device().begin();
    {
        Pass pass = commands.pass("sum");
        pass.clear(counts.view(), std::array<uint32_t, 4>{10});
        for (int i = 0; i < 3; ++i)
            pass.dispatch(pipeline, {counts.mip<d3>(0)}, {.size = {5, 3, 2}}, {.x = 15, .unordered = true});
    }
    device().submit(std::move(commands));
    EXPECT_THAT(texels<uint32_t>(counts), Each(10u + 3 * 15 * 64 / 30));
}

TEST_P(TextureTest, WhatOneWritesTheNextSamples) {
    // Storage writes, then sampling, then storage again: the layout stays, the barriers must not.
    TextureDesc desc{.name = "both", .format = Format::r32_float, .extent = {8, 8, 1}, .usage = every_use};
    Texture made = texture(desc);
    const auto store = compute<store_d2>();
    const auto read = compute<sample_d2>();
    const Sampler nearest = nearest_sampler();
    const auto points = centres({8, 8, 1}, 1, false);
    Buffer at = buffer_with(points);
    Buffer first = buffer(64 * 16), second = buffer(64 * 16);
    Commands commands = device().begin();
    {
        Pass pass = commands.pass("ping");
        for (int i = 0; i < 2; ++i) {
            pass.dispatch(store, {made.mip<d2>(0)}, {{8, 8, 1}, 100.0f * float(i)}, {2, 2, 1});
            pass.dispatch(read,
                          {.source = {made.view<d2>(), nearest},
                           .Points = at.slice(),
                           .Results = (i ? second : first).slice()},
                          {.count = 64, .lod = 0}, {1});
        }
    }
    device().submit(std::move(commands));
    const auto a = contents<glm::vec4>(first), b = contents<glm::vec4>(second);
    for (uint32_t i = 0; i < 64; ++i) {
        const uint32_t stored = i % 8 + 16 * (i / 8);
        EXPECT_EQ(a[i].r, float(stored));
        EXPECT_EQ(b[i].r, a[i].r + 100);
    }
}

}  // namespace
}  // namespace lumo::rhi
