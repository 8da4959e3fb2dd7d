#include "techniques/atmosphere/atmosphere.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <glm/glm.hpp>
#include <numbers>

#include "rhi/keep.hpp"
#include "techniques/atmosphere/quadrature.hpp"

namespace lumo::atmosphere {

using rhi::Dimension;
using rhi::Format;

namespace {

constexpr double pi = std::numbers::pi;
constexpr uint32_t max_nodes = 16;                                 // of shaders/atmosphere/air.glsl
constexpr uint32_t irradiance_layer = 4, first_aerosol_layer = 5;  // of shaders/atmosphere/scattering.glsl
constexpr uint32_t max_layers = 256;                               // that every device has
constexpr uint32_t peak_texels = 256;
constexpr uint32_t peak_moments = 400;  // the rest is below 1e-9 up to g = 0.95
constexpr uint32_t most_degrees = 48;   // of the aerosols' light that is gathered from many directions
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
    in_range("degree", s.degree, 2, 15);
    in_range("directions", s.directions, 4, (max_layers - first_aerosol_layer) / (s.degree + 1));
    in_range("zeniths", s.zeniths, 6, 128);
    in_range("azimuths", s.azimuths, s.degree + 1, 128);
    in_range("table_nodes", s.table_nodes, 4, max_nodes);
    in_range("nodes", s.nodes, 4, max_nodes);
    return result;
}

/// Orders after which the series is off by at most three thousandths of all light. In a layer over white ground orders
/// fall by the first eigenvalue of diffusion, and what else there is in them by the others; the estimate is for isotropic
/// scattering without absorption, and the orders of any other layer of this depth fall faster.
uint32_t orders_before_series(const scene::Atmosphere& a) {
    constexpr double error = 0.003, extrapolation = 0.71;
    constexpr uint32_t most = 100;
    double orders = 0;
    for (size_t i = 0; i < a.wavelengths_nm.size(); ++i) {
        double depth = 0;
        if (a.rayleigh) depth += a.rayleigh->scattering_per_km[i] * a.rayleigh->scale_height_km;
        if (a.mie) depth += a.mie->scattering_per_km[i] * a.mie->scale_height_km;
        const double wave =
            0.5 * pi / (depth + extrapolation);  // a quarter of one fills the layer, three the next mode
        const double first = 1 / (1 + wave * wave / 3), second = 1 / (1 + 3 * wave * wave);
        orders = std::max(orders, std::log(error * (1 - first) / first) / std::log(second / first));
    }
    return uint32_t(std::min(std::ceil(orders), double(most)));
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
    block.directions = int32_t(settings.directions);
    return block;
}

/// How many of the zenith angles that light is gathered from lie below the horizon, between it and the level, and above;
/// in each zone they are a rule's nodes.
std::array<uint32_t, 3> zone_sizes(uint32_t zeniths) {
    const uint32_t between = std::max(zeniths / 6, 2u), below = std::max(zeniths / 3, 2u);
    return {below, between, zeniths - below - between};
}

/// As shaders/atmosphere/rays.comp has them: place in the zone, zone.
std::vector<float> zenith_places(uint32_t zeniths) {
    std::vector<float> places;
    int zone = 0;
    for (const uint32_t size : zone_sizes(zeniths)) {
        for (const Node& node : gauss_legendre(size))
            places.insert(places.end(), {float(node.x), float(zone)});
        ++zone;
    }
    return places;
}

/// A zenith angle of a rule that integrates phase functions times polynomials through the light at the gathered ones.
struct ZenithNode {
    Node node;
    int zone;
    uint32_t first;               ///< zenith angle of the zone
    std::vector<double> through;  ///< the polynomials of the zone's zenith angles
};

std::vector<ZenithNode> zenith_nodes(uint32_t zeniths) {
    std::vector<ZenithNode> nodes;
    int zone = 0;
    uint32_t first = 0;
    for (const uint32_t size : zone_sizes(zeniths)) {
        const std::vector<Node> gathered = gauss_legendre(size);
        for (const Node& node : gauss_legendre(most_degrees + size))
            nodes.push_back({node, zone, first, interpolation(gathered, node.x)});
        first += size;
        ++zone;
    }
    return nodes;
}

/// The weights with which the light that arrives at each zenith angle counts in each layer of a row of the tables, for
/// light integrated over azimuths as rings.comp does; zenith angles are adjacent. Phase functions are too narrow for few zenith angles, light is not: it counts as the
/// polynomial through its values in each zone, so that what is uniform is scattered without loss or gain.
std::vector<float> gather_weights(const scene::Atmosphere& a, const Settings& settings,
                                  std::span<const ZenithNode> nodes, double altitude) {
    constexpr uint32_t degree = most_degrees;
    const double horizon =
        -std::sqrt(altitude * (2 * a.radius_ground_km + altitude)) / (a.radius_ground_km + altitude);
    const size_t zeniths = settings.zeniths;
    const uint32_t layers = first_aerosol_layer + (settings.degree + 1) * settings.directions;
    std::vector<double> weights(layers * zeniths);
    std::vector<double> arriving((settings.degree + 1) * (degree + 1) * zeniths);  // of each m and degree
    for (const ZenithNode& fine : nodes) {
        const double from = fine.zone < 2 ? horizon : 0, to = fine.zone == 0 ? -1 : fine.zone == 1 ? 0 : 1;
        const double mu = from + (to - from) * fine.node.x * fine.node.x;
        const double solid = 2 * fine.node.x * fine.node.weight * std::abs(to - from);
        const double sine = std::sqrt((1 - mu) * (1 + mu));
        const auto add = [&](std::vector<double>& sums, size_t row, double value) {
            for (size_t j = 0; j < fine.through.size(); ++j)
                sums[row * zeniths + fine.first + j] += solid * value * fine.through[j];
        };
        add(weights, 0, 1 / (4 * pi));
        add(weights, 1, 0.125 / pi * (1.5 * mu * mu - 0.5));
        add(weights, 2, 0.375 / pi * mu * sine);
        add(weights, 3, 0.09375 / pi * sine * sine);
        add(weights, irradiance_layer, fine.zone == 2 ? mu : 0);
        for (uint32_t m = 0; m <= settings.degree; ++m) {
            const std::vector<double> values = harmonics(m, degree, mu);
            for (uint32_t l = m; l <= degree; ++l) add(arriving, m * (degree + 1) + l, values[l - m]);
        }
    }
    const std::vector<double> moments = cornette_shanks_moments(a.mie ? a.mie->g : 0, degree);
    for (uint32_t m = 0; m <= settings.degree; ++m) {
        for (uint32_t k = 0; k < settings.directions; ++k) {
            const double y = double(k) / (settings.directions - 1) - 0.5;  // of direction_place()
            const std::vector<double> leaving =
                harmonics(m, degree, std::sin(0.5 * pi * y / (1 - std::abs(y))));
            double* const row = &weights[(first_aerosol_layer + m * settings.directions + k) * zeniths];
            for (uint32_t l = m; l <= degree; ++l)
                for (size_t j = 0; j < zeniths; ++j)
                    row[j] += moments[l] * leaving[l - m] * arriving[(m * (degree + 1) + l) * zeniths + j];
        }
    }
    return {weights.begin(), weights.end()};
}

/// Of the first four orders of light that aerosols scatter, as far as `orders` has them; a row of their irradiance follows.
std::vector<glm::vec4> peak_table(const scene::Atmosphere& a, const Settings& settings) {
    std::vector<glm::vec4> table(size_t(2) * peak_texels, glm::vec4(0));
    if (!a.mie) return table;
    const std::vector<double> moments = cornette_shanks_moments(a.mie->g, peak_moments);
    const uint32_t last = std::min(settings.orders.value_or(4), 4u);
    for (uint32_t i = 0; i < peak_texels; ++i) {
        const double sine = double(i) / (peak_texels - 1), nu = 1 - 2 * sine * sine;
        for (uint32_t order = 1; order <= last; ++order) {
            table[i][int(order - 1)] = float(peak(moments, settings.degree, order, nu));
            table[peak_texels + i][int(order - 1)] =
                float(peak_irradiance(moments, settings.degree, order, nu));
        }
    }
    return table;
}

}  // namespace

