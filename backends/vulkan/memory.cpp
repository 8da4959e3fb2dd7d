#include "backends/vulkan/memory.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <optional>

namespace lumo::backends::vulkan {

namespace {

constexpr uint64_t block_bytes = uint64_t(64) << 20;

/// Properties of a memory type: those it must have, should have, should not have.
struct Wish {
    VkMemoryPropertyFlags required;
    VkMemoryPropertyFlags preferred;
    VkMemoryPropertyFlags unwanted;
};

Wish wish_for(rhi::Memory where) {
    constexpr auto visible = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT;
    constexpr auto cached = VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
    constexpr auto local = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
    constexpr auto mappable = visible | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    if (where == rhi::Memory::upload) return {mappable, 0, cached};
    if (where == rhi::Memory::readback) return {mappable, cached, local};
    return {0, local, visible};
}

uint64_t align_up(uint64_t value, uint64_t alignment) {
    return (value + alignment - 1) / alignment * alignment;
}

}  // namespace

struct MemoryBlock {
    struct Gap {
        uint64_t offset;
        uint64_t size;
    };
    Unique<VkDeviceMemory> memory;
    uint64_t size;
    uint32_t type;
    bool images;
    bool dedicated;
    std::byte* mapped;
    std::vector<Gap> gaps;  ///< what is free, by ascending offset, never touching each other

    std::optional<uint64_t> take(uint64_t bytes, uint64_t alignment) {
        for (auto gap = gaps.begin(); gap != gaps.end(); ++gap) {
            uint64_t begin = align_up(gap->offset, alignment);
            uint64_t end = gap->offset + gap->size;
            if (begin + bytes > end) continue;
            uint64_t rest = end - begin - bytes;
            gap->size = begin - gap->offset;
            auto after = gap->size == 0 ? gaps.erase(gap) : gap + 1;
            if (rest > 0) gaps.insert(after, {begin + bytes, rest});
            return begin;
        }
        return std::nullopt;
    }

    void give_back(uint64_t offset, uint64_t bytes) {
        auto next =
            std::find_if(gaps.begin(), gaps.end(), [&](const Gap& gap) { return gap.offset > offset; });
        next = gaps.insert(next, {offset, bytes});
        auto join_with_next = [&](auto gap) {
            if (gap + 1 == gaps.end() || gap->offset + gap->size != (gap + 1)->offset) return;
            gap->size += (gap + 1)->size;
            gaps.erase(gap + 1);
        };
        join_with_next(next);
        if (next != gaps.begin()) join_with_next(next - 1);
    }

