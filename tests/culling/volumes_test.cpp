// Bounding volumes contain all vertices and separate only disjoint parts.
#include <gtest/gtest.h>

#include <map>

#include "culling/volumes/slabs.h"
#include "culling/volumes/volume_list.h"
#include "shapes.h"

namespace throng::test::volumes_test {
namespace {

constexpr uint64_t kSeed = 20260;

static_assert(BoundingVolume<Sphere> && BoundingVolume<Obb>);
static_assert(RefittedVolume<Aabb>);
static_assert(RefittedVolume<Kdop<14>> && RefittedVolume<Kdop<18>> && RefittedVolume<Kdop<26>>);
static_assert(BoundingVolume<Ordop<14>> && BoundingVolume<Ordop<18>> && BoundingVolume<Ordop<26>>);

Eigen::Vector3d direction(int i) { return direction_vector(i).cast<double>(); }

/// Distance of a world point outside of a placed volume; at most 0 inside.
double outside(const Sphere::Placed& v, const Eigen::Vector3d& q) {
  return (q - v.centre_m.cast<double>()).norm() - static_cast<double>(v.radius_m);
}
double outside(const Aabb::Placed& v, const Eigen::Vector3d& q) {
  return ((q - v.centre_m.cast<double>()).cwiseAbs() - v.half_m.cast<double>()).maxCoeff();
}
double outside(const Obb::Placed& v, const Eigen::Vector3d& q) {
  const Eigen::Vector3d h = v.axes.cast<double>().transpose() * (q - v.centre_m.cast<double>());
  return (h.cwiseAbs() - v.half_m.cast<double>()).maxCoeff();
}
double outside_slabs(const Slabs& slabs, int k, const Eigen::Vector3d& q) {
  double worst = -1e30;
  for (int i = 0; i < 13; ++i) {
    if (!has_direction(k, i)) continue;
    const Slab& slab = slabs.slab[static_cast<size_t>(i)];
    const double off = std::fabs(direction(i).dot(q) - static_cast<double>(slab.centre));
    worst = std::max(worst, (off - static_cast<double>(slab.half)) / direction(i).norm());
  }
  return worst;
}

/// Largest gap between two placed volumes along the volume's axes (at most unit length), in world
/// axes and double precision. Above zero: apart.
double gap(const Sphere::Placed& a, const Sphere::Placed& b, const Eigen::Vector3d& a_to_b) {
  return (a_to_b + b.centre_m.cast<double>() - a.centre_m.cast<double>()).norm() -
         static_cast<double>(a.radius_m) - static_cast<double>(b.radius_m);
}
double gap(const Aabb::Placed& a, const Aabb::Placed& b, const Eigen::Vector3d& a_to_b) {
  const Eigen::Vector3d d = a_to_b + b.centre_m.cast<double>() - a.centre_m.cast<double>();
  return (d.cwiseAbs() - a.half_m.cast<double>() - b.half_m.cast<double>()).maxCoeff();
}
double half_along(const Obb::Placed& v, const Eigen::Vector3d& axis) {
  return (v.axes.cast<double>().transpose() * axis).cwiseAbs().dot(v.half_m.cast<double>());
}
double gap(const Obb::Placed& a, const Obb::Placed& b, const Eigen::Vector3d& a_to_b) {
  const Eigen::Vector3d d = a_to_b + b.centre_m.cast<double>() - a.centre_m.cast<double>();
  std::vector<Eigen::Vector3d> axes;
  for (int i = 0; i < 3; ++i) {
    axes.push_back(a.axes.col(i).cast<double>());
    axes.push_back(b.axes.col(i).cast<double>());
    for (int j = 0; j < 3; ++j)
      axes.push_back(a.axes.col(i).cast<double>().cross(b.axes.col(j).cast<double>()));
  }
  double best = -1e30;
  for (const Eigen::Vector3d& axis : axes)
    best = std::max(best, std::fabs(axis.dot(d)) - half_along(a, axis) - half_along(b, axis));
  return best;
}
template <int K>
double gap_slabs(const Slabs& a, const Slabs& b, const Eigen::Vector3d& a_to_b) {
  double best = -1e30;
  for (size_t i = 0; i < 13; ++i) {
    if (!has_direction(K, static_cast<int>(i))) continue;
    const Eigen::Vector3d n = direction(static_cast<int>(i));
    const double centres = n.dot(a_to_b) + static_cast<double>(b.slab[i].centre) -
                           static_cast<double>(a.slab[i].centre);
    const double halves = static_cast<double>(a.slab[i].half) + static_cast<double>(b.slab[i].half);
    best = std::max(best, (std::fabs(centres) - halves) / n.norm());
  }
  return best;
}
template <int K>
double gap_ordop(const typename Ordop<K>::Placed& a, const typename Ordop<K>::Placed& b,
                 const Eigen::Vector3d& a_to_b) {
  const Slabs &slabs_a = *a.slabs, &slabs_b = *b.slabs;
  const Eigen::Isometry3d ta = to_isometry(a.pose), tb = to_isometry(b.pose);
  const double sa = static_cast<double>(a.scale), sb = static_cast<double>(b.scale);
  double best = -1e30;
  for (int i = 0; i < 13; ++i) {
    if (!has_direction(K, i)) continue;
    for (const Eigen::Isometry3d& owner : {ta, tb}) {
      const Eigen::Vector3d u = owner.linear() * direction(i);
      const Slab in_a = slabs_a.bound<K>((ta.linear().transpose() * u).cast<float>());
      const Slab in_b = slabs_b.bound<K>((tb.linear().transpose() * u).cast<float>());
      const double middle_a = u.dot(ta.translation()) + sa * static_cast<double>(in_a.centre);
      const double middle_b =
          u.dot(a_to_b + tb.translation()) + sb * static_cast<double>(in_b.centre);
      const double halves =
          sa * static_cast<double>(in_a.half) + sb * static_cast<double>(in_b.half);
      best = std::max(best, (std::fabs(middle_b - middle_a) - halves) / u.norm());
    }
  }
  return best;
}

template <typename V>
struct Oracle {
  static double gap(const typename V::Placed& a, const typename V::Placed& b,
                    const Eigen::Vector3d& a_to_b) {
    return volumes_test::gap(a, b, a_to_b);
  }
};
template <int K>
struct Oracle<Kdop<K>> {
  static double gap(const Slabs& a, const Slabs& b, const Eigen::Vector3d& a_to_b) {
    return gap_slabs<K>(a, b, a_to_b);
  }
};
template <int K>
struct Oracle<Ordop<K>> {
  static double gap(const typename Ordop<K>::Placed& a, const typename Ordop<K>::Placed& b,
                    const Eigen::Vector3d& a_to_b) {
    return gap_ordop<K>(a, b, a_to_b);
  }
};

/// Two placed shapes whose hulls share a point.
struct Meeting {
  PartPose pose_a, pose_b;
  float scale_a, scale_b;
  Eigen::Vector3f a_to_b_m;
  float reach_m;
};

Eigen::Vector3d inside_of_hull(Draw& draw, const Shape& shape, const PartPose& pose, float scale) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double weights = 0;
  const int corners = draw.integer(1, 4);
  for (int i = 0; i < corners; ++i) {
    const size_t p =
        static_cast<size_t>(draw.integer(0, static_cast<int>(shape.points.size()) - 1));
    const double weight = draw.uniform(0.1, 1);
    sum += weight * placed_exactly(pose, scale, shape.points[p]);
    weights += weight;
  }
  return sum / weights;
}

Meeting meeting_of(Draw& draw, const Shape& a, const Shape& b) {
  Meeting m;
  m.pose_a = draw.pose(1);
  m.pose_b = draw.integer(0, 3) == 0 ? m.pose_a : draw.pose(1);  // includes parallel faces
  m.scale_a = static_cast<float>(draw.uniform(0.5, 2));
  m.scale_b = static_cast<float>(draw.uniform(0.5, 2));
  const Eigen::Vector3d offset =
      inside_of_hull(draw, a, m.pose_a, m.scale_a) - inside_of_hull(draw, b, m.pose_b, m.scale_b);
  m.a_to_b_m = offset.cast<float>();
  m.reach_m =
      static_cast<float>(offset.norm() + 4 + 2 * reach_of(a.points) + 2 * reach_of(b.points));
  return m;
}

template <typename V>
class EveryVolume : public ::testing::Test {};
using Volumes = ::testing::Types<Sphere, Aabb, Obb, Kdop<14>, Kdop<18>, Kdop<26>, Ordop<14>,
                                 Ordop<18>, Ordop<26>>;
TYPED_TEST_SUITE(EveryVolume, Volumes);

TYPED_TEST(EveryVolume, NeverSeparatesPartsThatShareAPoint) {
  const std::vector<Shape> shapes = special_shapes(kSeed);
  Draw draw(kSeed, 2);
  for (const Shape& a : shapes) {
    const auto fitted_a = TypeParam::fit(a.points);
    for (const Shape& b : shapes) {
      const auto fitted_b = TypeParam::fit(b.points);
      for (int i = 0; i < 60; ++i) {
        const Meeting m = meeting_of(draw, a, b);
        const auto placed_a = TypeParam::place(fitted_a, m.pose_a, m.scale_a);
        const auto placed_b = TypeParam::place(fitted_b, m.pose_b, m.scale_b);
        ASSERT_TRUE(
            TypeParam::overlaps(placed_a, placed_b, m.a_to_b_m, rounding_margin_m(m.reach_m)))
            << a.name << " against " << b.name << ", meeting " << i << ", seed " << kSeed
            << ": apart by "
            << Oracle<TypeParam>::gap(placed_a, placed_b, m.a_to_b_m.template cast<double>())
            << " m, allowed " << rounding_margin_m(m.reach_m);
      }
    }
  }
}

TYPED_TEST(EveryVolume, AgreesWithTheSameTestInWorldAxesAndDoublePrecision) {
  const std::vector<Shape> shapes = special_shapes(kSeed);
  Draw draw(kSeed, 3);
  int apart = 0, overlapping = 0, doubtful = 0;
  for (const Shape& a : shapes) {
    const auto fitted_a = TypeParam::fit(a.points);
    for (const Shape& b : shapes) {
      const auto fitted_b = TypeParam::fit(b.points);
      for (int i = 0; i < 60; ++i) {
        Meeting m = meeting_of(draw, a, b);
        // From a common point to well apart: moves B by up to twice the sizes.
        const double size = 2 * (reach_of(a.points) + reach_of(b.points));
        const double share = draw.uniform(0, 1);
        const Eigen::Vector3d push = share * share * size * draw.direction();
        m.a_to_b_m += push.cast<float>();
        m.reach_m += static_cast<float>(push.norm());
        const auto placed_a = TypeParam::place(fitted_a, m.pose_a, m.scale_a);
        const auto placed_b = TypeParam::place(fitted_b, m.pose_b, m.scale_b);
        const float margin = rounding_margin_m(m.reach_m);
        const double gap =
            Oracle<TypeParam>::gap(placed_a, placed_b, m.a_to_b_m.template cast<double>());
        const bool found = TypeParam::overlaps(placed_a, placed_b, m.a_to_b_m, margin);
        const double allowed = 2 * static_cast<double>(margin);
        ++(gap > allowed ? apart : gap <= 0 ? overlapping : doubtful);
        ASSERT_FALSE(found && gap > allowed)
            << a.name << " against " << b.name << ", seed " << kSeed << ": apart by " << gap
            << " m and not separated, allowed " << allowed;
        ASSERT_FALSE(!found && gap <= 0) << a.name << " against " << b.name << ", seed " << kSeed
                                         << ": separated, but they overlap by " << -gap << " m";
      }
    }
  }
  EXPECT_GT(apart, 2000);
  EXPECT_GT(overlapping, 2000);
  EXPECT_LT(doubtful, (apart + overlapping) / 10);
}

TYPED_TEST(EveryVolume, GivesTheSameResultInBothOrders) {
  const std::vector<Shape> shapes = special_shapes(kSeed);
  std::vector<typename TypeParam::Fitted> fitted;
  for (const Shape& shape : shapes) fitted.push_back(TypeParam::fit(shape.points));
  Draw draw(kSeed, 4);
  int overlapping = 0;
  for (size_t i = 0; i < shapes.size(); ++i) {
    for (size_t j = 0; j < shapes.size(); ++j) {
      for (int round = 0; round < 20; ++round) {
        Meeting m = meeting_of(draw, shapes[i], shapes[j]);
        const double size = reach_of(shapes[i].points) + reach_of(shapes[j].points);
        const Eigen::Vector3d push = draw.uniform(0, size) * draw.direction();
        m.a_to_b_m += push.cast<float>();
        const auto placed_a = TypeParam::place(fitted[i], m.pose_a, m.scale_a);
        const auto placed_b = TypeParam::place(fitted[j], m.pose_b, m.scale_b);
        const float margin = rounding_margin_m(m.reach_m + static_cast<float>(push.norm()));
        if (!TypeParam::overlaps(placed_a, placed_b, m.a_to_b_m, margin)) continue;
        ++overlapping;
        ASSERT_TRUE(TypeParam::overlaps(placed_b, placed_a, -m.a_to_b_m, 2 * margin))
            << shapes[i].name << " against " << shapes[j].name << ", seed " << kSeed;
      }
    }
  }
  EXPECT_GT(overlapping, 500);
}

/// Poses every special shape and measures how far a vertex is outside of its volume, in metres.
template <typename Place, typename Outside>
void expect_every_vertex_inside(uint64_t id, Place place, Outside outside_of) {
  Draw draw(kSeed, id);
  for (const Shape& shape : special_shapes(kSeed)) {
    for (int i = 0; i < 150; ++i) {
      const PartPose pose = draw.pose(2);
      const float scale = static_cast<float>(draw.uniform(0.3, 3));
      const auto placed = place(shape, pose, scale);
      const double allowed = static_cast<double>(
          rounding_margin_m(static_cast<float>(4 + 3 * reach_of(shape.points))));
      for (const Eigen::Vector3f& p : shape.points)
        ASSERT_LE(outside_of(placed, placed_exactly(pose, scale, p)), allowed)
            << shape.name << ", pose " << i << ", seed " << kSeed;
    }
  }
}

TEST(Placing, KeepsEveryVertexInside) {
  const auto out = [](const auto& placed, const Eigen::Vector3d& q) { return outside(placed, q); };
  expect_every_vertex_inside(
      5,
      [](const Shape& s, const PartPose& p, float k) {
        return Sphere::place(Sphere::fit(s.points), p, k);
      },
      out);
  expect_every_vertex_inside(
      6,
      [](const Shape& s, const PartPose& p, float k) {
        return Aabb::place(Aabb::fit(s.points), p, k);
      },
      out);
  expect_every_vertex_inside(
      7, [](const Shape& s, const PartPose& p, float k) { return Aabb::refit(s.points, p, k); },
      out);
  std::map<std::string, Obb::Fitted> boxes;  // computed once per shape, because the fit is slow
  for (const Shape& s : special_shapes(kSeed)) boxes[s.name] = Obb::fit(s.points);
  expect_every_vertex_inside(
      8,
      [&](const Shape& s, const PartPose& p, float k) { return Obb::place(boxes[s.name], p, k); },
      out);
}

template <int K>
void expect_slabs_keep_every_vertex_inside() {
  const auto out = [](const Slabs& placed, const Eigen::Vector3d& q) {
    return outside_slabs(placed, K, q);
  };
  expect_every_vertex_inside(
      9,
      [](const Shape& s, const PartPose& p, float k) {
        return Kdop<K>::place(Kdop<K>::fit(s.points), p, k);
      },
      out);
  expect_every_vertex_inside(
      10, [](const Shape& s, const PartPose& p, float k) { return Kdop<K>::refit(s.points, p, k); },
      out);
}

TEST(Placing, KeepsEveryVertexInsideTheSlabs) {
  expect_slabs_keep_every_vertex_inside<14>();
  expect_slabs_keep_every_vertex_inside<18>();
  expect_slabs_keep_every_vertex_inside<26>();
}

/// Refitting to the vertices is never larger than refitting to the rotated volume.
TEST(Placing, RefitsAtMostAsLargeAsRotated) {
  Draw draw(kSeed, 11);
  for (const Shape& shape : special_shapes(kSeed)) {
    const PartPose pose = draw.pose(1);
    const double allowed =
        static_cast<double>(rounding_margin_m(static_cast<float>(3 + reach_of(shape.points))));
    const Aabb::Placed box = Aabb::place(Aabb::fit(shape.points), pose, 1);
    const Aabb::Placed tight_box = Aabb::refit(shape.points, pose, 1);
    const Slabs slabs = Kdop<26>::place(Kdop<26>::fit(shape.points), pose, 1);
    const Slabs tight_slabs = Kdop<26>::refit(shape.points, pose, 1);
    EXPECT_LE((tight_box.half_m - box.half_m).cast<double>().maxCoeff(), allowed) << shape.name;
    for (size_t i = 0; i < 13; ++i)
      EXPECT_LE(static_cast<double>(tight_slabs.slab[i].half - slabs.slab[i].half), 2 * allowed)
          << shape.name << ", direction " << i;
  }
}

TEST(Margin, InflatesByThatManyMetres) {
  const std::vector<Eigen::Vector3f> cube = special_shapes(kSeed)[10].points;  // half width 0.5
  const PartPose upright = to_part_pose(Eigen::Isometry3d::Identity());
  const auto expect = [&]<typename V>(V) {
    const auto fitted = V::fit(cube);
    const auto placed = V::place(fitted, upright, 1);
    EXPECT_FALSE(V::overlaps(placed, placed, {1.01f, 0, 0}, 0.005f));
    EXPECT_TRUE(V::overlaps(placed, placed, {1.01f, 0, 0}, 0.015f));
  };
  expect(Aabb{});
  expect(Obb{});
  expect(Kdop<14>{});
  expect(Kdop<18>{});
  expect(Kdop<26>{});
  expect(Ordop<14>{});
  expect(Ordop<18>{});
  expect(Ordop<26>{});
  const auto ball = Sphere::fit(cube);
  const float touching = 2 * ball.radius_m;
  EXPECT_FALSE(Sphere::overlaps(ball, ball, {touching + 0.01f, 0, 0}, 0.005f));
  EXPECT_TRUE(Sphere::overlaps(ball, ball, {touching + 0.01f, 0, 0}, 0.015f));
}

}  // namespace
}  // namespace throng::test::volumes_test
