#include "lcm_io/export/csv_export.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "base/text.h"
#include "throng/layouts.hpp"

namespace throng {
namespace {

constexpr size_t kPiece = 1 << 16;

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + "\"";
}

double seconds(int64_t utime_us) { return 1e-6 * static_cast<double>(utime_us); }

/// Names are empty before the run's description.
std::string names_of(const run_description_t* description, PairKey pair) {
  if (description == nullptr) return fmt::format("{},{},,,,", pair.a(), pair.b());
  const run_description_t& run = *description;
  return fmt::format("{},{},{},{},{},{}", pair.a(), pair.b(), quoted(body_name(run, pair.a())),
                     quoted(body_name(run, pair.b())),
                     quoted(part_name(run, pair.a(), pair.part_a())),
                     quoted(part_name(run, pair.b(), pair.part_b())));
}

constexpr const char* kPairColumns = "body_a,body_b,name_a,name_b,part_a,part_b";

void add_events(RunReader& run, const MessageHeader& header, std::string& out) {
  for (const PairEvent& event : run.new_events())
    append(out, "{},{:.6f},{},{},{}\n", header.frame, seconds(header.utime_us),
           event.kind == EventKind::kBegin ? "begin" : "end", names_of(run.run(), event.pair),
           static_cast<int>(event.level));
}

void add_touching(RunReader& run, const MessageHeader& header, std::string& out) {
  for (const auto& [pair, level] : run.touching())
    append(out, "{},{:.6f},{},{}\n", header.frame, seconds(header.utime_us),
           names_of(run.run(), pair), static_cast<int>(level));
}

void add_proximity(RunReader& run, const MessageHeader& header, std::string& out) {
  const auto add = [&](std::span<const ProximityPair> rows, const char* kind) {
    for (const ProximityPair& row : rows) {
      append(out, "{},{:.6f},{},{},{},{},{}", header.frame, seconds(header.utime_us), kind,
             names_of(run.run(), row.pair), static_cast<int>(row.level), row.lo_m, row.hi_m);
      if (row.level != PairLevel::kTriangles) {
        out += ",,,,,,,,,,,,\n";
        continue;
      }
      for (const auto* point : {&row.point_a_m, &row.point_b_m})
        for (const double x : *point) append(out, ",{:.6f}", x);
      for (const float x : row.normal) append(out, ",{:.6f}", x);
      append(out, ",{:.6f},", row.depth_m);
      if (!std::isnan(row.closing_speed_mps))
        append(out, "{:.6f},{:.6f}", row.closing_speed_mps, row.time_to_contact_s());
      else
        out += ',';
      out += '\n';
    }
  };
  add(run.proximity_pairs(), "parts");
  add(run.closest_parts(), "closest_parts");
}

void add_contacts(RunReader& run, const MessageHeader& header, std::string& out) {
  for (const ContactPoint& row : run.contact_points()) {
    append(out, "{},{:.6f},{}", header.frame, seconds(header.utime_us),
           names_of(run.run(), row.pair));
    for (const double x : row.point_m) append(out, ",{:.6f}", x);
    for (const float x : row.normal) append(out, ",{:.6f}", x);
    append(out, ",{:.6f}\n", row.depth_m);
  }
}

void add_separation(RunReader& run, const MessageHeader& header, std::string& out) {
  for (const auto& [kind, shortfall] : run.new_shortfalls())
    append(out, "{},{:.6f},{},{},{},{},{},{},{},{},{},{}\n", header.frame, seconds(header.utime_us),
           kind == EventKind::kBegin ? "begin" : "end", shortfall.robot, shortfall.person,
           name_of(shortfall.region), shortfall.begin_frame, shortfall.min_distance_lo_m,
           shortfall.min_distance_hi_m, shortfall.max_shortfall_m, shortfall.is_truncated ? 1 : 0,
           shortfall.is_beyond_margin ? 1 : 0);
}

void add_states(RunReader& run, const MessageHeader&, std::string& out) {
  const CrowdState& state = run.state();
  for (size_t id = 0; id < state.roots.size(); ++id) {
    if (!state.present.empty() && state.present[id] == 0) continue;
    const RootPose& root = state.roots[id];
    const Eigen::Vector3f ahead = root.world_from_root * Eigen::Vector3f::UnitX();
    append(out, "{},{:.6f},{},{},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f}\n", state.frame,
           seconds(state.utime_us), id, quoted(body_name(*run.run(), static_cast<uint32_t>(id))),
           root.position_m.x(), root.position_m.y(), root.position_m.z(),
           std::atan2(static_cast<double>(ahead.y()), static_cast<double>(ahead.x())),
           state.speeds_mps[id]);
  }
}

template <class Cell>
void add_cell(const Cell& cell, std::string& out) {
  if constexpr (std::is_same_v<Cell, std::string>)
    out += ',' + quoted(printable(cell));
  else
    append(out, ",{}", cell);
}

template <class Message>
void add_rows(std::span<const uint8_t> bytes, std::string& out) {
  Message m;
  if (!decode(bytes, m).empty()) return;
  for (size_t row = 0; row < csv_rows(m); ++row) {
    append(out, "{},{:.6f}", m.frame, seconds(m.utime));
    add_csv_cells(m, row, [&out](const auto& cell) { add_cell(cell, out); });
    out += '\n';
  }
}

/// A CSV table: its columns and the conversion of a message to rows.
struct Table {
  std::string channel;
  RunReader::Update update;
  std::string columns;
  void (*add)(RunReader& run, const MessageHeader& header, std::string& out);
  void (*add_rows)(std::span<const uint8_t> bytes, std::string& out) = nullptr;  ///< replaces `add`
};

/// Returns "events" for "THRONG_EVENTS".
std::string csv_name(std::string_view channel) {
  std::string lower(channel);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (lower.starts_with("throng_")) lower.erase(0, 7);
  return lower;
}

std::vector<Table> with_defined_tables(std::vector<Table> tables) {
  for (const Channel channel : kAllChannels)
    with_type_of(channel, [&]<class Message>() {
      if constexpr (requires(const Message* type) { csv_columns(type); })
        tables.push_back(
            {csv_name(name_of(channel)), RunReader::Update::kMessage,
             fmt::format("frame,time_s,{}", csv_columns(std::add_pointer_t<const Message>())),
             nullptr, add_rows<Message>});
    });
  return tables;
}

const std::vector<Table>& tables() {
  using Update = RunReader::Update;
  static const std::vector<Table> all = with_defined_tables(
      {{"events", Update::kEvents, fmt::format("frame,time_s,kind,{},level", kPairColumns),
        add_events},
       {"states", Update::kState, "frame,time_s,id,name,x_m,y_m,z_m,heading_rad,speed_mps",
        add_states},
       {"touching", Update::kTouching, fmt::format("frame,time_s,{},level", kPairColumns),
        add_touching},
       {"proximity", Update::kProximity,
        fmt::format("frame,time_s,kind,{},level,distance_lo_m,distance_hi_m,point_a_x_m,point_a_y_"
                    "m,point_a_z_m,point_"
                    "b_x_m,point_b_y_m,point_b_z_m,"
                    "normal_x,normal_y,normal_z,depth_m,closing_speed_mps,time_to_contact_s",
                    kPairColumns),
        add_proximity},
       {"contact_points", Update::kContactPoints,
        fmt::format("frame,time_s,{},x_m,y_m,z_m,normal_x,normal_y,normal_z,depth_m", kPairColumns),
        add_contacts},
       {"separation", Update::kSeparation,
        "frame,time_s,kind,robot,person,region,begin_frame,min_distance_lo_m,min_distance_hi_m,max_"
        "shortfall_m,truncated,"
        "beyond_margin",
        add_separation}});
  return all;
}

const Table* table_of(std::string_view channel) {
  for (const Table& table : tables())
    if (table.channel == channel) return &table;
  return nullptr;
}

}  // namespace

const std::vector<std::string>& csv_channels() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> out;
    for (const Table& table : tables()) out.emplace_back(table.channel);
    return out;
  }();
  return names;
}

std::string csv_channel(std::string_view name) {
  const std::string lower = csv_name(name);
  return table_of(lower) != nullptr ? lower : "";
}

std::string export_csv(ExportedLog& log, const std::string& channel,
                       const std::function<void(std::string_view text)>& write,
                       const std::function<bool()>& keep_going) {
  const Table& table = *table_of(channel);
  std::string text = table.columns + "\n";
  bool is_stopped = false;
  while (log.next()) {
    is_stopped = !keep_going();
    if (is_stopped) break;
    RunReader& run = log.run();
    const RunReader::Update update = log.update();
    if (run.header() == nullptr) continue;
    if (table.add_rows == nullptr) {
      if (update == table.update) table.add(run, *run.header(), text);
    } else if (update > RunReader::Update::kNothing && update < RunReader::Update::kRejected &&
               csv_name(log.event().channel) == table.channel) {
      table.add_rows(log.event().data, text);
    }
    if (text.size() < kPiece) continue;
    write(text);
    text.clear();
  }
  write(text);
  return is_stopped ? "stopped" : log.missing();
}

}  // namespace throng
