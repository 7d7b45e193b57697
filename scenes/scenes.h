// Scenes: scene files, people walking in them, and the simulation step.
#pragma once

#include "scenes/runner.h"
#include "scenes/scene.h"
#include "scenes/simulation.h"
#include "scenes/sink.h"
