// Writing: rounding, sameness, and what a killed or failing writer leaves behind.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <random>

#include "base/file.h"
#include "pan/model.h"
#include "pan/writer.h"
#include "tests/support/pan_sample.h"

namespace panwright::pan::write_test {
namespace {

namespace fs = std::filesystem;

class Folder {
 public:
  Folder() {
    std::string name = (fs::temp_directory_path() / "panwright_pan_XXXXXX").string();
    path_ = mkdtemp(name.data());
  }
  ~Folder() { fs::remove_all(path_); }
  fs::path operator/(const char* name) const { return path_ / name; }
  std::size_t files() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(path_), fs::directory_iterator()));
  }
  fs::directory_iterator begin() const { return fs::directory_iterator(path_); }
  fs::directory_iterator end() const { return {}; }

 private:
  fs::path path_;
};

std::string contents_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(Write, FileAndMemoryAndASecondTimeAreTheSame) {
  const Folder folder;
  DiagnosticLog log;
  const auto report = write(support::small_contents(), folder / "a.pan", log);
  ASSERT_TRUE(report) << to_text(log);
  const std::vector<std::byte> memory = support::small_pan();
  const std::string file = contents_of(folder / "a.pan");
  EXPECT_EQ(report->bytes, file.size());
  ASSERT_EQ(file.size(), memory.size());
  EXPECT_EQ(std::memcmp(file.data(), memory.data(), file.size()), 0);
  EXPECT_EQ(memory, support::small_pan());
  EXPECT_EQ(folder.files(), 1u);
}

TEST(Write, ContentsThatAreGivenAwayMakeTheSameFile) {
  const Folder folder;
  DiagnosticLog log;
  for (const bool compress : {false, true})
    for (Contents contents : {support::small_contents(), support::large_contents(1)}) {
      const Contents& kept = contents;
      ASSERT_TRUE(write(kept, folder / "a.pan", log, {.compress = compress})) << to_text(log);
      EXPECT_FALSE(contents.meshes.back().indices.empty());
      ASSERT_TRUE(write(std::move(contents), folder / "b.pan", log, {.compress = compress}));
      EXPECT_TRUE(contents_of(folder / "a.pan") == contents_of(folder / "b.pan"));
    }
}

TEST(Write, NothingThatReadersRefuse) {
  const Folder folder;
  DiagnosticLog log;
  ASSERT_TRUE(write(support::small_contents(), folder / "a.pan", log)) << to_text(log);
  const std::string before = contents_of(folder / "a.pan");
  for (const bool compress : {false, true})
    for (const int fault : {0, 1, 2}) {
      Contents contents = support::small_contents();
      if (fault == 0) contents.meshes[0].positions[0] = std::numeric_limits<float>::infinity();
      if (fault == 1) contents.instances[0].material = 1000;
      if (fault == 2) contents.nodes.back().rotation = Quat(2, 0, 0, 0);
      DiagnosticLog refused;
      EXPECT_FALSE(write(contents, folder / "a.pan", refused, {.compress = compress})) << fault;
      EXPECT_EQ(refused.errors(), 1u) << to_text(refused);
      EXPECT_EQ(contents_of(folder / "a.pan"), before) << fault;
      EXPECT_EQ(folder.files(), 1u);
    }
}

TEST(Write, SectionsMayComeInPieces) {
  // pieces below, at and above the size of a block give the file of a single call
  std::vector<std::byte> data(2 * layout::kHashBlock + 12345);
  std::mt19937 random(3);
  for (std::byte& byte : data) byte = static_cast<std::byte>(random());
  const auto file = [&](std::size_t piece) {
    DiagnosticLog log;
    Writer writer = Writer::in_memory();
    EXPECT_TRUE(writer.begin(1000, 1, true, log));
    for (std::size_t at = 0; at < data.size(); at += piece)
      EXPECT_TRUE(
          writer.append(std::span(data).subspan(at, std::min(piece, data.size() - at)), log));
    EXPECT_TRUE(writer.end(log) && writer.finish({}, log));
    EXPECT_EQ(writer.bytes(), 128 + (data.size() + 63) / 64 * 64 + 64);
    return std::move(writer).take();
  };
  const auto whole = file(data.size());
  EXPECT_EQ(whole, file(1000));
  EXPECT_EQ(whole, file(layout::kHashBlock));
  EXPECT_EQ(whole, file(layout::kHashBlock - 1));
  EXPECT_EQ(whole, file(layout::kHashBlock + 1));
}

TEST(Write, RoundingIsPartOfTheError) {
  // a mesh far from its origin, with coordinates that no float holds
  std::mt19937 random(11);
  geometry::Mesh mesh;
  mesh.error = 1e-7;
  for (int i = 0; i < 3000; ++i) {
    const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
    mesh.positions.emplace_back(1e6 + 10 * uniform(), -2e5 + 7 * uniform(), 3 * uniform());
  }
  mesh.normals.assign(3000, {0, 0, 1});
  mesh.triangles = {{0, 1, 2}};
  const PackedMesh packed_mesh = packed(mesh, "far");
  double worst = 0;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    // note: volatile, so that no compiler takes the rounding to float for nothing
    volatile float stored[3] = {packed_mesh.positions[3 * i], packed_mesh.positions[3 * i + 1],
                                packed_mesh.positions[3 * i + 2]};
    const Vec3 back = packed_mesh.origin + Vec3(stored[0], stored[1], stored[2]);
    worst = std::max(worst, glm::length(back - mesh.positions[i]));
  }
  EXPECT_GT(worst, 1e-8);
  EXPECT_EQ(packed_mesh.error, 1e-7 + worst);
  // half an ulp of each half extent: 5 m, 3.5 m and 1.5 m have ulps of 2^-21, 2^-22 and 2^-23
  const double bound =
      0.5 * std::sqrt(std::exp2(-42.0) + std::exp2(-44.0) + std::exp2(-46.0)) + 2e-10;
  EXPECT_LE(worst, bound);
}

