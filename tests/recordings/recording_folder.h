// RecordingTest gives each test a temporary folder for its recordings.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "base/errors.h"
#include "recordings/recording.h"

namespace throng {

class RecordingTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::path(::testing::TempDir()) /
              fmt::format("recordings_{}_{}", test->name(), getpid());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path path(std::string_view name) const { return folder_ / name; }
  std::filesystem::path write(std::string_view name, std::string_view text) const {
    std::ofstream out(path(name), std::ios::binary);
    out.write(text.data(), static_cast<std::streamsize>(text.size()));
    return path(name);
  }
  std::shared_ptr<const Recording> read(std::string_view text,
                                        RecordingOptions options = {}) const {
    options.file = write("recording", text);
    return read_recording(options);
  }
  /// Error of reading a text, without the folder; "" for none.
  std::string rejection(std::string_view text, RecordingOptions options = {}) const {
    try {
      read(text, std::move(options));
      return "";
    } catch (const InputError& error) {
      const std::string message = error.what();
      const std::string before = folder_.string() + "/";
      return message.starts_with(before) ? message.substr(before.size()) : message;
    }
  }
  static std::vector<Sample> track(const Recording& recording, size_t person) {
    std::vector<Sample> out;
    recording.read(person, out);
    return out;
  }

 private:
  std::filesystem::path folder_;
};

}  // namespace throng
