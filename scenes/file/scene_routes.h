// Reading where people come from and go to: areas, goals, sources.
// One rule: every area lies on the ground; every complaint names file:line.
#pragma once

#include <string>
#include <vector>

#include "scenes/file/scene.h"
#include "scenes/file/scene_fields.h"

namespace throng {

/// A rectangle within the ground. `what` names it in messages: "spawn".
Rectangle read_area(const std::string& file, const YamlNode& node, const std::string& what,
                    const Rectangle& ground);

/// The items of a list-valued key; an absent key is an empty list unless it is required, which
/// takes one item at least.
std::vector<const YamlNode*> items_of(Fields& fields, const std::string& key, bool required);

/// The keys `goals`, `on_arrival`, `sources` and `delay_s` of a group.
void read_routes(Fields& fields, const Rectangle& ground, Group& group);

}  // namespace throng
