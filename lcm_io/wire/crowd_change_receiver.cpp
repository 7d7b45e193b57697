#include "lcm_io/wire/crowd_change_receiver.h"

#include <fmt/format.h>

#include <lcm/lcm-cpp.hpp>

#include "base/errors.h"
#include "lcm_io/codec/message_validation.h"
#include "lcm_io/codec/rows.h"
#include "lcm_io/wire/lcm_url.h"

namespace throng {
namespace {

/// Queued messages until a step; each may change hundreds of agents.
constexpr int kQueuedChanges = 1000;
/// Each may need a new flow field; later ones wait for the next frame.
constexpr int kGoalsPerFrame = 20;

}  // namespace

CrowdChangeReceiver::CrowdChangeReceiver(const RunInfo& run, const std::string& url)
    : CrowdChangeReceiver(run, listening(url, " for changes of the crowd")) {}

CrowdChangeReceiver::CrowdChangeReceiver(const RunInfo& run, std::shared_ptr<lcm::LCM> lcm)
    : run_(run), lcm_(std::move(lcm)) {
  subscribe();
}

CrowdChangeReceiver::~CrowdChangeReceiver() = default;

void CrowdChangeReceiver::subscribe() {
  static constexpr auto on_message = [](const lcm::ReceiveBuffer* buffer, const std::string&,
                                        CrowdChangeReceiver* self) {
    self->take({static_cast<const uint8_t*>(buffer->data), buffer->data_size});
  };
  counts_.channel = run_.scene->change_channel;
  lcm_->subscribeFunction(counts_.channel, +on_message, this)->setQueueCapacity(kQueuedChanges);
}

void CrowdChangeReceiver::apply(Simulation& simulation) {
  simulation_ = &simulation;
  // At most one full queue, because a continuous sender must not delay the run.
  goals_ = 0;
  for (int i = 0; i < kQueuedChanges && goals_ < kGoalsPerFrame && lcm_->handleTimeout(0) > 0;
       ++i) {
  }
  simulation_ = nullptr;
}

void CrowdChangeReceiver::take(std::span<const uint8_t> bytes) {
  // No exception may pass through liblcm's C code.
  try {
    std::string defect = decode(bytes, message_);
    const auto run_id = static_cast<uint64_t>(message_.run_id);
    if (defect.empty() && run_id != 0 && run_id != run_.run_id)
      defect = fmt::format("a change for run {:016x}, not {:016x}", run_id, run_.run_id);
    if (simulation_ == nullptr) defect = "received while no changes are taken";
    if (defect.empty()) {
      MessageHeader header;
      header.seq = message_.seq;
      tally_.count(header, bytes.size());
      counts_.missing = tally_.missing;
      CrowdChange change = change_of(message_);
      goals_ += change.kind == CrowdChange::Kind::kSetGoal ? 1 : 0;
      simulation_->change(change);
      ++counts_.messages;
      return;
    }
    counts_.rejection = std::move(defect);
  } catch (const InputError& error) {
    counts_.rejection = error.what();
  } catch (const std::exception&) {
    counts_.rejection = "too large";
  }
  ++counts_.rejected;
}

}  // namespace throng
