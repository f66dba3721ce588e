// Flat faces and the coordinates along their edges, against rectangles in closed form.
#include "geometry/mesh/flat_faces.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>

#include "shapes.h"

namespace panwright::geometry::flat_faces_test {
namespace {

struct Turn {
  Mat3 matrix;
  Vec3 shift;
  Vec3 operator()(const Vec3& p) const { return matrix * p + shift; }
};

Turn random_turn(shapes::Random& random) {
  const Vec3 z = random.direction();
  const Vec3 x = glm::normalize(glm::cross(z, random.direction()));
  return {{x, glm::cross(z, x), z}, 10.0 * random.direction()};
}

// Cells of a grid that are in, each two triangles, with inner points moved about; in the plane.
struct Sheet {
  std::vector<Vec2> at;
  std::vector<Triangle> triangles;
};
Sheet sheet(Vec2 size, std::uint32_t columns, std::uint32_t rows, shapes::Random& random,
            const std::function<bool(std::uint32_t, std::uint32_t)>& in = {}) {
  Sheet out;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> known;
  const bool moves = !in;
  const auto vertex = [&](std::uint32_t i, std::uint32_t j) {
    const auto [place, added] = known.emplace(std::pair(i, j), out.at.size());
    if (added) {
      Vec2 p(i, j);
      if (moves && i > 0 && j > 0 && i < columns && j < rows)
        p += 0.3 * Vec2(random.between(-1, 1), random.between(-1, 1));
      out.at.push_back(p / Vec2(columns, rows) * size);
    }
    return place->second;
  };
  for (std::uint32_t j = 0; j < rows; ++j)
    for (std::uint32_t i = 0; i < columns; ++i) {
      if (in && !in(i, j)) continue;
      const std::uint32_t a = vertex(i, j), b = vertex(i + 1, j), c = vertex(i + 1, j + 1),
                          d = vertex(i, j + 1);
      if (random() < 0.5) {
        out.triangles.push_back({a, b, c});
        out.triangles.push_back({a, c, d});
      } else {
        out.triangles.push_back({a, b, d});
        out.triangles.push_back({b, c, d});
      }
    }
  return out;
}

std::vector<Vec3> placed(const Sheet& sheet, const Turn& turn) {
  std::vector<Vec3> out;
  for (const Vec2& p : sheet.at) out.push_back(turn(Vec3(p, 0)));
  return out;
}

std::vector<Vec2> mapped(const Sheet& sheet, const glm::dmat2& map, Vec2 shift = Vec2(0)) {
  std::vector<Vec2> out;
  for (const Vec2& p : sheet.at) out.push_back(map * p + shift);
  return out;
}

Vec2 coordinates(const FlatFace& face, const Vec3& p) {
  return Vec2(glm::dot(face.u, p), glm::dot(face.v, p)) + face.origin;
}

// The layout of the only face.
FaceLayout layout(const Sheet& sheet, const std::vector<Vec2>& texcoords, const Turn& turn) {
  const FlatFaces found = flat_faces(placed(sheet, turn), texcoords, sheet.triangles);
  EXPECT_EQ(found.faces.size(), 1u);
  return found.faces.empty() ? FaceLayout::none : found.faces[0].layout;
}

glm::dmat2 columns(double a, double b, double c, double d) { return {Vec2(a, b), Vec2(c, d)}; }

TEST(FlatFaces, RectanglesHaveMetresFromACorner) {
  shapes::Random random(1);
  for (int i = 0; i < 200; ++i) {
    const Vec2 size(random.between(0.01, 5), random.between(0.01, 5));
    const Sheet s = sheet(size, 1 + i % 7, 1 + i % 5, random);
    const Turn turn = random_turn(random);
    const std::vector<Vec3> positions = placed(s, turn);
    // without texture coordinates, with sheared ones, with ones that are all equal, with NaN
    std::vector<Vec2> texcoords;
    if (i % 4 == 1) texcoords = mapped(s, columns(1, 0, 0.3, 1));
    if (i % 4 == 2) texcoords.assign(s.at.size(), Vec2(0.5));
    if (i % 4 == 3) texcoords.assign(s.at.size(), Vec2(std::nan("")));
    const FlatFaces found = flat_faces(positions, texcoords, s.triangles);
    ASSERT_EQ(found.faces.size(), 1u);
    const FlatFace& face = found.faces[0];
    ASSERT_EQ(face.layout, FaceLayout::rectangle) << i;
    EXPECT_NEAR(face.area, size.x * size.y, 1e-12);
    Vec2 low(HUGE_VAL), high(-HUGE_VAL);
    for (std::size_t v = 0; v < positions.size(); ++v) {
      const Vec2 at = coordinates(face, positions[v]);
      low = glm::min(low, at);
      high = glm::max(high, at);
      // distances are those of the plane: no shear, no stretch
      EXPECT_NEAR(glm::length(at - coordinates(face, positions[0])), glm::length(s.at[v] - s.at[0]),
                  1e-13);  // largest 4.5e-15, as those below
    }
    const double longer = std::max(size.x, size.y), shorter = std::min(size.x, size.y);
    if (longer < 1.01 * shorter) continue;
    EXPECT_NEAR(glm::length(low), 0, 1e-13);
    EXPECT_NEAR(glm::length(high - Vec2(longer, shorter)), 0, 1e-13);
    // right-handed from outside
    EXPECT_NEAR(glm::dot(glm::cross(face.u, face.v), turn.matrix[2]), 1, 1e-13);
  }
}

TEST(FlatFaces, UnshearedCoordinatesAlongTheEdgesStay) {
  shapes::Random random(2);
  for (int i = 0; i < 100; ++i) {
    const Sheet s = sheet(Vec2(3, 1), 6, 3, random);
    const Turn turn = random_turn(random);
    const double k = random.between(0.1, 20);
    const Vec2 shift(random.between(-3, 3), random.between(-3, 3));
    // quarter turns, mirrored or not
    const glm::dmat2 maps[] = {columns(k, 0, 0, k), columns(0, k, -k, 0), columns(-k, 0, 0, k),
                               columns(0, k, k, 0)};
    const std::vector<Vec2> texcoords = mapped(s, maps[i % 4], shift);
    const std::vector<Vec3> positions = placed(s, turn);
    const FlatFaces found = flat_faces(positions, texcoords, s.triangles);
    ASSERT_EQ(found.faces.size(), 1u);
    ASSERT_EQ(found.faces[0].layout, FaceLayout::file) << i;
    // in metres; largest difference 4.5e-15
    for (std::size_t v = 0; v < positions.size(); ++v)
      EXPECT_NEAR(glm::length(coordinates(found.faces[0], positions[v]) - texcoords[v] / k), 0,
                  1e-12);
  }
}

TEST(FlatFaces, ToleratesAPercentOfStretchAndADegree) {
  shapes::Random random(3);
  const Sheet s = sheet(Vec2(3, 1), 4, 2, random);
  const Turn turn = random_turn(random);
  const auto with = [&](const glm::dmat2& map) { return layout(s, mapped(s, map), turn); };
  const auto turned = [](double degrees) {
    const double a = degrees * kDegree;
    return columns(std::cos(a), std::sin(a), -std::sin(a), std::cos(a));
  };
  EXPECT_EQ(with(columns(1, 0, 0, 1.009)), FaceLayout::file);
  EXPECT_EQ(with(columns(1, 0, 0, 1.011)), FaceLayout::rectangle);
  EXPECT_EQ(with(columns(1, 0, 0.009, 1)), FaceLayout::file);
  EXPECT_EQ(with(columns(1, 0, 0.011, 1)), FaceLayout::rectangle);
  EXPECT_EQ(with(turned(0.99)), FaceLayout::file);
  EXPECT_EQ(with(turned(1.01)), FaceLayout::rectangle);
  EXPECT_EQ(with(turned(90.5)), FaceLayout::file);
  EXPECT_EQ(with(turned(30)), FaceLayout::rectangle);
  // one vertex of the map elsewhere: 4 % of √area
  std::vector<Vec2> bent = mapped(s, columns(1, 0, 0, 1));
  bent[0].x += 0.07;
  EXPECT_EQ(layout(s, bent, turn), FaceLayout::rectangle);
}

TEST(FlatFaces, OtherOutlinesNeedTheFilesCoordinates) {
  shapes::Random random(4);
  const auto l_shape = [](std::uint32_t i, std::uint32_t j) { return i < 2 || j < 2; };
  const auto ring = [](std::uint32_t i, std::uint32_t j) { return i != 2 || j != 2; };
  for (int i = 0; i < 50; ++i) {
    const Turn turn = random_turn(random);
    for (const auto& in : {std::function<bool(std::uint32_t, std::uint32_t)>(l_shape),
                           std::function<bool(std::uint32_t, std::uint32_t)>(ring)}) {
      const Sheet s = sheet(Vec2(2, 1), 6, 6, random, in);
      EXPECT_EQ(layout(s, {}, turn), FaceLayout::none);
      EXPECT_EQ(layout(s, mapped(s, columns(1, 0, 0.3, 1)), turn), FaceLayout::none);
      EXPECT_EQ(layout(s, mapped(s, columns(2, 0, 0, 2)), turn), FaceLayout::file);
    }
    Sheet slanted = sheet(Vec2(2, 1), 3, 3, random);
    for (Vec2& p : slanted.at) p.x += 0.03 * p.y;
    EXPECT_EQ(layout(slanted, {}, turn), FaceLayout::none);
    Sheet disc;
    for (int k = 0; k < 48; ++k)
      disc.at.push_back({std::cos(k * kPi / 24), std::sin(k * kPi / 24)});
    for (std::uint32_t k = 1; k + 1 < 48; ++k) disc.triangles.push_back({0, k, k + 1});
    EXPECT_EQ(layout(disc, {}, turn), FaceLayout::none);
    // a triangle fills half of its bounds
    EXPECT_EQ(layout({{{0, 0}, {2, 0}, {0, 1}}, {{0, 1, 2}}}, {}, turn), FaceLayout::none);
    EXPECT_EQ(layout({{{0, 0}, {2, 0}, {1.5, 1}, {0.5, 1}}, {{0, 1, 2}, {0, 2, 3}}}, {}, turn),
              FaceLayout::none);
  }
}

TEST(FlatFaces, ACubeHasSixAndASheetOfTwoSidesTwo) {
  const Mesh cube = shapes::cube();
  const FlatFaces found = flat_faces(cube.positions, {}, cube.triangles);
  ASSERT_EQ(found.faces.size(), 6u);
  for (const FlatFace& face : found.faces) {
    EXPECT_EQ(face.layout, FaceLayout::rectangle);
    EXPECT_EQ(face.area, 4);
  }
  const std::vector<Vec3> square = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const std::vector<Triangle> both = {{0, 1, 2}, {0, 2, 3}, {2, 1, 0}, {3, 2, 0}};
  const FlatFaces sides = flat_faces(square, {}, both);
  ASSERT_EQ(sides.faces.size(), 2u);
  EXPECT_EQ(sides.faces[0].layout, FaceLayout::rectangle);
  EXPECT_EQ(sides.faces[1].layout, FaceLayout::rectangle);
  // of a square, u is the side nearer to x
  EXPECT_EQ(sides.faces[0].u, Vec3(1, 0, 0));
}

TEST(FlatFaces, CurvedSurfacesStayApart) {
  const Mesh ball = shapes::sphere(180, 360);
  const FlatFaces found = flat_faces(ball.positions, {}, ball.triangles);
  std::vector<Vec3> first(found.faces.size());
  for (std::size_t t = 0; t < ball.triangles.size(); ++t) {
    const auto [a, b, c] = ball.triangles[t];
    const Vec3 n = glm::normalize(
        glm::cross(ball.positions[b] - ball.positions[a], ball.positions[c] - ball.positions[a]));
    Vec3& other = first[found.face_of[t]];
    if (other == Vec3(0)) other = n;
    // two triangles of a face are within a degree of a third
    ASSERT_GE(glm::dot(other, n), std::cos(2.001 * kDegree));
  }
}

// Every triangle has the edge 0, 1: pairs of them are not compared.
TEST(FlatFaces, ManyTrianglesAtOneEdgeStayFast) {
  std::vector<Vec3> positions = {{0, 0, 0}, {1, 0, 0}};
  std::vector<Triangle> triangles;
  for (std::uint32_t i = 0; i < 200000; ++i) {
    positions.push_back({0.5, 1 + i * 1e-5, 0});
    triangles.push_back({0, 1, i + 2});
  }
  triangles.push_back({0, 0, 1});  // without area
  const FlatFaces found = flat_faces(positions, {}, triangles);
  EXPECT_EQ(found.faces.size(), 200000u);
  EXPECT_EQ(found.face_of.back(), kNoFace);
  EXPECT_TRUE(flat_faces({}, {}, {}).faces.empty());
}

}  // namespace
}  // namespace panwright::geometry::flat_faces_test
