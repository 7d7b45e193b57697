#include "scenes/file/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <numbers>
#include <set>

#include "avatars/mesh/primitives.h"
#include "avatars/mesh/tri.h"
#include "base/errors.h"
#include "base/limits.h"
#include "base/text.h"
#include "scenes/file/scene_fields.h"
#include "scenes/file/scene_keys.h"
#include "scenes/file/scene_limits.h"
#include "scenes/file/scene_routes.h"
#include "scenes/file/shapes.h"
#include "scenes/run/drive.h"

namespace throng {
namespace {

namespace fs = std::filesystem;

constexpr Range kSpeedRange{0.1, 4.0};  // from a shuffle to a run
constexpr Range kPersonRange{kMinPerson_m, kMaxPerson_m};
constexpr Range kRobotRange{kMinRobot_m, kMaxRobot_m};
/// Of one age among others: parts of 1, per cent or people.
constexpr Range kShareRange{0, 1e6};
constexpr Range kRadiusRange{kMinRadius_m, kMaxRadius_m};
// A millimetre is a tape; floats of 10 km, a wall around the largest scene, tell it from nothing.
constexpr Range kSizeRange{1e-3, 1e4};
/// Of a box: its parts are as large as hands.
constexpr Range kEdgeRange{0.1, kMaxEdge_m};
/// The narrowest ground: two of the smallest radii.
constexpr double kMinGround_m = 2 * kMinRadius_m;
/// Of what flies in a box: speed in m/s, spin in rad/s.
constexpr Range kFlightRange{0, 100};
/// Steering turns ten times a second; a longer step would outlive its decisions.
constexpr Range kStepRange{1e-4, 0.1};
/// Meshes hold floats: a wall along the edge of a ground of 10 km may stand out by as much.
constexpr double kRounding_m = 1e-3;
constexpr double kDefaultStep_s = 1.0 / 60.0;

std::string list_of(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) {
    if (!text.empty()) text += ", ";
    text += name;
  }
  return text;
}

double lowest_m(const Mesh& mesh) {
  float lowest = mesh.vertices.front().z();
  for (const Eigen::Vector3f& vertex : mesh.vertices) lowest = std::min(lowest, vertex.z());
  return static_cast<double>(lowest);
}

std::string show(const Rectangle& r) {
  return fmt::format("[{}, {}] to [{}, {}]", r.min_m.x(), r.min_m.y(), r.max_m.x(), r.max_m.y());
}

/// Reads a scene from its tree; remembers the file for messages.
class SceneReader {
 public:
  SceneReader(const fs::path& file, const YamlNode& root)
      : file_(file.string()), folder_(file.parent_path()), fields_(file_, root, "a scene") {
    scene_.file = file;
  }

  Scene read() {
    fields_.expect_keys(keys_of("scene"));
    scene_.name = fields_.name_or("name", name_after(fs::path(file_).stem().string()));
    scene_.description = fields_.line_or("description", "");
    scene_.seed = static_cast<uint64_t>(fields_.integer_or("seed", 0, INT64_MAX, 1));
    scene_.step_s = fields_.number_or("step_s", kStepRange, kDefaultStep_s);
    scene_.duration_s = fields_.number_or("duration_s", {0, 1e7, true}, 10);
    read_culling();
    read_steering();
    scene_.planted_feet = fields_.boolean_or("planted_feet", true);
    if (is_box())
      read_box();
    else
      read_crowd();
    fields_.done();
    scene_.content_hash = content_hash_of(scene_);
    return std::move(scene_);
  }

 private:
  bool is_box() {
    const std::string kind = fields_.text_or("kind", "crowd");
    const std::vector<std::string> kinds = {"box", "crowd"};
    if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end())
      throw InputError(fields_.where(fields_.require("kind")), "kind: crowd or box",
                       fmt::format("'{}'{}", kind, did_you_mean(kind, kinds)));
    return kind == "box";
  }

