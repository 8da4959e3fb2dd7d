// Typed elements out of buffers. A part of the loader.
#pragma once

#include <cstdint>
#include <vector>

#include "rhi/error.hpp"
#include "scene/gltf_bytes.hpp"
#include "scene/gltf_document.hpp"
#include "scene/limits.hpp"

namespace lumo::scene::gltf {

/// Checks every accessor of the document: that its elements, and those of its sparse form, lie inside their
/// buffer views, and that nothing but zeros is too many. Errors: invalid_file, limit. Misalignment is a
/// warning.
Result<void> check_accessors(Document& document, const Limits& limits);

/// Warns of accessors, used or not, whose numbers are not finite or not within their own min and max; of a
/// document with very many elements only the first accessors are looked at.
void check_values(Document& document, const Bytes& bytes);

/// How many numbers an element has: 1 for SCALAR to 16 for MAT4.
uint32_t component_count(const tinygltf::Accessor& accessor);

/// All elements as floats, component_count of each, matrices by columns, normalized integers as glTF 2.0,
/// section 3.6.2.2 ("Accessor Data Types") converts them. Errors: invalid_file (also where a number is not
/// finite, which names accessor and element).
Result<std::vector<float>> read_floats(const Document& document, const Bytes& bytes, int accessor);

/// The elements of a SCALAR accessor of unsigned integers. Errors: invalid_file.
Result<std::vector<uint32_t>> read_indices(const Document& document, const Bytes& bytes, int accessor);

}  // namespace lumo::scene::gltf
