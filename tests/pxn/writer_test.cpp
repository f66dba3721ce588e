// Scene → text → scene: the same again.

#include "pxn/writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <random>

#include "image/decode.h"
#include "image/png.h"
#include "tests/pxn/reading.h"
#include "tests/support/paths.h"
#include "tests/support/process.h"

namespace panwright::pxn::writer_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

// The scene of a text that was made of a scene, with its textures beside it in memory.
Reading read_again(const scene::Scene& scene) {
  std::vector<MemoryFile> files{{"again.pxn", to_text(scene, [](std::size_t i) {
                                   return "picture" + std::to_string(i) + ".png";
                                 })}};
  for (std::size_t i = 0; i < scene.textures.size(); ++i) {
    const scene::Texture& t = scene.textures[i];
    files.push_back(
        {"picture" + std::to_string(i) + ".png", image::png_file(t.width, t.height, t.rgba)});
  }
  return read_files(files);
}

// The names of images are those of files.
scene::Scene with_names_of_textures(scene::Scene scene) {
  for (std::size_t i = 0; i < scene.textures.size(); ++i)
    scene.textures[i].name = "picture" + std::to_string(i) + ".png";
  return scene;
}

void expect_identity(const scene::Scene& scene, const std::string& what) {
  const Reading once = read_again(scene);
  ASSERT_TRUE(once.scene) << what << once.summary();
  EXPECT_FALSE(once.log.has_errors()) << what << once.summary();
  EXPECT_EQ(scene_difference(with_names_of_textures(scene), *once.scene, Likeness::same), "")
      << what << "\n"
      << to_text(scene).substr(0, 3000);
}

// The number of files. The folder blankets only where it is asked for: it takes most of the time.
std::size_t expect_files_come_back(const std::string& folder) {
  std::size_t files = 0;
  const fs::path path = PANWRIGHT_SOURCE_DIR + folder;
  for (const auto& entry : fs::recursive_directory_iterator(path)) {
    if (entry.path().extension() != ".pxn") continue;
    if (path.filename() != "blankets" && entry.path().parent_path().filename() == "blankets")
      continue;
    // sheets of 1.4 million triangles: more text than is read
    if (entry.path().filename() == "operations.pxn") continue;
    Options options;
    options.root = path;
    const Reading r = read_path(entry.path().string(), options);
    if (!r.scene) continue;
    ++files;
    expect_identity(*r.scene, entry.path().string());
  }
  return files;
}

TEST(Writer, ShippedFilesComeBack) {
  EXPECT_GE(expect_files_come_back("/examples") + expect_files_come_back("/tests/pxn/data/good"),
            10u);
}

TEST(Writer, ShippedBlanketsComeBack) {
  EXPECT_GE(expect_files_come_back("/examples/blankets"), 3u);
}

// Everything of level 1 in one text, multiplied out by hand.
TEST(Writer, MultipliesOut) {
  const Reading r = read_files({{"m.pxn",
                                 "<pangu_model ver='1' units='mm' up='y'>"
                                 "<param name='n' value='2'/>"
                                 "<material name='foil'><diffuse>0.5 0.5 0.5</diffuse></material>"
                                 "<budget nearest='5m' ifov='0.2mrad'/>"
                                 "<part name='p'><box name='b' size='{10mm*n}'/>"
                                 "<frame name='f' rotate='10 20 30'/></part>"
                                 "<repeat count='3' var='i' name='r{i}' translate='{i*1m} 0 0'>"
                                 "<use part='p' name='u{i}' material='foil'/></repeat>"
                                 "</pangu_model>"}});
  ASSERT_TRUE(r.scene) << r.summary();
  const std::string text = to_text(*r.scene);
  EXPECT_THAT(text, HasSubstr("<node name=\"r2\" translate=\"2 0 0\">\n    <node name=\"u2\">\n"
                              "      <box name=\"b\" size=\"0.02 0.02 0.02\" material=\"foil\"/>\n"
                              "      <frame\n          name=\"u2/f\"\n          quat=\"0.95"));
  EXPECT_THAT(text, HasSubstr("angle=\"rad\" up=\"y\""));
  EXPECT_THAT(text, HasSubstr("<budget nearest=\"5\" ifov=\"0.0002\" pixels=\"0.25\"/>"));
  for (const char* gone : {"repeat", "param", "<part", "<use", "{"})
    EXPECT_EQ(text.find(gone), std::string::npos) << gone;
  expect_identity(*r.scene, "by hand");
}

