// Drawing: where fragments land, what they write, and how targets combine it.
#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <numeric>

#include "shaders/test_rhi/arguments.hpp"
#include "shaders/test_rhi/layered.hpp"
#include "shaders/test_rhi/pull.hpp"
#include "shaders/test_rhi/sample_multisample.hpp"
#include "shaders/test_rhi/several.hpp"
#include "shaders/test_rhi/tally.hpp"
#include "tests/device/texels.hpp"
#include "tests/support/device_test.hpp"

namespace lumo::rhi {
namespace {

using namespace testing_support;
using namespace shaders::test_rhi;
using enum Dimension;
using testing::Each;
using testing::ElementsAre;

struct Vertex {
    glm::vec4 position;
    glm::vec4 color{1, 1, 1, 1};
};

constexpr TextureUsage target_use = TextureUsage::attachment | TextureUsage::sampled;

struct RasterTest : DeviceTest {
    static constexpr uint32_t side = 16;
    const pull::Push white{.tint = {1, 1, 1, 1}, .offset = {0, 0}};

    Texture target(Format format = Format::rgba32_float, uint32_t samples = 1) {
        return texture({.name = "target",
                        .dimension = samples > 1 ? d2_multisample : d2,
                        .format = format,
                        .extent = {side, side, 1},
                        .samples = samples,
                        .usage = target_use});
    }
    static RasterState state(Format format = Format::rgba32_float) {
        return {.color = {{.format = format}}, .cull = CullMode::none};
    }
    /// Draws `vertices` into `into`, cleared to `clear`.
    void draw(const Texture& into, const RasterState& with, const std::vector<Vertex>& vertices,
              const std::array<float, 4>& clear = {}) {
        Buffer data = buffer_with(vertices);
        const auto pipeline = raster<pull>(with);
        Commands commands = device().begin();
        RasterPass pass = commands.raster_pass("draw", {.color = {{.view = into.view(), .clear = clear}}});
        pass.draw(pipeline, {data.slice()}, white, Draw{.vertices = uint32_t(vertices.size())});
    }
    std::vector<float> reds(const Texture& from) {
        std::vector<float> red;
        for (const glm::vec4& texel : texels<glm::vec4>(from)) red.push_back(texel.r);
        return red;
    }
    static std::vector<float> grid(const std::function<float(uint32_t x, uint32_t y)>& value) {
        std::vector<float> values;
        for (uint32_t y = 0; y < side; ++y)
            for (uint32_t x = 0; x < side; ++x) values.push_back(value(x, y));
        return values;
    }
};
INSTANTIATE_TEST_SUITE_P(Device, RasterTest, both_apis, api_name);

/// Two triangles over a rectangle of NDC, counter-clockwise with +y up.
std::vector<Vertex> rectangle(glm::vec2 low, glm::vec2 high, float z = 0.5f, glm::vec4 color = {1, 1, 1, 1}) {
    const glm::vec4 a{low.x, low.y, z, 1}, b{high.x, low.y, z, 1}, c{high.x, high.y, z, 1},
        d{low.x, high.y, z, 1};
    return {{a, color}, {b, color}, {c, color}, {a, color}, {c, color}, {d, color}};
}

TEST_P(RasterTest, RowZeroOfMemoryIsTheBottomOfNdc) {
    Texture into = target();
    draw(into, state(), rectangle({-1, -1}, {0.5f, -0.5f}));
    EXPECT_EQ(reds(into), grid([](uint32_t x, uint32_t y) { return x < 12 && y < 4 ? 1.0f : 0.0f; }));
}

TEST_P(RasterTest, FrontFacesAreCounterClockwiseWithUpwardY) {
    const auto ccw = rectangle({-1, -1}, {0, 1});
    std::vector<Vertex> both = ccw;
    auto cw = rectangle({0, -1}, {1, 1});
    std::ranges::reverse(cw);
    both.insert(both.end(), cw.begin(), cw.end());
    for (CullMode cull : {CullMode::none, CullMode::back, CullMode::front}) {
        Texture into = target();
        RasterState with = state();
        with.cull = cull;
        draw(into, with, both);
        EXPECT_EQ(reds(into), grid([&](uint32_t x, uint32_t) {
                      return cull == CullMode::none || (x < 8) == (cull == CullMode::back) ? 1.0f : 0.0f;
                  }));
    }
}

TEST_P(RasterTest, FragmentsKnowTheirPlaceInTargetsOfSeveralKinds) {
    Texture where = target();
    Texture which = target(Format::rgba32_uint);
    Texture facing = target(Format::rgba8_unorm);
    const auto pipeline = raster<several>({.color = {{.format = Format::rgba32_float},
                                                     {.format = Format::rgba32_uint},
                                                     {.format = Format::rgba8_unorm}}});
    Commands commands = device().begin();
    {
        RasterPass pass = commands.raster_pass(
            "several", {.color = {{.view = where.view()},
                                  {.view = which.view(), .clear = std::array<uint32_t, 4>{9, 9, 9, 9}},
                                  {.view = facing.view()}}});
        pass.draw(pipeline, {}, {}, Draw{.vertices = 3});
    }
    device().submit(std::move(commands));
    const auto places = texels<glm::vec4>(where);
    const auto words = texels<glm::uvec4>(which);
    for (uint32_t y = 0; y < side; ++y)
        for (uint32_t x = 0; x < side; ++x) {
            EXPECT_EQ(places[y * side + x], glm::vec4(float(x) + 0.5f, float(y) + 0.5f, 0.25f, 1));
            EXPECT_EQ(words[y * side + x], glm::uvec4(x + 100 * y, 0, 0, 0xffffffff));
        }
    EXPECT_THAT(texels<uint32_t>(facing), Each(0xff00ff00)) << "facing front: green";
}

TEST_P(RasterTest, LoadsClearKeepAndMask) {
    Texture into = target();
    Buffer data = buffer_with(rectangle({-1, -1}, {0, 1}, 0.5f, {0.5f, 0.5f, 0.5f, 0.5f}));
    RasterState with = state();
    with.color[0].write_mask = 0b0101;
    const auto masked = raster<pull>(with);
    Commands commands = device().begin();
    {
        commands.raster_pass("clear",
                             {.color = {{.view = into.view(), .clear = std::array<float, 4>{1, 2, 3, 4}}}});
        RasterPass pass =
            commands.raster_pass("keep", {.color = {{.view = into.view(), .load = Load::keep}}});
        pass.draw(masked, {data.slice()}, white, Draw{.vertices = 6});
    }
    device().submit(std::move(commands));
    const auto read = texels<glm::vec4>(into);
    EXPECT_EQ(read[0], glm::vec4(0.5f, 2, 0.5f, 4));
    EXPECT_EQ(read[side - 1], glm::vec4(1, 2, 3, 4));
}

TEST_P(RasterTest, DepthIsComparedAndWritten) {
    for (Compare compare : {Compare::less, Compare::greater, Compare::always, Compare::never, Compare::equal,
                            Compare::less_equal, Compare::greater_equal, Compare::not_equal}) {
        for (bool write : {true, false}) {
            Texture color = target();
            Texture depth = target(Format::d32_float);
            std::vector<Vertex> vertices = rectangle({-1, -1}, {-0.5f, 1}, 0.25f);
            for (const auto& more :
                 {rectangle({-0.5f, -1}, {0, 1}, 0.5f), rectangle({0, -1}, {0.5f, 1}, 0.75f)})
                vertices.insert(vertices.end(), more.begin(), more.end());
            Buffer data = buffer_with(vertices);
            RasterState with = state();
            with.depth = DepthState{.write = write, .compare = compare};
            const auto pipeline = raster<pull>(with);
            Commands commands = device().begin();
            {
                RasterPass pass = commands.raster_pass(
                    "depth", {.color = {{.view = color.view()}},
                              .depth = DepthTarget{.view = depth.view(), .clear = 0.5f}});
                pass.draw(pipeline, {data.slice()}, white, Draw{.vertices = 18});
            }
            device().submit(std::move(commands));
            const auto passes = [&](float z) {
                switch (compare) {
                    case Compare::less:
                        return z < 0.5f;
                    case Compare::greater:
                        return z > 0.5f;
                    case Compare::always:
                        return true;
                    case Compare::never:
                        return false;
                    case Compare::equal:
                        return z == 0.5f;
                    case Compare::less_equal:
                        return z <= 0.5f;
                    case Compare::greater_equal:
                        return z >= 0.5f;
                    default:
                        return z != 0.5f;
                }
            };
            const auto z_at = [](uint32_t x) { return x < 4 ? 0.25f : x < 8 ? 0.5f : 0.75f; };
            EXPECT_EQ(reds(color),
                      grid([&](uint32_t x, uint32_t) { return x < 12 && passes(z_at(x)) ? 1.0f : 0.0f; }));
            EXPECT_EQ(texels<float>(depth), grid([&](uint32_t x, uint32_t) {
                          return write && x < 12 && passes(z_at(x)) ? z_at(x) : 0.5f;
                      }));
        }
    }
}

TEST_P(RasterTest, DepthOutsideIsClippedOrClampedAndBiasMovesIt) {
    const auto depth_of = [&](const DepthState& depth_state, bool clamp, float z) {
        Texture depth = target(Format::d32_float);
        Buffer data = buffer_with(rectangle({-1, -1}, {1, 1}, z));
        const auto pipeline =
            raster<pull>({.depth = depth_state, .cull = CullMode::none, .depth_clamp = clamp});
        Commands commands = device().begin();
        {
            RasterPass pass =
                commands.raster_pass("depth", {.depth = DepthTarget{.view = depth.view(), .clear = 0.5f}});
            pass.draw(pipeline, {data.slice()}, white, Draw{.vertices = 6});
        }
        device().submit(std::move(commands));
        return texels<float>(depth)[17];
    };
    const DepthState always{.compare = Compare::always};
    EXPECT_EQ(depth_of(always, false, 1.5f), 0.5f) << "clipped";
    EXPECT_EQ(depth_of(always, false, -0.5f), 0.5f) << "depth begins at 0, not at -1";
    EXPECT_EQ(depth_of(always, true, 1.5f), 1.0f);
    EXPECT_EQ(depth_of(always, true, -0.5f), 0.0f);
    EXPECT_EQ(depth_of(always, false, 0.75f), 0.75f);
    DepthState biased = always;
    biased.bias_constant = 1 << 20;
    EXPECT_NEAR(depth_of(biased, false, 0.75f), 0.75f + float(1 << 20) * 0x1p-24f, 1e-3);
}

TEST_P(RasterTest, BlendingFollowsItsEquations) {
    const glm::vec4 source{0.5f, 0.25f, 0.75f, 0.25f};
    const std::array<float, 4> under{0.25f, 1, 0.5f, 0.5f};
    using enum BlendFactor;
    const BlendFactor factors[] = {zero,
                                   one,
                                   source_alpha,
                                   one_minus_source_alpha,
                                   destination_alpha,
                                   one_minus_destination_alpha,
                                   source_color,
                                   destination_color};
    const auto weight = [&](BlendFactor factor, int c) {
        switch (factor) {
            case zero:
                return 0.0f;
            case one:
                return 1.0f;
            case source_alpha:
                return source.a;
            case one_minus_source_alpha:
                return 1 - source.a;
            case destination_alpha:
                return under[3];
            case one_minus_destination_alpha:
                return 1 - under[3];
            case source_color:
                return source[c];
            default:
                return under[size_t(c)];
        }
    };
    const auto combine = [&](BlendOp op, BlendFactor a, BlendFactor b, int c) {
        const float s = source[c], d = under[size_t(c)];
        switch (op) {
            case BlendOp::add:
                return s * weight(a, c) + d * weight(b, c);
            case BlendOp::subtract:
                return s * weight(a, c) - d * weight(b, c);
            case BlendOp::minimum:
                return std::min(s, d);
            default:
                return std::max(s, d);
        }
    };
    std::vector<BlendState> states;
    for (BlendFactor a : factors)
        for (BlendFactor b : {one, one_minus_source_alpha})
            states.push_back(
                {.source_color = a, .destination_color = b, .source_alpha = b, .destination_alpha = a});
    for (BlendOp op : {BlendOp::subtract, BlendOp::minimum, BlendOp::maximum})
        states.push_back(
            {.source_color = one, .destination_color = source_alpha, .color_op = op, .alpha_op = op});
    for (const BlendState& blend : states) {
        Texture into = target(Format::rgba16_float);
        RasterState with = state(Format::rgba16_float);
        with.color[0].blend = blend;
        draw(into, with, rectangle({-1, -1}, {1, 1}, 0.5f, source), under);
        const auto bytes = must(device().download(into, {.x = 5, .y = 5, .extent = {1, 1, 1}}));
        const Color read = decode(Format::rgba16_float, bytes.data());
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(read[size_t(c)],
                        combine(blend.color_op, blend.source_color, blend.destination_color, c), 1e-3)
                << int(blend.source_color) << " " << int(blend.destination_color) << " "
                << int(blend.color_op);
        EXPECT_NEAR(read[3], combine(blend.alpha_op, blend.source_alpha, blend.destination_alpha, 3), 1e-3);
    }
}

TEST_P(RasterTest, SamplesAreAveraged) {
    constexpr uint32_t samples = 4;
    ASSERT_GE(device().info().limits.max_samples, samples);
    const Format format = Format::rgba16_float;
    Texture several_samples = target(format, samples);
    Texture one = target(format);
    RasterState with = state(format);
    with.samples = samples;
    // A slanted edge, so that pixels are covered in part.
    const std::vector<Vertex> half{{{-1, -1, 0.5f, 1}}, {{0.3f, -1, 0.5f, 1}}, {{-0.7f, 1, 0.5f, 1}},
                                   {{-1, -1, 0.5f, 1}}, {{-0.7f, 1, 0.5f, 1}}, {{-1, 1, 0.5f, 1}}};
    Buffer data = buffer_with(half);
    const auto pipeline = raster<pull>(with);
    std::vector<Buffer> per_sample;
    Commands commands = device().begin();
    {
        RasterPass pass = commands.raster_pass(
            "samples", {.color = {{.view = several_samples.view(), .resolve = one.view()}}});
        pass.draw(pipeline, {data.slice()}, white, Draw{.vertices = 6});
    }
    {
        Pass pass = commands.pass("each sample");
        const auto fetch = compute<sample_multisample>();
        const Sampler nearest = nearest_sampler();
        for (uint32_t i = 0; i < samples; ++i) {
            per_sample.push_back(buffer(side * side * sizeof(glm::vec4)));
            pass.dispatch(fetch,
                          {.source = {several_samples.view<d2_multisample>(), nearest},
                           .Results = per_sample.back().slice()},
                          {.size = {side, side}, .index = int32_t(i)}, {2, 2});
        }
    }
    device().submit(std::move(commands));
    std::vector<double> mean(side * side, 0);
    for (const Buffer& sample : per_sample) {
        const auto values = contents<glm::vec4>(sample);
        for (size_t i = 0; i < mean.size(); ++i) mean[i] += double(values[i].r) / samples;
    }
    const auto resolved = must(device().download(one, whole_mip(one.desc())));
    int partial = 0;
    for (size_t i = 0; i < mean.size(); ++i) {
        EXPECT_NEAR(decode(format, &resolved[i * 8])[0], mean[i], 1e-3) << i;
        partial += mean[i] > 0 && mean[i] < 1;
    }
    EXPECT_GT(partial, 4);
    EXPECT_EQ(mean[0], 1);
    EXPECT_EQ(mean[side - 1], 0);
}

TEST_P(RasterTest, AGeometryShaderFillsLayers) {
    ASSERT_TRUE(device().info().geometry_shader);
    Texture layers = texture({.name = "layers",
                              .dimension = d2_array,
                              .format = Format::rgba32_float,
                              .extent = {8, 4, 1},
                              .layers = 6,
                              .mips = 2,
                              .usage = target_use});
    Texture faces = texture({.name = "faces",
                             .dimension = cube,
                             .format = Format::rgba32_float,
                             .extent = {4, 4, 1},
                             .layers = 6,
                             .usage = target_use});
    const auto pipeline = raster<layered>(state());
    Commands commands = device().begin();
    for (const TextureView& view :
         {TextureView(layers.view({.first_mip = 1, .mips = 1, .first_layer = 2, .layers = 3})),
          TextureView(faces.view())}) {
        RasterPass pass = commands.raster_pass("layers", {.color = {{.view = view}}});
        pass.draw(pipeline, {}, {.layers = int32_t(view.layers)}, Draw{.vertices = 3});
    }
    device().submit(std::move(commands));
    TextureRegion region = whole_mip(layers.desc(), 1);
    region.first_layer = 2;
    region.layers = 3;
    const auto read = values_of<glm::vec4>(must(device().download(layers, region)));
    for (size_t i = 0; i < read.size(); ++i) {
        const size_t layer = i / 8, x = i % 4;
        EXPECT_EQ(read[i], glm::vec4(float(layer) + 1, float(x) + 0.5f, 0, 1)) << i;
    }
    const auto face = texels<glm::vec4>(faces);
    for (size_t i = 0; i < face.size(); ++i) {
        const size_t layer = i / 16;
        EXPECT_EQ(face[i].r, float(layer) + 1);
    }
}

TEST_P(RasterTest, WithoutTargetsTheExtentIsTheRasters) {
    Buffer tallied = buffer(4);
    const auto pipeline = raster<tally>({.cull = CullMode::none});
    Commands commands = device().begin();
    commands.pass("zero").fill(tallied.slice());
    {
        RasterPass pass = commands.raster_pass("tally", {.extent = {37, 21, 1}});
        pass.draw(pipeline, {tallied.slice()}, {}, Draw{.vertices = 3});
        pass.draw(pipeline, {tallied.slice()}, {}, Draw{.vertices = 3, .instances = 2});
        pass.viewport({.x = 5, .y = 3, .width = 10, .height = 7});
        pass.draw(pipeline, {tallied.slice()}, {}, Draw{.vertices = 3});
    }
    device().submit(std::move(commands));
    EXPECT_THAT(contents<uint32_t>(tallied), ElementsAre(37u * 21 * 3 + 70));
}

TEST_P(RasterTest, ViewportsPlaceAndClip) {
    Texture into = target();
    // Larger than the viewport: what lies outside is cut off.
    Buffer data = buffer_with(rectangle({-3, -3}, {0, 3}));
    const auto pipeline = raster<pull>(state());
    Commands commands = device().begin();
    {
        RasterPass pass = commands.raster_pass("viewport", {.color = {{.view = into.view()}}});
        pass.viewport({.x = 4, .y = 2, .width = 8, .height = 6});
        pass.draw(pipeline, {data.slice()}, white, Draw{.vertices = 6});
    }
    device().submit(std::move(commands));
    EXPECT_EQ(reds(into),
              grid([](uint32_t x, uint32_t y) { return x >= 4 && x < 8 && y >= 2 && y < 8 ? 1.0f : 0.0f; }));
}

TEST_P(RasterTest, IndicesInstancesAndOffsetsSelectVertices) {
    // Squares of a quarter of the target's width, one per four vertices, red by their number.
    std::vector<Vertex> vertices(2);
    for (int i = 0; i < 4; ++i) {
        const float x = -1 + 0.5f * float(i);
        const glm::vec4 color{float(i + 1), 0, 0, 1};
        for (glm::vec2 corner : {glm::vec2(0, -1), glm::vec2(0.5f, -1), glm::vec2(0.5f, 0), glm::vec2(0, 0)})
            vertices.push_back({{x + corner.x, corner.y, 0.5f, 1}, color});
    }
    Buffer data = buffer_with(vertices);
    const std::vector<uint32_t> order{77, 77, 0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7};
    std::vector<uint16_t> narrow(order.begin(), order.end());
    Buffer wide = buffer_with(order, BufferUsage::index);
    Buffer slim = buffer_with(narrow, BufferUsage::index);
    Buffer arguments_buffer = buffer(256, BufferUsage::storage | BufferUsage::indirect);
    const auto pipeline = raster<pull>(state());
    const auto write = compute<arguments>();
    const pull::Push up{.tint = {1, 1, 1, 1}, .offset = {0, 1}};

    // Squares `first` and `first` + 1, in both halves: two instances, the second one higher.
    const auto expected = [](uint32_t first) {
        return grid([first](uint32_t x, uint32_t) {
            const uint32_t square = x / 4;
            return square == first || square == first + 1 ? float(square + 1) : 0.0f;
        });
    };
    const auto drawn = [&](auto&& record) {
        Texture into = target();
        Commands commands = device().begin();
        {
            Pass pass = commands.pass("arguments");
            const uint64_t step = std::max(64u, device().info().limits.storage_alignment);
            pass.dispatch(write, {arguments_buffer.slice(0, 20)}, {.words = {12, 2, 2, 6}, .last = 0}, {});
            if (step + 20 <= arguments_buffer.size())
                pass.dispatch(write, {arguments_buffer.slice(step, 20)}, {.words = {0, 0, 0, 0}, .last = 0},
                              {});
        }
        {
            RasterPass pass = commands.raster_pass("draw", {.color = {{.view = into.view()}}});
            record(pass);
        }
        device().submit(std::move(commands));
        return reds(into);
    };
    EXPECT_EQ(
        drawn([&](RasterPass& pass) {
            pass.draw(
                pipeline, {data.slice()}, up,
                DrawIndexed{
                    .indices = wide.slice(), .count = 12, .instances = 2, .first = 2, .vertex_offset = 2});
        }),
        expected(0));
    EXPECT_EQ(drawn([&](RasterPass& pass) {
                  pass.draw(pipeline, {data.slice()}, up,
                            DrawIndexed{.indices = slim.slice(4, 24),
                                        .type = IndexType::uint16,
                                        .count = 12,
                                        .instances = 2,
                                        .vertex_offset = 10});
              }),
              expected(2));
    EXPECT_EQ(drawn([&](RasterPass& pass) {
                  pass.draw(
                      pipeline, {data.slice()}, up,
                      DrawIndirect{.arguments = arguments_buffer.slice(0, 20), .indices = wide.slice()});
              }),
              expected(1))
        << "12 indices, 2 instances, from index 2, vertices from 6";
}

TEST_P(RasterTest, SeveralIndirectDrawsWithoutIndices) {
    std::vector<Vertex> vertices = rectangle({-1, -1}, {-0.5f, 1}, 0.5f, {1, 0, 0, 1});
    for (const auto& more : {rectangle({-0.5f, -1}, {0, 1}, 0.5f, {2, 0, 0, 1}),
                             rectangle({0, -1}, {0.5f, 1}, 0.5f, {3, 0, 0, 1})})
        vertices.insert(vertices.end(), more.begin(), more.end());
    Buffer data = buffer_with(vertices);
    Buffer args =
        buffer_with(std::vector<uint32_t>{0, 0, 0, 0, 6, 1, 12, 0, 6, 1, 0, 0}, BufferUsage::indirect);
    Texture into = target();
    const auto pipeline = raster<pull>(state());
    Commands commands = device().begin();
    {
        RasterPass pass = commands.raster_pass("draw", {.color = {{.view = into.view()}}});
        pass.draw(pipeline, {data.slice()}, white, DrawIndirect{.arguments = args.slice(16, 32), .draws = 2});
    }
    device().submit(std::move(commands));
    EXPECT_EQ(reds(into), grid([](uint32_t x, uint32_t) {
                  return x < 4 ? 1.0f : x >= 8 && x < 12 ? 3.0f : 0.0f;
              }));
}

TEST_P(RasterTest, TopologiesMakeTheirShapes) {
    const auto covered = [&](Topology topology, const std::vector<Vertex>& vertices) {
        Texture into = target();
        RasterState with = state();
        with.topology = topology;
        draw(into, with, vertices);
        const auto red = reds(into);
        return std::ranges::count(red, 1.0f);
    };
    const auto at = [](uint32_t x, uint32_t y) {
        return Vertex{{(float(x) + 0.5f) / 8 - 1, (float(y) + 0.5f) / 8 - 1, 0.5f, 1}};
    };
    EXPECT_EQ(covered(Topology::points, {at(1, 2), at(5, 5), at(15, 15)}), 3);
    EXPECT_NEAR(double(covered(Topology::lines, {at(1, 2), at(11, 2)})), 10, 1);
    const auto corner = [](float x, float y) { return Vertex{{x, y, 0.5f, 1}}; };
    EXPECT_EQ(covered(Topology::triangle_strip, {corner(-1, -1), corner(1, -1), corner(-1, 1), corner(1, 1)}),
              256);
    EXPECT_EQ(covered(Topology::triangles, rectangle({-1, -1}, {1, 0})), 128);
}

TEST_P(RasterTest, WhatIsDrawnIsSampledByTheNextDraw) {
    // Attachment, then copy, then attachment again, within one submission.
    Texture into = target();
    Texture copy = target();
    Buffer data = buffer_with(rectangle({-1, -1}, {0, 1}));
    const auto pipeline = raster<pull>(state());
    Commands commands = device().begin();
    for (float shade : {0.25f, 0.75f}) {
        {
            RasterPass pass = commands.raster_pass("draw", {.color = {{.view = into.view()}}});
            pass.draw(pipeline, {data.slice()}, {.tint = {shade, 0, 0, 1}, .offset = {0, 0}},
                      Draw{.vertices = 6});
        }
        if (shade < 0.5f)
            commands.pass("copy").copy(into, whole_mip(into.desc()), copy, whole_mip(copy.desc()));
    }
    device().submit(std::move(commands));
    EXPECT_EQ(reds(copy)[0], 0.25f);
    EXPECT_EQ(reds(into)[0], 0.75f);
    EXPECT_EQ(reds(into)[side - 1], 0);
}

}  // namespace
}  // namespace lumo::rhi
