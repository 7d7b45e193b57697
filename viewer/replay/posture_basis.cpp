#include "viewer/replay/posture_basis.h"

#include <Eigen/Eigenvalues>

namespace throng {
namespace {

/// A whole step moves a column by at most this share of its tolerance, so that rounding many
/// coefficients stays inside it together with what the left-out directions miss.
constexpr double kStepShare = 0.7;
/// What the left-out directions may miss, as a share of the tolerance.
constexpr double kMissShare = 0.6;

}  // namespace

Eigen::MatrixXi PostureBasis::coefficients(const Eigen::MatrixXd& rows) const {
  const Eigen::MatrixXd steps = (rows.rowwise() - mean.transpose()) * coefficient_of_.transpose();
  return steps.array().round().cast<int>();
}

PostureBasis PostureBasis::of(const Eigen::MatrixXd& rows, const Eigen::VectorXd& tolerance) {
  PostureBasis basis;
  const Eigen::Index columns = rows.cols();
  basis.mean = Eigen::VectorXd::Zero(columns);
  if (rows.size() == 0) {
    basis.directions.resize(columns, 0);
    basis.coefficient_of_.resize(0, columns);
    return basis;
  }
  basis.mean = rows.colwise().mean();
  const Eigen::VectorXd weight = tolerance.cwiseInverse();
  // In units of the tolerance every column counts alike.
  const Eigen::MatrixXd scaled = (rows.rowwise() - basis.mean.transpose()) * weight.asDiagonal();
  const Eigen::MatrixXd covariance = scaled.transpose() * scaled;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(covariance);
  const Eigen::MatrixXd vectors = solver.eigenvectors().rowwise().reverse();  // largest first
  Eigen::MatrixXd missed = scaled;
  Eigen::Index components = 0;
  while (components < columns && missed.cwiseAbs().maxCoeff() > kMissShare) {
    const Eigen::VectorXd v = vectors.col(components++);
    missed -= (missed * v) * v.transpose();
  }
  const Eigen::MatrixXd kept = vectors.leftCols(components);
  basis.directions = tolerance.asDiagonal() * kept * kStepShare;
  basis.coefficient_of_ = kept.transpose() * weight.asDiagonal() / kStepShare;
  return basis;
}

}  // namespace throng
