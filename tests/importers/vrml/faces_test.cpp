#include "importers/vrml/internal/faces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/mesh/check.h"

namespace panwright::importers::vrml::faces_test {
namespace {

using geometry::Mesh;
using geometry::MeshReport;

using Numbers = std::vector<double>;
using Index = std::vector<std::int32_t>;

// The unit cube, its faces counter-clockwise from outside.
const Numbers kCubePoints{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1};
const Index kCubeIndex{0, 3, 2, 1, -1, 4, 5, 6, 7, -1, 0, 1, 5, 4, -1,
                       1, 2, 6, 5, -1, 2, 3, 7, 6, -1, 3, 0, 4, 7};
// outwards, in order of the faces
const Numbers kCubeNormals{0, 0, -1, 0, 0, 1, 0, -1, 0, 1, 0, 0, 0, 1, 0, -1, 0, 0};

FaceSet cube() {
  FaceSet set;
  set.points = kCubePoints;
  set.coord_index = kCubeIndex;
  return set;
}

struct Made {
  Mesh mesh;
  ListProblems problems;
};

template <class Set>
Made made(const Set& set, const FaceOptions& options = {}) {
  Made out;
  out.mesh = mesh_of(set, options, out.problems);
  const Mesh& m = out.mesh;
  EXPECT_TRUE(m.triangles.empty() || m.normals.size() == m.positions.size());
  const MeshReport report = check(m);
  EXPECT_EQ(report.bad_lengths, 0u);
  EXPECT_EQ(report.bad_indices, 0u);
  EXPECT_EQ(report.non_finite, 0u);
  EXPECT_EQ(report.bad_normals, 0u);
  return out;
}

Vec3 facet_normal(const Mesh& mesh, std::size_t t) {
  const auto& [a, b, c] = mesh.triangles[t];
  return glm::normalize(
      glm::cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]));
}

TEST(Faces, ACubeOfQuadrilaterals) {
  const Made cube_made = made(cube());
  EXPECT_TRUE(cube_made.problems.empty());
  const MeshReport report = check(cube_made.mesh);
  EXPECT_EQ(cube_made.mesh.triangles.size(), 12u);
  EXPECT_EQ(cube_made.mesh.positions.size(), 24u);  // crease angle 0
  EXPECT_TRUE(report.closed);
  EXPECT_DOUBLE_EQ(report.volume, 1);
  for (std::size_t t = 0; t < 12; ++t)
    for (const std::uint32_t v : cube_made.mesh.triangles[t])
      EXPECT_EQ(cube_made.mesh.normals[v], facet_normal(cube_made.mesh, t));
}

TEST(Faces, TheCreaseAngleIsTheNodesOrElseTheCallers) {
  FaceSet set = cube();
  EXPECT_EQ(made(set, {.crease_angle = 2}).mesh.positions.size(), 8u);
  set.crease_angle = 0;
  EXPECT_EQ(made(set, {.crease_angle = 2}).mesh.positions.size(), 24u);
  set.crease_angle = 2;
  EXPECT_EQ(made(set).mesh.positions.size(), 8u);
}

TEST(Faces, ClockwiseFacesAreTurnedRound) {
  FaceSet set = cube();
  set.ccw = false;
  EXPECT_DOUBLE_EQ(check(made(set).mesh).volume, -1);
}

TEST(Faces, PointsThatNoFaceUsesAreNotThere) {
  FaceSet set;
  const Numbers points{9, 9, 9, 0, 0, 0, 8, 8, 8, 1, 0, 0, 0, 1, 0};
  const Index index{3, 4, 1, -1, -1, 1, 3, 4};
  set.points = points;
  set.coord_index = index;
  set.crease_angle = 1;
  const Made two = made(set);
  ASSERT_EQ(two.mesh.positions.size(), 3u);
  EXPECT_EQ(two.mesh.positions[0], Vec3(1, 0, 0));  // order of first use
  EXPECT_EQ(two.mesh.triangles.size(), 2u);
  EXPECT_TRUE(two.problems.empty());
}

TEST(Faces, NormalsForEachFace) {
  FaceSet set = cube();
  set.normals = kCubeNormals;
  set.normal_per_vertex = false;
  const Made by_order = made(set);
  EXPECT_EQ(by_order.mesh.positions.size(), 24u);
  for (std::size_t t = 0; t < 12; ++t)
    for (const std::uint32_t v : by_order.mesh.triangles[t])
      EXPECT_EQ(by_order.mesh.normals[v], facet_normal(by_order.mesh, t));

  // the same normals in another order
  const Numbers reversed{-1, 0, 0, 0, 1, 0, 1, 0, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1};
  const Index index{5, 4, 3, 2, 1, 0};
  set.normals = reversed;
  set.normal_index = index;
  EXPECT_EQ(made(set).mesh.normals, by_order.mesh.normals);
}

