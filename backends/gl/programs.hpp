// From the GLSL of a ProgramInfo to a linked program object.
#pragma once

#include <epoxy/gl.h>
#include <span>

#include "rhi/device_info.hpp"
#include "rhi/disk_cache.hpp"
#include "rhi/error.hpp"
#include "rhi/program.hpp"

namespace lumo::backends::gl {

/// Compiles and links with specialization constants set to `options`, 32-bit values in the order of
/// ProgramInfo::options, or takes the driver's binary of an earlier run from `cache`. Error: shader, with the
/// driver's log.
Result<GLuint> make_program(const rhi::ProgramInfo& info, std::span<const uint32_t> options,
                            const rhi::DeviceInfo& device, const rhi::DiskCache& cache);

}  // namespace lumo::backends::gl
