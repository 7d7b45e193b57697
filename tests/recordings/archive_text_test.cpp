// Archive text: facts in comments, missing facts, derived facts.
#include <gmock/gmock.h>

#include <algorithm>
#include <thread>

#include "base/random.h"
#include "recordings/sample_store.h"
#include "tests/recordings/recording_folder.h"

namespace throng::archive_text_test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class ArchiveText : public RecordingTest {};

constexpr const char* kHeader = "# framerate: 25.00 fps\n# id frame x/cm y/cm z/cm\n";

TEST_F(ArchiveText, ReadsRateAndUnitFromComments) {
  const auto recording = read(std::string(kHeader) +
                              "7 100 79.035 774.009 183.02\n"
                              "7\t101\t80\t780.5\t183.02\n"
                              "3  102  -10.5 0 171\n");
  const RecordingFacts& facts = recording->facts();
  EXPECT_EQ(facts.kind, "archive text");
  EXPECT_EQ(facts.tracked_point, TrackedPoint::kHead);
  EXPECT_EQ(facts.fps, 25);
  EXPECT_EQ(facts.first_frame, 100);
  EXPECT_EQ(facts.frames, 3);
  EXPECT_EQ(facts.samples, 3);
  EXPECT_EQ(facts.duration_s, 2 / 25.0);
  ASSERT_EQ(recording->people().size(), 2u);
  EXPECT_EQ(recording->people()[0].id, 3);
  EXPECT_FLOAT_EQ(static_cast<float>(*recording->people()[0].height_m), 1.71f);
  const std::vector<Sample> seven = track(*recording, 1);
  ASSERT_EQ(seven.size(), 2u);
  EXPECT_EQ(seven[0].position_m, Eigen::Vector2d(0.79035, 7.74009)) << "to the last digit";
  EXPECT_EQ(seven[1].time_s, 1 / 25.0);
}

TEST_F(ArchiveText, RequestsAllMissingFactsAtOnce) {
  const std::string bare = "1 43 79.035 774.009 183.02\n1 44 79.1 764.6 183.02\n";
  EXPECT_THAT(rejection(bare), HasSubstr("--fps 16 --unit cm"));
  EXPECT_THAT(rejection(bare, {.fps = 16}), HasSubstr("--unit cm"));
  EXPECT_THAT(rejection(bare, {.fps = 16}), Not(HasSubstr("--fps")));
  EXPECT_THAT(rejection(bare, {.unit_m = 0.01}), HasSubstr("--fps 25"));
  EXPECT_EQ(read(bare, {.fps = 16, .unit_m = 0.01})->facts().fps, 16);
}

TEST_F(ArchiveText, ReadsEveryTenthFrame) {
  const auto recording = read(std::string(kHeader) + "1 1010 0 0\n1 1020 10 0\n2 1040 0 0\n");
  EXPECT_EQ(recording->facts().fps, 2.5);
  EXPECT_EQ(recording->facts().frame_step, 10);
  EXPECT_EQ(recording->facts().frames, 4);
  EXPECT_EQ(track(*recording, 0)[1].time_s, 0.4);
}

TEST_F(ArchiveText, IgnoresEqualHeights) {
  const auto flat = read(std::string(kHeader) + "1 0 0 0 176\n2 0 99 0 176\n");
  EXPECT_FALSE(flat->people()[0].height_m);
  const auto low = read(std::string(kHeader) + "1 0 0 0 3\n2 0 99 0 4\n");
  EXPECT_FALSE(low->people()[0].height_m) << "3 cm is not a body height";
}

TEST_F(ArchiveText, CountsAnomaliesAndNamesTheFirst) {
  const std::string text = std::string(kHeader) +
                           "1 10 0 0\n1 11 400 0\n"                    // a jump
                           "2 10 0 100\n2 11 60 100\n"                 // 15 m/s
                           "3 10 0 0\n3 14 0 0\n3 15 0 0\n3 16 0 0\n"  // a hole
                           "4 10 0 0\n4 11 0 0\n4 51 0 0\n"            // comes back
                           "5 10 0 0\n5 10 1 0\n5 11 0 0\n"            // twice
                           "6 10 0 0\n";                               // once
  std::vector<std::string> anomalies;
  const auto recording = read(text);
  for (const Anomaly& anomaly : recording->facts().anomalies)
    anomalies.push_back(fmt::format("{} {}: {}", anomaly.count, anomaly.what, anomaly.first));
  EXPECT_THAT(anomalies,
              testing::ElementsAre(
                  "1 jumps of more than 3 m: id 1 at frame 11: 4 m in 0.04 s",
                  "1 speeds above 12 m/s: id 2 at frame 11: 0.6 m in 0.04 s",
                  "1 ids that reappear after more than 1 s: id 4 at frame 51, 1.6 s and 0 m "
                  "after its last position",
                  "1 gaps in tracks: id 3 at frame 14: 3 frames before it are missing",
                  "1 duplicate positions (the first is used): id 5 at frame 10",
                  "1 people with a single position: id 6 at frame 10"));
  EXPECT_EQ(track(*recording, 4)[0].position_m.x(), 0) << "the first is kept";
  EXPECT_THAT(rejection(text, {.strict = true}),
              testing::AllOf(HasSubstr("--strict"), HasSubstr("id 1 at frame 11")));
}

