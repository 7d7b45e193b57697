// draw_plan() draws a scene from above before it runs, as an SVG.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <optional>
#include <string_view>
#include <vector>

#include "analysis/trajectories/walkable_area.h"
#include "apps/commands/info.h"
#include "base/errors.h"
#include "base/text.h"
#include "crowd/navigation/footprints.h"
#include "geometry/polygon_grid.h"
#include "geometry/polygon_union.h"

namespace throng {
namespace {

using Point = Eigen::Vector2d;
using Ring = Polygon::Ring;

constexpr double kWidth_px = 1200;
constexpr double kTop_px = 92;
constexpr double kLeft_px = 76;
constexpr double kRight_px = 24;
constexpr double kLegend_px = 300;
constexpr double kText_px = 12;
/// Space around the ground: walls and labels at its edge stay visible.
constexpr double kPadding_px = 16;
constexpr double kMaxPlot_px = 860;
constexpr double kMinPlot_px = 90;
/// Obstacles with names next to them; with more, only names that fit inside are written.
constexpr size_t kMaxNamesBeside = 25;
/// Limit of tooltips, which keeps scenes of 60 000 obstacles below 10 MB.
constexpr size_t kMaxObstacleBytes = 7'000'000;
constexpr size_t kMaxListedGroups = 40;
constexpr size_t kMaxRoutes = 200;
constexpr size_t kMaxTracks = 80;
constexpr size_t kMaxTrackCorners = 60;
constexpr size_t kMaxQueueMarks = 200;

/// Colours that colour-blind readers can distinguish (Okabe and Ito 2008), the palest last.
constexpr std::array kColours = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                 "#e69f00", "#56b4e9", "#b8a800"};
constexpr std::array kDashes = {"none", "9 3", "3 3", "12 3 3 3", "16 5", "6 6", "12 3 3 3 3 3"};
/// Hatches of groups, which distinguish them in grey: angle, and content of a tile of 9 px.
struct Hatch {
  int angle_deg;
  const char* tile;
};
constexpr std::array<Hatch, 7> kHatches = {{{45, "M0 0V9"},
                                            {-45, "M0 0V9"},
                                            {0, "M0 0V9"},
                                            {90, "M0 0V9"},
                                            {0, "M3 4.5H6"},
                                            {45, "M0 0V9M0 0H9"},
                                            {0, "M0 0V9M0 0H9"}}};
static_assert(kColours.size() == kDashes.size() && kColours.size() == kHatches.size());

/// With as many colours as hatches, groups from the eighth on combine them in another way.
size_t hatch_of(size_t group) { return (group + group / kColours.size()) % kHatches.size(); }
const char* colour_of(size_t group) { return kColours[group % kColours.size()]; }
const char* dash_of(size_t group) { return kDashes[hatch_of(group)]; }

/// "A" to "Z", "AA", ...
std::string letter_of(size_t group) {
  std::string letters;
  for (size_t rest = group + 1; rest > 0; rest = (rest - 1) / 26)
    letters.insert(letters.begin(), static_cast<char>('A' + (rest - 1) % 26));
  return letters;
}

/// Outline of an obstacle from above; without the edges between its pieces if they can be joined.
std::vector<Polygon> outline_of(const StatedObstacle& obstacle) {
  std::vector<Polygon> pieces;
  double reach_m = 0;
  for (const Obstacle* each : obstacle.pieces)
    for (std::vector<Point>& piece : footprint_pieces_of(*each)) {
      for (const Point& corner : piece) reach_m = std::max(reach_m, corner.cwiseAbs().maxCoeff());
      pieces.push_back({std::move(piece), {}});
    }
  if (pieces.size() < 2 || reach_m > kMaxOnGrid_m) return pieces;
  try {
    std::vector<Polygon> joined = join(pieces, obstacle.name).polygons;
    return joined.empty() ? pieces : joined;
  } catch (const InputError&) {
    return pieces;  // too many crossings; the edges between the pieces stay
  }
}

const Polygon& largest_of(const std::vector<Polygon>& polygons) {
  return *std::max_element(
      polygons.begin(), polygons.end(),
      [](const Polygon& a, const Polygon& b) { return area_m2(a) < area_m2(b); });
}

/// The largest 1, 2 or 5 times a power of ten up to `limit`.
double round_length(double limit) {
  const double power = std::pow(10, std::floor(std::log10(limit)));
  for (const double factor : {5.0, 2.0})
    if (factor * power <= limit) return factor * power;
  return power;
}

std::string metres_text(double length_m) {
  if (length_m >= 1000) return fmt::format("{:g} km", length_m / 1000);
  if (length_m >= 1) return fmt::format("{:g} m", length_m);
  return length_m >= 0.01 ? fmt::format("{:g} cm", 100 * length_m)
                          : fmt::format("{:g} mm", 1000 * length_m);
}

/// Pixels with one digit, as short as possible.
std::string px(double value) {
  std::string text = fmt::format("{:.1f}", value);
  if (text.ends_with(".0")) text.resize(text.size() - 2);
  return text == "-0" ? "0" : text;
}

std::string tooltip(const std::string& text) { return "<title>" + xml_text(text) + "</title>"; }

/// Upper bound of a text's width in a sans-serif font; wide scripts count two letters.
double width_px(const std::string& text, double size_px = kText_px) {
  constexpr std::string_view kNarrow = " .,:;ijlt|'()";
  double letters = 0;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if ((byte & 0xC0) != 0x80)
      letters += byte >= 0xE0 ? 2 : kNarrow.find(c) != std::string_view::npos ? 0.6 : 1;
  }
  return 0.63 * size_px * letters;
}

/// The beginning of a text that fits, ended by an ellipsis if something is missing.
std::string cut(std::string text, double max_px, double size_px = kText_px) {
  if (width_px(text, size_px) <= max_px) return text;
  while (!text.empty() && width_px(text, size_px) > max_px - size_px) {
    while ((static_cast<unsigned char>(text.back()) & 0xC0) == 0x80) text.pop_back();
    text.pop_back();
  }
  return text + "\u2026";
}

