#include "bench/false_positives.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "bench/boxes.h"
#include "culling/exact/triangle_bvh.h"
#include "culling/volumes/volume_list.h"

namespace throng::bench {
namespace {

/// The volumes of every part of a frame, avatar-major.
struct Method {
  std::string name;
  virtual ~Method() = default;
  virtual void place(const std::vector<PartPose>& poses, std::span<const float> scales) = 0;
  virtual bool overlaps(size_t a, size_t b, const Eigen::Vector3f& a_to_b_m,
                        float margin_m) const = 0;
};

template <typename V, bool kFromVertices>
class MethodOf : public Method {
 public:
  MethodOf(VolumeKind kind, std::shared_ptr<const BodyType> type) : type_(std::move(type)) {
    name = std::string(name_of(kind)) + (kFromVertices ? "_vertices" : "");
    for (const PartShape& part : type_->parts()) fitted_.push_back(V::fit(part.points));
  }
  void place(const std::vector<PartPose>& poses, std::span<const float> scales) override {
    placed_.clear();
    for (size_t i = 0; i < poses.size(); ++i) {
      const size_t part = i % fitted_.size();
      const float scale = scales[i / fitted_.size()];
      if constexpr (kFromVertices)
        placed_.push_back(V::refit(type_->parts()[part].points, poses[i], scale));
      else
        placed_.push_back(V::place(fitted_[part], poses[i], scale));
    }
  }
  bool overlaps(size_t a, size_t b, const Eigen::Vector3f& a_to_b_m,
                float margin_m) const override {
    return V::overlaps(placed_[a], placed_[b], a_to_b_m, margin_m);
  }

 private:
  std::shared_ptr<const BodyType> type_;
  std::vector<typename V::Fitted> fitted_;
  std::vector<typename V::Placed> placed_;
};

std::vector<std::unique_ptr<Method>> all_methods(const std::shared_ptr<const BodyType>& type) {
  std::vector<std::unique_ptr<Method>> out;
  for_each_volume([&]<typename V>(VolumeKind kind) {
    out.push_back(std::make_unique<MethodOf<V, false>>(kind, type));
    if constexpr (RefittedVolume<V>) out.push_back(std::make_unique<MethodOf<V, true>>(kind, type));
  });
  return out;
}

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

/// What a pair of avatars is judged with, and where the counts go. The pipeline's row is the last.
struct Census {
  const std::vector<std::unique_ptr<Method>>& methods;
  const std::vector<TriangleBvh>& surfaces;
  FalsePositives& out;
  ExactCounters exact{};

  /// Every part of `a` against every part of `b`.
  void judge(const BodiesView& bodies, const BodyType& type, const std::vector<PartPose>& poses,
             std::span<const PairKey> reported, const BoxPair& pair) {
    const size_t parts = surfaces.size();
    const Eigen::Vector3f shift =
        (bodies.roots[pair.b].position_m - bodies.roots[pair.a].position_m).cast<float>();
    const float margin = rounding_margin_m(shift.norm() + 4 * type.sphere().radius_m +
                                           2 * type.sphere().centre_m.norm());
    ++out.avatar_pairs;
    for (size_t cell = 0; cell < parts * parts; ++cell) {
      const size_t part_a = cell / parts, part_b = cell % parts;
      const size_t a = pair.a * parts + part_a, b = pair.b * parts + part_b;
      std::array<bool, 16> says{};
      bool any = false;
      for (size_t i = 0; i < methods.size(); ++i)
        any |= says[i] = methods[i]->overlaps(a, b, shift, margin);
      says[methods.size()] =
          std::binary_search(reported.begin(), reported.end(),
                             PairKey(bodies.ids[pair.a], bodies.ids[pair.b],
                                     static_cast<uint32_t>(part_a), static_cast<uint32_t>(part_b)));
      // The truth is looked for wherever any volume reports, so that one that misses is caught.
      const bool touching =
          any && solids_touch(surfaces[part_a], poses[a], bodies.scales[pair.a], surfaces[part_b],
                              poses[b], bodies.scales[pair.b], shift, exact);
      count(std::min(part_a, part_b) * parts + std::max(part_a, part_b), says, touching);
    }
  }

  void count(size_t cell, const std::array<bool, 16>& says, bool touching) {
    ++out.tests;
    out.touching += touching;
    ++out.matrix[cell].tests;
    out.matrix[cell].touching += touching;
    for (size_t i = 0; i < out.volumes.size(); ++i) {
      out.volumes[i].reported += says[i];
      out.volumes[i].missed += touching && !says[i];
      if (out.volumes[i].name == out.matrix_volume) out.matrix[cell].passed += says[i];
    }
  }
};

}  // namespace

FalsePositives count_false_positives(BenchOptions options, VolumeKind matrix_volume, int stride,
                                     const Progress& progress) {
  const std::unique_ptr<Crowd> made = make_crowd(options);
  Crowd& crowd = *made;
  const auto type = crowd.body_type();
  FalsePositives out;
  for (const Part& part : crowd.model().parts) out.parts.push_back(part.name);
  out.matrix.resize(out.parts.size() * out.parts.size());
  out.matrix_volume = name_of(matrix_volume);
  const std::vector<std::unique_ptr<Method>> methods = all_methods(type);
  for (const auto& method : methods) out.volumes.push_back({method->name});
  out.volumes.push_back({"pipeline"});  // cylinders, avatar boxes and part boxes before or-DOP 26
  std::vector<TriangleBvh> surfaces;
  for (const PartShape& part : type->parts()) surfaces.emplace_back(part.points, part.triangles);

  Workers workers(1);
  Culler culler({type}, {}, workers);
  CrowdBoxes boxes(crowd, type);
  Census census{methods, surfaces, out};
  for (int frame = 0; frame < options.frames; ++frame) {
    for (int step = 0; step < stride; ++step) crowd.advance();
    boxes.compute();
    for (const auto& method : methods) method->place(boxes.poses(), crowd.view().scales);
    culler.step(crowd.view(), crowd);
    for (const BoxPair& pair : sphere_pairs(crowd, *type))
      census.judge(crowd.view(), *type, boxes.poses(), culler.pairs(), pair);
    progress(fmt::format("frame {} of {}", frame + 1, options.frames));
  }
  return out;
}

}  // namespace throng::bench
