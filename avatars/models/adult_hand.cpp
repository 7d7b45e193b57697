// hand_shape() draws the hand: a flat tube for the palm, four fingers at its far end and the thumb
// at its side. Left hand, hanging: the thumb is in front, along the index finger, and the palm
// faces the thigh (-y).
#include <Eigen/Geometry>
#include <array>

#include "avatars/models/adult_body.h"
#include "avatars/models/loft.h"
#include "base/portable_math.h"

namespace throng {
namespace {

// The palm's rings have 20 points: 9 columns on the back, 1 at the little finger's side, 9 on the
// inside, 1 at the thumb's side. The end face is a grid of 9 columns and 3 rows. Each finger stands
// on the rim of 2 x 2 of its cells, the thumb on the palm's side likewise. Vertices: 11 x 20 + 45 x
// 8 + 3 webs + 5 tips + 2 at the wrist - 1 under the thumb = 589.
constexpr int kColumns = 9;
constexpr int kPalmRings = 11;
constexpr int kPalmSegments = 20;
constexpr int kLittleSide = 9;
constexpr int kThumbSide = 19;
constexpr int kThumbRing = 4;  ///< middle row of the cells under the thumb
constexpr int kDigitRings = 9;
constexpr int kDigitSegments = 8;

constexpr int back(int column) { return column; }
constexpr int inside(int column) { return kThumbSide - 1 - column; }

struct PalmRow {
  double down, half_width, half_thickness, forward;
};
constexpr std::array<PalmRow, kPalmRings> kPalm = {{
    {-0.006, 0.0240, 0.0150, 0.000},
    {0.008, 0.0275, 0.0180, 0.000},
    {0.018, 0.0305, 0.0190, 0.001},
    {0.028, 0.0345, 0.0190, 0.003},
    {0.040, 0.0380, 0.0185, 0.004},
    {0.052, 0.0400, 0.0170, 0.004},
    {0.063, 0.0410, 0.0155, 0.003},
    {0.073, 0.0415, 0.0145, 0.002},
    {0.083, 0.0420, 0.0138, 0.001},
    {0.093, 0.0425, 0.0130, 0.000},
    {0.101, 0.0420, 0.0118, 0.000},
}};

struct Digit {
  double length, radius, curl_rad;
};
/// Index to little finger of a relaxed hand: each is bent slightly more than the one before.
constexpr std::array<Digit, 4> kFingers = {
    {{0.074, 0.0093, 0.92}, {0.083, 0.0095, 0.94}, {0.076, 0.0093, 0.97}, {0.060, 0.0087, 1.00}}};
constexpr std::array<double, 4> kKnuckles_rad = {0.34, 0.36, 0.38, 0.40};
/// Ratio of a finger's breadth to its thickness: leaves less than 2 mm between fingers.
constexpr double kFingerBreadth = 1.07;
constexpr Digit kThumb = {0.060, 0.0108, 0.55};

/// Thickness along a digit: knuckles, a waist between them, a rounded tip.
constexpr std::array<double, kDigitRings> kDigitGirth = {0.98, 0.97, 0.94, 0.97, 0.92,
                                                         0.88, 0.88, 0.78, 0.52};
constexpr std::array<double, kDigitRings> kDigitAlong = {0.06, 0.18, 0.32, 0.46, 0.60,
                                                         0.74, 0.86, 0.94, 0.985};

/// Axis of a digit: from `base` along `start`, turning by `curl_rad` in total towards `bend`.
struct DigitPath {
  Eigen::Vector3d base, start, bend;  ///< the two directions are orthogonal
  double breadth = 1;                 ///< of the digit over its thickness
};

void append_digit(Mesh& mesh, const std::array<int, kDigitSegments>& rim, const Digit& digit,
                  const DigitPath& path) {
  // The rim's points are ordered like the octagon: corner, edge, corner, ...
  static constexpr std::array<std::array<double, 2>, kDigitSegments> kOctagon = {{{-0.76, 0.76},
                                                                                  {0, 1},
                                                                                  {0.76, 0.76},
                                                                                  {1, 0},
                                                                                  {0.76, -0.76},
                                                                                  {0, -1},
                                                                                  {-0.76, -0.76},
                                                                                  {-1, 0}}};
  const Eigen::Vector3d side = path.start.cross(path.bend);
  Eigen::Vector3d at = path.base;
  Eigen::Vector3d along = path.start;
  double done = 0;
  std::array<int, kDigitSegments> previous = rim;
  const auto forward_to = [&](double fraction) {
    const Eigen::Vector2d turn = on_circle(digit.curl_rad * fraction / kTurn);
    along = path.start * turn.x() + path.bend * turn.y();
    at += along * (digit.length * (fraction - done));
    done = fraction;
  };
  for (size_t r = 0; r < kDigitRings; ++r) {
    forward_to(kDigitAlong[r]);
    const Eigen::Vector3d away = along.cross(side);  // from the inside of the bend outwards
    std::array<int, kDigitSegments> ring;
    for (size_t k = 0; k < kDigitSegments; ++k) {
      ring[k] = static_cast<int>(mesh.vertices.size());
      const double radius = digit.radius * kDigitGirth[r];
      mesh.vertices.push_back(rounded(at + side * (kOctagon[k][0] * radius * path.breadth) +
                                      away * (kOctagon[k][1] * radius)));
    }
    for (size_t k = 0; k < kDigitSegments; ++k) {
      const size_t next = (k + 1) % kDigitSegments;
      mesh.triangles.emplace_back(previous[k], previous[next], ring[next]);
      mesh.triangles.emplace_back(previous[k], ring[next], ring[k]);
    }
    previous = ring;
  }
  forward_to(1);
  const int tip = static_cast<int>(mesh.vertices.size());
  mesh.vertices.push_back(rounded(at));
  for (size_t k = 0; k < kDigitSegments; ++k)
    mesh.triangles.emplace_back(previous[k], previous[(k + 1) % kDigitSegments], tip);
}

/// Columns run from the thumb's side (+x) to the little finger's (-x).
Eigen::Vector3d palm_point(const PalmRow& row, int segment) {
  if (segment == kLittleSide) return {row.forward - row.half_width, 0, -row.down};
  if (segment == kThumbSide) return {row.forward + row.half_width, 0, -row.down};
  const bool on_back = segment < kColumns;
  const int column = on_back ? segment : inside(segment);
  const double t = 1 - column / 4.0;  // 1 at the thumb's side, -1 at the little finger's
  const double thick = row.half_thickness * (1 - 0.38 * t * t * t * t);
  return {row.forward + 0.94 * row.half_width * t, on_back ? thick : -thick, -row.down};
}

void add_quad(Mesh& mesh, int a, int b, int c, int d) {
  mesh.triangles.emplace_back(a, b, c);
  mesh.triangles.emplace_back(a, c, d);
}

}  // namespace

Mesh hand_shape() {
  Mesh mesh;
  // Vertex ids of the palm, ring by ring; the point under the thumb has none.
  std::array<std::array<int, kPalmSegments>, kPalmRings> id;
  for (size_t r = 0; r < kPalmRings; ++r) {
    for (int s = 0; s < kPalmSegments; ++s) {
      const bool under_thumb = r == kThumbRing && s == kThumbSide;
      id[r][static_cast<size_t>(s)] = under_thumb ? -1 : static_cast<int>(mesh.vertices.size());
      if (!under_thumb) mesh.vertices.push_back(rounded(palm_point(kPalm[r], s)));
    }
  }
  const auto at = [&](int ring, int segment) {
    return id[static_cast<size_t>(ring)][static_cast<size_t>(segment)];
  };
  for (int r = 0; r + 1 < kPalmRings; ++r) {
    for (int s = 0; s < kPalmSegments; ++s) {
      const int next = (s + 1) % kPalmSegments;
      const bool under_thumb =
          (r == kThumbRing || r + 1 == kThumbRing) && (s == kThumbSide || next == kThumbSide);
      if (!under_thumb) add_quad(mesh, at(r, s), at(r, next), at(r + 1, next), at(r + 1, s));
    }
  }

  // The wrist ends in a ridge of two points, because the ring is twice as wide as thick.
  const int front = static_cast<int>(mesh.vertices.size());
  const int rear = front + 1;
  mesh.vertices.push_back(rounded({0.012, 0, 0.012}));
  mesh.vertices.push_back(rounded({-0.012, 0, 0.012}));
  const auto ridge = [&](int segment) {
    const int column = segment < kColumns       ? segment
                       : segment == kLittleSide ? kColumns
                       : segment == kThumbSide  ? -1
                                                : inside(segment);
    return column < 4 ? front : rear;
  };
  for (int s = 0; s < kPalmSegments; ++s) {
    const int next = (s + 1) % kPalmSegments;
    mesh.triangles.emplace_back(at(0, s), ridge(s), at(0, next));
    if (ridge(s) != ridge(next)) mesh.triangles.emplace_back(at(0, next), ridge(s), ridge(next));
  }

  constexpr int kEnd = kPalmRings - 1;
  std::array<int, kColumns> middle{};
  middle[0] = at(kEnd, kThumbSide);
  middle[kColumns - 1] = at(kEnd, kLittleSide);
  for (const int c : {2, 4, 6}) {
    middle[static_cast<size_t>(c)] = static_cast<int>(mesh.vertices.size());
    const double x = kPalm[kEnd].forward + 0.94 * kPalm[kEnd].half_width * (1 - c / 4.0);
    mesh.vertices.push_back(rounded({x, 0, -kPalm[kEnd].down + 0.002}));
  }
  for (int f = 0; f < 4; ++f) {
    const int c = 2 * f;
    const std::array<int, kDigitSegments> rim = {
        at(kEnd, back(c)),       at(kEnd, back(c + 1)),
        at(kEnd, back(c + 2)),   middle[static_cast<size_t>(c) + 2],
        at(kEnd, inside(c + 2)), at(kEnd, inside(c + 1)),
        at(kEnd, inside(c)),     middle[static_cast<size_t>(c)]};
    const double t = 1 - (c + 1) / 4.0;
    const Eigen::Vector3d base(kPalm[kEnd].forward + 0.96 * kPalm[kEnd].half_width * t, 0,
                               -kPalm[kEnd].down);
    // Towards the middle of the hand, and at the knuckle towards the palm.
    const Eigen::Vector2d bent = on_circle(kKnuckles_rad[static_cast<size_t>(f)] / kTurn);
    const Eigen::Vector3d down = Eigen::Vector3d(-0.04 * t, 0, -1).normalized();
    const Eigen::Vector3d palmwards(0, -1, 0);
    append_digit(mesh, rim, kFingers[static_cast<size_t>(f)],
                 {base, down * bent.x() + palmwards * bent.y(),
                  palmwards * bent.x() - down * bent.y(), kFingerBreadth});
  }

  const int r = kThumbRing;
  const std::array<int, kDigitSegments> rim = {
      at(r - 1, inside(0)), at(r - 1, kThumbSide), at(r - 1, back(0)),   at(r, back(0)),
      at(r + 1, back(0)),   at(r + 1, kThumbSide), at(r + 1, inside(0)), at(r, inside(0))};
  const Eigen::Vector3d start = Eigen::Vector3d(0.34, -0.26, -0.90).normalized();
  Eigen::Vector3d bend(-1, -0.10, -0.30);
  bend = (bend - start * bend.dot(start)).normalized();
  const Eigen::Vector3d base =
      palm_point(kPalm[kThumbRing], kThumbSide) + Eigen::Vector3d(-0.001, -0.003, -0.009);
  append_digit(mesh, rim, kThumb, {base, start, bend});
  orient_outwards(mesh);
  const Eigen::Vector3d& wrist = adult_joints().wrist;
  for (Eigen::Vector3f& v : mesh.vertices) v = rounded(v.cast<double>() + wrist);
  return mesh;
}

}  // namespace throng
