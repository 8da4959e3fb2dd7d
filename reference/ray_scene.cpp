#include "reference/ray_scene.hpp"

#include <fmt/format.h>
#include <glm/gtc/type_ptr.hpp>
#include <vector>

#include "reference/embree.hpp"
#include "reference/sampler.hpp"
#include "reference/surface.hpp"

namespace lumo::reference {
namespace {

using Device = std::unique_ptr<RTCDeviceTy, decltype(&rtcReleaseDevice)>;
using Tree = std::unique_ptr<RTCSceneTy, decltype(&rtcReleaseScene)>;

/// What the filter has to know of a geometry, its user data.
struct Triangles {
    const scene::Scene* scene;
    const scene::Primitive* primitive;
};

/// A ray's context, passed to the filter.
struct Context {
    RTCIntersectContext embree;
    uint32_t seed;
    bool drawn_faces;
};

/// The seed decides for each triangle anew, and in the same way when the tree offers one twice.
bool stops(const scene::Scene& scene, const scene::Primitive& primitive, const RTCHit& hit, uint32_t seed) {
    const scene::Material& material = scene.materials[primitive.material];
    if (material.alpha_mode == scene::AlphaMode::opaque) return true;
    const double opacity = opacity_at(scene, primitive, hit.primID, {hit.u, hit.v});
    if (opacity >= 1) return true;
    const uint32_t triangle = primitive.first_index + 3 * hit.primID;
    return to_unit(hash(seed, hash(triangle, hit.instID[0]))) < opacity;
}

void filter(const RTCFilterFunctionNArguments* arguments) {
    const auto& context = *reinterpret_cast<const Context*>(arguments->context);
    const auto& geometry = *static_cast<const Triangles*>(arguments->geometryUserPtr);
    const auto& hit = *reinterpret_cast<const RTCHit*>(arguments->hit);
    const auto& ray = *reinterpret_cast<const RTCRay*>(arguments->ray);
    // In object space, where mirrors have not yet swapped the faces.
    const float facing = ray.dir_x * hit.Ng_x + ray.dir_y * hit.Ng_y + ray.dir_z * hit.Ng_z;
    const bool hidden = context.drawn_faces && facing > 0 &&
                        !geometry.scene->materials[geometry.primitive->material].double_sided;
    if (hidden || !stops(*geometry.scene, *geometry.primitive, hit, context.seed)) arguments->valid[0] = 0;
}

RTCRay embree_ray(const Ray& ray) {
    return {.org_x = float(ray.origin.x),
            .org_y = float(ray.origin.y),
            .org_z = float(ray.origin.z),
            .tnear = float(ray.near),
            .dir_x = float(ray.direction.x),
            .dir_y = float(ray.direction.y),
            .dir_z = float(ray.direction.z),
            .time = 0,
            .tfar = float(ray.far),
            .mask = ~0u,
            .id = 0,
            .flags = 0};
}

/// The first error since the last call; without a device, that of making one.
Result<void> last_error(const Embree& embree, RTCDevice device) {
    const RTCError error = embree.get_device_error(device);
    if (error == RTC_ERROR_NONE) return {};
    if (error == RTC_ERROR_OUT_OF_MEMORY)
        return fail(ErrorKind::out_of_memory, "ray tracing", "out of memory",
                    "free some, or take a smaller scene");
    return fail(ErrorKind::unsupported, "ray tracing", fmt::format("Embree ends with error {}", int(error)),
                error == RTC_ERROR_UNSUPPORTED_CPU ? "it does not run on this processor" : "");
}

}  // namespace

struct RayScene::Impl {
    explicit Impl(const Embree& functions) : embree(functions) {}

    Embree embree;
    Device device{embree.new_device(nullptr), embree.release_device};
    std::vector<std::vector<Triangles>> triangles;  // by mesh and primitive
    std::vector<Tree> meshes;
    Tree world{nullptr, embree.release_scene};
    bool translucent = false;

