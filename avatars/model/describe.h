// What `throng info` says about a model or a .tri file, as text for a terminal.
// One rule: says what was read and what was not understood; never an absolute path.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "avatars/mesh/tri.h"
#include "avatars/model/model.h"

namespace throng {

/// Name, tree with joints and limits, parts with counts and sizes, notes, degrees of freedom. Lines
/// end in '\n'.
std::string describe_model(const Model& model);

/// Reads and describes a URDF even where meshes are missing: says which, at the end. `complete`
/// tells whether a scene could use the model. Throws InputError for a bad URDF.
std::string describe_urdf(const std::filesystem::path& file, bool& complete);

/// Dialect, counts, bounding box, closedness, volume.
std::string describe_tri(const TriFile& tri, const std::string& file_name);

/// What the URDFs of some models leave open and how it is read, a line each and none twice.
std::vector<std::string> notes_on(std::span<const std::shared_ptr<const Model>> models);

}  // namespace throng
