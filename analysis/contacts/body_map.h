// Where on the body contacts are: points of contact carried back to a body at rest, as a picture.
// One rule: memory does not grow with the run; what is drawn is time of contact, spread over a
// finger's width.
#pragma once

#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include "avatars/model/model.h"
#include "base/figure.h"
#include "scenes/run/sink.h"

namespace throng {

class BodyMap {
 public:
  /// Whether a run of this scene knows points of contact: it is asked for them, or for distances by
  /// triangles.
  static bool is_known(const Scene& scene) {
    return scene.exact && (scene.contact_points || scene.near_m > 0);
  }

  /// Of the people who have the model that most of them have.
  explicit BodyMap(const RunInfo& run);

  /// A frame with postures.
  void frame(const RunInfo& run, const Frame& frame);

  bool has_figure() const { return !cells_.empty(); }
  /// Seconds of all points together.
  double total_s() const;
  /// From the front, the right, the back and the left.
  Figure figure() const;

  /// A point of the body at rest, and for how long it was touched.
  struct Touched {
    Eigen::Vector3f at_m;
    double seconds = 0;
  };
  /// By part and place.
  std::vector<Touched> touched() const;

 private:
  void add(const RunInfo& run, const Frame& frame, uint32_t body, uint32_t part,
           const Eigen::Vector3d& point_m);

  double step_s_;
  int model_ = -1;  ///< -1: nobody is a person
  std::shared_ptr<const Model> body_;
  std::vector<PartPose> rest_, poses_;
  int64_t posed_ = -1;                            ///< whose poses poses_ has
  std::unordered_map<uint64_t, uint64_t> cells_;  ///< frames by part and cell of its frame
};

}  // namespace throng
