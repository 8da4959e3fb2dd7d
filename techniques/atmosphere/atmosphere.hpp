// The sky of a planet, precomputed: Bruneton and Neyret 2008, Precomputed Atmospheric Scattering, with other tables.
// docs/atmosphere.md says which and why.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

#include "rhi/rhi.hpp"
#include "scene/atmosphere.hpp"
#include "shaders/atmosphere/columns.hpp"
#include "shaders/atmosphere/gather.hpp"
#include "shaders/atmosphere/probe.hpp"
#include "shaders/atmosphere/rays.hpp"
#include "shaders/atmosphere/rings.hpp"
#include "shaders/atmosphere/tail.hpp"

namespace lumo::atmosphere {

inline constexpr size_t max_wavelengths = 4;

struct Settings {
    /// Of scattering and reflection by the ground together, 1 and up; none: all, of which the first `iterations` are
    /// computed and the rest is a geometric series.
    std::optional<uint32_t> orders = {};
    uint32_t iterations = 6;  ///< 2 and up; up to 100 in air so thick that the series would need as many

    uint32_t columns = 256;    ///< side of the table of columns, 16 to 1024
    uint32_t altitudes = 32;   ///< of the tables of scattered light, 2 to 512
    uint32_t suns = 160;       ///< sun zenith angles, 2 to 1024
    uint32_t directions = 16;  ///< zenith angles into which aerosols send light on, 4 to 128
    uint32_t degree = 4;    ///< of azimuths of that light, 2 to 15; (degree + 1) * directions is at most 251
    uint32_t zeniths = 24;  ///< from which light is gathered, 6 to 128
    uint32_t azimuths = 8;  ///< likewise over half a turn, 3 to 128; more than the degree
    uint32_t table_nodes = 10;  ///< of a ray's quadrature while tables are made, 4 to 16
    uint32_t nodes = 16;        ///< and when the sky is looked at, 4 to 16
};

/// By measured error and time: docs/atmosphere.md.
enum class Preset : uint8_t { fast, standard, precise };
Settings settings_of(Preset preset);
/// `fast`, `default`, `precise`. Error: invalid_argument.
Result<Preset> parse_preset(std::string_view name);

/// What shaders/atmosphere/sky.glsl reads.
struct Sky {
    rhi::UniformBuffer block;
    rhi::Sampled<rhi::Dimension::d2> columns;
    rhi::Sampled<rhi::Dimension::d2_array> light;
    rhi::Sampled<rhi::Dimension::d2> peaks;
};

/// The tables of up to four wavelengths. They hold what they should once all steps have been recorded, in order, and
/// submitted: each step is one submission's worth on software drivers.
class Tables {
  public:
    /// `atmosphere` has passed scene::check and has at most max_wavelengths; see by_fours. Errors: invalid_argument
    /// for a setting out of its range, and those of the device.
    static Result<Tables> create(rhi::Device& device, const scene::Atmosphere& atmosphere,
                                 const Settings& settings);

    uint32_t steps() const { return uint32_t(steps_.size()); }
    /// `step` is below steps().
    void record(rhi::Commands& commands, uint32_t step) const;

    /// For programs of this submission; `nodes` in place of Settings::nodes, 4 to 16: few are enough for rays that end
    /// within a few km.
    Sky sky(rhi::Commands& commands, std::optional<uint32_t> nodes = {}) const;

    /// As given, but for `iterations`: as many as there are.
    const Settings& settings() const { return settings_; }
    /// Of the device's memory that is held.
    uint64_t bytes() const;

    /// All that the steps read and run, so that equal bytes on equal devices make equal contents.
    Result<std::vector<std::byte>> recipe(rhi::Device& device) const;
    /// All that the steps have made. Both wait for the device.
    Result<std::vector<std::byte>> contents(rhi::Device& device) const;
    /// In place of the steps. Error: invalid_argument where the contents are of another size.
    Result<void> restore(rhi::Device& device, std::span<const std::byte> contents);

  private:
    struct Columns {};
    struct Rows {
        uint32_t order, first, count;
    };
    struct Tail {};
    using Step = std::variant<Columns, Rows, Tail>;
    using Block = shaders::atmosphere::probe::Atmosphere;

    Result<void> create_resources(rhi::Device& device, const scene::Atmosphere& atmosphere);
    Result<void> create_pipelines(rhi::Device& device);
    uint32_t layers() const;
    const rhi::Texture& light_of(uint32_t order) const { return orders_[order % 2]; }
    void record_columns(rhi::Commands& commands) const;
    void record_rows(rhi::Commands& commands, const Rows& rows) const;
    void record_tail(rhi::Commands& commands) const;
    Sky sky_of(rhi::Commands& commands, const Block& block, const rhi::Texture& light) const;

    Settings settings_;
    Block block_ = {};        ///< for views
    Block table_block_ = {};  ///< while tables are made
    std::vector<Step> steps_;
    uint32_t rows_per_step_ = 1;
    rhi::Texture columns_, peaks_;
    std::array<rhi::Texture, 2> orders_;  ///< of the last two orders, in turn
    rhi::Texture sum_;
    rhi::Buffer zeniths_, weights_, rays_, rings_;
    bool aerosols_ = false;
    rhi::Sampler sampler_;
    rhi::ComputePipeline<shaders::atmosphere::columns> columns_pipeline_;
    rhi::ComputePipeline<shaders::atmosphere::rays> rays_pipeline_;
    rhi::ComputePipeline<shaders::atmosphere::rings> rings_pipeline_;
    rhi::ComputePipeline<shaders::atmosphere::gather> gather_pipeline_;
    rhi::ComputePipeline<shaders::atmosphere::tail> tail_pipeline_;
};

/// Submits every step and waits for the last. `progress` is told the part done, 0 to 1, after each.
Result<void> precompute(rhi::Device& device, const Tables& tables,
                        const std::function<void(double)>& progress = {});

/// An atmosphere of any number of wavelengths as atmospheres of up to four each.
std::vector<scene::Atmosphere> by_fours(const scene::Atmosphere& atmosphere);

/// Numbers instead of pictures, by the functions that render pixels.
enum class Quantity : uint32_t {
    transmittance_to_space,
    transmittance_segment,  ///< over the distance
    radiance,               ///< W/m²/nm/sr
    radiance_order1,
    inscatter,       ///< radiance over the distance
    sky_irradiance,  ///< on a level plane that faces up, W/m²/nm
    sun_irradiance,
};

/// Conventions as reference::SkyView and shaders/atmosphere/sky.glsl.
struct Question {
    double altitude_km = 0;
    double view_zenith_deg = 0;
    double sun_zenith_deg = 0;
    double azimuth_deg = 0;
    double distance_km = 0;
    Quantity quantity = Quantity::radiance;
};

class Probe {
  public:
    static Result<Probe> create(rhi::Device& device);
    /// An answer a question, with a component for each wavelength of the tables. Waits for it.
    Result<std::vector<std::array<float, max_wavelengths>>> ask(rhi::Device& device, const Tables& tables,
                                                                std::span<const Question> questions) const;

  private:
    rhi::ComputePipeline<shaders::atmosphere::probe> pipeline_;
};

}  // namespace lumo::atmosphere
