#include "tests/culling/proximity_oracle.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace throng::test {
namespace {

/// Rounding of float poses and of the vector between roots.
constexpr double kRounding_m = 2e-6;
constexpr uint64_t kByAllEvery = 100;

}  // namespace

void ProximityTally::add(const ProximityTally& other) {
  tested += other.tested;
  touching += other.touching;
  listed += other.listed;
  missed += other.missed;
  outside += other.outside;
  wide += other.wide;
  by_all += other.by_all;
  differing += other.differing;
  if (first_wrong.empty()) first_wrong = other.first_wrong;
}

std::string ProximityOracle::verdict(const DistanceTree::Placed& a, const DistanceTree::Placed& b,
                                     const Eigen::Vector3d& a_to_b_m, bool touches, PairKey key,
                                     const ProximityRows& rows) {
  const auto row = std::lower_bound(rows.begin(), rows.end(), key,
                                    [](const ProximityPair& candidate, const PairKey& searched) {
                                      return candidate.pair < searched;
                                    });
  const bool is_listed = row != rows.end() && row->pair == key;
  // Distances beyond the row's upper bound, or beyond the margin, are not needed.
  const double within_m = static_cast<double>(is_listed ? row->hi_m : margin_m_) + 1e-3;
  const double distance = touches ? 0 : DistanceTree::distance(a, b, a_to_b_m, within_m);
  const bool is_near = distance <= static_cast<double>(margin_m_);
  tally_.tested += is_near;
  tally_.touching += touches;
  tally_.listed += is_listed;
  if (is_near && !touches && (tally_.tested - tally_.touching) % kByAllEvery == 1) {
    const double by_all = DistanceTree::distance_by_all(a, b, a_to_b_m);
    const bool is_same = std::abs(by_all - distance) <= 1e-9;
    ++(is_same ? tally_.by_all : tally_.differing);
    if (!is_same) return fmt::format("{} m by the tree, {} m by all triangles", distance, by_all);
  }
  if (!is_listed) {
    if (!is_near) return "";
    ++tally_.missed;
    return fmt::format("missed at {} m", distance);
  }
  if (static_cast<double>(row->lo_m) > distance + kRounding_m ||
      static_cast<double>(row->hi_m) < distance - kRounding_m) {
    ++tally_.outside;
    return fmt::format("{} m, not within {} to {} m", distance, row->lo_m, row->hi_m);
  }
  if (row->level == PairLevel::kTriangles && row->hi_m - row->lo_m > 1e-3f) {
    ++tally_.wide;
    return fmt::format("{} to {} m by triangles", row->lo_m, row->hi_m);
  }
  return "";
}

void print_proximity_head(std::string_view what) {
  fmt::print("{:<16}{:>12}{:>12}{:>12}{:>8}{:>9}{:>6}{:>10}{:>11}\n", what, "near", "touching",
             "listed", "missed", "outside", "wide", "by all", "differing");
}

void print_proximity_rows(std::string_view name, const ProximityTally& t) {
  fmt::print("{:<16}{:>12}{:>12}{:>12}{:>8}{:>9}{:>6}{:>10}{:>11}\n", name, t.tested, t.touching,
             t.listed, t.missed, t.outside, t.wide, t.by_all, t.differing);
  if (!t.is_right()) fmt::print("  first: {}\n", t.first_wrong);
  std::fflush(stdout);
}

}  // namespace throng::test
