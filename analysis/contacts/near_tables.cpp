#include "analysis/contacts/near_tables.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "analysis/part_name.h"
#include "base/append.h"
#include "base/csv.h"

namespace throng {
namespace {

constexpr const char* kFiles[] = {"near.csv", "exposure.csv", "near.tij", "near.graphml"};

}  // namespace

NearTables::NearTables(std::filesystem::path folder, const RunInfo& run)
    : folder_(std::move(folder)), step_s_(run.step_s), person_near_m_(run.culler.near.body_near_m) {
  // Those of an earlier run beside the numbers of this one would be wrong.
  std::error_code error;
  for (const char* name : kFiles) std::filesystem::remove(folder_ / name, error);
  if (!run.culler.near.is_asked()) return;
  rows_ = std::make_unique<FolderFile>(folder_ / "near.csv", kContactsOption);
  rows_->write(
      "frame,time_s,of,body_a,part_a,body_b,part_b,level,lo_m,hi_m,closing_mps,contact_in_s\n");
  if (!(person_near_m_ > 0)) return;
  seconds_ = std::make_unique<SecondsFile>(folder_ / "near.tij", step_s_);
  while (levels_ < kLevels_m.size() && kLevels_m[levels_] <= static_cast<double>(person_near_m_))
    ++levels_;
}

void NearTables::list(const RunInfo& run, const Frame& frame, const NearRows& rows,
                      const char* of) {
  for (const NearPair& row : rows) {
    const PairKey pair = row.pair;
    append(text_, "{},{:.4f},{},{},{},{},{},{},{},{},{},{}\n", frame.number,
           static_cast<double>(frame.number) * step_s_, of, pair.a(),
           csv_field(part_name(run, pair.a(), pair.part_a())), pair.b(),
           csv_field(part_name(run, pair.b(), pair.part_b())), static_cast<int>(row.level),
           row.lo_m, row.hi_m, csv_number(row.closing_mps), csv_number(row.contact_in_s()));
  }
}

void NearTables::expose(const Frame& frame) {
  pairs_.clear();
  for (const NearPair& row : frame.near_people) {
    const uint64_t pair = pair_key(row.pair.a(), row.pair.b());
    pairs_.push_back(pair);
    Exposure& exposure = exposures_[pair];
    for (size_t i = 0; i < levels_; ++i) {
      const auto level_m = static_cast<float>(kLevels_m[i]);
      exposure.below[i] += row.hi_m <= level_m;
      exposure.unsure[i] += row.lo_m <= level_m && row.hi_m > level_m;
    }
  }
  seconds_->frame(frame.number, pairs_);
}

void NearTables::frame(const RunInfo& run, const Frame& frame) {
  if (rows_ == nullptr) return;
  text_.clear();
  list(run, frame, frame.near_pairs, "parts");
  list(run, frame, frame.near_people, "people");
  rows_->write(text_);
  if (seconds_ != nullptr) expose(frame);
}

void NearTables::write_exposures(const RunInfo& run) {
  std::vector<uint64_t> pairs;
  for (const auto& [pair, exposure] : exposures_) pairs.push_back(pair);
  std::sort(pairs.begin(), pairs.end());
  std::string header = "person_a,person_b";
  GraphFile::Attributes attributes;
  for (size_t i = 0; i < levels_; ++i) {
    header += fmt::format(",below_{0}_m_s,unsure_{0}_m_s", kLevels_m[i]);
    attributes.emplace_back(fmt::format("below_{}_m_s", kLevels_m[i]), "double");
  }
  FolderFile table(folder_ / "exposure.csv", kContactsOption);
  table.write(header + "\n");
  GraphFile graph(folder_ / "near.graphml", run, attributes);
  const auto seconds = [&](uint32_t frames) { return fmt::format("{:.4f}", frames * step_s_); };
  for (const uint64_t pair : pairs) {
    const Exposure& exposure = exposures_.at(pair);
    std::string line = fmt::format("{},{}", pair >> 32, pair & UINT32_MAX);
    std::vector<std::string> values;
    for (size_t i = 0; i < levels_; ++i) {
      values.push_back(seconds(exposure.below[i]));
      line += fmt::format(",{},{}", values.back(), seconds(exposure.unsure[i]));
    }
    table.write(line + "\n");
    graph.edge(pair, values);
  }
  table.close();
  graph.end();
}

void NearTables::end(const RunInfo& run) {
  if (rows_ == nullptr) return;
  rows_->close();
  if (seconds_ == nullptr) return;
  seconds_->end();
  write_exposures(run);
}

std::string NearTables::note() const {
  if (seconds_ == nullptr || levels_ == kLevels_m.size()) return "";
  return fmt::format(
      "{} has no seconds below {} m: person_near_m is {}", (folder_ / "exposure.csv").string(),
      fmt::join(kLevels_m.begin() + static_cast<ptrdiff_t>(levels_), kLevels_m.end(), ", "),
      person_near_m_);
}

std::vector<std::string> near_table_files() { return {std::begin(kFiles), std::end(kFiles)}; }

}  // namespace throng