TEST(Faces, NormalsForEachCornerAreMadeUnitLength) {
  FaceSet set = cube();
  Numbers normals;
  for (const double x : kCubePoints) normals.push_back(100 * (x - 0.5));
  set.normals = normals;
  const Made by_point = made(set);
  ASSERT_EQ(by_point.mesh.positions.size(), 8u);
  for (std::size_t v = 0; v < 8; ++v)
    EXPECT_LT(glm::length(by_point.mesh.normals[v] -
                          glm::normalize(by_point.mesh.positions[v] - Vec3(0.5))),
              3e-16);
  // an index that says the same as coordIndex changes nothing
  set.normal_index = kCubeIndex;
  EXPECT_EQ(made(set).mesh.triangles, by_point.mesh.triangles);
}

TEST(Faces, AnIndexOfItsOwnForEachCorner) {
  FaceSet set = cube();
  set.normals = kCubeNormals;
  const Index index{0, 0, 0, 0, -1, 1, 1, 1, 1, -1, 2, 2, 2, 2, -1,
                    3, 3, 3, 3, -1, 4, 4, 4, 4, -1, 5, 5, 5, 5, -1};
  set.normal_index = index;
  const Made boxed = made(set);
  EXPECT_TRUE(boxed.problems.empty());
  EXPECT_EQ(boxed.mesh.positions.size(), 24u);
  for (std::size_t t = 0; t < 12; ++t)
    for (const std::uint32_t v : boxed.mesh.triangles[t])
      EXPECT_EQ(boxed.mesh.normals[v], facet_normal(boxed.mesh, t));
}

TEST(Faces, OneVertexForEachTuple) {
  // two triangles over one edge: colours by face, texcoords by corner, the same on the edge
  const Numbers points{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  const Index index{0, 1, 2, -1, 0, 2, 3, -1};
  const Numbers colors{1, 0, 0, 0, 1, 0};
  const Numbers texcoords{0, 0, 0.5, 0.25, 1, 1};
  const Index texcoord_index{0, 1, 2, -1, 0, 2, 1, -1};
  FaceSet set;
  set.points = points;
  set.coord_index = index;
  set.crease_angle = 1;
  set.texcoords = texcoords;
  set.texcoord_index = texcoord_index;
  EXPECT_EQ(made(set).mesh.positions.size(), 4u);
  set.colors = colors;
  set.color_per_vertex = false;
  const Mesh mesh = made(set).mesh;
  ASSERT_EQ(mesh.positions.size(), 6u);
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(mesh.colors[mesh.triangles[0][k]], Vec3(1, 0, 0));
    EXPECT_EQ(mesh.colors[mesh.triangles[1][k]], Vec3(0, 1, 0));
  }
  EXPECT_EQ(mesh.texcoords[mesh.triangles[1][2]], Vec2(0.5, 0.25));
  const Index swapped{1, 0};
  set.color_index = swapped;
  EXPECT_EQ(made(set).mesh.colors[0], Vec3(0, 1, 0));
}

TEST(Faces, ColoursStayBetweenZeroAndOne) {
  FaceSet set = cube();
  Numbers colors(24, 0.25);
  colors[0] = -3;
  colors[4] = 7;
  set.colors = colors;
  for (const Vec3& c : made(set).mesh.colors)
    EXPECT_TRUE(glm::min(c.x, c.y) >= 0 && glm::max(c.x, c.y) <= 1 && c.z == 0.25);
}

TEST(Faces, FacesThatNameWhatIsNotThereAreLeftOut) {
  FaceSet set = cube();
  Index index = kCubeIndex;
  index[1] = 8;
  index[7] = 2147483647;
  set.coord_index = index;
  const Made rest = made(set);
  EXPECT_EQ(rest.mesh.triangles.size(), 8u);
  ASSERT_EQ(rest.problems.size(), 1u);
  EXPECT_EQ(rest.problems[0].code, Code("E6113"));
  EXPECT_EQ(rest.problems[0].list, List::coord_index);
  EXPECT_EQ(rest.problems[0].item, 1u);
  EXPECT_NE(rest.problems[0].message.find("1 more"), std::string::npos);
}

