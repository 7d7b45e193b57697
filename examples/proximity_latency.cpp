#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <lcm/lcm-cpp.hpp>
#include <string>
#include <vector>

#include "throng/end_t.hpp"
#include "throng/frame_stats_t.hpp"
#include "throng/proximity_t.hpp"
#include "throng/stamp_t.hpp"

// proximity_latency CHANNEL: prints the time from the start of culling until proximity rows are
// sent on CHANNEL_PROXIMITY and received, for a run with --publish-for WHO:CHANNEL on the same
// machine.
struct Latency {
  lcm::LCM lcm{"udpm://239.255.76.67:7684?ttl=0&recv_buf_size=2097152"};
  bool is_over = false;
  int64_t frame = -1, received_ns = 0;  // latest complete proximity rows
  int64_t frames = 0, missing = 0, next_seq = 0;
  std::vector<double> sent_ms, here_ms, rows;
  std::vector<double> tests[5];  // per stage of culling, see frame_stats_t

  void on_proximity(const lcm::ReceiveBuffer*, const std::string&,
                    const throng::proximity_t* message) {
    if (message->chunk + 1 != message->chunk_count) return;
    frame = message->frame;
    received_ns =
        std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
  }
  void on_stamp(const lcm::ReceiveBuffer*, const std::string&, const throng::stamp_t* stamp) {
    if (frames++ > 0) missing += stamp->seq - next_seq;
    next_seq = stamp->seq + 1;
    if (stamp->frame != frame) return;
    sent_ms.push_back(static_cast<double>(stamp->sent_ns - stamp->culling_ns) * 1e-6);
    here_ms.push_back(static_cast<double>(received_ns - stamp->culling_ns) * 1e-6);
    rows.push_back(stamp->proximity_rows);
  }
  void on_frame_stats(const lcm::ReceiveBuffer*, const std::string&,
                      const throng::frame_stats_t* stats) {
    for (size_t i = 0; i < std::size(tests); ++i)
      tests[i].push_back(static_cast<double>(stats->tests[i]));
  }
  void on_end(const lcm::ReceiveBuffer*, const std::string&, const throng::end_t*) {
    is_over = frames > 0;
  }
};

// Least value that is not exceeded by this share of all.
static double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const double rank = std::ceil(share * static_cast<double>(values.size()));
  return values[static_cast<size_t>(std::max(1.0, rank)) - 1];
}

int main(int argc, char** argv) {
  Latency latency;
  if (argc != 2 || !latency.lcm.good()) return 3;
  const std::string channel = argv[1];
  latency.lcm.subscribe(channel + "_PROXIMITY", &Latency::on_proximity, &latency);
  latency.lcm.subscribe(channel + "_STAMP", &Latency::on_stamp, &latency);
  latency.lcm.subscribe("THRONG_FRAME_STATS", &Latency::on_frame_stats, &latency)
      ->setQueueCapacity(1000);
  latency.lcm.subscribe("THRONG_END", &Latency::on_end, &latency);
  while (!latency.is_over && latency.lcm.handle() == 0) {
  }
  std::printf("%lld frames, %lld missing; proximity rows per frame: %.0f median, %.0f at most\n",
              static_cast<long long>(latency.frames), static_cast<long long>(latency.missing),
              quantile(latency.rows, 0.5), quantile(latency.rows, 1));
  std::printf(
      "tests per frame, median: %.0f spheres, %.0f boxes of bodies, %.0f boxes, %.0f volumes, "
      "%.0f triangles\n",
      quantile(latency.tests[0], 0.5), quantile(latency.tests[1], 0.5),
      quantile(latency.tests[2], 0.5), quantile(latency.tests[3], 0.5),
      quantile(latency.tests[4], 0.5));
  std::printf("ms after the start of culling   p50      p99    p99.9      max\n");
  const auto line = [](const char* what, const std::vector<double>& ms) {
    std::printf("%-25s %9.3f %8.3f %8.3f %8.3f\n", what, quantile(ms, 0.5), quantile(ms, 0.99),
                quantile(ms, 0.999), quantile(ms, 1));
  };
  line("sent", latency.sent_ms);
  line("received", latency.here_ms);
}
