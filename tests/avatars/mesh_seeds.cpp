#include "tests/avatars/mesh_seeds.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace throng {

std::vector<MeshSeed> mesh_seeds() {
  std::vector<MeshSeed> out;
  for (const auto& entry : std::filesystem::directory_iterator(THRONG_MESH_FIXTURES)) {
    std::ifstream in(entry.path(), std::ios::binary);
    out.push_back({entry.path().stem().string(),
                   entry.path().extension().string(),
                   {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()}});
  }
  std::sort(out.begin(), out.end(),
            [](const MeshSeed& a, const MeshSeed& b) { return a.name < b.name; });
  return out;
}

}  // namespace throng
