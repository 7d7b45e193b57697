// What recorded people did: speed against density in six set-ups, flow through doors by width.
// One rule: every number is of a published recording, and each table names it; nothing of ours is
// in it.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace throng::validation {

/// Speeds over the densities from `from` on, one bin wide.
struct RecordedBin {
  double from = 0;
  double mean_mps = 0;
  double low_mps = 0;   ///< a tenth is slower
  double high_mps = 0;  ///< a tenth is faster
};

struct RecordedCurve {
  std::string id;
  std::string source;
  std::string unit;              ///< of densities: "per m2", "per m"
  double desired_speed_mps = 0;  ///< of its people, on average
  std::vector<RecordedBin> bins;

  /// Standard deviation of free speeds: what the 10 and 90 % of the emptiest bin are apart, as of a
  /// normal distribution.
  double desired_std_dev_mps() const;
};
inline constexpr double kRecordedBin = 0.25;

/// `single_file`, `ug`, `uo`, `eo`, `ko`, `bot`; throws std::out_of_range for others.
const RecordedCurve& recorded_curve(const std::string& id);

/// Speeds where people walk one way: from the slowest tenth of the slowest to the fastest tenth of
/// the fastest of `ug`, `uo` and `eo`.
struct RecordedBand {
  double at_per_m2 = 0;
  double low_mps = 0;
  double high_mps = 0;
};
/// By density, each at the middle of the bin that it was seen in.
const std::vector<RecordedBand>& recorded_one_way();
/// Between two of them; none where nobody was recorded.
std::optional<RecordedBand> recorded_one_way_at(double per_m2);

struct RecordedDoor {
  double width_m = 0;
  std::vector<double> flows_per_s;  ///< one an experiment
  double mean_per_s() const;
};
const std::vector<RecordedDoor>& recorded_doors();
/// Throws std::out_of_range where no experiment had that width.
const RecordedDoor& recorded_door(double width_m);
extern const char* const kRecordedDoorsSource;

/// Contacts a person and minute of recorded people, from so many people per m2 to so many.
struct RecordedContacts {
  double from_per_m2 = 0;
  double to_per_m2 = 0;
  double per_person_min = 0;
};
/// Ascending; the levels of ContactMeasures from the first on.
const std::vector<RecordedContacts>& recorded_contacts();
extern const char* const kRecordedContactsSource;

}  // namespace throng::validation
