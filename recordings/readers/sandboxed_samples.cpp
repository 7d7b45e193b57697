#include "recordings/readers/sandboxed_samples.h"

#include <fmt/format.h>

#include <cmath>
#include <cstring>

#include "base/errors.h"
#include "base/text.h"
#include "recordings/readers/header_comments.h"
#include "recordings/readers/stated_units.h"
#include "recordings/units.h"

namespace throng {
namespace {

constexpr size_t kSamplesPerPiece = 8192;
constexpr size_t kMaxWktBytes = 512 << 10;

constexpr size_t kMaxUnitBytes = 32;

struct FactsHeader {
  double fps = 0;
  int64_t version = 0;
  int64_t areas = 0;
  std::array<std::array<char, kMaxUnitBytes>, 3> units{};
};
constexpr std::array<ColumnRole, 3> kAxes = {ColumnRole::kX, ColumnRole::kY, ColumnRole::kZ};

static_assert(kSamplesPerPiece * sizeof(ParsedSample) <= kMaxPieceBytes);
static_assert(sizeof(FactsHeader) + kMaxWktBytes <= kMaxPieceBytes);

template <typename T>
std::span<const uint8_t> bytes_of(const T* values, size_t count) {
  return {reinterpret_cast<const uint8_t*>(values), count * sizeof(T)};
}

class Handler {
 public:
  Handler(RecordingBuilder& builder, const SandboxedKind& kind) : builder_(builder), kind_(kind) {}

  void take(std::span<const uint8_t> piece) {
    if (!has_facts_)
      facts(piece);
    else
      samples(piece);
  }
  /// The child must send facts or fail.
  void end() const {
    if (!has_facts_) reject();
  }

 private:
  [[noreturn]] void reject() const {
    throw InputError(builder_.options().file.string(), kind_.parser.expected,
                     fmt::format("data that {} parses inconsistently", kind_.parser.library));
  }

