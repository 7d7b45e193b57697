#include "bench/paper/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <deque>
#include <fstream>
#include <iterator>
#include <optional>

#include "avatars/mesh/primitives.h"
#include "base/cores.h"
#include "base/errors.h"
#include "base/files/atomic_file.h"
#include "base/text.h"
#include "bench/paper/census.h"
#include "bench/paper/published.h"
#include "bench/paper/strategies.h"
#include "bench/paper/tables.h"
#include "bench/workbench/volume_trials.h"
#include "culling/triangles/triangle_bvh.h"
#include "culling/volumes/pose_math.h"
#include "viewer/picture/volume_outline.h"

namespace throng::paper {
namespace {

/// The five volumes of the paper's figures, with the update rules that the paper probably used.
constexpr std::array<std::string_view, 5> kPlottedVolumes = {"sphere", "aabb", "obb",
                                                             "kdop26_refit", "ordop26"};
constexpr std::array<const char*, 5> kColours = {"#4477aa", "#ee6677", "#228833", "#ccbb44",
                                                 "#aa3377"};

const VolumeResult& volume_of(const PaperResult& result, std::string_view name) {
  for (const VolumeResult& volume : result.volumes)
    if (volume.name == name) return volume;
  return result.volumes.front();
}

std::string label(std::string_view name) {
  std::string text(name);
  for (size_t at = text.find('_'); at != std::string::npos; at = text.find('_', at + 1))
    text[at] = ' ';
  return text;
}

/// Clustered bars: a row per name, a column per series.
std::string bars(const std::string& data, const std::vector<std::string>& series, bool log,
                 const std::string& y_label) {
  std::string script = "$data << EOD\n" + data + "EOD\n";
  script +=
      "set style data histograms\nset style histogram clustered gap 1\nset style fill solid 0.85\n"
      "set boxwidth 0.9\nset grid ytics\nset xtics rotate by -30\nset key outside top center "
      "horizontal\n";
  if (log) script += "set logscale y\nset format y '10^{%L}'\n";
  script += fmt::format("set ylabel '{}'\nplot ", y_label);
  for (size_t i = 0; i < series.size(); ++i)
    script += fmt::format("{}$data using {}{} title '{}' linecolor rgb '{}'", i == 0 ? "" : ", ",
                          i + 2, i == 0 ? ":xtic(1)" : "", series[i], kColours[i % 5]);
  return script + "\n";
}

Figure figure_3(const PaperResult& result) {
  std::vector<bench::LabelledPoint> points;
  for (const VolumeResult& volume : result.volumes)
    points.push_back({label(volume.name), result.frame_ns(volume), 1 - volume.false_positive_rate});
  return {"figure_03", "Figure 3: simplicity against accuracy",
          fmt::format("The paper draws this as a ranking without numbers; here it is measured: the "
                      "cost of a frame of {} objects over the fraction of found pairs that touch.",
                      result.objects.size()),
          bench::figure_3_script(points, result.frame_in_words())};
}

Figure figure_6(const PaperResult& result) {
  std::string data;
  for (size_t i = 0; i < result.objects.size(); ++i) {
    data += fmt::format("\"{}\"", display_name(result.objects[i]));
    for (const std::string_view name : kPlottedVolumes)
      data += fmt::format(" {}", volume_of(result, name).costs.construction[i].median_ns * 1e-3);
    data += '\n';
  }
  std::vector<std::string> series;
  for (const std::string_view name : kPlottedVolumes) series.push_back(label(name));
  return {"figure_06", "Figure 6: construction time by object",
          "Median of 100 constructions. The paper prints the sums (C_o): AABB 91, sphere 135, OBB "
          "368, or-DOP 369, k-DOP 574 ms.",
          bars(data, series, true, "microseconds")};
}

Figure figure_7(const PaperResult& result) {
  std::string script, plots;
  for (size_t v = 0; v < kPlottedVolumes.size(); ++v) {
    const VolumeResult& volume = volume_of(result, kPlottedVolumes[v]);
    const PublishedVolume& published = *published_for(kPlottedVolumes[v]);
    script += fmt::format("$v{} << EOD\n", v);
    for (size_t mark = 0; mark < kMarks; ++mark) {
      const double published_count = legible(published.collisions[mark]);
      script += fmt::format("{} {} {} {}\n", (mark + 1) * 100, volume.collisions[mark],
                            volume.deviation[mark],
                            published_count < 0 ? "NaN" : fmt::format("{}", published_count));
    }
    script += "EOD\n";
    plots += fmt::format(
        "{0}$v{1} using 1:2:3 with yerrorlines linewidth 2 pointtype 7 linecolor rgb '{2}' title "
        "'{3}, Throng', $v{1} using 1:4 with linespoints dashtype 2 pointtype 6 linecolor rgb "
        "'{2}' title '{4}, paper'",
        v == 0 ? "plot " : ", ", v, kColours[v], label(kPlottedVolumes[v]), published.volume);
  }
  return {"figure_07", "Figure 7: accumulated collisions",
          "Solid: Throng, with the standard deviation over the seeds; dashed: the paper, lost last "
          "digits replaced by 4.5. The axis counts fifths of the run as the paper's 500 frames.",
          script +
              "set grid\nset xlabel 'frames'\nset ylabel 'collisions'\nset key outside right\n" +
              plots + "\n"};
}

Figure figure_8(const PaperResult& result) {
  std::string data;
  for (const VolumeResult& volume : result.volumes)
    data += fmt::format("\"{}\" {}\n", label(volume.name),
                        volume.frames * 1e3 / volume.costs.run_ms[0]);
  return {"figure_08",
          fmt::format("Figure 8: frames per second, {} objects", result.objects.size()),
          "Motion, updates and tests without drawing; the paper's bars have no numbers.",
          bars(data, {"frames per second"}, true, "frames per second")};
}

/// Figures 9 and 10: T by volume, with the paper's values for 500 frames.
Figure totals(const PaperResult& result, const char* id, const char* title, const char* caption,
              std::vector<int> lengths) {
  std::string data;
  std::vector<std::string> series;
  for (const int length : lengths)
    series.push_back(fmt::format("{} frames", length * result.options.frames));
  const bool paper = lengths.front() == 1;
  if (paper) series.push_back("the paper, 500 frames");
  for (const VolumeResult& volume : result.volumes) {
    data += fmt::format("\"{}\"", label(volume.name));
    for (const int length : lengths) data += fmt::format(" {}", volume.total_ms(length));
    const PublishedVolume* published = published_for(volume.name);
    if (paper) data += published == nullptr ? " NaN" : fmt::format(" {}", published->total_ms);
    data += '\n';
  }
  return {id, title, caption, bars(data, series, true, "T, ms")};
}

Figure figure_13(const PaperResult& result) {
  std::string data;
  for (size_t s = 0; s < kStrategies.size(); ++s) {
    data += fmt::format("\"{}\"", label(kStrategies[s]));
    for (const size_t size : {size_t{50}, size_t{350}, size_t{500}}) {
      const StrategyResult& run = result.scale(size)->strategies[s].result;
      data += fmt::format(" {} {} {}", 1e3 / run.median_ms, 1e3 / run.high_ms, 1e3 / run.low_ms);
    }
    data += '\n';
  }
  std::string script = "$data << EOD\n" + data +
                       "EOD\nset style data histograms\nset style histogram errorbars gap 1 "
                       "linewidth 1\nset style fill solid 0.85\nset boxwidth 0.9\nset grid "
                       "ytics\nset xtics rotate by -30\nset key outside top center horizontal\n"
                       "set logscale y\nset format y '10^{%L}'\nset ylabel 'frames per second'\n"
                       "plot ";
  for (size_t i = 0; i < 3; ++i)
    script +=
        fmt::format("{}$data using {}:{}:{}{} title '{} objects' linecolor rgb '{}'",
                    i == 0 ? "" : ", ", 3 * i + 2, 3 * i + 3, 3 * i + 4, i == 0 ? ":xtic(1)" : "",
                    i == 0   ? 50
                    : i == 1 ? 350
                             : 500,
                    kColours[i]);
  return {"figure_13", "Figure 13: frames per second by strategy",
          "The first 100 frames, one thread, no drawing: the median of all runs, whiskers from the "
          "slowest tenth to the fastest. two pass grid is not the paper's.",
          script + "\n"};
}

Figure crossings(const PaperResult& result) {
  std::string script = "$data << EOD\n";
  for (const Scale& scale : result.scales) {
    script += fmt::format("{}", scale.objects);
    for (const StrategyCost& each : scale.strategies)
      script += fmt::format(" {} {}", each.result.frame_ms,
                            each.result.frame_ms + each.exact_ms / each.result.frames);
    script += '\n';
  }
  script +=
      "EOD\nset logscale xy\nset grid\nset xlabel 'objects'\nset ylabel 'ms per frame, with "
      "triangles'\nset key outside right\nset xrange [12:12000]\nplot ";
  for (size_t s = 0; s < kStrategies.size(); ++s)
    script += fmt::format("{}$data using 1:{} with linespoints linewidth 2 title '{}'",
                          s == 0 ? "" : ", ", 3 + 2 * s, label(kStrategies[s]));
  return {"crossings", "Announced by the paper: the total cost of the hybrids",
          "Measured culling plus N_p C_p, the exact test of the reported pairs: strategies pay for "
          "false positives. hybrid one looks at one object only.",
          script + "\n"};
}

}  // namespace

std::vector<Figure> figures_of(const PaperResult& result) {
  return {figure_3(result),
          figure_6(result),
          figure_7(result),
          figure_8(result),
          totals(result, "figure_09", "Figure 9: total cost",
                 "T by the formula. The paper's k-DOP rises above its OBB at 1000 frames, which a "
                 "cost that is linear in the frames cannot do.",
                 {1, 2}),
          totals(result, "figure_10", "Figure 10: total cost of long runs",
                 "Ten times the frames, all volumes instead of the paper's short list.", {10}),
          figure_13(result),
          crossings(result)};
}

namespace {

constexpr int kFrames = 60;
const Eigen::Vector3f kColliding(0.85F, 0.10F, 0.08F);
const Eigen::Vector3f kMoving(0.40F, 0.52F, 0.68F);
const Eigen::Vector3f kStatic(0.62F, 0.60F, 0.55F);
const Eigen::Vector3f kWall(0.25F, 0.25F, 0.28F);
constexpr float kBarShare = 0.0012F;  // fraction of the distance to the eye

/// The twelve edges of the box as thin bars.
struct Frame {
  explicit Frame(double edge_m) {
    const double thickness_m = 0.004 * edge_m;
    for (int axis = 0; axis < 3; ++axis) {
      Eigen::Vector3d size = Eigen::Vector3d::Constant(thickness_m);
      size[axis] = edge_m;
      bars[static_cast<size_t>(axis)] = shape_of(box_mesh(size));
    }
  }
  void add(double edge_m, std::vector<RenderItem>& items) const {
    for (int axis = 0; axis < 3; ++axis)
      for (int corner = 0; corner < 4; ++corner) {
        Eigen::Vector3d place(0, 0, 0.5 * edge_m);
        place[(axis + 1) % 3] += (corner % 2 == 0 ? -0.5 : 0.5) * edge_m;
        place[(axis + 2) % 3] += (corner / 2 == 0 ? -0.5 : 0.5) * edge_m;
        RenderItem item{&bars[static_cast<size_t>(axis)]};
        item.world_from_shape.translation() = place.cast<float>();
        item.rgb = kWall;
        item.shadow = item.shape;
        items.push_back(item);
      }
  }
  std::array<Shape, 3> bars;
};

/// Scenery collects the items of a picture and its camera.
class Scenery {
 public:
  explicit Scenery(const Camera& camera) : camera_(camera) {}

