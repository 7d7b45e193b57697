// Every unit edge between a free and another cell has a gate: the segment between the centres of
// the two cells. A line that passes all gates of a part of the border separates the same cells.
// Maximal straight parts are found by clipping the set of such lines (O'Rourke 1981). Dynamic
// programming joins them to a polygon with the fewest edges (Selinger 2003). The polygon is checked
// against the gates. Edges that fail become shorter, in the end exact: hence the invariant.
#include "scenes/import/grid_outline.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

namespace throng {
namespace {

using Point = Eigen::Vector2d;

/// Half of a gate. Ends at the centres would allow rings that touch.
constexpr double kHalfGate = 0.499;
/// BorderCorners where two free cells meet diagonally move into their cell: their rings keep apart.
constexpr double kSaddleShift = 0.125;
constexpr double kMinSaddleShift = 0.02;
/// Number of runs that one edge may replace before edges are merged, a limit on time.
constexpr size_t kMaxRuns = 128;
/// Number of corners before straightening at most: noise, and a limit on memory.
constexpr size_t kMaxBorderCorners = 2'000'000;
constexpr double kMaxBorderShift = 0.5;
/// Cells by which the end of an edge may move along the border, and the longest edge that goes if
/// its neighbours meet.
constexpr int kMaxMove = 4;
constexpr int64_t kMaxCut = 3;
/// The slope of a line in the chart of its main direction, with a margin.
constexpr double kMaxSlope = 1.5;
constexpr double kMaxOffset = 3;

struct BorderStep {
  int x, y;
};
constexpr std::array<BorderStep, 4> kBorderSteps = {{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};

Point step_of(int direction) {
  return {kBorderSteps[static_cast<size_t>(direction)].x,
          kBorderSteps[static_cast<size_t>(direction)].y};
}
int left_of(int direction) { return (direction + 1) & 3; }

/// BorderCorner of the exact border, which has free cells on its left.
struct BorderCorner {
  int32_t x, y;
  int8_t in = 0, out = 0;  ///< directions before and after: 0 is +x, 1 is +y
  bool is_saddle = false;
  bool is_left() const { return out == left_of(in); }
};
using BorderCorners = std::vector<BorderCorner>;

// ---- areas of free cells

/// Runs of free cells in rows, joined to areas.
class FreeAreas {
 public:
  explicit FreeAreas(const CellGrid& grid) {
    row_begin_.push_back(0);
    for (int64_t y = 0; y < grid.height; ++y) {
      const uint8_t* const row = grid.is_free.data() + y * grid.width;
      size_t below = y > 0 ? row_begin_[static_cast<size_t>(y) - 1] : 0;
      const size_t below_end = row_begin_[static_cast<size_t>(y)];
      for (int64_t x = 0; x < grid.width;) {
        if (row[x] == 0) {
          ++x;
          continue;
        }
        int64_t end = x;
        while (end < grid.width && row[end] != 0) ++end;
        const auto own = static_cast<uint32_t>(runs_.size());
        runs_.push_back({static_cast<uint32_t>(x), static_cast<uint32_t>(end), own});
        while (below < below_end && runs_[below].end <= x) ++below;
        for (size_t i = below; i < below_end && runs_[i].begin < end; ++i)
          join(static_cast<uint32_t>(i), own);
        x = end;
      }
      row_begin_.push_back(runs_.size());
    }
    cells_.assign(runs_.size(), 0);
    for (uint32_t i = 0; i < runs_.size(); ++i)
      cells_[root_of(i)] += int64_t{runs_[i].end} - runs_[i].begin;
  }

  /// Area of a free cell, the same number for all its cells.
  uint32_t area_of(int64_t x, int64_t y) {
    const auto begin = runs_.begin() + static_cast<ptrdiff_t>(row_begin_[static_cast<size_t>(y)]);
    const auto end = runs_.begin() + static_cast<ptrdiff_t>(row_begin_[static_cast<size_t>(y) + 1]);
    const auto after =
        std::upper_bound(begin, end, x, [](int64_t at, const Run& run) { return at < run.begin; });
    return root_of(static_cast<uint32_t>(after - runs_.begin() - 1));
  }

  void leave_out_small(CellGrid& grid, int64_t min_cells, GridOutline& out) {
    const int64_t largest = cells_.empty() ? 0 : *std::max_element(cells_.begin(), cells_.end());
    const int64_t limit = std::min(std::max(min_cells, (largest + 999) / 1000), largest);
    for (size_t y = 0; y + 1 < row_begin_.size(); ++y)
      for (size_t i = row_begin_[y]; i < row_begin_[y + 1]; ++i) {
        const uint32_t root = root_of(static_cast<uint32_t>(i));
        if (cells_[root] >= limit) continue;
        if (root == i) {
          ++out.areas_left_out;
          out.cells_left_out += cells_[root];
        }
        const auto row = grid.is_free.begin() + static_cast<ptrdiff_t>(y) * grid.width;
        std::fill(row + runs_[i].begin, row + runs_[i].end, uint8_t{0});
      }
  }

 private:
  struct Run {
    uint32_t begin, end;
    uint32_t parent;
  };

  uint32_t root_of(uint32_t run) {
    while (runs_[run].parent != run) run = runs_[run].parent = runs_[runs_[run].parent].parent;
    return run;
  }
  void join(uint32_t a, uint32_t b) {
    a = root_of(a);
    b = root_of(b);
    runs_[std::max(a, b)].parent = std::min(a, b);
  }

  std::vector<Run> runs_;
  std::vector<size_t> row_begin_;
  std::vector<int64_t> cells_;
};

// ---- exact borders

class BorderTracer {
 public:
  explicit BorderTracer(const CellGrid& grid)
      : grid_(grid), is_passed_(static_cast<size_t>(grid.width * grid.height), false) {}

  /// Whether the border below a cell is traced.
  bool has_passed(int64_t x, int64_t y) const {
    return is_passed_[static_cast<size_t>(y * grid_.width + x)];
  }

  /// The border that passes below a cell.
  BorderCorners trace(int64_t x, int64_t y) {
    BorderCorners corners;
    const int64_t begin_x = x, begin_y = y;
    int direction = 0;
    do {
      if (direction == 0) is_passed_[static_cast<size_t>(y * grid_.width + x)] = true;
      x += kBorderSteps[static_cast<size_t>(direction)].x;
      y += kBorderSteps[static_cast<size_t>(direction)].y;
      const bool is_left_free = cell_beside(x, y, direction, true);
      const bool is_right_free = cell_beside(x, y, direction, false);
      const int before = direction;
      if (!is_left_free) direction = left_of(direction);
      if (is_left_free && is_right_free) direction = (direction + 3) & 3;
      if (direction != before)
        corners.push_back({static_cast<int32_t>(x), static_cast<int32_t>(y),
                           static_cast<int8_t>(before), static_cast<int8_t>(direction),
                           !is_left_free && is_right_free});
    } while (x != begin_x || y != begin_y || direction != 0);
    return corners;
  }

 private:
  /// The cell on a side of the edge that goes on from (x, y).
  bool cell_beside(int64_t x, int64_t y, int direction, bool is_left) const {
    switch (direction) {
      case 0:
        return grid_.contains_free(x, is_left ? y : y - 1);
      case 1:
        return grid_.contains_free(is_left ? x - 1 : x, y);
      case 2:
        return grid_.contains_free(x - 1, is_left ? y - 1 : y);
      default:
        return grid_.contains_free(is_left ? x : x - 1, y - 1);
    }
  }

  const CellGrid& grid_;
  std::vector<bool> is_passed_;
};

// ---- straight parts

struct BorderLine {
  Point at, along;
  double distance(const Point& p) const {
    return along.x() * (p.y() - at.y()) - along.y() * (p.x() - at.x());
  }
};

/// Lines of one main direction that pass a growing number of gates: a convex set of (slope,
/// offset). Coordinates turn so that the main direction is +x, and are relative to an origin.
class BorderLines {
 public:
  BorderLines(int direction, const Point& origin)
      : direction_(direction),
        origin_(origin),
        set_{{-kMaxSlope, -kMaxOffset},
             {kMaxSlope, -kMaxOffset},
             {kMaxSlope, kMaxOffset},
             {-kMaxSlope, kMaxOffset}} {}

  bool is_empty() const { return set_.empty(); }

  void pass(const Point& free_end, const Point& other_end) {
    const Point above = turned(free_end), below = turned(other_end);
    clip(above.y(), -above.x(), -1);
    clip(-below.y(), below.x(), 1);
  }

  BorderLine middle() const {
    Point sum(0, 0);
    double area = 0;
    for (size_t i = 1; i + 1 < set_.size(); ++i) {
      const Point a = set_[i] - set_[0], b = set_[i + 1] - set_[0];
      const double part = a.x() * b.y() - a.y() * b.x();
      sum += part / 3 * (a + b);
      area += part;
    }
    Point middle = set_[0];
    if (area > 0) middle += sum / area;
    const Point x = step_of(direction_), y = step_of(left_of(direction_));
    return {origin_ + middle.y() * y, (x + middle.x() * y).normalized()};
  }

 private:
  Point turned(const Point& p) const {
    const Point from = p - origin_;
    return {from.dot(step_of(direction_)), from.dot(step_of(left_of(direction_)))};
  }

  /// Keeps the part where constant + by_slope * slope + by_offset * offset >= 0.
  void clip(double constant, double by_slope, double by_offset) {
    const auto value = [&](const Point& p) {
      return constant + by_slope * p.x() + by_offset * p.y();
    };
    const bool is_all =
        std::all_of(set_.begin(), set_.end(), [&](const Point& p) { return value(p) >= 0; });
    if (is_all) return;
    std::vector<Point>& kept = scratch_;
    kept.clear();
    for (size_t i = 0; i < set_.size(); ++i) {
      const Point &p = set_[i], &next = set_[(i + 1) % set_.size()];
      const double here = value(p), there = value(next);
      if (here >= 0) kept.push_back(p);
      if ((here > 0 && there < 0) || (here < 0 && there > 0))
        kept.push_back(p + here / (here - there) * (next - p));
    }
    if (kept.size() < 3) kept.clear();
    std::swap(set_, scratch_);
  }

  int direction_;
  Point origin_;
  std::vector<Point> set_, scratch_;
};

/// Sums over the middles of unit edges, for the deviation from the best line.
struct BorderMoments {
  long double n = 0, x = 0, y = 0, xx = 0, yy = 0, xy = 0;

  BorderMoments operator-(const BorderMoments& o) const {
    return {n - o.n, x - o.x, y - o.y, xx - o.xx, yy - o.yy, xy - o.xy};
  }
  double deviation() const {
    if (n < 2) return 0;
    const long double a = xx - x * x / n, b = yy - y * y / n, c = xy - x * y / n;
    return static_cast<double>(
        std::max(0.0L, (a + b - std::sqrt((a - b) * (a - b) + 4 * c * c)) / 2));
  }
};

class BorderRing {
 public:
  explicit BorderRing(BorderCorners corners) : corners_(std::move(corners)) {
    const size_t count = corners_.size();
    sums_.resize(2 * count + 1);
    for (size_t i = 0; i < 2 * count; ++i) {
      const Point d = step_of(corner(i).out), from = at(i) - at(0);
      const long double length = run_length(i), half = length * length / 2,
                        cube = length * length * length / 3 - length / 12;
      BorderMoments s = sums_[i];
      s.n += length;
      s.x += length * from.x() + half * d.x();
      s.y += length * from.y() + half * d.y();
      s.xx += length * from.x() * from.x() + 2 * from.x() * half * d.x() + cube * d.x() * d.x();
      s.yy += length * from.y() * from.y() + 2 * from.y() * half * d.y() + cube * d.y() * d.y();
      s.xy += length * from.x() * from.y() + half * (from.x() * d.y() + from.y() * d.x());
      sums_[i + 1] = s;
    }
    reach_.resize(count);
    for (size_t i = 0; i < count; ++i) reach_[i] = reach_of(i);
  }

  Polygon::Ring straightened() const {
    std::vector<size_t> breaks = hard_corners();
    if (breaks.empty()) {
      const auto lowest = std::min_element(corners_.begin(), corners_.end(),
                                           [](const BorderCorner& a, const BorderCorner& b) {
                                             return std::pair(a.x, a.y) < std::pair(b.x, b.y);
                                           });
      // Another round begins at a corner that the first one chose freely.
      const auto begin = static_cast<size_t>(lowest - corners_.begin());
      const std::vector<size_t> chosen = best_breaks(begin, begin + corners_.size());
      breaks.push_back(chosen[chosen.size() / 2] % corners_.size());
    }
    std::vector<size_t> all;
    for (size_t i = 0; i < breaks.size(); ++i) {
      const size_t end = i + 1 < breaks.size() ? breaks[i + 1] : breaks[0] + corners_.size();
      const std::vector<size_t> part = best_breaks(breaks[i], end);
      all.insert(all.end(), part.begin(), part.end() - 1);
    }
    return placed(merged(all, breaks));
  }

 private:
  size_t count() const { return corners_.size(); }
  const BorderCorner& corner(size_t i) const { return corners_[i % count()]; }
  Point at(size_t i) const { return {corner(i).x, corner(i).y}; }
  double run_length(size_t i) const { return (at(i + 1) - at(i)).lpNorm<1>(); }

  /// Passes the first and the last gate of a run; those between follow.
  void pass_run(size_t run, BorderLines& lines) const {
    const Point along = step_of(corner(run).out);
    const Point side = kHalfGate * step_of(left_of(corner(run).out));
    for (const Point& middle : {Point(at(run) + 0.5 * along), Point(at(run + 1) - 0.5 * along)})
      lines.pass(middle + side, middle - side);
  }

  /// Number of runs from a corner that one line can replace.
  size_t reach_of(size_t i) const {
    std::array<BorderLines, 4> sets = {BorderLines(0, at(i)), BorderLines(1, at(i)),
                                       BorderLines(2, at(i)), BorderLines(3, at(i))};
    const size_t limit = std::min(kMaxRuns, count());
    for (size_t runs = 0; runs < limit; ++runs) {
      bool is_possible = false;
      for (BorderLines& set : sets) {
        if (set.is_empty()) continue;
        pass_run(i + runs, set);
        is_possible = is_possible || !set.is_empty();
      }
      if (!is_possible) return std::max<size_t>(runs, 1);
    }
    return limit;
  }

  /// BorderCorners that no straight wall has: both runs are longer than one cell, or both ends of a
  /// wall of one cell.
  std::vector<size_t> hard_corners() const {
    std::vector<uint8_t> is_hard(count(), 0);
    const auto mark = [&](size_t i) { is_hard[i % count()] = 1; };
    for (size_t i = count(); i < 2 * count(); ++i) {
      const bool before = corner(i - 1).is_left(), own = corner(i).is_left(),
                 after = corner(i + 1).is_left();
      if (run_length(i - 1) >= 2 && run_length(i) >= 2) mark(i);
      if (own == after && run_length(i - 1) >= 2 && run_length(i + 1) >= 2) {
        mark(i);
        mark(i + 1);
      }
      if (before == own && own == after) {
        mark(i - 1);
        mark(i);
        mark(i + 1);
      }
    }
    std::vector<size_t> out;
    for (size_t i = 0; i < count(); ++i)
      if (is_hard[i] != 0) out.push_back(i);
    return out;
  }

  /// BorderCorners from `begin` to `end`, inclusive, with the fewest edges between them, then the
  /// least deviation.
  std::vector<size_t> best_breaks(size_t begin, size_t end) const {
    struct Best {
      size_t edges = std::numeric_limits<size_t>::max();
      double deviation = 0;
      size_t from = 0;
    };
    std::vector<Best> best(end - begin + 1);
    best[0].edges = 0;
    for (size_t i = begin; i < end; ++i) {
      const Best& here = best[i - begin];
      const size_t last = std::min(end, i + reach_[i % count()]);
      for (size_t j = i + 1; j <= last; ++j) {
        Best& there = best[j - begin];
        if (here.edges + 1 > there.edges) continue;
        const size_t first = i % count();
        const double deviation = here.deviation + (sums_[first + j - i] - sums_[first]).deviation();
        if (here.edges + 1 < there.edges || deviation < there.deviation)
          there = {here.edges + 1, deviation, i};
      }
    }
    std::vector<size_t> out = {end};
    while (out.back() != begin) out.push_back(best[out.back() - begin].from);
    std::reverse(out.begin(), out.end());
    return out;
  }

  /// Leaves out breaks between edges that are one line, which kMaxRuns has cut.
  std::vector<size_t> merged(const std::vector<size_t>& all,
                             const std::vector<size_t>& kept) const {
    std::vector<size_t> out;
    for (size_t i = 0; i < all.size(); ++i) {
      const size_t next = i + 1 < all.size() ? all[i + 1] : all[0] + count();
      if (i == 0 || std::binary_search(kept.begin(), kept.end(), all[i] % count()) ||
          !is_straight(out.back(), next))
        out.push_back(all[i]);
    }
    return out;
  }

  bool is_straight(size_t from, size_t to) const {
    for (int main = 0; main < 4; ++main) {
      BorderLines set(main, at(from));
      for (size_t run = from; run < to && !set.is_empty(); ++run) pass_run(run, set);
      if (!set.is_empty()) return true;
    }
    return false;
  }

  BorderLine line_between(size_t from, size_t to) const {
    if (to - from == 1) return {at(from), step_of(corner(from).out)};
    const Point whole = at(to) - at(from);
    int main = std::abs(whole.x()) >= std::abs(whole.y()) ? (whole.x() >= 0 ? 0 : 2)
                                                          : (whole.y() >= 0 ? 1 : 3);
    for (int turn = 0; turn < 4; ++turn, main = left_of(main)) {
      BorderLines set(main, at(from));
      for (size_t run = from; run < to && !set.is_empty(); ++run) pass_run(run, set);
      if (!set.is_empty()) return set.middle();
    }
    return {at(from), whole.normalized()};
  }

  Point exact(size_t i) const {
    const BorderCorner& c = corner(i);
    return c.is_saddle ? Point(at(i) + kSaddleShift * to_free(c)) : at(i);
  }
  /// Direction from a saddle to the middle of its free cell, twice as long.
  static Point to_free(const BorderCorner& c) { return step_of(left_of(c.in)) - step_of(c.in); }

  /// A grid point of the exact border: so many cells after a corner.
  struct Spot {
    size_t run;
    int64_t cells;
  };
  int64_t position(const Spot& spot) const {
    return static_cast<int64_t>(sums_[spot.run].n) + spot.cells;
  }
  int64_t position(size_t i) const { return static_cast<int64_t>(sums_[i].n); }
  Spot after(Spot spot) const {
    if (++spot.cells < static_cast<int64_t>(run_length(spot.run))) return spot;
    return {spot.run + 1, 0};
  }
  /// The spot up to kMaxMove cells before a corner, at `lowest` or after it.
  Spot before(size_t i, int64_t lowest) const {
    Spot spot{i, 0};
    for (int moves = 0; moves < kMaxMove && position(spot) > lowest; ++moves) {
      if (spot.cells == 0) spot = {spot.run - 1, static_cast<int64_t>(run_length(spot.run - 1))};
      --spot.cells;
    }
    return spot;
  }

  /// Whether a vertex lies near a spot, where no other border passes.
  bool is_in_piece(const Spot& spot, const Point& p) const {
    const BorderCorner& c = corner(spot.run);
    const Point off = p - (at(spot.run) + static_cast<double>(spot.cells) * step_of(c.out));
    if (off.lpNorm<Eigen::Infinity>() > kHalfGate || off.norm() > kMaxBorderShift) return false;
    return spot.cells > 0 || !c.is_saddle || off.dot(to_free(c)) >= 2 * kMinSaddleShift;
  }

  /// Whether a line passes the gate of the unit edge after a spot.
  bool passes(const BorderLine& line, const Spot& spot) const {
    const int direction = corner(spot.run).out;
    const Point along = step_of(direction);
    const Point middle = at(spot.run) + (static_cast<double>(spot.cells) + 0.5) * along;
    if (!(line.along.dot(along) > 0)) return false;
    return (on_gate(line, middle, direction) - middle).lpNorm<Eigen::Infinity>() <= kHalfGate;
  }

  /// `line_a` replaces the border up to corner `a`, and `line_b` from corner `b` on. Returns their
  /// meeting point and its position, from `lowest` to `highest`.
  std::optional<std::pair<Point, int64_t>> meeting(const BorderLine& line_a, size_t a,
                                                   const BorderLine& line_b, size_t b,
                                                   int64_t lowest, int64_t highest) const {
    const std::optional<Point> met = crossing(line_a, line_b);
    if (!met) return std::nullopt;
    const int64_t last = std::min(highest, position(b) + kMaxMove);
    for (Spot spot = before(a, lowest); position(spot) <= last; spot = after(spot)) {
      if (!is_in_piece(spot, *met)) continue;
      bool is_sound = true;
      for (Spot s{a, 0}; is_sound && position(s) < position(spot); s = after(s))
        is_sound = passes(line_a, s);
      for (Spot s = spot; is_sound && position(s) < position(b); s = after(s))
        is_sound = passes(line_b, s);
      if (is_sound) return std::pair(*met, position(spot));
    }
    return std::nullopt;
  }

  static std::optional<Point> crossing(const BorderLine& a, const BorderLine& b) {
    const double sine = a.along.x() * b.along.y() - a.along.y() * b.along.x();
    if (std::abs(sine) < 1e-12) return std::nullopt;
    return Point(a.at + b.distance(a.at) / sine * a.along);
  }

  /// Where a line passes the gate of a unit edge next to a corner.
  Point on_gate(const BorderLine& line, const Point& middle, int direction) const {
    const Point side = step_of(left_of(direction));
    return crossing(line, {middle, side}).value_or(middle);
  }

  Polygon::Ring placed(const std::vector<size_t>& breaks) const {
    Polygon::Ring out;
    if (breaks.size() < 3) {
      for (size_t i = 0; i < count(); ++i) out.push_back(exact(i));
      return out;
    }
    std::vector<BorderLine> lines;
    for (size_t i = 0; i < breaks.size(); ++i)
      lines.push_back(
          line_between(breaks[i], i + 1 < breaks.size() ? breaks[i + 1] : breaks[0] + count()));
    const int64_t whole = position(count());
    int64_t lowest = position(breaks[0]);
    const auto position_of = [&](size_t i) {
      return i < breaks.size() ? position(breaks[i]) : position(breaks[0]) + whole;
    };
    for (size_t i = 0; i < breaks.size(); ++i) {
      const BorderLine &before = lines[(i + lines.size() - 1) % lines.size()], &after = lines[i];
      const size_t b = breaks[i];
      // BorderCorners of straight walls may have been cut.
      if (i + 1 < breaks.size() && position_of(i + 1) - position_of(i) <= kMaxCut) {
        const auto met =
            meeting(before, b, lines[i + 1], breaks[i + 1], lowest, position_of(i + 2) - 1);
        if (met) {
          out.push_back(met->first);
          lowest = met->second + 1;
          ++i;
          continue;
        }
      }
      if (const auto met = meeting(before, b, after, b, lowest, position_of(i + 1) - 1)) {
        out.push_back((met->first - at(b)).norm() < 1e-9 ? at(b) : met->first);
        lowest = met->second + 1;
        continue;
      }
      // The lines end at the gates before and after the corner; no border passes between these.
      const BorderCorner& c = corner(b);
      out.push_back(on_gate(before, at(b) - 0.5 * step_of(c.in), c.in));
      out.push_back(on_gate(after, at(b) + 0.5 * step_of(c.out), c.out));
      lowest = position(b) + 1;
    }
    // A line that replaces one unit edge begins and ends at its gate.
    const auto is_same = [](const Point& a, const Point& c) { return (a - c).norm() < 1e-6; };
    out.erase(std::unique(out.begin(), out.end(), is_same), out.end());
    while (out.size() > 1 && is_same(out.front(), out.back())) out.pop_back();
    return out.size() < 3 ? placed({}) : out;
  }

  BorderCorners corners_;
  std::vector<BorderMoments> sums_;  ///< before each run, twice round
  std::vector<size_t> reach_;
};

}  // namespace

GridOutline outline_of(CellGrid grid, int64_t min_cells, size_t max_vertices) {
  GridOutline out;
  FreeAreas areas(grid);
  areas.leave_out_small(grid, min_cells, out);
  BorderTracer tracer(grid);
  std::vector<std::pair<uint32_t, size_t>> polygon_of_area;
  std::vector<std::pair<uint32_t, Polygon::Ring>> holes;
  size_t corners = 0, vertices = 0;
  for (int64_t y = 0; y < grid.height; ++y) {
    const uint8_t* const row = grid.is_free.data() + y * grid.width;
    for (int64_t x = 0; x < grid.width; ++x) {
      const bool has_border = row[x] != 0 && (y == 0 || row[x - grid.width] == 0);
      if (!has_border || tracer.has_passed(x, y)) continue;
      const uint32_t area = areas.area_of(x, y);
      BorderCorners exact = tracer.trace(x, y);
      int turns = 0;
      for (const BorderCorner& corner : exact) turns += corner.is_left() ? 1 : -1;
      corners += exact.size();
      out.is_too_detailed = corners > kMaxBorderCorners;
      if (out.is_too_detailed) return out;
      Polygon::Ring ring = BorderRing(std::move(exact)).straightened();
      vertices += ring.size();
      out.is_too_detailed = vertices > max_vertices;
      if (out.is_too_detailed) return out;
      if (turns > 0) {
        polygon_of_area.emplace_back(area, out.polygons.size());
        out.polygons.emplace_back().outline = std::move(ring);
      } else {
        holes.emplace_back(area, std::move(ring));
      }
    }
  }
  std::sort(polygon_of_area.begin(), polygon_of_area.end());
  for (auto& [area, ring] : holes) {
    const auto found = std::lower_bound(polygon_of_area.begin(), polygon_of_area.end(),
                                        std::pair<uint32_t, size_t>(area, 0));
    out.polygons[found->second].holes.push_back(std::move(ring));
  }
  return out;
}

}  // namespace throng