/// Rectangle of the page, y downwards.
struct Box {
  double left = 0, top = 0, right = 0, bottom = 0;

  static Box around(const Point& middle, double width, double height) {
    return {middle.x() - width / 2, middle.y() - height / 2, middle.x() + width / 2,
            middle.y() + height / 2};
  }
  double width() const { return right - left; }
  double height() const { return bottom - top; }
  Point middle() const { return {(left + right) / 2, (top + bottom) / 2}; }
  bool overlaps(const Box& other) const {
    return left < other.right && other.left < right && top < other.bottom && other.top < bottom;
  }
  bool contains(const Box& other) const {
    return left <= other.left && top <= other.top && right >= other.right && bottom >= other.bottom;
  }
};

/// View maps the ground to the page; x to the right, y upwards.
class View {
 public:
  explicit View(const Rectangle& ground) {
    const Point size = ground.size_m();
    const auto scale_for = [&](double width, double height) {
      return std::min((width - 2 * kPadding_px) / size.x(), (height - 2 * kPadding_px) / size.y());
    };
    const double whole = kWidth_px - kLeft_px - kRight_px;
    const double at_side = scale_for(whole - kLegend_px, kMaxPlot_px);
    const double above = scale_for(whole, 0.8 * kMaxPlot_px);
    legend_beside = at_side >= above;
    scale = legend_beside ? at_side : above;
    frame = {kLeft_px, kTop_px, kLeft_px + (legend_beside ? whole - kLegend_px : whole),
             kTop_px + std::max(kMinPlot_px, scale * size.y() + 2 * kPadding_px)};
    if (legend_beside)
      frame.right = frame.left + std::max(scale * size.x() + 2 * kPadding_px, 320.0);
    middle_m_ = ground.middle_m();
  }

  Point operator()(const Point& m) const {
    return frame.middle() + scale * Point(m.x() - middle_m_.x(), middle_m_.y() - m.y());
  }
  Box operator()(const Rectangle& m) const {
    const Point low = (*this)(m.min_m), high = (*this)(m.max_m);
    return {low.x(), high.y(), high.x(), low.y()};
  }
  Point metres(const Point& px) const {
    const Point offset = (px - frame.middle()) / scale;
    return {middle_m_.x() + offset.x(), middle_m_.y() - offset.y()};
  }
  /// Metres at the edges of the frame.
  Rectangle shown_m() const {
    const Point half = Point(frame.width(), frame.height()) / (2 * scale);
    return {middle_m_ - half, middle_m_ + half};
  }

  double scale = 1;  ///< pixels per metre
  Box frame;
  bool legend_beside = false;

 private:
  Point middle_m_;
};

/// Labels places texts without overlap, first come first served.
class Labels {
 public:
  explicit Labels(const Box& frame) : frame_(frame) {}

  void block(const Box& box) { taken_.push_back(box); }
  bool is_free(const Box& box) const {
    return frame_.contains(box) && std::none_of(taken_.begin(), taken_.end(), [&](const Box& each) {
             return each.overlaps(box);
           });
  }
  /// Writes a text at a place if it is free.
  bool place(const std::string& text, const Point& middle, bool upright = false) {
    const double width = width_px(text) + 4, height = kText_px + 3;
    const Box box =
        upright ? Box::around(middle, height, width) : Box::around(middle, width, height);
    if (!is_free(box)) return false;
    taken_.push_back(box);
    const std::string x = px(middle.x()), y = px(middle.y());
    append(svg_, "<text class=\"name\" x=\"{}\" y=\"{}\"{}>{}</text>\n", x, y,
           upright ? fmt::format(" transform=\"rotate(-90 {} {})\"", x, y) : "", xml_text(text));
    return true;
  }
  /// Writes a framed text as near to a point of an area as possible, on the area or at least within
  /// its bounds or near them. If all places are taken, writes nothing.
  void place_badge(const std::string& text, const Box& bounds, const Point& anchor,
                   const std::function<bool(const Point&)>& is_on_area, const char* colour) {
    const double width = width_px(text) + 9, height = kText_px + 5;
    std::vector<Point> places;
    for (int row = -8; row <= 8; ++row)
      for (int column = -8; column <= 8; ++column)
        places.emplace_back(anchor + Point(column * (width + 3), row * (height + 3)));
    std::stable_sort(places.begin(), places.end(), [&](const Point& a, const Point& b) {
      return (a - anchor).squaredNorm() < (b - anchor).squaredNorm();
    });
    const Box reach = {bounds.left - 1.5 * width, bounds.top - 1.5 * height,
                       bounds.right + 1.5 * width, bounds.bottom + 1.5 * height};
    enum class Limit { kArea, kBounds, kReach };
    for (const Limit limit : {Limit::kArea, Limit::kBounds, Limit::kReach})
      for (const Point& place : places) {
        const Box box = Box::around(place, width, height);
        if (!(limit == Limit::kReach ? reach : bounds).contains(box) || !is_free(box) ||
            (limit == Limit::kArea && !is_on_area(place)))
          continue;
        taken_.push_back(box);
        append(svg_,
               "<rect class=\"badge\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" rx=\"4\" "
               "stroke=\"{}\"/><text class=\"code\" x=\"{}\" y=\"{}\">{}</text>\n",
               px(box.left), px(box.top), px(width), px(height), colour, px(place.x()),
               px(place.y()), xml_text(text));
        return;
      }
  }
  const std::string& svg() const { return svg_; }

 private:
  Box frame_;
  std::vector<Box> taken_;
  std::string svg_;
};

/// A row of the legend: a symbol of 34 x 20 px, and one or two lines.
struct LegendRow {
  std::string symbol, line, more{};
  double height_px() const { return more.empty() ? 26 : 42; }
};

