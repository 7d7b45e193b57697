#include "lcm_io/wire/lcm_sink.h"

#include <fmt/format.h>

#include <algorithm>
#include <lcm/lcm-cpp.hpp>
#include <thread>
#include <utility>

#include "base/console.h"
#include "lcm_io/wire/lcm_url.h"

namespace throng {
namespace {

constexpr int kEndCopies = 5;
constexpr std::chrono::milliseconds kEndPause{20};
constexpr std::chrono::duration<double> kDescriptionPeriod{1.0};
// Gives receivers time: the default buffer of 208 kB holds three messages of 60 kB.
constexpr std::chrono::milliseconds kDescriptionPause{1};

void print_line(const std::string& text) { print_message("{}\n", text); }

}  // namespace

LcmSink::LcmSink(const LcmOptions& options)
    : LcmSink(options, is_usable(options.url) ? std::make_shared<lcm::LCM>(options.url) : nullptr) {
}

LcmSink::LcmSink(const LcmOptions& options, std::shared_ptr<lcm::LCM> lcm)
    : options_(options), lcm_(std::move(lcm)) {
  for (const Channel channel : kAllChannels)
    channels_[static_cast<size_t>(channel)] = name_of(channel);
  if (!options_.warn) options_.warn = print_line;
  if (good()) return;
  if (is_tcpq(options_.url)) {
    server_is_lost_ = true;
    options_.warn(fmt::format(
        "warning: LCM has no server at {}: nothing is published, messages count as dropped, "
        "the run continues; start the server before the run, or use --lcm off",
        options_.url));
    return;
  }
  options_.warn(
      fmt::format("warning: LCM cannot use {}: nothing is published, the run continues; {}, or use "
                  "--lcm off",
                  options_.url, kMulticastRemedy));
}

LcmSink::~LcmSink() = default;

bool LcmSink::good() const { return lcm_ && lcm_->good(); }

EncoderOptions LcmSink::encoding() const {
  return {.state_every = options_.state_every, .part_poses = options_.part_poses};
}

void LcmSink::after_begin(TargetState& target_state) {
  for (int chunk = 0; chunk < target_state.description_chunks(); ++chunk) {
    if (chunk > 1 && good()) std::this_thread::sleep_for(kDescriptionPause);
    target_state.send_description_chunk(chunk);
  }
  round_started_ = Clock::now();
  next_chunk_ = 0;
}

void LcmSink::after_frame(TargetState& target_state) {
  // Spread over the second, to avoid a burst of description chunks after a frame.
  const auto now = Clock::now();
  const int chunks = target_state.description_chunks();
  const double round = (now - round_started_) / kDescriptionPeriod;
  const int due = static_cast<int>(std::min(1.0, round) * chunks);
  for (; next_chunk_ < due; ++next_chunk_) target_state.send_description_chunk(next_chunk_);
  if (next_chunk_ == chunks) {
    next_chunk_ = 0;
    round_started_ = now;
  }
}

void LcmSink::after_end(TargetState& target_state) {
  if (server_is_lost_) return;
  for (int copy = 1; copy < kEndCopies; ++copy) {
    std::this_thread::sleep_for(kEndPause);
    target_state.repeat_end();
  }
  target_state.send_last_checksums();
}

void LcmSink::message(Channel channel, int64_t, std::span<const uint8_t> bytes) {
  send(channels_[static_cast<size_t>(channel)], bytes);
}

void LcmSink::send(const std::string& name, std::span<const uint8_t> bytes) {
  if (!wants_messages()) return;
  if (!server_is_lost_ &&
      lcm_->publish(name, bytes.data(), static_cast<unsigned>(bytes.size())) == 0) {
    ++messages_;
    bytes_ += static_cast<int64_t>(bytes.size());
    return;
  }
  // Otherwise liblcm would look for the server, and print, with each message.
  const bool was_lost = std::exchange(server_is_lost_, is_tcpq(options_.url));
  if (dropped_++ == 0 && !was_lost)
    options_.warn(
        fmt::format("warning: LCM rejected a message on {} ({}); the run continues, further ones "
                    "are only counted",
                    name, options_.url));
}

}  // namespace throng
