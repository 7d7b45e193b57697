// Texts as fields of CSV (RFC 4180).
// One rule: what is a field as it stands is not quoted.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <string>

namespace throng {

/// A field that may hold commas; its own quotes are doubled.
inline std::string csv_quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + "\"";
}

/// A name as a field: quoted where it would not be one otherwise.
inline std::string csv_field(const std::string& name) {
  return name.find_first_of(",\"\r\n") == std::string::npos ? name : csv_quoted(name);
}

/// What is not known (NaN) is empty.
inline std::string csv_number(float value) {
  return std::isnan(value) ? "" : fmt::format("{}", value);
}

}  // namespace throng
