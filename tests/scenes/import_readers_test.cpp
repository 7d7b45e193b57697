// Occupancy grids, JuPedSim's files and Vadere's scenarios as floor plans.
#include <gmock/gmock.h>
#include <png.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <span>

#include "base/random.h"
#include "geometry/polygon_union.h"
#include "scenes/import/grid_outline.h"
#include "scenes/import/plan_readers.h"
#include "tests/nightly.h"
#include "tests/recordings/binary_files.h"
#include "tests/scenes/scene_file.h"

namespace throng::import_readers_test {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

using Read = ImportedPlan (*)(const ImportOptions&);

class PlanFile : public SceneFile {
 protected:
  ImportedPlan read(Read reader, const std::string& name) const {
    return reader({.file = folder_ / name, .layers = {}, .unit_m = {}});
  }
  std::string refusal(Read reader, const std::string& name) const {
    try {
      read(reader, name);
    } catch (const InputError& error) {
      std::string message = error.what();
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
      for (size_t at; (at = message.find(folder_.string() + "/")) != std::string::npos;)
        message.erase(at, folder_.string().size() + 1);
      return message;
    }
    return "none";
  }

  /// Reads files with a few changed bytes: each is accepted or rejected with an error.
  void try_mutated(Read reader, const std::string& named, const std::string& mutated,
                   const std::string& text) const {
    const int count = test::is_nightly() ? 2000 : 100;
    int accepted = 0;
    for (int i = 0; i < count; ++i) {
      uint32_t draw = 0;
      const auto below = [&](size_t limit) {
        const RandomKey key{7, static_cast<uint64_t>(i), 0, Purpose::kStyle};
        return static_cast<size_t>(random_bits(key, draw++) % std::max<size_t>(limit, 1));
      };
      std::string bytes = text;
      for (size_t edits = 1 + below(4); edits > 0 && !bytes.empty(); --edits) {
        const size_t at = below(bytes.size()), length = below(20);
        switch (below(5)) {
          case 0:
            bytes[at] = static_cast<char>(below(256));
            break;
          case 1:
            bytes.erase(at, length);
            break;
          case 2:
            bytes.insert(below(bytes.size()), bytes.substr(at, length));
            break;
          case 3:
            bytes[at] = "0123456789-.,[]{}<>\"e"[below(21)];
            break;
          default:
            bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
        }
      }
      write(mutated, bytes);
      SCOPED_TRACE(testing::Message() << "mutated file " << i << " of " << mutated);
      std::string message;
      ASSERT_NO_THROW(message = refusal(reader, named));
      if (message == "none")
        ++accepted;
      else
        EXPECT_THAT(message, HasSubstr("expected"));
      EXPECT_EQ(message.find("crashes"), std::string::npos) << message;
    }
    EXPECT_LT(accepted, count);
  }
};

double area_of(const Polygon& polygon) {
  double doubled = std::abs(doubled_area(polygon.outline));
  for (const Polygon::Ring& hole : polygon.holes) doubled -= std::abs(doubled_area(hole));
  return doubled / 2;
}

double area_of(const std::vector<Polygon>& polygons) {
  double sum = 0;
  for (const Polygon& polygon : polygons) sum += area_of(polygon);
  return sum;
}

// ---- borders of grids

CellGrid grid_of(int64_t width, int64_t height, const std::function<bool(double, double)>& free) {
  CellGrid grid{width, height, {}};
  for (int64_t y = 0; y < height; ++y)
    for (int64_t x = 0; x < width; ++x)
      grid.is_free.push_back(free(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5));
  return grid;
}

bool is_inside(const Polygon& polygon, double x, double y) {
  bool inside = false;
  const auto add = [&](const Polygon::Ring& ring) {
    for (size_t i = 0, k = ring.size() - 1; i < ring.size(); k = i++)
      if ((ring[i].y() > y) != (ring[k].y() > y) &&
          x < ring[i].x() +
                  (y - ring[i].y()) / (ring[k].y() - ring[i].y()) * (ring[k].x() - ring[i].x()))
        inside = !inside;
  };
  add(polygon.outline);
  for (const Polygon::Ring& hole : polygon.holes) add(hole);
  return inside;
}

struct RingEdge {
  Eigen::Vector2d from, to;
  size_t ring, number, count;

