// Scenes: scene files, motion of avatars, and the simulation step.
#pragma once

#include "base/errors.h"
#include "scenes/file/scene.h"
#include "scenes/run/crowd_change.h"
#include "scenes/run/runner.h"
#include "scenes/run/simulation.h"
#include "scenes/run/sink.h"