TEST(Write, PackedCentresTheMesh) {
  geometry::Mesh mesh;
  mesh.positions = {{-3, 1.7e308, 0}, {5, 1.7e308, 0}, {0, 1.7e308, 0}};
  mesh.normals.assign(3, {0, 0, 1});
  mesh.triangles = {{0, 1, 2}};
  const PackedMesh out = packed(mesh, "");
  EXPECT_EQ(out.origin, Vec3(1, 1.7e308, 0));
  EXPECT_EQ(out.error, 0);
}

TEST(Write, StringsAreNumberedOnce) {
  StringTable strings;
  EXPECT_EQ(strings.id(""), 0u);
  EXPECT_EQ(strings.id("b"), 1u);
  EXPECT_EQ(strings.id("aa"), 2u);
  EXPECT_EQ(strings.id("b"), 1u);
  EXPECT_EQ(strings.bytes(), "baa");
  EXPECT_EQ(std::vector<std::uint32_t>(strings.offsets().begin(), strings.offsets().end()),
            (std::vector<std::uint32_t>{0, 0, 1, 3}));
}

TEST(Write, BuildIdentityTellsEveryPartFromAnother) {
  const std::vector<InputContent> inputs = {{"a", {1, 2}, 3}, {"b", {4, 5}, 6}};
  const Hash128 id = build_identity(inputs, "v", "o");
  EXPECT_EQ(id, build_identity(inputs, "v", "o"));
  for (int change = 0; change < 6; ++change) {
    auto other = inputs;
    if (change == 0) other[1].path = "c";
    if (change == 1) other[0].hash.low ^= 1;
    if (change == 2) other[0].hash.high ^= 1;
    if (change == 3) other[1].bytes = 7;
    if (change == 4) std::swap(other[0], other[1]);
    if (change == 5) other.pop_back();
    EXPECT_NE(id, build_identity(other, "v", "o")) << change;
  }
  // text may not move from one string to the next
  EXPECT_NE(build_identity(inputs, "vo", ""), id);
  EXPECT_NE(build_identity(inputs, "", "vo"), id);
}

TEST(Write, AnAbandonedWriterLeavesNothing) {
  const Folder folder;
  DiagnosticLog log;
  ASSERT_TRUE(write_file(folder / "a.pan", as_bytes("old"), log));
  {
    auto writer = Writer::create(folder / "a.pan", log);
    ASSERT_TRUE(writer);
    EXPECT_LE(folder.files(), 2u);  // the unfinished one has a name on some file systems
    const std::vector<std::byte> data(3 * layout::kHashBlock);
    EXPECT_TRUE(writer->section(layout::SectionKind::texels, data, log));
  }
  EXPECT_EQ(folder.files(), 1u);
  EXPECT_EQ(contents_of(folder / "a.pan"), "old");
}

// The child does the work, and is killed without warning at some point of it.
template <class Work>
int status_of_child(Work work) {
  const pid_t child = fork();
  if (child == 0) {
    work();
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return status;
}

TEST(Write, AKilledWriterLeavesTheOldFileWhole) {
  for (const bool through_the_directory : {false, true}) {
    const Folder folder;
    DiagnosticLog log;
    ASSERT_TRUE(write_file(folder / "a.pan", as_bytes("old"), log));
    const int status = status_of_child([&] {
      DiagnosticLog inner;
      auto writer = Writer::create(folder / "a.pan", inner);
      const std::vector<std::byte> data(3 * layout::kHashBlock);
      writer->section(layout::SectionKind::texels, data, inner);
      if (!through_the_directory) {
        writer->begin(1, 1, false, inner);
        writer->append(data, inner);
      }
      raise(SIGKILL);
    });
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
    EXPECT_EQ(contents_of(folder / "a.pan"), "old");
    // where the temporary file has a name it is still there, and says that it is not finished
    ASSERT_LE(folder.files(), 2u);
    for (const auto& file : folder) {
      if (file.path().filename() == "a.pan") continue;
      DiagnosticLog inner;
      EXPECT_FALSE(Model::open(file.path(), inner));
      EXPECT_TRUE(inner.contains(Code("E4006"))) << to_text(inner);
    }
  }
}

TEST(Write, ADiskThatIsFullIsReportedOnce) {
  const Folder folder;
  DiagnosticLog log;
  ASSERT_TRUE(write_file(folder / "a.pan", as_bytes("old"), log));
  const int status = status_of_child([&] {
    signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{4096, 4096};
    setrlimit(RLIMIT_FSIZE, &limit);
    DiagnosticLog inner;
    const bool written = write(support::large_contents(1), folder / "a.pan", inner).ok();
    _exit(!written && inner.errors() == 1 && inner.contains(Code("E0103")) ? 7 : 8);
  });
  EXPECT_EQ(WEXITSTATUS(status), 7);
  EXPECT_EQ(contents_of(folder / "a.pan"), "old");
  EXPECT_EQ(folder.files(), 1u);
}

TEST(Write, FoldersThatAreNotThere) {
  DiagnosticLog log;
  EXPECT_FALSE(write(support::small_contents(), "/nowhere/at/all.pan", log));
  EXPECT_TRUE(log.contains(Code("E0103")));
}

}  // namespace
}  // namespace panwright::pan::write_test