Settings settings_of(Preset preset) {
    switch (preset) {
        case Preset::fast:
            return {.iterations = 4,
                    .columns = 128,
                    .altitudes = 20,
                    .suns = 64,
                    .directions = 16,
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
                    .suns = 160,
                    .directions = 27,
                    .degree = 8,
                    .zeniths = 40,
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
    made.aerosols_ = atmosphere.mie.has_value();
    const auto checked = check(atmosphere, settings);
    if (!checked) return tl::unexpected(checked.error());
    made.settings_.iterations = std::max(settings.iterations, orders_before_series(atmosphere));
    made.block_ = make_block<Block>(atmosphere, settings);
    made.table_block_ = made.block_;
    set_quadrature(made.block_, settings.nodes);
    set_quadrature(made.table_block_, settings.table_nodes);
    const auto created =
        made.create_resources(device, atmosphere).and_then([&] { return made.create_pipelines(device); });
    if (!created) return tl::unexpected(created.error());

    made.steps_.emplace_back(Columns{});
    for (uint32_t order = 1; order <= settings.orders.value_or(made.settings_.iterations); ++order)
        for (uint32_t row = 0; row < settings.altitudes; row += made.rows_per_step_)
            made.steps_.emplace_back(Rows{.order = order,
                                          .first = row,
                                          .count = std::min(made.rows_per_step_, settings.altitudes - row)});
    if (!settings.orders) made.steps_.emplace_back(Tail{});
    return made;
}

uint32_t Tables::layers() const {
    return first_aerosol_layer + (settings_.degree + 1) * settings_.directions;
}

Result<void> Tables::create_resources(rhi::Device& device, const scene::Atmosphere& atmosphere) {
    const auto keep = [](auto created, auto& where) -> Result<void> {
        if (!created) return tl::unexpected(created.error());
        where = std::move(*created);
        return {};
    };
    const auto make_texture = [&](rhi::TextureDesc desc, rhi::Texture& where) {
        return keep(device.create_texture(desc), where);
    };
    const auto make_buffer = [&](std::string name, uint64_t floats, rhi::Buffer& where) {
        return keep(device.create_buffer({.name = std::move(name), .size = floats * sizeof(float)}), where);
    };
    const auto fill = [&](std::string name, const std::vector<float>& values, rhi::Buffer& where) {
        return make_buffer(std::move(name), values.size(), where).and_then([&] {
            return device.upload(where.slice(), std::as_bytes(std::span(values)));
        });
    };
    const auto both = rhi::TextureUsage::sampled | rhi::TextureUsage::storage;
    rhi::TextureDesc table{.name = "atmosphere.light",
                           .dimension = Dimension::d2_array,
                           .format = Format::rgba32_float,
                           .extent = {settings_.suns, settings_.altitudes},
                           .layers = layers(),
                           .usage = both};
    Result<void> made = make_texture(table, sum_);
    for (rhi::Texture& order : orders_) {
        table.name = "atmosphere.order";
        if (made) made = make_texture(table, order);
    }

    const uint32_t rings_per_row = settings_.suns * settings_.zeniths;
    const uint32_t rays_per_row = rings_per_row * settings_.azimuths;
    rows_per_step_ = std::clamp(rays_per_step / rays_per_row, 1u, settings_.altitudes);
    const std::vector<ZenithNode> nodes = zenith_nodes(settings_.zeniths);
    const std::vector<glm::vec4> peaks = peak_table(atmosphere, settings_);
    std::vector<float> weights;
    for (uint32_t row = 0; row < settings_.altitudes; ++row) {
        const double place = double(row) / (settings_.altitudes - 1);  // of altitude_place()
        const auto of_row =
            gather_weights(atmosphere, settings_, nodes, atmosphere.height_km() * place * place);
        weights.insert(weights.end(), of_row.begin(), of_row.end());
    }
    return made
        .and_then([&] {
            return make_texture({.name = "atmosphere.columns",
                                 .format = Format::rgba32_float,
                                 .extent = {settings_.columns, settings_.columns},
                                 .usage = both},
                                columns_);
        })
        .and_then([&] {
            return make_texture(
                {.name = "atmosphere.peaks", .format = Format::rgba32_float, .extent = {peak_texels, 2}},
                peaks_);
        })
        .and_then([&] {
            return device.upload(peaks_, rhi::whole_mip(peaks_.desc()), std::as_bytes(std::span(peaks)));
        })
        .and_then([&] {
            return make_buffer("atmosphere.rays", uint64_t(4) * rows_per_step_ * rays_per_row, rays_);
        })
        .and_then([&] {
            return make_buffer("atmosphere.rings",
                               uint64_t(4) * rows_per_step_ * rings_per_row * (settings_.degree + 1), rings_);
        })
        .and_then([&] { return fill("atmosphere.zeniths", zenith_places(settings_.zeniths), zeniths_); })
        .and_then([&] { return fill("atmosphere.weights", weights, weights_); })
        .and_then([&] { return keep(device.create_sampler({}), sampler_); });
}

Result<void> Tables::create_pipelines(rhi::Device& device) {
    const auto create = [&]<class P>(rhi::ComputePipeline<P>& pipeline) {
        return device.create_compute_pipeline<P>().map(keep(pipeline));
    };
    return create(columns_pipeline_)
        .and_then([&] { return create(rays_pipeline_); })
        .and_then([&] { return create(rings_pipeline_); })
        .and_then([&] { return create(gather_pipeline_); })
        .and_then([&] { return create(tail_pipeline_); });
}

Sky Tables::sky_of(rhi::Commands& commands, const Block& block, const rhi::Texture& light) const {
    return {.block = commands.uniform(block),
            .columns = {columns_.view<Dimension::d2>(), sampler_},
            .light = {light.view<Dimension::d2_array>(), sampler_},
            .peaks = {peaks_.view<Dimension::d2>(), sampler_}};
}

Sky Tables::sky(rhi::Commands& commands, std::optional<uint32_t> nodes) const {
    Block block = block_;
    if (nodes) set_quadrature(block, std::clamp(*nodes, 4u, max_nodes));
    return sky_of(commands, block, sum_);
}

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
    const Sky sky = sky_of(commands, table_block_, light_of(rows.order - 1));
    const glm::ivec2 size(settings_.suns, settings_.altitudes);
    const uint32_t texels = settings_.suns * rows.count;
    const uint32_t rings = texels * settings_.zeniths;
    // What is scattered once more: of the last order nothing is, and its irradiance alone counts.
    const bool last = settings_.orders == rows.order;
    const uint32_t first_layer = last ? irradiance_layer : 0;
    const uint32_t layer_count = last ? 1 : layers();
    // The sun's light that aerosols scattered forward n times, over n!.
    const auto forward = [&](uint32_t n) {
        constexpr std::array factors{1.0f, 1 / 2.0f, 1 / 6.0f};
        glm::vec4 chosen(0);
        if (aerosols_ && n >= 1 && n <= factors.size()) chosen[int(n - 1)] = factors[n - 1];
        return chosen;
    };

    rhi::Pass pass = commands.pass("atmosphere.order");
    pass.dispatch(rays_pipeline_,
                  {.air = sky.block,
                   .air_columns = sky.columns,
                   .air_light = sky.light,
                   .air_peaks = sky.peaks,
                   .rays = rays_.slice(),
                   .zeniths = zeniths_.slice()},
                  {.size = size,
                   .directions = glm::ivec2(settings_.zeniths, settings_.azimuths),
                   .first_row = int32_t(rows.first),
                   .rows = int32_t(rows.count),
                   .first = rows.order == 1,
                   .forward = forward(rows.order - 1),
                   .left_out = forward(rows.order)},
                  {rhi::groups_for(rings * settings_.azimuths, 64)});
    pass.dispatch(rings_pipeline_, {.rays = rays_.slice(), .rings = rings_.slice()},
                  {.rings = int32_t(rings),
                   .azimuths = int32_t(settings_.azimuths),
                   .degree = int32_t(settings_.degree)},
                  {rhi::groups_for(rings * (settings_.degree + 1), 64)});
    pass.dispatch(gather_pipeline_,
                  {.rings = rings_.slice(),
                   .weights = weights_.slice(),
                   .light = light_of(rows.order).mip<Dimension::d2_array>(0),
                   .sum = sum_.mip<Dimension::d2_array>(0)},
                  {.size = size,
                   .first_row = int32_t(rows.first),
                   .rows = int32_t(rows.count),
                   .first_layer = int32_t(first_layer),
                   .layers = int32_t(layer_count),
                   .all_layers = int32_t(layers()),
                   .zeniths = int32_t(settings_.zeniths),
                   .degree = int32_t(settings_.degree),
                   .directions = int32_t(settings_.directions),
                   .add = rows.order > 1},
                  {rhi::groups_for(texels * layer_count, 64)});
}

void Tables::record_tail(rhi::Commands& commands) const {
    rhi::Pass pass = commands.pass("atmosphere.tail");
    pass.dispatch(tail_pipeline_,
                  {.last = light_of(settings_.iterations).mip<Dimension::d2_array>(0),
                   .before = light_of(settings_.iterations - 1).mip<Dimension::d2_array>(0),
                   .sum = sum_.mip<Dimension::d2_array>(0)},
                  {},
                  {rhi::groups_for(settings_.suns, 8), rhi::groups_for(settings_.altitudes, 8), layers()});
}

uint64_t Tables::bytes() const {
    const uint64_t table = uint64_t(settings_.suns) * settings_.altitudes * layers();
    const uint64_t texels = 3 * table + uint64_t(settings_.columns) * settings_.columns + 2 * peak_texels;
    return texels * sizeof(glm::vec4) + rays_.size() + rings_.size() + zeniths_.size() + weights_.size();
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
