// ArchiveHdf5 reads HDF5 files of the archive: a dataset `trajectory` with columns id, frame, x, y
// and perhaps z. An attribute gives fps; wkt_geometry may give the walkable area.
#include <fmt/format.h>
#include <hdf5.h>

#include <array>
#include <cmath>
#include <utility>

#include "base/errors.h"
#include "base/text.h"
#include "recordings/readers/column_name.h"
#include "recordings/readers/header_comments.h"
#include "recordings/readers/sandboxed_samples.h"
#include "recordings/readers/table_columns.h"

namespace throng {
namespace {

constexpr const char* kExpectedHdf5 =
    "an HDF5 file with a dataset trajectory of id, frame, x, y, z";
constexpr hsize_t kRowsPerRead = 8192;
constexpr size_t kMaxTextBytes = 1 << 20;

class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  hid_t id() const { return id_; }
  explicit operator bool() const { return id_ >= 0; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

struct Row {
  int64_t id, frame;
  double x, y, z, time;
};

class RowType {
 public:
  explicit RowType(hid_t file_type) : type_(H5Tcreate(H5T_COMPOUND, sizeof(Row)), H5Tclose) {
    if (H5Tget_class(file_type) != H5T_COMPOUND)
      throw ParseFailure(kExpectedHdf5, "a dataset without columns");
    for (int i = 0; i < H5Tget_nmembers(file_type); ++i) {
      char* const name = H5Tget_member_name(file_type, static_cast<unsigned>(i));
      names_.emplace_back(name == nullptr ? "" : name);
      H5free_memory(name);
    }
    columns_ = columns_by_name(names_, {}, "");
    add(file_type, ColumnRole::kId, HOFFSET(Row, id), true);
    add(file_type, ColumnRole::kFrame, HOFFSET(Row, frame), true);
    add(file_type, ColumnRole::kX, HOFFSET(Row, x), false);
    add(file_type, ColumnRole::kY, HOFFSET(Row, y), false);
    if (has_z()) add(file_type, ColumnRole::kZ, HOFFSET(Row, z), false);
    time_ = time_scale(columns_);
    if (time_ && !is_number(file_type, ColumnRole::kTime)) time_.reset();
    if (time_) add(file_type, ColumnRole::kTime, HOFFSET(Row, time), false);
  }
  hid_t id() const { return type_.id(); }
  const std::optional<UnitScale>& time() const { return time_; }
  bool has_z() const { return columns_.has(ColumnRole::kZ); }
  const std::string& name_of(ColumnRole role) const { return names_[columns_[role]]; }
  /// Unit in the name of a column, or its remark; empty: none.
  const std::string& unit_of(ColumnRole role) const {
    const std::string& unit = columns_.units[static_cast<size_t>(role)];
    return unit.empty() ? columns_.remarks[static_cast<size_t>(role)] : unit;
  }

 private:
  bool is_number(hid_t file_type, ColumnRole role) const {
    const H5T_class_t kind = H5Tget_member_class(file_type, static_cast<unsigned>(columns_[role]));
    return kind == H5T_INTEGER || kind == H5T_FLOAT;
  }
  void add(hid_t file_type, ColumnRole role, size_t offset, bool is_whole) {
    if (!columns_.has(role))
      throw ParseFailure(kExpectedHdf5, fmt::format("one without the column {}",
                                                    kColumnRoleNames[static_cast<size_t>(role)]));
    const std::string& name = name_of(role);
    const H5T_class_t kind = H5Tget_member_class(file_type, static_cast<unsigned>(columns_[role]));
    if (kind != H5T_INTEGER && (is_whole || kind != H5T_FLOAT))
      throw ParseFailure(fmt::format("{}numbers in the column {} of the dataset trajectory",
                                     is_whole ? "whole " : "", escaped(name)),
                         "something else");
    H5Tinsert(type_.id(), name.c_str(), offset, is_whole ? H5T_NATIVE_INT64 : H5T_NATIVE_DOUBLE);
  }

  Handle type_;
  std::vector<std::string> names_;
  TableColumns columns_;
  std::optional<UnitScale> time_;
};

bool has_text(hid_t object, const char* name) {
  if (H5Aexists(object, name) <= 0) return false;
  const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
  const Handle type(H5Aget_type(attribute.id()), H5Tclose);
  const Handle space(H5Aget_space(attribute.id()), H5Sclose);
  return H5Tget_class(type.id()) == H5T_STRING && H5Sget_simple_extent_npoints(space.id()) == 1;
}

double number_of(hid_t object, const char* name) {
  double out = std::nan("");
  if (H5Aexists(object, name) <= 0) return out;
  const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
  const Handle space(H5Aget_space(attribute.id()), H5Sclose);
  if (H5Sget_simple_extent_npoints(space.id()) != 1)
    throw ParseFailure(fmt::format("one number as attribute {}", name), "none or several");
  if (H5Aread(attribute.id(), H5T_NATIVE_DOUBLE, &out) < 0)
    throw ParseFailure(fmt::format("a number as attribute {}", name), "something else");
  return out;
}

std::string text_of(hid_t object, const char* name) {
  if (H5Aexists(object, name) <= 0) return "";
  const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
  const Handle type(H5Aget_type(attribute.id()), H5Tclose);
  const Handle space(H5Aget_space(attribute.id()), H5Sclose);
  if (H5Tget_class(type.id()) != H5T_STRING || H5Sget_simple_extent_npoints(space.id()) != 1)
    throw ParseFailure(fmt::format("a text as attribute {}", name), "something else");
  if (H5Tis_variable_str(type.id()) > 0) {
    char* text = nullptr;
    if (H5Aread(attribute.id(), type.id(), static_cast<void*>(&text)) < 0 || text == nullptr)
      throw ParseFailure(fmt::format("a text as attribute {}", name), "an unreadable one");
    std::string out(text, ::strnlen(text, kMaxTextBytes));
    H5free_memory(text);
    return out;
  }
  std::string out(std::min(H5Tget_size(type.id()), kMaxTextBytes), '\0');
  if (H5Tget_size(type.id()) > out.size() || H5Aread(attribute.id(), type.id(), out.data()) < 0)
    throw ParseFailure(fmt::format("a text as attribute {}", name), "an unreadable one");
  out.resize(::strnlen(out.data(), out.size()));
  return std::string(trimmed(out));
}

double rate_of(hid_t object, const RecordingOptions& options) {
  return has_text(object, "fps") ? parsed_rate(text_of(object, "fps"), "the attribute fps", options)
                                 : number_of(object, "fps");
}

/// Units of x, y and z: from column names, attributes such as "pedestrian x-coordinate (meter
/// [m])", or one for all.
std::array<std::string, 3> units_of(hid_t file, hid_t dataset, const RowType& type,
                                    const RecordingOptions& options) {
  std::array<std::string, 3> out;
  std::string of_all;
  for (const hid_t object : {dataset, file})
    for (const char* name : {"unit", "units", "length_unit"})
      if (has_text(object, name))
        state_unit(of_all, bare_unit(text_of(object, name)), fmt::format("the attribute {}", name),
                   options);
  constexpr std::array kAxes = {ColumnRole::kX, ColumnRole::kY, ColumnRole::kZ};
  for (size_t axis = 0; axis < kAxes.size(); ++axis) {
    if (kAxes[axis] == ColumnRole::kZ && !type.has_z()) continue;
    const std::string& name = type.name_of(kAxes[axis]);
    out[axis] = type.unit_of(kAxes[axis]);
    if (has_text(dataset, name.c_str()))
      state_unit(out[axis],
                 unit_in_description(folded(text_of(dataset, name.c_str())), Quantity::kLength),
                 fmt::format("the attribute {}", escaped(name)), options);
    state_unit(out[axis], of_all, fmt::format("the unit of {}", escaped(name)), options);
  }
  return out;
}

void send_rows(hid_t dataset, const RowType& type, SampleSender& sender) {
  const Handle space(H5Dget_space(dataset), H5Sclose);
  if (H5Sget_simple_extent_ndims(space.id()) != 1)
    throw ParseFailure(kExpectedHdf5, "one of another shape");
  hsize_t count = 0;
  H5Sget_simple_extent_dims(space.id(), &count, nullptr);
  std::vector<Row> rows(static_cast<size_t>(std::min(count, kRowsPerRead)));
  for (hsize_t at = 0; at < count;) {
    const hsize_t some = std::min(kRowsPerRead, count - at);
    const Handle memory(H5Screate_simple(1, &some, nullptr), H5Sclose);
    H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, &at, nullptr, &some, nullptr);
    if (H5Dread(dataset, type.id(), memory.id(), space.id(), H5P_DEFAULT, rows.data()) < 0)
      throw ParseFailure(kExpectedHdf5, fmt::format("one with unreadable rows from {} on", at + 1));
    for (size_t i = 0; i < some; ++i)
      sender.sample({.id = rows[i].id,
                     .frame = rows[i].frame,
                     .x = rows[i].x,
                     .y = rows[i].y,
                     .z = type.has_z() ? static_cast<float>(rows[i].z)
                                       : std::numeric_limits<float>::quiet_NaN(),
                     .time_s = type.time() ? type.time()->si(rows[i].time) : std::nan("")});
    at += some;
  }
}

void parse_hdf5(const RegularFile& file, const RecordingOptions& options, SampleSender& sender) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  H5PLset_loading_state(0);  // no plugins: files may name filters
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_file_locking(access.id(), false, true);
  const Handle opened(H5Fopen(path_of(file).c_str(), H5F_ACC_RDONLY, access.id()), H5Fclose);
  if (!opened) throw ParseFailure(kExpectedHdf5, "one that is damaged or cut short");
  const Handle dataset(H5Dopen2(opened.id(), "trajectory", H5P_DEFAULT), H5Dclose);
  if (!dataset) throw ParseFailure(kExpectedHdf5, "one without such a dataset");
  ParsedFacts facts;
  for (const hid_t object : {dataset.id(), opened.id()})
    state_rate(facts.fps, rate_of(object, options), "the attribute fps", options);
  facts.wkt = text_of(opened.id(), "wkt_geometry");
  if (facts.wkt.empty()) facts.wkt = text_of(dataset.id(), "wkt_geometry");
  const Handle file_type(H5Dget_type(dataset.id()), H5Tclose);
  const RowType type(file_type.id());
  facts.units = units_of(opened.id(), dataset.id(), type, options);
  sender.facts(facts);
  send_rows(dataset.id(), type, sender);
}

class ArchiveHdf5 final : public RecordingReader {
 public:
  std::string_view kind() const override { return "archive HDF5"; }
  bool knows(std::string_view head) const override { return head.starts_with("\x89HDF\r\n\x1a\n"); }

  void read(const RecordingSource& source, RecordingBuilder& builder) const override {
    reject_packed(source, *this);
    const SandboxedKind foreign{.parser = {.library = "HDF5",
                                           .expected = kExpectedHdf5,
                                           .remedy = "export it again, for example as text"},
                                .kind = kind(),
                                .tracked_point = TrackedPoint::kHead};
    read_sandboxed(source, foreign, parse_hdf5, builder);
  }
};

}  // namespace

const RecordingReader& archive_hdf5_reader() {
  static const ArchiveHdf5 reader;
  return reader;
}

}  // namespace throng
