#include "samples/embed-vulkan/gi.hpp"

#include <stdexcept>

#include "backends/vulkan/adopt.hpp"
#include "techniques/cones/cones.hpp"
#include "techniques/gbuffer/gbuffer.hpp"
#include "techniques/shadow/shadow.hpp"
#include "techniques/voxels/voxels.hpp"

namespace embed {

using namespace lumo;
using rhi::Dimension;

namespace {

/// What lumo makes is a value or an error; here an error ends the program.
template <class T>
T must(Result<T> result) {
    if (!result) throw std::runtime_error(to_string(result.error()));
    if constexpr (!std::is_void_v<T>) return std::move(*result);
}

// 1. The device. lumo makes every call through functions that get_instance_proc_addr gives it, so a host with a loader
// of its own hands on that one. Features and extensions are told, because Vulkan does not tell what was enabled.
rhi::Device adopt(const Host& host) {
    return must(backends::vulkan::adopt_device({.get_instance_proc_addr = vkGetInstanceProcAddr,
                                                .instance = host.instance(),
                                                .api_version = VK_API_VERSION_1_3,
                                                .physical_device = host.physical_device(),
                                                .device = host.device(),
                                                .queue = host.queue(),
                                                .queue_family = host.queue_family(),
                                                .features = &host.features(),
                                                .extensions = host.device_extensions()}));
}

// 2. The scene, for the voxels and the shadow map alone: its pixels stay the host's. An engine that has its triangles
// in storage buffers already fills a scene::GeometryView instead, and uploads nothing.
scene::Scene scene_of_boxes() {
    scene::Scene scene;
    for (const Box& box : boxes) {
        const auto first_index = uint32_t(scene.indices.size());
        for (int face = 0; face < 6; ++face) {
            const int axis = face / 2;
            glm::vec3 normal(0), u(0), v(0);
            normal[axis] = face % 2 == 0 ? 1.0f : -1.0f;
            u[(axis + 1) % 3] = normal[axis];  // u x v = normal: counter-clockwise seen from outside
            v[(axis + 2) % 3] = 1;
            const auto first = uint32_t(scene.vertices.size());
            for (const glm::vec2 corner : {glm::vec2(-1, -1), {1, -1}, {1, 1}, {-1, 1}})
                scene.vertices.push_back(
                    {.position = glm::vec3(box.center) +
                                 glm::vec3(box.half_size) * (normal + corner.x * u + corner.y * v),
                     .normal = normal});
            for (uint32_t corner : {0, 1, 2, 0, 2, 3}) scene.indices.push_back(first + corner);
        }
        const auto index = uint32_t(scene.meshes.size());
        scene.materials.push_back(
            {.base_color = glm::vec4(glm::vec3(box.color), 1), .metallic = 0, .roughness = 1});
        scene.meshes.push_back(
            {.primitives = {{.first_index = first_index, .index_count = 36, .material = index}}});
        scene.instances.push_back({.mesh = index});
    }
    return scene;
}

// 3. The images. Each is in `layout_before` whenever a submission of lumo's that uses it begins, and in `layout_after`
// when that ends. The host leaves them for its shaders to sample, and wants them back so; equal layouts also leave it
// free to use an image or not between two submissions of lumo's.
rhi::Texture adopt(rhi::Device& device, const char* name, const Host& host, const Image& image,
                   rhi::Format format) {
    constexpr uint32_t layout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
    return must(device.adopt_texture(
        {.name = name, .format = format, .extent = {host.width(), host.height()}},
        {.object = uint64_t(image.image), .layout_before = layout, .layout_after = layout}));
}

// 4. The camera. lumo counts rows from NDC y = -1, which is the bottom in its own pictures. This host draws its top
// there, so pixels go the other way along the same rays. Nothing else of lumo's cares which way is up.
gbuffer::CameraBlock camera_block(const Camera& camera, rhi::Extent size) {
    gbuffer::CameraBlock block = gbuffer::camera_block({.position = camera.position,
                                                        .target = camera.target,
                                                        .vertical_fov = camera.vertical_fov,
                                                        .near_plane = camera.near_plane,
                                                        .far_plane = camera.far_plane},
                                                       size);
    block.corner += block.along * float(size.height);
    block.along = -block.along;
    return block;
}

}  // namespace

/// In this order: the device outlives what was made on it.
struct Gi::Parts {
    rhi::Extent size;
    rhi::Device device;
    scene::GpuScene scene;
    std::vector<scene::Light> lights;
    rhi::Texture normal, depth, irradiance;
    shadow::Shadow shadow;
    voxels::Volume volume;
    cones::Irradiance cones;
};

Gi::Gi(const Host& host) {
    const rhi::Extent size{host.width(), host.height()};
    rhi::Device device = adopt(host);
    scene::GpuScene scene = must(scene::GpuScene::create(device, scene_of_boxes()));
    const scene::GeometryView geometry = scene.view();
    // Made in the order of the members, so that what fails leaves nothing behind.
    rhi::Texture normal = adopt(device, "host.normal", host, host.normal(), rhi::Format::rgba16_float);
    rhi::Texture depth = adopt(device, "host.depth", host, host.depth(), rhi::Format::d32_float);
    rhi::Texture irradiance =
        adopt(device, "host.irradiance", host, host.irradiance(), rhi::Format::rgba32_float);
    // 5. The techniques: each is told what the scene needs of it, and makes nothing else.
    const voxels::Settings settings{.resolution = 64};
    auto shadow = must(shadow::Shadow::create(device, {.resolution = 512}, {}));
    auto volume = must(voxels::Volume::create(device, settings,
                                              {.lights = true,
                                               .triangles = voxels::count_triangles(geometry),
                                               .draws = uint32_t(geometry.draws.size())}));
    auto cones = must(cones::Irradiance::create(device, {.count = 9}, {.environment = true}, size));
    const scene::Light sun{.intensity = sun_irradiance, .direction = -toward_sun};
    parts_ = std::make_unique<Parts>(Parts{size,
                                           std::move(device),
                                           std::move(scene),
                                           {sun},
                                           std::move(normal),
                                           std::move(depth),
                                           std::move(irradiance),
                                           std::move(shadow),
                                           std::move(volume),
                                           std::move(cones)});
    // The scene stands still: its voxels are made once.
    rhi::Commands commands = parts_->device.begin();
    parts_->volume.voxelize(commands, parts_->scene.view(), 0);
}

/// Waits for lumo's own work, and gives back all but what is the host's.
Gi::~Gi() = default;

// 6. A frame. Barriers, descriptors and staging are lumo's; the host's images come and go in their layouts. The host
// submits to the same queue, whose order is all the synchronization that is needed: between queues, Commands::wait and
// Commands::signal take semaphores.
void Gi::record(const Camera& camera) {
    Parts& parts = *parts_;
    rhi::Commands commands = parts.device.begin();
    const shadow::View lights = parts.shadow.record(commands, parts.scene.view(), parts.lights);
    parts.volume.inject(commands, &lights);
    // Cones read depth and normals of a G-buffer. This host has one normal for both that lumo knows, and keeps its
    // base colour to itself: lumo returns irradiance, and the host multiplies.
    const gbuffer::View gbuffer{.size = parts.size,
                                .normal_roughness = parts.normal.view<Dimension::d2>(),
                                .geometric_normal_occlusion = parts.normal.view<Dimension::d2>(),
                                .depth = parts.depth.view<Dimension::d2>(),
                                .camera = commands.uniform(camera_block(camera, parts.size))};
    parts.cones.record(commands, gbuffer, {.volume = parts.volume.view(), .environment = sky_radiance});
    const rhi::Texture& gathered = parts.cones.irradiance();
    commands.pass("to the host")
        .copy(gathered, whole_mip(gathered.desc()), parts.irradiance, whole_mip(parts.irradiance.desc()));
    parts.device.submit(std::move(commands));
}

}  // namespace embed
