// Contacts of two people by density, and what is wrong with them; the tables of `realism contacts`.
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

/// Whether a hand is wholly inside a part of somebody else.
/// Every vertex of the hand is asked for, until one is outside.
class HandPenetration {
 public:
  explicit HandPenetration(const RunInfo& run);

  /// Of a pair of which one part or both are hands; false for any other. The frame has postures.
  bool is_inside(const RunInfo& run, const Frame& frame, PairKey pair);

  /// The least edge of the hand's box at this avatar's scale; of two hands the lesser. Infinite for
  /// a pair without hands: nothing is deeper.
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
    Eigen::Isometry3d world_from_part;  ///< but for the place of the first root
    double scale;
  };
  const Solid& solid(const RunInfo& run, uint32_t avatar, uint32_t part) const;
  Placed placed(const RunInfo& run, const Frame& frame, uint32_t avatar, uint32_t part,
                const Eigen::Vector3d& origin_m);
  static bool contains(const Placed& outer, const Placed& hand);

  std::vector<std::vector<Solid>> solids_;  ///< by model and part
  std::vector<PartPose> poses_;
};

// Contacts of two people by density, and what is wrong with them: depth, trunk in trunk, a hand
// inside somebody, and how many are there because two heads are nearer than bodies allow.
// Sums alone, so that those of several runs add up to those of all.

/// Contacts whose heads never came nearer than this are counted once more by themselves. The first
/// are all.
inline constexpr std::array<double, 4> kMinHeadDistances_m = {0, 0.30, 0.35, 0.38};

/// Of the contacts at one level of density whose heads stayed so far apart. Depths and what follows
/// from them are those of sampled instants, as long as the heads are so far apart then.
struct ContactTally {
  ContactTally();

  uint64_t contacts = 0;
  uint64_t trunks = 0;      ///< of these: trunk touched trunk
  uint64_t hands_in = 0;    ///< of these: a hand was wholly inside another part
  uint64_t hands_deep = 0;  ///< of these: one was deeper in another part than it is thick
  Histogram depths;         ///< of two parts
  Histogram max_depths;     ///< of two people: the deepest of their parts

  void add(const ContactTally& other);
};

struct ContactLevel {
  double person_s = 0;
  double touching_s = 0;  ///< person-seconds of those who touch somebody
  std::array<ContactTally, kMinHeadDistances_m.size()> apart;  ///< by kMinHeadDistances_m

  void add(const ContactLevel& other);
};

struct ContactSums {
  static constexpr size_t kLevels = ContactMeasures::kLevels;

  ContactSums();

  double person_s = 0;
  std::array<ContactLevel, kLevels> levels;
  std::vector<Histogram> depths_of;  ///< by pair of groups
  double min_head_distance_m = 100;  ///< of those who touched

  void add(const ContactSums& other);
  /// Of all levels.
  ContactLevel all() const;
};

class ContactAudit final : public Sink {
 public:
  ContactAudit();
  ~ContactAudit() override;

  SinkNeeds needs() const override { return {.postures = true}; }
  void begin(const RunInfo& run) override;
  void frame(const RunInfo& run, const Frame& frame) override;
  void end(const RunInfo& run, const RunEnd& end) override;

  /// After end().
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

/// The tables of `realism contacts`.
/// What there is nothing of is a dash, never 0.
struct NamedContactSums {
  std::string name;
  ContactSums sums;
};

/// With a second one, each figure is followed by its own: before and after.
std::string contact_report(const NamedContactSums& before, const NamedContactSums* after,
                           bool with_parts);

}  // namespace throng::realism
