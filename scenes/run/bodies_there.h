// The bodies that culling sees: all of them, or those that are in the scene now.
// One rule: bodies keep their ids; what is left out is left out of the view only.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "culling/culler.h"
#include "scenes/run/posing.h"

namespace throng {

class BodiesThere {
 public:
  explicit BodiesThere(size_t bodies);

  /// `present`: one an avatar, or empty if everybody is there; the bodies beyond are always there.
  /// Holds as long as `bodies` does and until the next call.
  BodiesView view(const BodyStates& bodies, std::span<const uint8_t> present);

  /// The ids of the latest view if some were left out, else empty.
  std::span<const uint32_t> chosen() const { return chosen_; }

 private:
  std::vector<uint32_t> ids_;
  std::vector<uint32_t> chosen_;
  std::vector<uint16_t> types_;
  std::vector<float> scales_;
  std::vector<RootPose> roots_;
};

}  // namespace throng
