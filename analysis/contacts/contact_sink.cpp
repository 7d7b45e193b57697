#include "analysis/contacts/contact_sink.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "analysis/part_names.h"
#include "base/files/atomic_file.h"
#include "base/text.h"
#include "scenes/run/sink.h"

namespace throng {
namespace {

/// Points within one cell are merged.
constexpr float kCell_m = 0.005f;
/// Offset that makes cell numbers positive: larger than the reach of any part.
constexpr int64_t kOrigin = 1 << 17;
constexpr uint64_t kMask = (1 << 18) - 1;
/// Standard deviation of the Gaussian that spreads the time of a point.
constexpr double kSpread_m = 0.02;
constexpr double kReach_m = 3 * kSpread_m;
constexpr float kPixel_m = 0.005f;

uint64_t cell_key(uint32_t part, const Eigen::Vector3f& point_m) {
  uint64_t key = part;
  for (int axis = 0; axis < 3; ++axis) {
    const auto cell = static_cast<int64_t>(std::floor(point_m[axis] / kCell_m)) + kOrigin;
    key = key << 18 | (static_cast<uint64_t>(cell) & kMask);
  }
  return key;
}

Eigen::Vector3f cell_centre(uint64_t key) {
  Eigen::Vector3f point_m;
  for (int axis = 2; axis >= 0; --axis, key >>= 18)
    point_m[axis] =
        (static_cast<float>(static_cast<int64_t>(key & kMask) - kOrigin) + 0.5f) * kCell_m;
  return point_m;
}

Eigen::Vector3f placed(const PartPose& pose, const Eigen::Vector3f& point_m) {
  return (to_isometry(pose) * point_m.cast<double>()).cast<float>();
}

/// Touched points, indexed for lookup by place.
class Neighbours {
 public:
  explicit Neighbours(const std::vector<BodyMap::TouchedPoint>& points) {
    for (const BodyMap::TouchedPoint& point : points)
      cells_[key(cell_of(point.at_m))].push_back(point);
  }

  /// Contact time per area, in s/cm2.
  double density(const Eigen::Vector3f& at_m) const {
    double sum = 0;
    const std::array<int, 3> cell = cell_of(at_m);
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        for (int z = -1; z <= 1; ++z) {
          const auto found = cells_.find(key({cell[0] + x, cell[1] + y, cell[2] + z}));
          if (found == cells_.end()) continue;
          for (const BodyMap::TouchedPoint& point : found->second) {
            const auto squared = static_cast<double>((point.at_m - at_m).squaredNorm());
            if (squared < kReach_m * kReach_m)
              sum += point.seconds * std::exp(-0.5 * squared / (kSpread_m * kSpread_m));
          }
        }
    return sum / (2 * M_PI * kSpread_m * kSpread_m * 1e4);
  }

 private:
  static std::array<int, 3> cell_of(const Eigen::Vector3f& at_m) {
    std::array<int, 3> cell{};
    for (int axis = 0; axis < 3; ++axis)
      cell[static_cast<size_t>(axis)] =
          static_cast<int>(std::floor(static_cast<double>(at_m[axis]) / kReach_m));
    return cell;
  }
  static uint64_t key(const std::array<int, 3>& cell) {
    uint64_t key = 0;
    for (const int number : cell) key = key << 20 | static_cast<uint32_t>(number + (1 << 19));
    return key;
  }

  std::unordered_map<uint64_t, std::vector<BodyMap::TouchedPoint>> cells_;
};

/// Pixels of a body at rest, seen from one side.
class View {
 public:
  struct Pixel {
    float depth_m = -std::numeric_limits<float>::infinity();
    float light = 0;
    Eigen::Vector3f at_m;
  };

