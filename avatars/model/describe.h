// describe_model() and describe_tri() describe a model or a .tri file as text for `throng info`.
// Invariant: the text contains everything read or ignored, but no absolute path.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "avatars/mesh/tri.h"
#include "avatars/model/model.h"

namespace throng {

/// Returns size, tree with joints and limits, parts, degrees of freedom and notes.
std::string describe_model(const Model& model);

/// Reads and describes a URDF even if meshes are missing; lists those at the end. Sets `complete`
/// to whether a scene could use the model. Throws InputError for a bad URDF.
std::string describe_urdf(const std::filesystem::path& file, bool& complete);

std::string describe_tri(const TriFile& tri, const std::string& file_name);

/// Returns the assumptions made for ambiguous URDFs, one per line, without duplicates.
std::vector<std::string> notes_on(std::span<const std::shared_ptr<const Model>> models);

}  // namespace throng
