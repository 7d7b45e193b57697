// OutputPlan collects the outputs of a command and checks them before any is opened.
// Invariant: no existing file changes before every output is known to be writable. No two outputs
// are one file, and no output is an input.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace throng {

struct Scene;

/// Identity of an output: an existing file or folder, and the missing path below it. Two paths are
/// one file if and only if their identities are equal, regardless of links and dots.
struct FileIdentity {
  dev_t device = 0;
  ino_t inode = 0;
  mode_t mode = 0;                     ///< mode of the existing file or folder
  std::filesystem::path missing_path;  ///< empty if the file itself exists

  bool operator==(const FileIdentity& other) const {
    return device == other.device && inode == other.inode && missing_path == other.missing_path;
  }
};
FileIdentity identify(const std::filesystem::path& path);

/// When an output replaces an older file.
enum class WriteMode {
  kStreamed,  ///< emptied when the work begins, locked until it ends
  kAppended,  ///< appended to and locked
  kAtomic,    ///< replaced by a complete file at the end
};

struct PlannedFile {
  std::string option;  ///< "--log"
  std::filesystem::path path{};
  WriteMode mode = WriteMode::kAtomic;
  bool is_recording = false;        ///< whether replacing an older one is noted
  bool makes_folder = false;        ///< for default names only: creates the folder
  std::filesystem::path keep_as{};  ///< new name of an older file, or empty: it is lost
  std::vector<std::filesystem::path> side_files{};  ///< side files of the writer
};

/// Holds the locks of the outputs until destroyed. If an exception destroys it, it removes the
/// empty files and folders that it created.
class OpenOutputs {
 public:
  OpenOutputs();
  ~OpenOutputs();
  OpenOutputs(OpenOutputs&& other) noexcept;
  OpenOutputs(const OpenOutputs&) = delete;
  OpenOutputs& operator=(const OpenOutputs&) = delete;

  /// Renames files to keep; call it when all writers have opened their files. Throws
  /// EnvironmentError.
  void keep_previous();
  /// Files that were replaced or kept, one line each.
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  friend class OutputPlan;
  void make_folder(const std::filesystem::path& folder, const std::string& option);
  void lock_folder(const std::filesystem::path& folder, const std::string& option);
  void open(const PlannedFile& file);
  void keep_previous(const PlannedFile& file);
  int open_locked(const PlannedFile& file);
  void roll_back() noexcept;

  std::vector<int> descriptors_;
  std::vector<std::filesystem::path> created_;
  std::vector<std::string> notes_;
  std::vector<PlannedFile> files_to_keep_;
  int exceptions_;
};

class OutputPlan {
 public:
  /// `what` follows the path and a comma: "the scene". Ignores an empty path.
  void reads(const std::string& what, const std::filesystem::path& path);
  /// Ignores an empty path.
  void writes(PlannedFile file);
  /// Adds a JSON result; "-" is stdout, which then holds nothing else.
  void writes_json(const std::string& path);
  /// Adds a folder, created if missing, and the names written in it; "*.svg" is every such name.
  void fills(const std::string& option, const std::filesystem::path& folder,
             std::vector<std::string> names);

  /// Changes nothing. Throws InputError for two outputs that are one file or a folder in place of a
  /// file, EnvironmentError for a missing or read-only folder.
  void check() const;
  /// Checks again, opens every output without emptying any, and locks streamed ones. Throws as
  /// check(); then nothing has changed.
  OpenOutputs open() const;

 private:
  struct Name {
    std::string label;  ///< "the file of --log"
    std::filesystem::path path;
    FileIdentity place;
  };
  struct Folder {
    std::string option;
    std::filesystem::path path;
    std::vector<std::string> names;
  };

  std::vector<Name> inputs() const;
  std::vector<Name> names_of(const PlannedFile& file) const;
  void check_file(const PlannedFile& file) const;
  void check_folder(const Folder& folder) const;
  void check_distinct() const;
  bool will_be_made(const FileIdentity& folder) const;

  std::vector<std::pair<std::string, std::filesystem::path>> inputs_;
  std::vector<PlannedFile> files_;
  std::vector<Folder> folders_;
  bool json_to_stdout_ = false;
};

/// Adds the files that a scene was read from.
void plan_inputs(const Scene& scene, OutputPlan& plan);

}  // namespace throng
