// The run description: all that somebody on another machine needs to draw a run and to understand
// its events. One rule: no path of this machine is in it, and nothing in it is trusted when read.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "lcm_io/codec/channels.h"
#include "lcm_io/codec/quantise.h"
#include "scenes/run/sink.h"

namespace throng {

/// How each column of a model's posture rows is quantised.
std::vector<ColumnRange> column_ranges(const Model& model);

run_description_t describe(const RunInfo& run);

/// The description of a run, encoded. Throws InputError naming the scene's file if it is longer
/// than a reader takes, or has what defect_of() refuses.
std::vector<uint8_t> encode_description(const RunInfo& run);

/// Fills in what checksums_t says of the run itself: by what it was made, and what it leaves out.
void describe_checksums(const RunInfo& run, checksums_t& out);

/// A name that came over the wire, fit for a terminal: what could command one (control characters,
/// bytes that are no UTF-8) becomes '?', and after `longest` bytes it is cut.
std::string printable(std::string_view name, size_t max_bytes = 64);

/// "<group> <id>" of an avatar, the name of an obstacle; printable. For a description that
/// defect_of() passed.
std::string body_name(const run_description_t& run, uint32_t body);
/// Printable. "" for a whole body (kWholeBody) and for an obstacle.
std::string part_name(const run_description_t& run, uint32_t body, uint32_t part);
/// Whether the run has these bodies and parts.
bool has_pair(const run_description_t& run, PairKey pair);

/// Why a received description cannot be used, or "" if it is sound: every index in range, every
/// number finite, joints a tree with unit axes.
std::string defect_of(const run_description_t& description);

/// A model that can be posed like the one that was described. `described` has no defect.
std::shared_ptr<const Model> to_model(const model_t& described);

/// The ranges that the description states; the same as column_ranges() of the sender's model.
std::vector<ColumnRange> column_ranges(const model_t& described);

}  // namespace throng
