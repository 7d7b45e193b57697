// What moves the avatars of a run: a steered crowd, a recording, a box of loose parts.
// One rule: a world moves all of its avatars at each call, once a frame, and knows nothing of
// culling or of who listens. What not every world has to say is empty unless it says so.
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
class ExternalAvatars;
class Posing;

class MotionSource {
 public:
  virtual ~MotionSource() = default;

  /// Which models its avatars have.
  virtual const std::vector<std::shared_ptr<const Model>>& models() const = 0;
  /// Appends, one an avatar, what it is from the start: its type (an index into models()), scale,
  /// phase; style and look where avatars have them. Where it knows postures itself, external_rows,
  /// one an avatar, null for those who walk by their gait: all of a model or none.
  virtual void place(BodyStates& bodies) = 0;
  /// Around every posture that it holds avatars of this model in; none: around every posture at
  /// all.
  virtual std::optional<RootSphere> external_rows_sphere(size_t /*model*/) const { return {}; }
  /// The groups of the run, and which of them each avatar is in.
  virtual void describe(RunInfo& info) const = 0;

  /// Once, before the first update(): what depends on how the placed bodies walk.
  virtual void prepare(const Posing&, const BodyStates&) {}

  /// Moves everybody on by the scene's step. Allocates nothing.
  virtual void step() = 0;
  /// Writes where everybody is: the first of `bodies.roots`, phases and feet as `posing` has its
  /// avatars walk there, held rows where they are elsewhere, and speeds, one an avatar. Once a
  /// frame, frame 0 included.
  virtual void update(const Posing& posing, BodyStates& bodies, std::span<float> speeds_mps) = 0;
  /// Everything that the next step depends on and that the constructor does not know.
  virtual void archive(Archive& a) = 0;
  /// Of all that shapes its frames and that the scene does not say; 0: nothing does. Part of the
  /// run id.
  virtual uint64_t content_hash() const { return 0; }

  /// One an avatar, 0 where it is not in the scene at this time; always empty if everybody is there
  /// all the time.
  virtual std::span<const uint8_t> present() const { return {}; }

  /// As present(), but 1 as well where it is about to come in and others give way to it already.
  virtual std::span<const uint8_t> expected() const { return present(); }

  /// Adds those that something outside moves, where they start.
  virtual void add_external(ExternalAvatars&) const {}
  /// Puts the driven where they are, after step() and over what it made of them.
  virtual void apply_external(const ExternalAvatars&) {}

  /// What the user should know before the run.
  virtual const std::vector<std::string>& notes() const;
  /// Avatars that the scene asks for but that found no place.
  virtual int unplaced() const { return 0; }
  /// Of the latest decision of steering.
  virtual const SteeringCounters& steering() const;
  /// How many have entered and left so far.
  virtual const PopulationCounters& population() const;
  /// The people who cannot reach a goal, as of now.
  virtual std::vector<Stranding> strandings() const { return {}; }
};

/// Makes what moves the avatars of a scene; the world may keep references to scene and workers.
/// Throws InputError.
using MotionFactory = std::function<std::unique_ptr<MotionSource>(
    const Scene& scene, SimdTarget simd, Workers& workers)>;

/// The world of a scene whose models are loaded. Keeps references to `scene` and `workers`. Throws
/// InputError.
std::unique_ptr<MotionSource> make_motion(const Scene& scene, SimdTarget simd, Workers& workers);

}  // namespace throng