TEST(Writer, NamesThatCannotStay) {
  // the same name in two files, a decal on one of two shapes of a name, braces of level 0
  const Reading r =
      read_files({{"m.pxn",
                   "<pangu_model ver='1'><material name='m'><diffuse>1 0 0</diffuse></material>"
                   "<part name='one'><plane name='face' size='1' material='m'/>"
                   "<decal on='face' image='t.png' at='0 0 0' size='0.1'/></part>"
                   "<use part='one'/><node><include file='o.pxn'/></node>"
                   "<plane name='face' size='2'/></pangu_model>"},
                  {"o.pxn",
                   "<pangu_model ver='1'><material name='m'><diffuse>0 1 0</diffuse></material>"
                   "<plane name='face' size='3' material='m'/>"
                   "<include file='zero.pxn'/></pangu_model>"},
                  {"zero.pxn",
                   "<pangu_model ver='0'><frame_s label='a{b}'><origin><vec3>0 0 0</vec3></origin>"
                   "<forward><vec3>0 0 1</vec3></forward><up><vec3>0 -1 0</vec3></up>"
                   "<right><vec3>1 0 0</vec3></right></frame_s></pangu_model>"},
                  {"t.png", image::png_file(1, 1, std::array<std::uint8_t, 4>{1, 2, 3, 4})}});
  ASSERT_TRUE(r.scene) << r.summary();
  ASSERT_EQ(r.scene->decals.size(), 1u);
  const Reading again = read_again(*r.scene);
  ASSERT_TRUE(again.scene);
  EXPECT_FALSE(again.log.has_errors()) << again.summary();
  ASSERT_EQ(again.scene->decals.size(), 1u) << to_text(*r.scene);
  EXPECT_EQ(again.scene->decals[0].instance, r.scene->decals[0].instance);
  EXPECT_EQ(again.scene->frames[0].name, "a(b)");
  scene::Scene renamed = *r.scene;
  renamed.frames[0].name = "a(b)";
  EXPECT_EQ(scene_difference(renamed, *again.scene, Likeness::looks), "");
  EXPECT_NE(scene_difference(renamed, *again.scene, Likeness::same), "");
  // from then on nothing changes
  expect_identity(*again.scene, "again");
}

// Scenes of every shape with random numbers, as pxn::read could have made them.
class Maker {
 public:
  explicit Maker(std::uint32_t seed) : random_(seed) {}

  scene::Scene make() {
    scene_.nodes.push_back({"root", scene::kNone, {}, {}});
    for (std::uint32_t i = 0; i < 3; ++i) texture(i == 1);
    for (std::uint32_t i = 0; i < 4; ++i) material(i);
    nodes(0, 0, scene::kNone, Mat4(1));
    while (scene_.instances.empty()) shape(0, scene::kNone, Mat4(1));
    for (std::uint32_t n = below(3), i = 0; i < n; ++i) decal(i);
    if (below(2) == 0) scene_.budget.tolerance = positive();
    if (below(2) == 0) {
      scene_.budget.nearest = positive();
      scene_.budget.ifov = positive() * 1e-4;
      scene_.budget.pixels = positive();
      if (below(2) == 0 && !scene_.frames.empty()) {
        scene_.budget.approach = scene_.frames[0].name;
        scene_.budget.corridor = unit() + 0.1;
      }
    }
    if (below(2) == 0) scene_.budget.flux = 1e-3 * unit();
    return scene_;
  }

