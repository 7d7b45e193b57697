// Occupancy grids are maps of robots: a map.yaml and a PGM or PNG image. Free cells are walkable.
#include <fmt/format.h>
#include <png.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <csetjmp>
#include <cstring>
#include <span>

#include "base/errors.h"
#include "base/limits.h"
#include "base/text.h"
#include "scenes/file/yaml_tree.h"
#include "scenes/import/grid_outline.h"
#include "scenes/import/plan_readers.h"

namespace throng {
namespace {

constexpr const char* kExpectedImage = "a PGM or PNG image of an occupancy grid";
constexpr const char* kConvert = "convert it with `convert IMAGE map.pgm`";
constexpr std::string_view kPngSignature("\x89PNG\r\n\x1a\n", 8);
constexpr uint64_t kMaxPixels = 100'000'000;
constexpr uint64_t kMaxInterlacedBytes = uint64_t{256} << 20;
constexpr double kMaxResolution_m = 1000;
/// Smaller free areas are noise of the scanner.
constexpr double kMinArea_m2 = 1;

enum class MapMode { kTrinary, kScale, kRaw };
enum MapCell : uint8_t { kFree, kOccupied, kUnknown };

struct MapFile {
  std::filesystem::path image;
  double resolution_m = 0;
  Eigen::Vector2d origin_m = Eigen::Vector2d::Zero();  ///< lower left corner of the map
  double yaw_rad = 0;
  bool is_negated = false;
  double occupied_above = 0, free_below = 0;
  MapMode mode = MapMode::kTrinary;
  std::vector<std::string> unused_keys;
};

struct MapCells {
  int64_t width = 0, height = 0;
  std::vector<uint8_t> cells;  ///< MapCell, in rows from the bottom
  bool has_opacity = false;
};

// ---- map.yaml

class MapReader {
 public:
  explicit MapReader(const std::filesystem::path& file) : file_(file) {}

  MapFile read() {
    root_ = parse_yaml(read_text_file(file_, kMaxYamlBytes), file_.string());
    if (root_.kind != YamlNode::Kind::kMap)
      throw InputError(file_.string(), "the keys of a map.yaml", "something else");
    MapFile map;
    const YamlNode& image = scalar("image", "the name of a PGM or PNG image");
    map.image = image.scalar;
    if (map.image.empty() || image.scalar.find('\0') != std::string::npos)
      reject(image, "the name of a PGM or PNG image", in_quotes(image.scalar));
    if (map.image.is_relative()) map.image = file_.parent_path() / map.image;
    map.resolution_m =
        number("resolution", "the edge of a cell in metres, above 0 and at most 1000",
               [](double v) { return v > 0 && v <= kMaxResolution_m; });
    read_origin(map);
    if (const YamlNode* negate = find("negate")) map.is_negated = flag(*negate);
    constexpr const char* kShare = "a number from 0 to 1";
    const auto is_share = [](double v) { return v >= 0 && v <= 1; };
    map.occupied_above = number("occupied_thresh", kShare, is_share);
    map.free_below = number("free_thresh", kShare, is_share);
    if (map.free_below > map.occupied_above)
      reject(*find("free_thresh"), fmt::format("at most occupied_thresh, {}", map.occupied_above),
             fmt::format("{}", map.free_below));
    read_mode(map);
    for (const YamlEntry& entry : root_.entries)
      if (std::find(used_.begin(), used_.end(), entry.key) == used_.end())
        map.unused_keys.push_back(entry.key);
    return map;
  }

 private:
  [[noreturn]] void reject(const YamlNode& node, const std::string& expected,
                           const std::string& found) const {
    throw InputError(at_line(file_.string(), node.line), expected, found);
  }

  const YamlNode* find(std::string_view key) {
    used_.emplace_back(key);
    for (const YamlEntry& entry : root_.entries)
      if (entry.key == key) return &entry.value;
    return nullptr;
  }

  const YamlNode& scalar(const std::string& key, const std::string& expected) {
    const YamlNode* const node = find(key);
    if (node == nullptr)
      throw InputError(file_.string(), fmt::format("the key '{}': {}", key, expected),
                       "no such key; add it, as map_saver writes it");
    if (node->kind != YamlNode::Kind::kScalar)
      reject(*node, expected + " as " + key, "a list, a map or nothing");
    return *node;
  }

