#include "bench/exchange.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <compare>
#include <fstream>
#include <limits>
#include <optional>
#include <string_view>

#include "avatars/mesh/tri.h"
#include "base/errors.h"
#include "base/files/atomic_file.h"
#include "base/text.h"
#include "bench/crowd.h"
#include "culling/triangles/triangle_bvh.h"

namespace throng::bench {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kBoxHeader = "frame,a,b";
constexpr std::string_view kPartHeader = "frame,part_a,part_b";

constexpr const char* kReadme =
    R"(Frames of {0} people with {1} parts each, written by `throng bench --export`.

A part and its box have one number, from 0 in each frame: part p of avatar i is number {1} i + p.
Lengths are metres, x and y on the ground, z up. Numbers read back to the same bit.

boxes.csv     frame,box,avatar,part,min_x_m,min_y_m,min_z_m,max_x_m,max_y_m,max_z_m
              Axis-aligned, closed: boxes that touch overlap. Single precision.
poses.csv     frame,box,scale,r00,r01,r02,r10,r11,r12,r20,r21,r22,x_m,y_m,z_m
              A point p of the part's shape lies at R (scale p) + (x, y, z).
parts.csv     part,name,file: the shapes, part_NN.tri. A .tri holds the number of vertices and
              of triangles, then the vertices, then the triangles, counted from 0.
pairs.csv     frame,a,b: every pair of overlapping boxes of different avatars, a < b, sorted.
touching.csv  frame,part_a,part_b: of these, the parts whose triangles touch or of which one lies
              inside the other.

Write the pairs of another program into a file of this folder, with the header of pairs.csv or of
touching.csv, in any order. `throng bench --check FILE` compares them. Boxes must be exactly those
of pairs.csv. Parts must include all of touching.csv and none whose boxes are apart.
)";

struct FramePair {
  uint32_t frame = 0;
  BoxPair pair{};
  auto operator<=>(const FramePair&) const = default;
};

struct Tables {
  std::string boxes = "frame,box,avatar,part,min_x_m,min_y_m,min_z_m,max_x_m,max_y_m,max_z_m\n";
  std::string poses = "frame,box,scale,r00,r01,r02,r10,r11,r12,r20,r21,r22,x_m,y_m,z_m\n";
  std::string pairs = fmt::format("{}\n", kBoxHeader);
  std::string touching = fmt::format("{}\n", kPartHeader);

  void add_frame(int frame, const BoxList& list, const std::vector<PartPose>& part_poses,
                 const BodiesView& bodies) {
    for (size_t i = 0; i < list.boxes.size(); ++i) {
      const size_t avatar = i / list.parts;
      const Box& box = list.boxes[i];
      append(boxes, "{},{},{},{}", frame, i, avatar, i % list.parts);
      for (const float value : box.min_m) append(boxes, ",{}", value);
      for (const float value : box.max_m) append(boxes, ",{}", value);
      boxes += '\n';
      append(poses, "{},{},{}", frame, i, bodies.scales[avatar]);
      const auto& rows = part_poses[i].rows;
      for (const auto& row : rows)
        for (int column = 0; column < 3; ++column) append(poses, ",{}", row[column]);
      for (int axis = 0; axis < 3; ++axis)
        append(poses, ",{}",
               bodies.roots[avatar].position_m[axis] + static_cast<double>(rows[axis][3]));
      poses += '\n';
    }
  }
};

void write(const fs::path& file, const std::string& text) {
  write_file_atomically(file, text, {.what = "the exported frames"});
}

void write_shapes(const Model& model, const fs::path& folder) {
  std::string parts = "part,name,file\n";
  for (size_t part = 0; part < model.parts.size(); ++part) {
    const std::string name = fmt::format("part_{:02}.tri", part);
    write(folder / name, format_tri(model.parts[part].mesh));
    append(parts, "{},{},{}\n", part, csv_field(model.parts[part].name), name);
  }
  write(folder / "parts.csv", parts);
}