  /// `turned` rotates the body for a camera that looks along -x, with y to the right and z up.
  View(const Model& model, const std::vector<PartPose>& rest, const Eigen::AlignedBox3f& box,
       const Eigen::Matrix3f& turned)
      : turned_(turned) {
    Eigen::AlignedBox3f bounds;
    for (int corner = 0; corner < 8; ++corner)
      bounds.extend(turned * box.corner(static_cast<Eigen::AlignedBox3f::CornerType>(corner)));
    left_m_ = bounds.min().y();
    top_m_ = bounds.max().z();
    width = static_cast<int>(std::ceil(bounds.sizes().y() / kPixel_m)) + 1;
    height = static_cast<int>(std::ceil(bounds.sizes().z() / kPixel_m)) + 1;
    pixels.resize(static_cast<size_t>(width) * static_cast<size_t>(height));
    for (size_t part = 0; part < model.parts.size(); ++part) {
      const Mesh& mesh = model.parts[part].mesh;
      for (const auto& triangle : mesh.triangles) {
        std::array<Eigen::Vector3f, 3> corners;
        for (size_t i = 0; i < 3; ++i)
          corners[i] =
              placed(rest[part], mesh.vertices[static_cast<size_t>(triangle[static_cast<int>(i)])]);
        fill(corners);
      }
    }
  }

  int width = 0, height = 0;
  std::vector<Pixel> pixels;  ///< row-major, from the top

 private:
  void fill(const std::array<Eigen::Vector3f, 3>& corners) {
    std::array<Eigen::Vector3f, 3> at;  // pixel to the right, pixel down, depth
    for (size_t i = 0; i < 3; ++i) {
      const Eigen::Vector3f p = turned_ * corners[i];
      at[i] = {(p.y() - left_m_) / kPixel_m, (top_m_ - p.z()) / kPixel_m, p.x()};
    }
    const Eigen::Vector2f e1 = (at[1] - at[0]).head<2>(), e2 = (at[2] - at[0]).head<2>();
    const float area = e1.x() * e2.y() - e1.y() * e2.x();
    if (area == 0) return;
    const Eigen::Vector3f normal =
        (turned_ * (corners[1] - corners[0]).cross(corners[2] - corners[0])).normalized();
    const Eigen::Vector3f low = at[0].cwiseMin(at[1]).cwiseMin(at[2]);
    const Eigen::Vector3f high = at[0].cwiseMax(at[1]).cwiseMax(at[2]);
    const int bottom = std::min(height - 1, static_cast<int>(high.y()));
    const int right = std::min(width - 1, static_cast<int>(high.x()));
    for (int y = std::max(0, static_cast<int>(low.y())); y <= bottom; ++y)
      for (int x = std::max(0, static_cast<int>(low.x())); x <= right; ++x) {
        const Eigen::Vector2f d(static_cast<float>(x) - at[0].x(),
                                static_cast<float>(y) - at[0].y());
        const float v = (d.x() * e2.y() - d.y() * e2.x()) / area;
        const float w = (e1.x() * d.y() - e1.y() * d.x()) / area;
        if (v < 0 || w < 0 || v + w > 1) continue;
        const float depth = at[0].z() + v * (at[1].z() - at[0].z()) + w * (at[2].z() - at[0].z());
        Pixel& pixel =
            pixels[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)];
        if (depth <= pixel.depth_m) continue;
        pixel.depth_m = depth;
        pixel.light = std::abs(normal.dot(Eigen::Vector3f(0.85f, 0.3f, 0.43f)));
        pixel.at_m = corners[0] + v * (corners[1] - corners[0]) + w * (corners[2] - corners[0]);
      }
  }

  Eigen::Matrix3f turned_;
  float left_m_ = 0, top_m_ = 0;
};

constexpr std::array<std::array<double, 3>, 5> kHeat = {
    {{214, 214, 218}, {254, 217, 118}, {253, 141, 60}, {227, 26, 28}, {110, 0, 38}}};

std::array<int, 3> colour_of(double share, double light) {
  const double place = std::clamp(share, 0.0, 1.0) * (kHeat.size() - 1);
  const size_t low = std::min(static_cast<size_t>(place), kHeat.size() - 2);
  const double between = place - static_cast<double>(low);
  std::array<int, 3> out{};
  for (size_t i = 0; i < 3; ++i)
    out[i] = static_cast<int>((0.55 + 0.45 * light) *
                              (kHeat[low][i] + between * (kHeat[low + 1][i] - kHeat[low][i])));
  return out;
}

}  // namespace

BodyMap::BodyMap(const RunInfo& run) : step_s_(run.step_s) {
  std::vector<int> people(run.models.size());
  for (const uint16_t model : run.model_of_avatar)
    if (run.models[model]->is_person) ++people[model];
  const auto max = std::max_element(people.begin(), people.end());
  if (max == people.end() || *max == 0) return;
  model_ = static_cast<int>(max - people.begin());
  body_ = run.models[static_cast<size_t>(model_)];
  rest_.resize(body_->parts.size());
  poses_.resize(body_->parts.size());
  const std::vector<float> zeros(static_cast<size_t>(body_->kinematics.column_count()));
  const RootFrame root;
  forward_kinematics(body_->kinematics, zeros, {&root, 1}, rest_);
}

