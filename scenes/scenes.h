// Scenes: scene files, people walking in them, and the simulation step.
#pragma once

#include "scenes/file/scene.h"
#include "scenes/run/runner.h"
#include "scenes/run/simulation.h"
#include "scenes/run/sink.h"
