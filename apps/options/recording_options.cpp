#include "apps/options/recording_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "base/errors.h"

namespace throng {
namespace {

constexpr std::pair<const char*, double> kUnits[] = {
    {"m", 1}, {"cm", 0.01}, {"mm", 0.001}, {"ft", 0.3048}, {"in", 0.0254}};
constexpr std::pair<const char*, char> kSeparators[] = {
    {"tab", '\t'}, {"blank", ' '}, {"comma", ','}, {"semicolon", ';'}};

char separator_named(const std::string& name) {
  for (const auto& [known, separator] : kSeparators)
    if (name == known) return separator;
  return name.size() == 1 ? name[0] : '\0';
}

}  // namespace

std::string RecordingFlags::given() const {
  if (fps) return "--fps";
  if (!unit.empty()) return "--unit";
  if (!columns.empty()) return "--columns";
  if (!separator.empty()) return "--separator";
  if (!tracks.empty()) return "--tracks";
  return strict ? "--strict" : "";
}

void add_recording_options(CommandOptions& app, RecordingFlags& flags) {
  app.add_option("--fps", flags.fps, "Of a recording: frames a second, as its file numbers them")
      ->check(number_option(0, 10'000, true, "a number of frames a second above 0"))
      ->type_name("N");
  std::vector<std::string> units;
  for (const auto& [name, unit_m] : kUnits) units.emplace_back(name);
  app.add_option("--unit", flags.unit, "Of lengths in a recording: m, cm, mm, ft or in")
      ->check(name_option(units))
      ->type_name("UNIT");
  app.add_option(
         "--columns", flags.columns,
         "Of a table: id=NAME,t=NAME,x=NAME,y=NAME; frame=, z=, heading=; numbers from 1 do")
      ->type_name("LIST");
  app.add_option("--separator", flags.separator,
                 "Of a table: one character, or tab, blank, comma, semicolon")
      ->check([](const std::string& name) {
        return separator_named(name) != '\0'
                   ? std::string()
                   : fmt::format(
                         "expected one character, or tab, blank, comma or semicolon, found '{}'",
                         name);
      })
      ->type_name("CHARACTER");
  app.add_option("--tracks", flags.tracks,
                 "Whose way a recording is: of heads or of centres of bodies [as the kind of file]")
      ->check(name_option({"head", "centre"}))
      ->type_name("POINT");
  app.add_flag("--strict", flags.strict, "What is odd about a recording is an error");
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
