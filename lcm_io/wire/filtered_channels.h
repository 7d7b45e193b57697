// Channels of their own for who asks: the contacts and near rows of one group or body alone.
// One rule: every row of the run that names one of them is there, in the run's order, numbered and
// chunked as on the run's own channels; nothing else is.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "lcm_io/wire/lcm_sink.h"
#include "scenes/run/sink.h"
#include "throng/events_t.hpp"
#include "throng/proximity_t.hpp"
#include "throng/stamp_t.hpp"

namespace throng {

/// Bodies, and where to publish what names one of them.
struct FilteredChannel {
  std::string who;      ///< the number of a body, or a name, see NamedBodies
  std::string channel;  ///< followed by _EVENTS, _NEAR and _STAMP
};

/// "WHO:CHANNEL". Throws InputError.
FilteredChannel parse_filtered_channel(const std::string& text);

class FilteredChannels final : public Sink {
 public:
  /// Throws InputError if no body of this run is called so.
  FilteredChannels(const RunInfo& run, std::span<const FilteredChannel> requested);
  /// From now on; it outlives this.
  void publish_by(LcmSink& sink) { sink_ = &sink; }

  void begin(const RunInfo& run) override;
  /// Of each channel: events, if there are some, near rows, if the run asks for distances, stamp.
  void frame(const RunInfo& run, const Frame& frame) override;
  void end(const RunInfo& run, const RunEnd& end) override;

  struct PublishedTotals {
    FilteredChannel to;
    int64_t bodies = 0;  ///< that it is about
    int64_t messages = 0, events = 0, proximity_rows = 0;
  };
  /// One a channel.
  const std::vector<PublishedTotals>& totals() const { return totals_; }
  /// A line for each name that a group or an obstacle has, too, which is not meant.
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  struct OutputChannel {
    std::string channel;
    int64_t seq = 0;
  };
  struct Subscriber {
    std::vector<uint8_t> is_selected;  // by body
    OutputChannel events, proximity, stamp;
  };
  static bool involves(const Subscriber& subscriber, const PairKey& pair);
  void send_events(size_t i, std::span<const PairEvent> events);
  void send_proximity(size_t i, const RunInfo& run, const Frame& frame);
  template <class Message>
  void send(size_t i, OutputChannel& to, Message& message, int chunk, int chunks);

  LcmSink* sink_ = nullptr;
  std::vector<Subscriber> subscribers_;
  std::vector<PublishedTotals> totals_;
  std::vector<std::string> notes_;
  int64_t run_id_ = 0, instance_ = 0, utime_us_ = 0, frame_ = 0;
  // Reused; their vectors keep their capacity.
  std::vector<PairEvent> selected_events_;
  std::vector<ProximityPair> selected_pairs_, selected_closest_;
  events_t events_{};
  proximity_t proximity_{};
  stamp_t stamp_{};
  std::vector<uint8_t> buffer_;
};

}  // namespace throng
