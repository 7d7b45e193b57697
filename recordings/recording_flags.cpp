#include "recordings/recording_flags.h"

#include <utility>

#include "recordings/units.h"

namespace throng {
namespace {

constexpr std::pair<const char*, char> kSeparators[] = {
    {"tab", '\t'}, {"blank", ' '}, {"comma", ','}, {"semicolon", ';'}};

}  // namespace

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

}  // namespace throng
