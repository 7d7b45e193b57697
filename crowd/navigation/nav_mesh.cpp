#include "crowd/navigation/nav_mesh.h"

#include <DetourNavMesh.h>
#include <DetourNavMeshBuilder.h>
#include <DetourNavMeshQuery.h>
#include <Recast.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/portable_math.h"
#include "crowd/navigation/flow_field.h"
#include "crowd/navigation/footprints.h"
#include "geometry/floor.h"

namespace throng {
namespace {

/// A doorway of 0.8 m leaves four such voxels between the bodies' margins.
constexpr double kMinVoxel_m = 0.1;
/// A million voxels build in about a second.
constexpr double kMaxVoxels = 1 << 20;
/// Recast walks 40 000 sides of voxels round a region and drops the rest of a longer contour.
constexpr double kMaxVoxelsPerRow = 15'000;
/// Time for the polygons of a region grows with the cube of its corners: with 600 some 0.05 s.
constexpr int kMaxRegionCorners = 600;
/// Side of the squares that divide regions if one has more corners.
constexpr int kDividedVoxels = 48;
constexpr unsigned short kMaxRegions = 0x7fff;  // the bit above marks borders
/// In fewer rows than this Recast finds no region.
constexpr double kMinVoxelRows = 4;
/// A mesh has at most 65 534 corners, and a footprint at least three of them.
constexpr size_t kMaxFootprints = 65'534;
constexpr float kVoxelHeight_m = 0.1f;
/// Tolerance of contour corners in voxels: straight walls become one edge.
constexpr float kContourError = 1.3f;
constexpr int kCornersPerPolygon = 6;
constexpr int kMergeVoxels = 400;
constexpr unsigned short kWalk = 1;
/// A point this close to the mesh belongs to it: the margin that bodies keep to walls.
constexpr double kBeside_m = 0.5;
constexpr int kMaxPolygons = 4096;  // per path
constexpr int kMaxCorners = 1024;
constexpr int kMaxNodes = 65535;  // Detour numbers the nodes of a search with 16 bits

/// Returns a convex footprint inflated by a margin.
std::vector<Eigen::Vector2d> widened(const std::vector<Eigen::Vector2d>& footprint,
                                     double margin_m) {
  // A polygon around each corner encloses the circle of the margin.
  constexpr int kSides = 12;
  const double half_rad = 3.14159265358979323846 / kSides;
  const double radius_m = margin_m / sin_cos(half_rad).cos;
  std::vector<Eigen::Vector2d> points;
  for (const Eigen::Vector2d& corner : footprint)
    for (int k = 0; k < kSides; ++k) {
      const SinCos turn = sin_cos((2 * k + 1) * half_rad);
      points.push_back(corner + radius_m * Eigen::Vector2d(turn.cos, turn.sin));
    }
  return convex_hull(std::move(points));
}

/// Returns the neighbour of a voxel in one of four directions, or -1 at a wall.
int neighbour_of(const rcCompactHeightfield& open, int voxel, int column, int row, int direction) {
  const int level = rcGetCon(open.spans[voxel], direction);
  if (level == RC_NOT_CONNECTED) return -1;
  const int cell =
      column + rcGetDirOffsetX(direction) + (row + rcGetDirOffsetY(direction)) * open.width;
  return static_cast<int>(open.cells[cell].index) + level;
}

template <typename Visit>
void for_each_voxel(const rcCompactHeightfield& open, const Visit& visit) {
  for (int row = 0; row < open.height; ++row)
    for (int column = 0; column < open.width; ++column) {
      const rcCompactCell& cell = open.cells[column + row * open.width];
      for (unsigned i = 0; i < cell.count; ++i)
        visit(static_cast<int>(cell.index + i), column, row);
    }
}

bool has_large_regions(const rcContourSet& contours) {
  return std::any_of(contours.conts, contours.conts + contours.nconts,
                     [](const rcContour& each) { return each.nverts > kMaxRegionCorners; });
}

/// Divides all regions along a grid of squares; each connected part becomes a region. Returns
/// false, without a change, if they would be too many.
bool divide_regions(rcCompactHeightfield& open) {
  struct Place {
    int voxel, column, row;
  };
  std::vector<unsigned short> regions(static_cast<size_t>(open.spanCount));
  std::vector<Place> front;
  int count = 0;
  for_each_voxel(open, [&](int seed, int seed_column, int seed_row) {
    if (open.spans[seed].reg == 0 || regions[static_cast<size_t>(seed)] != 0) return;
    if (++count >= kMaxRegions) return;
    const auto name = static_cast<unsigned short>(count);
    regions[static_cast<size_t>(seed)] = name;
    front.assign(1, {seed, seed_column, seed_row});
    while (!front.empty()) {
      const auto [voxel, column, row] = front.back();
      front.pop_back();
      for (int direction = 0; direction < 4; ++direction) {
        const int next = neighbour_of(open, voxel, column, row, direction);
        const int next_column = column + rcGetDirOffsetX(direction),
                  next_row = row + rcGetDirOffsetY(direction);
        if (next < 0 || regions[static_cast<size_t>(next)] != 0 ||
            open.spans[next].reg != open.spans[seed].reg ||
            next_column / kDividedVoxels != seed_column / kDividedVoxels ||
            next_row / kDividedVoxels != seed_row / kDividedVoxels)
          continue;
        regions[static_cast<size_t>(next)] = name;
        front.push_back({next, next_column, next_row});
      }
    }
  });
  if (count >= kMaxRegions) return false;
  for (int i = 0; i < open.spanCount; ++i) open.spans[i].reg = regions[static_cast<size_t>(i)];
  open.maxRegions = static_cast<unsigned short>(count);
  return true;
}

}  // namespace

double Path::length_m() const {
  double length = 0;
  for (size_t i = 1; i < corners_m.size(); ++i) length += (corners_m[i] - corners_m[i - 1]).norm();
  return length;
}

struct NavMesh::State {
  template <typename T, void (*Free)(T*)>
  struct Freed {
    void operator()(T* owned) const { Free(owned); }
  };
  template <typename T, void (*Free)(T*)>
  using Owned = std::unique_ptr<T, Freed<T, Free>>;

