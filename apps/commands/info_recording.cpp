#include <fmt/format.h>

#include <iterator>

#include "apps/commands/info.h"
#include "base/text.h"
#include "geometry/polygon_union.h"
#include "recordings/recording_summary.h"

namespace throng {
namespace {

class FactLines {
 public:
  template <typename... Args>
  void line(std::string_view what, fmt::format_string<Args...> format, Args&&... args) {
    fmt::format_to(std::back_inserter(text_), "  {:<10} {}\n", what,
                   fmt::format(format, std::forward<Args>(args)...));
  }
  void head(const std::string& line) { text_ += line + '\n'; }
  std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

void add_time(FactLines& lines, const RecordingFacts& facts) {
  if (facts.fps == 0) {
    lines.line("time", "{:.6g} s, positions at any time", facts.duration_s);
    return;
  }
  std::string numbers;
  if (facts.first_frame != 0 || facts.frame_step > 1)
    numbers = fmt::format(", numbered {} to {}", facts.first_frame,
                          facts.first_frame + (facts.frames - 1) * facts.frame_step);
  if (facts.frame_step > 1) numbers += fmt::format(" by {}", facts.frame_step);
  lines.line("time", "{:.6g} s, {} frames at {:.6g} per second{}", facts.duration_s, facts.frames,
             facts.fps, numbers);
}

void add_area(FactLines& lines, const RecordingFacts& facts, const std::string& file) {
  const Rectangle& b = facts.bounds;
  lines.line("area", "({:.2f}, {:.2f}) to ({:.2f}, {:.2f}) m, {:.1f} m2", b.min_m.x(), b.min_m.y(),
             b.max_m.x(), b.max_m.y(), b.area_m2());
  if (!facts.shift_m.isZero())
    lines.line("shifted", "by ({:.0f}, {:.0f}) m from the file's coordinates", facts.shift_m.x(),
               facts.shift_m.y());
  if (facts.wkt.empty()) return;
  size_t edges = 0, holes = 0;
  const std::vector<Polygon> polygons = recorded_area(facts, file).polygons;
  for (const Polygon& polygon : polygons) {
    edges += polygon.outline.size();
    holes += polygon.holes.size();
    for (const Polygon::Ring& hole : polygon.holes) edges += hole.size();
  }
  lines.line("walls", "{} around {} with {}", counted(edges, "edge"),
             counted(polygons.size(), "walkable area"), counted(holes, "hole"));
}

}  // namespace

std::string describe_recording(const Recording& recording, const std::string& file) {
  const RecordingFacts& facts = recording.facts();
  const std::vector<RecordedPerson>& people = recording.people();
  const RecordingSummary summary = summary_of(recording);
  FactLines lines;
  lines.head(fmt::format("{}: a recording, {}", file, facts.kind));
  lines.line("tracks", "{} (override with --tracked-point {})",
             facts.tracked_point == TrackedPoint::kHead ? "heads" : "centres of bodies",
             facts.tracked_point == TrackedPoint::kHead ? "centre" : "head");
  lines.line("people", "{}, ids {} to {}; {:.0f} at once on average, at most {} (at {:.0f} s)",
             people.size(), people.front().id, people.back().id, summary.mean_people,
             summary.max_people, summary.max_people_at_s);
  add_time(lines, facts);
  lines.line("positions", "{}, {:.0f} per person", facts.samples,
             static_cast<double>(facts.samples) / static_cast<double>(people.size()));
  add_area(lines, facts, file);
  if (summary.heights > 0)
    lines.line("heights", "{:.2f} m, 90 % from {:.2f} to {:.2f}; {} of {} people have one",
               summary.height_m.median, summary.height_m.low, summary.height_m.high,
               summary.heights, people.size());
  else
    lines.line("heights", "none");
  lines.line("headings", "{}", facts.has_headings ? "from the file" : "none");
  lines.line("speeds", "{:.2f} m/s over a second, 90 % from {:.2f} to {:.2f}",
             summary.speed_mps.median, summary.speed_mps.low, summary.speed_mps.high);
  lines.line("densities",
             "{:.2f} per m2 within {:g} m, 90 % from {:.2f} to {:.2f}; walls not "
             "counted",
             summary.density_per_m2.median, kDensityRadius_m, summary.density_per_m2.low,
             summary.density_per_m2.high);
  lines.line("anomalies", "{}", facts.anomalies.empty() ? "none" : "");
  for (const Anomaly& anomaly : facts.anomalies)
    lines.head(fmt::format("    {:>6} {}\n           first {}", anomaly.count, anomaly.what,
                           anomaly.first));
  return lines.take();
}

}  // namespace throng
