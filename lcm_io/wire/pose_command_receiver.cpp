#include "lcm_io/wire/pose_command_receiver.h"

#include <lcm/lcm-cpp.hpp>

#include "base/console.h"
#include "lcm_io/codec/message_validation.h"
#include "lcm_io/wire/external_poses.h"
#include "lcm_io/wire/lcm_url.h"

namespace throng {
namespace {

// Queued messages until a step; a controller at 1 kHz sends 17 per frame.
constexpr int kQueuedCommands = 200;
// After this silence a controller may have restarted, with any numbers.
constexpr std::chrono::seconds kRestart{1};

}  // namespace

PoseCommandReceiver::PoseCommandReceiver(const RunInfo& run, const std::string& url)
    : PoseCommandReceiver(run, listening(url, " for pose commands")) {}

PoseCommandReceiver::PoseCommandReceiver(const RunInfo& run, std::shared_ptr<lcm::LCM> lcm)
    : run_(run), lcm_(std::move(lcm)) {
  subscribe();
}

PoseCommandReceiver::~PoseCommandReceiver() = default;

void PoseCommandReceiver::subscribe() {
  static constexpr auto on_message = [](const lcm::ReceiveBuffer* buffer, const std::string&,
                                        Listener* listener) {
    listener->self->take(*listener, {static_cast<const uint8_t*>(buffer->data), buffer->data_size});
  };
  for (size_t group = 0; group < run_.control_channels.size(); ++group) {
    const std::string& channel = run_.control_channels[group];
    if (channel.empty()) continue;
    auto listener = std::make_unique<Listener>();
    listener->self = this;
    listener->index = counts_.size();
    listener->group = static_cast<uint16_t>(group);
    Counts& counts = counts_.emplace_back();
    counts.channel = channel;
    counts.group = run_.groups[group];
    lcm_->subscribeFunction(channel, +on_message, listener.get())
        ->setQueueCapacity(kQueuedCommands);
    listeners_.push_back(std::move(listener));
  }
}

void PoseCommandReceiver::apply(Simulation& simulation) {
  simulation_ = &simulation;
  for (const auto& listener : listeners_) listener->is_new = false;
  // At most one full queue, because a continuous sender must not delay the run.
  for (int i = 0; i < kQueuedCommands && lcm_->handleTimeout(0) > 0; ++i) {
  }
  for (const auto& listener : listeners_) {
    Counts& counts = counts_[listener->index];
    ++counts.frames;
    counts.frames_without_command += listener->is_new ? 0 : 1;
    counts.missing = listener->tally.missing;
    counts.late = listener->tally.late + listener->tally.repeated;
  }
  simulation_ = nullptr;
}

bool PoseCommandReceiver::is_current(Listener& listener, const pose_command_t& message,
                                     size_t bytes) {
  const auto now = Clock::now();
  ChannelTally& tally = listener.tally;
  const bool is_older = tally.next_seq >= 0 && message.seq < tally.next_seq;
  if (is_older && message.seq == 0)
    tally.next_seq = 0;
  else if (is_older && now - listener.last > kRestart)
    restart(listener, message, std::chrono::duration<double>(now - listener.last).count());
  const bool is_newest = tally.next_seq < 0 || message.seq >= tally.next_seq;
  const int64_t missing = tally.missing;
  MessageHeader header;
  header.seq = message.seq;
  tally.count(header, bytes);
  if (!is_newest) return false;
  // Rejected or ignored messages do not delay a restart of the numbering.
  listener.last = now;
  listener.last_hole = tally.missing - missing;
  return true;
}

void PoseCommandReceiver::restart(Listener& listener, const pose_command_t& message,
                                  double silence_s) {
  ChannelTally& tally = listener.tally;
  print_message(
      "note: control channel {}: no message after number {} for {:.1f} s; numbering restarts "
      "at {}\n",
      counts_[listener.index].channel, tally.next_seq - 1, silence_s, message.seq);
  ++counts_[listener.index].restarts;
  // Messages before that number were never sent, so they are not missing.
  tally.missing -= listener.last_hole;
  listener.last_hole = 0;
  tally.next_seq = message.seq;
}

void PoseCommandReceiver::take(Listener& listener, std::span<const uint8_t> bytes) {
  Counts& counts = counts_[listener.index];
  // No exception may pass through liblcm's C code; only memory allocation could throw here.
  try {
    std::string defect = decode(bytes, message_);
    if (defect.empty()) defect = defect_for_group(run_, listener.group, message_);
    if (!defect.empty()) {
      ++counts.rejected;
      counts.rejection = std::move(defect);
    } else if (is_current(listener, message_, bytes.size())) {
      move(listener, message_);
    }
  } catch (const std::exception&) {
    ++counts.rejected;
  }
}

void PoseCommandReceiver::move(Listener& listener, const pose_command_t& message) {
  Counts& counts = counts_[listener.index];
  for_each_pose(run_, message, [&](uint32_t id, const ExternalPose& pose) {
    counts.clamped += std::max(0, simulation_->set_pose(id, pose));
  });
  ++counts.messages;
  listener.is_new = true;
}

}  // namespace throng