void BodyMap::add(const RunInfo& run, const Frame& frame, uint32_t body, uint32_t part,
                  const Eigen::Vector3d& point_m) {
  if (body >= run.model_of_avatar.size() || run.model_of_avatar[body] != model_ ||
      part >= poses_.size())
    return;
  if (posed_ != body) part_poses(run, frame, body, poses_);
  posed_ = body;
  const Eigen::Vector3d from_root = point_m - frame.roots[body].position_m;
  const Eigen::Vector3d on_part = to_isometry(poses_[part]).inverse() * from_root;
  const auto scale = static_cast<double>(run.scale_of_avatar[body]);
  ++cells_[cell_key(part, (on_part / scale).cast<float>())];
}

void BodyMap::frame(const RunInfo& run, const Frame& frame) {
  if (model_ < 0) return;
  posed_ = -1;
  for (const ContactPoint& row : frame.contact_points) {
    const Eigen::Vector3d point_m(row.point_m.data());
    add(run, frame, row.pair.a(), row.pair.part_a(), point_m);
    add(run, frame, row.pair.b(), row.pair.part_b(), point_m);
  }
  if (run.culler.proximity.contact_points) return;  // proximity rows hold the same points
  for (const ProximityPair& row : frame.proximity_pairs) {
    if (row.level != PairLevel::kTriangles || row.hi_m > 0) continue;
    add(run, frame, row.pair.a(), row.pair.part_a(), Eigen::Vector3d(row.point_a_m.data()));
    add(run, frame, row.pair.b(), row.pair.part_b(), Eigen::Vector3d(row.point_b_m.data()));
  }
}

std::vector<BodyMap::TouchedPoint> BodyMap::touched() const {
  std::vector<std::pair<uint64_t, uint64_t>> sorted(cells_.begin(), cells_.end());
  std::sort(sorted.begin(), sorted.end());
  std::vector<TouchedPoint> all;
  for (const auto& [key, frames] : sorted)
    all.push_back(
        {placed(rest_[key >> 54], cell_centre(key)), static_cast<double>(frames) * step_s_});
  return all;
}

double BodyMap::total_s() const {
  uint64_t frames = 0;
  for (const auto& [key, count] : cells_) frames += count;
  return static_cast<double>(frames) * step_s_;
}

