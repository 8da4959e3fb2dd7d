// A device without an API: it keeps what it is told, runs buffer copies on host memory, finishes submissions
// when a test says so, and fails where a test asks for it.
#pragma once

#include <deque>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "rhi/backend.hpp"
#include "rhi/rhi.hpp"

namespace lumo::rhi::fake {

struct Emitted {
    std::string name;
    bool raster = false;
    Extent extent;
    std::vector<Barrier> barriers;
    std::vector<std::vector<Barrier>> step_barriers;
    std::vector<Command> commands;               ///< their spans are dead; see pushes and bindings
    std::vector<std::vector<std::byte>> pushes;  ///< one per dispatch or draw
    std::vector<std::vector<BindingValue>> bindings;
};

/// What a test sees and steers; outlives the backend.
struct State {
    DeviceInfo info;
    std::map<Format, FormatCaps> caps;  ///< others can do everything

    uint64_t submitted = 0;
    uint64_t completed = 0;
    bool finish_at_once = true;
    std::vector<uint64_t> begun;
    std::vector<Emitted> passes;
    std::map<uint64_t, std::vector<PassStamp>> stamps;
    std::vector<uint64_t> waits, signals;  ///< objects of the host's
    std::vector<Barrier> handed_back;      ///< with the last submission

    std::map<uint32_t, std::vector<std::byte>> buffers;  ///< by index, alive on the device
    std::map<uint32_t, std::string> textures;
    std::set<uint32_t> samplers, pipelines;
    std::vector<std::string> destroyed;
    std::vector<SamplerDesc> sampler_descs;

    /// The next calls of this name fail.
    std::map<std::string, Error> failing;

    State() {
        info.limits.max_texture_side_2d = 4096;
        info.limits.max_texture_side_3d = 512;
        info.limits.max_texture_layers = 256;
        info.limits.max_storage_bytes = uint64_t{1} << 27;
        info.limits.max_uniform_bytes = 65536;
        info.limits.max_samples = 4;
        info.limits.max_anisotropy = 8;
        info.geometry_shader = true;
    }

    size_t alive() const { return buffers.size() + textures.size() + samplers.size() + pipelines.size(); }
};

class FakeBackend : public Backend {
  public:
    explicit FakeBackend(State& state) : state_(state) {}

    const DeviceInfo& info() const override { return state_.info; }
    FormatCaps format_caps(Format format) const override {
        const auto found = state_.caps.find(format);
        return found == state_.caps.end() ? FormatCaps(127) : found->second;
    }

    Result<CreatedBuffer> create_buffer(BufferHandle handle, const BufferDesc& desc) override {
        if (auto error = failure("create_buffer")) return tl::unexpected(*error);
        auto& bytes = state_.buffers[handle.index];
        bytes.resize(desc.size);
        names_[handle.index] = desc.name;
        return CreatedBuffer{desc.memory == Memory::device ? nullptr : bytes.data(), desc.size};
    }
    Result<uint64_t> create_texture(TextureHandle handle, const TextureDesc& desc) override {
        if (auto error = failure("create_texture")) return tl::unexpected(*error);
        state_.textures[handle.index] = desc.name;
        return region_bytes(desc.format, whole_mip(desc));
    }
    Result<void> adopt_texture(TextureHandle handle, const TextureDesc& desc, const NativeTexture&) override {
        if (auto error = failure("adopt_texture")) return tl::unexpected(*error);
        state_.textures[handle.index] = desc.name;
        return {};
    }
    Result<void> adopt_buffer(BufferHandle handle, const BufferDesc& desc, const NativeBuffer&) override {
        if (auto error = failure("adopt_buffer")) return tl::unexpected(*error);
        state_.buffers[handle.index].resize(desc.size);
        names_[handle.index] = desc.name;
        return {};
    }
    Result<void> create_sampler(SamplerHandle handle, const SamplerDesc& desc) override {
        if (auto error = failure("create_sampler")) return tl::unexpected(*error);
        state_.samplers.insert(handle.index);
        state_.sampler_descs.push_back(desc);
        return {};
    }
    Result<void> create_pipeline(PipelineHandle handle, const ProgramInfo&, std::span<const uint32_t>,
                                 const RasterState*) override {
        if (auto error = failure("create_pipeline")) return tl::unexpected(*error);
        state_.pipelines.insert(handle.index);
        return {};
    }
    void destroy(BufferHandle handle) override {
        state_.buffers.erase(handle.index);
        state_.destroyed.push_back(names_[handle.index]);
    }
    void destroy(TextureHandle handle) override {
        state_.destroyed.push_back(state_.textures[handle.index]);
        state_.textures.erase(handle.index);
    }
    void destroy(SamplerHandle handle) override {
        state_.samplers.erase(handle.index);
        state_.destroyed.emplace_back("sampler");
    }
    void destroy(PipelineHandle handle) override {
        state_.pipelines.erase(handle.index);
        state_.destroyed.emplace_back("pipeline");
    }

