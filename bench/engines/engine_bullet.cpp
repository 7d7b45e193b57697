// Bullet's dynamic AABB tree (btDbvt), used directly, because its broad phase adds a pair cache.
// Leaves are enlarged by 0.05 m as in Bullet: most of them stay in place.
#include <BulletCollision/BroadphaseCollision/btDbvt.h>
#include <fmt/format.h>

#include "bench/engines/engine.h"

namespace throng::bench {
namespace {

class BulletEngine : public Engine {
 public:
  std::string name() const override { return "bullet"; }
  std::string version() const override {
    return fmt::format("{}.{:02}", BT_BULLET_VERSION / 100, BT_BULLET_VERSION % 100);
  }
  std::string what() const override {
    return "boxes only: btDbvt, leaves fattened by 0.05 m, collideTT, one thread";
  }

  void build(const BoxList& frame) override {
    list_ = {{}, frame.parts};
    boxes_.assign(frame.boxes.begin(), frame.boxes.end());
    for (size_t i = 0; i < boxes_.size(); ++i) {
      btDbvtVolume volume = volume_of(boxes_[i]);
      volume.Expand(btVector3(kMargin, kMargin, kMargin));
      leaves_.push_back(tree_.insert(volume, reinterpret_cast<void*>(i)));
    }
    tree_.optimizeTopDown();
  }

  void update(const BoxList& frame) override {
    for (size_t i = 0; i < boxes_.size(); ++i) {
      boxes_[i] = frame.boxes[i];
      btDbvtVolume volume = volume_of(boxes_[i]);
      tree_.update(leaves_[i], volume, kMargin);
    }
    // btDbvtBroadphase does this once per step to balance its tree, for a hundredth of the leaves.
    tree_.optimizeIncremental(1 + tree_.m_leaves / 100);
  }

  void pairs(std::vector<BoxPair>& out) override {
    out.clear();
    Collector collector(*this, out);
    tree_.collideTTpersistentStack(tree_.m_root, tree_.m_root, collector);
  }

 private:
  static constexpr btScalar kMargin = 0.05f;

  struct Collector : btDbvt::ICollide {
    Collector(const BulletEngine& of, std::vector<BoxPair>& to) : engine(of), out(to) {}
    void Process(const btDbvtNode* a, const btDbvtNode* b) override {
      const auto i = static_cast<uint32_t>(reinterpret_cast<uintptr_t>(a->data));
      const auto j = static_cast<uint32_t>(reinterpret_cast<uintptr_t>(b->data));
      if (i != j && !engine.list_.same_avatar(i, j) && overlap(engine.boxes_[i], engine.boxes_[j]))
        append_pair(engine.list_, i, j, out);
    }
    const BulletEngine& engine;
    std::vector<BoxPair>& out;
  };

  static btDbvtVolume volume_of(const Box& box) {
    return btDbvtVolume::FromMM({box.min_m[0], box.min_m[1], box.min_m[2]},
                                {box.max_m[0], box.max_m[1], box.max_m[2]});
  }

  BoxList list_;
  std::vector<Box> boxes_;
  std::vector<btDbvtNode*> leaves_;
  btDbvt tree_;
};

}  // namespace

std::unique_ptr<Engine> make_bullet(int) { return std::make_unique<BulletEngine>(); }

}  // namespace throng::bench
