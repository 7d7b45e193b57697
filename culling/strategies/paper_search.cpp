#include "culling/strategies/paper_search.h"

#include <algorithm>
#include <cassert>

#include "base/memory.h"
#include "base/stopwatch.h"
#include "culling/fitted.h"
#include "culling/kernels/kernels.h"
#include "culling/stages/pair_search.h"
#include "culling/stages/slots.h"

namespace throng {
namespace {

/// Floats in the widest register: kernels load whole registers at the last slot.
constexpr size_t kPadding = 16;
/// Larger than any scene.
constexpr float kUnbounded_m = 1e9f;

template <typename V>
struct VolumeTest {
  using Fitted = typename V::Fitted;
  using Placed = typename V::Placed;
  explicit VolumeTest(const Kernels&) {}
  static const std::vector<Fitted>& fitted(const BodyType::Volumes& volumes) {
    return volumes.of<V>();
  }
  static Placed place(const Fitted& fitted, const PartPose& pose, float scale) {
    return V::place(fitted, pose, scale);
  }
  static bool overlaps(const Placed& a, const Placed& b, const float (&shift_m)[4]) {
    return V::overlaps(a, b, {shift_m[0], shift_m[1], shift_m[2]}, shift_m[3]);
  }
};

/// Tests with the kernel that has the directions of one volume as lanes.
template <typename V>
struct KernelTest {
  using Fitted = OrdopLanes;
  struct Placed {
    const OrdopLanes* lanes;
    PartPose pose;
    float scale;
  };
  explicit KernelTest(const Kernels& kernels) : overlap(kernels.*KernelsOf<V>::kPair) {}
  static const std::vector<Fitted>& fitted(const BodyType::Volumes& volumes) {
    return volumes.lanes<V>();
  }
  static Placed place(const Fitted& fitted, const PartPose& pose, float scale) {
    return {&fitted, pose, scale};
  }
  bool overlaps(const Placed& a, const Placed& b, const float (&shift_m)[4]) const {
    return overlap(*a.lanes, a.pose, a.scale, *b.lanes, b.pose, b.scale, shift_m);
  }
  Kernels::OrdopPair overlap;
};

template <typename Test>
class PaperSearchWith final : public PaperSearch {
 public:
  PaperSearchWith(Strategy strategy, const CullerOptions& options, BodyTypes types)
      : strategy_(strategy),
        pair_search_(options.pair_search),
        volume_(options.part_volume),
        exact_(options.exact),
        types_(types),
        kernels_(kernels_for(options.simd)),
        test_(kernels_),
        any_static_(std::any_of(types.begin(), types.end(),
                                [](const auto& type) { return type->is_static(); })) {
    for (const auto& type : types) {
      Test::fitted(type->volumes());
      if (exact_) type->volumes().surfaces();
    }
  }

  void run(const BodiesView& bodies, const PoseSource& source) override {
    bodies_ = &bodies;
    source_ = &source;
    n_ = static_cast<uint32_t>(bodies.ids.size());
    count_ = sphere_pair_count_ = 0;
    posed_ = 0;
    spheres_ = {.volume = "sphere"};
    volumes_ = {.volume = name_of(volume_)};
    triangles_ = {.volume = exact_ ? "triangles" : "off"};
    primitive_tests_ = 0;
    if (strategy_ == Strategy::kNone) return;
    lay_out_parts();
    if (strategy_ != Strategy::kVolume) update_spheres();
    if (strategy_ == Strategy::kVolume || strategy_ == Strategy::kHybridAll) update_all();
    if (n_ < 2) return;
    Stopwatch watch;
    switch (strategy_) {
      case Strategy::kSphere:
        sphere_pass();
        report_whole_bodies();
        break;
      case Strategy::kVolume:
        for (uint32_t a = 0; a < n_; ++a)
          for (uint32_t b = a + 1; b < n_; ++b) test_parts(a, b);
        volumes_.test_ns += watch.lap_ns();
        break;
      case Strategy::kHybridOne:
        for (uint32_t b = 1; b < n_; ++b)
          if (spheres_overlap(0, b)) test_survivors(0, b);
        spheres_.test_ns += watch.lap_ns();
        break;
      case Strategy::kHybridAll:
        for (uint32_t a = 0; a < n_; ++a)
          for (uint32_t b = a + 1; b < n_; ++b)
            if (spheres_overlap(a, b)) test_parts(a, b);
        spheres_.test_ns += watch.lap_ns();
        break;
      case Strategy::kTwoPass:
        sphere_pass();
        refine();
        break;
      default:
        assert(false);
    }
    if (strategy_ == Strategy::kSphere) return;
    volumes_.passed = count_;
    if (exact_) decide_by_triangles();
  }