  double number_of(const YamlNode& node, const std::string& expected) const {
    std::string_view text = node.scalar;
    if (text.starts_with('+')) text.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (node.kind != YamlNode::Kind::kScalar || error != std::errc() || text.empty() ||
        end != text.data() + text.size() || !std::isfinite(value))
      reject(node, expected,
             node.kind == YamlNode::Kind::kScalar ? in_quotes(node.scalar)
                                                  : "a list, a map or nothing");
    return value;
  }

  template <typename Check>
  double number(const std::string& key, const std::string& expected, const Check& check) {
    const YamlNode& node = scalar(key, expected);
    const double value = number_of(node, expected + " as " + key);
    if (!check(value)) reject(node, expected + " as " + key, in_quotes(node.scalar));
    return value;
  }

  bool flag(const YamlNode& node) const {
    for (const char* yes : {"1", "true", "True"})
      if (node.scalar == yes) return true;
    for (const char* no : {"0", "false", "False"})
      if (node.scalar == no) return false;
    reject(node, "0 or 1 as negate", in_quotes(node.scalar));
  }

  void read_origin(MapFile& map) {
    constexpr const char* kOrigin = "[x, y, yaw] of the lower left corner in metres and radians";
    const YamlNode* const node = find("origin");
    if (node == nullptr)
      throw InputError(file_.string(), std::string("the key 'origin': ") + kOrigin,
                       "no such key; add it, as map_saver writes it");
    if (node->kind != YamlNode::Kind::kList || node->items.size() != 3)
      reject(*node, std::string(kOrigin) + " as origin",
             node->kind == YamlNode::Kind::kList ? counted(node->items.size(), "number")
                                                 : "something else");
    std::array<double, 3> pose{};
    for (size_t i = 0; i < pose.size(); ++i) {
      pose[i] = number_of(node->items[i], std::string(kOrigin) + " as origin");
      if (std::abs(pose[i]) > 1e8)
        reject(node->items[i], std::string(kOrigin) + " as origin",
               in_quotes(node->items[i].scalar));
    }
    map.origin_m = {pose[0], pose[1]};
    map.yaw_rad = pose[2];
  }

  void read_mode(MapFile& map) {
    const YamlNode* const node = find("mode");
    if (node == nullptr || node->scalar == "trinary") return;
    if (node->scalar == "scale")
      map.mode = MapMode::kScale;
    else if (node->scalar == "raw")
      map.mode = MapMode::kRaw;
    else
      reject(*node, "trinary, scale or raw as mode", in_quotes(node->scalar));
    if (map.mode == MapMode::kRaw && map.is_negated)
      reject(*find("negate"), "0 as negate of a raw map, whose values are percentages", "1");
  }

  const std::filesystem::path& file_;
  YamlNode root_;
  std::vector<std::string> used_;
};

// ---- cells of an image

/// MapCell of a pixel: `sum` over `channels` values up to `max`.
class CellClasses {
 public:
  explicit CellClasses(const MapFile& map) : map_(map) {}

  MapCell cell_of(uint32_t sum, uint32_t channels, uint32_t max, bool is_opaque) const {
    const double whole = static_cast<double>(max) * channels;
    if (!is_opaque) return kUnknown;
    double occupied = (map_.is_negated ? sum : whole - sum) / whole;
    if (map_.mode == MapMode::kRaw) {
      const double percent = std::round(sum / whole * 255);
      if (percent > 100) return kUnknown;
      occupied = percent / 100;
    }
    if (occupied > map_.occupied_above) return kOccupied;
    return occupied < map_.free_below ? kFree : kUnknown;
  }

  /// MapCells of all grey values, for images of one channel.
  std::vector<uint8_t> table(uint32_t max) const {
    std::vector<uint8_t> out(max + 1);
    for (uint32_t value = 0; value <= max; ++value) out[value] = cell_of(value, 1, max, true);
    return out;
  }

 private:
  const MapFile& map_;
};

MapCells sized_cells(uint64_t width, uint64_t height) {
  if (width == 0 || height == 0 || width > kMaxPixels || height > kMaxPixels ||
      width * height > kMaxPixels)
    throw ParseFailure("an image of 1 to 100 million pixels",
                       fmt::format("{} by {}; scale it down", width, height));
  return {static_cast<int64_t>(width), static_cast<int64_t>(height),
          std::vector<uint8_t>(width * height), false};
}

class PgmImage {
 public:
  PgmImage(std::span<const uint8_t> bytes, const CellClasses& classes)
      : bytes_(bytes), classes_(classes) {}