/// PairFile reads a header and lines of three whole numbers.
class PairFile {
 public:
  explicit PairFile(const fs::path& file) : name_(file.string()), in_(file) {
    if (!in_ || fs::is_directory(file)) throw InputError(name_, "a readable file of pairs", "none");
    std::getline(in_, header_);
    strip(header_);
    if (header_ != kBoxHeader && header_ != kPartHeader)
      throw InputError(at_line(name_, 1), fmt::format("{} or {}", kBoxHeader, kPartHeader),
                       fmt::format("'{}'", header_.substr(0, 40)));
  }
  bool are_boxes() const { return header_ == kBoxHeader; }

  std::vector<FramePair> read() {
    std::vector<FramePair> out;
    std::string line;
    for (int number = 2; std::getline(in_, line); ++number) {
      strip(line);
      if (!line.empty()) out.push_back(pair_of(line, number));
    }
    std::sort(out.begin(), out.end());
    return out;
  }

 private:
  static void strip(std::string& line) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
  }
  FramePair pair_of(const std::string& line, int number) const {
    std::array<uint32_t, 3> values{};
    const char* at = line.data();
    const char* const end = at + line.size();
    for (size_t i = 0; i < values.size(); ++i) {
      const auto [next, error] = std::from_chars(at, end, values[i]);
      const bool is_last = i + 1 == values.size();
      if (error != std::errc() || (is_last ? next != end : next == end || *next != ','))
        throw InputError(at_line(name_, number), "three whole numbers, FRAME,A,B",
                         fmt::format("'{}'", line.substr(0, 40)));
      at = next + 1;
    }
    const auto [low, high] = std::minmax(values[1], values[2]);
    return {values[0], {low, high}};
  }

  std::string name_, header_;
  std::ifstream in_;
};

/// PartNames translates numbers of parts into names.
class PartNames {
 public:
  explicit PartNames(const fs::path& folder) {
    std::ifstream in(folder / "parts.csv");
    std::string line;
    std::getline(in, line);
    while (std::getline(in, line)) {
      const size_t begin = line.find(',') + 1, end = line.rfind(',');
      names_.push_back(end > begin ? line.substr(begin, end - begin) : line);
    }
  }
  std::string of(const FramePair& found) const {
    const auto named = [&](uint32_t i) {
      return names_.empty()
                 ? fmt::format("{}", i)
                 : fmt::format("{} ({} of {})", i, names_[i % names_.size()], i / names_.size());
    };
    return fmt::format("frame {}, {} and {}", found.frame, named(found.pair.a),
                       named(found.pair.b));
  }

 private:
  std::vector<std::string> names_;
};

std::vector<FramePair> without(const std::vector<FramePair>& all,
                               const std::vector<FramePair>& some) {
  std::vector<FramePair> out;
  std::set_difference(all.begin(), all.end(), some.begin(), some.end(), std::back_inserter(out));
  return out;
}

}  // namespace

std::vector<std::string> exported_files() {
  return {"README.txt", "boxes.csv",    "poses.csv", "parts.csv",
          "pairs.csv",  "touching.csv", "part_*.tri"};
}

