#include "scenes/file/part_words.h"

#include <algorithm>
#include <cctype>

namespace throng {
namespace {

bool is_lower(char c) { return std::islower(static_cast<unsigned char>(c)) != 0; }
bool is_upper(char c) { return std::isupper(static_cast<unsigned char>(c)) != 0; }

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

}  // namespace throng
