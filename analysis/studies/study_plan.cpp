#include "analysis/studies/study_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <set>

#include "analysis/studies/scene_path.h"
#include "base/checksum.h"
#include "base/errors.h"
#include "scenes/file/scene_keys.h"

namespace throng {
namespace {

void put(YamlNode& map, const StudyParameter& parameter, const YamlNode& value) {
  map.entries.push_back({parameter.name, parameter.line, value});
  // A value stands where the study says it.
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
        blame(scene, point);
      }
      if (study_.seeds.empty()) own_seeds_.push_back(run.scene.seed);
      for (std::string& note : run.notes)
        if (noted.insert(note).second) notes_.push_back(std::move(note));
      hash.add(content_hash_of(run.scene)).add(run.scene.duration_s);
      hash.add(name_of(run.strategy)).add(run.culler.deadline_tests.value_or(UINT64_MAX));
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
  const Place place = place_of(run);
  const uint64_t seed = study_.seeds.empty()
                            ? own_seeds_[place.scene * study_.points() + place.point]
                            : static_cast<uint64_t>(study_.seeds[place.seed]);
  std::vector<std::string> cells = {fmt::format("{}", run + 1), fmt::format("{}", runs()),
                                    fmt::format("{:016x}", identity_),
                                    study_.scenes[place.scene].name, fmt::format("{}", seed)};
  for (const YamlEntry& option : study_.options.entries) cells.push_back(text_of(option.value));
  const std::vector<size_t> rows = rows_of(place.point);
  for (size_t i = 0; i < rows.size(); ++i)
    for (const YamlNode& value : study_.blocks[i].rows[rows[i]]) cells.push_back(text_of(value));
  return cells;
}

StudyPlan::Place StudyPlan::place_of(size_t run) const {
  const size_t seeds = study_.seeds.empty() ? 1 : study_.seeds.size();
  const size_t points = study_.points();
  return {run / seeds / points, run / seeds % points, run % seeds};
}

/// The last block changes fastest.
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
  const Place place = place_of(run);
  LoadedModels models = models_;  // all of them, so that runs share them
  PlannedRun planned_run = planned(place.scene, place.point, models);
  if (!study_.seeds.empty())
    planned_run.scene.seed = static_cast<uint64_t>(study_.seeds[place.seed]);
  return planned_run;
}

/// Names the first value that the scene refuses after those before it; called while the error that
/// it found is handled.
void StudyPlan::blame(size_t scene, size_t point) {
  const std::string file = study_.file.string();
  const std::vector<size_t> rows = rows_of(point);
  const std::vector<ParameterBlock> all = std::move(study_.blocks);
  study_.blocks.clear();
  const StudyParameter* guilty = nullptr;
  std::string value;
  try {
    planned(scene, 0, models_);
    for (size_t i = 0; i < rows.size(); ++i)
      for (size_t k = 0; k < all[i].parameters.size(); ++k) {
        guilty = &all[i].parameters[k];
        value = text_of(all[i].rows[rows[i]][k]);
        study_.blocks.push_back({{*guilty}, {{all[i].rows[rows[i]][k]}}});
        planned(scene, 0, models_);
      }
  } catch (const InputError& error) {
    const std::string said = error.what();
    // The study's own lines say enough, and so do the scene's where the study changes nothing.
    if (guilty == nullptr || said.starts_with(file + ":")) throw;
    throw InputError(
        at_line(file, guilty->line),
        fmt::format("a value of '{}' that {} takes", guilty->name, study_.scenes[scene].name),
        fmt::format("'{}' ({})", value, said));
  }
  throw;
}

}  // namespace throng
