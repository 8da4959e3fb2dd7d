// The work through lumo, and what all ways share.
#include "samples/lumo/bench/rhi_work.hpp"

#include <chrono>
#include <cstring>
#include <ctime>
#include <numeric>
#include <utility>

namespace lumo::program {
namespace {

using shaders::bench_rhi::mark;
using shaders::bench_rhi::step;

class ThroughLumo final : public RhiWork {
  public:
    static Result<std::unique_ptr<RhiWork>> create(rhi::Device& device);

    Result<double> dispatches(uint32_t count) override;
    Result<double> draws(uint32_t count) override;
    Result<std::vector<std::byte>> outcome() override;
    Result<double> transfer(Transfer what) override;

  private:
    explicit ThroughLumo(rhi::Device& device) : device_(device) {}

    /// Runs `record` on commands of their own and waits for them.
    template <class Record>
    Result<double> timed(Record record) {
        // Its context is current from here on, where there is such a thing.
        (void)device_.finished({});
        const CpuTimer timer;
        rhi::Commands commands = device_.begin();
        record(commands);
        const rhi::Submission submission = device_.submit(std::move(commands));
        const double seconds = timer.seconds();
        return device_.wait(submission).map([&] { return seconds; });
    }

    rhi::Device& device_;
    rhi::ComputePipeline<step> step_;
    rhi::RasterPipeline<mark> mark_;
    rhi::Sampler sampler_;
    rhi::Texture pictures_[2], target_;
    rhi::Buffer items_[2], corners_;
    rhi::Buffer transfer_buffer_;
    rhi::Texture transfer_texture_;
    std::vector<std::byte> transfer_bytes_ = std::vector<std::byte>(transfer_bytes, std::byte{7});
};

Result<std::unique_ptr<RhiWork>> ThroughLumo::create(rhi::Device& device) {
    std::unique_ptr<ThroughLumo> made(new ThroughLumo(device));
    Keep keep;
    const auto texture = [&](const char* name, uint32_t side, rhi::TextureUsage usage) {
        return device.create_texture({.name = name, .extent = {side, side, 1}, .usage = usage});
    };
    const auto buffer = [&](const char* name, uint64_t size) {
        return device.create_buffer({.name = name, .size = size});
    };
    keep(made->step_, device.create_compute_pipeline<step>());
    keep(made->mark_, device.create_raster_pipeline<mark>({.color = {{.format = rhi::Format::rgba8_unorm}}}));
    keep(made->sampler_, device.create_sampler({.magnification = rhi::FilterMode::nearest,
                                                .minification = rhi::FilterMode::nearest,
                                                .mip = rhi::FilterMode::nearest}));
    for (rhi::Texture& picture : made->pictures_)
        keep(picture, texture("picture", 1, rhi::TextureUsage::sampled));
    keep(made->target_, texture("target", mark_side, rhi::TextureUsage::attachment));
    for (rhi::Buffer& items : made->items_) keep(items, buffer("items", step_items * sizeof(uint32_t)));
    keep(made->corners_, buffer("corners", 2 * corners_stride));
    keep(made->transfer_buffer_, buffer("transfer", transfer_bytes));
    keep(made->transfer_texture_, texture("transfer", transfer_side, rhi::TextureUsage::sampled));
    if (!keep.fine) return tl::unexpected(keep.fine.error());

    const std::vector<uint32_t> items = first_items();
    rhi::Commands commands = device.begin();
    {
        rhi::Pass pass = commands.pass("setup");
        for (int i = 0; i < 2; ++i) {
            pass.upload(made->items_[i].slice(), std::as_bytes(std::span(items)));
            pass.upload(made->pictures_[i], whole_mip(made->pictures_[i].desc()),
                        std::as_bytes(std::span(texture_colors[i])));
        }
        pass.upload(made->corners_.slice(), corner_bytes());
    }
    return device.wait(device.submit(std::move(commands))).map([&]() -> std::unique_ptr<RhiWork> {
        return std::move(made);
    });
}

Result<double> ThroughLumo::dispatches(uint32_t count) {
    return timed([&](rhi::Commands& commands) {
        rhi::Pass pass = commands.pass("dispatches");
        for (uint32_t i = 0; i < count; ++i) {
            const uint32_t odd = i % 2;
            pass.dispatch(step_,
                          {.picture = {pictures_[odd].view<rhi::Dimension::d2>(), sampler_},
                           .Source = items_[odd].slice(),
                           .Target = items_[1 - odd].slice()},
                          step_push(i), {});
        }
    });
}

Result<double> ThroughLumo::draws(uint32_t count) {
    return timed([&](rhi::Commands& commands) {
        rhi::RasterPass pass = commands.raster_pass("draws", {.color = {{.view = target_.view()}}});
        for (uint32_t i = 0; i < count; ++i) {
            const uint32_t odd = i % 2;
            pass.draw(mark_,
                      {.Corners = corners_.slice(odd * corners_stride, corners_stride),
                       .picture = {pictures_[odd].view<rhi::Dimension::d2>(), sampler_}},
                      mark_push(i), rhi::Draw{.vertices = 3});
        }
    });
}

Result<std::vector<std::byte>> ThroughLumo::outcome() {
    auto words = device_.download(items_[0].slice());
    if (!words) return words;
    return device_.download(target_, whole_mip(target_.desc())).map([&](const auto& texels) {
        words->insert(words->end(), texels.begin(), texels.end());
        return *std::move(words);
    });
}

Result<double> ThroughLumo::transfer(Transfer what) {
    (void)device_.finished({});
    const rhi::TextureRegion whole = whole_mip(transfer_texture_.desc());
    const double start = wall_seconds();
    const auto seconds = [&](auto&&...) { return wall_seconds() - start; };
    switch (what) {
        case Transfer::buffer_upload:
            return device_.upload(transfer_buffer_.slice(), transfer_bytes_).map(seconds);
        case Transfer::texture_upload:
            return device_.upload(transfer_texture_, whole, transfer_bytes_).map(seconds);
        case Transfer::buffer_readback:
            return device_.download(transfer_buffer_.slice()).map(seconds);
        case Transfer::texture_readback:
            return device_.download(transfer_texture_, whole).map(seconds);
    }
    return 0;
}

}  // namespace

Result<std::unique_ptr<RhiWork>> work_through_lumo(rhi::Device& device) {
    return ThroughLumo::create(device);
}

std::vector<std::byte> corner_bytes() {
    constexpr glm::vec4 corners[2][3] = {
        {glm::vec4(-1, -1, 0, 1), glm::vec4(1, -1, 0, 1), glm::vec4(-1, 1, 0, 1)},
        {glm::vec4(1, 1, 0, 1), glm::vec4(-1, 1, 0, 1), glm::vec4(1, -1, 0, 1)}};
    std::vector<std::byte> bytes(2 * corners_stride);
    for (size_t i = 0; i < 2; ++i)
        std::memcpy(bytes.data() + i * corners_stride, corners[i], sizeof corners[i]);
    return bytes;
}

std::vector<uint32_t> first_items() {
    std::vector<uint32_t> items(step_items);
    std::iota(items.begin(), items.end(), 0u);
    return items;
}

double CpuTimer::now() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return double(time.tv_sec) + double(time.tv_nsec) * 1e-9;
}

double wall_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace lumo::program
