// The work that `lumo bench rhi` gives to a device in more than one way: through lumo, and by calls straight to
// the API. Every way binds the same programs' code, changes as many bindings per call, and gets the same
// result.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "rhi/rhi.hpp"
#include "shaders/bench_rhi/mark.hpp"
#include "shaders/bench_rhi/step.hpp"

namespace lumo::program {

/// Between host and device.
enum class Transfer : uint8_t { buffer_upload, texture_upload, buffer_readback, texture_readback };
inline constexpr int transfer_count = 4;
/// A buffer of this size, or a texture of transfer_side by transfer_side texels of rgba8_unorm.
inline constexpr uint64_t transfer_bytes = uint64_t{16} << 20;
inline constexpr uint32_t transfer_side = 2048;

class RhiWork {
  public:
    virtual ~RhiWork() = default;

    // CPU seconds of the calling thread from opening to submitting; they wait for the device before they start
    // and before they return. Errors: those of the device.

    /// Each dispatch multiplies and adds into one of two buffers from the other, in turn, and so waits for the
    /// one before it.
    virtual Result<double> dispatches(uint32_t count) = 0;
    /// Each draw puts a small triangle into one target.
    virtual Result<double> draws(uint32_t count) = 0;
    /// What the last of each left behind: step_items words, then mark_side by mark_side texels.
    virtual Result<std::vector<std::byte>> outcome() = 0;

    /// Wall seconds until the device, or for a readback the host, has all bytes.
    virtual Result<double> transfer(Transfer what) = 0;
};

/// Through lumo. The device must outlive it.
Result<std::unique_ptr<RhiWork>> work_through_lumo(rhi::Device& device);
/// Straight to the API, beside a device of lumo's and of the same kind: a context on its display, which must be
/// current, or a Vulkan device of its own.
Result<std::unique_ptr<RhiWork>> work_straight_to_gl(const rhi::DeviceInfo& info);
Result<std::unique_ptr<RhiWork>> work_straight_to_vulkan(const rhi::DeviceInfo& info);

// -- what each call of any way is given

inline constexpr uint32_t step_items = 64;  ///< one work group
inline constexpr uint32_t mark_side = 64;   ///< texels of the target
inline constexpr uint32_t marks_across = 16;

constexpr shaders::bench_rhi::step::Push step_push(uint32_t call) {
    return {.factor = 2 * call + 3, .addend = call};
}

/// Triangles in rows of marks_across.
inline shaders::bench_rhi::mark::Push mark_push(uint32_t call) {
    const uint32_t x = call % marks_across, y = call / marks_across % marks_across;
    const auto place = [](uint32_t cell) { return (2 * float(cell) + 1) / float(marks_across) - 1; };
    return {.tint = glm::vec4(1, float(call % 7) / 7, float(call % 11) / 11, 1),
            .place = glm::vec2(place(x), place(y)),
            .scale = 1.0f / float(marks_across)};
}

/// Corners of the triangles: two sets, for calls with even and odd numbers, a slice each.
inline constexpr uint64_t corners_stride = 256;
std::vector<std::byte> corner_bytes();
/// Colours of the two textures of one texel, likewise.
inline constexpr uint8_t texture_colors[2][4] = {{255, 128, 64, 255}, {32, 200, 255, 255}};
/// The buffers that dispatches start from hold 0, 1, 2, …
std::vector<uint32_t> first_items();

/// Puts what several calls made into its places; the first of their errors stays.
struct Keep {
    Result<void> fine = {};

    template <class T>
    void operator()(T& place, Result<T> made) {
        if (made)
            place = *std::move(made);
        else if (fine)
            fine = tl::unexpected(made.error());
    }
};

/// CPU time of the calling thread since it was made.
class CpuTimer {
  public:
    CpuTimer() : start_(now()) {}
    double seconds() const { return now() - start_; }

  private:
    static double now();
    double start_;
};

double wall_seconds();

}  // namespace lumo::program
