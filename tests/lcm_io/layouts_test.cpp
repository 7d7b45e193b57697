// The checks generated from the .lcm files, tested with an independent reader of these files. Each
// field of each type is changed in an encoded message, and is rejected or read with its value.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>

#include "lcm_io/codec/log_format.h"
#include "lcm_io/codec/message_validation.h"
#include "synthetic_run.h"

namespace throng {
namespace {

using Bytes = std::vector<uint8_t>;
using FieldName = std::pair<std::string, std::string>;

struct Field {
  std::string type, name, length;
};

struct Definitions {
  std::map<std::string, std::vector<Field>> types;
  std::set<FieldName> ruled;

  Definitions() {
    static const std::regex field(R"(^\s+(\w+) (\w+)(?:\[(\w+)\])?;.*)"),
        rule(R"(^\s+//! (?!each )(.*))"), word(R"([a-z_]\w*)");
    for (const auto& entry : std::filesystem::directory_iterator(THRONG_SOURCE_DIR "/lcmtypes")) {
      if (entry.path().extension() != ".lcm") continue;
      const std::string type = entry.path().stem();
      std::ifstream in(entry.path());
      std::smatch found;
      for (std::string line; std::getline(in, line);) {
        if (std::regex_match(line, found, field))
          types[type].push_back({found[1], found[2], found[3]});
        if (!std::regex_match(line, found, rule)) continue;
        const std::string text = found[1];
        for (std::sregex_iterator at(text.begin(), text.end(), word), end; at != end; ++at)
          ruled.emplace(type, at->str());
      }
    }
  }
};

/// Position of a field, or of one item, in an encoded message.
struct Place {
  FieldName field;
  size_t at = 0, bytes = 0;
  bool is_length = false;
};

class Reading {
 public:
  Reading(const Definitions& definitions, std::span<const uint8_t> bytes)
      : definitions_(definitions), bytes_(bytes) {}

  std::vector<Place> places_of(const std::string& type) {
    read(type);
    EXPECT_EQ(at_, bytes_.size()) << type;
    return places_;
  }

 private:
  void read(const std::string& type) {
    static const std::map<std::string, size_t> sizes = {
        {"byte", 1},    {"boolean", 1}, {"int8_t", 1},  {"int16_t", 2},
        {"int32_t", 4}, {"float", 4},   {"int64_t", 8}, {"double", 8}};
    std::map<std::string, int32_t> counts;
    const std::vector<Field>& fields = definitions_.types.at(type);
    for (const Field& field : fields) {
      const bool is_number = !field.length.empty() && std::isdigit(field.length[0]) != 0;
      const int items = field.length.empty() ? 1
                        : is_number          ? std::stoi(field.length)
                                             : counts.at(field.length);
      for (int i = 0; i < items; ++i) {
        if (definitions_.types.contains(field.type)) {
          if (i == 0) places_.push_back({{type, field.name}, at_, 1, false});
          read(field.type);
        } else if (field.type == "string") {
          add({type, field.name}, 4, i, true);
          at_ += static_cast<size_t>(get_big_endian<int32_t>(bytes_.data() + at_ - 4));
        } else {
          add({type, field.name}, sizes.at(field.type), i, false);
        }
      }
      if (field.type == "int32_t" && items == 1)
        counts[field.name] = get_big_endian<int32_t>(bytes_.data() + at_ - 4);
      for (const Field& other : fields)
        if (other.length == field.name) places_.back().is_length = true;
    }
  }
  void add(FieldName field, size_t bytes, int item, bool is_length) {
    if (item < 3) places_.push_back({std::move(field), at_, bytes, is_length});
    at_ += bytes;
  }

