// Runs that are gone on with after crashes, and what they must not write over.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tests/support/paths.h"
#include "tests/support/process.h"

namespace panwright::resume_test {
namespace {

namespace fs = std::filesystem;
using support::contents;
using support::Outcome;
using support::panwright;
using support::TemporaryFolder;
using testing::HasSubstr;
using testing::Not;

std::map<std::string, std::string> tree_of(const fs::path& folder) {
  std::map<std::string, std::string> out;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file())
      out[fs::relative(entry.path(), folder).string()] = contents(entry.path());
  return out;
}

void expect_same_trees(const fs::path& one, const fs::path& other) {
  const auto a = tree_of(one), b = tree_of(other);
  for (const auto& [name, bytes] : a) {
    const auto at = b.find(name);
    if (at == b.end())
      ADD_FAILURE() << name << " is missing";
    else
      EXPECT_TRUE(bytes == at->second) << name;
  }
  for (const auto& [name, bytes] : b) EXPECT_TRUE(a.contains(name)) << name << " is left over";
}

class Resume : public testing::Test {
 protected:
  const TemporaryFolder folder_;

  Resume() {
    folder_.write("box.pxn",
                  "<pangu_model ver=\"1\"><keypoint name=\"tip\" at=\"0.5 0.5 0.5\"/><box "
                  "size=\"1\"/></pangu_model>");
    folder_.write("way.csv", "time[s],camera.x[m],camera.y[m],camera.z[m]\n0,0,-6,0\n100,2,-6,1\n");
  }

  std::string scenario(const std::string& head, const std::string& labels,
                       const std::string& size = "[24, 16]") const {
    return folder_.write("run.toml",
                         head +
                             "look_at = \"box\"\n[targets]\nbox = \"box.pxn\"\n"
                             "[[source]]\nfile = \"way.csv\"\n"
                             "[[source]]\nformula = \"fixed\"\nsun = [1, -2, 1]\n"
                             "[view]\nsize = " +
                             size + "\nfov = 30\nengine = \"reference\"\nsamples = 1\n" + labels);
  }
  std::vector<std::string> words(const std::string& file, const std::string& output,
                                 std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"run", file, "-o", folder_ / output});
    return more;
  }
  void cut(const std::string& file) const {
    const std::string path = folder_ / file;
    fs::resize_file(path, fs::file_size(path) / 2);
  }
};

TEST_F(Resume, DamagedFilesAreMadeAgain) {
  const std::string file = scenario("begin = 0\nend = 8\nstep = 1\n",
                                    "[labels]\nflow = true\nformats = [\"coco\", \"bop\"]\n");
  const std::vector<std::string> types = {"--type", "png", "--type", "npz", "--type", "exr"};
  const auto run = [&](const std::string& output, bool resume = false) {
    std::vector<std::string> all = words(file, output, types);
    if (resume) all.push_back("--resume");
    return panwright(all);
  };
  const Outcome done = run("whole");
  ASSERT_EQ(done.code, 0) << done.err;
  ASSERT_EQ(run("part").code, 0);
  for (const char* each : {"000000.png", "000001.npz", "000002.exr", "000003.labels.json",
                           "000004.masks.npz", "000005.forward.flo", "000006.backward.flo"})
    cut(std::string("part/") + each);
  folder_.write("part/000001.png.4711-3", "what a killed run has left");
  folder_.write("part/notes.4711-3", "mine");
  const auto kept = fs::last_write_time(folder_ / "part/000007.png");
  const auto old = fs::last_write_time(folder_ / "part/000006.png");
  const Outcome again = run("part", true);
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_THAT(again.err, HasSubstr("2 frames kept"));
  EXPECT_THAT(again.err, HasSubstr("7 frames not whole: made again"));
  EXPECT_EQ(fs::last_write_time(folder_ / "part/000007.png"), kept);
  EXPECT_NE(fs::last_write_time(folder_ / "part/000006.png"), old);
  EXPECT_EQ(contents(folder_ / "part/notes.4711-3"), "mine");
  fs::remove(folder_ / "part/notes.4711-3");
  expect_same_trees(folder_ / "whole", folder_ / "part");
}

