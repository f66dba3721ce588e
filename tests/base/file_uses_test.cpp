#include "base/file_uses.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "base/file.h"

namespace panwright::file_uses_test {
namespace {

namespace fs = std::filesystem;

class Uses : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "panwright-uses-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder = name;
    DiagnosticLog unwatched;
    for (const char* file : {"in", "old"})
      ASSERT_TRUE(write_file(folder / file, as_bytes(file), unwatched));
    log.set_files(std::make_shared<FileUses>());
  }
  void TearDown() override { fs::remove_all(folder); }
  FileUses& files() { return *log.files(); }
  bool write(const fs::path& path) { return write_file(path, as_bytes("new"), log); }
  std::string contents(const fs::path& path) {
    DiagnosticLog unwatched;
    const auto text = read_file(path, 100, unwatched);
    return text ? *text : "";
  }
  std::size_t refusals() const {
    std::size_t count = 0;
    for (const Diagnostic& each : log.entries()) count += each.code == Code("E0206");
    return count;
  }
  fs::path folder;
  DiagnosticLog log;
};

TEST_F(Uses, AnInputStaysWhole) {
  ASSERT_TRUE(read_file(folder / "in", 100, log));
  EXPECT_FALSE(write(folder / "in"));
  EXPECT_EQ(contents(folder / "in"), "in");
  EXPECT_EQ(refusals(), 1u);
  EXPECT_EQ(exit_code(log), 2);
  EXPECT_TRUE(write(folder / "old")) << "an undeclared output falls alone";
}

TEST_F(Uses, OtherNamesOfAnInputAreIt) {
  fs::create_symlink("in", folder / "link");
  fs::create_hard_link(folder / "in", folder / "hard");
  fs::create_directory_symlink(".", folder / "here");
  ASSERT_TRUE(MappedFile::open(folder / "in", log));
  for (const char* name : {"link", "hard", "here/in", "./in"})
    EXPECT_FALSE(write(folder / name)) << name;
  EXPECT_EQ(contents(folder / "in"), "in");
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
}

TEST_F(Uses, NothingIsWrittenWhereOneDeclaredOutputIsAnInput) {
  EXPECT_TRUE(files().will_write(folder / "a", "-o", log));
  EXPECT_TRUE(files().will_write(folder / "in", "--depfile", log));
  EXPECT_TRUE(files().will_write(folder / "said", "--sarif", log, FileUses::Output::diagnostics));
  ASSERT_TRUE(read_file(folder / "in", 100, log));
  EXPECT_FALSE(write(folder / "a"));
  EXPECT_FALSE(fs::exists(folder / "a"));
  EXPECT_FALSE(write(folder / "in"));
  EXPECT_EQ(refusals(), 1u) << "said once";
  EXPECT_NE(log.entries()[0].message.find("--depfile"), std::string::npos);
  EXPECT_TRUE(write(folder / "said"));
}

// The target of a link is where the file will be, whether it is there or not.
TEST_F(Uses, ALinkThatLeadsNowhereIsItsTarget) {
  fs::create_symlink("b", folder / "a");
  EXPECT_TRUE(files().will_write(folder / "b", "-o", log));
  EXPECT_FALSE(files().will_write(folder / "a", "--report", log));
  EXPECT_EQ(refusals(), 1u);
  EXPECT_FALSE(write(folder / "b"));
  EXPECT_FALSE(fs::exists(folder / "b"));
}

TEST_F(Uses, TwoOutputsAreTwoFiles) {
  fs::create_directory_symlink(".", folder / "here");
  EXPECT_TRUE(files().will_write(folder / "a", "-o", log));
  EXPECT_FALSE(files().will_write(folder / "here" / "a", "--report", log));
  EXPECT_EQ(refusals(), 1u);
  EXPECT_FALSE(write(folder / "a"));
  EXPECT_FALSE(fs::exists(folder / "a"));
}

TEST_F(Uses, AFileIsWrittenOnce) {
  EXPECT_TRUE(write(folder / "a"));
  EXPECT_FALSE(write(folder / "a"));
  EXPECT_TRUE(write(folder / "b"));
}

TEST_F(Uses, InPlaceIsMeant) {
  EXPECT_TRUE(files().will_write(folder / "in", "", log, FileUses::Output::in_place));
  ASSERT_TRUE(read_file(folder / "in", 100, log));
  EXPECT_TRUE(write(folder / "in"));
  EXPECT_EQ(contents(folder / "in"), "new");
}

TEST_F(Uses, WhatIsNoFileIsNotWatched) {
  EXPECT_TRUE(files().will_write("-", "-o", log));
  EXPECT_TRUE(files().will_write("-", "--sarif", log));
  EXPECT_TRUE(files().will_write("", "-o", log));
  EXPECT_TRUE(files().will_write("/dev/null", "-o", log));
  EXPECT_TRUE(files().will_write("/dev/null", "--sarif", log));
  EXPECT_FALSE(log.has_errors());
}

// It would fail after the work; diagnostics are written in any case.
TEST_F(Uses, FoldersThatAreMissingAreErrorsBeforeTheWork) {
  EXPECT_TRUE(
      files().will_write(folder / "no" / "x", "--sarif", log, FileUses::Output::diagnostics));
  EXPECT_FALSE(log.has_errors());
  EXPECT_FALSE(files().will_write(folder / "no" / "x", "-o", log));
  EXPECT_TRUE(log.contains(Code("E0103")));
}

TEST_F(Uses, ALogApartKnowsTheRun) {
  DiagnosticLog apart = log.apart();
  ASSERT_TRUE(read_file(folder / "in", 100, apart));
  EXPECT_FALSE(write(folder / "in"));
}

}  // namespace
}  // namespace panwright::file_uses_test
