// Lines and numbers of recordings that are text.
// One rule: bytes come in pieces and lines are looked at where they lie; nothing of a file is ever
// in memory but the piece at hand and a line that is cut in two.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace throng {

/// What lines are given to.
class LineHandler {
 public:
  virtual ~LineHandler() = default;
  /// Without its end; `number` from 1.
  virtual void take(std::string_view line, int64_t number) = 0;
};

/// Cuts bytes into lines: "\n" or "\r\n", the last one with or without. Leaves out a byte order
/// mark. Throws InputError for a line longer than any table has.
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
  [[noreturn]] void refuse_long() const;

  const std::filesystem::path& file_;
  LineHandler& handler_;
  std::string partial_line_;  ///< the beginning of a line whose end has not come
  int64_t number_ = 0;
};

inline bool is_blank(char c) { return c == ' ' || c == '\t'; }
std::string_view trimmed(std::string_view text);
std::string lower(std::string_view text);

/// True if the text as a whole is a number; infinity and NaN are.
bool parse_number(std::string_view text, double& out);
/// True if it is a whole number, also as "12.0" and "1.2e+01", that a double holds.
bool parse_whole(std::string_view text, int64_t& out);
/// Digits behind the point, as many as there were without an exponent.
int decimals_of(std::string_view number);
/// Why a text is no whole number: the text, or that it is beyond what is counted in.
std::string defect_of_whole(std::string_view text);

/// Words between blanks.
std::vector<std::string_view> words_of(std::string_view line);

/// The same for `columns` columns (0: not known yet), where fields between tabs may be empty.
void fields_of(std::string_view line, size_t columns, std::vector<std::string_view>& out);

/// Where a number is not known.
inline constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
/// True for what stands where a number is not known: nothing, "nan", "<NA>", "null", "?", "-",
/// "1.#QNAN" and the like.
bool is_missing(std::string_view text);
/// True for a line that begins with the sign of a comment ('#', '%', "//"), but not with "#N/A".
bool is_comment(std::string_view line);
/// True for a row of empty fields: separators, blanks and quotes alone, and at least one separator.
bool is_empty_row(std::string_view line, char separator);
/// parse_number(), but kMissing for what is_missing().
bool parse_number_or_missing(std::string_view text, double& out);

}  // namespace throng
