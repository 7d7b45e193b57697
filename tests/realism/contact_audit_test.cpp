// Tests the contact audit: contacts equal those of `throng compare`, sums add up, and hands inside
// other parts are detected.
#include "bench/realism/contact_audit.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "bench/realism/measured_run.h"
#include "scenes/run/runner.h"

namespace throng::realism::contact_audit_test {
namespace {

ContactSums sums_of(Scene scene) {
  ContactAudit audit;
  run_measured(std::move(scene), 2, true,
               [&](const Simulation&) { return std::vector<Sink*>{&audit}; });
  return audit.sums();
}

Scene one_person() {
  Scene scene = load_scene("plaza");
  scene.groups.resize(1);
  scene.groups.front().count = 1;
  scene.groups.front().sources.clear();
  scene.duration_s = 3;
  scene.exact = true;
  return scene;
}

TEST(ContactAudit, FindsNoContactsOfASinglePerson) {
  const ContactSums sums = sums_of(one_person());
  EXPECT_NEAR(sums.person_s, 3, 0.1);
  EXPECT_EQ(sums.all().tallies[0].contacts, 0u);
  EXPECT_EQ(sums.all().touching_s, 0);
  EXPECT_EQ(sums.all().tallies[0].depths.count(), 0u);
}

TEST(ContactAudit, CountsTheContactsOfCompare) {
  class Both final : public Sink {
   public:
    SinkNeeds needs() const override { return {.postures = true}; }
    void begin(const RunInfo& run) override {
      measures.emplace(run);
      audit.begin(run);
    }
    void frame(const RunInfo& run, const Frame& frame) override {
      measures->frame(frame);
      audit.frame(run, frame);
    }
    void end(const RunInfo& run, const RunEnd& end) override {
      measures->end();
      audit.end(run, end);
    }
    std::optional<ContactMeasures> measures;
    ContactAudit audit;
  };
  for (uint64_t seed = 1; seed <= 2; ++seed) {
    Scene scene = open_measured_run("corridor", 3);
    scene.seed = seed;
    Both both;
    run_measured(std::move(scene), 2, true,
                 [&](const Simulation&) { return std::vector<Sink*>{&both}; });
    const ContactLevel all = both.audit.sums().all();
    EXPECT_GT(all.tallies[0].contacts, 0u) << "seed " << seed;
    EXPECT_EQ(all.tallies[0].contacts, both.measures->contacts()) << "seed " << seed;
    EXPECT_NEAR(all.person_s, both.measures->person_s(), 1e-6) << "seed " << seed;
    for (size_t i = 1; i < kMinHeadDistances_m.size(); ++i) {
      EXPECT_LE(all.tallies[i].contacts, all.tallies[i - 1].contacts);
      EXPECT_LE(all.tallies[i].depths.count(), all.tallies[i - 1].depths.count());
    }
    EXPECT_LE(all.tallies[0].trunks, all.tallies[0].contacts);
    EXPECT_LE(all.touching_s, all.person_s);
  }
}

TEST(ContactAudit, AddsSumsOfRuns) {
  const ContactSums once = sums_of(open_measured_run("corridor", 2));
  ContactSums twice = once;
  twice.add(once);
  EXPECT_EQ(twice.all().tallies[0].contacts, 2 * once.all().tallies[0].contacts);
  EXPECT_EQ(twice.all().tallies[0].depths.count(), 2 * once.all().tallies[0].depths.count());
  EXPECT_EQ(twice.all().tallies[0].depths.max(), once.all().tallies[0].depths.max());
  EXPECT_NEAR(twice.all().tallies[0].depths.quantile(0.9),
              once.all().tallies[0].depths.quantile(0.9), 1e-9);
  EXPECT_NEAR(twice.person_s, 2 * once.person_s, 1e-6);
}

struct TwoPeople {
  TwoPeople() {
    model = load_model(adult_urdf());
    run.scene = &scene;
    run.models = {model};
    run.model_of_avatar = {0, 0};
    run.scale_of_avatar = {1, 1};
    roots.resize(2);
    const auto columns = static_cast<size_t>(model->kinematics.column_count());
    rows.assign(2 * columns, 0);
    offsets = {0, columns, 2 * columns};
  }
  Frame frame() const {
    Frame out;
    out.roots = roots;
    out.postures = rows;
    out.posture_offsets = offsets;
    return out;
  }
  uint32_t part(const std::string& name) const {
    for (uint32_t i = 0; i < model->parts.size(); ++i)
      if (model->parts[i].name == name) return i;
    throw std::runtime_error("the adult has no " + name);
  }
  /// Returns the centre of a part's box in world coordinates.
  Eigen::Vector3d middle_m(size_t person, const std::string& name) const {
    const size_t columns = offsets[1];
    const RootFrame root{roots[person].world_from_root, run.scale_of_avatar[person]};
    std::vector<PartPose> poses(model->parts.size());
    forward_kinematics(model->kinematics, std::span(rows).subspan(person * columns, columns),
                       {&root, 1}, poses);
    Eigen::AlignedBox3f box;
    for (const Eigen::Vector3f& vertex : model->parts[part(name)].mesh.vertices) box.extend(vertex);
    return roots[person].position_m +
           to_isometry(poses[part(name)]) *
               (static_cast<double>(run.scale_of_avatar[person]) * box.center().cast<double>());
  }

