#include "analysis/studies/study_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <set>
#include <string_view>
#include <vector>

#include "base/checksum.h"
#include "base/errors.h"
#include "scenes/file/scene_fields.h"
#include "scenes/file/scene_keys.h"

namespace throng {
namespace {

const YamlNode* name_of_item(const YamlNode& item) {
  for (const YamlEntry& entry : item.entries)
    if (entry.key == "name" && entry.value.kind == YamlNode::Kind::kScalar) return &entry.value;
  return nullptr;
}

/// Sets all lines of a value to `line`, for errors that name the place in the study.
YamlNode moved_to(YamlNode value, int line) {
  value.line = line;
  for (YamlNode& item : value.items) item = moved_to(std::move(item), line);
  for (YamlEntry& entry : value.entries) {
    entry.line = line;
    entry.value = moved_to(std::move(entry.value), line);
  }
  return value;
}

class Setter {
 public:
  Setter(const std::string& path, const YamlNode& value, const std::string& where)
      : path_(path), value_(value), where_(where) {}

  void set(YamlNode& node, size_t from) const {
    if (from > path_.size()) {
      node = moved_to(value_, node.line);
      return;
    }
    const size_t dot = std::min(path_.find('.', from), path_.size());
    const std::string step = path_.substr(from, dot - from);
    if (node.kind == YamlNode::Kind::kNull) node.kind = YamlNode::Kind::kMap;
    if (node.kind == YamlNode::Kind::kMap)
      set(entry(node, step), dot + 1);
    else if (node.kind == YamlNode::Kind::kList)
      set_items(node, step, dot + 1);
    else
      throw InputError(where_, fmt::format("a map or a list before '{}' of '{}'", step, path_),
                       describe(node));
  }

 private:
  static YamlNode& entry(YamlNode& map, const std::string& key) {
    for (YamlEntry& entry : map.entries)
      if (entry.key == key) return entry.value;
    YamlNode fresh;
    fresh.line = map.line;
    return map.entries.emplace_back(YamlEntry{key, map.line, fresh}).value;
  }

  void set_items(YamlNode& list, const std::string& step, size_t from) const {
    bool found = false;
    size_t number = 0;
    const auto [end, error] = std::from_chars(step.data(), step.data() + step.size(), number);
    const bool is_number = error == std::errc() && end == step.data() + step.size();
    for (size_t i = 0; i < list.items.size(); ++i) {
      const YamlNode* name = name_of_item(list.items[i]);
      const bool is_named = name != nullptr && name->scalar == step;
      if (step != "*" && !is_named && !(is_number && number == i + 1)) continue;
      set(list.items[i], from);
      found = true;
    }
    if (!found) reject(list, step);
  }

  [[noreturn]] void reject(const YamlNode& list, const std::string& step) const {
    std::vector<std::string> names;
    for (const YamlNode& item : list.items)
      if (const YamlNode* name = name_of_item(item)) names.push_back(name->scalar);
    throw InputError(
        where_,
        fmt::format("in '{}' the number of an item, 1 to {}, '*' for all{}{}", path_,
                    list.items.size(), names.empty() ? "" : ", or one of ", list_of(names)),
        fmt::format("'{}'{}", step, did_you_mean(step, names)));
  }

