#include "apps/process/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "base/console.h"

namespace throng {
namespace {

constexpr int kWidth = 32;
constexpr std::chrono::milliseconds kPeriod{100};

}  // namespace

ProgressBar::ProgressBar(std::string label, int64_t total, std::string unit)
    : label_(std::move(label)),
      total_(total),
      unit_(std::move(unit)),
      on_terminal_(isatty(STDERR_FILENO) != 0) {}

ProgressBar::~ProgressBar() {
  if (drawn_) print_message("\r\033[K");
}

void ProgressBar::show(int64_t done) {
  if (!on_terminal_) return;
  const Clock::time_point now = Clock::now();
  if (now - last_ < kPeriod && done < total_) return;
  last_ = now;
  drawn_ = true;
  const double fraction =
      std::clamp(static_cast<double>(done) / static_cast<double>(total_), 0.0, 1.0);
  const int filled = static_cast<int>(fraction * kWidth);
  const double elapsed_s = std::chrono::duration<double>(now - start_).count();
  const double left_s = done > 0 ? elapsed_s * (1 / fraction - 1) : 0;
  print_message("\r{} [{:#<{}}{:.<{}}] {}/{} {}, {:.1f} s left\033[K", label_, "", filled, "",
                kWidth - filled, done, total_, unit_, left_s);
}

}  // namespace throng
