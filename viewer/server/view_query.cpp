#include "viewer/server/view_query.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace throng {

ViewQuery parse_view_query(std::string_view text) {
  const auto json = nlohmann::json::parse(text, nullptr, false);
  ViewQuery query;
  if (!json.is_object()) return query;
  const auto number = [&](const char* key, int64_t max) -> std::optional<int64_t> {
    const auto found = json.find(key);
    if (found == json.end() || !found->is_number_integer()) return std::nullopt;
    const auto value = found->get<int64_t>();
    if (value < 0 || value > max) return std::nullopt;
    return value;
  };
  constexpr int64_t kMaxFrame = int64_t{1} << 40;
  query.frame = number("frame", kMaxFrame);
  query.since = number("since", kMaxFrame);
  // Without a valid frame the answer would list the whole run.
  if (query.since || !json.contains("since")) {
    if (const auto contacts = number("contacts", int64_t{1} << 53))
      query.contacts = static_cast<uint64_t>(*contacts);
    if (const auto body = number("proximity", UINT32_MAX))
      query.proximity = static_cast<uint32_t>(*body);
  }
  if (const auto person = number("history", UINT32_MAX))
    query.person = static_cast<uint32_t>(*person);
  query.positions = number("positions", kMaxFrame);
  query.to = number("to", kMaxFrame).value_or(0);
  query.every = std::max(int64_t{1}, number("every", kMaxFrame).value_or(1));
  query.index = json.contains("index");
  return query;
}

}  // namespace throng
