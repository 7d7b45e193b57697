// `throng run` on a log: its poses with other options, and all outputs of any run.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/apps/run_json.h"

namespace throng::culled_log_test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;
using Json = nlohmann::json;

/// A folder with the log of a short run of a robot among people.
class CulledLog : public testing::Test {
 protected:
  void SetUp() override {
    simulated_ = run_json("robot_in_crowd --seconds 1 --log a.lcmlog", folder_);
    ASSERT_FALSE(simulated_.is_null());
  }
  ScratchFolder folder_;
  Json simulated_;
};

TEST_F(CulledLog, KeepsTheOptionsOfItsRunByDefault) {
  const Json again = run_json("a.lcmlog --log b.lcmlog", folder_);
  EXPECT_EQ(again["scene"], simulated_["scene"]);
  EXPECT_EQ(again["seed"], simulated_["seed"]);
  EXPECT_EQ(again["avatars"], simulated_["avatars"]);
  EXPECT_EQ(again["frames"], simulated_["frames"]);
  EXPECT_EQ(again["step_s"], simulated_["step_s"]);
  EXPECT_NE(again["run_id"], simulated_["run_id"]);
  EXPECT_EQ(again["stages"]["part_volume"]["volume"],
            simulated_["stages"]["part_volume"]["volume"]);
  const auto persist = [](const Json& run) { return run["events"]["persist"].get<double>(); };
  EXPECT_NEAR(persist(again), persist(simulated_), 0.02 * persist(simulated_));
  const Json other = run_json("a.lcmlog --exact --part-volume obb --log off", folder_);
  EXPECT_EQ(other["stages"]["part_volume"]["volume"], "obb");
  EXPECT_LT(persist(other), persist(simulated_)) << "triangles decide";
  EXPECT_EQ(shell("throng check b.lcmlog", folder_).exit_code, 0);
}

/// The option and the scene key give the same points in summary, log and table.
TEST_F(CulledLog, HasContactPointsOnRequest) {
  const std::string exact = "robot_in_crowd --seconds 1 --exact ";
  const Json plain = run_json(exact + "--log plain.lcmlog", folder_);
  const Json with = run_json(exact + "--contact-points --log with.lcmlog", folder_);
  EXPECT_FALSE(plain.contains("contact_points"));
  EXPECT_FALSE(with.contains("proximity"));
  EXPECT_EQ(with["hash"], plain["hash"]);
  const int64_t points = with["contact_points"]["points"];
  EXPECT_EQ(points,
            with["events"]["begin"].get<int64_t>() + with["events"]["persist"].get<int64_t>());
  EXPECT_GT(points, 0);
  EXPECT_GT(with["contact_points"]["max_depth_m"], 0);
  for (const char* log : {"with.lcmlog", "again.lcmlog"}) {
    if (std::string(log) == "again.lcmlog")
      run_json("with.lcmlog --contact-points --log again.lcmlog", folder_);
    const Outcome check = shell("throng check " + std::string(log), folder_);
    EXPECT_EQ(check.exit_code, 0) << check.out << check.err;
    EXPECT_THAT(shell("throng info " + std::string(log), folder_).out,
                HasSubstr("THRONG_CONTACT_POINTS        60"));
    const std::string table =
        shell("throng export " + std::string(log) + " --csv contact_points", folder_).out;
    EXPECT_THAT(table,
                StartsWith("frame,time_s,body_a,body_b,name_a,name_b,part_a,part_b,x_m,y_m,z_m,"));
    EXPECT_NEAR(static_cast<double>(line_count(table) - 1), static_cast<double>(points),
                0.05 * static_cast<double>(points) + 5);
  }
  EXPECT_THAT(shell("throng info plain.lcmlog", folder_).out,
              Not(HasSubstr("THRONG_CONTACT_POINTS")));
}

TEST_F(CulledLog, IsNamedInTheJson) {
  const Json recording = run_json("a.lcmlog --log off", folder_)["recording"];
  EXPECT_EQ(recording["kind"], "throng log");
  EXPECT_EQ(recording["people"], simulated_["avatars"]);
  EXPECT_EQ(recording["frames"], 60);
  EXPECT_DOUBLE_EQ(recording["fps"].get<double>(), 60);
  EXPECT_EQ(recording["anomalies"], Json::array());
  EXPECT_FALSE(simulated_.contains("recording"));
}