Figure BodyMap::figure() const {
  Eigen::AlignedBox3f box;
  for (size_t part = 0; part < rest_.size(); ++part)
    for (const Eigen::Vector3f& vertex : body_->parts[part].mesh.vertices)
      box.extend(placed(rest_[part], vertex));
  const Neighbours touches(touched());
  // Turns about z bring the front, the right side, the back and the left side to +x in turn.
  Eigen::Matrix3f quarter;
  quarter << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  Eigen::Matrix3f turned = Eigen::Matrix3f::Identity();
  std::vector<View> views;
  std::vector<std::vector<double>> heats;
  double max = 0;
  for (int side = 0; side < 4; ++side, turned = quarter * turned) {
    const View& view = views.emplace_back(*body_, rest_, box, turned);
    std::vector<double>& heat = heats.emplace_back();
    for (const View::Pixel& pixel : view.pixels) {
      heat.push_back(pixel.light > 0 ? touches.density(pixel.at_m) : 0);
      max = std::max(max, heat.back());
    }
  }
  constexpr int kBetween = 25;
  int width = kBetween;
  for (const View& view : views) width += view.width + kBetween;
  const int height = views.front().height;
  constexpr std::array<int, 3> kPaper = {255, 255, 255};
  std::vector<std::array<int, 3>> canvas(static_cast<size_t>(width) * static_cast<size_t>(height),
                                         kPaper);
  std::string labels;
  constexpr const char* kSides[] = {"front", "right", "back", "left"};
  int left = kBetween;
  for (size_t side = 0; side < views.size(); ++side) {
    const View& view = views[side];
    for (size_t i = 0; i < view.pixels.size(); ++i) {
      if (!(view.pixels[i].light > 0)) continue;
      const auto x = static_cast<int>(i) % view.width, y = static_cast<int>(i) / view.width;
      // The square root keeps rare contacts visible next to frequent ones.
      canvas[static_cast<size_t>(height - 1 - y) * static_cast<size_t>(width) +
             static_cast<size_t>(left + x)] =
          colour_of(max > 0 ? std::sqrt(heats[side][i] / max) : 0,
                    static_cast<double>(view.pixels[i].light));
    }
    labels += fmt::format("set label '{}' at {},-18 center\n", kSides[side], left + view.width / 2);
    left += view.width + kBetween;
  }
  std::string script = "$body << EOD\n";
  for (size_t i = 0; i < canvas.size(); ++i)
    append(script, "{} {} {} {} {}\n", static_cast<int>(i) % width, static_cast<int>(i) / width,
           canvas[i][0], canvas[i][1], canvas[i][2]);
  append(script, "EOD\n{}set size ratio -1\nunset border\nunset tics\nunset key\n", labels);
  script += "set palette defined (";
  for (size_t i = 0; i < kHeat.size(); ++i)
    append(script, "{}{} '#{:02x}{:02x}{:02x}'", i == 0 ? "" : ", ",
           static_cast<double>(i * i) / ((kHeat.size() - 1) * (kHeat.size() - 1)),
           static_cast<int>(kHeat[i][0]), static_cast<int>(kHeat[i][1]),
           static_cast<int>(kHeat[i][2]));
  append(script,
         ")\nset cbrange [0:{:.3g}]\nset cbtics\nset cblabel 'contact time, s/cm^2; {:.4g} s in "
         "total'\n"
         "set xrange [0:{}]\nset yrange [-30:{}]\n"
         "plot $body using 1:2:3:4:5 with rgbimage, $body using (-9):(-99):(0) every 100000 with "
         "points palette pointsize 0\n",
         max, total_s(), width, height + 10);
  return {"contact_body", "Contact time per area of the body", "", script, 900, 620};
}

namespace {

constexpr const char* kFiles[] = {"proximity.csv", "exposure.csv", "proximity.tij",
                                  "proximity.graphml"};

}  // namespace

ProximityTables::ProximityTables(std::filesystem::path folder, const RunInfo& run)
    : folder_(std::move(folder)),
      step_s_(run.step_s),
      closest_parts_m_(run.culler.proximity.closest_margin_m) {
  // Files of an earlier run do not belong to these numbers.
  std::error_code error;
  for (const char* name : kFiles) std::filesystem::remove(folder_ / name, error);
  if (!run.culler.proximity.is_enabled()) return;
  rows_ = std::make_unique<OutputFile>(folder_ / "proximity.csv", kContactsOption);
  rows_->write(
      "frame,time_s,kind,body_a,part_a,body_b,part_b,level,distance_lo_m,distance_hi_m,closing_"
      "speed_mps,time_to_contact_s\n");
  if (!(closest_parts_m_ > 0)) return;
  seconds_ = std::make_unique<SecondsFile>(folder_ / "proximity.tij", step_s_);
  while (levels_ < kLevels_m.size() && kLevels_m[levels_] <= static_cast<double>(closest_parts_m_))
    ++levels_;
}

void ProximityTables::list(const RunInfo& run, const Frame& frame, const ProximityRows& rows,
                           const char* kind) {
  for (const ProximityPair& row : rows) {
    const PairKey pair = row.pair;
    append(text_, "{},{:.4f},{},{},{},{},{},{},{},{},{},{}\n", frame.number,
           static_cast<double>(frame.number) * step_s_, kind, pair.a(),
           csv_field(part_name(run, pair.a(), pair.part_a())), pair.b(),
           csv_field(part_name(run, pair.b(), pair.part_b())), static_cast<int>(row.level),
           row.lo_m, row.hi_m, csv_number(row.closing_speed_mps),
           csv_number(row.time_to_contact_s()));
  }
}

void ProximityTables::expose(const Frame& frame) {
  pairs_.clear();
  for (const ProximityPair& row : frame.closest_parts) {
    const uint64_t pair = pair_key(row.pair.a(), row.pair.b());
    pairs_.push_back(pair);
    Exposure& exposure = exposures_[pair];
    for (size_t i = 0; i < levels_; ++i) {
      const auto level_m = static_cast<float>(kLevels_m[i]);
      exposure.below[i] += row.hi_m <= level_m;
      exposure.undetermined[i] += row.lo_m <= level_m && row.hi_m > level_m;
    }
  }
  seconds_->frame(frame.number, pairs_);
}

