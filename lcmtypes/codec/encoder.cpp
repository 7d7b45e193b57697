#include "lcmtypes/codec/encoder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>

#include "base/errors.h"
#include "base/files/checksum.h"
#include "base/limits.h"
#include "lcmtypes/codec/readable.h"

namespace throng {
namespace {

constexpr int64_t kSecond_us = 1'000'000;

// Whoever stands on a scene's ground, and every part of a body there, is nearer than int32 tells.
static_assert(kMaxCoordinate_m + kMaxReach_m < 214'000);

// Fingerprint, five int64 and three int32 that every message begins with.
constexpr size_t kHeaderBytes = 8 + 5 * 8 + 3 * 4;

constexpr int kRunBytes = static_cast<int>(kMaxMessageBytes - kHeaderBytes) - 12;
constexpr size_t kStatesFixed = kHeaderBytes + 5 * 4;
constexpr size_t kStatesPerAvatar = 3 * 4 + 4 * 2 + 4 + 1;  // with the byte of who is absent
constexpr size_t kPartsFixed = kHeaderBytes + 4 * 4;
constexpr size_t kPartsPerPart = 3 * 4 + 4 * 2;
constexpr size_t kEventsPerMessage = (kMaxMessageBytes - kHeaderBytes - 4) / 12;
constexpr size_t kTouchingPerMessage = (kMaxMessageBytes - kHeaderBytes - 4) / 11;

/// A message takes some hundred microseconds; all slots together fit the second cache.
constexpr size_t kSlotsAThread = 4;

constexpr int chunks_of(size_t items, size_t per_chunk) {
  return static_cast<int>(items / per_chunk + (items % per_chunk != 0));
}

/// A reader takes no more pieces of one thing.
void require_few(const RunInfo& run, size_t chunks) {
  if (chunks > static_cast<size_t>(kMaxChunks))
    throw InputError(run.scene->name,
                     fmt::format("avatars and joints for at most {} messages a frame", kMaxChunks),
                     fmt::format("{}", chunks));
}

/// `levels` may be empty: then everything got as far as this run refines.
uint8_t level_at(std::span<const uint8_t> levels, size_t i, PairLevel last) {
  return levels.empty() ? static_cast<uint8_t>(last) : levels[i];
}

/// The message in the room of `buffer`, which holds the largest.
template <class Message>
std::span<const uint8_t> encoded(const Message& message, std::vector<uint8_t>& buffer) {
  const int size = message.encode(buffer.data(), 0, static_cast<int>(buffer.size()));
  assert(size > 0);
  return {buffer.data(), static_cast<size_t>(size)};
}

}  // namespace

RunEncoder::RunEncoder(const EncoderOptions& options, MessageTarget& target)
    : options_(options), target_(target), workers_(options.threads), buffer_(kMaxMessageBytes) {
  assert(options.state_every >= 1);
}

template <class Message>
void RunEncoder::number(Message& message, int64_t seq, int chunk, int chunk_count) const {
  message.utime = utime_us_;
  message.run_id = run_id_;
  message.instance = instance_;
  message.frame = frame_;
  message.seq = seq;
  message.chunk = chunk;
  message.chunk_count = chunk_count;
  message.schema = kSchema;
}

template <class Message>
void RunEncoder::send(Channel channel, Message& message, int chunk, int chunk_count) {
  number(message, said_[channel].messages, chunk, chunk_count);
  const std::span<const uint8_t> bytes = encoded(message, buffer_);
  hand_over(channel, bytes, checksum(bytes));
}

void RunEncoder::hand_over(Channel channel, std::span<const uint8_t> bytes, uint64_t checksum) {
  said_.add(channel, said_.messages(), utime_us_, bytes.size(), checksum);
  target_.message(channel, utime_us_, bytes);
}

void require_readable(const RunInfo& run, bool part_poses) {
  struct : MessageTarget {
    void message(Channel, int64_t, std::span<const uint8_t>) override {}
  } nobody;
  EncoderOptions options;
  options.part_poses = part_poses;
  RunEncoder(options, nobody).begin(run);
}

void RunEncoder::begin(const RunInfo& run) {
  run_id_ = static_cast<int64_t>(run.run_id);
  last_level_ = run.exact ? PairLevel::kExact : PairLevel::kPartVolume;
  instance_ = options_.with_instance ? static_cast<int64_t>(run.instance) : 0;
  said_ = {};
  clamped_ = 0;
  utime_us_ = frame_ = 0;
  last_second_ = -1;

  describe_checks(run, checks_);

  description_ = readable_description(run);

  ranges_.clear();
  for (const auto& model : run.models) ranges_.push_back(column_ranges(*model));

  // As many avatars a message as fit, model by model of different width.
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
  const auto threads = static_cast<size_t>(options_.threads);
  states_.resize(threads == 1 ? 1 : std::min(state_chunks_.size(), kSlotsAThread * threads));
  for (StatesSlot& slot : states_) slot.bytes.resize(kMaxMessageBytes);
  part_chunks_ = plan(kPartsFixed, 0, kPartsPerPart,
                      [&](uint16_t model) { return run.models[model]->part_count(); });
  if (options_.part_poses) require_few(run, part_chunks_.size());
}

int RunEncoder::description_chunks() const {
  return chunks_of(description_.size(), static_cast<size_t>(kRunBytes));
}

void RunEncoder::send_description_chunk(int chunk) {
  const auto total = static_cast<int>(description_.size());
  run_.total_bytes = total;
  run_.offset = chunk * kRunBytes;
  run_.size = std::min(kRunBytes, total - run_.offset);
  const auto first = description_.begin() + run_.offset;
  run_.data.assign(first, first + run_.size);
  send(Channel::kRun, run_, chunk, description_chunks());
}

void RunEncoder::frame(const RunInfo& run, const Frame& frame) {
  const bool is_first = last_second_ < 0;
  if (run.resumed && is_first) {  // what the first events refer to
    utime_us_ = run.resumed->utime_us;
    frame_ = run.resumed->frame;
    send_touching(run.resumed->touching, run.resumed->levels);
  }
  utime_us_ = frame.utime_us;
  frame_ = frame.number;
  send_events(frame.events);
  if (frame.utime_us / kSecond_us != last_second_) {
    last_second_ = frame.utime_us / kSecond_us;
    send_touching(frame.pairs, frame.levels);
  }
  if (is_first || states_are_due(frame.number)) {
    send_states(run, frame);
    if (options_.part_poses) send_parts(run, frame);
  }
  send_counters(frame);
  send_checks(frame.hash);
}

void RunEncoder::send_events(std::span<const PairEvent> events) {
  const int chunks = chunks_of(events.size(), kEventsPerMessage);
  for (int chunk = 0; chunk < chunks; ++chunk) {
    const size_t first = static_cast<size_t>(chunk) * kEventsPerMessage;
    const size_t count = std::min(kEventsPerMessage, events.size() - first);
    events_t& m = events_;
    m.count = static_cast<int32_t>(count);
    m.a.resize(count);
    m.b.resize(count);
    m.part_a.resize(count);
    m.part_b.resize(count);
    m.kind.resize(count);
    m.level.resize(count);
    for (size_t i = 0; i < count; ++i) {
      const PairEvent& event = events[first + i];
      m.a[i] = static_cast<int32_t>(event.pair.a());
      m.b[i] = static_cast<int32_t>(event.pair.b());
      m.part_a[i] = static_cast<uint8_t>(event.pair.part_a());
      m.part_b[i] = static_cast<uint8_t>(event.pair.part_b());
      m.kind[i] = static_cast<uint8_t>(event.kind);
      m.level[i] = static_cast<uint8_t>(event.level);
    }
    send(Channel::kEvents, m, chunk, chunks);
  }
}

void RunEncoder::send_touching(std::span<const PairKey> pairs, std::span<const uint8_t> levels) {
  assert(levels.empty() || levels.size() == pairs.size());
  // Also when nothing touches: a receiver learns that its set should be empty.
  const int chunks = std::max(1, chunks_of(pairs.size(), kTouchingPerMessage));
  for (int chunk = 0; chunk < chunks; ++chunk) {
    const size_t first = static_cast<size_t>(chunk) * kTouchingPerMessage;
    const size_t count = std::min(kTouchingPerMessage, pairs.size() - first);
    touching_t& m = touching_;
    m.count = static_cast<int32_t>(count);
    m.a.resize(count);
    m.b.resize(count);
    m.part_a.resize(count);
    m.part_b.resize(count);
    m.level.resize(count);
    for (size_t i = 0; i < count; ++i) {
      const PairKey pair = pairs[first + i];
      m.a[i] = static_cast<int32_t>(pair.a());
      m.b[i] = static_cast<int32_t>(pair.b());
      m.part_a[i] = static_cast<uint8_t>(pair.part_a());
      m.part_b[i] = static_cast<uint8_t>(pair.part_b());
      m.level[i] = level_at(levels, first + i, last_level_);
    }
    send(Channel::kTouching, m, chunk, chunks);
  }
}

bool RunEncoder::states_are_due(int64_t frame) const {
  // A multiple that rounding put a hair behind its frame is that frame's all the same.
  const auto multiples = [this](int64_t number) {
    return std::floor(static_cast<double>(number) / options_.state_every + 1e-6);
  };
  return multiples(frame) > multiples(frame - 1);
}

/// Some chunks at a time are encoded side by side, then sent in their order.
void RunEncoder::send_states(const RunInfo& run, const Frame& frame) {
  assert(static_cast<int>(frame.roots.size()) == run.avatar_count());
  const int64_t seq = said_[Channel::kStates].messages;
  const auto chunks = static_cast<int>(state_chunks_.size());
  const auto slots = static_cast<int>(states_.size());
  for (int first = 0; first < chunks; first += slots) {
    const int count = std::min(slots, chunks - first);
    workers_.for_blocks(count, [&](int i, int) {
      StatesSlot& slot = states_[static_cast<size_t>(i)];
      fill_states(run, frame, state_chunks_[static_cast<size_t>(first + i)], slot.message);
      number(slot.message, seq + first + i, first + i, chunks);
      const std::span<const uint8_t> bytes = encoded(slot.message, slot.bytes);
      slot.size = bytes.size();
      slot.checksum = checksum(bytes);
    });
    for (int i = 0; i < count; ++i) {
      const StatesSlot& slot = states_[static_cast<size_t>(i)];
      clamped_ += slot.message.clamped;
      hand_over(Channel::kStates, {slot.bytes.data(), slot.size}, slot.checksum);
    }
  }
}

void RunEncoder::fill_states(const RunInfo& run, const Frame& frame, const AvatarRange& range,
                             states_t& m) const {
  const auto count = static_cast<size_t>(range.count);
  m.first_avatar = range.first;
  m.avatar_count = range.count;
  m.joint_value_count = range.items;
  m.clamped = 0;
  for (auto* column : {&m.root_x_100um, &m.root_y_100um, &m.root_z_100um}) column->resize(count);
  for (auto* column : {&m.root_qw, &m.root_qx, &m.root_qy, &m.root_qz}) column->resize(count);
  m.speed_mps.resize(count);
  m.joint_values.resize(static_cast<size_t>(range.items));
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
      m.joint_values[value++] = column.quantised_value(*posture++, m.clamped);
  }
}

void RunEncoder::send_parts(const RunInfo& run, const Frame& frame) {
  const auto chunks = static_cast<int>(part_chunks_.size());
  for (int chunk = 0; chunk < chunks; ++chunk) {
    const AvatarRange& range = part_chunks_[static_cast<size_t>(chunk)];
    parts_t& m = parts_;
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
    clamped_ += m.clamped;
    send(Channel::kParts, m, chunk, chunks);
  }
}

void RunEncoder::add_part_poses(const Model& model, const RootPose& root, float scale,
                                std::span<const float> posture) {
  const RootFrame root_frame{root.world_from_root, scale};
  poses_.resize(static_cast<size_t>(model.part_count()));
  forward_kinematics(model.kinematics, posture, {&root_frame, 1}, poses_);
  parts_t& m = parts_;
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

void RunEncoder::send_counters(const Frame& frame) {
  counters_t& m = counters_;
  const CullingCounters& c = *frame.counters;
  const StageCounters* stages[] = {&c.avatar, &c.box, &c.part, &c.exact};
  const bool clock = options_.with_clock_times;
  for (size_t i = 0; i < std::size(stages); ++i) {
    m.updates[i] = static_cast<int64_t>(stages[i]->updates);
    m.tests[i] = static_cast<int64_t>(stages[i]->tests);
    m.passed[i] = static_cast<int64_t>(stages[i]->passed);
    m.update_ns[i] = clock ? stages[i]->update_ns : 0;
    m.test_ns[i] = clock ? stages[i]->test_ns : 0;
  }
  m.posed_bodies = static_cast<int64_t>(c.posed_bodies);
  m.begins = std::count_if(frame.events.begin(), frame.events.end(),
                           [](const PairEvent& e) { return e.kind == EventKind::kBegin; });
  m.ends = static_cast<int64_t>(frame.events.size()) - m.begins;
  m.persisting = static_cast<int64_t>(frame.persisting);
  m.touching = static_cast<int64_t>(frame.pairs.size());
  const FrameTimes times = clock && frame.times ? *frame.times : FrameTimes{};
  m.steering_ns = times.steering_ns;
  m.gait_ns = times.gait_ns;
  m.kinematics_ns = times.kinematics_ns;
  m.avatar_cull_ns = times.avatar_cull_ns;
  m.part_cull_ns = times.part_cull_ns;
  m.exact_ns = times.exact_ns;
  m.events_ns = times.events_ns;
  m.publish_ns = times.publish_ns;
  m.frame_ns = times.frame_ns;
  send(Channel::kCounters, m, 0, 1);
}

void RunEncoder::send_checks(uint64_t hash) {
  number(checks_, said_[Channel::kChecks].messages, 0, 1);
  checks_.number = said_.messages();
  checks_.hash = static_cast<int64_t>(hash);
  said_.fill(checks_);
  const size_t size = encoded(checks_, buffer_).size();
  const std::span<uint8_t> bytes(buffer_.data(), size);
  seal(bytes);
  hand_over(Channel::kChecks, bytes, checksum(bytes));
}

void RunEncoder::end(const RunInfo&, const RunEnd& end) {
  utime_us_ = end.utime_us;
  frame_ = end.frames;
  send_events(end.events);
  end_.frames = end.frames;
  end_.begins = static_cast<int64_t>(end.begins);
  end_.ends = static_cast<int64_t>(end.ends);
  end_.hash = static_cast<int64_t>(end.hash);
  end_.channels.clear();
  end_.messages.clear();
  end_.bytes.clear();
  for (const Channel channel : kAllChannels) {
    if (channel == Channel::kEnd) continue;
    end_.channels.emplace_back(name_of(channel));
    end_.messages.push_back(totals(channel).messages);
    end_.bytes.push_back(totals(channel).bytes);
  }
  end_.channel_count = static_cast<int32_t>(end_.channels.size());
  send(Channel::kEnd, end_, 0, 1);
}

void RunEncoder::repeat_end() { send(Channel::kEnd, end_, 0, 1); }

void RunEncoder::send_last_checks() {
  checks_.is_last = 1;
  send_checks(static_cast<uint64_t>(end_.hash));
}

}  // namespace throng
