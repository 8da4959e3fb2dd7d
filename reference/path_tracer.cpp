#include "reference/path_tracer.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <fmt/format.h>
#include <mutex>
#include <new>
#include <numbers>
#include <system_error>
#include <thread>

#include "reference/brdf.hpp"
#include "reference/environment.hpp"
#include "reference/lights.hpp"
#include "reference/metrics.hpp"
#include "reference/ray_scene.hpp"
#include "reference/sampler.hpp"
#include "reference/seen_sky.hpp"
#include "reference/surface.hpp"

namespace lumo::reference {
namespace {

constexpr std::array<std::string_view, traced_layer_count> layer_names{
    "radiance", "direct",   "indirect", "irradiance", "specular",
    "ao",       "emission", "albedo",   "normal",     "depth"};

constexpr size_t light_layers = size_t(TracedLayer::emission) + 1;
using LightSums = std::array<glm::dvec3, light_layers>;

/// What a camera's ray brings, without the air before it.
struct Seen {
    LightSums light{};
    std::optional<double> distance = {};  ///< metres to a surface
};

bool is_light(TracedLayer layer) { return size_t(layer) < light_layers; }

/// The dimensions of a sample: those of the camera, then a block for each surface along the path.
enum CameraDimension : uint32_t { camera_jitter, camera_seed, camera_dimensions };
enum VertexDimension : uint32_t {
    light_choice,
    light_seed,
    emitter_choice,
    emitter_point,
    emitter_seed,
    lobe_choice,
    lobe_direction,
    ray_seed,
    survival,
    environment_point,
    environment_seed,
    vertex_dimensions
};
uint32_t first_dimension(uint32_t vertex) { return camera_dimensions + vertex * vertex_dimensions; }

/// The rays of gbuffer::camera_block.
class Lens {
  public:
    Lens(const scene::Camera& camera, uint32_t width, uint32_t height)
        : position_(camera.position), near_(camera.near_plane), far_(camera.far_plane) {
        axis_ = glm::normalize(glm::dvec3(camera.target) - position_);
        glm::dvec3 up(camera.up);
        if (glm::length(glm::cross(axis_, glm::normalize(up))) < 1e-6) up = {0, 0, -1};
        orthographic_ = camera.orthographic_height.has_value();
        const double half_height = orthographic_ ? 0.5 * double(*camera.orthographic_height)
                                                 : std::tan(0.5 * double(camera.vertical_fov));
        right_ = glm::normalize(glm::cross(axis_, up));
        up_ = glm::cross(right_, axis_);
        right_ *= half_height * width / height;
        up_ *= half_height;
        pixel_ = {2.0 / width, 2.0 / height};
    }

    /// `at` in pixels from the top left of the picture.
    Ray ray(glm::dvec2 at) const {
        const glm::dvec2 ndc{at.x * pixel_.x - 1, 1 - at.y * pixel_.y};
        const glm::dvec3 aside = ndc.x * right_ + ndc.y * up_;
        if (orthographic_) return {position_ + aside, axis_, near_, far_};
        const glm::dvec3 direction = axis_ + aside;
        const double length = glm::length(direction);
        return {position_, direction / length, near_ * length, far_ * length};
    }

    double depth(glm::dvec3 position) const { return glm::dot(position - position_, axis_); }

  private:
    glm::dvec3 position_, axis_{0}, right_{0}, up_{0};
    double near_, far_;
    glm::dvec2 pixel_{0};
    bool orthographic_ = false;
};

/// A surface that reflects light along a path.
struct Vertex {
    SurfacePoint surface;
    glm::dmat3 frame;    ///< of the shading normal
    glm::dvec3 to_eye;   ///< in the frame
    uint32_t dimension;  ///< where its block begins

    Vertex(const SurfacePoint& at, glm::dvec3 ray, uint32_t index)
        : surface(at),
          frame(frame_about(at.normal)),
          to_eye(-ray * frame),
          dimension(first_dimension(index)) {}

