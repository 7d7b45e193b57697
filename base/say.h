// Words for a person: say() on stderr, show() on stdout.
// One rule: telling never ends the work. A stderr that takes nothing takes nothing; a stdout that
// takes nothing leaves its mark on the stream, and main() ends with it.
#pragma once

#include <fmt/format.h>

#include <string_view>
#include <utility>

namespace throng {

/// Notes, progress and errors, exactly as given: the line feed is the caller's.
void say_text(std::string_view text) noexcept;
/// Results. What could not be written is known to flush_shown().
void show_text(std::string_view text) noexcept;

template <typename... Args>
void say(fmt::format_string<Args...> format, Args&&... args) {
  say_text(fmt::format(format, std::forward<Args>(args)...));
}
template <typename... Args>
void show(fmt::format_string<Args...> format, Args&&... args) {
  show_text(fmt::format(format, std::forward<Args>(args)...));
}

/// Sends on what was shown so far; false if any of it, now or before, did not reach its reader.
bool flush_shown() noexcept;

/// Whether stdout is a pipe whose reader has gone, as `head` does once it has enough: what is shown
/// from then on goes nowhere, and that is no failure.
bool reader_has_left() noexcept;

/// For signal handlers, which may call next to nothing: this.
void say_in_handler(std::string_view text) noexcept;

}  // namespace throng
