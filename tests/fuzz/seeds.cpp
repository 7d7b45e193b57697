#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "base/files/archive.h"
#include "lcm_io/codec/log_format.h"
#include "lcm_io/codec/message_validation.h"
#include "lcm_io/codec/running_checksums.h"
#include "lcm_io/log/log_reader.h"
#include "lcm_io/log/log_sink.h"
#include "scenes/motion/box_motion.h"
#include "scenes/run/checkpoint.h"
#include "tests/avatars/mesh_seeds.h"
#include "tests/fuzz/targets.h"
#include "tests/lcm_io/synthetic_run.h"
#include "tests/recordings/recording_seeds.h"

namespace throng::fuzz {
namespace {

namespace fs = std::filesystem;

Bytes bytes_of(std::string_view text) { return {text.begin(), text.end()}; }

/// Files of a folder of the repository with this ending, in order of their names.
void add_files(const std::string& folder, const std::string& ending, size_t max_bytes,
               std::vector<Bytes>& out) {
  const fs::path path = fs::path(THRONG_SOURCE_DIR) / folder;
  std::vector<fs::path> files;
  if (fs::is_directory(path))
    for (const auto& entry : fs::directory_iterator(path))
      if (entry.is_regular_file() && entry.path().string().ends_with(ending) &&
          entry.file_size() <= max_bytes)
        files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    std::ifstream in(file, std::ios::binary);
    out.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  }
}

std::string repeated(std::string_view text, int times) {
  std::string out;
  for (int i = 0; i < times; ++i) out += text;
  return out;
}

/// A chain of links on which KDL recurses until the stack overflows.
std::string chain_urdf(int links) {
  std::string out = "<robot name=\"chain\"><link name=\"l0\"/>";
  for (int i = 1; i < links; ++i) {
    const std::string n = std::to_string(i);
    out.append("<link name=\"l").append(n).append("\"/><joint name=\"j").append(n);
    out.append("\" type=\"fixed\"><parent link=\"l").append(std::to_string(i - 1));
    out.append("\"/><child link=\"l").append(n).append("\"/></joint>");
  }
  return out + "</robot>";
}

void add_tri(std::vector<Bytes>& out) {
  add_files("tests/avatars/fixtures/tri", ".tri", 4096, out);
  for (const char* text :
       {"", "3 1\n0 0 0\n1 0 0\n0 1 0\n0 1 2\n", "2147483647 2147483647\n", "-1 -1\n",
        "4294967297 1\n0 0 0\n", "3 1\n1e999 0 0\n1 0 0\n0 1 0\n0 1 2\n",
        "3 1\nnan inf 0\n1 0 0\n0 1 0\n0 1 2\n", "3 1\n0 0 0\n1 0 0\n0 1 0\n0 1 99999999999\n"})
    out.push_back(bytes_of(text));
  out.push_back(bytes_of(repeated("9", 100'000)));
}

void add_urdf(std::vector<Bytes>& out) {
  add_files("tests/kinematics/fixtures", ".urdf", 16'384, out);
  // Inputs that crash tinyxml and KDL; between them, inputs just within the limits.
  out.push_back(bytes_of("<robot name=\"deep\">" + repeated("<a>", 200'000)));
  out.push_back(bytes_of("<robot name=\"deep\">" + repeated("<a>", 60) + repeated("</a>", 60) +
                         "<link name=\"l\"/></robot>"));
  for (const int links : {1, 256, 257, 10'000}) out.push_back(bytes_of(chain_urdf(links)));
  out.push_back(
      bytes_of("<robot name=\"" + repeated("n", 100'000) + "\"><link name=\"l\"/></robot>"));
  out.push_back(
      bytes_of("<robot><link name=\"a\"/><joint name=\"j\" type=\"fixed\"><parent "
               "link=\"a\"/><child link=\"a\"/></joint></robot>"));
}

void add_scenes(std::vector<Bytes>& out) {
  add_files("scenes/bundled", ".yaml", 16'384, out);
  out.push_back(bytes_of(repeated("[", 100'000)));
  out.push_back(bytes_of(repeated("{a: ", 10'000)));
  out.push_back(bytes_of("a: &a [x, x]\nb: &b [*a, *a]\nc: [*b, *b]\n"));
  out.push_back(bytes_of("name: x\nground: {min_m: [-1e308, -1e308], max_m: [1e308, 1e308]}\n"));
  out.push_back(bytes_of(
      "ground: {min_m: [0, 0], max_m: [9, 9]}\ngroups: [{count: 5, social_groups: {share: 1, "
      "pairs: 0, threes: 2, fours: 1e6}, spawn: {min_m: [1, 1], max_m: [8, 3]}, goals: "
      "[{min_m: [1, 6], max_m: [8, 8]}]}]\n"));
  out.push_back(
      bytes_of("ground: {min_m: [0, 0], max_m: [9, 9]}\ngroups: [{count: 5, spawn: {min_m: [1, 1], "
               "max_m: [8, 3]}, goals: [{min_m: [1, 6], max_m: [8, 8], capacity: 2, wait_s: {mean: "
               "3, std_dev: 1}, queue: {spacing_m: 1, line: [[4, 5], [4, 3], [8, 3]]}}]}]\n"));
  out.push_back(bytes_of("name: x\nstep_s: .nan\nduration_s: -.inf\nseed: -1\n"));
}

std::vector<MessageList::Message> a_run() {
  SyntheticRun run({.avatars = 3, .seed = 6, .pairs = 5, .crowd = SyntheticRun::Crowd::kRovers});
  return messages_of(run, 3, {.part_poses = true});
}

/// A controller's message about an avatar, for any channel.
template <class Message>
Bytes driving() {
  Message m{};
  m.schema = kSchema;
  m.count = 1;
  m.avatar = {0};
  m.x_m = m.y_m = m.z_m = {1};
  m.qw = m.qx = m.qy = m.qz = m.vx_mps = m.vy_mps = {0.5f};
  m.joint_position_count = 2;
  m.joint_positions = {0.25, 0.5};
  Bytes bytes(static_cast<size_t>(m.getEncodedSize()));
  m.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return packed(std::vector<std::pair<uint8_t, Bytes>>{{uint8_t{0}, bytes}});
}

/// People who are sent to a goal.
Bytes redirection() {
  crowd_change_t m{};
  m.schema = kSchema;
  m.chunk_count = 1;
  m.kind = 2;
  m.goal = "{min_m: [0, 0], max_m: [2, 2]}";
  m.count = 2;
  m.avatar = {0, 1};
  m.x_m = m.y_m = {0, 0};
  m.heading_rad = m.speed_mps = {0, 0};
  Bytes bytes(static_cast<size_t>(m.getEncodedSize()));
  m.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return packed(
      std::vector<std::pair<uint8_t, Bytes>>{{static_cast<uint8_t>(Channel::kChanges), bytes}});
}

void add_messages(std::vector<Bytes>& out) {
  out.push_back(redirection());
  out.push_back(driving<pose_command_t>());
  out.push_back(driving<step_reply_t>());
  std::vector<std::pair<uint8_t, Bytes>> all;
  for (const MessageList::Message& message : a_run()) {
    const auto channel = static_cast<uint8_t>(message.channel);
    all.emplace_back(channel, message.bytes);
    out.push_back(packed(std::vector<std::pair<uint8_t, Bytes>>{{channel, message.bytes}}));
    // Valid checksums reach the code behind their validation.
    if (message.channel == Channel::kChecksums) {
      Bytes hostile = message.bytes;
      for (size_t at = kHeaderBytes; at + 12 < hostile.size(); at += 97) {
        hostile[at] ^= 0x80;
        seal(hostile);
        out.push_back(packed(std::vector<std::pair<uint8_t, Bytes>>{{channel, hostile}}));
      }
    }
    // Counts that crash generated code, in the first field after the header.
    for (const int32_t count : {0x7fffffff, -1, INT32_MIN}) {
      Bytes hostile = message.bytes;
      if (hostile.size() < kHeaderBytes + 4) continue;
      put_big_endian(hostile.data() + kHeaderBytes, count);
      out.push_back(packed(std::vector<std::pair<uint8_t, Bytes>>{{channel, hostile}}));
    }
  }
  out.push_back(packed(all));
}

void add_logs(std::vector<Bytes>& out) {
  const ScratchFile file;
  SyntheticRun run({.avatars = 2, .seed = 6, .pairs = 5, .crowd = SyntheticRun::Crowd::kRovers});
  {
    LogSink sink(file.path());
    run.play(sink, 3);
  }
  const Bytes whole = throng::bytes_of(file.path());
  out.push_back(whole);
  out.emplace_back(whole.begin(), whole.begin() + static_cast<ptrdiff_t>(whole.size() * 2 / 3));
  // Damage that only checksums detect.
  for (size_t i = 1; i < 8; ++i) {
    Bytes flipped = whole;
    flipped[whole.size() * i / 8] ^= 1;
    out.push_back(flipped);
  }
  for (const int32_t length : {0x7fffffff, -1, INT32_MIN, 0})
    for (const size_t field : {size_t{20}, size_t{24}}) {
      Bytes hostile = whole;
      put_big_endian(hostile.data() + field, length);
      out.push_back(hostile);
    }
  out.push_back({});
  out.push_back({0xED, 0xA1, 0xDA, 0x01});
}

/// A log without checksums, which would detect nearly every change of a fuzzer.
Bytes without_checks(const std::filesystem::path& file) {
  const ScratchFile out;
  LogReader reader(file);
  LogFile log(out.path());
  LogEvent event;
  while (reader.next(event) == LogReader::Status::kEvent)
    if (event.channel != name_of(Channel::kChecksums))
      log.write(event.channel, event.stamp_us, event.data);
  log.close();
  return throng::bytes_of(out.path());
}

void add_culled_logs(std::vector<Bytes>& out) {
  add_logs(out);
  for (const bool comings : {false, true}) {
    const ScratchFile file;
    SyntheticRun run({.avatars = 4,
                      .seed = 7,
                      .pairs = 5,
                      .crowd = SyntheticRun::Crowd::kRovers,
                      .spread_m = 2,
                      .comings = comings});
    {
      LogSink sink(file.path());
      run.play(sink, 4);
    }
    out.push_back(without_checks(file.path()));
  }
}

void add_checkpoints(std::vector<Bytes>& out) {
  BoxDynamics world = BoxDynamics::of_kinds({}, std::vector<double>{0.2}, 3, 0);
  Archive state;
  world.archive(state);
  std::vector<PairKey> pairs = {{1, 2, 3, 4}, {1, 3, 0, 0}};
  state.resized(pairs, 10);
  out.push_back(state.bytes());
  out.push_back(format_checkpoint({7, 8, state.bytes()}));
  out.push_back(format_checkpoint({0, 0, {}}));
  Bytes hostile = state.bytes();
  std::fill_n(hostile.begin(), 8, 0xff);
  out.push_back(hostile);
}

void add_meshes(std::vector<Bytes>& out) {
  const auto add = [&](std::string_view extension, const Bytes& file) {
    const auto* at = std::find(std::begin(kMeshExtensions), std::end(kMeshExtensions), extension);
    out.push_back({static_cast<uint8_t>(at - std::begin(kMeshExtensions))});
    out.back().insert(out.back().end(), file.begin(), file.end());
  };
  for (const MeshSeed& seed : mesh_seeds()) {
    add(seed.extension, seed.bytes);
    // Truncated within its vertices: assimp reads beyond its array.
    if (seed.name == "ply_binary")
      add(seed.extension, Bytes(seed.bytes.begin(), seed.bytes.begin() + 400));
  }
}

void add_recordings(std::vector<Bytes>& out) {
  for (const std::string& seed : recording_seeds())
    for (const char options : {'\0', '\3'}) out.push_back(bytes_of(options + seed));
}

void add_areas(std::vector<Bytes>& out) {
  for (const char* area :
       {"POLYGON ((-2 6, -2 0, 2 0, 2 6, 10 6, 10 10, -10 10, -10 6, -2 6))",
        "MULTIPOLYGON (((0 0, 9 0, 9 9, 0 9), (1 1, 2 1, 2 2)), ((20 0, 29 0, 29 9)))",
        "GEOMETRYCOLLECTION (POLYGON Z ((0 0 1, 1 0 1, 1 1 1)), POLYGON EMPTY)",
        "LINESTRING (0 0, 1 1)"})
    out.push_back(bytes_of(area));
}

void add_plans(std::vector<Bytes>& out) {
  constexpr std::string_view kDrawing =
      "0 SECTION 2 HEADER 9 $INSUNITS 70 5 0 ENDSEC 0 SECTION 2 TABLES 0 TABLE 2 LAYER 0 LAYER 2 "
      "WALL 70 0 62 7 0 ENDTAB 0 ENDSEC 0 SECTION 2 BLOCKS 0 BLOCK 2 PILLAR 10 0 20 0 0 CIRCLE 8 0 "
      "10 0 20 0 40 30 0 ENDBLK 0 ENDSEC 0 SECTION 2 ENTITIES 0 LWPOLYLINE 8 FLOOR 90 4 70 1 10 0 "
      "20 0 10 900 20 0 42 0.5 10 900 20 600 10 0 20 600 0 LINE 8 WALL 10 0 20 0 11 300 21 0 0 ARC "
      "8 WALL 10 300 20 100 40 100 50 270 51 0 0 INSERT 8 COLUMN 2 PILLAR 10 500 20 300 41 2 50 30 "
      "0 POLYLINE 8 EXIT 66 1 70 1 0 VERTEX 10 0 20 0 0 VERTEX 10 90 20 0 0 VERTEX 10 90 20 90 0 "
      "SEQEND 0 ENDSEC 0 EOF ";
  std::string drawing(kDrawing);
  std::replace(drawing.begin(), drawing.end(), ' ', '\n');
  const std::string geojson =
      R"({"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {"layer": )"
      R"("floor"}, "geometry": {"type": "MultiPolygon", "coordinates": [[[[0, 0], [9, 0], [9, 9], )"
      R"([0, 0]]], [[[20, 0], [29, 0], [29, 9], [20, 0]]]]}}, {"type": "Feature", "properties": )"
      R"(null, "geometry": {"type": "LineString", "coordinates": [[0, 0], [5, 0], [5, 5]]}}]})";
  const std::string wkt =
      "POLYGON ((0 0, 10 0, 10 6, 0 6, 0 0), (4 2, 4 3, 5 3, 5 2, 4 2))\n"
      "MULTIPOLYGON (((20 0, 30 0, 30 9)), ((20 10, 30 10, 30 19)))\n";
  const std::string geometry =
      "<geometry version=\"0.8\" unit=\"m\"><rooms><room id=\"0\"><subroom id=\"0\"><polygon>"
      "<vertex px=\"10\" py=\"4\"/><vertex px=\"10\" py=\"6\"/><vertex px=\"0\" py=\"6\"/>"
      "<vertex px=\"0\" py=\"0\"/><vertex px=\"10\" py=\"0\"/></polygon></subroom></room></rooms>"
      "<transitions><transition id=\"1\" room1_id=\"0\" subroom1_id=\"0\" room2_id=\"-1\" "
      "subroom2_id=\"-1\"><vertex px=\"10\" py=\"0\"/><vertex px=\"10\" py=\"4\"/></transition>"
      "</transitions></geometry>";
  const std::string scenario =
      R"({"scenario": {"topography": {"attributes": {"bounds": {"x": 0, "y": 0, "width": 20, )"
      R"("height": 10}, "boundingBoxWidth": 0.5, "bounded": true}, "obstacles": [{"id": 1, )"
      R"("shape": {"type": "POLYGON", "points": [{"x": 5, "y": 5}, {"x": 6, "y": 5}, {"x": 6, )"
      R"("y": 7}]}}], "targets": [{"id": 2, "shape": {"type": "CIRCLE", "radius": 1, "center": )"
      R"({"x": 18, "y": 7}}}], "sources": [{"id": 3, "shape": {"type": "RECTANGLE", "x": 2, "y": )"
      R"(4, "width": 1, "height": 2}}], "stairs": [{"id": 4}]}}})";
  const std::string map =
      "image: map.pgm\nresolution: 0.05\norigin: [-1, 2, 0.5]\nnegate: 0\noccupied_thresh: 0.65\n"
      "free_thresh: 0.196\n";
  for (const std::string& each : {drawing, geojson, wkt, geometry, scenario, map})
    for (const char options : {'\1', '\3'}) out.push_back(bytes_of(options + each));
}

void add_starts(std::vector<Bytes>& out) {
  for (const std::string_view text :
       {"x_m,y_m\n1,2\n3,4.5\n", "# people\ny_m, heading_rad ,x_m,speed_mps\r\n1,-1.5,2,0\r\n\r\n",
        "x_m,y_m\n1,nan\n", "x_m,x_m,y_m\n"})
    out.emplace_back(text.begin(), text.end());
}

void add_studies(std::string_view target, std::vector<Bytes>& out) {
  const auto add = [&](std::string_view text) { out.emplace_back(text.begin(), text.end()); };
  if (target == "study_table") {
    add("run,runs,study,scene,people\n1,2,aa,\"a, \"\"b\"\"\",5\n2,2,aa,c,6\n");
    add("run,runs,study\n1,1,aa\n");
    return;
  }
  add("scenes: [corridor]\nseeds: [1, 2]\nseconds: 2\nparameters:\n  avatars: [5, 10]\n"
      "  groups.*.desired_speed_mps.mean: {from: 1, to: 1.4, step: 0.2}\n");
  add("scenes: [corridor]\nexact: true\nparameters:\n  latin_hypercube: {samples: 4, seed: 2, "
      "parameters: "
      "{groups.1.count: {from: 1, to: 9, integer: true}, steering: [heuristic, orca]}}\n");
}

}  // namespace

Bytes packed(std::span<const std::pair<uint8_t, Bytes>> messages) {
  Bytes out;
  for (const auto& [channel, bytes] : messages) {
    const size_t size = std::min<size_t>(bytes.size(), 0xffff);
    out.push_back(channel);
    out.push_back(static_cast<uint8_t>(size >> 8));
    out.push_back(static_cast<uint8_t>(size));
    out.insert(out.end(), bytes.begin(), bytes.begin() + static_cast<ptrdiff_t>(size));
  }
  return out;
}

std::vector<Bytes> seeds_of(std::string_view target) {
  std::vector<Bytes> out;
  // Inputs that fuzzing has found; all are kept.
  add_files("tests/fuzz/found/" + std::string(target), "", size_t{1} << 20, out);
  if (target == "tri") add_tri(out);
  if (target == "urdf") add_urdf(out);
  if (target == "scene") add_scenes(out);
  if (target == "starts") add_starts(out);
  if (target == "study" || target == "study_table") add_studies(target, out);
  if (target == "messages") add_messages(out);
  if (target == "log") add_logs(out);
  if (target == "culled_log") add_culled_logs(out);
  if (target == "checkpoint") add_checkpoints(out);
  if (target == "recording") add_recordings(out);
  if (target == "wkt") add_areas(out);
  if (target == "plan") add_plans(out);
  if (target == "mesh") add_meshes(out);
  return out;
}

}  // namespace throng::fuzz
