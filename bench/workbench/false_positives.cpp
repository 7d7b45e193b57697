#include "bench/workbench/false_positives.h"

#include <fmt/format.h>

#include <algorithm>

#include "bench/boxes.h"
#include "culling/exact/triangle_bvh.h"

namespace throng::bench {
namespace {

/// Pairs of avatars judged at once: enough that volumes are placed once for most of their tests.
constexpr size_t kChunk = 2048;

/// Pairs of avatars whose spheres overlap: the two-pass strategy's first pass.
std::vector<BoxPair> sphere_pairs(const Crowd& crowd, const BodyType& type) {
  const BodiesView bodies = crowd.view();
  std::vector<Box> spheres;  // as boxes first, so that the grid of the reference serves
  const double radius = static_cast<double>(type.sphere().radius_m);
  for (const RootPose& root : bodies.roots) {
    const Eigen::Vector3d centre =
        root.position_m + (root.world_from_root * type.sphere().centre_m).cast<double>();
    const Eigen::Vector3f low = (centre.array() - radius).cast<float>(),
                          high = (centre.array() + radius).cast<float>();
    spheres.push_back({{low.x(), low.y(), low.z()}, {high.x(), high.y(), high.z()}});
  }
  std::vector<BoxPair> pairs = reference_pairs({spheres, 1});
  std::erase_if(pairs, [&](const BoxPair& pair) {
    const auto centre = [&](uint32_t i) -> Eigen::Vector3f {
      return Eigen::Vector3f(spheres[i].min_m) + Eigen::Vector3f(spheres[i].max_m);
    };
    return (centre(pair.a) - centre(pair.b)).norm() / 2 > 2 * type.sphere().radius_m;
  });
  return pairs;
}

/// What pairs of avatars are judged with, and where the counts go. The pipeline's row is the last.
class Census {
 public:
  Census(const BodyType& type, VolumeList volumes, FalsePositives& out)
      : type_(type), out_(out), says_(volumes.size()) {
    for (const TestedVolume* volume : volumes) fitted_.push_back(volume->fit(type.parts()));
    for (const PartShape& part : type.parts()) surfaces_.emplace_back(part.points, part.triangles);
  }

  /// Every part of `a` against every part of `b`, for each pair of avatars.
  void judge(const BodiesView& bodies, const std::vector<PartPose>& poses,
             std::span<const PairKey> reported, std::span<const BoxPair> pairs) {
    lay_out(bodies, poses, pairs);
    for (size_t i = 0; i < fitted_.size(); ++i) {
      says_[i].resize(tests_.size());
      fitted_[i]->test(places_, tests_, says_[i]);
    }
    out_.avatar_pairs += pairs.size();
    for (size_t i = 0; i < tests_.size(); ++i) {
      const PlacedPair& test = tests_[i];
      const PartPlace &a = places_[test.a], &b = places_[test.b];
      const BoxPair& avatars = pairs[i / (surfaces_.size() * surfaces_.size())];
      // The truth is looked for wherever any volume reports, so that one that misses is caught.
      const bool touching =
          std::any_of(says_.begin(), says_.end(), [&](const auto& says) { return says[i] != 0; }) &&
          solids_touch(surfaces_[a.shape], a.pose, a.scale, surfaces_[b.shape], b.pose, b.scale,
                       test.a_to_b_m, exact_);
      const PairKey key(bodies.ids[avatars.a], bodies.ids[avatars.b], a.shape, b.shape);
      count(i, std::minmax(a.shape, b.shape), touching,
            std::binary_search(reported.begin(), reported.end(), key));
    }
  }

 private:
  /// The places of all avatars in `pairs`, once each, and all tests of their parts.
  void lay_out(const BodiesView& bodies, const std::vector<PartPose>& poses,
               std::span<const BoxPair> pairs) {
    const auto parts = static_cast<uint32_t>(surfaces_.size());
    first_place_.assign(bodies.ids.size(), UINT32_MAX);
    places_.clear();
    tests_.clear();
    const auto placed = [&](uint32_t avatar) {
      if (first_place_[avatar] != UINT32_MAX) return first_place_[avatar];
      const auto first = static_cast<uint32_t>(places_.size());
      for (uint32_t part = 0; part < parts; ++part)
        places_.push_back({part, poses[size_t{avatar} * parts + part], bodies.scales[avatar]});
      return first_place_[avatar] = first;
    };
    for (const BoxPair& pair : pairs) {
      const Eigen::Vector3f shift =
          (bodies.roots[pair.b].position_m - bodies.roots[pair.a].position_m).cast<float>();
      const float margin = rounding_margin_m(shift.norm() + 4 * type_.sphere().radius_m +
                                             2 * type_.sphere().centre_m.norm());
      const uint32_t a = placed(pair.a), b = placed(pair.b);
      for (uint32_t i = 0; i < parts; ++i)
        for (uint32_t j = 0; j < parts; ++j) tests_.push_back({a + i, b + j, shift, margin});
    }
  }

  void count(size_t test, std::pair<uint32_t, uint32_t> cell, bool touching, bool by_pipeline) {
    PartCell& in = out_.matrix[cell.first * surfaces_.size() + cell.second];
    ++out_.tests;
    out_.touching += touching;
    ++in.tests;
    in.touching += touching;
    for (size_t i = 0; i < out_.volumes.size(); ++i) {
      const bool says = i < says_.size() ? says_[i][test] != 0 : by_pipeline;
      out_.volumes[i].reported += says;
      out_.volumes[i].missed += touching && !says;
      if (out_.volumes[i].name == out_.matrix_volume) in.passed += says;
    }
  }

  const BodyType& type_;
  FalsePositives& out_;
  std::vector<std::unique_ptr<FittedVolume>> fitted_;
  std::vector<TriangleBvh> surfaces_;
  std::vector<uint32_t> first_place_;  // by avatar
  std::vector<PartPlace> places_;
  std::vector<PlacedPair> tests_;
  std::vector<std::vector<uint8_t>> says_;  // by volume
  ExactCounters exact_;
};

}  // namespace

FalsePositives count_false_positives(Crowd& crowd, VolumeList volumes, const CensusOptions& options,
                                     const Progress& progress) {
  const auto type = crowd.body_type();
  FalsePositives out;
  for (const Part& part : crowd.model().parts) out.parts.push_back(part.name);
  out.matrix.resize(out.parts.size() * out.parts.size());
  out.matrix_volume = options.matrix_volume;
  for (const TestedVolume* volume : volumes) out.volumes.push_back({volume->name()});
  out.volumes.push_back({"pipeline"});  // cylinders, avatar boxes and part boxes before or-DOP 26

  Workers workers(1);
  Culler culler({type}, {}, workers);
  CrowdBoxes boxes(crowd, type);
  Census census(*type, volumes, out);
  for (int frame = 0; frame < options.frames; ++frame) {
    for (int step = 0; step < options.stride; ++step) crowd.advance();
    boxes.compute();
    culler.step(crowd.view(), crowd);
    const std::vector<BoxPair> pairs = sphere_pairs(crowd, *type);
    for (size_t first = 0; first < pairs.size(); first += kChunk)
      census.judge(crowd.view(), boxes.poses(), culler.pairs(),
                   std::span(pairs).subspan(first, std::min(kChunk, pairs.size() - first)));
    progress(fmt::format("frame {} of {}", frame + 1, options.frames));
  }
  return out;
}

}  // namespace throng::bench
