#include "bench/workbench/tested_volume.h"
#include "culling/volumes/volume_list.h"

namespace throng::bench {

VolumeList project_volumes() {
  static const auto volumes = [] {
    std::vector<std::unique_ptr<const TestedVolume>> out;
    for_each_volume([&]<typename V>(VolumeKind kind) {
      const std::string name(name_of(kind));
      out.push_back(std::make_unique<TestedVolumeOf<V>>(name));
      if constexpr (HasRefit<V>)
        out.push_back(
            std::make_unique<TestedVolumeOf<V, Update::kFromVertices>>(name + "_vertices"));
    });
    return out;
  }();
  static const auto list = [] {
    std::vector<const TestedVolume*> out;
    for (const auto& volume : volumes) out.push_back(volume.get());
    return out;
  }();
  return list;
}

}  // namespace throng::bench
