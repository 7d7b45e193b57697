// The volumes fitted to a body type, for the inside of culling only.
// One rule: fitted once in the part's frame; what a frame needs of them is only read.
#pragma once

#include <vector>

#include "culling/body_type.h"
#include "culling/exact/triangle_bvh.h"
#include "culling/kernels/kernels.h"
#include "culling/volumes/ordop_pair.h"
#include "culling/volumes/volumes.h"

namespace throng {

struct BodyType::Volumes {
  std::vector<Slabs> slabs;  ///< one a part, as all below
  std::vector<OrdopTable> ordops;
  std::vector<OrdopLanes> ordop_lanes_14, ordop_lanes_18, ordop_lanes_26;
  std::vector<Sphere::Fitted> spheres;
  std::vector<Aabb::Fitted> aabbs;
  std::vector<Obb::Fitted> obbs;
  std::vector<TriangleBvh> surfaces;  ///< empty if any part is a point cloud
};

}  // namespace throng