TEST(Faces, PerFaceListsCountFacesThatAreLeftOut) {
  FaceSet set = cube();
  Index index = kCubeIndex;
  index[1] = 8;
  set.coord_index = index;
  set.normals = kCubeNormals;
  set.normal_per_vertex = false;
  const Mesh mesh = made(set).mesh;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    EXPECT_EQ(mesh.normals[mesh.triangles[t][0]], facet_normal(mesh, t));
}

TEST(Faces, PointsWithoutEndAreNotUsed) {
  for (const double bad :
       {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN(), -1e31}) {
    FaceSet set = cube();
    Numbers points = kCubePoints;
    points[4] = bad;
    set.points = points;
    const Made rest = made(set);
    EXPECT_EQ(rest.mesh.triangles.size(), 6u);  // three faces meet there
    ASSERT_EQ(rest.problems.size(), 1u);
    EXPECT_EQ(rest.problems[0].code, Code("E6107"));
    EXPECT_EQ(rest.problems[0].list, List::points);
    EXPECT_EQ(rest.problems[0].item, 1u);
  }
}

TEST(Faces, CoordinatesAtTheLimitMakeNoNonsense) {
  FaceSet set = cube();
  Numbers points = kCubePoints;
  for (double& x : points) x = (x - 0.5) * 2e30;
  set.points = points;
  EXPECT_EQ(made(set).mesh.triangles.size(), 12u);
  for (double& x : points) x *= 1e-300;
  set.points = points;
  EXPECT_EQ(made(set).mesh.triangles.size(), 12u);
}

TEST(Faces, ListsOfNormalsThatCannotBeAreComputedAnew) {
  const Mesh expected = made(cube()).mesh;
  FaceSet set = cube();
  set.normals = std::span(kCubeNormals).first(15);
  set.normal_per_vertex = false;
  Made too_short = made(set);
  EXPECT_EQ(too_short.mesh.normals, expected.normals);
  ASSERT_EQ(too_short.problems.size(), 1u);
  EXPECT_EQ(too_short.problems[0].code, Code("W6114"));
  EXPECT_EQ(too_short.problems[0].list, List::normals);

  set.normals = kCubeNormals;
  Index index{0, 1, 2, 3, 4, 6};
  set.normal_index = index;
  Made past_end = made(set);
  EXPECT_EQ(past_end.mesh.normals, expected.normals);
  ASSERT_EQ(past_end.problems.size(), 1u);
  EXPECT_EQ(past_end.problems[0].code, Code("E6113"));
  EXPECT_EQ(past_end.problems[0].list, List::normal_index);
  EXPECT_EQ(past_end.problems[0].item, 5u);

  // one per face where one per corner is promised
  set.normal_per_vertex = true;
  index[5] = 5;
  Made short_index = made(set);
  EXPECT_EQ(short_index.mesh.normals, expected.normals);
  ASSERT_EQ(short_index.problems.size(), 1u);
  EXPECT_EQ(short_index.problems[0].code, Code("W6114"));
  EXPECT_EQ(short_index.problems[0].list, List::normal_index);
}

TEST(Faces, AnIndexThatEndsFacesElsewhereIsNotUsed) {
  FaceSet set = cube();
  Index index = kCubeIndex;
  std::rotate(index.begin(), index.begin() + 1, index.end());
  const Numbers texcoords(16, 0.5);
  set.texcoords = texcoords;
  set.texcoord_index = index;
  const Made plain = made(set);
  EXPECT_TRUE(plain.mesh.texcoords.empty());
  ASSERT_EQ(plain.problems.size(), 1u);
  EXPECT_EQ(plain.problems[0].code, Code("W6114"));
  EXPECT_EQ(plain.problems[0].list, List::texcoord_index);
  EXPECT_EQ(plain.problems[0].item, 3u);
}

TEST(Faces, NumbersThatAreNotFiniteDropTheirList) {
  FaceSet set = cube();
  Numbers colors(24, 0.5);
  colors[7] = std::numeric_limits<double>::quiet_NaN();
  set.colors = colors;
  const Made plain = made(set);
  EXPECT_TRUE(plain.mesh.colors.empty());
  ASSERT_EQ(plain.problems.size(), 1u);
  EXPECT_EQ(plain.problems[0].code, Code("E6107"));
  EXPECT_EQ(plain.problems[0].item, 2u);
}