  void read_box() {
    Fields fields(file_, fields_.require("box"), "a box");
    fields.expect_keys(keys_of("box"));
    PartsBox box;
    box.count = static_cast<int>(fields.integer_or("count", 1, kMaxBodies, std::nullopt));
    box.static_every = static_cast<int>(fields.integer_or("static_every", 0, kMaxBodies, 0));
    box.edge_m = fields.number("edge_m", kEdgeRange);
    box.min_speed_mps = fields.number_or("min_speed_mps", kFlightRange, box.min_speed_mps);
    box.max_speed_mps = fields.number_or("max_speed_mps", kFlightRange, box.max_speed_mps);
    if (box.min_speed_mps > box.max_speed_mps)
      throw InputError(at_line(file_, fields.line()), "min_speed_mps of at most max_speed_mps",
                       fmt::format("{} and {}", box.min_speed_mps, box.max_speed_mps));
    box.max_spin_radps = fields.number_or("max_spin_radps", kFlightRange, box.max_spin_radps);
    box.model = model_file(fields);
    box.body = load_model(box.model);
    require_parts_of_size(fields, *box.body);
    fields.done();
    scene_.ground.max_m = Eigen::Vector2d::Constant(0.5 * box.edge_m);
    scene_.ground.min_m = -scene_.ground.max_m;
    scene_.box = std::move(box);
  }

  /// Each part flies by itself, about its middle.
  void require_parts_of_size(Fields& fields, const Model& body) {
    for (const Part& part : body.parts)
      for (const Eigen::Vector3f& vertex : part.mesh.vertices)
        if (!(static_cast<double>(vertex.norm()) <= kMaxReach_m))
          throw InputError(
              at_line(file_, fields.line()),
              fmt::format("a model with all vertices within {:g} m of their links", kMaxReach_m),
              fmt::format("one at {:g} m in '{}'; is it in other units?", vertex.norm(),
                          part.name));
  }

  void read_crowd() {
    scene_.ground = read_rectangle(file_, fields_.require("ground"), "ground");
    if (!(scene_.ground.size_m().minCoeff() >= kMinGround_m))
      throw InputError(
          at_line(file_, fields_.require("ground").line),
          fmt::format("ground of at least {} m x {} m", kMinGround_m, kMinGround_m),
          fmt::format("{} m x {} m", scene_.ground.size_m().x(), scene_.ground.size_m().y()));
    if (!(scene_.ground.area_m2() <= kMaxGround_m2))
      throw InputError(at_line(file_, fields_.require("ground").line),
                       fmt::format("ground of at most {} m2", kMaxGround_m2),
                       fmt::format("{}", scene_.ground.area_m2()));
    read_obstacles();
    read_groups();
  }

  void read_culling() {
    const YamlNode* node = fields_.find("culling");
    if (node == nullptr) return;
    Fields culling(file_, *node, "culling");
    culling.expect_keys(keys_of("culling"));
    if (const YamlNode* volume = culling.find("part_volume")) {
      const auto kind = volume_of(volume->scalar);
      if (!kind) {
        std::vector<std::string> names;
        for (const VolumeKind each : kAllVolumes) names.emplace_back(name_of(each));
        throw InputError(culling.where(*volume), fmt::format("a part_volume ({})", list_of(names)),
                         describe(*volume) + did_you_mean(volume->scalar, names));
      }
      scene_.part_volume = *kind;
    }
    scene_.exact = culling.boolean_or("exact", false);
    culling.done();
  }

  void read_steering() {
    const YamlNode* node = fields_.find("steering");
    if (node == nullptr) return;
    Fields steering(file_, *node, "steering");
    steering.expect_keys(keys_of("steering"));
    if (const YamlNode* model = steering.find("model")) {
      const auto kind = steering_kind_of(model->scalar);
      if (!kind)
        throw InputError(steering.where(*model),
                         fmt::format("a steering model ({})", list_of(steering_names())),
                         describe(*model) + did_you_mean(model->scalar, steering_names()));
      scene_.steering.model = *kind;
    }
    scene_.steering.density_speed = steering.boolean_or("density_speed", false);
    steering.done();
  }