class PlanDrawing {
 public:
  PlanDrawing(const Scene& scene, const std::optional<NavMesh>& mesh)
      : scene_(scene), mesh_(mesh), view_(scene.ground), labels_(view_.frame) {}

  std::string draw() {
    draw_ground();
    for (size_t i = 0; i < scene_.groups.size(); ++i) draw_areas(i);
    draw_recorded();
    draw_obstacles();
    draw_routes();
    for (const Door& door : scene_.doors) draw_door(door);
    for (size_t i = 0; i < scene_.groups.size(); ++i) draw_queues(i);
    label_areas();
    label_obstacles();
    list_symbols();
    return page();
  }

 private:
  struct Shape {
    std::string name;
    Box box;
    Point middle;                           ///< a point inside, far from the edges
    std::vector<std::vector<Point>> rings;  ///< outlines and holes
  };
  struct Badge {
    size_t group;
    Area area;
    std::string label;
  };
  struct DoorLabel {
    std::string name;
    Point middle, half;
  };

  std::string path_of(const std::vector<Polygon>& polygons) const {
    std::string path;
    for (const Polygon& polygon : polygons) {
      add_ring(path, polygon.outline);
      for (const Ring& hole : polygon.holes) add_ring(path, hole);
    }
    return path;
  }

  void add_line(std::string& path, const std::vector<Point>& points) const {
    Point last = Point::Constant(-1e9);
    char command = 'M';
    for (const Point& point : points) {
      const Point at = view_(point);
      if ((at - last).norm() < 0.4) continue;
      append(path, "{}{} {}", command, px(at.x()), px(at.y()));
      last = at;
      command = 'L';
    }
  }

  /// A ring of less than a pixel becomes a dot.
  void add_ring(std::string& path, const Ring& ring) const {
    const Box box = view_(throng::bounds_of(ring));
    if (std::max(box.width(), box.height()) < 1.2) {
      append(path, "M{} {}h1.2v1.2h-1.2z", px(box.left), px(box.top));
      return;
    }
    add_line(path, ring);
    path += 'Z';
  }

  void draw_ground() {
    const Box& frame = view_.frame;
    const Box ground = view_(scene_.ground);
    append(map_,
           "<rect class=\"around\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>\n"
           "<rect id=\"ground\" fill=\"url(#blocked)\" x=\"{:.3f}\" y=\"{:.3f}\" width=\"{:.3f}\" "
           "height=\"{:.3f}\"/>\n",
           px(frame.left), px(frame.top), px(frame.width()), px(frame.height()), ground.left,
           ground.top, ground.width(), ground.height());
    std::vector<Polygon> walkable;
    const double reach_m = std::max(scene_.ground.min_m.cwiseAbs().maxCoeff(),
                                    scene_.ground.max_m.cwiseAbs().maxCoeff());
    if (reach_m > kMaxOnGrid_m || scene_.box)
      walkable = {polygon_of(scene_.ground)};
    else
      walkable = walkable_area(scene_);
    append(map_, "<path id=\"walkable\" d=\"{}\"/>\n", path_of(walkable));
    draw_grid();
    append(map_, "<rect class=\"edge\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\">{}</rect>\n",
           px(ground.left), px(ground.top), px(ground.width()), px(ground.height()),
           tooltip("edge of the ground"));
  }

  void draw_grid() {
    const Box& frame = view_.frame;
    const Rectangle shown = view_.shown_m();
    for (int axis = 0; axis < 2; ++axis) {
      // 60 px hold seven digits.
      const double spacing_m = (axis == 0 ? 60 : 40) / view_.scale;
      double step_m = round_length(spacing_m);
      while (step_m < spacing_m) step_m = round_length(2.6 * step_m);
      const auto last = static_cast<int64_t>(std::floor(shown.max_m[axis] / step_m));
      for (auto i = static_cast<int64_t>(std::ceil(shown.min_m[axis] / step_m)); i <= last; ++i) {
        Point at_m = shown.min_m;
        at_m[axis] = static_cast<double>(i) * step_m;
        const Point at = view_(at_m);
        if (axis == 0) {
          append(map_, "<path class=\"grid\" d=\"M{} {}V{}\"/>\n", px(at.x()), px(frame.top),
                 px(frame.bottom));
          append(border_,
                 "<path class=\"tick\" d=\"M{} {}v6\"/><text class=\"x\" x=\"{}\" "
                 "y=\"{}\">{:.10g}</text>\n",
                 px(at.x()), px(frame.bottom), px(at.x()), px(frame.bottom + 19), at_m.x());
        } else {
          append(map_, "<path class=\"grid\" d=\"M{} {}H{}\"/>\n", px(frame.left), px(at.y()),
                 px(frame.right));
          append(border_,
                 "<path class=\"tick\" d=\"M{} {}h-6\"/><text class=\"y\" x=\"{}\" "
                 "y=\"{}\">{:.10g}</text>\n",
                 px(frame.left), px(at.y()), px(frame.left - 9), px(at.y()), at_m.y());
        }
      }
    }
    append(border_,
           "<rect class=\"frame\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>\n"
           "<text class=\"x\" x=\"{}\" y=\"{}\">x in metres (east)</text>\n"
           "<text class=\"x\" transform=\"translate(16 {}) rotate(-90)\">y in metres "
           "(north)</text>\n",
           px(frame.left), px(frame.top), px(frame.width()), px(frame.height()),
           px(frame.middle().x()), px(frame.bottom + 37), px(frame.middle().y()));
  }