 private:
  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(random_() % n); }
  double unit() { return (static_cast<double>(random_()) + 0.5) / 4294967296.0; }
  double any() { return (2 * unit() - 1) * std::pow(10.0, static_cast<double>(below(7)) - 3); }
  double positive() { return std::abs(any()) + 1e-6; }
  Vec3 vector() { return {any(), any(), any()}; }
  Quat turn() { return glm::normalize(Quat(unit() + 0.1, unit(), unit(), unit())); }

  scene::Transform transform() {
    scene::Transform t;
    if (below(2) == 0) t.translation = vector();
    if (below(2) == 0) t.rotation = turn();
    if (below(3) == 0) t.scale = Vec3(positive(), -positive(), positive());
    if (below(4) == 0) t.scale = Vec3(positive());
    return t;
  }
  void texture(bool linear) {
    scene::Texture t;
    t.width = 1 + below(5);
    t.height = 1 + below(5);
    t.linear = linear;
    for (std::uint32_t i = 0; i < 4 * t.width * t.height; ++i)
      t.rgba.push_back(static_cast<std::uint8_t>(below(256)));
    scene_.textures.push_back(std::move(t));
  }
  Vec3 color() { return {unit() * 0.4, unit() * 0.4, unit() * 0.4}; }

  void material(std::uint32_t index) {
    materials::Fields f;
    if (below(2) == 0) f.diffuse = color();
    if (below(2) == 0) f.specular = color();
    if (below(3) == 0) f.blinn_phong = materials::BlinnPhong{unit() * 128};
    if (below(3) == 0) f.emissive = color();
    // level 1 refuses more than 1 in all
    if (below(2) == 0) f.reflect = Vec3(unit(), unit(), below(2) * unit()) / 3.0;
    if (below(3) == 0)
      f.cook_torrance = materials::CookTorrance{unit(), unit() + 0.01, unit(), unit()};
    if (below(6) == 0) {
      f.retroreflector =
          materials::Retroreflector{1 + unit(), unit(), 1.5 * unit() + 0.01, 0.4 * unit() + 1e-4};
      f.specular_model = materials::SpecularModel::retroreflector;
    }
    if (below(3) == 0) f.oren_nayar = materials::OrenNayar{unit()};
    if (below(3) == 0) f.hapke = materials::Hapke{unit(), unit(), unit(), 80 * unit() * kDegree};
    if (below(3) == 0) f.refract = Vec3(1) + color();
    if (below(2) == 0) {
      f.maps = materials::Maps{};
      f.maps->albedo = 0;
      if (below(2) == 0) f.maps->normal = 1;
      if (below(2) == 0) f.maps->repeat = {positive(), positive()};
      if (f.cook_torrance) f.maps->reflectance = 0;
    }
    DiagnosticLog log;
    scene_.materials.push_back(materials::resolved(f, {}, log));
    scene_.materials.back().name = "material & \"<" + std::to_string(index);
  }

  void nodes(std::int32_t parent, std::uint32_t depth, std::int32_t texture, const Mat4& matrix) {
    for (std::uint32_t n = below(5); n > 0; --n) {
      const std::uint32_t kind = below(6);
      if (kind == 0) {
        scene_.frames.push_back(
            {"frame" + std::to_string(scene_.frames.size()), parent, vector(), turn(), {}});
      } else if (kind == 1) {
        scene_.keypoints.push_back(
            {"key/" + std::to_string(scene_.keypoints.size()), parent, vector(), {}});
      } else {
        // a texture begins around some
        const bool begins = below(5) == 0;
        const std::int32_t inner = begins ? 2 : texture;
        const Mat4 outer = begins ? Mat4(1) : matrix;
        if (kind < 4 && depth < 4) {
          const auto node = static_cast<std::int32_t>(scene_.nodes.size());
          scene_.nodes.push_back({"node" + std::to_string(node), parent, transform(), {}});
          if (below(3) == 0) scene_.nodes.back().marks.label = "part & " + std::to_string(below(4));
          const Mat4 local = scene_.nodes.back().parent_from_node.matrix();
          nodes(node, depth + 1, inner, inner == scene::kNone ? matrix : outer * local);
        } else {
          shape(parent, inner, outer);
        }
      }
    }
  }

  void shape(std::int32_t parent, std::int32_t texture, const Mat4& matrix) {
    const auto node = static_cast<std::int32_t>(scene_.nodes.size());
    scene_.nodes.push_back({"shape" + std::to_string(node), parent, transform(), {}});
    if (below(3) == 0) scene_.nodes.back().marks.label = "shape's";
    scene::Instance instance;
    instance.node = node;
    instance.shape = static_cast<std::int32_t>(scene_.shapes.size());
    instance.material = static_cast<std::int32_t>(below(4));
    instance.texture = texture;
    if (texture != scene::kNone) {
      instance.mapping = scene::Mapping::sphere;
      instance.texture_from_shape = matrix * scene_.nodes.back().parent_from_node.matrix();
    }
    if (below(4) == 0) instance.tolerance = positive();
    scene_.instances.push_back(instance);
    scene_.shapes.push_back(some_shape());
  }

  geometry::Sector sector() {
    if (below(2) == 0) return {};
    const double begin = any() * 1e-3;
    return {begin, begin + 6 * unit() + 0.01};
  }
  geometry::Counts segments() { return {counts().around, 0}; }
  geometry::Counts counts() {
    if (below(2) == 0) return {};
    return {3 + below(50), 2 + below(50)};
  }
  geometry::Caps caps() { return static_cast<geometry::Caps>(below(4)); }

  geometry::Shape some_shape() {
    geometry::Shape shape = random_shape();
    while (std::holds_alternative<geometry::MeshShape>(shape)
               ? false
               : geometry::problem_of(shape) != std::nullopt)
      shape = random_shape();
    return shape;
  }

  geometry::Shape random_shape() {
    switch (below(15)) {
      case 0: {
        geometry::Sphere s;
        s.radius = positive();
        if (below(2) == 0) s.counts = geometry::SphereCounts{2 + below(9), 3 + below(9)};
        if (below(2) == 0) s.latitude_min = -1.5 * unit();
        if (below(2) == 0) s.latitude_max = 1.5 * unit();
        s.sector = sector();
        return s;
      }
      case 1:
        return mesh();
      case 2:
        return geometry::Ellipsoid{Vec3(positive(), positive(), positive()), counts()};
      case 3:
        return geometry::Box{Vec3(positive(), positive(), positive()), below(2) * 1e-7 * unit(),
                             below(2) == 0};
      case 4:
        return geometry::Cylinder{positive(), positive(), caps(), sector(), segments()};
      case 5:
        return geometry::Cone{positive(), below(2) * positive(), positive(), caps(), sector(),
                              segments()};
      case 6:
        return geometry::Disc{1 + unit(), below(2) * unit(), sector(), segments()};
      case 7:
        return geometry::Torus{1 + unit(), unit(), sector(), counts()};
      case 8:
        return geometry::Dish{positive(), positive(), below(2) * unit(), counts()};
      case 9:
        return geometry::Plane{positive(), positive()};
      case 10:
        return tube();
      case 11:
        return lathe();
      case 12:
        return extrude();
      case 13:
        return subdiv();
      default:
        return polygons();
    }
  }

  geometry::Tube tube() {
    geometry::Tube s;
    for (std::uint32_t i = 0, n = 3 + below(4); i < n; ++i)
      s.path.push_back({static_cast<double>(i) + unit() / 4, unit(), unit()});
    s.radius = 1e-3 * unit();
    s.inner_radius = below(2) * s.radius * 0.5;
    s.spline = below(2) == 0;
    s.closed = below(3) == 0;
    s.caps = caps();
    s.counts = counts();
    return s;
  }

  geometry::Lathe lathe() {
    geometry::Lathe s;
    for (std::uint32_t i = 0, n = 2 + below(6); i < n; ++i)
      s.profile.push_back({unit(), static_cast<double>(i) + unit() / 2});
    s.spline = below(2) == 0;
    s.sector = sector();
    s.counts = counts();
    return s;
  }

  geometry::Extrude extrude() {
    geometry::Extrude s;
    s.outline = {{-unit() - 1, -1 - unit()}, {1 + unit(), -1 - unit()}, {unit(), 2 + unit()}};
    if (below(2) == 0) s.holes.push_back({{0, 0}, {0.1 * unit() + 0.01, 0}, {0, 0.1}});
    s.height = positive();
    s.smooth = below(2) * unit();
    s.caps = caps();
    return s;
  }

  geometry::Subdiv subdiv() {
    geometry::Subdiv s;
    for (std::uint32_t i = 0; i < 6; ++i)
      s.positions.push_back({i % 3 + unit() / 4, i / 3 + unit() / 4, unit()});
    s.faces = {{{0, 1, 4, 3}, {}}, {{1, 2, 5, 4}, {}}};
    if (below(2) == 0) {
      s.texcoords = {{0, unit()}, {1, 0}, {1, unit()}, {0, 1}};
      for (auto& face : s.faces) face.texcoords = {0, below(4), 2, 3};
    }
    if (below(2) == 0) s.creases.push_back({{2, 1, 4}, below(2) == 0 ? 10 : unit()});
    if (below(2) == 0) s.corners.push_back({{4, 5}, 9 * unit()});
    s.smooth_border = below(2) == 0;
    s.levels = below(3);
    return s;
  }

  geometry::Polygons polygons() {
    geometry::Polygons s;
    s.positions = {{0, 0, 0},     {3 + unit(), 0, 0}, {0, 3 + unit(), 0}, {0, 0, 1},
                   {0.5, 0.5, 0}, {0.7, 0.5, 0},      {0.5, 0.7, 0}};
    s.faces.push_back({{0, 1, 2}, {}});
    if (below(2) == 0) s.faces[0].holes.push_back({4, 5, 6});
    s.faces.push_back({{0, 3, 1}, {}});
    s.smooth = below(2) * unit();
    return s;
  }

  // A patch of a wavy sheet in strips, or loose triangles of a fan.
  geometry::Shape mesh() {
    auto m = std::make_shared<geometry::Mesh>();
    const std::uint32_t n = 2 + below(4);
    for (std::uint32_t j = 0; j < n; ++j)
      for (std::uint32_t i = 0; i < n; ++i) {
        m->positions.push_back({static_cast<double>(i), static_cast<double>(j), unit()});
        m->normals.push_back(glm::normalize(Vec3(unit(), unit(), 1)));
      }
    if (below(2) == 0)
      for (std::size_t i = 0; i < m->positions.size(); ++i) {
        m->texcoords.push_back({any(), any()});
        m->colors.push_back({unit(), unit(), unit()});
      }
    for (std::uint32_t j = 0; j + 1 < n; ++j)
      for (std::uint32_t i = 0; i + 1 < n; ++i) {
        const std::uint32_t a = j * n + i, b = a + 1, c = a + n, d = c + 1;
        m->triangles.push_back({a, b, c});
        m->triangles.push_back(below(2) == 0 ? geometry::Triangle{c, b, d}
                                             : geometry::Triangle{d, c, b});
      }
    return geometry::MeshShape(std::move(m));
  }

  void decal(std::uint32_t index) {
    scene::Decal d;
    d.name = index == 0 ? "" : "decal";
    d.instance =
        static_cast<std::int32_t>(below(static_cast<std::uint32_t>(scene_.instances.size())));
    d.texture = 0;
    d.at = vector();
    if (below(2) == 0) d.normal = vector();
    if (below(2) == 0) d.up = vector();
    d.width = positive();
    d.height = positive();
    scene_.decals.push_back(d);
  }

  std::mt19937 random_;
  scene::Scene scene_;
};

