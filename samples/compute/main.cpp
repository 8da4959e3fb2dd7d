// Numbers go to the device, a shader squares them, and they come back. No window is needed.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstring>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include "backends/backends.hpp"
#include "shaders/compute/square.hpp"

using namespace lumo;
using lumo::shaders::compute::square;

namespace {

/// What lumo makes is a value or an error; here an error ends the program.
template <class T>
T must(Result<T> result) {
    if (!result) throw std::runtime_error(to_string(result.error()));
    if constexpr (!std::is_void_v<T>) return std::move(*result);
}

void run(rhi::Api api, uint32_t count) {
    auto device = must(backends::create_device(api));
    std::printf("%s, %s\n", device.info().name.c_str(), device.info().driver.c_str());

    std::vector<uint32_t> values(count);
    std::iota(values.begin(), values.end(), 1u);
    const auto bytes = std::as_writable_bytes(std::span(values));
    auto numbers = must(device.create_buffer({.name = "numbers", .size = bytes.size()}));
    auto squares = must(device.create_buffer({.name = "squares", .size = bytes.size()}));
    auto pipeline = must(device.create_compute_pipeline<square>());

    rhi::Commands commands = device.begin();
    rhi::Readback result;
    {
        rhi::Pass pass = commands.pass("square");
        pass.upload(numbers.slice(), bytes);
        pass.dispatch(pipeline, {.numbers = numbers.slice(), .squares = squares.slice()}, {.count = count},
                      {rhi::groups_for(count, 64)});
        result = pass.read(squares.slice());
    }
    const rhi::Submission done = device.submit(std::move(commands));

    const std::vector<std::byte> read = must(device.take(result));
    std::memcpy(values.data(), read.data(), read.size());
    for (uint32_t i = 0; i < count; ++i) std::printf("%u squared is %u\n", i + 1, values[i]);
    for (const rhi::PassTime& time : device.pass_times(done))
        std::printf("pass \"%s\": %.3f ms\n", time.name.c_str(), time.milliseconds);
}

}  // namespace

int main(int argc, char** argv) {
    std::string api = "vulkan";
    uint32_t count = 8;
    CLI::App app{"Squares numbers on a GPU."};
    app.add_option("--api", api, "vulkan if not given")->check(CLI::IsMember({"vulkan", "gl"}));
    app.add_option("--count", count, "how many")->check(CLI::Range(1, 65535));
    CLI11_PARSE(app, argc, argv);
    try {
        run(api == "gl" ? rhi::Api::gl : rhi::Api::vulkan, count);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "compute: %s\n", error.what());
        return 1;
    }
    return 0;
}
