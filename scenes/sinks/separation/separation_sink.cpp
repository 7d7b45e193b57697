#include "scenes/sinks/separation/separation_sink.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>

#include "base/append.h"
#include "base/csv.h"
#include "base/errors.h"
#include "scenes/run/runner.h"

namespace throng {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRows = "separation.csv";
constexpr const char* kShortfalls = "shortfalls.csv";
constexpr const char* kFigure = "separation.svg";

EnvironmentError cannot_write(const fs::path& file, int error) {
  return EnvironmentError(
      fmt::format("{}: cannot write: {}; choose another folder with --separation", file.string(),
                  std::strerror(error)));
}

void open(std::ofstream& out, const fs::path& file, const char* header) {
  errno = 0;
  out.open(file, std::ios::trunc | std::ios::binary);
  out << header;
  if (!out) throw cannot_write(file, errno);
}

void write(std::ofstream& out, const fs::path& file, const std::string& text) {
  errno = 0;
  out.write(text.data(), static_cast<std::streamsize>(text.size()));
  if (!out) throw cannot_write(file, errno);
}

/// What is not known is empty.
std::string known(float value) { return value == value ? fmt::format("{}", value) : ""; }

std::string part_name(const RunInfo& run, uint32_t avatar, uint32_t part) {
  const Model& model = *run.models[run.model_of_avatar[avatar]];
  return part < model.parts.size() ? csv_field(model.parts[part].name) : "whole body";
}

}  // namespace

SeparationSink::SeparationSink(fs::path folder, const SeparationRule& rule)
    : folder_(std::move(folder)), is_measured_(rule.is_measured()) {
  if (folder_.empty()) return;
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) throw cannot_write(folder_, error.value());
}

void SeparationSink::begin(const RunInfo& run) {
  monitor_ = std::make_unique<SeparationMonitor>(run);
  if (folder_.empty()) return;
  history_ =
      std::make_unique<SeparationHistory>(run, frame_count(run.scene->duration_s, run.step_s));
  open(rows_, folder_ / kRows,
       "frame,time_s,robot,region,lo_m,hi_m,person,robot_part,person_part,closing_mps,robot_mps,"
       "human_mps,required_m,spare_m,people_short\n");
  open(shortfalls_, folder_ / kShortfalls,
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
  write(shortfalls_, folder_ / kShortfalls, text_);
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
           part_name(run, row.robot, robot_is_a ? part_a : part_b),
           part_name(run, person, robot_is_a ? part_b : part_a), known(row.closing_mps),
           known(row.robot_mps), known(row.human_mps), known(row.required_m), known(row.spare_m),
           row.people_short);
  }
  write(rows_, folder_ / kRows, text_);
  list_ended(run);
}

void SeparationSink::end(const RunInfo& run, const RunEnd&) {
  monitor_->end();
  if (folder_.empty()) return;
  list_ended(run);
  for (const auto& [out, name] : {std::pair(&rows_, kRows), std::pair(&shortfalls_, kShortfalls)}) {
    errno = 0;
    out->close();
    if (!*out) throw cannot_write(folder_ / name, errno);
  }
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
