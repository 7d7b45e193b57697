// Tables with named columns, footsteps and gzip files: columns, rates and units.
#include <gmock/gmock.h>
#include <zlib.h>

#include <cmath>

#include "base/random.h"
#include "tests/recordings/recording_folder.h"

namespace throng::tables_test {
namespace {

using testing::HasSubstr;

class Tables : public RecordingTest {};

std::string gzip(const std::string& text) {
  std::string out(text.size() + 1000, '\0');
  z_stream stream{};
  deflateInit2(&stream, 9, Z_DEFLATED, MAX_WBITS + 16, 8, Z_DEFAULT_STRATEGY);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  deflate(&stream, Z_FINISH);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

TEST_F(Tables, DetectCrowdIt) {
  const std::string text = "time,pedID,posX,posY\n0.00,0,40.64,35.44\n0.50,0,41,35\n0.50,4,1,2\n";
  const auto recording = read(text);
  EXPECT_EQ(recording->facts().kind, "Crowd:it");
  EXPECT_EQ(recording->facts().fps, 2);
  EXPECT_EQ(recording->facts().tracked_point, TrackedPoint::kCentre);
  ASSERT_EQ(recording->people().size(), 2u);
  EXPECT_EQ(recording->people()[1].id, 4);
  EXPECT_EQ(recording->people()[1].first_s, 0.5);
  EXPECT_EQ(read(gzip(text))->content_hash(), recording->content_hash()) << "packed or not";
}

TEST_F(Tables, ReadPathfinderUnitsAndAbsences) {
  const auto recording = read(
      "\"t\",\"id\",\"name\",\"active\",\"x\",\"y\",\"z\",\"v\",\"location\"\n"
      "\"s\",\"\",\"\",\"\",\"m\",\"m\",\"m\",\"m/s\",\"\"\n"
      "0.000000,0,\"00001\",0,-10.5,-2,0.02,0,\"Room, 7\"\n"
      "1.000000,0,\"00001\",1,-10.5,-2,0.02,0,\"Room, 7\"\n"
      "2.000000,0,\"00001\",1,-9.5,-2,0.02,1,\"Room \"\"7\"\"\"\n");
  EXPECT_EQ(recording->facts().kind, "Pathfinder");
  EXPECT_EQ(recording->facts().fps, 1);
  EXPECT_EQ(recording->facts().samples, 2);
  EXPECT_FALSE(recording->people()[0].height_m) << "z is the floor";
  EXPECT_EQ(track(*recording, 0)[0].time_s, 0);
  EXPECT_EQ(track(*recording, 0)[0].position_m, Eigen::Vector2d(-10.5, -2));
}

TEST_F(Tables, ReadViswalkHeaders) {
  const auto recording = read(
      "$VISION\n* File: a.inpx\n* Comment:\n*\n* NO: Number\n"
      "$PEDESTRIAN:NO;SIMSEC;COORDCENTX;COORDCENTY\n"
      "3;0.20;1.5;2\n3;0.40;1.75;2\n");
  EXPECT_EQ(recording->facts().kind, "Viswalk");
  EXPECT_EQ(recording->facts().fps, 5);
  EXPECT_EQ(track(*recording, 0)[1].time_s, 0.2);
}

TEST_F(Tables, ReadHeadingsOfThrong) {
  std::string text = "frame,time_s,id,x_m,y_m,heading_rad,speed_mps\n";
  for (int frame = 0; frame < 200; ++frame)
    text +=
        fmt::format("{},{:.4f},0,{:.4f},0.0000,0.5000,1.0000\n", frame, frame / 60.0, frame / 60.0);
  const auto recording = read(text);
  EXPECT_EQ(recording->facts().kind, "Throng CSV");
  EXPECT_EQ(recording->facts().fps, 60) << "from times of four digits";
  EXPECT_TRUE(recording->facts().has_headings);
  EXPECT_EQ(track(*recording, 0)[7].heading_rad, 0.5f);
  EXPECT_EQ(track(*recording, 0)[7].time_s, 7 / 60.0);
}

TEST_F(Tables, FindRatesWithinPrintedDigits) {
  for (const double fps : {1.0, 2.5, 10.0, 12.5, 16.0, 25.0, 30.0, 30 / 1.001, 50.0, 60.0, 120.0})
    for (const int digits : {2, 3, 4, 6}) {
      SCOPED_TRACE(fmt::format("{} fps, {} digits", fps, digits));
      // Both frames have the same printed time.
      if (1 / fps < 1.01 * std::pow(10, -digits)) continue;
      std::string text = "t;id;x;y\n";
      for (int frame = 0; frame < 3000; ++frame)
        for (int id = 0; id < 2; ++id)
          if (frame % (id + 1) == 0)
            text += fmt::format("{:.{}f};{};{};0\n", 17 + frame / fps, digits, id, frame / fps);
      const auto recording = read(text);
      EXPECT_NEAR(recording->facts().fps, fps, 1e-3 * fps);
      EXPECT_EQ(recording->facts().frames, 3000);
    }
}

TEST_F(Tables, TreatIrregularTimesAsEvents) {
  std::string text = "t,id,x,y\n";
  double time_s = 0;
  for (uint32_t i = 0; i < 500; ++i) {
    time_s +=
        0.01 + 0.1 * static_cast<double>(random_bits({5, i, 0, Purpose::kStyle}, 0) % 1000) / 1000;
    text += fmt::format("{:.3f},1,{},0\n", time_s, time_s);
  }
  EXPECT_EQ(read(text)->facts().fps, 0);
  EXPECT_THAT(rejection(text, {.fps = 25}), HasSubstr("(--fps)"));
}

TEST_F(Tables, AcceptNamesByOption) {
  const std::string text = "who|when|easting|northing\n4|0|1.5|2\n4|1|1.75|2\n";
  const RecordingOptions options{
      .fps = 10, .columns = "id=who,frame=when,x=easting,y=northing", .separator = '|'};
  EXPECT_EQ(read(text, options)->facts().fps, 10);
  EXPECT_THAT(
      rejection("who;when;east;north\n4;0;1;2\n", {.columns = "id=whos,t=when,x=east,y=north"}),
      HasSubstr("did you mean 'who'?"));
  EXPECT_THAT(rejection(text, {.columns = "id=who,where=x"}), HasSubstr("--columns: expected"));
  const auto bare = read("0 1.5 2 4\n1 1.75 2 4\n", {.columns = "t=1,x=2,y=3,id=4"});
  EXPECT_EQ(bare->facts().samples, 2);
  EXPECT_EQ(bare->people()[0].id, 4);
}

TEST_F(Tables, TakeUnitsFromNamesOrOptions) {
  const auto x_of = [&](std::string_view text, RecordingOptions options = {}) {
    return track(*read(text, std::move(options)), 0)[0].position_m.x();
  };
  EXPECT_EQ(x_of("t,id,x,y\n0,1,3,4\n"), 3);
  EXPECT_EQ(x_of("t,id,x/cm,y/cm\n0,1,3,4\n"), 0.03);
  EXPECT_EQ(x_of("t,id,Pos X [mm],Pos Y [mm]\n0,1,3,4\n"), 0.003);
  EXPECT_EQ(x_of("t,id,x,y\n0,1,3,4\n", {.unit_m = 0.01}), 0.03);
}

TEST_F(Tables, RequestMissingRates) {
  const std::string text = "ID,Frame,x,y,v_x,v_y\n21,1010,0.2,-0.1,0,0\n21,1020,0.3,-0.1,0,0\n";
  EXPECT_THAT(rejection(text), HasSubstr("--fps 25"));
  EXPECT_EQ(read(text, {.fps = 25})->facts().fps, 2.5);
}

TEST_F(Tables, ReadFootsteps) {
  const auto recording = read(
      "#IDXCOL=2,DATACOL=6,SEP=' '\n"
      "pedestrianId simTime endTime-PID1 startX-PID1 startY-PID1 endX-PID1 endY-PID1 "
      "targetId-PID2\n"
      "1 0.4 1.0683293133551417 2.5 7.1 2.4880996733806358 6.383746164613437 8\n"
      "2 0.4 0.9 1 1 1.5 1 8\n"
      "1 1.0683293133551417 1.7 2.488099673380636 6.383746164613437 2.2 5.8 8\n"
      "2 5.9 6.4 1.5 1 2 1 8\n");
  EXPECT_EQ(recording->facts().kind, "Vadere footsteps");
  EXPECT_EQ(recording->facts().fps, 0);
  EXPECT_EQ(recording->facts().frames, 0);
  const std::vector<Sample> one = track(*recording, 0);
  ASSERT_EQ(one.size(), 3u) << "where a step ends the next begins";
  EXPECT_EQ(one[0].time_s, 0);
  EXPECT_EQ(one[1].time_s, 1.0683293133551417 - 0.4);
  EXPECT_EQ(track(*recording, 1).size(), 4u);
  EXPECT_TRUE(recording->facts().anomalies.empty()) << "standing people take no steps";
}

TEST_F(Tables, ReadEthWithFramesFirst) {
  std::string text;
  for (int frame = 780; frame < 1200; frame += 10)
    for (int id = 1; id <= 5; ++id)
      text += fmt::format("{}.0\t{}.0\t{}\t{}\n", frame, id, 0.05 * frame + id, 2 * id);
  const auto recording = read(text);
  EXPECT_EQ(recording->facts().kind, "ETH/UCY text");
  EXPECT_EQ(recording->facts().fps, 2.5);
  EXPECT_EQ(recording->people().size(), 5u);
  EXPECT_EQ(read(text, {.fps = 15})->facts().fps, 1.5) << "as frames are numbered";
  const auto obsmat = read(
      "  7.8000000e+02   1.0000000e+00   8.45   0   3.58   1.6   0   0.1\n"
      "  7.8600000e+02   1.0000000e+00   9.12   0   3.66   1.7   0   0.2\n");
  EXPECT_EQ(obsmat->facts().fps, 2.5);
  EXPECT_EQ(track(*obsmat, 0)[1].position_m, Eigen::Vector2d(9.12, 3.66));
}

TEST_F(Tables, IgnoreUnrelatedComments) {
  std::string rows;
  for (int frame = 780; frame < 900; frame += 6)
    for (int id = 1; id <= 5; ++id)
      rows += fmt::format("{}\t{}\t{}\t{}\n", frame, id, 0.05 * frame + id, 2 * id);
  const auto bare = read(rows);
  for (const char* comment :
       {"# scene: eth\n", "#\n", "# x to the east, y to the north\n\n# made in 2009\n",
        "\xEF\xBB\xBF# scene\n", "  # scene\n", "# positions in m\n", "% scene\n", "// scene\n",
        "# frame id\n"}) {
    const auto recording = read(comment + rows);
    EXPECT_EQ(recording->facts().kind, "ETH/UCY text") << comment;
    EXPECT_EQ(recording->content_hash(), bare->content_hash()) << comment;
  }
  const size_t line = rows.find("\n816") + 1;
  EXPECT_EQ(read(rows.substr(0, line) + "# more\n" + rows.substr(line))->content_hash(),
            bare->content_hash());
  EXPECT_EQ(read("# framerate: 15 fps\n" + rows)->facts().fps, 2.5) << "every sixth of 15";
  EXPECT_EQ(read("# framerate: 30 fps\n" + rows)->facts().fps, 5);
  const auto in_cm = read("# unit: cm\n" + rows);
  EXPECT_DOUBLE_EQ(track(*in_cm, 0)[0].position_m.x(), 0.4);
  EXPECT_EQ(track(*read("# - - cm ft\n" + rows), 0)[0].position_m.y(), 2 * 0.3048);
  EXPECT_THAT(rejection("# unit: px\n" + rows), HasSubstr("a unit of length"));
  EXPECT_THAT(rejection("# framerate: fast\n" + rows), HasSubstr("a frame rate as in"));
  EXPECT_THAT(rejection(rows + "# unit: cm\n" + rows), HasSubstr("split the file there"));
  EXPECT_THAT(rejection(rows + "# framerate: 30\n" + rows), HasSubstr("split the file there"));
  // Names take precedence over the more likely order.
  const RecordingOptions given = {.fps = 15, .unit_m = 1};
  const auto named = read("# frame id x y\n" + rows, given);
  EXPECT_EQ(named->people().size(), 5u);
  EXPECT_EQ(named->facts().fps, 2.5);
  EXPECT_EQ(read("# id frame x y\n" + rows, given)->people().size(), 20u);
  EXPECT_THAT(rejection("# id frame\n" + rows), HasSubstr("found archive text"));
  std::string archive;
  for (int id = 1; id <= 5; ++id)
    for (int frame = 0; frame < 50; ++frame)
      archive += fmt::format("{} {} {} {}\n", id, frame, 5 * frame + 100 * id, 200 * id);
  EXPECT_EQ(read("# scene\n" + archive, {.fps = 16, .unit_m = 0.01})->facts().kind, "archive text");
}

TEST_F(Tables, DetectArchiveTextByOrder) {
  std::string text;
  for (int id = 1; id <= 5; ++id)
    for (int frame = 0; frame < 50; ++frame)
      text += fmt::format("{} {} {} {}\n", id, frame, 5 * frame + 100 * id, 200 * id);
  EXPECT_EQ(read(text, {.fps = 16, .unit_m = 0.01})->facts().kind, "archive text");
}

TEST_F(Tables, RejectDamagedGzipFiles) {
  std::string text = "time,pedID,posX,posY\n";
  for (uint32_t i = 0; i < 20'000; ++i)
    text += fmt::format("{:.2f},{},{},{}\n", 0.5 * i, i % 7,
                        random_bits({1, i, 0, Purpose::kStyle}, 0) % 997, i);
  const std::string packed = gzip(text);
  EXPECT_THAT(rejection(packed.substr(0, packed.size() - 20)), HasSubstr("cut short"));
  std::string flipped = packed;
  for (size_t i = flipped.size() / 2; i < flipped.size() / 2 + 50; ++i) flipped[i] ^= 0x55;
  EXPECT_THAT(rejection(flipped), HasSubstr("expected"));
  EXPECT_FALSE(is_recording(write("bad", "\x1f\x8b\x08nonsense")));
  // One repeated line compresses by more than a factor of 300.
  const std::string line = "0.00,0,0,0\n";
  std::string bomb = "time,pedID,posX,posY\n";
  while (bomb.size() < (20u << 20)) bomb += line;
  EXPECT_THAT(rejection(gzip(bomb)), HasSubstr("at most 300 times its size"));
  EXPECT_THAT(rejection(gzip(std::string(1 << 20, ' '))), HasSubstr("expected"));
  EXPECT_THAT(rejection(gzip("time,pedID,posX,posY\n" + std::string(1 << 20, '1'))),
              HasSubstr(":2: expected lines of at most 64 KiB"));
}

}  // namespace
}  // namespace throng::tables_test
