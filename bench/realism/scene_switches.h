// What is switched on or off in every scene that is measured.
// One rule: the only place that changes a scene, so that before and after differ by it alone.
#pragma once

#include "scenes/file/scene.h"

namespace throng::realism {

/// --yielding off: bodies walk as if they were alone.
inline bool bodies_yield = true;

inline void set_switches(Scene& scene) {
  scene.exact = true;
  if (!bodies_yield) scene.yielding = false;
}

}  // namespace throng::realism