  void facts(std::span<const uint8_t> piece) {
    FactsHeader facts;
    if (piece.size() < sizeof facts || piece.size() > sizeof facts + kMaxWktBytes) reject();
    std::memcpy(&facts, piece.data(), sizeof facts);
    has_facts_ = true;
    const std::span<const uint8_t> wkt = piece.subspan(sizeof facts);
    RecordingHeader& head = builder_.header();
    head.kind = facts.version > 0 ? fmt::format("{} {}", kind_.kind, facts.version) : kind_.kind;
    head.tracked_point = kind_.tracked_point;
    head.clock = RecordedClock::kFrames;
    head.place = "row";
    head.wkt.assign(wkt.begin(), wkt.end());
    if (find_invalid_utf8(head.wkt) != std::string::npos) reject();
    settle_units(facts);
    if (facts.areas > 1)
      builder_.note("additional walkable areas (the first is used)", facts.areas - 1,
                    "areas may change with frames");
    if (!builder_.options().fps && std::isnan(facts.fps))
      throw_missing(builder_, true, false, fmt::format("{} without an fps", kind_.parser.expected));
    const auto stated = std::isnan(facts.fps) ? std::nullopt : std::optional(facts.fps);
    head.per_s = *overruled_rate(builder_, stated, fmt::format("{:g}", facts.fps));
    builder_.state_rate(stated, "the file");
    if (!(head.per_s > 0 && head.per_s <= 10'000))
      throw InputError(builder_.options().file.string(), "an fps above 0 and up to 10000",
                       fmt::format("{:g}; --fps 25 overrides the file", head.per_s));
  }

  void settle_units(const FactsHeader& facts) {
    StatedUnits units;
    for (size_t axis = 0; axis < kAxes.size(); ++axis) {
      const std::string_view text(facts.units[axis].data(),
                                  ::strnlen(facts.units[axis].data(), kMaxUnitBytes));
      units.state(
          kAxes[axis], text,
          fmt::format("the column '{}'", kColumnRoleNames[static_cast<size_t>(kAxes[axis])]), 0);
    }
    scales_ = units.settle(builder_, false);
    builder_.header().wkt_unit_m = scales_.area_unit_m;
  }

  void samples(std::span<const uint8_t> piece) {
    if (piece.size() % sizeof(ParsedSample) != 0) reject();
    for (; !piece.empty(); piece = piece.subspan(sizeof(ParsedSample))) {
      ParsedSample sample;
      std::memcpy(&sample, piece.data(), sizeof sample);
      ++row_;
      if (std::isinf(sample.z)) builder_.reject(row_, "z", "infinity");
      if (std::isinf(sample.heading_rad)) builder_.reject(row_, "an orientation", "infinity");
      builder_.frame_times().take(static_cast<double>(sample.frame), sample.time_s, 0);
      builder_.add(sample.id,
                   {.instant = static_cast<double>(sample.frame),
                    .x_m = scales_.x.si(sample.x),
                    .y_m = scales_.y.si(sample.y),
                    .z_m = static_cast<float>(scales_.z.si(static_cast<double>(sample.z))),
                    .heading_rad = sample.heading_rad},
                   row_);
    }
  }

  RecordingBuilder& builder_;
  const SandboxedKind& kind_;
  ColumnScales scales_;
  bool has_facts_ = false;
  int64_t row_ = 0;
};

}  // namespace

void SampleSender::facts(const ParsedFacts& facts) {
  if (facts.wkt.size() > kMaxWktBytes)
    throw ParseFailure(fmt::format("a walkable area of at most {} KiB", kMaxWktBytes >> 10),
                       fmt::format("one of {} KiB", facts.wkt.size() >> 10));
  FactsHeader head{facts.fps, facts.version, facts.areas, {}};
  for (size_t axis = 0; axis < head.units.size(); ++axis)
    facts.units[axis].copy(head.units[axis].data(), kMaxUnitBytes);
  std::vector<uint8_t> piece(sizeof head + facts.wkt.size());
  std::memcpy(piece.data(), &head, sizeof head);
  std::memcpy(piece.data() + sizeof head, facts.wkt.data(), facts.wkt.size());
  send_(piece);
}

void SampleSender::sample(const ParsedSample& sample) {
  samples_.push_back(sample);
  if (samples_.size() == kSamplesPerPiece) end();
}

void SampleSender::end() {
  send_(bytes_of(samples_.data(), samples_.size()));
  samples_.clear();
}

void read_sandboxed(const RecordingSource& source, const SandboxedKind& kind, ParseFunction parse,
                    RecordingBuilder& builder) {
  if (!builder.options().columns.empty())
    throw InputError("--columns", "a table of text", std::string(kind.parser.expected));
  const SandboxLimits limits{.max_file_bytes = uint64_t{64} << 30,
                             .max_memory_bytes = uint64_t{1} << 30,
                             .memory_per_file_byte = 0,
                             .max_result_bytes = uint64_t{1} << 40};
  Handler handler(builder, kind);
  parse_sandboxed_in_pieces(
      source.file(), kind.parser, limits,
      [&](const RegularFile& file, const SendPiece& send) {
        SampleSender sender(send);
        parse(file, builder.options(), sender);
        sender.end();
      },
      [&](std::span<const uint8_t> piece) { handler.take(piece); });
  handler.end();
}

double parsed_rate(std::string_view text, std::string_view place, const RecordingOptions& options) {
  if (const std::optional<double> rate = frame_rate_named(text)) return *rate;
  if (options.fps) return kMissing;
  throw ParseFailure(fmt::format("{} as {}", kFrameRateForms, place),
                     in_quotes(text) + "; --fps overrides the file");
}

void state_rate(double& fps, double found, std::string_view place,
                const RecordingOptions& options) {
  if (std::isnan(fps))
    fps = found;
  else if (!std::isnan(found) && found != fps && !options.fps)
    throw ParseFailure(fmt::format("one frame rate, {:g}", fps),
                       fmt::format("{:g} as {}; --fps overrides the file", found, place));
}

void state_unit(std::string& unit, const std::string& found, std::string_view place,
                const RecordingOptions& options) {
  if (unit.empty()) {
    unit = found;
    return;
  }
  if (found.empty() || found == unit || options.unit_m) return;
  const std::optional<Unit> first = unit_named(unit), other = unit_named(found);
  if (first && other && first->quantity == other->quantity && first->in_si == other->in_si) return;
  throw ParseFailure(fmt::format("one unit, {}", in_quotes(unit)),
                     fmt::format("{} as {}; --unit overrides the file", in_quotes(found), place));
}

std::optional<UnitScale> time_scale(const TableColumns& columns) {
  if (!columns.has(ColumnRole::kTime)) return std::nullopt;
  const std::string& text = columns.units[static_cast<size_t>(ColumnRole::kTime)];
  if (text.empty()) return UnitScale();
  const std::optional<Unit> unit = unit_named(text);
  if (!unit || unit->in_si == 0 || unit->quantity != Quantity::kTime) return std::nullopt;
  return UnitScale(unit->in_si);
}

std::string path_of(const RegularFile& file) {
  return fmt::format("/proc/self/fd/{}", file.descriptor());
}

}  // namespace throng
