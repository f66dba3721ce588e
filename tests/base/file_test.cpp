#include "base/file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <memory>
#include <thread>

#include "base/file_uses.h"
#include "base/job.h"

namespace panwright::file_test {
namespace {

namespace fs = std::filesystem;

class File : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "panwright-file-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder = name;
  }
  void TearDown() override { fs::remove_all(folder); }
  std::size_t entries() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), {}));
  }
  // Whether the file system has files without a name.
  bool unnamed_files() const {
    const int fd = open(folder.c_str(), O_TMPFILE | O_WRONLY, 0600);
    if (fd >= 0) close(fd);
    return fd >= 0;
  }
  std::string contents(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  fs::path folder;
  DiagnosticLog log;
};

TEST_F(File, ReadsWhatIsThere) {
  const std::string text("a\0b\r\n\xff", 6);
  ASSERT_TRUE(write_file(folder / "f", as_bytes(text), log));
  const auto read = read_file(folder / "f", 6, log);
  ASSERT_TRUE(read);
  EXPECT_EQ(*read, text);
  EXPECT_FALSE(log.has_errors());
}

TEST_F(File, RefusesMoreThanTheLimit) {
  ASSERT_TRUE(write_file(folder / "f", as_bytes("123456"), log));
  EXPECT_FALSE(read_file(folder / "f", 5, log));
  EXPECT_TRUE(log.contains(Code("E0104")));
  EXPECT_EQ(exit_code(log), 3);
  // a device has no size to ask for: the limit holds while reading
  DiagnosticLog endless;
  EXPECT_FALSE(read_file("/dev/zero", 1 << 20, endless));
  EXPECT_TRUE(endless.contains(Code("E0104")));
}

TEST_F(File, NamesTheReasonWhenItCannotOpen) {
  EXPECT_FALSE(read_file(folder / "none", 10, log));
  ASSERT_EQ(log.entries().size(), 1u);
  EXPECT_EQ(log.entries()[0].code, Code("E0101"));
  EXPECT_NE(log.entries()[0].message.find("No such file"), std::string::npos);
  EXPECT_FALSE(read_file(folder, 10, log));
  EXPECT_FALSE(MappedFile::open(folder, log));
  EXPECT_FALSE(MappedFile::open(folder / "none", log));
  EXPECT_EQ(log.errors(), 4u);
}

TEST_F(File, NamesTheNearestOfAFolderForOneThatIsMissing) {
  ASSERT_TRUE(write_file(folder / "probe.pxn", as_bytes("x"), log));
  const auto hint = [&](const std::filesystem::path& path) {
    DiagnosticLog apart;
    EXPECT_FALSE(require_file(path, apart));
    EXPECT_EQ(apart.entries().at(0).code, Code("E0101"));
    return apart.entries()[0].hint;
  };
  EXPECT_EQ(hint(folder / "prob.pxn"), "did you mean '" + (folder / "probe.pxn").string() + "'?");
  EXPECT_EQ(hint(folder / "none/a.pxn"), "there is no folder '" + (folder / "none").string() + "'");
  EXPECT_EQ(hint(folder / "xyz"), "");
  EXPECT_TRUE(require_file(folder / "probe.pxn", log));
  EXPECT_FALSE(read_file(folder / "prob.pxn", 10, log));
  EXPECT_NE(log.entries().back().hint, "");
}

TEST_F(File, MapsBytesAndTheEmptyFile) {
  ASSERT_TRUE(write_file(folder / "f", as_bytes("pan"), log));
  ASSERT_TRUE(write_file(folder / "empty", {}, log));
  const auto mapped = MappedFile::open(folder / "f", log);
  ASSERT_TRUE(mapped);
  EXPECT_EQ(mapped->bytes().size(), 3u);
  EXPECT_EQ(mapped->bytes()[1], std::byte{'a'});
  const auto empty = MappedFile::open(folder / "empty", log);
  ASSERT_TRUE(empty);
  EXPECT_TRUE(empty->bytes().empty());
}

TEST_F(File, UncommittedWritesLeaveTheOldFile) {
  ASSERT_TRUE(write_file(folder / "f", as_bytes("old"), log));
  {
    auto file = AtomicFile::create(folder / "f", log);
    ASSERT_TRUE(file);
    ASSERT_TRUE(file->write(as_bytes("new and longer"), log));
    EXPECT_EQ(contents(folder / "f"), "old");
    EXPECT_EQ(entries(), unnamed_files() ? 1u : 2u);
  }
  EXPECT_EQ(contents(folder / "f"), "old");
  EXPECT_EQ(entries(), 1u) << "the temporary file is gone";
}

TEST_F(File, KilledWritersLeaveTheOldFile) {
  ASSERT_TRUE(write_file(folder / "f", as_bytes("old"), log));
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    DiagnosticLog inner;
    auto file = AtomicFile::create(folder / "f", inner);
    file->write(as_bytes("half"), inner);
    raise(SIGKILL);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(contents(folder / "f"), "old");
  EXPECT_EQ(entries(), unnamed_files() ? 1u : 2u);
}