  /// An area of several groups, or several times of one: later outlines lie within earlier ones.
  std::vector<Polygon> nested(const Area& area) {
    std::vector<Polygon> polygons = area.polygons();
    const int earlier = drawn_[path_of(polygons)]++;
    const Rectangle bounds = bounds_of(polygons);
    const double inset_m = 3.5 * std::min(earlier, 8) / view_.scale;
    if (earlier == 0 || bounds.size_m().minCoeff() < 4 * inset_m) return polygons;
    for (Polygon& polygon : polygons)
      for (Point& corner : polygon.outline)
        for (int axis = 0; axis < 2; ++axis) {
          if (corner[axis] == bounds.min_m[axis]) corner[axis] += inset_m;
          if (corner[axis] == bounds.max_m[axis]) corner[axis] -= inset_m;
        }
    return polygons;
  }

  void draw_start(size_t group, const Area& area, const char* kind, const std::string& about,
                  const std::string& label) {
    append(map_, "<path class=\"{}\" stroke=\"{}\" fill=\"url(#hatch{})\" d=\"{}\">{}</path>\n",
           kind, colour_of(group), group, path_of(nested(area)), tooltip(about));
    add_badge(group, area, label);
  }

  void add_badge(size_t group, const Area& area, const std::string& label) {
    badges_.push_back({group, area, label});
  }

  std::string count_of(const Group& group) const {
    if (group.recorded > 0) return counted(group.total(), "recorded person", "recorded people");
    if (has_people(group)) return counted(group.total(), "person", "people");
    return counted(group.total(), "robot");
  }

  static std::string controller_of(const Group& group) {
    return group.control_channel.empty() ? "by the program that steps the run"
                                         : "by messages on channel " + group.control_channel;
  }

  void draw_areas(size_t index) {
    const Group& group = scene_.groups[index];
    const std::string letter = letter_of(index), name = "group " + letter + " " + group.name;
    if (group.recorded > 0) return;
    const bool is_external = group.is_external();
    if (group.count > 0) {
      draw_start(index, group.spawn, is_external ? "external" : "start",
                 is_external ? fmt::format("{}: {} at first, moved {}", name, group.count,
                                           controller_of(group))
                             : fmt::format("{}: {} start here", name, group.count),
                 is_external ? letter + " external" : letter + " start");
      (is_external ? has_external_ : has_start_) = true;
    }
    for (const Source& source : group.sources) {
      draw_start(index, source.area, "source",
                 fmt::format("{}: {} enter here, {:g} per s from {:g} s on", name, source.count,
                             source.rate_per_s, source.start_s),
                 letter + " enter");
      has_source_ = true;
    }
    for (size_t i = 0; i < group.goals.size() && !is_external; ++i) {
      const Goal& goal = group.goals[i];
      std::string about = fmt::format("{}: goal {}", name, i + 1);
      if (goal.areas.size() > 1) append(about, ", one of {} areas", goal.areas.size());
      if (goal.waypoint) about += ", passed without a stop";
      if (goal.is_limited()) append(about, ", a queue for {} at once", goal.max_inside());
      for (const auto& area : goal.areas) {
        append(map_,
               "<path class=\"goal\" stroke=\"{}\" fill=\"{}\" stroke-dasharray=\"{}\" "
               "d=\"{}\">{}</path>\n",
               colour_of(index), colour_of(index), dash_of(index), path_of(nested(area)),
               tooltip(about));
        add_badge(index, area, fmt::format("{}{}", letter, i + 1));
        has_goal_ = true;
      }
    }
    if (!group.look_at_m) return;
    const Point at = view_(*group.look_at_m);
    append(over_, "<path class=\"look\" stroke=\"{}\" d=\"M{} {}l6 6l-6 6l-6 -6Z\">{}</path>\n",
           colour_of(index), px(at.x()), px(at.y() - 6), tooltip(name + ": looks here"));
    labels_.block(Box::around(at, 14, 14));
    has_look_ = true;
  }

  void draw_recorded() {
    if (!scene_.recorded) return;
    const Recording& recording = *scene_.recorded->recording;
    const size_t people = recording.people().size();
    const size_t every = std::max<size_t>(1, (people + kMaxTracks - 1) / kMaxTracks);
    std::vector<Sample> samples;
    std::string tracks;
    for (size_t i = 0; i < people; i += every) {
      samples.clear();
      recording.read(i, samples);
      std::vector<Point> points;
      const size_t stride = std::max<size_t>(1, samples.size() / kMaxTrackCorners);
      for (size_t k = 0; k < samples.size(); k += stride) points.push_back(samples[k].position_m);
      if (!samples.empty()) points.push_back(samples.back().position_m);
      add_line(tracks, points);
    }
    const size_t group = scene_.groups.size() - 1;
    append(map_,
           "<path class=\"track\" stroke=\"{}\" d=\"{}\"/>\n<path class=\"recorded\" stroke=\"{}\" "
           "d=\"{}\">{}</path>\n",
           colour_of(group), tracks, colour_of(group),
           path_of({polygon_of(recording.facts().bounds)}),
           tooltip(
               fmt::format("bounds of {}", counted(people, "recorded person", "recorded people"))));
    add_badge(group, recording.facts().bounds, letter_of(group) + " recorded");
  }

  void draw_obstacles() {
    const double headroom = headroom_m(scene_);
    std::string small, solid, overhead;
    const std::vector<StatedObstacle> obstacles = stated_obstacles(scene_);
    has_few_obstacles_ = obstacles.size() <= kMaxNamesBeside;
    for (const StatedObstacle& obstacle : obstacles) {
      const Obstacle& first = *obstacle.pieces.front();
      const bool blocks = blocks_people(first, headroom);
      (blocks ? has_obstacle_ : has_overhead_) = true;
      const std::vector<Polygon> outline = outline_of(obstacle);
      const Rectangle bounds = bounds_of(outline);
      const Box box = view_(bounds);
      // Its outline would hide a small obstacle's true size.
      const bool is_small = blocks && std::max(box.width(), box.height()) < 4;
      if (std::max(box.width(), box.height()) > kText_px)
        shapes_.push_back(shape_of(obstacle.name, outline, box));
      const Point size_m =
          obstacle.pieces.size() > 1 ? bounds.size_m() : Point(first.size_m.head<2>());
      std::string& svg = is_small ? small : blocks ? solid : overhead;
      svg += "<path d=\"" + path_of(outline) + '"';
      if (small.size() + solid.size() + overhead.size() < kMaxObstacleBytes)
        append(
            svg, ">{}</path>\n",
            tooltip(fmt::format("{}: {:.4g} x {:.4g} x {:.4g} m{}", obstacle.name, size_m.x(),
                                size_m.y(), first.size_m.z(), blocks ? "" : ", not in the way")));
      else
        svg += "/>\n";
    }
    append(map_,
           "<g class=\"small\">\n{}</g>\n<g class=\"solid\">\n{}</g>\n<g "
           "class=\"overhead\">\n{}</g>\n",
           small, solid, overhead);
  }

