#include <algorithm>
#include <cmath>

#include "avatars/gait/gait.h"
#include "avatars/gait/gait_table.h"
#include "base/portable_math.h"
#include "culling/volumes/slabs.h"

namespace throng {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

// Single precision in postures, kinematics and placing: ten times the measured error.
constexpr double kFloatMargin = 1e-4;

// Results are multiples of this grain, which hides the last bits of a C library's sines.
constexpr double kGrain = 1.0 / 8192;

// Speeds per table cell: the bound between nodes falls with the square of their distance.
constexpr int kSpeedSplit = 3;

int speed_steps(const GaitTable& table) { return (table.speeds - 1) * kSpeedSplit + 1; }

// Returns a posture of the table; `step` counts speeds in parts of kSpeedSplit.
std::vector<double> columns_at(const GaitTable& table, int step, int phase) {
  const int speed = step / kSpeedSplit;
  const double share = static_cast<double>(step % kSpeedSplit) / kSpeedSplit;
  const float* slow = table.row(speed, phase);
  const float* fast = share > 0 ? table.row(speed + 1, phase) : slow;
  std::vector<double> columns(static_cast<size_t>(table.columns));
  for (int c = 0; c < table.columns; ++c)
    columns[static_cast<size_t>(c)] =
        (1 - share) * static_cast<double>(slow[c]) + share * static_cast<double>(fast[c]);
  return columns;
}

// A vertex at height z and distance r from the axis is sqrt(r^2 + z^2 - 2 z c + c^2) from a centre
// at height c. Without c^2 this is a line over c; the farthest vertices have the uppermost lines.
struct Line {
  double z, square;
  double at(double c) const { return square - 2 * z * c; }
};

double squared_radius(const std::vector<Line>& lines, double c) {
  double max_value = 0;
  for (const Line& line : lines) max_value = std::max(max_value, line.at(c));
  return max_value + c * c;
}

// std::max_element would compute every line twice.
Line uppermost_at(double c, const std::vector<Line>& lines) {
  const Line* uppermost = &lines.front();
  double max_value = uppermost->at(c);
  for (const Line& line : lines)
    if (const double height = line.at(c); height > max_value) {
      max_value = height;
      uppermost = &line;
    }
  return *uppermost;
}

// Minimises the convex squared_radius() by golden-section search.
double best_centre(const std::vector<Line>& lines, double low, double high) {
  constexpr double kGolden = 0.6180339887498949;
  for (int i = 0; i < 40; ++i) {
    const double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
    (squared_radius(lines, a) < squared_radius(lines, b) ? high : low) =
        squared_radius(lines, a) < squared_radius(lines, b) ? b : a;
  }
  return (low + high) / 2;
}

// A sample of the nodes finds the best height to less than a millimetre.
double centre_height(const PosableModel& model, const GaitTable& table) {
  constexpr int kPhaseStride = 16, kStepStride = 12, kHeights = 12;
  std::vector<Line> uppermost;
  std::vector<Isometry3d> links;
  double low = 0, high = 0;
  for (int step = speed_steps(table) - 1; step >= 0; step -= kStepStride)
    for (int phase = 0; phase < table.phases; phase += kPhaseStride) {
      model.pose(columns_at(table, step, phase), links);
      std::vector<Line> lines;
      for (const Part& part : model.model().parts)
        for (const Eigen::Vector3f& vertex : part.mesh.vertices) {
          const Vector3d p = links[static_cast<size_t>(part.link)] * vertex.cast<double>();
          lines.push_back({p.z(), p.squaredNorm()});
          low = std::min(low, p.z());
          high = std::max(high, p.z());
        }
      if (lines.empty()) continue;
      for (int i = 0; i <= kHeights; ++i) {
        const double c = low + (high - low) * i / kHeights;
        uppermost.push_back(uppermost_at(c, lines));
      }
    }
  return best_centre(uppermost, low, high);
}

// Sagitta bounds the distance of a part's vertices between two nodes from the chord between the
// nodes. Joints move linearly there: |p - chord| <= |p''| / 8. Two joints i above j contribute 2
// |di| |dj| lever_j to |p''|, one alone di^2 lever_i.
class Sagitta {
 public:
  Sagitta(const PosableModel& model, const Part& part) {
    double lever = 0;
    for (const Eigen::Vector3f& vertex : part.mesh.vertices)
      lever = std::max(lever, static_cast<double>(vertex.norm()));
    for (int link = part.link; link > 0;) {
      const Joint& joint = model.model().robot.joints[static_cast<size_t>(link - 1)];
      const bool prismatic = joint.kind == Joint::Kind::kPrismatic;
      const int column = model.column_of_joint(link - 1);
      if (prismatic) lever += std::max(std::abs(joint.lower), std::abs(joint.upper));
      if (column >= 0)
        chain_.push_back({column, prismatic, std::abs(model.gain_of_joint(link - 1)), lever});
      lever += joint.parent_from_joint.translation().norm();
      link = joint.parent_link;
    }
    std::reverse(chain_.begin(), chain_.end());
  }

