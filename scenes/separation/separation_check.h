// Whether a run can judge the separation that its scene asks for.
// One rule: what a margin cannot reach is refused, or said, before the run.
#pragma once

#include <string>
#include <vector>

#include "scenes/file/scene.h"

namespace throng {

/// Throws InputError where the scene has a separation that needs a margin, triangles, or a larger
/// margin than the scene has.
void require_judgeable(const Scene& scene);

/// Throws InputError where there is nothing to be written; `where` names the option that asks.
void require_separation(const Scene& scene, const std::string& where);

/// What is to be known of it: up to which speeds the margin reaches, parts of people that are of no
/// region of the body.
std::vector<std::string> separation_notes(const Scene& scene);

}  // namespace throng
