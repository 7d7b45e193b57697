#include <fmt/format.h>
#include <fmt/ranges.h>

#include <vector>

#include "apps/info.h"
#include "avatars/tri.h"

namespace throng {
namespace {

std::string describe(const TriDialect& dialect) {
  std::vector<std::string> words = {dialect.keyword ? "TRI keyword" : "counts, then lists"};
  if (dialect.counts_on_one_line) words.push_back("counts on one line");
  words.push_back(dialect.one_based ? "1-based" : "0-based");
  if (dialect.comments) words.push_back("comments");
  if (dialect.crlf) words.push_back("CRLF");
  if (dialect.byte_order_mark) words.push_back("byte order mark");
  return fmt::format("{}", fmt::join(words, ", "));
}

}  // namespace

void print_tri_info(const std::filesystem::path& file) {
  const TriFile tri = read_tri(file);
  const Mesh& mesh = tri.mesh;
  Eigen::Vector3f low = mesh.vertices.front();
  Eigen::Vector3f high = low;
  for (const Eigen::Vector3f& vertex : mesh.vertices) {
    low = low.cwiseMin(vertex);
    high = high.cwiseMax(vertex);
  }
  fmt::print("{}\n", file.string());
  fmt::print("  form       {}\n", describe(tri.dialect));
  fmt::print("  vertices   {}\n", mesh.vertices.size());
  if (mesh.is_point_cloud()) {
    fmt::print("  triangles  none: a point cloud; volumes fit it, exact tests refuse it\n");
  } else {
    fmt::print("  triangles  {}\n", mesh.triangles.size());
    const double volume_m3 = signed_volume_m3(mesh);
    if (is_closed(mesh)) {
      fmt::print("  surface    closed, {}\n", volume_m3 > 0
                                                  ? "oriented outwards"
                                                  : "oriented inwards: exact tests need outwards");
      fmt::print("  volume     {:.6f} m3\n", volume_m3);
    } else {
      fmt::print("  surface    open: exact tests see the surface, not a solid\n");
    }
  }
  fmt::print("  low        {:.4f} {:.4f} {:.4f} m\n", low.x(), low.y(), low.z());
  fmt::print("  high       {:.4f} {:.4f} {:.4f} m\n", high.x(), high.y(), high.z());
}

}  // namespace throng
