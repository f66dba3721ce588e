// Placement: transforms, frames, textures, names. Matrices are multiplied out here by hand.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/text.h"
#include "tests/pxn/reading.h"
#include "tests/support/paths.h"
#include "tests/support/process.h"

namespace panwright::pxn::scene_test {
namespace {

using testing::HasSubstr;

const std::string kSphere = "<sphere rings=\"4\" quads=\"4\"/>";

std::string transform(const std::string& parts, const std::string& inside = kSphere) {
  return "<transform>" + parts + "<child>" + inside + "</child></transform>";
}

Mat4 world_of(const Reading& r, std::size_t instance) {
  const auto world = scene::world_from_nodes(*r.scene);
  return world[static_cast<std::size_t>(r.scene->instances.at(instance).node)];
}

// Row-major 3x3 product and rotation about one axis, in long double.
struct M3 {
  long double m[3][3];
};
M3 times(const M3& a, const M3& b) {
  M3 out{};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) out.m[i][j] += a.m[i][k] * b.m[k][j];
  return out;
}
M3 about(int axis, long double degrees) {
  const long double t = degrees * 3.14159265358979323846264338327950288L / 180;
  const long double c = std::cos(t), s = std::sin(t);
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  M3 out{};
  out.m[axis][axis] = 1;
  out.m[i][i] = out.m[j][j] = c;
  out.m[i][j] = -s;
  out.m[j][i] = s;
  return out;
}

TEST(Scene, TransformsAreTRSWithFixedAxes) {
  std::mt19937 random(1);
  const auto number = [&] { return static_cast<double>(random() % 20001) / 1000 - 10; };
  long double worst = 0;
  for (int round = 0; round < 200; ++round) {
    double s[3], a[3], t[3];
    for (int k = 0; k < 3; ++k) {
      s[k] = number() + 11;
      a[k] = 18 * number();
      t[k] = number();
    }
    const auto triple = [](const double* v) {
      return format_double(v[0]) + " " + format_double(v[1]) + "\n" + format_double(v[2]);
    };
    const Reading r =
        read_nodes(transform("<rotation>" + triple(a) + "</rotation><scaling>" + triple(s) +
                             "</scaling><translation>" + triple(t) + "</translation>"));
    ASSERT_TRUE(r.scene);
    const Mat4 world = world_of(r, 0);
    const M3 rotation = times(about(2, a[2]), times(about(1, a[1]), about(0, a[0])));
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(world[3][i], t[i]);
      for (int j = 0; j < 3; ++j)
        worst = std::max(worst, std::abs(world[j][i] - rotation.m[i][j] * s[j]));
    }
  }
  // measured 1.1e-14, for scales up to 21
  EXPECT_LT(worst, 2e-14L);
}

TEST(Scene, QuaternionsTurnAndAreNormalised) {
  // 90 degrees about z takes x to y; the length is off by 5e-4
  const Reading r =
      read_nodes("<rotate><quat> 0.7075 0 0 0.7075 </quat><child>" + kSphere + "</child></rotate>");
  EXPECT_EQ(r.summary(), "");
  const Vec3 x = Vec3(world_of(r, 0)[0]);
  // measured 3.1e-16
  EXPECT_LT(glm::length(x - Vec3(0, 1, 0)), 1e-15);
  for (const char* bad : {"0 0 0 0", "1 0.1 0 0", "0.998 0 0 0", "1e9 0 0 0"}) {
    const Reading b = read_nodes("<rotate><quat>" + std::string(bad) + "</quat><child>" + kSphere +
                                 "</child></rotate>");
    EXPECT_EQ(b.codes(), std::multiset<std::string>{"E1206"}) << bad;
    EXPECT_EQ(world_of(b, 0), Mat4(1));
  }
}

TEST(Scene, NestedTransformsMultiply) {
  const Reading r = read_nodes(transform(
      "<translation>1 0 0</translation>",
      transform("<scaling>2 2 -2</scaling>", transform("<translation>0 0 3</translation>"))));
  EXPECT_EQ(r.summary(), "");
  const Vec4 p = world_of(r, 0) * Vec4(1, 1, 1, 1);
  EXPECT_EQ(Vec3(p), Vec3(3, 2, -8));
}

TEST(Scene, SizesThatSinglePrecisionCannotHold) {
  for (const char* scaling : {"1e20 1e20 1e20", "1e-20 1e-20 1e-20", "1e20 1 1"}) {
    const std::string s = "<scaling>" + std::string(scaling) + "</scaling>";
    const Reading r = read_nodes(transform(s, transform(s)));
    EXPECT_EQ(r.codes(), std::multiset<std::string>{"E2010"}) << scaling;
    EXPECT_TRUE(std::isfinite(world_of(r, 0)[0][0]));
  }
  std::string far = kSphere;
  for (int i = 0; i < 100; ++i) far = transform("<scaling>1e30 1e30 1e30</scaling>", far);
  const Reading r = read_nodes(far);
  EXPECT_EQ(r.codes().count("E2010"), 50u) << "49 more are counted, the first 50 kept";
  EXPECT_EQ(r.log.errors(), 99u);
}

