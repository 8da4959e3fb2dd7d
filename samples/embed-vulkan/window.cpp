#include "samples/embed-vulkan/window.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <algorithm>
#include <stdexcept>

namespace embed {

Window::Window(const std::string& title, uint32_t width, uint32_t height) {
    if (!glfwInit()) throw std::runtime_error("there is no window system; --headless does without");
    glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    glfwWindowHint(GLFW_RESIZABLE, GLFW_FALSE);
    window_ = glfwCreateWindow(int(width), int(height), title.c_str(), nullptr, nullptr);
    if (!window_) {
        glfwTerminate();
        throw std::runtime_error("the window could not be made");
    }
}

Window::~Window() {
    glfwDestroyWindow(window_);
    glfwTerminate();
}

std::span<const char* const> Window::instance_extensions() const {
    uint32_t count = 0;
    const char** names = glfwGetRequiredInstanceExtensions(&count);
    if (!names) throw std::runtime_error("this window system has no Vulkan surfaces");
    return {names, count};
}

VkSurfaceKHR Window::make_surface(VkInstance instance) const {
    VkSurfaceKHR surface = VK_NULL_HANDLE;
    check(glfwCreateWindowSurface(instance, window_, nullptr, &surface), "glfwCreateWindowSurface");
    return surface;
}

void Window::poll() { glfwPollEvents(); }

bool Window::should_close() const { return glfwWindowShouldClose(window_) != 0; }

WindowTarget::WindowTarget(const Window& window, const Host& host)
    : host_(host), surface_(window.make_surface(host.instance())) {
    VkBool32 presents = VK_FALSE;
    vkGetPhysicalDeviceSurfaceSupportKHR(host.physical_device(), host.queue_family(), surface_, &presents);
    if (!presents) throw std::runtime_error("the device cannot show pictures in this window");
    VkSurfaceCapabilitiesKHR capabilities;
    check(vkGetPhysicalDeviceSurfaceCapabilitiesKHR(host.physical_device(), surface_, &capabilities),
          "vkGetPhysicalDeviceSurfaceCapabilitiesKHR");
    extent_ = capabilities.currentExtent;
    if (extent_.width == UINT32_MAX) extent_ = {host.width(), host.height()};
    uint32_t count = 64;
    std::vector<VkSurfaceFormatKHR> formats(count);
    vkGetPhysicalDeviceSurfaceFormatsKHR(host.physical_device(), surface_, &count, formats.data());
    formats.resize(count);
    // The picture's values are encoded; a blit between sRGB formats leaves them as they are.
    const auto format = std::find_if(formats.begin(), formats.end(), [](const VkSurfaceFormatKHR& f) {
        return f.format == VK_FORMAT_B8G8R8A8_SRGB || f.format == VK_FORMAT_R8G8B8A8_SRGB;
    });
    if (format == formats.end()) throw std::runtime_error("the window has no sRGB format");
    const VkSwapchainCreateInfoKHR info{
        .sType = VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR,
        .surface = surface_,
        .minImageCount = std::max(capabilities.minImageCount, 2u),
        .imageFormat = format->format,
        .imageColorSpace = format->colorSpace,
        .imageExtent = extent_,
        .imageArrayLayers = 1,
        .imageUsage = VK_IMAGE_USAGE_TRANSFER_DST_BIT,
        .preTransform = capabilities.currentTransform,
        .compositeAlpha = VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR,
        .presentMode = VK_PRESENT_MODE_FIFO_KHR,
    };
    check(vkCreateSwapchainKHR(host.device(), &info, nullptr, &swapchain_), "vkCreateSwapchainKHR");
    vkGetSwapchainImagesKHR(host.device(), swapchain_, &count, nullptr);
    images_.resize(count);
    vkGetSwapchainImagesKHR(host.device(), swapchain_, &count, images_.data());
    const VkSemaphoreCreateInfo semaphore{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
    check(vkCreateSemaphore(host.device(), &semaphore, nullptr, &free_), "vkCreateSemaphore");
    drawn_.resize(images_.size());
    for (VkSemaphore& drawn : drawn_)
        check(vkCreateSemaphore(host.device(), &semaphore, nullptr, &drawn), "vkCreateSemaphore");
}

WindowTarget::~WindowTarget() {
    vkDeviceWaitIdle(host_.device());
    for (VkSemaphore drawn : drawn_) vkDestroySemaphore(host_.device(), drawn, nullptr);
    vkDestroySemaphore(host_.device(), free_, nullptr);
    vkDestroySwapchainKHR(host_.device(), swapchain_, nullptr);
    vkDestroySurfaceKHR(host_.instance(), surface_, nullptr);
}

void WindowTarget::show(Host& host) {
    uint32_t index = 0;
    const VkResult acquired =
        vkAcquireNextImageKHR(host.device(), swapchain_, UINT64_MAX, free_, VK_NULL_HANDLE, &index);
    if (acquired != VK_SUBOPTIMAL_KHR) check(acquired, "vkAcquireNextImageKHR");
    host.run(
        [&](VkCommandBuffer commands) {
            transition(commands, images_[index], VK_IMAGE_ASPECT_COLOR_BIT, VK_IMAGE_LAYOUT_UNDEFINED,
                       VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
            const VkImageSubresourceLayers color{VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
            const VkImageBlit whole{.srcSubresource = color,
                                    .srcOffsets = {{}, {int32_t(host.width()), int32_t(host.height()), 1}},
                                    .dstSubresource = color,
                                    .dstOffsets = {{}, {int32_t(extent_.width), int32_t(extent_.height), 1}}};
            vkCmdBlitImage(commands, host.picture().image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                           images_[index], VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &whole, VK_FILTER_LINEAR);
            transition(commands, images_[index], VK_IMAGE_ASPECT_COLOR_BIT,
                       VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR);
        },
        free_, drawn_[index]);
    const VkPresentInfoKHR info{.sType = VK_STRUCTURE_TYPE_PRESENT_INFO_KHR,
                                .waitSemaphoreCount = 1,
                                .pWaitSemaphores = &drawn_[index],
                                .swapchainCount = 1,
                                .pSwapchains = &swapchain_,
                                .pImageIndices = &index};
    const VkResult presented = vkQueuePresentKHR(host.queue(), &info);
    if (presented != VK_SUBOPTIMAL_KHR) check(presented, "vkQueuePresentKHR");
    host.finish();
}

}  // namespace embed
