#include "analysis/studies/study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "analysis/studies/study_options.h"
#include "base/errors.h"
#include "base/random.h"
#include "base/text.h"
#include "scenes/file/scene_fields.h"
#include "scenes/file/scene_keys.h"

namespace throng {
namespace {

namespace fs = std::filesystem;

constexpr Range kAnyNumber{-1e15, 1e15};
constexpr const char* kHypercube = "latin_hypercube";

YamlNode scalar(std::string text, int line) {
  YamlNode node;
  node.kind = YamlNode::Kind::kScalar;
  node.line = line;
  node.scalar = std::move(text);
  return node;
}

/// Formats a number without the rounding digits of steps such as 0.1.
std::string number_text(double value) { return fmt::format("{:.12g}", value + 0.0); }

std::vector<YamlNode> range_values(const Fields& range) {
  range.expect_keys({"from", "to", "step"});
  const double from = range.number("from", kAnyNumber), to = range.number("to", kAnyNumber);
  if (to < from)
    throw InputError(range.where(), "a range with 'to' from 'from' on",
                     fmt::format("{} to {}", number_text(from), number_text(to)));
  const double step = range.number("step", {0, 1e15, true});
  // The tolerance keeps `to` as the last value in spite of rounding.
  const double count = std::floor((to - from) / step + 1e-9) + 1;
  if (!(count <= static_cast<double>(kMaxStudyRuns)))
    throw InputError(range.where(), fmt::format("at most {} values", kMaxStudyRuns),
                     fmt::format("{:.6g}", count));
  std::vector<YamlNode> values;
  for (int64_t i = 0; i < static_cast<int64_t>(count); ++i)
    values.push_back(scalar(number_text(from + static_cast<double>(i) * step), range.line()));
  return values;
}

std::vector<YamlNode> values_of(const std::string& file, const std::string& name,
                                const YamlNode& node) {
  if (node.kind == YamlNode::Kind::kMap)
    return range_values(Fields(file, node, fmt::format("'{}', a list or a range", name)));
  if (node.kind != YamlNode::Kind::kList || node.items.empty())
    throw InputError(at_line(file, node.line),
                     fmt::format("a list of values of '{}', or a range {{from, to, step}}", name),
                     describe(node));
  std::set<std::string> names;
  for (const YamlNode& item : node.items)
    if (!names.insert(text_of(item)).second)
      throw InputError(at_line(file, item.line), fmt::format("each value of '{}' once", name),
                       fmt::format("'{}' twice", text_of(item)));
  return node.items;
}

StudyParameter parameter_of(const std::string& file, const YamlEntry& entry) {
  const std::string where = at_line(file, entry.line);
  const std::string& name = entry.key;
  if (name.empty() || name.front() == '.' || name.back() == '.' ||
      name.find("..") != std::string::npos)
    throw InputError(where, "an option of a run, or a key of a scene as in 'groups.1.count'",
                     fmt::format("'{}'", name));
  if (const std::string expected = reason_not_in_study(name); !expected.empty())
    throw InputError(where, expected, fmt::format("'{}'", name));
  const std::vector<std::string>& options = study_option_names();
  return {name, entry.line, std::find(options.begin(), options.end(), name) != options.end()};
}

/// Random permutation of `count` strata for one parameter (Fisher and Yates).
std::vector<size_t> strata(size_t count, uint64_t seed, uint64_t key) {
  std::vector<size_t> order(count);
  std::iota(order.begin(), order.end(), size_t{0});
  for (size_t i = count; i > 1; --i) {
    const double at = random_uniform({seed, key, i, Purpose::kStudy});
    std::swap(order[i - 1], order[static_cast<size_t>(at * static_cast<double>(i))]);
  }
  return order;
}

struct HypercubeParameter {
  std::vector<YamlNode> choices;  ///< values of a list; empty: a range of numbers
  double from = 0, to = 0;
  bool integer = false;
  int line = 0;

