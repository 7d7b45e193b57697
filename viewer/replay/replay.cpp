#include "viewer/replay/replay.h"

#include <fmt/format.h>
#include <glib.h>
#include <zlib.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/errors.h"
#include "base/files/atomic_file.h"
#include "lcm_io/log/log_gaps.h"
#include "viewer/picture/recorded_frame.h"

namespace throng {
namespace {

/// A whole step moves a column by at most this fraction of its tolerance. The rounding of many
/// coefficients and the omitted directions together stay within the tolerance.
constexpr double kStepShare = 0.7;
/// Maximum error from omitted directions, as a fraction of the tolerance.
constexpr double kMissShare = 0.6;

}  // namespace

Eigen::MatrixXi PostureBasis::coefficients(const Eigen::MatrixXd& rows) const {
  const Eigen::MatrixXd steps = (rows.rowwise() - mean.transpose()) * coefficient_of_.transpose();
  return steps.array().round().cast<int>();
}

PostureBasis PostureBasis::of(const Eigen::MatrixXd& rows, const Eigen::VectorXd& tolerance) {
  PostureBasis basis;
  const Eigen::Index columns = rows.cols();
  basis.mean = Eigen::VectorXd::Zero(columns);
  if (rows.size() == 0) {
    basis.directions.resize(columns, 0);
    basis.coefficient_of_.resize(0, columns);
    return basis;
  }
  basis.mean = rows.colwise().mean();
  const Eigen::VectorXd weight = tolerance.cwiseInverse();
  // In units of the tolerance all columns have equal weight.
  const Eigen::MatrixXd scaled = (rows.rowwise() - basis.mean.transpose()) * weight.asDiagonal();
  const Eigen::MatrixXd covariance = scaled.transpose() * scaled;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(covariance);
  const Eigen::MatrixXd vectors = solver.eigenvectors().rowwise().reverse();  // largest first
  Eigen::MatrixXd missed = scaled;
  Eigen::Index components = 0;
  while (components < columns && missed.cwiseAbs().maxCoeff() > kMissShare) {
    const Eigen::VectorXd v = vectors.col(components++);
    missed -= (missed * v) * v.transpose();
  }
  const Eigen::MatrixXd kept = vectors.leftCols(components);
  basis.directions = tolerance.asDiagonal() * kept * kStepShare;
  basis.coefficient_of_ = kept.transpose() * weight.asDiagonal() / kStepShare;
  return basis;
}

namespace {

using nlohmann::json;

// Flags of a contact interval, also read by the page.
constexpr uint8_t kBeganBefore = 1;  // its begin was not recorded
constexpr uint8_t kEndLost = 2;      // its end was not recorded
// Flag in the level of a proximity row.
constexpr int kPoints = 128;  // its closest points are known

constexpr size_t kMaxStoredBytes = size_t{2} << 30;
constexpr size_t kMaxProximityRows = 3'000'000;  // 300 MB
constexpr int64_t kMaxFrames = 10'000'000;  // two days; a damaged number must not allocate memory

/// Writes seven bits per byte, low ones first, with the sign in the lowest bit.
void put_varint(Bytes& out, int64_t value) {
  auto folded = static_cast<uint64_t>(value) << 1 ^ static_cast<uint64_t>(value >> 63);
  for (; folded >= 128; folded >>= 7) out.push_back(static_cast<uint8_t>(folded | 128));
  out.push_back(static_cast<uint8_t>(folded));
}

/// Curve writes a number over time as its deviation from a straight line through the last two.
class Curve {
 public:
  explicit Curve(Bytes& out) : out_(out) {}
  void add(int64_t value) {
    put_varint(out_, value - last_ - slope_);
    slope_ = count_++ == 0 ? 0 : value - last_;
    last_ = value;
  }

