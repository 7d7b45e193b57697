#include "scenes/crowd/steering/steering.h"

#include "scenes/crowd/steering/collision_free_speed.h"
#include "scenes/crowd/steering/orca.h"

namespace throng {
namespace {

using Function = void (*)(const SteeringView&, size_t, size_t, float*, float*);

/// A model that is one function for each target.
class FunctionModel : public SteeringModel {
 public:
  explicit FunctionModel(Function function) : function_(function) {}
  void decide(const SteeringView& people, size_t begin, size_t end, float* next_x_mps,
              float* next_y_mps) const override {
    function_(people, begin, end, next_x_mps, next_y_mps);
  }

 private:
  Function function_;
};

Function orca_on(SimdTarget target) {
  switch (target) {
    case SimdTarget::kSse4:
      return decide_orca_sse4;
    case SimdTarget::kAvx2:
      return decide_orca_avx2;
    case SimdTarget::kAvx512:
      return decide_orca_avx512;
    default:
      return decide_orca_scalar;
  }
}

}  // namespace

std::string_view name_of(SteeringKind kind) {
  return kind == SteeringKind::kOrca ? "orca" : "speed";
}

std::optional<SteeringKind> steering_kind_of(std::string_view name) {
  for (const SteeringKind kind : kAllSteeringKinds)
    if (name_of(kind) == name) return kind;
  return std::nullopt;
}

std::unique_ptr<const SteeringModel> make_steering_model(SteeringKind kind, SimdTarget target) {
  if (kind == SteeringKind::kSpeed)
    return std::make_unique<FunctionModel>(decide_collision_free_speed);
  return std::make_unique<FunctionModel>(orca_on(resolved(target)));
}

}  // namespace throng
