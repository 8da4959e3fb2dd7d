#include "tests/adopt/every_operation.hpp"

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <numeric>

#include "shaders/test_rhi/advance.hpp"
#include "shaders/test_rhi/arguments.hpp"
#include "shaders/test_rhi/copy_image.hpp"
#include "shaders/test_rhi/layered.hpp"
#include "shaders/test_rhi/pull.hpp"
#include "shaders/test_rhi/sample_cube.hpp"
#include "shaders/test_rhi/sample_d2.hpp"
#include "shaders/test_rhi/sample_d3.hpp"
#include "shaders/test_rhi/sample_multisample.hpp"
#include "shaders/test_rhi/scale.hpp"
#include "shaders/test_rhi/several.hpp"
#include "shaders/test_rhi/store_d3.hpp"
#include "shaders/test_rhi/tally.hpp"
#include "tests/support/device_test.hpp"

namespace lumo::testing_support {
namespace {

using namespace rhi;
using namespace shaders::test_rhi;
using enum Dimension;
using Bytes = std::vector<std::byte>;

constexpr uint32_t side = 12;
constexpr TextureUsage every_use = TextureUsage::sampled | TextureUsage::storage | TextureUsage::attachment;

struct Vertex {
    glm::vec4 position;
    glm::vec4 color;
};
const std::vector<Vertex> triangle{{{-0.9f, -0.8f, 0.25f, 1}, {1, 0.25f, 0, 1}},
                                   {{0.9f, -0.7f, 0.5f, 1}, {0, 1, 0.5f, 0.5f}},
                                   {{-0.2f, 0.9f, 0.75f, 1}, {0.125f, 0, 1, 0.25f}}};
const pull::Push white{.tint = {1, 1, 1, 1}, .offset = {0.1f, 0}};

Bytes counting(uint64_t size) {
    Bytes bytes(size);
    for (uint64_t i = 0; i < size; ++i) bytes[i] = std::byte(i * 7 + i / 251);
    return bytes;
}

template <class T>
Buffer buffer_with(Device& device, const std::vector<T>& values, BufferUsage usage = BufferUsage::storage) {
    Buffer made =
        must(device.create_buffer({.name = "values", .size = values.size() * sizeof(T), .usage = usage}));
    must(device.upload(made.slice(), bytes_of(values)));
    return made;
}

Texture texture(Device& device, TextureDesc desc) {
    desc.name = "texture";
    desc.usage = desc.usage | TextureUsage::sampled;
    return must(device.create_texture(desc));
}

Texture target(Device& device, Format format = Format::rgba8_srgb, uint32_t samples = 1) {
    return texture(device, {.dimension = samples > 1 ? d2_multisample : d2,
                            .format = format,
                            .extent = {side, side, 1},
                            .samples = samples,
                            .usage = TextureUsage::attachment});
}

Texture filled(Device& device, const TextureDesc& desc) {
    Texture made = texture(device, desc);
    for (uint32_t mip = 0; mip < desc.mips; ++mip) {
        const TextureRegion region = whole_mip(desc, mip);
        must(device.upload(made, region, counting(region_bytes(desc.format, region))));
    }
    return made;
}

Bytes every_mip(Device& device, const Texture& texture) {
    Bytes all;
    for (uint32_t mip = 0; mip < texture.desc().mips; ++mip) {
        const Bytes one = must(device.download(texture, whole_mip(texture.desc(), mip)));
        all.insert(all.end(), one.begin(), one.end());
    }
    return all;
}

/// The triangle by `draw`, two instances, into a target of its own.
template <class AnyDraw>
Bytes drawn(Device& device, const RasterState& state, const AnyDraw& draw,
            std::optional<Viewport> viewport = {}) {
    const Texture color = target(device, state.color[0].format, state.samples);
    const Texture resolved = target(device, state.color[0].format);
    const Texture depth = target(device, Format::d32_float, state.samples);
    const Buffer vertices = buffer_with(device, triangle);
    const auto pipeline = must(device.create_raster_pipeline<pull>(state));
    RasterTargets targets{.color = {{.view = color.view(), .clear = std::array{0.25f, 0.5f, 0.75f, 1.0f}}}};
    if (state.depth) targets.depth = DepthTarget{.view = depth.view()};
    if (state.samples > 1) targets.color[0].resolve = resolved.view();
    Commands commands = device.begin();
    {
        RasterPass pass = commands.raster_pass("draw", targets);
        if (viewport) pass.viewport(*viewport);
        pass.draw(pipeline, {vertices.slice()}, white, draw);
    }
    device.submit(std::move(commands));
    return every_mip(device, state.samples > 1 ? resolved : color);
}

Bytes drawn(Device& device, const RasterState& state) {
    return drawn(device, state, Draw{.vertices = 3, .instances = 2});
}

RasterState plain(Format format = Format::rgba8_srgb) {
    return {.color = {{.format = format}}, .cull = CullMode::none};
}

Bytes buffers(Device& device) {
    Bytes all;
    for (Memory memory : {Memory::device, Memory::upload, Memory::readback}) {
        const Buffer one = must(device.create_buffer({.name = "one", .size = 4096, .memory = memory}));
        const Buffer two = must(device.create_buffer({.name = "two", .size = 4096, .memory = memory}));
        must(device.upload(one.slice(16, 2048), counting(2048)));
        Commands commands = device.begin();
        {
            Pass pass = commands.pass("copies");
            pass.fill(two.slice(), 0x01020304);
            pass.copy(one.slice(64, 1024), two.slice(128, 1024));
        }
        must(device.wait(device.submit(std::move(commands))));
        const Bytes bytes = must(device.download(two.slice()));
        all.insert(all.end(), bytes.begin(), bytes.end());
    }
    return all;
}

Bytes texture_shapes(Device& device) {
    Bytes all;
    for (const TextureDesc& desc : std::vector<TextureDesc>{
             {.dimension = d1, .format = Format::r8_unorm, .extent = {13, 1, 1}, .mips = 3},
             {.dimension = d1_array, .format = Format::rg8_unorm, .extent = {13, 1, 1}, .layers = 3},
             {.dimension = d2, .format = Format::rgba8_srgb, .extent = {13, 6, 1}, .mips = 4},
             {.dimension = d2, .format = Format::d32_float, .extent = {13, 6, 1}},
             {.dimension = d2_array, .format = Format::r16_uint, .extent = {13, 6, 1}, .layers = 3},
             {.dimension = d3, .format = Format::rgba8_unorm, .extent = {13, 6, 5}, .mips = 2},
             {.dimension = cube, .format = Format::r8_unorm, .extent = {9, 9, 1}, .layers = 6},
             {.dimension = cube_array, .format = Format::r8_unorm, .extent = {9, 9, 1}, .layers = 12},
             {.dimension = d2, .format = Format::bc1_rgba_srgb, .extent = {16, 8, 1}},
             {.dimension = d2_array, .format = Format::bc7_rgba_unorm, .extent = {16, 8, 1}, .layers = 2},
         }) {
        if (desc.format == Format::d32_float) {  // all bits of a depth need not survive
            const Texture depth = texture(device, desc);
            const std::vector<float> values(size_t(desc.extent.width) * desc.extent.height, 0.375f);
            must(device.upload(depth, whole_mip(desc), bytes_of(values)));
            const Bytes bytes = every_mip(device, depth);
            all.insert(all.end(), bytes.begin(), bytes.end());
            continue;
        }
        const Bytes bytes = every_mip(device, filled(device, desc));
        all.insert(all.end(), bytes.begin(), bytes.end());
    }
    return all;
}

Bytes texture_copies(Device& device) {
    const TextureDesc desc{
        .dimension = d2_array, .format = Format::rgba8_unorm, .extent = {side, side, 1}, .layers = 3};
    const Texture from = filled(device, desc);
    const Texture to = texture(device, desc);
    Commands commands = device.begin();
    {
        Pass pass = commands.pass("copy");
        pass.clear(to.view(), std::array{0.5f, 0.25f, 0.0f, 1.0f});
        pass.copy(from, {.first_layer = 1, .layers = 2, .x = 2, .y = 3, .extent = {5, 4, 1}}, to,
                  {.first_layer = 0, .layers = 2, .x = 1, .y = 1, .extent = {5, 4, 1}});
    }
    device.submit(std::move(commands));
    return every_mip(device, to);
}

Bytes clears(Device& device) {
    Bytes all;
    const std::array<std::pair<Format, ClearValue>, 4> cases{{
        {Format::rgba8_srgb, std::array{0.5f, 0.25f, 0.75f, 1.0f}},
        {Format::rgba32_uint, std::array<uint32_t, 4>{1, 2, 3, 4}},
        {Format::r32_sint, std::array<int32_t, 4>{-5, 0, 0, 0}},
        {Format::d32_float, std::array{0.625f, 0.0f, 0.0f, 0.0f}},
    }};
    for (const auto& [format, value] : cases) {
        const Texture cleared =
            texture(device, {.dimension = d2, .format = format, .extent = {side, side, 1}, .mips = 3});
        Commands commands = device.begin();
        commands.pass("clear").clear(cleared.view(), value);
        device.submit(std::move(commands));
        const Bytes bytes = every_mip(device, cleared);
        all.insert(all.end(), bytes.begin(), bytes.end());
    }
    return all;
}

Bytes mips(Device& device, const TextureDesc& desc) {
    const Texture made = filled(device, desc);
    Commands commands = device.begin();
    commands.pass("mips").generate_mips(made);
    device.submit(std::move(commands));
    return every_mip(device, made);
}

template <class P, Dimension D>
Bytes sampled(Device& device, const TextureDesc& desc) {
    const Texture from = filled(device, desc);
    const Sampler sampler = must(device.create_sampler({.mip = FilterMode::linear,
                                                        .address_u = AddressMode::mirrored_repeat,
                                                        .border = BorderColor::opaque_white}));
    std::vector<glm::vec4> points;
    for (int i = 0; i < 64; ++i) points.emplace_back(0.03f * float(i), 0.9f - 0.02f * float(i), 0.3f, 1);
    const Buffer at = buffer_with(device, points);
    const Buffer results = must(device.create_buffer({.name = "results", .size = 64 * 16}));
    const auto pipeline = must(device.create_compute_pipeline<P>());
    Commands commands = device.begin();
    {
        Pass pass = commands.pass("sample");
        using Bindings = typename P::Bindings;
        pass.dispatch(
            pipeline,
            Bindings{.source = {from.view<D>(), sampler}, .Points = at.slice(), .Results = results.slice()},
            {.count = 64, .lod = 0.5f}, {1});
    }
    device.submit(std::move(commands));
    return must(device.download(results.slice()));
}

Bytes stored(Device& device) {
    const Texture volume = texture(
        device,
        {.dimension = d3, .format = Format::r32_float, .extent = {8, 8, 4}, .usage = TextureUsage::storage});
    const auto pipeline = must(device.create_compute_pipeline<store_d3>());
    Commands commands = device.begin();
    commands.pass("store").dispatch(pipeline, {volume.view<d3>()}, {.size = {8, 8, 4}, .base = 3}, {2, 2, 1});
    device.submit(std::move(commands));
    return every_mip(device, volume);
}

Bytes images(Device& device) {
    const TextureDesc desc{.format = Format::rgba32_float, .extent = {8, 8, 1}, .usage = every_use};
    Texture from = texture(device, desc);
    std::vector<float> values(8 * 8 * 4);
    std::iota(values.begin(), values.end(), 1.0f);
    must(device.upload(from, whole_mip(from.desc()), bytes_of(values)));
    const Texture to = texture(device, desc);
    const auto pipeline = must(device.create_compute_pipeline<copy_image>());
    Commands commands = device.begin();
    commands.pass("images").dispatch(pipeline, {.source = from.view<d2>(), .target = to.view<d2>()}, {}, {1});
    device.submit(std::move(commands));
    return every_mip(device, to);
}

Bytes computed(Device& device) {
    std::vector<int32_t> values(256);
    std::iota(values.begin(), values.end(), -20);
    const Buffer source = buffer_with(device, values);
    const Buffer result = must(device.create_buffer({.name = "result", .size = 1024}));
    const auto pipeline = must(device.create_compute_pipeline<scale>({.bias = 5}));
    Commands commands = device.begin();
    {
        Pass pass = commands.pass("scale");
        pass.dispatch(pipeline,
                      {.Source = source.slice(),
                       .settings = commands.uniform(scale::Settings{glm::ivec4(1, 2, 3, 4)}),
                       .Target = result.slice()},
                      {.count = 256, .factor = 3, .pair = {2, 5}}, {4});
    }
    device.submit(std::move(commands));
    return must(device.download(result.slice()));
}

Buffer arguments_of(Device& device, const std::vector<uint32_t>& words) {
    return buffer_with(device, words, BufferUsage::indirect);
}

Bytes computed_indirectly(Device& device) {
    const Buffer values = buffer_with(device, std::vector<uint32_t>(128, 7));
    const Buffer arguments = arguments_of(device, {2, 1, 1});
    const auto pipeline = must(device.create_compute_pipeline<advance>());
    Commands commands = device.begin();
    commands.pass("advance").dispatch_indirect(pipeline, {values.slice()}, {}, arguments.slice());
    device.submit(std::move(commands));
    return must(device.download(values.slice()));
}

Bytes drawn_indexed(Device& device) {
    const Buffer indices =
        buffer_with(device, std::vector<uint16_t>{9, 9, 2, 1, 0, 0xffff}, BufferUsage::index);
    return drawn(
        device, plain(),
        DrawIndexed{
            .indices = indices.slice(), .type = IndexType::uint16, .count = 3, .instances = 2, .first = 2});
}

Bytes drawn_indirectly(Device& device) {
    const Buffer arguments = arguments_of(device, {3, 2, 0, 0});
    return drawn(device, plain(), DrawIndirect{.arguments = arguments.slice()});
}

Bytes drawn_indexed_indirectly(Device& device) {
    const Buffer indices = buffer_with(device, std::vector<uint32_t>{2, 1, 0}, BufferUsage::index);
    const Buffer arguments = arguments_of(device, {3, 2, 0, 0, 0});
    return drawn(device, plain(), DrawIndirect{.arguments = arguments.slice(), .indices = indices.slice()});
}

Bytes drawn_blended(Device& device) {
    RasterState state = plain(Format::rgba8_unorm);
    state.color[0].blend = BlendState{.source_color = BlendFactor::source_alpha,
                                      .destination_color = BlendFactor::one_minus_source_alpha,
                                      .source_alpha = BlendFactor::one,
                                      .destination_alpha = BlendFactor::destination_alpha,
                                      .alpha_op = BlendOp::maximum};
    state.color[0].write_mask = 0xb;
    return drawn(device, state);
}

Bytes drawn_with_depth(Device& device) {
    RasterState state = plain();
    state.depth = DepthState{.compare = Compare::less_equal, .bias_constant = 4, .bias_slope = 1.5f};
    state.cull = CullMode::back;
    state.depth_clamp = true;
    return drawn(device, state);
}

Bytes drawn_with_samples(Device& device) {
    RasterState state = plain(Format::rgba8_unorm);
    state.samples = 4;
    return drawn(device, state);
}

Bytes drawn_as(Device& device, Topology topology) {
    RasterState state = plain();
    state.topology = topology;
    return drawn(device, state);
}

Bytes drawn_to_several(Device& device) {
    const std::array formats{Format::rgba32_float, Format::rgba32_uint, Format::rgba32_float};
    std::vector<Texture> targets;
    RasterState state{.cull = CullMode::none};
    RasterTargets into;
    for (Format format : formats) {
        targets.push_back(target(device, format));
        state.color.push_back({.format = format});
        into.color.push_back({.view = targets.back().view()});
    }
    into.color[1].clear = std::array<uint32_t, 4>{9, 8, 7, 6};
    into.color[2].load = Load::discard;
    const auto pipeline = must(device.create_raster_pipeline<several>(state));
    Commands commands = device.begin();
    {
        RasterPass pass = commands.raster_pass("several", into);
        pass.draw(pipeline, {}, {}, Draw{.vertices = 3});
    }
    device.submit(std::move(commands));
    Bytes all;
    for (const Texture& one : targets) {
        const Bytes bytes = every_mip(device, one);
        all.insert(all.end(), bytes.begin(), bytes.end());
    }
    return all;
}

Bytes drawn_to_layers(Device& device) {
    const Texture layers = texture(device, {.dimension = d2_array,
                                            .format = Format::rgba32_float,
                                            .extent = {side, side, 1},
                                            .layers = 4,
                                            .usage = TextureUsage::attachment});
    const auto pipeline = must(device.create_raster_pipeline<layered>(plain(Format::rgba32_float)));
    Commands commands = device.begin();
    {
        RasterPass pass = commands.raster_pass("layers", {.color = {{.view = layers.view()}}});
        pass.draw(pipeline, {}, {.layers = 3}, Draw{.vertices = 3});
    }
    device.submit(std::move(commands));
    return every_mip(device, layers);
}

Bytes drawn_without_targets(Device& device) {
    const Buffer count = buffer_with(device, std::vector<uint32_t>{0});
    const auto pipeline = must(device.create_raster_pipeline<tally>({.cull = CullMode::none}));
    Commands commands = device.begin();
    {
        RasterPass pass = commands.raster_pass("tally", {.extent = {side, side, 1}});
        pass.draw(pipeline, {count.slice()}, {}, Draw{.vertices = 3});
    }
    device.submit(std::move(commands));
    return must(device.download(count.slice()));
}

/// Both kinds of stamps are taken; what they say is no result.
Bytes timed(Device& device) {
    const Buffer values = buffer_with(device, std::vector<uint32_t>(64, 1));
    Commands commands = device.begin();
    commands.pass("fill").fill(values.slice(), 3);
    commands.pass("again").fill(values.slice(), 4);
    const Submission done = device.submit(std::move(commands));
    const Bytes passes(device.pass_times(done).size());
    (void)device.finished(done);
    (void)device.memory_budget();
    return passes;
}

/// Resources come and go while a submission is open.
Bytes created_while_recording(Device& device) {
    Commands commands = device.begin();
    Readback ticket;
    {
        Pass pass = commands.pass("frame");
        const Buffer values = must(device.create_buffer({.name = "values", .size = 256}));
        const Texture picture = texture(device, {.format = Format::r32_uint, .extent = {8, 8, 1}});
        const Sampler sampler = must(device.create_sampler({}));
        const auto pipeline = must(device.create_compute_pipeline<advance>());
        pass.fill(values.slice(), 5);
        pass.dispatch(pipeline, {values.slice()}, {}, {1});
        pass.clear(picture.view(), std::array<uint32_t, 4>{6});
        ticket = pass.read(values.slice());
    }
    device.submit(std::move(commands));
    return must(device.take(ticket));
}

Bytes refused(Device& device) {
    const auto failed = device.create_texture(
        {.name = "huge", .dimension = d2, .format = Format::rgba32_float, .extent = {1u << 20, 1, 1}});
    return Bytes(failed ? 0 : 1);
}

}  // namespace

std::vector<Operation> every_operation() {
    const TextureDesc flat{.format = Format::rgba8_srgb, .extent = {side, side, 1}, .mips = 3};
    const TextureDesc deep{.dimension = d3, .format = Format::rgba8_unorm, .extent = {8, 8, 8}, .mips = 4};
    const TextureDesc faces{
        .dimension = cube, .format = Format::rgba8_unorm, .extent = {8, 8, 1}, .layers = 6, .mips = 2};
    TextureDesc drawable = flat;
    drawable.usage = TextureUsage::sampled | TextureUsage::attachment;
    return {
        {"buffers", buffers},
        {"texture shapes", texture_shapes},
        {"texture copies", texture_copies},
        {"clears", clears},
        {"mips 2D", [=](Device& device) { return mips(device, drawable); }},
        {"mips 3D", [=](Device& device) { return mips(device, deep); }},
        {"sample 2D", [=](Device& device) { return sampled<sample_d2, d2>(device, flat); }},
        {"sample 3D", [=](Device& device) { return sampled<sample_d3, d3>(device, deep); }},
        {"sample cube", [=](Device& device) { return sampled<sample_cube, cube>(device, faces); }},
        {"store", stored},
        {"images", images},
        {"compute", computed},
        {"compute indirect", computed_indirectly},
        {"draw", [](Device& device) { return drawn(device, plain()); }},
        {"draw in a viewport",
         [](Device& device) {
             return drawn(device, plain(), Draw{.vertices = 3}, Viewport{2.5f, 3, 6, 7.5f});
         }},
        {"draw indexed", drawn_indexed},
        {"draw indirect", drawn_indirectly},
        {"draw indexed indirect", drawn_indexed_indirectly},
        {"draw blended", drawn_blended},
        {"draw with depth", drawn_with_depth},
        {"draw with samples", drawn_with_samples},
        {"draw lines", [](Device& device) { return drawn_as(device, Topology::lines); }},
        {"draw points", [](Device& device) { return drawn_as(device, Topology::points); }},
        {"draw to several", drawn_to_several},
        {"draw to layers", drawn_to_layers},
        {"draw without targets", drawn_without_targets},
        {"times", timed},
        {"create while recording", created_while_recording},
        {"refused", refused},
    };
}

}  // namespace lumo::testing_support
