// Push constants as ranges of a mapped uniform buffer.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "backends/gl/state.hpp"
#include "rhi/error.hpp"

namespace lumo::backends::gl {

/// Hands out ranges one after another. The buffer is a ring of parts; a part is written again only when the
/// device has passed the fence behind its last use.
class PushRing {
  public:
    static Result<PushRing> create(uint32_t alignment);

    /// Where the bytes are for the next command. Bytes equal to those before stay where they are.
    BufferRange put(std::span<const std::byte> bytes);

    /// Deletes its objects.
    void clear();

  private:
    static constexpr size_t parts = 8;
    static constexpr size_t part_bytes = 128 << 10;

    GLuint buffer_ = 0;
    std::byte* mapped_ = nullptr;
    size_t alignment_ = 0;
    size_t part_ = 0;
    size_t used_ = 0;  ///< bytes of this part
    std::array<GLsync, parts> fences_{};
    BufferRange last_;
    std::vector<std::byte> last_bytes_;
};

}  // namespace lumo::backends::gl
