// `throng view`, `run --html` and animations.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/apps/cli.h"

namespace throng::view_test {
namespace {

using testing::HasSubstr;

class View : public testing::Test {
 protected:
  void record() {
    const Outcome run = shell(
        "throng run plaza --avatars 12 --seconds 0.5 --lcm off --log run.lcmlog --html run.html",
        folder_);
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }
  ScratchFolder folder_;
};

TEST_F(View, WritesAPageWithoutOutsideAddresses) {
  record();
  const Outcome view = shell("throng view run.lcmlog --html log.html", folder_);
  ASSERT_EQ(view.exit_code, 0) << view.err;
  EXPECT_THAT(view.out, HasSubstr("12 people, 0.5 s"));
  for (const char* name : {"run.html", "log.html"}) {
    const std::string html = read_file(folder_ / name);
    EXPECT_THAT(html, HasSubstr("id=\"recording\"")) << name;
    for (const char* attribute : {"src=\"http", "href=\"http", "src=//", "@import", "url(http"})
      EXPECT_EQ(html.find(attribute), std::string::npos) << name << " has " << attribute;
  }
}

TEST_F(View, RejectsAPageOverTheLimitWithARemedy) {
  record();
  const Outcome view = shell("throng view run.lcmlog --html log.html --html-limit-mb 0.1", folder_);
  EXPECT_EQ(view.exit_code, 2);
  EXPECT_EQ(line_count(view.err), 1) << view.err;
  EXPECT_THAT(view.err, HasSubstr("--html-limit-mb"));
}

TEST_F(View, ServesALogUntilASignal) {
  record();
  const Outcome view = shell(
      "throng view run.lcmlog --port 0 >out & pid=$!\n"
      "for i in $(seq 100); do grep -q http out && break; sleep 0.1; done\n"
      "kill -INT $pid; wait $pid; cat out",
      folder_);
  EXPECT_EQ(view.exit_code, 0) << view.err;
  EXPECT_THAT(view.out, HasSubstr("http://127.0.0.1:"));
}

TEST_F(View, NeedsAHostNameOnTheNetwork) {
  record();
  const Outcome view = shell("throng view run.lcmlog --port 0 --address 0.0.0.0", folder_);
  EXPECT_EQ(view.exit_code, 2);
  EXPECT_EQ(line_count(view.err), 1) << view.err;
  EXPECT_THAT(view.err, HasSubstr("--address 0.0.0.0: expected a --host-name NAME"));
}

TEST_F(View, RejectsBadInput) {
  write_file(folder_ / "empty.lcmlog", "");
  for (const char* line :
       {"throng view no.lcmlog", "throng view empty.lcmlog", "throng view --html a.html",
        "throng view --port 70000", "throng view --host-name http://crowd.lan",
        "throng view empty.lcmlog --lcm udpm://239.255.76.67:7684"}) {
    const Outcome view = shell(line, folder_);
    EXPECT_EQ(view.exit_code, 2) << line;
    EXPECT_EQ(line_count(view.err), 1) << line << ": " << view.err;
  }
}

TEST_F(View, DrawsAnAnimation) {
  record();
  const std::string line =
      "throng render run.lcmlog --frames 0:20 --every 10 --width 160 --height 90 --out ";
  for (const char* name : {"a.webp", "b.webp"}) {
    const Outcome render = shell(line + name, folder_);
    ASSERT_EQ(render.exit_code, 0) << render.err;
    EXPECT_THAT(render.out, HasSubstr("3 pictures"));
  }
  const std::string webp = read_file(folder_ / "a.webp");
  EXPECT_EQ(webp.substr(0, 4), "RIFF");
  EXPECT_THAT(webp, HasSubstr("ANMF"));
  EXPECT_EQ(webp, read_file(folder_ / "b.webp")) << "the same frames, other bytes";
}

TEST_F(View, WritesNumberedPictures) {
  record();
  const std::string line =
      "throng render run.lcmlog --frames 0:20 --every 10 --width 160 --height 90 --out pictures";
  const Outcome render = shell(line, folder_);
  ASSERT_EQ(render.exit_code, 0) << render.err;
  EXPECT_THAT(render.out, HasSubstr("pictures: 3 pictures"));
  ASSERT_EQ(shell("throng render run.lcmlog --frame 10 --width 160 --height 90 --out a.png "
                  "--eye 9,-9,5 --target 0,0,1 && rm -r pictures && " +
                      line + " --eye 9,-9,5 --target 0,0,1",
                  folder_)
                .exit_code,
            0);
  EXPECT_EQ(shell("ls pictures", folder_).out,
            "frame_000000.png\nframe_000010.png\nframe_000020.png\n");
  EXPECT_EQ(read_file(folder_ / "a.png"), read_file(folder_ / "pictures/frame_000010.png"));
  const Outcome again = shell(line, folder_);
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_THAT(again.err, HasSubstr("--out pictures: expected a folder without pictures, found "));
}

TEST_F(View, LeavesNoPicturesIfTheLogEndsBeforeTheLastFrame) {
  record();
  EXPECT_EQ(shell("throng render run.lcmlog --frames 0:99 --out pictures", folder_).exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "pictures"));
}

/// Puts a program of this name and text on the PATH of "PATH=bin:$PATH".
void install(const std::string& text, const ScratchFolder& folder) {
  std::filesystem::create_directory(folder / "bin");
  write_file(folder / "bin/ffmpeg", "#!/bin/sh\n" + text);
  std::filesystem::permissions(folder / "bin/ffmpeg", std::filesystem::perms::owner_all);
}
const std::string kFilm =
    "PATH=$PWD/bin:$PATH throng render run.lcmlog --frames 0:20 --every 10 --width 160 --height 90 "
    "--out ";

TEST_F(View, PipesPicturesIntoFfmpeg) {
  record();
  install("echo \"$@\" >arguments; for file; do :; done; wc -c >\"$file\"", folder_);
  for (const std::string name : {"film.mp4", "film.webm"}) {
    const Outcome render = shell(kFilm + name, folder_);
    ASSERT_EQ(render.exit_code, 0) << render.err;
    EXPECT_THAT(render.out, HasSubstr(name + ": 3 pictures"));
    EXPECT_EQ(std::stoi(read_file(folder_ / name)), 3 * 160 * 90 * 3);
    const std::string arguments = read_file(folder_ / "arguments");
    EXPECT_THAT(arguments, HasSubstr("-f rawvideo -pixel_format rgb24 -video_size 160x90 "));
    EXPECT_THAT(arguments, HasSubstr("-framerate 6 -i pipe:0 "));  // 60 frames a second
    EXPECT_THAT(arguments, HasSubstr("-f " + name.substr(5)));
  }
}

TEST_F(View, KeepsAnOlderFilmIfFfmpegFails) {
  record();
  for (const char* failure :
       {"echo no such codec >&2; exit 1", "cat >/dev/null; echo no such codec >&2; exit 1"}) {
    install(failure, folder_);
    write_file(folder_ / "film.mp4", "older");
    const Outcome render = shell(kFilm + "film.mp4", folder_);
    EXPECT_EQ(render.exit_code, 3) << failure;
    EXPECT_EQ(line_count(render.err), 1) << render.err;
    EXPECT_THAT(render.err, HasSubstr("ffmpeg could not make film.mp4: no such codec"));
    EXPECT_EQ(read_file(folder_ / "film.mp4"), "older");
  }
}

TEST_F(View, NamesTheRemedyIfFfmpegIsMissing) {
  record();
  const Outcome render = shell(
      "throng=$(command -v throng); mkdir empty; "
      "PATH=$PWD/empty \"$throng\" render run.lcmlog --frames 0:20 --out film.mp4",
      folder_);
  EXPECT_EQ(render.exit_code, 3);
  EXPECT_EQ(render.err,
            "--out film.mp4: ffmpeg is not on PATH; install ffmpeg, or write numbered pictures "
            "with --out FOLDER\n");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "film.mp4"));
}

