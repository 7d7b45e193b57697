// Plan readers read one kind of floor plan each. A reader is chosen by the content of the file.
// Invariant: files are parsed in a child process, and what it sends is checked like a file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "base/files/regular_file.h"
#include "base/files/sandboxed_parser.h"
#include "scenes/import/imported_plan.h"

namespace throng {

/// Number of vertices of a plan at most.
inline constexpr size_t kMaxPlanVertices = kMaxVertices;
/// Bytes of a plan at most.
inline constexpr uint64_t kMaxPlanBytes = 64 << 20;
/// Bytes of a database, of which only the area is read, and of an image of a map at most.
inline constexpr uint64_t kMaxPlanDatabaseBytes = uint64_t{64} << 30;
inline constexpr uint64_t kMaxPlanImageBytes = uint64_t{512} << 20;
/// Bytes at the beginning of a file that decide its kind.
inline constexpr size_t kPlanHeadBytes = 64 << 10;

// Each is_...() decides by the first kPlanHeadBytes of a file. Each read_...() returns coordinates
// in units of the file, and the unit if the file states one. It opens options.file itself and reads
// through read_plan_sandboxed(). options.unit_m serves tolerances only.

bool is_wkt_plan(std::string_view head);
ImportedPlan read_wkt_plan(const ImportOptions& options);

bool is_geojson(std::string_view head);
ImportedPlan read_geojson(const ImportOptions& options);

bool is_dxf(std::string_view head);
ImportedPlan read_dxf(const ImportOptions& options);

/// The map.yaml of a ROS occupancy grid, or its image, for which read_occupancy_grid() asks for
/// the map.yaml.
bool is_occupancy_grid(std::string_view head);
ImportedPlan read_occupancy_grid(const ImportOptions& options);

bool is_jupedsim_database(std::string_view head);
ImportedPlan read_jupedsim_database(const ImportOptions& options);

/// The XML geometry of JuPedSim before version 1.
bool is_jupedsim_geometry(std::string_view head);
ImportedPlan read_jupedsim_geometry(const ImportOptions& options);

bool is_vadere_scenario(std::string_view head);
ImportedPlan read_vadere_scenario(const ImportOptions& options);

/// Runs `parse` on the file in a child process and returns the plan that it built. Checks for
/// finite coordinates, at most kMaxPlanVertices vertices, and valid names. `parse` throws
/// ParseFailure, or InputError for an error in a line; both become an InputError here.
ImportedPlan read_plan_sandboxed(const RegularFile& file, const SandboxedParser& parser,
                                 const std::function<ImportedPlan(const RegularFile&)>& parse,
                                 uint64_t max_bytes = kMaxPlanBytes);

/// Content of a file.
std::string plan_bytes(const RegularFile& file);
/// Content of a text file without byte order mark. Throws ParseFailure unless it is UTF-8.
std::string plan_text(const RegularFile& file, std::string_view expected);

}  // namespace throng
