#include "bench/workbench/law.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "avatars/avatars.h"
#include "base/append.h"
#include "bench/boxes.h"
#include "bench/crowd.h"
#include "bench/workbench/couples.h"
#include "culling/volumes/pose_math.h"

namespace throng::bench {
namespace {

constexpr int kFramesAtOnce = 8;  // as many for any number of threads
constexpr int kWalkers = 100;
constexpr double kWalkersPerM2 = 4;
constexpr int kStride = 5;               // steps between two frames of walkers
constexpr uint64_t kFramesOfCrowd = 30;  // later they have walked apart

/// Near pairs of one frame, with the truth of each.
struct NearFrame {
  std::vector<PartPlace> places;
  std::vector<PlacedPair> pairs;
  std::vector<uint8_t> touching;
};

/// Where near pairs come from: shapes that a volume is fitted to, and frame after frame of places.
class Source {
 public:
  virtual ~Source() = default;
  virtual std::string name() const = 0;
  /// What comes next, in order; by one thread.
  virtual void go_on() {}
  /// Frame `number`, at most kFramesAtOnce from the next; by several threads at once.
  virtual NearFrame frame(uint64_t number) const = 0;
  virtual std::string describe(const PlacedPair& pair) const = 0;

  std::span<const PartShape> shapes() const { return shapes_; }

 protected:
  void add_shape(const PartShape& shape) {
    shapes_.push_back(shape);
    reach_m_.push_back(1.001f * static_cast<float>(reach_of(shape.points)));
  }
  void add_pair(NearFrame& frame, uint32_t a, uint32_t b, const Eigen::Vector3f& a_to_b_m,
                bool touching) const {
    const PartPlace &p = frame.places[a], &q = frame.places[b];
    const float reach = a_to_b_m.norm() + translation_m(p.pose).norm() +
                        translation_m(q.pose).norm() + p.scale * reach_m_[p.shape] +
                        q.scale * reach_m_[q.shape];
    frame.pairs.push_back({a, b, a_to_b_m, rounding_margin_m(reach)});
    frame.touching.push_back(touching);
  }

 private:
  std::vector<PartShape> shapes_;
  std::vector<float> reach_m_;
};

/// Bodies of a family in twos.
class CouplesSource final : public Source {
 public:
  CouplesSource(Family family, uint64_t seed) : family_(family), seed_(seed) {
    Draw draw(seed, static_cast<uint64_t>(family));
    kinds_ = kinds_of(family, draw);
    uint32_t shapes = 0;
    for (const BodyKind& kind : kinds_) {
      first_shape_.push_back(shapes);
      shapes += static_cast<uint32_t>(kind.type->part_count());
      for (const PartShape& shape : kind.type->parts()) add_shape(shape);
    }
  }
  std::string name() const override { return std::string(name_of(family_)); }

  NearFrame frame(uint64_t number) const override {
    Draw draw(seed_, ((number + 1) << 8) | static_cast<uint64_t>(family_));
    const Couples world(family_, kinds_, draw);
    NearFrame out;
    std::vector<PartBox> boxes;
    for (uint32_t a = 0; a < 2 * Couples::kCouples; a += 2) {
      const auto first = static_cast<uint32_t>(out.places.size());
      boxes.clear();
      for (const uint32_t body : {a, a + 1})
        for (uint32_t part = 0; part < world.parts_of(body).size(); ++part) {
          out.places.push_back({first_shape_[world.type(body)] + part, world.parts_of(body)[part],
                                world.scale(body)});
          boxes.push_back(world.box(body, part));
        }
      const auto parts_a = static_cast<uint32_t>(world.parts_of(a).size());
      const Eigen::Vector3d a_to_b = world.root(a + 1) - world.root(a);
      for (uint32_t i = 0; i < parts_a; ++i)
        for (uint32_t j = parts_a; j < boxes.size(); ++j)
          if (PartBox::near(boxes[i], boxes[j], a_to_b))
            add_pair(out, first + i, first + j, a_to_b.cast<float>(),
                     world.touch(a, i, a + 1, j - parts_a));
    }
    return out;
  }
  std::string describe(const PlacedPair& pair) const override {
    return fmt::format("parts {} and {}", pair.a, pair.b);
  }

 private:
  Family family_;
  uint64_t seed_;
  std::vector<BodyKind> kinds_;
  std::vector<uint32_t> first_shape_;
};

/// The bundled adult, many of them, close together, walking straight through each other.
class WalkersSource final : public Source {
 public:
  explicit WalkersSource(uint64_t seed) : model_(load_model(adult_urdf())), seed_(seed) {
    for (const Part& part : model_->parts) {
      add_shape({part.mesh.vertices, part.mesh.triangles});
      trees_.emplace_back(part.mesh.vertices, part.mesh.triangles);
    }
  }
  std::string name() const override { return "walking"; }

  void go_on() override {
    moments_.clear();
    for (int i = 0; i < kFramesAtOnce; ++i, ++next_) {
      if (next_ % kFramesOfCrowd == 0)
        crowd_ =
            std::make_unique<Crowd>(model_, CrowdShape{.avatars = kWalkers,
                                                       .per_m2 = kWalkersPerM2,
                                                       .seed = seed_ + next_ / kFramesOfCrowd});
      for (int step = 0; step < kStride; ++step) crowd_->advance();
      CrowdBoxes boxes(*crowd_, crowd_->body_type());
      const BoxList list = boxes.compute();
      const std::span<const RootPose> roots = crowd_->view().roots;
      moments_.push_back(
          {boxes.poses(), {list.boxes.begin(), list.boxes.end()}, {roots.begin(), roots.end()}});
    }
  }

