// Models larger than memory: what writing and checking them takes.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <functional>

#include "base/diagnostic.h"
#include "pan/writer.h"
#include "tests/support/paths.h"
#include "tests/support/process.h"
#include "tests/support/sanitizers.h"

namespace panwright::pan::huge_test {
namespace {

constexpr std::uint64_t kVerticesOfMesh = 49'998;
constexpr std::uint64_t kBytesOfVertex = 26;  // position, normal, one index of 2 bytes

// Triangles of their own vertices, beside each other.
void make_mesh(std::size_t i, PackedMesh& mesh) {
  if (mesh.positions.empty()) {
    for (std::uint32_t v = 0; v < kVerticesOfMesh; ++v) {
      const std::uint32_t t = v / 3, k = v % 3;
      mesh.positions.insert(mesh.positions.end(), {static_cast<float>(t % 128 + (k == 1)),
                                                   static_cast<float>(t / 128 + (k == 2)), 0.0f});
      mesh.normals.insert(mesh.normals.end(), {0, 0, 1});
      mesh.indices.push_back(v);
    }
  }
  mesh.name = "tile " + std::to_string(i);
  mesh.origin = {200.0 * static_cast<double>(i % 1000), 200.0 * static_cast<double>(i / 1000), 0};
}

bool write_huge(const std::string& path, std::uint64_t meshes) {
  Contents contents;
  contents.version = "huge";
  contents.nodes = {{"root"}};
  contents.materials = {materials::Material{}};
  MeshProducer producer;
  for (std::uint32_t i = 0; i < meshes; ++i) {
    contents.instances.push_back({0, i, 0, -1});
    producer.shapes.push_back({kVerticesOfMesh, kVerticesOfMesh / 3, false, false});
  }
  producer.make = [](std::size_t i, PackedMesh& mesh) {
    make_mesh(i, mesh);
    return true;
  };
  DiagnosticLog log;
  const bool done = bool(write(contents, producer, path, log));
  if (!done) std::fputs(to_text(log).c_str(), stderr);
  return done;
}

struct Spent {
  int code = -1;
  std::uint64_t resident = 0;  // bytes at most, pages of files counted
};

// Runs a child whose own memory (heap, stacks, private mappings: RLIMIT_DATA) is limited.
Spent limited(std::uint64_t bytes, const std::function<int()>& body) {
  const pid_t child = fork();
  if (child == 0) {
    const rlimit limit{bytes, bytes};
    setrlimit(RLIMIT_DATA, &limit);
    _exit(body());
  }
  int status = 0;
  rusage usage{};
  wait4(child, &status, 0, &usage);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
          std::uint64_t{1024} * static_cast<std::uint64_t>(usage.ru_maxrss)};
}

// Writes vertices, and checks them with the program, each within `limit` bytes of memory.
void write_and_check(std::uint64_t vertices, std::uint64_t limit) {
#ifdef PANWRIGHT_SANITIZED
  GTEST_SKIP() << "shadow memory is not the program's";
#endif
  const support::TemporaryFolder folder;
  const std::uint64_t meshes = (vertices + kVerticesOfMesh - 1) / kVerticesOfMesh;
  const std::uint64_t bytes = meshes * kVerticesOfMesh * kBytesOfVertex;
  if (std::filesystem::space(folder.path()).available < bytes + bytes / 4)
    GTEST_SKIP() << "no room for " << bytes << " bytes";
  const std::string path = folder / "huge.pan";
  const Spent written = limited(limit, [&] { return write_huge(path, meshes) ? 0 : 1; });
  ASSERT_EQ(written.code, 0);
  EXPECT_GT(std::filesystem::file_size(path), bytes);
  const Spent checked = limited(limit, [&] {
    execl(PANWRIGHT_BIN_DIR "/panwright", "panwright", "check", path.c_str(), nullptr);
    return 127;
  });
  EXPECT_EQ(checked.code, 0);
  EXPECT_LT(written.resident, limit);
  EXPECT_LT(checked.resident, limit);
  std::printf("%llu vertices, %llu bytes: written in %.0f MiB, checked in %.0f MiB\n",
              static_cast<unsigned long long>(meshes * kVerticesOfMesh),
              static_cast<unsigned long long>(bytes),
              static_cast<double>(written.resident) / (1 << 20),
              static_cast<double>(checked.resident) / (1 << 20));
}

// measured: 397 MiB for a file of 1.17 GB, 403 MiB for the 26 GB below
TEST(Huge, FileLargerThanItsMemory) { write_and_check(45'000'000, std::uint64_t{768} << 20); }

TEST(Huge, BillionVertices) { write_and_check(1'000'000'000, std::uint64_t{1} << 30); }

}  // namespace
}  // namespace panwright::pan::huge_test
