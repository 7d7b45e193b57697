// InputError and EnvironmentError end a command with the exit codes 2 and 3.
// Invariant: a message states the place, what was expected, what was found, and the remedy if there
// is one.
#pragma once

#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace throng {

/// Bad input (exit code 2). The message reads "where: expected X, found Y", for example
/// "avatars/models/adult/head.tri:17: expected 3 vertex indices, found 2".
class InputError : public std::runtime_error {
 public:
  InputError(std::string_view where, std::string_view expected, std::string_view found);

  /// First part of the message: "file:line", a file, an option.
  const std::string& where() const { return where_; }

 private:
  std::string where_;
};

/// Fault of the environment (exit code 3): a full disk, a missing folder, a dead socket.
class EnvironmentError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// "file:line", the form of `where` that editors make clickable.
std::string at_line(std::string_view file, int line);

/// " (did you mean 'NAME'?)" for a synonym of `found` or the candidate with the least edit distance
/// to it; "" if none is similar.
std::string did_you_mean(std::string_view found, std::span<const std::string> candidates);

}  // namespace throng
