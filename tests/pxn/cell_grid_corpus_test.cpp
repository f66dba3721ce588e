// Solar cells on panels of public spacecraft.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "cell_grid_support.h"

namespace panwright::pxn::cell_grid_corpus_test {
namespace {

namespace fs = std::filesystem;

struct Panels {
  const char* file;
  const char* rule;
  double with_cells;  // m²
  bool warns;
};

// Areas as measured, lengths good to 4.9e-7 of the size; Juno's panels have holders, a boom and
// edges that are no rectangles.
constexpr Panels kPanels[] = {
    {"sentinel6-draco-webp.glb", "materials=\"solarArray\"", 16.8, false},
    {"landsat8-blender.glb", "materials=\"*solarpanel-face\"", 26.1, false},
    {"juno-draco-webp.glb", "materials=\"solar_panels\"", 57.0, true},
};

TEST(CellGridCorpus, CellsAreTrueMetres) {
  const char* given = std::getenv("PANWRIGHT_CORPUS");
  const fs::path corpus =
      (given != nullptr && *given != '\0' ? fs::path(given) : fs::path(PANWRIGHT_CORPUS_DIR)) /
      "spacecraft-gltf";
  if (!fs::exists(corpus)) GTEST_SKIP() << corpus << " is not there";
  for (const Panels& panels : kPanels) {
    SCOPED_TRACE(panels.file);
    std::ifstream in(corpus / panels.file, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    const CellReading r = cells_reading(panels.file, bytes, "", panels.rule);
    const double area = expect_true_metres(r.scene, 1e-5);
    EXPECT_NEAR(area, panels.with_cells, 0.005 * panels.with_cells);
    EXPECT_TRUE(r.log.contains(Code("N2021")));
    EXPECT_EQ(r.log.contains(Code("W6008")), panels.warns) << to_text(r.log);
  }
}

}  // namespace
}  // namespace panwright::pxn::cell_grid_corpus_test
