// Forward kinematics of all parts: Throng's batches of avatars on every SIMD target of this
// machine, and KDL's recursive tree solver for every part.
#include <benchmark/benchmark.h>

#include <kdl/treefksolverpos_recursive.hpp>
#include <string>

#include "avatars/gait/gait.h"
#include "base/random.h"
#include "kinematics/kdl_tree.h"

namespace throng::bench {
namespace {

constexpr size_t kAvatars = 1024;

struct Postures {
  Postures() : model(load_model(adult_urdf())) {
    const Gait gait(*model);
    std::vector<float> phases, speeds(kAvatars, 1.3f), scales(kAvatars, 1.0f);
    for (size_t i = 0; i < kAvatars; ++i)
      phases.push_back(
          static_cast<float>(random_uniform({.id = i, .purpose = Purpose::kGaitPhase})));
    rows.resize(kAvatars * static_cast<size_t>(gait.column_count()));
    gait.postures(phases, speeds, scales, rows);
  }
  std::shared_ptr<const Model> model;
  std::vector<float> rows;
};

const Postures& postures() {
  static const Postures made;
  return made;
}

void kinematics_batch(benchmark::State& state, SimdTarget target) {
  const Postures& p = postures();
  const std::vector<RootFrame> roots(kAvatars);
  std::vector<PartPose> poses(kAvatars * p.model->parts.size());
  for (auto _ : state) {
    forward_kinematics(p.model->kinematics, p.rows, roots, poses, target);
    benchmark::DoNotOptimize(poses.data());
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(kAvatars));
}

void kinematics_kdl_tree_solver(benchmark::State& state) {
  const Postures& p = postures();
  const KDL::Tree tree = to_kdl(p.model->robot);
  KDL::TreeFkSolverPos_recursive solver(tree);
  // KDL has its own joint numbers; the adult has no mimic joints.
  std::vector<size_t> joint_of_column;
  for (const Joint& joint : p.model->robot.joints)
    if (joint.kind != Joint::Kind::kFixed)
      joint_of_column.push_back(
          tree.getSegment(p.model->robot.links[static_cast<size_t>(joint.child_link)].name)
              ->second.q_nr);
  std::vector<std::string> names;
  for (const Part& part : p.model->parts) names.push_back(part.name);
  KDL::JntArray joints(tree.getNrOfJoints());
  KDL::Frame frame;
  for (auto _ : state)
    for (size_t avatar = 0; avatar < kAvatars; ++avatar) {
      const float* row = p.rows.data() + avatar * joint_of_column.size();
      for (size_t i = 0; i < joint_of_column.size(); ++i)
        joints(static_cast<unsigned>(joint_of_column[i])) = static_cast<double>(row[i]);
      for (const std::string& name : names) {
        solver.JntToCart(joints, frame, name);
        benchmark::DoNotOptimize(frame);
      }
    }
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(kAvatars));
}

[[maybe_unused]] const bool kRegistered = [] {
  for (const SimdTarget target : simd_targets_of_this_machine())
    benchmark::RegisterBenchmark(("kinematics_batch/" + std::string(name_of(target))).c_str(),
                                 kinematics_batch, target);
  return true;
}();
BENCHMARK(kinematics_kdl_tree_solver);

}  // namespace
}  // namespace throng::bench