  std::span<const PairKey> pairs() const override { return {pairs_.data(), count_}; }
  const StageCounters& spheres() const override { return spheres_; }
  const StageCounters& volumes() const override { return volumes_; }
  const StageCounters& triangles() const override { return triangles_; }
  uint64_t primitive_tests() const override { return primitive_tests_; }
  uint64_t posed_bodies() const override { return posed_; }
  uint64_t times_grown() const override {
    uint64_t sum = first_part_.times_grown() + poses_.times_grown() + placed_grown_ +
                   is_updated_.times_grown() + pairs_.times_grown() + sphere_pairs_.times_grown() +
                   block_.times_grown() + all_bodies_.times_grown() + bodies_placed_.times_grown() +
                   margin_.times_grown();
    for (const GrowBuffer<float>* column : {&x_, &y_, &z_, &radius_}) sum += column->times_grown();
    return sum + searcher_.times_grown();
  }

 private:
  const BodyType& type_of(uint32_t body) const { return *types_[bodies_->types[body]]; }
  bool both_static(uint32_t a, uint32_t b) const {
    return any_static_ && type_of(a).is_static() && type_of(b).is_static();
  }

  void lay_out_parts() {
    first_part_.resize(n_ + 1);
    is_updated_.resize(n_);
    margin_.resize(n_);
    size_t parts = 0;
    for (uint32_t i = 0; i < n_; ++i) {
      first_part_[i] = static_cast<uint32_t>(parts);
      is_updated_[i] = 0;
      margin_[i] = body_margin_m(bodies_->scales[i] * reach_m(type_of(i)));
      parts += static_cast<size_t>(type_of(i).part_count());
    }
    first_part_[n_] = static_cast<uint32_t>(parts);
    poses_.resize(parts);
    if (placed_.size() < parts) {
      placed_.resize(parts);
      ++placed_grown_;
    }
  }

  /// Relative to one of the bodies, to keep numbers small.
  void update_spheres() {
    Stopwatch watch;
    for (GrowBuffer<float>* column : {&x_, &y_, &z_, &radius_}) column->resize(n_ + kPadding);
    const Eigen::Vector3d origin =
        n_ == 0 ? Eigen::Vector3d::Zero() : bodies_->roots[n_ / 2].position_m;
    for (uint32_t i = 0; i < n_; ++i) {
      const RootSphere& sphere = type_of(i).sphere();
      const RootPose& root = bodies_->roots[i];
      const float scale = bodies_->scales[i];
      Eigen::Vector3d centre = root.position_m - origin;
      if (!sphere.centre_m.isZero(0))
        centre += (root.world_from_root * Eigen::Vector3f(scale * sphere.centre_m)).cast<double>();
      x_[i] = static_cast<float>(centre.x());
      y_[i] = static_cast<float>(centre.y());
      z_[i] = static_cast<float>(centre.z());
      // Coordinates are rounded when stored and when the search subtracts them.
      const auto farthest = static_cast<float>(centre.cwiseAbs().maxCoeff());
      radius_[i] = scale * sphere.radius_m + margin_[i] + 0x1p-22f * farthest;
    }
    for (size_t i = n_; i < n_ + kPadding; ++i) x_[i] = y_[i] = z_[i] = radius_[i] = 0;
    spheres_.updates += n_;
    spheres_.update_ns += watch.lap_ns();
  }

