#include "apps/options/recording_options.h"

#include <fmt/format.h>

namespace throng {

void add_recording_options(CommandOptions& app, RecordingFlags& flags) {
  app.add_option("--fps", flags.fps, "Of a recording: frames a second, as its file numbers them")
      ->check(number_option(0, 10'000, true, "a number of frames a second above 0"))
      ->type_name("N");
  app.add_option("--unit", flags.unit, "Of lengths in a recording: m, cm, mm, km, ft or in")
      ->check(name_option(unit_names()))
      ->type_name("UNIT");
  app.add_option("--heading-unit", flags.heading_unit, "Of headings in a table: rad or deg")
      ->check(name_option(heading_unit_names()))
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
      ->check(name_option(tracks_names()))
      ->type_name("POINT");
  app.add_flag("--strict", flags.strict, "What is odd about a recording is an error");
}

}  // namespace throng