    bool above(glm::dvec3 direction) const { return glm::dot(direction, surface.geometric_normal) > 0; }
    /// Times the cosine; zero from behind the triangle.
    Reflected reflected(glm::dvec3 to_light) const {
        return above(to_light) ? reflect(surface.brdf, to_eye, to_light * frame) : Reflected{};
    }
};

/// A part of the light that arrives at a point: the radiance, over the density of its direction.
struct Arrival {
    glm::dvec3 direction{0};
    glm::dvec3 radiance{0};
};

/// The weight of a direction drawn with one density where another could have drawn it too (Veach's power heuristic).
double weight(double density, double other) {
    return density * density / (density * density + other * other);
}

glm::dvec3 sum(const Reflected& reflected) { return reflected.diffuse + reflected.specular; }

class Tracer {
  public:
    Tracer(const scene::Scene& scene, const PathTracerSettings& settings, RayScene rays)
        : scene_(scene),
          settings_(settings),
          occlusion_(std::ranges::find(settings.layers, TracedLayer::ao) != settings.layers.end()),
          rays_(std::move(rays)),
          emitters_(scene),
          environment_(scene) {}

    Seen sample(const Ray& ray, const Sampler& sampler) const;
    /// Albedo, normal and (in the first channel) depth.
    std::array<glm::dvec3, 3> surface(const Ray& ray, const Lens& lens, uint32_t seed) const;

  private:
    Reflected analytic(const Vertex& vertex, const Sampler& sampler) const;
    std::optional<Arrival> aimed(const Vertex& vertex, const DirectionSampler& directions,
                                 const Sampler& sampler) const;
    std::optional<Arrival> from_beyond(const Vertex& vertex, const DirectionSampler& directions,
                                       const Sampler& sampler) const;
    std::optional<Arrival> gathered(const Vertex& vertex, const DirectionSampler& directions,
                                    const Sampler& sampler) const;
    glm::dvec3 incoming(Ray ray, double density, const Sampler& sampler) const;
    double openness(const Vertex& vertex, const Sampler& sampler) const;

