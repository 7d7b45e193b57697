#include <algorithm>
#include <array>
#include <string_view>

#include "base/errors.h"
#include "base/text.h"
#include "recordings/readers/text_lines.h"
#include "scenes/file/key_tables.h"
#include "scenes/file/polygon_values.h"
#include "scenes/file/scene_values.h"

namespace throng {
namespace {

namespace fs = std::filesystem;

constexpr Range kPlaceRange{-kMaxCoordinate_m, kMaxCoordinate_m};
constexpr Range kHeadingRange{-kMaxHeading_rad, kMaxHeading_rad};
constexpr Range kSpeedRange{0, kMaxEntrySpeed_mps};

/// StartsFile reads the columns of a CSV file of starts.
class StartsFile final : public LineHandler {
 public:
  StartsFile(const fs::path& file, Starts& out) : file_(file.string()), out_(out) {}

  void take(std::string_view line, int64_t number) override {
    if (stripped(line).empty() || is_comment(line)) return;
    fields_ = split_text(line, ',');
    if (!has_names_)
      read_names(number);
    else
      read_row(number);
  }
  bool has_names() const { return has_names_; }

 private:
  struct Column {
    std::string_view name;
    Range range;
    size_t at = kNone;
  };
  static constexpr size_t kNone = ~size_t{0};

  void read_names(int64_t line) {
    for (size_t i = 0; i < fields_.size(); ++i) {
      const std::string_view name = stripped(fields_[i]);
      const auto column = std::find_if(columns_.begin(), columns_.end(),
                                       [&](const Column& each) { return each.name == name; });
      if (column == columns_.end() || column->at != kNone) reject_names(line, in_quotes(name));
      column->at = i;
    }
    if (columns_[0].at == kNone || columns_[1].at == kNone) reject_names(line, "others");
    count_ = fields_.size();
    has_names_ = true;
  }
  [[noreturn]] void reject_names(int64_t line, const std::string& found) const {
    throw InputError(where(line), "the columns x_m, y_m and at most heading_rad and speed_mps",
                     found);
  }

  void read_row(int64_t line) {
    if (fields_.size() != count_)
      throw InputError(where(line), fmt::format("{} fields", count_),
                       fmt::format("{}", fields_.size()));
    out_.positions_m.emplace_back(number(columns_[0], line), number(columns_[1], line));
    if (columns_[2].at != kNone) out_.headings_rad.push_back(number(columns_[2], line));
    if (columns_[3].at != kNone) out_.speeds_mps.push_back(number(columns_[3], line));
    out_.lines.push_back(static_cast<int>(line));
    if (out_.positions_m.size() > static_cast<size_t>(kMaxBodies))
      throw InputError(where(line), fmt::format("at most {} rows", kMaxBodies), "more");
  }
  double number(const Column& column, int64_t line) const {
    const std::string_view text = stripped(fields_[column.at]);
    double value = 0;
    if (!parse_number(text, value) || !(value >= column.range.min && value <= column.range.max))
      throw InputError(where(line),
                       fmt::format("a number from {:g} to {:g} for '{}'", column.range.min,
                                   column.range.max, column.name),
                       in_quotes(text));
    return value;
  }
  std::string where(int64_t line) const { return at_line(file_, static_cast<int>(line)); }

