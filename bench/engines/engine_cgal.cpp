// CGAL's box_self_intersection_d: a streamed segment tree, which is rebuilt in every frame.
// Serial: its parallel mode is slower on these boxes.
#include <CGAL/box_intersection_d.h>
#include <CGAL/version.h>

#include "bench/engines/engine.h"

namespace throng::bench {
namespace {

// Split along y, then z, and swept along x: people stand next to each other, not on top.
// 2000 people at 1 per m2 take 13.6 ms; in the order z, y, x with CGAL's cutoff of 10, 140 ms.
constexpr int kAxes[3] = {0, 2, 1};
constexpr std::ptrdiff_t kCutoff = 500;

struct NumberedBox {
  using NT = float;
  using ID = size_t;
  static int dimension() { return 3; }
  float min_coord(int axis) const { return box.min_m[kAxes[axis]]; }
  float max_coord(int axis) const { return box.max_m[kAxes[axis]]; }
  size_t id() const { return index; }

  Box box;
  uint32_t index;
};

class CgalEngine : public Engine {
 public:
  std::string name() const override { return "cgal"; }
  std::string version() const override { return CGAL_VERSION_STR; }
  std::string what() const override {
    return "boxes only: box_self_intersection_d, cutoff 500, one thread";
  }

  void build(const BoxList& frame) override {
    list_ = {{}, frame.parts};
    boxes_.resize(frame.boxes.size());
    pointers_.resize(frame.boxes.size());
    update(frame);
  }

  void update(const BoxList& frame) override {
    for (uint32_t i = 0; i < boxes_.size(); ++i) {
      boxes_[i] = {frame.boxes[i], i};
      pointers_[i] = &boxes_[i];
    }
  }

  void pairs(std::vector<BoxPair>& out) override {
    out.clear();
    // Reorders pointers instead of boxes, as CGAL's manual advises.
    CGAL::box_self_intersection_d(
        pointers_.begin(), pointers_.end(),
        [&](const NumberedBox* a, const NumberedBox* b) {
          append_pair(list_, a->index, b->index, out);
        },
        CGAL::Box_intersection_d::Box_traits_d<const NumberedBox*>(), kCutoff);
  }

 private:
  BoxList list_;
  std::vector<NumberedBox> boxes_;
  std::vector<const NumberedBox*> pointers_;
};

}  // namespace

std::unique_ptr<Engine> make_cgal(int) { return std::make_unique<CgalEngine>(); }

}  // namespace throng::bench
