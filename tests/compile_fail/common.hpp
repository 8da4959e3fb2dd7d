// What the cases share. Each case is one function that is right with LUMO_RIGHT defined and has one defect
// without.
#pragma once

#include "shaders/unit_shaders/everything.hpp"
#include "shaders/unit_shaders/raster.hpp"

namespace lumo {

using Raster = shaders::unit_shaders::raster;
using Everything = shaders::unit_shaders::everything;

struct Resources {
    rhi::View<rhi::Dimension::d2> color;
    rhi::View<rhi::Dimension::d2> shadow;
    rhi::View<rhi::Dimension::d2> hits;
    rhi::View<rhi::Dimension::d3> volume;
    rhi::SamplerHandle sampler;
    rhi::BufferSlice vertices;
};

}  // namespace lumo
