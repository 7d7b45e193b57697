#include "analysis/separation/separation_sink.h"

#include <fmt/format.h>

#include "analysis/part_name.h"
#include "base/append.h"
#include "base/csv.h"
#include "scenes/run/runner.h"

namespace throng {
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
  if (error) throw cannot_write(folder_, error.value(), kOption);
}

void SeparationSink::begin(const RunInfo& run) {
  monitor_ = std::make_unique<SeparationMonitor>(run);
  if (folder_.empty()) return;
  history_ =
      std::make_unique<SeparationHistory>(run, frame_count(run.scene->duration_s, run.step_s));
  rows_ = std::make_unique<FolderFile>(folder_ / kRows, kOption);
  rows_->write(
      "frame,time_s,robot,region,lo_m,hi_m,person,robot_part,person_part,closing_mps,robot_mps,"
      "human_mps,required_m,spare_m,people_short\n");
  shortfalls_ = std::make_unique<FolderFile>(folder_ / kShortfalls, kOption);
  shortfalls_->write(
      "begin_s,end_s,robot,person,region,least_lo_m,least_hi_m,most_short_m,beyond_margin,cut\n");
}

void SeparationSink::list_ended(const RunInfo& run) {
  text_.clear();
  for (const Shortfall& each : monitor_->ended())
    append(text_, "{:.4f},{:.4f},{},{},{},{},{},{},{},{}\n",
           static_cast<double>(each.begin_frame) * run.step_s,
           static_cast<double>(each.end_frame) * run.step_s, each.robot, each.person,
           name_of(each.region), each.least_lo_m, each.least_hi_m, each.most_short_m,
           each.is_beyond_margin ? 1 : 0, each.is_cut ? 1 : 0);
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
           csv_number(row.closing_mps), csv_number(row.robot_mps), csv_number(row.human_mps),
           csv_number(row.required_m), csv_number(row.spare_m), row.people_short);
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
  // A figure of an earlier run beside the numbers of this one would be wrong.
  std::error_code error;
  fs::remove(folder_ / kFigure, error);
  if (!has_gnuplot())
    note_ = fmt::format("no figure in {}: gnuplot is not installed", folder_.string());
  else if (!history_->has_figure())
    note_ = fmt::format("no {} in {}: no robot came within the margin of anybody", kFigure,
                        folder_.string());
  else
    draw(history_->figure(run, monitor_->totals()), folder_);
}

std::vector<std::string> separation_files() { return {kRows, kShortfalls, kFigure}; }

}  // namespace throng
