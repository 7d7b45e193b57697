// SceneFile writes scene files for tests and loads them.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "base/errors.h"
#include "scenes/file/scene.h"

namespace throng {

/// Temporary folder per test, removed at its end.
class SceneFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              fmt::format("throng_scene_{}_{}", ::getpid(),
                          testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }
  Scene load(const std::string& text) const { return load_scene(write("s.yaml", text).string()); }

  /// Error of loading a text, without the folder.
  std::string complaint(const std::string& text) const {
    const std::string file = write("s.yaml", text).string();
    try {
      load_scene(file);
    } catch (const InputError& error) {
      std::string message = error.what();
      const size_t at = message.find(folder_.string() + "/");
      if (at != std::string::npos) message.erase(at, folder_.string().size() + 1);
      return message;
    }
    return "no complaint";
  }

  std::filesystem::path folder_;
};

inline const std::string kGround = "ground: {min_m: [0, 0], max_m: [20, 10]}\n";

}  // namespace throng
