#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/command.h"
#include "apps/output/output_plan.h"
#include "apps/process/progress.h"
#include "base/console.h"
#include "base/cores.h"
#include "base/errors.h"
#include "base/text.h"
#include "viewer/picture/picture.h"
#include "viewer/picture/recorded_frame.h"
#include "viewer/picture/sequence.h"

namespace throng {
namespace {

constexpr int kMaxPixels = 8192;

constexpr const char* kRenderFooter = R"(
Touching body parts are orange; red if triangles decided. Without --eye and --target the picture shows the whole
crowd. With --frames, --out FOLDER writes numbered PNGs, FILE.webp an animation, and FILE.mp4 or FILE.webm a video,
for which ffmpeg must be installed.

Examples:
  throng render out/plaza.lcmlog --frame 300 --out plaza.png
  throng render out/plaza.lcmlog --frames 300:420 --every 5 --out plaza.webp
  throng render out/plaza.lcmlog --frames 0:599 --every 1 --out pictures
  throng render out/plaza.lcmlog --frames 0:599 --every 1 --out plaza.mp4
  throng render out/plaza.lcmlog --frame 300 --volumes body-box,ordop26 --out volumes.png
  throng render out/plaza.lcmlog --frame 300 --eye 4,-9,3 --target 0,-5,1 --out close.png)";

struct RenderCommand {
  std::string log;
  int64_t frame = 0;
  std::vector<int64_t> frames;  ///< first, last
  int64_t every = 4;
  std::string out;
  std::vector<float> eye_m;
  std::vector<float> target_m;
  std::optional<double> fov_deg;
  std::optional<std::string> volumes, volumes_of;
  PictureOptions picture;
};

/// Throws for options that cannot be drawn, before any file is read.
void require_drawable(const RenderCommand& command) {
  const bool moves = !command.frames.empty();
  if (moves) static_cast<void>(sequence_kind(command.out, "--out"));
  if (!moves && std::filesystem::path(command.out).extension() != ".png")
    throw InputError("--out", "a name that ends in .png: --frames makes animations and videos",
                     fmt::format("'{}'", command.out));
  if (moves && command.frames[0] > command.frames[1])
    throw InputError("--frames", "FIRST:LAST with FIRST up to LAST",
                     fmt::format("{}:{}", command.frames[0], command.frames[1]));
}

std::vector<std::string> layers_of(const std::string& list) {
  std::vector<std::string> words = split_text(list, ',');
  const std::vector<std::string> known = volume_layers();
  for (const std::string& word : words)
    if (std::find(known.begin(), known.end(), word) == known.end())
      throw InputError("--volumes", fmt::format("some of {}", fmt::join(known, ",")),
                       fmt::format("'{}'{}", word, did_you_mean(word, known)));
  return words;
}

std::vector<uint32_t> people_of(const std::string& list) {
  std::vector<uint32_t> people;
  for (const std::string& word : split_text(list, ',')) {
    uint32_t id = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), id);
    if (error != std::errc() || end != word.data() + word.size())
      throw InputError("--volumes-of", "ids of avatars, as in 3,17", fmt::format("'{}'", word));
    people.push_back(id);
  }
  return people;
}

/// Throws for options that the opened log cannot satisfy.
void require_in_log(const RenderCommand& command, RecordedFrame& frame) {
  const int32_t avatars = frame.run().run()->avatar_count;
  for (const uint32_t id : command.picture.volumes_of)
    if (id >= static_cast<uint32_t>(avatars))
      throw InputError("--volumes-of",
                       fmt::format("ids of avatars of {}, 0 to {}", command.log, avatars - 1),
                       fmt::format("{}", id));
}

/// Exit code for a picture of a log that may be incomplete.
int ended(const std::string& log, RecordedFrame& frame) {
  const std::string missing = frame.describe_missing();
  if (missing.empty()) return kExitSuccess;
  print_message("note: {}: {} The picture shows the recorded part.\n", log, missing);
  return kExitCheckFailed;
}

int render_frames(const RenderCommand& command) {
  const auto [first, last] = std::pair(command.frames[0], command.frames[1]);
  static_cast<void>(RecordedFrame(command.log, last));  // throws if it is missing
  RecordedFrame frame(command.log, first);
  require_in_log(command, frame);
  CrowdPainter painter(frame, command.picture, core_count());
  painter.fix_camera();
  const double shown_s = frame.run().run()->step_s * static_cast<double>(command.every);
  const auto sequence = make_sequence(command.out, {.width = command.picture.width,
                                                    .height = command.picture.height,
                                                    .shown_s = shown_s,
                                                    .threads = core_count()});
  ProgressBar progress("render", (last - first) / command.every + 1, "pictures");
  int pictures = 0, with_states = 0;
  for (int64_t number = first; number <= last; number += command.every) {
    frame.advance_to(number);
    with_states += frame.crowd().frame == number;
    sequence->add(painter.paint(), number);
    progress.show(++pictures);
  }
  const int64_t bytes = sequence->finish();
  print_result("{}: {}, {:.2f} MB\n", command.out, counted(pictures, "picture"),
               static_cast<double>(bytes) * 1e-6);
  if (with_states < pictures)
    print_message("note: {} of {} have states; the others show the previous states\n", with_states,
                  counted(pictures, "frame"));
  return ended(command.log, frame);
}