    bool empty() const { return gaps.size() == 1 && gaps.front().size == size; }
};

struct Allocator::Request {
    VkBuffer buffer;
    VkImage image;
    rhi::Memory where;
    VkMemoryRequirements needs;
    bool dedicated;
    const std::string& name;
};

void Allocator::Release::operator()(MemoryRange* range) const {
    MemoryBlock* block = range->block;
    block->give_back(range->offset, range->size);
    if (block->empty()) std::erase_if(allocator->blocks_, [&](const auto& b) { return b.get() == block; });
    delete range;
}

Allocator::Allocator(const Gpu& gpu) : gpu_(gpu) {
    VkPhysicalDeviceMemoryProperties2 memory{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MEMORY_PROPERTIES_2};
    gpu.instance().vk().memory_properties(gpu.physical(), &memory);
    properties_ = memory.memoryProperties;
    VkPhysicalDeviceMaintenance3Properties limits{
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES};
    VkPhysicalDeviceProperties2 properties{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2,
                                           .pNext = &limits};
    gpu.instance().vk().properties(gpu.physical(), &properties);
    max_allocation_ = limits.maxMemoryAllocationSize;
}

Allocator::~Allocator() = default;

Result<Allocation> Allocator::bind(VkBuffer buffer, VkImage image, rhi::Memory where,
                                   const std::string& name) {
    const auto& vk = gpu_.vk();
    VkMemoryDedicatedRequirements alone{.sType = VK_STRUCTURE_TYPE_MEMORY_DEDICATED_REQUIREMENTS};
    VkMemoryRequirements2 needs{.sType = VK_STRUCTURE_TYPE_MEMORY_REQUIREMENTS_2, .pNext = &alone};
    if (buffer) {
        VkBufferMemoryRequirementsInfo2 what{.sType = VK_STRUCTURE_TYPE_BUFFER_MEMORY_REQUIREMENTS_INFO_2,
                                             .buffer = buffer};
        vk.vkGetBufferMemoryRequirements2(gpu_.device(), &what, &needs);
    } else {
        VkImageMemoryRequirementsInfo2 what{.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_REQUIREMENTS_INFO_2,
                                            .image = image};
        vk.vkGetImageMemoryRequirements2(gpu_.device(), &what, &needs);
    }
    bool dedicated = alone.prefersDedicatedAllocation || needs.memoryRequirements.size >= block_bytes / 4;
    auto range = allocate({buffer, image, where, needs.memoryRequirements, dedicated, name});
    if (!range) return range;
    VkDeviceMemory memory = (*range)->block->memory.get();
    VkResult result = buffer ? vk.vkBindBufferMemory(gpu_.device(), buffer, memory, (*range)->offset)
                             : vk.vkBindImageMemory(gpu_.device(), image, memory, (*range)->offset);
    if (result != VK_SUCCESS) return fail(result, name, "vkBindMemory");
    return range;
}

Result<Allocation> Allocator::allocate(const Request& request) {
    Wish wish = wish_for(request.where);
    std::vector<std::pair<int, uint32_t>> types;
    for (uint32_t type = 0; type < properties_.memoryTypeCount; ++type) {
        VkMemoryPropertyFlags flags = properties_.memoryTypes[type].propertyFlags;
        bool fits = (request.needs.memoryTypeBits >> type & 1) && (flags & wish.required) == wish.required &&
                    !(flags & VK_MEMORY_PROPERTY_PROTECTED_BIT);
        if (!fits) continue;
        int misses = ((flags & wish.preferred) != wish.preferred ? 2 : 0) + ((flags & wish.unwanted) != 0);
        types.emplace_back(misses, type);
    }
    // The driver's order counts among equals, and a full heap leaves the next best type.
    std::stable_sort(types.begin(), types.end(), [](auto& a, auto& b) { return a.first < b.first; });
    Result<Allocation> range =
        fail(ErrorKind::unsupported, request.name, "the device has no memory of a fitting type");
    for (auto [misses, type] : types) {
        range = allocate(request, type);
        if (range) break;
    }
    return range;
}

Result<Allocation> Allocator::allocate(const Request& request, uint32_t type) {
    const auto& needs = request.needs;
    bool map = request.where != rhi::Memory::device;
    auto range_in = [&](MemoryBlock& block, uint64_t offset) {
        std::byte* mapped = map ? block.mapped + offset : nullptr;
        return Allocation(new MemoryRange{&block, offset, needs.size, mapped}, Release{this});
    };
    for (auto& block : blocks_) {
        bool fits = !request.dedicated && !block->dedicated && block->type == type &&
                    block->images == bool(request.image) && bool(block->mapped) == map;
        if (!fits) continue;
        if (auto offset = block->take(needs.size, needs.alignment)) return range_in(*block, *offset);
    }

    uint64_t heap = properties_.memoryHeaps[properties_.memoryTypes[type].heapIndex].size;
    uint64_t most = std::min(heap, max_allocation_);
    uint64_t bytes = request.dedicated ? needs.size : std::min(block_bytes, std::max(needs.size, heap / 8));
    if (bytes > most) {
        return fail(ErrorKind::out_of_memory, request.name,
                    fmt::format("{} bytes are more than the device's {}", bytes, most));
    }
    VkMemoryDedicatedAllocateInfo alone{.sType = VK_STRUCTURE_TYPE_MEMORY_DEDICATED_ALLOCATE_INFO,
                                        .image = request.image,
                                        .buffer = request.buffer};
    VkMemoryAllocateInfo info{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                              .pNext = request.dedicated ? &alone : nullptr,
                              .allocationSize = bytes,
                              .memoryTypeIndex = type};
    auto memory =
        gpu_.make<VkDeviceMemory>(gpu_.vk().vkAllocateMemory, gpu_.vk().vkFreeMemory, info, request.name);
    if (!memory) return tl::unexpected(memory.error());
    void* mapped = nullptr;
    if (map) {
        VkResult result = gpu_.vk().vkMapMemory(gpu_.device(), memory->get(), 0, VK_WHOLE_SIZE, 0, &mapped);
        if (result != VK_SUCCESS) return fail(result, request.name, "vkMapMemory");
    }
    auto& block =
        *blocks_.emplace_back(std::make_unique<MemoryBlock>(MemoryBlock{std::move(*memory),
                                                                        bytes,
                                                                        type,
                                                                        bool(request.image),
                                                                        request.dedicated,
                                                                        static_cast<std::byte*>(mapped),
                                                                        {{0, bytes}}}));
    block.take(needs.size, needs.alignment);
    return range_in(block, 0);
}

}  // namespace lumo::backends::vulkan
