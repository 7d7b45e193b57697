// Embree 3: the boxes are one user geometry, which is refitted and collided with itself.
// rtcCollide() calls back from several threads. Its reversed pairs and boxes that collide with
// themselves are filtered here.
#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <mutex>

#include "base/errors.h"
#include "bench/engines/engine.h"

namespace throng::bench {
namespace {

class EmbreeEngine : public Engine {
 public:
  explicit EmbreeEngine(int threads) : threads_(threads) {
    device_ = rtcNewDevice(fmt::format("threads={},user_threads=0", threads).c_str());
    if (device_ == nullptr) throw EnvironmentError("embree: no device");
    scene_ = rtcNewScene(device_);
    geometry_ = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_USER);
  }
  ~EmbreeEngine() override {
    rtcReleaseGeometry(geometry_);
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  EmbreeEngine(const EmbreeEngine&) = delete;
  EmbreeEngine& operator=(const EmbreeEngine&) = delete;

  std::string name() const override { return "embree"; }
  std::string version() const override { return RTC_VERSION_STRING; }
  std::string what() const override {
    return fmt::format("boxes only: user geometry, refit and rtcCollide, {} thread{}", threads_,
                       threads_ == 1 ? "" : "s");
  }

  void build(const BoxList& frame) override {
    list_ = {{}, frame.parts};
    boxes_.assign(frame.boxes.begin(), frame.boxes.end());
    rtcSetGeometryUserPrimitiveCount(geometry_, static_cast<unsigned>(boxes_.size()));
    rtcSetGeometryUserData(geometry_, this);
    rtcSetGeometryBoundsFunction(geometry_, bounds, nullptr);
    rtcSetGeometryIntersectFunction(geometry_, [](const RTCIntersectFunctionNArguments*) {});
    rtcSetGeometryOccludedFunction(geometry_, [](const RTCOccludedFunctionNArguments*) {});
    // Only scenes of low build quality keep one tree per geometry, which can be refitted.
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_DYNAMIC);
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_LOW);
    rtcSetGeometryBuildQuality(geometry_, RTC_BUILD_QUALITY_REFIT);
    rtcCommitGeometry(geometry_);
    rtcAttachGeometry(scene_, geometry_);
    commit();
  }

  void update(const BoxList& frame) override {
    std::copy(frame.boxes.begin(), frame.boxes.end(), boxes_.begin());
    rtcCommitGeometry(geometry_);
    commit();
  }

  void pairs(std::vector<BoxPair>& out) override {
    out.clear();
    out_ = &out;
    rtcCollide(scene_, scene_, collect, this);
    check();
  }

 private:
  void commit() {
    rtcCommitScene(scene_);
    check();
  }
  void check() {
    const RTCError error = rtcGetDeviceError(device_);
    if (error != RTC_ERROR_NONE)
      throw EnvironmentError(fmt::format("embree: error {}", static_cast<int>(error)));
  }

  static void bounds(const RTCBoundsFunctionArguments* arguments) {
    const auto* self = static_cast<const EmbreeEngine*>(arguments->geometryUserPtr);
    const Box& box = self->boxes_[arguments->primID];
    RTCBounds& out = *arguments->bounds_o;
    out.lower_x = box.min_m[0];
    out.lower_y = box.min_m[1];
    out.lower_z = box.min_m[2];
    out.upper_x = box.max_m[0];
    out.upper_y = box.max_m[1];
    out.upper_z = box.max_m[2];
  }

  /// Called with batches of up to some tens of pairs.
  static void collect(void* to, RTCCollision* found, unsigned count) {
    auto* self = static_cast<EmbreeEngine*>(to);
    const std::lock_guard<std::mutex> lock(self->mutex_);
    for (unsigned i = 0; i < count; ++i) {
      const uint32_t a = found[i].primID0, b = found[i].primID1;
      if (a < b && overlap(self->boxes_[a], self->boxes_[b]))
        append_pair(self->list_, a, b, *self->out_);
    }
  }

  int threads_;
  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
  RTCGeometry geometry_ = nullptr;
  BoxList list_;
  std::vector<Box> boxes_;
  std::mutex mutex_;
  std::vector<BoxPair>* out_ = nullptr;
};

}  // namespace

std::unique_ptr<Engine> make_embree(int threads) { return std::make_unique<EmbreeEngine>(threads); }

}  // namespace throng::bench
