#include "samples/embed-gl/gi.hpp"

#include <stdexcept>

#include "backends/gl/adopt.hpp"
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

// 2. The scene, for the voxels and the shadow map alone: its pixels stay the host's. The host has one mesh with a colour
// at each vertex, so one material does.
scene::Scene scene_of(const Mesh& mesh) {
    scene::Scene scene;
    for (const Vertex& vertex : mesh.vertices)
        scene.vertices.push_back(
            {.position = vertex.position, .normal = vertex.normal, .color = glm::vec4(vertex.color, 1)});
    scene.indices = mesh.indices;
    scene.materials = {{.metallic = 0, .roughness = 1}};
    scene.meshes = {{.primitives = {{.index_count = uint32_t(mesh.indices.size())}}}};
    scene.instances = {{}};
    return scene;
}

// 3. The textures, whose storage has to be immutable. lumo reads and writes them through views of its own: the host's
// filters, swizzles and mip ranges do not matter to it, and it changes none.
rhi::Texture adopt(rhi::Device& device, const char* name, rhi::Extent size, GLuint texture,
                   rhi::Format format) {
    return must(device.adopt_texture({.name = name, .format = format, .extent = size}, {.object = texture}));
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
    const rhi::Extent size{uint32_t(host.width()), uint32_t(host.height())};
    // 1. The device: of the context that is current here, as it has to be in each call of it from now on.
    rhi::Device device = must(backends::gl::adopt_current_context());
    scene::GpuScene scene = must(scene::GpuScene::create(device, scene_of(host.mesh())));
    const scene::GeometryView geometry = scene.view();
    rhi::Texture normal = adopt(device, "host.normal", size, host.normal(), rhi::Format::rgba16_float);
    rhi::Texture depth = adopt(device, "host.depth", size, host.depth(), rhi::Format::d32_float);
    rhi::Texture irradiance =
        adopt(device, "host.irradiance", size, host.irradiance(), rhi::Format::rgba32_float);
    // 4. The techniques: each is told what the scene needs of it, and makes nothing else.
    auto shadow = must(shadow::Shadow::create(device, {.resolution = 512}, {}));
    auto volume = must(voxels::Volume::create(device, {.resolution = 64},
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

/// Deletes all that lumo made; with the context current, as ever.
Gi::~Gi() = default;

// 5. A frame. From begin to submit the context is lumo's. What lumo changes of its state it has read before, and puts
// back at submit, so the host need not set anything anew. OpenGL orders the commands of one context: there is nothing
// to wait for.
void Gi::record(const Camera& camera) {
    Parts& parts = *parts_;
    rhi::Commands commands = parts.device.begin();
    const shadow::View lights = parts.shadow.record(commands, parts.scene.view(), parts.lights);
    parts.volume.inject(commands, &lights);
    // Cones read depth and normals of a G-buffer. This host has one normal for both that lumo knows, and keeps its
    // base colour to itself: lumo returns irradiance, and the host multiplies. OpenGL's pictures begin at the bottom,
    // as lumo's do, and a depth texture holds 0 to 1 whichever range clip space has: the camera's block fits as it is.
    const gbuffer::CameraBlock block = gbuffer::camera_block({.position = camera.position,
                                                              .target = camera.target,
                                                              .vertical_fov = camera.vertical_fov,
                                                              .near_plane = camera.near_plane,
                                                              .far_plane = camera.far_plane},
                                                             parts.size);
    const gbuffer::View gbuffer{.size = parts.size,
                                .base_color_metallic = {},
                                .normal_roughness = parts.normal.view<Dimension::d2>(),
                                .geometric_normal_occlusion = parts.normal.view<Dimension::d2>(),
                                .emission = {},
                                .depth = parts.depth.view<Dimension::d2>(),
                                .camera = commands.uniform(block)};
    parts.cones.record(commands, gbuffer, {.volume = parts.volume.view(), .environment = sky_radiance});
    const rhi::Texture& gathered = parts.cones.irradiance();
    commands.pass("to the host")
        .copy(gathered, whole_mip(gathered.desc()), parts.irradiance, whole_mip(parts.irradiance.desc()));
    parts.device.submit(std::move(commands));
}

}  // namespace embed
