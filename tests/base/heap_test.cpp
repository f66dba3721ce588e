#include "base/heap.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <string>
#include <thread>

#include "tests/support/sanitizers.h"

namespace panwright::heap_test {
namespace {

#if defined(__GLIBC__) && !defined(PANWRIGHT_SANITIZED)

// Whether an address is of the heap of the process, not of one that a thread has for itself.
bool in_heap(std::uintptr_t address) {
  std::ifstream maps("/proc/self/maps");
  for (std::string line; std::getline(maps, line);) {
    if (line.find("[heap]") == line.npos) continue;
    char* end = nullptr;
    const auto low = std::strtoull(line.c_str(), &end, 16);
    const auto high = std::strtoull(end + 1, nullptr, 16);
    if (low <= address && address < high) return true;
  }
  return false;
}

bool thread_uses_heap() {
  bool result = false;
  std::thread([&] {
    const auto bytes = std::make_unique<char[]>(5000);
    result = in_heap(reinterpret_cast<std::uintptr_t>(bytes.get()));
  }).join();
  return result;
}

// In a process of its own: heaps of threads that ended go to the next ones.
TEST(HeapDeathTest, ThreadsShareTheHeap) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(std::exit(thread_uses_heap() ? 3 : 4), testing::ExitedWithCode(4), "");
  const auto shared = [] {
    share_heap();
    return thread_uses_heap() ? 3 : 4;
  };
  EXPECT_EXIT(std::exit(shared()), testing::ExitedWithCode(3), "");
}

#endif

}  // namespace
}  // namespace panwright::heap_test