TEST_F(View, ShowsATornLogWithANoteAndExitCode1) {
  record();
  const std::string whole = read_file(folder_ / "run.lcmlog");
  for (const size_t size : {whole.size() - 1, whole.size() - 3000, whole.size() * 9 / 10}) {
    write_file(folder_ / "torn.lcmlog", whole.substr(0, size));
    for (const char* line :
         {"throng view torn.lcmlog --html torn.html",
          "throng render torn.lcmlog --frame 3 --width 64 --height 64 --out a.png",
          "throng render torn.lcmlog --frames 0:3 --width 64 --height 64 --out a.webp",
          "throng export torn.lcmlog --csv events --out a.csv"}) {
      const Outcome outcome = shell(std::string("rm -f torn.html; ") + line, folder_);
      EXPECT_EQ(outcome.exit_code, 1) << line << ", " << size << " bytes: " << outcome.err;
      EXPECT_EQ(line_count(outcome.err), 1) << line << ": " << outcome.err;
    }
  }
  ASSERT_EQ(shell("throng view torn.lcmlog --html torn.html", folder_).exit_code, 1);
  EXPECT_THAT(read_file(folder_ / "torn.html"), HasSubstr("id=\"recording\""));
  const Outcome served = shell(
      "throng view torn.lcmlog --port 0 >out 2>err & pid=$!\n"
      "for i in $(seq 100); do grep -q torn err && break; sleep 0.1; done\n"
      "kill -INT $pid; wait $pid; cat err",
      folder_);
  EXPECT_THAT(served.out,
              HasSubstr("torn.lcmlog: The log is torn: it ends inside a message after"));
}

