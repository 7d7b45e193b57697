// Culling: which parts of which bodies overlap. Knows poses and points: no avatar, no KDL, no file.
// One rule: these headers, and event_hash.h, are the door; what lies in the folders is behind it.
#pragma once

#include "culling/bodies.h"
#include "culling/body_type.h"
#include "culling/counters.h"
#include "culling/culler.h"
#include "culling/pair.h"
#include "culling/pair_filter.h"
#include "culling/proximity.h"
