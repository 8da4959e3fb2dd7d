// Pipelines, and the driver's cache of them on disk.
#pragma once

#include <span>
#include <vector>

#include "backends/vulkan/gpu.hpp"
#include "rhi/program.hpp"
#include "rhi/resources.hpp"

namespace lumo::backends::vulkan {

/// Where a binding value goes.
struct BindingSlot {
    uint32_t binding;
    VkDescriptorType type;
};

struct Pipeline {
    Unique<VkDescriptorSetLayout> set_layout;
    Unique<VkPipelineLayout> layout;
    Unique<VkPipeline> pipeline;
    VkPipelineBindPoint bind_point = VK_PIPELINE_BIND_POINT_COMPUTE;
    VkShaderStageFlags stages = 0;
    std::vector<BindingSlot> slots;  ///< in the order of ProgramInfo::bindings
};

/// The driver's compiled code, kept between runs. What is on disk is handed to the driver only if its header
/// names this device and driver.
class PipelineCache {
  public:
    PipelineCache(const Gpu& gpu, bool on_disk);
    ~PipelineCache();
    PipelineCache(const PipelineCache&) = delete;
    PipelineCache& operator=(const PipelineCache&) = delete;

    VkPipelineCache get() const { return cache_.get(); }

  private:
    const Gpu& gpu_;
    bool on_disk_;
    size_t loaded_bytes_ = 0;
    Unique<VkPipelineCache> cache_;
};

/// `options` are 32-bit values in the order of ProgramInfo::options; `raster` is null for compute. Errors:
/// shader, out_of_memory.
Result<Pipeline> create_pipeline(const Gpu& gpu, const PipelineCache& cache, const rhi::ProgramInfo& program,
                                 std::span<const uint32_t> options, const rhi::RasterState* raster);

}  // namespace lumo::backends::vulkan
