#include "techniques/atmosphere/stored.hpp"

#include <fmt/format.h>

namespace lumo::atmosphere {
namespace {

Result<void> append(std::vector<std::byte>& all, const Result<std::vector<std::byte>>& part) {
    if (!part) return tl::unexpected(part.error());
    all.insert(all.end(), part->begin(), part->end());
    return {};
}

/// A name of all that decides what the tables hold.
Result<rhi::CacheKey> key_of(rhi::Device& device, const Tables& tables) {
    return tables.recipe(device).map([&](const std::vector<std::byte>& recipe) {
        const rhi::DeviceInfo& info = device.info();
        return rhi::KeyBuilder()
            .add("atmosphere tables")
            .add(rhi::to_string(info.api))
            .add(info.name)
            .add(info.driver)
            .add(recipe)
            .key();
    });
}

}  // namespace

Result<std::vector<std::byte>> Tables::recipe(rhi::Device& device) const {
    const std::array<uint64_t, 5> programs{
        shaders::atmosphere::columns::info().hash, shaders::atmosphere::rays::info().hash,
        shaders::atmosphere::rings::info().hash, shaders::atmosphere::gather::info().hash,
        shaders::atmosphere::tail::info().hash};
    const std::array<uint64_t, 10> numbers{settings_.orders.value_or(0),
                                           settings_.iterations,
                                           settings_.columns,
                                           settings_.altitudes,
                                           settings_.suns,
                                           settings_.directions,
                                           settings_.degree,
                                           settings_.zeniths,
                                           settings_.azimuths,
                                           settings_.nodes};
    std::vector<std::byte> all;
    for (const std::span<const std::byte> part : std::initializer_list<std::span<const std::byte>>{
             std::as_bytes(std::span(programs)), std::as_bytes(std::span(numbers)),
             std::as_bytes(std::span(&block_, 1)), std::as_bytes(std::span(&table_block_, 1))})
        all.insert(all.end(), part.begin(), part.end());
    return append(all, device.download(zeniths_.slice()))
        .and_then([&] { return append(all, device.download(weights_.slice())); })
        .and_then([&] { return append(all, device.download(peaks_, rhi::whole_mip(peaks_.desc()))); })
        .map([&] { return std::move(all); });
}

Result<std::vector<std::byte>> Tables::contents(rhi::Device& device) const {
    std::vector<std::byte> all;
    return append(all, device.download(columns_, rhi::whole_mip(columns_.desc())))
        .and_then([&] { return append(all, device.download(sum_, rhi::whole_mip(sum_.desc()))); })
        .map([&] { return std::move(all); });
}

Result<void> Tables::restore(rhi::Device& device, std::span<const std::byte> contents) {
    const rhi::TextureRegion columns = rhi::whole_mip(columns_.desc()), sum = rhi::whole_mip(sum_.desc());
    const uint64_t first = rhi::region_bytes(columns_.desc().format, columns);
    const uint64_t size = first + rhi::region_bytes(sum_.desc().format, sum);
    if (contents.size() != size)
        return fail(ErrorKind::invalid_argument, "atmosphere",
                    fmt::format("contents of {} bytes", contents.size()), fmt::format("give {}", size));
    return device.upload(columns_, columns, contents.first(first)).and_then([&] {
        return device.upload(sum_, sum, contents.subspan(first));
    });
}

Result<Tables> stored_or_precomputed(rhi::Device& device, const scene::Atmosphere& atmosphere,
                                     const Settings& settings, const rhi::DiskCache& cache,
                                     const std::function<void(double)>& progress) {
    auto tables = Tables::create(device, atmosphere, settings);
    if (!tables) return tables;
    const auto key = key_of(device, *tables);
    if (!key) return tl::unexpected(key.error());
    if (const auto stored = cache.get(*key)) {
        if (const auto restored = tables->restore(device, *stored); !restored)
            return tl::unexpected(restored.error());
        return tables;
    }
    return precompute(device, *tables, progress)
        .and_then([&] { return tables->contents(device); })
        .map([&](const std::vector<std::byte>& contents) {
            (void)cache.put(*key, contents);  // a cache: without it the tables are made again
            return std::move(*tables);
        });
}

Result<std::vector<Tables>> stored_or_precomputed_by_fours(rhi::Device& device,
                                                           const scene::Atmosphere& atmosphere,
                                                           const Settings& settings,
                                                           const rhi::DiskCache& cache,
                                                           const std::function<void(double)>& progress) {
    const std::vector<scene::Atmosphere> parts = by_fours(atmosphere);
    std::vector<Tables> all;
    for (const scene::Atmosphere& part : parts) {
        auto tables = stored_or_precomputed(device, part, settings, cache, [&](double done) {
            if (progress) progress((double(all.size()) + done) / double(parts.size()));
        });
        if (!tables) return tl::unexpected(tables.error());
        all.push_back(std::move(*tables));
    }
    return all;
}

}  // namespace lumo::atmosphere
