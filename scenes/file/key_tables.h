// The tables of keys of scene files, one for each kind of map.
// One rule: the order of rows is that of the documentation and of the content hash.
#pragma once

#include "culling/near.h"
#include "scenes/file/key.h"

namespace throng {

/// Of waiting, starting late and arriving: from at once to the end of the longest run.
inline constexpr Range kTimeRange{0, 1e7};
inline constexpr Range kNearRange{0, static_cast<double>(kMostNear_m)};

const KeyTable<Scene>& scene_keys();
const KeyTable<Group>& group_keys();
const KeyTable<Goal>& goal_keys();
const KeyTable<QueueRule>& queue_keys();
const KeyTable<Source>& source_keys();
const KeyTable<Cue>& cue_keys();
const KeyTable<Companions>& companion_keys();
const KeyTable<Door>& door_keys();
const KeyTable<Obstacle>& obstacle_keys();
const KeyTable<PartsBox>& box_keys();
const KeyTable<SeparationRule>& separation_keys();
/// Of scene.recorded and of the last group.
const KeyTable<Scene>& recording_keys();

/// A map of cue_keys(), or the number of seconds after the start. Whether there is such a group
/// is asked by require_cues(), when all groups are known.
Cue read_cue(Reading& reading, const std::string& file, const YamlNode& node);
void require_cues(const Reading& reading);
void add_cue(Hasher& hash, const Cue& cue);

/// Whether lines of queues lie on free ground, and goals of the same areas have one queue, is asked
/// when all of the scene is known.
void require_lines(const Reading& reading);

/// A map of companion_keys(), or the share of the people as one number.
Companions read_companions(Reading& reading, const std::string& file, const YamlNode& node);

/// A list of maps.
template <typename T>
void read_items(const KeyTable<T>& table, const std::string& key, bool required, Reading& reading,
                const Fields& fields, std::vector<T>& out) {
  for (const YamlNode* item : fields.items(key, required)) {
    Fields inner(fields.file(), *item, table.title);
    T value;
    read_keys(table, reading, inner, value);
    out.push_back(std::move(value));
  }
}

template <typename T>
void add_items(const KeyTable<T>& table, Hasher& hash, const std::vector<T>& items) {
  hash.add(uint64_t{items.size()});
  for (const T& item : items) add_keys(table, hash, item);
}

}  // namespace throng
