#include "analysis/trace.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "base/checksum.h"
#include "base/errors.h"
#include "culling/event_hash.h"
#include "scenes/run/sink.h"

namespace throng {
namespace {

void add(Hasher& hash, float value) { hash.add(static_cast<double>(value)); }

uint64_t hash_of_steering(const Frame& frame) {
  Hasher hash;
  for (const RootPose& root : frame.roots) {
    for (int axis = 0; axis < 3; ++axis) hash.add(root.position_m[axis]);
    for (int i = 0; i < 4; ++i) add(hash, root.world_from_root.coeffs()[i]);
  }
  for (const float speed : frame.speeds_mps) add(hash, speed);
  return hash.value();
}

uint64_t hash_of_postures(const Frame& frame) {
  Hasher hash;
  for (const float value : frame.postures) add(hash, value);
  return hash.value();
}

uint64_t hash_of(std::span<const PairKey> pairs) {
  Hasher hash;
  for (const PairKey& pair : pairs) hash.add(pair.bits());
  return hash.value();
}

uint64_t hash_of(std::span<const PairEvent> events) {
  EventSum sum;
  sum.add(events, EventHashKind::kEvents);
  return sum.sum;
}

}  // namespace

TraceSink::TraceSink(const std::filesystem::path& file) : file_(file) {
  // begin() truncates the file: a run that fails to start keeps the old trace.
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor >= 0) out_.reset(::fdopen(descriptor, "w"));
  if (out_ == nullptr)
    throw EnvironmentError(
        fmt::format("{}: cannot create the trace: {}", file.string(), std::strerror(errno)));
}

void TraceSink::begin(const RunInfo& run) {
  // EINVAL: pipes and devices cannot be truncated.
  if (::ftruncate(::fileno(out_.get()), 0) != 0 && errno != EINVAL) fail();
  std::fputs(fmt::format("run {:016x}\n", run.run_id).c_str(), out_.get());
  flush();
}

void TraceSink::frame(const RunInfo& run, const Frame& frame) {
  line(frame.number, "steering", hash_of_steering(frame));
  if (!frame.postures.empty()) {
    line(frame.number, "gait", hash_of_postures(frame));
    line(frame.number, "poses", hash_of_poses(run, frame));
  }
  line(frame.number, "pairs", hash_of(frame.pairs));
  line(frame.number, "events", hash_of(frame.events));
  flush();
}

void TraceSink::end(const RunInfo&, const RunEnd& end) {
  line(end.frames, "end", end.hash);
  flush();
}

void TraceSink::line(int64_t frame, std::string_view stage, uint64_t hash) {
  std::fputs(fmt::format("{} {} {:016x}\n", frame, stage, hash).c_str(), out_.get());
}

uint64_t TraceSink::hash_of_poses(const RunInfo& run, const Frame& frame) {
  Hasher hash;
  for (size_t avatar = 0; avatar < frame.roots.size(); ++avatar) {
    const Model& model = *run.models[run.model_of_avatar[avatar]];
    poses_.resize(model.parts.size());
    part_poses(run, frame, avatar, poses_);
    for (const PartPose& pose : poses_)
      for (const auto& row : pose.rows)
        for (const float value : row) add(hash, value);
  }
  return hash.value();
}

void TraceSink::flush() {
  if (std::fflush(out_.get()) != 0 || std::ferror(out_.get()) != 0) fail();
}

void TraceSink::fail() const {
  throw EnvironmentError(
      fmt::format("{}: cannot write the trace: {}", file_.string(), std::strerror(errno)));
}

}  // namespace throng
