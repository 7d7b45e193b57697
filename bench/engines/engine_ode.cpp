// ODE's sweep and prune space (radix sort along one axis). Its hash space aborts at 20 000 avatars.
// A custom geom class returns the box directly: no shape has to be bounded.
#include <ode/ode.h>
#include <ode/version.h>

#include "bench/engines/engine.h"

namespace throng::bench {
namespace {

class OdeEngine : public Engine {
 public:
  OdeEngine() {
    dInitODE2(0);
    space_ = dSweepAndPruneSpaceCreate(nullptr, dSAP_AXES_XYZ);
    dSpaceSetCleanup(space_, 1);  // the space destroys its geoms
  }
  ~OdeEngine() override { dSpaceDestroy(space_); }
  OdeEngine(const OdeEngine&) = delete;
  OdeEngine& operator=(const OdeEngine&) = delete;

  std::string name() const override { return "ode"; }
  std::string version() const override { return dODE_VERSION; }
  std::string what() const override {
    return "boxes only: sweep and prune space, dSpaceCollide, one thread";
  }

  void build(const BoxList& frame) override {
    list_ = {{}, frame.parts};
    boxes_.assign(frame.boxes.begin(), frame.boxes.end());
    for (const Box& box : boxes_) {
      const dGeomID geom = dCreateGeom(box_class());
      *static_cast<const Box**>(dGeomGetClassData(geom)) = &box;
      dSpaceAdd(space_, geom);
      geoms_.push_back(geom);
    }
  }

  void update(const BoxList& frame) override {
    for (size_t i = 0; i < boxes_.size(); ++i) {
      boxes_[i] = frame.boxes[i];
      const float* low = boxes_[i].min_m;
      dGeomSetPosition(geoms_[i], static_cast<dReal>(low[0]), static_cast<dReal>(low[1]),
                       static_cast<dReal>(low[2]));  // reports the move to the space
    }
  }

  void pairs(std::vector<BoxPair>& out) override {
    out.clear();
    out_ = &out;
    dSpaceCollide(space_, this, [](void* to, dGeomID a, dGeomID b) {
      auto* self = static_cast<OdeEngine*>(to);
      append_pair(self->list_, self->index_of(a), self->index_of(b), *self->out_);
    });
  }

 private:
  uint32_t index_of(dGeomID geom) const {
    return static_cast<uint32_t>(*static_cast<const Box**>(dGeomGetClassData(geom)) -
                                 boxes_.data());
  }

  /// ODE keeps classes for the life of the process, four at most.
  static int box_class() {
    static const int number = [] {
      dGeomClass kind{};
      kind.bytes = sizeof(const Box*);
      kind.collider = [](int) -> dColliderFn* { return nullptr; };
      kind.aabb = [](dGeomID geom, dReal* out) {
        const Box& box = **static_cast<const Box**>(dGeomGetClassData(geom));
        for (int axis = 0; axis < 3; ++axis) {
          out[2 * axis] = static_cast<dReal>(box.min_m[axis]);
          out[2 * axis + 1] = static_cast<dReal>(box.max_m[axis]);
        }
      };
      return dCreateGeomClass(&kind);
    }();
    return number;
  }

  dSpaceID space_;
  BoxList list_;
  std::vector<Box> boxes_;
  std::vector<dGeomID> geoms_;
  std::vector<BoxPair>* out_ = nullptr;
};

}  // namespace

std::unique_ptr<Engine> make_ode(int) { return std::make_unique<OdeEngine>(); }

}  // namespace throng::bench
