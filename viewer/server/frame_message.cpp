#include "viewer/server/frame_message.h"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <cmath>

#include "base/counting_sort.h"

namespace throng {
namespace {

bool overlap(const PlacedSphere& a, const PlacedSphere& b) {
  const float x = a.x - b.x, y = a.y - b.y, z = a.z - b.z, reach = a.radius + b.radius;
  return x * x + y * y + z * z <= reach * reach;
}

}  // namespace

/// Cells are no smaller than the largest diameter: the neighbour cells hold all partners.
struct SphereOverlaps::Grid {
  explicit Grid(std::span<const PlacedSphere> spheres) {
    float widest = 0;
    for (const PlacedSphere& s : spheres) {
      if (s.radius <= 0) continue;
      low_x = std::min(low_x, s.x), high_x = std::max(high_x, s.x);
      low_y = std::min(low_y, s.y), high_y = std::max(high_y, s.y);
      widest = std::max(widest, s.radius);
    }
    if (high_x < low_x) return;
    // A sparse crowd over kilometres gets larger cells instead of millions of them.
    const float side = std::sqrt((high_x - low_x) * (high_y - low_y) / kMaxCells);
    const float long_side = std::max(high_x - low_x, high_y - low_y) / kMaxCells;
    edge = std::max({2 * widest, side, long_side, 1e-3F});
    columns = static_cast<int>((high_x - low_x) / edge) + 1;
    rows = static_cast<int>((high_y - low_y) / edge) + 1;
  }
  size_t cell(int column, int row) const {
    return static_cast<size_t>(row) * static_cast<size_t>(columns) + static_cast<size_t>(column);
  }
  size_t cell(const PlacedSphere& s) const {
    return cell(std::min(columns - 1, static_cast<int>((s.x - low_x) / edge)),
                std::min(rows - 1, static_cast<int>((s.y - low_y) / edge)));
  }
  static constexpr float kMaxCells = 1 << 18;
  float low_x = 1e30F, high_x = -1e30F, low_y = 1e30F, high_y = -1e30F, edge = 1;
  int columns = 1, rows = 1;
};

void SphereOverlaps::sort_by_cell(std::span<const PlacedSphere> spheres, const Grid& grid) {
  const size_t cells = static_cast<size_t>(grid.columns) * static_cast<size_t>(grid.rows);
  start_.resize(cells + 2);
  order_.resize(spheres.size());
  counting_sort(
      cells, start_.data(),
      [&](const auto& visit) {
        for (uint32_t i = 0; i < spheres.size(); ++i)
          if (spheres[i].radius > 0) visit(i);
      },
      [&](uint32_t i) { return grid.cell(spheres[i]); },
      [&](uint32_t i, uint32_t position) { order_[position] = i; });
}

size_t SphereOverlaps::mark(std::span<const PlacedSphere> spheres, std::span<uint8_t> flags) {
  assert(flags.size() == spheres.size());
  std::fill(flags.begin(), flags.end(), uint8_t{0});
  const Grid grid(spheres);
  sort_by_cell(spheres, grid);
  size_t marked = 0;
  const auto meet = [&](uint32_t i, uint32_t j) {
    if ((flags[i] != 0 && flags[j] != 0) || !overlap(spheres[i], spheres[j])) return;
    marked += (flags[i] == 0 ? 1u : 0u) + (flags[j] == 0 ? 1u : 0u);
    flags[i] = flags[j] = 1;
  };
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const size_t cell = grid.cell(column, row);
      for (uint32_t at = start_[cell]; at < start_[cell + 1]; ++at) {
        // The rest of this cell and the next cell of the row are contiguous; so are the three cells
        // of the next row.
        const uint32_t end = start_[grid.cell(std::min(column + 1, grid.columns - 1), row) + 1];
        for (uint32_t other = at + 1; other < end; ++other) meet(order_[at], order_[other]);
        if (row + 1 == grid.rows) continue;
        const uint32_t above = start_[grid.cell(std::max(column - 1, 0), row + 1)];
        const uint32_t last =
            start_[grid.cell(std::min(column + 1, grid.columns - 1), row + 1) + 1];
        for (uint32_t other = above; other < last; ++other) meet(order_[at], order_[other]);
      }
    }
  }
  return marked;
}

