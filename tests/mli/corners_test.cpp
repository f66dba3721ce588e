// Inner corners: what a place follows from.

#include "mli/corners.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace panwright::mli::corners_test {
namespace {

using Face = std::array<Vec3, 3>;

// Numbers in [0, 1) from a generator.
double share(std::mt19937& random) { return random() / 4294967296.0; }

Vec3 point(std::mt19937& random, const Vec3& low, const Vec3& size) {
  const double x = share(random), y = share(random);
  return low + size * Vec3(x, y, share(random));
}

std::vector<Face> faces(std::mt19937& random, std::size_t count, const Vec3& low, double size) {
  std::vector<Face> out(count);
  for (Face& face : out)
    for (Vec3& p : face) p = point(random, low, Vec3(size));
  return out;
}

// Some faces of owner 0, all others of owner 1.
Corners corners(const std::vector<std::vector<Face>>& of) {
  Corners out;
  for (std::size_t k = 0; k < of.size(); ++k)
    for (const Face& face : of[k]) out.add(face[0], face[1], face[2], k == 0 ? 0 : 1);
  out.build();
  return out;
}

Hash128 key_of(const Corners& corners, const std::vector<AxisBox>& boxes, bool expected) {
  KeyHasher key;
  EXPECT_EQ(corners.add_near(0, boxes, key), expected);
  return key.key();
}

// Far faces change the tree, and neither a bit of what is near nor its key.
TEST(Corners, FarFacesChangeNothing) {
  std::mt19937 random(7);
  const std::vector<Face> own = faces(random, 20, Vec3(0), 1), near = faces(random, 60, Vec3(0), 1);
  const std::vector<Face> far = faces(random, 500, Vec3(0, 0, 8), 3);
  const Corners alone = corners({own, near}), among = corners({own, far, near});
  std::size_t lower = 0;
  for (int k = 0; k < 20'000; ++k) {
    const Vec3 from = point(random, Vec3(0), Vec3(1));
    const Vec3 along = glm::normalize(point(random, Vec3(-1), Vec3(2)));
    const double free = alone.room(0, from, along, 0.5);
    EXPECT_EQ(among.room(0, from, along, 0.5), free);
    lower += free < 0.5 && free > 0;
    const Vec3 to = point(random, Vec3(0), Vec3(1));
    EXPECT_EQ(among.crossed(0, from, to, 1e-3), alone.crossed(0, from, to, 1e-3));
  }
  EXPECT_GT(lower, 1000u);
  AxisBox box;
  box.add(Vec3(-1));
  box.add(Vec3(2));
  EXPECT_EQ(key_of(among, {box}, true), key_of(alone, {box}, true));
}

TEST(Corners, KeysHoldWhatIsNear) {
  std::mt19937 random(8);
  const std::vector<Face> own = faces(random, 20, Vec3(0), 1);
  std::vector<Face> others = faces(random, 40, Vec3(0), 4);
  AxisBox box;
  box.add(Vec3(1));
  box.add(Vec3(2));
  const auto meets = [&](const Face& face) {
    AxisBox around;
    for (const Vec3& p : face) around.add(p);
    return box.meets(around);
  };
  const Hash128 key = key_of(corners({own, others}), {box}, true);
  EXPECT_EQ(key_of(corners({{}, others}), {box}, true), key) << "its own are no part of it";
  // once only, whichever box finds it
  EXPECT_EQ(key_of(corners({own, others}), {box, box}, true), key);
  std::size_t inside = 0;
  for (Face& face : others) {
    const Face before = face;
    face[1] += Vec3(1e-12);
    const bool met = meets(face);
    inside += met;
    EXPECT_EQ(key_of(corners({own, others}), {box}, true) != key, met);
    face = before;
  }
  EXPECT_GT(inside, 5u);
  EXPECT_LT(inside, 40u);
  AxisBox away;
  away.add(Vec3(9));
  away.add(Vec3(10));
  key_of(corners({own, others}), {away}, false);
  key_of(corners({own, others}), {}, false);
  key_of(corners({own}), {box}, false);
  key_of({}, {box}, false);
}

}  // namespace
}  // namespace panwright::mli::corners_test
