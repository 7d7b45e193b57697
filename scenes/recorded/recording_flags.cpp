#include "scenes/recorded/recording_flags.h"

#include <utility>

#include "base/errors.h"

namespace throng {
namespace {

constexpr std::pair<const char*, double> kUnits[] = {
    {"m", 1}, {"cm", 0.01}, {"mm", 0.001}, {"ft", 0.3048}, {"in", 0.0254}};
constexpr std::pair<const char*, char> kSeparators[] = {
    {"tab", '\t'}, {"blank", ' '}, {"comma", ','}, {"semicolon", ';'}};

}  // namespace

std::string RecordingFlags::given() const {
  if (fps) return "--fps";
  if (!unit.empty()) return "--unit";
  if (!columns.empty()) return "--columns";
  if (!separator.empty()) return "--separator";
  if (!tracks.empty()) return "--tracks";
  return strict ? "--strict" : "";
}

std::vector<std::string> unit_names() {
  std::vector<std::string> names;
  for (const auto& [name, unit_m] : kUnits) names.emplace_back(name);
  return names;
}

std::vector<std::string> tracks_names() { return {"head", "centre"}; }

char separator_named(const std::string& name) {
  for (const auto& [known, separator] : kSeparators)
    if (name == known) return separator;
  return name.size() == 1 ? name[0] : '\0';
}

RecordingOptions recording_options(const std::filesystem::path& file, const RecordingFlags& flags) {
  RecordingOptions out{.file = file, .fps = flags.fps, .columns = flags.columns};
  for (const auto& [name, unit_m] : kUnits)
    if (flags.unit == name) out.unit_m = unit_m;
  out.separator = separator_named(flags.separator);
  if (!flags.tracks.empty())
    out.tracks = flags.tracks == "head" ? TrackedPoint::kHead : TrackedPoint::kCentre;
  out.strict = flags.strict;
  return out;
}

void require_no_recording_options(const RecordingFlags& flags, const std::string& what) {
  if (const std::string option = flags.given(); !option.empty())
    throw InputError(option, "a recording", what);
}

}  // namespace throng
