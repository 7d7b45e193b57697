#include "recordings/recording.h"

#include "geometry/wkt.h"
#include "recordings/recorded_samples.h"

namespace throng {

Recording::Recording(RecordingFacts facts, std::vector<RecordedPerson> people,
                     std::unique_ptr<const RecordedSamples> samples, uint64_t content_hash)
    : facts_(std::move(facts)),
      people_(std::move(people)),
      samples_(std::move(samples)),
      content_hash_(content_hash) {}

Recording::~Recording() = default;

void Recording::read(size_t person, std::vector<Sample>& out) const { samples_->read(person, out); }

JoinedArea recorded_area(const RecordingFacts& facts, const std::string& where) {
  if (facts.wkt.empty()) return {};
  std::vector<Polygon> area = parse_wkt(facts.wkt, where);
  const auto place = [&](Polygon::Ring& ring) {
    for (Eigen::Vector2d& corner : ring) corner = corner * facts.wkt_unit_m - facts.shift_m;
  };
  for (Polygon& polygon : area) {
    place(polygon.outline);
    for (Polygon::Ring& hole : polygon.holes) place(hole);
  }
  return join(area, where);
}

}  // namespace throng