    const scene::Scene& scene_;
    const PathTracerSettings& settings_;
    bool occlusion_;  ///< is asked for
    RayScene rays_;
    Emitters emitters_;
    Environment environment_;
};

/// One of the analytic lights, drawn by what each would give unshadowed.
Reflected Tracer::analytic(const Vertex& vertex, const Sampler& sampler) const {
    struct Candidate {
        Reflected reflected;
        Incident incident;
    };
    std::optional<Candidate> chosen;
    double total = 0, chosen_share = 0;
    double choice = scene_.lights.size() > 1 ? sampler.number(vertex.dimension + light_choice) : 0;
    for (const scene::Light& light : scene_.lights) {
        const std::optional<Incident> arriving = incident(light, vertex.surface.position);
        if (!arriving) continue;
        Reflected reflected = vertex.reflected(arriving->to_light);
        reflected.diffuse *= arriving->irradiance;
        reflected.specular *= arriving->irradiance;
        const glm::dvec3 both = sum(reflected);
        const double share = both.x + both.y + both.z;
        if (share <= 0) continue;
        // A reservoir of one: the choice is stretched over what is left of it.
        total += share;
        const double part = share / total;
        if (choice < part) {
            choice /= part;
            chosen = Candidate{reflected, *arriving};
            chosen_share = share;
        } else {
            choice = (choice - part) / (1 - part);
        }
    }
    if (!chosen) return {};
    const Ray shadow{.origin = vertex.surface.above(),
                     .direction = chosen->incident.to_light,
                     .far = chosen->incident.distance};
    if (rays_.occluded(shadow, sampler.word(vertex.dimension + light_seed))) return {};
    const double over_probability = total / chosen_share;
    return {chosen->reflected.diffuse * over_probability, chosen->reflected.specular * over_probability};
}

/// Light of a point on an emitter.
std::optional<Arrival> Tracer::aimed(const Vertex& vertex, const DirectionSampler& directions,
                                     const Sampler& sampler) const {
    if (emitters_.empty()) return std::nullopt;
    const EmitterSample emitter = emitters_.sample(sampler.number(vertex.dimension + emitter_choice),
                                                   sampler.pair(vertex.dimension + emitter_point));
    const glm::dvec3 origin = vertex.surface.above();
    const glm::dvec3 to_emitter = emitter.position - origin;
    const double distance = glm::length(to_emitter);
    if (distance == 0) return std::nullopt;
    const glm::dvec3 direction_to = to_emitter / distance;
    const double facing = -glm::dot(emitter.normal, direction_to);
    if (facing == 0 || (facing < 0 && !emitter.double_sided)) return std::nullopt;
    if (!vertex.above(direction_to) || glm::dot(direction_to, vertex.surface.normal) <= 0)
        return std::nullopt;
    if (emitter.radiance == glm::dvec3(0)) return std::nullopt;

    const glm::dvec3 end = emitter.position + std::copysign(emitter.lift, facing) * emitter.normal;
    const Ray shadow{.origin = origin, .direction = end - origin, .far = 1};
    if (rays_.occluded(shadow, sampler.word(vertex.dimension + emitter_seed))) return std::nullopt;
    const double density = emitter.density * distance * distance / std::abs(facing);
    return Arrival{direction_to, emitter.radiance / density *
                                     weight(density, directions.density(direction_to * vertex.frame))};
}

/// Light of the environment's map from a direction in which it is bright.
std::optional<Arrival> Tracer::from_beyond(const Vertex& vertex, const DirectionSampler& directions,
                                           const Sampler& sampler) const {
    if (environment_.uniform()) return std::nullopt;
    const EnvironmentSample beyond = environment_.sample(sampler.pair(vertex.dimension + environment_point));
    if (!vertex.above(beyond.direction) || glm::dot(beyond.direction, vertex.surface.normal) <= 0)
        return std::nullopt;
    const Ray shadow{.origin = vertex.surface.above(), .direction = beyond.direction};
    if (rays_.occluded(shadow, sampler.word(vertex.dimension + environment_seed))) return std::nullopt;
    return Arrival{beyond.direction,
                   environment_.radiance(beyond.direction) / beyond.density *
                       weight(beyond.density, directions.density(beyond.direction * vertex.frame))};
}

/// Light from a direction that the reflection asks for.
std::optional<Arrival> Tracer::gathered(const Vertex& vertex, const DirectionSampler& directions,
                                        const Sampler& sampler) const {
    const glm::dvec3 local = directions.draw(sampler.number(vertex.dimension + lobe_choice),
                                             sampler.pair(vertex.dimension + lobe_direction));
    const glm::dvec3 way = vertex.frame * local;
    const double density = directions.density(local);
    if (density <= 0 || !vertex.above(way)) return std::nullopt;
    const glm::dvec3 radiance =
        incoming({.origin = vertex.surface.above(), .direction = way}, density, sampler);
    return Arrival{way, radiance / density};
}

/// Radiance along a ray that left the visible surface in a direction drawn with that density.
glm::dvec3 Tracer::incoming(Ray ray, double density, const Sampler& sampler) const {
    constexpr uint32_t first_roulette = 3;
    constexpr double highest_survival = 0.95;
    const bool diffuse = settings_.diffuse_materials || settings_.diffuse_reflectors;
    glm::dvec3 radiance(0), throughput(1);
    uint32_t seed_dimension = first_dimension(0) + ray_seed;
    for (uint32_t reflections = 0;; ++reflections) {
        const std::optional<Hit> hit = rays_.intersect(ray, Faces::both, sampler.word(seed_dimension));
        if (!hit)
            return radiance + throughput * environment_.radiance(ray.direction) *
                                  weight(density, environment_.density(ray.direction));
        const Vertex vertex(surface_at(scene_, *hit, ray.direction, diffuse), ray.direction, reflections + 1);
        if (vertex.surface.unlit) return radiance;
        if (vertex.surface.emission != glm::dvec3(0)) {
            const glm::dvec3 way = vertex.surface.position - ray.origin;
            const double cosine = std::abs(glm::dot(vertex.surface.geometric_normal, ray.direction));
            const double aimed_density =
                emitters_.density(*hit) * glm::dot(way, way) / std::max(cosine, 1e-12);
            radiance += throughput * vertex.surface.emission * weight(density, aimed_density);
        }
        if (settings_.bounces && reflections >= *settings_.bounces) return radiance;

        const SurfacePoint& surface = vertex.surface;
        const DirectionSampler directions(surface.brdf, vertex.to_eye,
                                          specular_share(surface.brdf, vertex.to_eye));
        radiance += throughput * sum(analytic(vertex, sampler));
        for (const auto& light :
             {aimed(vertex, directions, sampler), from_beyond(vertex, directions, sampler)})
            if (light) radiance += throughput * light->radiance * sum(vertex.reflected(light->direction));

        const glm::dvec3 local = directions.draw(sampler.number(vertex.dimension + lobe_choice),
                                                 sampler.pair(vertex.dimension + lobe_direction));
        density = directions.density(local);
        const glm::dvec3 way = vertex.frame * local;
        if (density <= 0) return radiance;
        throughput *= sum(vertex.reflected(way)) / density;
        const double brightest = std::max({throughput.x, throughput.y, throughput.z});
        if (brightest <= 0) return radiance;
        if (reflections + 1 >= first_roulette) {
            const double survives = std::min(brightest, highest_survival);
            if (sampler.number(vertex.dimension + survival) >= survives) return radiance;
            throughput /= survives;
        }
        ray = {.origin = surface.above(), .direction = way};
        seed_dimension = vertex.dimension + ray_seed;
    }
}

/// Ambient occlusion by one direction, drawn by the cosine; what lies behind the triangle is hidden.
double Tracer::openness(const Vertex& vertex, const Sampler& sampler) const {
    const glm::dvec2 at = sampler.pair(vertex.dimension + lobe_direction);
    const double sine = std::sqrt(at.x), angle = 2 * std::numbers::pi * at.y;
    const glm::dvec3 way =
        vertex.frame * glm::dvec3(sine * std::cos(angle), sine * std::sin(angle), std::sqrt(1 - at.x));
    if (!vertex.above(way)) return 0;
    const glm::dvec3 origin = vertex.surface.above();
    const std::optional<Hit> hit = rays_.intersect({.origin = origin, .direction = way}, Faces::both,
                                                   sampler.word(vertex.dimension + ray_seed));
    if (!hit) return 1;
    const double distance =
        glm::length(surface_at(scene_, *hit, way, settings_.diffuse_materials).position - origin);
    return 1 - 1 / (1 + distance / double(settings_.ao_radius));
}

Seen Tracer::sample(const Ray& ray, const Sampler& sampler) const {
    Seen result;
    const auto layer = [&](TracedLayer l) -> glm::dvec3& { return result.light[size_t(l)]; };
    const std::optional<Hit> hit = rays_.intersect(ray, Faces::drawn, sampler.word(camera_seed));
    if (!hit) {
        layer(TracedLayer::radiance) = layer(TracedLayer::emission) = environment_.radiance(ray.direction);
        return result;
    }
    const Vertex vertex(surface_at(scene_, *hit, ray.direction, settings_.diffuse_materials), ray.direction,
                        0);
    result.distance = glm::length(vertex.surface.position - ray.origin);
    if (vertex.surface.unlit) {
        layer(TracedLayer::radiance) = layer(TracedLayer::emission) = vertex.surface.base_color;
        return result;
    }

    // Irradiance wants directions by the cosine whatever the surface reflects, so that it gets half of them.
    const DirectionSampler directions(vertex.surface.brdf, vertex.to_eye, 0.5);
    for (const auto& light : {aimed(vertex, directions, sampler), from_beyond(vertex, directions, sampler),
                              gathered(vertex, directions, sampler)}) {
        if (!light) continue;
        const Reflected reflected = vertex.reflected(light->direction);
        layer(TracedLayer::irradiance) +=
            light->radiance * std::max(glm::dot(light->direction, vertex.surface.normal), 0.0);
        layer(TracedLayer::indirect) += light->radiance * reflected.diffuse;
        layer(TracedLayer::specular) += light->radiance * reflected.specular;
    }
    if (occlusion_) layer(TracedLayer::ao) = glm::dvec3(openness(vertex, sampler));
    layer(TracedLayer::direct) = sum(analytic(vertex, sampler));
    layer(TracedLayer::emission) = vertex.surface.emission;
    layer(TracedLayer::radiance) = layer(TracedLayer::direct) + layer(TracedLayer::indirect) +
                                   layer(TracedLayer::specular) + layer(TracedLayer::emission);
    return result;
}

std::array<glm::dvec3, 3> Tracer::surface(const Ray& ray, const Lens& lens, uint32_t seed) const {
    const std::optional<Hit> hit = rays_.intersect(ray, Faces::drawn, seed);
    if (!hit) return {};
    const SurfacePoint point = surface_at(scene_, *hit, ray.direction, settings_.diffuse_materials);
    return {point.base_color, point.unlit ? glm::dvec3(0) : point.normal,
            glm::dvec3(lens.depth(point.position))};
}

/// The means of two halves of a pixel's samples, by which the noise is known, and how many samples each has.
struct Halves {
    LightSums first{}, second{};
    double first_count = 0, second_count = 0;
};

/// Puts the air before what a pixel shows, and the sky behind it.
class PixelAir {
  public:
    PixelAir(const SeenSky& sky, uint32_t paths, uint32_t seed) : sky_(sky), paths_{paths, seed} {}

