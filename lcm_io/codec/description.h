// Run description: everything another machine needs to draw a run and interpret its events.
// Invariant: it contains no path of this machine, and readers check all of it before use.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/polygon.h"
#include "lcm_io/codec/channels.h"
#include "lcm_io/codec/quantise.h"
#include "scenes/run/sink.h"

namespace throng {

/// Returns how each column of a model's postures is quantised.
std::vector<ColumnRange> column_ranges(const Model& model);

run_description_t describe(const RunInfo& run);

/// Encodes the description of a run. Throws InputError naming the scene's file if it is larger than
/// kMaxDescriptionBytes or has a defect (see defect_of()).
std::vector<uint8_t> encode_description(const RunInfo& run);

/// Sets the fields of checksums_t that describe the run: version, strategy, budgets, omitted
/// contacts.
void describe_checksums(const RunInfo& run, checksums_t& out);

/// Returns a received name for display on a terminal. Control characters and invalid UTF-8 become
/// '?'; the name is cut after `max_bytes`.
std::string printable(std::string_view name, size_t max_bytes = 64);

/// Returns "<group> <id>" of an avatar or the name of an obstacle, printable. Requires a
/// description without defect.
std::string body_name(const run_description_t& run, uint32_t body);
/// Returns the printable part name; "" for a whole body (kWholeBody) and for an obstacle.
std::string part_name(const run_description_t& run, uint32_t body, uint32_t part);
bool has_pair(const run_description_t& run, PairKey pair);

/// Returns why a received description cannot be used, or "" if it is sound. Indices must be in
/// range, numbers finite, and joints a tree with unit axes.
std::string defect_of(const run_description_t& description);

/// Requires a description without defect.
Polygon to_polygon(const polygon_t& described);

/// Builds a model with the kinematics of the described one. Requires a description without defect.
std::shared_ptr<const Model> to_model(const model_t& described);

/// Returns the ranges in the description; equal to column_ranges() of the sender's model.
std::vector<ColumnRange> column_ranges(const model_t& described);

}  // namespace throng
