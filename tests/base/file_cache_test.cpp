#include "base/file_cache.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <string>
#include <thread>

#include "base/file.h"

namespace panwright::file_cache_test {
namespace {

namespace fs = std::filesystem;

class Cache : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "panwright-cache-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    top = name;
    folder = top / "a" / "b";
  }
  void TearDown() override { fs::remove_all(top); }
  std::string found(const FileCache& cache, const Hash128& key) {
    const auto entry = cache.find(key);
    if (!entry) return "none";
    return {reinterpret_cast<const char*>(entry->data()), entry->size()};
  }
  std::string contents(const fs::path& path) {
    DiagnosticLog log;
    return *read_file(path, 1 << 20, log);
  }
  void write(const fs::path& path, const std::string& text) {
    DiagnosticLog log;
    ASSERT_TRUE(write_file(path, as_bytes(text), log));
  }
  fs::path top, folder;
  const Hash128 one{1, 2};
};

TEST_F(Cache, GivesBackWhatItKept) {
  const FileCache cache(folder);
  EXPECT_EQ(found(cache, one), "none");
  EXPECT_FALSE(fs::exists(folder)) << "nothing is made before there is something to keep";
  cache.keep(one, as_bytes("kept"));
  cache.keep({2, 1}, as_bytes(""));
  EXPECT_EQ(found(cache, one), "kept");
  EXPECT_EQ(found(cache, {2, 1}), "");
  EXPECT_EQ(found(cache, {1, 1}), "none");
  EXPECT_EQ(found(FileCache(folder), one), "kept") << "another process";
  cache.keep(one, as_bytes("anew"));
  EXPECT_EQ(found(cache, one), "anew");
  struct stat status {};
  ASSERT_EQ(stat(folder.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0700u);
}

TEST_F(Cache, WhatIsNotWholeIsNotThere) {
  const FileCache cache(folder);
  cache.keep(one, as_bytes("an entry"));
  const fs::path file = folder / one.hex();
  const std::string whole = contents(file);
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::string damaged = whole;
    damaged[i] = static_cast<char>(damaged[i] ^ 4);
    write(file, damaged);
    EXPECT_EQ(found(cache, one), "none") << "byte " << i;
    write(file, whole.substr(0, i));
    EXPECT_EQ(found(cache, one), "none") << i << " bytes";
  }
  write(file, whole + "x");
  EXPECT_EQ(found(cache, one), "none");
  // under the name of another key
  fs::rename(file, folder / Hash128{5, 5}.hex());
  EXPECT_EQ(found(cache, {5, 5}), "none");
  write(file, whole);
  EXPECT_EQ(found(cache, one), "an entry");
  fs::remove(file);
  fs::create_directory(file);
  EXPECT_EQ(found(cache, one), "none");
  cache.keep(one, as_bytes("an entry"));
  fs::remove(file);
  ASSERT_EQ(mkfifo(file.c_str(), 0600), 0);
  EXPECT_EQ(found(cache, one), "none") << "and it does not wait";
}

TEST_F(Cache, AFolderThatCannotBeWrittenIsNoError) {
  write(top / "a", "a file");
  const FileCache cache(folder);
  cache.keep(one, as_bytes("kept"));
  EXPECT_EQ(found(cache, one), "none");
  FileCache("/proc/none").keep(one, as_bytes("kept"));
}

TEST_F(Cache, WhatWasUsedLongestAgoGoes) {
  const FileCache cache(folder, 10 * 4096);
  write(top / "other", "");
  const auto key = [](std::uint64_t i) { return Hash128{i, 0}; };
  for (std::uint64_t i = 0; i < 10; ++i) {
    cache.keep(key(i), as_bytes("entry"));
    fs::last_write_time(folder / key(i).hex(),
                        fs::file_time_type::clock::now() - std::chrono::hours(20 - i));
  }
  write(folder / "of somebody else", std::string(100'000, 'x'));
  EXPECT_EQ(found(cache, key(0)), "entry") << "used now";
  cache.keep(key(10), as_bytes("entry"));
  // eleven blocks were too much: three quarters of ten stay
  for (std::uint64_t i = 1; i <= 4; ++i) EXPECT_EQ(found(cache, key(i)), "none") << i;
  for (const std::uint64_t i : {0, 5, 6, 7, 8, 9, 10})
    EXPECT_EQ(found(cache, key(i)), "entry") << i;
  EXPECT_TRUE(fs::exists(folder / "of somebody else"));
  cache.keep(key(11), as_bytes(std::string(5 * 4096, 'x')));
  EXPECT_EQ(found(cache, key(11)), "none") << "too large to keep";
}

TEST_F(Cache, WritersAndReadersMeetWholeEntries) {
  const auto text = [](int i) { return std::string(20'000, static_cast<char>('a' + i)); };
  std::vector<std::thread> writers;
  for (int i = 0; i < 4; ++i)
    writers.emplace_back([&, i] {
      const FileCache cache(folder);
      for (int k = 0; k < 50; ++k) cache.keep(one, as_bytes(text(i)));
    });
  const FileCache cache(folder);
  int seen = 0;
  for (int k = 0; k < 200; ++k)
    if (const std::string entry = found(cache, one); entry != "none") {
      ++seen;
      EXPECT_EQ(entry, text(entry[0] - 'a'));
    }
  for (std::thread& writer : writers) writer.join();
  EXPECT_NE(found(cache, one), "none");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 1);
}

}  // namespace
}  // namespace panwright::file_cache_test