  NearFrame frame(uint64_t number) const override {
    const Moment& moment = moments_[number % kFramesAtOnce];
    const auto parts = static_cast<uint32_t>(trees_.size());
    NearFrame out;
    for (uint32_t i = 0; i < moment.poses.size(); ++i)
      out.places.push_back({i % parts, moment.poses[i], 1});
    ExactCounters counters;
    for (const BoxPair& pair : reference_pairs({moment.boxes, parts})) {
      const PartPlace &a = out.places[pair.a], &b = out.places[pair.b];
      const Eigen::Vector3f a_to_b =
          (moment.roots[pair.b / parts].position_m - moment.roots[pair.a / parts].position_m)
              .cast<float>();
      add_pair(
          out, pair.a, pair.b, a_to_b,
          solids_touch(trees_[a.shape], a.pose, 1, trees_[b.shape], b.pose, 1, a_to_b, counters));
    }
    return out;
  }
  std::string describe(const PlacedPair& pair) const override {
    const auto named = [&](uint32_t place) {
      return fmt::format("{} of {}", model_->parts[place % trees_.size()].name,
                         place / trees_.size());
    };
    return named(pair.a) + " and " + named(pair.b);
  }

 private:
  struct Moment {
    std::vector<PartPose> poses;
    std::vector<Box> boxes;
    std::vector<RootPose> roots;
  };
  std::shared_ptr<const Model> model_;
  uint64_t seed_;
  std::vector<TriangleBvh> trees_;
  std::unique_ptr<Crowd> crowd_;
  std::vector<Moment> moments_;
  uint64_t next_ = 0;
};

/// One frame held against the truth.
LawRow judge(const Source& source, const FittedVolume& volume, uint64_t seed, uint64_t number) {
  const NearFrame frame = source.frame(number);
  std::vector<uint8_t> overlaps(frame.pairs.size());
  volume.test(frame.places, frame.pairs, overlaps);
  LawRow row{.family = source.name()};
  row.near = frame.pairs.size();
  row.differing = volume.kernel_differs(frame.places, frame.pairs);
  for (size_t i = 0; i < frame.pairs.size(); ++i) {
    row.touching += frame.touching[i];
    row.reported += overlaps[i] != 0;
    if (frame.touching[i] == 0 || overlaps[i] != 0) continue;
    if (row.missed++ > 0) continue;
    const PlacedPair& pair = frame.pairs[i];
    const PartPlace &a = frame.places[pair.a], &b = frame.places[pair.b];
    row.first_miss = {fmt::format("{}, seed {}, frame {}: {}", source.name(), seed, number,
                                  source.describe(pair)),
                      source.shapes()[a.shape],
                      source.shapes()[b.shape],
                      a,
                      b,
                      pair};
  }
  return row;
}

LawRow check_source(Source& source, const TestedVolume& volume, uint64_t pairs, uint64_t seed,
                    Workers& workers) {
  const std::unique_ptr<FittedVolume> fitted = volume.fit(source.shapes());
  LawRow sum{.family = source.name()};
  for (uint64_t first = 0; sum.near < pairs; first += kFramesAtOnce) {
    source.go_on();
    std::vector<LawRow> rows(kFramesAtOnce);
    workers.for_blocks(kFramesAtOnce, [&](int block, int) {
      rows[static_cast<size_t>(block)] =
          judge(source, *fitted, seed, first + static_cast<uint64_t>(block));
    });
    for (const LawRow& row : rows) sum.add(row);
  }
  return sum;
}

void append_part(std::string& text, const char* name, const PartShape& shape,
                 const PartPlace& place) {
  append(text, "{}: scale {}, pose", name, place.scale);
  for (const auto& row : place.pose.rows)
    for (const float value : row) append(text, " {}", value);
  append(text, "\n");
  for (const Eigen::Vector3f& p : shape.points)
    append(text, "  point {} {} {}\n", p.x(), p.y(), p.z());
  for (const Eigen::Vector3i& t : shape.triangles)
    append(text, "  triangle {} {} {}\n", t[0], t[1], t[2]);
}

}  // namespace

void LawRow::add(const LawRow& other) {
  near += other.near;
  touching += other.touching;
  reported += other.reported;
  missed += other.missed;
  differing += other.differing;
  if (!first_miss) first_miss = other.first_miss;
}

std::vector<LawRow> check_law(const TestedVolume& volume, uint64_t near_pairs, uint64_t seed,
                              Workers& workers) {
  const uint64_t each = near_pairs / (std::size(kFamilies) + 1) + 1;
  std::vector<LawRow> rows;
  for (const Family family : kFamilies) {
    CouplesSource source(family, seed);
    rows.push_back(check_source(source, volume, each, seed, workers));
  }
  WalkersSource walkers(seed);
  rows.push_back(check_source(walkers, volume, each, seed, workers));
  return rows;
}

std::string to_text(const Miss& miss) {
  std::string text = miss.where + "\n";
  append_part(text, "a", miss.shape_a, miss.a);
  append_part(text, "b", miss.shape_b, miss.b);
  append(text, "a_to_b_m: {} {} {}, margin_m: {}\n", miss.test.a_to_b_m.x(), miss.test.a_to_b_m.y(),
         miss.test.a_to_b_m.z(), miss.test.margin_m);
  return text;
}

}  // namespace throng::bench