  MapCells read() {
    const bool is_text = bytes_[1] == '2';
    at_ = 2;
    const uint32_t width = whole("the width", kMaxPixels);
    const uint32_t height = whole("the height", kMaxPixels);
    const uint32_t max = whole("the largest value, 1 to 65535,", 65'535);
    if (max == 0) throw ParseFailure("1 to 65535 as the largest value of the PGM image", "0");
    MapCells out = sized_cells(width, height);
    const std::vector<uint8_t> table = classes_.table(max);
    ++at_;  // one blank
    const size_t bytes_each = max > 255 ? 2 : 1, needed = out.cells.size() * bytes_each;
    if (!is_text && (at_ > bytes_.size() || bytes_.size() - at_ < needed))
      throw ParseFailure(fmt::format("{} bytes of pixels", needed),
                         fmt::format("{}", bytes_.size() - std::min(at_, bytes_.size())));
    for (uint32_t row = 0; row < height; ++row) {
      uint8_t* const cells = out.cells.data() + uint64_t{height - 1 - row} * width;
      for (uint32_t x = 0; x < width; ++x) {
        uint32_t value = 0;
        if (is_text) {
          value = whole("a grey value", max);
        } else {
          value = bytes_[at_++];
          if (bytes_each == 2) value = value << 8 | bytes_[at_++];
        }
        if (value > max)
          throw ParseFailure(fmt::format("grey values of at most {}", max),
                             fmt::format("{}", value));
        cells[x] = table[value];
      }
    }
    return out;
  }

 private:
  uint32_t whole(const char* what, uint64_t max) {
    for (; at_ < bytes_.size(); ++at_) {
      if (bytes_[at_] == '#')
        while (at_ < bytes_.size() && bytes_[at_] != '\n') ++at_;
      else if (std::isspace(bytes_[at_]) == 0)
        break;
      if (at_ == bytes_.size()) break;
    }
    uint64_t value = 0;
    const size_t begin = at_;
    for (; at_ < bytes_.size() && std::isdigit(bytes_[at_]) != 0; ++at_) {
      value = 10 * value + (bytes_[at_] - uint64_t{'0'});
      if (value > max)
        throw ParseFailure(fmt::format("{} of at most {} in the PGM image", what, max),
                           "a larger number");
    }
    if (at_ == begin)
      throw ParseFailure(fmt::format("{} as a whole number in the PGM image", what),
                         at_ < bytes_.size() ? "something else" : "the end of the file");
    return static_cast<uint32_t>(value);
  }

  std::span<const uint8_t> bytes_;
  const CellClasses& classes_;
  size_t at_ = 0;
};

/// libpng jumps out of its functions on errors. Hence the functions that call it hold no objects
/// with destructors.
class PngImage {
 public:
  PngImage(std::span<const uint8_t> bytes, const CellClasses& classes)
      : rest_(bytes), classes_(classes) {
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, fail, [](png_structp, auto) {});
    info_ = png_ != nullptr ? png_create_info_struct(png_) : nullptr;
    if (info_ == nullptr) throw std::bad_alloc();
    png_set_read_fn(png_, this, read_bytes);
    png_set_user_limits(png_, kMaxPixels, kMaxPixels);
    png_set_chunk_malloc_max(png_, 8 << 20);
    png_set_chunk_cache_max(png_, 64);
  }
  ~PngImage() { png_destroy_read_struct(&png_, &info_, nullptr); }
  PngImage(const PngImage&) = delete;
  PngImage& operator=(const PngImage&) = delete;

  MapCells read() {
    if (!read_header()) throw ParseFailure(kExpectedImage, "a PNG image with an error: " + error());
    out_ = sized_cells(width_, height_);
    if (!set_transforms())
      throw ParseFailure(kExpectedImage, "a PNG image with an error: " + error());
    out_.has_opacity = has_opacity_;
    if (passes_ > 1 && row_bytes_ * height_ > kMaxInterlacedBytes)
      throw ParseFailure("an image without interlacing, as it is large",
                         fmt::format("{} by {} interlaced pixels", width_, height_));
    pixels_.resize(passes_ > 1 ? row_bytes_ * height_ : row_bytes_);
    table_ = classes_.table(max_);
    if (!read_rows()) throw ParseFailure(kExpectedImage, "a PNG image with an error: " + error());
    return std::move(out_);
  }

