// Vadere's scenarios: bounds, obstacles, sources and targets of a topography, with the numbers,
// speeds and waiting times of people.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <map>
#include <set>

#include "base/errors.h"
#include "base/text.h"
#include "recordings/readers/text_lines.h"
#include "scenes/file/key_tables.h"
#include "scenes/import/plan_json.h"
#include "scenes/import/plan_readers.h"

namespace throng {
namespace {

constexpr size_t kMaxTargetsOfSource = 100;
constexpr const char* kExpectedScenario = "a scenario of Vadere";
constexpr double kMaxScenarioNumber = 1e9;
/// A circle becomes a polygon around it, larger by 0.1 %.
constexpr int kCircleCorners = 64;

/// Agents of one source at most; more are a source without an end.
constexpr double kMaxAgentsOfSource = 100'000;
/// Desired speeds where a scenario states some of the four values only.
constexpr Distribution kVadereSpeed_mps{1.34, 0.26, 0.5, 2.2};

/// In the order of mean, standard deviation, minimum and maximum.
constexpr std::array kSpeedKeys = {"speedDistributionMean", "speedDistributionStandardDeviation",
                                   "minimumSpeed", "maximumSpeed"};

/// List of the topography that does not become shapes.
struct VadereList {
  std::string_view key;
  const char* what;  ///< description in `left_out`
};
constexpr VadereList kOtherLists[] = {
    {"stairs", "stairs, which are level ground"},
    {"measurementAreas", "measurement areas"},
    {"targetChangers", "target changers"},
    {"absorbingAreas", "absorbing areas"},
    {"aerosolClouds", "aerosol clouds"},
    {"droplets", "droplets"},
    {"dynamicElements", "agents that are placed singly"},
    {"pedestrians", "agents that are placed singly"},
    {"teleporter", "teleporters"},
};
constexpr std::string_view kUsedKeys[] = {
    "obstacles",    "sources",          "targets", "attributes",
    "bounds",       "boundingBoxWidth", "bounded", "attributesPedestrian",
    "attributesCar"};

/// A distribution in the forms of all versions.
struct VadereDistribution {
  std::string kind;                      ///< "constant", "normal", "negativeexponential", ...
  const PlanJson* parameters = nullptr;  ///< an object; in old versions a list; or none
};

/// Kind of a distribution or spawner, from its name or from that of its class.
std::string kind_of(std::string_view name) {
  name.remove_prefix(name.find_last_of('.') + 1);
  const std::string lowered = lower(name);
  std::string_view out = lowered;
  constexpr std::string_view kBegin = "attributes";
  if (out.starts_with(kBegin)) out.remove_prefix(kBegin.size());
  for (const std::string_view end : {"distribution", "spawner"})
    if (out.ends_with(end)) out.remove_suffix(end.size());
  return std::string(out);
}

class VadereScenario {
 public:
  explicit VadereScenario(const std::string& file) : file_(file) {}

  ImportedPlan read(const std::string& text) {
    const PlanJson root = parse_plan_json(text, file_);
    const PlanJson& topography = find_topography(root);
    plan_.kind = "Vadere scenario";
    plan_.unit_m = 1;  // by definition
    read_ground(topography);
    read_end(root);
    place_ = "the attributes of pedestrians";
    plan_.speed_mps = speed_of({stated(&topography, "attributesPedestrian")});
    place_ = "obstacles";
    for_each(topography, "obstacles", [&](const PlanJson& element, size_t number) {
      plan_.obstacles.push_back({name_of(element, "obstacle", number), shape_of(element)});
    });
    for_each(topography, "sources", [&](const PlanJson& element, size_t number) {
      NamedPolygon& start = plan_.starts.emplace_back();
      start = {name_of(element, "source", number), shape_of(element), targets_of(element)};
      start.arrivals = arrivals_of(element);
      const PlanJson* const spawner = stated(&element, "spawner");
      const PlanJson* const own = spawner != nullptr ? stated(spawner, "eventElement")
                                                     : stated(&element, "attributesPedestrian");
      if (states_speed(own))
        start.speed_mps = speed_of({own, stated(&topography, "attributesPedestrian")});
    });
    for_each(topography, "targets", [&](const PlanJson& element, size_t number) {
      NamedPolygon& goal = plan_.goals.emplace_back();
      goal = {name_of(element, "target", number), shape_of(element)};
      goal.wait_s = wait_of(element);
      is_absorbing_.insert({goal.name, absorbs(element)});
    });
    end_routes();
    compare_waits();
    for (const auto& [shapes, noun] :
         {std::pair(&plan_.obstacles, "obstacle"), std::pair(&plan_.starts, "source"),
          std::pair(&plan_.goals, "target")})
      if (!shapes->empty()) plan_.used.push_back(counted(shapes->size(), noun));
    if (circles_ > 0)
      plan_.used.push_back(
          fmt::format("{} as polygons of {} corners", counted(circles_, "circle"), kCircleCorners));
    list_people();
    list_others(topography);
    return std::move(plan_);
  }