void ProximityTables::frame(const RunInfo& run, const Frame& frame) {
  if (rows_ == nullptr) return;
  text_.clear();
  list(run, frame, frame.proximity_pairs, "parts");
  list(run, frame, frame.closest_parts, "closest_parts");
  rows_->write(text_);
  if (seconds_ != nullptr) expose(frame);
}

void ProximityTables::write_exposures(const RunInfo& run) {
  std::vector<uint64_t> pairs;
  for (const auto& [pair, exposure] : exposures_) pairs.push_back(pair);
  std::sort(pairs.begin(), pairs.end());
  std::string header = "person_a,person_b";
  GraphFile::Attributes attributes;
  for (size_t i = 0; i < levels_; ++i) {
    header += fmt::format(",below_{0}_m_s,undetermined_{0}_m_s", kLevels_m[i]);
    attributes.emplace_back(fmt::format("below_{}_m_s", kLevels_m[i]), "double");
  }
  OutputFile table(folder_ / "exposure.csv", kContactsOption);
  table.write(header + "\n");
  GraphFile graph(folder_ / "proximity.graphml", run, attributes);
  const auto seconds = [&](uint32_t frames) { return fmt::format("{:.4f}", frames * step_s_); };
  for (const uint64_t pair : pairs) {
    const Exposure& exposure = exposures_.at(pair);
    std::string line = fmt::format("{},{}", pair >> 32, pair & UINT32_MAX);
    std::vector<std::string> values;
    for (size_t i = 0; i < levels_; ++i) {
      values.push_back(seconds(exposure.below[i]));
      line += fmt::format(",{},{}", values.back(), seconds(exposure.undetermined[i]));
    }
    table.write(line + "\n");
    graph.edge(pair, values);
  }
  table.close();
  graph.end();
}

void ProximityTables::end(const RunInfo& run) {
  if (rows_ == nullptr) return;
  rows_->close();
  if (seconds_ == nullptr) return;
  seconds_->end();
  write_exposures(run);
}

std::string ProximityTables::note() const {
  if (seconds_ == nullptr || levels_ == kLevels_m.size()) return "";
  return fmt::format(
      "{} has no seconds below {} m because closest_parts_m is {} m",
      (folder_ / "exposure.csv").string(),
      fmt::join(kLevels_m.begin() + static_cast<ptrdiff_t>(levels_), kLevels_m.end(), ", "),
      closest_parts_m_);
}

std::vector<std::string> proximity_table_files() { return {std::begin(kFiles), std::end(kFiles)}; }

