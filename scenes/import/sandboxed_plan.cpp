// Sandboxed plans: a child process parses the file and sends the plan, or where it is wrong.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/errors.h"
#include "base/files/archive.h"
#include "base/text.h"
#include "scenes/file/key_tables.h"
#include "scenes/import/plan_readers.h"

namespace throng {
namespace {

constexpr size_t kMaxPlanText = 2000;
constexpr size_t kMaxPlanItems = kMaxPlanVertices;
constexpr double kMaxPlanNumber = 1e15;

/// An InputError of the child: the message is "where: expected ..., found ...".
struct PlanError {
  std::string where, expected, found;
};

/// Archives a plan. Archive itself has no texts and no lists of structs without archive().
class PlanArchive {
 public:
  explicit PlanArchive(Archive& archive) : archive_(archive) {}

  void text(std::string& value) {
    std::vector<uint8_t> bytes(value.begin(), value.end());
    archive_.resized(bytes, kMaxPlanText);
    value.assign(bytes.begin(), bytes.end());
  }
  void operator()(PlanError& error) {
    text(error.where);
    text(error.expected);
    text(error.found);
  }
  void operator()(ImportedPlan& plan) {
    text(plan.kind);
    list(plan.walkable, [&](Polygon& each) { polygon(each); });
    for (std::vector<NamedPolygon>* named : {&plan.obstacles, &plan.starts, &plan.goals})
      list(*named, [&](NamedPolygon& each) {
        text(each.name);
        polygon(each.polygon);
        list(each.goals, [&](std::string& goal) { text(goal); });
        optional(each.arrivals, [&](PlanArrivals& arrivals) {
          archive_(arrivals.count, arrivals.start_s, arrivals.rate_per_s, arrivals.is_poisson);
        });
        distribution(each.speed_mps);
        archive_(each.stays);
        distribution(each.wait_s);
      });
    list(plan.walls, [&](PlanWall& each) {
      text(each.name);
      archive_.resized(each.line_m, kMaxPlanItems);
      archive_(each.thickness_m);
    });
    optional(plan.unit_m, [&](double& unit_m) { archive_(unit_m); });
    optional(plan.duration_s, [&](double& duration_s) { archive_(duration_s); });
    distribution(plan.speed_mps);
    for (std::vector<std::string>* lines : {&plan.used, &plan.left_out})
      list(*lines, [&](std::string& each) { text(each); });
  }

 private:
  template <typename T, typename Each>
  void list(std::vector<T>& values, const Each& each) {
    uint64_t count = values.size();
    archive_(count);
    if (archive_.is_reading()) {
      if (count > kMaxPlanItems) archive_.reject("a plan", "one with too many parts");
      values.resize(static_cast<size_t>(count));
    }
    for (T& value : values) each(value);
  }
  template <typename T, typename Each>
  void optional(std::optional<T>& value, const Each& each) {
    bool is_there = value.has_value();
    archive_(is_there);
    if (is_there && !value) value.emplace();
    if (is_there) each(*value);
  }
  void distribution(std::optional<Distribution>& value) {
    optional(value,
             [&](Distribution& each) { archive_(each.mean, each.std_dev, each.min, each.max); });
  }
  void polygon(Polygon& polygon) {
    archive_.resized(polygon.outline, kMaxPlanItems);
    list(polygon.holes, [&](Polygon::Ring& hole) { archive_.resized(hole, kMaxPlanItems); });
  }

  Archive& archive_;
};

/// Checks a received plan as a file: the child may have sent anything.
class PlanCheck {
 public:
  PlanCheck(const ImportedPlan& plan, const Archive& archive) : archive_(archive) {
    line(plan.kind);
    for (const Polygon& each : plan.walkable) polygon(each);
    for (const auto* named : {&plan.obstacles, &plan.starts, &plan.goals})
      for (const NamedPolygon& each : *named) {
        name(each.name);
        polygon(each.polygon);
        for (const std::string& goal : each.goals) name(goal);
        if (each.arrivals) arrivals(*each.arrivals);
        distribution(each.speed_mps, kDesiredSpeedRange);
        distribution(each.wait_s, kTimeRange);
      }
    distribution(plan.speed_mps, kDesiredSpeedRange);
    expect(!plan.duration_s || (*plan.duration_s > 0 && *plan.duration_s <= kTimeRange.max),
           "a duration");
    for (const PlanWall& each : plan.walls) {
      name(each.name);
      points(each.line_m, 2);
      expect(std::isfinite(each.thickness_m) && each.thickness_m >= 0, "a wall's thickness");
    }
    expect(!plan.unit_m || (*plan.unit_m > 0 && *plan.unit_m <= kMaxPlanNumber), "a unit");
    for (const auto* lines : {&plan.used, &plan.left_out})
      for (const std::string& each : *lines) line(each);
  }

