// A custom volume on the workbench: the capsule, all points within a radius of a segment.
// PROGRAM [PAIRS [SEED [FOLDER]]]; THICKNESS=0.95 makes the capsule too thin, which is detected.
#include <Eigen/Eigenvalues>
#include <cmath>
#include <cstdlib>

#include "bench/workbench/workbench.h"

using Eigen::Vector3d, Eigen::Vector3f;
double distance(const Vector3d& p, const Vector3d& begin, const Vector3d& along) {
  const double length2 = along.squaredNorm(), at = (p - begin).dot(along);
  return (begin + (length2 > 0 ? std::clamp(at / length2, 0.0, 1.0) : 0) * along - p).norm();
}

struct Capsule {
  Vector3f begin_m, end_m;
  float radius_m;
  /// Along the line of the largest variance, as short as the round ends allow.
  static Capsule fit(std::span<const Vector3f> points) {
    Eigen::Matrix3Xd p(3, points.size());
    for (Eigen::Index i = 0; i < p.cols(); ++i) p.col(i) = points[i].cast<double>();
    const Eigen::Matrix3Xd off = p.colwise() - p.rowwise().mean();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> scatter(off * off.transpose());
    const Eigen::Matrix3Xd in = scatter.eigenvectors().transpose() * p;  // z along the line
    const Vector3d middle = 0.5 * (in.rowwise().minCoeff() + in.rowwise().maxCoeff());
    const Eigen::ArrayXd aside2 = (in.colwise() - middle).topRows<2>().colwise().squaredNorm();
    const Eigen::ArrayXd end = (aside2.maxCoeff() - aside2).sqrt(), z = in.row(2).transpose();
    const double low = std::min((z + end).minCoeff(), middle.z());
    const double high = std::max((z - end).maxCoeff(), middle.z());
    const auto at = [&](double along) -> Vector3f {
      return (scatter.eigenvectors() * Vector3d(middle.x(), middle.y(), along)).cast<float>();
    };
    Capsule out{at(low), at(high), 0};
    const Vector3d begin = out.begin_m.cast<double>(), along = out.end_m.cast<double>() - begin;
    for (Eigen::Index i = 0; i < p.cols(); ++i)  // measured on the rounded segment
      out.radius_m = std::max(out.radius_m, float(distance(p.col(i), begin, along)));
    const char* const thickness = std::getenv("THICKNESS");
    out.radius_m *= thickness != nullptr ? std::strtof(thickness, nullptr) : 1.000001f;
    return out;
  }
  static Capsule place(const Capsule& fitted, const throng::PartPose& pose, float scale) {
    return {placed_point(pose, scale, fitted.begin_m), placed_point(pose, scale, fitted.end_m),
            scale * fitted.radius_m};
  }
  /// The distance of two segments is that of two inner points, or at an end of one.
  static bool overlaps(const Capsule& a, const Capsule& b, const Vector3f& a_to_b, float margin) {
    const Vector3d p = a.begin_m.cast<double>(), u = a.end_m.cast<double>() - p;
    const Vector3d q = (a_to_b + b.begin_m).cast<double>(),
                   v = (b.end_m - b.begin_m).cast<double>();
    double min_distance = std::min(
        {distance(p, q, v), distance(p + u, q, v), distance(q, p, u), distance(q + v, p, u)});
    const double uu = u.dot(u), uv = u.dot(v), vv = v.dot(v), volume = uu * vv - uv * uv;
    const double s = (uv * v.dot(p - q) - vv * u.dot(p - q)) / volume;
    const double t = (uu * v.dot(p - q) - uv * u.dot(p - q)) / volume;
    if (volume > 0 && s > 0 && s < 1 && t > 0 && t < 1)
      min_distance = std::min(min_distance, (p + s * u - q - t * v).norm());
    return min_distance <= double(a.radius_m) + double(b.radius_m) + double(margin);
  }
};
int main(int argc, char** argv) { return throng::workbench_main<Capsule>("capsule", argc, argv); }
