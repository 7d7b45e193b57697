#include "apps/commands/monitor_screen.h"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <iterator>
#include <string_view>

#include "apps/process/terminal.h"
#include "base/errors.h"
#include "base/text.h"

namespace throng {
namespace {

constexpr const char* kSorts[] = {"newest", "longest", "number"};
constexpr const char* kWiths[] = {"all", "people", "robots", "obstacles"};
constexpr size_t kMaxTyped = 40;
constexpr size_t kPartRows = 6;
constexpr int kAllKeys = 60;  // columns that the keys and their states take; fewer are narrow

template <typename Choice>
Choice next(Choice choice, size_t count) {
  return static_cast<Choice>((static_cast<size_t>(choice) + 1) % count);
}

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return out;
}

/// Whether a word of `text` is `word`, or begins with it unless it is a number.
bool has_word(const std::string& text, const std::string& word) {
  const bool is_number = word.find_first_not_of("0123456789") == std::string::npos;
  for (size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    const size_t end = at + word.size();
    const bool ends = end == text.size() || text[end] == ' ' || text[end] == ',';
    if ((at == 0 || text[at - 1] == ' ') && (ends || !is_number)) return true;
  }
  return false;
}

void append_section(std::vector<std::string>& lines, const std::vector<std::string>& section,
                    size_t max_lines) {
  if (lines.size() + section.size() + 1 > max_lines) return;
  lines.emplace_back();
  lines.insert(lines.end(), section.begin(), section.end());
}

}  // namespace

bool MonitorScreen::press(char key) {
  if (is_typing_) {
    type(key);
    return true;
  }
  switch (key) {
    case 'q':
      return false;
    case 's':
      sort_ = next(sort_, std::size(kSorts));
      break;
    case 'f':
      with_ = next(with_, std::size(kWiths));
      break;
    case '/':
      is_typing_ = true;
      break;
    case Terminal::kEscape:
      text_.clear();
      break;
    case 'r':
      follow_next();
      break;
    default:
      break;
  }
  return true;
}

void MonitorScreen::type(char key) {
  if (key == Terminal::kEscape) text_.clear();
  if (key == Terminal::kEscape || key == Terminal::kEnter) {
    is_typing_ = false;
  } else if (key != Terminal::kBackspace) {
    if (text_.size() < kMaxTyped) text_ += key;
  } else if (!text_.empty()) {
    text_.pop_back();
  }
}

