// What a host of another making hands to lumo: textures and buffers of its own, and what orders its work with
// lumo's. Devices that can take them are made by backends/vulkan/adopt.hpp and backends/gl/adopt.hpp; on any other
// device these calls are errors.
//
// A host's resource belongs to the host between lumo's submissions. A submission that uses a texture finds it, with
// all its mips and layers, in `layout_before`, and leaves it so in `layout_after`; what either side wrote to a texture
// or a buffer is visible to the other, on the one queue or context that both submit to: there no NativeSync is needed.
// Where several submissions use a texture while the host does not, its two layouts are to be equal.
#pragma once

#include <cstdint>

namespace lumo::rhi {

/// A texture that the host made and destroys: after its lumo::rhi::Texture is gone and the last submission
/// that used it is done. It must allow what its TextureDesc says, and copies where these are recorded.
struct NativeTexture {
    uint64_t object = 0;  ///< a VkImage, of all the TextureDesc's mips and layers; or a GL texture's name
    uint32_t layout_before = 0;  ///< a VkImageLayout; undefined: what it held is lost. OpenGL has no layouts
    uint32_t layout_after = 0;   ///< a VkImageLayout other than undefined and preinitialized
};

/// A buffer that the host made and destroys, when it might destroy a texture. It must allow what its BufferDesc
/// says, and copies where these are recorded.
struct NativeBuffer {
    uint64_t object = 0;  ///< a VkBuffer; or a GL buffer's name. lumo uses it from its first byte
};

/// What the device's work waits for, or what says that it is done.
struct NativeSync {
    uint64_t object = 0;  ///< a VkSemaphore; or a GLsync
    uint64_t value = 0;   ///< of a timeline semaphore; 0 with others
};

}  // namespace lumo::rhi
