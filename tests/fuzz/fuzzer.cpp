// libFuzzer's entry: one program a target.
#include <cstddef>

#include "tests/fuzz/targets.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  throng::fuzz::THRONG_FUZZ_TARGET({data, size});
  return 0;
}