  void update(uint32_t body) {
    if (is_updated_[body]) return;
    is_updated_[body] = 1;
    ++posed_;
    const size_t first = first_part_[body], parts = first_part_[body + 1] - first;
    source_->poses({&body, 1}, {poses_.data() + first, parts});
    const auto& fitted = Test::fitted(type_of(body).volumes());
    for (size_t part = 0; part < parts; ++part)
      placed_[first + part] =
          test_.place(fitted[part], poses_[first + part], bodies_->scales[body]);
    volumes_.updates += parts;
  }
  void update_all() {
    Stopwatch watch;
    for (uint32_t body = 0; body < n_; ++body) update(body);
    volumes_.update_ns += watch.lap_ns();
  }

  bool spheres_overlap(uint32_t a, uint32_t b) {
    if (both_static(a, b)) return false;
    ++spheres_.tests;
    const float dx = x_[b] - x_[a], dy = y_[b] - y_[a], dz = z_[b] - z_[a];
    const float reach = radius_[a] + radius_[b];
    const bool overlap = dx * dx + dy * dy + dz * dz <= reach * reach;
    spheres_.passed += overlap;
    return overlap;
  }

  /// Tests every part of a with every part of b. Both must be updated.
  void test_parts(uint32_t a, uint32_t b) {
    if (both_static(a, b)) return;
    const Eigen::Vector3f shift =
        (bodies_->roots[b].position_m - bodies_->roots[a].position_m).template cast<float>();
    const float shift_m[4] = {shift.x(), shift.y(), shift.z(), margin_[a] + margin_[b]};
    const uint32_t parts_a = first_part_[a + 1] - first_part_[a];
    const uint32_t parts_b = first_part_[b + 1] - first_part_[b];
    pairs_.grow(count_ + size_t{parts_a} * parts_b, count_);
    for (uint32_t pa = 0; pa < parts_a; ++pa)
      for (uint32_t pb = 0; pb < parts_b; ++pb)
        if (test_.overlaps(placed_[first_part_[a] + pa], placed_[first_part_[b] + pb], shift_m))
          pairs_[count_++] = PairKey(a, b, pa, pb);
    volumes_.tests += uint64_t{parts_a} * parts_b;
  }
  void test_survivors(uint32_t a, uint32_t b) {
    update(a);
    update(b);
    test_parts(a, b);
  }

  /// Finds pairs of bodies with overlapping spheres, a < b.
  void sphere_pass() {
    Stopwatch watch;
    if (pair_search_ == PairSearch::kBrute) {
      const SphereRows rows{x_.data(), y_.data(), z_.data(), radius_.data(), radius_.data()};
      for (uint32_t a = 0; a + 1 < n_; ++a) {
        sphere_pairs_.grow(sphere_pair_count_ + n_ - a + kPairSlack, sphere_pair_count_);
        sphere_pair_count_ +=
            kernels_.sphere_run(rows, a, a + 1, n_, sphere_pairs_.data() + sphere_pair_count_);
      }
      spheres_.tests += uint64_t{n_} * (n_ - 1) / 2;
    } else {
      search();
    }
    size_t kept = 0;
    for (size_t i = 0; i < sphere_pair_count_; ++i)
      if (!both_static(sphere_pairs_[i].a, sphere_pairs_[i].b))
        sphere_pairs_[kept++] = sphere_pairs_[i];
    sphere_pair_count_ = kept;
    spheres_.passed += sphere_pair_count_;
    spheres_.test_ns += watch.lap_ns();
  }
  void search() {
    all_bodies_.resize(n_);
    bodies_placed_.resize(n_);
    for (uint32_t i = 0; i < n_; ++i) {
      all_bodies_[i] = i;
      // Spheres alone: rectangles on the ground that never separate.
      bodies_placed_[i] = {x_[i], y_[i], z_[i], radius_[i],   radius_[i],  0,
                           0,     1,     0,     kUnbounded_m, kUnbounded_m};
    }
    searcher_.build(pair_search_, {bodies_placed_.data(), n_}, {all_bodies_.data(), n_}, serial_);
    for (size_t block = 0; block < searcher_.block_count(); ++block) {
      const PairSearcher::BlockCounts searched = searcher_.search_block(kernels_, block, block_);
      spheres_.tests += searched.tests;
      const size_t found = searched.pairs;
      sphere_pairs_.grow(sphere_pair_count_ + found, sphere_pair_count_);
      for (size_t i = 0; i < found; ++i) {
        const uint32_t a = searcher_.bodies()[block_[i].a];
        const uint32_t b = searcher_.bodies()[block_[i].b];
        sphere_pairs_[sphere_pair_count_++] = {std::min(a, b), std::max(a, b)};
      }
    }
    std::sort(
        sphere_pairs_.data(), sphere_pairs_.data() + sphere_pair_count_,
        [](const SlotPair& p, const SlotPair& q) { return p.a != q.a ? p.a < q.a : p.b < q.b; });
  }
  void report_whole_bodies() {
    pairs_.resize(sphere_pair_count_);
    for (size_t i = 0; i < sphere_pair_count_; ++i)
      pairs_[count_++] = PairKey(sphere_pairs_[i].a, sphere_pairs_[i].b, kWholeBody, kWholeBody);
  }
  void refine() {
    Stopwatch watch;
    for (size_t i = 0; i < sphere_pair_count_; ++i) {
      update(sphere_pairs_[i].a);
      update(sphere_pairs_[i].b);
    }
    volumes_.update_ns += watch.lap_ns();
    for (size_t i = 0; i < sphere_pair_count_; ++i)
      test_parts(sphere_pairs_[i].a, sphere_pairs_[i].b);
    volumes_.test_ns += watch.lap_ns();
  }