  void add(const Object& object, const PartPose& pose, const Eigen::Vector3f& rgb) {
    shapes_.push_back(shape_of(object.mesh));
    RenderItem item{&shapes_.back()};
    item.world_from_shape = to_isometry(pose).cast<float>();
    item.rgb = rgb;
    item.shadow = item.shape;
    items_.push_back(item);
  }
  void add(VolumeKind kind, const BodyType& type, const PartPose& pose) {
    const VolumeOutline outline = outline_of(kind, type, 0, pose, 1);
    const float far = (camera_.eye_m - translation_m(pose)).norm();
    volumes_.add(outline, Eigen::Vector3f::Zero(), volume_rgb(name_of(kind)), kBarShare * far);
  }
  void add_box(double edge_m) {
    frame_.emplace(edge_m);
    frame_->add(edge_m, items_);
  }
  Image draw(int width, int height) {
    volumes_.append_to(items_);
    RenderOptions options;
    options.width = width;
    options.height = height;
    Workers workers(core_count());
    return render(items_, camera_, options, workers);
  }

 private:
  Camera camera_;
  std::deque<Shape> shapes_;  // a deque does not move its elements
  std::vector<RenderItem> items_;
  VolumeItems volumes_;
  std::optional<Frame> frame_;
};

/// Draws the whole box, on request with the sphere of every object.
Image draw_world(const std::vector<Object>& objects, const BoxDynamics& world,
                 const std::vector<SlotPair>& pairs, bool with_spheres) {
  std::vector<uint8_t> collides(world.size());
  for (const SlotPair& pair : pairs) collides[pair.a] = collides[pair.b] = 1;
  const auto edge = static_cast<float>(world.options().edge_m);
  Camera camera;
  camera.target_m = {0, 0, 0.47F * edge};
  camera.eye_m = {1.05F * edge, -2.1F * edge, 1.35F * edge};
  Scenery scenery(camera);
  for (size_t i = 0; i < world.size(); ++i) {
    const Object& object = objects[i % objects.size()];
    const bool moves = world.velocities_mps()[i].squaredNorm() > 0;
    scenery.add(object, world.pose(i), collides[i] != 0 ? kColliding : moves ? kMoving : kStatic);
    if (with_spheres) scenery.add(VolumeKind::kSphere, *object.type, world.pose(i));
  }
  scenery.add_box(world.options().edge_m);
  return scenery.draw(800, 600);
}

const Object& object_named(const std::vector<Object>& objects, const char* name) {
  for (const Object& object : objects)
    if (object.name == name) return object;
  return objects.front();
}

/// Row places copies of an object next to each other, seen from the front.
class Row {
 public:
  explicit Row(const Object& object, size_t count)
      : object_(object), step_m_(2.5 * object.radius_m), scenery_(camera(count)) {}

