// Workers run every block exactly once, on a valid worker.
#include "base/workers.h"

#include <gtest/gtest.h>

#include <atomic>
#include <vector>

namespace throng::workers_test {
namespace {

class WorkersTest : public testing::TestWithParam<int> {};

TEST_P(WorkersTest, RunsEveryBlockOnceOnAValidWorker) {
  Workers workers(GetParam());
  EXPECT_EQ(workers.threads(), GetParam());
  for (const int blocks : {0, 1, 2, 7, 1000}) {
    std::vector<std::atomic<int>> runs(static_cast<size_t>(blocks));
    std::atomic<int> strangers = 0;
    workers.for_blocks(blocks, [&](int block, int worker) {
      runs[static_cast<size_t>(block)].fetch_add(1);
      if (worker < 0 || worker >= GetParam()) strangers.fetch_add(1);
    });
    EXPECT_EQ(strangers, 0) << blocks << " blocks";
    for (size_t i = 0; i < runs.size(); ++i) EXPECT_EQ(runs[i], 1) << "block " << i;
  }
}

TEST_P(WorkersTest, RunsOneBlockPerWorkerAtATime) {
  // Scratch memory per worker relies on this.
  Workers workers(GetParam());
  std::vector<std::atomic<int>> busy(static_cast<size_t>(GetParam()));
  std::atomic<int> clashes = 0;
  workers.for_blocks(2000, [&](int, int worker) {
    std::atomic<int>& mine = busy[static_cast<size_t>(worker)];
    if (mine.fetch_add(1) != 0) clashes.fetch_add(1);
    for (volatile int spin = 0; spin < 100;) spin = spin + 1;
    mine.fetch_sub(1);
  });
  EXPECT_EQ(clashes, 0);
}

TEST_P(WorkersTest, ShowsEarlierWritesToBlocks) {
  Workers workers(GetParam());
  std::vector<int> values(512, 1);
  for (int round = 0; round < 12; ++round)
    workers.for_blocks(512, [&](int block, int) { values[static_cast<size_t>(block)] *= 3; });
  int expected = 1;
  for (int round = 0; round < 12; ++round) expected *= 3;
  for (const int value : values) ASSERT_EQ(value, expected);
}

INSTANTIATE_TEST_SUITE_P(Threads, WorkersTest, testing::Values(1, 2, 3, 8));

}  // namespace
}  // namespace throng::workers_test
