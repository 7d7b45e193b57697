// DXF drawings (ASCII): lines, arcs and polylines of the model space by layer, with blocks.
// Source: Autodesk, DXF Reference.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <span>
#include <utility>

#include "base/errors.h"
#include "base/text.h"
#include "recordings/readers/text_lines.h"
#include "scenes/import/plan_layers.h"
#include "scenes/import/plan_readers.h"

namespace throng {
namespace {

constexpr std::string_view kBinaryDxfMark = "AutoCAD Binary DXF";
constexpr double kMaxDxfNumber = 1e12;
constexpr int kMaxBlockDepth = 16;
/// Entities after the expansion of blocks: blocks of blocks multiply.
constexpr size_t kMaxDxfEntities = 1'000'000;
/// Distance of chords from their arc.
constexpr double kChordError_m = 0.01;
/// Ends of lines that meet.
constexpr double kJoin_m = 0.001;

const SandboxedParser kDxfParser{.library = "the reader of DXF drawings",
                                 .expected = "a DXF drawing",
                                 .remedy = "export it again as ASCII DXF"};

struct DxfGroup {
  int code = 0;
  int line = 0;  ///< line of the value
  std::string_view value;
};

/// A record: the group with code 0, and those up to the next one.
struct DxfRecord {
  std::string_view type;
  int line = 0;
  std::span<const DxfGroup> groups;
};

struct DxfPlacement {
  Eigen::Matrix2d linear = Eigen::Matrix2d::Identity();
  Eigen::Vector2d offset = Eigen::Vector2d::Zero();

  Eigen::Vector2d operator*(const Eigen::Vector2d& point) const { return linear * point + offset; }
  DxfPlacement operator*(const DxfPlacement& inner) const {
    return {linear * inner.linear, linear * inner.offset + offset};
  }
};

struct DxfLayer {
  std::string name;
  bool is_frozen = false;
  bool is_off = false;
  LayerShapes shapes;
  std::map<std::string, size_t> counts;  ///< entities by their description
  size_t entities = 0;
  size_t hidden = 0;
};

struct DxfBlock {
  Eigen::Vector2d base = Eigen::Vector2d::Zero();
  std::span<const DxfRecord> records;
};

struct DxfVertex {
  Eigen::Vector2d point;
  double bulge = 0;
};

/// A name in UTF-8: drawings before AutoCAD 2007 have code pages, most of them close to Latin-1,
/// and escapes such as \U+00DC.
std::string dxf_name(std::string_view value) {
  const auto append_utf8 = [](std::string& out, unsigned code) {
    if (code < 0x80) {
      out += static_cast<char>(code);
    } else if (code < 0x800) {
      out += static_cast<char>(0xc0 | code >> 6);
      out += static_cast<char>(0x80 | (code & 0x3f));
    } else {
      out += static_cast<char>(0xe0 | code >> 12);
      out += static_cast<char>(0x80 | (code >> 6 & 0x3f));
      out += static_cast<char>(0x80 | (code & 0x3f));
    }
  };
  const bool is_utf8 = find_invalid_utf8(value) == std::string_view::npos;
  std::string out;
  for (size_t i = 0; i < value.size(); ++i) {
    unsigned code = 0;
    if (value.substr(i).starts_with("\\U+") && i + 7 <= value.size() &&
        std::sscanf(std::string(value.substr(i + 3, 4)).c_str(), "%4x", &code) == 1) {
      append_utf8(out, code);
      i += 6;
    } else if (is_utf8) {
      out += value[i];
    } else {
      append_utf8(out, static_cast<unsigned char>(value[i]));
    }
  }
  return escaped(out);
}

/// Metres per unit of $INSUNITS; none for a drawing without unit.
std::optional<double> metres_of_insunits(int code) {
  constexpr double kSurveyFoot_m = 1200.0 / 3937.0;
  switch (code) {
    case 1:
      return 0.0254;
    case 2:
      return 0.3048;
    case 3:
      return 1609.344;
    case 4:
      return 0.001;
    case 5:
      return 0.01;
    case 6:
      return 1;
    case 7:
      return 1000;
    case 8:
      return 2.54e-8;
    case 9:
      return 2.54e-5;
    case 10:
      return 0.9144;
    case 13:
      return 1e-6;
    case 14:
      return 0.1;
    case 15:
      return 10;
    case 16:
      return 100;
    case 21:
      return kSurveyFoot_m;
    case 22:
      return kSurveyFoot_m / 12;
    case 23:
      return kSurveyFoot_m * 3;
    case 24:
      return kSurveyFoot_m * 5280;
    default:
      return std::nullopt;
  }
}

class DxfDrawing {
 public:
  DxfDrawing(std::string_view text, const ImportOptions& options)
      : options_(options), choice_(options), file_(options.file.string()) {
    split_groups(text);
    split_records();
  }

