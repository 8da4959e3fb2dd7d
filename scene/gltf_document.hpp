// A glTF file taken apart and checked, before anything is made of it. A part of the loader.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <tiny_gltf.h>
#include <vector>

#include "rhi/error.hpp"
#include "scene/gltf_warnings.hpp"
#include "scene/limits.hpp"

namespace lumo::scene::gltf {

struct BufferSource {
    std::optional<std::string> uri;  ///< none: a GLB's binary chunk
    uint64_t byte_length = 0;
};

struct ImageSource {
    std::string name;
    std::optional<std::string> uri;  ///< none: in a buffer view
    std::string mime_type;
    int buffer_view = -1;
};

struct Document {
    std::string file;  ///< as errors name it
    std::filesystem::path folder;
    /// Of its schema by check_document. Without buffers and images, which tinygltf would open and decode
    /// without limits, and without animations and skins.
    tinygltf::Model model;
    std::vector<BufferSource> buffers;
    std::vector<ImageSource> images;
    std::vector<std::byte> bytes;                            ///< the file
    std::optional<std::span<const std::byte>> binary_chunk;  ///< in bytes
    Warnings warnings;
};

/// Reads a .gltf or .glb file. Errors: those of load_gltf.
Result<Document> read_document(const std::filesystem::path& file, const Limits& limits);

}  // namespace lumo::scene::gltf