 private:
  [[noreturn]] void reject(const std::string& expected, const PlanJson* found) const {
    throw InputError(file_, fmt::format("{} in {}", expected, place_),
                     found != nullptr ? described_json(*found) : "no such key");
  }

  static const PlanJson* member(const PlanJson& object, std::string_view key) {
    if (!object.is_object()) return nullptr;
    const auto found = object.find(key);
    return found != object.end() ? &*found : nullptr;
  }

  const PlanJson& find_topography(const PlanJson& root) {
    for (const char* above : {"", "scenario", "vadere"}) {
      const PlanJson* const outer = *above == '\0' ? &root : member(root, above);
      const PlanJson* const found = outer != nullptr ? member(*outer, "topography") : nullptr;
      if (found == nullptr) continue;
      place_ = "topography";
      if (!found->is_object()) reject("an object", found);
      return *found;
    }
    throw InputError(file_, "the key topography, as in a .scenario of Vadere", "no such key");
  }

  double number(const PlanJson& object, const char* key) const {
    const PlanJson* const found = member(object, key);
    if (found == nullptr || !found->is_number() ||
        !(std::abs(found->get<double>()) <= kMaxScenarioNumber))
      reject(fmt::format("a number as '{}'", key), found);
    return found->get<double>();
  }

  /// A member that is there and not null; old versions write null as a text.
  static const PlanJson* stated(const PlanJson* object, std::string_view key) {
    const PlanJson* const found = object != nullptr ? member(*object, key) : nullptr;
    return found != nullptr && !found->is_null() && *found != "null" ? found : nullptr;
  }

  /// Times without an end are numbers beyond the limit.
  double time_or(const PlanJson& object, const char* key, double fallback) const {
    const PlanJson* const found = stated(&object, key);
    if (found == nullptr) return fallback;
    if (!found->is_number()) reject(fmt::format("a number as '{}'", key), found);
    return std::clamp(found->get<double>(), -kMaxScenarioNumber, kMaxScenarioNumber);
  }

  double whole_or(const PlanJson& object, const char* key, double fallback) const {
    if (stated(&object, key) == nullptr) return fallback;
    const double value = number(object, key);
    if (value != std::floor(value))
      reject(fmt::format("a whole number as '{}'", key), member(object, key));
    return value;
  }

  bool flag_or(const PlanJson& object, const char* key, bool fallback) const {
    const PlanJson* const found = stated(&object, key);
    if (found == nullptr) return fallback;
    if (!found->is_boolean()) reject(fmt::format("true or false as '{}'", key), found);
    return found->get<bool>();
  }

  std::string text_of(const PlanJson& object, const char* key) const {
    const PlanJson* const found = member(object, key);
    if (found == nullptr || !found->is_string()) reject(fmt::format("a text as '{}'", key), found);
    return found->get<std::string>();
  }

  /// A distribution that is an object with its class as type, or a name and its parameters.
  std::optional<VadereDistribution> distribution_of(const PlanJson& object, const char* key) const {
    const PlanJson* const found = stated(&object, key);
    if (found == nullptr) return std::nullopt;
    if (found->is_object()) return VadereDistribution{kind_of(text_of(*found, "type")), found};
    return VadereDistribution{kind_of(text_of(object, key)),
                              stated(&object, "distributionParameters")};
  }

