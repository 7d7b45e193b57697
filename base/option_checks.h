// What an option accepts.
// One rule: a check returns "" or one line, "expected ..., found ...".
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace throng {

using OptionCheck = std::function<std::string(const std::string& argument)>;

/// Accepts a number in [low, high] (above low if `open`); `what` completes "expected ...".
OptionCheck number_option(double low, double high, bool open, const std::string& what);
/// Accepts a whole number in [low, high].
OptionCheck whole_option(int64_t low, int64_t high, const std::string& what);
/// Accepts one word of `count` pieces with `between` between them, each of which passes `piece`;
/// `what` completes "expected ...".
OptionCheck list_option(OptionCheck piece, size_t count, char between, const std::string& what);
/// Accepts one of the names, with a did-you-mean.
OptionCheck name_option(std::vector<std::string> names);

}  // namespace throng