  Shape shape_of(const std::string& name, const std::vector<Polygon>& outline,
                 const Box& box) const {
    Shape shape{name, box, box.middle(), {}};
    for (const Polygon& polygon : outline)
      for_each_ring(polygon, [&](const Ring& ring) {
        for (std::vector<Point>& corners = shape.rings.emplace_back(); const Point& corner : ring)
          corners.push_back(view_(corner));
      });
    const bool is_convex = outline.size() == 1 && outline[0].holes.empty() &&
                           convex_hull(outline[0].outline).size() == outline[0].outline.size();
    if (!is_convex) shape.middle = view_(Area({largest_of(outline)}).middle_m());
    return shape;
  }

  /// Arrowhead in the middle of a path's longest leg: labels cover the ends.
  std::string arrow_on(const std::vector<Point>& corners, const char* colour) const {
    size_t longest = 1;
    for (size_t i = 2; i < corners.size(); ++i)
      if ((corners[i] - corners[i - 1]).norm() > (corners[longest] - corners[longest - 1]).norm())
        longest = i;
    const Point from = view_(corners[longest - 1]), to = view_(corners[longest]);
    if ((to - from).norm() < 24) return "";
    const Point along = (to - from).normalized(), aside(-along.y(), along.x());
    const Point tip = 0.5 * (from + to) + 6 * along;
    const Point left = tip - 12 * along + 5 * aside, right = tip - 12 * along - 5 * aside;
    return fmt::format("<path fill=\"{}\" d=\"M{} {}L{} {}L{} {}Z\"/>", colour, px(tip.x()),
                       px(tip.y()), px(left.x()), px(left.y()), px(right.x()), px(right.y()));
  }

  void draw_routes() {
    if (!mesh_ || !mesh_->is_built()) return;
    size_t drawn = 0;
    const auto draw_leg = [&](size_t group, const Point& from, const auto& areas) {
      const Path path = mesh_->path(from, areas);
      if (path.corners_m.size() > 1 && path.arrives && drawn++ < kMaxRoutes) {
        std::string line;
        add_line(line, path.corners_m);
        append(over_, "<path class=\"route\" stroke=\"{0}\" d=\"{1}\"/>{2}\n", colour_of(group),
               line, arrow_on(path.corners_m, colour_of(group)));
        has_route_ = true;
      }
      return path.corners_m.empty() ? areas.front().middle_m() : path.corners_m.back();
    };
    for (size_t i = 0; i < scene_.groups.size(); ++i) {
      const Group& group = scene_.groups[i];
      if (group.goals.empty() || group.is_external() || group.recorded > 0) continue;
      std::vector<Point> starts;
      if (group.count > 0) starts.push_back(group.spawn.middle_m());
      for (const Source& source : group.sources) starts.push_back(source.area.middle_m());
      std::optional<Point> at;
      for (const Point& start : starts) {
        const Point end = draw_leg(i, start, group.goals.front().areas);
        if (!at) at = end;
      }
      for (size_t k = 1; k < group.goals.size() && at; ++k)
        at = draw_leg(i, *at, group.goals[k].areas);
    }
  }

  void draw_door(const Door& door) {
    const bool is_shut = !door.opens.empty();
    (is_shut ? has_shut_ : has_open_) = true;
    const Point from = view_(door.from_m), to = view_(door.to_m);
    append(over_,
           "<g class=\"door {}\"><path class=\"halo\" d=\"M{} {}L{} {}\"/><path d=\"M{} {}L{} "
           "{}\"/><circle cx=\"{}\" cy=\"{}\" r=\"3\"/><circle cx=\"{}\" cy=\"{}\" "
           "r=\"3\"/>{}</g>\n",
           is_shut ? "shut" : "open", px(from.x()), px(from.y()), px(to.x()), px(to.y()),
           px(from.x()), px(from.y()), px(to.x()), px(to.y()), px(from.x()), px(from.y()),
           px(to.x()), px(to.y()),
           tooltip(fmt::format("door {}, {} at first", door.name, is_shut ? "shut" : "open")));
    const Point middle = 0.5 * (from + to), half = 0.5 * (from - to).cwiseAbs();
    labels_.block(Box::around(middle, 2 * half.x() + 6, 2 * half.y() + 6));
    doors_.push_back({door.name, middle, half});
  }

  void draw_queues(size_t index) {
    if (scene_.groups[index].is_external()) return;
    for (const Goal& goal : scene_.groups[index].goals) {
      if (!goal.is_limited() || goal.queue.line_m.size() < 2) continue;
      has_queue_ = true;
      std::string line;
      add_line(line, goal.queue.line_m);
      append(over_, "<path class=\"queue\" stroke=\"{}\" d=\"{}\"/>\n", colour_of(index), line);
      double walked_m = 0, next_m = 0;
      size_t marks = 0;
      for (size_t i = 1; i < goal.queue.line_m.size(); ++i) {
        const Point &from = goal.queue.line_m[i - 1], &to = goal.queue.line_m[i];
        const double length_m = (to - from).norm();
        for (; next_m <= walked_m + length_m && marks < kMaxQueueMarks;
             next_m += goal.queue.spacing_m, ++marks) {
          const Point at = view_(from + (to - from) * ((next_m - walked_m) / length_m));
          append(over_, "<circle class=\"place\" stroke=\"{}\" cx=\"{}\" cy=\"{}\" r=\"3\"/>\n",
                 colour_of(index), px(at.x()), px(at.y()));
        }
        walked_m += length_m;
      }
    }
  }