 private:
  Bytes& out_;
  int64_t last_ = 0, slope_ = 0, count_ = 0;
};

int64_t steps(double value, double step) { return std::llround(value / step); }

Eigen::VectorXd tolerance_of(const Model& model) {
  Eigen::VectorXd tolerance(model.kinematics.column_count());
  for (int c = 0; c < model.kinematics.column_count(); ++c)
    tolerance[c] = model.kinematics.columns()[static_cast<size_t>(c)].prismatic ? kReplayTravel_m
                                                                                : kReplayAngle_rad;
  return tolerance;
}

std::vector<float> floats_of(const Eigen::VectorXd& numbers) {
  std::vector<float> out;
  for (const double number : numbers) out.push_back(static_cast<float>(number));
  return out;
}

}  // namespace

double ReplayRecorder::seconds() const {
  return run_.run() == nullptr ? 0 : static_cast<double>(last_frame_ + 1) * run_.run()->step_s;
}

/// Stores contacts for the page: one without a recorded begin starts when it is first seen.
void ReplayRecorder::store_changes() {
  for (const PairBegins::Change& change : begins_.changes()) {
    std::vector<ContactInterval>& intervals = pairs_[change.pair];
    if (change.kind == PairBegins::ChangeKind::kBegan) {
      const bool is_begin_known = change.began >= 0;
      const auto level = run_.touching().find(change.pair);
      intervals.push_back({is_begin_known ? change.began : ~change.began, -1,
                           level == run_.touching().end() ? PairLevel::kPartVolume : level->second,
                           is_begin_known ? uint8_t{0} : kBeganBefore});
      ++interval_count_;
    } else if (!intervals.empty()) {
      intervals.back().end = std::max(intervals.back().begin, change.frame);
      if (change.kind == PairBegins::ChangeKind::kLost) intervals.back().flags |= kEndLost;
    }
  }
}

bool ReplayRecorder::drop_proximity() {
  const bool had_rows = nearest_count_ > 0;
  is_proximity_dropped_ = true;
  nearest_.clear();
  nearest_count_ = 0;
  return had_rows;
}

void ReplayRecorder::store_nearest() {
  has_proximity_ = true;
  const int64_t frame = run_.header()->frame;
  if (is_proximity_dropped_ || frame < 0 || frame >= kMaxFrames) return;
  for (const ProximityPair& row : nearest_parts(run_)) {
    std::vector<ProximityRow>& rows = nearest_[{row.pair.a(), row.pair.b()}];
    if (!rows.empty() && rows.back().frame >= frame) continue;  // repeated or in a wrong order
    rows.push_back({frame, row});
    ++nearest_count_;
  }
  if (nearest_count_ > kMaxProximityRows) drop_proximity();
}

void ReplayRecorder::take(std::string_view channel, std::span<const uint8_t> bytes) {
  const RunReader::Update update = run_.take(channel, bytes);
  begins_.take(run_, update);
  store_changes();
  switch (update) {
    case RunReader::Update::kState: {
      const auto every =
          static_cast<int64_t>(std::max(1.0, std::round(kReplayKeyPeriod_s / run_.run()->step_s)));
      const CrowdState& crowd = run_.state();
      if (!keys_.empty() && crowd.frame < keys_.back().frame + every) break;
      bytes_per_key_ = crowd.roots.size() * (sizeof(RootPose) + 5) + crowd.postures.size() * 4;
      if (stored_bytes() + bytes_per_key_ > kMaxStoredBytes)
        throw EnvironmentError(fmt::format(
            "--html keeps at most {} MB in memory, reached after {:.1f} s of {} people; choose a "
            "shorter time or fewer people",
            kMaxStoredBytes >> 20, seconds(), avatars()));
      keys_.push_back({crowd.frame, crowd});
      break;
    }
    case RunReader::Update::kProximity:
      store_nearest();
      break;
    case RunReader::Update::kSeparation:
      shortfalls_.take(run_.header()->frame, run_.new_shortfalls());
      break;
    case RunReader::Update::kFrameStats:
      if (run_.frame_stats()->frame >= kMaxFrames)
        throw EnvironmentError(fmt::format("--html stores at most {} frames, found frame {}",
                                           kMaxFrames, run_.frame_stats()->frame));
      last_frame_ = std::max(last_frame_, run_.frame_stats()->frame);
      frame_ms_.resize(static_cast<size_t>(last_frame_) + 1);
      frame_ms_.back() = static_cast<float>(run_.frame_stats()->frame_ns * 1e-6);
      break;
    default:
      break;
  }
}

void ReplayRecorder::put_people(Bytes& out) const {
  const size_t avatars = keys_.front().crowd.roots.size();
  const auto channel = [&](const auto& value_of) {
    for (size_t i = 0; i < avatars; ++i) {
      Curve curve(out);
      for (const Key& key : keys_) curve.add(value_of(key.crowd, i));
    }
  };
  channel([](const CrowdState& crowd, size_t i) { return int64_t{crowd.present[i]}; });
  for (int axis = 0; axis < 3; ++axis)
    channel([axis](const CrowdState& crowd, size_t i) {
      return steps(crowd.roots[i].position_m[axis], kReplayPosition_m);
    });
  for (int c = 0; c < 4; ++c) {
    for (size_t i = 0; i < avatars; ++i) {
      Curve curve(out);
      // q and -q are the same rotation: take the one nearer to the last key.
      Eigen::Vector4f last = keys_.front().crowd.roots[i].world_from_root.coeffs();
      for (const Key& key : keys_) {
        Eigen::Vector4f q = key.crowd.roots[i].world_from_root.coeffs();
        if (q.dot(last) < 0) q = -q;
        curve.add(steps(static_cast<double>(q[c]), kReplayQuaternion));
        last = q;
      }
    }
  }
}

void ReplayRecorder::put_pairs(Bytes& out) const {
  // Column by column: similar numbers next to each other compress best.
  const auto column = [&](const auto& put_one) {
    PairKey last(0, 0, 0, 0);
    for (const auto& [pair, intervals] : pairs_) {
      int64_t end = 0;
      for (const ContactInterval& interval : intervals) {
        const bool is_same_a = pair.a() == last.a();
        put_one(pair, last, is_same_a, interval, end);
        end = interval.end < 0 ? last_frame_ + 1 : interval.end;
        last = pair;
      }
    }
  };
  using Pair = const PairKey&;
  using Span = const ContactInterval&;
  column([&](Pair pair, Pair last, bool, Span, int64_t) {
    put_varint(out, int64_t{pair.a()} - int64_t{last.a()});
  });
  column([&](Pair pair, Pair last, bool is_same_a, Span, int64_t) {
    put_varint(out, int64_t{pair.b()} - (is_same_a ? int64_t{last.b()} : int64_t{pair.a()}));
  });
  column(
      [&](Pair pair, Pair, bool, Span, int64_t) { put(out, static_cast<uint8_t>(pair.part_a())); });
  column(
      [&](Pair pair, Pair, bool, Span, int64_t) { put(out, static_cast<uint8_t>(pair.part_b())); });
  column([&](Pair, Pair, bool, Span part, int64_t) { put(out, static_cast<uint8_t>(part.level)); });
  column([&](Pair, Pair, bool, Span part, int64_t) { put(out, part.flags); });
  column([&](Pair, Pair, bool, Span part, int64_t end) { put_varint(out, part.begin - end); });
  column([&](Pair, Pair, bool, Span part, int64_t) {
    put_varint(out, (part.end < 0 ? last_frame_ + 1 : part.end) - part.begin);
  });
}

void ReplayRecorder::put_nearest(Bytes& out) const {
  std::pair<uint32_t, uint32_t> last{0, 0};
  for (const auto& [bodies, rows] : nearest_) {
    put_varint(out, int64_t{bodies.first} - int64_t{last.first});
    put_varint(out, int64_t{bodies.second} - int64_t{last.second});
    put_varint(out, static_cast<int64_t>(rows.size()));
    last = bodies;
  }
  const auto column = [&](const auto& put_one) {
    for (const auto& [bodies, rows] : nearest_)
      for (const ProximityRow& near : rows) put_one(near.row);
  };
  const auto curve = [&](const auto& value_of) {
    for (const auto& [bodies, rows] : nearest_) {
      Curve values(out);
      for (const ProximityRow& near : rows) values.add(value_of(near));
    }
  };
  // Bit patterns of floats above 0 have the order of the floats.
  const auto bits = [](float distance_m) { return int64_t{std::bit_cast<int32_t>(distance_m)}; };
  curve([](const ProximityRow& near) { return near.frame; });
  column([&](const ProximityPair& row) { put(out, static_cast<uint8_t>(row.pair.part_a())); });
  column([&](const ProximityPair& row) { put(out, static_cast<uint8_t>(row.pair.part_b())); });
  column([&](const ProximityPair& row) {
    put(out, static_cast<uint8_t>(static_cast<int>(row.level) | (has_points(row) ? kPoints : 0)));
  });
  curve([&](const ProximityRow& near) { return bits(near.row.lo_m); });
  curve([&](const ProximityRow& near) { return bits(near.row.hi_m) - bits(near.row.lo_m); });
  for (const auto point : {&ProximityPair::point_a_m, &ProximityPair::point_b_m})
    for (size_t axis = 0; axis < 3; ++axis)
      for (const auto& [bodies, rows] : nearest_) {
        Curve values(out);
        for (const ProximityRow& near : rows)
          if (has_points(near.row)) values.add(steps((near.row.*point)[axis], kReplayPoint_m));
      }
}

Eigen::MatrixXd ReplayRecorder::rows_of(std::span<const size_t> members,
                                        Eigen::Index joints) const {
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(members.size() * keys_.size()), joints);
  Eigen::Index at = 0;
  for (const size_t i : members)
    for (const Key& key : keys_)
      rows.row(at++) = Eigen::Map<const Eigen::VectorXf>(
                           key.crowd.postures.data() + run_.posture_offsets()[i], joints)
                           .cast<double>();
  return rows;
}

