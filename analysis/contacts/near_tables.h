// How near people were, beside their contacts: near.csv, exposure.csv, near.tij and near.graphml.
// One rule: what the margins of the run do not reach is left out and said so, never counted as 0.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

#include "analysis/contacts/networks.h"

namespace throng {

class NearTables {
 public:
  /// Distances below which seconds are counted.
  static constexpr std::array<double, 3> kLevels_m = {0.5, 1, 2};

  /// Frames in which two people were nearer than a level: proven, or not proven to be farther.
  struct Exposure {
    std::array<uint32_t, 3> below{}, unsure{};
  };

  NearTables(std::filesystem::path folder, const RunInfo& run);

  void frame(const RunInfo& run, const Frame& frame);
  void end(const RunInfo& run);

  /// Of every two people who were within the run's margin for people; by pair_key().
  const std::unordered_map<uint64_t, Exposure>& exposures() const { return exposures_; }
  /// Levels that are left out, or "".
  std::string note() const;

 private:
  void list(const RunInfo& run, const Frame& frame, const NearRows& rows, const char* of);
  void expose(const Frame& frame);
  void write_exposures(const RunInfo& run);

  std::filesystem::path folder_;
  double step_s_;
  float person_near_m_;
  size_t levels_ = 0;                     ///< of kLevels_m, that the margin reaches
  std::unique_ptr<FolderFile> rows_;      ///< null: no margin was asked for
  std::unique_ptr<SecondsFile> seconds_;  ///< null: none for people
  std::unordered_map<uint64_t, Exposure> exposures_;
  std::vector<uint64_t> pairs_;
  std::string text_;
};

/// The names of all files that it writes.
std::vector<std::string> near_table_files();

}  // namespace throng
