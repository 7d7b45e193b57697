// Trajectories as comma-separated values, a row a person and frame.
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "analysis/trajectories/trajectory_writer.h"
#include "base/append.h"
#include "base/errors.h"

namespace throng {
namespace {

class CsvWriter final : public TrajectoryWriter {
 public:
  explicit CsvWriter(const std::filesystem::path& file)
      : file_(file.string()),
        descriptor_(open(file_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666)) {
    if (descriptor_ < 0) fail();
  }
  ~CsvWriter() override {
    if (descriptor_ >= 0) close(descriptor_);
  }
  CsvWriter(const CsvWriter&) = delete;
  CsvWriter& operator=(const CsvWriter&) = delete;

  void begin(const TrajectoryHead& head) override {
    // A pipe or device has nothing to lose (EINVAL).
    if (ftruncate(descriptor_, 0) != 0 && errno != EINVAL) fail();
    frame_s_ = 1 / head.fps;
    text_ = "frame,time_s,id,x_m,y_m,heading_rad,speed_mps\n";
    write_out();
  }

  void frame(int64_t number, std::span<const TrajectoryRow> rows) override {
    const double time_s = static_cast<double>(number) * frame_s_;
    for (const TrajectoryRow& row : rows)
      append(text_, "{},{:.4f},{},{:.4f},{:.4f},{:.4f},{:.4f}\n", number, time_s, row.id, row.x_m,
             row.y_m, row.heading_rad, row.speed_mps);
    write_out();
  }

  void end() override {
    const int closed = close(descriptor_);
    descriptor_ = -1;
    if (closed != 0) fail();
  }

 private:
  void write_out() {
    size_t done = 0;
    while (done < text_.size()) {
      const ssize_t count = write(descriptor_, text_.data() + done, text_.size() - done);
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) {
        const int error = errno;
        // Whole frames only: a torn line would read as a wrong number.
        [[maybe_unused]] const int cut = ftruncate(descriptor_, complete_);
        errno = error;
        fail();
      }
      done += static_cast<size_t>(count);
    }
    complete_ += static_cast<off_t>(text_.size());
    text_.clear();
  }

  [[noreturn]] void fail() const {
    throw EnvironmentError(
        fmt::format("{}: cannot write the trajectory: {}; choose another place with --trajectory",
                    file_, std::strerror(errno)));
  }

  std::string file_;
  int descriptor_;
  double frame_s_ = 0;
  off_t complete_ = 0;
  std::string text_;
};

}  // namespace

std::unique_ptr<TrajectoryWriter> open_csv_trajectory(const std::filesystem::path& file) {
  return std::make_unique<CsvWriter>(file);
}

}  // namespace throng
