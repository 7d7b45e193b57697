// Tests recordings in one HTML file: tolerances, limits and errors.
#include "viewer/replay/replay.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/errors.h"
#include "base/random.h"
#include "tests/lcm_io/synthetic_run.h"

namespace throng::replay_test {
namespace {

constexpr std::string_view kPage = "<!doctype html><!--RECORDING--><script></script>";

TEST(PostureBasis, KeepsTolerances) {
  for (const int dimensions : {1, 2, 5, 9}) {
    // Rows on a curved surface of this many dimensions, like gaits, plus noise.
    Eigen::MatrixXd rows(400, 9);
    for (Eigen::Index row = 0; row < rows.rows(); ++row)
      for (Eigen::Index column = 0; column < rows.cols(); ++column) {
        const auto d = static_cast<uint64_t>(column % dimensions);
        const double t = random_uniform({.seed = 2, .id = static_cast<uint64_t>(row), .step = d});
        rows(row, column) = std::sin(3 * t + static_cast<double>(column)) +
                            1e-3 * random_uniform({.seed = 3, .id = static_cast<uint64_t>(row)});
      }
    Eigen::VectorXd tolerance = Eigen::VectorXd::Constant(9, 0.02);
    tolerance[4] = 0.002;
    const PostureBasis basis = PostureBasis::of(rows, tolerance);
    const Eigen::MatrixXd rebuilt =
        (basis.coefficients(rows).cast<double>() * basis.directions.transpose()).rowwise() +
        basis.mean.transpose();
    const Eigen::VectorXd worst = (rebuilt - rows).cwiseAbs().colwise().maxCoeff().transpose();
    for (Eigen::Index column = 0; column < 9; ++column)
      EXPECT_LE(worst[column], 1.5 * tolerance[column])
          << "column " << column << " of " << dimensions << " dimensions";
  }
}

TEST(PostureBasis, HasNoComponentsForAStaticCrowd) {
  const Eigen::MatrixXd rows = Eigen::MatrixXd::Constant(10, 3, 0.25);
  const PostureBasis basis = PostureBasis::of(rows, Eigen::VectorXd::Constant(3, 0.01));
  EXPECT_EQ(basis.components(), 0);
  EXPECT_DOUBLE_EQ(basis.mean[2], 0.25);
  EXPECT_EQ(PostureBasis::of(Eigen::MatrixXd(0, 3), Eigen::VectorXd::Ones(3)).components(), 0);
}

TEST(Replay, RecordsARunAndItsLogEqually) {
  const SyntheticRun::Options options{.avatars = 20, .seed = 6, .comings = true};
  const ScratchFile log, from_log(".html"), direct(".html");
  SyntheticRun run(options), again(options);
  LogSink log_sink(log.path());
  run.play(log_sink, 120);
  ReplaySink sink(direct.path(), kPage, 25);
  again.play(sink, 120);
  const ReplayReport& report = sink.report();
  write_replay(log.path(), from_log.path(), kPage, 25);
  EXPECT_EQ(report.avatars, 20);
  EXPECT_DOUBLE_EQ(report.seconds, 120 * again.info().step_s);
  const std::vector<uint8_t> bytes = bytes_of(direct.path());
  EXPECT_EQ(bytes.size(), report.bytes);
  const std::string text(bytes.begin(), bytes.end());
  EXPECT_EQ(text.find("<!--RECORDING-->"), std::string::npos);
  EXPECT_NE(text.find("id=\"recording\""), std::string::npos);
  EXPECT_TRUE(text.ends_with("<script></script>"));
}

TEST(Replay, RejectsALargeFileAndStatesTheFittingTime) {
  const ScratchFile log, html(".html");
  SyntheticRun run({.avatars = 50});
  LogSink sink(log.path());
  run.play(sink, 60);
  try {
    write_replay(log.path(), html.path(), kPage, 0.05);
    FAIL() << "a file over the limit was written";
  } catch (const InputError& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find("--html-limit-mb"), std::string::npos) << message;
    EXPECT_NE(message.find("would fit"), std::string::npos) << message;
  }
  EXPECT_FALSE(std::filesystem::exists(html.path()));
}

TEST(Replay, RejectsTooManyFrames) {
  const ScratchFile log, html(".html");
  {
    SyntheticRun run({.avatars = 5});
    LogSink sink(log.path());
    sink.begin(run.info());
    Frame frame = run.step();
    frame.number = int64_t{1} << 53;
    sink.frame(run.info(), frame);
    sink.end(run.info(), run.finish());
  }
  EXPECT_THROW(write_replay(log.path(), html.path(), kPage, 25), EnvironmentError);
}

TEST(Replay, ReportsMissingPartsOfATornLog) {
  const ScratchFile log, html(".html");
  SyntheticRun run({.avatars = 20});
  LogSink sink(log.path());
  run.play(sink, 120);
  EXPECT_EQ(write_replay(log.path(), html.path(), kPage, 25).problem, "");
  const std::vector<uint8_t> bytes = bytes_of(log.path());
  for (const size_t size : {bytes.size() - 1, bytes.size() * 2 / 3}) {
    write_bytes(log.path(), std::span(bytes).first(size));
    const ReplayReport report = write_replay(log.path(), html.path(), kPage, 25);
    EXPECT_NE(report.problem.find("torn"), std::string::npos) << report.problem;
  }
}

TEST(Replay, RejectsARunWithoutAvatars) {
  const ScratchFile log, html(".html");
  SyntheticRun run({.avatars = 0, .pairs = 0});
  LogSink sink(log.path());
  run.play(sink, 20);
  try {
    write_replay(log.path(), html.path(), kPage, 25);
    FAIL() << "a page without avatars";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("without avatars"), std::string::npos) << error.what();
  }
}

TEST(Replay, RejectsAFileThatIsNoLog) {
  const ScratchFile file, html(".html");
  write_bytes(file.path(), std::vector<uint8_t>(1000, 7));
  EXPECT_THROW(write_replay(file.path(), html.path(), kPage, 25), InputError);
}

}  // namespace
}  // namespace throng::replay_test