    /// Rays along one direction that end at one place share the air's paths.
    glm::dvec3 seen(const Seen& surface, glm::dvec3 direction) {
        const auto known = std::ranges::find_if(known_, [&](const Known& k) {
            return k.distance == surface.distance && k.direction == direction;
        });
        const AirBefore air = known != known_.end() ? known->air : look(surface.distance, direction);
        return surface.light[size_t(TracedLayer::radiance)] * air.transmittance + air.radiance;
    }

  private:
    struct Known {
        std::optional<double> distance;
        glm::dvec3 direction;
        AirBefore air;
    };

    AirBefore look(std::optional<double> distance, glm::dvec3 direction) {
        const AirBefore air =
            distance ? sky_.over(direction, *distance, paths_)
                     : AirBefore{.radiance = sky_.beyond(direction, paths_), .transmittance = glm::dvec3(0)};
        paths_.seed += 1'000'003;  // another look is by other paths
        known_.push_back({distance, direction, air});
        return air;
    }

    const SeenSky& sky_;
    SeenSkyPaths paths_;
    std::vector<Known> known_;
};

/// The mean of the sun's disc over a pixel, which may be larger.
glm::dvec3 disc_in_pixel(const SeenSky& sky, const Lens& lens, uint32_t x, uint32_t y) {
    constexpr int side = 24;
    const auto toward = [&](glm::dvec2 at) { return lens.ray(glm::dvec2(x, y) + at).direction; };
    const glm::dvec3 middle = toward(glm::dvec2(0.5));
    double reach = 0;
    for (const glm::dvec2 corner : {glm::dvec2(0, 0), {1, 0}, {0, 1}, {1, 1}})
        reach = std::max(reach, glm::length(toward(corner) - middle));
    glm::dvec3 sum(0);
    if (sky.to_sun_disc(middle) > 2 * reach) return sum;
    for (int i = 0; i < side * side; ++i)
        sum += sky.disc(toward((glm::dvec2(i % side, i / side) + 0.5) / double(side)));
    return sum / double(side * side);
}

/// `sky` is none where no layer shows it.
Halves trace_pixel(const Tracer& tracer, const Lens& lens, const PathTracerSettings& settings,
                   const SeenSky* sky, uint32_t x, uint32_t y) {
    Halves halves;
    const uint32_t pixel = hash(hash(settings.seed, x), y);
    const glm::dvec3 disc = sky ? disc_in_pixel(*sky, lens, x, y) : glm::dvec3(0);
    const auto trace_half = [&](LightSums& sums, uint32_t count, uint32_t half) {
        const uint32_t stream = hash(pixel, half);
        // Where every sample looks along its own direction, each has its own paths.
        const double paths = settings.air_paths * (settings.pixel_centers_only ? count : 1);
        std::optional<PixelAir> air;
        if (sky) air.emplace(*sky, std::max(uint32_t(std::lround(paths)), 1u), stream);
        for (uint32_t i = 0; i < count; ++i) {
            const Sampler sampler(stream, i);
            const glm::dvec2 at = settings.pixel_centers_only ? glm::dvec2(0.5) : sampler.pair(camera_jitter);
            const Ray ray = lens.ray(glm::dvec2(x, y) + at);
            Seen seen = tracer.sample(ray, sampler);
            if (air) {
                glm::dvec3& radiance = seen.light[size_t(TracedLayer::radiance)];
                radiance = air->seen(seen, ray.direction);
                if (!seen.distance) radiance += disc;
            }
            for (size_t l = 0; l < light_layers; ++l) sums[l] += seen.light[l];
        }
        for (glm::dvec3& sum : sums) sum /= count;
    };
    const uint32_t second = settings.spp / 2, first = settings.spp - second;
    trace_half(halves.first, first, 0);
    trace_half(halves.second, second, 1);
    halves.first_count = first;
    halves.second_count = second;
    return halves;
}

/// A layer while it is filled.
struct Target {
    TracedImage image;
    scene::ImageF first_half;  ///< light layers alone
};

scene::ImageF blank(uint32_t width, uint32_t height, uint32_t channels) {
    return {width, height, channels, std::vector<float>(size_t(width) * height * channels)};
}

Target make_target(TracedLayer layer, const PathTracerSettings& settings) {
    const uint32_t w = settings.width, h = settings.height;
    Target target;
    target.image.layer = layer;
    target.image.mean = blank(w, h, layer == TracedLayer::depth ? 1 : 3);
    if (is_light(layer)) {
        target.image.noise = blank(w, h, 3);
        target.first_half = blank(w, h, 3);
    }
    return target;
}

void store_light(Target& target, const Halves& halves, uint32_t x, uint32_t y) {
    const size_t layer = size_t(target.image.layer);
    const double count = halves.first_count + halves.second_count;
    const double spread = std::sqrt(halves.first_count * halves.second_count) / count;
    for (int c = 0; c < 3; ++c) {
        const double first = halves.first[layer][c], second = halves.second[layer][c];
        target.first_half.at(x, y)[c] = float(first);
        target.image.mean.at(x, y)[c] =
            float((halves.first_count * first + halves.second_count * second) / count);
        target.image.noise.at(x, y)[c] = float(spread * std::abs(first - second));
    }
}

void store_surface(Target& target, const std::array<glm::dvec3, 3>& values, uint32_t x, uint32_t y) {
    const glm::dvec3& value = values[size_t(target.image.layer) - light_layers];
    for (uint32_t c = 0; c < target.image.mean.channels; ++c)
        target.image.mean.at(x, y)[c] = float(value[int(c)]);
}

/// Hands out the picture in tiles until none is left.
class Tiles {
  public:
    static constexpr uint32_t side = 16;