  const Definitions& definitions_;
  std::span<const uint8_t> bytes_;
  size_t at_ = 8;
  std::vector<Place> places_;
};

template <class Message>
Bytes encoded(const Message& message) {
  Bytes bytes(static_cast<size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

/// Returns the result of decode(); an accepted message must encode to the same bytes.
std::string defect_of(const std::string& type, std::span<const uint8_t> bytes) {
#define THRONG_DECODE(Message)                                                \
  if (type == #Message) {                                                     \
    Message message;                                                          \
    const std::string defect = decode(bytes, message);                        \
    if (defect.empty()) {                                                     \
      EXPECT_EQ(encoded(message), Bytes(bytes.begin(), bytes.end())) << type; \
    }                                                                         \
    return defect;                                                            \
  }
  THRONG_MESSAGES(THRONG_DECODE)
#undef THRONG_DECODE
  return "no such message";
}

/// Lockstep messages, which have no header of a run.
template <class Message>
Message of_avatars() {
  Message m{};
  m.schema = kSchema;
  m.count = 2;
  m.avatar = {0, 1};
  for (auto* column : {&m.x_m, &m.y_m, &m.z_m}) column->resize(2);
  for (auto* column : {&m.qw, &m.qx, &m.qy, &m.qz, &m.vx_mps, &m.vy_mps}) column->resize(2);
  return m;
}

/// A valid message of each type.
std::map<std::string, Bytes> samples() {
  std::map<std::string, Bytes> out;
  SyntheticRun run({.avatars = 12, .seed = 3, .pairs = 12, .comings = true, .proximity = true});
  for (const auto& m : messages_of(run, 2, {.part_poses = true}))
    with_type_of(m.channel, [&]<class Message>() { out.emplace(Message::getTypeName(), m.bytes); });
  SyntheticRun rovers({.avatars = 4, .crowd = SyntheticRun::Crowd::kRovers});
  run_description_t described = describe(rovers.info());
  described.floor.push_back({1, {3}, 6, {0, 0, 4, 0, 0, 4}});
  described.floor_count = 1;
  out["run_description_t"] = encoded(described);
  auto drive = of_avatars<pose_command_t>();
  auto answer = of_avatars<step_reply_t>();
  drive.joint_positions = answer.joint_positions = {0.5, 1};
  drive.joint_position_count = answer.joint_position_count = 2;
  out["pose_command_t"] = encoded(drive);
  out["step_reply_t"] = encoded(answer);
  out["step_request_t"] = encoded(of_avatars<step_request_t>());
  crowd_change_t change{};
  change.schema = kSchema;
  change.chunk_count = 1;
  change.group = "people";
  change.count = 2;
  change.avatar = {3, 4};
  change.x_m = change.y_m = {1, 2};
  change.heading_rad = change.speed_mps = {0.5f, 1};
  out["crowd_change_t"] = encoded(change);
  stamp_t stamp{};
  stamp.schema = kSchema;
  out["stamp_t"] = encoded(stamp);
  return out;
}

std::vector<Bytes> values_in_place_of(std::span<const uint8_t> was) {
  std::vector<Bytes> out;
  for (const int first : {0x00, 0x7f, 0x80, 0xff})
    for (const int rest : {0x00, 0xff}) {
      out.emplace_back(was.size(), static_cast<uint8_t>(rest));
      out.back().front() = static_cast<uint8_t>(first);
    }
  for (const int bit : {1, 2, 4}) {
    out.emplace_back(was.begin(), was.end());
    out.back().back() ^= static_cast<uint8_t>(bit);
  }
  return out;
}

TEST(Layouts, CheckEveryFieldOfEveryType) {
  const Definitions definitions;
  const std::map<std::string, Bytes> sound = samples();
  std::set<FieldName> met, rejected;
  for (const auto& [type, bytes] : sound) {
    ASSERT_EQ(defect_of(type, bytes), "") << type;
    for (const Place& place : Reading(definitions, bytes).places_of(type)) {
      SCOPED_TRACE(type + ": " + place.field.first + "::" + place.field.second);
      met.insert(place.field);
      ASSERT_NE(defect_of(type, std::span(bytes).first(place.at)), "");
      ASSERT_NE(defect_of(type, std::span(bytes).first(place.at + place.bytes - 1)), "");
      const auto was = std::span(bytes).subspan(place.at, place.bytes);
      for (const Bytes& value : values_in_place_of(was)) {
        Bytes changed = bytes;
        std::copy(value.begin(), value.end(), changed.begin() + static_cast<ptrdiff_t>(place.at));
        std::string defect;
        ASSERT_NO_THROW(defect = defect_of(type, changed));
        if (!defect.empty()) rejected.insert(place.field);
        if (place.is_length && changed != bytes) {
          EXPECT_NE(defect, "") << "a length that exceeds the message";
        }
      }
    }
  }
  for (const auto& [type, fields] : definitions.types)
    for (const Field& field : fields)
      EXPECT_TRUE(met.contains({type, field.name}))
          << type << "::" << field.name << " is missing in the samples";
  for (const FieldName& field : definitions.ruled)
    EXPECT_TRUE(rejected.contains(field))
        << field.first << "::" << field.second << " takes any value";
  EXPECT_GT(definitions.ruled.size(), 30u);
}

TEST(Layouts, ReportBrokenRulesWithTheirValues) {
  stamp_t stamp{};
  stamp.schema = kSchema;
  stamp.events = -4;
  EXPECT_EQ(defect_of("stamp_t", encoded(stamp)), "expected 0 <= events, found events -4");
  step_request_t turn = of_avatars<step_request_t>();
  turn.schema = kSchema + 1;
  EXPECT_EQ(defect_of("step_request_t", encoded(turn)),
            fmt::format("schema {}, this program reads {}", kSchema + 1, kSchema));
}

}  // namespace
}  // namespace throng