  void label_areas() {
    std::stable_sort(badges_.begin(), badges_.end(), [](const Badge& a, const Badge& b) {
      return a.label.size() < b.label.size();  // goals first
    });
    for (const Badge& badge : badges_)
      labels_.place_badge(
          badge.label, view_(badge.area.bounds()), view_(badge.area.middle_m()),
          [&](const Point& place) { return badge.area.contains(view_.metres(place)); },
          colour_of(badge.group));
    for (const DoorLabel& door : doors_) {
      const double aside = width_px(door.name) / 2 + 8;
      for (const Point& offset : {Point(door.half.x() + aside, 0), Point(-door.half.x() - aside, 0),
                                  Point(0, -door.half.y() - 14), Point(0, door.half.y() + 14)})
        if (labels_.place(door.name, door.middle + offset)) break;
    }
  }

  /// Length of the line through the middle of a shape along an axis, up to the nearest edge.
  static double chord_px(const Shape& shape, int along) {
    const int across = 1 - along;
    double half = 1e9;
    for (const std::vector<Point>& corners : shape.rings)
      for (size_t i = 0; i < corners.size(); ++i) {
        const Point &p = corners[i], &q = corners[(i + 1) % corners.size()];
        if ((p[across] <= shape.middle[across]) == (q[across] <= shape.middle[across])) continue;
        const double t = (shape.middle[across] - p[across]) / (q[across] - p[across]);
        half = std::min(half, std::abs(p[along] + t * (q[along] - p[along]) - shape.middle[along]));
      }
    return half < 1e9 ? 2 * half : 0;
  }

  void label_obstacles() {
    std::stable_sort(shapes_.begin(), shapes_.end(), [](const Shape& a, const Shape& b) {
      return a.box.width() * a.box.height() > b.box.width() * b.box.height();
    });
    std::vector<const Shape*> left;
    for (const Shape& shape : shapes_) {
      const double along[] = {chord_px(shape, 0), chord_px(shape, 1)};
      const double width = width_px(shape.name) + 2;
      const bool is_written = (along[0] >= width && along[1] >= kText_px + 1 &&
                               labels_.place(shape.name, shape.middle)) ||
                              (along[1] >= width && along[0] >= kText_px + 1 &&
                               labels_.place(shape.name, shape.middle, true));
      if (!is_written) left.push_back(&shape);
    }
    if (!has_few_obstacles_) return;
    for (const Shape* shape : left) {
      // Bounds of slanted walls are mostly empty.
      if (std::min(shape->box.width(), shape->box.height()) < 60) labels_.block(shape->box);
    }
    for (const Shape* shape : left) {
      const std::string& name = shape->name;
      const Box& box = shape->box;
      const Point middle = box.middle();
      const double width = width_px(name) + 8, height = kText_px + 6;
      if (box.height() > 1.5 * width && box.width() < 30) {
        if (labels_.place(name, {box.right + height / 2, middle.y()}, true) ||
            labels_.place(name, {box.left - height / 2, middle.y()}, true))
          continue;
      }
      for (const Point& place :
           {Point(middle.x(), box.bottom + height / 2), Point(middle.x(), box.top - height / 2),
            Point(box.right + width / 2, middle.y()), Point(box.left - width / 2, middle.y())})
        if (labels_.place(name, place)) break;
    }
  }

  static std::string after_last_goal(const Group& group) {
    if (group.on_arrival == OnArrival::kLeave) return ", then leave";
    return group.on_arrival == OnArrival::kStay || group.goals.size() < 2 ? ", then stay"
                                                                          : ", repeat";
  }

  std::string route_of(size_t index) const {
    const Group& group = scene_.groups[index];
    if (group.is_external()) return ", moved " + controller_of(group);
    if (group.recorded > 0) return "";
    if (group.goals.empty()) return ", no goals";
    std::string text = ": ";
    const std::string letter = letter_of(index);
    const size_t count = group.goals.size();
    for (size_t i = 0; i < count; ++i) {
      if (count > 5 && i == 3) text += "..., ";
      if (count > 5 && i > 2 && i + 1 < count) continue;
      append(text, "{}{}{}", letter, i + 1, i + 1 < count ? ", " : "");
    }
    return text + after_last_goal(group);
  }

