#include "bench/boxes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "culling/volumes/aabb.h"

namespace throng::bench {
namespace {

struct Cell {
  int32_t x, y;
  uint32_t avatar;
  auto operator<=>(const Cell&) const = default;
};

/// The boxes around each avatar's boxes.
std::vector<Box> avatar_boxes(const BoxList& frame) {
  std::vector<Box> out(frame.boxes.size() / frame.parts);
  for (size_t i = 0; i < out.size(); ++i) {
    out[i] = frame.boxes[i * frame.parts];
    for (const Box& part : frame.boxes.subspan(i * frame.parts, frame.parts))
      for (int axis = 0; axis < 3; ++axis) {
        out[i].min_m[axis] = std::min(out[i].min_m[axis], part.min_m[axis]);
        out[i].max_m[axis] = std::max(out[i].max_m[axis], part.max_m[axis]);
      }
  }
  return out;
}

void append_part_pairs(const BoxList& frame, uint32_t a, uint32_t b, std::vector<BoxPair>& out) {
  for (uint32_t i = a * frame.parts; i < (a + 1) * frame.parts; ++i)
    for (uint32_t j = b * frame.parts; j < (b + 1) * frame.parts; ++j)
      if (overlap(frame.boxes[i], frame.boxes[j])) append_pair(frame, i, j, out);
}

}  // namespace

BoxList CrowdBoxes::compute() {
  const BodiesView bodies = crowd_.view();
  const size_t parts = static_cast<size_t>(type_->part_count()), count = bodies.ids.size();
  poses_.resize(count * parts);
  boxes_.resize(count * parts);
  std::array<uint32_t, PoseSource::kMaxBatch> batch;
  for (size_t first = 0; first < count; first += batch.size()) {
    const size_t n = std::min(batch.size(), count - first);
    for (size_t i = 0; i < n; ++i) batch[i] = static_cast<uint32_t>(first + i);
    crowd_.poses({batch.data(), n}, {poses_.data() + first * parts, n * parts});
  }
  for (size_t i = 0; i < boxes_.size(); ++i) {
    const size_t body = i / parts;
    const Aabb::Placed box =
        Aabb::refit(type_->parts()[i % parts].points, poses_[i], bodies.scales[body]);
    for (int axis = 0; axis < 3; ++axis) {
      const double root = bodies.roots[body].position_m[axis];
      const double centre = root + static_cast<double>(box.centre_m[axis]);
      boxes_[i].min_m[axis] = static_cast<float>(centre - static_cast<double>(box.half_m[axis]));
      boxes_[i].max_m[axis] = static_cast<float>(centre + static_cast<double>(box.half_m[axis]));
    }
  }
  return {boxes_, static_cast<uint32_t>(parts)};
}

std::vector<BoxPair> reference_pairs(const BoxList& frame) {
  const std::vector<Box> avatars = avatar_boxes(frame);
  float width = std::numeric_limits<float>::min();
  for (const Box& box : avatars)
    for (int axis = 0; axis < 2; ++axis) width = std::max(width, box.max_m[axis] - box.min_m[axis]);
  std::vector<Cell> cells;
  for (uint32_t i = 0; i < avatars.size(); ++i)
    cells.push_back({static_cast<int32_t>(std::floor(avatars[i].min_m[0] / width)),
                     static_cast<int32_t>(std::floor(avatars[i].min_m[1] / width)), i});
  std::sort(cells.begin(), cells.end());
  std::vector<BoxPair> out;
  for (const Cell& cell : cells)
    for (int32_t dx = -1; dx <= 1; ++dx) {
      auto other = std::lower_bound(cells.begin(), cells.end(), Cell{cell.x + dx, cell.y - 1, 0});
      for (; other != cells.end() && other->x == cell.x + dx && other->y <= cell.y + 1; ++other)
        if (cell.avatar < other->avatar && overlap(avatars[cell.avatar], avatars[other->avatar]))
          append_part_pairs(frame, cell.avatar, other->avatar, out);
    }
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace throng::bench
