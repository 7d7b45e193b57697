#include "crowd/dense_placement.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/random.h"

namespace throng {
namespace {

/// Share of the ground covered by enlarged bodies. Heaps of ellipses jam from about 0.85 on.
constexpr double kCoverage = 0.62;
/// Enlargement of bodies: enough to be clear of each other, no more room than people keep.
constexpr double kMinBodyScale = 1.03, kMaxBodyScale = 2.2;
constexpr int kSweeps = 600;
/// Sweeps per update of headings and neighbour lists.
constexpr int kSweepsPerList = 5;
constexpr double kClear_m = 1e-3;
/// Overlap above which a body counts as not placed; less than the thickness of clothes.
constexpr double kMaxDepth_m = 0.01;
/// Random displacement in mean distances: low-discrepancy sequences look like lattices.
constexpr double kJitter = 0.35;
constexpr uint32_t kTriesEach = 400;
constexpr uint32_t kEnd = UINT32_MAX;

/// Returns the n-th point of an even sequence (Roberts 2018: powers of the plastic number).
Eigen::Vector2d even_point(uint64_t n, const Eigen::Vector2d& start) {
  constexpr double kFirst = 0.7548776662466927, kSecond = 0.5698402909980532;
  const auto part = [n](double start_of, double step) {
    const double sum = start_of + static_cast<double>(n) * step;
    return sum - std::floor(sum);
  };
  return {part(start.x(), kFirst), part(start.y(), kSecond)};
}

/// Bodies in lists by cell; a cell is as wide as two enlarged bodies.
class CellLists {
 public:
  CellLists(const Rectangle& area, double cell_m) : origin_m_(area.min_m), cell_m_(cell_m) {
    columns_ = static_cast<int>(area.size_m().x() / cell_m_) + 1;
    rows_ = static_cast<int>(area.size_m().y() / cell_m_) + 1;
  }

  void fill(std::span<const StandingBody> bodies) {
    first_.assign(static_cast<size_t>(columns_) * static_cast<size_t>(rows_), kEnd);
    next_.assign(bodies.size(), kEnd);
    for (size_t i = bodies.size(); i-- > 0;) {
      uint32_t& first = first_[index(column_of(bodies[i]), row_of(bodies[i]))];
      next_[i] = first;
      first = static_cast<uint32_t>(i);
    }
  }

  /// Calls visit(other) for bodies of higher index that may be near.
  template <typename Visit>
  void for_later_neighbours(std::span<const StandingBody> bodies, size_t i,
                            const Visit& visit) const {
    const int column = column_of(bodies[i]), row = row_of(bodies[i]);
    for (int r = std::max(0, row - 1); r <= std::min(rows_ - 1, row + 1); ++r)
      for (int c = std::max(0, column - 1); c <= std::min(columns_ - 1, column + 1); ++c)
        for (uint32_t other = first_[index(c, r)]; other != kEnd; other = next_[other])
          if (other > i) visit(other);
  }

 private:
  int column_of(const StandingBody& body) const {
    return std::clamp(static_cast<int>((body.place_m.x() - origin_m_.x()) / cell_m_), 0,
                      columns_ - 1);
  }
  int row_of(const StandingBody& body) const {
    return std::clamp(static_cast<int>((body.place_m.y() - origin_m_.y()) / cell_m_), 0, rows_ - 1);
  }
  size_t index(int column, int row) const {
    return static_cast<size_t>(row) * static_cast<size_t>(columns_) + static_cast<size_t>(column);
  }

  Eigen::Vector2d origin_m_;
  double cell_m_;
  int columns_ = 1;
  int rows_ = 1;
  std::vector<uint32_t> first_;  ///< per cell
  std::vector<uint32_t> next_;   ///< per body
};

class DensePlacement {
 public:
  DensePlacement(const StandingArea& where, uint64_t seed, std::span<StandingBody> bodies)
      : where_(where), seed_(seed), bodies_(bodies), is_placed_(bodies.size(), 0) {}

  std::vector<uint8_t> place_standing() {
    if (bodies_.empty()) return {};
    place_evenly();
    double largest = 0, covered_m2 = 0;
    for (const StandingBody& body : bodies_) {
      largest = std::max(largest, body.size);
      covered_m2 += std::numbers::pi * StandingBody::kHalfWidth_m * StandingBody::kHalfDepth_m *
                    body.size * body.size;
    }
    body_scale_ =
        std::clamp(std::sqrt(kCoverage * free_area_m2_ / covered_m2), kMinBodyScale, kMaxBodyScale);
    CellLists lists(where_.area.bounds(),
                    2 * body_scale_ * StandingBody::kHalfWidth_m * largest + 0.1);
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      if (sweep % kSweepsPerList == 0) {
        face();
        lists.fill(bodies_);
      }
      if (push_apart(lists) < kClear_m && sweep > 2 * kSweepsPerList) break;
    }
    face();
    lists.fill(bodies_);
    reject_overlapping(lists);
    return is_placed_;
  }

 private:
  /// A distance to obstacles that is short by up to `slack_m` still counts as clear.
  bool is_ground(const Eigen::Vector2d& point, double slack_m = 0) const {
    if (!where_.area.contains(point) ||
        where_.walkable.clearance_m(point) < where_.wall_gap_m - slack_m)
      return false;
    return std::none_of(where_.others.begin(), where_.others.end(), [&](const StandingDisc& other) {
      return (other.place_m - point).norm() < other.radius_m - slack_m;
    });
  }

