#include "scenes/retargeting/smoothing.h"

#include <algorithm>
#include <cmath>

namespace throng {
namespace {

/// The samples not more than `reach_s` before `at` or after it.
struct Window {
  size_t begin = 0, end = 0;

  void move_to(std::span<const Sample> track, size_t at, double reach_s) {
    while (track[at].time_s - track[begin].time_s > reach_s) ++begin;
    end = std::max(end, at + 1);
    while (end < track.size() && track[end].time_s - track[at].time_s <= reach_s) ++end;
  }
  size_t size() const { return end - begin; }
};

/// From the sample before to the one after, as far as there are any.
Eigen::Vector2d velocity_by_neighbours(std::span<const Sample> track, size_t at) {
  const Sample& before = track[at > 0 ? at - 1 : at];
  const Sample& after = track[std::min(at + 1, track.size() - 1)];
  const double time_s = after.time_s - before.time_s;
  if (!(time_s > 0)) return Eigen::Vector2d::Zero();
  return (after.position_m - before.position_m) / time_s;
}

}  // namespace

std::vector<WayPoint> way_of(std::span<const Sample> track, double reach_s) {
  std::vector<WayPoint> way(track.size());
  Window window;
  for (size_t i = 0; i < track.size(); ++i) {
    window.move_to(track, i, reach_s);
    const Sample& here = track[i];
    double weight = 0, first = 0, second = 0;
    Eigen::Vector2d sum = Eigen::Vector2d::Zero(), tilt = Eigen::Vector2d::Zero();
    for (size_t j = window.begin; j < window.end; ++j) {
      const double u = (track[j].time_s - here.time_s) / reach_s;
      // Nearly a Gaussian of a third of the reach.
      const double inside = 1 - u * u, w = inside * inside * inside;
      const Eigen::Vector2d d = track[j].position_m - here.position_m;
      weight += w;
      first += w * u;
      second += w * u * u;
      sum += w * d;
      tilt += w * u * d;
    }
    const double determinant = weight * second - first * first;
    way[i] = {here.position_m, velocity_by_neighbours(track, i)};
    if (window.size() < 3 || !(determinant > 1e-6 * weight * weight)) continue;
    way[i].position_m += (second * sum - first * tilt) / determinant;
    way[i].velocity_mps = (weight * tilt - first * sum) / (determinant * reach_s);
  }
  return way;
}

std::vector<Eigen::Vector2d> without_noise(std::span<const Sample> track, double reach_s,
                                           double most_m) {
  std::vector<Eigen::Vector2d> smooth(track.size());
  Window window;
  for (size_t i = 0; i < track.size(); ++i) {
    window.move_to(track, i, reach_s);
    smooth[i] = track[i].position_m;
    if (window.size() < 5) continue;
    double s1 = 0, s2 = 0, s3 = 0, s4 = 0;
    Eigen::Vector2d b0 = Eigen::Vector2d::Zero(), b1 = b0, b2 = b0;
    for (size_t j = window.begin; j < window.end; ++j) {
      const double u = (track[j].time_s - track[i].time_s) / reach_s, square = u * u;
      const Eigen::Vector2d d = track[j].position_m - track[i].position_m;
      s1 += u;
      s2 += square;
      s3 += square * u;
      s4 += square * square;
      b0 += d;
      b1 += u * d;
      b2 += square * d;
    }
    const auto s0 = static_cast<double>(window.size());
    // Cramer's rule for the parabola's value here.
    const double c0 = s2 * s4 - s3 * s3, c1 = s2 * s3 - s1 * s4, c2 = s1 * s3 - s2 * s2;
    const double determinant = s0 * c0 + s1 * c1 + s2 * c2;
    if (!(determinant > 1e-9)) continue;
    Eigen::Vector2d move = (c0 * b0 + c1 * b1 + c2 * b2) / determinant;
    const double length_m = move.norm();
    if (length_m > most_m) move *= most_m / length_m;
    smooth[i] += move;
  }
  return smooth;
}

}  // namespace throng
