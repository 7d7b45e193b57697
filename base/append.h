// Text that grows piece by piece.
// One rule: fmt's library formats it; fmt::format_to() compiles half of fmt into each file that
// calls it, three seconds of a compiler's time.
#pragma once

#include <fmt/format.h>

#include <string>

namespace throng {

template <typename... Values>
void append(std::string& text, fmt::format_string<Values...> format, const Values&... values) {
  text += fmt::vformat(format, fmt::make_format_args(values...));
}

}  // namespace throng