namespace {

namespace fs = std::filesystem;

constexpr const char* kTables[] = {
    "contacts.csv", "part_contacts.csv", "people.csv",        "minutes.csv",  "durations.csv",
    "parts.csv",    "density.csv",       "parts_seconds.csv", "touching.tij", "touching.graphml"};
constexpr const char* kBodyFigure = "contact_body";
constexpr const char* kFigures[] = {"contact_rates", "contact_durations", "contact_parts",
                                    "contact_density"};

std::string people_csv(const ContactStatistics& statistics, const RunInfo& run) {
  std::string text =
      "id,group,present_s,contacts,contacts_per_min,partners,touching_s,obstacle_contacts\n";
  for (size_t id = 0; id < statistics.people().size(); ++id) {
    const PersonContacts& person = statistics.people()[id];
    const double rate = person.present_s > 0 ? 60 * person.contacts / person.present_s : 0;
    const std::string group =
        id < run.group_of_avatar.size() ? run.groups[run.group_of_avatar[id]] : "";
    append(text, "{},{},{:.3f},{},{:.3f},{},{:.3f},{}\n", id, csv_quoted(group), person.present_s,
           person.contacts, rate, person.partners, person.touching_s, person.obstacle_contacts);
  }
  return text;
}

std::string minutes_csv(const ContactStatistics& statistics) {
  std::string text = "minute,contacts,person_s,contacts_per_person_min\n";
  for (size_t i = 0; i < statistics.minutes().size(); ++i) {
    const MinuteRow& row = statistics.minutes()[i];
    append(text, "{},{},{:.3f},{:.4f}\n", i, row.contacts, row.person_s,
           row.person_s > 0 ? 120 * static_cast<double>(row.contacts) / row.person_s : 0.0);
  }
  return text;
}

/// Upper ends of the classes of duration, in seconds; the last class has none.
constexpr double kDurations_s[] = {0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 30};

std::vector<uint64_t> duration_counts(const ContactStatistics& statistics) {
  std::vector<uint64_t> counts(std::size(kDurations_s) + 1, 0);
  for (size_t frames = 0; frames < statistics.lengths().size(); ++frames) {
    const double duration_s = static_cast<double>(frames) * statistics.step_s();
    counts[static_cast<size_t>(
        std::lower_bound(std::begin(kDurations_s), std::end(kDurations_s), duration_s - 1e-6) -
        std::begin(kDurations_s))] += statistics.lengths()[frames];
  }
  return counts;
}

std::string durations_csv(const ContactStatistics& statistics) {
  std::string text = "above_s,up_to_s,contacts,share\n";
  const std::vector<uint64_t> counts = duration_counts(statistics);
  const double all = std::max<double>(1, static_cast<double>(statistics.complete_count()));
  for (size_t i = 0; i < counts.size(); ++i)
    append(text, "{},{},{},{:.5f}\n", i == 0 ? 0 : kDurations_s[i - 1],
           i < std::size(kDurations_s) ? fmt::format("{}", kDurations_s[i]) : "", counts[i],
           static_cast<double>(counts[i]) / all);
  append(text, "truncated,,{},\n", statistics.truncated_count());
  return text;
}

template <typename Value>
std::string matrix_csv(const PartMatrix& parts, const std::vector<Value>& values,
                       const char* format, const std::vector<uint64_t>* obstacles) {
  std::string text = "part";
  for (const std::string& name : parts.names) text += fmt::format(",{}", csv_field(name));
  text += obstacles != nullptr ? ",obstacle\n" : "\n";
  for (size_t row = 0; row < parts.names.size(); ++row) {
    text += csv_field(parts.names[row]);
    for (size_t column = 0; column < parts.names.size(); ++column)
      text += fmt::format(fmt::runtime(format), values[row * parts.names.size() + column]);
    text += obstacles != nullptr ? fmt::format(",{}\n", (*obstacles)[row]) : "\n";
  }
  return text;
}

std::string density_csv(const ContactStatistics& statistics) {
  std::string text = "level,above_per_m2,up_to_per_m2,contacts,person_s,contacts_per_person_min\n";
  for (size_t i = 0; i < DensityLevels::kCount; ++i) {
    const DensityRow& row = statistics.densities()[i];
    append(text, "{},{},{},{},{:.1f},{:.4f}\n", DensityLevels::kNames[i],
           i == 0 ? 0 : DensityLevels::kBounds[i - 1],
           i < DensityLevels::kBounds.size() ? fmt::format("{}", DensityLevels::kBounds[i]) : "",
           row.contacts, row.person_s, row.per_person_min());
  }
  return text;
}

Figure rate_figure(const ContactStatistics& statistics) {
  std::vector<double> rates;  // at least one, as the caller checks
  for (const PersonContacts& person : statistics.people())
    if (person.present_s > 0) rates.push_back(60 * person.contacts / person.present_s);
  const double max = *std::max_element(rates.begin(), rates.end());
  // At most 25 bars, of width 1, 2 or 5 times a power of ten.
  double width = 0.1;
  for (int i = 0; max / width > 25; ++i) width *= i % 3 == 1 ? 2.5 : 2;
  std::vector<int> counts(static_cast<size_t>(max / width) + 1, 0);
  for (const double rate : rates) ++counts[static_cast<size_t>(rate / width)];
  std::string script = "$data << EOD\n";
  for (size_t i = 0; i < counts.size(); ++i)
    script += fmt::format("{} {}\n", (static_cast<double>(i) + 0.5) * width, counts[i]);
  script += fmt::format(
      "EOD\nset boxwidth {}\nset style fill solid 0.85\nset grid ytics\nunset key\nset yrange "
      "[0:*]\nset xrange [0:*]\nset xlabel 'contacts with others per minute'\nset ylabel 'people'\n"
      "plot $data with boxes linecolor rgb '{}'\n",
      0.9 * width, kFigureColours[0]);
  return {"contact_rates", "Contacts per person and minute", "", script};
}

Figure duration_figure(const ContactStatistics& statistics) {
  const std::vector<uint64_t> counts = duration_counts(statistics);
  const double all = std::max<double>(1, static_cast<double>(statistics.complete_count()));
  std::string script = "$data << EOD\n";
  for (size_t i = 0; i < counts.size(); ++i)
    script += fmt::format(
        "\"{}\" {}\n",
        i < std::size(kDurations_s) ? fmt::format("up to {}", kDurations_s[i]) : "longer",
        100 * static_cast<double>(counts[i]) / all);
  script += fmt::format(
      "EOD\nset boxwidth 0.9\nset style fill solid 0.85\nset grid ytics\nunset key\nset yrange "
      "[0:*]\nset xlabel 'length of a contact, s'\nset ylabel 'share of contacts, %'\nplot $data "
      "using 0:2:xtic(1) with boxes linecolor rgb '{}'\n",
      kFigureColours[0]);
  return {"contact_durations", "Duration of contacts", "", script};
}

Figure part_figure(const ContactStatistics& statistics) {
  const PartMatrix parts = statistics.parts();
  // Logarithmic colours keep rare pairs visible next to frequent ones.
  const HeatMap map{.names = display_name(parts.names),
                    .values = {parts.counts.begin(), parts.counts.end()},
                    .using_expression = "(log10(1 + $3))",
                    .label = "contacts, log_1_0(1 + n)"};
  return {"contact_parts", "Contacts by pair of body parts", "", gnuplot_script(map)};
}

Figure density_figure(const ContactStatistics& statistics) {
  std::string script = "$data << EOD\n";
  for (size_t i = 0; i < DensityLevels::kCount; ++i) {
    const DensityRow& row = statistics.densities()[i];
    if (row.person_s == 0) continue;
    const std::string range =
        i + 1 < DensityLevels::kCount
            ? fmt::format("{} to {}", i == 0 ? 0 : DensityLevels::kBounds[i - 1],
                          DensityLevels::kBounds[i])
            : fmt::format("above {}", DensityLevels::kBounds.back());
    script +=
        fmt::format("\"{}\\n{}\" {}\n", DensityLevels::kNames[i], range, row.per_person_min());
  }
  script += fmt::format(
      "EOD\nset boxwidth 0.7\nset style fill solid 0.85\nset grid ytics\nunset key\nset yrange "
      "[0:*]\nset xlabel 'people per m^2 around them' offset 0,-1\nset ylabel 'contacts per person "
      "and "
      "minute'\nset bmargin 5\nplot $data using 0:2:xtic(1) with boxes linecolor rgb '{}'\n",
      kFigureColours[0]);
  return {"contact_density", "Contacts by density", "", script};
}

}  // namespace