PostureBasis ReplayRecorder::put_postures(size_t model_index, Bytes& out) {
  const std::shared_ptr<const Model> model = run_.model(model_index);
  const std::vector<int16_t>& model_of = run_.run()->model_of_avatar;
  std::vector<size_t> members;
  for (size_t i = 0; i < model_of.size(); ++i)
    if (static_cast<size_t>(model_of[i]) == model_index) members.push_back(i);
  const Eigen::MatrixXd rows = rows_of(members, model->kinematics.column_count());
  PostureBasis basis = PostureBasis::of(rows, tolerance_of(*model));
  const Eigen::MatrixXi coefficients = basis.coefficients(rows);
  for (Eigen::Index c = 0; c < coefficients.cols(); ++c) {
    Eigen::Index row = 0;
    for (size_t member = 0; member < members.size(); ++member) {
      Curve curve(out);
      for (size_t key = 0; key < keys_.size(); ++key) curve.add(coefficients(row++, c));
    }
  }
  return basis;
}

Bytes ReplayRecorder::finish(const std::string& problem) {
  const RunGeometry geometry(run_);
  // The last frame is a key, too: people move until the end.
  if (keys_.back().frame < run_.state().frame) keys_.push_back({run_.state().frame, run_.state()});
  Bytes columns;
  put_people(columns);
  json models = json::array();
  for (size_t m = 0; m < run_.run()->models.size(); ++m) {
    const PostureBasis basis = put_postures(m, columns);
    json directions = json::array();
    for (int c = 0; c < basis.components(); ++c)
      directions.push_back(floats_of(basis.directions.col(c)));
    models.push_back({{"mean", floats_of(basis.mean)}, {"directions", directions}});
  }
  const size_t pairs_at = columns.size();
  put_pairs(columns);
  const size_t nearest_at = columns.size();
  put_nearest(columns);
  json head = {{"position_step_m", kReplayPosition_m},
               {"quaternion_step", kReplayQuaternion},
               {"frames", last_frame_ + 1},
               {"pairs", interval_count_},
               {"pairs_at", pairs_at},
               {"problem", problem},
               {"models", models}};
  if (json shortfalls = shortfalls_.to_json(); !shortfalls.empty())
    head["shortfalls"] = std::move(shortfalls);
  if (has_proximity_)
    head["nearest"] = {{"bodies", nearest_.size()},
                       {"rows", nearest_count_},
                       {"at", nearest_at},
                       {"dropped", is_proximity_dropped_}};
  head["keys"] = json::array();
  for (const Key& key : keys_) head["keys"].push_back(key.frame);
  head["frame_us"] = json::array();
  if (std::any_of(frame_ms_.begin(), frame_ms_.end(), [](float ms) { return ms > 0; }))
    for (const float ms : frame_ms_) head["frame_us"].push_back(std::lround(ms * 1000));

  Bytes out;
  const auto put_sized = [&out](const Bytes& bytes) {
    put(out, static_cast<uint32_t>(bytes.size()));
    out.insert(out.end(), bytes.begin(), bytes.end());
  };
  Bytes run = run_message(run_, geometry, ViewMode::kFile);
  align(run, 4);
  put_sized(run);
  const std::string text = head.dump(-1, ' ', false, json::error_handler_t::replace);
  put_sized(Bytes(text.begin(), text.end()));
  out.insert(out.end(), columns.begin(), columns.end());
  return out;
}

