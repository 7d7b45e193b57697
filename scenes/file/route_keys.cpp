// Where people come from and go to.
#include "base/errors.h"
#include "scenes/file/key_tables.h"
#include "scenes/file/scene_limits.h"
#include "scenes/file/scene_values.h"

namespace throng {
namespace {

/// A thousand a second fill any entrance; more is a mistake in the unit.
constexpr Range kRateRange{0, 1000, true};

/// A goal is one area, its corners among its keys, or several in a list.
void read_areas(Reading& reading, Fields& fields, Goal& goal) {
  const Rectangle& ground = reading.scene.ground;
  for (const YamlNode* item : fields.items("nearest_of", false))
    goal.areas.push_back(read_area(fields.file(), *item, "a goal", ground));
  if (!goal.areas.empty()) {
    expect_keys_without({"min_m", "max_m"}, goal_keys(), fields);
    return;
  }
  goal.areas.push_back(read_rectangle(fields, "a goal"));
  require_on_ground(fields.where(), "a goal", goal.areas.back(), ground);
}

void add_areas(Hasher& hash, const Goal& goal) {
  hash.add(uint64_t{goal.areas.size()});
  for (const Rectangle& area : goal.areas) add_value(hash, area);
}

KeyTable<Goal> make_goal_keys() {
  const std::vector<KeyText> corners = area_text().keys;
  return {
      .text = {.name = "goal",
               .meaning = "A rectangle to go to, or one of several",
               .choices = {{"min_m", "max_m"}, {"nearest_of"}}},
      .title = "a goal",
      .keys = {
          own_key<Goal>("min_m", corners[0].meaning, "required, or `nearest_of`", corners[0].rule),
          own_key<Goal>("max_m", corners[1].meaning, "required, or `nearest_of`", corners[1].rule),
          own_key<Goal>(
              "nearest_of",
              "any one of these areas, for everybody the one that they expect to be through first",
              "required, or one area", list_rule("area", 1))
              .reading(read_areas)
              .hashing(add_areas),
          number("wait_s", "how long everybody stands there before going on", &Goal::wait_s,
                 kTimeRange),
          flag("pass",
               "a point on the way: reached on entering it. Otherwise people walk to a place of "
               "their own inside",
               &Goal::pass)}};
}

KeyTable<Source> make_source_keys() {
  return {
      .text = {.name = "source", .meaning = "Where people enter while the scene runs"},
      .title = "a source",
      .keys = {
          own_key<Source>("area", "the rectangle they appear in, wherever there is room", "",
                          map_rule("area"))
              .required()
              .reading([](Reading& reading, Fields& fields, Source& source) {
                source.area = read_area(fields.file(), fields.require("area"),
                                        "the area of a source", reading.scene.ground);
              })
              .hashing(&Source::area),
          whole("count", "how many in all; they belong to the group and have ids from the start",
                &Source::count, 0, kMaxBodies)
              .required(),
          number("rate_per_s", "how many a second", &Source::rate_per_s, kRateRange).required(),
          number("start_s", "when the first one comes", &Source::start_s, kTimeRange),
          flag("random", "at random (a Poisson process), not evenly spaced", &Source::random)}};
}

}  // namespace

const KeyTable<Goal>& goal_keys() {
  static const KeyTable<Goal> table = make_goal_keys();
  return table;
}

const KeyTable<Source>& source_keys() {
  static const KeyTable<Source> table = make_source_keys();
  return table;
}

}  // namespace throng
