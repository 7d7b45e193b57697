#include "avatars/mesh/assimp_files.h"

#include <algorithm>
#include <cstring>
#include <string_view>

#include "base/errors.h"

namespace throng {
namespace {

/// A file in memory.
class Stream : public Assimp::IOStream {
 public:
  explicit Stream(std::shared_ptr<const std::vector<uint8_t>> content)
      : content_(std::move(content)) {}

  /// As fread: whole elements only.
  size_t Read(void* out, size_t size, size_t count) override {
    if (size == 0 || count == 0) return 0;
    const size_t whole = std::min(count, (content_->size() - at_) / size);
    if (whole == 0) return 0;
    std::memcpy(out, content_->data() + at_, whole * size);
    at_ += whole * size;
    return whole;
  }
  size_t Write(const void*, size_t, size_t) override { return 0; }
  /// As fseek, but not beyond the end. An offset is a negative number where it goes back.
  aiReturn Seek(size_t offset, aiOrigin origin) override {
    const size_t from = origin == aiOrigin_SET   ? 0
                        : origin == aiOrigin_CUR ? at_
                                                 : content_->size();
    const size_t to = from + offset;
    if (to > content_->size()) return aiReturn_FAILURE;
    at_ = to;
    return aiReturn_SUCCESS;
  }
  size_t Tell() const override { return at_; }
  size_t FileSize() const override { return content_->size(); }
  void Flush() override {}

 private:
  std::shared_ptr<const std::vector<uint8_t>> content_;
  size_t at_ = 0;
};

}  // namespace

AssimpFiles::AssimpFiles(const RegularFile& mesh, uint64_t max_bytes)
    : mesh_(mesh), name_(mesh.path().string()), bytes_left_(max_bytes) {}

AssimpFiles::Content AssimpFiles::content_of(const std::string& file) {
  if (const auto found = read_.find(file); found != read_.end()) return found->second;
  std::vector<uint8_t> bytes;
  try {
    bytes = file == name_ ? mesh_.bytes() : RegularFile(file, "a file", bytes_left_).bytes();
  } catch (const InputError&) {
    return nullptr;
  }
  bytes_left_ -= std::min<uint64_t>(bytes_left_, bytes.size());
  return read_[file] = std::make_shared<const std::vector<uint8_t>>(std::move(bytes));
}

bool AssimpFiles::Exists(const char* file) const {
  std::error_code ignored;
  return file == name_ || std::filesystem::is_regular_file(file, ignored);
}

Assimp::IOStream* AssimpFiles::Open(const char* file, const char* mode) {
  if (std::string_view(mode).find_first_of("wa+") != std::string_view::npos) return nullptr;
  Content content = content_of(file);
  return content == nullptr ? nullptr : new Stream(std::move(content));
}

void AssimpFiles::Close(Assimp::IOStream* stream) { delete stream; }

bool AssimpFiles::ComparePaths(const char* one, const char* other) const {
  return std::strcmp(one, other) == 0;
}

}  // namespace throng