std::string frame(const std::string& label, const Vec3& f, const Vec3& u, const Vec3& r) {
  const auto axis = [](const char* name, const Vec3& v) {
    return std::string("<") + name + "><vec3>" + format_double(v.x) + " " + format_double(v.y) +
           " " + format_double(v.z) + "</vec3></" + name + ">";
  };
  return "<frame_s label=\"" + label + "\"><origin><vec3>1 2 3</vec3></origin>" +
         axis("forward", f) + axis("up", u) + axis("right", r) + "</frame_s>";
}

TEST(Scene, FramesHoldACamera) {
  const Vec3 f(0, 0.6, 0.8), u(0, -0.8, 0.6), r = glm::cross(f, u);
  const Reading reading =
      read_nodes(transform("<translation>5 0 0</translation>", frame("cam", f, u, r)));
  EXPECT_EQ(reading.summary(), "");
  ASSERT_EQ(reading.scene->frames.size(), 1u);
  const scene::Frame& cam = reading.scene->frames[0];
  EXPECT_EQ(cam.origin, Vec3(1, 2, 3));
  EXPECT_EQ(reading.scene->nodes[static_cast<std::size_t>(cam.node)].name, "transform1");
  // x right, y down, z forward; measured 2.5e-16
  EXPECT_LT(glm::length(cam.rotation * Vec3(1, 0, 0) - r), 1e-15);
  EXPECT_LT(glm::length(cam.rotation * Vec3(0, 1, 0) + u), 1e-15);
  EXPECT_LT(glm::length(cam.rotation * Vec3(0, 0, 1) - f), 1e-15);
}

TEST(Scene, FramesAreMadeOrthonormalOrRefused) {
  std::mt19937 random(3);
  const auto noise = [&] { return (static_cast<double>(random() % 2001) / 1000 - 1); };
  double worst_turn = 0;
  for (int round = 0; round < 100; ++round) {
    const Quat q = glm::normalize(Quat(noise(), noise(), noise(), noise()));
    const Mat3 exact = glm::mat3_cast(q);
    const double size = 2e-5;
    const auto shaken = [&](const Vec3& v) { return v + size * Vec3(noise(), noise(), noise()); };
    const Reading r = read_nodes(frame("f", shaken(exact[2]), shaken(-exact[1]), shaken(exact[0])));
    EXPECT_EQ(r.codes(), std::multiset<std::string>{"N1208"}) << r.summary();
    const Mat3 made = glm::mat3_cast(r.scene->frames.at(0).rotation);
    for (int i = 0; i < 3; ++i) worst_turn = std::max(worst_turn, glm::length(made[i] - exact[i]));
  }
  // the shaking itself is at most sqrt(3)·2e-5 = 3.5e-5; measured 2.6e-5
  EXPECT_LT(worst_turn, 3.5e-5);
  const auto code = [](const Vec3& f, const Vec3& u, const Vec3& r) {
    return read_nodes(frame("f", f, u, r)).summary();
  };
  EXPECT_THAT(code({0, 0, 1}, {0, -1, 0}, {-1, 0, 0}),
              HasSubstr("right is the opposite of forward × up"));
  EXPECT_THAT(code({0, 0, 0}, {0, -1, 0}, {1, 0, 0}), HasSubstr("forward has length 0, not 1"));
  EXPECT_THAT(code({0, 0, 1}, {0, -1, 0}, {1.0002, 0, 0}), HasSubstr("right has length 1.0002"));
  EXPECT_THAT(code({0, 0, 1}, {0, -1, 0}, {0, 1, 0}),
              HasSubstr("right and up are not at right angles: 180"));
  EXPECT_THAT(code({1e30, 0, 0}, {0, 1e30, 0}, {0, 0, 1e30}), HasSubstr("E1207"));
}

