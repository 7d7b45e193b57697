#include "analysis/separation/separation_sink.h"

#include <fmt/format.h>

#include <algorithm>

#include "analysis/part_names.h"
#include "base/text.h"
#include "scenes/run/runner.h"

namespace throng {

SeparationHistory::SeparationHistory(const RunInfo& run, int64_t frames)
    : step_s_(run.step_s),
      proximity_m_(run.culler.proximity.margin_m),
      frames_per_point_(std::max<int64_t>(1, (frames + kPoints - 1) / kPoints)),
      index_(run.model_of_avatar.size(), -1) {}

void SeparationHistory::add(int64_t frame, std::span<const RegionSeparation> rows) {
  if (first_frame_ < 0) first_frame_ = frame;
  const auto point = static_cast<size_t>((frame - first_frame_) / frames_per_point_);
  points_ = std::max(points_, point + 1);
  for (const RegionSeparation& row : rows) {
    if (row.is_far()) continue;
    int32_t& index = index_[row.robot];
    if (index < 0) {
      index = static_cast<int32_t>(robots_.size());
      robots_.push_back(std::make_unique<Robot>());
      ids_.push_back(row.robot);
    }
    Robot& robot = *robots_[static_cast<size_t>(index)];
    robot.short_frames += row.people_too_close > 0;
    robot.min_distance_m = std::min(robot.min_distance_m, row.lo_m);
    std::vector<Point>& points = robot.regions[static_cast<size_t>(row.region)];
    if (points.size() <= point) points.resize(point + 1);
    Point& now = points[point];
    if (row.lo_m < now.lo_m) {
      now.lo_m = row.lo_m;
      now.required_m = row.required_m;
    }
    now.is_short |= row.people_too_close > 0;
  }
}

bool SeparationHistory::has_figure() const { return !robots_.empty(); }

size_t SeparationHistory::worst() const {
  size_t worst = 0;
  const auto rank = [&](size_t i) {
    return std::tuple(0 - static_cast<double>(robots_[i]->short_frames), robots_[i]->min_distance_m,
                      ids_[i]);
  };
  for (size_t i = 1; i < robots_.size(); ++i)
    if (rank(i) < rank(worst)) worst = i;
  return worst;
}

Figure SeparationHistory::figure(const RunInfo& run, const SeparationTotals& totals) const {
  const size_t which = worst();
  const Robot& robot = *robots_[which];
  const double from_s = static_cast<double>(first_frame_) * step_s_;
  const double point_s = static_cast<double>(frames_per_point_) * step_s_;
  float axis_max_m = proximity_m_;
  std::string data;
  std::vector<size_t> shown;
  for (size_t region = 0; region < kBodyRegions; ++region) {
    if (!totals.regions[region].is_there) continue;
    shown.push_back(region);
    append(data, "$r{} << EOD\n", region);
    bool was_far = true;
    for (size_t i = 0; i < robot.regions[region].size(); ++i) {
      const Point& point = robot.regions[region][i];
      const bool is_far = point.lo_m == RegionSeparation::kFar;
      // A blank line breaks the curve where no distance is known.
      if (is_far && !was_far) data += '\n';
      was_far = is_far;
      if (is_far) continue;
      axis_max_m = std::max(axis_max_m, point.required_m > 0 ? point.required_m : 0.f);
      append(data, "{:.6g} {:.6g} {:.6g} {}\n", from_s + static_cast<double>(i) * point_s,
             point.lo_m, point.required_m, point.is_short ? 0 : -1);
    }
    // gnuplot rejects an empty data block.
    data += "\n-1 -1 NaN -1\nEOD\n";
  }
  const uint32_t id = ids_[which];
  const std::string group =
      id < run.group_of_avatar.size() ? run.groups[run.group_of_avatar[id]] : "robot";
  const std::string title = fmt::format("Distance of {} {} to people", group, id);
  const int rows = static_cast<int>((shown.size() + 1) / 2);
  std::string script = data;
  append(script,
         "set multiplot layout {},2 columnsfirst title {} noenhanced margins 0.07,0.98,{},{} "
         "spacing 0.09,{}\n"
         "set xrange [{:.6g}:{:.6g}]\nset yrange [0:{:.6g}]\nset grid\nset key off\n",
         rows, gnuplot_quoted(title), rows < 3 ? 0.16 : 0.1, rows < 3 ? 0.86 : 0.92,
         rows < 3 ? 0.24 : 0.08, from_s,
         from_s + std::max(1.0, static_cast<double>(points_)) * point_s,
         1.05 * static_cast<double>(axis_max_m));
  for (size_t i = 0; i < shown.size(); ++i) {
    const size_t region = shown[i];
    std::string name(name_of(static_cast<BodyRegion>(region)));
    std::replace(name.begin(), name.end(), '_', ' ');
    const bool is_last = i + 1 == shown.size();
    append(script,
           "set title '{0}' offset 0,-0.7\nset ylabel 'm'\nset xlabel '{1}'\n{2}"
           "plot {3:.6g} with lines dashtype 2 linecolor rgb '#999999' title 'margin', "
           "$r{4} using 1:2 with lines linewidth 1.6 linecolor rgb '{5}' title 'separation', "
           "$r{4} using 1:3 with lines linewidth 1.6 linecolor rgb '{6}' title 'required', "
           "$r{4} using 1:($4 < 0 ? NaN : 0.012 * {7:.6g}) with points pointtype 5 pointsize 0.35 "
           "linecolor rgb '{8}' title 'too close'\n",
           name, i + 1 == static_cast<size_t>(rows) || is_last ? "s" : "",
           is_last ? "set key at screen 0.5,0.02 center horizontal maxrows 1\n" : "", proximity_m_,
           region, kFigureColours[0], kFigureColours[3], 1.05 * static_cast<double>(axis_max_m),
           kFigureColours[1]);
  }
  script += "unset multiplot\n";
  return {"separation", title, "", script, 1000, 90 + 190 * rows};
}

namespace {

namespace fs = std::filesystem;

constexpr const char* kRows = "separation.csv";
constexpr const char* kShortfalls = "shortfalls.csv";
constexpr const char* kFigure = "separation.svg";

constexpr std::string_view kOption = "--separation";

}  // namespace

SeparationSink::SeparationSink(fs::path folder, const SeparationRule& rule)
    : folder_(std::move(folder)), is_measured_(rule.is_measured()) {
  if (folder_.empty()) return;
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) throw write_error(folder_, error.value(), kOption);
}

