// Each rule of the RHI broken once: the named check arrives, with the resource's name in its text, and nothing
// reaches the backend.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/rhi_fake_backend.hpp"
#include "tests/unit/rhi_fake_programs.hpp"

namespace lumo::rhi {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using enum Dimension;

struct Checks : testing::Test {
    fake::State state;
    std::vector<Message> messages;
    std::optional<Device> device;

    Checks() {
        device.emplace(std::make_unique<fake::FakeBackend>(state),
                       DeviceDesc{.sink = [this](const Message& message) { messages.push_back(message); }});
    }

    Buffer buffer(std::string name, BufferUsage usage = BufferUsage::storage, uint64_t size = 1024) {
        return std::move(
            device->create_buffer({.name = std::move(name), .size = size, .usage = usage}).value());
    }
    Texture texture(const TextureDesc& desc) { return std::move(device->create_texture(desc).value()); }
    Sampler sampler(SamplerDesc desc = {}) { return std::move(device->create_sampler(desc).value()); }

    /// Records `work` (Pass&) and expects one message of this check that names `what`.
    template <class Work>
    void expect(Check check, std::string_view what, Work work) {
        messages.clear();
        {
            Commands commands = device->begin();
            Pass pass = commands.pass("test");
            work(pass);
        }
        expect_message(check, what);
        EXPECT_THAT(state.passes.back().commands, IsEmpty());
    }
    template <class Work>
    void expect_raster(Check check, std::string_view what, const RasterTargets& targets, Work work) {
        messages.clear();
        const size_t passes = state.passes.size();
        {
            Commands commands = device->begin();
            RasterPass pass = commands.raster_pass("test", targets);
            work(pass);
        }
        expect_message(check, what);
        if (state.passes.size() > passes) {
            EXPECT_THAT(state.passes.back().commands, IsEmpty());
        }
    }
    void expect_message(Check check, std::string_view what) {
        ASSERT_THAT(messages, SizeIs(1)) << to_string(check);
        EXPECT_EQ(messages[0].check, check) << messages[0].text;
        EXPECT_EQ(messages[0].id, to_string(check));
        EXPECT_TRUE(is_failure(messages[0]));
        EXPECT_THAT(messages[0].text, HasSubstr(std::string(what)));
    }
};

TEST(CheckNames, AreAllDifferent) {
    std::set<std::string_view> names;
    for (int i = 0; i <= int(Check::leaked_resource); ++i) names.insert(to_string(Check(i)));
    EXPECT_EQ(names.size(), size_t(Check::leaked_resource) + 1);
    EXPECT_EQ(names.count("unknown"), 0u);
}

TEST_F(Checks, Buffers) {
    auto store = std::move(device->create_compute_pipeline<fake::Store>().value());
    Buffer data = buffer("data");
    Buffer plain = buffer("plain", BufferUsage::index);
    const auto dispatch = [&](BufferSlice slice) {
        return [&, slice](Pass& pass) { pass.dispatch(store, {slice}, {}, {}); };
    };
    expect(Check::missing_usage, "plain", dispatch(plain.slice()));
    expect(Check::buffer_out_of_range, "data", dispatch(data.slice(0, 1025)));
    expect(Check::buffer_out_of_range, "data", dispatch(data.slice(2048, 16)));
    expect(Check::buffer_out_of_range, "data", dispatch(data.slice(256, ~uint64_t{0})));
    expect(Check::buffer_alignment, "data", dispatch(data.slice(4, 16)));
    expect(Check::buffer_too_small, "data", dispatch(data.slice(0, 12)));
    expect(Check::empty_work, "data", dispatch(data.slice(0, 0)));
    expect(Check::stale_handle, "buffer", dispatch({}));
    BufferSlice gone = data.slice();
    data = {};
    expect(Check::stale_handle, "target", dispatch(gone));
    state.info.limits.max_storage_bytes = 512;
    data = buffer("data");
    expect(Check::work_too_large, "data", dispatch(data.slice()));
}

TEST_F(Checks, UniformBuffers) {
    auto count = std::move(device->create_compute_pipeline<fake::Count>().value());
    Buffer source = buffer("source");
    Buffer counter = buffer("counter");
    Buffer settings = buffer("settings", BufferUsage::uniform);
    state.info.limits.max_uniform_bytes = 512;
    const auto dispatch = [&](BufferSlice slice) {
        return [&, slice](Pass& pass) {
            pass.dispatch(count, {source.slice(), counter.slice(), slice}, {}, {});
        };
    };
    expect(Check::missing_usage, "source", dispatch(source.slice()));
    expect(Check::buffer_alignment, "settings", dispatch(settings.slice(16, 16)));
    expect(Check::buffer_too_small, "settings", dispatch(settings.slice(0, 8)));
    expect(Check::work_too_large, "settings", dispatch(settings.slice()));
}

TEST_F(Checks, TexturesAndImages) {
    auto convert = std::move(device->create_compute_pipeline<fake::Convert>().value());
    const TextureUsage both = TextureUsage::sampled | TextureUsage::storage;
    Texture source = texture({.name = "source", .extent = {8, 8, 1}, .mips = 2});
    Texture target =
        texture({.name = "target", .format = Format::r32_uint, .extent = {8, 8, 1}, .usage = both});
    Texture floats = texture({.name = "floats", .extent = {8, 8, 1}, .usage = both});
    Texture bytes = texture(
        {.name = "bytes", .extent = {8, 8, 1}, .mips = 2, .usage = both, .view_formats = {Format::r32_uint}});
    Texture layers = texture({.name = "layers", .dimension = d2_array, .extent = {8, 8, 1}, .layers = 3});
    Texture volume = texture({.name = "volume", .dimension = d3, .extent = {8, 8, 8}});
    Texture whole = texture({.name = "whole", .format = Format::r16_uint, .extent = {8, 8, 1}});
    Sampler nearest = sampler({.magnification = FilterMode::nearest, .minification = FilterMode::nearest});
    Sampler linear = sampler();

    const auto dispatch = [&](View<d2> view, View<d2> image, SamplerHandle with) {
        return [&, view, image, with](Pass& pass) { pass.dispatch(convert, {{view, with}, image}, {}, {}); };
    };
    const View<d2> in = source.view<d2>();
    const View<d2> out = target.mip<d2>(0);
    {
        Commands commands = device->begin();
        Pass pass = commands.pass("fine");
        dispatch(in, out, linear)(pass);
        dispatch(layers.view<d2>({.first_layer = 1, .layers = 1}), bytes.mip<d2>(1, Format::r32_uint),
                 linear)(pass);
        EXPECT_THAT(messages, IsEmpty());
    }

    expect(Check::missing_usage, "source", dispatch(in, source.mip<d2>(0), linear));
    expect(Check::view_out_of_range, "source",
           dispatch(source.view<d2>({.first_mip = 1, .mips = 2}), out, linear));
    expect(Check::view_out_of_range, "source",
           dispatch(source.view<d2>({.first_mip = 2, .mips = 1}), out, linear));
    expect(Check::view_out_of_range, "layers",
           dispatch(layers.view<d2>({.first_layer = 3, .layers = 1}), out, linear));
    expect(Check::view_dimension, "layers", dispatch(layers.view<d2>(), out, linear));
    expect(Check::view_dimension, "volume", dispatch(volume.view<d2>(), out, linear));
    expect(Check::view_format, "source",
           dispatch(source.view<d2>({.format = Format::r32_uint}), out, linear));
    expect(Check::view_out_of_range, "bytes",
           dispatch(in, bytes.view<d2>({.format = Format::r32_uint}), linear));
    expect(Check::texel_kind, "floats", dispatch(in, floats.mip<d2>(0), linear));
    expect(Check::texel_kind, "whole", dispatch(whole.view<d2>(), out, nearest));
    expect(Check::stale_handle, "sampler", dispatch(in, out, {}));
    expect(Check::stale_handle, "texture", dispatch({}, out, linear));

    state.caps[Format::rgba8_unorm] = FormatCaps::sampled;
    expect(Check::format_unsupported, "source", dispatch(in, out, linear));
    const FilterMode n = FilterMode::nearest, l = FilterMode::linear;
    for (const SamplerDesc& filters :
         {SamplerDesc{.magnification = l, .minification = n},
          SamplerDesc{.magnification = n, .minification = l},
          SamplerDesc{.magnification = n, .minification = n, .mip = l},
          SamplerDesc{.magnification = n, .minification = n, .max_anisotropy = 4}})
        expect(Check::format_unsupported, "source", dispatch(in, out, sampler(filters)));
    state.caps[Format::r32_uint] = FormatCaps::sampled;
    expect(Check::format_unsupported, "target", dispatch(in, out, nearest));
}

TEST_F(Checks, AnImageInAnotherFormatThanTheShaders) {
    auto convert = std::move(device->create_compute_pipeline<fake::Convert>().value());
    Texture source = texture({.name = "source"});
    Texture other = texture({.name = "other", .format = Format::rgba8_uint, .usage = TextureUsage::storage});
    Sampler linear = sampler();
    expect(Check::view_format, "other", [&](Pass& pass) {
        pass.dispatch(convert, {{source.view<d2>(), linear}, other.mip<d2>(0)}, {}, {});
    });
}

TEST_F(Checks, Groups) {
    auto store = std::move(device->create_compute_pipeline<fake::Store>().value());
    Buffer data = buffer("data", BufferUsage::storage | BufferUsage::indirect);
    state.info.limits.max_groups[1] = 100;
    expect(Check::empty_work, "fake/store",
           [&](Pass& p) { p.dispatch(store, {data.slice()}, {}, {.y = 0}); });
    expect(Check::work_too_large, "fake/store",
           [&](Pass& p) { p.dispatch(store, {data.slice()}, {}, {.y = 101}); });
    Buffer plain = buffer("plain");
    Buffer arguments = buffer("arguments", BufferUsage::indirect);
    const auto indirect = [&](BufferSlice from) {
        return [&, from](Pass& pass) { pass.dispatch_indirect(store, {data.slice()}, {}, from); };
    };
    expect(Check::missing_usage, "plain", indirect(plain.slice()));
    expect(Check::buffer_too_small, "8 bytes", indirect(arguments.slice(0, 8)));
    expect(Check::buffer_alignment, "arguments", indirect(arguments.slice(2, 12)));
    expect(Check::buffer_out_of_range, "arguments", indirect(arguments.slice(1020, 12)));
    expect(Check::conflicting_access, "data", indirect(data.slice()));
}

TEST_F(Checks, PipelinesInTheWrongPlace) {
    auto store = std::move(device->create_compute_pipeline<fake::Store>().value());
    Buffer data = buffer("data");
    ComputePipeline<fake::Store> none;
    expect(Check::stale_handle, "pipeline", [&](Pass& pass) { pass.dispatch(none, {data.slice()}, {}, {}); });

    // What the types forbid, through a program type that lies about its kind and its push constants.
    struct Lie : fake::Store {
        using Push = NoPush;
    };
    auto lie = std::move(device->create_compute_pipeline<Lie>().value());
    expect(Check::push_size, "fake/store", [&](Pass& pass) { pass.dispatch(lie, {data.slice()}, {}, {}); });

    // A raster pipeline behind the type of a compute one.
    struct Both : fake::Paint {};
    ComputePipeline<Both> compute;
    auto raster = std::move(device->create_raster_pipeline<Both>({}).value());
    static_cast<Owner<PipelineHandle>&>(compute) = std::move(static_cast<Owner<PipelineHandle>&>(raster));
    expect(Check::pipeline_kind, "fake/paint", [&](Pass& pass) {
        pass.dispatch(compute, {data.slice(), data.slice(), data.slice()}, {}, {});
    });

    EXPECT_EQ(device->create_compute_pipeline<fake::Paint>().error().kind, ErrorKind::invalid_argument);
    EXPECT_EQ(device->create_raster_pipeline<fake::Store>({}).error().kind, ErrorKind::invalid_argument);
}

TEST_F(Checks, Conflicts) {
    auto count = std::move(device->create_compute_pipeline<fake::Count>().value());
    Buffer data = buffer("data");
    Buffer settings = buffer("settings", BufferUsage::uniform);
    expect(Check::conflicting_access, "data", [&](Pass& pass) {
        pass.dispatch(count, {data.slice(0, 256), data.slice(256, 256), settings.slice()}, {}, {});
    });
    auto convert = std::move(device->create_compute_pipeline<fake::Convert>().value());
    Texture image = texture({.name = "image",
                             .extent = {8, 8, 1},
                             .mips = 2,
                             .usage = TextureUsage::sampled | TextureUsage::storage,
                             .view_formats = {Format::r32_uint}});
    Sampler linear = sampler();
    expect(Check::conflicting_access, "image", [&](Pass& pass) {
        pass.dispatch(convert, {{image.view<d2>(), linear}, image.mip<d2>(1, Format::r32_uint)}, {}, {});
    });
    messages.clear();
    Commands commands = device->begin();
    commands.pass("other mip")
        .dispatch(convert, {{image.mip<d2>(0), linear}, image.mip<d2>(1, Format::r32_uint)}, {}, {});
    EXPECT_THAT(messages, IsEmpty());
}

TEST_F(Checks, BufferCopies) {
    Buffer a = buffer("a");
    Buffer b = buffer("b");
    const auto copy = [&](BufferSlice from, BufferSlice to) {
        return [from, to](Pass& pass) { pass.copy(from, to); };
    };
    expect(Check::buffer_out_of_range, "a", copy(a.slice(1000, 100), b.slice(0, 100)));
    expect(Check::buffer_out_of_range, "b", copy(a.slice(0, 100), b.slice(1000, 100)));
    expect(Check::copy_out_of_range, "b", copy(a.slice(0, 100), b.slice(0, 101)));
    expect(Check::copy_overlap, "a", copy(a.slice(0, 100), a.slice(99, 100)));
    expect(Check::copy_overlap, "a", copy(a.slice(), a.slice()));
    expect(Check::copy_out_of_range, "b", [&](Pass& p) { p.upload(b.slice(), std::vector<std::byte>(1)); });
    expect(Check::buffer_alignment, "b", [&](Pass& p) { p.fill(b.slice(2, 4)); });
    expect(Check::buffer_alignment, "b", [&](Pass& p) { p.fill(b.slice(4, 6)); });
    expect(Check::empty_work, "b", [&](Pass& p) { EXPECT_EQ(p.read(b.slice(0, 0)).id, 0u); });
    EXPECT_FALSE(device->download(b.slice(0, 2000)));
    messages.clear();
    Commands commands = device->begin();
    commands.pass("apart").copy(a.slice(0, 100), a.slice(100, 100));
    EXPECT_THAT(messages, IsEmpty());
}

TEST_F(Checks, TextureRegions) {
    Texture picture = texture({.name = "picture", .extent = {16, 8, 1}, .mips = 3});
    Texture layers = texture({.name = "layers", .dimension = d2_array, .extent = {16, 8, 1}, .layers = 4});
    Texture wide = texture({.name = "wide", .format = Format::rgba16_float, .extent = {16, 8, 1}});
    Texture depth = texture({.name = "depth", .format = Format::d32_float, .extent = {16, 8, 1}});
    Texture blocks = texture({.name = "blocks", .format = Format::bc7_rgba_unorm, .extent = {10, 8, 1}});
    Texture several = texture({.name = "several",
                               .dimension = d2_multisample,
                               .extent = {16, 8, 1},
                               .samples = 4,
                               .usage = TextureUsage::attachment});
    const auto read = [&](const Texture& from, TextureRegion region) {
        return [&, region](Pass& pass) { (void)pass.read(from, region); };
    };
    expect(Check::copy_out_of_range, "picture", read(picture, {.mip = 3, .extent = {1, 1, 1}}));
    expect(Check::copy_out_of_range, "picture", read(picture, {.mip = 1, .extent = {9, 1, 1}}));
    expect(Check::copy_out_of_range, "picture", read(picture, {.x = 16, .extent = {1, 1, 1}}));
    expect(Check::copy_out_of_range, "picture", read(picture, {.y = 7, .extent = {1, 2, 1}}));
    expect(Check::copy_out_of_range, "picture", read(picture, {.x = 0xffffffff, .extent = {2, 1, 1}}));
    expect(Check::copy_out_of_range, "picture", read(picture, {.x = 1, .extent = {0xffffffff, 1, 1}}));
    expect(Check::copy_out_of_range, "picture", read(picture, {.extent = {1, 1, 2}}));
    expect(Check::copy_out_of_range, "picture", read(picture, {.extent = {0, 1, 1}}));
    expect(Check::copy_out_of_range, "layers",
           read(layers, {.first_layer = 3, .layers = 2, .extent = {1, 1, 1}}));
    expect(Check::copy_out_of_range, "blocks", read(blocks, {.x = 2, .extent = {4, 4, 1}}));
    expect(Check::copy_out_of_range, "blocks", read(blocks, {.extent = {6, 4, 1}}));
    expect(Check::copy_format, "several", read(several, {.extent = {1, 1, 1}}));
    expect(Check::copy_out_of_range, "picture", [&](Pass& pass) {
        pass.upload(picture, {.extent = {2, 2, 1}}, std::vector<std::byte>(15));
    });

    const TextureRegion one{.extent = {1, 1, 1}};
    const TextureRegion two{.extent = {2, 1, 1}};
    expect(Check::copy_format, "wide", [&](Pass& pass) { pass.copy(picture, one, wide, one); });
    expect(Check::copy_format, "depth", [&](Pass& pass) { pass.copy(picture, one, depth, one); });
    expect(Check::copy_out_of_range, "layers", [&](Pass& pass) { pass.copy(picture, one, layers, two); });
    expect(Check::copy_overlap, "picture", [&](Pass& pass) {
        pass.copy(picture, two, picture, {.x = 1, .extent = {2, 1, 1}});
    });
    messages.clear();
    Commands commands = device->begin();
    Pass pass = commands.pass("fine");
    pass.copy(picture, two, picture, {.x = 2, .extent = {2, 1, 1}});
    pass.copy(picture, two, picture, {.mip = 1, .extent = {2, 1, 1}});
    (void)pass.read(blocks, {.x = 4, .y = 4, .extent = {6, 4, 1}});
    EXPECT_THAT(messages, IsEmpty());
}

TEST_F(Checks, ClearsAndMips) {
    Texture floats = texture({.name = "floats", .extent = {8, 8, 1}, .mips = 2});
    Texture counts = texture({.name = "counts", .format = Format::r32_uint, .extent = {8, 8, 1}, .mips = 2});
    Texture blocks = texture({.name = "blocks", .format = Format::bc1_rgba_srgb, .extent = {8, 8, 1}});
    Texture depth = texture({.name = "depth", .format = Format::d32_float, .extent = {8, 8, 1}, .mips = 2});
    expect(Check::texel_kind, "counts", [&](Pass& pass) {
        pass.clear(counts.view(), std::array<float, 4>{1, 0, 0, 0});
    });
    expect(Check::texel_kind, "floats", [&](Pass& pass) {
        pass.clear(floats.view(), std::array<uint32_t, 4>{1, 0, 0, 0});
    });
    expect(Check::format_unsupported, "blocks", [&](Pass& pass) { pass.clear(blocks.view()); });
    expect(Check::view_out_of_range, "floats",
           [&](Pass& pass) { pass.clear(floats.view({.first_mip = 1, .mips = 2})); });
    Texture words =
        texture({.name = "words", .format = Format::r32_uint, .view_formats = {Format::rgba8_unorm}});
    expect(Check::view_format, "words", [&](Pass& pass) {
        pass.clear(words.view({.format = Format::rgba8_unorm}), std::array<float, 4>{1, 0, 0, 0});
    });
    expect(Check::format_unsupported, "depth", [&](Pass& pass) { pass.generate_mips(depth); });
    state.caps[Format::rgba8_unorm] = FormatCaps::sampled;
    expect(Check::format_unsupported, "floats", [&](Pass& pass) { pass.generate_mips(floats); });
    messages.clear();
    Commands commands = device->begin();
    commands.pass("zeros fit").clear(counts.view());
    EXPECT_THAT(messages, IsEmpty());
    const auto& cleared = std::get<ClearTextureCommand>(state.passes.back().commands[0]);
    EXPECT_EQ(cleared.value, ClearValue((std::array<uint32_t, 4>{})));
}

// -- raster passes

struct RasterChecks : Checks {
    Buffer vertices = buffer("vertices");
    Buffer list = buffer("list");
    Buffer counter = buffer("counter");
    Texture color = target("color");