  /// Returns the pose of the next copy, with a rotation.
  PartPose next(const Eigen::Quaterniond& turn) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = turn.toRotationMatrix();
    pose.translation() =
        Eigen::Vector3d(step_m_ * static_cast<double>(placed_++), 0, 1.4 * object_.radius_m);
    const PartPose placed = to_part_pose(pose);
    scenery_.add(object_, placed, kMoving);
    return placed;
  }
  void add(VolumeKind kind, const BodyType& type, const PartPose& pose) {
    scenery_.add(kind, type, pose);
  }
  Image draw() { return scenery_.draw(1200, 420); }

 private:
  Camera camera(size_t count) const {
    Camera out;
    const auto middle = static_cast<float>(0.5 * step_m_ * static_cast<double>(count - 1));
    const auto radius = static_cast<float>(object_.radius_m);
    out.vertical_fov_rad = 0.35F;
    out.target_m = {middle, 0, 1.25F * radius};
    out.eye_m = out.target_m + Eigen::Vector3f(0, -13.5F * radius, 4 * radius);
    return out;
  }

  const Object& object_;
  double step_m_;
  size_t placed_ = 0;
  Scenery scenery_;
};

const Eigen::Quaterniond kTurn(Eigen::AngleAxisd(0.6, Eigen::Vector3d::UnitY()) *
                               Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX()));