std::vector<Figure> figures_of(const ContactStatistics& statistics) {
  const ContactTotals totals = statistics.totals();
  std::vector<Figure> figures;
  if (totals.person_s > 0) figures.push_back(rate_figure(statistics));
  if (statistics.complete_count() > 0) figures.push_back(duration_figure(statistics));
  // A matrix of one cell, or of one colour, shows nothing.
  if (totals.contacts > 0 && statistics.parts().names.size() > 1)
    figures.push_back(part_figure(statistics));
  if (totals.contacts > 0) figures.push_back(density_figure(statistics));
  return figures;
}

std::vector<std::string> contact_files() {
  std::vector<std::string> names(std::begin(kTables), std::end(kTables));
  for (const std::string& name : proximity_table_files()) names.push_back(name);
  for (const char* figure : kFigures) names.push_back(fmt::format("{}.svg", figure));
  names.push_back(fmt::format("{}.svg", kBodyFigure));
  return names;
}

ContactSink::ContactSink(fs::path folder, bool with_points)
    : folder_(std::move(folder)), with_points_(with_points) {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) throw write_error(folder_, error.value(), kContactsOption);
}

void ContactSink::begin(const RunInfo& run) {
  contacts_ = std::make_unique<OutputFile>(folder_ / "contacts.csv", kContactsOption);
  statistics_ = std::make_unique<ContactStatistics>(run);
  touching_ = std::make_unique<TouchingNetwork>(folder_, run);
  proximity_ = std::make_unique<ProximityTables>(folder_, run);
  body_map_ = with_points_ ? std::make_unique<BodyMap>(run) : nullptr;
  notes_.clear();
  contacts_->write(
      "begin_s,duration_s,person_a,person_b,x_m,y_m,density_per_m2,first_part_a,first_part_b,"
      "part_contacts,truncated\n");
}

