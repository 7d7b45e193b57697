// Keys of `separation`.
#include <algorithm>

#include "base/errors.h"
#include "scenes/file/key_tables.h"

namespace throng {
namespace {

constexpr Range kSpeedRange{0, 100};
constexpr Range kReactionRange{0, 60};
constexpr Range kStoppingRange{0, 600};
constexpr Range kDecelerationRange{0, 1000, true};
constexpr Range kLengthRange{0, 100};

Key<SeparationRule> optional_number(const std::string& name, const std::string& meaning,
                                    const std::string& fallback,
                                    std::optional<double> SeparationRule::*member, Range range) {
  return custom_key<SeparationRule>(name, meaning, fallback,
                                    {.kind = Rule::Kind::kNumber, .range = range})
      .with_reader([name, member, range](ReadContext&, Fields& fields, SeparationRule& rule) {
        if (fields.find(name) != nullptr) rule.*member = fields.number(name, range);
      })
      .with_hash([member](Hasher& hash, const SeparationRule& rule) {
        add_value(hash, (rule.*member).has_value());
        if (rule.*member) hash.add(*(rule.*member));
      });
}

void complete_separation(ReadContext& context, const Fields& fields, SeparationRule& rule) {
  rule.where = fields.where();
  if (rule.stopping_s.has_value() == rule.deceleration_mps2.has_value())
    throw InputError(fields.where(), "one of 'stopping_s' and 'deceleration_mps2'",
                     rule.stopping_s ? "both" : "neither");
  const std::vector<Group>& groups = context.scene.groups;
  if (std::none_of(groups.begin(), groups.end(), has_people) ||
      std::all_of(groups.begin(), groups.end(), has_people))
    throw InputError(
        fields.where(), "a group of robots (a model without human legs) and one of people",
        std::any_of(groups.begin(), groups.end(), has_people) ? "people alone" : "robots alone");
}

}  // namespace

const KeyTable<SeparationRule>& separation_keys() {
  static const KeyTable<SeparationRule> table = {
      .text = {.name = "separation",
               .meaning = "Required separation of robots from people",
               .choices = {{"stopping_s"}, {"deceleration_mps2"}}},
      .title = "a separation",
      .keys =
          {optional_number(
               "human_speed_mps", "v_h: speed of the person towards the robot, in m/s, at most 100",
               "as measured, with `exact`", &SeparationRule::human_speed_mps, kSpeedRange),
           optional_number(
               "robot_speed_mps", "v_r: speed of the robot towards the person, in m/s, at most 100",
               "as measured, with `exact`", &SeparationRule::robot_speed_mps, kSpeedRange),
           number("reaction_s", "T_r: time until the robot begins to stop, in seconds, at most 60",
                  &SeparationRule::reaction_s, kReactionRange)
               .required(),
           optional_number("stopping_s", "T_s: stopping time after that, in seconds, at most 600",
                           "from `deceleration_mps2`", &SeparationRule::stopping_s, kStoppingRange),
           optional_number("deceleration_mps2",
                           "deceleration of the stopping robot, in m/s2; above 0, at most 1000",
                           "from `stopping_s`", &SeparationRule::deceleration_mps2,
                           kDecelerationRange),
           number("intrusion_m", "C: intrusion of a person before detection, in metres",
                  &SeparationRule::intrusion_m, kLengthRange),
           number("human_uncertainty_m", "Z_d: position uncertainty of the person, in metres",
                  &SeparationRule::human_uncertainty_m, kLengthRange),
           number("robot_uncertainty_m", "Z_r: position uncertainty of the robot, in metres",
                  &SeparationRule::robot_uncertainty_m, kLengthRange)},
      .complete = complete_separation};
  return table;
}

}  // namespace throng
