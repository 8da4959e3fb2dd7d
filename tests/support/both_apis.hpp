// Both APIs at once: what must be equal between them.
#pragma once

#include <cstring>
#include <gtest/gtest.h>
#include <optional>

#include "tests/support/device_test.hpp"

namespace lumo::testing_support {

/// Runs where both APIs have a device.
class BothApisTest : public testing::Test {
  protected:
    void SetUp() override {
        gl_ = open_device(rhi::Api::gl);
        vulkan_ = open_device(rhi::Api::vulkan);
        if (!gl_ || !vulkan_) GTEST_SKIP() << "no device for " << (gl_ ? "Vulkan" : "OpenGL");
    }
    void TearDown() override {
        for (std::optional<CheckedDevice>* checked : {&gl_, &vulkan_}) {
            if (!*checked) continue;
            (*checked)->device.reset();
            for (const rhi::Message& failure : (*checked)->take_failures())
                ADD_FAILURE() << failure.id << ": " << failure.text;
        }
    }

    rhi::Device& gl() { return *gl_->device; }
    rhi::Device& vulkan() { return *vulkan_->device; }

  private:
    std::optional<CheckedDevice> gl_;
    std::optional<CheckedDevice> vulkan_;
};

}  // namespace lumo::testing_support