  std::string unique_name(Fields& fields, const std::string& fallback,
                          std::set<std::string>& earlier) {
    const std::string name = fields.name_or("name", fallback);
    if (!earlier.insert(name).second)
      throw InputError(at_line(file_, fields.line()), "every name once",
                       fmt::format("'{}' again", name));
    return name;
  }

  void read_groups() {
    int64_t bodies = static_cast<int64_t>(scene_.obstacles.size());
    const std::vector<const YamlNode*> items = items_of(fields_, "groups", true);
    if (static_cast<int64_t>(items.size()) > kMaxGroups)
      throw InputError(at_line(file_, fields_.require("groups").line),
                       fmt::format("at most {} groups", kMaxGroups),
                       fmt::format("{}", items.size()));
    for (const YamlNode* item : items) {
      Fields fields(file_, *item, "a group");
      fields.expect_keys(keys_of("group"));
      Group group;
      group.name =
          unique_name(fields, fmt::format("group {}", scene_.groups.size() + 1), group_names_);
      read_start(fields, group);
      bodies += group.count;
      require_few(*item, bodies);
      read_driven(fields, group);
      read_routes(fields, scene_.ground, group);
      bodies += group.total() - group.count;
      require_few(*item, bodies);
      read_model(fields, group);
      read_people(fields, group);
      group.radius_m = fields.number_or("radius_m", kRadiusRange, 0);
      keep_own_size(group);
      require_scale(fields, group);
      fields.done();
      scene_.groups.push_back(std::move(group));
    }
  }

  /// What is said of speeds and heights holds for all ages; what is left out is that of the only
  /// age, or of adults.
  void read_people(Fields& fields, Group& group) {
    if (const YamlNode* node = fields.find("ages")) group.ages = read_ages(fields, *node);
    const AgeGroup& base = age_group(only_age(group.ages).value_or(Age::kAdult));
    if (const YamlNode* node = fields.find("speed_mps"))
      group.speed_mps = read_distribution(file_, *node, "speed_mps", base.speed_mps, kSpeedRange);
    if (const YamlNode* node = fields.find("height_m"))
      group.height_m = read_height(*node, *group.body, base.height_m);
    if (const YamlNode* node = fields.find("styles")) group.styles = read_styles(fields, *node);
  }

  /// What a robot's leaves out is its own height, and no limit.
  Distribution read_height(const YamlNode& node, const Model& body, const Distribution& people) {
    if (body.is_person) return read_distribution(file_, node, "height_m", people, kPersonRange);
    const Distribution own{static_cast<double>(body.height_m), 0, kMinRobot_m, kMaxRobot_m};
    return read_distribution(file_, node, "height_m", own, kRobotRange);
  }

  /// What a log can say of the scale, and how far parts are then from the root.
  void require_scale(Fields& fields, const Group& group) {
    const Model& body = *group.body;
    double most_m = 0;
    for (size_t age = 0; age < kAgeCount; ++age)
      most_m =
          std::max(most_m, group.height_m.value_or(age_group(static_cast<Age>(age)).height_m).max);
    const auto own_m = static_cast<double>(body.height_m);
    const auto scale = static_cast<float>(most_m / own_m);
    if (!(scale <= kMaxScale))
      throw InputError(at_line(file_, fields.line()),
                       fmt::format("a model at least {:g} m tall for avatars of {:g} m",
                                   most_m / static_cast<double>(kMaxScale), most_m),
                       fmt::format("'{}' of {:g} m; is it in other units?", body.name, own_m));
    const double reach_m = static_cast<double>(scale) * static_cast<double>(reach_of(body));
    if (!(reach_m <= kMaxReach_m))
      throw InputError(
          at_line(file_, fields.line()),
          fmt::format("a model with all parts within {:g} m of its root", kMaxReach_m),
          fmt::format("'{}', whose joints let them be at {:g} m; is it in other units?", body.name,
                      reach_m));
  }

