// Results of long work: found by what they follow from, and made anew where an entry is no good.

#include "base/work_cache.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "base/file.h"

namespace panwright::work_cache_test {
namespace {

namespace fs = std::filesystem;

class WorkCaches : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "panwright-work-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder = name;
  }
  void TearDown() override { fs::remove_all(folder); }

  // The square of a number, and how often it was worked out.
  std::uint64_t square(const WorkCache* cache, std::uint64_t number, bool worth = true) {
    return *remember<std::uint64_t>(
        cache, Work::meshes,
        [&] {
          KeyHasher key;
          key.number(number);
          return key.key();
        },
        [&] {
          ++made;
          return std::optional(number * number);
        },
        [&](std::uint64_t result, ByteWriter& to) {
          to.number(result);
          to.text("square");
          return worth;
        },
        [](ByteReader& from) {
          const std::uint64_t result = from.number();
          if (from.text() != "square") from.fail();
          return result;
        });
  }
  std::vector<fs::path> entries() const {
    std::vector<fs::path> out;
    for (const auto& entry : fs::directory_iterator(folder)) out.push_back(entry.path());
    return out;
  }
  fs::path folder;
  int made = 0;
};

TEST_F(WorkCaches, WorkIsDoneOnce) {
  ASSERT_TRUE(program_identity()) << "the linker gives programs a build id";
  EXPECT_EQ(square(nullptr, 3), 9u);
  for (int run = 0; run < 3; ++run) {
    const WorkCache cache(folder);
    EXPECT_EQ(square(&cache, 3), 9u);
    EXPECT_EQ(square(&cache, 4), 16u);
    const WorkCounts counts = cache.counts();
    EXPECT_EQ(counts[Work::meshes].reused, run == 0 ? 0u : 2u);
    EXPECT_EQ(counts[Work::meshes].made, run == 0 ? 2u : 0u);
    EXPECT_EQ(counts.all().reused + counts.all().made, 2u);
  }
  EXPECT_EQ(made, 3);
  EXPECT_EQ(entries().size(), 2u);
}

TEST_F(WorkCaches, KindsOfWorkAreApart) {
  const WorkCache cache(folder);
  cache.keep(Work::levels, {1, 2}, as_bytes(std::string_view("levels")));
  EXPECT_TRUE(cache.find(Work::levels, {1, 2}));
  EXPECT_FALSE(cache.find(Work::simplified, {1, 2}));
  EXPECT_FALSE(cache.find(Work::levels, {2, 1}));
}

// Every byte of an entry, every length of it, and the entry of something else in its place.
TEST_F(WorkCaches, WhatIsDamagedIsMadeAnewAndReplaced) {
  const WorkCache cache(folder);
  square(&cache, 7);
  const fs::path entry = entries().at(0);
  std::ifstream in(entry, std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(in), {}};
  int expected = made;
  const auto expect_anew = [&](const std::string& bytes) {
    std::ofstream(entry, std::ios::binary) << bytes;
    EXPECT_EQ(square(&cache, 7), 49u);
    EXPECT_EQ(made, ++expected);
    EXPECT_EQ(square(&cache, 7), 49u) << "which is kept";
    EXPECT_EQ(made, expected);
  };
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::string damaged = whole;
    damaged[i] = static_cast<char>(damaged[i] ^ 4);
    expect_anew(damaged);
    expect_anew(whole.substr(0, i));
  }
  square(&cache, 8);
  ++expected;
  for (const fs::path& other : entries()) {
    if (other == entry) continue;
    std::ifstream foreign(other, std::ios::binary);
    expect_anew({std::istreambuf_iterator<char>(foreign), {}});
  }
}

TEST_F(WorkCaches, WhatReadersRefuseIsMadeAnew) {
  const WorkCache cache(folder);
  KeyHasher key;
  key.number(5);
  for (const std::string_view text : {"", "square", "a right checksum, and no number and text"}) {
    cache.keep(Work::meshes, key.key(), as_bytes(text));
    EXPECT_EQ(square(&cache, 5), 25u);
  }
  EXPECT_EQ(made, 3);
  EXPECT_EQ(square(&cache, 5), 25u);
  EXPECT_EQ(made, 3);
}

TEST_F(WorkCaches, WhatIsNotWorthItIsNotKept) {
  const WorkCache cache(folder);
  square(&cache, 5, false);
  EXPECT_TRUE(entries().empty());
  EXPECT_EQ(cache.counts()[Work::meshes].made, 1u);
}

TEST_F(WorkCaches, OneRunKeepsHalfOfTheRoom) {
  const WorkCache cache(folder, 100'000);
  const std::string much(10'000, 'x');
  for (std::uint64_t i = 0; i < 20; ++i)
    cache.keep(Work::meshes, {i, i}, as_bytes(std::string_view(much)));
  EXPECT_EQ(entries().size(), 5u);
  EXPECT_TRUE(cache.find(Work::meshes, {0, 0})) << "what came first is not driven out";
}

TEST_F(WorkCaches, TheFolderStaysWithinItsBoundWhateverTheNumberOfEntries) {
  constexpr std::uint64_t kMost = 50 * 4096;
  for (std::uint64_t run = 0; run < 10; ++run) {
    const FileCache files(folder, kMost);
    for (std::uint64_t i = 0; i < 70; ++i) {
      files.keep({run, i}, as_bytes(std::string_view("entry")));
      EXPECT_LE(entries().size(), 50u);
    }
  }
}

TEST_F(WorkCaches, ThreadsAndCachesShareAFolder) {
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([this] {
      const WorkCache cache(folder);
      for (std::uint64_t i = 0; i < 50; ++i) {
        const auto result = remember<std::uint64_t>(
            &cache, Work::simplified,
            [&] {
              return Hash128{i, 1};
            },
            [&] { return std::optional(i + 1); },
            [](std::uint64_t r, ByteWriter& to) { to.number(r); },
            [](ByteReader& from) { return from.number(); });
        EXPECT_EQ(result, i + 1);
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(entries().size(), 50u);
}

TEST(Bytes, ListsHaveALimit) {
  ByteWriter to;
  to.number(1ull << 61);  // more doubles than there are bytes
  ByteReader from(to.bytes());
  std::vector<double> values;
  from.list(values);
  EXPECT_TRUE(values.empty());
  EXPECT_FALSE(from.good());
}

TEST(Bytes, KeysTellListsApart) {
  const auto key = [](const std::vector<double>& a, const std::vector<double>& b) {
    KeyHasher hasher;
    hasher.list(a);
    hasher.list(b);
    return hasher.key();
  };
  EXPECT_EQ(key({1, 2}, {3}), key({1, 2}, {3}));
  EXPECT_NE(key({1, 2}, {3}), key({1}, {2, 3}));
  EXPECT_NE(key({0}, {}), key({}, {0}));
  EXPECT_NE(key({0.0}, {}), key({-0.0}, {})) << "bits, not numbers";
}

}  // namespace
}  // namespace panwright::work_cache_test
