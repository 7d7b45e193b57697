// A validator for the keywords of JSON Schema that scenes/scene.schema.json uses.
// Invariant: an unknown keyword is a fault of the schema.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace throng {

/// Faults of a document, one line each: the place and the violated keyword. Empty if valid.
std::vector<std::string> faults_of(const nlohmann::json& document, const nlohmann::json& schema);

}  // namespace throng
