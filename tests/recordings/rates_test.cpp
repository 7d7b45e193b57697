// Frame rates: parsed completely or rejected, and compared with the times of a file.
#include <gmock/gmock.h>

#include "recordings/units.h"
#include "tests/recordings/binary_files.h"
#include "tests/recordings/recording_folder.h"

namespace throng::rates_test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

TEST(FrameRates, ParseWholeTextsOnly) {
  const struct {
    double per_s;
    std::vector<const char*> texts;
  } cases[] = {
      {25,
       {"25",
        "25.00",
        "25,00",
        "25,0000",
        "25 fps",
        "25fps",
        "25.00 FPS",
        "25 Hz",
        "25 hertz",
        "25 frames per second",
        "25 frames/s",
        "25 frames / sec",
        "25/s",
        "25 1/s",
        "25 s^-1",
        "25 s-1",
        "25 per second",
        "25 frames a second",
        "1/25 s",
        "1 / 25 s",
        "1/25 sec",
        "0.04 s",
        "0,04 s",
        "40 ms",
        "40000 us",
        "25/1",
        "50/2 fps",
        "1500 frames per minute",
        "0.025 kHz",
        "25 [fps]",
        "25 (fps)",
        "+25",
        "25.",
        "2.5e1",
        "25 images per second",
        "25 f/s",
        "1/25 seconds"}},
      {29.97, {"29,97 fps", "29.97", "29,97", "29.97 Hz"}},
      {30000 / 1001.0, {"30000/1001", "30000/1001 fps"}},
      {23.976, {"23,976", "23,976 fps"}},
      {0.5, {"0,5", "0.5 Hz", "0,500", "1/2 fps"}},
      {2.5, {"2.5", "0.4 s", "400 ms"}},
      {0, {"0"}},
      {-25, {"-25"}},
      {1e6, {"1e6"}},
  };
  for (const auto& [per_s, texts] : cases)
    for (const char* text : texts) {
      SCOPED_TRACE(text);
      const std::optional<double> rate = frame_rate_named(text);
      ASSERT_TRUE(rate);
      EXPECT_DOUBLE_EQ(*rate, per_s);
    }
  for (const char* none : {"",
                           "fast",
                           "25 fps or so",
                           "about 25",
                           "~25",
                           "1/25",
                           "1,000",
                           "10,000",
                           "25;16",
                           "25 16",
                           "25 m",
                           "25 frames",
                           "25 s",
                           "nan",
                           "inf",
                           "25-30",
                           "25 fps (interpolated)",
                           "0x19",
                           "25,",
                           "1/0 s",
                           "25 per metre",
                           "2,5,0",
                           "25 fpss",
                           "40 Ms",
                           "25 frames per fortnight"})
    EXPECT_FALSE(frame_rate_named(none)) << none;
}

class RatesAndTimes : public RecordingTest {
 protected:
  /// Note about different rates; empty if there is none.
  std::string note(std::string_view text, RecordingOptions options = {}) const {
    return note_of(*read(text, std::move(options)));
  }
  static std::string note_of(const Recording& recording) {
    for (const Anomaly& anomaly : recording.facts().anomalies)
      if (anomaly.what == "a frame rate that contradicts the times of the file")
        return anomaly.first;
    return "";
  }
  /// Walk with frame numbers in steps of `step`, `rate` numbers per second.
  static std::string walk(std::string_view names, int rate, int step = 1) {
    const bool has_frames = names.find("frame") != std::string_view::npos;
    std::string out(names);
    for (int frame = 0; frame < 50; ++frame) {
      out += "1,";
      if (has_frames) out += fmt::format("{},", step * frame);
      out +=
          fmt::format("{:.3f},{:.2f},0\n", static_cast<double>(step * frame) / rate, 0.02 * frame);
    }
    return out;
  }
};