 private:
  void expect(bool is_kept, const std::string& what) const {
    if (!is_kept) archive_.reject(what, "another value");
  }
  void name(const std::string& text) const { expect(defect_of_name(text).empty(), "a name"); }
  void line(const std::string& text) const {
    expect(find_invalid_utf8(text) == std::string::npos && text.find('\n') == std::string::npos,
           "a line of text");
  }
  void arrivals(const PlanArrivals& each) const {
    expect(each.count >= 0 && each.count <= kMaxBodies, "a number of agents");
    expect(each.start_s >= kTimeRange.min && each.start_s <= kTimeRange.max, "a time");
    expect(each.rate_per_s >= 0 && each.rate_per_s <= kRateRange.max, "a rate");
  }
  void distribution(const std::optional<Distribution>& each, const Range& range) const {
    expect(!each || (each->min >= range.min && each->min <= each->mean && each->mean <= each->max &&
                     each->max <= range.max && each->std_dev >= 0 && each->std_dev <= range.max),
           "a distribution");
  }
  void polygon(const Polygon& polygon) {
    points(polygon.outline, 3);
    for (const Polygon::Ring& hole : polygon.holes) points(hole, 3);
  }
  void points(const std::vector<Eigen::Vector2d>& line, size_t min_count) {
    vertices_ += line.size();
    expect(line.size() >= min_count, "at least three vertices");
    for (const Eigen::Vector2d& point : line)
      expect(point.cwiseAbs().maxCoeff() <= kMaxPlanNumber, "coordinates within 1e15");
    if (vertices_ > kMaxPlanVertices)
      archive_.reject(fmt::format("at most {} vertices in a plan", kMaxPlanVertices),
                      "more; simplify the plan");
  }

  const Archive& archive_;
  size_t vertices_ = 0;
};

/// Splits the message of an InputError at its first ", found ".
PlanError plan_error(const InputError& error) {
  constexpr std::string_view kExpected = ": expected ", kFound = ", found ";
  const std::string_view message = error.what();
  const std::string_view rest =
      message.substr(std::min(error.where().size() + kExpected.size(), message.size()));
  const size_t found = std::min(rest.find(kFound), rest.size());
  return {error.where(), std::string(rest.substr(0, found)),
          std::string(rest.substr(std::min(found + kFound.size(), rest.size())))};
}

std::vector<uint8_t> reply_of(const RegularFile& file,
                              const std::function<ImportedPlan(const RegularFile&)>& parse) {
  Archive out;
  PlanArchive plan_out(out);
  bool is_plan = true;
  try {
    ImportedPlan plan = parse(file);
    out(is_plan);
    plan_out(plan);
  } catch (const InputError& error) {
    is_plan = false;
    PlanError refusal = plan_error(error);
    for (std::string* part : {&refusal.where, &refusal.expected, &refusal.found})
      *part = part->substr(0, kMaxPlanText);
    out(is_plan);
    plan_out(refusal);
  }
  return out.bytes();
}

}  // namespace

std::string plan_bytes(const RegularFile& file) {
  const std::vector<uint8_t> bytes = file.bytes();
  return {bytes.begin(), bytes.end()};
}

std::string plan_text(const RegularFile& file, std::string_view expected) {
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  std::string text = plan_bytes(file);
  if (const size_t at = find_invalid_utf8(text); at != std::string::npos)
    throw ParseFailure(fmt::format("{} in UTF-8", expected),
                       in_quotes(std::string_view(text).substr(at, 10)));
  if (text.starts_with(kByteOrderMark)) text.erase(0, kByteOrderMark.size());
  return text;
}

ImportedPlan read_plan_sandboxed(const RegularFile& file, const SandboxedParser& parser,
                                 const std::function<ImportedPlan(const RegularFile&)>& parse,
                                 uint64_t max_bytes) {
  // A larger file is a database, which is not read as a whole, or an image, which has no structure.
  const SandboxLimits limits{.max_file_bytes = max_bytes,
                             .memory_per_file_byte = max_bytes > kMaxPlanBytes ? 1u : 32u,
                             .max_result_bytes = 64 << 20};
  std::vector<uint8_t> received;
  parse_sandboxed_in_pieces(
      file, parser, limits,
      [&](const RegularFile& opened, const SendPiece& send) { send(reply_of(opened, parse)); },
      [&](std::span<const uint8_t> piece) {
        received.insert(received.end(), piece.begin(), piece.end());
      });
  Archive in(received, file.path().string());
  PlanArchive plan_in(in);
  bool is_plan = false;
  in(is_plan);
  if (!is_plan) {
    PlanError error;
    plan_in(error);
    throw InputError(escaped(error.where), escaped(error.expected), escaped(error.found));
  }
  ImportedPlan plan;
  plan_in(plan);
  in.expect_end();
  PlanCheck(plan, in);
  return plan;
}

}  // namespace throng
