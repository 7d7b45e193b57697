#include "lcm_io/codec/run_reader.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/errors.h"
#include "lcm_io/codec/rows.h"

namespace throng {

bool RunReader::follows(Channel channel) {
  if (header_.run_id == run_id() && header_.instance == instance() && has_run_) {
    is_free_ = false;
    return true;
  }
  // First round of the description; later rounds have a higher seq.
  const bool begins = channel == Channel::kRun && header_.seq < header_.chunk_count;
  const bool is_chosen = chosen_ && *chosen_ == std::pair(header_.run_id, header_.instance);
  if (!is_free_ && !is_chosen && !(begins && !chosen_) && !end_) {
    ++foreign_;
    return false;
  }
  *this = [this, is_chosen] {
    RunReader fresh;
    fresh.tally_.run_id = header_.run_id;
    fresh.tally_.instance = header_.instance;
    fresh.header_ = header_;
    fresh.is_sound_ = true;
    fresh.has_run_ = true;
    fresh.is_free_ = false;
    if (is_chosen) fresh.chosen_ = chosen_;
    fresh.rejected_ = rejected_;
    fresh.foreign_ = foreign_;
    fresh.rejection_ = std::move(rejection_);
    return fresh;
  }();
  return true;
}

void RunReader::rewind() {
  tally_.channels = {};
  state_.frame = pending_.frame = -1;
  pending_avatars_ = 0;
  pending_chunks_.clear();
  touching_.clear();
  pending_touching_.clear();
  for (ReceivedChunks* all : {&touching_chunks_, &proximity_chunks_, &contact_chunks_}) *all = {};
  new_events_.clear();
  proximity_pairs_.clear();
  closest_parts_.clear();
  contact_points_.clear();
  new_shortfalls_.clear();
  frame_stats_.reset();
  end_.reset();
  checks_.reset();
}

RunReader::Update RunReader::reject(std::string_view channel, std::string why) {
  ++rejected_;
  rejection_ = std::string(channel) + ": " + std::move(why);
  return Update::kRejected;
}

template <class Message>
std::string RunReader::handle(const Message&, Update& update) {
  update = Update::kMessage;
  return "";
}

template <class Message>
RunReader::Update RunReader::take(Channel channel, std::span<const uint8_t> bytes) {
  Message message;
  std::string defect = decode(bytes, message);
  if (!defect.empty()) return reject(name_of(channel), std::move(defect));
  is_sound_ = true;
  if (!follows(channel)) return Update::kNothing;
  tally_.count(channel, header_, bytes.size());
  Update update = Update::kNothing;
  defect = handle(message, update);
  return defect.empty() ? update : reject(name_of(channel), std::move(defect));
}

RunReader::Update RunReader::take(std::string_view name, std::span<const uint8_t> bytes) {
  is_sound_ = false;
  const std::optional<Channel> channel = channel_of(name);
  if (!channel) return Update::kNothing;
  std::string defect = read_header(*channel, bytes, header_);
  if (!defect.empty()) return reject(name, std::move(defect));
  return with_type_of(*channel, [&]<class Message>() { return take<Message>(*channel, bytes); });
}

std::string RunReader::handle(frame_stats_t& stats, Update& update) {
  frame_stats_ = stats;
  update = Update::kFrameStats;
  return "";
}

std::string RunReader::handle(end_t& end, Update& update) {
  end_ = std::move(end);
  tally_.close(*end_);
  update = Update::kEnd;
  return "";
}

std::string RunReader::handle(checksums_t& checks, Update& update) {
  checks_ = std::move(checks);
  update = Update::kChecksums;
  return "";
}

std::string RunReader::handle(const run_chunk_t& piece, Update& update) {
  if (run_) return "";
  if (piece.total_bytes != total_bytes_) {
    pieces_.clear();
    piece_bytes_ = 0;
    total_bytes_ = piece.total_bytes;
  }
  const bool is_new = pieces_.emplace(piece.offset, piece.data).second;
  if (is_new) piece_bytes_ += piece.size;
  if (piece_bytes_ < total_bytes_) return "";
  std::string defect = adopt_description();
  if (defect.empty()) update = Update::kRun;
  return defect;
}

std::string RunReader::adopt_description() {
  std::vector<uint8_t> bytes;
  bytes.reserve(static_cast<size_t>(total_bytes_));
  bool is_contiguous = true;
  for (const auto& [offset, data] : pieces_) {
    is_contiguous = is_contiguous && static_cast<size_t>(offset) == bytes.size();
    bytes.insert(bytes.end(), data.begin(), data.end());
  }
  pieces_.clear();
  piece_bytes_ = 0;
  if (!is_contiguous) return "overlapping pieces";
  auto description = std::make_unique<run_description_t>();
  std::string defect = decode(bytes, *description);
  if (!defect.empty()) return defect;
  run_ = std::move(description);
  models_.resize(run_->models.size());
  for (const model_t& model : run_->models) ranges_.push_back(column_ranges(model));
  posture_offsets_ = {0};
  for (const int16_t model : run_->model_of_avatar)
    posture_offsets_.push_back(posture_offsets_.back() +
                               ranges_[static_cast<size_t>(model)].size());
  std::erase_if(touching_, [this](const auto& entry) { return !has_pair(*run_, entry.first); });
  return "";
}

std::string RunReader::handle(const states_t& m, Update& update) {
  if (!run_) return "";
  const auto avatars = static_cast<int64_t>(run_->avatar_count);
  if (m.first_avatar < 0 || m.first_avatar + int64_t{m.avatar_count} > avatars)
    return "avatars that the run does not contain";
  const auto first = static_cast<size_t>(m.first_avatar);
  const auto count = static_cast<size_t>(m.avatar_count);
  const size_t first_value = posture_offsets_[first];
  if (posture_offsets_[first + count] - first_value != static_cast<size_t>(m.joint_position_count))
    return "joint positions that the models do not contain";
  if (m.frame < pending_.frame || m.frame <= state_.frame) return "";
  if (m.frame > pending_.frame || pending_chunks_.size() != static_cast<size_t>(m.chunk_count)) {
    if (pending_avatars_ > 0) ++tally_[Channel::kStates].incomplete;
    pending_.frame = m.frame;
    pending_.utime_us = m.utime;
    pending_.roots.resize(static_cast<size_t>(avatars));
    pending_.speeds_mps.resize(static_cast<size_t>(avatars));
    pending_.postures.resize(posture_offsets_.back());
    pending_.present.resize(static_cast<size_t>(avatars));
    pending_chunks_.assign(static_cast<size_t>(m.chunk_count), false);
    pending_avatars_ = 0;
  }
  if (pending_chunks_[static_cast<size_t>(m.chunk)]) return "";
  pending_chunks_[static_cast<size_t>(m.chunk)] = true;
  for (size_t i = 0, value = 0; i < count; ++i) {
    RootPose& root = pending_.roots[first + i];
    root.position_m = {position_of(m.root_x_100um[i]), position_of(m.root_y_100um[i]),
                       position_of(m.root_z_100um[i])};
    root.world_from_root = rotation_of(m.root_qw[i], m.root_qx[i], m.root_qy[i], m.root_qz[i]);
    pending_.speeds_mps[first + i] = m.speed_mps[i];
    pending_.present[first + i] = m.present.empty() || m.present[i] != 0 ? 1 : 0;
    for (const ColumnRange& range :
         ranges_[static_cast<size_t>(run_->model_of_avatar[first + i])]) {
      pending_.postures[first_value + value] = range.value_of(m.joint_positions[value]);
      ++value;
    }
  }
  pending_avatars_ += m.avatar_count;
  if (std::find(pending_chunks_.begin(), pending_chunks_.end(), false) != pending_chunks_.end())
    return "";
  const bool is_whole = pending_avatars_ == run_->avatar_count;
  pending_avatars_ = 0;
  if (!is_whole) return "chunks that do not cover the run's avatars";
  std::swap(state_, pending_);
  update = Update::kState;
  return "";
}

namespace {

/// A hundred thousand people shoulder to shoulder have a million touching pairs; more is malicious.
constexpr size_t kMaxTouching = size_t{1} << 22;

/// Returns a defect if the run lacks bodies or parts of these pairs; without a description nothing
/// is known.
template <class Message>
std::string defect_of_pairs(const Message& m, const run_description_t* run, size_t touching) {
  if (touching + m.a.size() > kMaxTouching)
    return fmt::format("more than {} touching pairs", kMaxTouching);
  for (size_t i = 0; run != nullptr && i < m.a.size(); ++i)
    if (!has_pair(*run, pair_at(m, i)))
      return fmt::format("a pair that the run does not have: {}:{} - {}:{}", m.a[i], m.part_a[i],
                         m.b[i], m.part_b[i]);
  return "";
}

}  // namespace

std::string RunReader::handle(const events_t& m, Update& update) {
  std::string defect = defect_of_pairs(m, run_.get(), touching_.size());
  if (!defect.empty()) return defect;
  new_events_.clear();
  for (size_t i = 0; i < m.a.size(); ++i) {
    const PairKey pair = pair_at(m, i);
    const auto kind = static_cast<EventKind>(m.kind[i]);
    const auto level = static_cast<PairLevel>(m.level[i]);
    new_events_.push_back({pair, kind, level});
    if (kind == EventKind::kBegin)
      touching_[pair] = level;
    else
      touching_.erase(pair);
  }
  update = Update::kEvents;
  return "";
}

/// Drops rows of another frame, which cannot be completed.
template <class Message>
bool RunReader::starts_anew(Channel channel, const Message& message, ReceivedChunks& received) {
  if (message.frame == received.frame) return false;
  if (!received.chunks.empty()) ++tally_[channel].incomplete;
  received = {message.frame, {}};
  return true;
}

template <class Message>
bool RunReader::completes(const Message& message, ReceivedChunks& received) {
  received.chunks.insert(message.chunk);
  if (received.chunks.size() < static_cast<size_t>(message.chunk_count)) return false;
  received = {};
  return true;
}

std::string RunReader::handle(const touching_t& m, Update& update) {
  std::string defect = defect_of_pairs(m, run_.get(), pending_touching_.size());
  if (!defect.empty()) return defect;
  if (starts_anew(Channel::kTouching, m, touching_chunks_)) pending_touching_.clear();
  for (size_t i = 0; i < m.a.size(); ++i)
    pending_touching_.emplace(pair_at(m, i), static_cast<PairLevel>(m.level[i]));
  if (!completes(m, touching_chunks_)) return "";
  // Later events that arrived first would be undone; the next set, one second later, is right.
  if (m.frame >= tally(Channel::kEvents).last_frame) touching_.swap(pending_touching_);
  pending_touching_.clear();
  update = Update::kTouching;
  return "";
}

std::string RunReader::handle(const proximity_t& m, Update& update) {
  const size_t before = m.frame == proximity_chunks_.frame
                            ? pending_proximity_pairs_.size() + pending_closest_parts_.size()
                            : 0;
  std::string defect = defect_of_pairs(m, run_.get(), before);
  if (!defect.empty()) return defect;
  if (starts_anew(Channel::kProximity, m, proximity_chunks_)) {
    pending_proximity_pairs_.clear();
    pending_closest_parts_.clear();
  }
  if (proximity_chunks_.chunks.contains(m.chunk)) return "";
  for (size_t i = 0; i < m.a.size(); ++i) {
    (m.kind[i] == 0 ? pending_proximity_pairs_ : pending_closest_parts_)
        .push_back(proximity_at(m, i));
  }
  if (!completes(m, proximity_chunks_)) return "";
  proximity_pairs_.swap(pending_proximity_pairs_);
  closest_parts_.swap(pending_closest_parts_);
  update = Update::kProximity;
  return "";
}

std::string RunReader::handle(const contact_points_t& m, Update& update) {
  const size_t before = m.frame == contact_chunks_.frame ? pending_contact_points_.size() : 0;
  std::string defect = defect_of_pairs(m, run_.get(), before);
  if (!defect.empty()) return defect;
  if (starts_anew(Channel::kContactPoints, m, contact_chunks_)) pending_contact_points_.clear();
  if (contact_chunks_.chunks.contains(m.chunk)) return "";
  for (size_t i = 0; i < m.a.size(); ++i) pending_contact_points_.push_back(contact_at(m, i));
  if (!completes(m, contact_chunks_)) return "";
  contact_points_.swap(pending_contact_points_);
  update = Update::kContactPoints;
  return "";
}

std::string RunReader::handle(const separation_t& m, Update& update) {
  for (size_t i = 0; run_ != nullptr && i < m.robot.size(); ++i)
    if (std::max(m.robot[i], m.person[i]) >= run_->avatar_count)
      return fmt::format("a robot {} and a person {} that the run does not have", m.robot[i],
                         m.person[i]);
  new_shortfalls_.clear();
  for (size_t i = 0; i < m.robot.size(); ++i) new_shortfalls_.push_back(shortfall_at(m, i));
  update = Update::kSeparation;
  return "";
}

std::shared_ptr<const Model> RunReader::model(size_t index) {
  std::shared_ptr<const Model>& model = models_.at(index);
  if (!model) model = to_model(run_->models.at(index));
  return model;
}

void RunReader::part_poses(int avatar, std::vector<PartPose>& out) {
  const auto i = static_cast<size_t>(avatar);
  const std::shared_ptr<const Model> body = model(static_cast<size_t>(run_->model_of_avatar.at(i)));
  const RootFrame root{state_.roots.at(i).world_from_root, run_->scale_of_avatar.at(i)};
  out.resize(static_cast<size_t>(body->part_count()));
  forward_kinematics(
      body->kinematics,
      std::span(state_.postures)
          .subspan(posture_offsets_[i], posture_offsets_[i + 1] - posture_offsets_[i]),
      {&root, 1}, out);
}

}  // namespace throng