PartPose without_turn(const PartPose& pose) {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  out.translation() = to_isometry(pose).translation();
  return to_part_pose(out);
}

/// Returns the object with rotated points, to fit an axis-aligned volume to them.
BodyType turned_type(const Object& object, const Eigen::Quaterniond& turn) {
  PartShape shape = object.shape;
  for (Eigen::Vector3f& p : shape.points) p = turn.cast<float>() * p;
  return BodyType({shape}, RootSphere{}, false);
}

Picture figure_1(const std::vector<Object>& objects) {
  const Object& object = object_named(objects, "lowerRightLeg");
  const BodyType turned = turned_type(object, kTurn);
  constexpr VolumeKind kKinds[] = {VolumeKind::kSphere, VolumeKind::kAabb, VolumeKind::kObb,
                                   VolumeKind::kKdop26, VolumeKind::kOrdop26};
  Row row(object, std::size(kKinds));
  for (const VolumeKind kind : kKinds) {
    const PartPose pose = row.next(kTurn);
    const bool is_ordop = kind == VolumeKind::kOrdop26;
    row.add(kind, is_ordop ? *object.type : turned, is_ordop ? pose : without_turn(pose));
  }
  return {"figure_01", "Figure 1: the five volumes around one object",
          "Sphere, AABB, OBB, k-DOP and or-DOP (k = 26) around the lower leg. The paper shows the "
          "volumes that it compares.",
          row.draw()};
}

