// MonitorScreen is what `throng monitor` shows in a terminal: the newest contacts, sorted and
// filtered by keys, then the other figures.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "apps/commands/monitor_view.h"

namespace throng {

class MonitorScreen {
 public:
  MonitorScreen(Inbox& inbox, bool has_keys) : inbox_(inbox), has_keys_(has_keys) {}

  /// Acts on a key of Terminal::typed(); returns false if it asks to quit.
  bool press(char key);
  /// Returns at most view.height lines; the last names the keys.
  std::vector<std::string> lines(const MonitorView& view);

 private:
  enum class Sort { kNewest, kLongest, kNumber };
  /// What a contact is with, as on the page: an obstacle, a robot, or people only.
  enum class With { kAny, kPeople, kRobots, kObstacles };
  using RunName = std::pair<int64_t, int64_t>;  // run_id and instance

  void type(char key);
  void follow_next();
  /// Runs that have not ended, and the followed one, in a fixed order.
  std::vector<RunName> choices() const;
  void learn_people();
  With with(PairKey pair) const;
  bool is_shown(const Monitor::Note& note, const std::string& text) const;
  std::vector<std::string> contact_lines(const MonitorView& view, size_t rows);
  std::string key_line(int width) const;

  Inbox& inbox_;
  bool has_keys_;
  Sort sort_ = Sort::kNewest;
  With with_ = With::kAny;
  bool is_typing_ = false;
  std::string text_;  ///< words that shown contacts contain
  // Known about the followed run.
  RunName known_{0, 0};
  std::vector<bool> is_person_;  ///< one per model
};

}  // namespace throng
