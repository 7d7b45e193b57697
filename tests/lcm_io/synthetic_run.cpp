#include "synthetic_run.h"

#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "base/random.h"

namespace throng {
namespace {

Mesh unit_box() {
  Mesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.emplace_back((i & 1) != 0 ? 0.5f : -0.5f, (i & 2) != 0 ? 0.5f : -0.5f,
                               (i & 4) != 0 ? 0.5f : -0.5f);
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

}  // namespace

std::shared_ptr<const Model> adult() {
  static const std::shared_ptr<const Model> model = load_model(adult_urdf());
  return model;
}

std::shared_ptr<const Model> rover() {
  static const std::shared_ptr<const Model> model =
      load_model(std::filesystem::path(THRONG_SOURCE_DIR) / "tests/lcm_io/fixtures/rover.urdf");
  return model;
}

SyntheticRun::SyntheticRun(const Options& options) : options_(options) {
  scene_.name = "synthetic";
  scene_.file = "/a/folder/of/this/machine/synthetic.yaml";
  scene_.seed = options.seed;
  scene_.ground = {{-60, -40}, {60, 40}};
  Obstacle& box = scene_.obstacles.emplace_back();
  box.name = "kiosk";
  box.centre_m = {3, 4, 0.5};
  box.heading_rad = 0.3;
  box.mesh_file = "/a/folder/of/this/machine/kiosk.tri";
  box.mesh = unit_box();
  info_.scene = &scene_;
  info_.run_id = 0x1234'5678'9abc'def0 + options.seed;
  info_.instance = 0xfeed'beef'0000'0001;
  info_.step_s = 1.0 / 60;
  if (options.proximity) {
    info_.culler.proximity = {0.3f, 1, info_.step_s, true};
    SeparationRule& rule = scene_.separation.emplace();
    rule.human_speed_mps = rule.robot_speed_mps = 0.5;
    rule.reaction_s = 0.1;
    rule.stopping_s = 0.05;
  }
  if (options.has_budget) info_.culler.budget_tests = 1000;
  if (options.crowd != Crowd::kRovers) info_.models.push_back(adult());
  if (options.crowd != Crowd::kAdults) info_.models.push_back(rover());
  info_.groups = {"walkers", "robots"};
  info_.control_channels = {"", "ROBOT_DRIVE"};
  offsets_ = {0};
  for (int i = 0; i < options.avatars; ++i) {
    const bool is_second = options.crowd == Crowd::kMixed && i % 3 == 2;
    info_.model_of_avatar.push_back(is_second ? 1 : 0);
    info_.group_of_avatar.push_back(is_second ? 1 : 0);
    info_.scale_of_avatar.push_back(0.9f + 0.01f * static_cast<float>(i % 20));
    const Model& model = *info_.models[info_.model_of_avatar.back()];
    offsets_.push_back(offsets_.back() + static_cast<size_t>(model.kinematics.column_count()));
  }
  const auto avatars = static_cast<size_t>(options.avatars);
  roots_.resize(avatars);
  speeds_.resize(avatars);
  postures_.resize(offsets_.back());
}

void SyntheticRun::pose() {
  const auto step = static_cast<uint64_t>(next_frame_);
  for (size_t i = 0; i < roots_.size(); ++i) {
    const RandomKey key{options_.seed, i, step, Purpose::kSpawnPosition};
    for (int axis = 0; axis < 3; ++axis)
      roots_[i].position_m[axis] =
          random_uniform(key, -options_.spread_m, options_.spread_m, static_cast<uint32_t>(axis));
    const auto heading = static_cast<float>(random_uniform(key, -3.14, 3.14, 3));
    const auto tilt = static_cast<float>(random_uniform(key, -0.5, 0.5, 4));
    roots_[i].world_from_root = Eigen::AngleAxisf(heading, Eigen::Vector3f::UnitZ()) *
                                Eigen::AngleAxisf(tilt, Eigen::Vector3f::UnitY());
    speeds_[i] = static_cast<float>(random_uniform(key, 0, 2, 5));
    const auto& columns = info_.models[info_.model_of_avatar[i]]->kinematics.columns();
    for (size_t c = 0; c < columns.size(); ++c)
      postures_[offsets_[i] + c] = static_cast<float>(
          random_uniform(key, static_cast<double>(columns[c].lower),
                         static_cast<double>(columns[c].upper), static_cast<uint32_t>(6 + c)));
  }
}

void SyntheticRun::touch() {
  // Half of the pairs persist from frame to frame, the others change.
  const auto bodies = static_cast<uint64_t>(options_.avatars) + 1;
  std::vector<PairKey> pairs;
  for (int i = 0; i < options_.pairs && options_.avatars > 0; ++i) {
    const auto step = static_cast<uint64_t>(i % 2 == 0 ? next_frame_ / 30 : next_frame_);
    const RandomKey key{options_.seed, static_cast<uint64_t>(i), step, Purpose::kGoal};
    auto a = static_cast<uint32_t>(random_bits(key, 0) % bodies);
    auto b = static_cast<uint32_t>(random_bits(key, 1) % bodies);
    if (a == b) continue;
    const bool is_there = present_.empty() || ((a >= present_.size() || present_[a] != 0) &&
                                               (b >= present_.size() || present_[b] != 0));
    if (!is_there) continue;
    const auto part = [&](uint32_t body, uint32_t k) {
      return body + 1 == bodies ? 0 : static_cast<uint32_t>(random_bits(key, k) % 4);
    };
    const bool is_whole = options_.has_budget && random_bits(key, 4) % 3 == 0;
    const uint32_t first = std::min(a, b), second = std::max(a, b);
    pairs.emplace_back(first, second, is_whole ? kWholeBody : part(first, 2),
                       is_whole ? kWholeBody : part(second, 3));
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  pairs_ = std::move(pairs);
}

void SyntheticRun::come_and_go() {
  present_.resize(roots_.size());
  for (size_t i = 0; i < present_.size(); ++i) {
    const RandomKey key{options_.seed, i, static_cast<uint64_t>(next_frame_) / 20, Purpose::kStyle};
    present_[i] = random_bits(key, 0) % 4 == 0 ? 0 : 1;
  }
}

namespace {

/// For whole bodies 0 or 1, for parts 1 to 3; constant per pair.
uint8_t level_of(PairKey pair) {
  const auto number = static_cast<uint8_t>(pair.bits() >> 16);
  return pair.part_a() == kWholeBody ? number % 2 : 1 + number % 3;
}

}  // namespace

void SyntheticRun::level() {
  levels_.clear();
  if (options_.has_budget)
    for (const PairKey& pair : pairs_) levels_.push_back(level_of(pair));
  for (PairEvent& event : pair_events_.events_to_level()) {
    event.level = info_.culler.exact ? PairLevel::kTriangles : PairLevel::kPartVolume;
    if (options_.has_budget) event.level = static_cast<PairLevel>(level_of(event.pair));
  }
}

void SyntheticRun::count(std::span<const PairEvent> events) {
  for (const PairEvent& event : events) ++(event.kind == EventKind::kBegin ? begins_ : ends_);
}

void SyntheticRun::add_to_hash() {
  EventSum sum;
  sum.add(pair_events_.events(),
          options_.has_budget ? EventHashKind::kEventsAndLevels : EventHashKind::kEvents);
  hash_.add_frame(static_cast<uint64_t>(next_frame_), sum);
}

/// Every second row is by triangles.
void SyntheticRun::list_proximity() {
  proximity_.clear();
  for (const PairKey& pair : pairs_) {
    ProximityPair& row = proximity_.emplace_back();
    row.pair = pair;
    row.lo_m = 0.001f * static_cast<float>(proximity_.size());
    row.hi_m = row.lo_m + 0.0005f;
    if (proximity_.size() % 2 == 0) continue;
    row.level = PairLevel::kTriangles;
    row.point_a_m = {1.5, 2.5, 1};
    row.point_b_m = {1.5, 2.5, 1 + static_cast<double>(row.hi_m)};
    row.normal = {0, 0, 1};
  }
  contact_points_.clear();
  for (const PairKey& pair : pairs_)
    contact_points_.push_back({pair, {1.5, 2.5, 0.125 * pair.part_a()}, {0, 0, 1}, 0.02f});
  frame_.contact_points = contact_points_;
  frame_.proximity_pairs = proximity_;
  frame_.closest_parts = std::span<const ProximityPair>(proximity_).first(proximity_.size() / 2);
}

const Frame& SyntheticRun::step() {
  pose();
  if (options_.comings) come_and_go();
  touch();
  pair_events_.advance(pairs_);
  level();
  count(pair_events_.events());
  add_to_hash();
  counters_.body_sphere.updates = roots_.size();
  counters_.body_sphere.tests = roots_.size() * 7 + static_cast<uint64_t>(next_frame_);
  counters_.part_volume.test_ns = 12.5 * static_cast<double>(next_frame_ + 1);
  times_.frame_ns = 1e6;
  frame_.number = next_frame_;
  frame_.utime_us = next_frame_ * 1'000'000 / 60;
  frame_.roots = roots_;
  frame_.speeds_mps = speeds_;
  frame_.postures = postures_;
  frame_.posture_offsets = offsets_;
  frame_.pairs = pairs_;
  frame_.events = pair_events_.events();
  frame_.present = present_;
  if (options_.changes)
    changes_ = {{.kind = CrowdChange::Kind::kSetGoal,
                 .ids = {0},
                 .goal = "{min_m: [0, 0], max_m: [1, 1]}"}};
  frame_.changes = changes_;
  frame_.levels = levels_;
  if (options_.proximity) list_proximity();
  frame_.hash = hash_.value();
  frame_.persisting = pair_events_.persisting();
  frame_.counters = &counters_;
  frame_.times = &times_;
  ++next_frame_;
  return frame_;
}

RunEnd SyntheticRun::finish() {
  pair_events_.advance({});
  count(pair_events_.events());
  level();
  add_to_hash();
  RunEnd end;
  end.frames = next_frame_;
  end.utime_us = frame_.utime_us;
  end.events = pair_events_.events();
  end.begins = static_cast<uint64_t>(begins_);
  end.ends = static_cast<uint64_t>(ends_);
  end.hash = hash_.value();
  return end;
}

void SyntheticRun::play(Sink& sink, int frames) {
  sink.begin(info_);
  for (int i = 0; i < frames; ++i) sink.frame(info_, step());
  sink.end(info_, finish());
}

ScratchFile::ScratchFile(const std::string& suffix) {
  static int count = 0;
  path_ = std::filesystem::temp_directory_path() /
          ("throng_lcm_" + std::to_string(::getpid()) + "_" + std::to_string(count++) + suffix);
}

ScratchFile::~ScratchFile() {
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

std::vector<uint8_t> bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

void write_bytes(const std::filesystem::path& file, std::span<const uint8_t> bytes) {
  // A new file, because ext4 writes a truncated and refilled file to the disk at once.
  std::filesystem::remove(file);
  std::ofstream out(file, std::ios::binary);
  out.write(reinterpret_cast<const char*>(bytes.data()),
            static_cast<std::streamsize>(bytes.size()));
}

std::vector<MessageList::Message> messages_of(SyntheticRun& run, int frames,
                                              const EncoderOptions& options) {
  MessageList list;
  RunEncoder encoder(options, list);
  encoder.begin(run.info());
  for (int chunk = 0; chunk < encoder.target_state().description_chunks(); ++chunk)
    encoder.target_state().send_description_chunk(chunk);
  for (int i = 0; i < frames; ++i) encoder.frame(run.info(), run.step());
  encoder.end(run.info(), run.finish());
  encoder.target_state().send_last_checksums();
  return std::move(list.messages);
}

}  // namespace throng
