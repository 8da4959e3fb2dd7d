#include "backends/gl/push_ring.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "backends/gl/resources.hpp"
#include "backends/gl/timeline.hpp"

namespace lumo::backends::gl {

Result<PushRing> PushRing::create(uint32_t alignment) {
    constexpr GLbitfield mapping = GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT | GL_MAP_WRITE_BIT;
    PushRing ring;
    ring.alignment_ = std::max<size_t>(alignment, 16);
    const Silence silence;
    glCreateBuffers(1, &ring.buffer_);
    glNamedBufferStorage(ring.buffer_, parts * part_bytes, nullptr, mapping);
    ring.mapped_ =
        static_cast<std::byte*>(glMapNamedBufferRange(ring.buffer_, 0, parts * part_bytes, mapping));
    auto status = check_errors("push constants");
    if (status && !ring.mapped_) status = out_of_memory("push constants");
    if (!status) {
        ring.clear();
        return tl::unexpected(status.error());
    }
    label(GL_BUFFER, ring.buffer_, "push constants");
    return ring;
}

void PushRing::clear() {
    for (GLsync& fence : fences_) glDeleteSync(std::exchange(fence, nullptr));
    glDeleteBuffers(1, &buffer_);
    buffer_ = 0;
}

BufferRange PushRing::put(std::span<const std::byte> bytes) {
    if (std::ranges::equal(bytes, last_bytes_)) return last_;
    last_bytes_.assign(bytes.begin(), bytes.end());

    const auto round_up = [](size_t size, size_t unit) { return (size + unit - 1) / unit * unit; };
    // A uniform block's size is a multiple of a vec4, and the range bound must hold all of it.
    const size_t size = round_up(bytes.size(), 16);
    if (used_ + size > part_bytes) {
        fences_[part_] = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
        if (!fences_[part_]) glFinish();
        part_ = (part_ + 1) % parts;
        used_ = 0;
        if (GLsync fence = std::exchange(fences_[part_], nullptr)) {
            (void)wait_for(fence);  // a lost device is found by the next submit
            glDeleteSync(fence);
        }
    }
    const size_t offset = part_ * part_bytes + used_;
    std::memcpy(mapped_ + offset, bytes.data(), bytes.size());
    used_ += round_up(size, alignment_);
    return last_ = {buffer_, GLintptr(offset), GLsizeiptr(size)};
}

}  // namespace lumo::backends::gl
