// Lockstep: the result of a run depends on the replies, not on their timing.
#include "lcm_io/wire/lockstep.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <functional>
#include <lcm/lcm-cpp.hpp>
#include <thread>

#include "base/errors.h"
#include "base/random.h"
#include "external_scene.h"
#include "lcm_io/codec/channels.h"
#include "lcm_io/codec/message_validation.h"
#include "scenes/run/checkpoint.h"
#include "synthetic_run.h"

namespace throng::lockstep_test {
namespace {

/// Replies with the poses of the request, without joint positions.
step_reply_t reply_to(const step_request_t& request) {
  step_reply_t m{};
  m.run_id = request.run_id;
  m.instance = request.instance;
  m.frame = request.frame;
  m.schema = kSchema;
  m.count = request.count;
  m.avatar = request.avatar;
  m.x_m = request.x_m;
  m.y_m = request.y_m;
  m.z_m = request.z_m;
  m.qw = request.qw;
  m.qx = request.qx;
  m.qy = request.qy;
  m.qz = request.qz;
  m.vx_mps = request.vx_mps;
  m.vy_mps = request.vy_mps;
  return m;
}

/// Replies with positions on a spiral at walking speed, computed from the request only.
step_reply_t moved(const step_request_t& request) {
  step_reply_t m = reply_to(request);
  if (request.is_first != 0) return m;
  for (size_t i = 0; i < m.avatar.size(); ++i) {
    const double angle = static_cast<double>(request.frame) / 40;
    m.vx_mps[i] = static_cast<float>(std::cos(angle));
    m.vy_mps[i] = static_cast<float>(std::sin(angle));
    m.x_m[i] += static_cast<double>(m.vx_mps[i]) / 60;
    m.y_m[i] += static_cast<double>(m.vy_mps[i]) / 60;
    m.qw[i] = static_cast<float>(std::cos(angle / 2));
    m.qz[i] = static_cast<float>(std::sin(angle / 2));
  }
  return m;
}

/// A run in lockstep and its controller, in one process.
struct InLockstep {
  using Respond = std::function<void(InLockstep&, const step_request_t&)>;

  explicit InLockstep(Respond respond, double timeout_s = 30, Scene scene = rover_in_crowd(60))
      : lcm(std::make_shared<lcm::LCM>("memq://")),
        simulation(std::move(scene), {}),
        lockstep(simulation.info(), lcm, timeout_s),
        responds(std::move(respond)) {
    lcm->subscribeFunction(
        kChannel + "_REQUEST",
        +[](const lcm::ReceiveBuffer*, const std::string&, const step_request_t* request,
            InLockstep* self) {
          self->requests.push_back(*request);
          self->responds(*self, *request);
        },
        this);
  }
  void send(const step_reply_t& m) { lcm->publish(kChannel + "_REPLY", &m); }
  const Frame& step() {
    const Frame& frame = simulation.step();
    EXPECT_TRUE(lockstep.after(simulation, frame)) << lockstep.failure();
    return frame;
  }
  uint64_t hash_after(int frames) {
    lockstep.begin(simulation);
    for (int i = 0; i < frames; ++i) step();
    return simulation.finish().hash;
  }
  const Lockstep::Counts& counts() const { return lockstep.counts().front(); }

