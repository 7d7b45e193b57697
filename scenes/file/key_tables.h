// Key tables list the keys of each kind of map in a scene file.
// Invariant: the order of rows is that of the documentation and of the content hash.
#pragma once

#include "culling/proximity.h"
#include "scenes/file/key.h"

namespace throng {

/// Range of times, in seconds: waiting, premovement, start of sources and triggers.
inline constexpr Range kTimeRange{0, 1e7};
inline constexpr Range kDesiredSpeedRange{kMinDesiredSpeed_mps, kMaxDesiredSpeed_mps};
/// 1000 agents per second fill any entrance; higher rates are mistaken units.
inline constexpr Range kRateRange{0, 1000, true};
inline constexpr Range kProximityRange{0, static_cast<double>(kMaxProximity_m)};

const KeyTable<Scene>& scene_keys();
const KeyTable<Group>& group_keys();
const KeyTable<Goal>& goal_keys();
const KeyTable<QueueRule>& queue_keys();
const KeyTable<Source>& source_keys();
const KeyTable<TriggerRule>& trigger_keys();
const KeyTable<SocialGroupRule>& social_group_keys();
const KeyTable<Door>& door_keys();
const KeyTable<Obstacle>& obstacle_keys();
const KeyTable<PartsBox>& box_keys();
const KeyTable<SeparationRule>& separation_keys();
const KeyTable<Scene>& recording_keys();

/// Reads a map of trigger_keys(), or a number of seconds after the start. require_triggers() checks
/// the groups after all groups are known.
TriggerRule read_trigger(ReadContext& context, const std::string& file, const YamlNode& node);
void require_triggers(const ReadContext& context);
void add_trigger(Hasher& hash, const TriggerRule& trigger);

/// Checks that queue lines lie on free ground, and that goals with equal areas share one queue.
/// Needs the complete scene. Throws InputError.
void require_lines(const ReadContext& context);

/// Reads a map of social_group_keys(), or the share of people in social groups as one number.
SocialGroupRule read_social_groups(ReadContext& context, const std::string& file,
                                   const YamlNode& node);

/// Reads `positions_m` of a group, with the columns of its file if it names one.
void read_positions(ReadContext& context, const Fields& fields, Group& group);
/// Rows of `positions_m`, `headings_rad` and `speeds_mps`. read_positions() comes first.
std::vector<Key<Group>> rows_of_starts();
MapText starts_text();

template <typename T>
void read_items(const KeyTable<T>& table, const std::string& key, bool required,
                ReadContext& context, const Fields& fields, std::vector<T>& out) {
  for (const YamlNode* item : fields.items(key, required)) {
    Fields inner(fields.file(), *item, table.title);
    T value;
    read_keys(table, context, inner, value);
    out.push_back(std::move(value));
  }
}

template <typename T>
void add_items(const KeyTable<T>& table, Hasher& hash, const std::vector<T>& items) {
  hash.add(uint64_t{items.size()});
  for (const T& item : items) add_keys(table, hash, item);
}

}  // namespace throng
