// What a part of a body is called in tables.
// One rule: every part of every body of a run has a name.
#pragma once

#include <cstdint>
#include <string>

#include "scenes/run/sink.h"

namespace throng {

/// As its model has it; "whole body" where no part was asked, "obstacle" for what is no avatar.
inline std::string part_name(const RunInfo& run, uint32_t body, uint32_t part) {
  if (body >= run.model_of_avatar.size()) return "obstacle";
  const std::vector<Part>& parts = run.models[run.model_of_avatar[body]]->parts;
  return part < parts.size() ? parts[part].name : "whole body";
}

}  // namespace throng
