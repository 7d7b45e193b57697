// What a soup of triangles is as a surface: closed or not, and in how many pieces.
// One rule: corners at exactly the same place are one corner, whatever their indices.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

namespace throng {

class Surface {
 public:
  explicit Surface(std::span<const std::array<Eigen::Vector3f, 3>> triangles);

  /// Every edge is used as often in one direction as in the other.
  bool is_closed() const { return is_closed_; }
  /// One corner of each connected piece, in the order in which the triangles first name them.
  const std::vector<Eigen::Vector3f>& pieces() const { return pieces_; }

 private:
  bool is_closed_ = false;
  std::vector<Eigen::Vector3f> pieces_;
};

}  // namespace throng
