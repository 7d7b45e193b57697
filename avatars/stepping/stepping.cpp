#include "avatars/stepping/stepping.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <tuple>
#include <utility>

#include "avatars/gait/gait_curves.h"
#include "avatars/gait/gait_cycle.h"
#include "avatars/gait/gait_table.h"
#include "avatars/stepping/standing.h"
#include "avatars/stepping/stepping_kernels.h"
#include "base/files/archive.h"
#include "base/portable_math.h"

namespace throng {
namespace {

float grained(double value) {
  constexpr double kGrain = 1.0 / (1 << 18);
  return static_cast<float>(std::nearbyint(value / kGrain) * kGrain);
}

std::array<float, 3> floats(const Eigen::Vector3d& v) {
  return {grained(v.x()), grained(v.y()), grained(v.z())};
}

std::array<float, 2> flat_floats(const Eigen::Vector2d& v) {
  return {grained(v.x()), grained(v.y())};
}

SignedAxis signed_axis(const Eigen::Vector3d& direction) {
  Eigen::Index index = 0;
  direction.cwiseAbs().maxCoeff(&index);
  return {static_cast<int>(index), direction[index] > 0 ? 1.0f : -1.0f};
}

// Returns the tangent of a lean from its sine, as in reach_for().
double lean_of(double sine) { return sine * (1 + 0.5 * sine * sine); }

}  // namespace

Stepping::Stepping(const Walker& walker, const PosableModel& model,
                   std::span<const std::vector<WalkerPose>> cycles, float cells_per_sqrt_speed,
                   float min_stride, std::span<const RootBox> rest_boxes,
                   const StandingJoints& standing)
    : tables_(std::make_unique<SteppingTables>()),
      vertical_column_(walker.vertical_column()),
      lateral_column_(standing.lateral_column),
      arm_columns_(standing.arm_columns) {
  SteppingTables& t = *tables_;
  t.leg_length_m = static_cast<float>(walker.leg_length_m());
  t.per_leg_length = 1 / t.leg_length_m;
  t.cells_per_sqrt_speed = cells_per_sqrt_speed;
  t.max_sqrt_speed = static_cast<float>(cycles.size() - 1) / cells_per_sqrt_speed;
  t.min_stride_m = min_stride * t.leg_length_m;
  t.phases = static_cast<int>(cycles.front().size());
  t.speeds = static_cast<int>(cycles.size());
  t.max_drop_m = static_cast<float>(max_drop_m(walker));
  t.max_shift_m = static_cast<float>(standing.max_shift_m());
  t.max_breath_m = grained(standing.max_breath_m());
  for (size_t side = 0; side < 2; ++side) read_leg(walker, model, side);
  t.table.resize((t.box(static_cast<int32_t>(rest_boxes.size())) + 15) / 16);
  float* const to = t.table.front().floats;
  for (int speed = 0; speed < t.speeds; ++speed) {
    const std::vector<WalkerPose>& cycle = cycles[static_cast<size_t>(speed)];
    add_track(walker, cycle, speed / static_cast<double>(cells_per_sqrt_speed),
              standing.shares[static_cast<size_t>(speed)], to + t.track(speed));
    for (int phase = 0; phase <= t.phases; ++phase)
      add_node(walker, cycle[static_cast<size_t>(phase % t.phases)],
               to + t.node(speed * (t.phases + 1) + phase));
  }
  float* corner = to + t.box(0);
  for (const RootBox& box : rest_boxes)
    for (const float number : {box.min_m[0], box.min_m[1], box.max_m[0], box.max_m[1]})
      *corner++ = number;
}

void Stepping::set_bounds(float centre_z_m, float radius_m, float upright_radius_m) {
  SteppingTables& t = *tables_;
  t.sphere_z_m = centre_z_m;
  t.sphere_m = radius_m;
  t.upright_m = upright_radius_m;
  // All permitted bodies fit into the upright cylinder, except for the bounds' slack.
  constexpr float kSlack = 1.2f;
  t.corner_m = -kSlack * t.upright_m;
  t.grain_m = -2 * t.corner_m / static_cast<float>(SteppingTables::kGrains);
  t.per_grain = 1 / t.grain_m;
}

const float* Stepping::table() const { return tables_->table.front().floats; }

Stepping::Stepping() : tables_(std::make_unique<SteppingTables>()) {}
Stepping::~Stepping() = default;
Stepping::Stepping(const Stepping& other)
    : tables_(std::make_unique<SteppingTables>(*other.tables_)),
      vertical_column_(other.vertical_column_),
      lateral_column_(other.lateral_column_),
      arm_columns_(other.arm_columns_) {}

void SignedAxis::archive(Archive& a) { a(index, sign); }

void LegParameters::Roll::archive(Archive& a) { a(ahead_m, height_m, more_ahead_m, more_height_m); }

void LegParameters::archive(Archive& a) {
  a(hip_m, thigh_m, shank_m, knee_side_m, ankle_side_m, square_sum_m2, per_twice_product,
    straight_rad, straight_sin, straight_cos, min_bend_cos, max_bend_cos, max_reach_m,
    max_reach2_m2, rolls, sole_half_width_m, axis1, axis3, axis13, hand, knee_sign, ankle_sign,
    lower_rad, upper_rad, thigh_radius_m, knee_radius_m, shank_radius_m, foot_middle_m, foot_half_m,
    columns);
}

void SteppingTables::Line::archive(Archive& a) { a(floats); }

void SteppingTables::archive(Archive& a) {
  constexpr size_t kMaxLines = 1 << 20;
  a(leg_length_m, per_leg_length, max_sqrt_speed, cells_per_sqrt_speed, min_stride_m, phases,
    speeds, max_drop_m, max_shift_m, max_breath_m, sphere_z_m, sphere_m, upright_m, corner_m,
    grain_m, per_grain, legs);
  a.resized(table, kMaxLines);
}

void Stepping::archive(Archive& a) { a(*tables_, vertical_column_, lateral_column_, arm_columns_); }

double Stepping::max_drop_m(const Walker& walker) {
  constexpr double kShare = 0.09;
  return kShare * walker.leg_length_m();
}

void Stepping::read_leg(const Walker& walker, const PosableModel& model, size_t side) {
  const LegShape shape = walker.leg(side).shape();
  const Eigen::Vector3d middle = 0.5 * (walker.leg(0).hip_m() + walker.leg(1).hip_m());
  LegParameters& leg = tables_->legs[side];
  leg.hip_m = floats(shape.hip_m - middle);
  leg.thigh_m = flat_floats(shape.thigh_m);
  leg.shank_m = flat_floats(shape.shank_m);
  leg.knee_side_m = grained(shape.knee_side_m);
  leg.ankle_side_m = grained(shape.ankle_side_m);
  leg.square_sum_m2 = grained(shape.thigh_m.squaredNorm() + shape.shank_m.squaredNorm());
  leg.per_twice_product = grained(0.5 / (shape.thigh_m.norm() * shape.shank_m.norm()));
  // Same rotation as turned() of gait_cycle.cpp.
  const double straight =
      arc_tan2(shape.shank_m.y() * shape.thigh_m.x() - shape.shank_m.x() * shape.thigh_m.y(),
               shape.shank_m.dot(shape.thigh_m));
  leg.straight_rad = static_cast<float>(straight);
  leg.straight_sin = static_cast<float>(sin_cos(straight).sin);
  leg.straight_cos = static_cast<float>(sin_cos(straight).cos);
  leg.knee_sign = shape.knee_sign > 0 ? 1.0f : -1.0f;
  leg.ankle_sign = shape.ankle_sign > 0 ? 1.0f : -1.0f;
  leg.columns = shape.columns;
  for (size_t i = 0; i < 5; ++i) {
    const JointColumn& column =
        model.model().kinematics.columns()[static_cast<size_t>(shape.columns[i])];
    leg.lower_rad[i] = column.lower;
    leg.upper_rad[i] = column.upper;
  }
  double min_rad = static_cast<double>(leg.lower_rad[3]),
         max_rad = static_cast<double>(leg.upper_rad[3]);
  if (leg.knee_sign < 0) std::tie(min_rad, max_rad) = std::pair(-max_rad, -min_rad);
  min_rad = std::max(min_rad, Walker::kMinKneeBend_rad);
  const auto beyond = [&](double angle) {
    return static_cast<float>(sin_cos(std::clamp(angle - straight, 0.0, 3.14)).cos);
  };
  leg.min_bend_cos = beyond(min_rad);
  leg.max_bend_cos = beyond(max_rad - 1e-4);
  const double max_reach_m = walker.leg(side).reach_m(min_rad);
  leg.max_reach_m = grained(max_reach_m);
  leg.max_reach2_m2 = grained(max_reach_m * max_reach_m);
  for (int i = 0; i < LegParameters::kRolls; ++i) {
    const auto rolled_at = [&](int node) {
      return walker.leg(side).rolled(static_cast<double>(LegParameters::kMinPitch_rad) +
                                     node / static_cast<double>(LegParameters::kRollsPerRadian));
    };
    const Leg::Rolled here = rolled_at(i), next = rolled_at(i + 1);
    leg.rolls[static_cast<size_t>(i)] = {grained(here.ahead_m), grained(here.height_m),
                                         grained(next.ahead_m) - grained(here.ahead_m),
                                         grained(next.height_m) - grained(here.height_m)};
  }
  leg.sole_half_width_m = grained(shape.sole_half_width_m);
  const Eigen::Vector3d cross = shape.hip_axes[0].cross(shape.hip_axes[2]);
  leg.axis1 = signed_axis(shape.hip_axes[0]);
  leg.axis3 = signed_axis(shape.hip_axes[2]);
  leg.axis13 = signed_axis(cross);
  leg.hand = shape.hip_axes[1].dot(cross) < 0 ? 1.0f : -1.0f;
  leg.thigh_radius_m = grained(shape.thigh_radius_m);
  leg.shank_radius_m = grained(shape.shank_radius_m);
  leg.knee_radius_m = std::max(leg.thigh_radius_m, leg.shank_radius_m);
  leg.foot_middle_m = floats(shape.foot_m.center());
  leg.foot_half_m = floats(0.5 * shape.foot_m.sizes());
}

void Stepping::add_node(const Walker& walker, const WalkerPose& pose, float* to) {
  for (size_t side = 0; side < 2; ++side) {
    const WalkerPose::Foot& foot = pose.feet[side];
    const LegParameters& leg = tables_->legs[side];
    const Eigen::Vector3d up = walker.leg(side).up_along_leg(foot.hip_m, foot.target);
    // A leaning foot stands on the sole's edge: part of the height depends on the lean.
    const double height =
        (foot.target.ankle_m - foot.ground_m).z() / up.z() -
        static_cast<double>(leg.sole_half_width_m) * lean_of(length_of(up.x(), up.y()));
    const double roll = walker.leg(side).roll_m(foot.target.pitch_rad);
    for (const double value : {foot.ground_m.x() - roll * sin_cos(foot.target.heading_rad).cos,
                               foot.ground_m.z(), height, roll, foot.target.pitch_rad})
      *to++ = grained(value);
  }
  Eigen::Quaterniond turn(pose.root_from_pelvis);
  if (turn.w() < 0) turn.coeffs() = -turn.coeffs();
  const Eigen::Vector3d middle = 0.5 * (pose.feet[0].hip_m + pose.feet[1].hip_m);
  for (const double value : {turn.x(), turn.y(), turn.z(), middle.x(), middle.y(), middle.z()})
    *to++ = grained(value);
}

void Stepping::add_track(const Walker& walker, const std::vector<WalkerPose>& cycle,
                         double sqrt_speed, double standing, float* to) {
  const WalkerPose &right_strike = cycle.front(), &left_strike = cycle[cycle.size() / 2];
  const double stride_m =
      stride_per_sqrt_speed(walker.style()) * sqrt_speed * walker.leg_length_m();
  const double stance = stance_fraction(sqrt_speed * sqrt_speed, walker.style());
  // Excludes the foot's roll along its heading.
  const auto side_m = [&](const WalkerPose::Foot& foot, size_t side) {
    return foot.ground_m.y() -
           walker.leg(side).roll_m(foot.target.pitch_rad) * sin_cos(foot.target.heading_rad).sin;
  };
  const WalkerPose::Foot &right = right_strike.feet[0], &left = left_strike.feet[1];
  const SinCos toes_out = sin_cos(left.target.heading_rad);
  for (const double value : {stance, right_strike.shift_m, side_m(right, 0), side_m(left, 1),
                             stride_m, toes_out.sin, toes_out.cos, standing})
    *to++ = grained(value);
}

uint64_t Stepping::walk(WalkBatch& batch, SimdTarget target) const {
  assert(batch.count > 0 && batch.count <= WalkBatch::kCapacity);
  batch.fill_up();
  if (target == SimdTarget::kScalar)
    walk_scalar(*tables_, batch);
  else
    walk_simd(*tables_, batch, target);
  uint64_t lost = 0;
  for (size_t lane = 0; lane < batch.count; ++lane)
    if (batch.out_of_reach[lane] != 0 && !settle(batch, lane)) lost |= uint64_t{1} << lane;
  for (size_t n = 0; n < 2; ++n)
    std::copy_n(batch.next_pelvis_drop[n], batch.count,
                batch.gait_rates[WalkBatch::kPelvisDrop + n]);
  return lost;
}

/// Reduces shifts of feet beyond the legs' reach. About one person in a hundred needs it.
bool Stepping::settle(WalkBatch& batch, size_t lane) const {
  const std::array<float, WalkBatch::kFeetNumbers> whole = batch.feet_of(lane);
  std::array<float, WalkBatch::kFeetNumbers> reached{};
  const auto reaches = [&](int sides, float share) {
    batch.set_feet(lane, whole);
    if (!reach_with(*tables_, batch, lane, sides, share)) return false;
    reached = batch.feet_of(lane);
    return true;
  };
  int sides = static_cast<int>(batch.out_of_reach[lane]);
  if (!reaches(sides, 0) && (sides == 3 || !reaches(sides = 3, 0))) return false;
  constexpr int kHalvings = 6;  // 0.4 m to some millimetres
  float low = 0, high = 1;
  for (int i = 0; i < kHalvings; ++i) {
    const float share = 0.5f * (low + high);
    (reaches(sides, share) ? low : high) = share;
  }
  batch.set_feet(lane, reached);
  return true;
}

FootTrack Stepping::track_at(float speed_mps, float scale) const {
  const SteppingTables& t = *tables_;
  const float sqrt_speed =
      std::min(std::sqrt(std::max(speed_mps, 0.0f) / (scale * t.leg_length_m)), t.max_sqrt_speed);
  const float at = sqrt_speed * t.cells_per_sqrt_speed;
  const int32_t row = std::min(static_cast<int32_t>(at), t.speeds - 2);
  const float v = at - static_cast<float>(row);
  const float *slow = table() + t.track(row), *fast = table() + t.track(row + 1);
  const auto blend = [&](size_t i) { return slow[i] + v * (fast[i] - slow[i]); };
  return {blend(0), blend(1), {blend(2), blend(3)}, std::max(blend(4), t.min_stride_m)};
}

void Stepping::put(const WalkPosture& posture, float* row) const {
  for (size_t side = 0; side < 2; ++side)
    for (size_t i = 0; i < 5; ++i)
      row[tables_->legs[side].columns[i]] = posture.numbers[5 * side + i];
  row[vertical_column_] -= posture.numbers[WalkPosture::kDrop];
  if (lateral_column_ >= 0) row[lateral_column_] += posture.numbers[WalkPosture::kShift];
  for (const int column : arm_columns_)
    if (column >= 0) row[column] += kBreath_rad * posture.numbers[WalkPosture::kBreath];
}

void Stepping::take(const float* row, WalkPosture& posture) const {
  for (size_t side = 0; side < 2; ++side)
    for (size_t i = 0; i < 5; ++i)
      posture.numbers[5 * side + i] = row[tables_->legs[side].columns[i]];
  for (const size_t added : {WalkPosture::kDrop, WalkPosture::kShift, WalkPosture::kBreath})
    posture.numbers[added] = 0;
}

WalkBounds Stepping::walk_bounds_of(const RootBox& box, float scale) const {
  const auto grains = [&](int axis) {
    return grains_between(*tables_, box.min_m[axis] / scale, box.max_m[axis] / scale);
  };
  return {grains(0), grains(1)};
}

RootBox Stepping::box_of(const WalkBounds& packed_bounds, float scale) const {
  const SteppingTables& t = *tables_;
  RootBox box{};
  for (int axis = 0; axis < 2; ++axis) {
    const auto both = static_cast<uint32_t>(axis == 0 ? packed_bounds.x : packed_bounds.y);
    const auto at = [&](uint32_t grains) {
      return scale * (t.corner_m + static_cast<float>(static_cast<int32_t>(grains)) * t.grain_m);
    };
    box.min_m[axis] = at(both / SteppingTables::kGrains);
    box.max_m[axis] = at(both % SteppingTables::kGrains);
  }
  // Upright bodies are separated by their outline seen from above.
  box.min_m[2] = scale * (t.sphere_z_m - t.sphere_m);
  box.max_m[2] = scale * (t.sphere_z_m + t.sphere_m);
  return box;
}

void WalkBatch::fill_up() {
  const size_t end = (count + kMaxLanes - 1) / kMaxLanes * kMaxLanes;
  const auto fill = [&](Numbers& numbers) {
    std::fill(numbers + count, numbers + end, numbers[count - 1]);
  };
  for (Numbers* numbers :
       {&displacement_x_m, &displacement_y_m, &w_before, &z_before, &w_after, &z_after, &ahead_mps,
        &scales, &present, &stride_scale, &shift_m, &breath, &gait_mps, &phases})
    fill(*numbers);
  for (Numbers& numbers : feet) fill(numbers);
  for (Numbers& numbers : gait_rates) fill(numbers);
  for (Numbers& numbers : landing) fill(numbers);
  std::fill(tables.begin() + static_cast<ptrdiff_t>(count),
            tables.begin() + static_cast<ptrdiff_t>(end), tables[count - 1]);
}

}  // namespace throng