Picture figure_2(const std::vector<Object>& objects) {
  const Object& object = object_named(objects, "lowerRightLeg");
  Row row(object, 5);
  for (const VolumeKind kind : {VolumeKind::kOrdop14, VolumeKind::kOrdop18, VolumeKind::kOrdop26})
    row.add(kind, *object.type, row.next(Eigen::Quaterniond::Identity()));
  for (const VolumeKind kind : {VolumeKind::kOrdop26, VolumeKind::kKdop26})
    row.add(kind, *object.type, row.next(kTurn));
  return {"figure_02", "Figure 2: the or-DOP and the effect of a rotation",
          "or-DOPs with 14, 18 and 26 faces; then the rotated object with its or-DOP 26, which "
          "rotates too, and with the k-DOP 26, which is refitted to the rotated volume and grows. "
          "The paper shows how a DOP is made and oriented.",
          row.draw()};
}

/// Draws the touching pair of the most similar sizes, with its volumes only.
Picture figure_11(const std::vector<Object>& objects, const BoxDynamics& world,
                  const std::vector<SlotPair>& pairs) {
  const auto object = [&](uint32_t i) -> const Object& { return objects[i % objects.size()]; };
  const auto difference = [&](const SlotPair& pair) {
    return std::abs(object(pair.a).radius_m - object(pair.b).radius_m);
  };
  const SlotPair* best = nullptr;
  TriangleCounters counters;
  for (const SlotPair& pair : pairs) {
    const Object &a = object(pair.a), &b = object(pair.b);
    if (!solids_touch({a.shape.points, a.shape.triangles}, world.pose(pair.a), 1,
                      {b.shape.points, b.shape.triangles}, world.pose(pair.b), 1,
                      Eigen::Vector3f::Zero(), counters))
      continue;
    if (best == nullptr || difference(pair) < difference(*best)) best = &pair;
  }
  if (best == nullptr) best = &pairs.front();
  // On the ground, to show a shadow.
  const double largest_m = std::max(object(best->a).radius_m, object(best->b).radius_m);
  const Eigen::Vector3d middle = 0.5 * (to_isometry(world.pose(best->a)).translation() +
                                        to_isometry(world.pose(best->b)).translation());
  Camera camera;
  camera.target_m = {0, 0, static_cast<float>(1.9 * largest_m)};
  camera.eye_m = camera.target_m + static_cast<float>(6.2 * largest_m) *
                                       Eigen::Vector3f(0.35F, -0.85F, 0.35F).normalized();
  Scenery scenery(camera);
  for (const uint32_t i : {best->a, best->b}) {
    Eigen::Isometry3d pose = to_isometry(world.pose(i));
    pose.pretranslate(Eigen::Vector3d(0, 0, 1.9 * largest_m) - middle);
    const PartPose placed = to_part_pose(pose);
    scenery.add(object(i), placed, kColliding);
    scenery.add(VolumeKind::kSphere, *object(i).type, placed);
    scenery.add(VolumeKind::kOrdop26, *object(i).type, placed);
  }
  return {"figure_11",
          fmt::format("Figure 11: a pair that collides, {} and {}",
                      display_name(object(best->a).name), display_name(object(best->b).name)),
          "Spheres and or-DOPs 26 of both; the triangles touch. The paper shows one colliding pair "
          "with its sphere and both or-DOPs.",
          scenery.draw(800, 600)};
}

