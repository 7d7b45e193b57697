// MotionSource moves the avatars of a run: a steered crowd, a recording, a box of loose parts.
// Invariant: a source moves all of its avatars once per frame and depends neither on culling nor on
// sinks. Optional parts default to empty.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "avatars/model/model.h"
#include "base/files/archive.h"
#include "base/simd.h"
#include "base/workers.h"
#include "crowd/crowd_counters.h"
#include "culling/body_type.h"
#include "scenes/file/scene.h"

namespace throng {

struct BodyStates;  // scenes/run/postures.h
struct RunInfo;     // scenes/run/sink.h
class Crowd;
class ExternalAvatars;
class Posing;

class MotionSource {
 public:
  virtual ~MotionSource() = default;

  virtual const std::vector<std::shared_ptr<const Model>>& models() const = 0;
  /// Appends the initial state per avatar: type (index into models()), scale and phase, with style
  /// and head yaw if avatars have them. A source that computes postures itself sets external_rows,
  /// null for avatars that walk by their gait; all avatars of a model or none.
  virtual void place(BodyStates& bodies) = 0;
  /// Sphere around all postures in external_rows of this model; empty: any posture is possible.
  virtual std::optional<RootSphere> external_rows_sphere(size_t /*model*/) const { return {}; }
  virtual void describe(RunInfo& info) const = 0;

  /// Called once, before the first update(), with the placed bodies.
  virtual void prepare(const Posing&, const BodyStates&) {}

  /// Advances all avatars by the scene's step. Allocates nothing.
  virtual void step() = 0;
  /// Writes roots, phases, feet, external rows and speeds of all avatars. Called once per frame,
  /// including frame 0. Its avatars come first in `bodies.roots`; `posing` defines their gaits.
  virtual void update(const Posing& posing, BodyStates& bodies, std::span<float> speeds_mps) = 0;
  /// Saves or restores all state of later steps that the constructor does not set.
  virtual void archive(Archive& a) = 0;
  /// Hash of inputs beyond the scene that shape frames, 0: none. Part of the run id.
  virtual uint64_t content_hash() const { return 0; }

  /// Per avatar, 0: not in the scene now; empty: all are always present.
  virtual std::span<const uint8_t> present() const { return {}; }

  /// As present(), but also 1 for avatars about to enter, which others already avoid.
  virtual std::span<const uint8_t> expected() const { return present(); }

  /// Crowd whose agents can be added, removed and redirected during the run; null: none.
  virtual Crowd* crowd() { return nullptr; }

  virtual void add_external(ExternalAvatars&) const {}
  /// Sets external poses, after step() and overriding its result.
  virtual void apply_external(const ExternalAvatars&) {}

  /// Notes for the user, before the run.
  virtual const std::vector<std::string>& notes() const;
  virtual int unplaced() const { return 0; }
  virtual const SteeringCounters& steering() const;
  virtual const PopulationCounters& population() const;
  /// Agents without a path to a goal, as of now.
  virtual std::vector<Stranding> strandings() const { return {}; }
};

/// Creates a motion source, which may keep references to `scene` and `workers`. Throws InputError.
using MotionFactory = std::function<std::unique_ptr<MotionSource>(
    const Scene& scene, SimdTarget simd, Workers& workers)>;

/// Motion source of a scene whose models are loaded. Keeps references to `scene` and `workers`.
/// Throws InputError.
std::unique_ptr<MotionSource> make_motion(const Scene& scene, SimdTarget simd, Workers& workers);

}  // namespace throng