ExportedFrames export_frames(BenchOptions options, int stride, const fs::path& folder,
                             const Progress& progress) {
  const std::unique_ptr<Crowd> crowd = make_crowd(options);
  const auto type = crowd->body_type();
  std::vector<TriangleBvh> surfaces;
  for (const PartShape& part : type->parts()) surfaces.emplace_back(part.points, part.triangles);
  CrowdBoxes boxes(*crowd, type);
  ExportedFrames out{options.frames, crowd->count(), type->part_count()};
  Tables tables;
  TriangleCounters counters;
  for (int frame = 0; frame < options.frames; ++frame) {
    for (int step = 0; step < stride; ++step) crowd->advance();
    const BoxList list = boxes.compute();
    const BodiesView bodies = crowd->view();
    tables.add_frame(frame, list, boxes.poses(), bodies);
    for (const BoxPair& pair : reference_pairs(list)) {
      append(tables.pairs, "{},{},{}\n", frame, pair.a, pair.b);
      ++out.box_pairs;
      const uint32_t a = pair.a / list.parts, b = pair.b / list.parts;
      const Eigen::Vector3f a_to_b =
          (bodies.roots[b].position_m - bodies.roots[a].position_m).cast<float>();
      if (!solids_touch(surfaces[pair.a % list.parts], boxes.poses()[pair.a], bodies.scales[a],
                        surfaces[pair.b % list.parts], boxes.poses()[pair.b], bodies.scales[b],
                        a_to_b, counters))
        continue;
      append(tables.touching, "{},{},{}\n", frame, pair.a, pair.b);
      ++out.touching;
    }
    progress(fmt::format("frame {} of {}", frame + 1, options.frames));
  }
  write(folder / "README.txt", fmt::format(kReadme, out.avatars, out.parts));
  write(folder / "boxes.csv", tables.boxes);
  write(folder / "poses.csv", tables.poses);
  write(folder / "pairs.csv", tables.pairs);
  write(folder / "touching.csv", tables.touching);
  write_shapes(crowd->model(), folder);
  return out;
}

PairCheck check_pairs(const fs::path& file) {
  PairFile found_file(file);
  const fs::path folder = file.parent_path();
  for (const char* name : {"pairs.csv", "touching.csv"})
    if (!fs::exists(folder / name))
      throw InputError(file.string(), "a file in a folder of `throng bench --export`",
                       fmt::format("no {} next to it", name));
  PairCheck out;
  out.are_boxes = found_file.are_boxes();
  std::vector<FramePair> found = found_file.read();
  const std::vector<FramePair> boxes = PairFile(folder / "pairs.csv").read();
  const std::vector<FramePair> touching = PairFile(folder / "touching.csv").read();
  const std::vector<FramePair>& reference = out.are_boxes ? boxes : touching;
  out.found = found.size();
  out.reference = reference.size();
  const PartNames names(folder);
  const auto note = [&](const char* what, const FramePair& pair) {
    if (out.first.empty()) out.first = fmt::format("{}: {}", what, names.of(pair));
  };
  const auto duplicates = std::adjacent_find(found.begin(), found.end());
  if (duplicates != found.end()) note("twice", *duplicates);
  found.erase(std::unique(found.begin(), found.end()), found.end());
  out.duplicates = out.found - found.size();
  const std::vector<FramePair> missing = without(reference, found),
                               unexpected = without(found, boxes);
  if (!missing.empty()) note("missing", missing.front());
  if (!unexpected.empty())
    note(out.are_boxes ? "unexpected" : "apart by their boxes", unexpected.front());
  out.missing = missing.size();
  out.unexpected = unexpected.size();
  out.false_positives = out.are_boxes ? 0 : without(found, touching).size();
  return out;
}

std::string to_text(const ExportedFrames& exported, const fs::path& folder) {
  return fmt::format(
      "{}: {} frames of {} people with {} parts; {} pairs of boxes overlap, the parts of {} "
      "touch\n",
      folder.string(), exported.frames, exported.avatars, exported.parts, exported.box_pairs,
      exported.touching);
}

std::string to_text(const PairCheck& check) {
  std::string text =
      check.are_boxes
          ? fmt::format("{} pairs of boxes found, {} in the reference: {} missing, {} unexpected",
                        check.found, check.reference, check.missing, check.unexpected)
          : fmt::format(
                "{} pairs of parts found, {} touch: {} of these missing, {} found do not touch, {} "
                "have boxes that are apart",
                check.found, check.reference, check.missing, check.false_positives,
                check.unexpected);
  if (check.duplicates > 0) text += fmt::format(", {} twice", check.duplicates);
  text += check.agrees() ? "\nthey agree\n" : fmt::format("\nfirst {}\n", check.first);
  return text;
}

}  // namespace throng::bench
