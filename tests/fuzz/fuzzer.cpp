// Entry point of libFuzzer: one program for all targets, linked once; THRONG_FUZZ_TARGET names the
// target.
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "tests/fuzz/targets.h"

namespace {

const throng::fuzz::Target* target = nullptr;

const throng::fuzz::Target* asked_for() {
  const char* const asked = std::getenv("THRONG_FUZZ_TARGET");
  const std::string_view name = asked == nullptr ? "" : asked;
  for (const throng::fuzz::Target& known : throng::fuzz::kTargets)
    if (known.name == name) return &known;
  std::fprintf(stderr, "THRONG_FUZZ_TARGET: expected one of");
  for (const throng::fuzz::Target& known : throng::fuzz::kTargets)
    std::fprintf(stderr, " %s", std::string(known.name).c_str());
  std::fprintf(stderr, ", found '%s'\n", std::string(name).c_str());
  std::exit(2);
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* /*argc*/, char*** /*argv*/) {
  target = asked_for();
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  target->run({data, size});
  return 0;
}
