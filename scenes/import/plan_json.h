// parse_plan_json() reads JSON with errors that name the line.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace throng {

using PlanJson = nlohmann::json;

/// Throws InputError "file:line: expected JSON, found ...".
PlanJson parse_plan_json(const std::string& text, const std::string& file);

/// A value as words after "found": "a list", "'text'".
std::string described_json(const PlanJson& value);

}  // namespace throng