TEST(Writer, RandomScenesComeBack) {
  std::set<std::size_t> kinds;
  for (std::uint32_t seed = 0; seed < 400 && !HasFailure(); ++seed) {
    const scene::Scene scene = Maker(seed).make();
    ASSERT_EQ(scene::check(scene), "") << "seed " << seed;
    for (const geometry::Shape& shape : scene.shapes) kinds.insert(shape.index());
    expect_identity(scene, "seed " + std::to_string(seed));
  }
  EXPECT_EQ(kinds.size(), std::variant_size_v<geometry::Shape>);
}

TEST(Writer, DifferencesAreSeen) {
  const scene::Scene scene = Maker(7).make();
  EXPECT_EQ(scene_difference(scene, scene, Likeness::same), "");
  const auto differs = [&](auto change) {
    scene::Scene other = scene;
    change(other);
    EXPECT_NE(scene_difference(scene, other, Likeness::same), "");
    EXPECT_NE(scene_difference(other, scene, Likeness::same), "");
    return !scene_difference(scene, other, Likeness::looks).empty();
  };
  ASSERT_FALSE(scene.instances.empty());
  const auto node = static_cast<std::size_t>(scene.instances[0].node);
  const auto material = static_cast<std::size_t>(scene.instances[0].material);
  EXPECT_TRUE(differs([&](scene::Scene& s) {
    double& x = s.nodes[node].parent_from_node.translation.x;
    x = std::nextafter(x, 1e30);
  }));
  EXPECT_TRUE(differs([&](scene::Scene& s) { s.materials[material].diffuse.x += 1e-9; }));
  EXPECT_TRUE(differs([](scene::Scene& s) { s.instances[0].tolerance = 0.123; }));
  EXPECT_TRUE(differs([](scene::Scene& s) { s.budget.centroid = 0.123; }));
  EXPECT_TRUE(differs([](scene::Scene& s) { s.shapes[0] = geometry::Plane{0.123, 1}; }));
  EXPECT_TRUE(differs([](scene::Scene& s) { s.instances.pop_back(); }));
  // names of nodes and materials are not seen
  EXPECT_FALSE(differs([&](scene::Scene& s) { s.nodes[node].name = "other"; }));
  EXPECT_FALSE(differs([&](scene::Scene& s) { s.materials[material].name = "other"; }));
  // nor is the order of lists
  scene::Scene turned = scene;
  std::reverse(turned.shapes.begin(), turned.shapes.end());
  const auto last = static_cast<std::int32_t>(turned.shapes.size()) - 1;
  for (scene::Instance& instance : turned.instances) instance.shape = last - instance.shape;
  EXPECT_EQ(scene_difference(scene, turned, Likeness::same), "");
}

