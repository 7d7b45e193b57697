#include "crowd/navigation/walkable.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "base/errors.h"
#include "crowd/navigation/footprints.h"
#include "geometry/floor.h"

namespace throng {
namespace {

/// Maximum number of cells with a list of footprints; more would not fit the second-level cache.
constexpr double kMaxListedCells = 1 << 16;
/// Entries of all lists, 256 MB: a thousand obstacles as large as the largest ground.
constexpr size_t kMaxEntries = size_t{1} << 26;

}  // namespace

Walkable::Walkable(const CrowdPlan& plan) : ground_(plan.ground), floor_(plan.floor) {
  edge_starts_.push_back(0);
  const std::vector<Footprint> obstacles = footprints_of(plan);
  if (!floor_.empty()) {
    locator_.emplace(floor_);
    uint32_t surface = 1;  // one that no obstacle has
    for (const Footprint& each : obstacles) surface = std::max(surface, each.surface + 1);
    for (const FloorStrip& strip : strips_around(floor_)) add_footprint(strip, surface);
  }
  for (const Footprint& each : obstacles) add_footprint(each.corners, each.surface);
  first_door_ = static_cast<uint32_t>(surfaces_.size());
  for (const Door& door : plan.doors) add_footprint(footprint_of(door));
  is_shut_.assign(plan.doors.size(), 0);
  build_cells();
}

void Walkable::shut(std::span<const uint8_t> doors) {
  is_shut_.assign(doors.begin(), doors.end());
  build_cells();
}

Walkable::Walkable(const Rectangle& ground,
                   const std::vector<std::vector<Eigen::Vector2d>>& footprints)
    : ground_(ground) {
  edge_starts_.push_back(0);
  for (const auto& corners : footprints) add_footprint(corners);
  first_door_ = static_cast<uint32_t>(footprints.size());
  build_cells();
}

void Walkable::add_footprint(std::span<const Eigen::Vector2d> corners, uint32_t surface) {
  assert(corners.size() >= 3);
  for (size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector2d along = corners[(i + 1) % corners.size()] - corners[i];
    edges_.push_back({corners[i], along, Eigen::Vector2d(along.y(), -along.x()).normalized()});
  }
  edge_starts_.push_back(static_cast<uint32_t>(edges_.size()));
  surfaces_.push_back(surface);
  Disc& disc = discs_.emplace_back();
  disc.centre_m =
      bounds_of(std::vector<Eigen::Vector2d>(corners.begin(), corners.end())).middle_m();
  constexpr double kRounding_m = 1e-6;
  for (const Eigen::Vector2d& corner : corners)
    disc.radius_m = std::max(disc.radius_m, (corner - disc.centre_m).norm() + kRounding_m);
}

std::vector<std::vector<Eigen::Vector2d>> Walkable::footprints() const {
  std::vector<std::vector<Eigen::Vector2d>> all(first_door_);
  for (uint32_t f = 0; f < all.size(); ++f)
    for (const Edge& edge : edges_of(f)) all[f].push_back(edge.start);
  return all;
}

std::span<const Walkable::Edge> Walkable::edges_of(uint32_t footprint) const {
  return {edges_.data() + edge_starts_[footprint], edges_.data() + edge_starts_[footprint + 1]};
}

int Walkable::cell_of(double offset_m, int cells) const {
  return std::clamp(static_cast<int>(std::floor(offset_m / cell_m_)), 0, cells - 1);
}

void Walkable::build_cells() {
  const Eigen::Vector2d size = ground_.size_m();
  cell_m_ = std::max(2.0, std::sqrt(size.prod() / kMaxListedCells));
  columns_ = std::max(1, static_cast<int>(std::ceil(size.x() / cell_m_)));
  rows_ = std::max(1, static_cast<int>(std::ceil(size.y() / cell_m_)));
  const auto footprints = first_door_ + static_cast<uint32_t>(is_shut_.size());
  const auto for_each_range = [&](auto&& visit) {
    for (uint32_t f = 0; f < footprints; ++f) {
      if (f >= first_door_ && is_shut_[f - first_door_] == 0) continue;
      Eigen::Vector2d low = edges_of(f).front().start;
      Eigen::Vector2d high = low;
      for (const Edge& edge : edges_of(f)) {
        low = low.cwiseMin(edge.start);
        high = high.cwiseMax(edge.start);
      }
      low -= ground_.min_m + Eigen::Vector2d::Constant(kReach_m);
      high -= ground_.min_m - Eigen::Vector2d::Constant(kReach_m);
      visit(f, cell_of(low.x(), columns_), cell_of(high.x(), columns_), cell_of(low.y(), rows_),
            cell_of(high.y(), rows_));
    }
  };
  size_t entries = 0;
  for_each_range([&](uint32_t, int left, int right, int low, int high) {
    entries += static_cast<size_t>(right - left + 1) * static_cast<size_t>(high - low + 1);
  });
  if (entries > kMaxEntries)
    throw InputError("obstacles", "fewer or smaller ones",
                     "more than the table of nearby footprints can hold; "
                     "remove small obstacles or merge them");
  const auto for_each_cell = [&](auto&& visit) {
    for_each_range([&](uint32_t f, int left, int right, int low, int high) {
      for (int row = low; row <= high; ++row)
        for (int column = left; column <= right; ++column) {
          const int cell = row * columns_ + column;
          visit(static_cast<size_t>(cell), f);
        }
    });
  };
  cell_starts_.assign(static_cast<size_t>(columns_ * rows_) + 1, 0);
  for_each_cell([&](size_t cell, uint32_t) { ++cell_starts_[cell + 1]; });
  for (size_t cell = 1; cell < cell_starts_.size(); ++cell)
    cell_starts_[cell] += cell_starts_[cell - 1];
  cell_footprints_.resize(cell_starts_.back());
  std::vector<uint32_t> next(cell_starts_.begin(), cell_starts_.end() - 1);
  for_each_cell([&](size_t cell, uint32_t f) { cell_footprints_[next[cell]++] = f; });
}

std::span<const uint32_t> Walkable::nearby_footprints(const Eigen::Vector2d& point) const {
  const Eigen::Vector2d offset = point - ground_.min_m;
  const int row = cell_of(offset.y(), rows_), column = cell_of(offset.x(), columns_);
  const auto cell =
      static_cast<size_t>(row) * static_cast<size_t>(columns_) + static_cast<size_t>(column);
  return {cell_footprints_.data() + cell_starts_[cell],
          cell_footprints_.data() + cell_starts_[cell + 1]};
}

Walkable::Nearest Walkable::nearest(uint32_t footprint, const Eigen::Vector2d& point) const {
  Nearest inside{Eigen::Vector2d::UnitX(), -1e300};
  double best_square = 1e300;
  Eigen::Vector2d best_offset = Eigen::Vector2d::Zero();
  bool is_outside = false;
  for (const Edge& edge : edges_of(footprint)) {
    const Eigen::Vector2d offset = point - edge.start;
    const double height = edge.normal.dot(offset);
    if (height > inside.distance_m) inside = {edge.normal, height};
    if (height <= 0) continue;
    is_outside = true;
    const double t = std::clamp(edge.along.dot(offset) / edge.along.squaredNorm(), 0.0, 1.0);
    const Eigen::Vector2d from_edge = offset - t * edge.along;
    const double square = from_edge.squaredNorm();
    if (square >= best_square) continue;
    best_square = square;
    best_offset = from_edge;
  }
  if (!is_outside) return inside;
  const double distance = std::sqrt(best_square);
  // Below a picometre the quotient is noise; the edge's own normal is right there.
  if (distance < 1e-12) return {inside.normal, distance};
  return {best_offset / distance, distance};
}

double Walkable::clearance_m(const Eigen::Vector2d& point) const {
  const double edge =
      std::min((point - ground_.min_m).minCoeff(), (ground_.max_m - point).minCoeff());
  return std::min(edge, obstacle_clearance_m(point));
}

bool Walkable::is_clear_between(const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                                double gap_m, int pieces) const {
  for (int i = 1; i < pieces; ++i)
    if (clearance_m(from + (i / double(pieces)) * (to - from)) < gap_m) return false;
  return true;
}

double Walkable::obstacle_clearance_m(const Eigen::Vector2d& point) const {
  return obstacle_clearance_m(point, nearby_footprints(point));
}

double Walkable::obstacle_clearance_m(const Eigen::Vector2d& point,
                                      std::span<const uint32_t> footprints) const {
  double clearance = kReach_m;
  for (const uint32_t footprint : footprints)
    if (!is_beyond(footprint, point, std::max(clearance, 0.0)))
      clearance = std::min(clearance, nearest(footprint, point).distance_m);
  return clearance >= 0 && locator_ && !locator_->contains(point) ? -kReach_m : clearance;
}

Gap Walkable::gap_at(const Eigen::Vector2d& point, double reach_m) const {
  return gap_at(point, reach_m, nearby_footprints(point));
}

Gap Walkable::gap_at(const Eigen::Vector2d& point, double reach_m,
                     std::span<const uint32_t> footprints) const {
  constexpr double kOpposite = -0.5;  // 120 degrees apart or more, the cosine
  // Only the nearest wall in each of sixteen directions counts: thousands may be near.
  constexpr size_t kSectors = 16;
  struct Wall {
    Eigen::Vector2d normal = Eigen::Vector2d::Zero();
    double distance_m = std::numeric_limits<double>::infinity();
  };
  std::array<Wall, kSectors + 4> walls;
  for (const uint32_t footprint : footprints) {
    if (is_beyond(footprint, point, reach_m)) continue;
    const Nearest wall = nearest(footprint, point);
    if (!(wall.distance_m < reach_m)) continue;
    const Eigen::Vector2d& n = wall.normal;
    const size_t octant = (n.x() < 0 ? 1u : 0u) + (n.y() < 0 ? 2u : 0u) +
                          (std::abs(n.x()) < std::abs(n.y()) ? 4u : 0u);
    const double slope = std::min(std::abs(n.x()), std::abs(n.y()));
    Wall& nearest_so_far = walls[2 * octant + (slope > 0.38 ? 1u : 0u)];
    if (wall.distance_m < nearest_so_far.distance_m) nearest_so_far = {n, wall.distance_m};
  }
  walls[kSectors] = {Eigen::Vector2d::UnitX(), point.x() - ground_.min_m.x()};
  walls[kSectors + 1] = {Eigen::Vector2d::UnitY(), point.y() - ground_.min_m.y()};
  walls[kSectors + 2] = {-Eigen::Vector2d::UnitX(), ground_.max_m.x() - point.x()};
  walls[kSectors + 3] = {-Eigen::Vector2d::UnitY(), ground_.max_m.y() - point.y()};
  Gap gap;
  for (size_t i = 0; i < kSectors; ++i)
    for (size_t k = i + 1; k < walls.size() && walls[i].distance_m < reach_m; ++k) {
      const double width_m = walls[i].distance_m + walls[k].distance_m;
      if (!(walls[k].distance_m < reach_m && width_m < gap.width_m) ||
          walls[i].normal.dot(walls[k].normal) >= kOpposite)
        continue;
      gap = {width_m,
             {point - walls[i].distance_m * walls[i].normal,
              point - walls[k].distance_m * walls[k].normal}};
    }
  return gap;
}

bool Walkable::crosses(uint32_t footprint, const Eigen::Vector2d& from,
                       const Eigen::Vector2d& to) const {
  // Clips the segment by each edge's inner side (Cyrus and Beck 1978); the rest runs inside.
  double enter = 0;
  double leave = 1;
  const Eigen::Vector2d segment = to - from;
  for (const Edge& edge : edges_of(footprint)) {
    const double height = edge.normal.dot(from - edge.start);
    const double climb = edge.normal.dot(segment);
    if (climb == 0) {
      if (height >= 0) return false;
    } else if (climb < 0) {
      enter = std::max(enter, -height / climb);
    } else {
      leave = std::min(leave, -height / climb);
    }
    if (enter >= leave) return false;
  }
  return true;
}

bool Walkable::crosses(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const {
  for (const uint32_t footprint : nearby_footprints(from))
    if (crosses(footprint, from, to)) return true;
  return false;
}

Eigen::Vector2d Walkable::slide(const Eigen::Vector2d& from, Eigen::Vector2d to,
                                double gap_m) const {
  const std::span<const uint32_t> around = nearby_footprints(from);
  const double edge_gap_m = std::min(gap_m, 0.5 * ground_.size_m().minCoeff());
  const Eigen::Vector2d low = ground_.min_m.array() + edge_gap_m;
  const Eigen::Vector2d high = ground_.max_m.array() - edge_gap_m;
  // Twice: leaving one wall of a corner may enter the other.
  for (int iteration = 0; iteration < 2; ++iteration) {
    to = to.cwiseMax(low).cwiseMin(high);
    for (const uint32_t footprint : around) {
      const Nearest wall = nearest(footprint, to);
      if (wall.distance_m < gap_m) to += (gap_m - wall.distance_m) * wall.normal;
    }
  }
  if (around.empty() ? !ground_.contains(to) : !is_on_floor(to)) return from;
  for (const uint32_t footprint : around)
    if (nearest(footprint, to).distance_m < 0 || crosses(footprint, from, to)) return from;
  return to;
}

}  // namespace throng