  void list_symbols() {
    const auto add = [&](bool is_used, const std::string& symbol, const std::string& line) {
      if (is_used) legend_.push_back({symbol, line});
    };
    const size_t listed = std::min(scene_.groups.size(), kMaxListedGroups);
    for (size_t i = 0; i < listed; ++i) {
      const Group& group = scene_.groups[i];
      const std::string symbol = fmt::format(
          "<rect class=\"start\" x=\"1\" y=\"1\" width=\"32\" height=\"22\" stroke=\"{0}\" "
          "fill=\"url(#hatch{1})\"/><rect class=\"badge\" x=\"{3}\" y=\"4\" width=\"{4}\" "
          "height=\"16\" rx=\"4\" stroke=\"{0}\"/><text class=\"code\" x=\"17\" "
          "y=\"12\">{2}</text>",
          colour_of(i), i, letter_of(i), px(17 - 0.5 * (width_px(letter_of(i)) + 9)),
          px(width_px(letter_of(i)) + 9));
      legend_.push_back({symbol, group.name, count_of(group) + route_of(i)});
    }
    if (scene_.groups.size() > listed)
      legend_.push_back(
          {"", fmt::format("and {}", counted(scene_.groups.size() - listed, "more group"))});
    if (scene_.box)
      legend_.push_back(
          {"", fmt::format("{} loose parts of '{}'", scene_.box->count, scene_.box->body->name),
           fmt::format("in a cube of {:g} m", scene_.box->edge_m)});
    const std::string area = "x=\"2\" y=\"3\" width=\"30\" height=\"17\"";
    const auto rect = [&](const std::string& rest) { return "<rect " + area + rest + "/>"; };
    const auto start = [&](const char* kind) {
      return rect(fmt::format(" class=\"{}\" stroke=\"#555\" fill=\"url(#hatch)\"", kind));
    };
    add(has_start_, start("start"), "start area");
    add(has_source_, start("source"), "entrance during the run");
    add(has_external_, start("external"), "externally controlled");
    add(has_goal_, rect(" class=\"goal\" stroke=\"#555\" fill=\"#555\""),
        "goal, in the order of visits");
    add(has_route_,
        "<path class=\"route\" stroke=\"#555\" d=\"M2 11H32\"/><path fill=\"#555\" d=\"M23 "
        "11L11 6V16Z\"/>",
        "shortest path from the middle");
    add(has_queue_,
        "<path class=\"queue\" stroke=\"#555\" d=\"M3 11H31\"/><circle class=\"place\" "
        "stroke=\"#555\" cx=\"3\" cy=\"11\" r=\"3\"/><circle class=\"place\" stroke=\"#555\" "
        "cx=\"17\" cy=\"11\" r=\"3\"/><circle class=\"place\" stroke=\"#555\" cx=\"31\" "
        "cy=\"11\" r=\"3\"/>",
        "line of a queue");
    add(scene_.recorded.has_value(), rect(" class=\"recorded\" stroke=\"#555\""),
        "bounds of recorded tracks");
    add(has_look_, "<path class=\"look\" stroke=\"#555\" d=\"M17 5l6 6l-6 6l-6 -6Z\"/>",
        "point that people look at");
    add(has_obstacle_, "<g class=\"solid\">" + rect("") + "</g>", "obstacle");
    add(has_overhead_, "<g class=\"overhead\">" + rect("") + "</g>", "overhead, not in the way");
    const auto door = [](const char* kind) {
      return fmt::format(
          "<g class=\"door {}\"><path d=\"M3 11H31\"/><circle cx=\"3\" cy=\"11\" "
          "r=\"3\"/><circle cx=\"31\" cy=\"11\" r=\"3\"/></g>",
          kind);
    };
    add(has_shut_, door("shut"), "door, shut at first");
    add(has_open_, door("open"), "door, open at first");
    add(!scene_.box, rect(" id=\"walkable-key\" fill=\"#fff\" stroke=\"#999\""), "walkable ground");
    add(!scene_.floor.empty(), rect(" fill=\"url(#blocked)\" stroke=\"#999\""), "not walkable");
  }

  /// Draws the legend; returns its lower end.
  double draw_legend(std::string& svg) const {
    const double column_px = view_.legend_beside ? kLegend_px - 24 : 276;
    const size_t columns = view_.legend_beside ? 1 : 4;
    const double left = view_.legend_beside ? view_.frame.right + 24 : kLeft_px;
    const double top = view_.legend_beside ? kTop_px : view_.frame.bottom + 56;
    const double total =
        std::accumulate(legend_.begin(), legend_.end(), 0.0,
                        [](double sum, const LegendRow& row) { return sum + row.height_px(); });
    const double limit = total / static_cast<double>(columns);
    double x = left, y = top, bottom = top;
    for (const LegendRow& row : legend_) {
      append(
          svg,
          "<g transform=\"translate({} {})\">{}<text class=\"entry\" x=\"42\" y=\"{}\">{}</text>",
          px(x), px(y), row.symbol, row.more.empty() ? 15 : 9,
          xml_text(cut(row.line, column_px - 48)));
      if (!row.more.empty())
        append(svg, "<text class=\"more\" x=\"42\" y=\"24\">{}</text>",
               xml_text(cut(row.more, column_px - 48)));
      append(svg, "{}</g>\n", tooltip(row.more.empty() ? row.line : row.line + ", " + row.more));
      y += row.height_px();
      bottom = std::max(bottom, y);
      if (y - top >= limit && columns > 1) {
        x += column_px;
        y = top;
      }
    }
    return bottom;
  }

  std::string header() const {
    const double right = kWidth_px - kRight_px;
    const double length_m = round_length(170 / view_.scale), length = length_m * view_.scale;
    int64_t people = 0;
    for (const Group& group : scene_.groups) people += group.total();
    const Point size = scene_.ground.size_m();
    std::string facts = fmt::format("{:.6g} x {:.6g} m", size.x(), size.y());
    if (scene_.box)
      append(facts, ", {}", counted(scene_.box->count, "loose part"));
    else
      append(facts, ", {} in {}, {}", counted(people, "avatar"),
             counted(scene_.groups.size(), "group"), counted(scene_.obstacles.size(), "obstacle"));
    if (!scene_.doors.empty()) append(facts, ", {}", counted(scene_.doors.size(), "door"));
    append(facts, ", {:g} s", scene_.duration_s);
    const double room = right - kLeft_px - 330;
    return fmt::format(
        "<text class=\"heading\" x=\"{}\" y=\"32\">{}</text>\n"
        "<text class=\"entry\" x=\"{}\" y=\"54\">{}</text>\n"
        "<text class=\"entry\" x=\"{}\" y=\"74\">{}</text>\n"
        "<g class=\"scale\"><path id=\"scale-bar\" d=\"M{:.3f} 60v-8v4h{:.3f}v4v-8\"/>"
        "<text x=\"{:.3f}\" y=\"42\">{}</text></g>\n"
        "<g class=\"scale\"><path d=\"M{:.1f} 66h34m-7 -4l7 4l-7 4M{:.1f} 66v-34m-4 7l4 -7l4 7\"/>"
        "<text x=\"{:.1f}\" y=\"70\">x</text><text x=\"{:.1f}\" y=\"26\">y, north</text></g>\n",
        px(kLeft_px), xml_text(cut(scene_.name, room, 22)), px(kLeft_px),
        xml_text(cut(escaped(scene_.description), room, 13)), px(kLeft_px), xml_text(facts),
        right - length - 1, length, right - length / 2 - 1, metres_text(length_m), right - 290,
        right - 290, right - 246, right - 290);
  }

