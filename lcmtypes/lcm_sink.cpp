#include "lcmtypes/lcm_sink.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <lcm/lcm-cpp.hpp>
#include <thread>
#include <utility>

namespace throng {
namespace {

constexpr int kEndCopies = 5;
constexpr std::chrono::milliseconds kEndPause{20};
constexpr std::chrono::duration<double> kDescriptionPeriod{1.0};
// A receiver with the stock buffer of 208 kB takes three messages of 60 kB at once: give it time.
constexpr std::chrono::milliseconds kDescriptionPause{1};

/// False if the kernel knows no way to the URL's multicast group. liblcm finds out as well, and
/// prints ten lines of its own.
bool has_route(const std::string& url) {
  constexpr std::string_view kScheme = "udpm://";
  if (!url.starts_with(kScheme)) return true;
  const size_t end = url.find_first_of(":?", kScheme.size());
  std::string group = url.substr(kScheme.size(), end - kScheme.size());
  if (group.empty()) group = "239.255.76.67";  // what liblcm uses
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(7667);  // any: connecting a UDP socket only looks the route up
  if (inet_pton(AF_INET, group.c_str(), &address.sin_addr) != 1) return true;
  const int descriptor = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (descriptor < 0) return true;
  const bool is_reachable =
      ::connect(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 ||
      errno != ENETUNREACH;
  ::close(descriptor);
  return is_reachable;
}

void to_stderr(const std::string& text) { fmt::print(stderr, "{}\n", text); }

}  // namespace

LcmSink::LcmSink(const LcmOptions& options)
    : LcmSink(options, has_route(options.url) ? std::make_shared<lcm::LCM>(options.url) : nullptr) {
}

LcmSink::LcmSink(const LcmOptions& options, std::shared_ptr<lcm::LCM> lcm)
    : options_(options),
      lcm_(std::move(lcm)),
      encoder_({.state_every = options.state_every, .part_poses = options.part_poses}, *this) {
  for (const Channel channel : kAllChannels)
    channels_[static_cast<size_t>(channel)] = name_of(channel);
  if (!options_.warn) options_.warn = to_stderr;
  if (good()) return;
  options_.warn(fmt::format(
      "LCM cannot use {}: nothing is published, the run goes on. Where multicast has no route: "
      "'ip route add 224.0.0.0/4 dev lo'; to do without LCM: --lcm off",
      options_.url));
}

LcmSink::~LcmSink() = default;

bool LcmSink::good() const { return lcm_ && lcm_->good(); }

void LcmSink::begin(const RunInfo& run) {
  if (!good()) return;
  encoder_.begin(run);
  for (int chunk = 0; chunk < encoder_.description_chunks(); ++chunk) {
    if (chunk > 1) std::this_thread::sleep_for(kDescriptionPause);
    encoder_.send_description_chunk(chunk);
  }
  round_started_ = Clock::now();
  next_chunk_ = 0;
}

void LcmSink::frame(const RunInfo& run, const Frame& frame) {
  if (!good()) return;
  encoder_.frame(run, frame);
  send_due_description();
}

void LcmSink::send_due_description() {
  // Spread over the second, so that a large description does not come as a burst on top of a frame.
  const auto now = Clock::now();
  const int chunks = encoder_.description_chunks();
  const double round = (now - round_started_) / kDescriptionPeriod;
  const int due = static_cast<int>(std::min(1.0, round) * chunks);
  for (; next_chunk_ < due; ++next_chunk_) encoder_.send_description_chunk(next_chunk_);
  if (next_chunk_ == chunks) {
    next_chunk_ = 0;
    round_started_ = now;
  }
}

void LcmSink::end(const RunInfo& run, const RunEnd& end) {
  if (!good()) return;
  encoder_.end(run, end);
  for (int copy = 1; copy < kEndCopies; ++copy) {
    std::this_thread::sleep_for(kEndPause);
    encoder_.repeat_end();
  }
}

void LcmSink::message(Channel channel, int64_t, std::span<const uint8_t> bytes) {
  const std::string& name = channels_[static_cast<size_t>(channel)];
  if (lcm_->publish(name, bytes.data(), static_cast<unsigned>(bytes.size())) == 0) {
    ++messages_;
    bytes_ += static_cast<int64_t>(bytes.size());
    return;
  }
  if (dropped_++ == 0)
    options_.warn(
        fmt::format("LCM did not take a message on {} ({}); the run goes on, further ones "
                    "are only counted",
                    name, options_.url));
}

}  // namespace throng
