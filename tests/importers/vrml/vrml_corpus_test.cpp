// Public VRML files, against what two other readers make of them (ORACLE-vrml.tsv: Coin 4.0.0 and
// castle 4.2.0). What differs stands in differences.tsv with its reason, and has to differ.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <set>
#include <sstream>

#include "base/clock.h"
#include "importers/import.h"
#include "tests/support/paths.h"

namespace panwright::importers::vrml_corpus_test {
namespace {

namespace fs = std::filesystem;

using Row = std::vector<std::string>;

fs::path corpus() {
  const char* folder = std::getenv("PANWRIGHT_CORPUS");
  return folder != nullptr ? folder : PANWRIGHT_CORPUS_DIR;
}

// Tab-separated values without the first line.
std::vector<Row> table(const fs::path& path) {
  std::vector<Row> rows;
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    Row row;
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, '\t');) row.push_back(cell);
    row.resize(5);
    rows.push_back(row);
  }
  return rows;
}

struct Count {
  std::uint64_t triangles = 0;
  bool exact = true;  // no surfaces of revolution
  Vec3 low{1e300};
  Vec3 high{-1e300};
};

// Coin's triangles for a primitive: spheres of 30 × 15, cylinders and cones of 20 segments, whose
// caps are fans of 18.
std::uint64_t coin_triangles(const geometry::Shape& shape) {
  constexpr std::uint64_t kSphere = 390, kCylinder = 40, kCone = 20, kCap = 18, kBox = 12;
  using geometry::Caps;
  if (const auto* cylinder = std::get_if<geometry::Cylinder>(&shape))
    return kCylinder + kCap * (cylinder->caps == Caps::both   ? 2
                               : cylinder->caps == Caps::none ? 0
                                                              : 1);
  if (const auto* cone = std::get_if<geometry::Cone>(&shape))
    return kCone + (cone->caps == Caps::none ? 0 : kCap);
  if (std::holds_alternative<geometry::Disc>(shape)) return kCap;
  if (std::holds_alternative<geometry::Sphere>(shape)) return kSphere;
  EXPECT_TRUE(std::holds_alternative<geometry::Box>(shape));
  return kBox;
}

Count counted(const scene::Scene& scene) {
  Count count;
  const std::vector<Mat4> worlds = scene::world_from_nodes(scene);
  for (const scene::Instance& instance : scene.instances) {
    const geometry::Shape& shape = scene.shapes[static_cast<std::size_t>(instance.shape)];
    const Mat4& world = worlds[static_cast<std::size_t>(instance.node)];
    const auto add = [&](const Vec3& p) {
      const Vec3 at(world * Vec4(p, 1));
      count.low = glm::min(count.low, at);
      count.high = glm::max(count.high, at);
    };
    if (const auto* mesh = std::get_if<geometry::MeshShape>(&shape)) {
      count.triangles += (*mesh)->triangles.size();
      for (const geometry::Triangle& t : (*mesh)->triangles)
        for (const std::uint32_t v : t) add((*mesh)->positions[v]);
      continue;
    }
    count.triangles += coin_triangles(shape);
    if (const auto* box = std::get_if<geometry::Box>(&shape)) {
      for (int i = 0; i < 8; ++i)
        add(box->size * 0.5 * Vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1));
    } else {
      count.exact = false;
    }
  }
  return count;
}

// The largest difference of two bounds, relative to the largest side.
double apart(const Count& ours, const std::string& expected) {
  std::istringstream numbers(expected);
  Vec3 low, high;
  numbers >> low.x >> low.y >> low.z >> high.x >> high.y >> high.z;
  const Vec3 size = high - low;
  double worst = 0;
  for (int i = 0; i < 3; ++i)
    worst = std::max({worst, std::fabs(ours.low[i] - low[i]), std::fabs(ours.high[i] - high[i])});
  return worst / std::max({size.x, size.y, size.z, 1e-30});
}

bool has_place(const Diagnostic& entry) {
  return entry.where.file != kNoFile && entry.severity() != Severity::note;
}

