#include "lcm_io/codec/encoder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "base/checksum.h"
#include "base/errors.h"
#include "base/limits.h"
#include "lcm_io/codec/log_format.h"
#include "lcm_io/codec/rows.h"
#include "scenes/run/stages.h"

namespace throng {
namespace {

constexpr int64_t kSecond_us = 1'000'000;

// All positions on the largest ground, and of all parts there, fit into int32.
static_assert(kMaxCoordinate_m + kMaxReach_m < 214'000);

// Header fields that differ between targets.
constexpr size_t kInstanceAt = 8 + 2 * 8, kSeqAt = 8 + 4 * 8;

constexpr auto kRunBytes = static_cast<int>(kRowsPerMessage<run_chunk_t>);
constexpr size_t kStatesFixed = kHeaderBytes + 5 * sizeof(int32_t);
constexpr size_t kStatesPerAvatar = 3 * 4 + 4 * 2 + 4 + 1;  // with the byte for presence

/// A message takes some hundred microseconds; all slots together fit into the L2 cache.
constexpr size_t kSlotsAThread = 4;

/// Throws InputError if a reader would reject that many chunks.
void require_few(const RunInfo& run, size_t chunks) {
  if (chunks > static_cast<size_t>(kMaxChunks))
    throw InputError(
        run.scene->name,
        fmt::format("avatars and joints for at most {} messages per frame", kMaxChunks),
        fmt::format("{}", chunks));
}

uint8_t level_at(std::span<const uint8_t> levels, size_t i, PairLevel last) {
  return levels.empty() ? static_cast<uint8_t>(last) : levels[i];
}

template <class Message>
std::span<uint8_t> encoded(const Message& message, std::vector<uint8_t>& buffer) {
  const int size = message.encode(buffer.data(), 0, static_cast<int>(buffer.size()));
  assert(size > 0);
  return {buffer.data(), static_cast<size_t>(size)};
}

}  // namespace

int TargetState::description_chunks() const {
  return chunks_of(encoder_.description_.size(), static_cast<size_t>(kRunBytes));
}

void TargetState::send_description_chunk(int chunk) {
  encoder_.send_description_chunk(*this, chunk);
}

void TargetState::repeat_end() { encoder_.send(*this, Channel::kEnd, end_, 0, 1); }

void TargetState::send_last_checksums() {
  encoder_.send_checksums(*this, encoder_.last_hash_, true);
}

void RunEncoder::add(const EncoderOptions& options, MessageTarget& target) {
  assert(options.state_every >= 1);
  target_states_.push_back(std::make_unique<TargetState>(*this, options, target));
}

void RunEncoder::choose_targets() {
  open_targets_.clear();
  for (const auto& target_state : target_states_)
    if (target_state->target_.wants_messages()) open_targets_.push_back(target_state.get());
}

template <class Message>
void RunEncoder::fill_header(Message& message, int chunk, int chunk_count) const {
  message.utime = utime_us_;
  message.run_id = run_id_;
  message.frame = frame_;
  message.chunk = chunk;
  message.chunk_count = chunk_count;
  message.schema = kSchema;
}

/// Sets the header fields that depend on the target, for a message `ahead` positions after the
/// next.
void RunEncoder::set_target_header(const TargetState& to, Channel channel, int64_t ahead,
                                   std::span<uint8_t> bytes) {
  put_big_endian(bytes.data() + kInstanceAt, to.instance_);
  put_big_endian(bytes.data() + kSeqAt, to.sent_[channel].messages + ahead);
}

template <class Message>
void RunEncoder::send(const TargetStates& to, Channel channel, Message& message, int chunk,
                      int chunk_count) {
  fill_header(message, chunk, chunk_count);
  const std::span<uint8_t> bytes = encoded(message, buffer_);
  for (TargetState* target_state : to) {
    set_target_header(*target_state, channel, 0, bytes);
    deliver(*target_state, channel, bytes, checksum(bytes));
  }
}

template <class Message>
void RunEncoder::send(TargetState& to, Channel channel, Message& message, int chunk,
                      int chunk_count) {
  fill_header(message, chunk, chunk_count);
  const std::span<uint8_t> bytes = encoded(message, buffer_);
  set_target_header(to, channel, 0, bytes);
  deliver(to, channel, bytes, checksum(bytes));
}

void RunEncoder::deliver(TargetState& to, Channel channel, std::span<const uint8_t> bytes,
                         uint64_t checksum) {
  to.sent_.add(channel, to.sent_.messages(), utime_us_, bytes.size(), checksum);
  to.target_.message(channel, utime_us_, bytes);
}

void RunEncoder::begin(const RunInfo& run) {
  run_id_ = static_cast<int64_t>(run.run_id);
  last_level_ = run.culler.exact ? PairLevel::kTriangles : PairLevel::kPartVolume;
  int threads = 1;
  bool part_poses = false;
  for (const auto& target_state : target_states_) {
    target_state->instance_ =
        target_state->options_.with_instance ? static_cast<int64_t>(run.instance) : 0;
    target_state->sent_ = {};
    target_state->clamped_ = 0;
    threads = std::max(threads, target_state->options_.threads);
    part_poses = part_poses || target_state->options_.part_poses;
  }
  if (!workers_ || workers_->threads() != threads) workers_.emplace(threads);
  utime_us_ = frame_ = 0;
  last_second_ = -1;

  monitor_.reset();
  if (run.scene->separation) monitor_.emplace(run);
  describe_checksums(run, checks_);

  description_ = encode_description(run);

  ranges_.clear();
  for (const auto& model : run.models) ranges_.push_back(column_ranges(*model));

  // Each message takes as many avatars as fit; postures differ in width between models.
  const auto plan = [&](size_t fixed, size_t per_avatar, size_t per_item, auto items_of) {
    std::vector<AvatarRange> chunks;
    size_t bytes = kMaxMessageBytes;
    for (int avatar = 0; avatar < run.avatar_count(); ++avatar) {
      const int items = items_of(run.model_of_avatar[static_cast<size_t>(avatar)]);
      const size_t more = per_avatar + per_item * static_cast<size_t>(items);
      if (chunks.empty() || bytes + more > kMaxMessageBytes) {
        chunks.push_back({avatar, 0, 0});
        bytes = fixed;
      }
      bytes += more;
      ++chunks.back().count;
      chunks.back().items += items;
    }
    return chunks;
  };
  state_chunks_ = plan(kStatesFixed, kStatesPerAvatar, 2,
                       [&](uint16_t model) { return static_cast<int>(ranges_[model].size()); });
  require_few(run, state_chunks_.size());
  const size_t slots = threads == 1 ? 1 : kSlotsAThread * static_cast<size_t>(threads);
  states_.resize(std::max<size_t>(1, std::min(state_chunks_.size(), slots)));
  for (StatesSlot& slot : states_) {
    slot.bytes.resize(kMaxMessageBytes);
    slot.checksums.resize(target_states_.size());
  }
  part_chunks_ = plan(kFixedBytes<part_poses_t>, 0, kRowBytes<part_poses_t>,
                      [&](uint16_t model) { return run.models[model]->part_count(); });
  if (part_poses) require_few(run, part_chunks_.size());
  choose_targets();
  for (TargetState* target_state : open_targets_) target_state->target_.after_begin(*target_state);
}

void RunEncoder::send_description_chunk(TargetState& to, int chunk) {
  const auto total = static_cast<int>(description_.size());
  run_.total_bytes = total;
  run_.offset = chunk * kRunBytes;
  run_.size = std::min(kRunBytes, total - run_.offset);
  const auto first = description_.begin() + run_.offset;
  run_.data.assign(first, first + run_.size);
  send(to, Channel::kRun, run_, chunk, to.description_chunks());
}

void RunEncoder::frame(const RunInfo& run, const Frame& frame) {
  choose_targets();
  const bool is_first = last_second_ < 0;
  if (run.resumed && is_first) {  // events refer to these pairs
    utime_us_ = run.resumed->utime_us;
    frame_ = run.resumed->frame;
    send_touching(run.resumed->touching, run.resumed->levels);
  }
  utime_us_ = frame.utime_us;
  frame_ = frame.number;
  send_changes(frame.changes);
  send_events(frame.events);
  if (frame.utime_us / kSecond_us != last_second_) {
    last_second_ = frame.utime_us / kSecond_us;
    send_touching(frame.pairs, frame.levels);
  }
  if (run.culler.proximity.is_enabled()) send_proximity(run, frame);
  if (run.culler.proximity.contact_points) send_contacts(frame.contact_points);
  if (monitor_) {
    monitor_->frame(run, frame);
    send_separation();
  }
  states_targets_.clear();
  part_poses_targets_.clear();
  for (TargetState* target_state : open_targets_) {
    if (!is_first && !states_are_due(target_state->options_.state_every, frame.number)) continue;
    states_targets_.push_back(target_state);
    if (target_state->options_.part_poses) part_poses_targets_.push_back(target_state);
  }
  if (!states_targets_.empty()) send_states(run, frame);
  if (!part_poses_targets_.empty()) send_part_poses(run, frame);
  const auto begins = std::count_if(frame.events.begin(), frame.events.end(),
                                    [](const PairEvent& e) { return e.kind == EventKind::kBegin; });
  for (TargetState* target_state : open_targets_) {
    send_frame_stats(*target_state, frame, begins);
    send_checksums(*target_state, frame.hash, false);
  }
  for (TargetState* target_state : open_targets_) target_state->target_.after_frame(*target_state);
}

/// Sends at least one message, so that receivers learn of empty frames. set(first, count) fills
/// `m`.
template <class Message, class Set>
void RunEncoder::send_rows(Channel channel, Message& m, size_t rows, const Set& set) {
  constexpr size_t per_message = kRowsPerMessage<Message>;
  const int chunks = std::max(1, chunks_of(rows, per_message));
  for (int chunk = 0; chunk < chunks; ++chunk) {
    const size_t first = static_cast<size_t>(chunk) * per_message;
    set(first, std::min(per_message, rows - first));
    send(open_targets_, channel, m, chunk, chunks);
  }
}

void RunEncoder::send_events(std::span<const PairEvent> events) {
  const int chunks = chunks_of(events.size(), kRowsPerMessage<events_t>);
  for (int chunk = 0; chunk < chunks; ++chunk) {
    const size_t first = static_cast<size_t>(chunk) * kRowsPerMessage<events_t>;
    set_events(events_,
               events.subspan(first, std::min(kRowsPerMessage<events_t>, events.size() - first)));
    send(open_targets_, Channel::kEvents, events_, chunk, chunks);
  }
}

void RunEncoder::send_touching(std::span<const PairKey> pairs, std::span<const uint8_t> levels) {
  assert(levels.empty() || levels.size() == pairs.size());
  send_rows(Channel::kTouching, touching_, pairs.size(), [&](size_t first, size_t count) {
    resize_pairs(touching_, count);
    for (size_t i = 0; i < count; ++i)
      set_pair(touching_, i, pairs[first + i], level_at(levels, first + i, last_level_));
  });
}

void RunEncoder::send_proximity(const RunInfo& run, const Frame& frame) {
  const size_t rows = frame.proximity_pairs.size() + frame.closest_parts.size();
  send_rows(Channel::kProximity, proximity_, rows, [&](size_t first, size_t) {
    set_proximity_chunk(proximity_, run.culler.proximity, frame.proximity_hash,
                        frame.proximity_pairs, frame.closest_parts, first);
  });
}

void RunEncoder::send_contacts(std::span<const ContactPoint> points) {
  send_rows(Channel::kContactPoints, contacts_, points.size(), [&](size_t first, size_t count) {
    set_contacts(contacts_, points.subspan(first, count));
  });
}

void RunEncoder::send_changes(std::span<const CrowdChange> changes) {
  int chunks = 0, chunk = 0;
  for (const CrowdChange& change : changes)
    chunks += chunks_of(change.ids.size(), kAgentsPerChange);
  for (const CrowdChange& change : changes)
    for (size_t first = 0; first < change.ids.size(); first += kAgentsPerChange) {
      set_change(crowd_change_, change, first,
                 std::min(kAgentsPerChange, change.ids.size() - first));
      send(open_targets_, Channel::kChanges, crowd_change_, chunk++, chunks);
    }
}

void RunEncoder::send_separation() {
  const std::span<const Shortfall> begun = monitor_->begun(), ended = monitor_->ended();
  const size_t rows = begun.size() + ended.size();
  const int chunks = chunks_of(rows, kRowsPerMessage<separation_t>);
  for (int chunk = 0; chunk < chunks; ++chunk) {
    const size_t first = static_cast<size_t>(chunk) * kRowsPerMessage<separation_t>;
    const size_t count = std::min(kRowsPerMessage<separation_t>, rows - first);
    begin_separation(separation_, count);
    for (size_t i = 0; i < count; ++i) {
      const bool is_begin = first + i < begun.size();
      set_shortfall(separation_, i, is_begin ? EventKind::kBegin : EventKind::kEnd,
                    is_begin ? begun[first + i] : ended[first + i - begun.size()]);
    }
    send(open_targets_, Channel::kSeparation, separation_, chunk, chunks);
  }
}

bool RunEncoder::states_are_due(double state_every, int64_t frame) const {
  // Tolerates a multiple just after its frame, caused by rounding.
  const auto multiples = [state_every](int64_t number) {
    return std::floor(static_cast<double>(number) / state_every + 1e-6);
  };
  return multiples(frame) > multiples(frame - 1);
}

/// Encodes several chunks in parallel, then sends them in order.
void RunEncoder::send_states(const RunInfo& run, const Frame& frame) {
  assert(static_cast<int>(frame.roots.size()) == run.avatar_count());
  const auto chunks = static_cast<int>(state_chunks_.size());
  const auto slots = static_cast<int>(states_.size());
  for (int first = 0; first < chunks; first += slots) {
    const int count = std::min(slots, chunks - first);
    workers_->for_blocks(count, [&](int i, int) {
      StatesSlot& slot = states_[static_cast<size_t>(i)];
      const int chunk = first + i;
      fill_states(run, frame, state_chunks_[static_cast<size_t>(chunk)], slot.message);
      fill_header(slot.message, chunk, chunks);
      const std::span<uint8_t> bytes = encoded(slot.message, slot.bytes);
      slot.size = bytes.size();
      for (size_t t = 0; t < states_targets_.size(); ++t) {
        set_target_header(*states_targets_[t], Channel::kStates, i, bytes);
        slot.checksums[t] = checksum(bytes);
      }
    });
    for (int i = 0; i < count; ++i) {
      StatesSlot& slot = states_[static_cast<size_t>(i)];
      const std::span<uint8_t> bytes(slot.bytes.data(), slot.size);
      for (size_t t = 0; t < states_targets_.size(); ++t) {
        TargetState& target_state = *states_targets_[t];
        target_state.clamped_ += slot.message.clamped;
        set_target_header(target_state, Channel::kStates, 0, bytes);
        deliver(target_state, Channel::kStates, bytes, slot.checksums[t]);
      }
    }
  }
}

void RunEncoder::fill_states(const RunInfo& run, const Frame& frame, const AvatarRange& range,
                             states_t& m) const {
  const auto count = static_cast<size_t>(range.count);
  m.first_avatar = range.first;
  m.avatar_count = range.count;
  m.joint_position_count = range.items;
  m.clamped = 0;
  for (auto* column : {&m.root_x_100um, &m.root_y_100um, &m.root_z_100um}) column->resize(count);
  for (auto* column : {&m.root_qw, &m.root_qx, &m.root_qy, &m.root_qz}) column->resize(count);
  m.speed_mps.resize(count);
  m.joint_positions.resize(static_cast<size_t>(range.items));
  const auto first = static_cast<size_t>(range.first);
  m.present.clear();
  if (!frame.present.empty()) {
    const auto present = frame.present.subspan(first, count);
    if (std::find(present.begin(), present.end(), 0) != present.end())
      m.present.assign(present.begin(), present.end());
  }
  m.present_count = static_cast<int32_t>(m.present.size());
  size_t value = 0;
  for (size_t i = 0; i < count; ++i) {
    const size_t avatar = first + i;
    const RootPose& root = frame.roots[avatar];
    m.root_x_100um[i] = quantised_position(root.position_m.x(), m.clamped);
    m.root_y_100um[i] = quantised_position(root.position_m.y(), m.clamped);
    m.root_z_100um[i] = quantised_position(root.position_m.z(), m.clamped);
    m.root_qw[i] = quantised_unit(root.world_from_root.w(), m.clamped);
    m.root_qx[i] = quantised_unit(root.world_from_root.x(), m.clamped);
    m.root_qy[i] = quantised_unit(root.world_from_root.y(), m.clamped);
    m.root_qz[i] = quantised_unit(root.world_from_root.z(), m.clamped);
    m.speed_mps[i] = frame.speeds_mps[avatar];
    const float* posture = frame.postures.data() + frame.posture_offsets[avatar];
    for (const ColumnRange& column : ranges_[run.model_of_avatar[avatar]])
      m.joint_positions[value++] = column.quantised_value(*posture++, m.clamped);
  }
}

void RunEncoder::send_part_poses(const RunInfo& run, const Frame& frame) {
  const auto chunks = static_cast<int>(part_chunks_.size());
  for (int chunk = 0; chunk < chunks; ++chunk) {
    const AvatarRange& range = part_chunks_[static_cast<size_t>(chunk)];
    part_poses_t& m = parts_;
    m.first_avatar = range.first;
    m.avatar_count = range.count;
    m.part_count = range.items;
    m.clamped = 0;
    for (auto* column : {&m.x_100um, &m.y_100um, &m.z_100um}) column->clear();
    for (auto* column : {&m.qw, &m.qx, &m.qy, &m.qz}) column->clear();
    for (int i = range.first; i < range.first + range.count; ++i) {
      const auto avatar = static_cast<size_t>(i);
      const size_t first = frame.posture_offsets[avatar];
      add_part_poses(*run.models[run.model_of_avatar[avatar]], frame.roots[avatar],
                     run.scale_of_avatar[avatar],
                     frame.postures.subspan(first, frame.posture_offsets[avatar + 1] - first));
    }
    for (TargetState* target_state : part_poses_targets_) target_state->clamped_ += m.clamped;
    send(part_poses_targets_, Channel::kPartPoses, m, chunk, chunks);
  }
}

void RunEncoder::add_part_poses(const Model& model, const RootPose& root, float scale,
                                std::span<const float> posture) {
  const RootFrame root_frame{root.world_from_root, scale};
  poses_.resize(static_cast<size_t>(model.part_count()));
  forward_kinematics(model.kinematics, posture, {&root_frame, 1}, poses_);
  part_poses_t& m = parts_;
  for (const PartPose& pose : poses_) {
    const Eigen::Isometry3d relative = to_isometry(pose);
    const Eigen::Vector3d position = root.position_m + relative.translation();
    const Eigen::Quaternionf q(Eigen::Quaterniond(relative.linear()).cast<float>());
    m.x_100um.push_back(quantised_position(position.x(), m.clamped));
    m.y_100um.push_back(quantised_position(position.y(), m.clamped));
    m.z_100um.push_back(quantised_position(position.z(), m.clamped));
    m.qw.push_back(quantised_unit(q.w(), m.clamped));
    m.qx.push_back(quantised_unit(q.x(), m.clamped));
    m.qy.push_back(quantised_unit(q.y(), m.clamped));
    m.qz.push_back(quantised_unit(q.z(), m.clamped));
  }
}

void RunEncoder::send_frame_stats(TargetState& to, const Frame& frame, int64_t begins) {
  // A log contains no clock times and is therefore reproducible.
  const bool clock = to.options_.with_clock_times;
  frame_stats_t& m = frame_stats_;
  const auto stages = culling_stages(*frame.counters);
  static_assert(std::extent_v<decltype(m.updates)> == kCullingStageCount);
  for (size_t i = 0; i < kCullingStageCount; ++i) {
    m.updates[i] = static_cast<int64_t>(stages[i]->updates);
    m.tests[i] = static_cast<int64_t>(stages[i]->tests);
    m.passed[i] = static_cast<int64_t>(stages[i]->passed);
    m.update_ns[i] = clock ? stages[i]->update_ns : 0;
    m.test_ns[i] = clock ? stages[i]->test_ns : 0;
  }
  m.posed_bodies = static_cast<int64_t>(frame.counters->posed_bodies);
  m.begins = begins;
  m.ends = static_cast<int64_t>(frame.events.size()) - begins;
  m.persisting = static_cast<int64_t>(frame.persisting);
  m.touching = static_cast<int64_t>(frame.pairs.size());
  const FrameTimes times = clock && frame.times ? *frame.times : FrameTimes{};
  static_assert(std::extent_v<decltype(m.stage_ns)> == kStageCount);
  std::copy(times.stage_ns.begin(), times.stage_ns.end(), m.stage_ns);
  m.frame_ns = times.frame_ns;
  send(to, Channel::kFrameStats, m, 0, 1);
}

void RunEncoder::send_checksums(TargetState& to, uint64_t hash, bool is_last) {
  fill_header(checks_, 0, 1);
  checks_.message_index = to.sent_.messages();
  checks_.hash = static_cast<int64_t>(hash);
  checks_.is_last = is_last;
  to.sent_.fill(checks_);
  const std::span<uint8_t> bytes = encoded(checks_, buffer_);
  set_target_header(to, Channel::kChecksums, 0, bytes);
  seal(bytes);
  deliver(to, Channel::kChecksums, bytes, checksum(bytes));
}

void RunEncoder::fill_end(const RunEnd& end, const TargetState& of, end_t& m) {
  m.frames = end.frames;
  m.begins = static_cast<int64_t>(end.begins);
  m.ends = static_cast<int64_t>(end.ends);
  m.hash = static_cast<int64_t>(end.hash);
  m.channels.clear();
  m.messages.clear();
  m.bytes.clear();
  for (const Channel channel : kAllChannels) {
    if (channel == Channel::kEnd || !is_named(channel, of.totals(channel).messages)) continue;
    m.channels.emplace_back(name_of(channel));
    m.messages.push_back(of.totals(channel).messages);
    m.bytes.push_back(of.totals(channel).bytes);
  }
  m.channel_count = static_cast<int32_t>(m.channels.size());
}

void RunEncoder::end(const RunInfo&, const RunEnd& end) {
  choose_targets();
  utime_us_ = end.utime_us;
  frame_ = end.frames;
  last_hash_ = end.hash;
  send_events(end.events);
  if (monitor_) {
    monitor_->end();
    send_separation();
  }
  for (TargetState* target_state : open_targets_) {
    fill_end(end, *target_state, target_state->end_);
    send(*target_state, Channel::kEnd, target_state->end_, 0, 1);
    target_state->target_.after_end(*target_state);
  }
}

void require_encodable(const RunInfo& run, bool part_poses) {
  struct : MessageTarget {
    void message(Channel, int64_t, std::span<const uint8_t>) override {}
  } discard;
  EncoderOptions options;
  options.part_poses = part_poses;
  RunEncoder(options, discard).begin(run);
}

}  // namespace throng
