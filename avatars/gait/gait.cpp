#include "avatars/gait/gait.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <optional>
#include <utility>

#include "avatars/gait/gait_curves.h"
#include "avatars/gait/gait_cycle.h"
#include "avatars/gait/gait_table.h"
#include "avatars/gait/row_blend.h"
#include "base/files/archive.h"
#include "base/portable_math.h"
#include "base/simd/scalar_lanes.h"

namespace throng {
namespace {

// 2.23 m/s at a height of 1.75 m: desired speeds are limited to 2.2 m/s (Weidmann 1993). Boulic's
// curves extend to 3, but higher limits enlarge every bounding sphere by 1 cm.
constexpr double kMaxRelativeSpeed = 2.6;
constexpr int kPhases = 128;
constexpr int kSpeeds = 33;

// Shorter strides, in leg lengths, belong to speeds below 1 mm/s.
constexpr float kMinStride = 0.03f;

// Nodes are rounded to hide the last bits of the C library's sines, which differ by processor.
constexpr double kNodeGrain = 1.0 / (1 << 18);

/// Fits the advance of the right foot in the root frame over its swing, by least squares.
SwingCurve swing_of(const std::vector<WalkerPose>& cycle, double stance) {
  const auto phases = static_cast<double>(cycle.size());
  const auto x_at = [&](double phase) {
    const auto before = static_cast<size_t>(phase * phases) % cycle.size();
    const double share = phase * phases - std::floor(phase * phases);
    const auto x = [&](size_t i) { return cycle[i % cycle.size()].feet[0].ground_m.x(); };
    return x(before) + share * (x(before + 1) - x(before));
  };
  constexpr int kPoints = 15;
  const double from = x_at(stance), to = x_at(0);
  Eigen::Matrix<double, kPoints, 4> powers;
  Eigen::Matrix<double, kPoints, 1> bulges;
  for (int i = 0; i < kPoints; ++i) {
    const double u = (i + 1.0) / (kPoints + 1), both = u * (1 - u);
    powers.row(i) << both, both * u, both * u * u, both * u * u * u;
    bulges[i] = (x_at(stance + u * (1 - stance)) - from) / (to - from) - u;
  }
  const Eigen::Vector4d fit =
      (powers.transpose() * powers).ldlt().solve(powers.transpose() * bulges);
  SwingCurve swing{};
  for (int i = 0; i < 4; ++i)
    swing.bulge[static_cast<size_t>(i)] =
        static_cast<float>(std::nearbyint(fit[i] / kNodeGrain) * kNodeGrain);
  return swing;
}

}  // namespace

struct Gait::Table : GaitTable {
  Table(int column_count, int phase_cells, int speed_nodes)
      : GaitTable(column_count, phase_cells, speed_nodes) {}

  float leg_length_m = 0;  // 0: the model has no gait
  float max_sqrt_speed = 0;
  float speed_cells_per_sqrt_speed = 0;
  float strides_per_sqrt_speed = 0;
  std::vector<RootBox> boxes;        // see bounds_around()
  std::optional<Stepping> stepping;  // of a walker only

  void set_row(int speed, int phase, const std::vector<double>& posture) {
    for (int c = 0; c < columns; ++c)
      row(speed, phase)[c] = static_cast<float>(
          std::nearbyint(posture[static_cast<size_t>(c)] / kNodeGrain) * kNodeGrain);
  }

  // Square root of the relative speed, limited to the table. Strides are linear in it.
  float sqrt_speed(float speed_mps, float scale) const {
    const float relative = std::max(speed_mps, 0.0f) / (leg_length_m * scale);
    return std::min(std::sqrt(relative), max_sqrt_speed);
  }

  GaitPosition place(float phase01, float speed_mps, float scale) const {
    if (leg_length_m == 0) return {};  // no legs: one posture
    const float x = phase01 * static_cast<float>(phases);
    const float y = sqrt_speed(speed_mps, scale) * speed_cells_per_sqrt_speed;
    const int phase = std::clamp(static_cast<int>(x), 0, phases - 1);
    const int speed = std::clamp(static_cast<int>(y), 0, speeds - 2);
    return {speed, phase, x - static_cast<float>(phase), y - static_cast<float>(speed)};
  }

  RowBlend between(float phase01, float speed_mps, float scale) const {
    const GaitPosition at = place(phase01, speed_mps, scale);
    return {row(at.speed, at.phase), at.u, at.v};
  }

  void archive(Archive& a) {
    constexpr size_t kMaxFloats = 1 << 26;
    a(columns, row_floats, phases, speeds, leg_length_m, max_sqrt_speed, speed_cells_per_sqrt_speed,
      strides_per_sqrt_speed);
    a.resized(rows, kMaxFloats);
    auto cells = static_cast<uint32_t>(boxes.size());
    a(cells);
    if (a.is_reading()) boxes.resize(cells);
    for (RootBox& box : boxes) a(box.min_m, box.max_m);
    bool steps = stepping.has_value();
    a(steps);
    if (steps && !stepping) stepping.emplace();
    if (stepping) a(*stepping);
  }

