#include "bench/paper/overlap.h"

#include <cmath>
#include <numbers>

#include "base/random.h"

namespace throng::paper {
namespace {

constexpr int kPlaces = 100;  // a pair of attitudes
constexpr size_t kBatches = 10;

/// Uniform over all rotations (Shoemake 1992).
Eigen::Quaterniond any_attitude(const RandomKey& key, uint32_t& index) {
  const double u = random_uniform(key, index++);
  const double p = 2 * std::numbers::pi * random_uniform(key, index++);
  const double q = 2 * std::numbers::pi * random_uniform(key, index++);
  const double r = std::sqrt(1 - u), s = std::sqrt(u);
  return {s * std::cos(q), r * std::sin(p), r * std::cos(p), s * std::sin(q)};
}

PartPose pose_of(const Eigen::Quaterniond& attitude) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = attitude.toRotationMatrix();
  return to_part_pose(pose);
}

/// The attitudes and places of one pair of objects.
struct Trial {
  PartPose a, b;
  std::array<Eigen::Vector3f, kPlaces> b_at_m;
};

Trial draw_trial(uint64_t seed, size_t pair, int attitude, double half_edge_m) {
  const RandomKey key{seed, pair, 2 + static_cast<uint64_t>(attitude), Purpose::kBoxWorld};
  uint32_t index = 0;
  Trial trial;
  trial.a = pose_of(any_attitude(key, index));
  trial.b = pose_of(any_attitude(key, index));
  for (Eigen::Vector3f& at : trial.b_at_m)
    for (int axis = 0; axis < 3; ++axis)
      at[axis] = static_cast<float>(random_uniform(key, -half_edge_m, half_edge_m, index++));
  return trial;
}

template <typename Method>
int hits_of(const typename Method::Fitted& fit_a, const Object& a,
            const typename Method::Fitted& fit_b, const Object& b, const Trial& trial,
            float margin_m, ExactCounters& unused) {
  const auto placed_a = Method::update(fit_a, a, trial.a);
  const auto placed_b = Method::update(fit_b, b, trial.b);
  int hits = 0;
  for (const Eigen::Vector3f& at : trial.b_at_m)
    hits += Method::test_at(placed_a, placed_b, at, margin_m, unused);
  return hits;
}

template <typename Method>
OverlapVolume measure(const std::vector<Object>& objects, int attitudes, uint64_t seed) {
  const auto fitted = fit_all<Method>(objects);
  OverlapVolume out;
  out.by_object_l.resize(objects.size());
  std::array<double, kBatches> batches{};
  ExactCounters unused;
  size_t pair = 0;
  for (size_t a = 0; a < objects.size(); ++a) {
    for (size_t b = a + 1; b < objects.size(); ++b, ++pair) {
      // The box around a turned box around a sphere's content reaches sqrt(3) times its radius.
      const double reach_m = std::sqrt(3.0) * (objects[a].radius_m + objects[b].radius_m);
      const double cube_l = 8e3 * reach_m * reach_m * reach_m;
      const auto margin_m = rounding_margin_m(static_cast<float>(4 * reach_m));
      double sum_l = 0;
      for (int attitude = 0; attitude < attitudes; ++attitude) {
        const Trial trial = draw_trial(seed, pair, attitude, reach_m);
        const double litres =
            cube_l / kPlaces *
            hits_of<Method>(fitted[a], objects[a], fitted[b], objects[b], trial, margin_m, unused);
        sum_l += litres;
        batches[static_cast<size_t>(attitude) % kBatches] += litres;
      }
      sum_l /= attitudes;
      out.litres += sum_l;
      for (const size_t object : {a, b})
        out.by_object_l[object] += sum_l / static_cast<double>(objects.size() - 1);
    }
  }
  const auto pairs = static_cast<double>(pair);
  out.litres /= pairs;
  double square = 0;
  for (const double batch : batches) {
    const double off = batch * kBatches / (attitudes * pairs) - out.litres;
    square += off * off;
  }
  out.error_l = std::sqrt(square / (kBatches * (kBatches - 1)));
  return out;
}

}  // namespace

OverlapTable measure_overlap(const std::vector<Object>& objects, int attitudes, uint64_t seed) {
  OverlapTable table;
  for_each_method([&](size_t index, auto method) {
    table[index] = measure<decltype(method)>(objects, attitudes, seed);
  });
  return table;
}

double elongation(const Object& object) {
  Eigen::Vector3f low = object.shape.points.front(), high = low;
  for (const Eigen::Vector3f& point : object.shape.points) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  const Eigen::Vector3f sides = high - low;
  return static_cast<double>(sides.maxCoeff() / sides.minCoeff());
}

}  // namespace throng::paper
