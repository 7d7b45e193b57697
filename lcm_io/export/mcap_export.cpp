#include "lcm_io/export/mcap_export.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "base/portable_math.h"
#include "lcm_io/export/foxglove.h"
#include "lcm_io/export/mcap_writer.h"

namespace throng {
namespace {

/// Colours of groups, see base/figure.h.
constexpr foxglove::Colour kColours[] = {{0.27, 0.47, 0.67}, {0.93, 0.40, 0.47},
                                         {0.13, 0.53, 0.20}, {0.80, 0.73, 0.27},
                                         {0.67, 0.20, 0.47}, {0.40, 0.80, 0.93}};
constexpr foxglove::Colour kObstacle = {0.6, 0.6, 0.6};
constexpr foxglove::Colour kContact = {0.9, 0.1, 0.1, 0.8};
constexpr double kMarker_m = 0.12;

uint64_t nanoseconds(int64_t utime_us) { return static_cast<uint64_t>(utime_us) * 1000; }

Eigen::Vector3d middle_of(const mesh_t& mesh) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (size_t i = 0; i < mesh.coordinates_m.size(); ++i)
    sum[static_cast<Eigen::Index>(i % 3)] += static_cast<double>(mesh.coordinates_m[i]);
  return mesh.coordinates_m.empty() ? sum
                                    : sum / (static_cast<double>(mesh.coordinates_m.size()) / 3);
}

void add_item(std::string& list, const std::string& item) {
  if (!list.empty()) list += ',';
  list += item;
}

class Exporter {
 public:
  Exporter(const std::filesystem::path& file, const McapExportOptions& options)
      : writer_(file),
        every_us_(static_cast<int64_t>(std::llround(1e6 / options.poses_hz))),
        transforms_(
            writer_.add_topic("/tf", "foxglove.FrameTransforms", foxglove::kFrameTransformsSchema)),
        scene_(writer_.add_topic("/scene", "foxglove.SceneUpdate", foxglove::kSceneUpdateSchema)),
        markers_(writer_.add_topic("/contact_markers", "foxglove.SceneUpdate",
                                   foxglove::kSceneUpdateSchema)),
        contacts_(writer_.add_topic("/contacts", "throng.Contact", foxglove::kContactSchema)) {}

  void take(RunReader& run, RunReader::Update update, const MessageHeader* header) {
    // Events need the bodies of a description, which may be damaged at first.
    if (run.run() == nullptr) return;
    switch (update) {
      case RunReader::Update::kRun:
        present_.assign(static_cast<size_t>(run.run()->avatar_count), 0);
        obstacles(*run.run());
        break;
      case RunReader::Update::kEvents:
        // The last message of the frame before may be missing.
        if (!waiting_.empty() && header->frame != frame_) end_frame(run);
        for (const PairEvent& event : run.new_events()) waiting_.push_back(event);
        time_us_ = header->utime_us;
        frame_ = header->frame;
        break;
      case RunReader::Update::kState:
        has_state_ = true;
        break;
      case RunReader::Update::kFrameStats:
      case RunReader::Update::kEnd:
        end_frame(run);
        break;
      default:
        break;
    }
  }

  McapExport finish(RunReader& run) {
    if (run.run() != nullptr) end_frame(run);
    writer_.finish();
    out_.bytes = writer_.bytes();
    return out_;
  }

 private:
  void end_frame(RunReader& run) {
    if (std::exchange(has_state_, false) && run.state().utime_us >= next_us_) {
      // States need not lie at multiples of the export period.
      next_us_ = run.state().utime_us - run.state().utime_us % every_us_ + every_us_;
      poses(run);
    }
    if (!waiting_.empty()) contacts(run);
    waiting_.clear();
  }

  void obstacles(const run_description_t& run) {
    std::string entities;
    for (const obstacle_t& obstacle : run.obstacles) {
      const SinCos turn = sin_cos(obstacle.heading_rad);
      std::vector<float> turned = obstacle.mesh.coordinates_m;
      for (size_t i = 0; i + 2 < turned.size(); i += 3) {
        const double x = static_cast<double>(turned[i]), y = static_cast<double>(turned[i + 1]);
        turned[i] = static_cast<float>(turn.cos * x - turn.sin * y + obstacle.centre_m[0]);
        turned[i + 1] = static_cast<float>(turn.sin * x + turn.cos * y + obstacle.centre_m[1]);
        turned[i + 2] += static_cast<float>(obstacle.centre_m[2]);
      }
      add_item(entities,
               foxglove::entity(
                   0, "world", "obstacle " + printable(obstacle.name),
                   foxglove::triangles(turned.data(), turned.size(), obstacle.mesh.indices.data(),
                                       obstacle.mesh.indices.size(), 1, kObstacle)));
    }
    if (!entities.empty()) writer_.add(scene_, 0, foxglove::scene_update("", entities));
  }

  static std::string frame_name(const run_description_t& run, uint32_t body, size_t part) {
    return body_name(run, body) + "/" + part_name(run, body, static_cast<uint32_t>(part));
  }