  /// Prefetches rows: the tables of all styles exceed the cache of a core.
  void fetch(const RowBlend& blend) const {
    if (leg_length_m == 0) return;
    for (const float* speed : {blend.from, blend.from + speed_stride()})
      for (const float* line = speed; line < speed + 2 * phase_stride(); line += 16)
        __builtin_prefetch(line);
  }

  void blend(std::span<const RowBlend> blends, float* out, SimdTarget target) const {
    const auto floats = static_cast<size_t>(columns);
    if (leg_length_m != 0)
      return blend_rows(blends, phase_stride(), speed_stride(), floats, out, target);
    for (const RowBlend& still : blends) out = std::copy_n(still.from, floats, out);
  }
};

Gait::Gait(const Model& model, GaitStyle style) : column_count_(model.kinematics.column_count()) {
  const PosableModel posable(model);
  std::vector<int> leg_links;
  std::vector<std::vector<WalkerPose>> cycles;
  double max_drop_m = 0;
  StandingJoints standing;
  const std::optional<Walker> walker = Walker::find(posable, style);
  if (walker) {
    table_ = std::make_unique<Table>(column_count_, kPhases, kSpeeds);
    const double highest = std::sqrt(kMaxRelativeSpeed);
    table_->leg_length_m = static_cast<float>(walker->leg_length_m());
    table_->max_sqrt_speed = static_cast<float>(highest);
    if (const int yaw_joint = posable.head_yaw_joint(); yaw_joint >= 0) {
      head_yaw_column_ = posable.column_of_joint(yaw_joint);
      const JointColumn& limits = model.kinematics.columns()[static_cast<size_t>(head_yaw_column_)];
      min_head_yaw_rad_ = limits.lower;
      max_head_yaw_rad_ = limits.upper;
    }
    table_->speed_cells_per_sqrt_speed = static_cast<float>((kSpeeds - 1) / highest);
    table_->strides_per_sqrt_speed = static_cast<float>(stride_per_sqrt_speed(style));
    for (int speed = 0; speed < kSpeeds; ++speed) {
      const double sqrt_speed = highest * speed / (kSpeeds - 1);
      cycles.push_back(
          walker->cycle(std::min(sqrt_speed * sqrt_speed, kMaxRelativeSpeed), kPhases));
      if (speed == 0) cycles.back().assign(kPhases, WalkerPose(cycles.back().front()));
      for (int phase = 0; phase <= kPhases; ++phase)
        table_->set_row(speed, phase, cycles.back()[static_cast<size_t>(phase % kPhases)].columns);
    }
    if (const int aside = posable.joint_of("pelvis_lateral"); aside >= 0)
      for (int speed = 0; speed < kSpeeds; ++speed)
        for (int phase = 0; phase <= kPhases; ++phase)
          hips_offset_m_.push_back(table_->row(speed, phase)[posable.column_of_joint(aside)]);
    leg_links.assign(walker->leg_links().begin(), walker->leg_links().end());
    max_drop_m = Stepping::max_drop_m(*walker);
    standing = standing_joints(posable, *table_, highest);
  } else {
    table_ = std::make_unique<Table>(column_count_, 1, 1);
    table_->set_row(0, 0, posable.rest());
    table_->set_row(0, 1, posable.rest());
  }
  GaitBounds bounds = bounds_around(posable, *table_, leg_links, max_drop_m, standing);
  sphere_centre_m_.z() = static_cast<float>(bounds.centre_z_m);
  sphere_radius_m_ = static_cast<float>(bounds.radius_m);
  upright_radius_m_ = static_cast<float>(bounds.upright_radius_m);
  table_->boxes = std::move(bounds.whole);
  if (!walker) return;
  table_->stepping.emplace(*walker, posable, cycles, table_->speed_cells_per_sqrt_speed, kMinStride,
                           bounds.rest, standing);
  share_bounds(sphere_centre_m_.z(), sphere_radius_m_, upright_radius_m_);
  swing_ = swing_of(cycles[static_cast<size_t>(kSpeeds / 2)],
                    stance_fraction(kMaxRelativeSpeed / 4, style));
  outline_ = outline_of(posable, *table_, table_->speed_cells_per_sqrt_speed, table_->leg_length_m);
}

Gait::~Gait() = default;
Gait::Gait(const Gait& other)
    : column_count_(other.column_count_),
      head_yaw_column_(other.head_yaw_column_),
      hips_offset_m_(other.hips_offset_m_),
      min_head_yaw_rad_(other.min_head_yaw_rad_),
      max_head_yaw_rad_(other.max_head_yaw_rad_),
      sphere_centre_m_(other.sphere_centre_m_),
      sphere_radius_m_(other.sphere_radius_m_),
      upright_radius_m_(other.upright_radius_m_),
      table_(std::make_unique<Table>(*other.table_)),
      swing_(other.swing_),
      outline_(other.outline_) {}
Gait::Gait(Gait&&) noexcept = default;
Gait& Gait::operator=(Gait&&) noexcept = default;

Gait::Gait() = default;

std::vector<uint8_t> Gait::bytes() const {
  Archive archive;
  Gait(*this).archive(archive);
  return archive.bytes();
}

Gait Gait::from(std::span<const uint8_t> bytes, const std::string& name) {
  Archive archive(bytes, name);
  Gait gait;
  gait.archive(archive);
  archive.expect_end();
  return gait;
}

void Gait::archive(Archive& a) {
  constexpr size_t kMaxRows = 1 << 20;
  a(column_count_, head_yaw_column_, min_head_yaw_rad_, max_head_yaw_rad_, sphere_centre_m_,
    sphere_radius_m_, upright_radius_m_, swing_.bulge);
  a.resized(hips_offset_m_, kMaxRows);
  if (table_ == nullptr) table_ = std::make_unique<Table>(0, 0, 0);
  a(*table_);
  bool has_outline = outline_ != nullptr;
  a(has_outline);
  if (!has_outline) return;
  const auto outline =
      a.is_reading() ? std::make_shared<Outline>() : std::make_shared<Outline>(*outline_);
  a(*outline);
  outline_ = outline;
}

float Gait::stride_length_m(float speed_mps, float scale) const {
  if (table_->leg_length_m == 0) return 1;
  const float stride = table_->strides_per_sqrt_speed * table_->sqrt_speed(speed_mps, scale);
  return std::max(stride, kMinStride) * table_->leg_length_m * scale;
}

void Gait::postures(std::span<const float> phases, std::span<const float> speeds_mps,
                    std::span<const float> scales, std::span<float> rows) const {
  assert(speeds_mps.size() == phases.size() && scales.size() == phases.size());
  assert(rows.size() == phases.size() * static_cast<size_t>(column_count_));
  const Table& table = *table_;
  float* out = rows.data();
  for (size_t avatar = 0; avatar < phases.size(); ++avatar, out += column_count_) {
    const RowBlend blend = table.between(phases[avatar], speeds_mps[avatar], scales[avatar]);
    table.blend({&blend, 1}, out, SimdTarget::kBest);
  }
}

void Gait::postures(std::span<const Gait* const> gaits, std::span<const float> phases,
                    std::span<const float> speeds_mps, std::span<const float> scales,
                    std::span<float> rows) {
  if (gaits.empty()) return;
  const auto columns = static_cast<size_t>(gaits.front()->column_count_);
  constexpr size_t kBatch = 16;
  std::array<RowBlend, kBatch> blends;
  for (size_t first = 0; first < gaits.size(); first += kBatch) {
    const size_t count = std::min(kBatch, gaits.size() - first);
    for (size_t i = 0; i < count; ++i) {
      const size_t avatar = first + i;
      const Table& table = *gaits[avatar]->table_;
      blends[i] = table.between(phases[avatar], speeds_mps[avatar], scales[avatar]);
      table.fetch(blends[i]);
    }
    gaits.front()->table_->blend({blends.data(), count}, rows.data() + first * columns,
                                 SimdTarget::kBest);
  }
}

float Gait::hips_offset_m(const WalkPosture& posture) const {
  if (hips_offset_m_.empty()) return 0;
  const float* n = posture.numbers;
  return bilinear(hips_offset_m_.data() + static_cast<size_t>(n[WalkPosture::kNode]), 1,
                  static_cast<size_t>(table_->phases) + 1, n[WalkPosture::kU], n[WalkPosture::kV]);
}

void Gait::apply_head_yaw(float head_yaw_rad, std::span<float> row) const {
  if (head_yaw_column_ < 0) return;
  assert(std::abs(head_yaw_rad) <= kMaxHeadYaw_rad);
  float& angle = row[static_cast<size_t>(head_yaw_column_)];
  angle = std::clamp(angle + head_yaw_rad, min_head_yaw_rad_, max_head_yaw_rad_);
}

void Gait::bounds(std::span<const float> phases, std::span<const float> speeds_mps,
                  std::span<const float> scales, std::span<RootBox> boxes) const {
  assert(speeds_mps.size() == phases.size() && scales.size() == phases.size());
  assert(boxes.size() == phases.size());
  for (size_t avatar = 0; avatar < phases.size(); ++avatar)
    boxes[avatar] =
        scaled(box_at(phases[avatar], speeds_mps[avatar], scales[avatar]), scales[avatar]);
}

const RootBox& Gait::box_at(float phase01, float speed_mps, float scale) const {
  const GaitPosition at = table_->place(phase01, speed_mps, scale);
  return table_->boxes[static_cast<size_t>(at.speed) * static_cast<size_t>(table_->phases) +
                       static_cast<size_t>(at.phase)];
}

bool Gait::has_legs() const { return table_->stepping.has_value(); }

FootTrack Gait::track_at(float speed_mps, float scale) const {
  return table_->stepping->track_at(speed_mps, scale);
}

RootBox Gait::box_of(const WalkBounds& packed_bounds, float scale) const {
  return table_->stepping->box_of(packed_bounds, scale);
}

WalkBounds Gait::walk_bounds_of(const RootBox& box, float scale) const {
  return table_->stepping->walk_bounds_of(box, scale);
}

void Gait::share_bounds(float centre_z_m, float radius_m, float upright_radius_m) {
  if (table_->stepping) table_->stepping->set_bounds(centre_z_m, radius_m, upright_radius_m);
}

void Gait::postures(std::span<const Gait* const> gaits, std::span<const WalkPosture> all,
                    std::span<const uint32_t> some, std::span<float> rows, SimdTarget target) {
  assert(gaits.size() == some.size());
  if (some.empty()) return;
  const auto columns = static_cast<size_t>(gaits.front()->column_count_);
  assert(rows.size() == some.size() * columns);
  constexpr size_t kBatch = 64;
  std::array<RowBlend, kBatch> blends;
  for (size_t first = 0; first < some.size(); first += kBatch) {
    const size_t count = std::min(kBatch, some.size() - first);
    for (size_t i = 0; i < count; ++i) {
      const Table& table = *gaits[first + i]->table_;
      const float* n = all[some[first + i]].numbers;
      blends[i] = {
          table.rows.data() + static_cast<size_t>(n[WalkPosture::kNode]) * table.phase_stride(),
          n[WalkPosture::kU], n[WalkPosture::kV]};
      table.fetch(blends[i]);
    }
    float* out = rows.data() + first * columns;
    gaits.front()->table_->blend({blends.data(), count}, out, target);
    for (size_t i = 0; i < count; ++i)
      gaits[first + i]->table_->stepping->put(all[some[first + i]], out + i * columns);
  }
}

void Gait::walk(WalkBatch& batch, SimdTarget target) {
  if (!batch.gaits[0]->has_legs()) {
    for (size_t i = 0; i < batch.count; ++i) batch.gaits[i]->roll(batch, i);
    return;
  }
  for (size_t i = 0; i < batch.count; ++i)
    batch.tables[i] = batch.gaits[i]->table_->stepping->table();
  uint64_t lost = batch.gaits[0]->table_->stepping->walk(batch, target);
  for (; lost != 0; lost &= lost - 1) {
    const auto lane = static_cast<size_t>(std::countr_zero(lost));
    batch.gaits[lane]->stand_as_tabled(batch, lane);
  }
}

/// Uses the table's posture and box, for fast walkers whose toes reach the common bounds.
void Gait::stand_as_tabled(WalkBatch& batch, size_t i) const {
  constexpr size_t kMaxColumns = 256;
  std::array<float, kMaxColumns> row;
  const std::span<float> columns(row.data(), static_cast<size_t>(column_count_));
  postures({&batch.phases[i], 1}, {&batch.gait_mps[i], 1}, {&batch.scales[i], 1}, columns);
  RootBox box;
  bounds({&batch.phases[i], 1}, {&batch.gait_mps[i], 1}, {&batch.scales[i], 1}, {&box, 1});
  table_->stepping->take(row.data(), batch.postures[i]);
  batch.shift_m[i] = batch.breath[i] = 0;
  const WalkBounds packed_bounds = table_->stepping->walk_bounds_of(box, batch.scales[i]);
  batch.bounds_x[i] = packed_bounds.x;
  batch.bounds_y[i] = packed_bounds.y;
  batch.set_feet(i, {});
  batch.gait_rates[WalkBatch::kPelvisDrop][i] = batch.gait_rates[WalkBatch::kPelvisDropSpeed][i] =
      0;
}

void Gait::roll(WalkBatch& batch, size_t i) const {
  if (batch.present[i] == 0) return;
  const bool fresh = batch.gait_mps[i] == kNotEntered;
  batch.gait_mps[i] = std::max(batch.ahead_mps[i], 0.0f);
  if (fresh) return;
  const float w = batch.w_before[i], z = batch.z_before[i];
  const float forward_m =
      (w * w - z * z) * batch.displacement_x_m[i] + 2 * (w * z) * batch.displacement_y_m[i];
  batch.phases[i] =
      phase_of(batch.phases[i] + forward_m / stride_length_m(batch.gait_mps[i], batch.scales[i]));
}

}  // namespace throng
