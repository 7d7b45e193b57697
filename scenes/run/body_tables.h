// What is worked out once for a kind of body, before the first frame: its meshes, the tables of its
// gaits, the volumes around its parts.
// One rule: all of it is immutable and follows from its key alone, so runs that share it come out
// as runs that do not.
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

/// From several threads at once; whoever asks for what another is making waits for it.
class BodyTables {
 public:
  /// As load_model(), each file once: a file that changes meanwhile is not read again.
  std::shared_ptr<const Model> model(const std::filesystem::path& urdf_file);

  /// The plain gait of a model and those of `styles`, in the room that they need together.
  std::shared_ptr<const ModelGaits> gaits(const std::shared_ptr<const Model>& model,
                                          GaitStyles styles, Workers& workers);

  /// As body_type() of kinds.h.
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

  /// A megabyte or five each: sets differ by the styles that chance gave to few people.
  static constexpr size_t kMaxSets = 16;

  void tabulate(const std::shared_ptr<const Model>& model, GaitStyles styles, Workers& workers);
  const Gait* find_gait(const std::shared_ptr<const Model>& model, size_t style) const;

  mutable std::mutex models_mutex_, gaits_mutex_, types_mutex_;
  std::map<std::string, std::shared_ptr<const Model>> models_;
  std::vector<StyledGait> single_gaits_;  ///< what takes long to work out; its room is of no use
  std::vector<Gaits> gaits_;              ///< of the latest sets of styles, the oldest first
  std::vector<Type> types_;
};

}  // namespace throng