TEST_F(Resume, NothingIsWrittenOver) {
  const std::string file =
      scenario("begin = 0\nend = 2\nstep = 1\n", "[labels]\nflow = true\nformats = \"coco\"\n");
  for (const char* name :
       {"run.json", "000001.png", "000002.masks.npz", "000000.forward.flo", "coco/mine.txt"}) {
    fs::remove_all(folder_ / "own");
    fs::create_directories(folder_ / "own/coco");
    folder_.write(std::string("own/") + name, "mine");
    for (const bool resume : {false, true}) {
      const Outcome done = panwright(words(
          file, "own", resume ? std::vector<std::string>{"--resume"} : std::vector<std::string>{}));
      EXPECT_NE(done.code, 0) << name;
      EXPECT_THAT(done.err, HasSubstr("E8014")) << name;
      EXPECT_THAT(done.err, HasSubstr(std::string(name) == "coco/mine.txt" ? "coco" : name));
    }
    EXPECT_EQ(contents(folder_ / (std::string("own/") + name)), "mine");
    EXPECT_EQ(tree_of(folder_ / "own").size(), 1u) << name;
  }
  // other files are in nobody's way
  fs::remove_all(folder_ / "own");
  fs::create_directories(folder_ / "own");
  folder_.write("own/notes.txt", "mine");
  const Outcome done = panwright(words(file, "own"));
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(contents(folder_ / "own/notes.txt"), "mine");
}

TEST_F(Resume, FormatsAreThoseOfTheCommand) {
  const std::string file =
      scenario("begin = 0\nend = 3\nstep = 1\n", "[labels]\nformats = [\"coco\", \"bop\"]\n");
  const Outcome done = panwright(words(file, "frames", {"--type", "png", "--type", "npz"}));
  ASSERT_EQ(done.code, 0) << done.err;
  const Outcome formats =
      panwright({"labels", folder_ / "frames", "-o", folder_ / "formats", "--format", "coco,bop",
                 "--target", "box=" + (folder_ / "box.pxn")});
  ASSERT_EQ(formats.code, 0) << formats.err;
  for (const char* name : {"coco", "bop"})
    expect_same_trees(folder_.path() / "formats" / name, folder_.path() / "frames" / name);
  EXPECT_TRUE(fs::exists(folder_ / "frames/bop/models/obj_000001.ply"));
  // a format that cannot hold the targets is found before anything is drawn
  const std::string two =
      folder_.write("two.toml",
                    "[targets]\na = \"box.pxn\"\nb = \"box.pxn\"\n[[source]]\nfile = \"way.csv\"\n"
                    "[view]\nlook_at = [0, 0, 0]\n[labels]\nformats = \"speed\"\n");
  const Outcome refused = panwright(words(two, "two", {"--frames", "0"}));
  EXPECT_THAT(refused.err, HasSubstr("E9003"));
  EXPECT_THAT(refused.err, HasSubstr("'speed' holds one target; the scenario has 2"));
  EXPECT_FALSE(fs::exists(folder_ / "two"));
}

TEST_F(Resume, KilledAtTenPlaces) {
  const std::string file = scenario("begin = 0\nend = 99\nstep = 1\n",
                                    "[labels]\nflow = true\nformats = \"coco\"\n", "[64, 48]");
  ASSERT_EQ(panwright(words(file, "whole", {})).code, 0);
  // each goes on where the one before was killed
  std::vector<std::string> command = words(file, "killed", {"--resume"});
  command.insert(command.begin(), PANWRIGHT_BIN_DIR "/panwright");
  const auto labelled = [&] {
    if (!fs::exists(folder_ / "killed")) return -1;
    int count = 0;
    for (const auto& entry : fs::directory_iterator(folder_ / "killed"))
      count += entry.path().string().ends_with(".labels.json");
    return count;
  };
  int killed = 0;
  for (int k = 0; k < 10; ++k)
    killed += support::run_and_kill(command, [&] { return labelled() >= 9 * k; });
  EXPECT_GE(killed, 5) << "the kills came too late to mean anything";
  const Outcome done = panwright(words(file, "killed", {"--resume"}));
  ASSERT_EQ(done.code, 0) << done.err;
  expect_same_trees(folder_ / "whole", folder_ / "killed");
}

