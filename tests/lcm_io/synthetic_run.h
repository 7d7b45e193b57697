// SyntheticRun generates the frames of a crowd for sinks, without steering or culling.
// Invariant: equal seeds give equal frames, so logs can be compared bytewise.
#pragma once

#include <string>
#include <vector>

#include "culling/event_hash.h"
#include "culling/stages/pair_events.h"
#include "lcm_io/codec/encoder.h"
#include "lcm_io/log/log_sink.h"
#include "scenes/run/crowd_change.h"
#include "scenes/run/sink.h"

namespace throng {

class SyntheticRun {
 public:
  enum class Crowd { kAdults, kRovers, kMixed };  // mixed: every third is a rover
  struct Options {
    int avatars = 20;
    uint64_t seed = 1;
    int pairs = 40;  ///< approximate number of touching pairs
    Crowd crowd = Crowd::kMixed;
    double spread_m = 50;     ///< avatars are within this distance of the origin
    bool comings = false;     ///< avatars enter and leave
    bool changes = false;     ///< the first avatar gets another goal in every frame
    bool has_budget = false;  ///< some pairs are not refined to the end
    bool proximity = false;   ///< touching pairs also have a proximity row and a contact point
  };
  explicit SyntheticRun(const Options& options);

  const RunInfo& info() const { return info_; }
  void set_exact(bool exact) { info_.culler.exact = exact; }
  void set_instance(uint64_t instance) { info_.instance = instance; }
  const Frame& step();
  RunEnd finish();

  /// Sends begin, `frames` frames and the end to a sink.
  void play(Sink& sink, int frames);

  int64_t begins() const { return begins_; }
  int64_t ends() const { return ends_; }
  int64_t events() const { return begins_ + ends_; }

 private:
  void pose();
  void touch();
  void come_and_go();
  void level();
  void list_proximity();
  void count(std::span<const PairEvent> events);
  void add_to_hash();

  Options options_;
  Scene scene_;
  RunInfo info_;
  Frame frame_;
  PairEvents pair_events_;
  CullingCounters counters_;
  FrameTimes times_;
  std::vector<RootPose> roots_;
  std::vector<float> speeds_, postures_;
  std::vector<size_t> offsets_;
  std::vector<PairKey> pairs_;
  std::vector<uint8_t> present_, levels_;
  std::vector<ProximityPair> proximity_;
  std::vector<ContactPoint> contact_points_;
  std::vector<CrowdChange> changes_;
  int64_t next_frame_ = 0;
  EventHash hash_;
  int64_t begins_ = 0, ends_ = 0;
};

/// The bundled adult and the rover of the fixtures, loaded once.
std::shared_ptr<const Model> adult();
std::shared_ptr<const Model> rover();

/// Path of a temporary file, which the destructor removes.
class ScratchFile {
 public:
  explicit ScratchFile(const std::string& suffix = ".lcmlog");
  ~ScratchFile();
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

std::vector<uint8_t> bytes_of(const std::filesystem::path& file);
void write_bytes(const std::filesystem::path& file, std::span<const uint8_t> bytes);

struct MessageList : MessageTarget {
  struct Message {
    Channel channel;
    int64_t utime_us;
    std::vector<uint8_t> bytes;
  };
  void message(Channel channel, int64_t utime_us, std::span<const uint8_t> bytes) override {
    messages.push_back({channel, utime_us, {bytes.begin(), bytes.end()}});
  }
  std::vector<Message> messages;
};

std::vector<MessageList::Message> messages_of(SyntheticRun& run, int frames,
                                              const EncoderOptions& options = {});

}  // namespace throng