  std::string definitions() const {
    std::string defs =
        "<defs>\n<pattern id=\"blocked\" width=\"6\" height=\"6\" "
        "patternUnits=\"userSpaceOnUse\"><rect width=\"6\" height=\"6\" fill=\"#dcdcdc\"/><path "
        "d=\"M0 6L6 0\" stroke=\"#b4b4b4\"/></pattern>\n";
    const auto add = [&](const std::string& suffix, const char* colour, const Hatch& hatch) {
      append(defs,
             "<pattern id=\"hatch{0}\" width=\"9\" height=\"9\" patternUnits=\"userSpaceOnUse\" "
             "patternTransform=\"rotate({1})\"><path d=\"{2}\" stroke=\"{3}\" "
             "stroke-width=\"2.4\" stroke-opacity=\"0.5\"/></pattern>\n",
             suffix, hatch.angle_deg, hatch.tile, colour);
    };
    for (size_t i = 0; i < scene_.groups.size(); ++i)
      add(std::to_string(i), colour_of(i), kHatches[hatch_of(i)]);
    add("", "#555", kHatches[0]);
    const Box& frame = view_.frame;
    append(defs,
           "<clipPath id=\"frame\"><rect x=\"{}\" y=\"{}\" width=\"{}\" "
           "height=\"{}\"/></clipPath>\n</defs>\n",
           px(frame.left), px(frame.top), px(frame.width()), px(frame.height()));
    return defs;
  }

  std::string page() const {
    std::string legend;
    const double height = std::max(view_.frame.bottom + 50, draw_legend(legend)) + 16;
    std::string svg = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} "
        "{1}\" role=\"img\">\n<title>{2}</title>\n",
        px(kWidth_px), px(std::ceil(height)), xml_text("Plan of " + scene_.name));
    svg += kStyle;
    svg += definitions();
    append(svg, "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n{}", header());
    append(svg, "<g clip-path=\"url(#frame)\">\n{}{}{}</g>\n", map_, over_, labels_.svg());
    return svg + border_ + legend + "</svg>\n";
  }

  static constexpr const char* kStyle = R"(<style>
text { font-family: Helvetica, Arial, 'DejaVu Sans', sans-serif; font-size: 12px; fill: #222; }
path, rect, circle { stroke-linejoin: round; }
.heading { font-size: 22px; font-weight: bold; }
.entry { font-size: 12.5px; }
.more { fill: #555; }
.name, .code { text-anchor: middle; dominant-baseline: central; }
.name { paint-order: stroke; stroke: #fff; stroke-width: 3px; stroke-linejoin: round; }
.code { font-weight: bold; font-size: 11.5px; }
.badge { fill: #fff; stroke-width: 2; }
.x { text-anchor: middle; }
.y { text-anchor: end; dominant-baseline: central; }
.tick, .frame, .edge, .scale path { fill: none; stroke: #444; }
.scale path { stroke-width: 1.5; }
.scale text { text-anchor: middle; }
.around { fill: #f1f1f1; }
#walkable { fill: #fff; fill-rule: evenodd; }
.grid { stroke: #000; stroke-opacity: 0.08; }
.edge { stroke-width: 1.5; }
.start { stroke-width: 1.2; }
.source { stroke-width: 3; stroke-dasharray: 1 4; stroke-linecap: round; }
.external { stroke-width: 3.5; stroke-dasharray: 12 2; }
.goal { stroke-width: 2.6; fill-opacity: 0.14; }
.solid, .small, .overhead { fill-rule: evenodd; }
.solid { fill: #8b8b8b; stroke: #333; stroke-width: 0.9; }
.small { fill: #444; }
.overhead { fill: #8b8b8b; fill-opacity: 0.12; stroke: #333; stroke-width: 1.2; stroke-dasharray: 5 3; }
.route { fill: none; stroke-width: 1.8; stroke-opacity: 0.85; }
.queue { fill: none; stroke-width: 1.6; }
.place { fill: #fff; stroke-width: 1.4; }
.track { fill: none; stroke-width: 0.9; stroke-opacity: 0.5; }
.recorded { fill: none; stroke-width: 1.8; stroke-dasharray: 2 4; }
.look { fill: #fff; stroke-width: 2; }
.door path { stroke: #000; stroke-width: 4; fill: none; }
.door path.halo { stroke: #fff; stroke-width: 8; stroke-dasharray: none; }
.door.open path { stroke-dasharray: 5 4; }
.door circle { fill: #000; }
</style>
)";

  const Scene& scene_;
  const std::optional<NavMesh>& mesh_;
  const View view_;
  Labels labels_;
  std::string map_, over_, border_;   ///< drawn in this order; the border is not clipped
  std::map<std::string, int> drawn_;  ///< number of outlines per path
  std::vector<Badge> badges_;
  std::vector<DoorLabel> doors_;
  std::vector<Shape> shapes_;  ///< obstacles that may have room for a name
  std::vector<LegendRow> legend_;
  bool has_start_ = false, has_source_ = false, has_external_ = false, has_goal_ = false;
  bool has_look_ = false, has_route_ = false, has_queue_ = false, has_obstacle_ = false;
  bool has_overhead_ = false, has_shut_ = false, has_open_ = false, has_few_obstacles_ = true;
};

}  // namespace

std::string draw_plan(const Scene& scene, const std::optional<NavMesh>& mesh) {
  return PlanDrawing(scene, mesh).draw();
}

}  // namespace throng