  std::optional<double> parameter(const VadereDistribution& distribution, const char* key,
                                  size_t index) const {
    const PlanJson* value = nullptr;
    if (distribution.parameters != nullptr && distribution.parameters->is_array())
      value =
          index < distribution.parameters->size() ? &(*distribution.parameters)[index] : nullptr;
    else
      value = stated(distribution.parameters, key);
    if (value == nullptr || value->is_null()) return std::nullopt;
    if (!value->is_number() || !(std::abs(value->get<double>()) <= kMaxScenarioNumber))
      reject(fmt::format("a number as '{}'", key), value);
    return value->get<double>();
  }

  void read_end(const PlanJson& root) {
    place_ = "attributesSimulation";
    for (const char* above : {"", "scenario", "vadere"}) {
      const PlanJson* const outer = *above == '\0' ? &root : member(root, above);
      if (const PlanJson* const simulation = stated(outer, "attributesSimulation"))
        end_s_ = time_or(*simulation, "finishTime", kMaxScenarioNumber);
    }
    if (end_s_ > 0 && end_s_ <= kTimeRange.max) plan_.duration_s = end_s_;
  }

  static bool states_speed(const PlanJson* attributes) {
    return std::any_of(kSpeedKeys.begin(), kSpeedKeys.end(),
                       [&](const char* key) { return stated(attributes, key) != nullptr; });
  }

  /// Desired speeds, each value by the first object that states it; none if all are missing.
  std::optional<Distribution> speed_of(std::initializer_list<const PlanJson*> attributes) {
    if (std::none_of(attributes.begin(), attributes.end(), states_speed)) return std::nullopt;
    Distribution out = kVadereSpeed_mps;
    double* const values[] = {&out.mean, &out.std_dev, &out.min, &out.max};
    for (size_t i = 0; i < kSpeedKeys.size(); ++i) {
      const auto* const found = std::find_if(
          attributes.begin(), attributes.end(),
          [&](const PlanJson* each) { return stated(each, kSpeedKeys[i]) != nullptr; });
      if (found != attributes.end()) *values[i] = number(**found, kSpeedKeys[i]);
    }
    const Distribution as_stated = out;
    out.min = std::max(out.min, kDesiredSpeedRange.min);
    out.max = std::min(out.max, kDesiredSpeedRange.max);
    if (!(out.min <= out.mean && out.mean <= out.max && out.std_dev >= 0 &&
          out.std_dev <= kDesiredSpeedRange.max)) {
      left_out_.insert(fmt::format(
          "desired speeds of mean {:g} and standard deviation {:g} m/s between {:g} and "
          "{:g} m/s",
          as_stated.mean, as_stated.std_dev, as_stated.min, as_stated.max));
      return std::nullopt;
    }
    if (out != as_stated)
      left_out_.insert(fmt::format("desired speeds outside {:g} to {:g} m/s",
                                   kDesiredSpeedRange.min, kDesiredSpeedRange.max));
    return out;
  }

  /// Mean time between the events of a source; none for intervals that a scene cannot express.
  std::optional<double> interval_s_of(const VadereDistribution& distribution) const {
    std::optional<double> out;
    if (distribution.kind == "constant")
      out = parameter(distribution, "updateFrequency", 0).value_or(1);
    else if (distribution.kind == "poisson")
      out = 1 / parameter(distribution, "numberPedsPerSecond", 0).value_or(0);
    else if (distribution.kind == "negativeexponential" || distribution.kind == "exponential")
      out = parameter(distribution, "mean", 0);
    return out && *out > 0 && std::isfinite(*out) ? out : std::nullopt;
  }

