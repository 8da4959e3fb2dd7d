#include "backends/vulkan/vulkan.hpp"

#include "backends/vulkan/execution.hpp"

namespace lumo::backends::vulkan {

namespace {

/// Puts an object where its handle says. What was there before was destroyed.
template <class T>
void place(std::vector<T>& objects, uint32_t index, T object) {
    if (index >= objects.size()) objects.resize(index + 1);
    objects[index] = std::move(object);
}

class VulkanBackend : public rhi::Backend {
  public:
    static Result<std::unique_ptr<rhi::Backend>> create(const rhi::DeviceDesc& desc,
                                                        std::shared_ptr<const Surface> surface) {
        return on(Gpu::create(desc, std::move(surface)), desc);
    }
    static Result<std::unique_ptr<rhi::Backend>> adopt(const HostDevice& host, const rhi::DeviceDesc& desc) {
        return on(Gpu::adopt(host, desc), desc);
    }
    static Result<std::unique_ptr<rhi::Backend>> on(Result<std::unique_ptr<Gpu>> gpu,
                                                    const rhi::DeviceDesc& desc) {
        if (!gpu) return tl::unexpected(gpu.error());
        std::unique_ptr<VulkanBackend> made(new VulkanBackend(std::move(*gpu), desc.disk_cache));
        auto executor = Executor::create(*made->gpu_, made->store_);
        if (!executor) return tl::unexpected(executor.error());
        made->executor_ = std::move(*executor);
        return made;
    }

    const rhi::DeviceInfo& info() const override { return gpu_->info(); }
    rhi::FormatCaps format_caps(rhi::Format format) const override { return gpu_->format_caps(format); }

    Result<rhi::CreatedBuffer> create_buffer(rhi::BufferHandle handle, const rhi::BufferDesc& desc) override {
        return vulkan::create_buffer(*gpu_, allocator_, desc).map([&](Buffer&& buffer) {
            rhi::CreatedBuffer created{buffer.memory->mapped, buffer.memory->size};
            place(store_.buffers, handle.index, std::move(buffer));
            return created;
        });
    }
    Result<uint64_t> create_texture(rhi::TextureHandle handle, const rhi::TextureDesc& desc) override {
        return Texture::create(*gpu_, allocator_, desc).map([&](Texture&& texture) {
            uint64_t bytes = texture.allocated_bytes();
            place(store_.textures, handle.index, std::move(texture));
            return bytes;
        });
    }
    Result<void> adopt_texture(rhi::TextureHandle handle, const rhi::TextureDesc& desc,
                               const rhi::NativeTexture& native) override {
        return Texture::adopt(*gpu_, desc, native).map([&](Texture&& texture) {
            place(store_.textures, handle.index, std::move(texture));
        });
    }
    Result<void> adopt_buffer(rhi::BufferHandle handle, const rhi::BufferDesc& desc,
                              const rhi::NativeBuffer& native) override {
        return vulkan::adopt_buffer(*gpu_, desc, native).map([&](Buffer&& buffer) {
            place(store_.buffers, handle.index, std::move(buffer));
        });
    }
    Result<void> create_sampler(rhi::SamplerHandle handle, const rhi::SamplerDesc& desc) override {
        return vulkan::create_sampler(*gpu_, desc).map([&](Unique<VkSampler>&& sampler) {
            place(store_.samplers, handle.index, std::move(sampler));
        });
    }
    Result<void> create_pipeline(rhi::PipelineHandle handle, const rhi::ProgramInfo& program,
                                 std::span<const uint32_t> options, const rhi::RasterState* raster) override {
        return vulkan::create_pipeline(*gpu_, cache_, program, options, raster).map([&](Pipeline&& pipeline) {
            place(store_.pipelines, handle.index, std::move(pipeline));
        });
    }

    void destroy(rhi::BufferHandle handle) override { store_.buffers[handle.index] = {}; }
    void destroy(rhi::TextureHandle handle) override { store_.textures[handle.index] = {}; }
    void destroy(rhi::SamplerHandle handle) override { store_.samplers[handle.index] = {}; }
    void destroy(rhi::PipelineHandle handle) override { store_.pipelines[handle.index] = {}; }

    Result<void> begin(uint64_t serial) override { return executor_->begin(serial); }
    Result<void> emit(const rhi::EmittedPass& pass) override { return executor_->emit(pass); }
    Result<void> submit(std::span<const rhi::Barrier> hand_back) override {
        return executor_->submit(hand_back);
    }
    Result<void> wait_for(const rhi::NativeSync& sync) override { return executor_->wait_for(sync); }
    Result<void> signal(const rhi::NativeSync& sync) override { return executor_->signal(sync); }
    uint64_t completed() override { return executor_->completed(); }
    Result<void> wait(uint64_t serial) override { return executor_->wait(serial); }
    std::vector<rhi::PassStamp> stamps(uint64_t serial) override { return executor_->stamps(serial); }

    rhi::MemoryBudget memory_budget() override { return gpu_->memory_budget(); }

  private:
    VulkanBackend(std::unique_ptr<Gpu> gpu, bool disk_cache)
        : gpu_(std::move(gpu)), allocator_(*gpu_), cache_(*gpu_, disk_cache) {}

    // Destroyed from the last to the first: the executor waits for the device, then nothing is in use.
    std::unique_ptr<Gpu> gpu_;
    Allocator allocator_;
    PipelineCache cache_;
    Store store_;
    std::unique_ptr<Executor> executor_;
};

}  // namespace

Result<std::unique_ptr<rhi::Backend>> create_backend(const rhi::DeviceDesc& desc,
                                                     std::shared_ptr<const Surface> surface) {
    return VulkanBackend::create(desc, std::move(surface));
}

Result<std::unique_ptr<rhi::Backend>> adopt_backend(const HostDevice& host, const rhi::DeviceDesc& desc) {
    return VulkanBackend::adopt(host, desc);
}

std::vector<rhi::DeviceInfo> list_devices() {
    auto instance = Instance::create(false, {}, {});
    return instance ? list_devices(**instance) : std::vector<rhi::DeviceInfo>();
}

}  // namespace lumo::backends::vulkan
