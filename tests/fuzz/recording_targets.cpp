// Fuzz targets for recordings, walkable areas and floor plans.
#include <cmath>

#include "base/errors.h"
#include "geometry/polygon_union.h"
#include "geometry/wkt.h"
#include "recordings/recording.h"
#include "scenes/file/yaml_tree.h"
#include "scenes/import/imported_plan.h"
#include "tests/fuzz/target_tools.h"
#include "tests/fuzz/targets.h"

namespace throng::fuzz {
namespace {

RecordingOptions options_of(uint8_t bits) {
  RecordingOptions out;
  if (bits & 1) out.fps = 25;
  if (bits & 2) out.unit_m = 0.01;
  if (bits & 4) out.columns = "id=1,frame=2,x=3,y=4";
  if (bits & 8) out.separator = ';';
  if (bits & 16) out.start_s = 0.1;
  if (bits & 32) out.tracked_point = TrackedPoint::kHead;
  if (bits & 64) out.strict = true;
  return out;
}

void expect_sound(const Recording& recording) {
  const RecordingFacts& facts = recording.facts();
  int64_t samples = 0;
  std::vector<Sample> track;
  int64_t last_id = -1;
  for (size_t person = 0; person < recording.people().size(); ++person) {
    const RecordedPerson& each = recording.people()[person];
    promise(each.id > last_id, "ascending ids");
    last_id = each.id;
    recording.read(person, track);
    samples += each.samples;
    promise(!track.empty() && static_cast<int64_t>(track.size()) == each.samples,
            "as many samples as announced");
    double last_s = -1;
    for (const Sample& sample : track) {
      promise(sample.time_s > last_s && sample.time_s >= 0, "ascending times from 0");
      last_s = sample.time_s;
      promise(facts.bounds.contains(sample.position_m), "positions within the bounds");
    }
    promise(track.front().time_s == each.first_s && last_s == each.last_s,
            "times of the first and the last sample");
  }
  promise(samples == facts.samples && samples > 0, "samples of all people");
  promise(facts.bounds.size_m().maxCoeff() <= 20'001, "people in one place");
  promise(facts.fps >= 0 && std::isfinite(facts.fps) && facts.duration_s <= 1.1e7,
          "a rate and a duration");
}

}  // namespace

bool recording(std::span<const uint8_t> input) {
  if (input.empty()) return false;
  const File file("recording", input.subspan(1));
  RecordingOptions options = options_of(input[0]);
  options.file = file.path();
  try {
    expect_sound(*read_recording(options));
    promise(!options.columns.empty() || is_recording(file.path()), "a recognised kind");
    return true;
  } catch (const InputError& error) {
    expect_words(error);
    return false;
  }
}

bool wkt(std::span<const uint8_t> input) {
  try {
    const std::vector<Polygon> polygons = parse_wkt(text_of(input), "fuzz.wkt");
    const PolygonLocator area(polygons);
    promise(!polygons.empty(), "a polygon");
    for (const Eigen::Vector2d& vertex : polygons.front().outline)
      promise(area.contains(vertex), "an outline that is part of the area");
    for (const Polygon& polygon : join(polygons, "fuzz.wkt").polygons)
      promise(polygon.outline.size() >= 3, "polygons of a union with an outline");
    return true;
  } catch (const InputError& error) {
    expect_words(error);
    return false;
  }
}

bool plan(std::span<const uint8_t> input) {
  if (input.empty()) return false;
  const File file("plan", input.subspan(1));
  ImportOptions options{.file = file.path(), .layers = {}, .unit_m = {}};
  if (input[0] & 1) options.unit_m = 1;
  if (input[0] & 2) options.layers = {{"walkable", {"floor"}}, {"walls", {"0"}}};
  try {
    const ImportedPlan read = import_plan(options);
    const std::optional<Rectangle> bounds = plan_bounds(read);
    promise(bounds && bounds->min_m.allFinite() && bounds->size_m().maxCoeff() <= 20'001,
            "a plan with a size");
    for (const Polygon& area : read.walkable)
      promise(area.outline.size() >= 3 && doubled_area(area.outline) != 0, "areas with an extent");
    for (const PlanWall& wall : read.walls) promise(wall.line_m.size() >= 2, "walls with a length");
    const std::string text = scene_text_of(read, "plan");
    if (text.size() <= kMaxYamlBytes)
      promise(!parse_yaml(text, "scene").entries.empty(), "a scene in YAML");
    return true;
  } catch (const InputError& error) {
    expect_words(error);
    return false;
  }
}

}  // namespace throng::fuzz