  /// Numbers and times of a source; none if it states none or if a scene cannot express them.
  std::optional<PlanArrivals> arrivals_of(const PlanJson& source) {
    const PlanJson* const spawner = stated(&source, "spawner");
    if (spawner != nullptr && !spawner->is_object()) reject("an object as 'spawner'", spawner);
    if (spawner == nullptr && stated(&source, "spawnNumber") == nullptr &&
        stated(&source, "startTime") == nullptr)
      return std::nullopt;
    // Version 3 moved the keys of a source to its spawner.
    const bool is_new = spawner != nullptr;
    const PlanJson& keys = is_new ? *spawner : source;
    const double per_event = whole_or(
        keys, is_new && stated(&keys, "eventElementCount") ? "eventElementCount" : "spawnNumber",
        1);
    const double max =
        whole_or(keys, is_new ? "constraintsElementsMax" : "maxSpawnNumberTotal", -1);
    const double start_s = time_or(keys, is_new ? "constraintsTimeStart" : "startTime", 0);
    const double stated_end_s = time_or(keys, is_new ? "constraintsTimeEnd" : "endTime", 0);
    VadereDistribution distribution =
        distribution_of(keys, is_new ? "distribution" : "interSpawnTimeDistribution")
            .value_or(VadereDistribution{.kind = "constant"});
    if (is_new && stated(spawner, "type") != nullptr)
      if (const std::string kind = kind_of(text_of(*spawner, "type")); kind != "regular")
        distribution.kind = kind;
    // Equal times mean one event.
    const bool is_single = start_s == stated_end_s;
    std::optional<double> interval_s = interval_s_of(distribution);
    if (const double delay_s = is_new ? -1 : time_or(source, "spawnDelay", -1);
        delay_s > 0 && distribution.kind == "constant")
      interval_s = delay_s;
    double count = std::max(per_event, 0.0);
    if (!is_single && interval_s) {
      const double last_s = std::min(stated_end_s, std::max(end_s_, start_s));
      count *= std::max(0.0, std::floor((last_s - start_s) / *interval_s + 1e-9) + 1);
    }
    if (max >= 0) count = std::min(count, max);
    if ((!is_single && !interval_s) || !(count <= kMaxAgentsOfSource) || start_s > kTimeRange.max) {
      ++unread_sources_[is_single || interval_s ? "" : distribution.kind];
      return std::nullopt;
    }
    ++read_sources_;
    PlanArrivals out{.count = static_cast<int64_t>(count), .start_s = std::max(start_s, 0.0)};
    if (count <= per_event) return out;
    out.rate_per_s = std::min(per_event / *interval_s, kRateRange.max);
    out.is_poisson = distribution.kind != "constant";
    if (per_event > 1) ++batches_;
    if (out.is_poisson) ++random_counts_;
    return out;
  }

  /// Time that agents spend at a target; none for no time and for what a scene cannot express.
  std::optional<Distribution> wait_of(const PlanJson& target) {
    const PlanJson* const waiter = stated(&target, "waiter");
    if (waiter != nullptr && !waiter->is_object()) reject("an object as 'waiter'", waiter);
    if (waiter != nullptr && !flag_or(*waiter, "enabled", false)) return std::nullopt;
    const PlanJson& keys = waiter != nullptr ? *waiter : target;
    const PlanJson* const behaviour = stated(&target, "waitingBehaviour");
    const std::string mode =
        behaviour != nullptr ? lower(text_of(target, "waitingBehaviour")) : "individual";
    if (mode == "no_waiting") return std::nullopt;
    std::optional<Distribution> out;
    std::optional<VadereDistribution> distribution =
        distribution_of(keys, waiter != nullptr ? "distribution" : "waitingTimeDistribution");
    if (distribution && distribution->kind == "normal") {
      out = {.mean = parameter(*distribution, "mean", 0).value_or(0),
             .std_dev = parameter(*distribution, "sd", 1).value_or(0),
             .min = kTimeRange.min,
             .max = kTimeRange.max};
      if (!(out->mean > 0 && out->mean <= out->max && out->std_dev >= 0 &&
            out->std_dev <= out->max))
        out.reset();
    } else if (!distribution || distribution->kind == "constant") {
      const double time_s = distribution
                                ? parameter(*distribution, "updateFrequency", 0).value_or(0)
                                : time_or(keys, "waitingTime", 0);
      if (!(time_s > 0)) return std::nullopt;
      if (time_s <= kTimeRange.max) out = {.mean = time_s, .min = time_s, .max = time_s};
    }
    if (!flag_or(keys, "individualWaiting", true) || mode == "traffic_light") {
      ++unread_waits_["traffic light"];
      return std::nullopt;
    }
    if (!out) {
      ++unread_waits_[distribution ? distribution->kind : "too long"];
      return out;
    }
    ++waits_;
    if (whole_or(target, waiter != nullptr ? "parallelEvents" : "parallelWaiters", 0) > 0)
      left_out_.insert("limits of the number of agents that wait at a target");
    return out;
  }

