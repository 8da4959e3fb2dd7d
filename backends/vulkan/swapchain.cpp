#include "backends/vulkan/swapchain.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <span>

#include "backends/vulkan/convert.hpp"

namespace lumo::backends::vulkan {

namespace {

/// After so long a frame is not shown: a window system may hand out no image while the window is hidden.
constexpr uint64_t patience_ns = 1'000'000'000;
/// Images made for one frame of a window that is being resized.
constexpr int tries = 4;
constexpr VkPipelineStageFlags2 blit_stage = VK_PIPELINE_STAGE_2_BLIT_BIT;
constexpr VkImageSubresourceRange whole{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};

VkSemaphoreSubmitInfo submit_info(VkSemaphore semaphore, VkPipelineStageFlags2 stages) {
    return {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO, .semaphore = semaphore, .stageMask = stages};
}

/// A blit decodes what it reads and encodes what it writes, so texels stay as they are stored where both are
/// of one kind.
std::optional<VkFormat> choose_format(std::span<const VkSurfaceFormatKHR> formats, bool srgb) {
    constexpr VkFormat kinds[2][2] = {{VK_FORMAT_B8G8R8A8_UNORM, VK_FORMAT_R8G8B8A8_UNORM},
                                      {VK_FORMAT_B8G8R8A8_SRGB, VK_FORMAT_R8G8B8A8_SRGB}};
    for (VkFormat wanted : kinds[srgb]) {
        for (const VkSurfaceFormatKHR& format : formats) {
            if (format.format == wanted && format.colorSpace == VK_COLOR_SPACE_SRGB_NONLINEAR_KHR)
                return wanted;
        }
    }
    return {};
}

/// As enumerate, of a call that may fail.
template <class T, class Call>
Result<std::vector<T>> list_of(std::string_view name, Call call) {
    VkResult result = VK_SUCCESS;
    std::vector<T> all = enumerate<T>([&](uint32_t* count, T* list) {
        if (result >= VK_SUCCESS) result = call(count, list);
    });
    if (result < VK_SUCCESS) return fail(result, "window", name);
    return all;
}

VkPresentModeKHR choose_mode(std::span<const VkPresentModeKHR> modes, bool vsync) {
    if (!vsync) {
        for (VkPresentModeKHR mode : {VK_PRESENT_MODE_MAILBOX_KHR, VK_PRESENT_MODE_IMMEDIATE_KHR})
            if (std::ranges::find(modes, mode) != modes.end()) return mode;
    }
    return VK_PRESENT_MODE_FIFO_KHR;  // which all have
}

}  // namespace

Result<void> Swapchain::make(const Shape& shape) {
    // Nothing of the old images is in use then, nor are their semaphores.
    vk_.vkDeviceWaitIdle(gpu_.device());
    images_.clear();
    const auto& vk = gpu_.instance().vk();
    VkSurfaceCapabilitiesKHR can{};
    VkResult result = vk.surface_capabilities(gpu_.physical(), gpu_.surface(), &can);
    if (result != VK_SUCCESS) return fail(result, "window", "vkGetPhysicalDeviceSurfaceCapabilitiesKHR");
    const auto formats = list_of<VkSurfaceFormatKHR>(
        "vkGetPhysicalDeviceSurfaceFormatsKHR", [&](uint32_t* count, VkSurfaceFormatKHR* list) {
            return vk.surface_formats(gpu_.physical(), gpu_.surface(), count, list);
        });
    const auto modes = list_of<VkPresentModeKHR>(
        "vkGetPhysicalDeviceSurfacePresentModesKHR", [&](uint32_t* count, VkPresentModeKHR* list) {
            return vk.present_modes(gpu_.physical(), gpu_.surface(), count, list);
        });
    if (!formats) return tl::unexpected(formats.error());
    if (!modes) return tl::unexpected(modes.error());
    const auto format = choose_format(*formats, shape.srgb);
    if (!format || !(can.supportedUsageFlags & VK_IMAGE_USAGE_TRANSFER_DST_BIT)) {
        return fail(
            ErrorKind::unsupported, "window",
            fmt::format("it has no images of 8-bit {} that can be copied to", shape.srgb ? "sRGB" : "UNORM"));
    }
    extent_ = can.currentExtent;
    if (extent_.width == UINT32_MAX) {  // it follows its images
        extent_ = {std::clamp(shape.window.width, can.minImageExtent.width, can.maxImageExtent.width),
                   std::clamp(shape.window.height, can.minImageExtent.height, can.maxImageExtent.height)};
    }
    if (extent_.width == 0 || extent_.height == 0) {
        swapchain_ = {};
        return {};
    }
    const uint32_t count = std::max(can.minImageCount + 1, 3u);
    const bool opaque = can.supportedCompositeAlpha & VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR;
    VkSwapchainCreateInfoKHR info{
        .sType = VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR,
        .surface = gpu_.surface(),
        .minImageCount = can.maxImageCount ? std::min(count, can.maxImageCount) : count,
        .imageFormat = *format,
        .imageColorSpace = VK_COLOR_SPACE_SRGB_NONLINEAR_KHR,
        .imageExtent = extent_,
        .imageArrayLayers = 1,
        .imageUsage = VK_IMAGE_USAGE_TRANSFER_DST_BIT,
        .preTransform = can.currentTransform,
        .compositeAlpha = opaque ? VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR : VK_COMPOSITE_ALPHA_INHERIT_BIT_KHR,
        .presentMode = choose_mode(*modes, shape.vsync),
        .clipped = VK_TRUE,
        .oldSwapchain = swapchain_.get(),
    };
    auto made =
        gpu_.make<VkSwapchainKHR>(vk_.vkCreateSwapchainKHR, vk_.vkDestroySwapchainKHR, info, "window");
    swapchain_ = {};  // retired, even where no other could be made
    if (!made) return tl::unexpected(made.error());
    swapchain_ = std::move(*made);

    VkSemaphoreCreateInfo semaphore{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
    auto renew = [&](Unique<VkSemaphore>& owner) -> Result<void> {
        return gpu_.make<VkSemaphore>(vk_.vkCreateSemaphore, vk_.vkDestroySemaphore, semaphore, "window")
            .map([&](Unique<VkSemaphore>&& fresh) { owner = std::move(fresh); });
    };
    const auto images = list_of<VkImage>("vkGetSwapchainImagesKHR", [&](uint32_t* count, VkImage* list) {
        return vk_.vkGetSwapchainImagesKHR(gpu_.device(), swapchain_.get(), count, list);
    });
    if (!images) return tl::unexpected(images.error());
    for (VkImage image : *images) {
        if (auto done = renew(images_.emplace_back(Image{image, {}}).drawn); !done) return done;
    }
    for (Unique<VkSemaphore>& free : free_) {
        if (free) continue;
        if (auto done = renew(free); !done) return done;
    }
    shape_ = shape;
    stale_ = false;
    return {};
}

Result<bool> Swapchain::acquire(const Shape& shape, size_t slot) {
    for (int i = 0; i < tries; ++i) {
        if (stale_ || shape != shape_) {
            if (auto made = make(shape); !made) return tl::unexpected(made.error());
            if (!swapchain_) return false;
        }
        Acquired taken{0, slot};
        const VkResult result = vk_.vkAcquireNextImageKHR(gpu_.device(), swapchain_.get(), patience_ns,
                                                          free_[slot].get(), VK_NULL_HANDLE, &taken.image);
        stale_ = result == VK_SUBOPTIMAL_KHR || result == VK_ERROR_OUT_OF_DATE_KHR;
        if (result == VK_SUCCESS || result == VK_SUBOPTIMAL_KHR) {
            acquired_ = taken;
            return true;
        }
        if (result == VK_TIMEOUT) return false;
        if (!stale_) return fail(result, "window", "vkAcquireNextImageKHR");
    }
    return false;
}

Result<void> Swapchain::record(VkCommandBuffer commands, const Texture& texture, bool vsync, size_t slot) {
    const rhi::Format format = texture.desc().format;
    const Shape shape{gpu_.window_size(), rhi::format_info(format).kind == rhi::FormatKind::srgb, vsync};
    if (failed_ || shape.window.width == 0 || shape.window.height == 0) return {};
    auto ready = acquire(shape, slot);
    if (!ready) {
        note(ready.error());
        return tl::unexpected(ready.error());
    }
    if (!*ready) return {};

    VkImageMemoryBarrier2 barrier{.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
                                  .srcStageMask = blit_stage,
                                  .dstStageMask = blit_stage,
                                  .dstAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT,
                                  .oldLayout = VK_IMAGE_LAYOUT_UNDEFINED,
                                  .newLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                                  .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                  .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                  .image = images_[acquired_->image].image,
                                  .subresourceRange = whole};
    VkDependencyInfo dependency{.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
                                .imageMemoryBarrierCount = 1,
                                .pImageMemoryBarriers = &barrier};
    vk_.vkCmdPipelineBarrier2(commands, &dependency);

    // Row 0 is the bottom of the picture, and the top of the window.
    const rhi::Extent& from = texture.desc().extent;
    const auto width = int32_t(extent_.width), height = int32_t(extent_.height);
    const VkImageSubresourceLayers layers{VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    VkImageBlit blit{.srcSubresource = layers,
                     .srcOffsets = {{}, {int32_t(from.width), int32_t(from.height), 1}},
                     .dstSubresource = layers,
                     .dstOffsets = {{0, height, 0}, {width, 0, 1}}};
    const bool stretched = from.width != extent_.width || from.height != extent_.height;
    const bool smooth = stretched && has(gpu_.format_caps(format), rhi::FormatCaps::linear_filter);
    vk_.vkCmdBlitImage(commands, texture.image(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, barrier.image,
                       VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &blit,
                       smooth ? VK_FILTER_LINEAR : VK_FILTER_NEAREST);

    barrier.srcAccessMask = std::exchange(barrier.dstAccessMask, VK_ACCESS_2_NONE);
    barrier.dstStageMask = VK_PIPELINE_STAGE_2_NONE;
    barrier.oldLayout = std::exchange(barrier.newLayout, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR);
    vk_.vkCmdPipelineBarrier2(commands, &dependency);
    return {};
}

std::optional<Swapchain::Semaphores> Swapchain::semaphores() const {
    if (!acquired_) return {};
    return Semaphores{
        submit_info(free_[acquired_->slot].get(), blit_stage),
        submit_info(images_[acquired_->image].drawn.get(), VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT)};
}

void Swapchain::drop() {
    if (!acquired_) return;
    // The image is given back with its swapchain; a semaphore that will be signalled cannot be used again.
    stale_ = true;
    free_[std::exchange(acquired_, {})->slot] = {};
}

VkResult Swapchain::present(bool ran) {
    if (!acquired_) return VK_SUCCESS;
    stale_ = stale_ || !ran;
    const uint32_t index = std::exchange(acquired_, {})->image;
    if (!ran) return VK_SUCCESS;
    const VkSemaphore drawn = images_[index].drawn.get();
    const VkSwapchainKHR swapchain = swapchain_.get();
    VkPresentInfoKHR info{.sType = VK_STRUCTURE_TYPE_PRESENT_INFO_KHR,
                          .waitSemaphoreCount = 1,
                          .pWaitSemaphores = &drawn,
                          .swapchainCount = 1,
                          .pSwapchains = &swapchain,
                          .pImageIndices = &index};
    const VkResult result = vk_.vkQueuePresentKHR(gpu_.queue(), &info);
    if (result == VK_SUBOPTIMAL_KHR || result == VK_ERROR_OUT_OF_DATE_KHR) {
        stale_ = true;
    } else if (result != VK_SUCCESS && result != VK_ERROR_DEVICE_LOST) {
        const Error error = fail(result, "window", "vkQueuePresentKHR").value();
        note(error);
        gpu_.instance().report({.severity = rhi::Severity::error, .id = "present", .text = to_string(error)});
    }
    return result == VK_ERROR_DEVICE_LOST ? result : VK_SUCCESS;
}

void Swapchain::note(const Error& error) {
    stale_ = true;
    failed_ = error.kind != ErrorKind::out_of_memory;
}

}  // namespace lumo::backends::vulkan
