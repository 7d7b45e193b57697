// Text lines splits text recordings into lines and parses numbers.
// Invariant: lines are parsed in place; only the current piece of the file and one incomplete line
// are in memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace throng {

class LineHandler {
 public:
  virtual ~LineHandler() = default;
  /// Called with a line without its end; `number` is from 1.
  virtual void take(std::string_view line, int64_t number) = 0;
};

/// LineSplitter splits bytes at "\n" or "\r\n", which the last line may lack. It omits a byte order
/// mark. Throws InputError for lines above kMaxLineBytes.
class LineSplitter {
 public:
  static constexpr size_t kMaxLineBytes = 64 << 10;

  LineSplitter(const std::filesystem::path& file, LineHandler& handler)
      : file_(file), handler_(handler) {}
  void push(std::string_view bytes);
  void end();
  int64_t lines() const { return number_; }

 private:
  void give(std::string_view line);
  [[noreturn]] void reject_long_line() const;

  const std::filesystem::path& file_;
  LineHandler& handler_;
  std::string partial_line_;  ///< start of a line whose end has not arrived
  int64_t number_ = 0;
};

inline bool is_blank(char c) { return c == ' ' || c == '\t'; }
std::string_view trimmed(std::string_view text);
std::string lower(std::string_view text);

bool parse_number(std::string_view text, double& out);
/// Returns whether it is a whole number that a double holds, such as "12.0" and "1.2e+01".
bool parse_whole(std::string_view text, int64_t& out);
/// Number of digits after the decimal point, without exponent.
int decimals_of(std::string_view number);
/// Describes why a text is no whole number: the text, or that it is too large.
std::string defect_of_whole(std::string_view text);

std::vector<std::string_view> words_of(std::string_view line);

/// Splits into words, or into `columns` columns (0: unknown) where fields between tabs may be
/// empty.
void fields_of(std::string_view line, size_t columns, std::vector<std::string_view>& out);

inline constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
/// Returns whether a text marks a missing number: "", "nan", "<NA>", "null", "?", "-", "1.#QNAN"
/// and similar.
bool is_missing(std::string_view text);
/// Returns whether a line begins with a comment sign ('#', '%', "//"); "#N/A" does not count.
bool is_comment(std::string_view line);
/// Returns whether all fields of a row are empty: separators, blanks and quotes, at least one
/// separator.
bool is_empty_row(std::string_view line, char separator);
bool parse_number_or_missing(std::string_view text, double& out);

}  // namespace throng
