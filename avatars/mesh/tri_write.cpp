#include <charconv>

#include "avatars/mesh/tri.h"

namespace throng {
namespace {

template <typename Number, typename... Format>
void append(std::string& out, Number value, char after, Format... format) {
  char digits[64];  // the longest fixed float is -3.4e38 written out: 40 characters; 1e-45: 55
  const auto end = std::to_chars(digits, digits + sizeof digits, value, format...).ptr;
  out.append(digits, end);
  out.push_back(after);
}

}  // namespace

std::string format_tri(const Mesh& mesh) {
  std::string out;
  out.reserve(mesh.vertices.size() * 30 + mesh.triangles.size() * 16 + 16);
  append(out, mesh.vertices.size(), '\n');
  // Adding zero turns -0 into 0. The shortest digits that read back as the same float: exact, and
  // the same from any compiler.
  for (const Eigen::Vector3f& v : mesh.vertices)
    for (int i = 0; i < 3; ++i)
      append(out, v[i] + 0.0F, i < 2 ? ' ' : '\n', std::chars_format::fixed);
  append(out, mesh.triangles.size(), '\n');
  for (const Eigen::Vector3i& t : mesh.triangles)
    for (int i = 0; i < 3; ++i) append(out, t[i], i < 2 ? ' ' : '\n');
  return out;
}

}  // namespace throng