  /// Value at a share of the range in [0, 1).
  YamlNode at(double share) const {
    if (!choices.empty())
      return choices[static_cast<size_t>(share * static_cast<double>(choices.size()))];
    if (integer)
      return scalar(fmt::format("{:.0f}", from + std::floor(share * (to - from + 1))), line);
    return scalar(fmt::format("{:.9g}", from + share * (to - from) + 0.0), line);
  }
};

HypercubeParameter hypercube_parameter(const std::string& file, const std::string& name,
                                       const YamlNode& node) {
  HypercubeParameter parameter;
  parameter.line = node.line;
  if (node.kind == YamlNode::Kind::kList) {
    parameter.choices = values_of(file, name, node);
    return parameter;
  }
  const Fields range(file, node, fmt::format("'{}', a range {{from, to}} or a list", name));
  range.expect_keys({"from", "to", "integer"});
  parameter.from = range.number("from", kAnyNumber);
  parameter.to = range.number("to", kAnyNumber);
  parameter.integer = range.boolean_or("integer", false);
  if (!(parameter.from < parameter.to))
    throw InputError(
        range.where(), "a range with 'to' above 'from'",
        fmt::format("{} to {}", number_text(parameter.from), number_text(parameter.to)));
  if (parameter.integer &&
      (parameter.from != std::floor(parameter.from) || parameter.to != std::floor(parameter.to)))
    throw InputError(
        range.where(), "integers 'from' and 'to'",
        fmt::format("{} to {}", number_text(parameter.from), number_text(parameter.to)));
  return parameter;
}

/// Each parameter has one value in each of its strata (McKay, Beckman and Conover 1979).
ParameterBlock hypercube(const std::string& file, const YamlNode& node) {
  const Fields fields(file, node, "a Latin hypercube");
  fields.expect_keys({"samples", "seed", "parameters"});
  fields.require("samples");
  const auto samples =
      static_cast<size_t>(fields.integer_or("samples", 1, static_cast<int64_t>(kMaxStudyRuns), 1));
  const auto seed = static_cast<uint64_t>(fields.integer_or("seed", 0, INT64_MAX, 1));
  const Fields parameters(file, fields.require("parameters"),
                          "the parameters of a Latin hypercube");
  if (parameters.node().entries.empty())
    throw InputError(parameters.where(), "at least one parameter", "none");
  if (samples * parameters.node().entries.size() > kMaxStudyRuns)
    throw InputError(fields.where(), fmt::format("at most {} values in all", kMaxStudyRuns),
                     "more");
  ParameterBlock block;
  block.rows.resize(samples);
  for (const YamlEntry& entry : parameters.node().entries) {
    const HypercubeParameter parameter = hypercube_parameter(file, entry.key, entry.value);
    const uint64_t id = block.parameters.size();
    block.parameters.push_back(parameter_of(file, entry));
    const std::vector<size_t> order = strata(samples, seed, id);
    for (size_t i = 0; i < samples; ++i) {
      const double within = random_uniform({seed, id, i, Purpose::kStudy}, 1);
      block.rows[i].push_back(
          parameter.at((static_cast<double>(order[i]) + within) / static_cast<double>(samples)));
    }
  }
  return block;
}

void require_few_runs(const Fields& fields, const Study& study, size_t min_points) {
  if (study.points() * min_points > kMaxStudyRuns)
    throw InputError(fields.where(), fmt::format("at most {} runs", kMaxStudyRuns), "more");
}

void read_parameters(const Fields& fields, Study& study) {
  const YamlNode* node = fields.find("parameters");
  if (node == nullptr) return;
  const Fields parameters(fields.file(), *node, "parameters");
  for (const YamlEntry& entry : node->entries) {
    require_few_runs(parameters, study, 1);
    if (entry.key == kHypercube) {
      study.blocks.push_back(hypercube(fields.file(), entry.value));
      continue;
    }
    ParameterBlock& block = study.blocks.emplace_back();
    block.parameters.push_back(parameter_of(fields.file(), entry));
    for (YamlNode& value : values_of(fields.file(), entry.key, entry.value))
      block.rows.push_back({std::move(value)});
  }
}

/// Throws if a parameter is also set for all runs, or occurs twice.
void require_once(const Fields& fields, const Study& study) {
  std::set<std::string> names;
  for (const YamlEntry& option : study.options.entries) names.insert(option.key);
  for (const ParameterBlock& block : study.blocks)
    for (const StudyParameter& parameter : block.parameters)
      if (!names.insert(parameter.name).second)
        throw InputError(at_line(fields.file(), parameter.line), "every parameter once",
                         fmt::format("'{}' again", parameter.name));
}

StudyScene scene_named(const std::string& name, const fs::path& folder,
                       const std::vector<StudyScene>& scenes) {
  for (const StudyScene& scene : scenes)
    if (scene.name == name) return scene;
  fs::path named = name;
  if (named.has_parent_path() || named.has_extension()) named = folder / named;
  const fs::path file = scene_file(named.string());
  return {name, file, parse_yaml(read_text_file(file, kMaxYamlBytes), file.string())};
}

void read_scenes(const Fields& fields, const std::vector<StudyScene>& scenes, Study& study) {
  for (const YamlNode* item : fields.items("scenes", true)) {
    const std::string where = fields.where(*item);
    if (item->kind != YamlNode::Kind::kScalar)
      throw InputError(where, "a scene file or the name of a bundled scene", describe(*item));
    if (const std::string defect = defect_of_name(item->scalar); !defect.empty())
      throw InputError(where, "the name of a scene", defect);
    for (const StudyScene& earlier : study.scenes)
      if (earlier.name == item->scalar)
        throw InputError(where, "every scene once", fmt::format("'{}' again", item->scalar));
    try {
      study.scenes.push_back(scene_named(item->scalar, study.file.parent_path(), scenes));
    } catch (const InputError& error) {
      throw InputError(where, "a scene", fmt::format("'{}' ({})", item->scalar, error.what()));
    }
  }
}

void read_seeds(const Fields& fields, Study& study) {
  const YamlNode* node = fields.find("seeds");
  if (node == nullptr) return;
  YamlNode one;
  one.kind = YamlNode::Kind::kMap;
  for (YamlNode& value : values_of(fields.file(), "seeds", *node)) {
    one.entries = {{"seeds", value.line, value}};
    study.seeds.push_back(Fields(fields.file(), one, "seeds").integer_or("seeds", 0, INT64_MAX, 1));
  }
}

void read_options(const Fields& fields, Study& study) {
  study.options.kind = YamlNode::Kind::kMap;
  study.options.line = fields.line();
  const std::vector<std::string>& names = study_option_names();
  for (const YamlEntry& entry : fields.node().entries)
    if (std::find(names.begin(), names.end(), entry.key) != names.end())
      study.options.entries.push_back(entry);
  read_study_options(Fields(fields.file(), study.options, "options of a run"));
}

}  // namespace

size_t Study::points() const {
  size_t count = 1;
  for (const ParameterBlock& block : blocks) {
    if (count > kMaxStudyRuns) return count;
    count *= block.rows.size();
  }
  return count;
}

std::string text_of(const YamlNode& value) {
  switch (value.kind) {
    case YamlNode::Kind::kNull:
      return "";
    case YamlNode::Kind::kScalar:
      return value.scalar;
    case YamlNode::Kind::kList: {
      std::string text;
      for (const YamlNode& item : value.items) text += (text.empty() ? "" : ", ") + text_of(item);
      return "[" + text + "]";
    }
    case YamlNode::Kind::kMap: {
      std::string text;
      for (const YamlEntry& entry : value.entries)
        text += (text.empty() ? "" : ", ") + entry.key + ": " + text_of(entry.value);
      return "{" + text + "}";
    }
  }
  return "";
}

Study read_study(const fs::path& file) {
  return parse_study(read_text_file(file, kMaxYamlBytes), file);
}

Study parse_study(const std::string& text, const fs::path& file,
                  const std::vector<StudyScene>& scenes) {
  const std::string name = file.string();
  const YamlNode root = parse_yaml(text, name);
  const Fields fields(name, root, "a study");
  std::vector<std::string> keys = {"scenes", "seeds", "parameters"};
  keys.insert(keys.end(), study_option_names().begin(), study_option_names().end());
  for (const YamlEntry& entry : root.entries)
    if (const std::string expected = reason_not_in_study(entry.key); !expected.empty())
      throw InputError(at_line(name, entry.line), expected, fmt::format("'{}'", entry.key));
  fields.expect_keys(keys);
  Study study;
  study.file = file;
  read_options(fields, study);
  read_seeds(fields, study);
  read_parameters(fields, study);
  require_once(fields, study);
  read_scenes(fields, scenes, study);
  require_few_runs(fields, study, study.runs() / study.points());
  return study;
}

}  // namespace throng
