// Contacts and depths: the definition of a contact, agreement with the statistics of a run, and
// depths of bodies at known positions.
#include "analysis/measures/contact_measures.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "analysis/contacts/contact_statistics.h"
#include "scenes/run/runner.h"
#include "tests/crowd/crowd_world.h"

namespace throng::contact_measures_test {
namespace {

const std::shared_ptr<const Model>& adult() {
  static const std::shared_ptr<const Model> model = load_model(adult_urdf());
  return model;
}

uint32_t part(const std::string& name) {
  for (uint32_t i = 0; i < adult()->parts.size(); ++i)
    if (adult()->parts[i].name == name) return i;
  throw std::runtime_error("the adult has no " + name);
}

/// Three people on empty ground; a step is 0.1 s.
struct ThreePeople {
  ThreePeople() {
    scene.ground = {{-10, -10}, {10, 10}};
    run.scene = &scene;
    run.step_s = 0.1;
    run.models = {adult()};
    run.model_of_avatar = {0, 0, 0};
    run.scale_of_avatar = {1, 1, 1};
    roots.resize(3);
    for (size_t id = 0; id < 3; ++id) roots[id].position_m = {5.0 * static_cast<double>(id), 0, 0};
    rows.assign(3 * static_cast<size_t>(adult()->kinematics.column_count()), 0);
    for (size_t id = 0; id <= 3; ++id)
      offsets.push_back(id * static_cast<size_t>(adult()->kinematics.column_count()));
  }
  Frame frame(int64_t number) const {
    Frame out;
    out.number = number;
    out.roots = roots;
    out.postures = rows;
    out.posture_offsets = offsets;
    return out;
  }

