// Joint rows of many moments as a mean and a few directions: walking people fill a small part of
// the space that their joints span (principal components, Pearson 1901).
// One rule: as many components as keep every number of every row within its tolerance.
#pragma once

#include <Eigen/Core>

namespace throng {

struct PostureBasis {
  Eigen::VectorXd mean;        ///< a column each
  Eigen::MatrixXd directions;  ///< columns x components; a coefficient's unit is one whole step
  int components() const { return static_cast<int>(directions.cols()); }

  /// Whole steps along each direction: rows x components.
  Eigen::MatrixXi coefficients(const Eigen::MatrixXd& rows) const;

  /// `rows`: one a line. `tolerance`: one a column, above 0.
  static PostureBasis of(const Eigen::MatrixXd& rows, const Eigen::VectorXd& tolerance);

 private:
  Eigen::MatrixXd coefficient_of_;  // components x columns
};

}  // namespace throng