 private:
  static void fail(png_structp png, png_const_charp message) {
    auto& self = *static_cast<PngImage*>(png_get_error_ptr(png));
    std::strncpy(self.message_.data(), message, self.message_.size() - 1);
    png_longjmp(png, 1);
  }
  static void read_bytes(png_structp png, png_bytep out, size_t count) {
    auto& self = *static_cast<PngImage*>(png_get_io_ptr(png));
    if (count > self.rest_.size()) png_error(png, "the file ends early");
    std::memcpy(out, self.rest_.data(), count);
    self.rest_ = self.rest_.subspan(count);
  }
  std::string error() const { return in_quotes(message_.data()); }

  bool read_header() {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_read_info(png_, info_);
    width_ = png_get_image_width(png_, info_);
    height_ = png_get_image_height(png_, info_);
    return true;
  }

  /// Palettes, few bits and transparent colours become grey or colours of 8 or 16 bits, and
  /// opacity.
  bool set_transforms() {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_set_expand(png_);
    passes_ = png_set_interlace_handling(png_);
    png_read_update_info(png_, info_);
    row_bytes_ = png_get_rowbytes(png_, info_);
    channels_ = png_get_channels(png_, info_);
    has_opacity_ = channels_ == 2 || channels_ == 4;
    bytes_each_ = png_get_bit_depth(png_, info_) / 8u;
    max_ = bytes_each_ == 2 ? 65'535 : 255;
    return true;
  }

  bool read_rows() {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    const bool is_whole = passes_ > 1;
    for (int pass = 0; pass < passes_; ++pass)
      for (uint32_t row = 0; row < height_; ++row) {
        uint8_t* const pixels = pixels_.data() + (is_whole ? row * row_bytes_ : 0);
        png_read_row(png_, pixels, nullptr);
        if (pass + 1 == passes_) classify(row, pixels);
      }
    png_read_end(png_, nullptr);
    return true;
  }

  uint32_t value(const uint8_t* bytes) const {
    return bytes_each_ == 2 ? uint32_t{bytes[0]} << 8 | bytes[1] : bytes[0];
  }

  void classify(uint32_t row, const uint8_t* pixels) {
    uint8_t* const cells = out_.cells.data() + uint64_t{height_ - 1 - row} * width_;
    const uint32_t colours = has_opacity_ ? channels_ - 1 : channels_;
    for (uint32_t x = 0; x < width_; ++x, pixels += channels_ * bytes_each_) {
      if (channels_ == 1) {
        cells[x] = table_[value(pixels)];
        continue;
      }
      uint32_t sum = 0;
      for (uint32_t i = 0; i < colours; ++i) sum += value(pixels + i * bytes_each_);
      const bool is_opaque = !has_opacity_ || value(pixels + colours * bytes_each_) == max_;
      cells[x] = classes_.cell_of(sum, colours, max_, is_opaque);
    }
  }

