// Sandboxed samples come from a child process in which a library parses a binary file.
// Invariant: received data are checked like a file; malformed pieces are rejected.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/files/sandboxed_parser.h"
#include "recordings/readers/recording_reader.h"
#include "recordings/readers/table_columns.h"

namespace throng {

struct ParsedFacts {
  double fps = std::numeric_limits<double>::quiet_NaN();  ///< NaN: not in the file
  int64_t version = 0;
  int64_t areas = 0;
  std::string wkt{};
  std::array<std::string, 3> units{};  ///< units of x, y and z; empty: not stated
};

/// Sample in units of the file; NaN: missing.
struct ParsedSample {
  int64_t id = 0;
  int64_t frame = 0;
  double x = 0, y = 0;
  float z = std::numeric_limits<float>::quiet_NaN();
  float heading_rad = std::numeric_limits<float>::quiet_NaN();
  double time_s = std::numeric_limits<double>::quiet_NaN();  ///< only compared; `frame` is used
};

/// SampleSender sends samples in large pieces; runs in the child.
class SampleSender {
 public:
  explicit SampleSender(const SendPiece& send) : send_(send) {}
  void facts(const ParsedFacts& facts);
  void sample(const ParsedSample& sample);
  void end();

 private:
  const SendPiece& send_;
  std::vector<ParsedSample> samples_;
};

struct SandboxedKind {
  SandboxedParser parser;
  std::string_view kind;
  TrackedPoint tracked_point = TrackedPoint::kCentre;
};

/// Parses a file in the child. Options override the file.
using ParseFunction = void (*)(const RegularFile&, const RecordingOptions&, SampleSender&);

/// Runs `parse` in a child and feeds the builder; instants are frames.
void read_sandboxed(const RecordingSource& source, const SandboxedKind& kind, ParseFunction parse,
                    RecordingBuilder& builder);

/// Rate stated by a text in the file. Throws ParseFailure for an invalid text; returns NaN instead
/// if --fps is given.
double parsed_rate(std::string_view text, std::string_view place, const RecordingOptions& options);

/// Keeps the first rate that a file states; NaN states none. Throws ParseFailure for a different
/// one, unless --fps is given.
void state_rate(double& fps, double found, std::string_view place, const RecordingOptions& options);

/// Keeps the first unit that a file states; an empty text states none. Throws ParseFailure for a
/// different one, unless --unit is given.
void state_unit(std::string& unit, const std::string& found, std::string_view place,
                const RecordingOptions& options);

/// Scale of a time column; empty if there is none or its unit is unknown.
std::optional<UnitScale> time_scale(const TableColumns& columns);

std::string path_of(const RegularFile& file);

}  // namespace throng
