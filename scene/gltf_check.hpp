// The shape of a glTF document: which members its objects have, of which types and in which ranges.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "rhi/error.hpp"
#include "scene/gltf_warnings.hpp"
#include "scene/limits.hpp"

namespace lumo::scene::gltf {

/// Checks a document against glTF 2.0's schema, all references between its parts included, and brings it into
/// one form: integers written as 1.0 become integers, factors outside their range are clamped, members and
/// extensions that lumo does not know are erased, each with a warning. Afterwards every member that is
/// present has its type and range and every index points to something. file is the errors' subject.
Result<void> check_document(nlohmann::json& document, const std::string& file, const Limits& limits,
                            Warnings& warnings);

}  // namespace lumo::scene::gltf
