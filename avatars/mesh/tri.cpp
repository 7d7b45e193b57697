#include "avatars/mesh/tri.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>

#include "base/errors.h"
#include "base/files/regular_file.h"
#include "base/text.h"

namespace throng {
namespace {

/// A body scan of five million points is about 250 MB of text; larger files are no body part.
constexpr uintmax_t kMaxTriBytes = uintmax_t{512} << 20;
/// Length in bytes of the shortest lines, such as "0 1 2"; limits the memory reserved for a file.
constexpr size_t kMinLineBytes = 6;
/// The earth's radius is 6.4e6 m; products of larger coordinates exceed the range of a float.
constexpr float kMaxTriCoordinate_m = 1e7F;
std::string plural(size_t count, const char* what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }

/// Words of a line; those beyond the fourth are counted, but not stored.
struct Words {
  std::array<std::string_view, 4> word;
  size_t count = 0;
};

Words split(std::string_view line) {
  Words words;
  for (size_t i = 0; i < line.size();) {
    if (is_space(line[i])) {
      ++i;
      continue;
    }
    size_t end = i;
    while (end < line.size() && !is_space(line[end])) ++end;
    if (words.count < words.word.size()) words.word[words.count] = line.substr(i, end - i);
    ++words.count;
    i = end;
  }
  return words;
}

/// from_chars() rejects a plus sign, although "+1.5" is common.
std::string_view without_plus(std::string_view word) {
  return word.size() > 1 && word[0] == '+' && word[1] != '-' && word[1] != '+' ? word.substr(1)
                                                                               : word;
}

std::optional<long long> whole_number(std::string_view word) {
  word = without_plus(word);
  long long value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

std::optional<float> coordinate(std::string_view word) {
  word = without_plus(word);
  const char* const last = word.data() + word.size();
  float value = 0;
  const auto [end, error] = std::from_chars(word.data(), last, value);
  if (end != last) return std::nullopt;
  if (error == std::errc::result_out_of_range) {
    // Near zero is harmless, too large is not.
    double wide = 0;
    if (std::from_chars(word.data(), last, wide).ec != std::errc() || std::abs(wide) > 1)
      return std::nullopt;
    return 0.0F;
  }
  if (error != std::errc() || !(std::abs(value) <= kMaxTriCoordinate_m)) return std::nullopt;
  return value;
}

/// Iterates over lines with content; skips comments and blank lines.
class Lines {
 public:
  Lines(std::string_view text, const std::string& file, TriDialect& dialect)
      : text_(text), file_(file), dialect_(dialect) {}

  bool next() {
    while (at_ < text_.size()) {
      const size_t end = std::min(text_.find_first_of("\r\n", at_), text_.size());
      std::string_view line = text_.substr(at_, end - at_);
      ++number_;
      at_ = end;
      if (at_ < text_.size()) {
        const bool crlf = text_.substr(at_, 2) == "\r\n";
        dialect_.crlf |= crlf;
        at_ += crlf ? 2 : 1;
      }
      line = without_comment(line);
      words_ = split(line);
      if (words_.count > 0) return true;
    }
    return false;
  }

  const Words& words() const { return words_; }
  void drop_first_word() {
    for (size_t i = 0; i + 1 < words_.word.size(); ++i) words_.word[i] = words_.word[i + 1];
    --words_.count;
  }
  size_t bytes_left() const { return text_.size() - at_; }
  /// Maximum number of lines in the rest; the last may lack its line end.
  size_t line_capacity() const { return (bytes_left() + 1) / kMinLineBytes; }

  [[noreturn]] void fail(const std::string& expected, const std::string& found) const {
    throw InputError(at_line(file_, number_), expected, found);
  }
  /// Reports the end of the file at the line after the last, as text editors number it.
  [[noreturn]] void fail_at_end(const std::string& expected) const {
    throw InputError(at_line(file_, std::max(number_, 1)), expected, "the end of the file");
  }

 private:
  std::string_view without_comment(std::string_view line) {
    const size_t slashes = line.find("//");
    const size_t start = std::min(line.find_first_of("#;"), slashes);
    if (start == std::string_view::npos) return line;
    dialect_.comments = true;
    return line.substr(0, start);
  }

  std::string_view text_;
  const std::string& file_;
  TriDialect& dialect_;
  Words words_;
  size_t at_ = 0;
  int number_ = 0;
};

size_t count_of(const Lines& lines, std::string_view word, const char* what, long long min_count) {
  const auto count = whole_number(word);
  const std::string expected = fmt::format("the number of {}", what);
  if (!count) lines.fail(expected, in_quotes(word));
  if (*count < min_count)
    lines.fail(fmt::format("{} to be at least {}", expected, min_count), std::to_string(*count));
  // More lines than bytes is a wrong count; slightly too many is a truncated file, reported later.
  if (static_cast<unsigned long long>(*count) > lines.bytes_left())
    lines.fail(fmt::format("{} to fit into the file ({} bytes left)", expected, lines.bytes_left()),
               std::to_string(*count));
  return static_cast<size_t>(*count);
}

void read_vertices(Lines& lines, size_t count, Mesh& mesh) {
  mesh.vertices.reserve(std::min(count, lines.line_capacity()));
  for (size_t i = 0; i < count; ++i) {
    if (!lines.next())
      lines.fail_at_end(fmt::format("3 coordinates (vertex {} of {})", i + 1, count));
    const Words& words = lines.words();
    if (words.count != 3) lines.fail("3 coordinates", plural(words.count, "word"));
    Eigen::Vector3f vertex;
    for (size_t k = 0; k < 3; ++k) {
      const auto value = coordinate(words.word[k]);
      if (!value)
        lines.fail(
            fmt::format("a coordinate within {:.0e} m", static_cast<double>(kMaxTriCoordinate_m)),
            in_quotes(words.word[k]));
      vertex[static_cast<Eigen::Index>(k)] = *value;
    }
    mesh.vertices.push_back(vertex);
  }
}

/// Indices count from 0 unless one of them equals the number of vertices and none is 0.
void read_triangles(Lines& lines, size_t count, TriFile& file) {
  const auto vertices = static_cast<long long>(file.mesh.vertices.size());
  bool zero_seen = false;
  bool end_seen = false;
  file.mesh.triangles.reserve(std::min(count, lines.line_capacity()));
  for (size_t i = 0; i < count; ++i) {
    if (!lines.next())
      lines.fail_at_end(fmt::format("3 vertex indices (triangle {} of {})", i + 1, count));
    const Words& words = lines.words();
    if (words.count != 3) lines.fail("3 vertex indices", std::to_string(words.count));
    Eigen::Vector3i triangle;
    for (size_t k = 0; k < 3; ++k) {
      const auto index = whole_number(words.word[k]);
      if (!index) lines.fail("a vertex index", in_quotes(words.word[k]));
      zero_seen |= *index == 0;
      end_seen |= *index == vertices;
      if (*index < 0 || *index > vertices || (zero_seen && end_seen))
        lines.fail(fmt::format("a vertex index from 0 to {}", vertices - 1),
                   in_quotes(words.word[k]));
      triangle[static_cast<Eigen::Index>(k)] = static_cast<int>(*index);
    }
    file.mesh.triangles.push_back(triangle);
  }
  file.dialect.one_based = end_seen;
  if (!end_seen) return;
  for (Eigen::Vector3i& triangle : file.mesh.triangles) triangle.array() -= 1;
}

bool is_keyword(std::string_view word) {
  return word.size() == 3 && std::tolower(static_cast<unsigned char>(word[0])) == 't' &&
         std::tolower(static_cast<unsigned char>(word[1])) == 'r' &&
         std::tolower(static_cast<unsigned char>(word[2])) == 'i';
}

/// Throws if the text contains a NUL byte; reports its line.
void reject_binary(std::string_view text, const std::string& file_name) {
  const size_t nul = text.find('\0');
  if (nul == std::string_view::npos) return;
  int line = 1;
  for (const char c : text.substr(0, nul)) line += c == '\n';
  throw InputError(at_line(file_name, line), "text", "a NUL byte (a binary file?)");
}

}  // namespace

TriFile parse_tri(std::string_view text, const std::string& file_name) {
  TriFile file;
  if (text.substr(0, 3) == "\xEF\xBB\xBF") {
    file.dialect.byte_order_mark = true;
    text.remove_prefix(3);
  }
  reject_binary(text, file_name);
  Lines lines(text, file_name, file.dialect);
  if (!lines.next()) lines.fail_at_end("the number of vertices");
  if (is_keyword(lines.words().word[0])) {
    file.dialect.keyword = true;
    lines.drop_first_word();
    if (lines.words().count == 0 && !lines.next()) lines.fail_at_end("the number of vertices");
  }
  const Words counts = lines.words();
  if (counts.count > 2)
    lines.fail("the number of vertices, alone or with the number of triangles",
               plural(counts.count, "word"));
  file.dialect.counts_on_one_line = counts.count == 2;
  const size_t vertex_count = count_of(lines, counts.word[0], "vertices", 1);
  size_t triangle_count = 0;
  if (counts.count == 2) triangle_count = count_of(lines, counts.word[1], "triangles", 0);
  read_vertices(lines, vertex_count, file.mesh);
  if (counts.count == 1 && lines.next()) {
    if (lines.words().count != 1)
      lines.fail("the number of triangles, or the end of the file",
                 plural(lines.words().count, "word"));
    triangle_count = count_of(lines, lines.words().word[0], "triangles", 0);
  }
  read_triangles(lines, triangle_count, file);
  if (lines.next()) lines.fail("the end of the file", in_quotes(lines.words().word[0]));
  return file;
}

TriFile read_tri(const std::filesystem::path& path) {
  const RegularFile file(path, "a .tri file", kMaxTriBytes);
  std::string text(static_cast<size_t>(file.size()), '\0');
  file.read(std::as_writable_bytes(std::span(text)));
  return parse_tri(text, path.string());
}

namespace {

template <typename Number, typename... Format>
void append(std::string& out, Number value, char after, Format... format) {
  char digits[64];  // longest fixed floats: -3.4e38 has 40 characters, 1e-45 has 55
  const auto end = std::to_chars(digits, digits + sizeof digits, value, format...).ptr;
  out.append(digits, end);
  out.push_back(after);
}

}  // namespace

std::string format_tri(const Mesh& mesh) {
  std::string out;
  out.reserve(mesh.vertices.size() * 30 + mesh.triangles.size() * 16 + 16);
  append(out, mesh.vertices.size(), '\n');
  // Adding zero turns -0 into 0. The shortest exact digits are equal for all compilers.
  for (const Eigen::Vector3f& v : mesh.vertices)
    for (int i = 0; i < 3; ++i)
      append(out, v[i] + 0.0F, i < 2 ? ' ' : '\n', std::chars_format::fixed);
  append(out, mesh.triangles.size(), '\n');
  for (const Eigen::Vector3i& t : mesh.triangles)
    for (int i = 0; i < 3; ++i) append(out, t[i], i < 2 ? ' ' : '\n');
  return out;
}

}  // namespace throng