  void place_evenly() {
    const RandomKey first{seed_, 0, 0, Purpose::kSpawnPosition};
    const Eigen::Vector2d start(random_uniform(first, 2), random_uniform(first, 3));
    std::vector<size_t> placed;
    uint64_t tries = 0;
    for (size_t i = 0; i < bodies_.size(); ++i) {
      for (uint32_t attempt = 0; attempt < kTriesEach; ++attempt) {
        const Eigen::Vector2d share = even_point(tries++, start);
        const Eigen::Vector2d point = where_.area.at(share);
        if (!is_ground(point)) continue;
        bodies_[i].place_m = point;
        placed.push_back(i);
        is_placed_[i] = 1;
        break;
      }
    }
    free_area_m2_ = where_.area.area_m2() * static_cast<double>(placed.size()) /
                    static_cast<double>(std::max<uint64_t>(tries, 1));
    const double jitter_m =
        kJitter *
        std::sqrt(free_area_m2_ / static_cast<double>(std::max<size_t>(placed.size(), 1)));
    for (const size_t i : placed) {
      const RandomKey key{seed_, i, 1, Purpose::kSpawnPosition};
      const Eigen::Vector2d to =
          bodies_[i].place_m + Eigen::Vector2d(random_uniform(key, -jitter_m, jitter_m, 0),
                                               random_uniform(key, -jitter_m, jitter_m, 1));
      if (is_ground(to)) bodies_[i].place_m = to;
    }
  }

  void face() {
    for (size_t i = 0; i < bodies_.size(); ++i)
      bodies_[i].heading = where_.facing(i, bodies_[i].place_m);
  }

  /// Returns the largest overlap of enlarged bodies.
  double push_apart(const CellLists& lists) {
    double deepest_m = 0;
    for (size_t i = 0; i < bodies_.size(); ++i) {
      if (is_placed_[i] == 0) continue;
      StandingBody& body = bodies_[i];
      lists.for_later_neighbours(bodies_, i, [&](uint32_t k) {
        if (is_placed_[k] == 0) return;
        StandingBody& other = bodies_[k];
        const Eigen::Vector2d offset = other.place_m - body.place_m;
        const double distance_m = offset.norm();
        const Eigen::Vector2d towards =
            distance_m > 1e-6 ? Eigen::Vector2d(offset / distance_m) : Eigen::Vector2d::UnitX();
        const double depth_m =
            body_scale_ * (body.radius_m(towards) + other.radius_m(towards)) - distance_m;
        if (depth_m <= 0) return;
        deepest_m = std::max(deepest_m, depth_m);
        body.place_m -= 0.5 * depth_m * towards;
        other.place_m += 0.5 * depth_m * towards;
      });
      keep_on_ground(body);
    }
    for (StandingBody& body : bodies_) keep_on_ground(body);
    return deepest_m;
  }

  /// Moves a body to free ground, clear of the discs that are already there.
  void keep_on_ground(StandingBody& body) const {
    Eigen::Vector2d& place = body.place_m;
    for (const StandingDisc& other : where_.others) {
      const Eigen::Vector2d offset = place - other.place_m;
      const double distance_m = offset.norm();
      const double apart_m = other.radius_m + StandingBody::kHalfWidth_m * body.size;
      if (distance_m < apart_m && distance_m > 0)
        place += (apart_m - distance_m) / distance_m * offset;
    }
    place = where_.area.nearest_m(place);
    // On the face of a wall, rounding would choose the side: move inwards first.
    const Eigen::Vector2d within = place + kClear_m * (where_.area.middle_m() - place).normalized();
    place = where_.walkable.slide(within, place, where_.wall_gap_m);
    place = where_.area.nearest_m(place);
  }

  void reject_overlapping(const CellLists& lists) {
    for (size_t i = 0; i < bodies_.size(); ++i) {
      if (is_placed_[i] == 0) continue;
      // A body moved off a wall is at its border, up to rounding.
      if (!is_ground(bodies_[i].place_m, kClear_m)) is_placed_[i] = 0;
      lists.for_later_neighbours(bodies_, i, [&](uint32_t k) {
        if (is_placed_[i] != 0 && is_placed_[k] != 0 &&
            overlap_m(bodies_[i], bodies_[k]) > kMaxDepth_m)
          is_placed_[k] = 0;
      });
    }
  }

  const StandingArea& where_;
  uint64_t seed_;
  std::span<StandingBody> bodies_;
  std::vector<uint8_t> is_placed_;
  double free_area_m2_ = 0;
  double body_scale_ = 1;  ///< enlargement of bodies
};

}  // namespace

double StandingBody::radius_m(const Eigen::Vector2d& towards) const {
  const double ahead = heading.dot(towards) / kHalfDepth_m;
  const double aside = (heading.x() * towards.y() - heading.y() * towards.x()) / kHalfWidth_m;
  return size / std::sqrt(ahead * ahead + aside * aside);
}

double overlap_m(const StandingBody& a, const StandingBody& b) {
  const Eigen::Vector2d offset = b.place_m - a.place_m;
  const double distance_m = offset.norm();
  const Eigen::Vector2d towards =
      distance_m > 0 ? Eigen::Vector2d(offset / distance_m) : Eigen::Vector2d::UnitX();
  return a.radius_m(towards) + b.radius_m(towards) - distance_m;
}

double max_overlap_m(std::span<const StandingBody> bodies) {
  double deepest_m = -std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < bodies.size(); ++i)
    for (size_t k = i + 1; k < bodies.size(); ++k)
      deepest_m = std::max(deepest_m, overlap_m(bodies[i], bodies[k]));
  return deepest_m;
}

std::vector<uint8_t> place_standing(const StandingArea& where, uint64_t seed,
                                    std::span<StandingBody> bodies) {
  return DensePlacement(where, seed, bodies).place_standing();
}

}  // namespace throng
