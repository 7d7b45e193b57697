// TestedVolume hides any bounding volume behind one interface for trials.
// Invariant: fitted volumes are constant; many threads can test at once.
#pragma once

#include <concepts>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "bench/workbench/repeat.h"
#include "culling/body_type.h"
#include "culling/volumes/pose_math.h"  // for volumes that place points
#include "culling/volumes/volumes.h"

namespace throng::bench {

/// A part in its pose relative to its body's root.
struct PartPlace {
  uint32_t shape;  ///< index into the fitted shapes
  PartPose pose;
  float scale;
};

/// Two indices into a list of places, with the other arguments of a test.
struct PlacedPair {
  uint32_t a, b;
  Eigen::Vector3f a_to_b_m;  ///< B's root minus A's
  float margin_m;            ///< bound of the rounding error, see rounding_margin_m()
};

/// The argument of overlaps() for a volume without place().
template <typename Fitted>
struct PosedPart {
  const Fitted* fitted;
  PartPose pose;
  float scale;
};

template <typename V>
using FittedBy = decltype(V::fit(std::declval<std::span<const Eigen::Vector3f>>()));

template <typename V>
concept HasUpdate = requires(const FittedBy<V>& fitted, const PartPose& pose, float scale) {
  V::place(fitted, pose, scale);
};
template <typename V>
struct PlacedBy {
  using Type = PosedPart<FittedBy<V>>;
};
template <HasUpdate V>
struct PlacedBy<V> {
  using Type = decltype(V::place(std::declval<const FittedBy<V>&>(),
                                 std::declval<const PartPose&>(), float{}));
};

/// A testable volume is a class of static functions. Two are required:
///   fit(points) -> F                         once, in the part's own frame
///   overlaps(a, b, a_to_b_m, margin_m)       false proves the enclosed points apart; a and b come
///                                            from place(), or are PosedPart<F> without it
/// Three are optional:
///   place(fitted, pose, scale) -> P          update, once per part and frame (the paper's C_u)
///   refit(points, pose, scale) -> P          update from the vertices
///   overlaps_many(placed, pairs, out)        kernel: many pairs at once, with equal results
template <typename V>
concept TestableVolume = requires(std::span<const Eigen::Vector3f> points) {
  V::fit(points);
}
&&requires(const typename PlacedBy<V>::Type& placed, const Eigen::Vector3f& a_to_b_m,
           float margin_m) {
  { V::overlaps(placed, placed, a_to_b_m, margin_m) } -> std::same_as<bool>;
};
template <typename V>
concept HasKernel = requires(std::span<const typename PlacedBy<V>::Type> placed,
                             std::span<const PlacedPair> pairs, std::span<uint8_t> out) {
  V::overlaps_many(placed, pairs, out);
};
template <typename V>
concept HasRefit = requires(std::span<const Eigen::Vector3f> points, const PartPose& pose,
                            float scale) {
  { V::refit(points, pose, scale) } -> std::same_as<typename PlacedBy<V>::Type>;
};

/// Input of the update of a moved volume.
enum class Update { kFromVolume, kFromVertices };

struct MotionCost {
  Cost update;  ///< C_u
  Cost test;    ///< C_v, by the scalar test or the kernel
};

/// Volumes fitted to a list of shapes.
class FittedVolume {
 public:
  virtual ~FittedVolume() = default;
  /// Places the volumes of `places` and tests `pairs` of them: 1 may overlap, 0 apart.
  virtual void test(std::span<const PartPlace> places, std::span<const PlacedPair> pairs,
                    std::span<uint8_t> overlaps) const = 0;
  virtual MotionCost cost(std::span<const PartPlace> places,
                          std::span<const PlacedPair> pairs) const = 0;
  /// Returns the number of `pairs` for which the kernel differs from the scalar test.
  virtual uint64_t kernel_differs(std::span<const PartPlace> places,
                                  std::span<const PlacedPair> pairs) const = 0;
};

class TestedVolume {
 public:
  explicit TestedVolume(std::string name) : name_(std::move(name)) {}
  virtual ~TestedVolume() = default;
  const std::string& name() const { return name_; }
  /// Keeps a reference to `shapes`.
  virtual std::unique_ptr<FittedVolume> fit(std::span<const PartShape> shapes) const = 0;
  /// Returns the cost of fitting all shapes once (C_o).
  virtual Cost fit_cost(std::span<const PartShape> shapes) const = 0;