  /// Writes meshes of new avatars, and the positions of all.
  void poses(RunReader& reader) {
    const run_description_t& run = *reader.run();
    const CrowdState& state = reader.state();
    std::string transforms, deletions, entities;
    for (size_t id = 0; id < present_.size(); ++id) {
      const bool is_there = state.present.empty() || state.present[id] != 0;
      const auto body = static_cast<uint32_t>(id);
      const model_t& model = run.models[static_cast<size_t>(run.model_of_avatar[id])];
      if (is_there) reader.part_poses(static_cast<int>(id), poses_);
      for (size_t part = 0; part < model.parts.size(); ++part) {
        if (!is_there && present_[id] == 0) break;
        const std::string name = frame_name(run, body, part);
        if (!is_there) {
          add_item(deletions, foxglove::deletion(state.utime_us, name));
          continue;
        }
        Eigen::Isometry3d place = to_isometry(poses_[part]);
        place.translation() += state.roots[id].position_m;
        foxglove::add_transform(transforms, state.utime_us, name, place);
        if (present_[id] == 0) add_item(entities, mesh_entity(run, state, id, part, name));
      }
      present_[id] = is_there ? 1 : 0;
    }
    const uint64_t time_ns = nanoseconds(state.utime_us);
    if (!deletions.empty() || !entities.empty())
      writer_.add(scene_, time_ns, foxglove::scene_update(deletions, entities));
    writer_.add(transforms_, time_ns, fmt::format(R"({{"transforms":[{}]}})", transforms));
    ++out_.frames;
  }

  static std::string mesh_entity(const run_description_t& run, const CrowdState& state, size_t id,
                                 size_t part, const std::string& name) {
    const mesh_t& mesh = run.models[static_cast<size_t>(run.model_of_avatar[id])].parts[part].mesh;
    const auto group = static_cast<size_t>(run.group_of_avatar[id]);
    return foxglove::entity(
        state.utime_us, name, name,
        foxglove::triangles(mesh.coordinates_m.data(), mesh.coordinates_m.size(),
                            mesh.indices.data(), mesh.indices.size(),
                            static_cast<double>(run.scale_of_avatar[id]),
                            kColours[group % std::size(kColours)]));
  }

  /// Returns the middle of a part or of a whole body; nothing for obstacles or without states.
  std::optional<Eigen::Vector3d> place_of(RunReader& reader, uint32_t body, uint32_t part) {
    const CrowdState& state = reader.state();
    if (body >= state.roots.size() || state.frame < 0) return {};
    if (part == kWholeBody) return state.roots[body].position_m + Eigen::Vector3d(0, 0, 1);
    const run_description_t& run = *reader.run();
    const mesh_t& mesh =
        run.models[static_cast<size_t>(run.model_of_avatar[body])].parts[part].mesh;
    reader.part_poses(static_cast<int>(body), poses_);
    const Eigen::Isometry3d place = to_isometry(poses_[part]);
    return state.roots[body].position_m +
           place * (static_cast<double>(run.scale_of_avatar[body]) * middle_of(mesh));
  }

  void contacts(RunReader& reader) {
    const run_description_t& run = *reader.run();
    std::string deletions, entities;
    for (const PairEvent& event : waiting_) {
      const PairKey pair = event.pair;
      const bool begins = event.kind == EventKind::kBegin;
      ++(begins ? out_.begins : out_.ends);
      writer_.add(
          contacts_, nanoseconds(time_us_),
          fmt::format(
              R"({{"frame":{},"time_s":{:.6f},"kind":"{}","body_a":{},"body_b":{},"name_a":{},"name_b":{},"part_a":{},"part_b":{}}})",
              frame_, 1e-6 * static_cast<double>(time_us_), begins ? "begin" : "end", pair.a(),
              pair.b(), foxglove::json_text(body_name(run, pair.a())),
              foxglove::json_text(body_name(run, pair.b())),
              foxglove::json_text(part_name(run, pair.a(), pair.part_a())),
              foxglove::json_text(part_name(run, pair.b(), pair.part_b()))));
      const std::string id =
          fmt::format("{}/{} {}/{}", pair.a(), pair.part_a(), pair.b(), pair.part_b());
      if (!begins) {
        add_item(deletions, foxglove::deletion(time_us_, id));
        continue;
      }
      const auto a = place_of(reader, pair.a(), pair.part_a());
      const auto b = place_of(reader, pair.b(), pair.part_b());
      if (!a && !b) continue;
      const Eigen::Vector3d middle = a && b ? Eigen::Vector3d(0.5 * (*a + *b)) : a ? *a : *b;
      add_item(entities, foxglove::entity(time_us_, "world", id,
                                          foxglove::sphere(middle, kMarker_m, kContact)));
    }
    if (!deletions.empty() || !entities.empty())
      writer_.add(markers_, nanoseconds(time_us_), foxglove::scene_update(deletions, entities));
  }

  McapWriter writer_;
  int64_t every_us_;
  uint16_t transforms_, scene_, markers_, contacts_;
  McapExport out_;
  bool has_state_ = false;
  int64_t next_us_ = 0, time_us_ = 0, frame_ = 0;
  std::vector<uint8_t> present_;
  std::vector<PairEvent> waiting_;
  std::vector<PartPose> poses_;
};

}  // namespace

McapExport export_mcap(ExportedLog& log, const std::filesystem::path& file,
                       const McapExportOptions& options,
                       const std::function<bool(double share)>& keep_going) {
  Exporter exporter(file, options);
  bool is_stopped = false;
  while (!is_stopped && log.next()) {
    log.require_one_run();
    exporter.take(log.run(), log.update(), log.run().header());
    is_stopped = !keep_going(log.share_read());
  }
  McapExport out = exporter.finish(log.run());
  out.missing = is_stopped ? "stopped" : log.missing();
  return out;
}

}  // namespace throng
