// The bundled adult's files match Table 1 of Suaib et al. 2013 and the anthropometric tables.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <span>
#include <sstream>

#include "avatars/mesh/tri.h"
#include "avatars/models/adult_body.h"
#include "base/portable_math.h"

namespace throng::adult_test {
namespace {

const std::filesystem::path kFolder =
    std::filesystem::path(THRONG_SOURCE_DIR) / "avatars/models/adult";

const std::map<std::string, size_t> kTable1 = {
    {"head.tri", 542},           {"torso.tri", 841},          {"pelvis.tri", 74},
    {"upperRightLeg.tri", 706},  {"upperLeftLeg.tri", 706},   {"lowerRightLeg.tri", 706},
    {"lowerLeftLeg.tri", 706},   {"leftFoot.tri", 122},       {"rightFoot.tri", 122},
    {"upperLeftArm.tri", 1346},  {"upperRightArm.tri", 1346}, {"lowerLeftArm.tri", 1138},
    {"lowerRightArm.tri", 1138}, {"leftHand.tri", 589},       {"RightHand.tri", 589}};

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  EXPECT_TRUE(in) << file;
  return {std::istreambuf_iterator<char>(in), {}};
}

Mesh committed(const std::string& name) { return read_tri(kFolder / name).mesh; }

Eigen::Vector3f size_of(const Mesh& mesh) {
  Eigen::Vector3f low = mesh.vertices[0];
  Eigen::Vector3f high = low;
  for (const Eigen::Vector3f& v : mesh.vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  return high - low;
}

/// Returns the length of the polygon in which the plane z = height cuts a mesh.
double girth_m(const Mesh& mesh, float height) {
  double girth = 0;
  for (const Eigen::Vector3i& t : mesh.triangles) {
    std::vector<Eigen::Vector3f> cut;
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3f& a = mesh.vertices[static_cast<size_t>(t[i])];
      const Eigen::Vector3f& b = mesh.vertices[static_cast<size_t>(t[(i + 1) % 3])];
      if ((a.z() > height) != (b.z() > height))
        cut.push_back(a + (b - a) * ((height - a.z()) / (b.z() - a.z())));
    }
    if (cut.size() == 2) girth += static_cast<double>((cut[1] - cut[0]).norm());
  }
  return girth;
}

double widest_girth_m(const Mesh& mesh, float from, float to) {
  double widest = 0;
  for (int i = 0; i <= 40; ++i)
    widest =
        std::max(widest, girth_m(mesh, from + (to - from) * static_cast<float>(i) / 40 + 1e-6F));
  return widest;
}

void expect_within(const char* what, double found, double expected, double tolerance) {
  EXPECT_LE(std::abs(found / expected - 1), tolerance)
      << what << ": expected " << expected << " m (ANSUR II, men), found " << found << " m, off by "
      << 100 * (found / expected - 1) << " %, allowed " << 100 * tolerance << " %";
}

/// Reach of a part from the twist's axis: one row per height, one column per degree.
constexpr int kDegrees = 360;
constexpr double kLowest_m = 0.95;
constexpr double kHeightStep_m = 0.001;
constexpr int kHeights = 200;
using Reach = std::vector<std::array<double, kDegrees>>;

Reach reach_of(const AdultPart& part) {
  Reach reach(kHeights);
  for (int h = 0; h < kHeights; ++h) {
    reach[static_cast<size_t>(h)].fill(0);
    // Between the steps, because no vertex may lie on the plane.
    const double height = kLowest_m + kHeightStep_m * (h + 0.37);
    for (const Eigen::Vector3i& t : part.mesh.triangles) {
      std::vector<Eigen::Vector2d> cut;
      for (int i = 0; i < 3; ++i) {
        const auto corner = [&](int k) -> Eigen::Vector3d {
          return part.mesh.vertices[static_cast<size_t>(t[k % 3])].cast<double>() + part.origin;
        };
        const Eigen::Vector3d a = corner(i);
        const Eigen::Vector3d b = corner(i + 1);
        if ((a.z() > height) != (b.z() > height))
          cut.emplace_back((a + (b - a) * ((height - a.z()) / (b.z() - a.z()))).head<2>());
      }
      if (cut.size() != 2) continue;
      for (size_t d = 0; d < kDegrees; ++d) {
        const Eigen::Rotation2Dd turn(static_cast<double>(d) * kDegree);
        const Eigen::Vector2d p = turn.inverse() * cut[0];
        const Eigen::Vector2d q = turn.inverse() * cut[1];
        if ((p.y() > 0) == (q.y() > 0)) continue;
        double& out = reach[static_cast<size_t>(h)][d];
        out = std::max(out, p.x() - p.y() * (q.x() - p.x()) / (q.y() - p.y()));
      }
    }
  }
  return reach;
}

/// The hand's last vertices: five digits from the index finger on, nine rings of eight and a tip.
constexpr int kDigits = 5;
constexpr int kThumb = 4;
constexpr int kDigitRings = 9;
constexpr int kRingVertices = 8;
constexpr int kDigitVertices = kDigitRings * kRingVertices + 1;

std::span<const Eigen::Vector3f> digit_of(const Mesh& hand, int digit) {
  return std::span(hand.vertices)
      .last(kDigits * kDigitVertices)
      .subspan(static_cast<size_t>(digit) * kDigitVertices, kDigitVertices);
}

/// Returns the centre line of a digit: its rings' centres and its tip.
std::vector<Eigen::Vector3f> line_of(const Mesh& hand, int digit) {
  const auto vertices = digit_of(hand, digit);
  std::vector<Eigen::Vector3f> line;
  for (int r = 0; r < kDigitRings; ++r) {
    Eigen::Vector3f centre = Eigen::Vector3f::Zero();
    for (const Eigen::Vector3f& v :
         vertices.subspan(static_cast<size_t>(r) * kRingVertices, kRingVertices))
      centre += v / kRingVertices;
    line.push_back(centre);
  }
  line.push_back(vertices.back());
  return line;
}

/// Returns the length from the upper end of the hand along the stretched middle finger.
double stretched_hand_m() {
  const Mesh hand = committed("leftHand.tri");
  const std::vector<Eigen::Vector3f> line = line_of(hand, 1);
  float upper = -1;
  for (const Eigen::Vector3f& v : hand.vertices) upper = std::max(upper, v.z());
  float length = upper - line[0].z();
  for (size_t i = 0; i + 1 < line.size(); ++i) length += (line[i + 1] - line[i]).norm();
  return static_cast<double>(length);
}

float distance_m(std::span<const Eigen::Vector3f> a, std::span<const Eigen::Vector3f> b) {
  float nearest = 1;
  for (const Eigen::Vector3f& p : a)
    for (const Eigen::Vector3f& q : b) nearest = std::min(nearest, (p - q).norm());
  return nearest;
}

TEST(Adult, HasTheFilesAndVertexCountsOfTable1) {
  std::set<std::string> found;
  for (const auto& entry : std::filesystem::directory_iterator(kFolder))
    if (entry.path().extension() == ".tri") found.insert(entry.path().filename().string());
  std::set<std::string> expected;
  for (const auto& [name, count] : kTable1) {
    expected.insert(name);
    EXPECT_EQ(committed(name).vertices.size(), count) << name;
  }
  EXPECT_EQ(found, expected);
}

TEST(Adult, MatchesTheOutputOfTheGenerator) {
  const std::vector<AdultPart> parts = adult_parts();
  ASSERT_EQ(parts.size(), kTable1.size());
  for (const AdultPart& part : parts)
    EXPECT_TRUE(bytes_of(kFolder / part.file) == format_tri(part.mesh)) << part.file;
  EXPECT_TRUE(bytes_of(kFolder / "adult.urdf") == adult_urdf_text());
}

TEST(Adult, HasClosedPartsOrientedOutwards) {
  for (const auto& [name, count] : kTable1) {
    const Mesh mesh = committed(name);
    EXPECT_TRUE(is_closed(mesh)) << name;
    EXPECT_GT(signed_volume_m3(mesh), 0) << name;
    // A sphere without handles, every vertex used: V - E + F = 2 with E = 3F/2.
    EXPECT_EQ(mesh.vertices.size() - mesh.triangles.size() / 2, 2u) << name;
  }
}

TEST(Adult, HasNoDegenerateTrianglesOrDuplicateVertices) {
  for (const auto& [name, count] : kTable1) {
    const Mesh mesh = committed(name);
    for (const Eigen::Vector3i& t : mesh.triangles) {
      const auto at = [&](int i) -> Eigen::Vector3d {
        return mesh.vertices[static_cast<size_t>(t[i])].cast<double>();
      };
      const double area = 0.5 * (at(1) - at(0)).cross(at(2) - at(0)).norm();
      EXPECT_GT(area, 1e-8) << name << ": triangle " << t.transpose() << " has " << area << " m2";
    }
    std::set<std::array<float, 3>> places;
    for (const Eigen::Vector3f& v : mesh.vertices) places.insert({v.x(), v.y(), v.z()});
    EXPECT_EQ(places.size(), mesh.vertices.size()) << name;
  }
}

TEST(Adult, MirrorsLeftPartsToRightParts) {
  const std::map<std::string, std::string> pairs = {
      {"upperLeftLeg.tri", "upperRightLeg.tri"}, {"lowerLeftLeg.tri", "lowerRightLeg.tri"},
      {"leftFoot.tri", "rightFoot.tri"},         {"upperLeftArm.tri", "upperRightArm.tri"},
      {"lowerLeftArm.tri", "lowerRightArm.tri"}, {"leftHand.tri", "RightHand.tri"}};
  for (const auto& [left_name, right_name] : pairs) {
    const Mesh left = committed(left_name);
    const Mesh right = committed(right_name);
    ASSERT_EQ(left.vertices.size(), right.vertices.size());
    for (size_t i = 0; i < left.vertices.size(); ++i) {
      const Eigen::Vector3f& v = left.vertices[i];
      ASSERT_EQ(right.vertices[i], Eigen::Vector3f(v.x(), -v.y(), v.z())) << left_name << ' ' << i;
    }
    for (size_t i = 0; i < left.triangles.size(); ++i) {
      const Eigen::Vector3i& t = left.triangles[i];
      ASSERT_EQ(right.triangles[i], Eigen::Vector3i(t[0], t[2], t[1])) << left_name << ' ' << i;
    }
  }
}

TEST(Adult, HasSymmetricPartsOnTheMidline) {
  for (const char* name : {"head.tri", "torso.tri", "pelvis.tri"}) {
    const Mesh mesh = committed(name);
    std::set<std::array<float, 3>> places;
    for (const Eigen::Vector3f& v : mesh.vertices) places.insert({v.x(), v.y(), v.z()});
    for (const Eigen::Vector3f& v : mesh.vertices)
      EXPECT_TRUE(places.count({v.x(), v.y() == 0 ? 0.0F : -v.y(), v.z()}))
          << name << ": " << v.transpose();
  }
}

TEST(Adult, StandsOnTheGroundAtItsStatedHeight) {
  float low = 1;
  float high = 0;
  float widest = 0;
  for (const AdultPart& part : adult_parts())
    for (const Eigen::Vector3f& v : part.mesh.vertices) {
      const Eigen::Vector3f p = v + part.origin.cast<float>();
      low = std::min(low, p.z());
      high = std::max(high, p.z());
      if (part.file.rfind("upper", 0) == 0) widest = std::max(widest, std::abs(p.y()));
    }
  EXPECT_NEAR(low, 0, 2e-5);
  EXPECT_NEAR(high, kAdultHeight_m, 2e-5);
  // Bideltoid breadth of men: 5th to 95th percentile.
  EXPECT_GT(2 * widest, 0.459F);
  EXPECT_LT(2 * widest, 0.567F);
}

TEST(Adult, HasTheGirthsAndSizesOfTheSurvey) {
  const Mesh head = committed("head.tri");
  expect_within("thigh circumference",
                widest_girth_m(committed("upperLeftLeg.tri"), -0.15F, -0.03F), 0.625, 0.05);
  expect_within("calf circumference", widest_girth_m(committed("lowerLeftLeg.tri"), -0.20F, -0.08F),
                0.392, 0.05);
  expect_within("ankle circumference", girth_m(committed("lowerLeftLeg.tri"), -0.36F), 0.229, 0.05);
  expect_within("neck circumference", girth_m(head, 0.005F), 0.398, 0.08);
  expect_within("forearm circumference",
                widest_girth_m(committed("lowerLeftArm.tri"), -0.12F, -0.02F), 0.310, 0.08);
  expect_within("wrist circumference", girth_m(committed("lowerLeftArm.tri"), -0.255F), 0.176,
                0.08);
  const Eigen::Vector3f foot = size_of(committed("leftFoot.tri"));
  expect_within("foot length", static_cast<double>(foot.x()), 0.271, 0.03);
  expect_within("foot breadth", static_cast<double>(foot.y()), 0.102, 0.05);
  expect_within("hand length, fingers stretched", stretched_hand_m(), 0.193, 0.03);
  const Eigen::Vector3f hips = size_of(committed("pelvis.tri"));
  expect_within("hip breadth", static_cast<double>(hips.y()), 0.346, 0.03);
  expect_within("buttock depth", static_cast<double>(hips.x()), 0.246, 0.05);
  expect_within("chest depth", static_cast<double>(size_of(committed("torso.tri")).x()), 0.254,
                0.05);
}

TEST(Adult, KeepsTheWaistClosedInEveryTwist) {
  // At any twist the overlapping ends at the waist stay inside the other part, and the common
  // outline has no ledge. The trunk turns about the vertical axis of the joint; a twist shifts its
  // columns.
  Reach torso;
  Reach pelvis;
  for (const AdultPart& part : adult_parts()) {
    if (part.file == "torso.tri") torso = reach_of(part);
    if (part.file == "pelvis.tri") pelvis = reach_of(part);
  }
  const auto is_cut = [](const std::array<double, kDegrees>& row) { return row[0] > 0; };
  const auto height_of = [](auto row, const Reach& reach) {
    return static_cast<int>(row - reach.begin());
  };
  const int bottom =
      height_of(std::find_if(torso.begin(), torso.end(), is_cut), torso);  // of the torso
  const int top = height_of(std::find_if_not(pelvis.begin(), pelvis.end(), is_cut), pelvis) - 1;
  const int joint =
      static_cast<int>(std::lround((adult_joints().thorax.z() - kLowest_m) / kHeightStep_m));
  ASSERT_GT(top, joint) << "torso and pelvis do not overlap";
  ASSERT_GT(joint, bottom) << "torso and pelvis do not overlap";
  double torso_out_m = -1;   // end of the torso beyond the pelvis
  double pelvis_out_m = -1;  // pelvis above the joint beyond the torso
  double ledge_m = 0;        // step of the outline in a millimetre of height
  double narrowest_m = 1;
  for (int twist = -45; twist <= 45; ++twist) {
    for (int d = 0; d < kDegrees; ++d) {
      const auto turned = static_cast<size_t>((d - twist + kDegrees) % kDegrees);
      const auto column = static_cast<size_t>(d);
      const auto row = [](int h) { return static_cast<size_t>(h); };
      torso_out_m = std::max(torso_out_m, torso[row(bottom)][turned] - pelvis[row(bottom)][column]);
      for (int h = joint; h <= top; ++h)
        pelvis_out_m = std::max(pelvis_out_m, pelvis[row(h)][column] - torso[row(h)][turned]);
      double before = 0;
      for (int h = 0; h < kHeights; ++h) {
        const double out = std::max(torso[row(h)][turned], pelvis[row(h)][column]);
        narrowest_m = std::min(narrowest_m, out);
        if (h > 0) ledge_m = std::max(ledge_m, std::abs(out - before));
        before = out;
      }
    }
  }
  EXPECT_LT(torso_out_m, -0.003) << "the lower end of the torso stands out of the pelvis";
  EXPECT_LT(pelvis_out_m, -0.003) << "the pelvis stands out of the torso above the joint";
  EXPECT_LT(ledge_m, 0.0025) << "the waist has a ledge";
  EXPECT_GT(narrowest_m, 0.095) << "the waist is open";
}

TEST(Adult, HasRelaxedHands) {
  // The left hand, hanging: the palm faces the thigh, -y.
  const Mesh hand = committed("leftHand.tri");
  for (int finger = 0; finger < kThumb; ++finger) {
    const std::vector<Eigen::Vector3f> line = line_of(hand, finger);
    const Eigen::Vector3f end = (line[kDigitRings] - line[kDigitRings - 3]).normalized();
    const double bent_deg = static_cast<double>(std::atan2(-end.y(), -end.z())) / kDegree;
    EXPECT_GT(bent_deg, 40) << "finger " << finger << " is stretched";
    EXPECT_LT(bent_deg, 90) << "finger " << finger << " is clenched";
    if (finger + 1 == kThumb) continue;
    // Adjacent along the whole of the shorter finger, but disjoint.
    const std::vector<Eigen::Vector3f> next = line_of(hand, finger + 1);
    for (size_t r = 0; r < kDigitRings; ++r)
      EXPECT_LT(std::abs(line[r].x() - next[r].x()), 0.021F) << "finger " << finger << " is spread";
    EXPECT_LT(distance_m(digit_of(hand, finger), digit_of(hand, finger + 1)), 0.002F) << finger;
    for (const Eigen::Vector3f& v : digit_of(hand, finger)) {
      for (const Eigen::Vector3f& w : digit_of(hand, finger + 1)) {
        const bool abreast = (v - w).tail<2>().norm() < 0.004F;
        EXPECT_TRUE(!abreast || v.x() > w.x())
            << "fingers " << finger << " and " << finger + 1 << " overlap";
      }
    }
  }
  // The thumb ends next to the base of the index finger.
  const std::span<const Eigen::Vector3f> thumb = digit_of(hand, kThumb);
  EXPECT_LT(distance_m(thumb, digit_of(hand, 0)), 0.012F);
  const Eigen::Vector3f tip = thumb.back();
  EXPECT_LT(tip.x() - line_of(hand, 0)[0].x(), 0.025F) << "the thumb is spread";
}

TEST(Adult, PointsNoseToesAndThumbsForward) {
  // x forward: the foremost point of the head is the nose, on the midline.
  const auto foremost = [](const Mesh& mesh) {
    return *std::max_element(
        mesh.vertices.begin(), mesh.vertices.end(),
        [](const Eigen::Vector3f& a, const Eigen::Vector3f& b) { return a.x() < b.x(); });
  };
  const Eigen::Vector3f nose = foremost(committed("head.tri"));
  EXPECT_EQ(nose.y(), 0);
  EXPECT_GT(nose.x(), 0.12F);
  EXPECT_GT(foremost(committed("leftFoot.tri")).x(), 0.15F);
  EXPECT_GT(foremost(committed("leftHand.tri")).x(), 0.05F);
}

}  // namespace
}  // namespace throng::adult_test
