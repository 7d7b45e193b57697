#include "recordings/sample_store.h"

#include <algorithm>
#include <cstring>

namespace throng {

SampleStore::SampleStore() { unwritten_.reserve(kWriteBytes); }

size_t SampleStore::add_person() {
  chains_.emplace_back();
  return chains_.size() - 1;
}

void SampleStore::add(size_t person, const StoredSample& sample) {
  if (chains_[person].staged == kNotStaged) stage(person);
  Chain& chain = chains_[person];
  if (chain.count > 0 && sample.instant < chain.last_instant) chain.is_shuffled = true;
  chain.last_instant = sample.instant;
  staged_[chain.staged * kBlockSamples + chain.staged_count] = sample;
  ++chain.count;
  if (++chain.staged_count == kBlockSamples) flush(chain);
}

void SampleStore::finish() {
  flush_all();
  write_out();
  staged_ = {};
  staged_people_ = {};
  unwritten_ = {};
}

void SampleStore::stage(size_t person) {
  if (staged_people_.size() == kMaxStaged) flush_all();
  chains_[person].staged = static_cast<uint32_t>(staged_people_.size());
  staged_people_.push_back(static_cast<uint32_t>(person));
  staged_.resize(staged_people_.size() * kBlockSamples);
}

void SampleStore::flush(Chain& chain) {
  if (chain.staged_count == 0) return;
  const size_t at = unwritten_.size();
  const size_t bytes = chain.staged_count * sizeof(StoredSample);
  const BlockHeader head{chain.last_block, chain.staged_count};
  unwritten_.resize(at + sizeof head + bytes);
  std::memcpy(unwritten_.data() + at, &head, sizeof head);
  std::memcpy(unwritten_.data() + at + sizeof head, &staged_[chain.staged * kBlockSamples], bytes);
  chain.last_block = written_ + static_cast<int64_t>(at);
  chain.staged_count = 0;
  if (unwritten_.size() + kBlockBytes > kWriteBytes) write_out();
}

void SampleStore::flush_all() {
  for (const uint32_t person : staged_people_) {
    flush(chains_[person]);
    chains_[person].staged = kNotStaged;
  }
  staged_people_.clear();
}

void SampleStore::write_out() {
  file_.write(written_, unwritten_);
  written_ += static_cast<int64_t>(unwritten_.size());
  unwritten_.clear();
}

void SampleStore::read(size_t person, std::vector<StoredSample>& out) const {
  const Chain& chain = chains_[person];
  auto left = static_cast<size_t>(chain.count);
  out.resize(left);
  alignas(StoredSample) std::byte block[kBlockBytes];
  for (int64_t at = chain.last_block; at >= 0;) {
    const auto bytes =
        static_cast<size_t>(std::min<int64_t>(static_cast<int64_t>(kBlockBytes), written_ - at));
    file_.read(at, {block, bytes});
    BlockHeader head;
    std::memcpy(&head, block, sizeof head);
    left -= static_cast<size_t>(head.count);
    std::memcpy(&out[left], block + sizeof head,
                static_cast<size_t>(head.count) * sizeof(StoredSample));
    at = head.before;
  }
  if (chain.is_shuffled)
    std::stable_sort(out.begin(), out.end(), [](const StoredSample& a, const StoredSample& b) {
      return a.instant < b.instant;
    });
}

}  // namespace throng
