#include "scenes/recorded/sample_store.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <span>

#include "base/errors.h"

namespace throng {
namespace {

std::filesystem::path folder() {
  std::error_code error;
  const std::filesystem::path path = std::filesystem::temp_directory_path(error);
  return error ? std::filesystem::path("/tmp") : path;
}

[[noreturn]] void fail(const char* what) {
  throw EnvironmentError(
      fmt::format("{}: cannot {} the temporary file that holds a recording: {}; set TMPDIR to a "
                  "folder that has room for it",
                  folder().string(), what, std::strerror(errno)));
}

/// Open for reading and writing, above standard error's, in no folder.
int nameless_file() {
  int low = ::open(folder().c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (low < 0) {  // a file system without such files
    std::string name = (folder() / "throng_recording_XXXXXX").string();
    low = ::mkostemp(name.data(), O_CLOEXEC);
    if (low < 0) fail("make");
    ::unlink(name.c_str());
  }
  if (low > STDERR_FILENO) return low;
  const int file = ::fcntl(low, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
  const int error = errno;
  ::close(low);
  errno = error;
  if (file < 0) fail("make");
  return file;
}

}  // namespace

SampleStore::SampleStore() : file_(nameless_file()) { unwritten_.reserve(kWriteBytes); }

SampleStore::~SampleStore() {
  if (file_ >= 0) ::close(file_);
}

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
  if (staged_people_.size() == kMostStaged) flush_all();
  chains_[person].staged = static_cast<uint32_t>(staged_people_.size());
  staged_people_.push_back(static_cast<uint32_t>(person));
  staged_.resize(staged_people_.size() * kBlockSamples);
}

void SampleStore::flush(Chain& chain) {
  if (chain.staged_count == 0) return;
  const size_t at = unwritten_.size();
  const size_t bytes = chain.staged_count * sizeof(StoredSample);
  const BlockHead head{chain.last_block, chain.staged_count};
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
  std::span<const std::byte> left(unwritten_);
  while (!left.empty()) {
    const ssize_t count = ::pwrite(file_, left.data(), left.size(), written_);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail("write");
    written_ += count;
    left = left.subspan(static_cast<size_t>(count));
  }
  unwritten_.clear();
}

void SampleStore::read(size_t person, std::vector<StoredSample>& out) const {
  const Chain& chain = chains_[person];
  auto left = static_cast<size_t>(chain.count);
  out.resize(left);
  alignas(StoredSample) std::byte block[kBlockBytes];
  for (int64_t at = chain.last_block; at >= 0;) {
    // The last block of the file may be shorter than the largest.
    const auto wanted =
        static_cast<size_t>(std::min<int64_t>(static_cast<int64_t>(kBlockBytes), written_ - at));
    size_t done = 0;
    while (done < wanted) {
      const ssize_t count =
          ::pread(file_, block + done, wanted - done, at + static_cast<int64_t>(done));
      if (count < 0 && errno == EINTR) continue;
      if (count == 0) errno = EIO;  // it was ours alone, and longer
      if (count <= 0) fail("read");
      done += static_cast<size_t>(count);
    }
    BlockHead head;
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