  bool adjoins(const RingEdge& other) const {
    return ring == other.ring &&
           ((number + 1) % count == other.number || (other.number + 1) % count == number);
  }
  bool meets(const RingEdge& other) const {
    const auto side = [](const RingEdge& edge, const Eigen::Vector2d& p) {
      const Eigen::Vector2d along = edge.to - edge.from, off = p - edge.from;
      return along.x() * off.y() - along.y() * off.x();
    };
    for (int axis = 0; axis < 2; ++axis)
      if (std::max(from[axis], to[axis]) < std::min(other.from[axis], other.to[axis]) ||
          std::max(other.from[axis], other.to[axis]) < std::min(from[axis], to[axis]))
        return false;
    return side(*this, other.from) * side(*this, other.to) <= 0 &&
           side(other, from) * side(other, to) <= 0;
  }
};

std::vector<RingEdge> edges_of(const std::vector<Polygon>& polygons) {
  std::vector<RingEdge> edges;
  size_t rings = 0;
  const auto add = [&](const Polygon::Ring& ring) {
    for (size_t i = 0; i < ring.size(); ++i)
      edges.push_back({ring[i], ring[(i + 1) % ring.size()], rings, i, ring.size()});
    ++rings;
  };
  for (const Polygon& polygon : polygons) {
    add(polygon.outline);
    for (const Polygon::Ring& hole : polygon.holes) add(hole);
  }
  return edges;
}

double distance_to_border(const CellGrid& grid, const Eigen::Vector2d& p) {
  double least = 1e9;
  const auto step = [&](Eigen::Vector2d low, Eigen::Vector2d high) {
    least = std::min(least, (p - p.cwiseMax(low).cwiseMin(high)).norm());
  };
  for (int64_t y = 0; y <= grid.height; ++y)
    for (int64_t x = 0; x <= grid.width; ++x) {
      const bool own = grid.contains_free(x, y);
      const Eigen::Vector2d corner(static_cast<double>(x), static_cast<double>(y));
      if (own != grid.contains_free(x, y - 1)) step(corner, corner + Eigen::Vector2d(1, 0));
      if (own != grid.contains_free(x - 1, y)) step(corner, corner + Eigen::Vector2d(0, 1));
    }
  return least;
}

/// Noise for even seeds, overlapping rotated boxes for the others.
CellGrid random_grid(uint64_t seed) {
  uint32_t draw = 0;
  const auto below = [&](uint64_t limit) {
    return static_cast<double>(random_bits({seed, 1, 2, Purpose::kStyle}, draw++) % limit);
  };
  const auto width = static_cast<int64_t>(1 + below(seed % 2 == 0 ? 14 : 40)),
             height = static_cast<int64_t>(1 + below(seed % 2 == 0 ? 14 : 40));
  const double share = 5 + below(90);
  if (seed % 2 == 0)
    return grid_of(width, height, [&](double, double) { return below(100) < share; });
  CellGrid grid = grid_of(width, height, [](double, double) { return false; });
  for (double boxes = 3 + below(5); boxes > 0; --boxes) {
    const double x0 = below(40), y0 = below(40), length = 1 + below(20), width_half = 1 + below(5);
    const double angle = below(628) / 100;
    const uint8_t value = below(3) > 0 ? 1 : 0;
    for (int64_t y = 0; y < height; ++y)
      for (int64_t x = 0; x < width; ++x) {
        const double dx = static_cast<double>(x) + 0.5 - x0, dy = static_cast<double>(y) + 0.5 - y0;
        if (std::abs(dx * std::cos(angle) + dy * std::sin(angle)) < length &&
            std::abs(-dx * std::sin(angle) + dy * std::cos(angle)) < width_half)
          grid.is_free[static_cast<size_t>(y * width + x)] = value;
      }
  }
  return grid;
}

TEST(GridOutline, SeparatesFreeCellsFromOthers) {
  for (uint64_t seed = 0; seed < test::part_of(uint64_t{3000}); ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const CellGrid grid = random_grid(seed);
    const GridOutline outline = outline_of(grid, 0, 1'000'000);
    ASSERT_EQ(outline.areas_left_out, 0);
    for (int64_t y = 0; y < grid.height; ++y)
      for (int64_t x = 0; x < grid.width; ++x) {
        int around = 0;
        for (const Polygon& polygon : outline.polygons)
          around += is_inside(polygon, static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5);
        ASSERT_EQ(around, grid.contains_free(x, y) ? 1 : 0) << "cell " << x << ", " << y;
      }
    const std::vector<RingEdge> edges = edges_of(outline.polygons);
    for (size_t i = 0; i < edges.size(); ++i) {
      // At corners of the cells a vertex is at most half a cell off; between them an edge is
      // nearer.
      ASSERT_LE(distance_to_border(grid, edges[i].from), 0.5 + 1e-9) << edges[i].from.transpose();
      for (size_t k = i + 1; k < edges.size(); ++k)
        ASSERT_FALSE(!edges[i].adjoins(edges[k]) && edges[i].meets(edges[k]))
            << "edges at " << edges[i].from.transpose() << " and " << edges[k].from.transpose();
    }
  }
}

TEST(GridOutline, KeepsTheCornersOfAxisAlignedWalls) {
  const GridOutline outline = outline_of(grid_of(60, 30,
                                                 [](double x, double y) {
                                                   return x > 5 && x < 55 && y > 10 && y < 20 &&
                                                          !(x > 30 && x < 31 && y > 12 && y < 15);
                                                 }),
                                         0, 1000);
  ASSERT_EQ(outline.polygons.size(), 1u);
  using Point = Eigen::Vector2d;
  EXPECT_THAT(
      outline.polygons[0].outline,
      testing::UnorderedElementsAre(Point(5, 10), Point(55, 10), Point(55, 20), Point(5, 20)));
  ASSERT_EQ(outline.polygons[0].holes.size(), 1u);
  EXPECT_THAT(
      outline.polygons[0].holes[0],
      testing::UnorderedElementsAre(Point(30, 12), Point(31, 12), Point(31, 15), Point(30, 15)));
}

TEST(GridOutline, StraightensWallsAtAnyAngle) {
  constexpr double kLength = 200, kWidth = 30, kMiddle = 115;
  size_t most = 0;
  for (int degrees = 1; degrees < 180; degrees += 2) {
    const double angle = degrees * std::numbers::pi / 180;
    const Eigen::Vector2d along(std::cos(angle), std::sin(angle)), side(-along.y(), along.x());
    const GridOutline outline = outline_of(
        grid_of(230, 230,
                [&](double x, double y) {
                  const Eigen::Vector2d p(x - kMiddle, y - kMiddle);
                  return std::abs(p.dot(along)) < kLength / 2 && std::abs(p.dot(side)) < kWidth / 2;
                }),
        0, 1000);
    ASSERT_EQ(outline.polygons.size(), 1u);
    const Polygon& corridor = outline.polygons[0];
    most = std::max(most, corridor.outline.size());
    EXPECT_NEAR(area_of(corridor), kLength * kWidth, kLength * kWidth / 100) << degrees;
    double straight = 0;
    for (size_t i = 0; i < corridor.outline.size(); ++i) {
      const Eigen::Vector2d edge =
          corridor.outline[(i + 1) % corridor.outline.size()] - corridor.outline[i];
      const double off = std::abs(edge.dot(side)) / edge.norm();
      if (off < 0.1) straight += edge.norm();
    }
    EXPECT_GT(straight, 2 * kLength - 16) << degrees << " degrees";
  }
  EXPECT_LE(most, 12u);
}

TEST(GridOutline, LeavesOutSmallAreas) {
  const GridOutline outline = outline_of(
      grid_of(100, 100, [](double x, double y) { return x < 90 || (x > 95 && y < 3); }), 20, 1000);
  EXPECT_EQ(outline.polygons.size(), 1u);
  EXPECT_EQ(outline.areas_left_out, 1);
  EXPECT_EQ(outline.cells_left_out, 15);
}

TEST(GridOutline, StopsAtTooManyVertices) {
  EXPECT_TRUE(outline_of(random_grid(40), 0, 5).is_too_detailed);
}

// ---- occupancy grids

std::string map_yaml(const std::string& image, const std::string& more = "") {
  return "image: " + image +
         "\nresolution: 0.5\norigin: [-10.0, 20.0, 0.0]\nnegate: 0\noccupied_thresh: 0.65\n"
         "free_thresh: 0.196\n" +
         more;
}

struct Picture {
  uint32_t width = 12, height = 6;
  uint8_t at(uint32_t x, uint32_t row) const {  // a room of 10 by 4 cells with unknown surroundings
    if (x == 0 || x == width - 1 || row == 0 || row == height - 1) return row == 0 ? 205 : 0;
    return 254;
  }
};

std::string pgm(const Picture& picture, bool is_text, uint32_t max) {
  std::string out = std::string(is_text ? "P2" : "P5") + "\n# a comment\n" +
                    std::to_string(picture.width) + " " + std::to_string(picture.height) +
                    "\n# another\n" + std::to_string(max) + "\n";
  for (uint32_t row = 0; row < picture.height; ++row)
    for (uint32_t x = 0; x < picture.width; ++x) {
      const uint32_t value = picture.at(x, row) * max / 255;
      if (is_text) {
        out += std::to_string(value) + (x % 5 == 4 ? "\n" : " ");
        continue;
      }
      if (max > 255) out += static_cast<char>(value >> 8);
      out += static_cast<char>(value & 255);
    }
  return out;
}

/// A PNG of any colour type and depth. With opacity all pixels are opaque but those of the column.
std::string png(const Picture& picture, int type, int depth, int interlace, int clear_column = -1) {
  std::string out;
  png_structp writer = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(writer);
  png_set_write_fn(
      writer, &out,
      [](png_structp self, png_bytep bytes, size_t count) {
        static_cast<std::string*>(png_get_io_ptr(self))
            ->append(reinterpret_cast<const char*>(bytes), count);
      },
      nullptr);
  png_set_IHDR(writer, info, picture.width, picture.height, depth, type, interlace,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  std::array<png_color, 3> palette = {{{254, 254, 254}, {205, 205, 205}, {0, 0, 0}}};
  if (type == PNG_COLOR_TYPE_PALETTE) png_set_PLTE(writer, info, palette.data(), 3);
  png_write_info(writer, info);
  const uint32_t channels = png_get_channels(writer, info);
  std::vector<std::string> rows(picture.height);
  std::vector<png_bytep> pointers;
  for (uint32_t row = 0; row < picture.height; ++row) {
    for (uint32_t x = 0; x < picture.width; ++x)
      for (uint32_t channel = 0; channel < channels; ++channel) {
        const uint8_t grey = picture.at(x, row);
        const bool is_opacity = (type & PNG_COLOR_MASK_ALPHA) != 0 && channel + 1 == channels;
        uint32_t value = is_opacity ? (static_cast<int>(x) == clear_column ? 0u : 255u) : grey;
        if (type == PNG_COLOR_TYPE_PALETTE) value = grey == 254 ? 0 : grey == 205 ? 1 : 2;
        rows[row] += static_cast<char>(value);
        if (depth == 16) rows[row] += static_cast<char>(value);
      }
    pointers.push_back(reinterpret_cast<png_bytep>(rows[row].data()));
  }
  png_write_image(writer, pointers.data());
  png_write_end(writer, info);
  png_destroy_write_struct(&writer, &info);
  return out;
}

class OccupancyGrid : public PlanFile {
 protected:
  ImportedPlan map(const std::string& image, const std::string& yaml = map_yaml("m.img")) const {
    write("m.img", image);
    write("map.yaml", yaml);
    return read(read_occupancy_grid, "map.yaml");
  }
  std::string map_refusal(const std::string& image, const std::string& yaml) const {
    write("m.img", image);
    write("map.yaml", yaml);
    return refusal(read_occupancy_grid, "map.yaml");
  }
};

TEST_F(OccupancyGrid, ReadsEveryKindOfImageAlike) {
  const Picture picture;
  const ImportedPlan first = map(pgm(picture, false, 255));
  ASSERT_EQ(first.walkable.size(), 1u);
  EXPECT_EQ(first.kind, "ROS occupancy grid");
  EXPECT_EQ(first.unit_m, 1);
  using Point = Eigen::Vector2d;
  EXPECT_THAT(first.walkable[0].outline,
              testing::UnorderedElementsAre(Point(-9.5, 20.5), Point(-4.5, 20.5), Point(-4.5, 22.5),
                                            Point(-9.5, 22.5)));
  EXPECT_THAT(first.used, ElementsAre("12 by 6 cells of 0.5 m: 40 free, 20 occupied"));
  EXPECT_THAT(first.left_out, ElementsAre("unknown, not walkable: 12 cells (3.0 m²)"));
  std::vector<std::string> images = {pgm(picture, true, 255), pgm(picture, false, 65'535),
                                     pgm(picture, true, 65'535)};
  for (const int interlace : {PNG_INTERLACE_NONE, PNG_INTERLACE_ADAM7}) {
    for (const int type : {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_RGB, PNG_COLOR_TYPE_RGB_ALPHA,
                           PNG_COLOR_TYPE_GRAY_ALPHA})
      for (const int depth : {8, 16}) images.push_back(png(picture, type, depth, interlace));
    images.push_back(png(picture, PNG_COLOR_TYPE_PALETTE, 8, interlace));
  }
  for (size_t i = 0; i < images.size(); ++i) {
    SCOPED_TRACE(testing::Message() << "image " << i);
    const ImportedPlan plan = map(images[i]);
    EXPECT_EQ(plan.walkable, first.walkable);
    EXPECT_EQ(plan.left_out, first.left_out);
    EXPECT_EQ(plan.used[0], first.used[0]);
  }
}

TEST_F(OccupancyGrid, TakesTransparentPixelsAsUnknown) {
  const ImportedPlan plan = map(png({}, PNG_COLOR_TYPE_GRAY_ALPHA, 8, PNG_INTERLACE_NONE, 5));
  EXPECT_EQ(plan.walkable.size(), 2u);
  EXPECT_THAT(plan.left_out, ElementsAre("unknown, not walkable: 17 cells (4.2 m²)"));
}

TEST_F(OccupancyGrid, MakesStraightWallsOfARotatedCorridor) {
  const double angle = std::numbers::pi / 6;
  std::string image = "P5 200 200 255\n";
  for (int row = 0; row < 200; ++row)
    for (int x = 0; x < 200; ++x) {
      const double dx = x + 0.5 - 100, dy = 100 - (row + 0.5);
      const bool is_free = std::abs(dx * std::cos(angle) + dy * std::sin(angle)) < 80 &&
                           std::abs(-dx * std::sin(angle) + dy * std::cos(angle)) < 15;
      image += static_cast<char>(is_free ? 254 : 0);
    }
  const ImportedPlan plan = map(image);
  ASSERT_EQ(plan.walkable.size(), 1u);
  EXPECT_LE(plan.walkable[0].outline.size(), 8u);
  EXPECT_NEAR(area_of(plan.walkable[0]), 80 * 15, 6);
}

TEST_F(OccupancyGrid, IsTurnedByTheYawOfItsOrigin) {
  std::string yaml = map_yaml("m.img");
  yaml.replace(yaml.find("0.0]"), 3, "1.5707963267948966");
  const ImportedPlan plan = map(pgm({}, false, 255), yaml);
  // The room reaches from (0.5, 0.5) to (5.5, 2.5) in the map.
  Eigen::Vector2d low(1e9, 1e9), high(-1e9, -1e9);
  for (const Eigen::Vector2d& corner : plan.walkable.at(0).outline) {
    low = low.cwiseMin(corner);
    high = high.cwiseMax(corner);
  }
  EXPECT_LT((low - Eigen::Vector2d(-12.5, 20.5)).norm(), 1e-9) << low.transpose();
  EXPECT_LT((high - Eigen::Vector2d(-10.5, 25.5)).norm(), 1e-9) << high.transpose();
}

TEST_F(OccupancyGrid, FollowsModeThresholdsAndNegation) {
  const auto free_share = [&](int grey, const std::string& yaml) {
    std::string image = "P5 8 4 255\n" + std::string(32, static_cast<char>(grey));
    image.back() = '\0';  // one cell is black; its corner is straightened
    const std::string refused = map_refusal(image, yaml);
    return refused == "none" ? std::round(area_of(map(image, yaml).walkable) / 0.25) : 0.0;
  };
  const std::string trinary = map_yaml("m.img"), scale = map_yaml("m.img", "mode: scale\n"),
                    raw = map_yaml("m.img", "mode: raw\n");
  EXPECT_EQ(free_share(254, trinary), 31);
  EXPECT_EQ(free_share(206, trinary), 31);  // 1 - 206/255 is 0.192
  EXPECT_EQ(free_share(205, trinary), 0);   // 0.196 is not below free_thresh
  EXPECT_EQ(free_share(206, scale), 31);
  EXPECT_EQ(free_share(100, scale), 0);
  EXPECT_EQ(free_share(19, raw), 32);  // 19 %; 0 is free as well
  EXPECT_EQ(free_share(20, raw), 1);
  EXPECT_EQ(free_share(255, raw), 1);
  std::string negated = trinary;
  negated.replace(negated.find("negate: 0"), 9, "negate: 1");
  EXPECT_EQ(free_share(254, negated), 1);
  EXPECT_EQ(free_share(20, negated), 32);
}

TEST_F(OccupancyGrid, RejectsMapsThatItDoesNotUnderstand) {
  const std::string image = pgm({}, false, 255), yaml = map_yaml("m.img");
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string text = yaml;
    text.replace(text.find(from), from.size(), to);
    return map_refusal(image, text);
  };
  EXPECT_EQ(map_refusal(image, yaml + "mode: fuzzy\n"),
            "map.yaml:7: expected trinary, scale or raw as mode, found 'fuzzy'");
  EXPECT_THAT(changed("resolution: 0.5", "resolution: 0"),
              HasSubstr("map.yaml:2: expected the edge of a cell in metres, above 0"));
  EXPECT_THAT(changed("resolution: 0.5", "resolution: 5 cm"), HasSubstr("found '5 cm'"));
  EXPECT_THAT(changed("resolution: 0.5\n", ""), HasSubstr("expected the key 'resolution'"));
  EXPECT_THAT(changed("0.0]", "0.0, 1]"), HasSubstr("map.yaml:3: expected [x, y, yaw]"));
  EXPECT_THAT(changed("-10.0", ".inf"), HasSubstr("map.yaml:3: expected [x, y, yaw]"));
  EXPECT_THAT(changed("free_thresh: 0.196", "free_thresh: 0.7"),
              HasSubstr("map.yaml:6: expected at most occupied_thresh, 0.65, found 0.7"));
  EXPECT_THAT(changed("negate: 0", "negate: maybe"), HasSubstr("expected 0 or 1 as negate"));
  EXPECT_THAT(changed("m.img", "none.pgm"), HasSubstr("none.pgm: expected a PGM or PNG image"));
  EXPECT_THAT(changed("m.img", "map.yaml"), HasSubstr("convert it with"));
  EXPECT_THAT(map_refusal("P5 12 6 255\nabc", yaml),
              HasSubstr("expected 72 bytes of pixels, found 3"));
  EXPECT_THAT(map_refusal("P2 2 1 255\n 1 256", yaml), HasSubstr("at most 255"));
  EXPECT_THAT(map_refusal(pgm({}, false, 255), map_yaml("m.img", "mode: raw\n")), "none");
  EXPECT_THAT(map_refusal("P5 2 1 255\n" + std::string(2, '\0'), yaml),
              HasSubstr("expected free cells, found 2 occupied and 0 unknown ones"));
  EXPECT_THAT(map_refusal(image.substr(0, 30), yaml), HasSubstr("expected"));
  EXPECT_THAT(refusal(read_occupancy_grid, "m.img"),
              HasSubstr("m.img: expected the map.yaml of an occupancy grid"));
}

TEST_F(OccupancyGrid, RejectsHugeImagesByTheirHeader) {
  const std::string yaml = map_yaml("m.img");
  EXPECT_THAT(map_refusal("P5 100000 100000 255\n", yaml),
              HasSubstr("expected an image of 1 to 100 million pixels, found 100000 by 100000"));
  std::string image = png({}, PNG_COLOR_TYPE_GRAY, 8, PNG_INTERLACE_NONE);
  image.replace(16, 8, std::string("\0\1\0\0\0\1\0\0", 8));
  EXPECT_THAT(map_refusal(image, yaml), HasSubstr("expected"));
  EXPECT_THAT(map_refusal("P5 0 5 255\n", yaml), HasSubstr("1 to 100 million pixels"));
}

TEST_F(OccupancyGrid, IsRecognisedByItsContent) {
  EXPECT_TRUE(is_occupancy_grid(map_yaml("m.pgm")));
  EXPECT_TRUE(is_occupancy_grid("{resolution: 1, \"image\": a.png}"));
  EXPECT_TRUE(is_occupancy_grid("P5\n5 5\n255\n"));
  EXPECT_FALSE(is_occupancy_grid("image: a.png\n"));
  EXPECT_FALSE(is_occupancy_grid("POLYGON ((0 0, 1 0, 1 1))"));
}

TEST_F(OccupancyGrid, RejectsOrReadsMutatedFiles) {
  const std::string yaml = map_yaml("m.img");
  write("map.yaml", yaml);
  try_mutated(read_occupancy_grid, "map.yaml", "m.img", pgm({}, true, 255));
  try_mutated(read_occupancy_grid, "map.yaml", "m.img", pgm({}, false, 65'535));
  for (const int type : {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_RGB_ALPHA, PNG_COLOR_TYPE_PALETTE})
    try_mutated(read_occupancy_grid, "map.yaml", "m.img", png({}, type, 8, PNG_INTERLACE_ADAM7));
  write("m.img", pgm({}, false, 255));
  try_mutated(read_occupancy_grid, "map.yaml", "map.yaml", yaml);
}

// ---- JuPedSim

class Jupedsim : public PlanFile {
 protected:
  ImportedPlan geometry(const std::string& text) const {
    write("geometry.xml", text);
    return read(read_jupedsim_geometry, "geometry.xml");
  }
  std::string geometry_refusal(const std::string& text) const {
    write("geometry.xml", text);
    return refusal(read_jupedsim_geometry, "geometry.xml");
  }
};

std::string xml_line(const std::string& element, const std::vector<std::array<double, 2>>& points,
                     const std::string& attributes = "") {
  std::string out = "<" + element + " " + attributes + ">\n";
  for (const auto& [x, y] : points) out += fmt::format("<vertex px=\"{}\" py=\"{}\"/>\n", x, y);
  return out + "</" + element + ">\n";
}

/// Two subrooms of 10 m by 6 m next to each other, with a wall and a crossing of 2 m between them.
/// There is an exit on the right, and a table.
std::string two_subrooms(const std::string& unit = "m", const std::string& head = "") {
  const std::string wall = "caption=\"wall\"";
  return head + "<geometry version=\"0.8\" caption=\"own\" unit=\"" + unit +
         "\">\n<rooms>\n<room id=\"0\" caption=\"hall\">\n"
         "<subroom id=\"0\" class=\"subroom\">\n" +
         xml_line("polygon", {{10, 4}, {10, 6}, {0, 6}, {0, 0}, {10, 0}, {10, 2}}, wall) +
         "<obstacle id=\"0\" caption=\"table\">" +
         xml_line("polygon", {{2, 2}, {3, 2}, {3, 3}, {2, 3}, {2, 2}}) +
         "</obstacle></subroom>\n<subroom id=\"1\" class=\"stair\">\n" +
         xml_line("polygon", {{10, 2}, {10, 0}, {20, 0}, {20, 2}}, wall) +
         xml_line("polygon", {{10, 4}, {10, 6}, {20, 6}, {20, 4}}, wall) +
         "<up px=\"1\" py=\"2\"/></subroom>\n<crossings>\n" +
         xml_line("crossing", {{10, 4}, {10, 2}}, "id=\"0\" subroom1_id=\"0\" subroom2_id=\"1\"") +
         "</crossings></room></rooms>\n<transitions>\n" +
         xml_line("transition", {{20, 2}, {20, 4}},
                  "id=\"1\" caption=\"main exit\" room1_id=\"0\" subroom1_id=\"1\" room2_id=\"-1\" "
                  "subroom2_id=\"-1\"") +
         "</transitions>\n</geometry>\n";
}

TEST_F(Jupedsim, ReadsTheAreaOfADatabase) {
  for (const bool is_first : {false, true}) {
    std::string sql = jupedsim_2();
    if (is_first)
      sql =
          "CREATE TABLE metadata(key TEXT, value TEXT); INSERT INTO metadata VALUES('version', "
          "'1'), ('fps', '10'); CREATE TABLE geometry(wkt TEXT NOT NULL); INSERT INTO geometry "
          "VALUES('GEOMETRYCOLLECTION (POLYGON ((-2 -2, 8 -2, 8 8, -2 8)))');";
    make_sqlite(folder_ / "run.sqlite", sql);
    const ImportedPlan plan = read(read_jupedsim_database, "run.sqlite");
    EXPECT_EQ(plan.kind, "JuPedSim database");
    EXPECT_EQ(area_of(plan.walkable), 100);
    EXPECT_EQ(plan.unit_m, 1);
    EXPECT_THAT(plan.left_out, ElementsAre("trajectories"));
  }
}

TEST_F(Jupedsim, RejectsADatabaseWithoutAnArea) {
  make_sqlite(folder_ / "run.sqlite", "CREATE TABLE t(x); CREATE TABLE metadata(key, value);");
  EXPECT_THAT(refusal(read_jupedsim_database, "run.sqlite"),
              HasSubstr("expected the tables geometry and metadata"));
  make_sqlite(folder_ / "run.sqlite",
              "CREATE TABLE geometry(wkt); CREATE TABLE metadata(key, value);");
  EXPECT_THAT(refusal(read_jupedsim_database, "run.sqlite"), HasSubstr("without an area"));
  write("run.sqlite", std::string("SQLite format 3\0", 16) + std::string(200, 'x'));
  EXPECT_THAT(refusal(read_jupedsim_database, "run.sqlite"), HasSubstr("expected"));
}

TEST_F(Jupedsim, ClosesWallsByDoors) {
  const ImportedPlan plan = geometry(two_subrooms());
  EXPECT_EQ(plan.kind, "JuPedSim geometry");
  ASSERT_EQ(plan.walkable.size(), 2u);
  EXPECT_EQ(area_of(plan.walkable[0]), 60);
  EXPECT_EQ(area_of(plan.walkable[1]), 60);
  ASSERT_EQ(plan.obstacles.size(), 1u);
  EXPECT_EQ(plan.obstacles[0].name, "table");
  EXPECT_EQ(area_of(plan.obstacles[0].polygon), 1);
}

TEST_F(Jupedsim, KeepsWallsBetweenRoomsThatAreJoined) {
  const ImportedPlan plan = geometry(two_subrooms());
  double length = 0;
  for (const PlanWall& wall : plan.walls) {
    ASSERT_EQ(wall.line_m.size(), 2u);
    EXPECT_EQ(wall.line_m[0].x(), 10);
    EXPECT_EQ(wall.line_m[1].x(), 10);
    length += (wall.line_m[1] - wall.line_m[0]).norm();
  }
  EXPECT_EQ(plan.walls.size(), 2u);  // each is stated by both rooms
  EXPECT_EQ(length, 4);
}

TEST_F(Jupedsim, MakesGoalsOfExits) {
  const ImportedPlan plan = geometry(two_subrooms());
  ASSERT_EQ(plan.goals.size(), 1u);
  EXPECT_EQ(plan.goals[0].name, "main exit");
  EXPECT_NEAR(area_of(plan.goals[0].polygon), 2 * 0.5, 1e-12);
  for (const Eigen::Vector2d& corner : plan.goals[0].polygon.outline) EXPECT_LE(corner.x(), 20);
  EXPECT_THAT(plan.left_out, Contains("slope of 1 stair, which are level ground"));
}

TEST_F(Jupedsim, TakesTheUnitOfTheFile) {
  const ImportedPlan plan = geometry(two_subrooms("cm"));
  EXPECT_EQ(plan.unit_m, 0.01);
  EXPECT_THAT(geometry_refusal(two_subrooms("parsec")),
              HasSubstr("geometry.xml:1: expected a unit of length"));
}

TEST_F(Jupedsim, SaysWhichRoomsDoNotClose) {
  std::string text = two_subrooms();
  const size_t begin = text.find("<transition "), end = text.find("</transitions>");
  text.erase(begin, end - begin);
  const ImportedPlan gap = geometry(text);
  EXPECT_EQ(area_of(gap.walkable), 120);
  EXPECT_THAT(gap.left_out,
              Contains("a gap of 2 m in 'hall, subroom 1', which has no door, is closed"));
  const size_t crossing = text.find("<crossing "), behind = text.find("</crossings>");
  text.erase(crossing, behind - crossing);
  const ImportedPlan open = geometry(text);
  EXPECT_EQ(open.walkable.size(), 1u);
  EXPECT_THAT(open.left_out, Contains(HasSubstr("its walls do not close")));
  EXPECT_EQ(open.walls.size(), 2u);
}

TEST_F(Jupedsim, RejectsDocumentTypesAndOtherXml) {
  EXPECT_THAT(geometry_refusal(two_subrooms("m", "<!DOCTYPE a [<!ENTITY b \"c\">]>\n")),
              HasSubstr("geometry.xml:1: expected XML without a document type"));
  EXPECT_THAT(geometry_refusal("<geometry><rooms>"),
              HasSubstr("geometry.xml:1: expected </rooms>"));
  EXPECT_THAT(
      geometry_refusal(two_subrooms().replace(two_subrooms().find("px=\"10\""), 7, "px=\"x\"")),
      HasSubstr("expected a number as px, found 'x'"));
  std::string deep = "<geometry>";
  for (int i = 0; i < 100; ++i) deep += "<a>";
  EXPECT_THAT(geometry_refusal(deep), HasSubstr("expected tags nested at most 32 deep"));
}

TEST_F(Jupedsim, IsRecognisedByItsContent) {
  EXPECT_TRUE(is_jupedsim_geometry(two_subrooms("m", "<?xml version=\"1.0\"?>\n<!-- a > b -->\n")));
  EXPECT_FALSE(is_jupedsim_geometry("<svg><geometry/></svg>"));
  EXPECT_TRUE(is_jupedsim_database(std::string("SQLite format 3\0", 16)));
}

TEST_F(Jupedsim, RejectsOrReadsMutatedFiles) {
  try_mutated(read_jupedsim_geometry, "geometry.xml", "geometry.xml", two_subrooms());
  make_sqlite(folder_ / "run.sqlite", jupedsim_2());
  const RegularFile file(folder_ / "run.sqlite", "a database", 1 << 20);
  const std::vector<uint8_t> bytes = file.bytes();
  try_mutated(read_jupedsim_database, "run.sqlite", "run.sqlite", {bytes.begin(), bytes.end()});
}

// ---- Vadere

class Vadere : public PlanFile {
 protected:
  ImportedPlan scenario(const std::string& text) const {
    write("a.scenario", text);
    return read(read_vadere_scenario, "a.scenario");
  }
  std::string scenario_refusal(const std::string& text) const {
    write("a.scenario", text);
    return refusal(read_vadere_scenario, "a.scenario");
  }
};

const std::string kTopography = R"({
  "attributes": {"bounds": {"x": 1.0, "y": 2.0, "width": 20.0, "height": 10.0},
    "boundingBoxWidth": 0.5, "bounded": true},
  "obstacles": [
    {"id": 3, "shape": {"type": "POLYGON", "points": [{"x": 5, "y": 5}, {"x": 6, "y": 5},
      {"x": 6, "y": 7}]}},
    {"id": -1, "shape": {"x": 8.0, "y": 4.0, "width": 1.0, "height": 2.0, "type": "RECTANGLE"}}],
  "measurementAreas": [{"id": 1}, {"id": 2}],
  "stairs": [], "targetChangers": [],
  "targets": [{"id": 2, "shape": {"type": "CIRCLE", "radius": 1.0, "center": {"x": 18, "y": 7}}}],
  "sources": [{"id": 1, "shape": {"x": 2, "y": 4, "width": 1, "height": 2, "type": "RECTANGLE"},
    "spawnNumber": 10}],
  "dynamicElements": [{"attributes": {"id": 7}}],
  "attributesPedestrian": {"radius": 0.2},
  "teleporter": null})";

TEST_F(Vadere, ReadsTheTopographyOfEveryVersion) {
  for (const std::string& text :
       {"{\"name\": \"a\", \"release\": \"2.1\", \"scenario\": {\"topography\": " + kTopography +
            "}}",
        "{\"vadere\": {\"topography\": " + kTopography + "}}",
        "{\"topography\": " + kTopography + "}"}) {
    const ImportedPlan plan = scenario(text);
    EXPECT_TRUE(is_vadere_scenario(text));
    EXPECT_EQ(plan.kind, "Vadere scenario");
    EXPECT_EQ(plan.unit_m, 1);
    ASSERT_EQ(plan.obstacles.size(), 2u);
    EXPECT_EQ(plan.obstacles[0].name, "obstacle 3");
    EXPECT_EQ(plan.obstacles[1].name, "obstacle number 2");
    EXPECT_EQ(area_of(plan.obstacles[0].polygon), 1);
    EXPECT_EQ(area_of(plan.obstacles[1].polygon), 2);
    ASSERT_EQ(plan.starts.size(), 1u);
    EXPECT_EQ(plan.starts[0].name, "source 1");
    ASSERT_EQ(plan.goals.size(), 1u);
    EXPECT_NEAR(area_of(plan.goals[0].polygon), std::numbers::pi, 0.004);
    EXPECT_THAT(plan.left_out,
                ElementsAre("agents that are placed singly: 1", "measurement areas: 2"));
  }
}

TEST_F(Vadere, SendsEachSourceToItsTargetsInOrder) {
  std::string text = "{\"topography\": " + kTopography + "}";
  const std::string target = R"({"id": 2, "shape": {"type": "CIRCLE")";
  const std::string more =
      R"({"id": 9, "absorbing": false, "shape": {"x": 2, "y": 9, "width": 1, "height": 1, "type": "RECTANGLE"}}, )";
  text.replace(text.find(target), 0, more);
  text.replace(text.find("\"spawnNumber\""), 0, "\"targetIds\": [9, 2], ");
  const ImportedPlan plan = scenario(text);
  EXPECT_THAT(plan.starts[0].goals, ElementsAre("target 9", "target 2"));
  const std::string scene = scene_text_of(plan, "a.scenario");
  EXPECT_THAT(scene,
              HasSubstr("goals:\n      - {min_m: [2, 9], max_m: [3, 10]}\n      - {polygon:"));
  EXPECT_THAT(scene, Not(HasSubstr("any_of")));
}

TEST_F(Vadere, LeavesTheWallAroundTheGroundOut) {
  const std::string whole = "{\"topography\": " + kTopography + "}";
  const ImportedPlan plan = scenario(whole);
  ASSERT_EQ(plan.walkable.size(), 1u);
  using Point = Eigen::Vector2d;
  EXPECT_THAT(plan.walkable[0].outline,
              ElementsAre(Point(1.5, 2.5), Point(20.5, 2.5), Point(20.5, 11.5), Point(1.5, 11.5)));
  std::string open = whole;
  open.replace(open.find("true"), 4, "false");
  EXPECT_EQ(area_of(scenario(open).walkable), 200);
}

TEST_F(Vadere, RejectsShapesThatItDoesNotUnderstand) {
  const std::string whole = "{\"topography\": " + kTopography + "}";
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string text = whole;
    text.replace(text.find(from), from.size(), to);
    return scenario_refusal(text);
  };
  EXPECT_EQ(changed("POLYGON", "BLOB"),
            "a.scenario: expected POLYGON, RECTANGLE or CIRCLE as 'type' of the shape in obstacles "
            "1 of the topography, found '\"BLOB\"'");
  EXPECT_THAT(changed("{\"x\": 5, \"y\": 5}, ", ""), HasSubstr("expected three points or more"));
  EXPECT_THAT(changed("\"width\": 20.0", "\"width\": 1.0"), HasSubstr("expected bounds wider"));
  EXPECT_THAT(changed("\"x\": 5", "\"x\": \"5\""), HasSubstr("expected a number as 'x'"));
  EXPECT_THAT(changed("\"x\": 5", "\"x\": 1e300"), HasSubstr("expected a number as 'x'"));
  EXPECT_THAT(changed("\"x\": 5,", "\"x\": 5"), HasSubstr("a.scenario:5: expected JSON"));
  EXPECT_THAT(scenario_refusal("{\"topography\": 5}"), HasSubstr("expected an object"));
  EXPECT_THAT(scenario_refusal("[]"), HasSubstr("expected the key topography"));
}

/// A scenario with a source, two targets and pedestrians that have these keys too.
std::string people(const std::string& source, const std::string& target = "",
                   const std::string& pedestrian = "", const std::string& simulation = "") {
  const auto element = [](int id, double x, const std::string& keys) {
    return fmt::format(
        R"({{"id": {}, "shape": {{"x": {}, "y": 4, "width": 4, "height": 5, "type": )"
        R"("RECTANGLE"}}{}}})",
        id, x, keys.empty() ? "" : ", " + keys);
  };
  return R"({"scenario": {"attributesSimulation": {)" + simulation +
         R"(}, "topography": {"attributes": {"bounds": {"x": 0, "y": 0, "width": 40, "height": 20}},
"obstacles": [], "targets": [)" +
         element(1, 15, target) + ", " + element(2, 30, "") + R"(], "sources": [)" +
         element(7, 3, R"("targetIds": [1, 2])" + (source.empty() ? "" : ", " + source)) +
         R"(], "attributesPedestrian": {)" + pedestrian + "}}}}";
}

TEST_F(Vadere, ReadsNumbersAndTimesOfSourcesOfEveryVersion) {
  const auto group = [&](const std::string& source, const std::string& simulation = "") {
    const Scene scene = load(scene_text_of(scenario(people(source, "", "", simulation)), "a"));
    return scene.groups.at(0);
  };
  const std::string new_keys = R"("spawner": {"type": "org.a.AttributesRegularSpawner", )";
  for (const std::string& source :
       {std::string(R"("spawnNumber": 18)"),
        std::string(R"("spawnNumber": 18, "startTime": 0.0, "endTime": 0.0, "spawnDelay": -1.0)"),
        new_keys + R"("eventElementCount": 18, "eventElement": null})"}) {
    EXPECT_EQ(group(source).count, 18) << source;
    EXPECT_TRUE(group(source).sources.empty());
    EXPECT_EQ(group(source).spawn.bounds(), (Rectangle{{3, 4}, {7, 9}}));
  }
  // More than one per square metre enter as space permits.
  ASSERT_EQ(group(R"("spawnNumber": 300)").sources.size(), 1u);
  EXPECT_EQ(group(R"("spawnNumber": 300)").count, 0);
  EXPECT_EQ(group(R"("spawnNumber": 300)").sources[0].count, 300);
  EXPECT_EQ(group(R"("spawnNumber": 3, "startTime": 5, "endTime": 5)").sources.at(0).start_s, 5);

  // One every 2 s from 10 s to 50 s.
  const std::string times = R"("startTime": 10, "endTime": 50, )";
  const std::string new_times = R"("constraintsTimeStart": 10, "constraintsTimeEnd": 50, )";
  for (const std::string& source :
       {times +
            R"("spawnNumber": 1, "distributionParameters": [2.0], "interSpawnTimeDistribution": )"
            R"("org.vadere.state.scenario.ConstantDistribution")",
        times + R"("spawnDelay": 2.0)",
        times + R"("interSpawnTimeDistribution": "constant", "spawnNumber": 1, )"
                R"("distributionParameters": {"updateFrequency": 2.0}, "maxSpawnNumberTotal": -1)",
        new_keys + new_times +
            R"("constraintsElementsMax": -1, "eventElementCount": 1, "distribution": {"type": )"
            R"("org.a.AttributesConstantDistribution", "updateFrequency": 2.0}})"}) {
    SCOPED_TRACE(source);
    const Group entering = group(source);
    EXPECT_EQ(entering.count, 0);
    ASSERT_EQ(entering.sources.size(), 1u);
    EXPECT_EQ(entering.sources[0].count, 21);
    EXPECT_EQ(entering.sources[0].rate_per_s, 0.5);
    EXPECT_EQ(entering.sources[0].start_s, 10);
    EXPECT_FALSE(entering.sources[0].is_poisson);
    EXPECT_EQ(entering.sources[0].area.bounds(), (Rectangle{{3, 4}, {7, 9}}));
    EXPECT_EQ(group(source, R"("finishTime": 20)").sources.at(0).count, 6) << "until the end";
  }
  EXPECT_EQ(group(times + R"("spawnNumber": 4, "maxSpawnNumberTotal": 30)").sources.at(0).count,
            30);
  EXPECT_EQ(group(times + R"("spawnNumber": 4)").sources.at(0).rate_per_s, 4);
  EXPECT_EQ(group(R"("spawnNumber": 0)").count, 0);
  EXPECT_EQ(group("").count, 5) << "by area";
  const Source poisson =
      group(new_keys + new_times +
            R"("distribution": {"type": "a.AttributesPoissonDistribution", "numberPedsPerSecond": )"
            R"(0.5}})")
          .sources.at(0);
  EXPECT_TRUE(poisson.is_poisson);
  EXPECT_EQ(poisson.rate_per_s, 0.5);
  EXPECT_EQ(poisson.count, 21);
  EXPECT_EQ(group(times + R"("interSpawnTimeDistribution": "negativeExponential", )"
                          R"("distributionParameters": {"mean": 4}, "spawnNumber": 1)")
                .sources.at(0)
                .rate_per_s,
            0.25);
}

TEST_F(Vadere, RunsForTheTimeOfTheScenario) {
  const auto duration_s = [&](const std::string& simulation) {
    return load(scene_text_of(scenario(people("", "", "", simulation)), "a")).duration_s;
  };
  EXPECT_EQ(duration_s(""), 60);
  EXPECT_EQ(duration_s(R"("finishTime": 312.5)"), 312.5);
  EXPECT_EQ(duration_s(R"("finishTime": 1.7976931348623157E308)"), 60);
  EXPECT_EQ(duration_s(R"("finishTime": 0)"), 60);
}

TEST_F(Vadere, NamesNumbersAndTimesThatASceneCannotExpress) {
  const auto left_out = [&](const std::string& source) {
    return scenario(people(R"("startTime": 0, "endTime": 50, )" + source)).left_out;
  };
  EXPECT_THAT(left_out(R"("spawnNumber": 1)"), testing::IsEmpty());
  EXPECT_THAT(left_out(R"("spawnNumber": 3)"),
              ElementsAre("events of 1 source with several agents: they enter one by one"));
  EXPECT_THAT(left_out(R"("interSpawnTimeDistribution": "poisson", "distributionParameters": )"
                       R"({"numberPedsPerSecond": 2})"),
              ElementsAre("random numbers of 1 source: the mean is used"));
  EXPECT_THAT(left_out(R"("interSpawnTimeDistribution": "timeSeries", "spawnNumber": 1)"),
              ElementsAre("numbers and times of 1 source, kind 'timeseries'"));
  EXPECT_THAT(left_out(R"("distributionParameters": {"updateFrequency": 0}, )"
                       R"("interSpawnTimeDistribution": "constant")"),
              ElementsAre("numbers and times of 1 source, kind 'constant'"));
  EXPECT_THAT(left_out(R"("spawnNumber": 900000000)"),
              ElementsAre("numbers and times of 1 source, too many or too late"));
  EXPECT_THAT(
      left_out(R"("spawner": {"type": "a.AttributesLerpSpawner", "constraintsTimeEnd": 9})"),
      ElementsAre("numbers and times of 1 source, kind 'lerp'"));
  EXPECT_THAT(scenario_refusal(people(R"("spawnNumber": "3")")),
              HasSubstr("a number as 'spawnNumber' in sources 1 of the topography"));
  EXPECT_THAT(scenario_refusal(people(R"("spawnNumber": 1.5)")), HasSubstr("a whole number"));
  EXPECT_THAT(scenario_refusal(people(R"("spawner": 3)")), HasSubstr("an object as 'spawner'"));
}

TEST_F(Vadere, ReadsDesiredSpeeds) {
  const auto plan = [&](const std::string& pedestrian, const std::string& source = "") {
    return scenario(people(source, "", pedestrian));
  };
  const auto speed = [&](const ImportedPlan& each) {
    return load(scene_text_of(each, "a")).groups.at(0).speed_mps;
  };
  const std::string slow = R"("speedDistributionMean": 0.6, "speedDistributionStandardDeviation": )"
                           R"(0.05, "minimumSpeed": 0.55, "maximumSpeed": 0.65)";
  EXPECT_EQ(speed(plan(slow)), (Distribution{0.6, 0.05, 0.55, 0.65}));
  EXPECT_EQ(speed(plan(R"("radius": 0.2)")), std::nullopt);
  EXPECT_EQ(speed(plan(R"("speedDistributionMean": 1)")), (Distribution{1, 0.26, 0.5, 2.2}));
  EXPECT_EQ(speed(plan(R"("speedDistributionStandardDeviation": 0)")),
            (Distribution{1.34, 0, 1.34, 1.34}));
  const std::string own = R"("speedDistributionMean": 0.62)";
  EXPECT_EQ(speed(plan(slow, R"("attributesPedestrian": {)" + own + "}")),
            (Distribution{0.62, 0.05, 0.55, 0.65}));
  EXPECT_EQ(speed(plan(slow, R"("spawner": {"eventElement": {)" + own + "}}")),
            (Distribution{0.62, 0.05, 0.55, 0.65}));
  const ImportedPlan fast = plan(R"("minimumSpeed": 0, "maximumSpeed": 5)");
  EXPECT_EQ(speed(fast), (Distribution{1.34, 0.26, 0.1, 4}));
  EXPECT_THAT(fast.left_out, ElementsAre("desired speeds outside 0.1 to 4 m/s"));
  const ImportedPlan cars = plan(R"("speedDistributionMean": 13)");
  EXPECT_EQ(speed(cars), std::nullopt);
  EXPECT_THAT(cars.left_out,
              ElementsAre("desired speeds of mean 13 and standard deviation 0.26 m/s "
                          "between 0.5 and 2.2 m/s"));
}

TEST_F(Vadere, ReadsWaitingTimesOfEveryVersion) {
  const std::string passed = R"("absorbing": false, )";
  const auto wait_s = [&](const std::string& target) {
    const Scene scene = load(scene_text_of(scenario(people("", passed + target)), "a"));
    EXPECT_EQ(scene.groups.at(0).goals.size(), 2u);
    EXPECT_EQ(scene.groups[0].goals.back().wait_s, Distribution{});
    return scene.groups[0].goals[0].wait_s;
  };
  const Distribution ten{10, 0, 10, 10}, around_ten{10, 2, 0, 1e7};
  EXPECT_EQ(wait_s(R"("waitingTime": 10.0, "individualWaiting": true)"), ten);
  EXPECT_EQ(wait_s(R"("waitingTimeDistribution": "constant", "distributionParameters": )"
                   R"({"updateFrequency": 10}, "waitingBehaviour": "INDIVIDUAL")"),
            ten);
  EXPECT_EQ(wait_s(R"("waiter": {"enabled": true, "individualWaiting": true, "distribution": )"
                   R"({"type": "a.AttributesConstantDistribution", "updateFrequency": 10.0}})"),
            ten);
  EXPECT_EQ(wait_s(R"("waiter": {"enabled": true, "distribution": "normal", )"
                   R"("distributionParameters": {"mean": 10, "sd": 2}})"),
            around_ten);
  EXPECT_EQ(wait_s(R"("waiter": {"enabled": true, "distribution": {"type": )"
                   R"("a.AttributesNormalDistribution", "mean": 10, "sd": 2}})"),
            around_ten);
  for (const char* none :
       {R"("waitingTime": 0.0)", R"("waiter": {"enabled": false, "distribution": null})",
        R"("waitingTimeDistribution": "null", "distributionParameters": "null", )"
        R"("waitingBehaviour": "NO_WAITING")"})
    EXPECT_EQ(wait_s(none), Distribution{}) << none;
}

TEST_F(Vadere, NamesWaitingTimesThatASceneCannotExpress) {
  const auto left_out = [&](const std::string& target) {
    return scenario(people("", target)).left_out;
  };
  EXPECT_THAT(left_out(R"("waitingTime": 10, "individualWaiting": false)"),
              ElementsAre("waiting times of 1 target, kind 'traffic light'"));
  EXPECT_THAT(left_out(R"("waitingTime": 10, "parallelWaiters": 2)"),
              ElementsAre("limits of the number of agents that wait at a target"));
  EXPECT_THAT(left_out(R"("waiter": {"enabled": true, "distribution": {"type": )"
                       R"("a.AttributesPoissonDistribution", "numberPedsPerSecond": 1}})"),
              ElementsAre("waiting times of 1 target, kind 'poisson'"));
  EXPECT_THAT(left_out(R"("waitingTime": 1e8)"),
              ElementsAre("waiting times of 1 target, kind 'too long'"));
  std::string chosen = people("", R"("waitingTime": 10)");
  chosen.replace(chosen.find("[1, 2]"), 6, "[]");
  EXPECT_THAT(scenario(chosen).left_out,
              ElementsAre("waiting times that differ between alternative targets"));
}

TEST_F(Vadere, EndsRoutesAtTargetsThatAbsorb) {
  const auto group = [&](const std::string& target) {
    return load(scene_text_of(scenario(people("", target)), "a")).groups.at(0);
  };
  for (const std::string absorbing :
       {"", R"("absorbing": true)", R"("absorber": {"enabled": true, "deletionDistance": 0.1})"})
    EXPECT_EQ(group(absorbing).goals.size(), 1u) << absorbing;
  for (const std::string passed : {R"("absorbing": false)", R"("absorber": {"enabled": false})"}) {
    EXPECT_EQ(group(passed).goals.size(), 2u) << passed;
    EXPECT_EQ(group(passed).on_arrival, OnArrival::kLeave);
    std::string text = people("", passed);
    text.replace(text.find("[1, 2]"), 6, "[1]");
    EXPECT_EQ(load(scene_text_of(scenario(text), "a")).groups.at(0).on_arrival, OnArrival::kStay);
  }
}

TEST_F(Vadere, RejectsOrReadsMutatedFiles) {
  try_mutated(read_vadere_scenario, "a.scenario", "a.scenario",
              "{\"scenario\": {\"topography\": " + kTopography + "}}");
  try_mutated(read_vadere_scenario, "a.scenario", "a.scenario",
              people(R"("spawnNumber": 3, "startTime": 1, "endTime": 9, "distributionParameters": )"
                     R"({"updateFrequency": 2.0}, "interSpawnTimeDistribution": "constant")",
                     R"("waiter": {"enabled": true, "distribution": {"type": )"
                     R"("a.AttributesNormalDistribution", "mean": 10, "sd": 2}})",
                     R"("speedDistributionMean": 1.2, "maximumSpeed": 2)"));
}

}  // namespace
}  // namespace throng::import_readers_test
