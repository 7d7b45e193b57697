#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "apps/command.h"
#include "apps/output/output_plan.h"
#include "base/errors.h"
#include "base/say.h"
#include "viewer/picture/animation.h"
#include "viewer/picture/picture.h"
#include "viewer/picture/recorded_frame.h"

namespace throng {
namespace {

constexpr int kMaxPixels = 8192;
constexpr float kAnimationQuality = 55;

constexpr const char* kRenderFooter = R"(
Body parts that touch are orange, by triangles red. Without --eye and --target the picture shows the whole crowd.

Examples:
  throng render out/plaza.lcmlog --frame 300 --out plaza.png
  throng render out/plaza.lcmlog --frames 300:420 --every 5 --out plaza.webp
  throng render out/plaza.lcmlog --frame 300 --volumes body-box,ordop26 --out volumes.png
  throng render out/plaza.lcmlog --frame 300 --eye 4,-9,3 --target 0,-5,1 --out near.png)";

struct RenderCommand {
  std::string log;
  int64_t frame = 0;
  std::vector<int64_t> frames;  // first, last
  int64_t every = 4;
  std::string out;
  std::vector<float> eye_m;
  std::vector<float> target_m;
  std::string volumes, volumes_of;
  PictureOptions picture;
};

/// What cannot be drawn is refused before anything is read or drawn.
void require_drawable(const RenderCommand& command) {
  const bool moves = !command.frames.empty();
  const char* ending = moves ? ".webp" : ".png";
  const std::string found = std::filesystem::path(command.out).extension().string();
  if (found != ending)
    throw InputError("--out",
                     fmt::format("a name that ends in {}: {}", ending,
                                 moves ? "--frames makes an animation"
                                       : "one frame is a PNG, --frames A:B makes a .webp"),
                     fmt::format("'{}'", command.out));
  if (moves && command.frames[0] > command.frames[1])
    throw InputError("--frames", "FIRST:LAST, the first not after the last",
                     fmt::format("{}:{}", command.frames[0], command.frames[1]));
}

std::vector<std::string> words_of(const std::string& list) {
  std::vector<std::string> words;
  for (size_t begin = 0; !list.empty() && begin <= list.size();) {
    const size_t end = std::min(list.find(',', begin), list.size());
    words.push_back(list.substr(begin, end - begin));
    begin = end + 1;
  }
  return words;
}

std::vector<std::string> layers_of(const std::string& list) {
  std::vector<std::string> words = words_of(list);
  const std::vector<std::string> known = volume_layers();
  for (const std::string& word : words)
    if (std::find(known.begin(), known.end(), word) == known.end())
      throw InputError("--volumes", fmt::format("some of {}", fmt::join(known, ",")),
                       fmt::format("'{}'{}", word, did_you_mean(word, known)));
  return words;
}

std::vector<uint32_t> people_of(const std::string& list) {
  std::vector<uint32_t> people;
  for (const std::string& word : words_of(list)) {
    uint32_t id = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), id);
    if (error != std::errc() || end != word.data() + word.size())
      throw InputError("--volumes-of", "numbers of people, as 3,17", fmt::format("'{}'", word));
    people.push_back(id);
  }
  return people;
}

int render_frames(const RenderCommand& command) {
  static_cast<void>(RecordedFrame(command.log, command.frames[1]));  // throws if there is none
  RecordedFrame frame(command.log, command.frames[0]);
  const PictureOptions options = with_fixed_camera(frame.crowd(), command.picture);
  const double shown_ms = 1000 * frame.run().run()->step_s * static_cast<double>(command.every);
  Animation animation(options.width, options.height, kAnimationQuality);
  int pictures = 0, with_states = 0;
  for (int64_t number = command.frames[0]; number <= command.frames[1]; number += command.every) {
    frame.advance_to(number);
    with_states += frame.crowd().frame == number;
    animation.add(picture_of(frame, options), static_cast<int>(std::lround(shown_ms)));
    ++pictures;
  }
  const size_t bytes = animation.write(command.out);
  show("{}: {} pictures, {:.2f} MB\n", command.out, pictures, static_cast<double>(bytes) * 1e-6);
  if (with_states < pictures)
    say("note: {} of {} frames have states; in the others people stand as in the last that had\n",
        with_states, pictures);
  return kExitFine;
}