  double bound(const std::vector<double>& travel) const {
    double turned_above = 0, sum = 0;
    for (const Mover& mover : chain_) {
      const double d = mover.gain * travel[static_cast<size_t>(mover.column)];
      sum += 2 * turned_above * d * (mover.prismatic ? 1 : mover.lever);
      if (mover.prismatic) continue;
      sum += d * d * mover.lever;
      turned_above += d;
    }
    return sum / 8;
  }

 private:
  struct Mover {
    int column;
    bool prismatic;
    double gain, lever;
  };
  std::vector<Mover> chain_;  // root first
};

// Bounds for each part over all cells: along the phase, plus along the speed.
std::vector<double> deviations_between_nodes(const PosableModel& model, const GaitTable& table) {
  std::vector<Sagitta> parts;
  for (const Part& part : model.model().parts) parts.emplace_back(model, part);
  std::vector<double> along_phase(parts.size(), 0), along_speed(parts.size(), 0);
  const auto raise = [&parts](std::vector<double>& bounds, const std::vector<double>& travel) {
    for (size_t i = 0; i < parts.size(); ++i)
      bounds[i] = std::max(bounds[i], parts[i].bound(travel));
  };
  std::vector<double> travel(static_cast<size_t>(table.columns));
  for (int step = 0; step < speed_steps(table); ++step) {
    std::vector<double> next = columns_at(table, step, 0), next_up = next;
    const bool last = step + 1 == speed_steps(table);
    if (!last) next_up = columns_at(table, step + 1, 0);
    for (int phase = 0; phase < table.phases; ++phase) {
      const std::vector<double> here = std::move(next), here_up = std::move(next_up);
      next = columns_at(table, step, phase + 1);
      next_up = last ? next : columns_at(table, step + 1, phase + 1);
      for (size_t c = 0; c < travel.size(); ++c) travel[c] = std::abs(next[c] - here[c]);
      raise(along_phase, travel);
      if (last) continue;
      for (size_t c = 0; c < travel.size(); ++c)
        travel[c] = std::max(std::abs(here_up[c] - here[c]), std::abs(next_up[c] - next[c]));
      raise(along_speed, travel);
    }
  }
  for (size_t i = 0; i < parts.size(); ++i) along_phase[i] += along_speed[i];
  return along_phase;
}

// Returns a part's vertices in its link's frame; for a head, points whose hull contains every
// vertex at any head yaw. A yaw arc lies inside the circumscribed polygon, given by its corners and
// the arc's ends.
std::vector<Vector3d> reached_by(const PosableModel& model, const GaitTable& table,
                                 const Part& part) {
  const std::vector<Joint>& joints = model.model().robot.joints;
  const int yaw_joint = table.speeds > 1 ? model.head_yaw_joint() : -1;
  const bool turns =
      yaw_joint >= 0 && joints[static_cast<size_t>(yaw_joint)].child_link == part.link;
  constexpr int kCorners = 4;  // to either side
  const double max_rad = static_cast<double>(Gait::kMaxHeadYaw_rad);
  const double half = 0.5 * max_rad / kCorners;
  std::vector<Vector3d> points;
  for (const Eigen::Vector3f& vertex : part.mesh.vertices) {
    const Vector3d p = vertex.cast<double>();
    if (!turns) {
      points.push_back(p);
      continue;
    }
    const Vector3d& axis = joints[static_cast<size_t>(yaw_joint)].axis;
    const Vector3d along = p.dot(axis) * axis;
    for (int corner = -kCorners; corner <= kCorners; ++corner) {
      const Vector3d out = turn_about(axis, 2 * half * corner) * (p - along);
      points.push_back(along + out / sin_cos(half).cos);
      if (std::abs(corner) == kCorners) points.push_back(along + out);
    }
  }
  return points;
}

// Nearby vertices; their sphere excludes most postures from the search.
struct Cluster {
  Vector3d middle;
  double radius = 0;
  std::vector<Vector3d> vertices;

  explicit Cluster(std::vector<Vector3d> points) : vertices(std::move(points)) {
    Eigen::AlignedBox3d box;
    for (const Vector3d& vertex : vertices) box.extend(vertex);
    middle = box.center();
    for (const Vector3d& vertex : vertices) radius = std::max(radius, (vertex - middle).norm());
  }

