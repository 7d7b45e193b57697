#include "tests/fuzz/targets.h"

#include <algorithm>
#include <filesystem>

#include "analysis/trajectories/walkable_area.h"
#include "avatars/avatars.h"
#include "avatars/mesh/mesh_file.h"
#include "avatars/mesh/tri.h"
#include "base/errors.h"
#include "kinematics/kdl_tree.h"
#include "lcm_io/codec/encoder.h"
#include "lcm_io/codec/message_validation.h"
#include "lcm_io/codec/run_reader.h"
#include "lcm_io/log/log_check.h"
#include "lcm_io/replay/log_motion.h"
#include "scenes/file/scene.h"
#include "scenes/motion/box_motion.h"
#include "scenes/run/checkpoint.h"
#include "tests/fuzz/target_tools.h"
#include "tests/kinematics/finite_poses.h"

namespace throng::fuzz {
namespace {

void expect_sound(const Mesh& mesh) {
  for (const Eigen::Vector3f& vertex : mesh.vertices)
    promise(vertex.allFinite(), "finite vertices");
  for (const Eigen::Vector3i& triangle : mesh.triangles)
    promise(
        triangle.minCoeff() >= 0 && triangle.maxCoeff() < static_cast<int>(mesh.vertices.size()),
        "indices in range");
}

}  // namespace

bool tri(std::span<const uint8_t> input) {
  try {
    const TriFile file = parse_tri(text_of(input), "fuzz.tri");
    const std::string written = format_tri(file.mesh);
    promise(format_tri(parse_tri(written, "again.tri").mesh) == written, "an unchanged mesh");
    expect_sound(file.mesh);
    return true;
  } catch (const InputError& error) {
    expect_words(error);
    return false;
  }
}

bool urdf(std::span<const uint8_t> input) {
  try {
    const Robot robot = parse_urdf(text_of(input), "fuzz.urdf");
    promise(robot.links.size() == robot.joints.size() + 1, "a tree");
    for (const Joint& joint : robot.joints)
      promise(joint.parent_link < joint.child_link && joint.lower <= joint.upper &&
                  std::abs(joint.axis.norm() - 1) < 1e-9,
              "valid joints");
    promise(has_finite_poses(robot), "finite poses");
    promise(to_kdl(robot).getNrOfSegments() == robot.joints.size(), "a KDL tree of all links");
    return true;
  } catch (const InputError& error) {
    expect_words(error);
    return false;
  }
}

bool scene(std::span<const uint8_t> input) {
  const File file("scene.yaml", input);
  try {
    const Scene read = load_scene(file.path().string());
    promise(read.step_s > 0 && read.duration_s > 0, "a positive duration");
    promise(read.box || !read.groups.empty() || !read.obstacles.empty(), "a non-empty scene");
    return true;
  } catch (const InputError& error) {
    expect_words(error);
    return false;
  }
}

bool starts(std::span<const uint8_t> input) {
  const File file("starts.csv", input);
  try {
    const Scene read = read_scene_text(
        "ground: {min_m: [0, 0], max_m: [9, 9]}\ngroups:\n  - goals: [{min_m: [1, 1], max_m: [2, "
        "2]}]\n    positions_m: {file: " +
            file.path().string() + "}\n",
        "scene");
    const Group& group = read.groups.front();
    const size_t count = group.starts.positions_m.size();
    promise(count > 0 && static_cast<size_t>(group.count) == count, "an agent per row");
    for (const std::vector<double>* column : {&group.starts.headings_rad, &group.starts.speeds_mps})
      promise(column->empty() || column->size() == count, "a value per row");
    for (const Eigen::Vector2d& place_m : group.starts.positions_m)
      promise(place_m.allFinite(), "finite places");
    return true;
  } catch (const InputError& error) {
    expect_words(error);
    return false;
  }
}

namespace {

/// A controller's message about avatars, if it is one.
template <class Message>
bool is_driving(std::span<const uint8_t> bytes) {
  Message message;
  if (!decode(bytes, message).empty()) return false;
  promise(message.avatar.size() == message.x_m.size() &&
              message.avatar.size() == message.vy_mps.size() && message.schema == kSchema,
          "poses for all avatars of a message");
  return true;
}

}  // namespace

bool messages(std::span<const uint8_t> input) {
  RunReader reader;
  bool is_accepted = false;
  std::vector<PartPose> poses;
  while (input.size() > 3) {
    const Channel channel = kAllChannels[input[0] % std::size(kAllChannels)];
    const size_t size = std::min<size_t>(size_t{input[1]} << 8 | input[2], input.size() - 3);
    const std::span<const uint8_t> message = input.subspan(3, size);
    input = input.subspan(3 + size);
    const bool is_sound = check_message(channel, message).empty() ||
                          is_driving<pose_command_t>(message) || is_driving<step_reply_t>(message);
    const auto update = reader.take(name_of(channel), message);
    is_accepted = is_accepted || is_sound;
    if (update != RunReader::Update::kState || reader.run()->avatar_count == 0) continue;
    try {
      reader.part_poses(0, poses);
    } catch (const InputError& error) {
      expect_words(error);
    }
  }
  return is_accepted;
}

bool log(std::span<const uint8_t> input) {
  const File file("a.lcmlog", input);
  const File repaired("b.lcmlog");
  try {
    const LogReport report = check_log(file.path());
    promise(report.sound_bytes <= input.size(), "at most all bytes are sound");
    describe_log(file.path());
    const int64_t messages = repair_log(file.path(), repaired.path());
    if (messages == 0) return false;
    const LogReport again = check_log(repaired.path());
    promise(!again.torn && !again.damaged && again.log_events == messages, "a repaired log");
    promise(again.damage.empty(), "a repaired log without damage");
    return report.is_sound();
  } catch (const InputError& error) {
    expect_words(error);
    return false;
  }
}

bool culled_log(std::span<const uint8_t> input) {
  const File file("c.lcmlog", input);
  try {
    const LogRun run = read_log_run(file.path());
    promise(run.facts.frames >= 1 && run.scene.step_s > 0 && run.scene.duration_s > 0,
            "a positive duration");
    SimulationOptions options;
    options.motion = run.motion;
    Simulation simulation(run.scene, options);
    for (int64_t i = 0; i < std::min<int64_t>(run.facts.frames, 5); ++i)
      for (const RootPose& root : simulation.step().roots)
        promise(root.position_m.allFinite(), "finite positions");
    for (const Polygon& piece : walkable_area(run.scene))
      promise(piece.outline.size() >= 3, "pieces of the ground with an outline");
    require_encodable(simulation.info(), true);
    return true;
  } catch (const InputError& error) {
    expect_words(error);
    return false;
  }
}

bool checkpoint_file(std::span<const uint8_t> input) {
  try {
    const Checkpoint read = parse_checkpoint(input, "fuzz.checkpoint");
    promise(format_checkpoint(read) == Bytes(input.begin(), input.end()), "an unchanged file");
    return true;
  } catch (const InputError& error) {
    expect_words(error);
    return false;
  }
}

bool checkpoint_state(std::span<const uint8_t> input) {
  static BoxDynamics world = BoxDynamics::of_kinds({}, std::vector<double>{0.2}, 3, 0);
  try {
    Archive in(input, "state");
    world.archive(in);
    std::vector<PairKey> pairs;
    in.resized(pairs, size_t{1} << 40);
    in.expect_end();
    for (int i = 0; i < 5; ++i) world.step();
    for (const Eigen::Vector3d& position : world.positions_m())
      promise(position.allFinite(), "finite positions");
    return true;
  } catch (const InputError& error) {
    expect_words(error);
    return false;
  }
}

/// The file itself, and its bytes as a state with a valid checksum.
bool checkpoint(std::span<const uint8_t> input) {
  const bool is_file = checkpoint_file(input), is_state = checkpoint_state(input);
  return is_file || is_state;
}

/// In the sandbox, as the product reads it: a crash or a hang of assimp is an error.
bool mesh(std::span<const uint8_t> input) {
  if (input.empty()) return false;
  const std::string_view extension = kMeshExtensions[input[0] % std::size(kMeshExtensions)];
  const File file(("mesh" + std::string(extension)).c_str(), input.subspan(1));
  constexpr SandboxLimits kQuick = {
      .cpu_s = 1, .wall_s = 0.5, .max_memory_bytes = 512 << 20, .max_result_bytes = 64 << 20};
  try {
    const Mesh read = read_mesh(file.path(), kQuick);
    promise(!read.triangles.empty(), "triangles");
    expect_sound(read);
    return true;
  } catch (const InputError& error) {
    expect_words(error);
    return false;
  }
}

}  // namespace throng::fuzz
