// ContactSink writes the contact statistics of a run: tables, networks, body map and figures.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

#include "analysis/contacts/contact_statistics.h"
#include "analysis/contacts/networks.h"
#include "avatars/model/model.h"
#include "base/figure.h"
#include "scenes/run/sink.h"

namespace throng {

/// Map of the places on the body where contacts occur. Contact points are moved to the body at
/// rest and drawn as contact time, smoothed over 2 cm.
/// Memory does not grow with the run.
class BodyMap {
 public:
  /// True if runs of this scene yield contact points, directly or from proximity by triangles.
  static bool is_known(const Scene& scene) {
    return scene.exact && (scene.contact_points || scene.proximity_m > 0);
  }

  /// Covers the people with the most frequent body model.
  explicit BodyMap(const RunInfo& run);

  /// Requires a frame with postures.
  void frame(const RunInfo& run, const Frame& frame);

  bool has_figure() const { return !cells_.empty(); }
  /// Contact time in seconds, summed over all points.
  double total_s() const;
  /// Views from the front, the right, the back and the left.
  Figure figure() const;

  /// Point on the body at rest and its contact time.
  struct TouchedPoint {
    Eigen::Vector3f at_m;
    double seconds = 0;
  };
  /// All touched points, ordered by part and position.
  std::vector<TouchedPoint> touched() const;

 private:
  void add(const RunInfo& run, const Frame& frame, uint32_t body, uint32_t part,
           const Eigen::Vector3d& point_m);

  double step_s_;
  int model_ = -1;  ///< -1: the run has no people
  std::shared_ptr<const Model> body_;
  std::vector<PartPose> rest_, poses_;
  int64_t posed_ = -1;                            ///< avatar whose part poses poses_ holds
  std::unordered_map<uint64_t, uint64_t> cells_;  ///< number of frames by part and cell
};

/// Writes proximity.csv, exposure.csv, proximity.tij and proximity.graphml.
/// Levels beyond the run's margin are omitted and named in note(), never written as 0.
class ProximityTables {
 public:
  /// Distances below which exposure time is counted.
  static constexpr std::array<double, 3> kLevels_m = {0.5, 1, 2};

  /// Number of frames in which two people were closer than each level: proven, and undetermined.
  struct Exposure {
    std::array<uint32_t, 3> below{}, undetermined{};
  };

  ProximityTables(std::filesystem::path folder, const RunInfo& run);

  void frame(const RunInfo& run, const Frame& frame);
  void end(const RunInfo& run);

  /// Exposure of all pairs of people within closest_parts_m, keyed by pair_key().
  const std::unordered_map<uint64_t, Exposure>& exposures() const { return exposures_; }
  /// Levels that are omitted, or "".
  std::string note() const;

 private:
  void list(const RunInfo& run, const Frame& frame, const ProximityRows& rows, const char* of);
  void expose(const Frame& frame);
  void write_exposures(const RunInfo& run);

  std::filesystem::path folder_;
  double step_s_;
  float closest_parts_m_;
  size_t levels_ = 0;                     ///< number of kLevels_m within the margin
  std::unique_ptr<OutputFile> rows_;      ///< null: the run has no margin
  std::unique_ptr<SecondsFile> seconds_;  ///< null: no margin for people
  std::unordered_map<uint64_t, Exposure> exposures_;
  std::vector<uint64_t> pairs_;
  std::string text_;
};

/// Names of all files that ProximityTables can write.
std::vector<std::string> proximity_table_files();

/// Writes contact statistics into a folder: CSV files, and figures if gnuplot is installed.
/// contacts.csv grows during the run; all other files are written at its end.
class ContactSink final : public Sink {
 public:
  /// Creates the folder; begin() replaces contacts.csv in it. Throws EnvironmentError, also in all
  /// other calls, if a file cannot be written.
  /// `with_points`: the run yields contact points (see BodyMap::is_known()).
  explicit ContactSink(std::filesystem::path folder, bool with_points = false);

  SinkNeeds needs() const override { return {.postures = with_points_}; }
  void begin(const RunInfo& run) override;
  void frame(const RunInfo& run, const Frame& frame) override;
  void end(const RunInfo& run, const RunEnd& end) override;

  /// Null before begin().
  const ContactStatistics* statistics() const { return statistics_.get(); }
  /// One line per missing file, with the reason.
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  void list_ended();
  void write_pairs() const;
  void draw_figures();

  std::filesystem::path folder_;
  bool with_points_;
  std::unique_ptr<OutputFile> contacts_;
  std::unique_ptr<ContactStatistics> statistics_;
  std::unique_ptr<TouchingNetwork> touching_;
  std::unique_ptr<ProximityTables> proximity_;
  std::unique_ptr<BodyMap> body_map_;  ///< null without points
  std::vector<std::string> notes_;
};

/// Names of all files that ContactSink can write.
std::vector<std::string> contact_files();

/// Figures of contact rate, duration, parts and density. Figures without data are omitted.
std::vector<Figure> figures_of(const ContactStatistics& statistics);

}  // namespace throng
