// The recording of a scene.
#include <cstdlib>

#include "base/errors.h"
#include "crowd/crowd_plan.h"
#include "recordings/units.h"
#include "scenes/file/key_tables.h"
#include "scenes/file/recorded_scene.h"
#include "scenes/file/scene_values.h"

namespace throng {
namespace {

constexpr Range kFpsRange{1e-3, 1e4};
constexpr Range kUnitRange{1e-4, 1e3};

/// An option that the file may say itself.
Key<Scene> option(const std::string& name, std::string meaning, std::string fallback,
                  const Range& range, std::optional<double> RecordingOptions::*member) {
  return custom_key<Scene>(name, std::move(meaning), std::move(fallback),
                           {.kind = Rule::Kind::kNumber, .range = range})
      .with_reader([name, range, member](ReadContext&, Fields& fields, Scene& scene) {
        if (fields.find(name) != nullptr)
          scene.recorded->options.*member = fields.number(name, range);
      });
}

Key<Scene> time(const std::string& name, std::string meaning, std::string fallback,
                double RecordingOptions::*member) {
  return custom_key<Scene>(name, std::move(meaning), std::move(fallback),
                           {.kind = Rule::Kind::kNumber, .range = kTimeRange})
      .with_reader([name, member](ReadContext&, Fields& fields, Scene& scene) {
        double& value = scene.recorded->options.*member;
        value = fields.number_or(name, kTimeRange, value);
      });
}

/// A name that begins with $NAME/ lies in the folder that this variable of the environment names:
/// recordings are large, and not everybody may pass them on.
std::filesystem::path recording_file(const ReadContext& context, const Fields& fields) {
  const YamlNode& node = fields.require("file");
  const std::string name = fields.text("file");
  const size_t slash = name.find('/');
  if (!name.starts_with('$') || slash == std::string::npos)
    return existing_file(context, fields, node, "a recording");
  const std::string variable = name.substr(1, slash - 1);
  const char* folder = std::getenv(variable.c_str());
  if (folder == nullptr || *folder == 0)
    throw InputError(
        fields.where(node),
        fmt::format("{} in the environment, the folder of '{}'", variable, name.substr(slash + 1)),
        "nothing");
  return std::filesystem::path(folder) / name.substr(slash + 1);
}

void read_recorded_model(ReadContext& context, Fields& fields, Scene& scene) {
  Group& group = scene.groups.back();
  group.model = read_model_file(context, fields);
  std::shared_ptr<const Model>& body = context.bodies[group.model.string()];
  if (body == nullptr) body = load_model(group.model);
  group.body = body;
}

void read_tracks(ReadContext&, Fields& fields, Scene& scene) {
  if (const auto found = fields.word("tracked_point", {"centre", "head"}))
    scene.recorded->options.tracked_point =
        *found == 0 ? TrackedPoint::kCentre : TrackedPoint::kHead;
}

void read_heading_unit(ReadContext&, Fields& fields, Scene& scene) {
  if (const auto found = fields.word("heading_unit", {"rad", "deg"}))
    scene.recorded->options.heading_unit_rad = unit_named(*found == 0 ? "rad" : "deg")->in_si;
}

void read_separator(ReadContext&, Fields& fields, Scene& scene) {
  const YamlNode* node = fields.find("separator");
  if (node == nullptr) return;
  const std::string text = fields.text("separator");
  if (text != "tab" && text.size() != 1)
    throw InputError(fields.where(*node), "one character, or tab, for 'separator'",
                     fmt::format("'{}'", text));
  scene.recorded->options.separator = text == "tab" ? '\t' : text.front();
}

std::vector<Key<Scene>> rows() {
  return {
      custom_key<Scene>("file",
                        "the recording, relative to the scene file, or to a folder that a variable "
                        "of the environment names (`$THRONG_RECORDINGS/jam.txt`); its kind is "
                        "known by what it holds, see [recordings.md](recordings.md)",
                        "", {})
          .required()
          .with_reader([](ReadContext& context, Fields& fields, Scene& scene) {
            scene.recorded->options.file = recording_file(context, fields);
          }),
      custom_key<Scene>("name", "what the recorded people are called", "`recorded`", {})
          .with_reader([](ReadContext& context, Fields& fields, Scene& scene) {
            Group& group = scene.groups.back();
            group.name = fields.name_or("name", group.name);
            require_new(fields, group.name, context.group_names);
          }),
      option("fps", "recorded frames a second", "what the file says, else required", kFpsRange,
             &RecordingOptions::fps),
      option("unit_m", "metres a unit of length: 0.01 for cm", "what the file or its kind says",
             kUnitRange, &RecordingOptions::unit_m),
      custom_key<Scene>("heading_unit", "of headings in a table: `rad` or `deg`",
                        "what the file says, else rad",
                        {.kind = Rule::Kind::kWord, .words = {"rad", "deg"}})
          .with_reader(read_heading_unit),
      custom_key<Scene>("columns", "of a table: `id=pedID,t=time,x=posX,y=posY`", "by their names",
                        {})
          .with_reader([](ReadContext&, Fields& fields, Scene& scene) {
            if (fields.find("columns") != nullptr)
              scene.recorded->options.columns = fields.text("columns");
          }),
      custom_key<Scene>("separator", "of columns: one character, or `tab`",
                        "as the first line shows", {})
          .with_reader(read_separator),
      custom_key<Scene>(
          "tracked_point",
          "what positions are those of: `head`, below which the body hangs, or `centre`",
          "by kind of file", {.kind = Rule::Kind::kWord, .words = {"centre", "head"}})
          .with_reader(read_tracks),
      time("start_s", "the part of the time that is run begins so long after the first frame", "0",
           &RecordingOptions::start_s),
      time("end_s", "and ends so long after it", "the end", &RecordingOptions::end_s),
      custom_key<Scene>("strict", "what is odd (jumps, holes, ...) is an error", "false",
                        {.kind = Rule::Kind::kFlag})
          .with_reader([](ReadContext&, Fields& fields, Scene& scene) {
            scene.recorded->options.strict = fields.boolean_or("strict", false);
          }),
      custom_key<Scene>(
          "sampling",
          "`smooth`: every recorded frame, and equal steps of at most 1/60 s between; "
          "`recorded`: the recorded frames alone",
          "`smooth`", {.kind = Rule::Kind::kWord, .words = {"smooth", "recorded"}})
          .with_reader([](ReadContext&, Fields& fields, Scene& scene) {
            scene.recorded->recorded_frames =
                fields.word("sampling", {"smooth", "recorded"}).value_or(0) == 1;
          }),
      custom_key<Scene>("geometry",
                        "the walkable area of the file, where it has one, becomes walls", "true",
                        {.kind = Rule::Kind::kFlag})
          .with_reader([](ReadContext&, Fields& fields, Scene& scene) {
            scene.recorded->geometry = fields.boolean_or("geometry", true);
          }),
      custom_key<Scene>("model", "the bodies, as of a group", "`adult`", {})
          .with_reader(read_recorded_model),
      custom_key<Scene>("height_m", "as of a group; says more than heights of the file",
                        "as recorded, else by age", map_rule("distribution"))
          .with_reader([](ReadContext&, Fields& fields, Scene& scene) {
            if (const YamlNode* node = fields.find("height_m"))
              scene.groups.back().height_m =
                  read_distribution(fields.file(), *node, "height_m",
                                    age_group(Age::kAdult).height_m, {kMinPerson_m, kMaxPerson_m});
          }),
      custom_key<Scene>("ages", "as of a group", "`adults`", map_rule("ages"))
          .with_reader([](ReadContext&, Fields& fields, Scene& scene) {
            scene.groups.back().ages = read_ages(fields);
          }),
      custom_key<Scene>("gait_styles", "as of a group", "by age", map_rule("gait_styles"))
          .with_reader([](ReadContext&, Fields& fields, Scene& scene) {
            if (const YamlNode* node = fields.find("gait_styles"))
              scene.groups.back().gait_styles = read_styles(fields, *node);
          })};
}

}  // namespace

const KeyTable<Scene>& recording_keys() {
  static const KeyTable<Scene> table = {
      .text = {.name = "recording", .meaning = "People who walk as they were recorded"},
      .title = "a recording",
      .keys = rows()};
  return table;
}

}  // namespace throng
