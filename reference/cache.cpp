#include "reference/cache.hpp"

#include <bit>
#include <cstring>
#include <span>

#include "scene/content_key.hpp"

namespace lumo::reference {
namespace {

constexpr uint64_t max_cache_bytes = uint64_t(1) << 30;

void add(rhi::KeyBuilder& key, const rhi::CacheKey& part) { key.add(part.high).add(part.low); }

rhi::CacheKey key_of(const scene::Scene& scene, const scene::Camera& camera,
                     const PathTracerSettings& settings) {
    // A member more does not compile here: add it, unless, as the number of threads, it changes nothing.
    const auto& [width, height, spp, bounces, seed, diffuse_materials, diffuse_reflectors, pixel_centers_only,
                 air_paths, ao_radius, threads, layers] = settings;
    rhi::KeyBuilder key;
    key.add("path-traced layers").add(sources_version());
    add(key, content_key(scene));
    add(key, content_key(camera));
    key.add(width).add(height).add(spp).add(bounces ? uint64_t(*bounces) + 1 : 0).add(seed);
    key.add(uint64_t(diffuse_materials)).add(uint64_t(diffuse_reflectors)).add(uint64_t(pixel_centers_only));
    key.add(std::bit_cast<uint64_t>(air_paths)).add(std::bit_cast<uint32_t>(ao_radius));
    for (const TracedLayer layer : layers) key.add(uint64_t(layer));
    return key.key();
}

/// An entry: for every layer its relative noise, and its mean and noise as width, height, channels, values.
class Writer {
  public:
    template <class T>
    void add(const T& value) {
        const auto* first = reinterpret_cast<const std::byte*>(&value);
        bytes.insert(bytes.end(), first, first + sizeof value);
    }
    void add(const scene::ImageF& image) {
        add(image.width);
        add(image.height);
        add(image.channels);
        add(uint64_t(image.values.size()));
        const auto values = std::as_bytes(std::span(image.values));
        bytes.insert(bytes.end(), values.begin(), values.end());
    }
    std::vector<std::byte> bytes = {};
};

/// The cache has checked the bytes; that there are enough of them is still checked, as nothing may crash.
class Reader {
  public:
    explicit Reader(std::span<const std::byte> bytes) : rest_(bytes) {}

    template <class T>
    bool read(T& value) {
        if (rest_.size() < sizeof value) return false;
        std::memcpy(&value, rest_.data(), sizeof value);
        rest_ = rest_.subspan(sizeof value);
        return true;
    }
    bool read(scene::ImageF& image) {
        uint64_t count = 0;
        if (!read(image.width) || !read(image.height) || !read(image.channels) || !read(count) ||
            count > rest_.size() / sizeof(float))
            return false;
        image.values.resize(count);
        std::memcpy(image.values.data(), rest_.data(), count * sizeof(float));
        rest_ = rest_.subspan(count * sizeof(float));
        return true;
    }
    bool ended() const { return rest_.empty(); }

  private:
    std::span<const std::byte> rest_;
};

std::vector<std::byte> bytes_of(const PathTraced& traced) {
    Writer writer;
    for (const TracedImage& layer : traced.layers) {
        writer.add(layer.relative_noise);
        writer.add(layer.mean);
        writer.add(layer.noise);
    }
    return std::move(writer.bytes);
}

std::optional<PathTraced> traced_of(std::span<const std::byte> bytes,
                                    const std::vector<TracedLayer>& layers) {
    Reader reader(bytes);
    PathTraced traced;
    for (const TracedLayer layer : layers) {
        TracedImage& image = traced.layers.emplace_back(TracedImage{.layer = layer});
        if (!reader.read(image.relative_noise) || !reader.read(image.mean) || !reader.read(image.noise))
            return std::nullopt;
    }
    return reader.ended() ? std::optional(std::move(traced)) : std::nullopt;
}

}  // namespace

rhi::DiskCache user_cache() {
    const std::filesystem::path folder = rhi::DiskCache::of_user().folder();
    return rhi::DiskCache(folder.empty() ? folder : folder / "reference", max_cache_bytes);
}

Result<CachedTrace> path_trace_cached(const scene::Scene& scene, const scene::Camera& camera,
                                      const PathTracerSettings& settings, const rhi::DiskCache& cache,
                                      const Progress& progress) {
    const rhi::CacheKey key = key_of(scene, camera, settings);
    if (const auto bytes = cache.get(key)) {
        if (auto traced = traced_of(*bytes, settings.layers))
            return CachedTrace{.traced = std::move(*traced), .found = true};
    }
    return path_trace(scene, camera, settings, progress).map([&](PathTraced traced) {
        CachedTrace made{.traced = std::move(traced)};
        made.stored = cache.put(key, bytes_of(made.traced));
        return made;
    });
}

}  // namespace lumo::reference