  ImportedPlan plan();

 private:
  [[noreturn]] void reject(int line, std::string_view expected, std::string_view found) const {
    throw InputError(at_line(file_, line), expected, found);
  }
  void split_groups(std::string_view text);
  void split_records();
  void read_header(const DxfRecord& section);
  void read_layer(const DxfRecord& record);
  void read_blocks(std::span<const DxfRecord> records);
  void count_entities(size_t count);
  void leave_out(const std::string& one, const std::string& several) {
    LeftOut& out = left_out_[one];
    out.several = several;
    ++out.count;
  }
  void expand(std::span<const DxfRecord> records, const DxfPlacement& placement,
              const std::string& block_layer, int depth);
  size_t expand_entity(std::span<const DxfRecord> records, size_t at, const DxfPlacement& placement,
                       const std::string& block_layer, int depth);
  void insert(const DxfRecord& record, const DxfPlacement& placement, const std::string& layer,
              int depth);
  void add_lwpolyline(DxfLayer& layer, const DxfRecord& record, const DxfPlacement& placement);
  size_t add_polyline(DxfLayer& layer, std::span<const DxfRecord> records, size_t at,
                      const DxfPlacement& placement);
  void add_vertices(DxfLayer& layer, const std::vector<DxfVertex>& vertices, bool is_closed,
                    const DxfPlacement& placement);
  void add_arc(DxfLayer& layer, const DxfRecord& record, const DxfPlacement& placement);
  void add_ellipse(DxfLayer& layer, const DxfRecord& record, const DxfPlacement& placement);
  void add_line(DxfLayer& layer, std::vector<Eigen::Vector2d> points, bool is_closed,
                const DxfPlacement& placement);

  double number(const DxfGroup& group) const;
  int whole(const DxfGroup& group) const;
  const DxfGroup* find(const DxfRecord& record, int code) const;
  double number_or(const DxfRecord& record, int code, double fallback) const;
  int whole_or(const DxfRecord& record, int code, int fallback) const;
  double required(const DxfRecord& record, int code) const;
  std::string text_or(const DxfRecord& record, int code, std::string_view fallback) const;
  DxfLayer& layer_of(const std::string& name);
  /// Placement of a flat entity; none if it does not lie in a horizontal plane.
  std::optional<DxfPlacement> plane_of(const DxfRecord& record,
                                       const DxfPlacement& placement) const;
  int chords_of(double radius, double sweep_rad, const DxfPlacement& placement) const;
  void use_layers(ImportedPlan& plan);
  [[noreturn]] void reject_without_uses() const;
  std::vector<const DxfLayer*> drawn_layers() const;

  struct LeftOut {
    size_t count = 0;
    std::string several;  ///< words after a number above 1
  };

