// Tests that run with each voxelizer on each API.
#pragma once

#include <tuple>

#include "tests/support/device_test.hpp"
#include "tests/support/voxels.hpp"

namespace lumo::testing_support {

using VoxelizeParam = std::tuple<rhi::Api, voxels::VoxelizerKind>;

class VoxelizerTest : public testing::TestWithParam<VoxelizeParam> {
  protected:
    void SetUp() override {
        auto opened = open_device(std::get<0>(GetParam()));
        if (!opened) GTEST_SKIP() << "no device for " << to_string(std::get<0>(GetParam()));
        checked_ = std::move(*opened);
    }
    void TearDown() override {
        checked_.device.reset();
        for (const rhi::Message& failure : checked_.take_failures())
            ADD_FAILURE() << failure.id << ": " << failure.text;
    }

    rhi::Device& device() { return *checked_.device; }
    /// The voxels of a scene by this test's voxelizer.
    Voxelized voxelized(const scene::Scene& scene, VoxelOptions options) {
        options.voxelizer = std::get<1>(GetParam());
        return voxelize(device(), scene, options);
    }
    VolumeTexels albedo_of(const scene::Scene& scene, uint32_t resolution) {
        const Voxelized made = voxelized(scene, {.resolution = resolution});
        return read_volume(device(), made.volume.albedo());
    }

  private:
    CheckedDevice checked_;
};

inline const auto each_voxelizer =
    testing::Combine(testing::Values(rhi::Api::gl, rhi::Api::vulkan),
                     testing::Values(voxels::VoxelizerKind::raster, voxels::VoxelizerKind::compute));

inline std::string voxelizer_name(const testing::TestParamInfo<VoxelizeParam>& info) {
    return std::string(to_string(std::get<0>(info.param))) + "_" +
           std::string(to_string(std::get<1>(info.param)));
}

}  // namespace lumo::testing_support
