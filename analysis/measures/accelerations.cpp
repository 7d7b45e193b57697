#include "analysis/measures/accelerations.h"

#include <utility>

namespace throng {
namespace {

constexpr double kShortestStep_s = 0.075, kLongestStep_s = 0.13;
constexpr double kBin_mps2 = 0.02;
constexpr size_t kBins = 2500;

}  // namespace

Accelerations::Accelerations(double sample_s)
    : sample_s_(sample_s),
      is_measured_(sample_s >= kShortestStep_s && sample_s <= kLongestStep_s),
      heads_mps2_(0, kBin_mps2, kBins),
      roots_mps2_(0, kBin_mps2, kBins) {}

void Accelerations::take(const RecentCrowd& crowd) {
  if (!is_measured_) return;
  const Moment& before = crowd.ago(2);
  const Moment& at = crowd.ago(1);
  const Moment& after = crowd.ago(0);
  const double square_s2 = sample_s_ * sample_s_;
  for (size_t i = 0; i < at.present.size(); ++i) {
    if (!crowd.stayed(i, 1, 1, 1)) continue;
    heads_mps2_.add((after.heads_m[i] - 2 * at.heads_m[i] + before.heads_m[i]).norm() / square_s2);
    roots_mps2_.add((after.roots_m[i] - 2 * at.roots_m[i] + before.roots_m[i]).norm() / square_s2);
  }
}

MeasureTable Accelerations::table() const {
  MeasureTable table{"accelerations",
                     "Accelerations",
                     "point",
                     "",
                     "Over a tenth of a second and in every direction: of the head, with its sway, "
                     "and of the body's way on the ground.",
                     {},
                     {}};
  for (const auto& [name, histogram] :
       {std::pair("head", &heads_mps2_), std::pair("body", &roots_mps2_)}) {
    if (histogram->count() == 0) continue;
    for (const auto& [what, share] :
         {std::pair("50 %", 0.5), std::pair("95 %", 0.95), std::pair("99.9 %", 0.999)})
      table.rows.push_back({name, {}, {}, "", what, "m/s2", histogram->quantile(share)});
  }
  return table;
}

}  // namespace throng
