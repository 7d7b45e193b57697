#include "recordings/recording.h"

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

}  // namespace throng
