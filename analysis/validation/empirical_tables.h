// Empirical tables: speed against density in six setups, flow through doors by width, contact
// rates. Each table names the published recording it is from.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace throng::validation {

/// Speeds at densities in [from, from + kRecordedBin).
struct RecordedBin {
  double from = 0;
  double mean_mps = 0;
  double low_mps = 0;   ///< 10 % quantile
  double high_mps = 0;  ///< 90 % quantile
};

struct RecordedCurve {
  std::string id;
  std::string source;
  std::string unit;              ///< unit of densities: "per m2", "per m"
  double desired_speed_mps = 0;  ///< mean desired speed
  std::vector<RecordedBin> bins;

  /// Standard deviation of desired speeds, from the 10 and 90 % quantiles of the emptiest bin and a
  /// normal distribution.
  double desired_std_dev_mps() const;
};
inline constexpr double kRecordedBin = 0.25;

/// Curve `single_file`, `ug`, `uo`, `eo`, `ko` or `bot`; throws std::out_of_range for other ids.
const RecordedCurve& recorded_curve(const std::string& id);

/// Range of one-way speeds at a density: from the lowest 10 % quantile to the highest 90 % quantile
/// of `ug`, `uo` and `eo`.
struct RecordedBand {
  double at_per_m2 = 0;
  double low_mps = 0;
  double high_mps = 0;
};
/// Bands in order of density, each at the centre of its bin.
const std::vector<RecordedBand>& recorded_one_way();
/// Interpolated band at a density; none outside of the recorded densities.
std::optional<RecordedBand> recorded_one_way_at(double per_m2);

struct RecordedDoor {
  double width_m = 0;
  std::vector<double> flows_per_s;  ///< one per experiment
  double mean_per_s() const;
};
const std::vector<RecordedDoor>& recorded_doors();
/// Door of this width; throws std::out_of_range if no experiment had it.
const RecordedDoor& recorded_door(double width_m);
extern const char* const kRecordedDoorsSource;

/// Contacts per person and minute of retargeted recordings, in a range of densities.
struct RecordedContacts {
  double from_per_m2 = 0;
  double to_per_m2 = 0;
  double per_person_min = 0;
};
/// Ascending; the first levels of ContactMeasures.
const std::vector<RecordedContacts>& recorded_contacts();
extern const char* const kRecordedContactsSource;

}  // namespace throng::validation
