// FCL's dynamic AABB tree: all boxes are set, then update() refits the whole tree.
// Compile this file without -march=native: it changes the alignment of FCL's Eigen types, and
// Debian's library then returns wrong results.
#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/config.h>
#include <fcl/narrowphase/collision_object.h>

#include <deque>

#include "bench/engines/engine.h"

namespace throng::bench {
namespace {

/// A shape that consists of its box only.
class BoxGeometry : public fcl::CollisionGeometryd {
 public:
  void computeLocalAABB() override {}
  void set(const Box& box) {
    for (int axis = 0; axis < 3; ++axis) {
      aabb_local.min_[axis] = static_cast<double>(box.min_m[axis]);
      aabb_local.max_[axis] = static_cast<double>(box.max_m[axis]);
    }
  }
};

class FclEngine : public Engine {
 public:
  std::string name() const override { return "fcl"; }
  std::string version() const override { return FCL_VERSION; }
  std::string what() const override {
    return "boxes only: DynamicAABBTreeCollisionManager, update and self-collide, one thread";
  }

  void build(const BoxList& frame) override {
    parts_ = frame.parts;
    std::vector<fcl::CollisionObjectd*> pointers;
    for (const Box& box : frame.boxes) {
      const auto geometry = std::make_shared<BoxGeometry>();
      geometry->set(box);
      fcl::CollisionObjectd& object = objects_.emplace_back(geometry);
      geometries_.push_back(geometry.get());
      object.setUserData(reinterpret_cast<void*>(objects_.size() - 1));
      pointers.push_back(&object);
    }
    manager_.registerObjects(pointers);
    manager_.setup();
  }

  void update(const BoxList& frame) override {
    for (size_t i = 0; i < frame.boxes.size(); ++i) {
      geometries_[i]->set(frame.boxes[i]);
      objects_[i].computeAABB();
    }
    manager_.update();
  }

  void pairs(std::vector<BoxPair>& out) override {
    out.clear();
    Collector collector{{{}, parts_}, &out};
    manager_.collide(&collector, [](fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* to) {
      auto* found = static_cast<Collector*>(to);
      append_pair(found->frame, index_of(a), index_of(b), *found->out);
      return false;
    });
  }

 private:
  struct Collector {
    BoxList frame;
    std::vector<BoxPair>* out;
  };
  static uint32_t index_of(const fcl::CollisionObjectd* object) {
    return static_cast<uint32_t>(reinterpret_cast<uintptr_t>(object->getUserData()));
  }

  uint32_t parts_ = 1;
  std::deque<fcl::CollisionObjectd> objects_;  // the manager stores their addresses
  std::vector<BoxGeometry*> geometries_;       // owned by the objects
  fcl::DynamicAABBTreeCollisionManagerd manager_;
};

}  // namespace

std::unique_ptr<Engine> make_fcl(int) { return std::make_unique<FclEngine>(); }

}  // namespace throng::bench
