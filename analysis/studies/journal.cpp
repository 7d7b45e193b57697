#include "analysis/studies/journal.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <set>

#include "analysis/studies/study_table.h"
#include "base/checksum.h"
#include "base/errors.h"
#include "base/files/regular_file.h"
#include "base/text.h"

namespace throng {
namespace {

constexpr uint64_t kMaxJournalBytes = uint64_t{1} << 32;

std::string sealed(const std::string& text) {
  return fmt::format("{},{:016x}\n", text, checksum(text));
}

EnvironmentError write_error(const std::filesystem::path& file) {
  return EnvironmentError(
      fmt::format("{}: cannot write the study's journal: {}", file.string(), std::strerror(errno)));
}

}  // namespace

std::filesystem::path journal_of(const std::filesystem::path& table) {
  std::filesystem::path file = table;
  file += ".journal";
  return file;
}

std::string line_of(const StudyRow& row) {
  std::vector<std::string> cells = {fmt::format("{}", row.run),
                                    fmt::format("{}", row.measures.size())};
  cells.insert(cells.end(), row.measures.begin(), row.measures.end());
  cells.insert(cells.end(), row.times.begin(), row.times.end());
  return sealed(csv_line(cells));
}

bool read_line(const std::string& line, StudyRow& row) {
  const size_t comma = line.rfind(',');
  if (comma == std::string::npos || sealed(line.substr(0, comma)) != line + "\n") return false;
  const std::vector<std::string> cells = parse_csv(line.substr(0, comma), "journal").columns;
  const auto number = [&](size_t at, size_t& value) {
    return std::from_chars(cells[at].data(), cells[at].data() + cells[at].size(), value).ec ==
           std::errc();
  };
  size_t measures = 0;
  if (cells.size() < 2 || !number(0, row.run) || !number(1, measures) ||
      measures != study_measures().size() || cells.size() != 2 + measures + study_times().size())
    return false;
  const auto times = cells.begin() + 2 + static_cast<ptrdiff_t>(measures);
  row.measures.assign(cells.begin() + 2, times);
  row.times.assign(times, cells.end());
  return true;
}

Journal::Journal(std::filesystem::path file, const std::string& owner) : file_(std::move(file)) {
  const std::string head = "throng study journal 1; " + owner + "\n";
  descriptor_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (descriptor_ < 0) throw write_error(file_);
  const RegularFile opened(file_, "a study's journal", kMaxJournalBytes);
  const std::vector<uint8_t> bytes = opened.bytes();
  const size_t sound = read({bytes.begin(), bytes.end()}, head);
  if (::ftruncate(descriptor_, static_cast<off_t>(sound)) != 0) throw write_error(file_);
  if (sound == 0 &&
      ::write(descriptor_, head.data(), head.size()) != static_cast<ssize_t>(head.size()))
    throw write_error(file_);
}

/// Returns the number of bytes in whole lines.
size_t Journal::read(const std::string& text, const std::string& head) {
  const size_t end = text.find('\n');
  if (end == std::string::npos && head.starts_with(text)) return 0;  // ended within the head
  if (!text.starts_with(head))
    throw InputError(file_.string(),
                     fmt::format("a journal of this study ({})", head.substr(0, head.size() - 1)),
                     fmt::format("{}; remove it to start again, or choose another --out",
                                 in_quotes(text.substr(0, end))));
  std::set<size_t> seen;
  size_t at = head.size();
  for (size_t next = 0; (next = text.find('\n', at)) != std::string::npos; at = next + 1) {
    StudyRow row;
    if (read_line(text.substr(at, next - at), row) && seen.insert(row.run).second)
      done_.push_back(std::move(row));
  }
  return at;
}

Journal::~Journal() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void Journal::add(const StudyRow& row) {
  const std::string line = line_of(row);
  size_t done = 0;
  while (done < line.size()) {
    const ssize_t n = ::write(descriptor_, line.data() + done, line.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw write_error(file_);
    done += static_cast<size_t>(n);
  }
}

void Journal::remove() { ::unlink(file_.c_str()); }

}  // namespace throng