  // Splits points across their longest side until the radius is at most `largest`.
  static void cut(std::vector<Vector3d> points, double largest, std::vector<Cluster>& pieces) {
    Cluster whole(std::move(points));
    if (whole.radius <= largest) {
      pieces.push_back(std::move(whole));
      return;
    }
    Eigen::AlignedBox3d box;
    for (const Vector3d& vertex : whole.vertices) box.extend(vertex);
    Eigen::Index axis = 0;
    box.sizes().maxCoeff(&axis);
    const auto middle =
        std::partition(whole.vertices.begin(), whole.vertices.end(),
                       [&](const Vector3d& vertex) { return vertex[axis] < box.center()[axis]; });
    cut({whole.vertices.begin(), middle}, largest, pieces);
    cut({middle, whole.vertices.end()}, largest, pieces);
  }
};

// A part as the search for the farthest vertex sees it.
struct Extent {
  size_t link;
  double deviation;
  double drop;
  bool stands;  // moves when a standing person shifts weight
  Cluster whole;
  std::vector<Cluster> pieces;
};

// Displacement by standing at one speed: of everything but the legs, and of any point.
struct Sway {
  double shift = 0, deviation = 0;
};

Sway sway_at(const StandingJoints& standing, int step) {
  if (standing.shares.empty()) return {};
  const auto speed = static_cast<size_t>(step / kSpeedSplit);
  const double part = static_cast<double>(step % kSpeedSplit) / kSpeedSplit;
  const double slow = standing.shares[speed];
  const double fast = part > 0 ? standing.shares[speed + 1] : slow;
  // Between two steps the share may be slightly above that at the faster one.
  const double share = speed > 0 ? std::max({slow, fast, standing.shares[speed - 1]}) : 1.0;
  return {share * standing.max_shift_m(), share * standing.max_breath_m()};
}

std::vector<bool> hanging_from(const PosableModel& model, std::span<const int> roots) {
  const Robot& robot = model.model().robot;
  std::vector<bool> hangs(robot.links.size(), false);
  for (const int root : roots) hangs[static_cast<size_t>(root)] = true;
  for (const Joint& joint : robot.joints)  // parents first
    if (hangs[static_cast<size_t>(joint.parent_link)])
      hangs[static_cast<size_t>(joint.child_link)] = true;
  return hangs;
}

std::vector<Extent> extents_of(const PosableModel& model, const GaitTable& table,
                               const std::vector<double>& deviations,
                               const std::vector<bool>& of_leg, double max_drop_m) {
  constexpr double kPieces = 8;  // ratio of the part's radius to a piece's
  std::vector<Extent> extents;
  for (size_t i = 0; i < deviations.size(); ++i) {
    const Part& part = model.model().parts[i];
    std::vector<Vector3d> points = reached_by(model, table, part);
    if (points.empty()) continue;
    Extent extent{static_cast<size_t>(part.link),
                  deviations[i],
                  of_leg[static_cast<size_t>(part.link)] ? 0 : max_drop_m,
                  !of_leg[static_cast<size_t>(part.link)],
                  Cluster(points),
                  {}};
    Cluster::cut(std::move(points), extent.whole.radius / kPieces, extent.pieces);
    extents.push_back(std::move(extent));
  }
  return extents;
}

// Raises `farthest` to the largest distance of any vertex in a posture. Requires: distance(point)
// grows by at most the point's displacement.
template <typename Distance>
void raise_farthest(const std::vector<Extent>& extents, const std::vector<Isometry3d>& links,
                    const Sway& sway, const Distance& distance, double& farthest) {
  for (const Extent& extent : extents) {
    const Isometry3d& pose = links[extent.link];
    // A convex function of drop and shift: its maximum is at their ends.
    const auto max_over_drop = [&](const Vector3d& point) {
      const double high = distance(point);
      return extent.drop > 0 ? std::max(high, distance(point - extent.drop * Vector3d::UnitZ()))
                             : high;
    };
    const auto max_distance = [&](const Vector3d& point) {
      if (!extent.stands || (sway.shift == 0 && sway.deviation == 0)) return max_over_drop(point);
      const Vector3d shift = sway.shift * Vector3d::UnitY();
      return std::max(max_over_drop(point - shift), max_over_drop(point + shift)) + sway.deviation;
    };
    const auto beyond = [&](const Cluster& cluster) {
      return max_distance(pose * cluster.middle) + cluster.radius + extent.deviation > farthest;
    };
    if (!beyond(extent.whole)) continue;
    for (const Cluster& piece : extent.pieces) {
      if (!beyond(piece)) continue;
      for (const Vector3d& vertex : piece.vertices)
        farthest = std::max(farthest, max_distance(pose * vertex) + extent.deviation);
    }
  }
}

double rounded_up(double farthest) {
  return std::ceil((farthest + kFloatMargin) / kGrain) * kGrain;
}

// Slabs of a part in its link's frame. They bound the part in any pose without its vertices.
struct BoundedPart {
  size_t link;
  double deviation;
  Slabs slabs;