// A disk of its own that is full after some frames: those are kept, and whole.
TEST_F(Resume, AFullDiskKeepsWhatIsWhole) {
  const std::string file =
      scenario("begin = 0\nend = 99\nstep = 1\n", "[labels]\nflow = true\n", "[64, 48]");
  ASSERT_EQ(panwright(words(file, "whole", {"--type", "npz"})).code, 0);
  fs::create_directory(folder_ / "disk");
  const auto ran =
      support::run_on_disk(folder_ / "disk", 3 * 1024,
                           "\"$0\" run \"$1\" -o \"$2/disk/frames\" --type npz; code=$?; "
                           "cp -r \"$2/disk/frames\" \"$2/frames\"; exit $code",
                           {PANWRIGHT_BIN_DIR "/panwright", file, folder_.path().string()});
  if (!ran) GTEST_SKIP() << "no mounts without privilege here";
  const Outcome& full = *ran;
  ASSERT_EQ(full.code, 3) << full.err;
  EXPECT_THAT(full.err, HasSubstr("E0103"));
  EXPECT_THAT(full.err, HasSubstr("No space left"));
  EXPECT_THAT(full.err, HasSubstr("complete frames are kept; --resume goes on"));
  const auto kept = tree_of(folder_ / "frames"), whole = tree_of(folder_ / "whole");
  std::size_t frames = 0;
  for (const auto& [name, bytes] : kept) {
    ASSERT_TRUE(whole.contains(name)) << name << " is left over";
    EXPECT_TRUE(bytes == whole.at(name)) << name;
    frames += name.ends_with(".labels.json");
  }
  EXPECT_GT(frames, 3u);
  EXPECT_LT(frames, 97u);
  const Outcome done = panwright(words(file, "frames", {"--type", "npz", "--resume"}));
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(done.err, HasSubstr(std::to_string(frames) + " frames kept"));
  expect_same_trees(folder_ / "whole", folder_ / "frames");
}

// Peak of the resident memory of a run, kilobytes.
long peak_of(std::vector<std::string> words) {
  const std::string program =
      "import resource, subprocess, sys\n"
      "quiet = subprocess.DEVNULL\n"
      "code = subprocess.run(sys.argv[1:], stdout=quiet, stderr=quiet).returncode\n"
      "print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss if code == 0 else -1)\n";
  words.insert(words.begin(), {"python3", "-c", program, PANWRIGHT_BIN_DIR "/panwright"});
  return std::stol(support::run(words).out);
}

TEST_F(Resume, MemoryIsFlatOverTenThousandFrames) {
  const std::string file =
      scenario("begin = 0\nend = 100\nstep = 0.01\n", "[labels]\nflow = true\n", "[16, 12]");
  const long few = peak_of(words(file, "few", {"--frames", "0..999"}));
  const long many = peak_of(words(file, "many", {"--frames", "0..9999"}));
  printf("peaks: %ld KiB of 1,000 frames, %ld KiB of 10,000\n", few, many);
  ASSERT_GT(few, 0);
  // lines of frames.jsonl, and names of files: 2.7 KB a frame, 24.1 MB measured
  EXPECT_LT(many - few, 27 * 1024);
  EXPECT_TRUE(fs::exists(folder_ / "many/009999.labels.json"));
}

}  // namespace
}  // namespace panwright::resume_test