std::vector<MonitorScreen::RunName> MonitorScreen::choices() const {
  const RunName followed{inbox_.run().run_id(), inbox_.run().instance()};
  std::vector<RunName> names;
  for (const RunTally& run : inbox_.runs()) {
    const RunName name{run.run_id, run.instance};
    if (!run.ended || name == followed) names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

void MonitorScreen::follow_next() {
  const std::vector<RunName> names = choices();
  if (names.size() < 2) return;
  const RunName followed{inbox_.run().run_id(), inbox_.run().instance()};
  const auto after = std::upper_bound(names.begin(), names.end(), followed);
  const RunName& name = after == names.end() ? names.front() : *after;
  inbox_.run().follow(name.first, name.second);
}

void MonitorScreen::learn_people() {
  RunReader& run = inbox_.run();
  const RunName followed{run.run_id(), run.instance()};
  if (run.run() == nullptr || (followed == known_ && !is_person_.empty())) return;
  known_ = followed;
  is_person_.clear();
  for (size_t m = 0; m < run.run()->models.size(); ++m) {
    try {
      is_person_.push_back(run.model(m)->is_person);
    } catch (const InputError&) {
      is_person_.push_back(false);  // a damaged body model; its contacts still have names
    }
  }
}

MonitorScreen::With MonitorScreen::with(PairKey pair) const {
  const run_description_t* run = inbox_.run().run();
  const auto is_avatar = [run](uint32_t body) { return body < run->model_of_avatar.size(); };
  const auto is_person = [&](uint32_t body) {
    return is_person_[static_cast<size_t>(run->model_of_avatar[body])];
  };
  if (!is_avatar(pair.a()) || !is_avatar(pair.b())) return With::kObstacles;
  return is_person(pair.a()) && is_person(pair.b()) ? With::kPeople : With::kRobots;
}

bool MonitorScreen::is_shown(const Monitor::Note& note, const std::string& text) const {
  if (with_ != With::kAny && (inbox_.run().run() == nullptr || with(note.pair) != with_))
    return false;
  const std::vector<std::string> words = split_text(text_, ' ');
  const std::string searched = words.empty() ? "" : lower(text);
  return std::all_of(words.begin(), words.end(), [&](const std::string& word) {
    return word.empty() || has_word(searched, lower(word));
  });
}

/// Returns a title and `rows` lines.
std::vector<std::string> MonitorScreen::contact_lines(const MonitorView& view, size_t rows) {
  struct Row {
    const Monitor::Note* note;
    std::string text;
  };
  const std::deque<Monitor::Note>& notes = view.monitor.notes();
  std::vector<Row> shown;
  for (auto note = notes.rbegin(); note != notes.rend(); ++note) {
    if (sort_ == Sort::kLongest && note->lasted_s < 0) continue;
    std::string text = text_of(*note, inbox_.run().run());
    if (is_shown(*note, text)) shown.push_back({&*note, std::move(text)});
    if (sort_ == Sort::kNewest && shown.size() == rows) break;
  }
  if (sort_ == Sort::kLongest)
    std::stable_sort(shown.begin(), shown.end(), [](const Row& x, const Row& y) {
      return x.note->lasted_s > y.note->lasted_s;
    });
  if (sort_ == Sort::kNumber)
    std::stable_sort(shown.begin(), shown.end(),
                     [](const Row& x, const Row& y) { return x.note->pair < y.note->pair; });
  std::string title = sort_ == Sort::kNewest    ? "newest contacts"
                      : sort_ == Sort::kLongest ? "longest of the newest contacts"
                                                : "newest contacts by number";
  if (with_ != With::kAny) title += fmt::format(", {}", kWiths[static_cast<size_t>(with_)]);
  if (!text_.empty()) title += fmt::format(", with {}", in_quotes(text_));
  if (shown.empty() && !notes.empty())
    title += fmt::format(": none of the last {}", counted(notes.size(), "event"));
  const bool is_narrow = view.width < kAllKeys;
  std::vector<std::string> lines = {title};
  for (size_t i = 0; i < std::min(rows, shown.size()); ++i) {
    const double time_s = static_cast<double>(shown[i].note->utime_us) * 1e-6;
    lines.push_back(
        (is_narrow ? fmt::format("{:.2f} s ", time_s) : fmt::format("{:>9.3f} s  ", time_s)) +
        shown[i].text);
  }
  lines.resize(rows + 1);
  return lines;
}

std::string MonitorScreen::key_line(int width) const {
  if (!has_keys_) return "Ctrl-C quit";
  if (is_typing_) return fmt::format("find: {}_   Enter keep  Esc clear", escaped(text_));
  const size_t runs = choices().size();
  if (width < kAllKeys)
    return fmt::format("q quit  s sort  f filter  / find{}", runs > 1 ? "  r run" : "");
  std::string line =
      fmt::format("q quit  s sort: {}  f filter: {}  / find{}", kSorts[static_cast<size_t>(sort_)],
                  kWiths[static_cast<size_t>(with_)], text_.empty() ? "" : ": " + escaped(text_));
  if (runs > 1) line += fmt::format("  r next of {} runs", runs);
  return line;
}

std::vector<std::string> MonitorScreen::lines(const MonitorView& view) {
  learn_people();
  const auto height = static_cast<size_t>(std::max(1, view.height));
  std::vector<std::string> lines = {title_of(view)};
  if (!inbox_.runs().empty()) {
    const std::vector<std::string> rates = rate_lines(view);
    lines.insert(lines.end(), rates.begin(), rates.end());
    lines.emplace_back();
    // The lower half is for the other figures.
    const size_t left = height > lines.size() + 2 ? height - lines.size() - 2 : 0;
    std::vector<std::string> others;
    append_section(others, part_lines(view, kPartRows + 1), left / 2);
    append_section(others, stage_lines(view), left / 2);
    append_section(others, channel_lines(view), left / 2);
    const std::vector<std::string> contacts = contact_lines(view, left - others.size());
    lines.insert(lines.end(), contacts.begin(), contacts.end());
    lines.insert(lines.end(), others.begin(), others.end());
  }
  lines.resize(height - 1);
  lines.push_back(key_line(view.width));
  return lines;
}

}  // namespace throng