namespace {

using Clock = std::chrono::steady_clock;

constexpr size_t kBatch = 512;  // avatars whose poses fit into the cache
constexpr float kUnit = 32767;

struct AvatarRecord {
  float x, y, z;
  uint8_t flags, mark;
  uint16_t speed_mmps;
};
static_assert(sizeof(AvatarRecord) == 16);

struct PartRecord {
  int16_t position[3];
  uint16_t mark;
  int16_t rotation_xyzw[4];
};
static_assert(sizeof(PartRecord) == 16);

struct PairRecord {
  uint32_t a, b;
  uint8_t part_a, part_b, level, zero;
  int32_t began;  // a BeginFrame
};
static_assert(sizeof(PairRecord) == 16);

int16_t to_int16(float value) {
  return static_cast<int16_t>(std::lrintf(std::clamp(value, -kUnit, kUnit)));
}

/// Converts a rotation matrix to a quaternion (Shepperd 1978).
void to_quaternion(const PartPose& pose, int16_t (&xyzw)[4]) {
  const auto& m = pose.rows;
  const float x = m[0][0], y = m[1][1], z = m[2][2];
  float q[4];
  if (x + y + z > 0) {
    q[0] = m[2][1] - m[1][2], q[1] = m[0][2] - m[2][0], q[2] = m[1][0] - m[0][1];
    q[3] = 1 + x + y + z;
  } else if (x > y && x > z) {
    q[0] = 1 + x - y - z, q[1] = m[0][1] + m[1][0], q[2] = m[0][2] + m[2][0];
    q[3] = m[2][1] - m[1][2];
  } else if (y > z) {
    q[0] = m[0][1] + m[1][0], q[1] = 1 - x + y - z, q[2] = m[1][2] + m[2][1];
    q[3] = m[0][2] - m[2][0];
  } else {
    q[0] = m[0][2] + m[2][0], q[1] = m[1][2] + m[2][1], q[2] = 1 - x - y + z;
    q[3] = m[1][0] - m[0][1];
  }
  const float scale = kUnit / std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  for (int i = 0; i < 4; ++i) xyzw[i] = to_int16(q[i] * scale);
}

template <typename Record>
Record* records_at(Bytes& bytes, size_t at) {
  return reinterpret_cast<Record*>(bytes.data() + at);
}

}  // namespace

void FrameMessages::add_people() {
  const CrowdState& crowd = run_.state();
  const run_description_t& description = *run_.run();
  spheres_.resize(crowd.roots.size());
  crowded_flags_.resize(crowd.roots.size());
  for (size_t i = 0; i < crowd.roots.size(); ++i) {
    const RootPose& root = crowd.roots[i];
    const AvatarSphere& sphere =
        geometry_.spheres[static_cast<size_t>(description.model_of_avatar[i])];
    const float scale = description.scale_of_avatar[i];
    const Eigen::Vector3f up =
        root.world_from_root * Eigen::Vector3f(0, 0, sphere.centre_z_m * scale);
    const Eigen::Vector3f centre = root.position_m.cast<float>() + up;
    const bool is_there = crowd.present[i] != 0;
    spheres_[i] = {centre.x(), centre.y(), centre.z(), is_there ? sphere.radius_m * scale : 0};
    if (is_there) ++head_.present;
  }
  head_.crowded = static_cast<uint32_t>(sphere_overlaps_.mark(spheres_, crowded_flags_));
  auto* people = records_at<AvatarRecord>(*out_, sizeof(FrameHead));
  for (size_t i = 0; i < crowd.roots.size(); ++i) {
    const Eigen::Vector3f position = crowd.roots[i].position_m.cast<float>();
    const float speed_mmps = std::clamp(crowd.speeds_mps[i] * 1000, 0.0F, 65535.0F);
    people[i] = {position.x(),
                 position.y(),
                 position.z(),
                 static_cast<uint8_t>((crowd.present[i] != 0 ? 1 : 0) | crowded_flags_[i] << 1),
                 person_marks_[i],
                 static_cast<uint16_t>(speed_mmps)};
  }
}