  AgeShares read_ages(Fields& fields, const YamlNode& node) {
    if (node.kind == YamlNode::Kind::kMap) return read_shares<AgeShares>(node, "ages");
    const std::optional<AgeShares> named = ages_of(node.scalar);
    if (named && node.kind == YamlNode::Kind::kScalar) return *named;
    std::vector<std::string> words = age_names();
    words.emplace_back("mixed");
    refuse_word(fields, node, "ages", words);
  }

  StyleShares read_styles(Fields& fields, const YamlNode& node) {
    if (node.kind == YamlNode::Kind::kMap) return read_shares<StyleShares>(node, "styles");
    const std::optional<StyleShares> named = styles_of(node.scalar);
    if (named && node.kind == YamlNode::Kind::kScalar) return *named;
    refuse_word(fields, node, "styles", style_names());
  }

  [[noreturn]] void refuse_word(Fields& fields, const YamlNode& node, const std::string& what,
                                const std::vector<std::string>& words) {
    throw InputError(fields.where(node),
                     fmt::format("{} ({}) or a map of shares", what, list_of(words)),
                     describe(node) + did_you_mean(node.scalar, words));
  }

  /// A map of shares, in the order of its keys.
  template <typename Shares>
  Shares read_shares(const YamlNode& node, const std::string& what) {
    Fields fields(file_, node, what);
    const std::vector<std::string>& names = keys_of(what);
    fields.expect_keys(names);
    Shares shares{};
    for (size_t i = 0; i < shares.size(); ++i)
      shares[i] = fields.number_or(names[i], kShareRange, 0);
    fields.done();
    if (std::all_of(shares.begin(), shares.end(), [](double share) { return share == 0; }))
      throw InputError(at_line(file_, node.line), fmt::format("a share above 0 in {}", what),
                       "none");
    return shares;
  }

  void require_few(const YamlNode& node, int64_t bodies) {
    if (bodies > kMaxBodies)
      throw InputError(at_line(file_, node.line),
                       fmt::format("at most {} people and obstacles", kMaxBodies),
                       fmt::format("{}", bodies));
  }

  /// Those who are there at the start. A group whose people all come from sources needs none.
  void read_start(Fields& fields, Group& group) {
    const bool may_be_none = fields.find("sources") != nullptr;
    const auto fallback = may_be_none ? std::optional<int64_t>(0) : std::nullopt;
    group.count = static_cast<int>(fields.integer_or("count", 0, kMaxBodies, fallback));
    const YamlNode* spawn = fields.find("spawn");
    if (spawn != nullptr || group.count > 0 || !may_be_none)
      group.spawn = read_area(file_, fields.require("spawn"), "spawn", scene_.ground);
    else
      group.spawn = scene_.ground;
  }

  void read_driven(Fields& fields, Group& group) {
    const YamlNode* node = fields.find("driven");
    if (node == nullptr) return;
    group.driven = fields.text("driven");
    const auto is_fine = [](char c) {
      return std::isalnum(static_cast<unsigned char>(c)) || c == '_';
    };
    // liblcm refuses channels of more than 63 characters.
    if (group.driven.empty() || group.driven.size() > 63 || group.driven.starts_with("THRONG_") ||
        !std::all_of(group.driven.begin(), group.driven.end(), is_fine))
      throw InputError(fields.where(*node),
                       "an LCM channel of your own for 'driven': 1 to 63 letters, digits or '_', "
                       "not beginning with THRONG_",
                       fmt::format("'{}'", group.driven));
  }

  fs::path model_file(Fields& fields) {
    const YamlNode* node = fields.find("model");
    if (node == nullptr || node->scalar == "adult") return adult_urdf();
    if (node->kind != YamlNode::Kind::kScalar)
      throw InputError(fields.where(*node), "'adult' or a URDF file for 'model'", describe(*node));
    return existing_file(fields, *node, "'adult' or a URDF file");
  }

