#include "crowd/steering/steering.h"

#include <cassert>
#include <iterator>

#include "crowd/steering/collision_free_speed.h"
#include "crowd/steering/heuristic.h"
#include "crowd/steering/orca.h"

namespace throng {
namespace {

class FunctionModel : public SteeringModel {
 public:
  FunctionModel(SteeringFunction function, const SteeringTraits& traits)
      : function_(function), traits_(traits) {}
  void decide(const SteeringView& people, std::span<const uint32_t> slots, float* next_x_mps,
              float* next_y_mps) const override {
    function_(people, slots, next_x_mps, next_y_mps);
  }
  SteeringTraits traits() const override { return traits_; }

 private:
  SteeringFunction function_;
  SteeringTraits traits_;
};

std::unique_ptr<const SteeringModel> make_orca(SimdTarget target) {
  return std::make_unique<FunctionModel>(orca_on(target), SteeringTraits{});
}

std::unique_ptr<const SteeringModel> make_collision_free_speed(SimdTarget) {
  return std::make_unique<FunctionModel>(decide_collision_free_speed,
                                         SteeringTraits{.has_time_gap = true});
}

std::unique_ptr<const SteeringModel> make_heuristic(SimdTarget target) {
  return std::make_unique<FunctionModel>(heuristic_on(target), kHeuristicTraits);
}

/// All that other code knows about a model.
struct Entry {
  SteeringKind kind;
  std::string_view name;
  std::unique_ptr<const SteeringModel> (*make)(SimdTarget);
};

constexpr Entry kModels[] = {
    {SteeringKind::kOrca, "orca", make_orca},
    {SteeringKind::kCollisionFreeSpeed, "collision_free_speed", make_collision_free_speed},
    {SteeringKind::kHeuristic, "heuristic", make_heuristic},
};

constexpr bool is_in_order() {
  size_t row = 0;
  for (const Entry& entry : kModels)
    if (static_cast<size_t>(entry.kind) != row++) return false;
  return true;
}
static_assert(is_in_order(), "rows are found by kind");

const Entry& entry_of(SteeringKind kind) {
  const auto row = static_cast<size_t>(kind);
  assert(row < std::size(kModels) && "a kind without a row");
  return kModels[row];
}

}  // namespace

std::vector<SteeringKind> all_steering_kinds() {
  std::vector<SteeringKind> kinds;
  for (const Entry& entry : kModels) kinds.push_back(entry.kind);
  return kinds;
}

std::string_view name_of(SteeringKind kind) { return entry_of(kind).name; }

std::optional<SteeringKind> steering_kind_of(std::string_view name) {
  for (const Entry& entry : kModels)
    if (entry.name == name) return entry.kind;
  return std::nullopt;
}

std::vector<std::string> steering_names() {
  std::vector<std::string> names;
  for (const Entry& entry : kModels) names.emplace_back(entry.name);
  return names;
}

std::string steering_choices() {
  std::string text;
  for (size_t row = 0; row < std::size(kModels); ++row) {
    if (row > 0) text += row + 1 < std::size(kModels) ? ", " : " or ";
    text += kModels[row].name;
  }
  return text;
}

std::unique_ptr<const SteeringModel> make_steering_model(SteeringKind kind, SimdTarget target) {
  return entry_of(kind).make(target);
}

}  // namespace throng
