#include "lcm_io/codec/readable.h"

#include <fmt/format.h>

#include "base/errors.h"
#include "base/limits.h"
#include "lcm_io/codec/description.h"
#include "lcm_io/codec/encoder.h"

namespace throng {

std::vector<uint8_t> readable_description(const RunInfo& run) {
  const std::string where = run.scene->file.empty() ? run.scene->name : run.scene->file.string();
  // What does not fit into the numbers of a description cannot be seen in it any more.
  if (run.models.size() > kMaxModels || run.groups.size() > kMaxGroups)
    throw InputError(where, fmt::format("at most {} models and {} groups", kMaxModels, kMaxGroups),
                     fmt::format("{} and {}", run.models.size(), run.groups.size()));
  const run_description_t description = describe(run);
  const std::string defect = defect_of(description);
  if (!defect.empty()) throw InputError(where, "a run whose log can be read", defect);
  const auto size = static_cast<size_t>(description.getEncodedSize());
  if (size > kMaxDescriptionBytes)
    throw InputError(
        where, fmt::format("models and obstacles of at most {} MB", kMaxDescriptionBytes >> 20),
        fmt::format("{} MB", size >> 20));
  std::vector<uint8_t> bytes(size);
  description.encode(bytes.data(), 0, static_cast<int>(size));
  return bytes;
}

void require_readable(const RunInfo& run, bool part_poses) {
  struct : MessageTarget {
    void message(Channel, int64_t, std::span<const uint8_t>) override {}
  } nobody;
  EncoderOptions options;
  options.part_poses = part_poses;
  RunEncoder(options, nobody).begin(run);
}

}  // namespace throng