void FrameMessages::mark_pairs(const RunReader::Touching& touching,
                               const PairBegins::Begins& begins) {
  const auto avatars = static_cast<uint32_t>(head_.avatars);
  marks_.assign(head_.parts, 0);
  person_marks_.assign(avatars, 0);
  auto* pairs = records_at<PairRecord>(
      *out_, sizeof(FrameHead) + avatars * sizeof(AvatarRecord) + head_.parts * sizeof(PartRecord));
  auto began = begins.begin();  // sorted by pair, as `touching` is
  for (const auto& [pair, pair_level] : touching) {
    while (began != begins.end() && began->first < pair) ++began;
    const bool is_known = began != begins.end() && began->first == pair;
    const BeginFrame since =
        is_known ? began->second : began_before(static_cast<int64_t>(head_.frame) + 1);
    const auto level = static_cast<uint8_t>(pair_level);
    const auto mark = [&](uint32_t body, uint32_t part) {
      if (body >= avatars) return;  // an obstacle
      const auto value = static_cast<uint8_t>(level + 1);
      person_marks_[body] = std::max(person_marks_[body], value);
      const uint32_t at = geometry_.first_part[body] + part;
      if (at < geometry_.first_part[body + 1]) marks_[at] = std::max(marks_[at], value);
    };
    mark(pair.a(), pair.part_a());
    mark(pair.b(), pair.part_b());
    *pairs++ = {pair.a(),
                pair.b(),
                static_cast<uint8_t>(pair.part_a()),
                static_cast<uint8_t>(pair.part_b()),
                level,
                0,
                to_int32(since)};
  }
}

void FrameMessages::pose(size_t first, size_t end) {
  const CrowdState& crowd = run_.state();
  const run_description_t& description = *run_.run();
  const auto model_index = static_cast<size_t>(description.model_of_avatar[first]);
  const std::shared_ptr<const Model> model = run_.model(model_index);
  roots_.clear();
  for (size_t i = first; i < end; ++i)
    roots_.push_back({crowd.roots[i].world_from_root, description.scale_of_avatar[i]});
  const auto parts = static_cast<size_t>(model->part_count());
  poses_.resize(parts * roots_.size());
  const std::vector<size_t>& rows = run_.posture_offsets();
  forward_kinematics(model->kinematics,
                     std::span(crowd.postures).subspan(rows[first], rows[end] - rows[first]),
                     roots_, poses_);
  const float steps_per_metre = 1 / geometry_.part_step_m[model_index];
  auto* out = records_at<PartRecord>(*out_, parts_at_) + geometry_.first_part[first];
  const uint8_t* marks = marks_.data() + geometry_.first_part[first];
  for (const PartPose& part : poses_) {
    for (int axis = 0; axis < 3; ++axis)
      out->position[axis] = to_int16(part.rows[axis][3] * steps_per_metre);
    out->mark = *marks++;
    to_quaternion(part, out->rotation_xyzw);
    ++out;
  }
}

void FrameMessages::add_parts() {
  const std::vector<int16_t>& models = run_.run()->model_of_avatar;
  for (size_t first = 0; first < models.size();) {
    size_t end = first + 1;
    while (end < models.size() && end - first < kBatch && models[end] == models[first]) ++end;
    pose(first, end);
    first = end;
  }
}

std::shared_ptr<const Bytes> FrameMessages::build(double seq, int64_t frame,
                                                  const RunReader::Touching& touching,
                                                  const PairBegins::Begins& begins, int64_t lost) {
  const auto start = Clock::now();
  const auto message = std::make_shared<Bytes>();
  out_ = message.get();
  head_ = {};
  head_.avatars = static_cast<uint32_t>(run_.state().roots.size());
  head_.parts = head_.avatars == 0 ? 0 : geometry_.first_part.back();
  head_.pairs = static_cast<uint32_t>(touching.size());
  head_.frame = static_cast<double>(frame);
  head_.time_s = static_cast<double>(frame) * run_.run()->step_s;
  head_.seq = seq;
  if (run_.frame_stats()) head_.frame_ms = static_cast<float>(run_.frame_stats()->frame_ns * 1e-6);
  head_.lost = static_cast<float>(lost);
  parts_at_ = sizeof(FrameHead) + head_.avatars * sizeof(AvatarRecord);
  message->resize(parts_at_ + head_.parts * sizeof(PartRecord) + head_.pairs * sizeof(PairRecord));
  mark_pairs(touching, begins);
  add_people();
  add_parts();
  head_.build_ms = std::chrono::duration<float, std::milli>(Clock::now() - start).count();
  std::memcpy(message->data(), &head_, sizeof head_);
  out_ = nullptr;
  return message;
}

}  // namespace throng