  std::shared_ptr<lcm::LCM> lcm;
  Simulation simulation;
  Lockstep lockstep;
  Respond responds;
  std::vector<step_request_t> requests;
};

const InLockstep::Respond kMoves = [](InLockstep& run, const step_request_t& request) {
  run.send(moved(request));
};

TEST(Lockstep, AppliesRepliesToTheNextFrame) {
  InLockstep run(kMoves);
  const uint32_t id = rover_of(run.simulation);
  run.lockstep.begin(run.simulation);
  ASSERT_EQ(run.requests.size(), 1U);
  EXPECT_EQ(run.requests[0].frame, -1);
  EXPECT_NE(run.requests[0].is_first, 0);
  for (int64_t i = 0; i < 50; ++i) {
    const step_reply_t expected = moved(run.requests.back());
    const Frame& frame = run.step();
    EXPECT_EQ(frame.roots[id].position_m.x(), expected.x_m[0]) << "frame " << i;
    EXPECT_EQ(frame.roots[id].position_m.y(), expected.y_m[0]) << "frame " << i;
    ASSERT_EQ(run.requests.size(), static_cast<size_t>(i) + 2);
    EXPECT_EQ(run.requests.back().frame, i);
    EXPECT_EQ(run.requests.back().seq, i + 1);
    EXPECT_EQ(run.requests.back().is_first, 0);
    EXPECT_EQ(run.requests.back().x_m[0], frame.roots[id].position_m.x());
  }
  EXPECT_EQ(run.counts().replies, 51);
  EXPECT_EQ(run.counts().requests, 51);
}

TEST(Lockstep, GivesAHashIndependentOfDelaysAndOtherReplies) {
  constexpr uint64_t kSeed = 11;
  constexpr int kFrames = 120;
  const uint64_t expected = InLockstep(kMoves).hash_after(kFrames);
  for (uint64_t trial = 0; trial < 3; ++trial) {
    int64_t answered = -2;
    InLockstep run([trial, &answered](InLockstep& self, const step_request_t& request) {
      if (request.frame == answered) return;  // repeated, because the machine is busy
      answered = request.frame;
      const RandomKey key{kSeed, trial, static_cast<uint64_t>(request.frame + 1), Purpose::kStyle};
      std::this_thread::sleep_for(std::chrono::microseconds(random_bits(key, 0) % 5000));
      step_reply_t reply = moved(request), wrong = reply;
      wrong.x_m[0] = 7;
      wrong.frame = request.frame + 1;
      self.send(wrong);
      wrong.frame = request.frame - 1;
      if (request.frame >= 0) self.send(wrong);
      wrong.frame = request.frame;
      ++wrong.instance;
      self.send(wrong);
      self.send(reply);
      --wrong.instance;
      self.send(wrong);
    });
    EXPECT_EQ(run.hash_after(kFrames), expected) << "seed " << kSeed << " trial " << trial;
    EXPECT_EQ(run.counts().replies, kFrames + 1);
    EXPECT_EQ(run.counts().other_runs, kFrames + 1);
    EXPECT_EQ(run.counts().rejected, kFrames + 1);
    EXPECT_GE(run.counts().late + run.counts().repeated, 2 * kFrames - 1);
  }
}

TEST(Lockstep, CountsAndIgnoresInvalidReplies) {
  InLockstep run([](InLockstep& self, const step_request_t& request) {
    step_reply_t wrong = reply_to(request);
    wrong.x_m[0] = 7;
    if (request.frame == 0) wrong.avatar = {0};
    if (request.frame == 1) wrong.frame = 5;
    if (request.frame == 2) wrong.frame = 1;
    if (request.frame == 3) ++wrong.run_id;
    if (request.frame == 4) wrong.schema = kSchema + 1;
    if (request.frame >= 0) self.send(wrong);
    step_reply_t reply = reply_to(request);
    reply.x_m[0] = request.frame == -1 ? reply.x_m[0] : 3;
    self.send(reply);  // for frame 5 the wrong reply is valid
  });
  const uint32_t id = rover_of(run.simulation);
  run.lockstep.begin(run.simulation);
  const std::vector<std::string> rejections = {"avatar 0 is not of group 'rovers'",
                                               "a reply to frame 5, expected frame 1"};
  for (int64_t i = 0; i <= 5; ++i) {
    const Frame& frame = run.step();
    if (i > 0) {
      EXPECT_EQ(frame.roots[id].position_m.x(), 3) << "frame " << i;
    }
    if (i < 2) {
      EXPECT_EQ(run.counts().rejection, rejections[static_cast<size_t>(i)]);
    }
  }
  EXPECT_EQ(run.simulation.step().roots[id].position_m.x(), 7) << "the first reply counts";
  EXPECT_EQ(run.counts().rejected, 3);
  EXPECT_EQ(run.counts().late, 1);
  EXPECT_EQ(run.counts().other_runs, 1);
  EXPECT_EQ(run.counts().replies, 7);
  EXPECT_EQ(run.counts().rejection, "schema 2, this program reads 1");
}

TEST(Lockstep, NamesAvatarsWithoutAReply) {
  const InLockstep::Respond half = [](InLockstep& run, const step_request_t& request) {
    step_reply_t m = reply_to(request);
    if (request.frame == 1)  // the rest of the group does not reply
      for (auto* column : {&m.x_m, &m.y_m, &m.z_m}) column->resize(1);
    if (request.frame == 1)
      for (auto* column : {&m.qw, &m.qx, &m.qy, &m.qz, &m.vx_mps, &m.vy_mps}) column->resize(1);
    if (request.frame == 1) m.avatar.resize(m.count = 1);
    if (request.frame == 1 && m.avatar[0] != 60) return;
    run.send(m);
  };
  InLockstep run(half, 0.7, rover_in_crowd(60, 3));
  run.lockstep.begin(run.simulation);
  run.step();
  EXPECT_FALSE(run.lockstep.after(run.simulation, run.simulation.step()));
  EXPECT_EQ(run.lockstep.failure(),
            "lockstep: no reply to frame 1 within 0.7 s for avatars 61, 62 of group 'rovers' "
            "(ROBOT_DRIVE_REPLY); check the controller, or raise --lockstep-timeout");
  EXPECT_THAT(run.requests.back().avatar, testing::ElementsAre(61, 62))
      << "requested again for the missing avatars";

  InLockstep silent([](InLockstep&, const step_request_t&) {}, 0.1);
  try {
    silent.lockstep.begin(silent.simulation);
    ADD_FAILURE() << "a run without a controller began";
  } catch (const EnvironmentError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("no reply to the request before the first frame "
                                                 "within 0.1 s for avatar 60 of group 'rovers'"));
  }
}

TEST(Lockstep, LetsSeveralControllersShareAGroup) {
  InLockstep run(
      [](InLockstep& self, const step_request_t& request) {
        const step_reply_t all = moved(request);
        for (size_t i = all.avatar.size(); i-- > 0;) {
          step_reply_t one = all;
          one.count = 1;
          one.avatar = {all.avatar[i]};
          for (auto column : {&step_reply_t::x_m, &step_reply_t::y_m, &step_reply_t::z_m})
            one.*column = {(all.*column)[i]};
          for (auto column : {&step_reply_t::qw, &step_reply_t::qx, &step_reply_t::qy,
                              &step_reply_t::qz, &step_reply_t::vx_mps, &step_reply_t::vy_mps})
            one.*column = {(all.*column)[i]};
          self.send(one);
        }
      },
      30, rover_in_crowd(60, 3));
  const uint64_t hash = run.hash_after(30);
  EXPECT_EQ(run.counts().replies, 3 * 31);
  EXPECT_EQ(hash, InLockstep(kMoves, 30, rover_in_crowd(60, 3)).hash_after(30));
}

TEST(Lockstep, StopsWaitingWhenTheRunIsStopped) {
  InLockstep run([](InLockstep& self, const step_request_t& request) {
    if (request.frame < 0) self.send(reply_to(request));
  });
  run.lockstep.begin(run.simulation);
  EXPECT_TRUE(run.lockstep.after(run.simulation, run.simulation.step(), [] { return true; }));
  EXPECT_TRUE(run.lockstep.has_missing_replies());
  EXPECT_EQ(run.lockstep.failure(), "");
}

TEST(Lockstep, ResumesFromACheckpoint) {
  constexpr int kFrames = 90, kBefore = 40;
  const uint64_t expected = InLockstep(kMoves).hash_after(kFrames);
  const ScratchFile file(".checkpoint");
  {
    InLockstep before(kMoves);
    before.lockstep.begin(before.simulation);
    for (int i = 0; i < kBefore; ++i) before.step();
    write_checkpoint(file.path(), checkpoint_of(before.simulation));
  }
  InLockstep after(kMoves);
  resume(after.simulation, file.path());
  EXPECT_EQ(after.hash_after(kFrames - kBefore), expected);
  EXPECT_EQ(after.requests.front().frame, kBefore - 1);
  EXPECT_NE(after.requests.front().is_first, 0) << "the resumed run waits for its controllers";
}

TEST(Lockstep, RejectsUnsuitableScenes) {
  const auto rejection = [](Scene scene) {
    const Simulation simulation(std::move(scene), {});
    try {
      const Lockstep lockstep(simulation.info(), std::make_shared<lcm::LCM>("memq://"));
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  Scene no_rovers = rover_in_crowd(20);
  no_rovers.groups.pop_back();
  EXPECT_EQ(rejection(no_rovers),
            "--lockstep: expected a scene with an externally controlled group (control_channel: "
            "CHANNEL), found none");
  Scene longer = rover_in_crowd(20);
  longer.groups.back().control_channel = std::string(58, 'x');
  EXPECT_THAT(rejection(longer),
              testing::HasSubstr("at most 57 characters, because '_REPLY' is appended"));
  Scene shared = rover_in_crowd(20);
  shared.groups.push_back(shared.groups.back());
  EXPECT_EQ(rejection(shared),
            "--lockstep: expected a separate control channel for each group, found "
            "'ROBOT_DRIVE' for several groups");
  EXPECT_EQ(rejection(rover_in_crowd(20)), "");
}

TEST(Lockstep, SurvivesDamagedReplies) {
  constexpr uint64_t kSeed = 23;
  uint64_t round = 0;
  InLockstep run([&round](InLockstep& self, const step_request_t& request) {
    const step_reply_t sound = reply_to(request);
    std::vector<uint8_t> bytes(static_cast<size_t>(sound.getEncodedSize()));
    sound.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    for (int i = 0; i < 100; ++i, ++round) {
      const RandomKey key{kSeed, round, 0, Purpose::kStyle};
      auto hit = bytes;
      for (uint32_t k = 0; k < 1 + random_bits(key, 0) % 4; ++k)
        hit[random_bits(key, 2 * k + 1) % hit.size()] =
            static_cast<uint8_t>(random_bits(key, 2 * k + 2));
      if (random_bits(key, 90) % 8 == 0) hit.resize(random_bits(key, 91) % hit.size());
      self.lcm->publish(kChannel + "_REPLY", hit.data(), static_cast<unsigned>(hit.size()));
    }
    self.send(sound);
  });
  const uint32_t id = rover_of(run.simulation);
  run.lockstep.begin(run.simulation);
  for (int i = 0; i < 60; ++i) {
    const Frame& frame = run.step();
    ASSERT_TRUE(run.simulation.scene().ground.contains(frame.roots[id].position_m.head<2>()))
        << "seed " << kSeed << " round " << round;
    ASSERT_NEAR(frame.roots[id].world_from_root.norm(), 1, 1e-5f);
  }
  EXPECT_GT(run.counts().rejected + run.counts().other_runs, 1000);
}

}  // namespace
}  // namespace throng::lockstep_test