TEST(Faces, NormalsWithoutLengthTakeThoseOfTheirFaces) {
  FaceSet set = cube();
  Numbers normals = kCubeNormals;
  std::fill(normals.begin() + 9, normals.begin() + 12, 0);
  set.normals = normals;
  set.normal_per_vertex = false;
  const Made whole = made(set);
  EXPECT_EQ(whole.mesh.normals, made(cube()).mesh.normals);
  ASSERT_EQ(whole.problems.size(), 1u);
  EXPECT_EQ(whole.problems[0].code, Code("W6114"));
  EXPECT_EQ(whole.problems[0].item, 3u);

  // tiny and huge ones have a direction all the same
  for (const double scale : {1e-310, 1e-200, 1e200, 1.7e308}) {
    for (std::size_t i = 0; i < normals.size(); ++i) normals[i] = kCubeNormals[i] * scale;
    const Made scaled = made(set);
    EXPECT_EQ(scaled.mesh.normals, whole.mesh.normals);
    EXPECT_TRUE(scaled.problems.empty());
  }
}

TEST(Faces, ShortFacesAreLeftOutAndSaid) {
  FaceSet set = cube();
  Index index{0, 1, -1, 5, -1, -1};
  index.insert(index.end(), kCubeIndex.begin(), kCubeIndex.end());
  set.coord_index = index;
  const Made rest = made(set);
  EXPECT_EQ(rest.mesh.triangles.size(), 12u);
  ASSERT_EQ(rest.problems.size(), 1u);
  EXPECT_EQ(rest.problems[0].code, Code("W6114"));
  EXPECT_EQ(rest.problems[0].item, 0u);
}

TEST(Faces, TooManyTriangles) {
  const Made none = made(cube(), {.max_triangles = 11});
  EXPECT_TRUE(none.mesh.triangles.empty());
  ASSERT_EQ(none.problems.size(), 1u);
  EXPECT_EQ(none.problems[0].code, Code("E6002"));
  EXPECT_EQ(made(cube(), {.max_triangles = 12}).mesh.triangles.size(), 12u);
}

TEST(Faces, TextureCoordinatesByTheStandardsDefault) {
  // bounds 2 × 4 × 3: s along y, t along z
  FaceSet set = cube();
  Numbers points = kCubePoints;
  for (std::size_t i = 0; i < points.size(); i += 3) {
    points[i] = 10 + 2 * points[i];
    points[i + 1] *= 4;
    points[i + 2] *= 3;
  }
  set.points = points;
  set.crease_angle = 2;
  EXPECT_TRUE(made(set).mesh.texcoords.empty());
  const Mesh mesh = made(set, {.texcoords = true}).mesh;
  ASSERT_EQ(mesh.texcoords.size(), 8u);
  for (std::size_t v = 0; v < 8; ++v)
    EXPECT_EQ(mesh.texcoords[v], Vec2(mesh.positions[v].y / 4, mesh.positions[v].z / 4));
}

TEST(Faces, ConcaveFacesAreCutRightWhateverTheFileSays) {
  // an L of area 3, with convex TRUE
  const Numbers points{0, 0, 0, 2, 0, 0, 2, 1, 0, 1, 1, 0, 1, 2, 0, 0, 2, 0};
  const Index index{0, 1, 2, 3, 4, 5, -1};
  FaceSet set;
  set.points = points;
  set.coord_index = index;
  const Mesh mesh = made(set).mesh;
  EXPECT_EQ(mesh.triangles.size(), 4u);
  EXPECT_DOUBLE_EQ(check(mesh).area, 3);
  for (std::size_t t = 0; t < 4; ++t) EXPECT_EQ(facet_normal(mesh, t), Vec3(0, 0, 1));
}

