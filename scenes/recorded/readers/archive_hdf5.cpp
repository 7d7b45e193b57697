// HDF5 as the archive of experiments has it: a dataset `trajectory` of id, frame, x, y and perhaps
// z, with an attribute fps; an attribute wkt_geometry may say where people can walk.
#include <fmt/format.h>
#include <hdf5.h>

#include <array>
#include <cmath>
#include <utility>

#include "base/errors.h"
#include "base/text.h"
#include "scenes/recorded/readers/foreign_samples.h"

namespace throng {
namespace {

constexpr const char* kExpectedHdf5 =
    "an HDF5 file with a dataset trajectory of id, frame, x, y, z";
constexpr hsize_t kRowsATime = 8192;
constexpr size_t kMostTextBytes = 1 << 20;

/// What HDF5 lends, given back.
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
  double x, y, z;
};

/// As the file has its columns, in our layout.
class RowType {
 public:
  explicit RowType(hid_t file_type) : type_(H5Tcreate(H5T_COMPOUND, sizeof(Row)), H5Tclose) {
    if (H5Tget_class(file_type) != H5T_COMPOUND)
      throw Refusal(kExpectedHdf5, "one that has no columns");
    add(file_type, "id", HOFFSET(Row, id), true);
    add(file_type, "frame", HOFFSET(Row, frame), true);
    add(file_type, "x", HOFFSET(Row, x), false);
    add(file_type, "y", HOFFSET(Row, y), false);
    has_z_ = H5Tget_member_index(file_type, "z") >= 0;
    if (has_z_) add(file_type, "z", HOFFSET(Row, z), false);
  }
  hid_t id() const { return type_.id(); }
  bool has_z() const { return has_z_; }

 private:
  void add(hid_t file_type, const char* name, size_t offset, bool is_whole) {
    const int index = H5Tget_member_index(file_type, name);
    if (index < 0) throw Refusal(kExpectedHdf5, fmt::format("one without the column {}", name));
    const H5T_class_t kind = H5Tget_member_class(file_type, static_cast<unsigned>(index));
    if (kind != H5T_INTEGER && (is_whole || kind != H5T_FLOAT))
      throw Refusal(fmt::format("{}numbers in the column {} of the dataset trajectory",
                                is_whole ? "whole " : "", name),
                    "something else");
    H5Tinsert(type_.id(), name, offset, is_whole ? H5T_NATIVE_INT64 : H5T_NATIVE_DOUBLE);
  }

