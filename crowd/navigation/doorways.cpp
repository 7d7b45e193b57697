#include "crowd/navigation/doorways.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>

namespace throng {
namespace {

constexpr double kReach_m = 10;
constexpr double kApart_m = 3;
constexpr double kNarrow_m = 4;
/// Factor by which the ground kApart_m behind a door is wider than the door.
constexpr double kMinWidening = 1.5;
/// Ground behind doorways that is smaller than other such ground by this factor does not count: it
/// is outside, between the doors of a hall.
constexpr uint32_t kMaxAreaRatio = 5;
/// Step between levels: less than a wall and the body's distance from it.
constexpr double kLevel_m = 0.25;
constexpr int kLevels = static_cast<int>(kReach_m / kLevel_m);
constexpr int kApartLevels = static_cast<int>(kApart_m / kLevel_m);

/// Counts and joins connected cells (Galler and Fischer 1964).
class DisjointSets {
 public:
  explicit DisjointSets(size_t cells) : parent_(cells), sizes_(cells, 1) {
    std::iota(parent_.begin(), parent_.end(), uint32_t{0});
  }
  uint32_t of(size_t cell) {
    auto at = static_cast<uint32_t>(cell);
    while (parent_[at] != at) at = parent_[at] = parent_[parent_[at]];
    return at;
  }
  void join(size_t one, size_t other) {
    uint32_t a = of(one), b = of(other);
    if (a == b) return;
    if (sizes_[a] < sizes_[b]) std::swap(a, b);
    parent_[b] = a;
    sizes_[a] += sizes_[b];
  }
  void part(size_t cell) {
    parent_[cell] = static_cast<uint32_t>(cell);
    sizes_[cell] = 1;
  }
  uint32_t size(size_t cell) { return sizes_[of(cell)]; }

 private:
  std::vector<uint32_t> parent_;
  std::vector<uint32_t> sizes_;
};

/// Ground between a level and one kApart_m behind it that reaches from one to the other.
struct Branch {
  std::vector<size_t> mouth;  ///< its cells next to those before the level
  size_t end = 0;             ///< number of cells next to those behind
};

class DoorwaySearch {
 public:
  DoorwaySearch(const FlowGrid& grid, const FlowField& field)
      : grid_(grid), behind_(grid.cell_count()), slab_(grid.cell_count()) {
    levels_.resize(grid.cell_count(), kNone);
    by_level_.resize(kLevels + kApartLevels);
    for (size_t cell = 0; cell < grid.cell_count(); ++cell) {
      const auto away_m = static_cast<double>(field.cell_distance_m(cell));
      if (!(away_m < std::numeric_limits<double>::infinity())) continue;
      const double level = std::min(std::floor(away_m / kLevel_m), double{kLastLevel});
      levels_[cell] = static_cast<int>(level);
      if (levels_[cell] < kLastLevel) by_level_[static_cast<size_t>(levels_[cell])].push_back(cell);
    }
  }

  std::vector<Doorway> find() {
    for (size_t cell = 0; cell < levels_.size(); ++cell)
      if (levels_[cell] == kLastLevel) join_behind(cell);
    for (int level = kLastLevel - 1; level > 0; --level) {
      for (const size_t cell : by_level_[static_cast<size_t>(level)]) join_behind(cell);
      if (level <= kLevels) find_doorways_at(level);
    }
    for (Doorway& doorway : best_) std::sort(doorway.cells.begin(), doorway.cells.end());
    std::sort(best_.begin(), best_.end(),
              [](const Doorway& a, const Doorway& b) { return a.cells.front() < b.cells.front(); });
    return std::move(best_);
  }

 private:
  static constexpr int kNone = -1;
  static constexpr int kLastLevel = kLevels + kApartLevels;

  template <typename Body>
  void for_neighbours(size_t cell, const Body& body) const {
    for (const ptrdiff_t next : grid_.free_neighbours(cell))
      if (next >= 0) body(static_cast<size_t>(next));
  }