TEST_F(CulledLog, IsNeverOverwritten) {
  ASSERT_EQ(shell("throng run robot_in_crowd --seconds 0.1 --lcm off", folder_).exit_code, 0);
  const std::string before = read_file(folder_ / "out/robot_in_crowd.lcmlog");
  EXPECT_EQ(shell("throng run out/robot_in_crowd.lcmlog --lcm off", folder_).exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/robot_in_crowd_culled.lcmlog"));
  for (const char* output : {"--log", "--json", "--html", "--checkpoint"}) {
    const Outcome outcome = shell("throng run out/robot_in_crowd.lcmlog --lcm off " +
                                      std::string(output) + " out/robot_in_crowd.lcmlog",
                                  folder_);
    EXPECT_EQ(outcome.exit_code, 2) << output << ": " << outcome.err;
    EXPECT_EQ(line_count(outcome.err), 1) << outcome.err;
  }
  EXPECT_EQ(read_file(folder_ / "out/robot_in_crowd.lcmlog"), before);
}

TEST_F(CulledLog, RejectsOptionsThatChangePeople) {
  for (const char* option : {"--avatars 5", "--seed 2", "--steering collision_free_speed"}) {
    const Outcome outcome =
        shell("throng run a.lcmlog --lcm off --log off " + std::string(option), folder_);
    EXPECT_EQ(outcome.exit_code, 2) << option;
    EXPECT_EQ(line_count(outcome.err), 1) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("a log contains its people"));
  }
  const Outcome longer = shell("throng run a.lcmlog --lcm off --log off --seconds 9", folder_);
  EXPECT_EQ(longer.exit_code, 0);
  EXPECT_THAT(longer.err, HasSubstr("note: a.lcmlog ends after 1 s"));
  EXPECT_EQ(run_json("a.lcmlog --log off --seconds 0.5", folder_)["frames"], 30);
}

TEST_F(CulledLog, ResumesFromACheckpoint) {
  const Json whole = run_json("a.lcmlog --log off --checkpoint c --checkpoint-every 0.7", folder_);
  const Json rest = run_json("a.lcmlog --resume c", folder_);
  EXPECT_EQ(rest["hash"], whole["hash"]);
  EXPECT_EQ(rest["frames"], 18);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/a_culled_resumed.lcmlog"));
  ASSERT_EQ(
      shell("throng run robot_in_crowd --seed 2 --seconds 1 --lcm off --log b.lcmlog", folder_)
          .exit_code,
      0);
  const Outcome other = shell("throng run b.lcmlog --lcm off --log off --resume c", folder_);
  EXPECT_EQ(other.exit_code, 2) << "a checkpoint of another log";
  EXPECT_EQ(line_count(other.err), 1) << other.err;
}

TEST_F(CulledLog, WritesTrajectoryPageAndContacts) {
  const Outcome outcome = shell(
      "throng run a.lcmlog --lcm off --log b.lcmlog --trajectory t.csv --html p.html --contacts c",
      folder_);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(read_file(folder_ / "t.csv"), StartsWith("frame,time_s,id,"));
  EXPECT_GT(line_count(read_file(folder_ / "c/contacts.csv")), 1);
  EXPECT_GT(read_file(folder_ / "p.html").size(), 10'000u);
}

TEST_F(CulledLog, ReportsDamageInOneLine) {
  const std::string whole = read_file(folder_ / "a.lcmlog");
  write_file(folder_ / "torn.lcmlog", whole.substr(0, whole.size() * 4 / 5));
  const Outcome torn = shell("throng run torn.lcmlog --lcm off --log off", folder_);
  EXPECT_EQ(torn.exit_code, 0) << torn.err;
  EXPECT_THAT(torn.err, HasSubstr("note: torn.lcmlog: it ends inside a message"));
  // A foreign log, one without poses, one that ends within its description.
  std::string foreign("\xED\xA1\xDA\x01", 4);
  foreign += std::string(19, '\0') + "\x03" + std::string(3, '\0') + "\x02" + "ABCxy";
  write_file(folder_ / "foreign.lcmlog", foreign);
  write_file(folder_ / "magic.lcmlog", foreign.substr(0, 4));
  write_file(folder_ / "begun.lcmlog", whole.substr(0, 70'000));
  for (const char* name : {"foreign", "magic", "begun"}) {
    const Outcome outcome =
        shell("throng run " + std::string(name) + ".lcmlog --lcm off --log off", folder_);
    EXPECT_EQ(outcome.exit_code, 2) << name << ": " << outcome.out;
    EXPECT_EQ(line_count(outcome.err), 1) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("expected a log with a run's description, found none"));
  }
}

}  // namespace
}  // namespace throng::culled_log_test
