// culling.h includes the interface of culling: bodies and poses in, pairs of parts in contact out.
// Culling does not depend on avatars, KDL or files.
// Invariant: code outside of culling includes only these headers and event_hash.h.
#pragma once

#include "base/errors.h"
#include "culling/bodies.h"
#include "culling/body_type.h"
#include "culling/counters.h"
#include "culling/culler.h"
#include "culling/pair.h"
#include "culling/pair_filter.h"
#include "culling/part_distance.h"
#include "culling/proximity.h"