    Result<void> begin(uint64_t serial) override {
        if (auto error = failure("begin")) return tl::unexpected(*error);
        state_.begun.push_back(serial);
        if (serial > max_in_flight) state_.completed = std::max(state_.completed, serial - max_in_flight);
        return {};
    }
    Result<void> emit(const EmittedPass& pass) override {
        Emitted& copy = state_.passes.emplace_back();
        copy.name = pass.name;
        copy.raster = pass.targets != nullptr;
        if (pass.targets) copy.extent = pass.targets->extent;
        copy.barriers = pass.barriers;
        for (const Step& step : pass.steps) {
            copy.step_barriers.emplace_back(step.barriers.begin(), step.barriers.end());
            copy.commands.push_back(step.command);
            std::visit([&](const auto& command) { run(copy, command); }, step.command);
        }
        const uint64_t serial = state_.begun.back();
        const uint64_t start = 1000 * state_.stamps[serial].size();
        state_.stamps[serial].push_back({start, start + 500'000 * (1 + pass.steps.size())});
        if (auto error = failure("emit")) return tl::unexpected(*error);
        return {};
    }
    Result<void> wait_for(const NativeSync& sync) override {
        if (auto error = failure("wait_for")) return tl::unexpected(*error);
        state_.waits.push_back(sync.object);
        return {};
    }
    Result<void> signal(const NativeSync& sync) override {
        if (auto error = failure("signal")) return tl::unexpected(*error);
        state_.signals.push_back(sync.object);
        return {};
    }
    Result<void> submit(std::span<const Barrier> hand_back) override {
        if (auto error = failure("submit")) return tl::unexpected(*error);
        state_.handed_back.assign(hand_back.begin(), hand_back.end());
        state_.submitted = state_.begun.back();
        if (state_.finish_at_once) state_.completed = state_.submitted;
        return {};
    }
    uint64_t completed() override { return state_.completed; }
    Result<void> wait(uint64_t serial) override {
        if (auto error = failure("wait")) return tl::unexpected(*error);
        state_.completed = std::max(state_.completed, serial);
        return {};
    }
    std::vector<PassStamp> stamps(uint64_t serial) override { return state_.stamps[serial]; }
    MemoryBudget memory_budget() override { return {1, 2}; }

  private:
    std::optional<Error> failure(const std::string& call) {
        const auto node = state_.failing.extract(call);
        return node ? std::optional(node.mapped()) : std::nullopt;
    }

    std::byte* at(const BufferSlice& slice) {
        return state_.buffers.at(slice.buffer.index).data() + slice.offset;
    }

    void run(Emitted&, const CopyBufferCommand& copy) {
        std::copy_n(at(copy.source), copy.source.size, at(copy.destination));
    }
    void run(Emitted&, const FillBufferCommand& fill) {
        auto* words = reinterpret_cast<uint32_t*>(at(fill.destination));
        std::fill_n(words, fill.destination.size / 4, fill.value);
    }
    template <class WithBindings>
    requires requires(WithBindings command) { command.what; }
    void run(Emitted& copy, const WithBindings& command) {
        copy.pushes.emplace_back(command.what.push.begin(), command.what.push.end());
        copy.bindings.emplace_back(command.what.bindings.begin(), command.what.bindings.end());
    }
    template <class Other>
    void run(Emitted&, const Other&) {}

    State& state_;
    std::map<uint32_t, std::string> names_;
};

}  // namespace lumo::rhi::fake
