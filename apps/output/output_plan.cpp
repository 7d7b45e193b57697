#include "apps/output/output_plan.h"

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <exception>
#include <utility>

#include "base/errors.h"
#include "base/files/atomic_file.h"
#include "scenes/file/scene.h"

namespace throng {
namespace {

namespace fs = std::filesystem;

void plan_model(const Model* model, OutputPlan& plan) {
  if (model == nullptr) return;
  for (const Link& link : model->robot.links)
    for (const std::vector<Geometry>* shapes : {&link.collision, &link.visual})
      for (const Geometry& shape : *shapes) plan.reads("a mesh of the scene", shape.mesh_file);
}

/// Output to these is not stored in a file.
bool is_special(mode_t mode) { return !S_ISREG(mode) && !S_ISDIR(mode); }

/// Two writers may share a character device: no bytes are overwritten.
bool is_character_device(const FileIdentity& place) {
  return place.missing_path.empty() && S_ISCHR(place.mode);
}

bool exists(const FileIdentity& place) { return place.missing_path.empty(); }

std::string named(const std::string& option, const fs::path& path) {
  return option + " " + path.string();
}

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

/// "2026-11-21 14:03, 33.1 MB"
std::string age_and_size(const struct stat& file) {
  const double bytes = static_cast<double>(file.st_size);
  return fmt::format("{:%Y-%m-%d %H:%M}, {}", fmt::localtime(file.st_mtime),
                     bytes < 1e5 ? fmt::format("{:.1f} kB", bytes * 1e-3)
                                 : fmt::format("{:.1f} MB", bytes * 1e-6));
}

EnvironmentError cannot_create(const std::string& option, const fs::path& path,
                               const std::string& why) {
  return EnvironmentError(fmt::format("{}: cannot create it: {}", named(option, path), why));
}

/// Locks the file or reports who holds it. File systems without locks are accepted.
void lock(int descriptor, const std::string& option, const fs::path& path) {
  if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
  throw EnvironmentError(
      fmt::format("{}: another run of throng is writing it; choose another name with {}",
                  path.string(), option));
}

bool matches(const std::string& name, const std::string& pattern) {
  return pattern.starts_with('*') ? name.ends_with(pattern.substr(1)) : name == pattern;
}

/// Whether the stream is open for output, other than on a character device.
bool is_open_for_output(int descriptor, struct stat& status) {
  return ::fstat(descriptor, &status) == 0 && !S_ISCHR(status.st_mode);
}

}  // namespace

FileIdentity identify(const fs::path& path) {
  fs::path existing = resolve_links(path);
  fs::path rest;
  struct stat status {};
  while (::stat(existing.empty() ? "." : existing.c_str(), &status) != 0) {
    rest = rest.empty() ? existing.filename() : existing.filename() / rest;
    // The parent of a name is its folder; of a relative one, the current folder.
    const fs::path above = existing.parent_path();
    if (above == existing) break;
    existing = above;
  }
  // "missing/.." is created on the way, so resolve dots before looking for existing paths.
  const fs::path normal = rest.lexically_normal();
  if (normal != rest) return identify(normal == "." ? existing : existing / normal);
  return {status.st_dev, status.st_ino, status.st_mode, normal};
}

void OutputPlan::reads(const std::string& what, const fs::path& path) {
  if (!path.empty()) inputs_.emplace_back(what, path);
}

void OutputPlan::writes(PlannedFile file) {
  if (!file.path.empty()) files_.push_back(std::move(file));
}

void OutputPlan::writes_json(const std::string& path) {
  if (path == "-")
    json_to_stdout_ = true;
  else
    writes({.option = "--json", .path = path});
}

void OutputPlan::fills(const std::string& option, const fs::path& folder,
                       std::vector<std::string> names) {
  // "out/" and "out" are one folder with different file names.
  if (!folder.empty())
    folders_.push_back(
        {option, folder.has_filename() ? folder : folder.parent_path(), std::move(names)});
}

std::vector<OutputPlan::Name> OutputPlan::inputs() const {
  std::vector<Name> all;
  for (const auto& [what, path] : inputs_)
    all.push_back({fmt::format("{}, {}", path.string(), what), path, identify(path)});
  struct stat status {};
  for (const int stream : {STDOUT_FILENO, STDERR_FILENO}) {
    const bool is_json = stream == STDOUT_FILENO && json_to_stdout_;
    if (!is_open_for_output(stream, status) && !(is_json && ::fstat(stream, &status) == 0))
      continue;
    const char* what = is_json                   ? "the standard output, used by --json"
                       : stream == STDOUT_FILENO ? "the file of the standard output"
                                                 : "the file of the standard error";
    all.push_back({what, {}, {status.st_dev, status.st_ino, status.st_mode, {}}});
  }
  return all;
}

std::vector<OutputPlan::Name> OutputPlan::names_of(const PlannedFile& file) const {
  std::vector<Name> all = {{"the file of " + file.option, file.path, identify(file.path)}};
  for (const fs::path& path : file.side_files)
    all.push_back(
        {fmt::format("{}, which {} needs, too", path.string(), file.option), path, identify(path)});
  if (!file.keep_as.empty())
    all.push_back(
        {fmt::format("{}, where {} keeps the older one", file.keep_as.string(), file.option),
         file.keep_as, identify(file.keep_as)});
  return all;
}

bool OutputPlan::will_be_made(const FileIdentity& folder) const {
  return std::any_of(folders_.begin(), folders_.end(),
                     [&](const Folder& made) { return identify(made.path) == folder; });
}

void OutputPlan::check_file(const PlannedFile& file) const {
  const FileIdentity place = identify(file.path);
  const bool is_folder = exists(place) ? S_ISDIR(place.mode) : !file.path.has_filename();
  if (is_folder) throw InputError(named(file.option, file.path), "a file", "a folder of that name");
  if (exists(place)) {
    if (S_ISSOCK(place.mode) || S_ISBLK(place.mode))
      throw InputError(named(file.option, file.path), "a file, a pipe or a writable device",
                       S_ISSOCK(place.mode) ? "a socket" : "a disk");
    if (::access(file.path.c_str(), W_OK) != 0)
      throw EnvironmentError(fmt::format("{}: cannot write it: {}", named(file.option, file.path),
                                         std::strerror(errno)));
    return;
  }
  const fs::path folder = folder_of(resolve_links(file.path));
  if (S_ISDIR(place.mode) && place.missing_path.has_parent_path()) {
    if (will_be_made(identify(folder)) || file.makes_folder) return;
    throw cannot_create(
        file.option, file.path,
        fmt::format("the folder {} does not exist; create it, or name another", folder.string()));
  }
  if (!S_ISDIR(place.mode))
    throw cannot_create(file.option, file.path,
                        fmt::format("{} is no folder; name another place", folder.string()));
  if (::access(folder.c_str(), W_OK | X_OK) != 0)
    throw cannot_create(file.option, file.path, std::strerror(errno));
}

void OutputPlan::check_folder(const Folder& folder) const {
  const FileIdentity place = identify(folder.path);
  if (exists(place) && !S_ISDIR(place.mode))
    throw InputError(named(folder.option, folder.path), "a folder", "a file of that name");
  if (!S_ISDIR(place.mode))
    throw cannot_create(folder.option, folder.path, "a file is in place of its folder");
}

void OutputPlan::check_distinct() const {
  const std::vector<Name> inputs = this->inputs();
  const auto reject = [](const Name& file, const std::string& option, const Name& other) {
    throw InputError(named(option, file.path), "a separate file", other.label);
  };
  const auto same = [](const Name& a, const Name& b) {
    return a.place == b.place && !is_character_device(a.place);
  };
  std::vector<Name> before;  // outputs of earlier options
  for (const PlannedFile& file : files_) {
    const std::vector<Name> names = names_of(file);
    for (const Name& name : names) {
      for (const Name& input : inputs)
        if (same(name, input)) reject(name, file.option, input);
      for (const Name& other : before)
        if (same(name, other)) reject(name, file.option, other);
    }
    before.insert(before.end(), names.begin(), names.end());
  }
  std::vector<std::pair<std::string, Name>> all;  // option and output
  for (const PlannedFile& file : files_)
    for (const Name& name : names_of(file)) all.emplace_back(file.option, name);
  for (const Name& input : inputs) all.emplace_back("", input);
  for (size_t i = 0; i < folders_.size(); ++i) {
    const Folder& folder = folders_[i];
    const FileIdentity place = identify(folder.path);
    for (size_t j = 0; j < i; ++j)
      if (identify(folders_[j].path) == place)
        throw InputError(named(folder.option, folder.path), "a separate folder",
                         "the folder of " + folders_[j].option);
    for (const auto& [option, name] : all) {
      if (name.place == place)
        throw InputError(named(folder.option, folder.path), "a separate folder", name.label);
      const bool lies_within =
          !name.path.empty() && identify(folder_of(resolve_links(name.path))) == place;
      for (const std::string& pattern : folder.names) {
        const bool is_taken =
            (lies_within && matches(resolve_links(name.path).filename().string(), pattern)) ||
            (!pattern.starts_with('*') && identify(folder.path / pattern) == name.place &&
             !is_character_device(name.place));
        if (!is_taken) continue;
        const std::string whole = named(folder.option, folder.path);
        if (option.empty())
          throw InputError(whole, "a folder without inputs of the command",
                           fmt::format("{} would overwrite {}", pattern, name.label));
        throw InputError(named(option, name.path), "a separate file",
                         fmt::format("one that {} writes", whole));
      }
    }
  }
}

void OutputPlan::check() const {
  check_distinct();
  for (const Folder& folder : folders_) check_folder(folder);
  for (const PlannedFile& file : files_) check_file(file);
}

OpenOutputs OutputPlan::open() const {
  check();
  OpenOutputs outputs;
  try {
    for (const Folder& folder : folders_) {
      outputs.make_folder(folder.path, folder.option);
      outputs.lock_folder(folder.path, folder.option);
      for (const std::string& name : folder.names)
        if (!name.starts_with('*'))
          outputs.open({.option = folder.option, .path = folder.path / name});
    }
    for (const PlannedFile& file : files_) {
      if (file.makes_folder) outputs.make_folder(folder_of(file.path), file.option);
      outputs.open(file);
    }
    for (const PlannedFile& file : files_)
      if (!file.keep_as.empty()) outputs.files_to_keep_.push_back(file);
  } catch (...) {
    outputs.roll_back();
    throw;
  }
  return outputs;
}

OpenOutputs::OpenOutputs() : exceptions_(std::uncaught_exceptions()) {}

OpenOutputs::OpenOutputs(OpenOutputs&& other) noexcept
    : descriptors_(std::exchange(other.descriptors_, {})),
      created_(std::exchange(other.created_, {})),
      notes_(std::move(other.notes_)),
      files_to_keep_(std::move(other.files_to_keep_)),
      exceptions_(other.exceptions_) {}

OpenOutputs::~OpenOutputs() {
  if (std::uncaught_exceptions() > exceptions_) roll_back();
  for (const int descriptor : descriptors_) ::close(descriptor);
}

void OpenOutputs::roll_back() noexcept {
  // Reverse order of creation; non-empty folders stay.
  for (auto path = created_.rbegin(); path != created_.rend(); ++path) {
    struct stat status {};
    if (::stat(path->c_str(), &status) != 0) continue;
    if (S_ISDIR(status.st_mode))
      ::rmdir(path->c_str());
    else if (S_ISREG(status.st_mode) && status.st_size == 0)
      ::unlink(path->c_str());
  }
  created_.clear();
}

void OpenOutputs::make_folder(const fs::path& folder, const std::string& option) {
  std::error_code error;
  if (fs::is_directory(folder, error)) return;
  if (const fs::path above = folder.parent_path(); !above.empty() && above != folder)
    make_folder(above, option);
  if (::mkdir(folder.c_str(), 0777) == 0)
    created_.push_back(folder);
  else if (errno != EEXIST || !fs::is_directory(folder, error))
    throw EnvironmentError(fmt::format("{}: cannot create the folder: {}; name another with {}",
                                       folder.string(), std::strerror(errno), option));
}

void OpenOutputs::lock_folder(const fs::path& folder, const std::string& option) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;  // a folder may be writable but not readable
  descriptors_.push_back(descriptor);
  lock(descriptor, option, folder);
}

