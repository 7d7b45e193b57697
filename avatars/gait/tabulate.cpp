// throng_tabulate URDF FOLDER: writes the gaits of a model into a folder and removes other files.
#include <algorithm>
#include <exception>
#include <filesystem>
#include <vector>

#include "avatars/gait/gait_file.h"
#include "base/console.h"

namespace throng {
namespace {

namespace fs = std::filesystem;

void tabulate(const fs::path& urdf, const fs::path& folder) {
  const std::shared_ptr<const Model> model = load_model(urdf);
  fs::create_directories(folder);
  std::vector<fs::path> names;
  for (size_t style = 0; style < kGaitStyleCount; ++style)
    names.push_back(gait_file_name(*model, static_cast<GaitStyle>(style)));
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (std::find(names.begin(), names.end(), entry.path().filename()) == names.end())
      fs::remove(entry);
  for (size_t style = 0; style < kGaitStyleCount; ++style)
    if (!fs::exists(folder / names[style]))
      write_gait_file(*model, static_cast<GaitStyle>(style), folder);
}

}  // namespace
}  // namespace throng

int main(int count, char** arguments) {
  if (count != 3) {
    throng::print_message("usage: throng_tabulate URDF FOLDER\n");
    return 2;
  }
  try {
    throng::tabulate(arguments[1], arguments[2]);
  } catch (const std::exception& error) {
    throng::print_message("{}\n", error.what());
    return 3;
  }
  return 0;
}
