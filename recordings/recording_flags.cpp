#include "recordings/recording_flags.h"

#include <utility>

#include "base/errors.h"
#include "recordings/units.h"

namespace throng {
namespace {

constexpr std::pair<const char*, char> kSeparators[] = {
    {"tab", '\t'}, {"blank", ' '}, {"comma", ','}, {"semicolon", ';'}};

}  // namespace

std::string RecordingFlags::given() const {
  if (fps) return "--fps";
  if (!unit.empty()) return "--unit";
  if (!heading_unit.empty()) return "--heading-unit";
  if (!columns.empty()) return "--columns";
  if (!separator.empty()) return "--separator";
  if (!tracks.empty()) return "--tracks";
  return strict ? "--strict" : "";
}

std::vector<std::string> unit_names() { return unit_names_of(Quantity::kLength); }

std::vector<std::string> heading_unit_names() { return unit_names_of(Quantity::kAngle); }

std::vector<std::string> tracks_names() { return {"head", "centre"}; }

char separator_named(const std::string& name) {
  for (const auto& [known, separator] : kSeparators)
    if (name == known) return separator;
  return name.size() == 1 ? name[0] : '\0';
}

RecordingOptions recording_options(const std::filesystem::path& file, const RecordingFlags& flags) {
  RecordingOptions out{.file = file, .fps = flags.fps, .columns = flags.columns};
  if (const auto unit = unit_named(flags.unit)) out.unit_m = unit->in_si;
  if (const auto unit = unit_named(flags.heading_unit)) out.heading_unit_rad = unit->in_si;
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
