// Public small bodies, against their labels and against assimp where it is installed.

#include <gtest/gtest.h>
#ifdef PANWRIGHT_ASSIMP
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#endif

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "geometry/mesh/check.h"
#include "importers/import.h"

namespace panwright::importers::meshes_corpus_test {
namespace {

namespace fs = std::filesystem;

// Counts as the MANIFEST.md of the corpus has them.
struct Body {
  const char* file;
  std::size_t triangles;
  std::size_t vertices;
};

constexpr Body kBodies[] = {{"bennu.obj", 2692, 1348}, {"67P-CG.obj", 13196, 6600}};

fs::path corpus() {
  const char* given = std::getenv("PANWRIGHT_CORPUS");
  return (given != nullptr && *given != '\0' ? fs::path(given) : fs::path(PANWRIGHT_CORPUS_DIR)) /
         "small-bodies";
}

struct Extent {
  Vec3 low{1e300};
  Vec3 high{-1e300};
  std::size_t triangles = 0;
  void add(const Vec3& p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
};

class SmallBody : public testing::TestWithParam<Body> {};

TEST_P(SmallBody, IsWholeAndClosed) {
  const fs::path path = corpus() / GetParam().file;
  if (!fs::exists(path)) GTEST_SKIP() << "no " << path;
  DiagnosticLog log;
  const auto out = import_file(path, {}, log);
  ASSERT_TRUE(out) << to_text(log);
  EXPECT_EQ(log.errors(), 0u) << to_text(log);
  // both name a material library that does not lie beside them
  EXPECT_EQ(log.warnings(), 1u) << to_text(log);
  EXPECT_TRUE(log.contains(Code("W6004"))) << to_text(log);
  ASSERT_EQ(out->scene.shapes.size(), 1u);
  const auto& mesh = *std::get<geometry::MeshShape>(out->scene.shapes[0]);
  EXPECT_EQ(mesh.triangles.size(), GetParam().triangles);
  const geometry::MeshReport report = geometry::check(mesh);
  EXPECT_TRUE(report.closed);
  EXPECT_EQ(report.misoriented_edges, 0u);
  EXPECT_GT(report.volume, 0);  // outwards
  // Euler: V − E + F = 2 for a body without handles
  EXPECT_EQ(GetParam().vertices + GetParam().triangles, 3 * GetParam().triangles / 2 + 2);
}

TEST_P(SmallBody, AgreesWithAssimp) {
  const fs::path path = corpus() / GetParam().file;
  if (!fs::exists(path)) GTEST_SKIP() << "no " << path;
#ifdef PANWRIGHT_ASSIMP
  DiagnosticLog log;
  const auto out = import_file(path, {}, log);
  ASSERT_TRUE(out);
  Extent ours, theirs;
  for (const geometry::Shape& shape : out->scene.shapes) {
    const auto& mesh = *std::get<geometry::MeshShape>(shape);
    ours.triangles += mesh.triangles.size();
    for (const Vec3& p : mesh.positions) ours.add(p);
  }
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(path.string(), 0);
  ASSERT_NE(scene, nullptr) << importer.GetErrorString();
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    theirs.triangles += scene->mMeshes[m]->mNumFaces;
    for (unsigned v = 0; v < scene->mMeshes[m]->mNumVertices; ++v) {
      const aiVector3D& p = scene->mMeshes[m]->mVertices[v];
      theirs.add({p.x, p.y, p.z});
    }
  }
  EXPECT_EQ(ours.triangles, theirs.triangles);
  // theirs are floats, up to one step off what is written
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(ours.low[k], theirs.low[k], 1.2e-7 * std::fabs(ours.low[k]));
    EXPECT_NEAR(ours.high[k], theirs.high[k], 1.2e-7 * std::fabs(ours.high[k]));
  }
#else
  GTEST_SKIP() << "assimp is not installed";
#endif
}

INSTANTIATE_TEST_SUITE_P(Files, SmallBody, testing::ValuesIn(kBodies),
                         [](const auto& body) { return "body" + std::to_string(body.index); });

}  // namespace
}  // namespace panwright::importers::meshes_corpus_test
