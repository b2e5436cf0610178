#include "support/allocation_guard.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cstdlib>
#include <memory>
#include <thread>
#include <vector>

namespace tactum {
namespace {

// The compiler may remove a pair of new and delete whose object is not used.
void look_at(void* p) { asm volatile("" : : "g"(p) : "memory"); }

TEST(AllocationGuard, CountsNewMallocAndEigen) {
  const AllocationGuard guard;
  auto number = std::make_unique<int>(1);
  look_at(number.get());
  const std::size_t after_new = guard.allocations();
  void* block = std::malloc(10);
  look_at(block);
  const std::size_t after_malloc = guard.allocations();
  Eigen::MatrixXd matrix(20, 20);
  look_at(matrix.data());
  const std::size_t after_eigen = guard.allocations();
  std::free(block);
  number.reset();
  const std::size_t frees = guard.frees();
  EXPECT_EQ(after_new, 1u);
  EXPECT_EQ(after_malloc, 2u);
  EXPECT_EQ(after_eigen, 3u);
  EXPECT_EQ(frees, 2u);
}

TEST(AllocationGuard, CountsGrowthAndAlignedBlocks) {
  struct alignas(64) Line {
    char bytes[64];
  };
  std::vector<Line> lines(1);
  const AllocationGuard guard;
  lines.resize(lines.capacity() + 1);
  look_at(lines.data());
  const std::size_t counted = guard.allocations();
  EXPECT_EQ(counted, 1u);
}

TEST(AllocationGuard, CountsNothingElse) {
  const AllocationGuard outer;
  double sum = 0.0;
  for (int i = 0; i < 1000; ++i) sum += i;
  look_at(&sum);
  EXPECT_EQ(outer.allocations(), 0u);
  EXPECT_EQ(outer.frees(), 0u);
}

TEST(AllocationGuard, OtherThreadsDoNotCount) {
  std::size_t counted = 1;
  std::thread worker([&counted] {
    const AllocationGuard guard;
    std::thread busy([] { look_at(std::vector<int>(1000).data()); });
    const std::size_t starting = guard.allocations();
    busy.join();
    counted = guard.allocations() - starting;
  });
  worker.join();
  EXPECT_EQ(counted, 0u);
}

}  // namespace
}  // namespace tactum
