// The command line: one structure of everything that can be asked for, checked before any work starts.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <tl/expected.hpp>
#include <variant>

#include "samples/lumo/probe_sky.hpp"
#include "scene/scene.hpp"
#include "techniques/frame/settings.hpp"

namespace lumo::program {

/// How the program ends.
enum ExitCode : int {
    exit_done = 0,
    exit_differs = 1,  ///< all was done, and two pictures differ by more than they may
    exit_failed = 2,
};

enum class Command : uint8_t { render, check, diff, devices, bench, probe, report, tune, version };
enum class ApiChoice : uint8_t { first, vulkan, gl, both };
enum class ParityChoice : uint8_t { mesa, hardware };

struct Sun {
    glm::vec3 direction_to_sun{0, 1, 0};  ///< unit length
    glm::vec3 irradiance{0};              ///< on a plane facing it, W/m²; 0 for none
};

/// A camera by its own numbers, or a scene's by name or index; nothing: the scene's own.
using CameraChoice = std::variant<std::monostate, scene::Camera, std::string>;

/// Frames of an animation. Frame i of `count`, from 0, turns the camera by orbit * i / count about the
/// vertical axis through its target and moves the sun by i / (count - 1) of the way to sun_to.
struct Animation {
    uint32_t count = 1;
    uint32_t shard = 1;  ///< of `shards`, from 1: it renders the frames i with i % shards == shard - 1
    uint32_t shards = 1;
    float orbit = 0;  ///< degrees
    std::optional<Sun> sun_to = {};
};

/// What `lumo probe` asks, and how it is answered.
struct Probe {
    std::filesystem::path input = {};
    atmosphere::Settings settings = {};
    SkyTruthSettings truth = {};
    bool luminance = false;  ///< as one more column
};

struct Options {
    Command command = Command::render;

    std::string scene = "atrium";
    bool photometric = false;
    CameraChoice camera = {};
    std::optional<Sun> sun = {};             ///< in place of the scene's directional lights
    bool sky = false;                        ///< also around a scene that has none
    std::filesystem::path atmosphere = {};   ///< of the sky; its own if empty
    std::optional<double> altitude_km = {};  ///< scene::Sky::altitude_km
    frame::Settings frame = {};
    Animation animation = {};
    bool reference = false;  ///< the path tracer instead of a GPU
    uint32_t spp = 256;      ///< its samples a pixel
    /// What was asked for and what holds by default, by option: what --stats writes and --config reads.
    nlohmann::ordered_json settings = {};

    ApiChoice api = ApiChoice::first;
    std::string device = {};
    bool validation = false;

    std::filesystem::path output = {};
    std::filesystem::path stats = {};    ///< none if empty
    std::filesystem::path capture = {};  ///< of the first frame, for RenderDoc; none if empty
    bool explain = false;
    bool json = false;
    bool quiet = false;

    std::filesystem::path first = {}, second = {};  ///< of diff
    ParityChoice parity = ParityChoice::mesa;

    Probe probe = {};

    std::string benchmark = {};
    /// Settings that the command line or the configuration gave, by their names without dashes.
    std::set<std::string> given = {};
    std::filesystem::path truth = {};  ///< of the sky, for its benchmark; none if empty
    uint32_t runs = 5;                 ///< of a benchmark: its figures are medians of so many

    std::vector<std::string> vary = {};  ///< of a report: NAME=V1,V2,...
    std::vector<std::string> also = {};  ///< of a report: NAME=V,NAME=V,...

    std::optional<double> max_error = {};  ///< of tune: relative RMSE, as a part of 1
    std::optional<double> max_ms = {};     ///< of tune: GPU time of a frame
};

/// A setting by its name without dashes, and its value as on the command line.
using SettingValue = std::pair<std::string, std::string>;

/// The same options with these settings, of those that say how a frame is made and not what it shows. Errors:
/// invalid_argument, with what there is.
Result<Options> with_settings(const Options& options, const std::vector<SettingValue>& values);

/// Those settings, of Options::settings, that with_settings() can change.
nlohmann::ordered_json technique_settings(const Options& options);

/// The value of one of Options::settings as its option takes it; empty if it has none.
std::string value_of(const Options& options, const std::string& setting);

/// The settings that were given, but those `elsewhere`, as on a command line: " --name value" each.
std::string given_arguments(const Options& options, std::initializer_list<std::string_view> elsewhere);

/// A command line that asks for no work, or for something that there is not.
struct Refusal {
    int exit_code = exit_failed;
    std::string text =
        {};  ///< help for the standard output if exit_code is 0, else what is wrong, in one line
};

/// Reads the arguments, and the file given to --config.
tl::expected<Options, Refusal> parse_options(int argc, const char* const* argv);

}  // namespace lumo::program