    Texture target(std::string name, Format format = Format::rgba8_unorm, Extent extent = {8, 8, 1},
                   uint32_t samples = 1) {
        return texture({.name = std::move(name),
                        .dimension = samples > 1 ? d2_multisample : d2,
                        .format = format,
                        .extent = extent,
                        .samples = samples,
                        .usage = TextureUsage::attachment | TextureUsage::sampled});
    }
    RasterPipeline<fake::Paint> pipeline(const RasterState& state) {
        return std::move(device->create_raster_pipeline<fake::Paint>(state).value());
    }
    RasterPipeline<fake::Paint> pipeline() { return pipeline({.color = {{.format = Format::rgba8_unorm}}}); }
    RasterTargets targets() { return {.color = {{.view = color.view()}}}; }
    fake::Paint::Bindings bindings() { return {vertices.slice(), list.slice(), counter.slice()}; }
};

TEST_F(RasterChecks, Targets) {
    const auto nothing = [](RasterPass&) {};
    Texture plain = texture({.name = "plain", .extent = {8, 8, 1}});
    Texture small = target("small", Format::rgba8_unorm, {4, 4, 1});
    Texture depth = target("depth", Format::d32_float);
    Texture counts = target("counts", Format::r32_uint);
    Texture several = target("several", Format::rgba8_unorm, {8, 8, 1}, 4);
    Texture chain =
        texture({.name = "chain", .extent = {8, 8, 1}, .mips = 2, .usage = TextureUsage::attachment});
    expect_raster(Check::missing_usage, "plain", {.color = {{.view = plain.view()}}}, nothing);
    expect_raster(Check::view_out_of_range, "chain", {.color = {{.view = chain.view()}}}, nothing);
    expect_raster(Check::pipeline_targets, "small",
                  {.color = {{.view = color.view()}, {.view = small.view()}}}, nothing);
    expect_raster(Check::pipeline_targets, "several",
                  {.color = {{.view = color.view()}, {.view = several.view()}}}, nothing);
    expect_raster(Check::texel_kind, "depth", {.color = {{.view = depth.view()}}}, nothing);
    expect_raster(Check::texel_kind, "color", {.depth = DepthTarget{.view = color.view()}}, nothing);
    expect_raster(Check::texel_kind, "counts",
                  {.color = {{.view = counts.view(), .clear = std::array<float, 4>{1}}}}, nothing);
    expect_raster(Check::conflicting_access, "color",
                  {.color = {{.view = color.view()}, {.view = color.view()}}}, nothing);
    expect_raster(Check::stale_handle, "target", {.color = {{.view = TextureView{}}}}, nothing);
    expect_raster(Check::empty_work, "0x8", {.extent = {0, 8, 1}}, nothing);
    expect_raster(Check::work_too_large, "5000", {.extent = {5000, 8, 1}}, nothing);
    expect_raster(Check::work_too_large, "9", {.color = std::vector<ColorTarget>(9, {.view = color.view()})},
                  nothing);
    expect_raster(Check::pipeline_targets, "small",
                  {.color = {{.view = several.view(), .resolve = small.view()}}}, nothing);
    expect_raster(Check::pipeline_targets, "color",
                  {.color = {{.view = chain.mip<d2>(0), .resolve = color.view()}}}, nothing);
    state.caps[Format::rgba8_unorm] = FormatCaps::sampled;
    expect_raster(Check::format_unsupported, "color", targets(), nothing);
}

TEST_F(RasterChecks, PipelinesOfOtherTargets) {
    const auto draw = [&](const RasterState& state) {
        return [&, made = pipeline(state)](RasterPass& pass) {
            pass.draw(made, bindings(), {}, Draw{.vertices = 3});
        };
    };
    Texture depth = target("depth", Format::d32_float);
    const ColorTargetState rgba8{.format = Format::rgba8_unorm};
    expect_raster(Check::pipeline_targets, "rgba8_srgb", targets(),
                  draw({.color = {{.format = Format::rgba8_srgb}}}));
    expect_raster(Check::pipeline_targets, "0 colour targets", targets(), draw({}));
    expect_raster(Check::pipeline_targets, "depth", targets(),
                  draw({.color = {rgba8}, .depth = DepthState{}}));
    expect_raster(Check::pipeline_targets, "4 samples", targets(), draw({.color = {rgba8}, .samples = 4}));
    expect_raster(Check::pipeline_targets, "no depth",
                  {.color = {{.view = color.view()}}, .depth = DepthTarget{.view = depth.view()}},
                  draw({.color = {rgba8}}));
}

TEST_F(RasterChecks, Draws) {
    auto paint = pipeline();
    Buffer indices = buffer("indices", BufferUsage::index, 64);
    Buffer arguments = buffer("arguments", BufferUsage::indirect, 64);
    const auto draw = [&](auto what) {
        return [&, what](RasterPass& pass) { pass.draw(paint, bindings(), {}, what); };
    };
    expect_raster(Check::empty_work, "0 vertices", targets(), draw(Draw{}));
    expect_raster(Check::empty_work, "0 instances", targets(), draw(Draw{.vertices = 3, .instances = 0}));
    expect_raster(Check::empty_work, "0 indices", targets(), draw(DrawIndexed{.indices = indices.slice()}));
    expect_raster(Check::buffer_out_of_range, "indices", targets(),
                  draw(DrawIndexed{.indices = indices.slice(), .count = 16, .first = 1}));
    expect_raster(Check::buffer_alignment, "indices", targets(),
                  draw(DrawIndexed{.indices = indices.slice(2, 32), .count = 1}));
    expect_raster(Check::missing_usage, "arguments", targets(),
                  draw(DrawIndexed{.indices = arguments.slice(), .count = 1}));
    expect_raster(Check::empty_work, "0 indirect", targets(),
                  draw(DrawIndirect{.arguments = arguments.slice(), .draws = 0}));
    expect_raster(Check::buffer_too_small, "5 draws", targets(),
                  draw(DrawIndirect{.arguments = arguments.slice(), .draws = 5}));
    expect_raster(Check::buffer_too_small, "4 draws", targets(),
                  draw(DrawIndirect{.arguments = arguments.slice(), .draws = 4, .indices = indices.slice()}));
    expect_raster(Check::buffer_alignment, "indices", targets(),
                  draw(DrawIndirect{.arguments = arguments.slice(), .indices = indices.slice(4, 32)}));
    expect_raster(Check::missing_usage, "indices", targets(),
                  draw(DrawIndirect{.arguments = indices.slice()}));
    expect_raster(Check::empty_work, "viewport", targets(),
                  [](RasterPass& pass) { pass.viewport({.width = 0, .height = 1}); });
    expect_raster(Check::view_out_of_range, "viewport", targets(),
                  [](RasterPass& pass) { pass.viewport({.x = 4, .width = 5, .height = 1}); });
}

TEST_F(RasterChecks, OneRasterPassIsOneScope) {
    auto paint = pipeline();
    const Draw three{.vertices = 3};
    // Draws that store to the same list and count in the same counter are fine together.
    {
        Commands commands = device->begin();
        RasterPass pass = commands.raster_pass("fine", targets());
        for (int i = 0; i < 3; ++i) pass.draw(paint, bindings(), {}, three);
    }
    EXPECT_THAT(messages, IsEmpty());
    // A draw must not read what one before it wrote, nor count where it stored.
    for (const fake::Paint::Bindings& second :
         {fake::Paint::Bindings{list.slice(), counter.slice(), vertices.slice()},
          fake::Paint::Bindings{counter.slice(), list.slice(), vertices.slice()},
          fake::Paint::Bindings{vertices.slice(), counter.slice(), list.slice()}}) {
        messages.clear();
        Commands commands = device->begin();
        RasterPass pass = commands.raster_pass("conflict", targets());
        pass.draw(paint, bindings(), {}, three);
        pass.draw(paint, second, {}, three);
        expect_message(Check::conflicting_access, "written");
        pass.end();
        EXPECT_THAT(state.passes.back().commands, SizeIs(1));
    }
}

TEST_F(Checks, DrawsThatReadWhatTheyWriteMayNotBeRepeated) {
    struct Rework : fake::Paint {
        static const ProgramInfo& info() {
            static const std::vector<BindingInfo> bindings = [] {
                std::vector<BindingInfo> changed(fake::Paint::info().bindings.begin(),
                                                 fake::Paint::info().bindings.end());
                changed[1].access = ShaderAccess::read_write;
                return changed;
            }();
            static const ProgramInfo program = [] {
                ProgramInfo changed = fake::Paint::info();
                changed.bindings = bindings;
                return changed;
            }();
            return program;
        }
    };
    auto rework = std::move(
        device->create_raster_pipeline<Rework>({.color = {{.format = Format::rgba8_unorm}}}).value());
    Texture color = texture({.name = "color", .extent = {8, 8, 1}, .usage = TextureUsage::attachment});
    Buffer vertices = buffer("vertices"), list = buffer("list"), counter = buffer("counter");
    Commands commands = device->begin();
    RasterPass pass = commands.raster_pass("conflict", {.color = {{.view = color.view()}}});
    for (int i = 0; i < 2; ++i)
        pass.draw(rework, {vertices.slice(), list.slice(), counter.slice()}, {}, Draw{.vertices = 3});
    expect_message(Check::conflicting_access, "list");
    pass.end();
    EXPECT_THAT(state.passes.back().commands, SizeIs(1));
}

TEST_F(Checks, WhatWasBoundBeforeIsCheckedAgainOnceAResourceIsGone) {
    auto store = std::move(device->create_compute_pipeline<fake::Store>().value());
    Buffer data = buffer("data");
    const BufferSlice slice = data.slice();
    Commands commands = device->begin();
    Pass pass = commands.pass("test");
    for (int i = 0; i < 3; ++i) pass.dispatch(store, {slice}, {}, {});
    EXPECT_THAT(messages, IsEmpty());
    data = {};
    pass.dispatch(store, {slice}, {}, {});
    expect_message(Check::stale_handle, "target");
    pass.end();
    EXPECT_THAT(state.passes.back().commands, SizeIs(3));
}

// -- descriptions that cannot be

TEST_F(Checks, TextureDescriptions) {
    const auto refused = [&](const TextureDesc& desc) {
        const auto made = device->create_texture(desc);
        return made ? std::optional<ErrorKind>{} : made.error().kind;
    };
    const auto invalid = testing::Optional(ErrorKind::invalid_argument);
    const auto unsupported = testing::Optional(ErrorKind::unsupported);
    EXPECT_THAT(refused({.format = Format::undefined}), invalid);
    EXPECT_THAT(refused({.extent = {0, 1, 1}}), invalid);
    EXPECT_THAT(refused({.extent = {4, 4, 4}}), invalid) << "2D with depth";
    EXPECT_THAT(refused({.dimension = d1, .extent = {4, 4, 1}}), invalid);
    EXPECT_THAT(refused({.layers = 2}), invalid);
    EXPECT_THAT(refused({.dimension = cube, .extent = {4, 4, 1}}), invalid) << "one layer";
    EXPECT_THAT(refused({.dimension = cube, .extent = {4, 2, 1}, .layers = 6}), invalid);
    EXPECT_THAT(refused({.dimension = cube_array, .extent = {4, 4, 1}, .layers = 8}), invalid);
    EXPECT_THAT(refused({.extent = {4, 4, 1}, .mips = 4}), invalid);
    EXPECT_THAT(refused({.mips = 0}), invalid);
    EXPECT_THAT(refused({.samples = 4}), invalid) << "not multisampled";
    EXPECT_THAT(refused({.dimension = d2_multisample, .samples = 3}), invalid);
    EXPECT_THAT(refused({.usage = TextureUsage::none}), invalid);
    EXPECT_THAT(refused({.view_formats = {Format::rgba16_float}}), invalid);
    EXPECT_THAT(refused({.extent = {4097, 1, 1}}), unsupported);
    EXPECT_THAT(refused({.dimension = d3, .extent = {1, 1, 513}}), unsupported);
    EXPECT_THAT(refused({.dimension = d2_array, .layers = 257}), unsupported);
    EXPECT_THAT(refused({.dimension = d2_multisample, .samples = 8, .usage = TextureUsage::attachment}),
                unsupported);
    EXPECT_THAT(refused({.dimension = d3, .usage = TextureUsage::attachment}), unsupported);
    state.caps[Format::rgba8_unorm] = FormatCaps::none;
    EXPECT_THAT(refused({}), unsupported);
    EXPECT_EQ(device->create_buffer({}).error().kind, ErrorKind::invalid_argument);
}

TEST_F(Checks, PipelineDescriptions) {
    const auto refused = [&](const RasterState& raster) {
        const auto made = device->create_raster_pipeline<fake::Paint>(raster);
        return made ? std::optional<ErrorKind>{} : made.error().kind;
    };
    const auto invalid = testing::Optional(ErrorKind::invalid_argument);
    const auto unsupported = testing::Optional(ErrorKind::unsupported);
    const ColorTargetState rgba8{.format = Format::rgba8_unorm};
    EXPECT_THAT(refused({.color = {rgba8, rgba8}}), invalid) << "the program writes one";
    EXPECT_THAT(refused({.color = {{.format = Format::d32_float}}}), invalid);
    EXPECT_THAT(refused({.depth = DepthState{.format = Format::rgba8_unorm}}), invalid);
    EXPECT_THAT(refused({.color = std::vector(9, rgba8)}), unsupported);
    EXPECT_THAT(refused({.samples = 64}), unsupported);
    state.caps[Format::rgba8_unorm] = FormatCaps::attachment;
    EXPECT_THAT(refused({.color = {{.format = Format::rgba8_unorm, .blend = BlendState{}}}}), unsupported);
    EXPECT_EQ(refused({.color = {rgba8}}), std::nullopt);
}

}  // namespace
}  // namespace lumo::rhi