TEST(Scene, TexturesFindTheirPlaceAndTheNearestWins) {
  const std::string ppm("P6 1 2 255 \x01\x02\x03\xff\xfe\xfd", 17);
  const auto texture = [](const std::string& file, const std::string& inside) {
    return "<texture type=\"sphere\"><data><include type=\"raw\" file=\"" + file +
           "\"/></data><child>" + inside + "</child></texture>";
  };
  const std::string inside = transform("<translation>0 0 1</translation>", kSphere);
  const std::string nodes = transform(
      "<scaling>3 3 3</scaling>",
      texture("a.ppm", "<group>" + inside + texture("b.ppm", kSphere) + texture("no.ppm", kSphere) +
                           texture("a.ppm", inside) + "</group>"));
  const Reading r =
      read_files({{"t.pxn", "<pangu_model ver=\"0\">" + nodes + kSphere + "</pangu_model>"},
                  {"a.ppm", ppm},
                  {"b.ppm", ppm}});
  EXPECT_EQ(r.codes(), std::multiset<std::string>{"E1301"});
  ASSERT_EQ(r.scene->instances.size(), 5u);
  ASSERT_EQ(r.scene->textures.size(), 2u);
  EXPECT_EQ(r.scene->textures[0].name, "a.ppm");
  EXPECT_EQ(r.scene->textures[0].rgba,
            (std::vector<std::uint8_t>{1, 2, 3, 255, 255, 254, 253, 255}));
  EXPECT_EQ(r.scene->instances[0].texture, 0);
  EXPECT_EQ(r.scene->instances[0].mapping, scene::Mapping::sphere);
  Mat4 up(1);
  up[3] = Vec4(0, 0, 1, 1);
  EXPECT_EQ(r.scene->instances[0].texture_from_shape, up)
      << "what is outside the texture does not count";
  EXPECT_EQ(r.scene->instances[1].texture, 1);
  EXPECT_EQ(r.scene->instances[1].texture_from_shape, Mat4(1));
  EXPECT_EQ(r.scene->instances[2].texture, 0) << "one that cannot be read leaves the outer one";
  EXPECT_EQ(r.scene->instances[3].texture_from_shape, up);
  EXPECT_EQ(r.scene->instances[4].texture, scene::kNone);
  EXPECT_EQ(r.scene->inputs.size(), 3u);
}

TEST(Scene, NodesAreNamedAndPlaced) {
  const Reading r = read_files(
      {{"models/top.pxn", "<pangu_model ver='0'>\n<group>" + kSphere +
                              "<include type='pxn' file='parts/dish.pxn'/></group>\n" + kSphere +
                              "<include type='pxn' file='parts/dish.pxn'/></pangu_model>"},
       {"models/parts/dish.pxn", "<pangu_model ver='0'>\n  " + kSphere + "</pangu_model>"}});
  EXPECT_EQ(r.summary(), "");
  std::string tree;
  for (const scene::Node& node : r.scene->nodes)
    tree += node.name + ":" + std::to_string(node.parent) + ":" + node.source.file + ":" +
            std::to_string(node.source.line) + ":" + std::to_string(node.source.column) + "\n";
  EXPECT_EQ(tree,
            "root:-1:top.pxn:1:1\n"
            "group1:0:top.pxn:2:1\n"
            "sphere1:1:top.pxn:2:8\n"
            "dish:1:top.pxn:2:37\n"
            "sphere2:3:parts/dish.pxn:2:3\n"
            "sphere3:0:top.pxn:3:1\n"
            "dish2:0:top.pxn:3:30\n"
            "sphere4:6:parts/dish.pxn:2:3\n");
  EXPECT_EQ(r.scene->shapes.size(), 1u) << "equal spheres are one";
  EXPECT_EQ(r.scene->inputs[1].path, "parts/dish.pxn");
}

TEST(Scene, TheFileWithEverything) {
  const Reading r = read_path(PANWRIGHT_SOURCE_DIR "/tests/pxn/data/good/everything.pxn");
  EXPECT_EQ(r.summary(), "");
  ASSERT_TRUE(r.scene);
  ASSERT_EQ(r.scene->frames.size(), 1u);
  EXPECT_EQ(r.scene->frames[0].name, "cam\xc3\xa9ra & port");
  // attribute references are characters: rings="&#56;" quads="1&#50;"
  const auto& sphere = std::get<geometry::Sphere>(r.scene->shapes[0]);
  EXPECT_EQ(sphere.counts, (geometry::SphereCounts{8, 12}));
  const auto& mesh = *std::get<geometry::MeshShape>(r.scene->shapes.back());
  EXPECT_EQ(mesh.positions[2], Vec3(0, 1, 0)) << "a comment in the text";
  EXPECT_EQ(mesh.positions[3], Vec3(1, 1, 0)) << "CDATA";
  EXPECT_EQ(mesh.normals[2], Vec3(0, 0, 1)) << "made unit";
  EXPECT_EQ(mesh.colors[1], Vec3(0, 1, 0));
  EXPECT_EQ(mesh.texcoords[3], Vec2(1, 1));
}

}  // namespace
}  // namespace panwright::pxn::scene_test