  std::string file_;
  Starts& out_;
  std::array<Column, 4> columns_{{{"x_m", kPlaceRange},
                                  {"y_m", kPlaceRange},
                                  {"heading_rad", kHeadingRange},
                                  {"speed_mps", kSpeedRange}}};
  std::vector<std::string> fields_;
  size_t count_ = 0;
  bool has_names_ = false;
};

void read_starts_file(const fs::path& file, Starts& out) {
  constexpr size_t kMaxBytes = size_t{1} << 30;
  out.file = file.string();
  StartsFile rows(file, out);
  LineSplitter lines(file, rows);
  lines.push(read_text_file(file, kMaxBytes));
  lines.end();
  if (!rows.has_names() || out.positions_m.empty())
    throw InputError(file.string(), "the columns x_m and y_m, and a row per agent", "no row");
}

/// Reads a list with one number per position; empty if the key is absent.
void read_values(const Fields& fields, const std::string& key, const Range& range,
                 const Group& group, std::vector<double>& out) {
  const YamlNode* node = fields.find(key);
  if (node == nullptr) return;
  if (fields.find("positions_m") == nullptr)
    throw InputError(fields.where(*node), fmt::format("'positions_m' with '{}'", key), "none");
  if (!out.empty())
    throw InputError(fields.where(*node), fmt::format("'{}' in the scene or in the file", key),
                     "both");
  out = fields.numbers(key, static_cast<int>(group.starts.positions_m.size()), range);
}

Rule list_of_numbers(const Range& range) {
  return {.kind = Rule::Kind::kNumbers, .range = range, .min = 1};
}

}  // namespace

void read_positions(ReadContext& context, const Fields& fields, Group& group) {
  const YamlNode& node = fields.require("positions_m");
  Starts& starts = group.starts;
  for (const char* key : {"density_per_m2", "social_groups"})
    if (const YamlNode* other = fields.find(key))
      throw InputError(fields.where(*other), fmt::format("either 'positions_m' or '{}'", key),
                       "both");
  if (node.kind == YamlNode::Kind::kMap) {
    const Fields map(fields.file(), node, "positions_m");
    map.expect_keys({"file"});
    read_starts_file(existing_file(context, map, map.require("file"), "a CSV file"), starts);
  } else {
    starts.positions_m = fields.points("positions_m", 1, kPlaceRange);
    starts.file = fields.file();
    for (const YamlNode& item : node.items) starts.lines.push_back(item.line);
  }
  group.count = static_cast<int>(starts.positions_m.size());
  if (fields.find("count") != nullptr &&
      fields.integer_or("count", 0, kMaxBodies, 0) != int64_t{group.count})
    throw InputError(fields.where(*fields.find("count")),
                     fmt::format("the number of 'positions_m', {}, or no 'count'", group.count),
                     fields.text("count"));
}

std::vector<Key<Group>> rows_of_starts() {
  Key<Group> positions =
      custom_key<Group>("positions_m",
                        "`[x, y]` of each agent at the start, in place of `count` and `spawn`",
                        "random places in `spawn`", map_rule("starts"))
          .with_hash([](Hasher& hash, const Group& group) {
            for (const Eigen::Vector2d& place_m : group.starts.positions_m)
              hash.add(place_m.x()).add(place_m.y());
          });
  positions.is_default = [](const Group& group) { return group.starts.positions_m.empty(); };
  const auto values = [](std::string name, std::string meaning, std::string fallback, Range range,
                         std::vector<double> Starts::*member) {
    Key<Group> key =
        custom_key<Group>(name, std::move(meaning), std::move(fallback), list_of_numbers(range))
            .with_reader([name, range, member](ReadContext&, Fields& fields, Group& group) {
              read_values(fields, name, range, group, group.starts.*member);
            })
            .with_hash([member](Hasher& hash, const Group& group) {
              for (const double value : group.starts.*member) hash.add(value);
            });
    key.is_default = [member](const Group& group) { return (group.starts.*member).empty(); };
    return key;
  };
  return {
      positions,
      values("headings_rad",
             "heading of each agent of `positions_m` at the start, counter-clockwise from the "
             "x axis",
             "towards the goal", kHeadingRange, &Starts::headings_rad),
      values("speeds_mps", "speed of each agent of `positions_m` at the start, along its heading",
             "the desired speed, or what agents ahead allow", kSpeedRange, &Starts::speeds_mps)};
}

MapText starts_text() {
  return {.name = "starts",
          .meaning = "Places at the start: a list of `[x, y]`, or a CSV file",
          .keys = {{"file",
                    "CSV file relative to the scene file, with the columns `x_m`, `y_m` and if "
                    "known `heading_rad` and `speed_mps`; a row per agent",
                    "required",
                    true,
                    {}}},
          .or_points = true};
}

}  // namespace throng
