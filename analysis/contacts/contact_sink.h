// Writes what a run's contacts add up to: tables, networks, the map of the body.
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

/// Where on the body contacts are: points of contact carried back to a body at rest, as a picture.
/// Memory does not grow with the run; what is drawn is time of contact, spread over a
/// finger's width.
class BodyMap {
 public:
  /// Whether a run of this scene knows points of contact: it is asked for them, or for distances by
  /// triangles.
  static bool is_known(const Scene& scene) {
    return scene.exact && (scene.contact_points || scene.proximity_m > 0);
  }

  /// Of the people who have the model that most of them have.
  explicit BodyMap(const RunInfo& run);

  /// A frame with postures.
  void frame(const RunInfo& run, const Frame& frame);

  bool has_figure() const { return !cells_.empty(); }
  /// Seconds of all points together.
  double total_s() const;
  /// From the front, the right, the back and the left.
  Figure figure() const;

  /// A point of the body at rest, and for how long it was touched.
  struct TouchedPoint {
    Eigen::Vector3f at_m;
    double seconds = 0;
  };
  /// By part and place.
  std::vector<TouchedPoint> touched() const;

 private:
  void add(const RunInfo& run, const Frame& frame, uint32_t body, uint32_t part,
           const Eigen::Vector3d& point_m);

  double step_s_;
  int model_ = -1;  ///< -1: nobody is a person
  std::shared_ptr<const Model> body_;
  std::vector<PartPose> rest_, poses_;
  int64_t posed_ = -1;                            ///< whose poses poses_ has
  std::unordered_map<uint64_t, uint64_t> cells_;  ///< frames by part and cell of its frame
};

/// How near people were, beside their contacts: near.csv, exposure.csv, near.tij and near.graphml.
/// What the margins of the run do not reach is left out and said so, never counted as 0.
class ProximityTables {
 public:
  /// Distances below which seconds are counted.
  static constexpr std::array<double, 3> kLevels_m = {0.5, 1, 2};

  /// Frames in which two people were nearer than a level: proven, or not proven to be farther.
  struct Exposure {
    std::array<uint32_t, 3> below{}, unsure{};
  };

  ProximityTables(std::filesystem::path folder, const RunInfo& run);

  void frame(const RunInfo& run, const Frame& frame);
  void end(const RunInfo& run);

  /// Of every two people who were within the run's margin for people; by pair_key().
  const std::unordered_map<uint64_t, Exposure>& exposures() const { return exposures_; }
  /// Levels that are left out, or "".
  std::string note() const;

 private:
  void list(const RunInfo& run, const Frame& frame, const ProximityRows& rows, const char* of);
  void expose(const Frame& frame);
  void write_exposures(const RunInfo& run);

  std::filesystem::path folder_;
  double step_s_;
  float closest_parts_m_;
  size_t levels_ = 0;                     ///< of kLevels_m, that the margin reaches
  std::unique_ptr<OutputFile> rows_;      ///< null: no margin was asked for
  std::unique_ptr<SecondsFile> seconds_;  ///< null: none for people
  std::unordered_map<uint64_t, Exposure> exposures_;
  std::vector<uint64_t> pairs_;
  std::string text_;
};

/// The names of all files that it writes.
std::vector<std::string> proximity_table_files();

/// Writes a run's contact statistics into a folder: CSV files, and figures where gnuplot is there.
/// The list of contacts grows with the run; the rest is written at its end.
class ContactSink final : public Sink {
 public:
  /// Creates the folder; begin() replaces contacts.csv in it. Throws EnvironmentError, here and in
  /// all calls, if something cannot be written.
  /// `with_points`: of a run that knows where contacts are on the body (see BodyMap::is_known()).
  explicit ContactSink(std::filesystem::path folder, bool with_points = false);

  SinkNeeds needs() const override { return {.postures = with_points_}; }
  void begin(const RunInfo& run) override;
  void frame(const RunInfo& run, const Frame& frame) override;
  void end(const RunInfo& run, const RunEnd& end) override;

  /// Null before begin().
  const ContactStatistics* statistics() const { return statistics_.get(); }
  /// What there is none of, and why; a line each.
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

/// The names of all files that it writes into the folder.
std::vector<std::string> contact_files();

/// How often people touched, how long, with what, and at which density; a figure that has nothing
/// to show is left out.
std::vector<Figure> figures_of(const ContactStatistics& statistics);

}  // namespace throng