namespace {

constexpr std::string_view kMarker = "<!--RECORDING-->";

Bytes deflated(const Bytes& bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  Bytes out(size);
  if (compress2(out.data(), &size, bytes.data(), static_cast<uLong>(bytes.size()), 9) != Z_OK)
    throw EnvironmentError("zlib could not compress the recording: out of memory");
  out.resize(size);
  return out;
}

std::string base64(const Bytes& bytes) {
  const std::unique_ptr<gchar, void (*)(void*)> text(g_base64_encode(bytes.data(), bytes.size()),
                                                     g_free);
  return text.get();
}

}  // namespace

ReplayReport write_replay(ReplayRecorder& recorder, const std::filesystem::path& html,
                          std::string_view page, double limit_mb, const std::string& problem) {
  if (!recorder.has_keys())
    throw InputError(html.string(), "a run with people or robots", "no frame");
  const size_t marker = page.find(kMarker);
  std::string recording = base64(deflated(recorder.finish(problem)));
  const double allowed = limit_mb * 1e6;
  // Proximity rows can be many times the rest: better a file without them than none.
  if (static_cast<double>(page.size() + recording.size()) > allowed && recorder.drop_proximity())
    recording = base64(deflated(recorder.finish(problem)));
  std::string text(page.substr(0, marker));
  text += "<script type=\"text/plain\" id=\"recording\">";
  text += recording;
  text += "</script>";
  text += page.substr(marker + kMarker.size());
  const double mb = static_cast<double>(text.size()) * 1e-6;
  if (mb > limit_mb) {
    const double room = limit_mb - static_cast<double>(page.size()) * 1e-6;
    const double share = std::max(0.0, room / (static_cast<double>(recording.size()) * 1e-6));
    throw InputError(
        html.string(), fmt::format("at most {:g} MB (--html-limit-mb)", limit_mb),
        fmt::format("{:.1f} MB for {} people over {:.1f} s; {:.1f} s of them would fit", mb,
                    recorder.avatars(), recorder.seconds(), 0.95 * share * recorder.seconds()));
  }
  write_file_atomically(html, text);
  return {text.size(), recorder.avatars(), recorder.seconds(), problem};
}

