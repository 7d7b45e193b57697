// `throng view`, `run --html` and pictures that move, from outside.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/apps/cli.h"

namespace throng {
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

TEST_F(View, ARunAndItsLogMakeAFileThatNamesNoOutsideAddress) {
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

TEST_F(View, AFileOverTheLimitIsBadInputAndTellsTheWayOut) {
  record();
  const Outcome view = shell("throng view run.lcmlog --html log.html --html-limit-mb 0.1", folder_);
  EXPECT_EQ(view.exit_code, 2);
  EXPECT_EQ(line_count(view.err), 1) << view.err;
  EXPECT_THAT(view.err, HasSubstr("--html-limit-mb"));
}

TEST_F(View, ALogIsServedUntilTheSignal) {
  record();
  const Outcome view = shell(
      "throng view run.lcmlog --port 0 >out & pid=$!\n"
      "for i in $(seq 100); do grep -q http out && break; sleep 0.1; done\n"
      "kill -INT $pid; wait $pid; cat out",
      folder_);
  EXPECT_EQ(view.exit_code, 0) << view.err;
  EXPECT_THAT(view.out, HasSubstr("http://127.0.0.1:"));
}

TEST_F(View, WhatCannotBeShownIsBadInput) {
  write_file(folder_ / "empty.lcmlog", "");
  for (const char* line :
       {"throng view no.lcmlog", "throng view empty.lcmlog", "throng view --html a.html",
        "throng view --port 70000", "throng view empty.lcmlog --lcm udpm://239.255.76.67:7684"}) {
    const Outcome view = shell(line, folder_);
    EXPECT_EQ(view.exit_code, 2) << line;
    EXPECT_EQ(line_count(view.err), 1) << line << ": " << view.err;
  }
}

TEST_F(View, FramesBecomeAnAnimation) {
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

}  // namespace
}  // namespace throng