// Text, and surfaces of revolution in a wrong place: others tessellate them too.
bool leaves_out_what_is_tessellated(const Diagnostic& entry) {
  if (entry.code != Code("N6007") && entry.code != Code("W6115")) return false;
  return std::ranges::any_of(
      std::array{"Text", "Cone", "Cylinder", "Sphere"},
      [&](const char* name) { return entry.message.find(name) != std::string::npos; });
}

TEST(VrmlCorpus, IsReadAsOtherReadersReadIt) {
  const fs::path folder = corpus();
  if (!fs::exists(folder / "ORACLE-vrml.tsv")) GTEST_SKIP() << "no files in " << folder;
  std::map<std::string, std::map<std::string, std::string>> reasons;
  for (const Row& row :
       table(fs::path(PANWRIGHT_SOURCE_DIR) / "tests/importers/vrml/differences.tsv"))
    reasons[row[0]][row[1]] = row[2];

  std::size_t comparable = 0,
              equal = 0;  // without surfaces of revolution, where both readers agree
  double worst_bounds = 0;
  for (const Row& row : table(folder / "ORACLE-vrml.tsv")) {
    if (row[0].starts_with("malformed")) continue;
    SCOPED_TRACE(row[0]);
    DiagnosticLog log;
    const auto begin = std::chrono::steady_clock::now();
    const auto imported = import_file(folder / row[0], {}, log);
    const double time = seconds_since(begin);
    EXPECT_LT(time, 5);
    for (const Diagnostic& entry : log.entries())
      EXPECT_TRUE(entry.severity() == Severity::note || has_place(entry)) << entry.message;

    std::set<std::string> differs;
    if ((imported && !log.has_errors()) != (row[4] == "ok")) differs.insert("verdict");
    if (imported) {
      EXPECT_EQ(scene::check(imported->scene), "");
      const Count count = counted(imported->scene);
      const bool counts_known = !row[2].empty();
      const bool left_out = std::ranges::any_of(log.entries(), leaves_out_what_is_tessellated);
      if (counts_known && count.triangles != std::stoull(row[2])) differs.insert("triangles");
      if (counts_known && row[1] == "ok" && row[4] == "ok" && count.exact && !left_out) {
        ++comparable;
        equal += differs.contains("triangles") ? 0 : 1;
      }
      if (!row[3].empty() && count.exact && !differs.contains("triangles")) {
        const double bounds = apart(count, row[3]);
        if (bounds > 1e-5)
          differs.insert("bounds");
        else
          worst_bounds = std::max(worst_bounds, bounds);
      }
    }
    for (const std::string& what : differs)
      EXPECT_TRUE(reasons[row[0]].erase(what) == 1) << what << " differs without a reason";
  }
  for (const auto& [path, left] : reasons)
    for (const auto& [what, why] : left)
      ADD_FAILURE() << path << ": " << what << " does not differ, and yet: " << why;
  EXPECT_GE(static_cast<double>(equal), 0.99 * static_cast<double>(comparable));
  EXPECT_GT(comparable, 100u);
  RecordProperty("comparable", static_cast<int>(comparable));
  RecordProperty("equal", static_cast<int>(equal));
  std::cout << equal << " of " << comparable << " counts equal, bounds to " << worst_bounds << "\n";
}

TEST(VrmlCorpus, WhatIsMalformedIsSaidWithItsPlace) {
  const fs::path folder = corpus() / "malformed";
  if (!fs::exists(folder)) GTEST_SKIP() << "no files in " << folder;
  std::size_t files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string path = fs::relative(entry.path(), folder).generic_string();
    if (!entry.is_regular_file() || !path.starts_with("vrml-")) continue;
    SCOPED_TRACE(path);
    ++files;
    DiagnosticLog log;
    const auto imported = import_file(entry.path(), {}, log);
    if (imported) {
      EXPECT_EQ(scene::check(imported->scene), "");
    }
    EXPECT_TRUE(std::ranges::any_of(log.entries(), has_place));
  }
  EXPECT_GT(files, 9u);
}

}  // namespace
}  // namespace panwright::importers::vrml_corpus_test