  State(const Rectangle& ground, std::span<const std::vector<Eigen::Vector2d>> footprints,
        std::span<const Passage> passages, std::span<const Passage> closures,
        const std::vector<Polygon>& floor);

  bool build(const Rectangle& ground, std::span<const std::vector<Eigen::Vector2d>> footprints,
             std::span<const Passage> passages, std::span<const Passage> closures,
             const std::vector<Polygon>& floor);
  void keep_floor(const std::vector<Polygon>& floor, rcCompactHeightfield& open) const;
  void mark(const Passage& passage, unsigned char area, rcCompactHeightfield& open) const;
  bool take(rcPolyMesh& polygons);
  void name_pieces();

  // Recast's y is up, its z is our y. Relative to a corner of the ground for precision.
  std::array<float, 3> local(const Eigen::Vector2d& point) const {
    return {static_cast<float>(point.x() - origin_m.x()), 0,
            static_cast<float>(point.y() - origin_m.y())};
  }
  Eigen::Vector2d world(const float* point) const {
    return origin_m + Eigen::Vector2d(static_cast<double>(point[0]), static_cast<double>(point[2]));
  }
  dtPolyRef polygon_at(const Eigen::Vector2d& point, float* nearest) const;

  double voxel_m = 0;
  Eigen::Vector2d size_m;  ///< size of the ground; a very narrow one is widened on both sides
  Eigen::Vector2d origin_m;
  Owned<dtNavMesh, dtFreeNavMesh> mesh;
  Owned<dtNavMeshQuery, dtFreeNavMeshQuery> query;
  dtQueryFilter filter;
  std::vector<int> pieces;  ///< per polygon
};

NavMesh::State::State(const Rectangle& ground,
                      std::span<const std::vector<Eigen::Vector2d>> footprints,
                      std::span<const Passage> passages, std::span<const Passage> closures,
                      const std::vector<Polygon>& floor)
    : voxel_m(std::max({kMinVoxel_m, std::sqrt(ground.area_m2() / kMaxVoxels),
                        ground.size_m().maxCoeff() / kMaxVoxelsPerRow})),
      size_m(ground.size_m().cwiseMax(kMinVoxelRows * voxel_m)),
      origin_m(ground.min_m - 0.5 * (size_m - ground.size_m())) {
  if (build(ground, footprints, passages, closures, floor))
    name_pieces();
  else
    mesh.reset();
}

/// Recast checks no input: this is called with valid input only.
bool NavMesh::State::build(const Rectangle& ground,
                           std::span<const std::vector<Eigen::Vector2d>> footprints,
                           std::span<const Passage> passages, std::span<const Passage> closures,
                           const std::vector<Polygon>& floor) {
  const Eigen::Vector2d size = size_m;
  const bool is_ground = origin_m.allFinite() && size.allFinite() &&
                         ground.size_m().minCoeff() > 0 && std::isfinite(voxel_m) &&
                         footprints.size() <= kMaxFootprints;
  if (!is_ground) return false;
  const auto width = static_cast<float>(size.x());
  const auto depth = static_cast<float>(size.y());
  const auto voxel = static_cast<float>(voxel_m);
  const float low[] = {0, -1, 0};
  const float high[] = {width, 3, depth};
  int columns = 0, rows = 0;
  rcCalcGridSize(low, high, voxel, &columns, &rows);
  if (columns < 1 || rows < 1) return false;
  rcContext context(false);
  const Owned<rcHeightfield, rcFreeHeightField> solid(rcAllocHeightfield());
  if (!solid ||
      !rcCreateHeightfield(&context, *solid, columns, rows, low, high, voxel, kVoxelHeight_m))
    return false;
  const float corners[] = {0, 0, 0, width, 0, 0, width, 0, depth, 0, 0, depth};
  const int triangles[] = {0, 2, 1, 0, 3, 2};
  const unsigned char areas[] = {RC_WALKABLE_AREA, RC_WALKABLE_AREA};
  if (!rcRasterizeTriangles(&context, corners, 4, triangles, areas, 2, *solid, 1)) return false;
  const Owned<rcCompactHeightfield, rcFreeCompactHeightfield> open(rcAllocCompactHeightfield());
  if (!open || !rcBuildCompactHeightfield(&context, 2, 1, *solid, *open)) return false;
  // Steering keeps agents off footprints; the mesh therefore uses them, not the triangles.
  const double margin_m = FlowGrid::margin_m(voxel_m);
  for (const std::vector<Eigen::Vector2d>& footprint : footprints) {
    std::vector<float> outline;
    for (const Eigen::Vector2d& corner : widened(footprint, margin_m)) {
      const std::array<float, 3> point = local(corner);
      outline.insert(outline.end(), point.begin(), point.end());
    }
    const auto is_finite = [](float each) { return std::isfinite(each); };
    if (outline.empty() || !std::all_of(outline.begin(), outline.end(), is_finite)) return false;
    rcMarkConvexPolyArea(&context, outline.data(), static_cast<int>(outline.size() / 3), -1, 3,
                         RC_NULL_AREA, *open);
  }
  if (!floor.empty()) keep_floor(floor, *open);
  // A gap is open exactly for agents that fit through, regardless of rounding to voxels.
  for (const Passage& closure : closures) mark(closure, RC_NULL_AREA, *open);
  for (const Passage& passage : passages) mark(passage, RC_WALKABLE_AREA, *open);
  Owned<rcContourSet, rcFreeContourSet> contours(rcAllocContourSet());
  const Owned<rcPolyMesh, rcFreePolyMesh> polygons(rcAllocPolyMesh());
  if (!contours || !polygons) return false;
  if (!rcBuildDistanceField(&context, *open) ||
      !rcBuildRegions(&context, *open, 0, 0, kMergeVoxels) ||
      !rcBuildContours(&context, *open, kContourError, 0, *contours))
    return false;
  if (has_large_regions(*contours) && divide_regions(*open)) {
    contours.reset(rcAllocContourSet());
    if (!contours || !rcBuildContours(&context, *open, kContourError, 0, *contours)) return false;
  }
  return rcBuildPolyMesh(&context, *contours, kCornersPerPolygon, *polygons) &&
         polygons->npolys > 0 && take(*polygons);
}

/// Removes voxels whose centres are off the floor.
void NavMesh::State::keep_floor(const std::vector<Polygon>& floor,
                                rcCompactHeightfield& open) const {
  for (int row = 0; row < open.height; ++row) {
    const std::vector<double> crossings = crossings_m(floor, origin_m.y() + (row + 0.5) * voxel_m);
    size_t passed = 0;
    for (int column = 0; column < open.width; ++column) {
      const double x_m = origin_m.x() + (column + 0.5) * voxel_m;
      while (passed < crossings.size() && crossings[passed] <= x_m) ++passed;
      if (passed % 2 == 1) continue;
      const rcCompactCell& cell = open.cells[column + row * open.width];
      const unsigned end = unsigned{cell.index} + unsigned{cell.count};
      for (unsigned span = cell.index; span < end; ++span) open.areas[span] = RC_NULL_AREA;
    }
  }
}

void NavMesh::State::mark(const Passage& passage, unsigned char area,
                          rcCompactHeightfield& open) const {
  const double reach_m = 0.8 * voxel_m;  // no step from voxel to voxel is skipped
  const Eigen::Vector2d from = passage.from_m - origin_m;
  const Eigen::Vector2d extent = passage.to_m - passage.from_m;
  const auto voxel_at = [&](double offset_m, int count) {
    return std::clamp(static_cast<int>(std::floor(offset_m / voxel_m)), 0, count - 1);
  };
  const Eigen::Vector2d low = from.cwiseMin(from + extent).array() - reach_m;
  const Eigen::Vector2d high = from.cwiseMax(from + extent).array() + reach_m;
  for (int row = voxel_at(low.y(), open.height); row <= voxel_at(high.y(), open.height); ++row)
    for (int column = voxel_at(low.x(), open.width); column <= voxel_at(high.x(), open.width);
         ++column) {
      const Eigen::Vector2d centre = voxel_m * Eigen::Vector2d(column + 0.5, row + 0.5);
      const double along =
          extent.squaredNorm() > 0
              ? std::clamp(extent.dot(centre - from) / extent.squaredNorm(), 0.0, 1.0)
              : 0.0;
      if ((centre - from - along * extent).norm() > reach_m) continue;
      const rcCompactCell& cell = open.cells[column + row * open.width];
      const unsigned end = unsigned{cell.index} + unsigned{cell.count};
      for (unsigned span = cell.index; span < end; ++span) open.areas[span] = area;
    }
}

bool NavMesh::State::take(rcPolyMesh& polygons) {
  std::fill_n(polygons.flags, polygons.npolys, kWalk);
  dtNavMeshCreateParams params{};
  params.verts = polygons.verts;
  params.vertCount = polygons.nverts;
  params.polys = polygons.polys;
  params.polyAreas = polygons.areas;
  params.polyFlags = polygons.flags;
  params.polyCount = polygons.npolys;
  params.nvp = polygons.nvp;
  params.walkableHeight = 2;
  params.walkableRadius = static_cast<float>(FlowGrid::margin_m(voxel_m));
  params.walkableClimb = kVoxelHeight_m;
  std::copy_n(polygons.bmin, 3, params.bmin);
  std::copy_n(polygons.bmax, 3, params.bmax);
  params.cs = polygons.cs;
  params.ch = polygons.ch;
  params.buildBvTree = true;
  unsigned char* data = nullptr;
  int size = 0;
  if (!dtCreateNavMeshData(&params, &data, &size)) return false;
  mesh.reset(dtAllocNavMesh());
  if (!mesh || dtStatusFailed(mesh->init(data, size, DT_TILE_FREE_DATA))) {
    dtFree(data);
    return false;
  }
  query.reset(dtAllocNavMeshQuery());
  return query != nullptr && dtStatusSucceed(query->init(mesh.get(), kMaxNodes));
}

/// Flood fill from each polygon without a piece.
void NavMesh::State::name_pieces() {
  const dtMeshTile* tile = static_cast<const dtNavMesh&>(*mesh).getTile(0);
  pieces.assign(static_cast<size_t>(tile->header->polyCount), -1);
  int piece = 0;
  std::vector<unsigned> front;
  for (size_t seed = 0; seed < pieces.size(); ++seed) {
    if (pieces[seed] >= 0) continue;
    pieces[seed] = piece;
    front.assign(1, static_cast<unsigned>(seed));
    while (!front.empty()) {
      const dtPoly& polygon = tile->polys[front.back()];
      front.pop_back();
      for (unsigned link = polygon.firstLink; link != DT_NULL_LINK; link = tile->links[link].next) {
        const unsigned next = mesh->decodePolyIdPoly(tile->links[link].ref);
        if (pieces[next] >= 0) continue;
        pieces[next] = piece;
        front.push_back(next);
      }
    }
    ++piece;
  }
}

dtPolyRef NavMesh::State::polygon_at(const Eigen::Vector2d& point, float* nearest) const {
  if (!point.allFinite()) return 0;
  const std::array<float, 3> centre = local(point);
  // Where voxels are coarse the mesh keeps farther from the rim.
  const auto beside_m = static_cast<float>(std::max(kBeside_m, 1.5 * voxel_m));
  const float reach[] = {beside_m, 2, beside_m};
  dtPolyRef polygon = 0;
  if (dtStatusFailed(query->findNearestPoly(centre.data(), reach, &filter, &polygon, nearest)))
    return 0;
  return polygon;
}

NavMesh::NavMesh(const Rectangle& ground, std::span<const std::vector<Eigen::Vector2d>> footprints,
                 std::span<const Passage> passages, std::span<const Passage> closures,
                 const std::vector<Polygon>& floor)
    : state_(std::make_unique<State>(ground, footprints, passages, closures, floor)) {}
NavMesh::~NavMesh() = default;
NavMesh::NavMesh(NavMesh&&) noexcept = default;

bool NavMesh::is_built() const { return state_->mesh != nullptr; }
int NavMesh::polygon_count() const { return static_cast<int>(state_->pieces.size()); }
double NavMesh::voxel_m() const { return state_->voxel_m; }

int NavMesh::piece_at(const Eigen::Vector2d& point) const {
  if (!is_built()) return -1;
  float nearest[3];
  const dtPolyRef polygon = state_->polygon_at(point, nearest);
  return polygon == 0 ? -1 : state_->pieces[state_->mesh->decodePolyIdPoly(polygon)];
}

Path NavMesh::path(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const {
  Path path;
  if (!is_built()) return path;
  const State& s = *state_;
  float start[3], end[3];
  const dtPolyRef first = s.polygon_at(from, start);
  dtPolyRef last = s.polygon_at(to, end);
  if (first == 0) return path;
  if (last == 0) {  // far from the mesh: as close as the start's polygon gets
    last = first;
    if (!to.allFinite() ||
        dtStatusFailed(s.query->closestPointOnPoly(first, s.local(to).data(), end, nullptr)))
      return path;
  } else {
    path.arrives = true;
  }
  std::vector<dtPolyRef> polygons(kMaxPolygons);
  int count = 0;
  if (dtStatusFailed(s.query->findPath(first, last, start, end, &s.filter, polygons.data(), &count,
                                       kMaxPolygons)) ||
      count == 0) {
    path.arrives = false;
    return path;
  }
  if (polygons[static_cast<size_t>(count - 1)] != last) {
    path.arrives = false;
    float nearest[3];
    if (dtStatusSucceed(s.query->closestPointOnPoly(polygons[static_cast<size_t>(count - 1)], end,
                                                    nearest, nullptr)))
      std::copy_n(nearest, 3, end);
  }
  std::vector<float> corners(size_t{3} * kMaxCorners);
  int corner_count = 0;
  if (dtStatusFailed(s.query->findStraightPath(start, end, polygons.data(), count, corners.data(),
                                               nullptr, nullptr, &corner_count, kMaxCorners))) {
    path.arrives = false;
    return path;
  }
  for (int i = 0; i < corner_count; ++i)
    path.corners_m.push_back(s.world(&corners[3 * static_cast<size_t>(i)]));
  return path;
}

/// Returns the sample of an area on a piece of the mesh nearest to the middle, or the middle.
Eigen::Vector2d NavMesh::place_in(const Area& area, int piece) const {
  constexpr int kSamples = 8;
  Eigen::Vector2d best = area.middle_m();
  if (piece_at(best) == piece) return best;
  double best_m2 = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kSamples; ++i)
    for (int j = 0; j <= kSamples; ++j) {
      const Eigen::Vector2d share(i / double{kSamples}, j / double{kSamples});
      const Eigen::Vector2d point = area.at(share);
      const double away_m2 = (point - area.middle_m()).squaredNorm();
      if (away_m2 >= best_m2 || piece_at(point) != piece) continue;
      best_m2 = away_m2;
      best = point;
    }
  return best;
}

Path NavMesh::path(const Eigen::Vector2d& from, std::span<const Area> areas) const {
  Path best;
  double best_m = std::numeric_limits<double>::infinity();
  const int piece = piece_at(from);
  for (const Area& area : areas) {
    const Eigen::Vector2d to = place_in(area, piece);
    Path found = path(from, to);
    if (found.corners_m.empty()) return found;
    // Paths that end short rank after all that arrive, the nearest end first.
    const double short_m = found.arrives ? 0 : 1e9 + (found.corners_m.back() - to).norm();
    if (found.length_m() + short_m >= best_m) continue;
    best_m = found.length_m() + short_m;
    best = std::move(found);
  }
  return best;
}

}  // namespace throng
