// distance_bench [AVATARS [MARGIN_M [FRAMES]]] measures distances of a crowd and compares them with
// FCL on the same frames, both on one thread. FCL uses its tree over boxes grown by the margin and
// then fcl::distance() for each pair.
// Exit code 1: FCL's pairs within the margin differ, or a distance lies outside of Throng's bounds.
#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/config.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/distance.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <deque>

#include "avatars/model/model.h"
#include "bench/crowd.h"

namespace throng::bench {
namespace {

using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

/// FclDistances holds placed parts, with their boxes grown by half the margin in FCL's tree.
class FclDistances {
 public:
  FclDistances(const Crowd& crowd, double margin_m) : proximity_m_(margin_m) {
    using Surface = fcl::BVHModel<fcl::OBBRSSd>;
    for (const Part& part : crowd.model().parts) {
      auto surface = std::make_shared<Surface>();
      surface->beginModel();
      for (const Eigen::Vector3i& t : part.mesh.triangles)
        surface->addTriangle(part.mesh.vertices[static_cast<size_t>(t[0])].cast<double>(),
                             part.mesh.vertices[static_cast<size_t>(t[1])].cast<double>(),
                             part.mesh.vertices[static_cast<size_t>(t[2])].cast<double>());
      surface->endModel();
      surfaces_.push_back(surface);
    }
    parts_ = surfaces_.size();
    std::vector<fcl::CollisionObjectd*> objects;
    for (size_t i = 0; i < static_cast<size_t>(crowd.count()) * parts_; ++i) {
      objects_.emplace_back(surfaces_[i % parts_]);
      objects_.back().setUserData(reinterpret_cast<void*>(i));
      objects.push_back(&objects_.back());
    }
    place(crowd);
    tree_.registerObjects(objects);
    tree_.setup();
  }

  /// Sets the poses of all bodies; not timed, because Throng poses within its time.
  void place(const Crowd& crowd) {
    std::vector<PartPose> poses(parts_);
    for (uint32_t body = 0; body < static_cast<uint32_t>(crowd.count()); ++body) {
      crowd.poses({&body, 1}, poses);
      for (size_t part = 0; part < parts_; ++part) {
        Eigen::Isometry3d there = to_isometry(poses[part]);
        there.translation() += crowd.view().roots[body].position_m;
        objects_[body * parts_ + part].setTransform(there);
      }
    }
  }

  struct Row {
    PairKey pair;
    double distance_m;
    bool operator<(const Row& other) const { return pair < other.pair; }
  };
  /// Returns the pairs within the margin.
  std::vector<Row> rows() {
    for (fcl::CollisionObjectd& object : objects_) {
      object.computeAABB();
      fcl::AABBd& box = const_cast<fcl::AABBd&>(object.getAABB());
      box.min_ -= Eigen::Vector3d::Constant(proximity_m_ / 2);
      box.max_ += Eigen::Vector3d::Constant(proximity_m_ / 2);
    }
    tree_.update();
    Collector found{this, {}};
    tree_.collide(&found, [](fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* to) {
      static_cast<Collector*>(to)->add(*a, *b);
      return false;
    });
    std::sort(found.rows.begin(), found.rows.end());
    return found.rows;
  }
  uint64_t distances() const { return distances_; }

 private:
  struct Collector {
    FclDistances* of;
    std::vector<Row> rows;

    void add(fcl::CollisionObjectd& a, fcl::CollisionObjectd& b) {
      auto i = reinterpret_cast<size_t>(a.getUserData()),
           j = reinterpret_cast<size_t>(b.getUserData());
      if (i > j) std::swap(i, j);
      const size_t parts = of->parts_;
      if (i / parts == j / parts) return;
      ++of->distances_;
      fcl::DistanceRequestd request;
      fcl::DistanceResultd result;
      const double distance = fcl::distance(&a, &b, request, result);
      if (distance > of->proximity_m_) return;
      rows.push_back({PairKey(static_cast<uint32_t>(i / parts), static_cast<uint32_t>(j / parts),
                              static_cast<uint32_t>(i % parts), static_cast<uint32_t>(j % parts)),
                      std::max(0.0, distance)});
    }
  };

