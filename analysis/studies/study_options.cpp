#include "analysis/studies/study_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <string_view>

#include "base/errors.h"

namespace throng {
namespace {

/// The value as on a command line; numeric options also accept YAML fractions.
std::string value_text(const Fields& fields, const RunOption& option, const YamlNode& node) {
  const bool is_text =
      option.kind == RunOption::Kind::kText || option.kind == RunOption::Kind::kWord;
  if (node.kind != YamlNode::Kind::kScalar || (node.quoted && !is_text))
    throw InputError(fields.where(node), option.expected, describe(node));
  const bool is_fraction =
      option.kind == RunOption::Kind::kNumber && node.scalar.find('/') != std::string::npos;
  return is_fraction ? fmt::format("{}", fields.number(option.name, {-1e300, 1e300})) : node.scalar;
}

}  // namespace

const std::vector<std::string>& study_option_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const RunOption& option : run_options())
      if (option.is_of_study) all.push_back(option.name);
    return all;
  }();
  return names;
}

std::string reason_not_in_study(const std::string& name) {
  for (const RunOption& option : run_options())
    if (option.name == name) return option.study_has;
  const std::span<const std::string_view> outputs = output_option_names();
  const bool is_output = std::find(outputs.begin(), outputs.end(), name) != outputs.end();
  return is_output ? kShapesNoResult : "";
}

RunOptions read_study_options(const Fields& fields) {
  fields.expect_keys(study_option_names());
  RunOptions options;
  for (const RunOption& option : run_options())
    if (const YamlNode* node = option.is_of_study ? fields.find(option.name) : nullptr)
      option.read(value_text(fields, option, *node), fields.where(*node), options);
  simulation_options(options);  // throws if the options contradict each other
  return options;
}

}  // namespace throng
