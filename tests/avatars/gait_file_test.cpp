// Gait files restore a gait bit by bit; damaged files are rejected.
#include "avatars/gait/gait_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

#include "avatars/avatars.h"
#include "base/errors.h"
#include "base/files/atomic_file.h"
#include "base/files/regular_file.h"
#include "base/random.h"
#include "tests/same_bits.h"

namespace throng::gait_file_test {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kSeed = 20261124;

struct Folder {
  fs::path path = fs::temp_directory_path() / ("throng_gaits_" + std::to_string(::getpid()));
  Folder() { fs::create_directories(path); }
  ~Folder() { fs::remove_all(path); }
};

std::shared_ptr<const Model> crate_in(const Folder& folder) {
  const fs::path urdf = folder.path / "crate.urdf";
  write_file_atomically(urdf, std::string_view(R"(<robot name="crate"><link name="crate"><collision>
    <geometry><box size="1 1 1"/></geometry></collision></link></robot>)"));
  return load_model(urdf);
}

float drawn(uint32_t i, float low, float high) {
  return static_cast<float>(random_uniform({kSeed, i, 0, Purpose::kGaitPhase}, low, high));
}

/// Returns the gait's results for random inputs, one number after another.
std::vector<float> results_of(const Gait& gait) {
  std::vector<float> results = {gait.sphere_centre_m().z(), gait.sphere_radius_m(),
                                gait.upright_radius_m()};
  const auto append = [&results](std::initializer_list<float> more) {
    results.insert(results.end(), more);
  };
  std::vector<float> row(static_cast<size_t>(gait.column_count()));
  for (uint32_t i = 0; i < 2000; ++i) {
    const float phase = drawn(3 * i, 0, 1), speed = drawn(3 * i + 1, 0, 3);
    const float scale = drawn(3 * i + 2, 0.5f, 1.2f);
    gait.postures({&phase, 1}, {&speed, 1}, {&scale, 1}, row);
    gait.apply_head_yaw(0.4f, row);
    results.insert(results.end(), row.begin(), row.end());
    RootBox box;
    gait.bounds({&phase, 1}, {&speed, 1}, {&scale, 1}, {&box, 1});
    for (const auto& corner : {box.min_m, box.max_m}) append({corner[0], corner[1], corner[2]});
    append({gait.stride_length_m(speed, scale), gait.swing().at(phase)});
    const FootTrack track = gait.track_at(speed, scale);
    append({track.stance, track.shift_m, track.side_m[0], track.side_m[1], track.stride_m});
    const WalkBounds packed_bounds = gait.walk_bounds_of(box, scale);
    const RootBox round = gait.box_of(packed_bounds, scale);
    append({packed_bounds.x, packed_bounds.y, round.min_m[0], round.min_m[1], round.max_m[0],
            round.max_m[1]});
    const LimbSweep& sweep = gait.outline()->sweep_at(speed, scale);
    const LimbOutlines limbs = sweep.at(LimbSweep::phase_index(phase));
    for (size_t side = 0; side < 2; ++side)
      for (size_t direction = 0; direction < 8; ++direction)
        append({limbs.arms[side].reaches_m[direction], limbs.thighs[side].reaches_m[direction],
                sweep.envelope().arms[side].reaches_m[direction],
                gait.outline()->tucked[side].reaches_m[direction]});
    append({sweep.sway_m(), sweep.outline().upper.at(48 * phase), sweep.outline().upper.max_m()});
  }
  return results;
}

/// Returns state and outputs of walkers that turn and stop, after each step.
std::vector<float> walked(const Gait& gait) {
  constexpr size_t kCount = 16;
  std::vector<float> results;
  std::vector<WalkPosture> postures(WalkBatch::kMaxLanes);
  WalkBatch batch{};
  batch.count = kCount;
  batch.postures = postures.data();
  batch.step_s = 1.0f / 60;
  std::vector<float> row(static_cast<size_t>(gait.column_count()));
  for (size_t lane = 0; lane < kCount; ++lane) {
    batch.gaits[lane] = &gait;
    batch.scales[lane] = drawn(static_cast<uint32_t>(lane), 0.8f, 1.1f);
    batch.present[lane] = batch.w_before[lane] = batch.w_after[lane] = batch.stride_scale[lane] = 1;
    batch.gait_mps[lane] = kNotEntered;
  }
  for (uint32_t step = 0; step < 300; ++step) {
    for (size_t lane = 0; lane < kCount; ++lane) {
      const float speed =
          step % 100 < 70 ? drawn(static_cast<uint32_t>(100 + lane), 0.2f, 1.8f) : 0.0f;
      batch.displacement_x_m[lane] = speed * batch.step_s;
      batch.ahead_mps[lane] = speed;
    }
    batch.fill_up();
    Gait::walk(batch, SimdTarget::kBest);
    for (size_t lane = 0; lane < kCount; ++lane) {
      const Gait* one = &gait;
      const auto some = static_cast<uint32_t>(lane);
      Gait::postures({&one, 1}, postures, {&some, 1}, row);
      results.insert(results.end(), row.begin(), row.end());
      results.insert(results.end(), {batch.phases[lane], batch.gait_mps[lane], batch.bounds_x[lane],
                                     batch.bounds_y[lane], gait.hips_offset_m(postures[lane])});
    }
  }
  return results;
}

template <typename T>
bool same(const std::vector<T>& a, const std::vector<T>& b) {
  return same_bits(std::span<const T>(a), std::span<const T>(b));
}

TEST(GaitFile, RestoresTheTabulatedGait) {
  const Folder folder;
  const std::shared_ptr<const Model> adult = load_model(adult_urdf());
  for (size_t i = 0; i < kGaitStyleCount; ++i) {
    const auto style = static_cast<GaitStyle>(i);
    SCOPED_TRACE(parameters_of(style).name);
    write_gait_file(*adult, style, folder.path);
    const Gait tabulated(*adult, style);
    const Gait read = read_gait_file(folder.path / gait_file_name(*adult, style));
    EXPECT_TRUE(same(read.bytes(), tabulated.bytes()));
    EXPECT_TRUE(same(results_of(read), results_of(tabulated)));
    EXPECT_TRUE(same(walked(read), walked(tabulated)));
  }
}

TEST(GaitFile, IsBuiltForEachStyleOfTheAdult) {
  const std::shared_ptr<const Model> adult = load_model(adult_urdf());
  for (size_t i = 0; i < kGaitStyleCount; ++i) {
    const fs::path name = gait_file_name(*adult, static_cast<GaitStyle>(i));
    EXPECT_FALSE(generated_file(fs::path("gaits") / name).empty()) << name;
  }
}

TEST(GaitFile, IsNamedAfterModelAndStyle) {
  const Folder folder;
  const std::shared_ptr<const Model> adult = load_model(adult_urdf()), crate = crate_in(folder);
  const fs::path plain = gait_file_name(*adult, GaitStyle::kPlain);
  EXPECT_NE(plain, gait_file_name(*adult, GaitStyle::kBrisk));
  EXPECT_NE(plain, gait_file_name(*crate, GaitStyle::kPlain));
}

TEST(GaitFile, IsRejectedIfDamagedOrShort) {
  const Folder folder;
  const std::shared_ptr<const Model> adult = load_model(adult_urdf());
  write_gait_file(*adult, GaitStyle::kPlain, folder.path);
  const fs::path file = folder.path / gait_file_name(*adult, GaitStyle::kPlain);
  const std::vector<uint8_t> whole = RegularFile(file, "a gait", 1 << 28).bytes();
  const auto is_rejected = [&](const std::vector<uint8_t>& bytes) {
    write_file_atomically(file, bytes);
    EXPECT_THROW(read_gait_file(file), InputError) << bytes.size();
  };
  for (uint32_t i = 0; i < 20; ++i) {
    std::vector<uint8_t> bytes = whole;
    const auto at = static_cast<size_t>(
        random_uniform({kSeed, i, 1, Purpose::kGaitPhase}, 0, static_cast<double>(whole.size())));
    bytes[at] ^= 0x10;
    is_rejected(bytes);
    is_rejected({whole.begin(), whole.begin() + static_cast<ptrdiff_t>(at)});
  }
  is_rejected({});
}

TEST(GaitFile, SupportsModelsWithoutLegs) {
  const Folder folder;
  const Gait gait = gait_of(*crate_in(folder), GaitStyle::kPlain);
  const Gait read = Gait::from(gait.bytes(), "a crate");
  EXPECT_FALSE(read.has_legs());
  EXPECT_EQ(read.outline(), nullptr);
  EXPECT_TRUE(same(read.bytes(), gait.bytes()));
}

}  // namespace
}  // namespace throng::gait_file_test
