// What a soup of triangles is as a surface: which of it is closed, and in how many pieces it comes.
// One rule: corners at exactly the same place are one corner, whatever their indices.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace throng {

class Surface {
 public:
  explicit Surface(std::span<const std::array<Eigen::Vector3f, 3>> triangles);

  /// Of a triangle that bounds no solid.
  static constexpr uint32_t kOpen = UINT32_MAX;

  /// By triangle: the solid that it bounds, numbered in the order in which the triangles first name
  /// them, or kOpen. A solid is what hangs together by edges, once all that ends in a rim is taken
  /// off (a loose triangle, a fin, a sheet), and uses every edge as often in one direction as in
  /// the other.
  const std::vector<uint32_t>& solids() const { return solids_; }
  uint32_t solid_count() const { return solid_count_; }
  /// One corner of each piece that hangs together by corners, in the order in which the triangles
  /// first name them.
  const std::vector<Eigen::Vector3f>& pieces() const { return pieces_; }

 private:
  std::vector<uint32_t> solids_;
  uint32_t solid_count_ = 0;
  std::vector<Eigen::Vector3f> pieces_;
};

}  // namespace throng
