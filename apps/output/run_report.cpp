#include "apps/output/run_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "apps/process/machine.h"
#include "base/text.h"
#include "bench/version_json.h"

namespace throng {
namespace {

using Json = nlohmann::ordered_json;

double per(double total, uint64_t count) {
  return count == 0 ? 0 : total / static_cast<double>(count);
}

std::string hash_text(uint64_t hash) { return fmt::format("{:016x}", hash); }

std::string megabytes(double bytes) { return fmt::format("{:.1f} MB", bytes * 1e-6); }

/// "body_box" becomes "body box".
std::string in_words(std::string_view name) {
  std::string text(name);
  std::replace(text.begin(), text.end(), '_', ' ');
  return text;
}

void add_stage(std::string& text, std::string_view name, const StageCounters& stage,
               int64_t frames) {
  if (stage.updates == 0 && stage.tests == 0) return;
  append(text, "{:<11} {:<9} {:>11} {:>12} {:>11} {:>10.1f} {:>8.1f} {:>9.3f}\n", in_words(name),
         stage.volume, stage.updates, stage.tests, stage.passed,
         per(stage.update_ns, stage.updates), per(stage.test_ns, stage.tests),
         per((stage.update_ns + stage.test_ns) * 1e-6, static_cast<uint64_t>(frames)));
}

void add_stage_table(std::string& text, const RunSummary& summary) {
  append(text, "{:<11} {:<9} {:>11} {:>12} {:>11} {:>10} {:>8} {:>9}\n", "stage", "volume",
         "updates", "tests", "passed", "ns/update", "ns/test", "ms/frame");
  const auto stages = culling_stages(summary.totals);
  for (size_t i = 0; i < stages.size(); ++i)
    add_stage(text, kCullingStageNames[i], *stages[i], summary.frames);
}

void add_time_table(std::string& text, const RunSummary& summary) {
  std::string names = fmt::format("{:<11}", "ms/frame"), times = fmt::format("{:<11}", "median");
  for (size_t i = 0; i < kStageCount; ++i) {
    const std::string name = in_words(kStageNames[i]);
    const size_t width = std::max<size_t>(name.size(), 7);
    names += fmt::format(" {:>{}}", name, width);
    times += fmt::format(" {:>{}.3f}", summary.stage_ms[i], width);
  }
  text += names + '\n' + times + '\n';
}

Json to_json(const StageCounters& stage) {
  return {{"volume", stage.volume},
          {"updates", stage.updates},
          {"tests", stage.tests},
          {"passed", stage.passed},
          {"update_ns", per(stage.update_ns, stage.updates)},
          {"test_ns", per(stage.test_ns, stage.tests)}};
}

Json stage_ms_json(const RunSummary& summary) {
  Json json;
  for (size_t i = 0; i < kStageCount; ++i) json[std::string(kStageNames[i])] = summary.stage_ms[i];
  return json;
}

Json stages_json(const RunSummary& summary) {
  Json json;
  const auto stages = culling_stages(summary.totals);
  for (size_t i = 0; i < stages.size(); ++i)
    json[std::string(kCullingStageNames[i])] = to_json(*stages[i]);
  return json;
}

int stranded(const RunReport& report) {
  int people = 0;
  for (const RunReport::Stranded& each : report.stranded) people += each.people;
  return people;
}

Json people_json(const RunReport& report) {
  const RunSummary& summary = report.summary;
  const PopulationCounters& population = summary.population;
  return {{"entered", population.entered},
          {"present", population.present},
          {"left", population.left},
          {"waiting", population.waiting_to_enter},
          {"scheduled", population.scheduled},
          {"stranded", stranded(report)},
          {"queuing_peak", summary.queuing_peak},
          {"longest_stall_s", summary.longest_stall_s},
          {"max_overlap_m", summary.max_overlap_m}};
}

std::string people_text(const PopulationCounters& population) {
  return fmt::format("{} entered, {} left, {} present; {} waiting to enter, {} scheduled",
                     population.entered, population.left, population.present,
                     population.waiting_to_enter, population.scheduled);
}

Json stranded_json(const RunReport& report) {
  Json groups = Json::array();
  for (const RunReport::Stranded& each : report.stranded)
    groups.push_back({{"group", each.group}, {"goal", each.goal}, {"people", each.people}});
  return {{"people", stranded(report)}, {"groups", groups}};
}

std::string stranded_text(const RunReport& report) {
  const int people = stranded(report);
  std::string text = fmt::format("{} cannot reach a goal", counted(people, "person", "people"));
  const char* between = ": ";
  for (const RunReport::Stranded& each : report.stranded) {
    text += fmt::format("{}{} of group '{}' goal {}", between, each.people, each.group, each.goal);
    between = ", ";
  }
  return text;
}

/// Names of PairLevel in JSON.
constexpr std::array<const char*, kPairLevels> kLevels = {"sphere", "box", "part_volume",
                                                          "triangles"};

Json budget_json(const RunReport& report) {
  Json json;
  if (report.budget_ms) json["ms"] = *report.budget_ms;
  if (report.budget_tests) json["tests"] = *report.budget_tests;
  json["frames_cut"] = report.summary.frames_cut;
  for (size_t level = 0; level < kPairLevels; ++level)
    json["pairs"][kLevels[level]] = report.summary.totals.levels[level];
  return json;
}

std::string budget_text(const RunReport& report) {
  const RunSummary& summary = report.summary;
  std::string text = "at most ";
  if (report.budget_ms) text += fmt::format("{} ms", *report.budget_ms);
  if (report.budget_ms && report.budget_tests) text += " and ";
  if (report.budget_tests) text += fmt::format("{} tests", *report.budget_tests);
  text += fmt::format(" per frame: {} of {} frames cut; pairs reported by", summary.frames_cut,
                      summary.frames);
  const std::array<std::string_view, kPairLevels> by = {
      "spheres", "boxes", summary.totals.part_volume.volume, "triangles"};
  for (size_t level = 0; level < kPairLevels; ++level)
    if (summary.totals.levels[level] > 0)
      text += fmt::format(" {} {},", by[level], summary.totals.levels[level]);
  if (text.back() == ',') text.pop_back();
  return text;
}

Json proximity_json(const ProximitySummary& proximity) {
  return {{"pairs", proximity.pairs},
          {"closest_parts", proximity.closest_parts},
          {"pairs_peak", proximity.pairs_peak},
          {"min_distance_m", proximity.min_distance_m},
          {"ms",
           {{"median", proximity.ms.median}, {"p95", proximity.ms.p95}, {"max", proximity.ms.max}}},
          {"hash", hash_text(proximity.hash)}};
}

std::string proximity_text(const ProximitySummary& proximity) {
  return fmt::format(
      "{} rows of parts, {} of closest parts; at most {} at once, least distance {:.3f} m; {:.2f} "
      "ms per frame (hash {})",
      proximity.pairs, proximity.closest_parts, proximity.pairs_peak, proximity.min_distance_m,
      proximity.ms.median, hash_text(proximity.hash));
}

Json points_json(const RunSummary& summary) {
  const ContactPointSummary& points = summary.contact_points;
  return {{"points", points.points},
          {"points_peak", points.points_peak},
          {"max_depth_m", points.max_depth_m},
          {"median_ms", summary.proximity.ms.median}};
}

std::string points_text(const RunSummary& summary) {
  const ContactPointSummary& points = summary.contact_points;
  return fmt::format("{} of contact; at most {} at once, depth up to {:.3f} m; {:.2f} ms per frame",
                     points.points, points.points_peak, points.max_depth_m,
                     summary.proximity.ms.median);
}

Json contacts_json(const RunReport::Contacts& contacts) {
  const ContactTotals& totals = contacts.totals;
  return {{"folder", contacts.folder},
          {"people", totals.contacts},
          {"obstacles", totals.obstacle_contacts},
          {"people_touched", totals.people_touched},
          {"per_person_min", totals.per_person_min()},
          {"contact_time_share", totals.touching_s / std::max(1e-9, totals.person_s)},
          {"median_s", totals.median_s}};
}

std::string contacts_text(const RunReport::Contacts& contacts) {
  const ContactTotals& totals = contacts.totals;
  return fmt::format(
      "{}: {} between two people, {:.2f} per person and minute, median {:.3f} s; {} with obstacles",
      contacts.folder, totals.contacts, totals.per_person_min(), totals.median_s,
      totals.obstacle_contacts);
}

Json separation_json(const RunReport::Separation& separation) {
  const SeparationTotals& totals = separation.totals;
  Json regions = Json::object();
  for (size_t i = 0; i < kBodyRegions; ++i) {
    const RegionTotals& region = totals.regions[i];
    if (!region.is_there) continue;
    const bool is_far = region.min_distance_lo_m == RegionSeparation::kFar;
    regions[std::string(name_of(static_cast<BodyRegion>(i)))] = {
        {"shortfalls", region.shortfalls},
        {"shortfall_s", region.shortfall_s},
        {"max_shortfall_m", region.max_shortfall_m},
        {"min_distance_lo_m", is_far ? Json() : Json(region.min_distance_lo_m)},
        {"min_distance_hi_m", is_far ? Json() : Json(region.min_distance_hi_m)}};
  }
  return {{"folder", separation.folder},
          {"robots", totals.robots},
          {"shortfalls", totals.shortfalls},
          {"pairs", totals.pairs},
          {"undetermined", totals.undetermined},
          {"beyond_margin", totals.beyond_margin},
          {"regions", regions}};
}

std::string separation_text(const SeparationTotals& totals) {
  size_t worst = 0;
  for (size_t i = 1; i < kBodyRegions; ++i)
    if (totals.regions[i].shortfall_s > totals.regions[worst].shortfall_s) worst = i;
  std::string text = fmt::format("{} shortfalls", totals.shortfalls);
  if (totals.shortfalls > 0)
    text += fmt::format(", longest for {} ({:.2f} s, at most {:.3f} m)",
                        name_of(static_cast<BodyRegion>(worst)), totals.regions[worst].shortfall_s,
                        totals.regions[worst].max_shortfall_m);
  text += fmt::format("; {} pairs of parts, {} without a speed", totals.pairs, totals.undetermined);
  if (totals.beyond_margin > 0)
    text += fmt::format(", {} require more than the margin", totals.beyond_margin);
  return text;
}

/// " (REASON)", or "".
std::string in_brackets(const std::string& reason) {
  return reason.empty() ? "" : " (" + reason + ")";
}

Json changes_json(const CrowdChangeReceiver::Counts& changes) {
  return {{"channel", changes.channel},
          {"messages", changes.messages},
          {"missing", changes.missing},
          {"rejected", changes.rejected},
          {"rejection", changes.rejection}};
}

std::string changes_text(const CrowdChangeReceiver::Counts& changes) {
  return fmt::format("by {}: {} messages, {} missing, {} rejected{}", changes.channel,
                     changes.messages, changes.missing, changes.rejected,
                     in_brackets(changes.rejection));
}

Json external_json(const PoseCommandReceiver::Counts& group) {
  return {{"group", group.group},
          {"channel", group.channel},
          {"messages", group.messages},
          {"frames", group.frames},
          {"frames_without_command", group.frames_without_command},
          {"missing", group.missing},
          {"late", group.late},
          {"restarts", group.restarts},
          {"rejected", group.rejected},
          {"rejection", group.rejection},
          {"clamped", group.clamped}};
}

std::string external_text(const PoseCommandReceiver::Counts& group) {
  return fmt::format(
      "{} by {}: {} messages, {} missing, {} late, {} rejected{}; {} of {} frames without a "
      "command; {} values out of range; {} restarts",
      group.group, group.channel, group.messages, group.missing, group.late, group.rejected,
      in_brackets(group.rejection), group.frames_without_command, group.frames, group.clamped,
      group.restarts);
}

Json lockstep_json(const RunReport::LockstepReport& lockstep) {
  Json groups = Json::array();
  for (const Lockstep::Counts& group : lockstep.groups)
    groups.push_back({{"group", group.group},
                      {"channel", group.channel},
                      {"requests", group.requests},
                      {"replies", group.replies},
                      {"late", group.late},
                      {"repeated", group.repeated},
                      {"other_runs", group.other_runs},
                      {"rejected", group.rejected},
                      {"rejection", group.rejection},
                      {"clamped", group.clamped}});
  return {{"timeout_s", lockstep.timeout_s},
          {"total_wait_s", lockstep.total_wait_s},
          {"max_wait_s", lockstep.max_wait_s},
          {"failure", lockstep.failure},
          {"groups", groups}};
}

std::string lockstep_text(const Lockstep::Counts& group) {
  return fmt::format(
      "{} by {}: {} replies, {} late, {} repeated, {} to other runs, {} rejected{}; {} values out "
      "of range",
      group.group, group.channel, group.replies, group.late, group.repeated, group.other_runs,
      group.rejected, in_brackets(group.rejection), group.clamped);
}

Json pace_json(const RunReport::Pace& pace) {
  return {{"factor", pace.factor},
          {"late_frames", pace.late_frames},
          {"worst_ms", pace.worst_s * 1e3},
          {"behind_ms", pace.behind_s * 1e3}};
}

std::string pace_text(const RunReport::Pace& pace, int64_t frames) {
  return fmt::format(
      "{:g} times real time requested; {} of {} frames late, at most {:.0f} ms, the last {:.0f} ms",
      pace.factor, pace.late_frames, frames, pace.worst_s * 1e3, pace.behind_s * 1e3);
}

Json steering_json(const RunReport& report) {
  const RunSummary& summary = report.summary;
  return {
      {"model", name_of(report.steering.model)},
      {"density_dependent_speed", report.steering.density_dependent_speed},
      {"longest_stall_s", summary.longest_stall_s},
      {"max_overlap_m", summary.max_overlap_m},
      {"mean_heading_rate_radps", summary.steering.mean_heading_rate_radps()},
      {"sweeps", {{"mean", summary.steering.mean_sweeps()}, {"max", summary.steering.max_sweeps}}}};
}

std::string walking_text(const RunSummary& summary) {
  return fmt::format(
      "longest stall {:.1f} s, largest overlap {:.1f} cm ({:.1f} sweeps, at most {}), heading rate "
      "{:.2f} rad/s",
      summary.longest_stall_s, 100 * summary.max_overlap_m, summary.steering.mean_sweeps(),
      summary.steering.max_sweeps, summary.steering.mean_heading_rate_radps());
}

std::string lcm_text(const RunReport::Lcm& lcm) {
  if (lcm.url == "off") return "off";
  return fmt::format("{}: {}, {}, {} dropped", lcm.url, counted(lcm.messages, "message"),
                     megabytes(static_cast<double>(lcm.bytes)), lcm.dropped);
}

Json channel_json(const FilteredChannels::PublishedTotals& published) {
  return {{"who", published.to.who},    {"channel", published.to.channel},
          {"bodies", published.bodies}, {"messages", published.messages},
          {"events", published.events}, {"proximity_rows", published.proximity_rows}};
}

std::string channel_text(const FilteredChannels::PublishedTotals& published) {
  return fmt::format("{} by {}: {} bodies, {} messages, {} events, {} proximity rows",
                     published.to.who, published.to.channel, published.bodies, published.messages,
                     published.events, published.proximity_rows);
}

Json recording_json(const RunReport::Recording& recording) {
  Json json = {{"kind", recording.facts.kind},
               {"people", recording.people},
               {"frames", recording.facts.frames},
               {"fps", recording.facts.fps},
               {"shift_m", {recording.facts.shift_m.x(), recording.facts.shift_m.y()}},
               {"anomalies", Json::array()}};
  for (const Anomaly& anomaly : recording.facts.anomalies)
    json["anomalies"].push_back(
        {{"kind", anomaly.what}, {"count", anomaly.count}, {"first", anomaly.first}});
  return json;
}

Json to_json(const RunReport& report) {
  const RunSummary& summary = report.summary;
  Json json;
  json["throng"] = version_json();
  json["scene"] = report.scene;
  json["seed"] = report.seed;
  json["avatars"] = summary.avatars;
  json["unplaced"] = summary.unplaced;
  json["people"] = people_json(report);
  json["stranded"] = stranded_json(report);
  json["scaling"] = {{"factor", report.scale_factor},
                     {"ground_m", {report.ground_m.x(), report.ground_m.y()}}};
  json["notes"] = report.notes;
  if (report.recording) json["recording"] = recording_json(*report.recording);
  json["parts"] = summary.parts;
  json["frames"] = summary.frames;
  json["stopped_early"] = summary.stopped_early;
  json["step_s"] = report.step_s;
  json["threads"] = report.threads;
  json["wall_s"] = summary.wall_s;
  json["realtime_factor"] = summary.realtime_factor;
  if (const auto& changes = report.crowd_changes) json["crowd_changes"] = changes_json(*changes);
  for (const PoseCommandReceiver::Counts& group : report.external_control)
    json["external_control"].push_back(external_json(group));
  if (report.lockstep) json["lockstep"] = lockstep_json(*report.lockstep);
  if (report.pace.factor > 0) json["pace"] = pace_json(report.pace);
  json["frame_ms"] = {{"median", summary.frame_ms.median},
                      {"p95", summary.frame_ms.p95},
                      {"max", summary.frame_ms.max}};
  json["cull_ms"] = {{"median", summary.cull_ms.median}};
  json["stage_ms"] = stage_ms_json(summary);
  json["stages"] = stages_json(summary);
  json["steering"] = steering_json(report);
  json["events"] = {
      {"begin", summary.begins}, {"persist", summary.persists}, {"end", summary.ends}};
  json["pairs_peak"] = summary.pairs_peak;
  if (report.budget_ms || report.budget_tests) json["budget"] = budget_json(report);
  if (summary.proximity.is_enabled) json["proximity"] = proximity_json(summary.proximity);
  if (summary.contact_points.is_enabled) json["contact_points"] = points_json(summary);
  json["hash"] = hash_text(summary.hash);
  json["run_id"] = hash_text(summary.run_id);
  json["lcm"] = {{"url", report.lcm.url},
                 {"messages", report.lcm.messages},
                 {"bytes", report.lcm.bytes},
                 {"dropped", report.lcm.dropped}};
  for (const FilteredChannels::PublishedTotals& published : report.filtered_channels)
    json["filtered_channels"].push_back(channel_json(published));
  json["log"] = {{"file", report.log}, {"bytes", report.log_bytes}};
  if (report.contacts) json["contacts"] = contacts_json(*report.contacts);
  if (report.separation) json["separation"] = separation_json(*report.separation);
  json["peak_rss_bytes"] = peak_rss_bytes();
  json["machine"] = {{"cpu", cpu_name()}, {"simd", report.simd}};
  return json;
}

}  // namespace

std::string format_table(const RunReport& report) {
  const RunSummary& summary = report.summary;
  std::string text = fmt::format("{}: {}, {}, {} of {:.4g} ms\n\n", report.scene,
                                 counted(summary.avatars, "avatar"), counted(summary.parts, "part"),
                                 counted(summary.frames, "frame"), report.step_s * 1e3);
  add_stage_table(text, summary);
  text += '\n';
  add_time_table(text, summary);
  const auto line = [&text](const char* name, const std::string& what) {
    append(text, "{:<9} {}\n", name, what);
  };
  text += '\n';
  line("frame", fmt::format("{:.3f} ms median, {:.3f} p95, {:.3f} max; culling {:.3f} median",
                            summary.frame_ms.median, summary.frame_ms.p95, summary.frame_ms.max,
                            summary.cull_ms.median));
  line("time", fmt::format("{:.2f} s simulated in {:.2f} s: {:.1f} times real time ({}, {})",
                           summary.simulated_s, summary.wall_s, summary.realtime_factor,
                           counted(report.threads, "thread"), report.simd));
  const PopulationCounters& population = summary.population;
  if (population.left + population.waiting_to_enter + population.scheduled > 0)
    line("people", people_text(population));
  line("stranded", stranded_text(report));
  if (const auto& changes = report.crowd_changes) line("changes", changes_text(*changes));
  for (const PoseCommandReceiver::Counts& group : report.external_control)
    line("external", external_text(group));
  if (report.lockstep) {
    for (const Lockstep::Counts& group : report.lockstep->groups)
      line("lockstep", lockstep_text(group));
    line("waited", fmt::format("{:.2f} s for replies, at most {:.3f} s per frame",
                               report.lockstep->total_wait_s, report.lockstep->max_wait_s));
  }
  if (report.pace.factor > 0) line("pace", pace_text(report.pace, summary.frames));
  line("events", fmt::format("{} begin, {} persist, {} end; at most {} at once", summary.begins,
                             summary.persists, summary.ends, counted(summary.pairs_peak, "pair")));
  if (report.budget_ms || report.budget_tests) line("budget", budget_text(report));
  if (summary.proximity.is_enabled) line("proximity", proximity_text(summary.proximity));
  if (summary.contact_points.is_enabled) line("points", points_text(summary));
  if (summary.steering.rounds > 0) line("walking", walking_text(summary));
  line("log", report.log == "off" ? "off"
                                  : fmt::format("{}, {}", report.log,
                                                megabytes(static_cast<double>(report.log_bytes))));
  line("lcm", lcm_text(report.lcm));
  for (const FilteredChannels::PublishedTotals& published : report.filtered_channels)
    line("published", channel_text(published));
  if (report.contacts) line("contacts", contacts_text(*report.contacts));
  if (report.separation) line("separated", separation_text(report.separation->totals));
  line("hash", hash_text(summary.hash));
  return text;
}

std::string json_text(const RunReport& report) {
  // Paths of the command line may be invalid UTF-8.
  return to_json(report).dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace throng
