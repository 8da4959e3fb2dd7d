#include "rhi/resource_table.hpp"

#include <algorithm>
#include <fmt/format.h>

#include "rhi/validate.hpp"

namespace lumo::rhi {
namespace {

/// `asked`: for what; put in front of the backend's reason.
template <class HandleType, class Record>
tl::unexpected<Error> undo(Slots<HandleType, Record>& slots, HandleType handle, Error error,
                           const std::string& asked) {
    slots.retire(handle);
    slots.recycle(handle);
    error.message = fmt::format("{}: {}", asked, error.message);
    if (error.kind == ErrorKind::out_of_memory && error.remedy.empty())
        error.remedy = "ask for less, or free memory of the device";
    return tl::unexpected(std::move(error));
}

std::string words(const BufferDesc& desc) {
    constexpr std::string_view kinds[] = {"device", "upload", "readback"};
    return fmt::format("{} bytes of {} memory", desc.size, kinds[size_t(desc.memory)]);
}

std::string words(const TextureDesc& desc) {
    return fmt::format("{}x{}x{} texels of {}, {} layers, {} mips, {} samples", desc.extent.width,
                       desc.extent.height, desc.extent.depth, format_info(desc.format).name, desc.layers,
                       desc.mips, desc.samples);
}

}  // namespace

Result<BufferHandle> ResourceTable::create(const BufferDesc& desc, bool internal) {
    const BufferHandle handle = buffers_.add(next_generation(), {.desc = desc, .internal = internal});
    auto made = backend_.create_buffer(handle, desc);
    if (!made) return undo(buffers_, handle, std::move(made.error()), words(desc));
    BufferRecord& record = *buffers_.find(handle);
    record.mapped = made->mapped;
    record.bytes = made->allocated_bytes;
    return handle;
}

Result<TextureHandle> ResourceTable::create(const TextureDesc& desc) {
    const TextureHandle handle = textures_.add(next_generation(), {.desc = desc});
    auto bytes = backend_.create_texture(handle, desc);
    if (!bytes) return undo(textures_, handle, std::move(bytes.error()), words(desc));
    textures_.find(handle)->bytes = *bytes;
    return handle;
}

Result<TextureHandle> ResourceTable::adopt(const TextureDesc& desc, const NativeTexture& native) {
    const TextureHandle handle = textures_.add(next_generation(), {.desc = desc, .adopted = true});
    auto made = backend_.adopt_texture(handle, desc, native);
    if (!made) return undo(textures_, handle, std::move(made.error()), words(desc));
    return handle;
}

Result<BufferHandle> ResourceTable::adopt(const BufferDesc& desc, const NativeBuffer& native) {
    const BufferHandle handle = buffers_.add(next_generation(), {.desc = desc, .adopted = true});
    auto made = backend_.adopt_buffer(handle, desc, native);
    if (!made) return undo(buffers_, handle, std::move(made.error()), words(desc));
    return handle;
}

Result<SamplerHandle> ResourceTable::create(const SamplerDesc& desc) {
    const SamplerHandle handle = samplers_.add(next_generation(), {.desc = desc});
    auto made = backend_.create_sampler(handle, desc);
    if (!made) return undo(samplers_, handle, std::move(made.error()), "a sampler");
    return handle;
}

Result<PipelineHandle> ResourceTable::create(const ProgramInfo& program, std::span<const uint32_t> options,
                                             const RasterState* raster) {
    PipelineRecord record{&program, raster ? std::optional(*raster) : std::nullopt};
    const PipelineHandle handle = pipelines_.add(next_generation(), std::move(record));
    auto made = backend_.create_pipeline(handle, program, options, raster);
    if (!made) return undo(pipelines_, handle, std::move(made.error()), "a pipeline");
    return handle;
}

std::string ResourceTable::name_of(const MemoryId& memory) const {
    if (memory.kind == MemoryId::Kind::buffer) return quoted(buffers_.at(memory.index).desc.name);
    const TextureDesc& texture = textures_.at(memory.index).desc;
    return texture.mips == 1 ? quoted(texture.name)
                             : fmt::format("{} mip {}", quoted(texture.name), memory.mip);
}

void ResourceTable::collect(uint64_t completed) {
    std::erase_if(graves_, [&](const Grave& grave) {
        if (grave.serial > completed) return false;
        std::visit(
            [&](auto handle) {
                backend_.destroy(handle);
                slots(handle).recycle(handle);
            },
            grave.handle);
        return true;
    });
}

std::vector<MemoryEntry> ResourceTable::memory() const {
    std::vector<MemoryEntry> entries;
    buffers_.each_alive([&](BufferHandle, const BufferRecord& b) {
        entries.push_back({b.desc.name, b.bytes});
    });
    textures_.each_alive([&](TextureHandle, const TextureRecord& t) {
        entries.push_back({t.desc.name, t.bytes});
    });
    std::ranges::stable_sort(entries, std::ranges::greater{}, &MemoryEntry::bytes);
    return entries;
}

std::vector<std::string> ResourceTable::owned() const {
    std::vector<std::string> words;
    buffers_.each_alive([&](BufferHandle, const BufferRecord& buffer) {
        if (!buffer.internal) words.push_back("buffer " + quoted(buffer.desc.name));
    });
    textures_.each_alive([&](TextureHandle, const TextureRecord& texture) {
        words.push_back("texture " + quoted(texture.desc.name));
    });
    samplers_.each_alive([&](SamplerHandle, const SamplerRecord&) { words.emplace_back("a sampler"); });
    pipelines_.each_alive([&](PipelineHandle, const PipelineRecord& pipeline) {
        words.push_back(fmt::format("a pipeline of program \"{}\"", pipeline.program->name));
    });
    return words;
}

void ResourceTable::release_all() {
    std::vector<AnyHandle> alive;
    const auto gather = [&](auto handle, const auto&) { alive.push_back(handle); };
    buffers_.each_alive(gather);
    textures_.each_alive(gather);
    samplers_.each_alive(gather);
    pipelines_.each_alive(gather);
    for (const AnyHandle& any : alive) std::visit([&](auto handle) { release(handle, 0); }, any);
}

}  // namespace lumo::rhi
