#include "techniques/atmosphere/atmosphere.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <glm/glm.hpp>
#include <numbers>

#include "techniques/atmosphere/quadrature.hpp"

namespace lumo::atmosphere {

using rhi::Dimension;
using rhi::Format;

namespace {

constexpr double pi = std::numbers::pi;
constexpr uint32_t max_nodes = 16;  // of shaders/atmosphere/air.glsl
constexpr uint32_t max_degree = 15;
constexpr uint32_t peak_texels = 256;
constexpr uint32_t peak_moments = 400;  // the rest is below 1e-9 up to g = 0.95
constexpr uint32_t rays_per_step = 1 << 16;

Result<void> check(const scene::Atmosphere& atmosphere, const Settings& s) {
    Result<void> result;
    const auto in_range = [&](std::string_view field, uint64_t value, uint64_t least, uint64_t most) {
        if (result && (value < least || value > most))
            result = fail(ErrorKind::invalid_argument, "atmosphere", fmt::format("{} is {}", field, value),
                          fmt::format("give a number from {} to {}", least, most));
    };
    in_range("the number of wavelengths", atmosphere.wavelengths_nm.size(), 1, max_wavelengths);
    in_range("orders", s.orders.value_or(1), 1, 1000);
    in_range("iterations", s.iterations, 2, 1000);
    in_range("columns", s.columns, 16, 1024);
    in_range("altitudes", s.altitudes, 2, 512);
    in_range("suns", s.suns, 2, 1024);
    in_range("degree", s.degree, 2, max_degree);
    in_range("zeniths", s.zeniths, 6, 128);
    in_range("azimuths", s.azimuths, s.degree + 1, 128);
    in_range("table_nodes", s.table_nodes, 4, max_nodes);
    in_range("nodes", s.nodes, 4, max_nodes);
    return result;
}

glm::vec4 components(const scene::Spectrum& values, double scale = 1) {
    glm::vec4 v(0);
    for (size_t i = 0; i < values.size(); ++i) v[int(i)] = float(values[i] * scale);
    return v;
}

/// Of the angles' map in sun_place(): it is linear over about the dip of the horizon at the air's top, half of that
/// below the level, and ends at three times it.
glm::vec4 sun_places(const scene::Atmosphere& a) {
    const double dip = std::acos(a.radius_ground_km / a.radius_top_km);
    const double middle = std::sin(0.5 * (0.5 * pi + 0.5 * dip));
    const double spread = std::clamp(0.9 * dip, 0.05, 1.0);
    const auto place = [&](double zenith) {
        const double x = std::sin(0.5 * std::min(zenith, pi)) - middle;
        return x / (spread + std::abs(x));
    };
    return glm::vec4(middle, spread, place(0), place(0.5 * pi + 3 * dip));
}

template <class Block>
void set_quadrature(Block& block, uint32_t nodes) {
    block.nodes = int32_t(nodes);
    const std::vector<Node> rule = gauss_legendre(nodes);
    for (uint32_t i = 0; i < nodes; ++i) {
        glm::vec4& pair = block.quadrature[i / 2];
        pair[int(2 * (i % 2))] = float(rule[i].x);
        pair[int(2 * (i % 2) + 1)] = float(rule[i].weight);
    }
}

/// All but the quadrature.
template <class Block>
Block make_block(const scene::Atmosphere& a, const Settings& settings) {
    Block block{};
    // Where a species is absent its coefficients are 0, and its shape is any that divides.
    const double rayleigh_height = a.rayleigh ? a.rayleigh->scale_height_km : a.height_km();
    const double mie_height = a.mie ? a.mie->scale_height_km : a.height_km();
    const scene::OzoneSpecies ozone =
        a.ozone.value_or(scene::OzoneSpecies{.bottom_km = 0, .peak_km = 1, .top_km = 2});
    if (a.rayleigh) block.rayleigh_scattering = components(a.rayleigh->scattering_per_km);
    if (a.mie) block.mie_scattering = components(a.mie->scattering_per_km);
    if (a.mie) block.mie_extinction = components(a.mie->extinction_per_km);
    if (a.ozone) block.ozone_extinction = components(a.ozone->extinction_per_km);
    block.sun_irradiance = components(a.sun_irradiance);
    block.ground_albedo = components(a.ground_albedo);
    block.ozone = glm::vec4(ozone.bottom_km, ozone.peak_km, ozone.top_km, 0);
    block.sun_places = sun_places(a);
    const auto shape = [&](double scale_height) {
        return std::min(8 * scale_height / (pi * a.radius_ground_km), 1.0);
    };
    const double least_height = std::min({rayleigh_height, mie_height, a.height_km()});
    block.column_shape =
        glm::vec4(shape(rayleigh_height), shape(mie_height), shape(0.5 * (ozone.top_km - ozone.bottom_km)),
                  std::clamp(3 * std::sqrt(2 * least_height / a.radius_ground_km), 0.01, 1.0));
    block.scale_heights = glm::vec2(rayleigh_height, mie_height);
    block.radius_ground = float(a.radius_ground_km);
    block.height = float(a.height_km());
    block.sun_radius = float(a.sun_angular_radius_deg * pi / 180);
    block.mie_g = a.mie ? float(a.mie->g) : 0;
    block.orders = int32_t(settings.orders.value_or(settings.iterations));
    block.degree = int32_t(settings.degree);
    const std::vector<double> moments =
        cornette_shanks_moments(a.mie ? a.mie->g : 0, std::max(settings.degree, 2u));
    for (uint32_t l = 0; l <= settings.degree; ++l) block.mie_moments[l / 4][int(l % 4)] = float(moments[l]);
    return block;
}

/// A quarter of the zenith angles for each zone that is below the level, of which there are two.
std::vector<glm::vec4> zenith_nodes(uint32_t count) {
    const uint32_t between = std::max(count / 6, 2u), below = std::max(count / 3, 2u);
    std::vector<glm::vec4> nodes;
    for (const auto& [zone, part] : {std::pair{0, below}, {1, between}, {2, count - below - between}})
        for (const Node& node : gauss_legendre(part))
            nodes.push_back(glm::vec4(node.x, node.weight, zone, 0));
    return nodes;
}

/// Orders 2 to 5 of light that aerosols scatter, as far as `orders` has them.
std::vector<glm::vec4> peak_table(const scene::Atmosphere& a, const Settings& settings) {
    std::vector<glm::vec4> table(peak_texels, glm::vec4(0));
    if (!a.mie) return table;
    const std::vector<double> moments = cornette_shanks_moments(a.mie->g, peak_moments);
    const uint32_t last = settings.orders.value_or(5);
    for (uint32_t i = 0; i < peak_texels; ++i) {
        const double sine = double(i) / (peak_texels - 1);
        for (uint32_t order = 2; order <= std::min(last, 5u); ++order)
            table[i][int(order - 2)] = float(peak(moments, settings.degree, order, 1 - 2 * sine * sine));
    }
    return table;
}

}  // namespace

Settings settings_of(Preset preset) {
    switch (preset) {
        case Preset::fast:
            return {.iterations = 4,
                    .columns = 64,
                    .altitudes = 20,
                    .suns = 40,
                    .degree = 3,
                    .zeniths = 16,
                    .azimuths = 6,
                    .table_nodes = 6,
                    .nodes = 10};
        case Preset::standard:
            break;
        case Preset::precise:
            return {.iterations = 8,
                    .altitudes = 48,
                    .suns = 96,
                    .degree = 6,
                    .zeniths = 32,
                    .azimuths = 12,
                    .table_nodes = 10};
    }
    return {};
}

Result<Preset> parse_preset(std::string_view name) {
    if (name == "fast") return Preset::fast;
    if (name == "default") return Preset::standard;
    if (name == "precise") return Preset::precise;
    return fail(ErrorKind::invalid_argument, "preset", fmt::format("there is no preset '{}'", name),
                "give fast, default or precise");
}

Result<Tables> Tables::create(rhi::Device& device, const scene::Atmosphere& atmosphere,
                              const Settings& settings) {
    Tables made;
    made.settings_ = settings;
    const auto checked = check(atmosphere, settings);
    if (!checked) return tl::unexpected(checked.error());
    made.block_ = make_block<Block>(atmosphere, settings);
    made.table_block_ = made.block_;
    set_quadrature(made.block_, settings.nodes);
    set_quadrature(made.table_block_, settings.table_nodes);
    const auto created =
        made.create_textures(device, atmosphere).and_then([&] { return made.create_pipelines(device); });
    if (!created) return tl::unexpected(created.error());

    made.steps_.emplace_back(Columns{});
    for (uint32_t order = 1; order <= settings.orders.value_or(settings.iterations); ++order)
        for (uint32_t row = 0; row < settings.altitudes; row += made.rows_per_step_)
            made.steps_.emplace_back(Rows{.order = order,
                                          .first = row,
                                          .count = std::min(made.rows_per_step_, settings.altitudes - row)});
    if (!settings.orders) made.steps_.emplace_back(Tail{});
    return made;
}

uint32_t Tables::layers() const { return (settings_.degree + 1) * (settings_.degree + 2) / 2 + 1; }

Result<void> Tables::create_textures(rhi::Device& device, const scene::Atmosphere& atmosphere) {
    const auto keep = [](auto created, auto& where) -> Result<void> {
        if (!created) return tl::unexpected(created.error());
        where = std::move(*created);
        return {};
    };
    const auto both = rhi::TextureUsage::sampled | rhi::TextureUsage::storage;
    const auto table = [&](std::string name, rhi::Texture& where) {
        return keep(device.create_texture({.name = std::move(name),
                                           .dimension = Dimension::d2_array,
                                           .format = Format::rgba32_float,
                                           .extent = {settings_.suns, settings_.altitudes},
                                           .layers = layers(),
                                           .usage = both}),
                    where);
    };
    const uint32_t rays_per_row = settings_.suns * settings_.zeniths * settings_.azimuths;
    rows_per_step_ = std::clamp(rays_per_step / rays_per_row, 1u, settings_.altitudes);
    const std::vector<glm::vec4> zeniths = zenith_nodes(settings_.zeniths);
    const std::vector<glm::vec4> peaks = peak_table(atmosphere, settings_);
    return table("atmosphere.sum", sum_)
        .and_then([&] { return table("atmosphere.odd_orders", moments_[1]); })
        .and_then([&] { return table("atmosphere.even_orders", moments_[0]); })
        .and_then([&] {
            return keep(device.create_texture({.name = "atmosphere.columns",
                                               .format = Format::rgba32_float,
                                               .extent = {settings_.columns, settings_.columns},
                                               .usage = both}),
                        columns_);
        })
        .and_then([&] {
            return keep(
                device.create_texture(
                    {.name = "atmosphere.peaks", .format = Format::rgba32_float, .extent = {peak_texels, 1}}),
                peaks_);
        })
        .and_then([&] {
            return keep(
                device.create_buffer({.name = "atmosphere.rays",
                                      .size = uint64_t(rows_per_step_) * rays_per_row * sizeof(glm::vec4)}),
                rays_);
        })
        .and_then([&] {
            return keep(device.create_buffer(
                            {.name = "atmosphere.zeniths", .size = zeniths.size() * sizeof(glm::vec4)}),
                        zeniths_);
        })
        .and_then([&] { return keep(device.create_sampler({}), sampler_); })
        .and_then([&] { return device.upload(zeniths_.slice(), std::as_bytes(std::span(zeniths))); })
        .and_then([&] {
            return device.upload(peaks_, rhi::whole_mip(peaks_.desc()), std::as_bytes(std::span(peaks)));
        });
}

Result<void> Tables::create_pipelines(rhi::Device& device) {
    const auto create = [&]<class P>(rhi::ComputePipeline<P>& pipeline) {
        return device.create_compute_pipeline<P>().map([&](auto created) { pipeline = std::move(created); });
    };
    return create(columns_pipeline_)
        .and_then([&] { return create(rays_pipeline_); })
        .and_then([&] { return create(moments_pipeline_); })
        .and_then([&] { return create(tail_pipeline_); });
}

Sky Tables::sky_of(rhi::Commands& commands, const Block& block, const rhi::Texture& moments) const {
    return {.block = commands.uniform(block),
            .columns = {columns_.view<Dimension::d2>(), sampler_},
            .moments = {moments.view<Dimension::d2_array>(), sampler_},
            .peaks = {peaks_.view<Dimension::d2>(), sampler_}};
}

Sky Tables::sky(rhi::Commands& commands) const { return sky_of(commands, block_, sum_); }

void Tables::record(rhi::Commands& commands, uint32_t step) const {
    if (const auto* rows = std::get_if<Rows>(&steps_[step])) {
        record_rows(commands, *rows);
    } else if (std::holds_alternative<Columns>(steps_[step])) {
        record_columns(commands);
    } else {
        record_tail(commands);
    }
}

void Tables::record_columns(rhi::Commands& commands) const {
    const rhi::UniformBuffer block = commands.uniform(block_);
    rhi::Pass pass = commands.pass("atmosphere.columns");
    const uint32_t groups = rhi::groups_for(settings_.columns, 8);
    pass.dispatch(columns_pipeline_, {.air = block, .columns = columns_.mip<Dimension::d2>(0)}, {},
                  {groups, groups, 1});
}

void Tables::record_rows(rhi::Commands& commands, const Rows& rows) const {
    const Sky sky = sky_of(commands, table_block_, moments_of(rows.order - 1));
    const glm::ivec2 size(settings_.suns, settings_.altitudes);
    const glm::ivec2 directions(settings_.zeniths, settings_.azimuths);
    const uint32_t texels = settings_.suns * rows.count;
    // What is scattered once more: of the last order nothing is.
    const bool last = settings_.orders == rows.order;
    const uint32_t first_layer = last ? layers() - 1 : 0;

    rhi::Pass pass = commands.pass("atmosphere.order");
    pass.dispatch(rays_pipeline_,
                  {.air = sky.block,
                   .air_columns = sky.columns,
                   .air_moments = sky.moments,
                   .air_peaks = sky.peaks,
                   .rays = rays_.slice(),
                   .zeniths = zeniths_.slice()},
                  {.size = size,
                   .directions = directions,
                   .first_row = int32_t(rows.first),
                   .rows = int32_t(rows.count),
                   .order = int32_t(rows.order)},
                  {rhi::groups_for(texels * settings_.zeniths * settings_.azimuths, 64)});
    pass.dispatch(moments_pipeline_,
                  {.air = sky.block,
                   .moments = moments_of(rows.order).mip<Dimension::d2_array>(0),
                   .sum = sum_.mip<Dimension::d2_array>(0),
                   .rays = rays_.slice(),
                   .zeniths = zeniths_.slice()},
                  {.size = size,
                   .directions = directions,
                   .first_row = int32_t(rows.first),
                   .rows = int32_t(rows.count),
                   .first_layer = int32_t(first_layer),
                   .layers = int32_t(layers() - first_layer),
                   .order = int32_t(rows.order)},
                  {rhi::groups_for(texels * (layers() - first_layer), 64)});
}

void Tables::record_tail(rhi::Commands& commands) const {
    rhi::Pass pass = commands.pass("atmosphere.tail");
    pass.dispatch(tail_pipeline_,
                  {.last = moments_of(settings_.iterations).mip<Dimension::d2_array>(0),
                   .before = moments_of(settings_.iterations - 1).mip<Dimension::d2_array>(0),
                   .sum = sum_.mip<Dimension::d2_array>(0)},
                  {},
                  {rhi::groups_for(settings_.suns, 8), rhi::groups_for(settings_.altitudes, 8), layers()});
}

uint64_t Tables::bytes() const {
    const uint64_t table = uint64_t(settings_.suns) * settings_.altitudes * layers();
    const uint64_t texels = 3 * table + uint64_t(settings_.columns) * settings_.columns + peak_texels;
    return texels * sizeof(glm::vec4) + rays_.size() + zeniths_.size();
}

Result<void> precompute(rhi::Device& device, const Tables& tables,
                        const std::function<void(double)>& progress) {
    for (uint32_t step = 0; step < tables.steps(); ++step) {
        rhi::Commands commands = device.begin();
        tables.record(commands, step);
        const auto done = device.wait(device.submit(std::move(commands)));
        if (!done) return done;
        if (progress) progress(double(step + 1) / tables.steps());
    }
    return {};
}

std::vector<scene::Atmosphere> by_fours(const scene::Atmosphere& atmosphere) {
    std::vector<scene::Atmosphere> parts;
    const size_t size = atmosphere.wavelengths_nm.size();
    for (size_t first = 0; first < size; first += max_wavelengths) {
        scene::Atmosphere part = atmosphere;
        const auto cut = [&](scene::Spectrum& values) {
            const auto begin = values.begin() + ptrdiff_t(first);
            values = scene::Spectrum(begin, begin + ptrdiff_t(std::min(max_wavelengths, size - first)));
        };
        cut(part.wavelengths_nm);
        cut(part.sun_irradiance);
        cut(part.ground_albedo);
        if (part.rayleigh) cut(part.rayleigh->scattering_per_km);
        if (part.mie) cut(part.mie->scattering_per_km);
        if (part.mie) cut(part.mie->extinction_per_km);
        if (part.ozone) cut(part.ozone->extinction_per_km);
        parts.push_back(std::move(part));
    }
    return parts;
}

}  // namespace lumo::atmosphere