int render_frame(RenderCommand command) {
  require_drawable(command);
  const auto to_point = [](const std::vector<float>& xyz) -> std::optional<Eigen::Vector3f> {
    if (xyz.empty()) return std::nullopt;
    return Eigen::Vector3f(xyz[0], xyz[1], xyz[2]);
  };
  command.picture.eye_m = to_point(command.eye_m);
  command.picture.target_m = to_point(command.target_m);
  command.picture.volumes = layers_of(command.volumes);
  command.picture.volumes_of = people_of(command.volumes_of);
  OutputPlan plan;
  plan.reads("which is drawn", command.log);
  plan.writes({.option = "--out", .path = command.out});
  const OpenOutputs outputs = plan.open();
  if (!command.frames.empty()) return render_frames(command);
  RecordedFrame frame(command.log, command.frame);
  write_png(command.out, picture_of(frame, command.picture));
  show("{}: frame {}, {} avatars, {} pairs of parts touch\n", command.out, command.frame,
       frame.crowd().roots.size(), frame.touching().size());
  if (const int64_t states = frame.crowd().frame; states < command.frame) {
    const std::optional<int64_t> next = frame.next_states();
    say("note: frame {} has no states: people stand as at frame {}; {}\n", command.frame, states,
        next ? fmt::format("the next states are those of frame {}", *next)
             : "no states come later");
  }
  return kExitFine;
}

void add_point(CommandOptions& app, const char* name, std::vector<float>& xyz, const char* what) {
  app.add_option(name, xyz, what)
      ->expected(3)
      ->delimiter(',')
      ->check(number_option(-1e6, 1e6, false, "three numbers, x,y,z"))
      ->type_name("X,Y,Z");
}

}  // namespace

Command add_render_command(CommandLine& parent) {
  CommandOptions* app = parent.add_subcommand("render", "A picture of one frame of a log");
  app->footer(kRenderFooter);
  const auto command = std::make_shared<RenderCommand>();
  app->add_option("LOG", command->log, "The log of a run")->required();
  Option* frame = app->add_option("--frame", command->frame, "Which frame; the first is 0")
                      ->check(whole_option(0, INT64_MAX, "a whole number from 0"))
                      ->type_name("N");
  app->add_option("--frames", command->frames, "From the first to the last: an animated WebP")
      ->expected(2)
      ->delimiter(':')
      ->check(whole_option(0, INT64_MAX, "two whole numbers from 0, FIRST:LAST"))
      ->type_name("A:B")
      ->excludes(frame);
  app->add_option(
         "--volumes", command->volumes,
         "Volumes of a stage around everybody, as sphere,ordop26; body-sphere and body-box "
         "are around whole bodies")
      ->type_name("LIST");
  app->add_option("--volumes-of", command->volumes_of, "Around these people alone, as 3,17")
      ->type_name("LIST");
  app->add_option("--every", command->every, "Of these frames every n-th [4]")
      ->check(whole_option(1, 10000, "a whole number from 1"))
      ->type_name("N");
  app->add_option("--out", command->out, "The PNG or WebP to write")->required()->type_name("FILE");
  add_point(*app, "--eye", command->eye_m, "Where the eye is, in metres");
  add_point(*app, "--target", command->target_m, "What it looks at, in metres");
  const auto pixels = whole_option(16, kMaxPixels, fmt::format("16 to {} pixels", kMaxPixels));
  app->add_option("--width", command->picture.width, "Pixels [1280]")
      ->check(pixels)
      ->type_name("N");
  app->add_option("--height", command->picture.height, "Pixels [720]")
      ->check(pixels)
      ->type_name("N");
  return {app, [command] { return render_frame(*command); }};
}

}  // namespace throng