TEST(Writer, TexturesBesideTheText) {
  const support::TemporaryFolder folder;
  std::mt19937 random(3);
  scene::Scene scene;
  for (const std::uint32_t side : {1u, 7u, 300u}) {
    scene::Texture t{"a.png", side, 2 * side, {}, false};
    for (std::uint32_t i = 0; i < 8 * side * side; ++i)
      t.rgba.push_back(static_cast<std::uint8_t>(random()));
    scene.textures.push_back(t);
  }
  scene.textures.push_back(scene.textures[0]);
  scene.textures[3].name = "below/b.png";
  scene.textures.push_back(scene.textures[0]);
  scene.textures[4].name = "../c.png";
  // one is there already
  folder.write("a.png", image::png_file(7, 14, scene.textures[1].rgba));
  DiagnosticLog log;
  const auto names = write_textures(scene, folder / "model.pxn", log);
  ASSERT_TRUE(names) << to_text(log);
  EXPECT_THAT(*names, testing::ElementsAre("model-1.png", "a.png", "model-2.png", "below/b.png",
                                           "model-3.png"));
  for (std::size_t i = 0; i < 5; ++i) {
    const std::string bytes = support::contents(folder / (*names)[i]);
    image::DecodedImage image;
    EXPECT_FALSE(image::decode_image(std::as_bytes(std::span(bytes)), 1 << 30, image).code);
    EXPECT_TRUE(image.rgba == scene.textures[i].rgba);
  }
}

}  // namespace
}  // namespace panwright::pxn::writer_test