  const std::string& path_;
  const YamlNode& value_;
  const std::string& where_;
};

/// Sets a value in a scene file by its path, for example "groups.1.desired_speed_mps.mean". A step
/// is a key of a map (added if absent; the scene's reader validates it) or selects items of a list
/// by number from 1, by `name` or by "*" for all. Throws InputError at `where` if a step does not
/// exist.
void set_value(YamlNode& root, const std::string& path, const YamlNode& value,
               const std::string& where) {
  Setter(path, value, where).set(root, 0);
}

void put(YamlNode& map, const StudyParameter& parameter, const YamlNode& value) {
  map.entries.push_back({parameter.name, parameter.line, value});
  // Errors in the value name the study's line.
  map.entries.back().value.line = parameter.line;
}

}  // namespace

StudyPlan::StudyPlan(Study study) : study_(std::move(study)) {
  Hasher hash;
  hash.add("throng study 1").add(uint64_t{study_.seeds.size()});
  for (const int64_t seed : study_.seeds) hash.add(static_cast<uint64_t>(seed));
  for (const std::string& column : columns()) hash.add(column);
  const size_t points = study_.points();
  std::set<std::string> noted;
  for (size_t scene = 0; scene < study_.scenes.size(); ++scene) {
    hash.add(study_.scenes[scene].name);
    for (size_t point = 0; point < points; ++point) {
      PlannedRun run;
      try {
        run = planned(scene, point, models_);
      } catch (const InputError&) {
        rethrow_at_value(scene, point);
      }
      if (study_.seeds.empty()) own_seeds_.push_back(run.scene.seed);
      for (std::string& note : run.notes)
        if (noted.insert(note).second) notes_.push_back(std::move(note));
      hash.add(content_hash_of(run.scene)).add(run.scene.duration_s);
      hash.add(name_of(run.strategy)).add(run.culler.budget_tests.value_or(UINT64_MAX));
      const std::vector<size_t> rows = rows_of(point);
      for (size_t i = 0; i < rows.size(); ++i)
        for (const YamlNode& value : study_.blocks[i].rows[rows[i]]) hash.add(text_of(value));
    }
  }
  identity_ = hash.value();
}

std::vector<std::string> StudyPlan::columns() const {
  std::vector<std::string> names = {"run", "runs", "study", "scene", "seed"};
  for (const YamlEntry& option : study_.options.entries) names.push_back(option.key);
  for (const ParameterBlock& block : study_.blocks)
    for (const StudyParameter& parameter : block.parameters) names.push_back(parameter.name);
  return names;
}

std::vector<std::string> StudyPlan::cells(size_t run) const {
  const RunPosition position = position_of(run);
  const uint64_t seed = study_.seeds.empty()
                            ? own_seeds_[position.scene * study_.points() + position.point]
                            : static_cast<uint64_t>(study_.seeds[position.seed]);
  std::vector<std::string> cells = {fmt::format("{}", run + 1), fmt::format("{}", runs()),
                                    fmt::format("{:016x}", identity_),
                                    study_.scenes[position.scene].name, fmt::format("{}", seed)};
  for (const YamlEntry& option : study_.options.entries) cells.push_back(text_of(option.value));
  const std::vector<size_t> rows = rows_of(position.point);
  for (size_t i = 0; i < rows.size(); ++i)
    for (const YamlNode& value : study_.blocks[i].rows[rows[i]]) cells.push_back(text_of(value));
  return cells;
}

StudyPlan::RunPosition StudyPlan::position_of(size_t run) const {
  const size_t seeds = study_.seeds.empty() ? 1 : study_.seeds.size();
  const size_t points = study_.points();
  return {run / seeds / points, run / seeds % points, run % seeds};
}

/// Row of each block at a point; the last block changes fastest.
std::vector<size_t> StudyPlan::rows_of(size_t point) const {
  std::vector<size_t> rows(study_.blocks.size());
  for (size_t i = rows.size(); i-- > 0;) {
    rows[i] = point % study_.blocks[i].rows.size();
    point /= study_.blocks[i].rows.size();
  }
  return rows;
}

PlannedRun StudyPlan::planned(size_t scene, size_t point, LoadedModels& models) const {
  const StudyScene& source = study_.scenes[scene];
  const std::string file = study_.file.string();
  YamlNode tree = source.tree;
  YamlNode options = study_.options;
  const std::vector<size_t> rows = rows_of(point);
  for (size_t i = 0; i < rows.size(); ++i) {
    const ParameterBlock& block = study_.blocks[i];
    for (size_t k = 0; k < block.parameters.size(); ++k) {
      const YamlNode& value = block.rows[rows[i]][k];
      if (block.parameters[k].is_option)
        put(options, block.parameters[k], value);
      else
        set_value(tree, block.parameters[k].name, value, at_line(file, block.parameters[k].line));
    }
  }
  const RunOptions read = read_study_options(Fields(file, options, "options of a run"));
  const SimulationOptions simulation = simulation_options(read);
  PlannedRun run{
      read_scene(source.file, tree, models), simulation.culler, simulation.strategy, 1, {}};
  run.notes = run.scene.notes;
  run.plan_growth = apply(read, run.scene, run.notes);
  return run;
}

PlannedRun StudyPlan::planned(size_t run) const {
  const RunPosition position = position_of(run);
  LoadedModels models = models_;  // copies share the loaded models
  PlannedRun planned_run = planned(position.scene, position.point, models);
  if (!study_.seeds.empty())
    planned_run.scene.seed = static_cast<uint64_t>(study_.seeds[position.seed]);
  return planned_run;
}

/// Called while a scene's error is handled: rethrows it for the first value that the scene rejects
/// when values are applied in order.
void StudyPlan::rethrow_at_value(size_t scene, size_t point) {
  const std::string file = study_.file.string();
  const std::vector<size_t> rows = rows_of(point);
  const std::vector<ParameterBlock> all = std::move(study_.blocks);
  study_.blocks.clear();
  const StudyParameter* faulty = nullptr;
  std::string value;
  try {
    planned(scene, 0, models_);
    for (size_t i = 0; i < rows.size(); ++i)
      for (size_t k = 0; k < all[i].parameters.size(); ++k) {
        faulty = &all[i].parameters[k];
        value = text_of(all[i].rows[rows[i]][k]);
        study_.blocks.push_back({{*faulty}, {{all[i].rows[rows[i]][k]}}});
        planned(scene, 0, models_);
      }
  } catch (const InputError& error) {
    const std::string message = error.what();
    // Errors in the study itself, or in an unmodified scene, are specific enough.
    if (faulty == nullptr || message.starts_with(file + ":")) throw;
    throw InputError(
        at_line(file, faulty->line),
        fmt::format("a value of '{}' that {} takes", faulty->name, study_.scenes[scene].name),
        fmt::format("'{}' ({})", value, message));
  }
  throw;
}

}  // namespace throng
