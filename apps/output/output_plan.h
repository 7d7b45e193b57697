// What a command is going to write, known before anything is opened.
// One rule: nothing that exists is changed before it is certain that every output can be written,
// that no two of them are one file, and that none is something the command reads.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace throng {

struct Scene;

/// A file on its way: an existing folder or file, and what is not there yet below it. Two paths are
/// one file if and only if their places are equal, whatever links, dots and names lead there.
struct FileIdentity {
  dev_t device = 0;
  ino_t inode = 0;
  mode_t mode = 0;                     ///< of what exists
  std::filesystem::path missing_path;  ///< empty: the file itself exists

  bool operator==(const FileIdentity& other) const {
    return device == other.device && inode == other.inode && missing_path == other.missing_path;
  }
};
FileIdentity identify(const std::filesystem::path& path);

/// When an output comes to be. What stood there before is lost only then.
enum class WriteMode {
  kStreamed,  ///< emptied when the work begins, locked until it ends
  kAppended,  ///< locked, too
  kAtomic,    ///< replaced by a whole one
};

struct PlannedFile {
  std::string option;  ///< "--log"
  std::filesystem::path path{};
  WriteMode mode = WriteMode::kAtomic;
  bool is_recording = false;        ///< worth a line when an older one is replaced
  bool makes_folder = false;        ///< nobody chose it
  std::filesystem::path keep_as{};  ///< where an older one goes instead of being lost, or empty
  std::vector<std::filesystem::path> beside{};  ///< what the writer needs besides
};

/// The outputs as long as they are written: until destroyed no other run can have them. Destroyed
/// by an exception it takes back the empty files and folders that were created for nothing.
class OpenOutputs {
 public:
  OpenOutputs();
  ~OpenOutputs();
  OpenOutputs(OpenOutputs&& other) noexcept;
  OpenOutputs(const OpenOutputs&) = delete;
  OpenOutputs& operator=(const OpenOutputs&) = delete;

  /// Moves away what is kept; for the moment when all writers have opened theirs. Throws
  /// EnvironmentError.
  void keep_previous();
  /// What was replaced or kept, a line each, for the user.
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
  /// `what` follows the path and a comma: "the scene". An empty path is none.
  void reads(const std::string& what, const std::filesystem::path& path);
  /// An empty path is none.
  void writes(PlannedFile file);
  /// A result for machines; "-" is the standard output, which then holds nothing else.
  void writes_json(const std::string& path);
  /// A folder, made where it is missing, and the names written in it; "*.svg" is every such name.
  void fills(const std::string& option, const std::filesystem::path& folder,
             std::vector<std::string> names);

  /// Touches nothing. Throws InputError where two are one file or a folder stands for a file,
  /// EnvironmentError where a folder is missing or refuses.
  void check() const;
  /// Checks again, then opens every output without emptying any, and locks those that are written
  /// as it runs. Throws as check(); then nothing has changed.
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

/// The files that a scene was read from.
void plan_inputs(const Scene& scene, OutputPlan& plan);

}  // namespace throng
