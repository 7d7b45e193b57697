// Console output: print_message() writes to stderr, print_result() to stdout.
// Invariant: neither throws. A failed stdout makes main() exit with code 3.
#pragma once

#include <fmt/format.h>

#include <string_view>
#include <utility>

namespace throng {

/// Writes a note, progress or an error to stderr, unchanged; the caller adds the line feed.
void print_message_text(std::string_view text) noexcept;
/// Writes a result to stdout. flush_results() reports failures.
void print_result_text(std::string_view text) noexcept;

template <typename... Args>
void print_message(fmt::format_string<Args...> format, Args&&... args) {
  print_message_text(fmt::format(format, std::forward<Args>(args)...));
}
template <typename... Args>
void print_result(fmt::format_string<Args...> format, Args&&... args) {
  print_result_text(fmt::format(format, std::forward<Args>(args)...));
}

/// Flushes stdout. Returns false if any result so far was not written.
bool flush_results() noexcept;

/// Whether stdout is a pipe whose reader has closed it, as `head` does. Later results are dropped
/// without an error.
bool stdout_is_closed() noexcept;

/// Writes to stderr; safe in a signal handler.
void print_in_signal_handler(std::string_view text) noexcept;

}  // namespace throng