/// Plans --out: a file, or a folder for numbered PNGs.
void plan_output(const RenderCommand& command, OutputPlan& plan) {
  if (!command.frames.empty()) require_possible(command.out, "--out");
  if (!command.frames.empty() && sequence_kind(command.out, "--out") == SequenceKind::kPngs)
    plan.fills("--out", command.out, {"*.png"});
  else
    plan.writes({.option = "--out", .path = command.out});
}

int render_frame(RenderCommand command) {
  require_drawable(command);
  const auto to_point = [](const std::vector<float>& xyz) -> std::optional<Eigen::Vector3f> {
    if (xyz.empty()) return std::nullopt;
    return Eigen::Vector3f(xyz[0], xyz[1], xyz[2]);
  };
  command.picture.eye_m = to_point(command.eye_m);
  command.picture.target_m = to_point(command.target_m);
  if (command.fov_deg)
    command.picture.fov_rad = static_cast<float>(*command.fov_deg * std::numbers::pi / 180);
  if (command.picture.eye_m && command.picture.target_m == command.picture.eye_m)
    throw InputError("--eye", "another point than --target", "the same point");
  if (command.volumes) command.picture.volumes = layers_of(*command.volumes);
  if (command.volumes_of) command.picture.volumes_of = people_of(*command.volumes_of);
  OutputPlan plan;
  plan.reads("which is drawn", command.log);
  plan_output(command, plan);
  const OpenOutputs outputs = plan.open();
  if (!command.frames.empty()) return render_frames(command);
  RecordedFrame frame(command.log, command.frame);
  require_in_log(command, frame);
  write_png(command.out, CrowdPainter(frame, command.picture, core_count()).paint());
  print_result("{}: frame {}, {}, {}\n", command.out, command.frame,
               counted(frame.crowd().roots.size(), "avatar"),
               counted(frame.touching().size(), "pair of parts touches", "pairs of parts touch"));
  if (const int64_t states = frame.crowd().frame; states < command.frame) {
    const std::optional<int64_t> next = frame.next_states();
    print_message(
        "note: frame {} has no states; the picture shows those of frame {}; {}\n", command.frame,
        states,
        next ? fmt::format("the next states are of frame {}", *next) : "there are no later states");
  }
  return ended(command.log, frame);
}

void add_point(CommandOptions& app, const char* name, std::vector<float>& xyz, const char* what) {
  app.add_list(name, xyz, 3, ',', number_option(-1e6, 1e6, false, ""),
               "three coordinates in metres, X,Y,Z", what)
      ->type_name("X,Y,Z");
}

}  // namespace

Command add_render_command(CommandLine& parent) {
  CommandOptions* app = parent.add_subcommand("render", "Draw a frame of a log, or a video");
  app->footer(kRenderFooter);
  const auto command = std::make_shared<RenderCommand>();
  app->add_option("LOG", command->log, "Log of a run")->required();
  Option* frame = app->add_option("--frame", command->frame, "Number of the frame, from 0")
                      ->check(whole_option(0, INT64_MAX, "a whole number from 0"))
                      ->type_name("N");
  Option* frames = app->add_list("--frames", command->frames, 2, ':',
                                 whole_option(0, INT64_MAX, ""), "two whole numbers from 0, A:B",
                                 "Draw frames A to B as PNGs, an animation or a video")
                       ->type_name("A:B")
                       ->excludes(frame);
  Option* volumes =
      app->add_option(
             "--volumes", command->volumes,
             fmt::format("Draw volumes around all bodies, a list of {}, separated by commas",
                         fmt::join(volume_layers(), ",")))
          ->type_name("LIST");
  app->add_option("--volumes-of", command->volumes_of,
                  "With --volumes: around these avatars only, as in 3,17")
      ->needs(volumes)
      ->type_name("LIST");
  app->add_option("--every", command->every, "With --frames: draw every n-th frame [4]")
      ->check(whole_option(1, 10000, "a whole number from 1 to 10000"))
      ->needs(frames)
      ->type_name("N");
  app->add_option("--out", command->out,
                  "Picture to write, FILE.png; with --frames also FOLDER, .webp, .mp4, .webm")
      ->required()
      ->type_name("FILE");
  add_point(*app, "--eye", command->eye_m, "Position of the eye, in metres");
  add_point(*app, "--target", command->target_m, "Point that the eye looks at, in metres");
  app->add_option("--fov", command->fov_deg,
                  "Angle of view from the lower to the upper edge, 1 to 150 degrees [40.1]")
      ->check(number_option(1, 150, false, "1 to 150 degrees"))
      ->type_name("DEGREES");
  const auto pixels = whole_option(16, kMaxPixels, fmt::format("16 to {} pixels", kMaxPixels));
  app->add_option("--width", command->picture.width,
                  fmt::format("16 to {} pixels [1280]", kMaxPixels))
      ->check(pixels)
      ->type_name("N");
  app->add_option("--height", command->picture.height,
                  fmt::format("16 to {} pixels [720]", kMaxPixels))
      ->check(pixels)
      ->type_name("N");
  return {app, [command] { return render_frame(*command); }};
}

}  // namespace throng