  void read_model(Fields& fields, Group& group) {
    group.model = model_file(fields);
    std::shared_ptr<const Model>& body = bodies_[group.model.string()];
    if (body == nullptr) body = load_model(group.model);
    group.body = body;
    if (!(group.body->height_m > 0))
      throw InputError(at_line(file_, fields.line()), "a model that stands above its ground",
                       fmt::format("'{}' with height {} m", group.body->name,
                                   static_cast<double>(group.body->height_m)));
  }

  fs::path existing_file(Fields& fields, const YamlNode& node, const std::string& expected) {
    if (node.scalar.empty()) throw InputError(fields.where(node), expected, "no name");
    std::error_code error;
    const fs::path path = fs::absolute(folder_ / node.scalar, error).lexically_normal();
    if (!fs::is_regular_file(path, error))
      throw InputError(fields.where(node), expected,
                       fmt::format("'{}', and no {} file at {}", node.scalar,
                                   fs::exists(path, error) ? "regular" : "such", path.string()));
    return path;
  }

  void read_obstacles() {
    if (const YamlNode* node = fields_.find("obstacles");
        node != nullptr && static_cast<int64_t>(node->items.size()) > kMaxObstacles)
      throw InputError(at_line(file_, node->line),
                       fmt::format("at most {} obstacles", kMaxObstacles),
                       fmt::format("{}", node->items.size()));
    for (const YamlNode* item : items_of(fields_, "obstacles", false)) {
      Fields fields(file_, *item, "an obstacle");
      fields.expect_keys(keys_of("obstacle"));
      Obstacle obstacle;
      obstacle.name = unique_name(fields, fmt::format("obstacle {}", scene_.obstacles.size() + 1),
                                  obstacle_names_);
      const std::vector<double> place =
          fields.numbers("position_m", 2, {-kMaxCoordinate_m, kMaxCoordinate_m});
      const double bottom_m = fields.number_or("bottom_m", {-10, 1000}, 0);
      obstacle.heading_rad =
          fields.number_or("heading_deg", {-360, 360}, 0) * (std::numbers::pi / 180);
      read_shape(fields, obstacle);
      fields.done();
      const bool is_mesh = obstacle.kind == Obstacle::Kind::kMesh;
      const double rise = is_mesh ? -lowest_m(obstacle.mesh) : 0.5 * obstacle.size_m.z();
      obstacle.centre_m = {place[0], place[1], bottom_m + rise};
      const Eigen::Vector2d rounding = Eigen::Vector2d::Constant(kRounding_m);
      const Rectangle reach{scene_.ground.min_m - rounding, scene_.ground.max_m + rounding};
      for (const Eigen::Vector2d& corner : footprint_of(obstacle))
        if (!reach.contains(corner))
          throw InputError(at_line(file_, item->line),
                           fmt::format("obstacle '{}' within the ground ({})", obstacle.name,
                                       show(scene_.ground)),
                           fmt::format("a corner at [{}, {}]", corner.x(), corner.y()));
      scene_.obstacles.push_back(std::move(obstacle));
    }
  }

