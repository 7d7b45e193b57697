#include "base/errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

namespace throng {
namespace {

/// Levenshtein distance: insertions, deletions and substitutions cost one each.
size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), size_t{0});
  for (size_t i = 0; i < a.size(); ++i) {
    size_t diagonal = row[0];
    row[0] = i + 1;
    for (size_t j = 0; j < b.size(); ++j) {
      const size_t substituted = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({substituted, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

/// Replaces line ends and terminal control bytes, which quoted input may hold.
std::string one_line(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  return text;
}

/// Words of other tools, and former names, with their name in Throng.
constexpr std::pair<std::string_view, std::string_view> kSynonyms[] = {
    // Command line
    {"--near", "--proximity"},
    {"--margin", "--proximity"},
    {"--person-near", "--closest-parts"},
    {"--between", "--filter-groups"},
    {"--parts", "--filter-parts"},
    {"--parts", "--false-positives"},
    {"--deadline-ms", "--budget-ms"},
    {"--deadline-tests", "--budget-tests"},
    {"--tell", "--publish-for"},
    {"--publish-parts", "--publish-part-poses"},
    {"--by-part", "--part-pairs"},
    {"--every", "--checkpoint-every"},
    {"--tracks", "--tracked-point"},
    {"--step", "--sampling"},
    {"--reality", "--empirical"},
    {"--agents", "--avatars"},
    {"--people", "--avatars"},
    {"--duration", "--seconds"},
    {"--jobs", "--threads"},
    {"--output", "--out"},
    // Python keywords
    {"person_near", "closest_parts"},
    {"deadline_ms", "budget_ms"},
    {"deadline_tests", "budget_tests"},
    {"publish_parts", "publish_part_poses"},
    {"by_part", "part_pairs"},
    {"tracks", "tracked_point"},
    {"step", "sampling"},
    {"between", "filter_groups"},
    {"parts", "filter_parts"},
    // Scene and study files
    {"near", "proximity"},
    {"near", "proximity_m"},
    {"near_m", "proximity_m"},
    {"margin_m", "proximity_m"},
    {"person_near_m", "closest_parts_m"},
    {"between", "group_filter"},
    {"parts", "part_filter"},
    {"yielding", "body_avoidance"},
    {"speed", "collision_free_speed"},
    {"density_speed", "density_dependent_speed"},
    {"driven", "control_channel"},
    {"companions", "social_groups"},
    {"speed_mps", "desired_speed_mps"},
    {"free_speed_mps", "desired_speed_mps"},
    {"delay_s", "premovement_s"},
    {"face", "look_at"},
    {"styles", "gait_styles"},
    {"deviation", "std_dev"},
    {"nearest_of", "any_of"},
    {"pass", "waypoint"},
    {"random", "arrivals"},
    {"later_s", "delay_s"},
    {"human_mps", "human_speed_mps"},
    {"robot_mps", "robot_speed_mps"},
    {"human_error_m", "human_uncertainty_m"},
    {"robot_error_m", "robot_uncertainty_m"},
    {"from_s", "start_s"},
    {"until_s", "end_s"},
    {"heading_deg", "yaw_deg"},
    {"whole", "integer"},
    {"keys", "parameters"},
    {"agents", "groups"},
    {"pedestrians", "groups"},
    {"walls", "obstacles"},
    {"waypoints", "goals"},
    {"destinations", "goals"},
    {"entrance", "spawn"},
    {"duration", "duration_s"},
    {"timestep", "step_s"},
    {"dt", "step_s"},
};

const std::string* find_synonym(std::string_view found, std::span<const std::string> candidates) {
  for (const auto& [word, name] : kSynonyms) {
    if (word != found) continue;
    const auto at = std::find(candidates.begin(), candidates.end(), name);
    if (at != candidates.end()) return &*at;
  }
  return nullptr;
}

/// The candidate with the least edit distance, or null if all are too far.
const std::string* find_similar(std::string_view found, std::span<const std::string> candidates) {
  // Up to a third of the word may be a typing error; more is another word.
  size_t nearest = found.size() / 3 + 1;
  const std::string* best = nullptr;
  for (const std::string& candidate : candidates) {
    const size_t distance = edit_distance(found, candidate);
    if (distance <= nearest && (best == nullptr || distance < nearest)) {
      nearest = distance;
      best = &candidate;
    }
  }
  return best;
}

}  // namespace

InputError::InputError(std::string_view where, std::string_view expected, std::string_view found)
    : std::runtime_error(
          one_line(fmt::format("{}: expected {}, found {}", where, expected, found))),
      where_(one_line(std::string(where))) {}

std::string at_line(std::string_view file, int line) { return fmt::format("{}:{}", file, line); }

std::string did_you_mean(std::string_view found, std::span<const std::string> candidates) {
  const std::string* best = find_synonym(found, candidates);
  if (best == nullptr) best = find_similar(found, candidates);
  return best == nullptr ? "" : fmt::format(" (did you mean '{}'?)", *best);
}

}  // namespace throng
