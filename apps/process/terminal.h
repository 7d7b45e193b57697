// Terminal shows a full-screen picture on stdout and reads keys from stdin.
// Invariant: the terminal is restored by returns, exceptions, signals and crashes, and while the
// process is stopped (Ctrl-Z).
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace throng {

/// At most one object at a time; used by one thread.
class Terminal {
 public:
  /// Switches to the alternate screen, without a cursor, if stdout is a terminal. Keys come without
  /// echo and without waiting for a line if stdin is a terminal and this process is in front.
  Terminal();
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  /// Whether stdout is a terminal.
  static bool is_available();
  bool has_keys() const { return has_keys_; }

  struct Size {
    int columns = 80, rows = 24;
    bool operator==(const Size&) const = default;
  };
  Size size() const;

  /// Replaces the picture. Lines over the size are cut. Returns false if stdout is closed.
  bool draw(const std::vector<std::string>& lines);

  /// Returns the keys typed since the last call: printable characters, kEnter, kEscape and
  /// kBackspace. Other keys are dropped.
  std::string typed();
  static constexpr char kEnter = '\r', kEscape = '\033', kBackspace = '\177';

 private:
  bool has_keys_ = false;
  Size drawn_;
};

/// Cuts valid UTF-8 text to a number of terminal columns.
std::string cut_to_columns(std::string_view text, int columns);

}  // namespace throng