  std::span<const uint8_t> rest_;
  const CellClasses& classes_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  std::array<char, 100> message_{};
  MapCells out_;
  std::vector<uint8_t> pixels_, table_;
  uint32_t width_ = 0, height_ = 0, channels_ = 1, bytes_each_ = 1, max_ = 255;
  size_t row_bytes_ = 0;
  int passes_ = 1;
  bool has_opacity_ = false;
};

bool is_pgm_image(std::string_view head) {
  return head.size() > 2 && head[0] == 'P' && (head[1] == '2' || head[1] == '5') &&
         (std::isspace(static_cast<unsigned char>(head[2])) != 0 || head[2] == '#');
}

MapCells read_cells(const RegularFile& file, const MapFile& map) {
  const std::vector<uint8_t> bytes = file.bytes();
  const std::string_view head(reinterpret_cast<const char*>(bytes.data()),
                              std::min<size_t>(bytes.size(), 16));
  const CellClasses classes(map);
  if (is_pgm_image(head)) return PgmImage(bytes, classes).read();
  if (head.starts_with(kPngSignature)) return PngImage(bytes, classes).read();
  throw ParseFailure(kExpectedImage, fmt::format("{}; {}", in_quotes(head.substr(0, 8)), kConvert));
}

// ---- plan

std::string map_cells_text(int64_t count, double resolution_m) {
  return fmt::format("{} ({:.1f} m²)", counted(count, "cell"),
                     static_cast<double>(count) * resolution_m * resolution_m);
}

ImportedPlan grid_plan(MapCells image, const MapFile& map) {
  std::array<int64_t, 3> count{};
  for (const uint8_t cell : image.cells) ++count[cell];
  const double cell_m2 = map.resolution_m * map.resolution_m;
  if (count[kFree] == 0)
    throw ParseFailure("free cells",
                       fmt::format("{} occupied and {} unknown ones; check negate, mode and "
                                   "free_thresh of the map.yaml",
                                   count[kOccupied], count[kUnknown]));
  for (uint8_t& cell : image.cells) cell = cell == kFree ? 1 : 0;
  const double min_cells = std::min(std::ceil(kMinArea_m2 / cell_m2 * (1 - 1e-9)), 1e15);
  GridOutline outline = outline_of({image.width, image.height, std::move(image.cells)},
                                   static_cast<int64_t>(min_cells), kMaxPlanVertices);
  if (outline.is_too_detailed)
    throw ParseFailure(
        fmt::format("borders of at most {} vertices after straightening", kMaxPlanVertices),
        "more; remove noise from the image with a median filter, or scale it down");
  const Eigen::Rotation2Dd turn(map.yaw_rad);
  const auto place = [&](Polygon::Ring& ring) {
    for (Eigen::Vector2d& corner : ring) {
      corner *= map.resolution_m;
      if (map.yaw_rad != 0) corner = turn * corner;
      corner += map.origin_m;
    }
  };
  for (Polygon& polygon : outline.polygons) {
    place(polygon.outline);
    for (Polygon::Ring& hole : polygon.holes) place(hole);
  }
  ImportedPlan plan;
  plan.kind = "ROS occupancy grid";
  plan.walkable = std::move(outline.polygons);
  plan.unit_m = 1;
  plan.used.push_back(fmt::format("{} by {} cells of {} m: {} free, {} occupied", image.width,
                                  image.height, map.resolution_m, count[kFree], count[kOccupied]));
  if (image.has_opacity)
    plan.used.emplace_back(
        "opacity: pixels that are not opaque are unknown, of others it is ignored");
  if (count[kUnknown] > 0)
    plan.left_out.push_back("unknown, not walkable: " +
                            map_cells_text(count[kUnknown], map.resolution_m));
  if (outline.areas_left_out > 0)
    plan.left_out.push_back(fmt::format("{} below {} m² or a thousandth of the largest: {}",
                                        counted(outline.areas_left_out, "free area"), kMinArea_m2,
                                        map_cells_text(outline.cells_left_out, map.resolution_m)));
  for (const std::string& key : map.unused_keys)
    plan.left_out.push_back(fmt::format("key {} of the map.yaml", in_quotes(key)));
  return plan;
}

/// Whether a line begins with the key of a map.
bool has_map_key(std::string_view text, std::string_view key) {
  for (size_t at = text.find(key); at != text.npos; at = text.find(key, at + 1)) {
    const char before = at == 0 ? '\n' : text[at - 1];
    size_t after = at + key.size();
    if (after < text.size() && (text[after] == '"' || text[after] == '\'')) ++after;
    while (after < text.size() && text[after] == ' ') ++after;
    if (after < text.size() && text[after] == ':' &&
        std::string_view("\n\r \t{,\"'").find(before) != std::string_view::npos)
      return true;
  }
  return false;
}

bool is_map_image(std::string_view head) {
  return is_pgm_image(head) || head.starts_with(kPngSignature);
}

}  // namespace

bool is_occupancy_grid(std::string_view head) {
  return is_map_image(head) || (has_map_key(head, "image") && has_map_key(head, "resolution"));
}

ImportedPlan read_occupancy_grid(const ImportOptions& options) {
  {
    const RegularFile file(options.file, "the map.yaml of an occupancy grid", kMaxPlanImageBytes);
    std::array<char, 16> head{};
    const size_t size = std::min<size_t>(head.size(), file.size());
    file.read(std::as_writable_bytes(std::span(head).first(size)));
    if (is_map_image({head.data(), size}))
      throw InputError(options.file.string(),
                       "the map.yaml of an occupancy grid, which states resolution and origin",
                       "its image alone; name the map.yaml instead");
  }
  const MapFile map = MapReader(options.file).read();
  const RegularFile image(map.image, kExpectedImage, kMaxPlanImageBytes);
  const SandboxedParser parser{
      .library = "the image reader", .expected = kExpectedImage, .remedy = kConvert};
  return read_plan_sandboxed(
      image, parser, [&](const RegularFile& file) { return grid_plan(read_cells(file, map), map); },
      kMaxPlanImageBytes);
}

}  // namespace throng