  Handle type_;
  bool has_z_ = false;
};

double number_of(hid_t object, const char* name) {
  double out = std::nan("");
  if (H5Aexists(object, name) <= 0) return out;
  const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
  const Handle space(H5Aget_space(attribute.id()), H5Sclose);
  if (H5Sget_simple_extent_npoints(space.id()) != 1)
    throw Refusal(fmt::format("one number as attribute {}", name), "none or several");
  if (H5Aread(attribute.id(), H5T_NATIVE_DOUBLE, &out) < 0)
    throw Refusal(fmt::format("a number as attribute {}", name), "something else");
  return out;
}

std::string text_of(hid_t object, const char* name) {
  if (H5Aexists(object, name) <= 0) return "";
  const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
  const Handle type(H5Aget_type(attribute.id()), H5Tclose);
  const Handle space(H5Aget_space(attribute.id()), H5Sclose);
  if (H5Tget_class(type.id()) != H5T_STRING || H5Sget_simple_extent_npoints(space.id()) != 1)
    throw Refusal(fmt::format("a text as attribute {}", name), "something else");
  if (H5Tis_variable_str(type.id()) > 0) {
    char* text = nullptr;
    if (H5Aread(attribute.id(), type.id(), static_cast<void*>(&text)) < 0 || text == nullptr)
      throw Refusal(fmt::format("a text as attribute {}", name), "one that cannot be read");
    std::string out(text, ::strnlen(text, kMostTextBytes));
    H5free_memory(text);
    return out;
  }
  std::string out(std::min(H5Tget_size(type.id()), kMostTextBytes), '\0');
  if (H5Tget_size(type.id()) > out.size() || H5Aread(attribute.id(), type.id(), out.data()) < 0)
    throw Refusal(fmt::format("a text as attribute {}", name), "one that cannot be read");
  // Padded with zeros or blanks.
  out.resize(::strnlen(out.data(), out.size()));
  return std::string(trimmed(out));
}

void send_rows(hid_t dataset, const RowType& type, ForeignSender& sender) {
  const Handle space(H5Dget_space(dataset), H5Sclose);
  if (H5Sget_simple_extent_ndims(space.id()) != 1)
    throw Refusal(kExpectedHdf5, "one of another shape");
  hsize_t count = 0;
  H5Sget_simple_extent_dims(space.id(), &count, nullptr);
  std::vector<Row> rows(static_cast<size_t>(std::min(count, kRowsATime)));
  for (hsize_t at = 0; at < count;) {
    const hsize_t some = std::min(kRowsATime, count - at);
    const Handle memory(H5Screate_simple(1, &some, nullptr), H5Sclose);
    H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, &at, nullptr, &some, nullptr);
    if (H5Dread(dataset, type.id(), memory.id(), space.id(), H5P_DEFAULT, rows.data()) < 0)
      throw Refusal(kExpectedHdf5, fmt::format("one whose rows from {} on cannot be read", at + 1));
    for (size_t i = 0; i < some; ++i)
      sender.sample({.id = rows[i].id,
                     .frame = rows[i].frame,
                     .x_m = rows[i].x,
                     .y_m = rows[i].y,
                     .z_m = type.has_z() ? static_cast<float>(rows[i].z)
                                         : std::numeric_limits<float>::quiet_NaN()});
    at += some;
  }
}

/// In the child.
void parse_hdf5(const RegularFile& file, ForeignSender& sender) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  H5PLset_loading_state(0);  // a file names filters; none is loaded for it
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_file_locking(access.id(), false, true);
  const Handle opened(H5Fopen(path_of(file).c_str(), H5F_ACC_RDONLY, access.id()), H5Fclose);
  if (!opened) throw Refusal(kExpectedHdf5, "one that is damaged or cut short");
  const Handle dataset(H5Dopen2(opened.id(), "trajectory", H5P_DEFAULT), H5Dclose);
  if (!dataset) throw Refusal(kExpectedHdf5, "one without such a dataset");
  ForeignFacts facts;
  facts.fps = number_of(dataset.id(), "fps");
  if (std::isnan(facts.fps)) facts.fps = number_of(opened.id(), "fps");
  facts.wkt = text_of(opened.id(), "wkt_geometry");
  if (facts.wkt.empty()) facts.wkt = text_of(dataset.id(), "wkt_geometry");
  const Handle file_type(H5Dget_type(dataset.id()), H5Tclose);
  const RowType type(file_type.id());
  sender.facts(facts);
  send_rows(dataset.id(), type, sender);
}

class ArchiveHdf5 final : public RecordingReader {
 public:
  std::string_view kind() const override { return "archive HDF5"; }
  bool knows(std::string_view head) const override { return head.starts_with("\x89HDF\r\n\x1a\n"); }

  void read(const RecordingSource& source, RecordingBuilder& builder) const override {
    refuse_packed(source, *this);
    const ForeignKind foreign{.parser = {.library = "HDF5",
                                         .expected = kExpectedHdf5,
                                         .way_out = "export it again, for example as text"},
                              .kind = kind(),
                              .tracks = TrackedPoint::kHead};
    read_apart(source, foreign, parse_hdf5, builder);
  }
};

}  // namespace

const RecordingReader& archive_hdf5_reader() {
  static const ArchiveHdf5 reader;
  return reader;
}

}  // namespace throng
