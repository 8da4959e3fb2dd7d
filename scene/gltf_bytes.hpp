// The bytes that a glTF document refers to: buffers and encoded images. A part of the loader.
#pragma once

#include <cstddef>
#include <filesystem>
#include <list>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "rhi/error.hpp"
#include "scene/gltf_document.hpp"
#include "scene/limits.hpp"

namespace lumo::scene::gltf {

/// "%20" as " ". Errors (without subject): invalid_file, where a % is not followed by two hexadecimal digits.
Result<std::string> percent_decoded(std::string_view text);

/// Base64 with its padding, RFC 4648. Errors (without subject): invalid_file.
Result<std::vector<std::byte>> base64_decoded(std::string_view text);

/// The regular file that a relative URI names, inside folder even after symlinks are followed. Errors
/// (without subject): io, invalid_file, unsupported (another scheme, as http:).
Result<std::filesystem::path> resolve_uri(const std::filesystem::path& folder, std::string_view uri);

/// Everything that a document's URIs, GLB chunk and buffer views stand for. Each file is read once.
class Bytes {
  public:
    /// Reads all buffers and checks all buffer views against them. The document outlives the object. Errors:
    /// io, invalid_file, unsupported, limit.
    static Result<Bytes> load(Document& document, const Limits& limits);

    /// The bytes of a buffer view. Errors: invalid_file, where its buffer has no data.
    Result<std::span<const std::byte>> view(int index) const;

    /// An image's encoded bytes, valid until the next call. Errors: those of load.
    Result<std::span<const std::byte>> image(size_t index);

  private:
    Bytes(Document& document, const Limits& limits) : document_(&document), left_(limits.max_buffer_bytes) {}

    Result<void> load_buffer(size_t index);
    Result<void> check_view(size_t index) const;
    Result<std::vector<std::byte>> from_uri(const std::string& uri, std::string_view where,
                                            std::span<const std::string_view> mime_types);

    Document* document_;
    uint64_t left_;  // of the limit
    std::map<std::filesystem::path, std::vector<std::byte>> files_;
    std::list<std::vector<std::byte>> embedded_;
    std::vector<std::optional<std::span<const std::byte>>> buffers_;
    std::vector<std::byte> image_;
};

}  // namespace lumo::scene::gltf