  bool absorbs(const PlanJson& target) const {
    const PlanJson* const absorber = stated(&target, "absorber");
    if (absorber != nullptr && !absorber->is_object()) reject("an object as 'absorber'", absorber);
    return absorber != nullptr ? flag_or(*absorber, "enabled", true)
                               : flag_or(target, "absorbing", true);
  }

  /// Agents vanish at the first target that absorbs them, or stay at the last one.
  void end_routes() {
    for (NamedPolygon& start : plan_.starts) {
      const auto absorbs = [&](const std::string& name) {
        const auto found = is_absorbing_.find(name);
        return found != is_absorbing_.end() && found->second;
      };
      if (start.goals.empty()) {
        start.stays = std::none_of(plan_.goals.begin(), plan_.goals.end(),
                                   [&](const NamedPolygon& goal) { return absorbs(goal.name); });
        continue;
      }
      const auto last = std::find_if(start.goals.begin(), start.goals.end(), absorbs);
      if (last != start.goals.end()) start.goals.erase(last + 1, start.goals.end());
      start.stays = is_absorbing_.contains(start.goals.back()) && !absorbs(start.goals.back());
    }
  }

  /// Alternatives of a goal share its waiting time.
  void compare_waits() {
    const auto differ = [&](const std::string* name) {
      const NamedPolygon* first = nullptr;
      for (const NamedPolygon& goal : plan_.goals) {
        if (name != nullptr && goal.name != *name) continue;
        if (first == nullptr) first = &goal;
        if (goal.wait_s != first->wait_s) return true;
      }
      return false;
    };
    bool is_unequal = false;
    for (const NamedPolygon& start : plan_.starts) {
      if (start.goals.empty()) is_unequal = is_unequal || differ(nullptr);
      for (const std::string& name : start.goals) is_unequal = is_unequal || differ(&name);
    }
    if (plan_.starts.empty()) is_unequal = differ(nullptr);
    if (is_unequal)
      plan_.left_out.emplace_back("waiting times that differ between alternative targets");
  }

  void list_people() {
    if (read_sources_ > 0)
      plan_.used.push_back("numbers and times of " + counted(read_sources_, "source"));
    if (plan_.speed_mps || std::any_of(plan_.starts.begin(), plan_.starts.end(),
                                       [](const NamedPolygon& start) { return start.speed_mps; }))
      plan_.used.emplace_back("desired speeds of pedestrians");
    if (waits_ > 0) plan_.used.push_back("waiting times of " + counted(waits_, "target"));
    for (const auto& [kind, count] : unread_sources_)
      plan_.left_out.push_back(
          fmt::format("numbers and times of {}{}", counted(count, "source"),
                      kind.empty() ? ", too many or too late" : ", kind " + in_quotes(kind)));
    if (batches_ > 0)
      plan_.left_out.push_back(fmt::format(
          "events of {} with several agents: they enter one by one", counted(batches_, "source")));
    if (random_counts_ > 0)
      plan_.left_out.push_back(
          fmt::format("random numbers of {}: the mean is used", counted(random_counts_, "source")));
    for (const auto& [kind, count] : unread_waits_)
      plan_.left_out.push_back(
          fmt::format("waiting times of {}, kind {}", counted(count, "target"), in_quotes(kind)));
    plan_.left_out.insert(plan_.left_out.end(), left_out_.begin(), left_out_.end());
  }