TEST_F(View, RejectsARunWithoutAvatars) {
  write_file(folder_ / "nobody.yaml",
             "name: nobody\nground: {min_m: [-5, -5], max_m: [5, 5]}\nduration_s: 1\n"
             "groups: [{name: none, count: 0, spawn: {min_m: [-1, -1], max_m: [1, 1]},\n"
             "          goals: [{min_m: [2, 2], max_m: [3, 3]}]}]\n");
  const Outcome rejected =
      shell("throng run nobody.yaml --lcm off --log n.lcmlog --html n.html", folder_);
  EXPECT_EQ(rejected.exit_code, 2);
  EXPECT_EQ(line_count(rejected.err), 1) << rejected.err;
  EXPECT_THAT(rejected.err, HasSubstr("--html: expected a run with people or robots"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "n.lcmlog"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "n.html"));
  ASSERT_EQ(shell("throng run nobody.yaml --lcm off --log n.lcmlog", folder_).exit_code, 0);
  for (const char* line : {"throng view n.lcmlog", "throng view n.lcmlog --html n.html",
                           "throng render n.lcmlog --frame 3 --out a.png"}) {
    const Outcome outcome = shell(line, folder_);
    EXPECT_EQ(outcome.exit_code, 2) << line;
    EXPECT_EQ(line_count(outcome.err), 1) << line << ": " << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("n.lcmlog: expected a run with people or robots, "
                                       "found scene 'nobody' without avatars"))
        << line;
  }
}

TEST_F(View, AcceptsTheDocumentedRenderOptionsOnly) {
  record();
  const std::string help = shell("throng render --help", folder_).out;
  EXPECT_EQ(help.find(" x "), std::string::npos) << "the help offers several values for one word";
  const std::string line = "throng render run.lcmlog --width 64 --height 64 ";
  const size_t list = help.find("a list of ") + 10;
  const std::string volumes = help.substr(list, help.find_first_of(" \n", list) - list - 1);
  for (const std::string fine :
       {"--frame 3 --out a.png --eye 4,-9,3 --target 0,-5,1", "--frame 3 --out a.png --eye=-4,-9,3",
        "--frames 0:3 --out a.webp", "--frames 0:3 --every 2 --out a.webp",
        "--frame 3 --out a.png --volumes sphere",
        "--frame 3 --out a.png --volumes sphere --volumes-of 0,11"}) {
    const Outcome outcome = shell(line + fine, folder_);
    EXPECT_EQ(outcome.exit_code, 0) << fine << ": " << outcome.err;
  }
  EXPECT_EQ(shell(line + "--frame 3 --out a.png --volumes " + volumes, folder_).exit_code, 0)
      << volumes;
  for (const std::string wrong :
       {"--frame 3 --out a.png --eye 4 -9 3", "--frame 3 --out a.png --eye 4,-9",
        "--frame 3 --out a.png --eye 1,2,3,4", "--frame 3 --out a.png --eye 1,2,x",
        "--frame 3 --out a.png --eye 1,2,3 --target 1,2,3", "--frames 0 3 --out a.webp",
        "--frames 0:3:6 --out a.webp", "--frames 0 --out a.webp", "--frame 3 --every 2 --out a.png",
        "--frame 3 --out a.png --volumes-of 3", "--frame 3 --out a.png --volumes ''",
        "--frame 3 --out a.png --volumes sphere --volumes-of ''",
        "--frame 3 --out a.png --volumes sphere --volumes-of 12", "--frame 3 --out a.webp"}) {
    const Outcome outcome = shell(line + wrong, folder_);
    EXPECT_EQ(outcome.exit_code, 2) << wrong;
    EXPECT_EQ(line_count(outcome.err), 1) << wrong << ": " << outcome.err;
  }
}

TEST_F(View, PrintsSingularForms) {
  ASSERT_EQ(shell("throng run plaza --avatars 1 --seconds 0.2 --lcm off --log one.lcmlog", folder_)
                .exit_code,
            0);
  EXPECT_THAT(shell("throng render one.lcmlog --frame 1 --out a.png", folder_).out,
              HasSubstr("frame 1, 1 avatar, 0 pairs of parts touch"));
  EXPECT_THAT(shell("throng render one.lcmlog --frames 1:1 --out a.webp", folder_).out,
              HasSubstr(": 1 picture, "));
  EXPECT_THAT(shell("throng view one.lcmlog --html a.html", folder_).out, HasSubstr(" 1 person, "));
}

TEST_F(View, ReportsAnUnwritableCheckpointOnce) {
  const Outcome outcome = shell(
      "throng run plaza --avatars 5 --seconds 2 --checkpoint-every 0.5 --lcm off --log off "
      "--checkpoint /dev/full",
      folder_);
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.err, HasSubstr("/dev/full"));
  EXPECT_THAT(outcome.err, testing::Not(HasSubstr("no checkpoint")));
}

}  // namespace
}  // namespace throng::view_test