  void decide_by_triangles() {
    Stopwatch watch;
    TriangleCounters primitive;
    size_t kept = 0;
    for (size_t i = 0; i < count_; ++i) {
      const PairKey pair = pairs_[i];
      const uint32_t a = pair.a(), b = pair.b();
      const Eigen::Vector3f shift =
          (bodies_->roots[b].position_m - bodies_->roots[a].position_m).template cast<float>();
      const bool touch = solids_touch(
          type_of(a).volumes().surfaces()[pair.part_a()], poses_[first_part_[a] + pair.part_a()],
          bodies_->scales[a], type_of(b).volumes().surfaces()[pair.part_b()],
          poses_[first_part_[b] + pair.part_b()], bodies_->scales[b], shift, primitive);
      if (touch) pairs_[kept++] = pair;
    }
    triangles_.tests = count_;
    triangles_.passed = count_ = kept;
    primitive_tests_ = primitive.node_tests + primitive.triangle_tests;
    triangles_.test_ns += watch.lap_ns();
  }

  Strategy strategy_;
  PairSearch pair_search_;
  VolumeKind volume_;
  bool exact_;
  BodyTypes types_;
  const Kernels& kernels_;
  Test test_;
  bool any_static_;

  const BodiesView* bodies_ = nullptr;
  const PoseSource* source_ = nullptr;
  uint32_t n_ = 0;
  GrowBuffer<uint32_t> first_part_;  // by body, plus one
  GrowBuffer<float> x_, y_, z_, radius_, margin_;
  GrowBuffer<PartPose> poses_;
  std::vector<typename Test::Placed> placed_;  // never shrinks
  uint64_t placed_grown_ = 0;
  GrowBuffer<uint8_t> is_updated_;
  GrowBuffer<SlotPair> sphere_pairs_, block_;
  GrowBuffer<uint32_t> all_bodies_;
  GrowBuffer<PlacedBody> bodies_placed_;
  Workers serial_{1};
  GrowBuffer<PairKey> pairs_;
  PairSearcher searcher_;
  size_t count_ = 0, sphere_pair_count_ = 0;
  uint64_t posed_ = 0;
  StageCounters spheres_, volumes_, triangles_;
  uint64_t primitive_tests_ = 0;
};

}  // namespace

std::unique_ptr<PaperSearch> PaperSearch::make(Strategy strategy, const CullerOptions& options,
                                               BodyTypes types) {
  assert(strategy != Strategy::kPipeline);
  std::unique_ptr<PaperSearch> search;
  with_volume(options.part_volume, [&]<typename V>() {
    using Test = std::conditional_t<KernelsOf<V>::kExist, KernelTest<V>, VolumeTest<V>>;
    search = std::make_unique<PaperSearchWith<Test>>(strategy, options, types);
  });
  return search;
}

}  // namespace throng