    Tree mesh_tree(const scene::Scene& scene, const scene::Mesh& mesh,
                   const std::vector<Triangles>& data) const;
    Tree world_tree(const scene::Scene& scene) const;
    Context context(Faces faces, uint32_t seed) const;
};

RayScene::RayScene(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
RayScene::RayScene(RayScene&&) noexcept = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;
RayScene::~RayScene() = default;

Tree RayScene::Impl::mesh_tree(const scene::Scene& scene, const scene::Mesh& mesh,
                               const std::vector<Triangles>& data) const {
    Tree tree(embree.new_scene(device.get()), embree.release_scene);
    embree.set_scene_flags(tree.get(),
                           RTCSceneFlags(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));
    for (size_t i = 0; i < mesh.primitives.size(); ++i) {
        const scene::Primitive& primitive = mesh.primitives[i];
        if (primitive.index_count == 0) continue;
        RTCGeometry geometry = embree.new_geometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
        embree.set_shared_geometry_buffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                          scene.vertices.data(), 0, sizeof(scene::Vertex),
                                          scene.vertices.size());
        embree.set_shared_geometry_buffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                          scene.indices.data() + primitive.first_index, 0,
                                          3 * sizeof(uint32_t), primitive.index_count / 3);
        embree.set_geometry_user_data(geometry, const_cast<Triangles*>(&data[i]));  // only read
        embree.commit_geometry(geometry);
        embree.attach_geometry_by_id(tree.get(), geometry, uint32_t(i));
        embree.release_geometry(geometry);
    }
    embree.commit_scene(tree.get());
    return tree;
}

Tree RayScene::Impl::world_tree(const scene::Scene& scene) const {
    Tree tree(embree.new_scene(device.get()), embree.release_scene);
    embree.set_scene_flags(tree.get(), RTC_SCENE_FLAG_ROBUST);
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const scene::Instance& instance = scene.instances[i];
        RTCGeometry geometry = embree.new_geometry(device.get(), RTC_GEOMETRY_TYPE_INSTANCE);
        embree.set_geometry_instanced_scene(geometry, meshes[instance.mesh].get());
        embree.set_geometry_transform(geometry, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR,
                                      glm::value_ptr(instance.world_from_object));
        embree.commit_geometry(geometry);
        embree.attach_geometry_by_id(tree.get(), geometry, uint32_t(i));
        embree.release_geometry(geometry);
    }
    embree.commit_scene(tree.get());
    return tree;
}

Context RayScene::Impl::context(Faces faces, uint32_t seed) const {
    Context context{.embree = {}, .seed = seed, .drawn_faces = faces == Faces::drawn};
    rtcInitIntersectContext(&context.embree);
    if (translucent || context.drawn_faces) context.embree.filter = filter;
    return context;
}

Result<RayScene> RayScene::create(const scene::Scene& scene) {
    const Result<Embree> embree = load_embree();
    if (!embree) return tl::unexpected(embree.error());
    auto impl = std::make_unique<Impl>(*embree);
    if (!impl->device) return tl::unexpected(last_error(*embree, nullptr).error());
    for (const scene::Material& material : scene.materials)
        impl->translucent |= material.alpha_mode != scene::AlphaMode::opaque;
    for (const scene::Mesh& mesh : scene.meshes) {
        std::vector<Triangles>& data = impl->triangles.emplace_back();
        for (const scene::Primitive& primitive : mesh.primitives) data.push_back({&scene, &primitive});
        impl->meshes.push_back(impl->mesh_tree(scene, mesh, data));
    }
    impl->world = impl->world_tree(scene);
    if (Result<void> built = last_error(*embree, impl->device.get()); !built)
        return tl::unexpected(std::move(built.error()));
    return RayScene(std::move(impl));
}

std::optional<Hit> RayScene::intersect(const Ray& ray, Faces faces, uint32_t seed) const {
    Context context = impl_->context(faces, seed);
    RTCRayHit result{.ray = embree_ray(ray), .hit = {}};
    result.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    impl_->embree.intersect1(impl_->world.get(), &context.embree, &result);
    if (result.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    return Hit{.instance = result.hit.instID[0],
               .primitive = result.hit.geomID,
               .triangle = result.hit.primID,
               .weights = {result.hit.u, result.hit.v}};
}

bool RayScene::occluded(const Ray& ray, uint32_t seed) const {
    Context context = impl_->context(Faces::both, seed);
    RTCRay result = embree_ray(ray);
    impl_->embree.occluded1(impl_->world.get(), &context.embree, &result);
    return result.tfar < 0;
}

}  // namespace lumo::reference
