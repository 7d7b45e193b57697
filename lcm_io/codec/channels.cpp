#include "lcm_io/codec/channels.h"

namespace throng {
namespace {

constexpr std::array<std::string_view, kChannelCount> kNames = {
    "THRONG_RUN",         "THRONG_STATES",     "THRONG_EVENTS",  "THRONG_TOUCHING",
    "THRONG_FRAME_STATS", "THRONG_END",        "THRONG_PARTS",   "THRONG_CHECKS",
    "THRONG_NEAR",        "THRONG_SEPARATION", "THRONG_CONTACTS"};

}  // namespace

std::string_view name_of(Channel channel) { return kNames[static_cast<size_t>(channel)]; }

std::optional<Channel> channel_of(std::string_view name) {
  for (const Channel channel : kAllChannels)
    if (name_of(channel) == name) return channel;
  return std::nullopt;
}

}  // namespace throng
