#include "scenes/file/part_words.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "base/errors.h"

namespace throng {
namespace {

bool is_lower(char c) { return std::islower(static_cast<unsigned char>(c)) != 0; }
bool is_upper(char c) { return std::isupper(static_cast<unsigned char>(c)) != 0; }

[[noreturn]] void reject(const std::string& found, std::span<const std::string> names,
                         std::string_view where) {
  std::vector<std::string> known(names.begin(), names.end());
  constexpr size_t kMaxShown = 16;
  std::vector<std::string> shown(
      names.begin(),
      names.begin() + static_cast<std::ptrdiff_t>(std::min(names.size(), kMaxShown)));
  if (names.size() > kMaxShown) shown.emplace_back("...");
  for (const std::string& name : names)
    for (const std::string& word : part_words(name)) known.push_back(word);
  throw InputError(where,
                   fmt::format("a part number up to {}, or words of a part: {}", names.size() - 1,
                               fmt::join(shown, ", ")),
                   fmt::format("'{}'{}", found, did_you_mean(found, known)));
}

}  // namespace

std::set<std::string> part_words(std::string_view name) {
  std::set<std::string> words;
  std::string word;
  const auto end = [&] {
    if (word == "feet") word = "foot";
    if (word.size() > 2 && word.back() == 's' && word[word.size() - 2] != 's') word.pop_back();
    if (!word.empty()) words.insert(word);
    word.clear();
  };
  for (size_t i = 0; i < name.size(); ++i) {
    const char c = name[i];
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) {
      end();
      continue;
    }
    if (is_upper(c) && i > 0 && is_lower(name[i - 1])) end();
    word += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  end();
  return words;
}

bool has_words(std::string_view part, std::string_view words) {
  const std::set<std::string> has = part_words(part), asked = part_words(words);
  return std::includes(has.begin(), has.end(), asked.begin(), asked.end());
}

std::vector<uint8_t> chosen_parts(const PartChoice& choice, std::span<const std::string> names,
                                  std::string_view where) {
  if (const auto* number = std::get_if<int64_t>(&choice)) {
    if (*number < 0 || *number >= static_cast<int64_t>(names.size()))
      reject(std::to_string(*number), names, where);
    return {static_cast<uint8_t>(*number)};
  }
  const std::string& name = std::get<std::string>(choice);
  const bool is_name = std::find(names.begin(), names.end(), name) != names.end();
  const bool has_no_words = part_words(name).empty();
  std::vector<uint8_t> out;
  for (size_t part = 0; part < names.size(); ++part)
    if (name.empty() ||
        (is_name ? names[part] == name : !has_no_words && has_words(names[part], name)))
      out.push_back(static_cast<uint8_t>(part));
  if (out.empty()) reject(name, names, where);
  return out;
}

}  // namespace throng
