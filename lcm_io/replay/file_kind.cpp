#include "lcm_io/replay/file_kind.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <string_view>

#include "base/errors.h"
#include "kinematics/robot.h"
#include "recordings/recording.h"

namespace throng {
namespace {

namespace fs = std::filesystem;

constexpr size_t kHeadBytes = 4096;

struct Signature {
  std::string_view begins;
  const char* what;
  const char* readers;
};

constexpr const char* kLogReaders =
    "`throng run`, `throng view`, `throng check`, `throng info`, `throng monitor` and "
    "`throng render` read it";
constexpr std::string_view kLogBegins = "\xED\xA1\xDA\x01";

constexpr std::array<Signature, 13> kSignatures = {{
    {kLogBegins, "a log of a run", kLogReaders},
    {"THRONGCP", "a checkpoint", "`throng run SCENE --resume FILE` continues from it"},
    {"\x89PNG\r\n", "a picture", ""},
    {"RIFF", "a picture or a sound", ""},
    {"\x1f\x8b", "a gzip archive", "unpack it first"},
    {"PK\x03\x04", "a zip archive", "unpack it first"},
    {"\x7f"
     "ELF",
     "a program", ""},
    {"ply\n", "a mesh", "a URDF names it as the geometry of a link"},
    {"ply\r\n", "a mesh", "a URDF names it as the geometry of a link"},
    {"solid ", "a mesh", "a URDF names it as the geometry of a link"},
    {"glTF", "a mesh", "a URDF names it as the geometry of a link"},
    {"<!doctype html", "a page", "a browser shows it"},
    {"<!DOCTYPE html", "a page", "a browser shows it"},
}};

std::string lower_extension(const fs::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

std::string head_of(const fs::path& file) {
  std::string head(kHeadBytes, '\0');
  std::ifstream in(file, std::ios::binary);
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<size_t>(in.gcount()));
  return head;
}

/// Skips a byte order mark and blanks.
std::string_view text_of(std::string_view head) {
  if (head.starts_with("\xEF\xBB\xBF")) head.remove_prefix(3);
  head.remove_prefix(std::min(head.find_first_not_of(" \t\r\n"), head.size()));
  return head;
}

}  // namespace

std::optional<FileKind> known_kind(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return std::nullopt;
  if (is_urdf(file))
    return FileKind{"a URDF",
                    "`throng info` reads it, and a scene names it as the model of a group", false};
  const std::string head = head_of(file);
  if (is_recording(file)) return FileKind{"a recording", "`throng info` describes it", true};
  for (const Signature& signature : kSignatures)
    if (head.starts_with(signature.begins))
      return FileKind{signature.what, signature.readers, false};
  const std::string_view text = text_of(head);
  if (lower_extension(file) == ".tri" || text.starts_with("TRI"))
    return FileKind{"a .tri mesh", "`throng info` reads it", false};
  if (text.starts_with("<")) return FileKind{"XML", "", false};
  if (text.starts_with("{") && text.find("\"throng\"") != std::string_view::npos)
    return FileKind{"results written by --json", "", false};
  return std::nullopt;
}

bool is_log(const fs::path& file) {
  std::error_code error;
  return fs::is_regular_file(file, error) && head_of(file).starts_with(kLogBegins);
}

void require_no_other_kind(const std::string& name) {
  const std::optional<FileKind> kind = known_kind(name);
  if (!kind) return;
  throw InputError(
      name, "a scene",
      kind->readers.empty() ? kind->what : fmt::format("{}; {}", kind->what, kind->readers));
}

}  // namespace throng
