// The files that assimp reads: the mesh, and those that it names (buffers of a glTF, materials of
// an .obj). One rule: only regular files, only for reading, and within one bound for all of them.
#pragma once

#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/files/regular_file.h"

namespace throng {

class AssimpFiles : public Assimp::IOSystem {
 public:
  /// `mesh` is known as name() whatever lies there now, and counts among the `max_bytes`.
  AssimpFiles(const RegularFile& mesh, uint64_t max_bytes);

  const std::string& name() const { return name_; }

  bool Exists(const char* file) const override;
  char getOsSeparator() const override { return '/'; }
  /// Null for what is not there, no regular file, too much, or to be written.
  Assimp::IOStream* Open(const char* file, const char* mode) override;
  void Close(Assimp::IOStream* stream) override;
  bool ComparePaths(const char* one, const char* other) const override;
  bool CreateDirectory(const std::string&) override { return false; }
  bool ChangeDirectory(const std::string&) override { return false; }
  bool DeleteFile(const std::string&) override { return false; }

 private:
  using Content = std::shared_ptr<const std::vector<uint8_t>>;

  Content content_of(const std::string& file);

  const RegularFile& mesh_;
  std::string name_;
  uint64_t bytes_left_;
  /// Importers open their file several times: to see whether it is theirs, and to read it.
  std::map<std::string, Content> read_;
};

}  // namespace throng
