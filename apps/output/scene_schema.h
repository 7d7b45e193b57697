// What a scene file may hold, as JSON Schema (2020-12), which editors complete and check by.
// One rule: made of the tables that the reader of scenes uses.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace throng {

nlohmann::ordered_json scene_schema();

}  // namespace throng
