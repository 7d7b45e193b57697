// A custom engine on the frames of `throng bench --export FOLDER`: FCL's tree of boxes. PROGRAM
// FOLDER writes FOLDER/found.csv for `throng bench --check FOLDER/found.csv`.
#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/narrowphase/collision_object.h>

#include <cstdio>
#include <deque>
#include <fstream>
#include <map>

struct Box : fcl::CollisionGeometryd {  // a shape that is its bounding box, with indices
  unsigned frame, box, avatar;
  void computeLocalAABB() override {}
};

bool append_pair(fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* out) {
  const auto& i = static_cast<const Box&>(*a->collisionGeometry());
  const auto& j = static_cast<const Box&>(*b->collisionGeometry());
  if (i.avatar != j.avatar)
    *static_cast<std::ofstream*>(out) << i.frame << ',' << i.box << ',' << j.box << '\n';
  return false;  // continue
}

int main(int argc, char** argv) {
  const std::string folder = argc > 1 ? argv[1] : ".";
  std::ifstream in(folder + "/boxes.csv");
  std::ofstream out(folder + "/found.csv");
  std::map<unsigned, std::deque<fcl::CollisionObjectd>> frames;
  std::string line;
  for (std::getline(in, line); std::getline(in, line);) {  // skips the header
    const auto box = std::make_shared<Box>();
    fcl::AABBd& at = box->aabb_local;
    std::sscanf(line.c_str(), "%u,%u,%u,%*u,%lf,%lf,%lf,%lf,%lf,%lf", &box->frame, &box->box,
                &box->avatar, &at.min_[0], &at.min_[1], &at.min_[2], &at.max_[0], &at.max_[1],
                &at.max_[2]);
    frames[box->frame].emplace_back(box);
  }
  out << "frame,a,b\n";
  for (auto& [number, boxes] : frames) {
    fcl::DynamicAABBTreeCollisionManagerd tree;
    for (fcl::CollisionObjectd& box : boxes) tree.registerObject(&box);
    tree.setup();
    tree.collide(&out, append_pair);
  }
  return in.eof() && out.flush() ? 0 : 3;
}
