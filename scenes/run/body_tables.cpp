#include "scenes/run/body_tables.h"

#include "avatars/gait/gait_file.h"
#include "scenes/run/body_kinds.h"

namespace throng {
namespace {

bool same(const RootSphere& a, const RootSphere& b) {
  return a.centre_m == b.centre_m && a.radius_m == b.radius_m &&
         a.upright_radius_m == b.upright_radius_m;
}

}  // namespace

std::shared_ptr<const Model> BodyTables::model(const std::filesystem::path& urdf_file) {
  const std::lock_guard lock(models_mutex_);
  std::shared_ptr<const Model>& model = models_[urdf_file.string()];
  if (model == nullptr) model = load_model(urdf_file);
  return model;
}

const Gait* BodyTables::find_gait(const std::shared_ptr<const Model>& model, size_t style) const {
  for (const StyledGait& one : single_gaits_)
    if (one.model == model && one.style == style) return one.gait.get();
  return nullptr;
}

void BodyTables::tabulate(const std::shared_ptr<const Model>& model, GaitStyles styles,
                          Workers& workers) {
  std::vector<StyledGait> fresh;
  for (size_t style = 0; style < kGaitStyleCount; ++style)
    if (styles[style] && find_gait(model, style) == nullptr)
      fresh.push_back({model, style, nullptr});
  workers.for_blocks(static_cast<int>(fresh.size()), [&](int index, int) {
    StyledGait& one = fresh[static_cast<size_t>(index)];
    one.gait = std::make_shared<const Gait>(gait_of(*model, static_cast<GaitStyle>(one.style)));
  });
  single_gaits_.insert(single_gaits_.end(), fresh.begin(), fresh.end());
}

std::shared_ptr<const ModelGaits> BodyTables::gaits(const std::shared_ptr<const Model>& model,
                                                    GaitStyles styles, Workers& workers) {
  styles.set(0);
  const std::lock_guard lock(gaits_mutex_);
  for (const Gaits& known : gaits_)
    if (known.model == model && known.styles == styles) return known.gaits;
  tabulate(model, styles, workers);
  const auto together = std::make_shared<ModelGaits>();
  for (size_t style = 0; style < kGaitStyleCount; ++style)
    if (styles[style]) together->of_style(style) = std::make_unique<Gait>(*find_gait(model, style));
  together->share_bounds();
  if (gaits_.size() >= kMaxSets) gaits_.erase(gaits_.begin());
  return gaits_.emplace_back(Gaits{model, styles, together}).gaits;
}

std::shared_ptr<const BodyType> BodyTables::body_type(const std::shared_ptr<const Model>& model,
                                                      const RootSphere& sphere,
                                                      const PartVolumes& volumes) {
  const std::lock_guard lock(types_mutex_);
  for (const Type& known : types_)
    if (known.model == model && same(known.sphere, sphere) && known.volumes == volumes)
      return known.type;
  if (types_.size() >= kMaxSets) types_.erase(types_.begin());
  return types_
      .emplace_back(Type{model, sphere, volumes, throng::body_type(*model, sphere, volumes)})
      .type;
}

}  // namespace throng
