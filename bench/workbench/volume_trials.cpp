#include "bench/workbench/volume_trials.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "avatars/avatars.h"
#include "base/figure.h"
#include "base/text.h"
#include "bench/workbench/random_pairs.h"
#include "culling/triangles/triangle_bvh.h"
#include "culling/volumes/pose_math.h"

namespace throng::bench {
namespace {

constexpr int kFramesAtOnce = 8;  // independent of the number of threads
constexpr int kWalkers = 100;
constexpr double kWalkersPerM2 = 4;
constexpr int kStride = 5;               // steps between two frames of walkers
constexpr uint64_t kFramesOfCrowd = 30;  // afterwards they have walked apart

/// Near pairs of one frame, with the oracle's result.
struct PairFrame {
  std::vector<PartPlace> places;
  std::vector<PlacedPair> pairs;
  std::vector<uint8_t> touching;
};

/// Source provides near pairs: the shapes to fit and frames of places.
class Source {
 public:
  virtual ~Source() = default;
  virtual std::string name() const = 0;
  /// Advances to the next frames; call from one thread.
  virtual void advance() {}
  /// Returns frame `number`, less than kFramesAtOnce ahead; thread-safe.
  virtual PairFrame frame(uint64_t number) const = 0;
  virtual std::string describe(const PlacedPair& pair) const = 0;

  std::span<const PartShape> shapes() const { return shapes_; }

