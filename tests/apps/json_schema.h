// A small validator for the words of JSON Schema that scenes/scene.schema.json uses.
// One rule: a word it does not know is a fault of the schema, never passed over.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace throng {

/// What is wrong with a document, a line each: where, and which word it offends. Empty: it is
/// valid.
std::vector<std::string> faults_of(const nlohmann::json& document, const nlohmann::json& schema);

}  // namespace throng