TEST_F(ArchiveText, ShiftsMapCoordinates) {
  const auto recording = read(
      "# framerate: 25\n# id frame x/m y/m\n"
      "1 0 365123.25 5621987.5\n1 1 365123.5 5621987.5\n");
  EXPECT_EQ(recording->facts().shift_m, Eigen::Vector2d(365'000, 5'621'000));
  EXPECT_EQ(track(*recording, 0)[1].position_m, Eigen::Vector2d(123.5, 987.5));
}

TEST_F(ArchiveText, StartsARangeAtItsFirstFrame) {
  std::string text = kHeader;
  for (int frame = 0; frame < 100; ++frame) text += fmt::format("1 {} {} 0\n", frame + 7, frame);
  text += "2 8 0 0\n2 9 0 0\n";
  const auto part = read(text, {.start_s = 1, .end_s = 2});
  EXPECT_EQ(part->facts().first_frame, 32);
  EXPECT_EQ(part->facts().frames, 26);
  ASSERT_EQ(part->people().size(), 1u);
  EXPECT_EQ(track(*part, 0).front().time_s, 0);
  EXPECT_EQ(track(*part, 0).front().position_m.x(), 0.25);
  EXPECT_THAT(rejection(text, {.start_s = 10}), HasSubstr("expected a person between 10 s"));
}

TEST_F(ArchiveText, IgnoresTheOrderOfLines) {
  for (const uint64_t seed : {1, 2, 3}) {
    SCOPED_TRACE(seed);
    std::vector<std::string> lines;
    for (int id = 1; id <= 9; ++id)
      for (int frame = id; frame < 300 + 10 * id; ++frame)
        lines.push_back(fmt::format("{} {} {} {}\n", id, frame, 100 * id + frame, id));
    const auto text = [&] { return fmt::format("{}{}", kHeader, fmt::join(lines, "")); };
    const auto sorted = read(text());
    for (size_t i = lines.size() - 1; i > 0; --i)
      std::swap(lines[i], lines[random_bits({seed, i, 0, Purpose::kStyle}, 0) % (i + 1)]);
    const auto shuffled = read(text());
    EXPECT_EQ(shuffled->content_hash(), sorted->content_hash());
    EXPECT_EQ(track(*shuffled, 4).back().time_s, track(*sorted, 4).back().time_s);
  }
}

TEST_F(ArchiveText, IsReadBySeveralThreads) {
  std::string text = kHeader;
  for (int frame = 0; frame < 500; ++frame)
    for (int id = 0; id < 40; ++id) text += fmt::format("{} {} {} {}\n", id, frame, id, frame);
  const auto recording = read(text);
  std::vector<int64_t> wrong(4, 0);
  {
    std::vector<std::jthread> threads;
    for (size_t t = 0; t < wrong.size(); ++t)
      threads.emplace_back([&, t] {
        std::vector<Sample> samples;
        for (size_t person = 0; person < 40; ++person) {
          recording->read(person, samples);
          wrong[t] += samples.size() != 500;
          for (const Sample& sample : samples)
            wrong[t] += sample.position_m.x() != static_cast<double>(person) / 100;
        }
      });
  }
  EXPECT_THAT(wrong, testing::Each(0));
}

TEST_F(ArchiveText, IsDetectedByContent) {
  EXPECT_TRUE(is_recording(write("a.dat", "1 43 79.035 774.009 183.02\n")));
  EXPECT_TRUE(is_recording(write("b.dat", "# id frame x/m y/m z/m\n")));
  EXPECT_FALSE(is_recording(write("c.txt", "name: plaza\nground: [10, 10]\n")));
  EXPECT_FALSE(is_recording(write("d.txt", "")));
  EXPECT_FALSE(is_recording(path("nothing.txt")));
}

TEST(SampleStore, HoldsMorePeopleThanBlocks) {
  SampleStore store;
  constexpr size_t kPeople = 40'000;
  for (size_t person = 0; person < kPeople; ++person) store.add_person();
  for (int round = 0; round < 3; ++round)
    for (size_t person = 0; person < kPeople; ++person)
      store.add(person,
                {.instant = static_cast<double>(2 - round), .x_m = static_cast<double>(person)});
  store.finish();
  std::vector<StoredSample> samples;
  for (const size_t person : {size_t{0}, size_t{32'768}, kPeople - 1}) {
    store.read(person, samples);
    ASSERT_EQ(samples.size(), 3u);
    EXPECT_EQ(samples[0].instant, 0);
    EXPECT_EQ(samples[2].instant, 2);
    EXPECT_EQ(samples[1].x_m, static_cast<double>(person));
  }
}

}  // namespace
}  // namespace throng::archive_text_test