  std::shared_ptr<const Model> model;
  Scene scene;
  RunInfo run;
  std::vector<RootPose> roots;
  std::vector<float> rows;
  std::vector<size_t> offsets;
};

TEST(HandPenetration, DetectsAHandInsideATorso) {
  for (const float scale : {1.0f, 0.9f, 1.1f}) {
    TwoPeople people;
    people.run.scale_of_avatar = {1, scale};
    HandPenetration hands(people.run);
    const PairKey pair(0, 1, people.part("leftHand"), people.part("torso"));
    // A hand at scale 0.5 fits into the trunk.
    people.run.scale_of_avatar[0] = 0.5f;
    people.roots[1].position_m.setZero();
    people.roots[0].position_m.setZero();
    const Eigen::Vector3d hand_to_torso =
        people.middle_m(1, "torso") - people.middle_m(0, "leftHand");
    people.roots[0].position_m = hand_to_torso;
    EXPECT_TRUE(hands.is_inside(people.run, people.frame(), pair)) << scale;
    EXPECT_FALSE(hands.is_inside(people.run, people.frame(),
                                 PairKey(0, 1, people.part("leftHand"), people.part("head"))));
    EXPECT_FALSE(hands.is_inside(people.run, people.frame(),
                                 PairKey(0, 1, people.part("torso"), people.part("torso"))));
    people.roots[0].position_m = hand_to_torso + Eigen::Vector3d(0, 0.3, 0);
    EXPECT_FALSE(hands.is_inside(people.run, people.frame(), pair)) << "next to it, " << scale;
    people.roots[0].position_m = hand_to_torso + Eigen::Vector3d(0.15, 0, 0);
    EXPECT_FALSE(hands.is_inside(people.run, people.frame(), pair)) << "sticks out, " << scale;
  }
}

TEST(HandPenetration, TakesThicknessFromTheHandsBox) {
  const TwoPeople people;
  const HandPenetration hands(people.run);
  const double thickness_m =
      hands.thickness_m(people.run, PairKey(0, 1, people.part("leftHand"), people.part("torso")));
  EXPECT_GT(thickness_m, 0.015);
  EXPECT_LT(thickness_m, 0.09) << "its fingers curl to the palm";
  EXPECT_GT(hands.thickness_m(people.run, PairKey(0, 1, people.part("head"), people.part("torso"))),
            1e6);
}

TEST(ContactReport, ShowsBeforeAndAfter) {
  const NamedContactSums alone{"alone", sums_of(one_person())};
  const std::string one = contact_report(alone, nullptr, true);
  const std::string two = contact_report(alone, &alone, true);
  EXPECT_NE(one.find("alone\n"), std::string::npos) << one;
  EXPECT_NE(two.find("alone > alone\n"), std::string::npos) << two;
}

}  // namespace
}  // namespace throng::realism::contact_audit_test
