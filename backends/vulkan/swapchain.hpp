// The images of a window's surface, and the way of a picture into them.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "backends/vulkan/gpu.hpp"
#include "backends/vulkan/resources.hpp"
#include "rhi/backend.hpp"

namespace lumo::backends::vulkan {

/// Made when a picture is first presented, and anew whenever the window, the kind of picture or vsync changes.
/// Where memory runs out, the next picture is tried anew. After any other error nothing is shown any more, and
/// nothing said, while the device goes on.
class Swapchain {
  public:
    explicit Swapchain(const Gpu& gpu) : gpu_(gpu), vk_(gpu.vk()) {}

    /// Takes the window's next image and records a blit of the texture's mip 0 into it, the right way up.
    /// Nothing while the window shows nothing. `slot`: of the submission in flight, below max_in_flight.
    Result<void> record(VkCommandBuffer commands, const Texture& texture, bool vsync, size_t slot);
    /// What the submission of those commands waits for and signals; none where nothing was recorded.
    struct Semaphores {
        VkSemaphoreSubmitInfo free;
        VkSemaphoreSubmitInfo drawn;
    };
    std::optional<Semaphores> semaphores() const;
    /// Shows the image after that submission, or lets go of it where its commands did not run. Where nothing
    /// was recorded, nothing. What it returns is an error only for a lost device.
    VkResult present(bool ran);
    /// That submission never was: its semaphores were neither waited for nor signalled.
    void drop();

  private:
    struct Image {
        VkImage image;
        Unique<VkSemaphore> drawn;
    };
    /// What the images were made for.
    struct Shape {
        rhi::Extent window;
        bool srgb = false;
        bool vsync = true;

        bool operator==(const Shape&) const = default;
    };
    Result<void> make(const Shape& shape);
    /// False: the window cannot be drawn into now.
    Result<bool> acquire(const Shape& shape, size_t slot);
    void note(const Error& error);

    const Gpu& gpu_;
    const DeviceTable& vk_;
    Unique<VkSwapchainKHR> swapchain_;
    std::vector<Image> images_;
    std::array<Unique<VkSemaphore>, rhi::max_in_flight> free_;
    Shape shape_;
    VkExtent2D extent_{};
    bool stale_ = true;    ///< to be made anew
    bool failed_ = false;  ///< for good
    struct Acquired {
        uint32_t image;
        size_t slot;
    };
    std::optional<Acquired> acquired_;
};

}  // namespace lumo::backends::vulkan
