#include "scenes/file/part_volumes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "avatars/model/model.h"
#include "base/errors.h"
#include "base/text.h"
#include "scenes/file/part_words.h"

namespace throng {
namespace {

constexpr std::string_view kDefault = "default";
constexpr size_t kMaxNamed = 32;
constexpr size_t kMaxNamesShown = 12;

VolumeKind volume_named(std::string_view name, std::string_view where) {
  if (const auto volume = volume_of(name)) return *volume;
  const std::vector<std::string> names = volume_names();
  throw InputError(where, fmt::format("one of {}", fmt::join(names, ", ")),
                   fmt::format("'{}'{}", name, did_you_mean(std::string(name), names)));
}

}  // namespace

VolumeKind PartVolumes::of(std::string_view part) const {
  if (named.empty()) return fallback;
  for (const Named& each : named)
    if (has_words(part, each.words)) return each.volume;
  return fallback;
}

std::string to_text(const PartVolumes& volumes) {
  if (volumes.named.empty()) return std::string(name_of(volumes.fallback));
  std::string text;
  for (const PartVolumes::Named& each : volumes.named)
    text += fmt::format("{}: {}, ", each.words, name_of(each.volume));
  return text + fmt::format("{}: {}", kDefault, name_of(volumes.fallback));
}

void add_part_volume(std::string_view words, std::string_view volume, std::string_view where,
                     PartVolumes& volumes) {
  const VolumeKind kind = volume_named(volume, where);
  if (words == kDefault) {
    volumes.fallback = kind;
    return;
  }
  if (part_words(words).empty() || words.find_first_of(",:\n") != std::string_view::npos)
    throw InputError(where, "words of the name of a part, as in 'hands: sphere'",
                     fmt::format("'{}'", words));
  const auto is_same = [&](const auto& each) { return each.words == words; };
  if (std::any_of(volumes.named.begin(), volumes.named.end(), is_same))
    throw InputError(where, "each part named once", fmt::format("'{}' twice", words));
  if (volumes.named.size() >= kMaxNamed)
    throw InputError(where, fmt::format("at most {} volumes of parts", kMaxNamed), "more");
  volumes.named.push_back({std::string(words), kind});
}

PartVolumes part_volumes_of(std::string_view text, std::string_view where) {
  if (text.find(':') == std::string_view::npos) return volume_named(text, where);
  PartVolumes volumes;
  for (size_t begin = 0; begin <= text.size();) {
    const size_t end = std::min(text.find(',', begin), text.size());
    const std::string_view entry = stripped(text.substr(begin, end - begin));
    const size_t colon = entry.find(':');
    if (colon == std::string_view::npos)
      throw InputError(where, "a volume, or 'hands: sphere, default: ordop26'",
                       fmt::format("'{}'", entry));
    add_part_volume(stripped(entry.substr(0, colon)), stripped(entry.substr(colon + 1)), where,
                    volumes);
    begin = end + 1;
  }
  return volumes;
}

void require_parts(const PartVolumes& volumes,
                   std::span<const std::shared_ptr<const Model>> models) {
  std::vector<std::string> names;
  for (const auto& model : models)
    for (const Part& part : model->parts) names.push_back(part.name);
  require_parts(volumes, std::move(names));
}

void require_parts(const PartVolumes& volumes, std::vector<std::string> part_names) {
  for (const PartVolumes::Named& named : volumes.named) {
    const auto is_taken = [&](const std::string& name) { return has_words(name, named.words); };
    if (std::any_of(part_names.begin(), part_names.end(), is_taken)) continue;
    const std::string nearest = did_you_mean(named.words, part_names);
    if (part_names.size() > kMaxNamesShown) {
      part_names.resize(kMaxNamesShown);
      part_names.emplace_back("...");
    }
    throw InputError("part_volume", fmt::format("words of a part: {}", fmt::join(part_names, ", ")),
                     fmt::format("'{}'{}", named.words, nearest));
  }
}

std::vector<std::string> volume_names() {
  std::vector<std::string> names;
  for (const VolumeKind kind : kAllVolumes) names.emplace_back(name_of(kind));
  return names;
}

}  // namespace throng