std::vector<SlotPair> ordop_pairs(const std::vector<Object>& objects, const BoxDynamics& world) {
  using Method = Turned<Ordop<26>>;
  const auto fitted = fit_all<Method>(objects);
  const float margin = margin_m(objects, world);
  TriangleCounters unused;
  std::vector<SlotPair> pairs;
  for (uint32_t a = 0; a < world.size(); ++a)
    for (uint32_t b = a + 1; b < world.size(); ++b)
      if (Method::test(Method::update(fitted[a], objects[a], world.pose(a)),
                       Method::update(fitted[b], objects[b], world.pose(b)), margin, unused))
        pairs.push_back({a, b});
  return pairs;
}

Picture figure_4(const std::vector<Object>& objects, uint64_t seed) {
  BoxDynamics world = world_of(objects, objects.size(), 0, part_one_box(objects, seed));
  std::vector<SlotPair> pairs;
  for (int frame = 0; frame < kFrames || (pairs.empty() && frame < 10 * kFrames); ++frame) {
    world.step();
    if (frame + 1 >= kFrames) pairs = ordop_pairs(objects, world);
  }
  return {"figure_04",
          fmt::format("Figure 4: the {} objects of Part I with their spheres; {} by "
                      "or-DOP (red)",
                      objects.size(), counted(pairs.size(), "pair collides", "pairs collide")),
          "The paper shows its 15 objects, each in its sphere.",
          draw_world(objects, world, pairs, true)};
}

}  // namespace

std::vector<Picture> pictures_of(const std::vector<Object>& objects, uint64_t seed) {
  std::vector<Picture> pictures{figure_1(objects), figure_2(objects), figure_4(objects, seed)};
  StrategyRun few(Strategy::kTwoPass, objects, 50, seed);
  StrategyRun many(Strategy::kTwoPass, objects, 350, seed);
  for (int frame = 0; frame < kFrames; ++frame) {
    few.frame();
    many.frame();
  }
  const std::vector<SlotPair> of_few = few.pairs(), of_many = many.pairs();
  pictures.push_back({"figure_05a",
                      fmt::format("Figure 5a: 50 objects, grey ones static; {} (red)",
                                  counted(of_few.size(), "pair collides", "pairs collide")),
                      "The paper shows 50 objects without volumes.",
                      draw_world(objects, few.world(), of_few, false)});
  pictures.push_back({"figure_05b", "Figure 5b: the same 50 objects with their spheres",
                      "The paper shows 50 objects with their spheres.",
                      draw_world(objects, few.world(), of_few, true)});
  if (!of_many.empty()) pictures.push_back(figure_11(objects, many.world(), of_many));
  pictures.push_back({"figure_12",
                      fmt::format("Figure 12: 350 objects, grey ones static; {} (red)",
                                  counted(of_many.size(), "pair collides", "pairs collide")),
                      "The paper shows 350 objects.",
                      draw_world(objects, many.world(), of_many, false)});
  return pictures;
}

