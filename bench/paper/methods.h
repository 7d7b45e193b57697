// Methods of the paper: every volume with every update rule, one type each.
// A method defines how a volume is built (C_o), updated (C_u) and tested (C_v). Counting and timing
// are the same for all.
#pragma once

#include <array>
#include <string_view>

#include "bench/paper/parts.h"
#include "culling/triangles/triangle_bvh.h"
#include "culling/volumes/volume_list.h"

namespace throng::paper {

/// Updates the fitted volume: spheres move, boxes and or-DOPs turn, k-DOPs enclose the turned one.
template <typename V>
struct Turned {
  using Fitted = typename V::Fitted;
  using Placed = typename V::Placed;
  static Fitted fit(const Object& object) { return V::fit(object.shape.points); }
  static Placed update(const Fitted& fitted, const Object&, const PartPose& pose) {
    return V::place(fitted, pose, 1.0f);
  }
  static bool test(const Placed& a, const Placed& b, float margin_m, TriangleCounters& counters) {
    return test_at(a, b, Eigen::Vector3f::Zero(), margin_m, counters);
  }
  /// Tests with b moved by `b_by_m`.
  static bool test_at(const Placed& a, const Placed& b, const Eigen::Vector3f& b_by_m,
                      float margin_m, TriangleCounters&) {
    return V::overlaps(a, b, b_by_m, margin_m);
  }
};

/// Updates the volume from the vertices.
template <typename V>
struct Refitted : Turned<V> {
  using typename Turned<V>::Fitted;
  using typename Turned<V>::Placed;
  static Placed update(const Fitted&, const Object& object, const PartPose& pose) {
    return V::refit(object.shape.points, pose, 1.0f);
  }
};

/// The reference: triangles against triangles. Its update is the pose, as for an or-DOP.
struct Triangles {
  using Fitted = TriangleBvh;
  struct Placed {
    const TriangleBvh* surface;
    PartPose pose;
  };
  static Fitted fit(const Object& object) { return {object.shape.points, object.shape.triangles}; }
  static Placed update(const Fitted& fitted, const Object&, const PartPose& pose) {
    return {&fitted, pose};
  }
  static bool test(const Placed& a, const Placed& b, float margin_m, TriangleCounters& counters) {
    return test_at(a, b, Eigen::Vector3f::Zero(), margin_m, counters);
  }
  static bool test_at(const Placed& a, const Placed& b, const Eigen::Vector3f& b_by_m, float,
                      TriangleCounters& counters) {
    return solids_touch(*a.surface, a.pose, 1, *b.surface, b.pose, 1, b_by_m, counters);
  }
};

/// The rows of every table; the reference is the last.
inline constexpr std::array<std::string_view, 14> kMethods = {
    "sphere",       "aabb",         "aabb_turned",  "obb",     "kdop14",  "kdop18",  "kdop26",
    "kdop14_refit", "kdop18_refit", "kdop26_refit", "ordop14", "ordop18", "ordop26", "exact"};
inline constexpr size_t kSphereMethod = 0;
inline constexpr size_t kOrdop26Method = 12;
inline constexpr size_t kExactMethod = 13;

/// Calls visit(index, method) for each of kMethods.
template <typename Visit>
void for_each_method(const Visit& visit) {
  visit(0, Turned<Sphere>{});
  visit(1, Refitted<Aabb>{});  // the paper's C_u is that of a refit
  visit(2, Turned<Aabb>{});
  visit(3, Turned<Obb>{});
  visit(4, Turned<Kdop<14>>{});
  visit(5, Turned<Kdop<18>>{});
  visit(6, Turned<Kdop<26>>{});
  visit(7, Refitted<Kdop<14>>{});
  visit(8, Refitted<Kdop<18>>{});
  visit(9, Refitted<Kdop<26>>{});
  visit(10, Turned<Ordop<14>>{});
  visit(11, Turned<Ordop<18>>{});
  visit(12, Turned<Ordop<26>>{});
  visit(13, Triangles{});
}

template <typename Method>
std::vector<typename Method::Fitted> fit_all(const std::vector<Object>& objects) {
  std::vector<typename Method::Fitted> fitted;
  fitted.reserve(objects.size());
  for (const Object& object : objects) fitted.push_back(Method::fit(object));
  return fitted;
}

}  // namespace throng::paper
