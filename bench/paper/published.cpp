#include "bench/paper/published.h"

#include <cstdlib>
#include <string>

namespace throng::paper {

const PublishedVolume* published_for(std::string_view volume) {
  for (const PublishedVolume& row : kPublished)
    if (volume.starts_with(row.volume)) return &row;
  return nullptr;
}

double legible(std::string_view printed) {
  if (printed.empty() || printed.front() == '?') return -1;
  const bool lost = printed.back() == '?';
  const std::string digits(printed.substr(0, printed.size() - (lost ? 1 : 0)));
  const double value = std::strtod(digits.c_str(), nullptr);
  return lost ? 10 * value + 4.5 : value;
}

}  // namespace throng::paper
