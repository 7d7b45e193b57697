#include "viewer/picture/recorded_frame.h"

#include <fmt/format.h>

#include "base/errors.h"
#include "lcm_io/codec/description.h"

namespace throng {

namespace {

Mesh floor_of(const run_description_t& run) {
  Mesh mesh;
  for (const polygon_t& polygon : run.floor)
    for (const FlatTriangle& triangle : triangles_of(to_polygon(polygon))) {
      const auto first = static_cast<int>(mesh.vertices.size());
      for (const Eigen::Vector2d& corner : triangle)
        mesh.vertices.emplace_back(static_cast<float>(corner.x()), static_cast<float>(corner.y()),
                                   0.0F);
      mesh.triangles.emplace_back(first, first + 1, first + 2);
    }
  return mesh;
}

}  // namespace

void require_people(const run_description_t& run, const std::string& where) {
  if (run.avatar_count == 0)
    throw InputError(where, "a run with people or robots",
                     fmt::format("scene '{}' without avatars", printable(run.scene)));
}

RecordedFrame::RecordedFrame(const std::filesystem::path& log, int64_t number)
    : log_(log), reader_(log) {
  advance_to(number);
}

void RecordedFrame::advance_to(int64_t number) {
  LogEvent event;
  while (last_frame_ < number && gaps_.next(reader_, event)) {
    // frame_stats_t is the last message of a frame.
    if (run_.take(event.channel, event.data) == RunReader::Update::kFrameStats)
      last_frame_ = run_.frame_stats()->frame;
  }
  if (run_.run() == nullptr)
    throw InputError(log_.string(), "a run's description", gaps_.found_no_description());
  require_people(*run_.run(), log_.string());
  if (last_frame_ < number) {
    const std::string missing = gaps_.describe(run_.run()->step_s);
    throw InputError(log_.string(), fmt::format("frame {}", number),
                     missing.empty() ? fmt::format("frames 0 to {}", last_frame_)
                                     : fmt::format("frames 0 to {} ({})", last_frame_, missing));
  }
  if (crowd().frame < 0) {
    const std::optional<int64_t> first = next_states();
    throw InputError(log_.string(), fmt::format("states at or before frame {}", number),
                     first ? fmt::format("the first at frame {}", *first) : "none");
  }
}

const Mesh& RecordedFrame::floor() {
  if (!floor_) floor_ = floor_of(*run_.run());
  return *floor_;
}

std::string RecordedFrame::describe_missing() {
  LogEvent event;
  while (gaps_.next(reader_, event)) continue;
  return run_.run() == nullptr ? "" : gaps_.describe(run_.run()->step_s);
}

std::optional<int64_t> RecordedFrame::next_states() {
  LogEvent event;
  MessageHeader header;
  while (gaps_.next(reader_, event))
    if (event.channel == name_of(Channel::kStates) &&
        read_header(Channel::kStates, event.data, header).empty() && header.frame > last_frame_)
      return header.frame;
  return std::nullopt;
}

}  // namespace throng