 protected:
  void add_shape(const PartShape& shape) {
    shapes_.push_back(shape);
    reach_m_.push_back(1.001f * static_cast<float>(reach_of(shape.points)));
  }
  void add_pair(PairFrame& frame, uint32_t a, uint32_t b, const Eigen::Vector3f& a_to_b_m,
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

class RandomPairsSource final : public Source {
 public:
  RandomPairsSource(Family family, uint64_t seed) : family_(family), seed_(seed) {
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

  PairFrame frame(uint64_t number) const override {
    Draw draw(seed_, ((number + 1) << 8) | static_cast<uint64_t>(family_));
    const RandomPairs world(family_, kinds_, draw);
    PairFrame out;
    std::vector<PartBox> boxes;
    for (uint32_t a = 0; a < 2 * RandomPairs::kPairs; a += 2) {
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
          if (PartBox::is_within_margin(boxes[i], boxes[j], a_to_b))
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

/// Many bundled adults, close together, walking straight through each other.
class WalkersSource final : public Source {
 public:
  explicit WalkersSource(uint64_t seed) : model_(load_model(adult_urdf())), seed_(seed) {
    for (const Part& part : model_->parts) {
      add_shape({part.mesh.vertices, part.mesh.triangles});
      trees_.emplace_back(part.mesh.vertices, part.mesh.triangles);
    }
  }
  std::string name() const override { return "walking"; }

  void advance() override {
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

  PairFrame frame(uint64_t number) const override {
    const Moment& moment = moments_[number % kFramesAtOnce];
    const auto parts = static_cast<uint32_t>(trees_.size());
    PairFrame out;
    for (uint32_t i = 0; i < moment.poses.size(); ++i)
      out.places.push_back({i % parts, moment.poses[i], 1});
    TriangleCounters counters;
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

NoMissResult judge(const Source& source, const FittedVolume& volume, uint64_t seed,
                   uint64_t number) {
  const PairFrame frame = source.frame(number);
  std::vector<uint8_t> overlaps(frame.pairs.size());
  volume.test(frame.places, frame.pairs, overlaps);
  NoMissResult row{.family = source.name()};
  row.tested = frame.pairs.size();
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

NoMissResult check_source(Source& source, const TestedVolume& volume, uint64_t pairs, uint64_t seed,
                          Workers& workers) {
  const std::unique_ptr<FittedVolume> fitted = volume.fit(source.shapes());
  NoMissResult sum{.family = source.name()};
  for (uint64_t first = 0; sum.tested < pairs; first += kFramesAtOnce) {
    source.advance();
    std::vector<NoMissResult> rows(kFramesAtOnce);
    workers.for_blocks(kFramesAtOnce, [&](int block, int) {
      rows[static_cast<size_t>(block)] =
          judge(source, *fitted, seed, first + static_cast<uint64_t>(block));
    });
    for (const NoMissResult& row : rows) sum.add(row);
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

void NoMissResult::add(const NoMissResult& other) {
  tested += other.tested;
  touching += other.touching;
  reported += other.reported;
  missed += other.missed;
  differing += other.differing;
  if (!first_miss) first_miss = other.first_miss;
}

std::vector<NoMissResult> check_no_misses(const TestedVolume& volume, uint64_t no_miss_pairs,
                                          uint64_t seed, Workers& workers) {
  const uint64_t each = no_miss_pairs / (std::size(kFamilies) + 1) + 1;
  std::vector<NoMissResult> rows;
  for (const Family family : kFamilies) {
    RandomPairsSource source(family, seed);
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

namespace {

/// Pairs of avatars per batch: large enough that volumes are placed once for most of their tests.
constexpr size_t kChunk = 2048;

/// Returns pairs of avatars whose spheres overlap: the first pass of the two-pass strategy.
std::vector<BoxPair> sphere_pairs(const Crowd& crowd, const BodyType& type) {
  const BodiesView bodies = crowd.view();
  std::vector<Box> spheres;  // as boxes first, for the grid of the reference
  const double radius = static_cast<double>(type.sphere().radius_m);
  for (const RootPose& root : bodies.roots) {
    const Eigen::Vector3d centre =
        root.position_m + (root.world_from_root * type.sphere().centre_m).cast<double>();
    const Eigen::Vector3f low = (centre.array() - radius).cast<float>(),
                          high = (centre.array() + radius).cast<float>();
    spheres.push_back({{low.x(), low.y(), low.z()}, {high.x(), high.y(), high.z()}});
  }
  std::vector<BoxPair> pairs = reference_pairs({spheres, 1});
  std::erase_if(pairs, [&](const BoxPair& pair) {
    const auto centre = [&](uint32_t i) -> Eigen::Vector3f {
      return Eigen::Vector3f(spheres[i].min_m) + Eigen::Vector3f(spheres[i].max_m);
    };
    return (centre(pair.a) - centre(pair.b)).norm() / 2 > 2 * type.sphere().radius_m;
  });
  return pairs;
}

/// Census tests pairs of avatars with all volumes and counts; the pipeline has the last row.
class Census {
 public:
  Census(const BodyType& type, VolumeList volumes, FalsePositives& out)
      : type_(type), out_(out), overlaps_(volumes.size()) {
    for (const TestedVolume* volume : volumes) fitted_.push_back(volume->fit(type.parts()));
    for (const PartShape& part : type.parts()) surfaces_.emplace_back(part.points, part.triangles);
  }

  /// Tests every part of `a` against every part of `b`, for each pair of avatars.
  void judge(const BodiesView& bodies, const std::vector<PartPose>& poses,
             std::span<const PairKey> reported, std::span<const BoxPair> pairs) {
    lay_out(bodies, poses, pairs);
    for (size_t i = 0; i < fitted_.size(); ++i) {
      overlaps_[i].resize(tests_.size());
      fitted_[i]->test(places_, tests_, overlaps_[i]);
    }
    out_.avatar_pairs += pairs.size();
    for (size_t i = 0; i < tests_.size(); ++i) {
      const PlacedPair& test = tests_[i];
      const PartPlace &a = places_[test.a], &b = places_[test.b];
      const BoxPair& avatars = pairs[i / (surfaces_.size() * surfaces_.size())];
      // The oracle is asked where any volume reports, to detect a volume that misses.
      const bool touching = std::any_of(overlaps_.begin(), overlaps_.end(),
                                        [&](const auto& overlaps) { return overlaps[i] != 0; }) &&
                            solids_touch(surfaces_[a.shape], a.pose, a.scale, surfaces_[b.shape],
                                         b.pose, b.scale, test.a_to_b_m, exact_);
      const PairKey key(bodies.ids[avatars.a], bodies.ids[avatars.b], a.shape, b.shape);
      count(i, std::minmax(a.shape, b.shape), touching,
            std::binary_search(reported.begin(), reported.end(), key));
    }
  }

 private:
  /// Lists the parts of all avatars in `pairs` once, and all tests between them.
  void lay_out(const BodiesView& bodies, const std::vector<PartPose>& poses,
               std::span<const BoxPair> pairs) {
    const auto parts = static_cast<uint32_t>(surfaces_.size());
    first_place_.assign(bodies.ids.size(), UINT32_MAX);
    places_.clear();
    tests_.clear();
    const auto placed = [&](uint32_t avatar) {
      if (first_place_[avatar] != UINT32_MAX) return first_place_[avatar];
      const auto first = static_cast<uint32_t>(places_.size());
      for (uint32_t part = 0; part < parts; ++part)
        places_.push_back({part, poses[size_t{avatar} * parts + part], bodies.scales[avatar]});
      return first_place_[avatar] = first;
    };
    for (const BoxPair& pair : pairs) {
      const Eigen::Vector3f shift =
          (bodies.roots[pair.b].position_m - bodies.roots[pair.a].position_m).cast<float>();
      const float margin = rounding_margin_m(shift.norm() + 4 * type_.sphere().radius_m +
                                             2 * type_.sphere().centre_m.norm());
      const uint32_t a = placed(pair.a), b = placed(pair.b);
      for (uint32_t i = 0; i < parts; ++i)
        for (uint32_t j = 0; j < parts; ++j) tests_.push_back({a + i, b + j, shift, margin});
    }
  }

  void count(size_t test, std::pair<uint32_t, uint32_t> cell, bool touching, bool by_pipeline) {
    PartCell& in = out_.matrix[cell.first * surfaces_.size() + cell.second];
    ++out_.tests;
    out_.touching += touching;
    ++in.tests;
    in.touching += touching;
    for (size_t i = 0; i < out_.volumes.size(); ++i) {
      const bool overlaps = i < overlaps_.size() ? overlaps_[i][test] != 0 : by_pipeline;
      out_.volumes[i].reported += overlaps;
      out_.volumes[i].missed += touching && !overlaps;
      if (out_.volumes[i].name == out_.matrix_volume) in.passed += overlaps;
    }
  }

  const BodyType& type_;
  FalsePositives& out_;
  std::vector<std::unique_ptr<FittedVolume>> fitted_;
  std::vector<TriangleBvh> surfaces_;
  std::vector<uint32_t> first_place_;  // by avatar
  std::vector<PartPlace> places_;
  std::vector<PlacedPair> tests_;
  std::vector<std::vector<uint8_t>> overlaps_;  // by volume
  TriangleCounters exact_;
};

}  // namespace

FalsePositives count_false_positives(Crowd& crowd, VolumeList volumes, const CensusOptions& options,
                                     const Progress& progress) {
  const auto type = crowd.body_type();
  FalsePositives out;
  for (const Part& part : crowd.model().parts) out.parts.push_back(part.name);
  out.matrix.resize(out.parts.size() * out.parts.size());
  out.matrix_volume = options.matrix_volume;
  for (const TestedVolume* volume : volumes) out.volumes.push_back({volume->name()});
  out.volumes.push_back({"pipeline"});  // cylinders, avatar boxes and part boxes before or-DOP 26

  Workers workers(1);
  Culler culler({type}, {}, workers);
  CrowdBoxes boxes(crowd, type);
  Census census(*type, volumes, out);
  for (int frame = 0; frame < options.frames; ++frame) {
    for (int step = 0; step < options.stride; ++step) crowd.advance();
    boxes.compute();
    culler.step(crowd.view(), crowd);
    const std::vector<BoxPair> pairs = sphere_pairs(crowd, *type);
    for (size_t first = 0; first < pairs.size(); first += kChunk)
      census.judge(crowd.view(), boxes.poses(), culler.pairs(),
                   std::span(pairs).subspan(first, std::min(kChunk, pairs.size() - first)));
    progress(fmt::format("frame {} of {}", frame + 1, options.frames));
  }
  return out;
}

namespace {

struct Motion {
  std::vector<PartShape> shapes;
  std::vector<PartPlace> places;  ///< shuffled
  std::vector<PlacedPair> pairs;  ///< shuffled
  std::vector<uint8_t> touching;  ///< indexed by pair
};

Motion record(const std::vector<paper::Object>& objects, int frames, uint64_t seed) {
  BoxDynamics world =
      paper::world_of(objects, objects.size(), 0, paper::part_one_box(objects, seed));
  const float margin = paper::margin_m(objects, world);
  const auto count = static_cast<uint32_t>(objects.size());
  Motion motion;
  std::vector<uint32_t> where(size_t{count} * static_cast<size_t>(frames - 1));
  for (uint32_t i = 0; i < where.size(); ++i) where[i] = i;
  shuffle(where, seed);
  motion.places.resize(where.size());
  for (uint32_t first = 0; first < where.size(); first += count) {
    world.step();
    for (uint32_t a = 0; a < count; ++a) {
      motion.places[where[first + a]] = {a, world.pose(a), 1};
      for (uint32_t b = a + 1; b < count; ++b)
        motion.pairs.push_back(
            {where[first + a], where[first + b], Eigen::Vector3f::Zero(), margin});
    }
  }
  shuffle(motion.pairs, seed);
  std::vector<TriangleBvh> surfaces;
  for (const paper::Object& object : objects) {
    motion.shapes.push_back(object.shape);
    surfaces.emplace_back(object.shape.points, object.shape.triangles);
  }
  TriangleCounters counters;
  for (const PlacedPair& pair : motion.pairs) {
    const PartPlace &a = motion.places[pair.a], &b = motion.places[pair.b];
    motion.touching.push_back(solids_touch(surfaces[a.shape], a.pose, 1, surfaces[b.shape], b.pose,
                                           1, pair.a_to_b_m, counters));
  }
  return motion;
}

}  // namespace

std::vector<CostAndAccuracy> measure_figure_3(const std::vector<paper::Object>& objects,
                                              VolumeList volumes, int frames, uint64_t seed) {
  const Motion motion = record(objects, frames, seed);
  const auto count = static_cast<double>(objects.size());
  std::vector<uint8_t> overlaps(motion.pairs.size());
  std::vector<CostAndAccuracy> out;
  for (const TestedVolume* volume : volumes) {
    const std::unique_ptr<FittedVolume> fitted = volume->fit(motion.shapes);
    fitted->test(motion.places, motion.pairs, overlaps);
    CostAndAccuracy row{.name = volume->name()};
    uint64_t touching = 0;
    for (size_t i = 0; i < overlaps.size(); ++i) {
      row.found += overlaps[i] != 0;
      touching += overlaps[i] != 0 && motion.touching[i] != 0;
    }
    if (row.found > 0)
      row.true_share = static_cast<double>(touching) / static_cast<double>(row.found);
    const MotionCost cost = fitted->cost(motion.places, motion.pairs);
    row.fit_ns = volume->fit_cost(motion.shapes).median_ns;
    row.update_ns = cost.update.median_ns;
    row.test_ns = cost.test.median_ns;
    row.frame_ns = count * row.update_ns + count * (count - 1) / 2 * row.test_ns;
    out.push_back(std::move(row));
  }
  return out;
}

std::string figure_3_script(std::span<const LabelledPoint> points, const std::string& what,
                            const std::string& highlighted) {
  std::string others, own;
  for (const LabelledPoint& point : points)
    (point.label == highlighted ? own : others) +=
        fmt::format("\"{}\" {} {}\n", point.label, point.frame_ns, 100 * point.true_share);
  const auto series = [](const char* data, const char* colour) {
    return fmt::format(
        "{0} using 2:3 with points pointtype 7 linecolor rgb '{1}', {0} using 2:3:1 with labels "
        "left offset 0.8,0 font ',9' textcolor rgb '{1}' noenhanced",
        data, colour);
  };
  std::string script = "$data << EOD\n" + others + "EOD\n";
  if (!own.empty()) script += "$own << EOD\n" + own + "EOD\n";
  script += "set logscale x\nset grid\nset xlabel 'ns per frame (" + what +
            ")'\nset ylabel 'pairs found that touch, %'\nset yrange [0:108]\nset offsets graph "
            "0.1, graph 0.15, 0, 0\nunset key\nplot " +
            series("$data", kFigureColours[0]);
  if (!own.empty()) script += ", " + series("$own", kFigureColours[1]);
  return script + "\n";
}

}  // namespace throng::bench
