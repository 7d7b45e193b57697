// Words for a person: print_message() on stderr, print_result() on stdout.
// One rule: telling never ends the work. A stderr that takes nothing takes nothing; a stdout that
// takes nothing leaves its mark on the stream, and main() ends with it.
#pragma once

#include <fmt/format.h>

#include <string_view>
#include <utility>

namespace throng {

/// Notes, progress and errors, exactly as given: the line feed is the caller's.
void print_message_text(std::string_view text) noexcept;
/// Results. What could not be written is known to flush_results().
void print_result_text(std::string_view text) noexcept;

template <typename... Args>
void print_message(fmt::format_string<Args...> format, Args&&... args) {
  print_message_text(fmt::format(format, std::forward<Args>(args)...));
}
template <typename... Args>
void print_result(fmt::format_string<Args...> format, Args&&... args) {
  print_result_text(fmt::format(format, std::forward<Args>(args)...));
}

/// Sends on what was shown so far; false if any of it, now or before, did not reach its reader.
bool flush_results() noexcept;

/// Whether stdout is a pipe whose reader has gone, as `head` does once it has enough: what is shown
/// from then on goes nowhere, and that is no failure.
bool stdout_is_closed() noexcept;

/// For signal handlers, which may call next to nothing: this.
void print_in_signal_handler(std::string_view text) noexcept;

}  // namespace throng
