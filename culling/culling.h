// Culling: which parts of which bodies overlap. Knows poses and points: no avatar, no KDL, no file.
#pragma once

#include "culling/body_type.h"
#include "culling/culler.h"
#include "culling/pair_level.h"
#include "culling/stages/pair_events.h"
#include "culling/strategies/strategy.h"
#include "culling/volumes/volume_kind.h"