namespace {

namespace fs = std::filesystem;

constexpr const char* kStyle =
    "body{font:16px/1.5 sans-serif;max-width:1100px;margin:2em auto;padding:0 1em;color:#222}"
    "table{border-collapse:collapse;font-size:13px;display:block;overflow-x:auto;margin:.5em 0 2em}"
    "td,th{border:1px solid #ccc;padding:2px 7px;text-align:right;white-space:nowrap}"
    "td:first-child,th:first-child{text-align:left}th{background:#f0f0f0}"
    "figure{margin:2em 0}figcaption{font-size:14px;color:#555}img,svg{max-width:100%;height:auto}";

/// Above this value other programs disturbed the times.
constexpr double kQuiet = 1.25;

constexpr const char* kIntroduction =
    "Every experiment of Suaib, Bade, Mohamad: Hybrid Collision Culling by Bounding Volumes "
    "Manipulation in Massive Rigid Body Simulation, TELKOMNIKA 11(6), 2013, repeated on the {} "
    "parts of {}, with the paper's numbers. docs/paper.md lists the assumptions and explains "
    "differences.";

std::string read_file(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string base64(const std::string& bytes) {
  constexpr const char* kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t group = 0;
    for (size_t j = 0; j < 3; ++j)
      group = group << 8 | (i + j < bytes.size() ? static_cast<unsigned char>(bytes[i + j]) : 0u);
    for (size_t j = 0; j < 4; ++j)
      text += i + j > bytes.size() ? '=' : kDigits[group >> (18 - 6 * j) & 63];
  }
  return text;
}

std::string how(const PaperResult& result, const std::string& cpu) {
  return fmt::format(
      "{} frames, seed {}, {} seed(s), a box of {} m; {}, {}. The paper: Core 2 Duo E7400, 2 GB, "
      "Windows XP. Noise: the slowest tenth of a strategy's runs took {:.2f} times as long as the "
      "fastest tenth (median over strategies and sizes; {}).",
      result.options.frames, result.options.seed, result.options.seeds, result.edge_m, cpu,
      name_of(resolved(SimdTarget::kBest)), result.noise(),
      result.noise() < kQuiet ? "a quiet machine" : "a busy machine: read counts, not times");
}

/// The two pages: figures and pictures in the paper's order, then the tables.
struct Pages {
  std::string html, markdown;

  void add_figure(const std::string& title, const std::string& caption, const std::string& inlined,
                  const std::string& file) {
    html += "<figure>" + inlined + "<figcaption><b>" + html_escaped(title) + "</b> " +
            html_escaped(caption) + "</figcaption></figure>\n";
    markdown += fmt::format("![{}]({})\n\n*{}* {}\n\n", title, file, title, caption);
  }
  void add_table(const Table& table) {
    html += to_html(table);
    markdown += to_markdown(table);
  }
};

}  // namespace

void write_report(const PaperResult& result, const std::vector<Object>& objects,
                  const std::string& cpu, const fs::path& folder) {
  Pages pages;
  const std::string model = result.options.model.empty()
                                ? "Throng's adult"
                                : fs::path(result.options.model).filename().string();
  const std::string introduction = fmt::format(kIntroduction, objects.size(), model);
  const std::string title = "The paper, reproduced";
  pages.html = "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>" + title +
               "</title><style>" + kStyle + "</style></head><body>\n<h1>" + title + "</h1>\n<p>" +
               html_escaped(introduction) + "</p>\n<p>" + html_escaped(how(result, cpu)) + "</p>\n";
  pages.markdown = "# " + title + "\n\n" + introduction + "\n\n" + how(result, cpu) + "\n\n";
  const std::vector<Picture> pictures = pictures_of(objects, result.options.seed);
  auto picture = pictures.begin();
  const auto add_pictures_before = [&](const std::string& id) {
    for (; picture != pictures.end() && (id.empty() || picture->id < id); ++picture) {
      const std::string name = picture->id + ".png";
      write_png(folder / name, picture->image);
      pages.add_figure(
          picture->title, picture->caption,
          "<img alt=\"\" src=\"data:image/png;base64," + base64(read_file(folder / name)) + "\">",
          name);
    }
  };
  for (const Figure& figure : figures_of(result)) {
    add_pictures_before(figure.id.starts_with("figure") ? figure.id : "");
    std::string svg = draw(figure, folder);
    svg.erase(0, svg.find("<svg"));
    pages.add_figure(figure.title, figure.caption, svg, figure.id + ".svg");
  }
  for (const Table& table : tables_of(result)) pages.add_table(table);
  write_file_atomically(folder / "report.html", pages.html + "</body></html>\n");
  write_file_atomically(folder / "report.md", pages.markdown);
}

}  // namespace throng::paper
