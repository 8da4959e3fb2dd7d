#include "techniques/cones/pattern_mean.hpp"

#include "rhi/keep.hpp"

namespace lumo::cones {

using rhi::Dimension;

Result<PatternMean> PatternMean::create(rhi::Device& device, const std::string& name, rhi::Extent size) {
    PatternMean made;
    made.size_ = size;
    return device
        .create_texture({.name = name,
                         .format = rhi::Format::rgba32_float,
                         .extent = size,
                         .usage = rhi::TextureUsage::sampled | rhi::TextureUsage::storage})
        .map(keep(made.gathered_))
        .and_then([&] {
            return device
                .create_sampler(
                    {.magnification = rhi::FilterMode::nearest, .minification = rhi::FilterMode::nearest})
                .map(keep(made.point_sampler_));
        })
        .and_then([&] {
            return device.create_compute_pipeline<shaders::cones::smooth_pattern>().map(keep(made.pipeline_));
        })
        .map([&] { return std::move(made); });
}

void PatternMean::record(rhi::Pass& pass, const gbuffer::View& gbuffer, float reach,
                         rhi::View<Dimension::d2> mean) const {
    pass.dispatch(pipeline_,
                  {.gathered = {gathered(), point_sampler_},
                   .depth = {gbuffer.depth, point_sampler_},
                   .normal_roughness = {gbuffer.normal_roughness, point_sampler_},
                   .geometric_normal_occlusion = {gbuffer.geometric_normal_occlusion, point_sampler_},
                   .camera = gbuffer.camera,
                   .smoothed = mean},
                  {.reach = reach}, rhi::groups_for(size_, {8, 8}));
}

}  // namespace lumo::cones
