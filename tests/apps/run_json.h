// run_json() returns the JSON of a run; a failing run fails the test.
#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/apps/cli.h"

namespace throng {

/// Runs `throng run` with the options; returns its JSON, null if the run failed.
inline nlohmann::json run_json(const std::string& options, const ScratchFolder& folder) {
  const Outcome outcome = shell("throng run " + options + " --lcm off --json run.json", folder);
  EXPECT_EQ(outcome.exit_code, 0) << options << ": " << outcome.err;
  return outcome.exit_code == 0 ? nlohmann::json::parse(read_file(folder / "run.json"))
                                : nlohmann::json();
}

}  // namespace throng
