// ContactAudit counts contacts of two people by density, with signs of implausible ones.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analysis/measures/contact_measures.h"
#include "analysis/measures/measure_table.h"
#include "culling/triangles/triangle_bvh.h"
#include "scenes/run/sink.h"

namespace throng::realism {

/// HandPenetration tests whether a hand is wholly inside a part of another person, by the hand's
/// vertices.
class HandPenetration {
 public:
  explicit HandPenetration(const RunInfo& run);

  /// For pairs with one or two hands; false for others. The frame must have postures.
  bool is_inside(const RunInfo& run, const Frame& frame, PairKey pair);

  /// Returns the shortest edge of the hand's box at the avatar's scale; of two hands the lesser.
  /// Infinite for a pair without hands.
  double thickness_m(const RunInfo& run, PairKey pair) const;

 private:
  struct Solid {
    bool is_hand = false;
    float thickness_m = 0;
    std::vector<Eigen::Vector3f> corners;  ///< a hand's vertices, those of its hull first
    std::unique_ptr<TriangleBvh> surface;
  };
  struct Placed {
    const Solid* solid;
    Eigen::Isometry3d world_from_part;  ///< relative to the position of the first root
    double scale;
  };
  const Solid& solid(const RunInfo& run, uint32_t avatar, uint32_t part) const;
  Placed placed(const RunInfo& run, const Frame& frame, uint32_t avatar, uint32_t part,
                const Eigen::Vector3d& origin_m);
  static bool contains(const Placed& outer, const Placed& hand);

  std::vector<std::vector<Solid>> solids_;  ///< indexed by model and part
  std::vector<PartPose> poses_;
};

// Implausible contacts: deep ones, trunk in trunk, a hand inside a part, and those of two people
// whose heads are closer than bodies allow.
// Invariant: results are sums; sums of several runs add up to those of all.

/// Contacts whose heads never came closer than this are counted separately. The first entry counts
/// all.
inline constexpr std::array<double, 4> kMinHeadDistances_m = {0, 0.30, 0.35, 0.38};

/// Tally of the contacts at one level of density whose heads kept a minimum distance. Depths and
/// derived counts come from samples in which the heads keep that distance.
struct ContactTally {
  ContactTally();

  uint64_t contacts = 0;
  uint64_t trunks = 0;      ///< trunk touched trunk
  uint64_t hands_in = 0;    ///< a hand was wholly inside another part
  uint64_t hands_deep = 0;  ///< a hand was deeper in another part than its thickness
  Histogram depths;         ///< depths of two parts
  Histogram max_depths;     ///< depths of two people: the deepest of their parts

  void add(const ContactTally& other);
};

struct ContactLevel {
  double person_s = 0;
  double touching_s = 0;  ///< person-seconds of touching people
  std::array<ContactTally, kMinHeadDistances_m.size()> tallies;  ///< by kMinHeadDistances_m

  void add(const ContactLevel& other);
};

struct ContactSums {
  static constexpr size_t kLevels = ContactMeasures::kLevels;

  ContactSums();

  double person_s = 0;
  std::array<ContactLevel, kLevels> levels;
  std::vector<Histogram> depths_of;  ///< indexed by pair of part groups
  double min_head_distance_m = 100;  ///< minimum over touching people

  void add(const ContactSums& other);
  ContactLevel all() const;
};

/// ContactAudit accumulates ContactSums over a run.
class ContactAudit final : public Sink {
 public:
  ContactAudit();
  ~ContactAudit() override;

  SinkNeeds needs() const override { return {.postures = true}; }
  void begin(const RunInfo& run) override;
  void frame(const RunInfo& run, const Frame& frame) override;
  void end(const RunInfo& run, const RunEnd& end) override;

  /// Valid after end().
  const ContactSums& sums() const { return sums_; }

 private:
  struct State;
  struct PairContact;

  void accumulate(const PairContact& met);
  void sample(const RunInfo& run, const Frame& frame);
  void track_contacts(const Frame& frame);
  void accumulate_time(const Frame& frame);

  std::unique_ptr<State> state_;
  ContactSums sums_;
};

/// Sums of a scene. The tables print a dash for an undefined value, never 0.
struct NamedContactSums {
  std::string name;
  ContactSums sums;
};

/// Returns the tables of `realism contacts`. With `after`, each figure is followed by that of
/// `after`.
std::string contact_report(const NamedContactSums& before, const NamedContactSums* after,
                           bool with_parts);

}  // namespace throng::realism
