// Samples from the child process in which a library reads a binary file, to the builder.
// One rule: what arrives is checked like a file; a piece that does not fit is refused.
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

/// What comes before all samples.
struct ParsedFacts {
  double fps = std::numeric_limits<double>::quiet_NaN();  ///< NaN: the file does not say
  int64_t version = 0;                                    ///< of the format
  int64_t areas = 0;                                      ///< how many walkable areas there are
  std::string wkt{};                                      ///< the first of them
  std::array<std::string, 3>
      units{};  ///< of x, y and z as the file states them; empty: it does not
};

/// In units of the file; NaN for what is missing.
struct ParsedSample {
  int64_t id = 0;
  int64_t frame = 0;
  double x = 0, y = 0;
  float z = std::numeric_limits<float>::quiet_NaN();
  float heading_rad = std::numeric_limits<float>::quiet_NaN();
  double time_s = std::numeric_limits<double>::quiet_NaN();  ///< beside the frame, which counts
};

/// In the child: many samples to a piece.
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

/// Reads a file in the child. Options overrule what the file states.
using ParseFunction = void (*)(const RegularFile&, const RecordingOptions&, SampleSender&);

/// Runs `parse` in a child and feeds the builder; the clock is one of frames.
void read_sandboxed(const RecordingSource& source, const SandboxedKind& kind, ParseFunction parse,
                    RecordingBuilder& builder);

/// The rate that a text of a file states. Throws ParseFailure if it is not understood, unless --fps
/// is given: NaN then.
double parsed_rate(std::string_view text, std::string_view place, const RecordingOptions& options);

/// Keeps the first rate that a file states; NaN states none. Throws ParseFailure for another one,
/// unless
/// --fps is given.
void state_rate(double& fps, double found, std::string_view place, const RecordingOptions& options);

/// Keeps the first unit that a file states; an empty text states none. Throws ParseFailure for
/// another one, unless --unit is given.
void state_unit(std::string& unit, const std::string& found, std::string_view place,
                const RecordingOptions& options);

/// Seconds of one unit of a column of times; none if there is no such column or its unit is not
/// known.
std::optional<UnitScale> time_scale(const TableColumns& columns);

/// How a library finds a file again that is open.
std::string path_of(const RegularFile& file);

}  // namespace throng
