// What a ray meets in a scene.
#pragma once

#include <glm/glm.hpp>
#include <limits>
#include <memory>
#include <optional>

#include "rhi/error.hpp"
#include "scene/scene.hpp"

namespace lumo::reference {

/// Points origin + t * direction in world space, near < t < far, in lengths of the direction.
struct Ray {
    glm::dvec3 origin{0};
    glm::dvec3 direction{0, 0, 1};
    double near = 0;
    double far = std::numeric_limits<double>::infinity();
};

/// A point of a triangle.
struct Hit {
    uint32_t instance = 0;   ///< index into Scene::instances
    uint32_t primitive = 0;  ///< index into its mesh's primitives
    uint32_t triangle = 0;   ///< of the primitive
    glm::dvec2 weights{0};   ///< of the second and third corners; the first has the rest
};

enum class Faces : uint8_t {
    drawn,  ///< as a rasterizer draws them: single-sided materials from their front alone
    both,
};

/// The triangles of all instances in a tree. Holes of alpha MASK let rays through. A BLEND surface stops a ray with
/// a probability of its opacity, decided by the ray's seed: the mean over many seeds is the blend.
class RayScene {
  public:
    /// `scene` outlives the result. Errors: out_of_memory, unsupported (this processor, or no Embree).
    static Result<RayScene> create(const scene::Scene& scene);

    RayScene(RayScene&&) noexcept;
    RayScene& operator=(RayScene&&) noexcept;
    ~RayScene();

    /// The nearest hit. From any thread.
    std::optional<Hit> intersect(const Ray& ray, Faces faces, uint32_t seed) const;

    /// Whether anything stops the ray. From any thread.
    bool occluded(const Ray& ray, uint32_t seed) const;

  private:
    struct Impl;
    explicit RayScene(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace lumo::reference
