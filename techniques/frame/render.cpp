#include "techniques/frame/render.hpp"

#include <algorithm>
#include <chrono>
#include <cstring>

#include "techniques/frame/frame.hpp"

namespace lumo::frame {
namespace {

/// Pictures have their first row at the top, textures at the bottom.
template <class T>
scene::Image<T> flipped(const std::vector<std::byte>& texels, rhi::Extent size, uint32_t channels) {
    scene::Image<T> image{size.width, size.height, channels,
                          std::vector<T>(size_t(size.width) * size.height * channels)};
    constexpr uint32_t stored_channels = 4;
    for (uint32_t y = 0; y < size.height; ++y) {
        for (uint32_t x = 0; x < size.width; ++x) {
            const size_t texel = size_t(size.height - 1 - y) * size.width + x;
            std::memcpy(image.at(x, y), texels.data() + texel * stored_channels * sizeof(T),
                        channels * sizeof(T));
        }
    }
    return image;
}

}  // namespace

Result<Rendered> render(rhi::Device& device, const scene::Scene& scene, const scene::Camera& camera,
                        const Settings& asked) {
    return scene::GpuScene::create(device, scene, asked.diffuse_materials)
        .and_then([&](const scene::GpuScene& gpu_scene) {
            return render(device, scene, gpu_scene, camera, asked, {});
        });
}

Result<Rendered> render(rhi::Device& device, const scene::Scene& scene, const scene::GpuScene& gpu_scene,
                        const scene::Camera& camera, const Settings& asked, const Again& again) {
    const SceneFacts facts = examine(scene, asked);
    const Settings settings = resolve(asked, facts);
    Rendered rendered;
    rendered.plan = make_plan(facts, settings);

    const scene::GeometryView geometry = gpu_scene.view();
    Result<Frame> frame = Frame::create(device, settings, rendered.plan, facts, geometry,
                                        scene.sky ? &scene.sky->atmosphere : nullptr);
    if (!frame) return tl::unexpected(frame.error());

    const Inputs inputs{.geometry = geometry,
                        .camera = camera,
                        .lights = shadow::drawn_lights(scene.lights),
                        .environment_radiance = scene.environment_radiance,
                        .sky = scene.sky};

    do {
        const auto start = std::chrono::steady_clock::now();
        rhi::Commands commands = device.begin();
        frame->record(commands, inputs);
        const rhi::Submission submission = device.submit(std::move(commands));
        if (Result<void> done = device.wait(submission); !done) return tl::unexpected(done.error());
        rendered.wall_ms =
            std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
        rendered.passes = device.pass_times(submission);
        rendered.trace = device.trace(submission);
    } while (again && again(rendered.passes));
    rendered.memory = device.memory();
    const Result<uint32_t> dropped = frame->dropped_voxel_writes(device);
    if (!dropped) return tl::unexpected(dropped.error());
    rendered.range = settings.voxels.range;
    rendered.dropped_voxel_writes = *dropped;

    for (const Layer layer : settings.layers) {
        const rhi::Texture& texture = frame->texture(layer);
        const auto texels = device.download(texture, rhi::whole_mip(texture.desc()));
        if (!texels) return tl::unexpected(texels.error());
        LayerImage& image = rendered.layers.emplace_back();
        image.layer = layer;
        if (layer == Layer::final) {
            image.display = flipped<uint8_t>(*texels, settings.size, 4);
        } else {
            image.linear = flipped<float>(*texels, settings.size, layer == Layer::depth ? 1 : 3);
        }
    }
    return rendered;
}

}  // namespace lumo::frame
