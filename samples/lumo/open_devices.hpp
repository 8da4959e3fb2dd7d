// The devices that a command line asks for.
#pragma once

#include <vector>

#include "rhi/rhi.hpp"
#include "samples/lumo/options.hpp"

namespace lumo::program {

/// One by --api vulkan or gl, OpenGL's and then Vulkan's by both, that of the first API that has one if neither is
/// named. What fails a run (rhi::is_failure) is logged, and counted in `failures`, which outlives the devices. Errors:
/// those of create_device.
Result<std::vector<rhi::Device>> open_devices(const Options& options, int& failures);

}  // namespace lumo::program
