// <mli type="wrap"> and foil=: what wears a blanket, where it lies, and what cannot be.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "geometry/ray/instances.h"
#include "pxn/reader/blankets.h"
#include "tests/pxn/reading.h"

namespace panwright::pxn::wrap_test {
namespace {

using testing::HasSubstr;

Reading read_1(const std::string& inside, const std::string& wrl = "") {
  return read_files(
      {{"m.pxn", "<pangu_model ver=\"1\">\n" + inside + "\n</pangu_model>\n"}, {"a.wrl", wrl}});
}

std::string wrap(const std::string& attributes, const std::string& inside = "",
                 const std::string& standoff = "1cm") {
  return "<mli type=\"wrap\" standoff=\"" + standoff + "\" " + attributes +
         "><mli_settings><width>1</width><height>1</height><xgrid>100</xgrid></mli_settings>"
         "<mli_operations>" +
         (inside.empty() ? "<random> 1mm </random>" : inside) + "</mli_operations></mli>";
}

Mat4 world_from(const scene::Scene& scene, std::int32_t node) {
  Mat4 out(1);
  for (; node != scene::kNone; node = scene.nodes[static_cast<std::size_t>(node)].parent)
    out = scene.nodes[static_cast<std::size_t>(node)].parent_from_node.matrix() * out;
  return out;
}

// Bounds of an instance's mesh in the world.
std::pair<Vec3, Vec3> bounds(const scene::Scene& scene, std::size_t instance) {
  const scene::Instance& i = scene.instances.at(instance);
  const auto& mesh =
      *std::get<geometry::MeshShape>(scene.shapes[static_cast<std::size_t>(i.shape)]);
  const Mat4 world = world_from(scene, i.node);
  Vec3 low(HUGE_VAL), high(-HUGE_VAL);
  for (const Vec3& p : mesh.positions) {
    const Vec3 q(world * Vec4(p, 1));
    low = glm::min(low, q), high = glm::max(high, q);
  }
  return {low, high};
}

TEST(Wraps, FoilIsAllThatNeedsToBeWritten) {
  const Reading r = read_1("<box name='b' size='1 0.8 0.6' foil='crinkled'/><box size='1'/>");
  EXPECT_EQ(r.summary(), "");
  ASSERT_EQ(r.scene->instances.size(), 3u);  // both boxes stay
  EXPECT_EQ(r.scene->nodes[static_cast<std::size_t>(r.scene->instances[2].node)].name, "b_foil");
  EXPECT_EQ(r.scene->materials[static_cast<std::size_t>(r.scene->instances[2].material)].name,
            "mli_gold_kapton");
  ASSERT_EQ(r.scene->foils.size(), 1u);
  EXPECT_TRUE(r.scene->foils[0].wrapped);
  EXPECT_GT(r.scene->foils[0].statistics.slope_rms,
            0.18);  // measured 0.189: 0.2 and heights scaled by 0.947
  // nothing below the sides of the box, all of it within a few stand-offs
  const auto [low, high] = bounds(*r.scene, 2);
  for (int k = 0; k < 3; ++k) {
    EXPECT_GT(high[k], r.scene ? 0.3 : 0);
    EXPECT_LT(high[k] - Vec3(0.5, 0.4, 0.3)[k], 0.08);
    EXPECT_GT(high[k] - Vec3(0.5, 0.4, 0.3)[k], 0.02);
    EXPECT_NEAR(high[k], -low[k], 0.05);
  }
  EXPECT_EQ(read_1("<box size='1' foil='none'/>").scene->instances.size(), 1u);
  // the shape's own material is the blanket's
  const Reading own =
      read_1("<material name='m' preset='mli_silver'/><box size='1' material='m' foil='taped'/>");
  EXPECT_EQ(own.scene->instances[1].material, own.scene->instances[0].material);
}

// Directions are those of where the element stands; the blanket moves with what it covers.
TEST(Wraps, FacesOfADirection) {
  const Reading r = read_1("<box name='b' size='1' rotate='0 0 90'/>" + wrap("on='b' faces='+x'"));
  EXPECT_EQ(r.summary(), "");
  ASSERT_EQ(r.scene->instances.size(), 2u);
  const auto [low, high] = bounds(*r.scene, 1);
  EXPECT_NEAR(low.x, 0.5, 1e-9);  // where its seams end
  EXPECT_NEAR(high.x, 0.51, 0.0011);
  EXPECT_NEAR(high.y, 0.5, 1e-9);
  EXPECT_EQ(r.scene->nodes[static_cast<std::size_t>(r.scene->instances[1].node)].parent,
            r.scene->nodes[static_cast<std::size_t>(r.scene->instances[0].node)].parent);
  EXPECT_EQ(
      bounds(*read_1("<box name='b' size='1'/>" + wrap("on='b' faces='-z +z'")).scene, 1).second.x,
      0.5);
}

// A stand-off and wrinkles are metres of the world: a scaled box wears the blanket of one that is
// as large, whatever the scales.
TEST(Wraps, ScalesStretchNothing) {
  const Reading r = read_1("<box name='b' size='1 0.01 2' scale='1 100 0.5' translate='5 0 0'/>" +
                           wrap("on='b'", "<constant> 1mm </constant>"));
  EXPECT_EQ(r.summary(), "");
  ASSERT_EQ(r.scene->instances.size(), 2u);
  const auto [low, high] = bounds(*r.scene, 1);
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(high[k], (k == 0 ? 5.5 : 0.5) + 0.01, 1e-9) << k;
    EXPECT_NEAR(low[k], (k == 0 ? 4.5 : -0.5) - 0.01, 1e-9) << k;
  }
  // shared where shape and stretch are the same, whatever the turn
  const Reading twice = read_1(
      "<box name='b' size='1'/><box name='c' size='1' translate='3 0 0' rotate='1 2 3'/>"
      "<box name='c2' size='1' translate='6 0 0' scale='2'/>" +
      wrap("on='*'"));
  ASSERT_EQ(twice.scene->instances.size(), 6u);
  EXPECT_EQ(twice.scene->instances[3].shape, twice.scene->instances[4].shape);
  EXPECT_NE(twice.scene->instances[3].shape, twice.scene->instances[5].shape);
  EXPECT_EQ(twice.scene->foils.size(), 2u);
}

constexpr const char* kWrl =
    "#VRML V2.0 utf8\nDEF Bus Transform { children [ DEF Box Shape { appearance Appearance { "
    "material DEF Gold Material { diffuseColor 1 0.8 0 } } geometry Box { size 1 1 1 } } ] }\n"
    "DEF Ball Transform { translation 5 0 0 children [ Shape { geometry Sphere {} } ] }\n";

TEST(Wraps, ImportedPartsWearThem) {
  const Reading r =
      read_1("<import file='a.wrl'><assign nodes='Bus' foil='crinkled'/></import>", kWrl);
  EXPECT_EQ(r.log.errors() + r.log.warnings(), 0u) << r.summary();
  ASSERT_EQ(r.scene->instances.size(), 3u);
  EXPECT_EQ(r.scene->foils.size(), 1u);
  // a later rule takes it back; patterns of wraps reach into imports
  EXPECT_EQ(read_1("<import file='a.wrl'><assign nodes='Bus' foil='crinkled'/>"
                   "<assign foil='none'/></import>",
                   kWrl)
                .scene->instances.size(),
            2u);
  EXPECT_EQ(read_1("<import name='i' file='a.wrl'/>" + wrap("on='i/*Bus*'"), kWrl)
                .scene->instances.size(),
            3u);
  // balls are refused, which is said with the area
  EXPECT_THAT(read_1("<import file='a.wrl'>\n<assign foil='crinkled'/></import>", kWrl).summary(),
              HasSubstr("3:1 W7002 "));
}

TEST(Wraps, RepeatsCoverTheirOwn) {
  const Reading r =
      read_1("<repeat count='3' var='k'><box name='b' size='1' translate='{3*k} 0 0'/>" +
             wrap("on='b' seed='{k}'") + "</repeat>");
  EXPECT_EQ(r.summary(), "");
  EXPECT_EQ(r.scene->instances.size(), 6u);
  EXPECT_EQ(r.scene->foils.size(), 3u);
}

// A shelf at 12 mm above a box, a doubler of 3 mm on it, and a mast through both: written after the
// blanket, and in part by another file's part. No point of the blanket lies inside any of them, but
// for the mast, which stands in it.
TEST(Wraps, GoBelowWhatIsNear) {
  const auto text = [](const std::string& near) {
    return "<box name='bus' size='1'/>" +
           wrap("on='bus' faces='+z'", "<random> 3mm </random><smooth> 3 </smooth>", "2cm") + near;
  };
  const std::string near =
      "<box name='shelf' size='0.3 0.3 0.01' translate='0.2 0.2 0.517'/>"
      "<node translate='-0.25 -0.2 0.5' rotate='0 0 30'>"
      "<box name='doubler' size='0.2 0.2 0.003' translate='0 0 0.0015'/></node>";
  const auto worst = [](const Reading& r) {
    // how far points of the blanket lie inside a part, metres
    const auto& foil = r.scene->foils.at(0);
    const auto& blanket =
        *std::get<geometry::MeshShape>(r.scene->shapes[static_cast<std::size_t>(foil.shape)]);
    double inside[2] = {0, 0};
    for (const auto& [a, b, c] : blanket.triangles)
      for (int i = 0; i <= 6; ++i)
        for (int j = 0; i + j <= 6; ++j) {
          const Vec3 p = (blanket.positions[a] * double(i) + blanket.positions[b] * double(j) +
                          blanket.positions[c] * double(6 - i - j)) /
                         6.0;
          const Vec3 shelf = glm::abs(p - Vec3(0.2, 0.2, 0.517));
          inside[0] =
              std::max(inside[0], std::min({0.15 - shelf.x, 0.15 - shelf.y, 0.005 - shelf.z}));
          // above the doubler: it is on the base, and foil inside it is not seen
          const double cosine = std::cos(30 * kDegree), sine = std::sin(30 * kDegree);
          const Vec3 d = p - Vec3(-0.25, -0.2, 0.5);
          const double x = cosine * d.x + sine * d.y, y = -sine * d.x + cosine * d.y;
          inside[1] =
              std::max(inside[1], std::min({0.1 - std::fabs(x), 0.1 - std::fabs(y), d.z - 0.003}));
        }
    return std::pair(inside[0], inside[1]);
  };
  const Reading alone = read_1(text(""));
  const Reading among = read_1(text(near));
  ASSERT_TRUE(alone.scene && among.scene) << among.summary();
  EXPECT_EQ(alone.summary(), "");
  EXPECT_EQ(among.summary(), "");
  EXPECT_THAT(read_1(text("<box size='0.8 0.6 0.01' translate='0 0 0.517'/>")).summary(),
              HasSubstr("m² lie lower than the stand-off: other parts are nearer"));  // half of it
  EXPECT_GT(worst(alone).first, 2e-3);
  EXPECT_GT(worst(alone).second, 10e-3);
  EXPECT_LE(worst(among).first, 0);
  EXPECT_LE(worst(among).second, 0);
  // parts of a part, which come later: the same
  const Reading parts =
      read_1("<part name='near'>" + near + "</part>" + text("") + "<use part='near'/>");
  EXPECT_LE(worst(parts).first, 0);
}

// Two equal panels share a blanket, and a third one, which has something in the way, wears its own.
TEST(Wraps, OnlyWhatNothingIsInTheWayOfIsShared) {
  const Reading r = read_1(
      "<repeat count='3' var='k'><box name='b' size='1' translate='{3*k} 0 0'/></repeat>"
      "<box name='shelf' size='0.3 0.3 0.01' translate='3 0 0.51'/>" +
      wrap("on='b' faces='+z'", "<random> 1mm </random>", "2cm"));
  ASSERT_TRUE(r.scene);
  EXPECT_EQ(r.scene->foils.size(), 2u);
  std::map<std::int32_t, int> worn;
  for (const scene::Instance& one : r.scene->instances)
    for (const scene::Foil& foil : r.scene->foils) worn[foil.shape] += foil.shape == one.shape;
  std::vector<int> counts;
  for (const auto& [shape, count] : worn) counts.push_back(count);
  std::sort(counts.begin(), counts.end());
  EXPECT_EQ(counts, (std::vector<int>{1, 2}));
}

TEST(Wraps, ManyTrianglesAreSaidWhoeverAskedForThem) {
  // triangles go with the square of the cell: 12 million are four times 3 million
  EXPECT_EQ(many_triangles(12e6, 0.001),
            "12 million triangles of foil with cells of 0.001 m: cells of 0.002 m, by "
            "<mli_settings> of <mli type=\"wrap\">, would make 3 million");
  EXPECT_EQ(many_triangles(4e6, 0.001), "");
}

// A node and a material of its own beside the blanket, with as many levels.
TEST(Wraps, TapeIsAMaterialAlongBorders) {
  const std::string kTapes =
      "<material name='mli_silver' preset='mli_silver'/>"
      "<material name='mli_kapton_tape' preset='mli_kapton_tape'/>";
  const Reading r = read_1(
      kTapes + "<box name='bus' size='1 0.8 0.6'/>" +
      wrap("on='bus' name='mli' tape='mli_kapton_tape' tape_width='4cm' material='mli_silver'"));
  EXPECT_EQ(r.summary(), "");
  ASSERT_EQ(r.scene->instances.size(), 3u);
  ASSERT_EQ(r.scene->foils.size(), 2u);
  double areas[2] = {0, 0};
  for (const std::size_t i : {1u, 2u}) {
    const scene::Instance& one = r.scene->instances[i];
    EXPECT_EQ(r.scene->nodes[static_cast<std::size_t>(one.node)].name, i == 1 ? "mli" : "mli_tape");
    EXPECT_EQ(r.scene->materials[static_cast<std::size_t>(one.material)].name,
              i == 1 ? "mli_silver" : "mli_kapton_tape");
    const auto& mesh =
        *std::get<geometry::MeshShape>(r.scene->shapes[static_cast<std::size_t>(one.shape)]);
    for (const auto& t : mesh.triangles) {
      const Vec3 cross = glm::cross(mesh.positions[t[1]] - mesh.positions[t[0]],
                                    mesh.positions[t[2]] - mesh.positions[t[0]]);
      // seen along the axis that it faces, which leaves out seams
      const Vec3 out = glm::abs(mesh.positions[t[0]]) / Vec3(0.5, 0.4, 0.3);
      const int axis = out.x > out.y && out.x > out.z ? 0 : out.y > out.z ? 1 : 2;
      areas[i - 1] += std::fabs(cross[axis]) / 2;
    }
    const scene::Foil& foil = r.scene->foils[i - 1];
    EXPECT_EQ(foil.shape, one.shape);
    ASSERT_FALSE(foil.levels.empty());
    EXPECT_DOUBLE_EQ(foil.levels[0].detail, 0.02);
    EXPECT_LT(foil.levels[0].mesh->triangles.size(), mesh.triangles.size() / 2);
  }
  double band = 0;
  const double sides[3] = {1, 0.8, 0.6};
  for (int k = 0; k < 3; ++k)
    band += 2 * (sides[k] * sides[(k + 1) % 3] - (sides[k] - 0.08) * (sides[(k + 1) % 3] - 0.08));
  EXPECT_NEAR(areas[1] / band, 1, 0.02);
  EXPECT_NEAR((areas[0] + areas[1]) / (2 * (0.8 + 0.48 + 0.6)), 1, 1e-6);
  // a part of its own scale: widths and details are metres of the world
  const Reading half =
      read_1(kTapes + "<node scale='0.5'><box name='bus' size='2 1.6 1.2'/></node>" +
             wrap("on='bus' tape='mli_kapton_tape' tape_width='4cm'"));
  ASSERT_EQ(half.scene->foils.size(), 2u);
  EXPECT_DOUBLE_EQ(half.scene->foils[1].levels.at(0).detail, 0.04);
}

// Nodes of their own: the seams of a wrap, and what hangs from the borders of a sheet.
TEST(Wraps, EdgesAndTapeHaveMaterialsOfTheirOwn) {
  const std::string kMaterials =
      "<material name='edge' preset='mli_edge'/><material name='tape' preset='mli_kapton_tape'/>";
  const Reading r = read_1(kMaterials + "<box name='bus' size='1 0.8 0.6'/>" +
                           wrap("on='bus' name='mli' edge='edge' tape='tape'"));
  EXPECT_EQ(r.summary(), "");
  ASSERT_EQ(r.scene->instances.size(), 4u);
  const auto [low, high] = bounds(*r.scene, 3);
  EXPECT_NEAR(high.x, 0.51, 1e-9);  // as high as the stand-off
  const auto name = [&](const Reading& of, std::size_t i) {
    const scene::Instance& one = of.scene->instances.at(i);
    return of.scene->nodes[static_cast<std::size_t>(one.node)].name + " " +
           of.scene->materials[static_cast<std::size_t>(one.material)].name;
  };
  EXPECT_EQ(name(r, 2), "mli_tape tape");
  EXPECT_EQ(name(r, 3), "mli_edge edge");
  const std::string settings =
      "<mli_settings><width>1</width><height>0.6</height><xgrid>100</xgrid></mli_settings>"
      "<mli_operations><random> 1mm </random></mli_operations></mli>";
  const Reading sheet =
      read_1(kMaterials +
             "<mli type='flat' name='door' tape='tape' tape_width='4cm' edge='edge' "
             "thickness='1cm' translate='0 0 2'>" +
             settings);
  EXPECT_EQ(sheet.summary(), "");
  ASSERT_EQ(sheet.scene->instances.size(), 3u);
  EXPECT_EQ(name(sheet, 1), "door_tape tape");
  EXPECT_EQ(name(sheet, 2), "door_edge edge");
  EXPECT_NEAR(bounds(*sheet.scene, 2).first.z, 1.99, 1.1e-3);
  EXPECT_NEAR(bounds(*sheet.scene, 0).second.x, 0.46, 0.004);
  EXPECT_EQ(sheet.scene->foils.size(), 3u);
}

// A box on a plate, each a shape of its own: their blankets share the corner between them, and no
// edge of one goes through the other.
TEST(Wraps, ShapesShareInnerCorners) {
  const Reading r = read_1(
      "<box name='plate' size='1 1 0.1'/><box name='unit' size='0.4 0.3 0.3' "
      "translate='0 0 0.2'/>" +
      wrap("on='*'", "<random> 1mm </random>", "2cm"));
  ASSERT_TRUE(r.scene);
  ASSERT_EQ(r.scene->instances.size(), 4u);
  const auto mesh = [&](std::size_t i) -> const geometry::Mesh& {
    return *std::get<geometry::MeshShape>(
        r.scene->shapes[static_cast<std::size_t>(r.scene->instances[i].shape)]);
  };
  std::size_t crossings = 0;
  for (const auto& [one, other] : {std::pair{2u, 3u}, std::pair{3u, 2u}}) {
    const Mat4 to_other = glm::inverse(world_from(*r.scene, r.scene->instances[other].node)) *
                          world_from(*r.scene, r.scene->instances[one].node);
    geometry::InstanceCaster caster;
    caster.add(caster.add_mesh(mesh(other).positions, mesh(other).triangles), Mat4(1), false);
    caster.build();
    for (const auto& t : mesh(one).triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 a(to_other * Vec4(mesh(one).positions[t[k]], 1)),
            b(to_other * Vec4(mesh(one).positions[t[(k + 1) % 3]], 1));
        const double length = glm::length(b - a);
        // on the plate below the unit's sides both touch it
        if (length > 0 && std::max(a.z, b.z) > (one == 2 ? 1e-6 : 0.05))
          crossings += caster.any({a, (b - a) / length, 1e-6, length - 1e-6}) ? 1 : 0;
      }
  }
  EXPECT_EQ(crossings, 0u);
}

TEST(Wraps, WhatCannotBeIsSaidWhereItStands) {
  const std::string box = "<box name='bus' size='1'/>\n";
  const std::pair<std::string, std::string> cases[] = {
      {box + wrap("on='buss'"),
       "3:1 W1501 no shape is covered: none at or below a node that fits "
       "'buss' (did you mean 'bus'?)"},
      {box + wrap("materials='gold'"), "W1501 no shape is covered"},
      {box + wrap("on='bus' faces='up'"),
       "E7001 faces is 'up'; it is all, or some of +x -x +y -y +z -z"},
      {"<plane name='bus' size='1'/>\n" + wrap("on='bus' faces='+x'"),
       "3:1 W1501 no face of 1 shape looks along '+x'"},
      {box + wrap("on='bus' tape_width='1cm'"),
       "3:54 E7001 tape_width without tape: 'tape' names the tape's material"},
      {box + wrap("on='bus' tape='kapton_tape'"), "unknown material 'kapton_tape'"},
      {box + wrap("on='bus' thickness='1cm' edge='e'"), "E7001 a wrap has no thickness"},
      {box + wrap("on='bus' edge='e'"), "unknown material 'e'"},
      {"<mli type='flat' thickness='1cm'><mli_settings><width>1</width><height>1</height><xgrid>9"
       "</xgrid></mli_settings><mli_operations/></mli>",
       "E7001 thickness without edge"},
      {"<material name='e'/><mli type='box' size='0.2' flange='1cm' edge='e'><mli_settings><width>1"
       "</width><height>1</height><xgrid>99</xgrid></mli_settings><mli_operations/></mli>",
       "E7001 a box has no cut edge"},
      {box + wrap("on='bus' radius='1'"), "E7001 a sheet of type 'wrap' has no radius"},
      {box + wrap("on='bus' translate='1 0 0'"), "E7001 a wrap has no placement"},
      {box + wrap(""), "3:2 E1103 a wrap covers nothing"},
      {box + "<mli type='wrap' on='bus' standoff='0'><mli_operations/></mli>",
       "E1202 standoff of <mli> is 0"},
      {box + "<mli type='flat' on='bus'><mli_settings><width>1</width><height>1</height><xgrid>9"
             "</xgrid></mli_settings><mli_operations/></mli>",
       "E7001 a sheet of type 'flat' has no on"},
      {"<mli type='flat'><mli_operations/></mli>", "2:2 E1103 <mli> needs <mli_settings>"},
      {"<sphere radius='1' foil='smooth'/>", "2:1 E7001 1 of 1 groups of faces have no blanket"},
      {"<box size='58' name='bus'/>\n" + wrap("on='bus'"),
       "3:1 E7001 the blankets have more than 20000000 triangles with cells of 0.01 m"},
      {box + wrap("on='bus'", "<random> 9cm </random>"),
       "W7002 heights meet the base in 6 of 6 groups"}};
  for (const auto& [text, expected] : cases)
    EXPECT_THAT(read_1(text).summary(), HasSubstr(expected)) << text;
}

// The stand-off of the warning keeps the heights, and one of 5 % less does not.
TEST(Wraps, AWarningSaysWhichStandOffIsEnough) {
  const std::string box = "<box name='bus' size='1.4 1.2 1.8'/>";
  for (const std::string heights : {"9cm", "2cm"}) {
    const std::string random = "<random> " + heights + " </random>";
    const std::string warning = read_1(box + wrap("on='bus'", random, "5mm")).summary();
    const std::size_t at = warning.find("a stand-off of ");
    ASSERT_NE(at, warning.npos) << warning;
    const double enough = std::stod(warning.substr(at + 15));
    const auto with = [&](double metres) {
      return read_1(box + wrap("on='bus'", random, std::to_string(metres) + "m")).summary();
    };
    EXPECT_EQ(with(enough), "") << enough;
    EXPECT_THAT(with(0.85 * enough), HasSubstr("heights meet the base"));
  }
}

TEST(Wraps, AWarningOfManyElementsIsToldOnce) {
  std::string text;
  for (const char* size : {"58cm", "29cm", "40cm"})
    text += "<box size='" + std::string(size) + "' name='b" + size[0] + "'/>" +
            wrap("on='b" + std::string(1, size[0]) + "'", "<random> 9cm </random>", "5mm");
  const Reading r = read_1(text);
  EXPECT_EQ(r.log.warnings(), 1u) << r.summary();
  EXPECT_THAT(r.summary(), HasSubstr("(the worst of 3 elements)"));
}

TEST(Wraps, AStandOffLargerThanTheShapeIsAWarning) {
  EXPECT_THAT(read_1("<box name='b' size='10cm'/>" + wrap("on='b'", "", "4m")).summary(),
              HasSubstr("W7002 the stand-off is 4 m, and the shape 0.173 m across, expected less "
                        "than a quarter of that; without standoff= it is 0.0043 m"));
}

}  // namespace
}  // namespace panwright::pxn::wrap_test
