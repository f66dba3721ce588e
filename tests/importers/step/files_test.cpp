// STEP files that OpenCASCADE writes, read back: units, names, places, colours, sharing.

#include <gtest/gtest.h>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRep_Builder.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS_Compound.hxx>
#include <gp_Ax1.hxx>

#include <cmath>
#include <utility>

#include "tests/importers/step/reading.h"
#include "tests/importers/step/sample.h"

namespace panwright::importers::step::files_test {
namespace {

gp_Trsf shift(double x, double y, double z) {
  gp_Trsf out;
  out.SetTranslation(gp_Vec(x, y, z));
  return out;
}

gp_Trsf quarter_turn() {
  gp_Trsf out;
  out.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), kPi / 2);
  return out;
}

// The curve of IEC 61966-2-1.
double linear(double srgb) {
  return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
}

// Half a cylinder, which is no shape of ours.
TopoDS_Shape half_cylinder() { return BRepPrimAPI_MakeCylinder(100, 300, kPi).Shape(); }

TEST(StepFiles, LengthsAreMetresWhateverTheUnit) {
  const std::pair<const char*, double> units[] = {{"MM", 1e-3}, {"INCH", 0.0254}, {"M", 1}};
  for (const auto& [unit, metres] : units) {
    SCOPED_TRACE(unit);
    const auto ball = read(text_of(BRepPrimAPI_MakeSphere(254).Shape(), "ball", unit));
    ASSERT_TRUE(ball->out);
    EXPECT_TRUE(ball->out->in_metres);
    EXPECT_FALSE(ball->out->lacks_unit);
    EXPECT_NEAR(ball->out->file_unit / metres, 1, 1e-12);
    EXPECT_EQ(ball->out->format, Format::step);
    ASSERT_EQ(ball->scene().shapes.size(), 1u);
    // the writer's digits: 13
    EXPECT_NEAR(std::get<geometry::Sphere>(ball->scene().shapes[0]).radius, 0.254, 1e-12);
    const auto half = read(text_of(half_cylinder(), "half", unit));
    ASSERT_EQ(half->scene().shapes.size(), 1u);
    const geometry::Mesh& mesh = *std::get<geometry::MeshShape>(half->scene().shapes[0]);
    for (const Vec3& p : mesh.positions) {
      const double r = std::hypot(p.x, p.y);
      const double off =
          std::min({std::abs(r - 0.1), std::abs(p.y), std::abs(p.z), std::abs(p.z - 0.3)});
      EXPECT_LE(off, 1e-11);
    }
    EXPECT_TRUE(half->log.entries().empty());
  }
}

TEST(StepFiles, AFileWithoutAUnitIsInMillimetres) {
  std::string text = text_of(BRepPrimAPI_MakeSphere(254).Shape(), "ball", "MM");
  // numbers, and a context that says no unit for them
  const std::size_t at = text.find("( GEOMETRIC_REPRESENTATION_CONTEXT");
  ASSERT_NE(at, text.npos);
  text.replace(at, text.find(';', at) - at, "GEOMETRIC_REPRESENTATION_CONTEXT('c','3D',3)");
  const auto ball = read(text);
  ASSERT_TRUE(ball->out) << to_text(ball->log);
  EXPECT_TRUE(ball->out->lacks_unit);
  EXPECT_EQ(ball->out->file_unit, 1e-3);
  EXPECT_NEAR(std::get<geometry::Sphere>(ball->scene().shapes.at(0)).radius, 0.254, 1e-12);
}

TEST(StepFiles, DeflectionIsAskedOrByTheSize) {
  const std::string text = text_of(half_cylinder());
  const auto triangles = [&](double deflection) {
    Options options;
    options.deflection = deflection;
    const auto reading = read(text, options);
    return std::get<geometry::MeshShape>(reading->scene().shapes.at(0))->triangles.size();
  };
  // a ten thousandth of the largest extent, 0.3 m with a little tolerance
  EXPECT_EQ(triangles(0), triangles(3.00001e-5));
  EXPECT_GT(triangles(1e-6), triangles(1e-4));
}

// A lander of two legs, the second turned and green; each leg has a foot and a rod.
std::string lander() {
  Sample sample;
  const TopoDS_Shape foot_shape = half_cylinder();
  const TDF_Label foot = sample.part(foot_shape, "foot");
  const TDF_Label rod = sample.part(BRepPrimAPI_MakeCylinder(20, 500).Shape(), "rod/1");
  sample.material(rod, "Al 6061");
  sample.color(foot, {0.5, 0.25, 1});
  TopExp_Explorer faces(foot_shape, TopAbs_FACE);
  sample.color(foot, faces.Current(), {1, 0, 0});
  const TDF_Label leg = sample.assembly("leg");
  sample.place(leg, foot, gp_Trsf(), "");
  sample.place(leg, rod, shift(0, 0, 300), "");
  const TDF_Label top = sample.assembly("lander");
  sample.place(top, leg, shift(1000, 0, 0), "leg:1");
  sample.color(sample.place(top, leg, quarter_turn() * shift(1000, 0, 0), "leg:2"), {0, 1, 0});
  return sample.text();
}

