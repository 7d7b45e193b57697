#include "analysis/validation/empirical_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>
#include <stdexcept>

namespace throng::validation {
namespace {

/// Distance from the 10 % to the 90 % quantile of a normal distribution, in standard deviations.
constexpr double kTenthToTenth = 2.563;

const char* const kArchive =
    "Pedestrian Dynamics Data Archive (Forschungszentrum Juelich), as tabled in the validation "
    "suite of JuPedSim: ";

/// {density from, mean, 10 %, 90 %}; bins with at least 15 values.
const std::vector<RecordedCurve>& curves() {
  static const std::vector<RecordedCurve> all = {
      {"single_file",
       std::string(kArchive) + "an oval of 26 m in single file, 14 to 70 people",
       "per m",
       1.25,
       {{0.25, 1.13, 0.88, 1.26},
        {0.5, 0.93, 0.80, 1.17},
        {0.75, 0.86, 0.62, 0.99},
        {1, 0.54, 0.40, 0.81},
        {1.25, 0.35, 0.21, 0.50},
        {1.5, 0.25, 0.18, 0.37},
        {1.75, 0.15, 0.10, 0.23},
        {2, 0.10, 0.05, 0.14},
        {2.25, 0.05, 0.00, 0.10},
        {2.5, 0.04, 0.00, 0.08},
        {2.75, 0.01, -0.02, 0.03}}},
      {"ug",
       std::string(kArchive) + "corridor `ug`, 1.8 m wide, one way, people go round",
       "per m2",
       1.15,
       {{0, 1.14, 1.02, 1.22},
        {0.25, 1.10, 1.01, 1.21},
        {0.5, 1.00, 0.94, 1.05},
        {0.75, 0.84, 0.73, 0.99},
        {1, 0.78, 0.72, 0.83},
        {1.25, 0.65, 0.52, 0.82},
        {1.5, 0.58, 0.50, 0.76},
        {1.75, 0.52, 0.48, 0.57},
        {2, 0.45, 0.30, 0.55},
        {2.25, 0.39, 0.27, 0.54},
        {3, 0.25, 0.22, 0.29},
        {3.25, 0.21, 0.16, 0.25},
        {3.5, 0.18, 0.12, 0.22},
        {3.75, 0.16, 0.08, 0.21},
        {4, 0.06, 0.03, 0.09}}},
      {"uo",
       std::string(kArchive) + "corridor `uo`, 3.0 m wide and 8 m long, one way, open",
       "per m2",
       1.55,
       {{0.25, 1.49, 1.31, 1.69},
        {0.5, 1.43, 1.31, 1.58},
        {0.75, 1.38, 1.23, 1.56},
        {1, 1.22, 1.14, 1.29},
        {1.25, 1.19, 1.09, 1.29},
        {1.5, 1.08, 0.97, 1.26},
        {1.75, 0.95, 0.79, 1.07},
        {2, 0.69, 0.51, 0.90},
        {2.25, 0.48, 0.36, 0.57},
        {2.5, 0.41, 0.31, 0.53},
        {2.75, 0.34, 0.22, 0.45},
        {3, 0.25, 0.17, 0.34},
        {3.25, 0.18, 0.17, 0.20},
        {3.5, 0.16, 0.14, 0.19}}},
      {"eo",
       std::string(kArchive) + "corner `eo`, 2.4 m wide",
       "per m2",
       1.5,
       {{0, 1.46, 1.28, 1.57},
        {0.25, 1.45, 1.28, 1.66},
        {0.5, 1.29, 1.16, 1.43},
        {0.75, 1.22, 1.10, 1.33},
        {1, 1.12, 0.98, 1.25},
        {1.25, 0.97, 0.88, 1.05},
        {1.5, 0.91, 0.81, 0.99},
        {2, 0.74, 0.67, 0.80}}},
      {"ko",
       std::string(kArchive) + "T-junction `ko`, all arms 2.4 m wide, two streams merge",
       "per m2",
       1.3,
       {{0.25, 1.23, 1.10, 1.35},
        {0.5, 1.10, 0.85, 1.31},
        {0.75, 1.05, 0.85, 1.30},
        {1, 0.92, 0.63, 1.14},
        {1.25, 0.80, 0.55, 1.05},
        {1.5, 0.79, 0.59, 0.98},
        {1.75, 0.74, 0.49, 0.92},
        {2, 0.58, 0.35, 0.81},
        {2.25, 0.53, 0.33, 0.78},
        {2.5, 0.45, 0.31, 0.68},
        {2.75, 0.36, 0.29, 0.38},
        {3, 0.34, 0.28, 0.36}}},
      {"bot",
       std::string(kArchive) + "corridor `bot`, 3.6 m wide and 8 m long, two-way",
       "per m2",
       1.55,
       {{0.25, 1.50, 1.37, 1.63},
        {0.5, 1.39, 1.24, 1.53},
        {0.75, 1.22, 1.14, 1.28},
        {1, 1.14, 0.98, 1.24},
        {1.25, 0.91, 0.78, 1.03},
        {1.5, 0.85, 0.78, 0.93},
        {1.75, 0.72, 0.62, 0.86},
        {2, 0.63, 0.56, 0.68},
        {2.25, 0.53, 0.48, 0.58},
        {2.5, 0.47, 0.41, 0.53}}},
  };
  return all;
}

}  // namespace

double RecordedCurve::desired_std_dev_mps() const {
  return (bins.front().high_mps - bins.front().low_mps) / kTenthToTenth;
}

const RecordedCurve& recorded_curve(const std::string& id) {
  for (const RecordedCurve& curve : curves())
    if (curve.id == id) return curve;
  throw std::out_of_range("no recorded curve " + id);
}

const std::vector<RecordedBand>& recorded_one_way() {
  static const std::vector<RecordedBand> bands = [] {
    std::map<double, RecordedBand> by_density;
    for (const char* id : {"ug", "uo", "eo"})
      for (const RecordedBin& bin : recorded_curve(id).bins) {
        const double at_per_m2 = bin.from + 0.5 * kRecordedBin;
        RecordedBand& band =
            by_density.try_emplace(at_per_m2, RecordedBand{at_per_m2, bin.low_mps, bin.high_mps})
                .first->second;
        band.low_mps = std::min(band.low_mps, bin.low_mps);
        band.high_mps = std::max(band.high_mps, bin.high_mps);
      }
    std::vector<RecordedBand> out;
    for (const auto& [at_per_m2, band] : by_density) out.push_back(band);
    return out;
  }();
  return bands;
}

std::optional<RecordedBand> recorded_one_way_at(double per_m2) {
  const std::vector<RecordedBand>& bands = recorded_one_way();
  const auto above = std::find_if(bands.begin(), bands.end(), [&](const RecordedBand& band) {
    return band.at_per_m2 >= per_m2;
  });
  if (above == bands.end()) return std::nullopt;
  if (above->at_per_m2 == per_m2) return *above;
  if (above == bands.begin()) return std::nullopt;
  const RecordedBand& below = *std::prev(above);
  const double part = (per_m2 - below.at_per_m2) / (above->at_per_m2 - below.at_per_m2);
  return RecordedBand{per_m2, std::lerp(below.low_mps, above->low_mps, part),
                      std::lerp(below.high_mps, above->high_mps, part)};
}

double RecordedDoor::mean_per_s() const {
  return std::accumulate(flows_per_s.begin(), flows_per_s.end(), 0.0) /
         static_cast<double>(flows_per_s.size());
}

const char* const kRecordedDoorsSource =
    "Kretz et al. 2006, Seyfried et al. 2009 and the bottleneck of 2006 with a neck of 2.8 m "
    "behind "
    "a room 6 m wide (Pedestrian Dynamics Data Archive)";

const std::vector<RecordedDoor>& recorded_doors() {
  static const std::vector<RecordedDoor> doors = {
      {0.5, {1.02}},
      {0.6, {1.12}},
      {0.7, {1.24}},
      {0.8, {1.42, 1.29}},
      {0.9, {1.58, 1.67, 1.59}},
      {1, {1.86, 1.9, 1.83}},
      {1.1, {2.12, 1.99}},
      {1.2, {2.14, 2.36, 2.31}},
      {1.4, {2.71}},
      {1.6, {2.84}},
      {1.8, {3.55}},
      {2, {3.55}},
      {2.2, {4.06}},
      {2.5, {5.12}},
  };
  return doors;
}

const RecordedDoor& recorded_door(double width_m) {
  for (const RecordedDoor& door : recorded_doors())
    if (std::abs(door.width_m - width_m) < 1e-9) return door;
  throw std::out_of_range(fmt::format("no recorded door of {} m", width_m));
}

const char* const kRecordedContactsSource =
    "three recordings of the Pedestrian Dynamics Data Archive (corridor of 1.8 m twice, bottleneck "
    "of 0.5 m) retargeted to Throng's bodies (docs/recordings.md)";

const std::vector<RecordedContacts>& recorded_contacts() {
  static const std::vector<RecordedContacts> levels = {
      {0, 0.43, 0.6}, {0.43, 1, 2.2}, {1, 2, 5.4}, {2, 3.57, 16.4}, {3.57, 5, 51.2}};
  return levels;
}

}  // namespace throng::validation
