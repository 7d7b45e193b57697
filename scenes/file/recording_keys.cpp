// Keys of `recording`.
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

/// Resolves $NAME/FILE through the environment variable NAME. Recordings are large and often not
/// redistributable, so their folder differs between machines.
std::filesystem::path recording_file(const ReadContext& context, const Fields& fields) {
  const YamlNode& node = fields.require("file");
  const std::string name = fields.text("file");
  const size_t slash = name.find('/');
  if (!name.starts_with('$') || slash == std::string::npos)
    return existing_file(context, fields, node, "a recording");
  const std::string variable = name.substr(1, slash - 1);
  const char* folder = std::getenv(variable.c_str());
  if (folder == nullptr || *folder == 0)
    throw InputError(fields.where(node),
                     fmt::format("{} in the environment, naming the folder of '{}'", variable,
                                 name.substr(slash + 1)),
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

void read_tracked_point(ReadContext&, Fields& fields, Scene& scene) {
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
                        "recording, relative to the scene file or to a folder named by an "
                        "environment variable (`$THRONG_RECORDINGS/jam.txt`); its kind is detected "
                        "by content, see docs/recordings.md",
                        "", {})
          .required()
          .with_reader([](ReadContext& context, Fields& fields, Scene& scene) {
            scene.recorded->options.file = recording_file(context, fields);
          }),
      custom_key<Scene>("name", "name of the recorded people in results", "`recorded`", {})
          .with_reader([](ReadContext& context, Fields& fields, Scene& scene) {
            Group& group = scene.groups.back();
            group.name = fields.name_or("name", group.name);
            require_new(fields, group.name, context.group_names);
          }),
      option("fps", "recorded frames per second", "as stated in the file, else required", kFpsRange,
             &RecordingOptions::fps),
      option("unit_m", "metres per unit of length: 0.01 for cm", "as stated in the file",
             kUnitRange, &RecordingOptions::unit_m),
      custom_key<Scene>("heading_unit", "unit of headings in a table: `rad` or `deg`",
                        "as stated in the file, else rad",
                        {.kind = Rule::Kind::kWord, .words = {"rad", "deg"}})
          .with_reader(read_heading_unit),
      custom_key<Scene>("columns", "columns of a table: `id=pedID,t=time,x=posX,y=posY`",
                        "by their names", {})
          .with_reader([](ReadContext&, Fields& fields, Scene& scene) {
            if (fields.find("columns") != nullptr)
              scene.recorded->options.columns = fields.text("columns");
          }),
      custom_key<Scene>("separator", "separator of columns: one character, or `tab`",
                        "detected in the first line", {})
          .with_reader(read_separator),
      custom_key<Scene>("tracked_point",
                        "point that positions follow: `head` or `centre` of the body",
                        "by kind of file", {.kind = Rule::Kind::kWord, .words = {"centre", "head"}})
          .with_reader(read_tracked_point),
      time("start_s", "start of the run after the first frame, in seconds", "0",
           &RecordingOptions::start_s),
      time("end_s", "end of the run after the first frame, in seconds", "the end",
           &RecordingOptions::end_s),
      custom_key<Scene>("strict", "treat anomalies (jumps, gaps, ...) as errors", "false",
                        {.kind = Rule::Kind::kFlag})
          .with_reader([](ReadContext&, Fields& fields, Scene& scene) {
            scene.recorded->options.strict = fields.boolean_or("strict", false);
          }),
      custom_key<Scene>(
          "sampling",
          "`smooth`: recorded frames, and equal steps of at most 1/60 s between them; "
          "`recorded`: recorded frames alone",
          "`smooth`", {.kind = Rule::Kind::kWord, .words = {"smooth", "recorded"}})
          .with_reader([](ReadContext&, Fields& fields, Scene& scene) {
            scene.recorded->recorded_frames =
                fields.word("sampling", {"smooth", "recorded"}).value_or(0) == 1;
          }),
      custom_key<Scene>("geometry",
                        "build walls around the walkable area of the file, if it has one", "true",
                        {.kind = Rule::Kind::kFlag})
          .with_reader([](ReadContext&, Fields& fields, Scene& scene) {
            scene.recorded->geometry = fields.boolean_or("geometry", true);
          }),
      custom_key<Scene>("model", "body model, as of a group", "`adult`", {})
          .with_reader(read_recorded_model),
      custom_key<Scene>("height_m", "body height, as of a group; overrides heights of the file",
                        "as recorded, else by age", map_rule("distribution"))
          .with_reader([](ReadContext&, Fields& fields, Scene& scene) {
            if (const YamlNode* node = fields.find("height_m"))
              scene.groups.back().height_m =
                  read_distribution(fields.file(), *node, "height_m",
                                    age_group(Age::kAdult).height_m, {kMinPerson_m, kMaxPerson_m});
          }),
      custom_key<Scene>("ages", "ages, as of a group", "`adults`", map_rule("ages"))
          .with_reader([](ReadContext&, Fields& fields, Scene& scene) {
            scene.groups.back().ages = read_ages(fields);
          }),
      custom_key<Scene>("gait_styles", "gait styles, as of a group", "by age",
                        map_rule("gait_styles"))
          .with_reader([](ReadContext&, Fields& fields, Scene& scene) {
            if (const YamlNode* node = fields.find("gait_styles"))
              scene.groups.back().gait_styles = read_styles(fields, *node);
          })};
}

}  // namespace

const KeyTable<Scene>& recording_keys() {
  static const KeyTable<Scene> table = {
      .text = {.name = "recording", .meaning = "People who walk on recorded trajectories"},
      .title = "a recording",
      .keys = rows()};
  return table;
}

}  // namespace throng