TEST(StepFiles, AssembliesAreNodes) {
  const auto reading = read(lander());
  ASSERT_TRUE(reading->out);
  EXPECT_TRUE(reading->log.entries().empty()) << to_text(reading->log);
  const scene::Scene& scene = reading->scene();
  std::vector<std::string> names;
  std::vector<std::int32_t> parents;
  for (const scene::Node& node : scene.nodes) {
    names.push_back(node.name);
    parents.push_back(node.parent);
  }
  EXPECT_EQ(names, (std::vector<std::string>{"root", "lander", "leg:1", "foot", "rod_1", "body1",
                                             "leg:2", "foot", "rod_1", "body2"}));
  EXPECT_EQ(parents, (std::vector<std::int32_t>{-1, 0, 1, 2, 2, 4, 1, 6, 6, 8}));
  const auto world = scene::world_from_nodes(scene);
  // the rod's middle: 0.3 + 0.25 up, at (1, 0) and at (0, 1)
  EXPECT_NEAR(glm::length(Vec3(world[5][3]) - Vec3(1, 0, 0.55)), 0, 1e-15);
  EXPECT_NEAR(glm::length(Vec3(world[9][3]) - Vec3(0, 1, 0.55)), 0, 1e-15);
  EXPECT_NEAR(glm::length(Vec3(world[7][0]) - Vec3(0, 1, 0)), 0, 1e-15);
  // the places of products in the text
  EXPECT_GT(scene.nodes[3].source.line, 1u);
  EXPECT_EQ(scene.nodes[3].source.line, scene.nodes[7].source.line);
}

TEST(StepFiles, PartsThatAreUsedTwiceAreOneShape) {
  const auto reading = read(lander());
  const scene::Scene& scene = reading->scene();
  // the foot's two colours and the rod
  EXPECT_EQ(scene.shapes.size(), 3u);
  ASSERT_EQ(scene.instances.size(), 6u);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_EQ(scene.instances[i].shape, scene.instances[i + 3].shape);
  EXPECT_EQ(std::get<geometry::Cylinder>(scene.shapes[2]).height, 0.5);
}

TEST(StepFiles, ColoursOfFacesProductsAndOccurrences) {
  const auto reading = read(lander());
  const auto& instances = reading->scene().instances;
  const auto color = [&](std::size_t i) {
    return reading->scene().materials[static_cast<std::size_t>(instances[i].material)].diffuse;
  };
  constexpr double kSingle = 1e-7;  // OpenCASCADE keeps colours in single precision
  const Vec3 foot(linear(0.5), linear(0.25), 1);
  for (const std::size_t leg : {0u, 3u}) {
    EXPECT_NEAR(glm::length(color(leg) - foot), 0, kSingle);
    EXPECT_EQ(color(leg + 1), Vec3(1, 0, 0));
  }
  // the rod has none of its own: grey, and green in the green leg
  EXPECT_EQ(color(2), Vec3(0.8));
  EXPECT_EQ(color(5), Vec3(0, 1, 0));
  const auto& cad = reading->out->materials;
  ASSERT_EQ(cad.size(), reading->scene().materials.size());
  EXPECT_EQ(cad[static_cast<std::size_t>(instances[2].material)].name, "Al 6061");
  EXPECT_EQ(cad[static_cast<std::size_t>(instances[0].material)].name, "");
}

TEST(StepFiles, BodiesOfOnePartStandBelowIt) {
  BRep_Builder builder;
  TopoDS_Compound compound;
  builder.MakeCompound(compound);
  const TopoDS_Shape ball = BRepPrimAPI_MakeSphere(100).Shape();
  builder.Add(compound, ball);
  builder.Add(compound, ball.Moved(TopLoc_Location(shift(500, 0, 0))));
  builder.Add(compound, BRepPrimAPI_MakeBox(100, 200, 300).Shape());
  builder.Add(compound, BRepBuilderAPI_MakeEdge(gp_Pnt(0, 0, 0), gp_Pnt(9, 0, 0)).Shape());
  builder.Add(compound, BRepBuilderAPI_MakeVertex(gp_Pnt(0, 0, 7)).Shape());
  const auto reading = read(text_of(compound, "cluster"));
  ASSERT_TRUE(reading->out);
  const scene::Scene& scene = reading->scene();
  EXPECT_EQ(scene.shapes.size(), 2u);
  EXPECT_EQ(scene.instances.size(), 3u);
  double x = 0;
  for (const scene::Instance& instance : scene.instances)
    if (std::holds_alternative<geometry::Sphere>(
            scene.shapes[static_cast<std::size_t>(instance.shape)]))
      x += scene::world_from_nodes(scene)[static_cast<std::size_t>(instance.node)][3].x;
  EXPECT_NEAR(x, 0.5, 1e-15);
  EXPECT_EQ(reading->count(Code("N6007")), 1u) << to_text(reading->log);
}

TEST(StepFiles, TheSameTextGivesTheSameScene) {
  const std::string text = lander();
  const auto first = read(text);
  const auto second = read(text);
  ASSERT_EQ(first->scene().shapes.size(), second->scene().shapes.size());
  for (std::size_t i = 0; i < first->scene().shapes.size(); ++i)
    EXPECT_EQ(geometry::hash_of(first->scene().shapes[i]),
              geometry::hash_of(second->scene().shapes[i]));
  ASSERT_EQ(first->scene().nodes.size(), second->scene().nodes.size());
  for (std::size_t i = 0; i < first->scene().nodes.size(); ++i) {
    EXPECT_EQ(first->scene().nodes[i].name, second->scene().nodes[i].name);
    EXPECT_EQ(first->scene().nodes[i].parent_from_node, second->scene().nodes[i].parent_from_node);
  }
  EXPECT_EQ(first->scene().materials, second->scene().materials);
}

}  // namespace
}  // namespace panwright::importers::step::files_test