TEST(Faces, ManyTuplesOfOnePointTakeNoTimeWithoutEnd) {
  // each corner of 100,000 triangles at one of three points, with a normal of its own
  const Numbers points{0, 0, 0, 1, 0, 0, 0, 1, 0};
  Index index, normal_index;
  Numbers normals;
  for (std::int32_t i = 0; i < 300'000; ++i) {
    index.push_back(i % 3);
    normal_index.push_back(i);
    normals.insert(normals.end(), {1, 0, i * 1e-5});
    if (i % 3 < 2) continue;
    index.push_back(-1);
    normal_index.push_back(-1);
  }
  FaceSet set;
  set.points = points;
  set.coord_index = index;
  set.normals = normals;
  set.normal_index = normal_index;
  EXPECT_EQ(made(set).mesh.positions.size(), 300'000u);
}

TEST(Faces, NothingGivesNothing) {
  EXPECT_TRUE(made(FaceSet{}).mesh.positions.empty());
  FaceSet set = cube();
  set.coord_index = {};
  EXPECT_TRUE(made(set).mesh.positions.empty());
  set = cube();
  set.points = {};
  const Made none = made(set);
  EXPECT_TRUE(none.mesh.positions.empty());
  ASSERT_EQ(none.problems.size(), 1u);
  EXPECT_EQ(none.problems[0].code, Code("E6113"));
}

// ---- grids

TEST(Grids, LookUpAndAreRight) {
  // heights of a plane: every facet has its normal
  const std::int32_t nx = 5, nz = 4;
  Numbers heights;
  for (int j = 0; j < nz; ++j)
    for (int i = 0; i < nx; ++i) heights.push_back(0.5 * (2.0 * i) - 0.25 * (3.0 * j));
  ElevationGrid grid;
  grid.x_dimension = nx;
  grid.z_dimension = nz;
  grid.x_spacing = 2;
  grid.z_spacing = 3;
  grid.heights = heights;
  const Mesh mesh = made(grid).mesh;
  EXPECT_EQ(mesh.triangles.size(), 2u * 4 * 3);
  const Vec3 normal = glm::normalize(Vec3(-0.5, 1, 0.25));
  for (const Vec3& n : mesh.normals) EXPECT_LT(glm::length(n - normal), 3e-16);
  EXPECT_NEAR(check(mesh).area, 8 * 9 / normal.y, 1e-13);
  grid.ccw = false;
  for (const Vec3& n : made(grid).mesh.normals) EXPECT_LT(n.y, 0);
}

TEST(Grids, ColoursAndNormalsOfQuadrilateralsOrPoints) {
  const Numbers heights(6, 0);  // 3 × 2 points, 2 quadrilaterals
  const Numbers two{1, 0, 0, 0, 0, 1};
  const Numbers six{0, 0, 0, 0.1, 0, 0, 0.2, 0, 0, 0.3, 0, 0, 0.4, 0, 0, 0.5, 0, 0};
  ElevationGrid grid;
  grid.x_dimension = 3;
  grid.z_dimension = 2;
  grid.heights = heights;
  grid.colors = two;
  grid.color_per_vertex = false;
  const Mesh by_face = made(grid).mesh;
  EXPECT_EQ(by_face.positions.size(), 8u);
  for (std::size_t t = 0; t < 4; ++t)
    EXPECT_EQ(by_face.colors[by_face.triangles[t][0]], t < 2 ? Vec3(1, 0, 0) : Vec3(0, 0, 1));
  grid.colors = six;
  grid.color_per_vertex = true;
  const Mesh by_point = made(grid).mesh;
  ASSERT_EQ(by_point.positions.size(), 6u);
  for (std::size_t v = 0; v < 6; ++v)
    EXPECT_NEAR(by_point.colors[v].x, 0.1 * (by_point.positions[v].x + 3 * by_point.positions[v].z),
                1e-15);
}

TEST(Grids, TextureFromZeroToOne) {
  const Numbers heights(6, 0);
  ElevationGrid grid;
  grid.x_dimension = 3;
  grid.z_dimension = 2;
  grid.x_spacing = 7;
  grid.heights = heights;
  const Mesh mesh = made(grid, {.texcoords = true}).mesh;
  ASSERT_EQ(mesh.texcoords.size(), 6u);
  for (std::size_t v = 0; v < 6; ++v)
    EXPECT_EQ(mesh.texcoords[v], Vec2(mesh.positions[v].x / 14, mesh.positions[v].z));
}

TEST(Grids, OneRowOrColumnHasNoSurface) {
  const Numbers heights(30, 1);
  for (const auto& [x, z] : std::vector<std::pair<int, int>>{
           {1, 30}, {30, 1}, {1, 1}, {0, 0}, {-5, 30}, {30, -2147483647 - 1}}) {
    ElevationGrid grid;
    grid.x_dimension = x;
    grid.z_dimension = z;
    grid.heights = heights;
    const Made none = made(grid);
    EXPECT_TRUE(none.mesh.triangles.empty());
    ASSERT_EQ(none.problems.size(), 1u);
    EXPECT_EQ(none.problems[0].code, Code("W6114"));
  }
}

TEST(Grids, WholeRowsOfTooFewHeights) {
  const Numbers heights(14, 0);
  ElevationGrid grid;
  grid.x_dimension = 4;
  grid.z_dimension = 1'000'000'000;
  grid.heights = heights;
  const Made rows = made(grid);
  EXPECT_EQ(rows.mesh.triangles.size(), 2u * 3 * 2);
  ASSERT_EQ(rows.problems.size(), 1u);
  EXPECT_EQ(rows.problems[0].list, List::heights);
  grid.x_dimension = 2'000'000'000;
  EXPECT_TRUE(made(grid).mesh.triangles.empty());
}

}  // namespace
}  // namespace panwright::importers::vrml::faces_test