  Scene scene;
  RunInfo run;
  std::vector<RootPose> roots;
  std::vector<float> rows;
  std::vector<size_t> offsets;
};

/// Contacts of two hands by frame: '#' touching, '.' apart.
uint64_t contacts_of(const std::string& frames, double gap_s) {
  const ThreePeople people;
  ContactMeasures measures(people.run, gap_s);
  const PairKey hands(0, 1, part("leftHand"), part("RightHand"));
  for (size_t i = 0; i < frames.size(); ++i) {
    std::vector<PairEvent> events;
    const bool before = i > 0 && frames[i - 1] == '#';
    if (frames[i] == '#' && !before) events.push_back({hands, EventKind::kBegin});
    if (frames[i] != '#' && before) events.push_back({hands, EventKind::kEnd});
    Frame frame = people.frame(static_cast<int64_t>(i));
    frame.events = events;
    measures.frame(frame);
  }
  measures.end();
  const double per_min = measures.contact_table().value("hand and hand", "", "contacts");
  if (measures.contacts() > 0) {  // both counts agree for a single pair of parts
    EXPECT_NEAR(per_min * measures.person_s() / 120, static_cast<double>(measures.contacts()), 1e-9)
        << frames;
  }
  return measures.contacts();
}

TEST(ContactMeasures, ContinueContactsAcrossShortGaps) {
  EXPECT_EQ(contacts_of("..##....##..", 0.5), 1u) << "0.4 s";
  EXPECT_EQ(contacts_of("..##.....##..", 0.5), 2u) << "0.5 s";
  EXPECT_EQ(contacts_of("..##....##....#..", 0.5), 1u) << "gaps do not add up";
  EXPECT_EQ(contacts_of("#.#.#", 0), 3u);
  EXPECT_EQ(contacts_of("#......", 0.5), 1u) << "contact in the first frame";
  EXPECT_EQ(contacts_of(".......", 0.5), 0u);
}

/// A person enters next to the others in the second frame of 0.1 s; hands touch from `from_frame`
/// on.
ContactMeasures newcomer_touches(size_t from_frame, double settles_s) {
  const ThreePeople people;
  ContactMeasures measures(people.run, ContactMeasures::kGap_s, settles_s);
  const std::vector<PairEvent> begins = {
      {PairKey(0, 1, part("leftHand"), part("RightHand")), EventKind::kBegin}};
  const std::vector<uint8_t> before = {1, 0, 1}, since = {1, 1, 1};
  for (size_t i = 0; i < 12; ++i) {
    Frame frame = people.frame(static_cast<int64_t>(i));
    frame.present = i == 0 ? before : since;
    if (i == from_frame) frame.events = begins;
    measures.frame(frame);
  }
  measures.end();
  return measures;
}

TEST(ContactMeasures, IgnorePeopleUntilTheyHaveSettled) {
  EXPECT_EQ(newcomer_touches(1, 0).contacts(), 1u);
  EXPECT_EQ(newcomer_touches(5, 0.5).contacts(), 0u) << "0.4 s after entering";
  EXPECT_EQ(newcomer_touches(6, 0.5).contacts(), 1u) << "0.5 s after";
  EXPECT_NEAR(newcomer_touches(1, 0).person_s(), 3.5, 1e-9);
  EXPECT_NEAR(newcomer_touches(1, 0.5).person_s(), 2 * 0.7 + 0.6, 1e-9);
}

TEST(ContactMeasures, CountAlternatingPartsAsOneContactOfPeople) {
  const ThreePeople people;
  ContactMeasures measures(people.run);
  const PairKey hands(0, 1, part("leftHand"), part("RightHand"));
  const PairKey arms(0, 1, part("lowerLeftArm"), part("upperRightArm"));
  const std::vector<std::vector<PairEvent>> frames = {
      {},
      {{hands, EventKind::kBegin}},
      {{hands, EventKind::kEnd}, {arms, EventKind::kBegin}},
      {{arms, EventKind::kEnd}}};
  for (size_t i = 0; i < frames.size(); ++i) {
    Frame frame = people.frame(static_cast<int64_t>(i));
    frame.events = frames[i];
    measures.frame(frame);
  }
  measures.end();
  const double one = 120 / measures.person_s();
  const MeasureTable table = measures.contact_table();
  EXPECT_NEAR(table.value("all", "", "contacts"), one, 1e-9);
  EXPECT_NEAR(table.value("hand and hand", "", "contacts"), one, 1e-9);
  EXPECT_NEAR(table.value("arm and arm", "", "contacts"), one, 1e-9);
  EXPECT_NEAR(measures.person_s(), 3 * 4 * 0.1, 1e-9);
}

TEST(ContactMeasures, EqualTheStatisticsOfTheRunWithoutAGap) {
  class Both final : public Sink {
   public:
    void begin(const RunInfo& run) override {
      statistics.emplace(run);
      measures.emplace(run, 0);
      bridged.emplace(run);
    }
    void frame(const RunInfo&, const Frame& frame) override {
      statistics->frame(frame);
      measures->frame(frame);
      bridged->frame(frame);
    }
    void end(const RunInfo&, const RunEnd& end) override {
      statistics->end(end);
      measures->end();
      bridged->end();
    }
    std::optional<ContactStatistics> statistics;
    std::optional<ContactMeasures> measures, bridged;
  };
  for (uint64_t seed = 1; seed <= 2; ++seed) {
    Scene scene = load_scene("corridor");
    scene.exact = true;
    scene.body_avoidance = false;  // for many contacts
    scene.duration_s = 20;
    scene.seed = seed;
    Simulation simulation(std::move(scene), {.threads = 2});
    Both both;
    Sink* const sink = &both;
    run(simulation, {&sink, 1});
    EXPECT_GT(both.measures->contacts(), 50u);
    EXPECT_EQ(both.measures->contacts(), both.statistics->totals().contacts) << "seed " << seed;
    EXPECT_NEAR(both.measures->person_s(), both.statistics->totals().person_s, 1e-6);
    EXPECT_LT(both.bridged->contacts(), both.measures->contacts()) << "seed " << seed;
    // The lowest level is equal in both.
    EXPECT_NEAR(both.measures->contact_table().value("0 to 0.43", "", "contacts"),
                both.statistics->densities()[0].per_person_min(), 1e-9);
  }
}

TEST(ContactDepths, AreAtMostTheOverlapOfTrunksSideBySide) {
  ThreePeople people;
  ContactDepths depths(people.run);
  const uint32_t torso = part("torso");
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& vertex : adult()->parts[torso].mesh.vertices) box.extend(vertex);
  const double width_m = static_cast<double>(box.sizes().y());
  const PairKey trunks(0, 1, torso, torso);
  double last_m = 1;
  for (const double apart_m : {0.1, 0.2, 0.3, 0.35, 0.4}) {
    people.roots[1].position_m = people.roots[0].position_m + Eigen::Vector3d(0, apart_m, 0);
    Frame frame = people.frame(0);
    frame.pairs = {&trunks, 1};
    double found_m = -1;
    depths.find(people.run, frame, [&](PairKey pair, double depth_m) {
      EXPECT_EQ(pair, trunks);
      found_m = depth_m;
    });
    EXPECT_LE(found_m, std::max(0.0, width_m - apart_m) + 1e-3) << apart_m;
    EXPECT_GE(found_m, 0) << apart_m;
    EXPECT_LT(found_m, last_m + 1e-3) << "the depth falls with the distance: " << apart_m;
    EXPECT_EQ(found_m > 0, apart_m < width_m) << apart_m;
    last_m = found_m;
  }
}

TEST(ContactDepths, AreCollectedByPartAndByContact) {
  ThreePeople people;
  people.roots[1].position_m = {0, 1, 0};
  ContactMeasures measures(people.run);
  const uint32_t torso = part("torso"), hand = part("leftHand");
  const PairKey trunks(0, 1, torso, torso), hands(0, 1, hand, hand);
  const std::vector<PairEvent> begins = {{trunks, EventKind::kBegin}, {hands, EventKind::kBegin}};
  Frame frame = people.frame(0);
  frame.events = begins;
  measures.frame(frame);
  for (const double depth_m : {0.012, 0.071, 0.032}) measures.add_depth(trunks, depth_m);
  measures.add_depth(hands, 0.006);
  measures.end();
  const MeasureTable table = measures.depth_table();
  EXPECT_NEAR(table.value("trunk and trunk", "", "max"), 0.071, 1e-9);
  EXPECT_NEAR(table.value("trunk and trunk", "", "> 2 cm"), 200 / 3.0, 1e-6);
  EXPECT_NEAR(table.value("trunk and trunk", "", "> 5 cm"), 100 / 3.0, 1e-6);
  EXPECT_NEAR(table.value("hand and hand", "", "50 %"), 0.006, 1e-9);
  EXPECT_NEAR(table.value("all", "", "> 2 cm"), 50, 1e-6);
  EXPECT_NEAR(table.value("maximum per contact", "", "50 %"), 0.071, 1e-9);
}

TEST(PartGroups, FollowFromNamesOfParts) {
  EXPECT_EQ(part_group("lowerLeftArm"), PartGroup::kArm);
  EXPECT_EQ(part_group("RightHand"), PartGroup::kHand);
  EXPECT_EQ(part_group("left_forearm_link"), PartGroup::kArm);
  EXPECT_EQ(part_group("pelvis"), PartGroup::kTrunk);
  EXPECT_EQ(part_group("upperRightLeg"), PartGroup::kLeg);
  EXPECT_EQ(part_group("rightFoot"), PartGroup::kFoot);
  EXPECT_EQ(part_group("laser_link"), PartGroup::kOther);
  std::set<size_t> pairs;
  for (size_t a = 0; a < kPartGroups; ++a)
    for (size_t b = 0; b < kPartGroups; ++b) {
      const auto first = static_cast<PartGroup>(a), second = static_cast<PartGroup>(b);
      EXPECT_EQ(group_pair(first, second), group_pair(second, first));
      pairs.insert(group_pair(first, second));
    }
  EXPECT_EQ(pairs.size(), kGroupPairs);
  EXPECT_EQ(*pairs.rbegin(), kGroupPairs - 1);
}

}  // namespace
}  // namespace throng::contact_measures_test
