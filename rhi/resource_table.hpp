// Handles and what they name: which are alive, and which wait for the device before they are destroyed.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "rhi/backend.hpp"
#include "rhi/rhi.hpp"

namespace lumo::rhi {

struct BufferRecord {
    BufferDesc desc;
    std::byte* mapped = nullptr;
    uint64_t bytes = 0;
    bool adopted = false;   ///< a host's
    bool internal = false;  ///< the core's own: host memory that the device only reads, or only writes
};
struct TextureRecord {
    TextureDesc desc;
    uint64_t bytes = 0;
    bool adopted = false;  ///< a host's
};
struct SamplerRecord {
    SamplerDesc desc;
};
struct PipelineRecord {
    const ProgramInfo* program = nullptr;
    std::optional<RasterState> raster;
};

/// Records by handle. An index is free again only when its resource is gone from the device.
template <class HandleType, class Record>
class Slots {
  public:
    HandleType add(uint32_t generation, Record record) {
        uint32_t index = uint32_t(slots_.size());
        if (free_.empty()) {
            slots_.emplace_back();
        } else {
            index = free_.back();
            free_.pop_back();
        }
        slots_[index] = {generation, true, std::move(record)};
        return {index, generation};
    }
    /// Null when the handle is stale.
    Record* find(HandleType handle) {
        const bool known = handle && handle.index < slots_.size();
        Slot* slot = known ? &slots_[handle.index] : nullptr;
        return slot && slot->alive && slot->generation == handle.generation ? &slot->record : nullptr;
    }
    /// Of a resource that is alive or waits for its destruction.
    const Record& at(uint32_t index) const { return slots_[index].record; }
    void retire(HandleType handle) { slots_[handle.index].alive = false; }
    void recycle(HandleType handle) {
        slots_[handle.index] = {};
        free_.push_back(handle.index);
    }
    template <class Visit>
    void each_alive(Visit visit) const {
        for (uint32_t i = 0; i < slots_.size(); ++i)
            if (slots_[i].alive) visit(HandleType{i, slots_[i].generation}, slots_[i].record);
    }

  private:
    struct Slot {
        uint32_t generation = 0;
        bool alive = false;
        Record record;
    };
    std::vector<Slot> slots_;
    std::vector<uint32_t> free_;
};

class ResourceTable {
  public:
    /// Handles of tables with different seeds do not meet.
    ResourceTable(Backend& backend, uint32_t seed) : backend_(backend), generation_(seed) {}

    Result<BufferHandle> create(const BufferDesc& desc, bool internal);
    Result<TextureHandle> create(const TextureDesc& desc);
    Result<TextureHandle> adopt(const TextureDesc& desc, const NativeTexture& native);
    Result<BufferHandle> adopt(const BufferDesc& desc, const NativeBuffer& native);
    Result<SamplerHandle> create(const SamplerDesc& desc);
    Result<PipelineHandle> create(const ProgramInfo& program, std::span<const uint32_t> options,
                                  const RasterState* raster);

    BufferRecord* find(BufferHandle handle) { return buffers_.find(handle); }
    TextureRecord* find(TextureHandle handle) { return textures_.find(handle); }
    SamplerRecord* find(SamplerHandle handle) { return samplers_.find(handle); }
    PipelineRecord* find(PipelineHandle handle) { return pipelines_.find(handle); }
    std::string name_of(const MemoryId& memory) const;
    /// Of a host's texture, and 1 of its buffer; of all else 0.
    uint32_t adopted_mips(const MemoryId& memory) const {
        if (memory.kind == MemoryId::Kind::buffer) return buffers_.at(memory.index).adopted ? 1 : 0;
        const TextureRecord& texture = textures_.at(memory.index);
        return texture.adopted ? texture.desc.mips : 0;
    }

    /// The handle is stale from now on; the resource goes once the device has finished submission `serial`.
    template <class HandleType>
    void release(HandleType handle, uint64_t serial) {
        if (!find(handle)) return;
        slots(handle).retire(handle);
        graves_.push_back({handle, serial});
        ++releases_;
    }
    /// How often that was. A handle that was alive is so until the next.
    uint64_t releases() const { return releases_; }
    /// Destroys what was released and is no longer used.
    void collect(uint64_t completed);

    /// Memory of what is alive.
    std::vector<MemoryEntry> memory() const;
    /// Words for each resource that its user still owns.
    std::vector<std::string> owned() const;
    /// Releases everything.
    void release_all();

  private:
    using AnyHandle = std::variant<BufferHandle, TextureHandle, SamplerHandle, PipelineHandle>;
    struct Grave {
        AnyHandle handle;
        uint64_t serial;
    };

    auto& slots(BufferHandle) { return buffers_; }
    auto& slots(TextureHandle) { return textures_; }
    auto& slots(SamplerHandle) { return samplers_; }
    auto& slots(PipelineHandle) { return pipelines_; }
    /// 0 stands for no resource and is skipped when the count wraps.
    uint32_t next_generation() { return ++generation_ ? generation_ : ++generation_; }

    Backend& backend_;
    uint32_t generation_;
    Slots<BufferHandle, BufferRecord> buffers_;
    Slots<TextureHandle, TextureRecord> textures_;
    Slots<SamplerHandle, SamplerRecord> samplers_;
    Slots<PipelineHandle, PipelineRecord> pipelines_;
    std::vector<Grave> graves_;
    uint64_t releases_ = 0;
};

}  // namespace lumo::rhi