ReplayReport write_replay(const std::filesystem::path& log, const std::filesystem::path& html,
                          std::string_view page, double limit_mb) {
  LogReader reader(log);
  ReplayRecorder recorder;
  LogGaps gaps;
  LogEvent event;
  while (gaps.next(reader, event)) recorder.take(event.channel, event.data);
  const run_description_t* run = recorder.run();
  if (run == nullptr)
    throw InputError(log.string(), "a run's description", gaps.found_no_description());
  require_people(*run, log.string());
  if (!recorder.has_keys())
    throw InputError(log.string(), "a log with states", "none; " + gaps.describe(run->step_s));
  return write_replay(recorder, html, page, limit_mb, gaps.describe(run->step_s));
}

ReplaySink::ReplaySink(const std::filesystem::path& html, std::string_view page, double limit_mb)
    : html_(html), page_(page), limit_mb_(limit_mb) {}

void ReplaySink::begin(const RunInfo& run) {
  if (run.avatar_count() == 0)
    throw InputError(html_.string(), "a run with people or robots",
                     fmt::format("scene '{}' without avatars", run.scene->name));
  const double every = std::max(1.0, std::round(kReplayKeyPeriod_s / run.step_s));
  encoder_.emplace(EncoderOptions{.state_every = every}, static_cast<MessageTarget&>(*this));
  encoder_->begin(run);
  for (int chunk = 0; chunk < encoder_->target_state().description_chunks(); ++chunk)
    encoder_->target_state().send_description_chunk(chunk);
}

void ReplaySink::frame(const RunInfo& run, const Frame& frame) { encoder_->frame(run, frame); }

void ReplaySink::end(const RunInfo& run, const RunEnd& end) {
  encoder_->end(run, end);
  try {
    report_ = write_replay(recorder_, html_, page_, limit_mb_);
  } catch (const InputError& error) {
    // The run itself succeeded: only this file is missing.
    throw EnvironmentError(error.what());
  }
}

void ReplaySink::message(Channel channel, int64_t, std::span<const uint8_t> bytes) {
  recorder_.take(name_of(channel), bytes);
}

}  // namespace throng