  const ImportOptions& options_;
  LayerChoice choice_;
  std::string file_;
  std::vector<DxfGroup> groups_;
  std::vector<DxfRecord> records_;
  std::optional<double> unit_m_;
  double tolerance_unit_m_ = 1;
  std::map<std::string, DxfLayer> layers_;   ///< keys: names in lower case
  std::map<std::string, DxfBlock> blocks_;   ///< keys: names in lower case
  std::map<std::string, LeftOut> left_out_;  ///< keys: words after the number 1
  size_t vertices_ = 0;
  size_t entities_ = 0;
};

void DxfDrawing::split_groups(std::string_view text) {
  int line = 0;
  const auto next_line = [&] {
    const size_t end = text.find('\n');
    std::string_view out = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (out.ends_with('\r')) out.remove_suffix(1);
    ++line;
    return out;
  };
  while (!text.empty()) {
    const std::string_view code_text = trimmed(next_line());
    if (code_text.empty() && trimmed(text).empty()) break;
    int64_t code = 0;
    if (!parse_whole(code_text, code) || std::abs(code) > 10'000)
      reject(line, "a group code of DXF, a whole number", in_quotes(code_text));
    if (text.empty()) reject(line, "a value after the group code", "the end of the file");
    const std::string_view value = next_line();
    groups_.push_back({static_cast<int>(code), line, value});
    if (code == 0 && trimmed(value) == "EOF") return;
  }
  reject(line, "EOF at the end of a DXF drawing",
         "the end of the file: it is cut short; export it again");
}

void DxfDrawing::split_records() {
  for (size_t begin = 0, end = 0; begin < groups_.size(); begin = end) {
    end = begin + 1;
    while (end < groups_.size() && groups_[end].code != 0) ++end;
    if (groups_[begin].code != 0) continue;  // comments before the first record
    records_.push_back({trimmed(groups_[begin].value), groups_[begin].line,
                        std::span(groups_).subspan(begin + 1, end - begin - 1)});
  }
}

double DxfDrawing::number(const DxfGroup& group) const {
  double value = 0;
  if (!parse_number(trimmed(group.value), value) || !(std::abs(value) <= kMaxDxfNumber))
    reject(group.line, fmt::format("a number within 1e12 for the group code {}", group.code),
           in_quotes(trimmed(group.value)));
  return value;
}

int DxfDrawing::whole(const DxfGroup& group) const {
  int64_t value = 0;
  if (!parse_whole(trimmed(group.value), value) || std::abs(value) > 1'000'000'000)
    reject(group.line, fmt::format("a whole number for the group code {}", group.code),
           in_quotes(trimmed(group.value)));
  return static_cast<int>(value);
}

const DxfGroup* DxfDrawing::find(const DxfRecord& record, int code) const {
  for (const DxfGroup& group : record.groups) {
    if (group.code >= 1000) break;  // extended data repeat the codes of other programs
    if (group.code == code) return &group;
  }
  return nullptr;
}

double DxfDrawing::number_or(const DxfRecord& record, int code, double fallback) const {
  const DxfGroup* const group = find(record, code);
  return group != nullptr ? number(*group) : fallback;
}

int DxfDrawing::whole_or(const DxfRecord& record, int code, int fallback) const {
  const DxfGroup* const group = find(record, code);
  return group != nullptr ? whole(*group) : fallback;
}

double DxfDrawing::required(const DxfRecord& record, int code) const {
  const DxfGroup* const group = find(record, code);
  if (group == nullptr)
    reject(record.line, fmt::format("the group code {} in {}", code, in_quotes(record.type)),
           "none");
  return number(*group);
}

std::string DxfDrawing::text_or(const DxfRecord& record, int code,
                                std::string_view fallback) const {
  const DxfGroup* const group = find(record, code);
  return dxf_name(trimmed(group != nullptr ? group->value : fallback));
}

DxfLayer& DxfDrawing::layer_of(const std::string& name) {
  DxfLayer& layer = layers_[lower(name)];
  if (layer.name.empty()) layer.name = name;
  return layer;
}

void DxfDrawing::read_header(const DxfRecord& section) {
  for (size_t i = 0; i + 1 < section.groups.size(); ++i)
    if (section.groups[i].code == 9 && trimmed(section.groups[i].value) == "$INSUNITS") {
      const DxfGroup& value = section.groups[i + 1];
      const int code = whole(value);
      unit_m_ = metres_of_insunits(code);
      if (!unit_m_ && code != 0 && !options_.unit_m)
        reject(value.line, "$INSUNITS of a plan, such as 4 (mm) or 6 (m)",
               fmt::format("{}; --unit mm overrides the file", code));
    }
}

void DxfDrawing::read_layer(const DxfRecord& record) {
  const std::string name = text_or(record, 2, "0");
  DxfLayer& layer = layer_of(name.empty() ? "0" : name);
  layer.is_frozen = (whole_or(record, 70, 0) & 1) != 0;
  layer.is_off = whole_or(record, 62, 7) < 0;
}

void DxfDrawing::read_blocks(std::span<const DxfRecord> records) {
  for (size_t i = 0; i < records.size(); ++i) {
    if (records[i].type != "BLOCK") continue;
    size_t end = i + 1;
    while (end < records.size() && records[end].type != "ENDBLK") ++end;
    blocks_[lower(text_or(records[i], 2, ""))] = {
        {number_or(records[i], 10, 0), number_or(records[i], 20, 0)},
        records.subspan(i + 1, end - i - 1)};
    i = end;
  }
}

std::optional<DxfPlacement> DxfDrawing::plane_of(const DxfRecord& record,
                                                 const DxfPlacement& placement) const {
  const double x = number_or(record, 210, 0), y = number_or(record, 220, 0),
               z = number_or(record, 230, 1);
  constexpr double kLevel = 1e-6;
  if (!(std::abs(z) > 0) || std::hypot(x, y) > kLevel * std::abs(z)) return std::nullopt;
  // Drawn from below: the axes of the entity are those of the arbitrary axis algorithm.
  DxfPlacement out = placement;
  if (z < 0) out.linear.col(0) *= -1;
  return out;
}

int DxfDrawing::chords_of(double radius, double sweep_rad, const DxfPlacement& placement) const {
  constexpr double kMaxChord_rad = std::numbers::pi / 4;
  constexpr double kMaxChords = 2000;
  const double scale = std::max(placement.linear.col(0).norm(), placement.linear.col(1).norm());
  const double error = kChordError_m / tolerance_unit_m_ / std::max(scale * radius, 1e-300);
  const double chord_rad =
      std::min(kMaxChord_rad, 2 * std::acos(std::max(1 - error, std::cos(kMaxChord_rad / 2))));
  const double count = std::ceil(std::abs(sweep_rad) / std::max(chord_rad, 1e-9) - 1e-9);
  return static_cast<int>(std::clamp(count, 1.0, kMaxChords));
}

void DxfDrawing::add_line(DxfLayer& layer, std::vector<Eigen::Vector2d> points, bool is_closed,
                          const DxfPlacement& placement) {
  vertices_ += points.size();
  if (vertices_ > kMaxPlanVertices)
    throw InputError(file_, fmt::format("at most {} vertices", kMaxPlanVertices),
                     "more; freeze the layers that are no part of the plan, or simplify it");
  for (Eigen::Vector2d& point : points) {
    point = placement * point;
    if (!(point.cwiseAbs().maxCoeff() <= kMaxDxfNumber))
      throw InputError(file_, "coordinates within 1e12", "larger ones after inserting blocks");
  }
  // A polyline that repeats its first vertex and is closed as well has one edge too many.
  while (is_closed && points.size() > 1 && points.front() == points.back()) points.pop_back();
  if (is_closed && points.size() >= 3)
    layer.shapes.rings.push_back(std::move(points));
  else if (points.size() >= 2)
    layer.shapes.lines.push_back(std::move(points));
}

void DxfDrawing::add_vertices(DxfLayer& layer, const std::vector<DxfVertex>& vertices,
                              bool is_closed, const DxfPlacement& placement) {
  std::vector<Eigen::Vector2d> points;
  constexpr double kStraight = 1e-9;
  for (size_t i = 0; i < vertices.size(); ++i) {
    const Eigen::Vector2d& from = vertices[i].point;
    points.push_back(from);
    if ((i + 1 == vertices.size() && !is_closed) || std::abs(vertices[i].bulge) < kStraight)
      continue;
    const Eigen::Vector2d chord = vertices[(i + 1) % vertices.size()].point - from;
    // The bulge is the tangent of a quarter of the arc's angle, positive counter-clockwise.
    const double bulge = vertices[i].bulge, sweep_rad = 4 * std::atan(bulge);
    const Eigen::Vector2d normal(-chord.y(), chord.x());
    const Eigen::Vector2d centre = from + chord / 2 + normal * ((1 - bulge * bulge) / (4 * bulge));
    const Eigen::Vector2d arm = from - centre;
    const int chords = chords_of(arm.norm(), sweep_rad, placement);
    for (int step = 1; step < chords; ++step)
      points.push_back(centre + Eigen::Rotation2Dd(sweep_rad * step / chords) * arm);
    if (points.size() > kMaxPlanVertices) break;
  }
  add_line(layer, std::move(points), is_closed, placement);
}

void DxfDrawing::add_lwpolyline(DxfLayer& layer, const DxfRecord& record,
                                const DxfPlacement& placement) {
  std::vector<DxfVertex> vertices;
  for (const DxfGroup& group : record.groups) {
    if (group.code >= 1000) break;
    if (group.code == 10) vertices.push_back({{number(group), 0}, 0});
    if ((group.code == 20 || group.code == 42) && vertices.empty())
      reject(group.line, "the group code 10 before 20 and 42", "none in this polyline");
    if (group.code == 20) vertices.back().point.y() = number(group);
    if (group.code == 42) vertices.back().bulge = number(group);
  }
  add_vertices(layer, vertices, (whole_or(record, 70, 0) & 1) != 0, placement);
}

size_t DxfDrawing::add_polyline(DxfLayer& layer, std::span<const DxfRecord> records, size_t at,
                                const DxfPlacement& placement) {
  constexpr int kClosed = 1, kMeshes = 16 | 64, kSplineFrame = 16;
  const DxfRecord& head = records[at];
  const int flags = whole_or(head, 70, 0);
  std::vector<DxfVertex> vertices;
  size_t end = at + 1;
  for (; end < records.size() && records[end].type == "VERTEX"; ++end)
    if ((whole_or(records[end], 70, 0) & kSplineFrame) == 0)
      vertices.push_back({{required(records[end], 10), required(records[end], 20)},
                          number_or(records[end], 42, 0)});
  if (end == records.size() || records[end].type != "SEQEND")
    reject(head.line, "SEQEND after the vertices of a POLYLINE",
           end == records.size() ? "none" : in_quotes(records[end].type));
  const std::optional<DxfPlacement> plane = plane_of(head, placement);
  if ((flags & kMeshes) != 0 || !plane)
    plane ? leave_out("POLYLINE that is a mesh", "POLYLINEs that are meshes")
          : leave_out("POLYLINE that is not horizontal", "POLYLINEs that are not horizontal");
  else
    add_vertices(layer, vertices, (flags & kClosed) != 0, *plane);
  return end + 1;
}

void DxfDrawing::add_arc(DxfLayer& layer, const DxfRecord& record, const DxfPlacement& placement) {
  constexpr double kFull_deg = 360;
  const bool is_circle = record.type == "CIRCLE";
  const Eigen::Vector2d centre(required(record, 10), required(record, 20));
  const double radius = std::abs(required(record, 40));
  const double from_deg = is_circle ? 0 : required(record, 50);
  double sweep_deg = kFull_deg;
  if (!is_circle) {
    sweep_deg = std::fmod(required(record, 51) - from_deg, kFull_deg);
    if (sweep_deg <= 0) sweep_deg += kFull_deg;
  }
  constexpr double kRadPerDeg = std::numbers::pi / 180;
  const int chords = chords_of(radius, sweep_deg * kRadPerDeg, placement);
  std::vector<Eigen::Vector2d> points;
  for (int step = 0; step < chords + (is_circle ? 0 : 1); ++step) {
    const double angle_rad = (from_deg + sweep_deg * step / chords) * kRadPerDeg;
    points.push_back(centre + radius * Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad)));
  }
  add_line(layer, std::move(points), is_circle, placement);
}

void DxfDrawing::add_ellipse(DxfLayer& layer, const DxfRecord& record,
                             const DxfPlacement& placement) {
  constexpr double kTurn_rad = 2 * std::numbers::pi;
  const Eigen::Vector2d centre(required(record, 10), required(record, 20));
  const Eigen::Vector2d major(required(record, 11), required(record, 21));
  const double side = number_or(record, 230, 1) < 0 ? -1 : 1;
  const Eigen::Vector2d minor =
      side * number_or(record, 40, 1) * Eigen::Vector2d(-major.y(), major.x());
  const double from_rad = number_or(record, 41, 0);
  double sweep_rad = std::fmod(number_or(record, 42, kTurn_rad) - from_rad, kTurn_rad);
  if (sweep_rad <= 1e-9) sweep_rad += kTurn_rad;
  const bool is_closed = std::abs(sweep_rad - kTurn_rad) < 1e-6;
  const int chords = chords_of(std::max(major.norm(), minor.norm()), sweep_rad, placement);
  std::vector<Eigen::Vector2d> points;
  for (int step = 0; step < chords + (is_closed ? 0 : 1); ++step) {
    const double angle_rad = from_rad + sweep_rad * step / chords;
    points.push_back(centre + std::cos(angle_rad) * major + std::sin(angle_rad) * minor);
  }
  add_line(layer, std::move(points), is_closed, placement);
}

void DxfDrawing::insert(const DxfRecord& record, const DxfPlacement& placement,
                        const std::string& layer, int depth) {
  const std::string name = text_or(record, 2, "");
  const auto block = blocks_.find(lower(name));
  if (block == blocks_.end()) {
    leave_out("INSERT of a block that the file lacks", "INSERTs of blocks that the file lacks");
    return;
  }
  if (depth >= kMaxBlockDepth) {
    leave_out(fmt::format("INSERT deeper than {} blocks", kMaxBlockDepth),
              fmt::format("INSERTs deeper than {} blocks", kMaxBlockDepth));
    return;
  }
  const std::optional<DxfPlacement> plane = plane_of(record, placement);
  if (!plane) {
    leave_out("INSERT that is not horizontal", "INSERTs that are not horizontal");
    return;
  }
  const double angle_rad = number_or(record, 50, 0) * std::numbers::pi / 180;
  const Eigen::Matrix2d rotation = Eigen::Rotation2Dd(angle_rad).toRotationMatrix();
  const Eigen::Vector2d scale(number_or(record, 41, 1), number_or(record, 42, 1));
  const Eigen::Vector2d at(number_or(record, 10, 0), number_or(record, 20, 0));
  const int columns = std::max(whole_or(record, 70, 1), 1),
            rows = std::max(whole_or(record, 71, 1), 1);
  const Eigen::Vector2d spacing(number_or(record, 44, 0), number_or(record, 45, 0));
  for (int column = 0; column < columns; ++column)
    for (int row = 0; row < rows; ++row) {
      count_entities(1);
      DxfPlacement own;
      own.linear = rotation * scale.asDiagonal();
      own.offset = at + rotation * Eigen::Vector2d(spacing.x() * column, spacing.y() * row) -
                   own.linear * block->second.base;
      expand(block->second.records, *plane * own, layer, depth + 1);
    }
}

void DxfDrawing::count_entities(size_t count) {
  entities_ += count;
  if (entities_ > kMaxDxfEntities)
    throw InputError(file_, fmt::format("at most {} entities, blocks expanded", kMaxDxfEntities),
                     "more; leave out the layers that are no part of the plan");
}

void DxfDrawing::expand(std::span<const DxfRecord> records, const DxfPlacement& placement,
                        const std::string& block_layer, int depth) {
  count_entities(records.size());
  for (size_t at = 0; at < records.size();)
    at = expand_entity(records, at, placement, block_layer, depth);
}

size_t DxfDrawing::expand_entity(std::span<const DxfRecord> records, size_t at,
                                 const DxfPlacement& placement, const std::string& block_layer,
                                 int depth) {
  const DxfRecord& record = records[at];
  const std::string_view type = record.type;
  size_t next = at + 1;
  if (type == "SEQEND") return next;
  std::string name = text_or(record, 8, "0");
  if (name.empty()) name = "0";
  // Entities on layer 0 of a block appear on the layer of its INSERT.
  if (name == "0" && !block_layer.empty()) name = block_layer;
  DxfLayer& layer = layer_of(name);
  const bool is_polyline = type == "POLYLINE";
  const auto skip_vertices = [&] {
    while (is_polyline && next < records.size() && records[next].type == "VERTEX") ++next;
    return next;
  };
  if (whole_or(record, 67, 0) == 1) {
    leave_out("entity of the paper space", "entities of the paper space");
    return skip_vertices();
  }
  const bool is_chosen = choice_.use_of(name).has_value();
  if (((layer.is_frozen || layer.is_off) && !is_chosen) || whole_or(record, 60, 0) == 1) {
    ++layer.hidden;
    return skip_vertices();
  }
  if (type == "INSERT") {
    insert(record, placement, name, depth);
    return next;
  }
  if (is_polyline) {
    ++layer.entities;
    ++layer.counts["polyline"];
    return add_polyline(layer, records, at, placement);
  }
  ++layer.entities;
  if (type == "LINE") {
    ++layer.counts["line"];
    add_line(layer,
             {{required(record, 10), required(record, 20)},
              {required(record, 11), required(record, 21)}},
             false, placement);
    return next;
  }
  const bool is_flat_kind = type == "LWPOLYLINE" || type == "ARC" || type == "CIRCLE";
  if (!is_flat_kind && type != "ELLIPSE") {
    ++layer.counts[name_after(type)];
    return next;
  }
  const std::optional<DxfPlacement> plane = plane_of(record, placement);
  if (!plane) {
    const std::string kind = name_after(type);
    leave_out(kind + " that is not horizontal", kind + "s that are not horizontal");
    return next;
  }
  if (type == "LWPOLYLINE") {
    ++layer.counts["polyline"];
    add_lwpolyline(layer, record, *plane);
  } else if (type == "ELLIPSE") {
    ++layer.counts["ellipse"];
    add_ellipse(layer, record, placement);
  } else {
    ++layer.counts[type == "ARC" ? "arc" : "circle"];
    add_arc(layer, record, *plane);
  }
  return next;
}

constexpr std::string_view kDrawnKinds[] = {"line", "polyline", "arc", "circle", "ellipse"};
bool is_drawn_kind(std::string_view kind) {
  return std::find(std::begin(kDrawnKinds), std::end(kDrawnKinds), kind) != std::end(kDrawnKinds);
}

std::vector<const DxfLayer*> DxfDrawing::drawn_layers() const {
  std::vector<const DxfLayer*> out;
  for (const auto& [name, layer] : layers_)
    if (layer.entities > 0 || layer.hidden > 0) out.push_back(&layer);
  return out;
}

void DxfDrawing::reject_without_uses() const {
  constexpr size_t kMaxBytes = 300;
  std::string found;
  const std::vector<const DxfLayer*> drawn = drawn_layers();
  for (size_t i = 0; i < drawn.size(); ++i) {
    if (found.size() > kMaxBytes) {
      found += fmt::format(" and {} more", drawn.size() - i);
      break;
    }
    found += fmt::format(
        "{}{} ({})", i == 0 ? "" : ", ", in_quotes(drawn[i]->name),
        drawn[i]->entities > 0 ? counted(drawn[i]->entities, "entity", "entities") : "hidden");
  }
  throw InputError(
      file_,
      choice_.is_empty()
          ? "layers named after their use (walkable, obstacle, wall, start, goal), or --layer "
            "walkable=NAME"
          : "lines, arcs or polylines on the layers of --layer",
      found.empty() ? "an empty drawing" : fmt::format("the layers {}", found));
}

void DxfDrawing::use_layers(ImportedPlan& plan) {
  std::vector<std::string> names;
  for (const DxfLayer* layer : drawn_layers()) names.push_back(layer->name);
  choice_.require(names, "a layer of the drawing");
  bool has_use = false;
  UseTally tally;
  std::vector<std::string> unused;
  for (auto& [folded_name, layer] : layers_) {
    const std::optional<PlanUse> use =
        choice_.is_empty() ? stated_use(layer.name) : choice_.use_of(layer.name);
    const std::string label = "layer " + in_quotes(layer.name);
    if (layer.hidden > 0)
      plan.left_out.push_back(fmt::format("{}: {}{}", label,
                                          counted(layer.hidden, "hidden entity", "hidden entities"),
                                          layer.is_frozen ? " (frozen layer)"
                                          : layer.is_off  ? " (layer that is off)"
                                                          : ""));
    if (layer.entities == 0) continue;
    if (!use) {
      unused.push_back(layer.name);
      continue;
    }
    for (const auto& [kind, count] : layer.counts)
      if (!is_drawn_kind(kind))
        plan.left_out.push_back(fmt::format("{}: {} {}", label, count, kind));
    if (layer.shapes.is_empty()) continue;
    has_use = true;
    join_lines(layer.shapes, kJoin_m / tolerance_unit_m_);
    add_shapes(plan, *use, std::move(layer.shapes), layer.name, tally.of(layer.name, *use));
  }
  if (!has_use) reject_without_uses();
  tally.add_to(plan, file_);
  if (!unused.empty())
    plan.left_out.push_back(
        fmt::format("{} without a use: {}", counted(unused.size(), "layer"), quoted_names(unused)));
  for (const auto& [one, out] : left_out_)
    plan.left_out.push_back(counted(out.count, one, out.several));
}

ImportedPlan DxfDrawing::plan() {
  std::span<const DxfRecord> entities;
  for (size_t i = 0; i < records_.size(); ++i) {
    if (records_[i].type != "SECTION") continue;
    size_t end = i + 1;
    while (end < records_.size() && records_[end].type != "ENDSEC") ++end;
    if (end == records_.size())
      reject(records_[i].line, "ENDSEC after the section", "the end of the file; export it again");
    const std::span<const DxfRecord> content =
        std::span<const DxfRecord>(records_).subspan(i + 1, end - i - 1);
    const std::string section = text_or(records_[i], 2, "");
    if (section == "HEADER") read_header(records_[i]);
    if (section == "TABLES")
      for (const DxfRecord& record : content)
        if (record.type == "LAYER") read_layer(record);
    if (section == "BLOCKS") read_blocks(content);
    if (section == "ENTITIES") entities = content;
    i = end;
  }
  if (!unit_m_ && !options_.unit_m)
    throw InputError(file_, "a unit of length, as in --unit mm",
                     "a DXF drawing without one ($INSUNITS is 0 or missing)");
  tolerance_unit_m_ = options_.unit_m.value_or(unit_m_.value_or(1));
  expand(entities, {}, "", 0);
  ImportedPlan out;
  out.kind = "DXF drawing";
  out.unit_m = unit_m_;
  use_layers(out);
  return out;
}

}  // namespace

bool is_dxf(std::string_view head) {
  if (head.starts_with(kBinaryDxfMark) || head.starts_with("AC10")) return true;
  // Comments (group code 999) may come first.
  while (true) {
    const size_t code_end = head.find('\n');
    if (code_end == std::string_view::npos) return false;
    const std::string_view code = trimmed(head.substr(0, head.find_first_of("\r\n")));
    head.remove_prefix(code_end + 1);
    const size_t value_end = std::min(head.find('\n'), head.size());
    const std::string_view value =
        trimmed(head.substr(0, std::min(head.find_first_of("\r\n"), value_end)));
    head.remove_prefix(std::min(value_end + 1, head.size()));
    if (code == "0") return value == "SECTION";
    if (code != "999") return false;
  }
}

ImportedPlan read_dxf(const ImportOptions& options) {
  const RegularFile file(options.file, kDxfParser.expected, kMaxPlanBytes);
  return read_plan_sandboxed(file, kDxfParser, [&](const RegularFile& opened) {
    const std::string text = plan_bytes(opened);
    if (text.starts_with("AC10"))
      throw ParseFailure("a DXF drawing", "a DWG drawing; save it as ASCII DXF");
    if (text.starts_with(kBinaryDxfMark))
      throw ParseFailure("an ASCII DXF drawing", "a binary one; save it as ASCII DXF");
    return DxfDrawing(text, options).plan();
  });
}

}  // namespace throng