  void join_behind(size_t cell) {
    for_neighbours(cell, [&](size_t next) {
      if (levels_[next] >= levels_[cell]) behind_.join(cell, next);
    });
  }

  std::map<size_t, Branch> branches_at(int level) {
    const int end = level + kApartLevels;
    const auto each = [&](const auto& body) {
      for (int at = level; at < end; ++at)
        for (const size_t cell : by_level_[static_cast<size_t>(at)]) body(cell);
    };
    each([&](size_t cell) { slab_.part(cell); });
    each([&](size_t cell) {
      for_neighbours(cell, [&](size_t next) {
        if (levels_[next] >= level && levels_[next] < end) slab_.join(cell, next);
      });
    });
    std::map<size_t, Branch> branches;
    each([&](size_t cell) {
      bool is_mouth = false, is_end = false;
      for_neighbours(cell, [&](size_t next) {
        is_mouth |= levels_[next] >= 0 && levels_[next] < level;
        is_end |= levels_[next] >= end;
      });
      if (!is_mouth && !is_end) return;
      Branch& branch = branches[slab_.of(cell)];
      if (is_mouth) branch.mouth.push_back(cell);
      branch.end += is_end;
    });
    std::erase_if(branches, [](const auto& found) {
      return found.second.mouth.empty() || found.second.end == 0;
    });
    return branches;
  }

  double width_m(size_t cells) const {
    return static_cast<double>(cells) * grid_.cell_m() + 2 * FlowGrid::margin_m(grid_.cell_m());
  }
  double width_m(const Branch& branch) const { return width_m(branch.mouth.size()); }

  /// A door is narrow and has room for a crowd in front of it: not just a piece of a corridor.
  bool is_door(const Branch& branch) const {
    return width_m(branch) <= kNarrow_m && width_m(branch.end) >= kMinWidening * width_m(branch);
  }

  /// The best level leaves the most ground behind the narrowest doorways; of equals, the nearest.
  void find_doorways_at(int level) {
    std::map<size_t, Branch> branches = branches_at(level);
    if (branches.size() < 2) return;
    std::map<uint32_t, std::vector<Branch*>> by_piece;
    for (auto& [cell, branch] : branches) by_piece[behind_.of(cell)].push_back(&branch);
    std::erase_if(by_piece, [&](const auto& piece) {
      return piece.second.size() < 2 ||
             std::none_of(piece.second.begin(), piece.second.end(),
                          [&](const Branch* branch) { return is_door(*branch); });
    });
    uint32_t largest = 0;
    for (const auto& [piece, its_arms] : by_piece) largest = std::max(largest, behind_.size(piece));
    std::vector<Doorway> found;
    double choice = 0, all_m = 0;
    for (auto& [piece, its_arms] : by_piece) {
      if (kMaxAreaRatio * behind_.size(piece) < largest) continue;
      choice += static_cast<double>(behind_.size(piece)) * static_cast<double>(its_arms.size() - 1);
      for (Branch* branch : its_arms) {
        const double its_m = width_m(*branch);
        found.push_back({std::move(branch->mouth), its_m});
        all_m += its_m;
      }
    }
    if (found.empty() || choice / all_m < best_score_) return;
    best_score_ = choice / all_m;
    best_ = std::move(found);
  }

  const FlowGrid& grid_;
  std::vector<int> levels_;                    ///< per cell
  std::vector<std::vector<size_t>> by_level_;  ///< cells, ascending
  DisjointSets behind_;                        ///< all cells from a level on
  DisjointSets slab_;
  std::vector<Doorway> best_;
  double best_score_ = 0;  ///< cells per metre of doorway
};

}  // namespace

std::vector<Doorway> doorways_before(const FlowGrid& grid, const FlowField& field) {
  return DoorwaySearch(grid, field).find();
}

}  // namespace throng