TEST_F(RatesAndTimes, NoteDifferences) {
  EXPECT_EQ(note("# framerate: 30\n" + walk("id,t,x,y\n", 25)),
            "30 per second of the comment '30', 25 of the times; that of the times is used");
  EXPECT_EQ(read("# framerate: 30\n" + walk("id,t,x,y\n", 25))->facts().fps, 25);
  EXPECT_EQ(note("# framerate: 30 fps\n" + walk("id,frame,t,x,y\n", 25)),
            "30 per second of the comment '30 fps', 25 of the times; that of the times is used");
  EXPECT_EQ(note(walk("id,frame,t,x,y\n", 25), {.fps = 30}),
            "30 per second of --fps, 25 of the times; 30 is used");
  EXPECT_EQ(
      note(walk("id,frame [30 fps],t,x,y\n", 25)),
      "30 per second of the name of the frames' column '30 fps', 25 of the times; that of the "
      "times is used");
  EXPECT_EQ(read("id,frame (1/30 s),x,y\n1,0,0,0\n1,1,0,0\n")->facts().fps, 30);
  EXPECT_THAT(rejection("# framerate: 25\nid,frame [30 fps],x,y\n1,0,0,0\n1,1,0,0\n"),
              StartsWith("recording:2: expected one frame rate, 25"));
  EXPECT_THAT(rejection("id,frame [1],x,y\n1,0,0,0\n"), HasSubstr("--fps"));
  std::string jittered = "# framerate: 50\nid,t,x,y\n";
  for (int frame = 0; frame < 99; ++frame)
    jittered += fmt::format("1,{:.4f},0,0\n", 0.04 * frame + 0.001 * (frame % 7));
  EXPECT_THAT(note(jittered), StartsWith("50 per second of the comment '50', 2"))
      << "no regular rate";
  EXPECT_EQ(note(walk("id,t,x,y\n", 10), {.fps = 50}),
            "50 per second of --fps, 10 of the times; 50 is used");
  EXPECT_THAT(rejection(walk("id,t,x,y\n", 10), {.fps = 16}), HasSubstr("(--fps)"));
  std::string archive = "# framerate: 30\n# id frame t x/m y/m\n";
  for (int frame = 0; frame < 50; ++frame)
    archive += fmt::format("1 {} {} 0 0\n", frame, frame / 25.0);
  EXPECT_EQ(note(archive), "30 per second of the comment '30', 25 of the times; 30 is used");
  make_sqlite(path("a.sqlite"), jupedsim_2() +
                                    "ALTER TABLE trajectory_data ADD COLUMN time_ms; "
                                    "UPDATE trajectory_data SET time_ms = 100 * frame;");
  EXPECT_EQ(note_of(*read_recording({.file = path("a.sqlite")})),
            "25 per second of the file, 10 of the times; 25 is used");
}

TEST_F(RatesAndTimes, AcceptAgreement) {
  EXPECT_EQ(note("# framerate: 25\n" + walk("id,t,x,y\n", 25)), "");
  EXPECT_EQ(note("# framerate: 25\n" + walk("id,frame,t,x,y\n", 25)), "");
  EXPECT_EQ(note("# framerate: 25\n" + walk("id,frame,t,x,y\n", 25, 10)), "") << "every tenth";
  EXPECT_EQ(note("# framerate: 29.97\n" + walk("id,frame,t,x,y\n", 30)), "") << "within 2 %";
  std::string jittered = "# framerate: 25\nid,t,x,y\n";
  for (int frame = 0; frame < 99; ++frame)
    if (frame < 20 || frame > 40)
      jittered += fmt::format("1,{:.4f},0,0\n", 0.04 * frame + 0.001 * (frame % 7));
  EXPECT_EQ(note(jittered), "") << "with gaps";
  EXPECT_EQ(note(walk("id,frame,t,x,y\n", 60), {.fps = 60}), "");
  EXPECT_EQ(note("# framerate: 60\nid,frame,t,x,y\n1,0,0.00,0,0\n1,1,0.02,0,0\n"), "")
      << "within the rounding of two digits";
  EXPECT_EQ(note("# framerate: 25\n# id frame t[ms] x/m y/m\n1 0 0 0 0\n1 25 1000 0 0\n"), "");
  EXPECT_EQ(note("# framerate: 25\n# id frame t[blinks] x/m y/m\n1 0 0 0 0\n1 25 77 0 0\n"), "");
  make_sqlite(path("a.sqlite"), jupedsim_2() +
                                    "ALTER TABLE trajectory_data ADD COLUMN time; "
                                    "UPDATE trajectory_data SET time = 0.04 * frame;");
  EXPECT_EQ(note_of(*read_recording({.file = path("a.sqlite")})), "");
}

}  // namespace
}  // namespace throng::rates_test
