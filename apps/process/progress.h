// A progress bar on the terminal.
// One rule: nothing is drawn where nobody looks; without a terminal on stderr it stays silent.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace throng {

class ProgressBar {
 public:
  /// total > 0; `unit` is what is counted.
  ProgressBar(std::string label, int64_t total, std::string unit = "frames");
  /// Wipes the line, so that what is printed next starts on a clean one.
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// Draws at most ten times a second.
  void show(int64_t done);

 private:
  using Clock = std::chrono::steady_clock;
  std::string label_;
  int64_t total_;
  std::string unit_;
  bool on_terminal_;
  bool drawn_ = false;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_{};
};

}  // namespace throng