  void read_shape(Fields& fields, Obstacle& obstacle) {
    const std::string kind = fields.text("kind");
    if (kind == "box") {
      const std::vector<double> size = fields.numbers("size_m", 3, kSizeRange);
      obstacle.kind = Obstacle::Kind::kBox;
      obstacle.size_m = {size[0], size[1], size[2]};
      obstacle.mesh = box_mesh(obstacle.size_m);
    } else if (kind == "cylinder") {
      const double diameter_m = fields.number("diameter_m", kSizeRange);
      obstacle.kind = Obstacle::Kind::kCylinder;
      obstacle.size_m = {diameter_m, diameter_m, fields.number("height_m", kSizeRange)};
      obstacle.mesh = cylinder_mesh(0.5 * diameter_m, obstacle.size_m.z());
    } else if (kind == "mesh") {
      obstacle.kind = Obstacle::Kind::kMesh;
      obstacle.mesh_file = existing_file(fields, fields.require("file"), "a .tri file");
      obstacle.mesh = read_tri(obstacle.mesh_file).mesh;
      measure_mesh(fields, obstacle);
    } else {
      const std::vector<std::string> kinds = {"box", "cylinder", "mesh"};
      throw InputError(fields.where(fields.require("kind")), "kind: box, cylinder or mesh",
                       fmt::format("'{}'{}", kind, did_you_mean(kind, kinds)));
    }
  }

  void measure_mesh(Fields& fields, Obstacle& obstacle) {
    Eigen::Vector3f low = obstacle.mesh.vertices.front();
    Eigen::Vector3f high = low;
    for (const Eigen::Vector3f& vertex : obstacle.mesh.vertices) {
      low = low.cwiseMin(vertex);
      high = high.cwiseMax(vertex);
    }
    const float farthest_m = low.cwiseAbs().cwiseMax(high.cwiseAbs()).maxCoeff();
    if (!(static_cast<double>(farthest_m) <= kMaxDescribed))
      throw InputError(at_line(file_, fields.line()),
                       fmt::format("a mesh within {:g} m of its origin", kMaxDescribed),
                       fmt::format("a vertex at {:g} m", farthest_m));
    obstacle.size_m = (high - low).cast<double>();
    if (footprint_of(obstacle).size() < 3 || !(obstacle.size_m.maxCoeff() <= kSizeRange.max))
      throw InputError(at_line(file_, fields.line()),
                       fmt::format("a mesh that covers some ground, at most {} m", kSizeRange.max),
                       fmt::format("one of {} x {} x {} m", obstacle.size_m.x(),
                                   obstacle.size_m.y(), obstacle.size_m.z()));
  }

  std::string file_;
  fs::path folder_;
  Fields fields_;
  Scene scene_;
  std::map<std::string, std::shared_ptr<const Model>> bodies_;  ///< by file
  std::set<std::string> group_names_;
  std::set<std::string> obstacle_names_;
};

fs::path bundled_folder() { return data_directory() / "scenes" / "bundled"; }

}  // namespace

Scene load_scene(const std::string& path_or_name) {
  fs::path file = path_or_name;
  // A bare word is a bundled scene; a path has a folder or an extension.
  if (!file.has_parent_path() && !file.has_extension() && !fs::exists(file)) {
    const fs::path bundled = bundled_folder() / (path_or_name + ".yaml");
    if (!fs::exists(bundled)) {
      std::vector<std::string> names;
      for (const SceneEntry& entry : bundled_scenes()) names.push_back(entry.name);
      throw InputError(path_or_name.empty() ? "scene" : path_or_name,
                       fmt::format("a scene file or a bundled scene ({})", list_of(names)),
                       fmt::format("neither{}", did_you_mean(path_or_name, names)));
    }
    file = bundled;
  }
  const std::string text = read_text_file(file, kMaxYamlBytes);
  return SceneReader(file, parse_yaml(text, file.string())).read();
}

std::vector<SceneEntry> bundled_scenes() {
  std::vector<SceneEntry> entries;
  for (const auto& item : fs::directory_iterator(bundled_folder())) {
    if (item.path().extension() != ".yaml") continue;
    const std::string file = item.path().string();
    const YamlNode root = parse_yaml(read_text_file(item.path(), kMaxYamlBytes), file);
    Fields fields(file, root, "a scene");
    entries.push_back({item.path().stem().string(), fields.text_or("description", "")});
  }
  std::sort(entries.begin(), entries.end(),
            [](const SceneEntry& a, const SceneEntry& b) { return a.name < b.name; });
  return entries;
}

}  // namespace throng