void ContactSink::list_ended() {
  for (const Contact& contact : statistics_->ended()) touching_->ended(contact);
  for (const Contact& contact : statistics_->ended())
    contacts_->write(fmt::format("{:.4f},{:.4f},{},{},{:.3f},{:.3f},{:.3f},{},{},{},{}\n",
                                 contact.begin_s, contact.duration_s, contact.a, contact.b,
                                 contact.place_m.x(), contact.place_m.y(), contact.density_per_m2,
                                 csv_field(statistics_->part_name(contact.a, contact.first_part_a)),
                                 csv_field(statistics_->part_name(contact.b, contact.first_part_b)),
                                 contact.part_contacts, contact.is_truncated ? 1 : 0));
}

void ContactSink::frame(const RunInfo& run, const Frame& frame) {
  statistics_->frame(frame);
  list_ended();
  touching_->frame(frame);
  proximity_->frame(run, frame);
  if (body_map_ != nullptr) body_map_->frame(run, frame);
}

void ContactSink::end(const RunInfo& run, const RunEnd& end) {
  statistics_->end(end);
  list_ended();
  contacts_->close();
  touching_->end(run);
  proximity_->end(run);
  if (!proximity_->note().empty()) notes_.push_back(proximity_->note());
  write_pairs();
  const PartMatrix parts = statistics_->parts();
  const auto write_file = [](const fs::path& file, const std::string& text) {
    write_file_atomically(file, text, {.what = "the contacts"});
  };
  write_file(folder_ / "people.csv", people_csv(*statistics_, run));
  write_file(folder_ / "minutes.csv", minutes_csv(*statistics_));
  write_file(folder_ / "durations.csv", durations_csv(*statistics_));
  write_file(folder_ / "parts.csv", matrix_csv(parts, parts.counts, ",{}", &parts.obstacle_counts));
  write_file(folder_ / "parts_seconds.csv", matrix_csv(parts, parts.seconds, ",{:.3f}", nullptr));
  write_file(folder_ / "density.csv", density_csv(*statistics_));
  draw_figures();
}

void ContactSink::write_pairs() const {
  const double step_s = statistics_->step_s();
  OutputFile out(folder_ / "part_contacts.csv", kContactsOption);
  out.write("begin_s,duration_s,person_a,part_a,person_b,part_b,truncated\n");
  statistics_->for_each_part_contact([&](const PartContact& contact) {
    const PairKey pair = contact.pair;
    out.write(fmt::format(
        "{:.4f},{:.4f},{},{},{},{},{}\n", static_cast<double>(contact.begin_frame) * step_s,
        static_cast<double>(contact.frames) * step_s, pair.a(),
        csv_field(statistics_->part_name(pair.a(), pair.part_a())), pair.b(),
        csv_field(statistics_->part_name(pair.b(), pair.part_b())), contact.is_truncated ? 1 : 0));
  });
  out.close();
}

void ContactSink::draw_figures() {
  // Figures of an earlier run do not belong to these numbers.
  std::error_code error;
  for (const char* name : kFigures) fs::remove(folder_ / fmt::format("{}.svg", name), error);
  fs::remove(folder_ / fmt::format("{}.svg", kBodyFigure), error);
  if (!has_gnuplot()) {
    notes_.push_back(
        fmt::format("no figures in {}; install gnuplot to draw them", folder_.string()));
    return;
  }
  std::vector<std::string> missing(std::begin(kFigures), std::end(kFigures));
  for (const Figure& figure : figures_of(*statistics_)) {
    draw(figure, folder_);
    std::erase(missing, figure.id);
  }
  if (body_map_ != nullptr && body_map_->has_figure()) draw(body_map_->figure(), folder_);
  if (body_map_ != nullptr && !body_map_->has_figure()) missing.emplace_back(kBodyFigure);
  if (!missing.empty())
    notes_.push_back(fmt::format("no {}.svg in {}: the run has no data for it",
                                 fmt::join(missing, ".svg, "), folder_.string()));
}

}  // namespace throng