/// Opens and locks the file; returns its descriptor, the last of descriptors_. Repeats if another
/// run removed the file between opening and locking.
int OpenOutputs::open_locked(const PlannedFile& file) {
  for (;;) {
    const int descriptor = ::open(file.path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
    if (descriptor < 0)
      throw EnvironmentError(fmt::format("{}: cannot write it: {}", named(file.option, file.path),
                                         std::strerror(errno)));
    descriptors_.push_back(descriptor);
    lock(descriptor, file.option, file.path);
    struct stat opened {
    }, there{};
    if (::fstat(descriptor, &opened) == 0 && ::stat(file.path.c_str(), &there) == 0 &&
        opened.st_dev == there.st_dev && opened.st_ino == there.st_ino)
      return descriptor;
    ::close(descriptor);
    descriptors_.pop_back();
  }
}

void OpenOutputs::open(const PlannedFile& file) {
  struct stat status {};
  const bool is_there = ::stat(file.path.c_str(), &status) == 0;
  // Opening a pipe would wait for its reader, and closing it would end the reader.
  if (is_there && is_special(status.st_mode)) return;
  const int descriptor = open_locked(file);
  // Only a locked file may be removed again: before, another run may have created it.
  if (!is_there) created_.push_back(resolve_links(file.path));
  if (is_there && status.st_size > 0 && file.is_recording && file.keep_as.empty())
    notes_.push_back(
        fmt::format("{} of {}, is replaced{}", file.path.string(), age_and_size(status),
                    file.mode == WriteMode::kAtomic ? " when the new one is whole" : ""));
  if (file.mode != WriteMode::kAtomic) return;
  // An atomic output must not exist before it is complete.
  if (!is_there && ::unlink(created_.back().c_str()) == 0) created_.pop_back();
  ::close(descriptor);
  descriptors_.pop_back();
}

void OpenOutputs::keep_previous() {
  for (const PlannedFile& file : files_to_keep_) keep_previous(file);
  files_to_keep_.clear();
}

void OpenOutputs::keep_previous(const PlannedFile& file) {
  struct stat status {
  }, kept{};
  if (::stat(file.path.c_str(), &status) != 0 || !S_ISREG(status.st_mode) || status.st_size == 0)
    return;
  const bool replaces = ::stat(file.keep_as.c_str(), &kept) == 0;
  if (replaces) {
    // Another run may be writing to that name.
    const int descriptor = ::open(file.keep_as.c_str(), O_WRONLY | O_CLOEXEC);
    if (descriptor >= 0) descriptors_.push_back(descriptor);
    if (descriptor >= 0) lock(descriptor, file.option, file.keep_as);
  }
  if (::rename(resolve_links(file.path).c_str(), file.keep_as.c_str()) != 0)
    throw EnvironmentError(
        fmt::format("{}: cannot keep the older one as {}: {}; name another place with {}",
                    file.path.string(), file.keep_as.string(), std::strerror(errno), file.option));
  open_locked(file);
  created_.push_back(resolve_links(file.path));
  notes_.push_back(fmt::format(
      "{} of {}, is kept as {}{}", file.path.string(), age_and_size(status), file.keep_as.string(),
      replaces ? fmt::format(", in place of the one of {}", age_and_size(kept)) : ""));
}

void plan_inputs(const Scene& scene, OutputPlan& plan) {
  plan.reads("the scene", scene.file);
  if (scene.recorded) plan.reads("the recording of the scene", scene.recorded->options.file);
  for (const Group& group : scene.groups) {
    plan.reads("a model of the scene", group.model);
    plan_model(group.body.get(), plan);
  }
  for (const Obstacle& obstacle : scene.obstacles)
    plan.reads("an obstacle of the scene", obstacle.mesh_file);
  if (!scene.box) return;
  plan.reads("the model of the scene", scene.box->model);
  plan_model(scene.box->body.get(), plan);
}

}  // namespace throng
