// BodyTables shares what is computed once per kind of body: meshes, gait tables, volumes of parts.
// Invariant: entries are immutable and follow from their key alone; sharing never changes a result.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "avatars/model/model.h"
#include "base/workers.h"
#include "culling/body_type.h"
#include "scenes/file/part_volumes.h"
#include "scenes/run/postures.h"

namespace throng {

/// Thread-safe; a caller waits if another thread is computing the same entry.
class BodyTables {
 public:
  /// Loads each file once, see load_model(); later changes of the file have no effect.
  std::shared_ptr<const Model> model(const std::filesystem::path& urdf_file);

  /// Plain gait of a model and those of `styles`, with common bounds.
  std::shared_ptr<const ModelGaits> gaits(const std::shared_ptr<const Model>& model,
                                          GaitStyles styles, Workers& workers);

  std::shared_ptr<const BodyType> body_type(const std::shared_ptr<const Model>& model,
                                            const RootSphere& sphere, const PartVolumes& volumes);

 private:
  struct StyledGait {
    std::shared_ptr<const Model> model;
    size_t style = 0;
    std::shared_ptr<const Gait> gait;
  };
  struct Gaits {
    std::shared_ptr<const Model> model;
    GaitStyles styles;
    std::shared_ptr<const ModelGaits> gaits;
  };
  struct Type {
    std::shared_ptr<const Model> model;
    RootSphere sphere;
    PartVolumes volumes;
    std::shared_ptr<const BodyType> type;
  };

  /// A set takes 1 to 5 MB. Sets differ by the styles that few agents happen to draw.
  static constexpr size_t kMaxSets = 16;

  void tabulate(const std::shared_ptr<const Model>& model, GaitStyles styles, Workers& workers);
  const Gait* find_gait(const std::shared_ptr<const Model>& model, size_t style) const;

  mutable std::mutex models_mutex_, gaits_mutex_, types_mutex_;
  std::map<std::string, std::shared_ptr<const Model>> models_;
  std::vector<StyledGait> single_gaits_;  ///< expensive tables; their bounds are not used
  std::vector<Gaits> gaits_;              ///< latest sets of styles, oldest first
  std::vector<Type> types_;
};

}  // namespace throng