void SeparationSink::begin(const RunInfo& run) {
  monitor_ = std::make_unique<SeparationMonitor>(run);
  if (folder_.empty()) return;
  history_ =
      std::make_unique<SeparationHistory>(run, frame_count(run.scene->duration_s, run.step_s));
  rows_ = std::make_unique<OutputFile>(folder_ / kRows, kOption);
  rows_->write(
      "frame,time_s,robot,region,distance_lo_m,distance_hi_m,person,robot_part,person_part,closing_"
      "speed_mps,robot_speed_mps,human_speed_mps,required_m,min_slack_m,people_too_close\n");
  shortfalls_ = std::make_unique<OutputFile>(folder_ / kShortfalls, kOption);
  shortfalls_->write(
      "begin_s,end_s,robot,person,region,min_distance_lo_m,min_distance_hi_m,max_shortfall_m,"
      "beyond_margin,truncated\n");
}

void SeparationSink::list_ended(const RunInfo& run) {
  text_.clear();
  for (const Shortfall& each : monitor_->ended())
    append(text_, "{:.4f},{:.4f},{},{},{},{},{},{},{},{}\n",
           static_cast<double>(each.begin_frame) * run.step_s,
           static_cast<double>(each.end_frame) * run.step_s, each.robot, each.person,
           name_of(each.region), each.min_distance_lo_m, each.min_distance_hi_m,
           each.max_shortfall_m, each.is_beyond_margin ? 1 : 0, each.is_truncated ? 1 : 0);
  shortfalls_->write(text_);
}

void SeparationSink::frame(const RunInfo& run, const Frame& frame) {
  monitor_->frame(run, frame);
  if (folder_.empty()) return;
  history_->add(frame.number, monitor_->rows());
  text_.clear();
  for (const RegionSeparation& row : monitor_->rows()) {
    append(text_, "{},{:.4f},{},{},{},{},", frame.number,
           static_cast<double>(frame.number) * run.step_s, row.robot, name_of(row.region), row.lo_m,
           row.hi_m);
    if (row.is_far()) {
      text_ += ",,,,,,,,0\n";
      continue;
    }
    const bool robot_is_a = row.pair.a() == row.robot;
    const uint32_t person = robot_is_a ? row.pair.b() : row.pair.a();
    const uint32_t part_a = row.pair.part_a(), part_b = row.pair.part_b();
    append(text_, "{},{},{},{},{},{},{},{},{}\n", person,
           csv_field(part_name(run, row.robot, robot_is_a ? part_a : part_b)),
           csv_field(part_name(run, person, robot_is_a ? part_b : part_a)),
           csv_number(row.closing_speed_mps), csv_number(row.robot_speed_mps),
           csv_number(row.human_speed_mps), csv_number(row.required_m), csv_number(row.min_slack_m),
           row.people_too_close);
  }
  rows_->write(text_);
  list_ended(run);
}

void SeparationSink::end(const RunInfo& run, const RunEnd&) {
  monitor_->end();
  if (folder_.empty()) return;
  list_ended(run);
  rows_->close();
  shortfalls_->close();
  draw_figure(run);
}

void SeparationSink::draw_figure(const RunInfo& run) {
  // A figure of an earlier run does not belong to these numbers.
  std::error_code error;
  fs::remove(folder_ / kFigure, error);
  if (!has_gnuplot())
    note_ = fmt::format("no figure in {}; install gnuplot to draw it", folder_.string());
  else if (!history_->has_figure())
    note_ = fmt::format("no {} in {}: no robot came within the margin of a person", kFigure,
                        folder_.string());
  else
    draw(history_->figure(run, monitor_->totals()), folder_);
}

std::vector<std::string> separation_files() { return {kRows, kShortfalls, kFigure}; }

}  // namespace throng