TEST_F(File, ReplacesTheTargetOfALinkAndKeepsTheMode) {
  ASSERT_TRUE(write_file(folder / "target", as_bytes("old"), log));
  ASSERT_EQ(chmod((folder / "target").c_str(), 0640), 0);
  fs::create_symlink("target", folder / "link");
  ASSERT_TRUE(write_file(folder / "link", as_bytes("new"), log));
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_EQ(contents(folder / "target"), "new");
  struct stat status {};
  ASSERT_EQ(stat((folder / "target").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0640u);
}

TEST_F(File, PatchesAPlaceBeforeCommit) {
  auto file = AtomicFile::create(folder / "f", log);
  ASSERT_TRUE(file);
  ASSERT_TRUE(file->write(as_bytes("0000body"), log));
  ASSERT_TRUE(file->write_at(0, as_bytes("HEAD"), log));
  double seconds = 0;
  ASSERT_TRUE(file->commit(log, &seconds));
  EXPECT_EQ(contents(folder / "f"), "HEADbody");
  EXPECT_GT(seconds, 0);
}

TEST_F(File, SaysWhyItCannotWrite) {
  EXPECT_FALSE(write_file(folder / "none" / "f", as_bytes("x"), log));
  EXPECT_FALSE(write_file(folder, as_bytes("x"), log));
  EXPECT_EQ(log.errors(), 2u);
  EXPECT_EQ(log.entries()[0].code, Code("E0103"));
  EXPECT_EQ(exit_code(log), 3);
  EXPECT_FALSE(write_file("/dev/full", as_bytes("x"), log));
  EXPECT_EQ(log.errors(), 3u);
}

// They stay what they are.
TEST_F(File, PipesAreWaitedFor) {
  const fs::path pipe = folder / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const std::string text(200'000, 'x');  // more than a pipe holds
  std::thread writer([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(150));
    std::ofstream out(pipe, std::ios::binary);
    out << text.substr(0, 100'000) << std::flush;
    std::this_thread::sleep_for(std::chrono::milliseconds(150));
    out << text.substr(100'000);
  });
  const auto read = read_file(pipe, 1 << 20, log);
  writer.join();
  ASSERT_TRUE(read);
  EXPECT_EQ(*read, text);
}

TEST_F(File, CancellingEndsTheWaitForAPipe) {
  const fs::path pipe = folder / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const Job job(JobOptions{});
  log.set_files(std::make_shared<FileUses>(job));
  std::thread canceller([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(150));
    job.cancel();
  });
  EXPECT_FALSE(read_file(pipe, 1 << 20, log));
  canceller.join();
  EXPECT_TRUE(log.contains(Code("E0001")));
  EXPECT_FALSE(MappedFile::open(pipe, log));
}

TEST_F(File, DevicesAndPipesTakeWhatIsWritten) {
  EXPECT_TRUE(write_file("/dev/null", as_bytes("x"), log));
  const fs::path pipe = folder / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  // nothing can be put into its place
  EXPECT_FALSE(AtomicFile::create(pipe, log));
  EXPECT_EQ(log.errors(), 1u);
  const int reader = open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
  ASSERT_GE(reader, 0);
  EXPECT_TRUE(write_file(pipe, as_bytes("said"), log));
  fs::create_symlink("pipe", folder / "link");
  EXPECT_TRUE(write_file(folder / "link", as_bytes("!"), log));
  char got[8] = {};
  EXPECT_EQ(read(reader, got, sizeof got), 5);
  EXPECT_STREQ(got, "said!");
  close(reader);
  EXPECT_TRUE(fs::is_fifo(pipe));
  EXPECT_EQ(log.errors(), 1u);
}

// Not the file behind it, which has other text from the same descriptor.
TEST_F(File, OpenStreamsTakeWhatIsWritten) {
  const int stream = open((folder / "out").c_str(), O_WRONLY | O_CREAT, 0600);
  ASSERT_EQ(write(stream, "one ", 4), 4);
  for (const char* name : {"/dev/fd/", "/proc/self/fd/"})
    EXPECT_TRUE(write_file(name + std::to_string(stream), as_bytes("two "), log));
  ASSERT_EQ(write(stream, "three", 5), 5);
  close(stream);
  EXPECT_EQ(contents(folder / "out"), "one two two three");
  EXPECT_FALSE(log.has_errors());
}

TEST_F(File, ALinkThatLeadsNowhereStaysALink) {
  fs::create_directory(folder / "sub");
  fs::create_symlink("sub/b", folder / "a");
  fs::create_symlink(folder / "a", folder / "again");
  ASSERT_TRUE(write_file(folder / "again", as_bytes("new"), log));
  EXPECT_TRUE(fs::is_symlink(folder / "a"));
  EXPECT_TRUE(fs::is_symlink(folder / "again"));
  EXPECT_EQ(contents(folder / "sub" / "b"), "new");
  fs::create_symlink("loop", folder / "loop");
  EXPECT_FALSE(write_file(folder / "loop" / "f", as_bytes("new"), log));
}

}  // namespace
}  // namespace panwright::file_test
