// Files as bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <span>
#include <vector>

#include "rhi/error.hpp"

namespace lumo::scene {

/// The whole of a regular file (never a folder, device or pipe). Errors: io, limit (more than max_bytes).
Result<std::vector<std::byte>> read_file(const std::filesystem::path& file,
                                         uint64_t max_bytes = std::numeric_limits<uint64_t>::max());

/// Makes or replaces a file. What could not be written in full is removed. Errors: io.
Result<void> write_file(const std::filesystem::path& file, std::span<const std::byte> bytes);

}  // namespace lumo::scene