  double proximity_m_;
  size_t parts_ = 0;
  uint64_t distances_ = 0;
  std::vector<std::shared_ptr<fcl::CollisionGeometryd>> surfaces_;
  std::deque<fcl::CollisionObjectd> objects_;
  fcl::DynamicAABBTreeCollisionManagerd tree_;
};

/// Counts the rows that only one of the two has. For one solid inside another FCL returns the
/// distance of the surfaces and Throng 0: such rows count as equal.
uint64_t differing(const ProximityRows& throng_rows, std::span<const FclDistances::Row> fcl_rows,
                   double margin_m) {
  constexpr double kRounding_m = 1e-5;
  uint64_t count = 0;
  for (const FclDistances::Row& row : fcl_rows) {
    const auto at = std::lower_bound(
        throng_rows.begin(), throng_rows.end(), row.pair,
        [](const ProximityPair& one, const PairKey& key) { return one.pair < key; });
    const bool is_there = at != throng_rows.end() && at->pair == row.pair;
    if (!is_there) {
      count += row.distance_m < margin_m - kRounding_m;
      continue;
    }
    count += at->hi_m > 0 && (row.distance_m < static_cast<double>(at->lo_m) - kRounding_m ||
                              row.distance_m > static_cast<double>(at->hi_m) + kRounding_m);
  }
  for (const ProximityPair& row : throng_rows) {
    if (row.hi_m == 0 || static_cast<double>(row.hi_m) > margin_m - kRounding_m) continue;
    const auto at =
        std::lower_bound(fcl_rows.begin(), fcl_rows.end(), FclDistances::Row{row.pair, 0});
    count += at == fcl_rows.end() || !(at->pair == row.pair);
  }
  return count;
}

int compare(int avatars, float margin_m, int frames) {
  Crowd crowd(load_model(adult_urdf()), {.avatars = avatars});
  CullerOptions options;
  options.exact = true;
  options.check_spheres = false;
  CullerOptions with = options;
  with.proximity.margin_m = margin_m;
  Workers one(1);
  Culler touching({crowd.body_type()}, options, one),
      with_distances({crowd.body_type()}, with, one);
  FclDistances fcl(crowd, static_cast<double>(margin_m));
  std::vector<double> without_ms, throng_ms, fcl_ms;
  uint64_t rows = 0, tested = 0, wrong = 0;
  for (int frame = 0; frame <= frames; ++frame, crowd.advance()) {
    fcl.place(crowd);
    auto begin = Clock::now();
    touching.step(crowd.view(), crowd);
    const double none = ms_since(begin);
    begin = Clock::now();
    with_distances.step(crowd.view(), crowd);
    const double proximity_ms = ms_since(begin);
    begin = Clock::now();
    const std::vector<FclDistances::Row> fcl_rows = fcl.rows();
    const double other = ms_since(begin);
    wrong += differing(with_distances.proximity_pairs(), fcl_rows, static_cast<double>(margin_m));
    if (frame == 0) continue;  // allocates memory
    without_ms.push_back(none);
    throng_ms.push_back(proximity_ms);
    fcl_ms.push_back(other);
    rows += with_distances.proximity_pairs().size();
    tested += with_distances.counters().proximity.tests;
  }
  const double each = static_cast<double>(rows) / frames;
  const CullingCounters& counters = touching.counters();
  fmt::print("{} people, {} m, {} frames, one thread each\n", avatars, margin_m, frames);
  fmt::print("rows per frame          {:.0f}\n", each);
  fmt::print("contacts only, exact    {:.2f} ms, {:.2f} us per pair tested by triangles\n",
             median(without_ms),
             counters.triangles.tests == 0 ? 0
                                           : 1e-3 * counters.triangles.test_ns /
                                                 static_cast<double>(counters.triangles.tests));
  const double more_us = 1e3 * frames * (median(throng_ms) - median(without_ms));
  fmt::print("with distances          {:.2f} ms, {:.2f} us more per row, {:.2f} per pair tested\n",
             median(throng_ms), more_us / static_cast<double>(rows),
             more_us / static_cast<double>(tested));
  fmt::print("fcl {}               {:.2f} ms, {:.1f} times Throng\n", FCL_VERSION, median(fcl_ms),
             median(fcl_ms) / median(throng_ms));
  fmt::print("rows that differ        {}\n", wrong);
  return wrong == 0 ? 0 : 1;
}

}  // namespace
}  // namespace throng::bench

int main(int argc, char** argv) {
  const int avatars = argc > 1 ? std::atoi(argv[1]) : 5000;
  const float margin_m = argc > 2 ? std::strtof(argv[2], nullptr) : 0.1f;
  const int frames = argc > 3 ? std::atoi(argv[3]) : 5;
  return throng::bench::compare(avatars, margin_m, frames);
}
