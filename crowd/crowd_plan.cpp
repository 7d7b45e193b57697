#include "crowd/crowd_plan.h"

#include <fmt/format.h>

#include <algorithm>

namespace throng {

double ground_area_m2(const CrowdPlan& plan) {
  if (plan.floor.empty()) return plan.ground.area_m2();
  double sum_m2 = 0;
  for (const Polygon& polygon : plan.floor) sum_m2 += area_m2(polygon);
  return sum_m2;
}

bool has_people(const Group& group) { return group.body == nullptr || group.body->is_person; }

void keep_own_size(Group& group) {
  if (group.height_m || (!group.is_external() && has_people(group))) return;
  const auto height_m = static_cast<double>(group.body->height_m);
  group.height_m = Distribution{height_m, 0, height_m, height_m};
}

namespace {

double tallest_by_age_m(const AgeShares& shares) {
  double tallest_m = 0;
  for (size_t age = 0; age < kAgeCount; ++age)
    if (shares[age] > 0)
      tallest_m = std::max(tallest_m, age_group(static_cast<Age>(age)).height_m.max);
  return tallest_m;
}

double tallest_m(const Group& group) {
  if (group.height_m) return group.height_m->max;
  if (!has_people(group)) return static_cast<double>(group.body->height_m);
  if (group.recorded > 0 && group.recorded_heights == group.recorded)
    return group.tallest_recorded_m;
  return std::max(group.tallest_recorded_m, tallest_by_age_m(group.ages));
}

}  // namespace

double tallest_m(const CrowdPlan& plan) {
  double max_m = plan.tallest_m;
  for (const Group& group : plan.groups)
    // A density gives the number of agents only after this.
    if (group.total() > 0 || group.density_per_m2 > 0) max_m = std::max(max_m, tallest_m(group));
  return max_m > 0 ? max_m : kMaxPerson_m;
}

std::string describe_size(const Group& group) {
  const Model& body = *group.body;
  const auto own_m = static_cast<double>(body.height_m);
  if (!group.height_m)
    return fmt::format("people of all heights after '{}', which is {:.3g} m tall", body.name,
                       own_m);
  const double least = group.height_m->min / own_m, max_radps = group.height_m->max / own_m;
  const double mean = group.height_m->mean / own_m;
  std::string scale = "its own size";
  if (group.height_m->std_dev > 0 && least < max_radps)
    scale = fmt::format("scale {:.3g} ({:.3g} to {:.3g})", mean, least, max_radps);
  else if (mean != 1)
    scale = fmt::format("scale {:.3g}", mean);
  const Eigen::Vector3d size = mean * body.start_box_m.sizes().cast<double>();
  return fmt::format(
      "{} '{}', {:.3g} x {:.3g} x {:.3g} m at {}, its root {:.3g} m above the ground",
      body.is_person ? "person" : "robot", body.name, size.x(), size.y(), size.z(), scale,
      mean * static_cast<double>(body.root_height_m()));
}

}  // namespace throng
