// Devices for tests: one per API, with validation on and every message kept. A test fails when the driver or
// the RHI said something that fails by rhi/check.hpp, unless it expected and took it.
#pragma once

#include <cstring>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "backends/backends.hpp"
#include "rhi/rhi.hpp"
#include "tests/support/required.hpp"

namespace lumo::testing_support {

/// A device that remembers what was said about it.
struct CheckedDevice {
    std::shared_ptr<std::vector<rhi::Message>> messages = std::make_shared<std::vector<rhi::Message>>();
    std::optional<rhi::Device> device;

    /// The failing messages so far, which are forgotten.
    std::vector<rhi::Message> take_failures() {
        std::vector<rhi::Message> failures;
        for (rhi::Message& message : *messages)
            if (is_failure(message)) failures.push_back(std::move(message));
        messages->clear();
        return failures;
    }
};

/// A device of this API; none when the API finds no device, which is a test failure where
/// apis_required(). Any other error is a failure everywhere.
inline std::optional<CheckedDevice> open_device(rhi::Api api, rhi::DeviceDesc desc = {}) {
    CheckedDevice checked;
    desc.validation = true;
    desc.sink = [messages = checked.messages](const rhi::Message& message) { messages->push_back(message); };
    auto made = backends::create_device(api, desc);
    if (!made) {
        const bool absent = made.error().kind == ErrorKind::no_device;
        if (!absent || apis_required()) ADD_FAILURE() << to_string(made.error());
        return {};
    }
    checked.device.emplace(std::move(*made));
    return checked;
}

/// The value, or a failed test that says why there is none.
template <class T>
T must(Result<T> result) {
    if (!result) throw std::runtime_error(to_string(result.error()));
    if constexpr (!std::is_void_v<T>) return std::move(*result);
}

template <class T>
std::span<const std::byte> bytes_of(const std::vector<T>& values) {
    return std::as_bytes(std::span(values));
}

template <class T>
std::vector<T> values_of(const std::vector<std::byte>& bytes) {
    std::vector<T> values(bytes.size() / sizeof(T));
    std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
    return values;
}

/// Runs each test on both APIs.
class DeviceTest : public testing::TestWithParam<rhi::Api> {
  protected:
    void SetUp() override {
        auto opened = open_device(GetParam());
        if (!opened && HasFailure()) FAIL() << "this device is required";
        if (!opened) GTEST_SKIP() << "no device for " << to_string(GetParam());
        checked_ = std::move(*opened);
    }
    void TearDown() override {
        checked_.device.reset();
        for (const rhi::Message& failure : checked_.take_failures())
            ADD_FAILURE() << failure.id << ": " << failure.text;
    }

    rhi::Device& device() { return *checked_.device; }
    std::vector<rhi::Message> take_failures() { return checked_.take_failures(); }

    rhi::Buffer buffer(uint64_t size, rhi::BufferUsage usage = rhi::BufferUsage::storage) {
        return must(device().create_buffer({.name = "buffer", .size = size, .usage = usage}));
    }
    template <class T>
    rhi::Buffer buffer_with(const std::vector<T>& values,
                            rhi::BufferUsage usage = rhi::BufferUsage::storage) {
        rhi::Buffer made = buffer(values.size() * sizeof(T), usage);
        must(device().upload(made.slice(), bytes_of(values)));
        return made;
    }
    template <class T>
    std::vector<T> contents(const rhi::Buffer& buffer) {
        return values_of<T>(must(device().download(buffer.slice())));
    }
    rhi::Texture texture(const rhi::TextureDesc& desc) { return must(device().create_texture(desc)); }
    template <class T>
    std::vector<T> texels(const rhi::Texture& texture, uint32_t mip = 0) {
        return values_of<T>(must(device().download(texture, whole_mip(texture.desc(), mip))));
    }
    rhi::Sampler sampler(const rhi::SamplerDesc& desc = {}) { return must(device().create_sampler(desc)); }
    rhi::Sampler nearest_sampler() {
        return sampler({.magnification = rhi::FilterMode::nearest, .minification = rhi::FilterMode::nearest});
    }
    template <rhi::Program P>
    rhi::ComputePipeline<P> compute(const typename P::Options& options = {}) {
        return must(device().create_compute_pipeline<P>(options));
    }
    template <rhi::Program P>
    rhi::RasterPipeline<P> raster(const rhi::RasterState& state, const typename P::Options& options = {}) {
        return must(device().create_raster_pipeline<P>(state, options));
    }
    /// One dispatch in a submission of its own.
    template <rhi::Program P>
    void run(const rhi::ComputePipeline<P>& pipeline, const typename P::Bindings& bindings,
             const typename P::Push& push, rhi::Groups groups) {
        rhi::Commands commands = device().begin();
        commands.pass("run").dispatch(pipeline, bindings, push, groups);
    }

  private:
    CheckedDevice checked_;
};

inline const auto both_apis = testing::Values(rhi::Api::gl, rhi::Api::vulkan);
inline std::string api_name(const testing::TestParamInfo<rhi::Api>& info) {
    return std::string(to_string(info.param));
}

}  // namespace lumo::testing_support