  Polygon rectangle(double x, double y, double width, double height, const PlanJson& found) const {
    if (!(width > 0 && height > 0)) reject("a width and a height above 0", &found);
    return {{{x, y}, {x + width, y}, {x + width, y + height}, {x, y + height}}, {}};
  }

  /// The wall around a bounded topography lies inside its bounds.
  void read_ground(const PlanJson& topography) {
    const PlanJson* const attributes = member(topography, "attributes");
    const PlanJson& source = attributes != nullptr ? *attributes : topography;
    const PlanJson* const bounds = member(source, "bounds");
    place_ = "the attributes of the topography";
    if (bounds == nullptr || !bounds->is_object()) reject("an object as 'bounds'", bounds);
    const PlanJson* const bounded = member(source, "bounded");
    if (bounded != nullptr && !bounded->is_boolean()) reject("true or false as 'bounded'", bounded);
    const bool has_wall = bounded == nullptr || bounded->get<bool>();
    const double wall = has_wall && member(source, "boundingBoxWidth") != nullptr
                            ? number(source, "boundingBoxWidth")
                            : 0;
    if (!(wall >= 0)) reject("0 or more as 'boundingBoxWidth'", member(source, "boundingBoxWidth"));
    const double width = number(*bounds, "width"), height = number(*bounds, "height");
    if (!(width > 2 * wall && height > 2 * wall))
      reject("bounds wider than two walls of boundingBoxWidth", bounds);
    plan_.walkable.push_back(rectangle(number(*bounds, "x") + wall, number(*bounds, "y") + wall,
                                       width - 2 * wall, height - 2 * wall, *bounds));
    plan_.used.push_back(wall > 0 ? fmt::format("bounds of {} m by {} m without their wall of {} m",
                                                width, height, wall)
                                  : fmt::format("bounds of {} m by {} m", width, height));
  }

  template <typename Each>
  void for_each(const PlanJson& topography, const char* key, const Each& each) {
    const PlanJson* const list = member(topography, key);
    if (list == nullptr || list->is_null()) return;
    place_ = key;
    if (!list->is_array()) reject("a list", list);
    size_t index = 0;
    for (const PlanJson& element : *list) {
      place_ = fmt::format("{} {} of the topography", key, ++index);
      // Before version 0.2 the attributes of an element are an object of their own.
      const PlanJson* const inner = member(element, "attributes");
      each(inner != nullptr && member(element, "shape") == nullptr ? *inner : element, index);
    }
  }

  static std::string name_of(const PlanJson& element, const char* noun, size_t number) {
    const PlanJson* const id = member(element, "id");
    if (id != nullptr && id->is_number_integer() && id->get<int64_t>() >= 0)
      return fmt::format("{} {}", noun, id->get<int64_t>());
    return fmt::format("{} number {}", noun, number);
  }

  /// Targets with one id are alternatives, those of a list are visited in order.
  std::vector<std::string> targets_of(const PlanJson& source) const {
    const PlanJson* const ids = member(source, "targetIds");
    std::vector<std::string> names;
    if (ids == nullptr || ids->is_null()) return names;
    if (!ids->is_array()) reject("a list as 'targetIds'", ids);
    if (ids->size() > kMaxTargetsOfSource)
      reject(fmt::format("at most {} ids in 'targetIds'", kMaxTargetsOfSource), ids);
    for (const PlanJson& id : *ids) {
      if (!id.is_number_integer()) reject("whole numbers in 'targetIds'", &id);
      names.push_back(fmt::format("target {}", id.get<int64_t>()));
    }
    return names;
  }

