#include "analysis/contacts/body_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/append.h"
#include "scenes/run/sink.h"

namespace throng {
namespace {

/// Points within a cell are one.
constexpr float kCell_m = 0.005f;
/// Cells are counted from here, farther from a part's origin than any part reaches.
constexpr int64_t kOrigin = 1 << 17;
constexpr uint64_t kMask = (1 << 18) - 1;
/// Over which the time of a point is spread, as a Gaussian.
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

/// Touched points near a place.
class Neighbours {
 public:
  explicit Neighbours(const std::vector<BodyMap::Touched>& points) {
    for (const BodyMap::Touched& point : points) cells_[key(cell_of(point.at_m))].push_back(point);
  }

  /// Seconds a square centimetre.
  double density(const Eigen::Vector3f& at_m) const {
    double sum = 0;
    const std::array<int, 3> cell = cell_of(at_m);
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        for (int z = -1; z <= 1; ++z) {
          const auto found = cells_.find(key({cell[0] + x, cell[1] + y, cell[2] + z}));
          if (found == cells_.end()) continue;
          for (const BodyMap::Touched& point : found->second) {
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

  std::unordered_map<uint64_t, std::vector<BodyMap::Touched>> cells_;
};

/// What is seen of a body at rest from one side, pixel by pixel.
class View {
 public:
  struct Pixel {
    float depth_m = -std::numeric_limits<float>::infinity();
    float light = 0;
    Eigen::Vector3f at_m;
  };

  /// `turned` takes the body to where it is looked at along -x, with y to the right and z up.
  View(const Model& model, const std::vector<PartPose>& rest, const Eigen::AlignedBox3f& box,
       const Eigen::Matrix3f& turned)
      : turned_(turned) {
    Eigen::AlignedBox3f seen;
    for (int corner = 0; corner < 8; ++corner)
      seen.extend(turned * box.corner(static_cast<Eigen::AlignedBox3f::CornerType>(corner)));
    left_m_ = seen.min().y();
    top_m_ = seen.max().z();
    width = static_cast<int>(std::ceil(seen.sizes().y() / kPixel_m)) + 1;
    height = static_cast<int>(std::ceil(seen.sizes().z() / kPixel_m)) + 1;
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
  std::vector<Pixel> pixels;  ///< row by row from the top

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

/// From where nobody touched to where most did.
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
  const auto most = std::max_element(people.begin(), people.end());
  if (most == people.end() || *most == 0) return;
  model_ = static_cast<int>(most - people.begin());
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
  if (run.culler.near.contact_points) return;  // the rows of distances have the same
  for (const NearPair& row : frame.near_pairs) {
    if (row.level != PairLevel::kExact || row.hi_m > 0) continue;
    add(run, frame, row.pair.a(), row.pair.part_a(), Eigen::Vector3d(row.point_a_m.data()));
    add(run, frame, row.pair.b(), row.pair.part_b(), Eigen::Vector3d(row.point_b_m.data()));
  }
}

std::vector<BodyMap::Touched> BodyMap::touched() const {
  std::vector<std::pair<uint64_t, uint64_t>> sorted(cells_.begin(), cells_.end());
  std::sort(sorted.begin(), sorted.end());
  std::vector<Touched> all;
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
  // About z: the front, then the right side, the back, the left side come to x.
  Eigen::Matrix3f quarter;
  quarter << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  Eigen::Matrix3f turned = Eigen::Matrix3f::Identity();
  std::vector<View> views;
  std::vector<std::vector<double>> heats;
  double most = 0;
  for (int side = 0; side < 4; ++side, turned = quarter * turned) {
    const View& view = views.emplace_back(*body_, rest_, box, turned);
    std::vector<double>& heat = heats.emplace_back();
    for (const View::Pixel& pixel : view.pixels) {
      heat.push_back(pixel.light > 0 ? touches.density(pixel.at_m) : 0);
      most = std::max(most, heat.back());
    }
  }
  constexpr int kBetween = 25;
  int width = kBetween;
  for (const View& view : views) width += view.width + kBetween;
  const int height = views.front().height;
  // An image is a whole rectangle.
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
      // A square root, so that a rare contact is seen beside a frequent one.
      canvas[static_cast<size_t>(height - 1 - y) * static_cast<size_t>(width) +
             static_cast<size_t>(left + x)] =
          colour_of(most > 0 ? std::sqrt(heats[side][i] / most) : 0,
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
         ")\nset cbrange [0:{:.3g}]\nset cbtics\nset cblabel 'seconds touched a cm^2, {:.4g} s in "
         "all'\n"
         "set xrange [0:{}]\nset yrange [-30:{}]\n"
         "plot $body using 1:2:3:4:5 with rgbimage, $body using (-9):(-99):(0) every 100000 with "
         "points palette pointsize 0\n",
         most, total_s(), width, height + 10);
  return {"contact_body", "Where on the body contacts are", "", script, 900, 620};
}

}  // namespace throng