 private:
  std::string name_;
};

template <TestableVolume V, Update kUpdate>
class FittedVolumeOf final : public FittedVolume {
 public:
  using Placed = typename PlacedBy<V>::Type;

  explicit FittedVolumeOf(std::span<const PartShape> shapes) : shapes_(shapes) {
    for (const PartShape& shape : shapes) fitted_.push_back(V::fit(shape.points));
  }

  void test(std::span<const PartPlace> places, std::span<const PlacedPair> pairs,
            std::span<uint8_t> overlaps) const override {
    std::vector<Placed> placed;
    place(places, placed);
    decide(placed, pairs, overlaps);
  }

  MotionCost cost(std::span<const PartPlace> places,
                  std::span<const PlacedPair> pairs) const override {
    std::vector<Placed> placed;
    std::vector<uint8_t> overlaps(pairs.size());
    MotionCost out;
    out.update = repeat(places.size(), [&] {
      place(places, placed);
      use(placed.data());
    });
    out.test = repeat(pairs.size(), [&] {
      decide(placed, pairs, overlaps);
      use(overlaps.data());
    });
    return out;
  }

  uint64_t kernel_differs(std::span<const PartPlace> places,
                          std::span<const PlacedPair> pairs) const override {
    if constexpr (!HasKernel<V>) {
      return 0;
    } else {
      std::vector<Placed> placed;
      place(places, placed);
      std::vector<uint8_t> many(pairs.size()), one(pairs.size());
      V::overlaps_many(placed, pairs, many);
      test_scalar(placed, pairs, one);
      uint64_t differing = 0;
      for (size_t i = 0; i < pairs.size(); ++i) differing += (many[i] != 0) != (one[i] != 0);
      return differing;
    }
  }

 private:
  void place(std::span<const PartPlace> places, std::vector<Placed>& placed) const {
    placed.clear();
    placed.reserve(places.size());
    for (const PartPlace& part : places) {
      if constexpr (kUpdate == Update::kFromVertices)
        placed.push_back(V::refit(shapes_[part.shape].points, part.pose, part.scale));
      else if constexpr (HasUpdate<V>)
        placed.push_back(V::place(fitted_[part.shape], part.pose, part.scale));
      else
        placed.push_back({&fitted_[part.shape], part.pose, part.scale});
    }
  }
  static void test_scalar(std::span<const Placed> placed, std::span<const PlacedPair> pairs,
                          std::span<uint8_t> overlaps) {
    for (size_t i = 0; i < pairs.size(); ++i) {
      const PlacedPair& pair = pairs[i];
      overlaps[i] = V::overlaps(placed[pair.a], placed[pair.b], pair.a_to_b_m, pair.margin_m);
    }
  }
  static void decide(std::span<const Placed> placed, std::span<const PlacedPair> pairs,
                     std::span<uint8_t> overlaps) {
    if constexpr (HasKernel<V>)
      V::overlaps_many(placed, pairs, overlaps);
    else
      test_scalar(placed, pairs, overlaps);
  }

  std::span<const PartShape> shapes_;
  std::vector<FittedBy<V>> fitted_;
};

template <TestableVolume V, Update kUpdate = Update::kFromVolume>
class TestedVolumeOf final : public TestedVolume {
 public:
  using TestedVolume::TestedVolume;

  std::unique_ptr<FittedVolume> fit(std::span<const PartShape> shapes) const override {
    return std::make_unique<FittedVolumeOf<V, kUpdate>>(shapes);
  }
  Cost fit_cost(std::span<const PartShape> shapes) const override {
    return repeat(1, [&] {
      for (const PartShape& shape : shapes) {
        const auto fitted = V::fit(shape.points);
        use(&fitted);
      }
    });
  }
};

using VolumeList = std::span<const TestedVolume* const>;

/// Returns the project's volumes by name; a refittable volume occurs twice, second with the suffix
/// "_vertices".
VolumeList project_volumes();

}  // namespace throng::bench
