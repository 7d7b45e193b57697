#include "lcm_io/wire/lockstep.h"

#include <fmt/format.h>

#include <algorithm>
#include <lcm/lcm-cpp.hpp>
#include <thread>

#include "base/errors.h"
#include "lcm_io/codec/channels.h"
#include "lcm_io/codec/message_validation.h"
#include "lcm_io/wire/external_poses.h"
#include "lcm_io/wire/lcm_url.h"

namespace throng {
namespace {

using std::chrono::milliseconds;

// Time until a request without reply is repeated; the request or its reply may be lost.
constexpr milliseconds kRequestPeriod{250};
// Interval at which a waiting run checks for stop requests.
constexpr milliseconds kPollPeriod{20};
// A stopped run waits this long for the replies to its last frame, for its checkpoint.
constexpr std::chrono::seconds kGrace{1};
constexpr size_t kMaxChannel = 63;  // limit of liblcm
constexpr size_t kAvatarsPerRequest = (kMaxMessageBytes - 100) / (4 + 3 * 8 + 6 * 4);
constexpr size_t kNamedAvatars = 5;
constexpr int kQueuedAnswers = 200;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

Lockstep::Lockstep(const RunInfo& run, const std::string& url, double timeout_s)
    : Lockstep(run, listening(url, " for replies", "--lockstep: "), timeout_s) {}

Lockstep::Lockstep(const RunInfo& run, std::shared_ptr<lcm::LCM> lcm, double timeout_s)
    : run_(run), lcm_(std::move(lcm)), timeout_s_(timeout_s) {
  has_replied_.resize(run.group_of_avatar.size());
  for (size_t group = 0; group < run.control_channels.size(); ++group)
    if (!run.control_channels[group].empty()) listen(group);
  if (controllers_.empty())
    throw InputError("--lockstep",
                     "a scene with an externally controlled group (control_channel: CHANNEL)",
                     "none");
}

Lockstep::~Lockstep() = default;

void Lockstep::listen(size_t group) {
  const std::string& channel = run_.control_channels[group];
  if (channel.size() + kReplySuffix.size() > kMaxChannel)
    throw InputError("--lockstep",
                     fmt::format("control channels of at most {} characters, because '{}' is "
                                 "appended",
                                 kMaxChannel - kReplySuffix.size(), kReplySuffix),
                     fmt::format("'{}'", channel));
  if (std::count(run_.control_channels.begin(), run_.control_channels.end(), channel) > 1)
    throw InputError("--lockstep", "a separate control channel for each group",
                     fmt::format("'{}' for several groups", channel));
  auto controller = std::make_unique<Controller>();
  controller->self = this;
  controller->index = counts_.size();
  controller->group = static_cast<uint16_t>(group);
  controller->request_channel = fmt::format("{}{}", channel, kRequestSuffix);
  for (size_t avatar = 0; avatar < run_.group_of_avatar.size(); ++avatar)
    if (run_.group_of_avatar[avatar] == group)
      controller->avatars.push_back(static_cast<uint32_t>(avatar));
  Counts& counts = counts_.emplace_back();
  counts.group = run_.groups[group];
  counts.channel = fmt::format("{}{}", channel, kReplySuffix);
  static constexpr auto on_message = [](const lcm::ReceiveBuffer* buffer, const std::string&,
                                        Controller* to) {
    to->self->take(*to, {static_cast<const uint8_t*>(buffer->data), buffer->data_size});
  };
  if (lcm_ && lcm_->good())
    lcm_->subscribeFunction(counts.channel, +on_message, controller.get())
        ->setQueueCapacity(kQueuedAnswers);
  controllers_.push_back(std::move(controller));
}

void Lockstep::begin(Simulation& simulation) {
  frame_ = run_.resumed ? run_.resumed->frame : -1;
  utime_us_ = run_.resumed ? run_.resumed->utime_us : 0;
  is_first_ = true;
  const bool all_are_there = await(simulation, {});
  is_first_ = false;
  total_wait_s_ = max_wait_s_ = 0;
  if (!all_are_there) throw EnvironmentError(failure_);
}

bool Lockstep::after(Simulation& simulation, const Frame& frame, const Stopped& stopped) {
  frame_ = frame.number;
  utime_us_ = frame.utime_us;
  return await(simulation, stopped);
}

bool Lockstep::await(Simulation& simulation, const Stopped& stopped) {
  simulation_ = &simulation;
  std::fill(has_replied_.begin(), has_replied_.end(), uint8_t{0});
  missing_ = 0;
  for (const auto& controller : controllers_)
    missing_ += static_cast<int64_t>(controller->avatars.size());
  const auto start = Clock::now();
  auto deadline = start + std::chrono::duration_cast<Clock::duration>(
                              std::chrono::duration<double>(timeout_s_));
  auto next_request = start;
  bool is_stopped = false;
  while (missing_ > 0 && failure_.empty()) {
    const auto now = Clock::now();
    if (!is_stopped && stopped && stopped()) {
      is_stopped = true;
      deadline = std::min<Clock::time_point>(deadline, now + kGrace);
    }
    if (now >= deadline) break;
    if (now >= next_request) {
      send_requests();
      next_request = now + kRequestPeriod;
    }
    const auto left = std::chrono::ceil<milliseconds>(std::min(deadline, next_request) - now);
    if (lcm_->handleTimeout(
            static_cast<int>(std::clamp(left, milliseconds{1}, kPollPeriod).count())) < 0)
      failure_ = "lockstep: LCM stopped receiving; check that its server is running";
  }
  if (missing_ > 0 && !is_stopped && failure_.empty()) failure_ = late_controllers();
  const double total_wait_s = seconds_since(start);
  total_wait_s_ += total_wait_s;
  max_wait_s_ = std::max(max_wait_s_, total_wait_s);
  simulation_ = nullptr;
  return failure_.empty();
}

void Lockstep::send_requests() {
  for (const auto& controller : controllers_) send_request(*controller);
}

void Lockstep::send_request(Controller& controller) {
  std::vector<uint32_t> requested;
  for (const uint32_t avatar : controller.avatars)
    if (has_replied_[avatar] == 0) requested.push_back(avatar);
  step_request_t& m = request_;
  m.utime = utime_us_;
  m.run_id = static_cast<int64_t>(run_.run_id);
  m.instance = static_cast<int64_t>(run_.instance);
  m.frame = frame_;
  m.schema = kSchema;
  m.is_first = is_first_ ? 1 : 0;
  m.chunk_count = chunks_of(requested.size(), kAvatarsPerRequest);
  for (m.chunk = 0; m.chunk < m.chunk_count; ++m.chunk) {
    const size_t first = static_cast<size_t>(m.chunk) * kAvatarsPerRequest;
    const size_t count = std::min(kAvatarsPerRequest, requested.size() - first);
    m.count = static_cast<int32_t>(count);
    m.avatar.resize(count);
    for (auto* column : {&m.x_m, &m.y_m, &m.z_m}) column->resize(count);
    for (auto* column : {&m.qw, &m.qx, &m.qy, &m.qz, &m.vx_mps, &m.vy_mps}) column->resize(count);
    for (size_t i = 0; i < count; ++i) {
      m.avatar[i] = static_cast<int32_t>(requested[first + i]);
      const ExternalPose& pose = *simulation_->external_pose(requested[first + i]);
      m.x_m[i] = pose.root.position_m.x();
      m.y_m[i] = pose.root.position_m.y();
      m.z_m[i] = pose.root.position_m.z();
      m.qw[i] = pose.root.world_from_root.w();
      m.qx[i] = pose.root.world_from_root.x();
      m.qy[i] = pose.root.world_from_root.y();
      m.qz[i] = pose.root.world_from_root.z();
      m.vx_mps[i] = static_cast<float>(pose.velocity_mps.x());
      m.vy_mps[i] = static_cast<float>(pose.velocity_mps.y());
    }
    m.seq = controller.requests++;
    ++counts_[controller.index].requests;
    lcm_->publish(controller.request_channel, &m);
  }
}

void Lockstep::take(Controller& controller, std::span<const uint8_t> bytes) {
  Counts& counts = counts_[controller.index];
  // No exception may pass through liblcm's C code.
  try {
    std::string defect = decode(bytes, reply_);
    if (defect.empty() && (reply_.run_id != static_cast<int64_t>(run_.run_id) ||
                           reply_.instance != static_cast<int64_t>(run_.instance))) {
      ++counts.other_runs;
      return;
    }
    if (defect.empty() && reply_.frame > frame_)
      defect = fmt::format("a reply to frame {}, expected frame {}", reply_.frame, frame_);
    if (defect.empty()) defect = defect_for_group(run_, controller.group, reply_);
    if (!defect.empty()) {
      ++counts.rejected;
      counts.rejection = std::move(defect);
    } else if (reply_.frame < frame_) {
      ++counts.late;
    } else {
      handle(controller, reply_);
    }
  } catch (const std::exception&) {
    ++counts.rejected;
  }
}

void Lockstep::handle(Controller& controller, const step_reply_t& reply) {
  Counts& counts = counts_[controller.index];
  bool is_new = false;
  for_each_pose(run_, reply, [&](uint32_t avatar, const ExternalPose& pose) {
    if (has_replied_[avatar] != 0) return;
    counts.clamped += std::max(0, simulation_->set_pose(avatar, pose));
    has_replied_[avatar] = 1;
    --missing_;
    is_new = true;
  });
  ++(is_new ? counts.replies : counts.repeated);
}

std::string Lockstep::late_controllers() const {
  std::string text;
  for (const auto& controller : controllers_) {
    std::string ids;
    size_t late = 0;
    for (const uint32_t avatar : controller->avatars) {
      if (has_replied_[avatar] != 0) continue;
      if (late < kNamedAvatars) ids += fmt::format("{}{}", late == 0 ? "" : ", ", avatar);
      ++late;
    }
    if (late == 0) continue;
    text += fmt::format(
        "{}{} {}{} of group '{}' ({})", text.empty() ? "" : "; ", late == 1 ? "avatar" : "avatars",
        ids, late > kNamedAvatars ? fmt::format(" and {} more", late - kNamedAvatars) : "",
        counts_[controller->index].group, counts_[controller->index].channel);
  }
  const std::string to =
      is_first_ ? "the request before the first frame" : fmt::format("frame {}", frame_);
  return fmt::format(
      "lockstep: no reply to {} within {:g} s for {}; check the controller, or raise "
      "--lockstep-timeout",
      to, timeout_s_, text);
}

}  // namespace throng
