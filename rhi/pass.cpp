// Commands and passes as their users see them: they name the core's open submission and pass, no more.
#include "rhi/core.hpp"

namespace lumo::rhi {

Commands::~Commands() {
    if (serial_) core_->submit(serial_);
}

Pass Commands::pass(std::string_view name) {
    const uint64_t id = core_->open_pass(serial_, name);
    return {id ? core_ : nullptr, id};
}

RasterPass Commands::raster_pass(std::string_view name, const RasterTargets& targets) {
    const uint64_t id = core_->open_raster_pass(serial_, name, targets);
    return {id ? core_ : nullptr, id};
}

UniformBuffer Commands::uniform_bytes(std::span<const std::byte> bytes) {
    return core_->uniform(serial_, bytes).value_or(BufferSlice{});
}

void Commands::present(const Texture& texture, bool vsync) {
    (void)core_->present(serial_, texture.handle(), vsync);
}

void Commands::wait(const NativeSync& sync) { (void)core_->wait_for(serial_, sync); }

void Commands::signal(const NativeSync& sync) { (void)core_->signal(serial_, sync); }

void PassBase::end() {
    if (id_) core_->end_pass(std::exchange(id_, 0));
}

void Pass::copy(BufferSlice source, BufferSlice destination) {
    if (core_) (void)core_->copy(id_, source, destination);
}

void Pass::copy(const Texture& source, const TextureRegion& source_region, const Texture& destination,
                const TextureRegion& destination_region) {
    if (core_)
        (void)core_->copy(id_, source.handle(), source_region, destination.handle(), destination_region);
}

void Pass::upload(BufferSlice destination, std::span<const std::byte> bytes) {
    if (core_) (void)core_->upload(id_, destination, bytes);
}

void Pass::upload(const Texture& destination, const TextureRegion& region,
                  std::span<const std::byte> texels) {
    if (core_) (void)core_->upload(id_, destination.handle(), region, texels);
}

void Pass::fill(BufferSlice destination, uint32_t value) {
    if (core_) (void)core_->fill(id_, destination, value);
}

void Pass::clear(const TextureView& view, const ClearValue& value) {
    if (core_) (void)core_->clear(id_, view, value);
}

void Pass::generate_mips(const Texture& texture) {
    if (core_) (void)core_->generate_mips(id_, texture.handle());
}

Readback Pass::read(BufferSlice source) {
    return core_ ? core_->read(id_, source).value_or(Readback{}) : Readback{};
}

Readback Pass::read(const Texture& source, const TextureRegion& region) {
    return core_ ? core_->read(id_, source.handle(), region).value_or(Readback{}) : Readback{};
}

void Pass::dispatch(PipelineHandle pipeline, std::span<const BindingValue> bindings,
                    std::span<const std::byte> push, Groups groups) {
    if (core_) (void)core_->dispatch(id_, pipeline, bindings, push, groups);
}

void Pass::dispatch_indirect(PipelineHandle pipeline, std::span<const BindingValue> bindings,
                             std::span<const std::byte> push, BufferSlice arguments, bool unordered) {
    if (core_) (void)core_->dispatch_indirect(id_, pipeline, bindings, push, arguments, unordered);
}

void RasterPass::viewport(const Viewport& viewport) {
    if (core_) (void)core_->viewport(id_, viewport);
}

void RasterPass::record(PipelineHandle pipeline, std::span<const BindingValue> bindings,
                        std::span<const std::byte> push, const AnyDraw& draw) {
    if (core_) (void)core_->draw(id_, pipeline, bindings, push, draw);
}

}  // namespace lumo::rhi
