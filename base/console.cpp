#include "base/console.h"

#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>

namespace throng {
namespace {

std::atomic<bool> g_reader_has_left{false};

}  // namespace

void print_message_text(std::string_view text) noexcept {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

void print_result_text(std::string_view text) noexcept {
  if (g_reader_has_left) return;
  if (std::fwrite(text.data(), 1, text.size(), stdout) < text.size() && errno == EPIPE)
    g_reader_has_left = true;
}

bool flush_results() noexcept {
  const bool flushed = std::fflush(stdout) == 0;
  if (!flushed && errno == EPIPE) g_reader_has_left = true;
  return flushed && std::ferror(stdout) == 0;
}

bool stdout_is_closed() noexcept { return g_reader_has_left; }

void print_in_signal_handler(std::string_view text) noexcept {
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, text.data(), text.size());
}

}  // namespace throng
