#include "viewer/server/questions.h"

#include <nlohmann/json.hpp>

namespace throng {

Question parse_question(std::string_view text) {
  const auto json = nlohmann::json::parse(text, nullptr, false);
  Question question;
  if (!json.is_object()) return question;
  const auto number = [&](const char* key, int64_t most) -> std::optional<int64_t> {
    const auto found = json.find(key);
    if (found == json.end() || !found->is_number_integer()) return std::nullopt;
    const auto value = found->get<int64_t>();
    if (value < 0 || value > most) return std::nullopt;
    return value;
  };
  question.frame = number("frame", int64_t{1} << 40);
  if (const auto person = number("history", UINT32_MAX))
    question.person = static_cast<uint32_t>(*person);
  question.index = json.contains("index");
  return question;
}

}  // namespace throng