  Eigen::AlignedBox3d box(const Isometry3d& pose) const {
    Vector3d middle, half;
    for (int axis = 0; axis < 3; ++axis) {
      const Slab extent = slabs.bound<26>(pose.linear().row(axis).transpose().cast<float>());
      middle[axis] = pose.translation()[axis] + static_cast<double>(extent.centre);
      half[axis] = static_cast<double>(extent.half) + deviation;
    }
    return {middle - half, middle + half};
  }
};

std::vector<BoundedPart> bounded_parts(const PosableModel& model, const GaitTable& table,
                                       const std::vector<double>& deviations) {
  std::vector<BoundedPart> parts;
  for (size_t i = 0; i < deviations.size(); ++i) {
    const Part& part = model.model().parts[i];
    if (part.mesh.vertices.empty()) continue;
    std::vector<Eigen::Vector3f> points;
    for (const Vector3d& point : reached_by(model, table, part))
      points.push_back(point.cast<float>());
    parts.push_back({static_cast<size_t>(part.link), deviations[i], Slabs::around(points)});
  }
  return parts;
}

RootBox root_box(const Eigen::AlignedBox3d& box) {
  RootBox out{};
  if (box.isEmpty()) return out;
  for (int axis = 0; axis < 3; ++axis) {
    out.min_m[axis] =
        static_cast<float>(std::floor((box.min()[axis] - kFloatMargin) / kGrain) * kGrain);
    out.max_m[axis] =
        static_cast<float>(std::ceil((box.max()[axis] + kFloatMargin) / kGrain) * kGrain);
  }
  return out;
}

class CellBoxes {
 public:
  explicit CellBoxes(const GaitTable& table)
      : phases_(table.phases),
        speeds_(std::max(table.speeds - 1, 1)),
        boxes_(static_cast<size_t>(speeds_) * static_cast<size_t>(phases_)) {}

  // A node belongs to the cells before and behind it; nodes at phase 0 also to the last cell.
  void add(int step, int phase, const Eigen::AlignedBox3d& node) {
    const int fast = step / kSpeedSplit, slow = step % kSpeedSplit == 0 ? fast - 1 : fast;
    const int before = phase == 0 ? phases_ - 1 : phase - 1;
    for (int s = std::max(slow, 0); s <= std::min(fast, speeds_ - 1); ++s)
      for (const int p : {before, phase})
        boxes_[static_cast<size_t>(s) * static_cast<size_t>(phases_) + static_cast<size_t>(p)]
            .extend(node);
  }

  std::vector<RootBox> boxes() const {
    std::vector<RootBox> out;
    out.reserve(boxes_.size());
    for (const Eigen::AlignedBox3d& box : boxes_) out.push_back(root_box(box));
    return out;
  }

 private:
  int phases_, speeds_;
  std::vector<Eigen::AlignedBox3d> boxes_;
};

}  // namespace

GaitBounds bounds_around(const PosableModel& model, const GaitTable& table,
                         std::span<const int> leg_roots, double max_drop_m,
                         const StandingJoints& standing) {
  const std::vector<double> deviations = deviations_between_nodes(model, table);
  const std::vector<bool> of_leg = hanging_from(model, leg_roots);
  const std::vector<Extent> extents = extents_of(model, table, deviations, of_leg, max_drop_m);
  const std::vector<BoundedPart> parts = bounded_parts(model, table, deviations);
  const Vector3d centre(0, 0, std::nearbyint(centre_height(model, table) / kGrain) * kGrain);
  double farthest = 0, widest = 0;
  CellBoxes whole(table), rest(table);
  std::vector<Isometry3d> links;
  for (int step = speed_steps(table) - 1; step >= 0; --step) {
    const Sway sway = sway_at(standing, step);
    for (int phase = 0; phase < table.phases; ++phase) {
      model.pose(columns_at(table, step, phase), links);
      raise_farthest(
          extents, links, sway, [&](const Vector3d& p) { return (p - centre).norm(); }, farthest);
      raise_farthest(
          extents, links, sway, [](const Vector3d& p) { return p.head<2>().norm(); }, widest);
      Eigen::AlignedBox3d body, trunk;
      for (const BoundedPart& part : parts) {
        const Eigen::AlignedBox3d box = part.box(links[part.link]);
        body.extend(box);
        if (!of_leg[part.link]) trunk.extend(box);
      }
      whole.add(step, phase, body);
      rest.add(step, phase, trunk);
    }
  }
  return {centre.z(), rounded_up(farthest), rounded_up(widest), whole.boxes(), rest.boxes()};
}

}  // namespace throng
