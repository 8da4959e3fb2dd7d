// One logical device: which one it is, what it can do, and how objects are made on it.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "backends/surface.hpp"
#include "backends/vulkan/adopt.hpp"
#include "backends/vulkan/device_table.hpp"
#include "backends/vulkan/features.hpp"
#include "backends/vulkan/instance.hpp"
#include "rhi/device_info.hpp"
#include "rhi/error.hpp"
#include "rhi/format.hpp"

namespace lumo::backends::vulkan {

/// An object of a device, destroyed with its owner; a host's, which has no `destroy`, is left to the host.
template <class T>
class Unique {
  public:
    using Destroy = void(VKAPI_PTR*)(VkDevice, T, const VkAllocationCallbacks*);

    Unique() = default;
    Unique(VkDevice device, T object, Destroy destroy)
        : device_(device), object_(object), destroy_(destroy) {}
    Unique(Unique&& other) noexcept { swap(other); }
    Unique& operator=(Unique&& other) noexcept {
        Unique(std::move(other)).swap(*this);
        return *this;
    }
    ~Unique() {
        if (object_ && destroy_) destroy_(device_, object_, nullptr);
    }

    T get() const { return object_; }
    explicit operator bool() const { return object_ != VK_NULL_HANDLE; }

  private:
    void swap(Unique& other) noexcept {
        std::swap(device_, other.device_);
        std::swap(object_, other.object_);
        std::swap(destroy_, other.destroy_);
    }

    VkDevice device_ = VK_NULL_HANDLE;
    T object_ = VK_NULL_HANDLE;
    Destroy destroy_ = nullptr;
};

/// A host's handle out of the number that stands for it. Some are pointers, some are numbers, by platform.
template <class T>
T handle_of(uint64_t number) {
    if constexpr (std::is_pointer_v<T>) {
        return reinterpret_cast<T>(uintptr_t(number));
    } else {
        return number;
    }
}

/// What a failed call means to the caller; `call` says which.
tl::unexpected<Error> fail(VkResult result, std::string subject, std::string_view call);

struct Candidate;

class Gpu {
  public:
    /// The best device, or the one whose name holds desc.name; with a surface, one that presents to it. Errors:
    /// no_device (with what was found), unsupported (with what the device lacks).
    static Result<std::unique_ptr<Gpu>> create(const rhi::DeviceDesc& desc,
                                               std::shared_ptr<const Surface> surface);
    /// A host's. Errors: adopt_device's.
    static Result<std::unique_ptr<Gpu>> adopt(const HostDevice& host, const rhi::DeviceDesc& desc);
    ~Gpu();
    Gpu(const Gpu&) = delete;
    Gpu& operator=(const Gpu&) = delete;

    VkDevice device() const { return device_; }
    VkPhysicalDevice physical() const { return physical_; }
    VkQueue queue() const { return queue_; }
    uint32_t queue_family() const { return queue_family_; }
    const DeviceTable& vk() const { return table_; }
    const Instance& instance() const { return *instance_; }

    /// Null without a window.
    VkSurfaceKHR surface() const { return surface_; }
    rhi::Extent window_size() const { return window_->size(); }

    /// A host's, which is not destroyed.
    bool is_adopted() const { return adopted_; }
    const rhi::DeviceInfo& info() const { return info_; }
    rhi::FormatCaps format_caps(rhi::Format format) const { return format_caps_[size_t(format)]; }
    const VkPhysicalDeviceProperties& properties() const { return properties_; }
    uint32_t timestamp_bits() const { return timestamp_bits_; }
    bool has_push_descriptors() const { return push_descriptors_; }
    /// Those that are enabled.
    const Features& features() const { return features_; }
    rhi::MemoryBudget memory_budget() const;

    void set_name(VkObjectType type, uint64_t object, std::string_view name) const;

    /// Makes an object with one of the vkCreate functions. `name` is for errors, and for debuggers where the
    /// object's type is given.
    template <class T, class Info>
    Result<Unique<T>> make(VkResult(VKAPI_PTR* create)(VkDevice, const Info*, const VkAllocationCallbacks*,
                                                       T*),
                           typename Unique<T>::Destroy destroy, const Info& info, std::string_view name,
                           VkObjectType type = VK_OBJECT_TYPE_UNKNOWN) const {
        T object = VK_NULL_HANDLE;
        VkResult result = create(device_, &info, nullptr, &object);
        if (result != VK_SUCCESS) return fail(result, std::string(name), "its creation");
        if (type != VK_OBJECT_TYPE_UNKNOWN) set_name(type, uint64_t(object), name);
        return Unique<T>(device_, object, destroy);
    }

  private:
    Gpu() = default;
    void take(const Candidate& candidate, const rhi::DeviceDesc& desc);
    void query_formats();

    std::shared_ptr<const Surface> window_;
    std::unique_ptr<Instance> instance_;
    VkSurfaceKHR surface_ = VK_NULL_HANDLE;
    VkPhysicalDevice physical_ = VK_NULL_HANDLE;
    VkDevice device_ = VK_NULL_HANDLE;
    VkQueue queue_ = VK_NULL_HANDLE;
    DeviceTable table_{};
    VkPhysicalDeviceProperties properties_{};
    Features features_;
    rhi::DeviceInfo info_;
    std::array<rhi::FormatCaps, rhi::format_count> format_caps_{};
    uint32_t queue_family_ = 0;
    uint32_t timestamp_bits_ = 0;
    bool adopted_ = false;
    bool push_descriptors_ = false;
    bool budget_ = false;
};

/// What every physical device of an instance is.
std::vector<rhi::DeviceInfo> list_devices(const Instance& instance);

}  // namespace lumo::backends::vulkan
