#include "apps/process/terminal.h"

#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdint>
#include <initializer_list>
#include <iterator>

#include "apps/process/stop_signal.h"
#include "base/console.h"
#include "base/text.h"

namespace throng {
namespace {

constexpr std::string_view kEnterScreen = "\033[?1049h\033[?25l";
constexpr std::string_view kLeaveScreen = "\033[?25h\033[?1049l";

// Signal handlers restore the terminal from these.
std::atomic<bool> g_is_shown{false}, g_has_keys{false};
termios g_before, g_for_keys;

/// Writes to stdout in a signal handler. A terminal that takes nothing gets nothing, because the
/// process would wait for it.
void write_in_handler(std::string_view text) {
  pollfd writable{STDOUT_FILENO, POLLOUT, 0};
  if (::poll(&writable, 1, 0) <= 0) return;
  [[maybe_unused]] const ssize_t written = ::write(STDOUT_FILENO, text.data(), text.size());
}

void restore_in_handler() {
  if (!g_is_shown) return;
  if (g_has_keys) {
    tcflow(STDOUT_FILENO, TCOON);  // Ctrl-S may have halted it
    tcsetattr(STDIN_FILENO, TCSANOW, &g_before);
  }
  write_in_handler(kLeaveScreen);
}

void end_in_handler(int signal) {
  restore_in_handler();
  ::raise(signal);  // with the default action: see SA_RESETHAND
}

void on_signal(int signal, void (*handler)(int)) {
  struct sigaction action = {};
  action.sa_handler = handler;
  if (handler != SIG_DFL)
    action.sa_flags = static_cast<int>(SA_RESETHAND | SA_NODEFER | SA_RESTART);
  sigemptyset(&action.sa_mask);
  sigaction(signal, &action, nullptr);
}

/// Ctrl-Z: the shell gets its screen; the picture returns with `fg`.
void stop_in_handler(int signal) {
  restore_in_handler();
  ::raise(signal);  // stops here
  on_signal(signal, stop_in_handler);
  if (!g_is_shown) return;
  if (g_has_keys) tcsetattr(STDIN_FILENO, TCSANOW, &g_for_keys);
  write_in_handler(kEnterScreen);
}

constexpr int kEndings[] = {SIGQUIT, SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL};

/// Bytes of the escape sequence at the start of `text`, such as an arrow key; 1 for Escape itself.
size_t sequence_bytes(std::string_view text) {
  if (text.size() < 2 || (text[1] != '[' && text[1] != 'O')) return 1;
  size_t end = 2;
  while (end < text.size() && (text[end] < '@' || text[end] > '~')) ++end;
  return std::min(end + 1, text.size());
}

struct Range {
  uint32_t first, last;
};
// East Asian wide characters and emoji; combining marks (Unicode 15, in coarse blocks).
constexpr Range kWide[] = {{0x1100, 0x115f}, {0x2e80, 0xa4cf},   {0xac00, 0xd7a3},
                           {0xf900, 0xfaff}, {0xfe30, 0xfe6f},   {0xff00, 0xff60},
                           {0xffe0, 0xffe6}, {0x1f300, 0x1faff}, {0x20000, 0x3fffd}};
constexpr Range kNoWidth[] = {{0x0300, 0x036f}, {0x200b, 0x200f}, {0xfe00, 0xfe0f}};

int columns_of(std::string_view character) {
  const auto lead = static_cast<unsigned char>(character[0]);
  uint32_t code = character.size() == 1 ? lead : lead & (0x7fU >> character.size());
  for (const char c : character.substr(1))
    code = code << 6 | (static_cast<unsigned char>(c) & 0x3f);
  const auto is_in = [code](const auto& ranges) {
    return std::any_of(std::begin(ranges), std::end(ranges), [code](const Range& range) {
      return range.first <= code && code <= range.last;
    });
  };
  return is_in(kWide) ? 2 : is_in(kNoWidth) ? 0 : 1;
}

}  // namespace

bool Terminal::is_available() { return isatty(STDOUT_FILENO) != 0; }

Terminal::Terminal() {
  if (!is_available()) return;
  has_keys_ = tcgetpgrp(STDIN_FILENO) == getpgrp() && tcgetattr(STDIN_FILENO, &g_before) == 0;
  if (has_keys_) {
    g_for_keys = g_before;
    g_for_keys.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    g_for_keys.c_iflag &= ~static_cast<tcflag_t>(ICRNL);
    g_for_keys.c_cc[VMIN] = 0;
    g_for_keys.c_cc[VTIME] = 0;
  }
  g_has_keys = has_keys_;
  g_is_shown = true;
  StopSignal::before_exit(restore_in_handler);
  for (const int signal : kEndings) on_signal(signal, end_in_handler);
  on_signal(SIGTSTP, stop_in_handler);
  if (has_keys_) tcsetattr(STDIN_FILENO, TCSANOW, &g_for_keys);
  print_result("{}", kEnterScreen);
}

Terminal::~Terminal() {
  if (!g_is_shown) return;
  print_result("{}", kLeaveScreen);
  flush_results();
  if (has_keys_) tcsetattr(STDIN_FILENO, TCSANOW, &g_before);
  g_is_shown = g_has_keys = false;
  StopSignal::before_exit(nullptr);
  for (const int signal : kEndings) on_signal(signal, SIG_DFL);
  on_signal(SIGTSTP, SIG_DFL);
}

Terminal::Size Terminal::size() const {
  winsize size{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0 || size.ws_row == 0)
    return {};
  return {size.ws_col, size.ws_row};
}

bool Terminal::draw(const std::vector<std::string>& lines) {
  const Size now = size();
  std::string text = now == drawn_ ? "\033[H" : "\033[H\033[2J";
  drawn_ = now;
  const size_t count = std::min(lines.size(), static_cast<size_t>(now.rows));
  for (size_t i = 0; i < count; ++i) {
    // Erases first: after the last column some terminals would erase the last character.
    text += (i == 0 ? "\033[2K" : "\r\n\033[2K") + cut_to_columns(lines[i], now.columns);
  }
  if (count < static_cast<size_t>(now.rows)) text += "\r\n\033[J";
  print_result("{}", text);
  return flush_results();
}

std::string Terminal::typed() {
  char buffer[256];
  const ssize_t got = has_keys_ ? ::read(STDIN_FILENO, buffer, sizeof buffer) : 0;
  std::string keys;
  for (std::string_view rest(buffer, got > 0 ? static_cast<size_t>(got) : 0); !rest.empty();) {
    const size_t bytes = rest[0] == kEscape ? sequence_bytes(rest) : 1;
    const auto key = static_cast<unsigned char>(rest[0] == '\b' ? kBackspace : rest[0]);
    if (bytes == 1 && (key >= ' ' || key == kEnter || key == kEscape))
      keys += static_cast<char>(key);
    rest.remove_prefix(bytes);
  }
  return keys;
}

std::string cut_to_columns(std::string_view text, int columns) {
  std::string out;
  while (!text.empty()) {
    const size_t bytes = std::max<size_t>(1, printable_character(text));
    const std::string_view character = text.substr(0, bytes);
    columns -= columns_of(character);
    if (columns < 0) break;
    out += character;
    text.remove_prefix(bytes);
  }
  return out;
}

}  // namespace throng
