// FilteredChannels publishes the contacts and proximity rows of one group or body on separate
// channels.
// Invariant: exactly the rows with one of its bodies are published, in the run's order, numbered
// and chunked as on the run's own channels.
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

/// Bodies, and the channels for their rows.
struct FilteredChannel {
  std::string who;      ///< a body id or a name, see NamedBodies
  std::string channel;  ///< prefix of _EVENTS, _PROXIMITY and _STAMP
};

/// Parses "WHO:CHANNEL". Throws InputError.
FilteredChannel parse_filtered_channel(const std::string& text);

class FilteredChannels final : public Sink {
 public:
  /// Throws InputError if a name matches no body of this run.
  FilteredChannels(const RunInfo& run, std::span<const FilteredChannel> requested);
  /// Sets the sink, which must outlive this object.
  void publish_by(LcmSink& sink) { sink_ = &sink; }

  void begin(const RunInfo& run) override;
  /// Sends on each channel: events if there are some, proximity rows if the run has a margin, the
  /// stamp.
  void frame(const RunInfo& run, const Frame& frame) override;
  void end(const RunInfo& run, const RunEnd& end) override;

  struct PublishedTotals {
    FilteredChannel to;
    int64_t bodies = 0;
    int64_t messages = 0, events = 0, proximity_rows = 0;
  };
  /// One entry per channel.
  const std::vector<PublishedTotals>& totals() const { return totals_; }
  /// One line for each name that is also that of a group or an obstacle, which is not selected.
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  struct OutputChannel {
    std::string channel;
    int64_t seq = 0;
  };
  struct Subscriber {
    std::vector<uint8_t> is_selected;
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