  Polygon shape_of(const PlanJson& element) {
    const PlanJson* const shape = member(element, "shape");
    if (shape == nullptr || !shape->is_object()) reject("an object as 'shape'", shape);
    const PlanJson* const type = member(*shape, "type");
    const std::string kind =
        type != nullptr && type->is_string() ? type->get<std::string>() : std::string();
    if (kind == "RECTANGLE") {
      count_vertices(4);
      return rectangle(number(*shape, "x"), number(*shape, "y"), number(*shape, "width"),
                       number(*shape, "height"), *shape);
    }
    if (kind == "CIRCLE") return circle(*shape);
    if (kind != "POLYGON") reject("POLYGON, RECTANGLE or CIRCLE as 'type' of the shape", type);
    const PlanJson* const points = member(*shape, "points");
    if (points == nullptr || !points->is_array()) reject("a list as 'points'", points);
    Polygon polygon;
    count_vertices(points->size());
    for (const PlanJson& point : *points)
      polygon.outline.emplace_back(number(point, "x"), number(point, "y"));
    Polygon::Ring& ring = polygon.outline;
    if (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
    if (ring.size() < 3) reject("three points or more", points);
    return polygon;
  }

  Polygon circle(const PlanJson& shape) {
    const PlanJson* const centre = member(shape, "center");
    if (centre == nullptr || !centre->is_object()) reject("an object as 'center'", centre);
    const double radius = number(shape, "radius");
    if (!(radius > 0)) reject("a number above 0 as 'radius'", member(shape, "radius"));
    count_vertices(kCircleCorners);
    ++circles_;
    const double angle = 2 * M_PI / kCircleCorners, outer = radius / std::cos(angle / 2);
    Polygon polygon;
    for (int i = 0; i < kCircleCorners; ++i)
      polygon.outline.emplace_back(number(*centre, "x") + outer * std::cos(i * angle),
                                   number(*centre, "y") + outer * std::sin(i * angle));
    return polygon;
  }

  void count_vertices(size_t count) {
    vertices_ += count;
    if (vertices_ > kMaxPlanVertices)
      throw InputError(file_, fmt::format("at most {} vertices in a plan", kMaxPlanVertices),
                       "more; simplify the plan");
  }

  void list_others(const PlanJson& topography) {
    for (const auto& [key, value] : topography.items()) {
      if (std::find(std::begin(kUsedKeys), std::end(kUsedKeys), key) != std::end(kUsedKeys))
        continue;
      const size_t count = value.is_array() ? value.size() : value.is_null() ? 0 : 1;
      if (count == 0) continue;
      const auto known =
          std::find_if(std::begin(kOtherLists), std::end(kOtherLists),
                       [&, &key = key](const VadereList& list) { return list.key == key; });
      const std::string what =
          known != std::end(kOtherLists) ? known->what : escaped(key).substr(0, 60);
      plan_.left_out.push_back(fmt::format("{}: {}", what, count));
    }
  }

  const std::string& file_;
  std::string place_ = "the file";
  ImportedPlan plan_;
  size_t vertices_ = 4, circles_ = 0;
  double end_s_ = kMaxScenarioNumber;         ///< end of the simulation
  std::map<std::string, bool> is_absorbing_;  ///< targets by their names
  size_t read_sources_ = 0, batches_ = 0, random_counts_ = 0, waits_ = 0;
  std::map<std::string, size_t> unread_sources_, unread_waits_;  ///< keys: kinds of distributions
  std::set<std::string> left_out_;                               ///< facts about people
};

}  // namespace

bool is_vadere_scenario(std::string_view head) {
  head.remove_prefix(std::min(head.find_first_not_of(" \t\r\n\xef\xbb\xbf"), head.size()));
  if (!head.starts_with('{')) return false;
  if (head.find("\"topography\"") != head.npos) return true;
  // Attributes of models, which may be long, precede the topography.
  return head.find("\"mainModel\"") != head.npos && head.find("\"attributesModel\"") != head.npos;
}

ImportedPlan read_vadere_scenario(const ImportOptions& options) {
  const RegularFile file(options.file, kExpectedScenario, kMaxPlanBytes);
  const SandboxedParser parser{.library = "the reader of scenarios",
                               .expected = kExpectedScenario,
                               .remedy = "save it again with Vadere"};
  const std::string name = options.file.string();
  return read_plan_sandboxed(file, parser, [&](const RegularFile& opened) {
    return VadereScenario(name).read(plan_text(opened, kExpectedScenario));
  });
}

}  // namespace throng