    Tiles(const PathTracerSettings& settings, const Progress& progress)
        : columns_((settings.width + side - 1) / side),
          count_(columns_ * ((settings.height + side - 1) / side)),
          progress_(progress) {}

    std::optional<glm::uvec2> next() {
        const uint64_t tile = next_++;
        if (tile >= count_) return std::nullopt;
        return glm::uvec2(uint32_t(tile % columns_), uint32_t(tile / columns_)) * side;
    }

    void done() {
        if (!progress_) return;
        const std::lock_guard lock(mutex_);
        progress_(double(++done_) / double(count_));
    }

  private:
    uint64_t columns_, count_;
    std::atomic<uint64_t> next_ = 0;
    const Progress& progress_;
    std::mutex mutex_;
    uint64_t done_ = 0;
};

void trace_tiles(const Tracer& tracer, const Lens& lens, const PathTracerSettings& settings,
                 const SeenSky* sky, Tiles& tiles, std::vector<Target>& targets) {
    const auto wanted = [&](bool light) {
        return std::ranges::any_of(settings.layers, [&](TracedLayer l) { return is_light(l) == light; });
    };
    const bool light = wanted(true), surface = wanted(false);
    while (const auto tile = tiles.next()) {
        for (uint32_t y = tile->y; y < std::min(tile->y + Tiles::side, settings.height); ++y) {
            for (uint32_t x = tile->x; x < std::min(tile->x + Tiles::side, settings.width); ++x) {
                const Halves halves = light ? trace_pixel(tracer, lens, settings, sky, x, y) : Halves{};
                const uint32_t seed = hash(hash(settings.seed, x), y);
                const auto values = surface ? tracer.surface(lens.ray(glm::dvec2(x, y) + 0.5), lens, seed)
                                            : std::array<glm::dvec3, 3>{};
                for (Target& target : targets) {
                    if (is_light(target.image.layer))
                        store_light(target, halves, x, y);
                    else
                        store_surface(target, values, x, y);
                }
            }
        }
        tiles.done();
    }
}

Result<void> check(const PathTracerSettings& settings) {
    if (settings.width == 0 || settings.height == 0)
        return fail(ErrorKind::invalid_argument, "reference",
                    fmt::format("a picture of {} x {} has no pixels", settings.width, settings.height));
    if (settings.spp < 2)
        return fail(ErrorKind::invalid_argument, "reference",
                    fmt::format("{} samples a pixel do not show their noise", settings.spp),
                    "take 2 or more");
    return {};
}

Result<PathTraced> trace(const scene::Scene& scene, const scene::Camera& camera,
                         const PathTracerSettings& settings, const Progress& progress) {
    Result<RayScene> rays = RayScene::create(scene);
    if (!rays) return tl::unexpected(std::move(rays.error()));
    const Tracer tracer(scene, settings, std::move(*rays));
    const Lens lens(camera, settings.width, settings.height);
    std::optional<SeenSky> sky;
    if (scene.sky && std::ranges::find(settings.layers, TracedLayer::radiance) != settings.layers.end())
        sky.emplace(*scene.sky, glm::dvec3(camera.position));
    const SeenSky* const seen = sky ? &*sky : nullptr;
    std::vector<Target> targets;
    for (const TracedLayer layer : settings.layers) targets.push_back(make_target(layer, settings));
    {
        Tiles tiles(settings, progress);
        const uint32_t threads =
            settings.threads > 0 ? settings.threads : std::max(std::thread::hardware_concurrency(), 1u);
        std::vector<std::jthread> others;
        for (uint32_t i = 1; i < threads; ++i)
            others.emplace_back([&] { trace_tiles(tracer, lens, settings, seen, tiles, targets); });
        trace_tiles(tracer, lens, settings, seen, tiles, targets);
    }
    PathTraced result;
    for (Target& target : targets) {
        if (is_light(target.image.layer)) {
            const auto of_first = relative_rmse(target.image.mean, target.first_half);
            if (!of_first) return tl::unexpected(of_first.error());
            // The first half of n samples is off by the mean's noise times sqrt(second / first).
            const uint32_t second = settings.spp / 2;
            target.image.relative_noise = *of_first * std::sqrt(double(settings.spp - second) / second);
        }
        result.layers.push_back(std::move(target.image));
    }
    return result;
}

}  // namespace

std::string_view to_string(TracedLayer layer) { return layer_names[size_t(layer)]; }

std::optional<TracedLayer> traced_layer_from_string(std::string_view name) {
    const auto found = std::ranges::find(layer_names, name);
    if (found == layer_names.end()) return std::nullopt;
    return TracedLayer(found - layer_names.begin());
}

const TracedImage& PathTraced::operator[](TracedLayer layer) const {
    return *std::ranges::find(layers, layer, &TracedImage::layer);
}

Result<PathTraced> path_trace(const scene::Scene& scene, const scene::Camera& camera,
                              const PathTracerSettings& settings, const Progress& progress) {
    if (Result<void> fine = check(settings); !fine) return tl::unexpected(std::move(fine.error()));
    try {
        return trace(scene, camera, settings, progress);
    } catch (const std::bad_alloc&) {
        return fail(ErrorKind::out_of_memory, "reference", "the pictures do not fit in memory",
                    "take a smaller size");
    } catch (const std::system_error& error) {
        return fail(ErrorKind::out_of_memory, "reference",
                    fmt::format("no thread can be made: {}", error.what()), "take fewer");
    }
}

}  // namespace lumo::reference
