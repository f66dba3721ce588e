// Level 1: parts, uses, repeats, parameters, named materials, frames, keypoints, decals, budgets.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <map>

#include "tests/pxn/reading.h"

namespace panwright::pxn::level1_test {
namespace {

using testing::HasSubstr;

// The nodes and definitions of one model; the first of them stands in line 2.
Reading read_model(const std::string& inside, const std::string& root = "",
                   const Options& options = {}) {
  return read_files(
      {{"m.pxn", "<pangu_model ver=\"1\"" + root + ">\n" + inside + "\n</pangu_model>\n"}},
      options);
}

std::vector<std::string> node_names(const Reading& r) {
  std::vector<std::string> names;
  for (const scene::Node& node : r.scene->nodes) names.push_back(node.name);
  return names;
}

Vec3 world_place(const Reading& r, std::int32_t node, const Vec3& point = Vec3(0)) {
  return Vec3(scene::world_from_nodes(*r.scene)[static_cast<std::size_t>(node)] * Vec4(point, 1));
}

void expect_near(const Vec3& a, const Vec3& b, double allowed) {
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], allowed) << "axis " << k;
}

TEST(Level1, APartIsStoredOnceAndShownWhereItIsUsed) {
  const Reading r = read_model(R"(
    <part name="pair"><sphere radius="1"/><use part="block" translate="0 0 3"/></part>
    <part name="block"><box size="1 2 3"/></part>
    <use part="pair"/>
    <use part="pair" name="other" translate="10 0 0" scale="2"/>
    <use part="pair"/>)");
  EXPECT_EQ(r.summary(), "");
  EXPECT_EQ(r.scene->shapes.size(), 2u);
  ASSERT_EQ(r.scene->instances.size(), 6u);
  EXPECT_EQ(node_names(r), (std::vector<std::string>{"root", "pair", "sphere1", "block", "box1",
                                                     "other", "sphere2", "block2", "box2", "pair2",
                                                     "sphere3", "block3", "box3"}));
  expect_near(world_place(r, r.scene->instances[3].node), Vec3(10, 0, 6), 0);
}

TEST(Level1, NodesShapesUsesAndJointsHaveLabels) {
  const Reading r = read_model(R"(
    <part name="wing"><box name="panel" size="1 1 0.1" label="panel"/></part>
    <node name="bus" label="bus"><box size="1"/></node>
    <use part="wing" label="left"/>
    <joint name="drive" type="continuous" label="array"><use part="wing" name="right"/></joint>
    <repeat count="2" var="k"><box name="fin" size="1" label="fin{k}"/></repeat>
    <box name="tank" size="1" label="tank" foil="smooth"/>)");
  EXPECT_EQ(r.summary(), "");
  std::map<std::string, std::string> labels;
  for (const scene::Node& node : r.scene->nodes)
    if (!node.marks.label.empty()) labels[node.name] = node.marks.label;
  EXPECT_EQ(labels.at("bus"), "bus");
  EXPECT_EQ(labels.at("wing"), "left");
  EXPECT_EQ(labels.at("drive"), "array");
  EXPECT_EQ(labels.at("panel"), "panel");
  EXPECT_EQ(labels.at("fin"), "fin1");
  // foil beside the shape that it covers belongs to its part
  std::size_t of_tank = 0;
  for (const scene::Instance& instance : r.scene->instances)
    of_tank += r.scene->nodes[static_cast<std::size_t>(instance.node)].marks.label == "tank";
  EXPECT_EQ(of_tank, 2u);
}

TEST(Level1, ARepeatCountsFromZeroAndPlacesAnew) {
  const Reading r = read_model(R"(
    <param name="pitch" value="250mm"/>
    <repeat count="4" var="k" name="bay{k}" translate="{k*pitch} 0 0" rotate="0 0 {k*90deg}">
      <box name="strut" size="{(k+1)*10mm} 1 1" translate="1 0 0"/>
      <repeat count="2" var="j"><keypoint name="p{k}_{j}" at="0 0 {j}"/></repeat>
    </repeat>)");
  EXPECT_EQ(r.summary(), "");
  ASSERT_EQ(r.scene->instances.size(), 4u);
  EXPECT_EQ(r.scene->keypoints.size(), 8u);
  EXPECT_EQ(r.scene->keypoints[5].name, "p2_1");
  const Vec3 turned[] = {{1, 0, 0}, {0.25, 1, 0}, {-0.5, 0, 0}, {0.75, -1, 0}};
  for (std::size_t k = 0; k < 4; ++k) {
    const scene::Instance& instance = r.scene->instances[k];
    // residual: cos(π/2) is 6e-17
    expect_near(world_place(r, instance.node), turned[k], 1e-15);
    const auto& box =
        std::get<geometry::Box>(r.scene->shapes[static_cast<std::size_t>(instance.shape)]);
    EXPECT_NEAR(box.size.x, 0.01 * static_cast<double>(k + 1), 1e-17);
    EXPECT_EQ(r.scene->nodes[static_cast<std::size_t>(instance.node)].name, "strut");
    EXPECT_EQ(instance.source.line, 5u);
  }
  EXPECT_EQ(r.scene->nodes[1].name, "bay0");
}

TEST(Level1, PartsSeeParametersButNotTheVariablesAroundTheirUse) {
  const Reading r = read_model(
      "<part name=\"a\"><box size=\"{i} 1 1\"/></part>\n"
      "<repeat count=\"3\" var=\"i\"><use part=\"a\"/></repeat>");
  EXPECT_THAT(r.summary(), HasSubstr("2:28 E1222"));
  EXPECT_EQ(r.log.entries().size(), 1u) << "said once, not for each use\n" << r.summary();
  EXPECT_THAT(to_text(r.log), HasSubstr("used from m.pxn:3:"));
}

TEST(Level1, PartsHaveParametersThatUsesMayGiveOtherValues) {
  const Reading r = read_model(
      "<param name=\"n\" value=\"9\"/>\n"
      "<part name=\"wing\"><param name=\"n\" value=\"2\"/><param name=\"w\" "
      "value=\"{n*10cm}\"/><repeat count=\"{n}\"><box size=\"{w} 1 1\"/></repeat></part>\n"
      "<use part=\"wing\"/><use part=\"wing\"/>\n"
      "<repeat count=\"3\"><use part=\"wing\"><with name=\"n\" value=\"{i}\"/></use></repeat>\n"
      "<use part=\"wing\"><with name=\"N\" value=\"4\"/></use>");
  EXPECT_EQ(r.log.entries().size(), 1u) << r.summary();
  EXPECT_THAT(r.summary(), HasSubstr("6:30 E1222 the part 'wing' has no parameter 'N'"));
  // 2 + 2, 0 + 1 + 2, and 2 for the one that was left out
  ASSERT_EQ(r.scene->instances.size(), 9u);
  EXPECT_EQ(r.scene->shapes.size(), 2u);
  const auto& box = std::get<geometry::Box>(r.scene->shapes[1]);
  EXPECT_NEAR(box.size.x, 0.1, 1e-17);
}

TEST(Level1, AnErrorInARepeatIsSaidOnceWithItsVariable) {
  const Reading r =
      read_model("<repeat count=\"1000\" var=\"i\"><sphere radius=\"{0.5 - i/4}\"/></repeat>");
  ASSERT_EQ(r.log.entries().size(), 1u) << r.summary();
  EXPECT_THAT(r.summary(), HasSubstr("2:46 E1202"));
  EXPECT_THAT(r.summary(), HasSubstr("with i = 2"));
  EXPECT_EQ(r.scene->instances.size(), 2u) << "those that can be made are";
}

TEST(Level1, UnitsOfTheRootAndUpright) {
  const Reading r = read_model("<box size=\"1000 2m 3\" translate=\"0 1000 0\"/>",
                               " units=\"mm\" angle=\"rad\" up=\"y\"");
  EXPECT_EQ(r.summary(), "");
  const auto& box = std::get<geometry::Box>(r.scene->shapes[0]);
  EXPECT_EQ(box.size, Vec3(1, 2, 0.003));
  // (x, y, z) goes to (x, −z, y); residual of the quaternion's rounding: 4.5e-16
  expect_near(world_place(r, r.scene->instances[0].node), Vec3(0, 0, 1), 6e-16);
  expect_near(world_place(r, r.scene->instances[0].node, Vec3(0, 0, 1)), Vec3(0, -1, 1), 6e-16);
}

TEST(Level1, AnUprightFileInsideAnotherKeepsItsScale) {
  const Reading r =
      read_files({{"m.pxn",
                   "<pangu_model ver=\"1\"><include file=\"y.pxn\" translate=\"1 0 0\" "
                   "rotate=\"0 0 90\" scale=\"2 3 5\"/></pangu_model>"},
                  {"y.pxn",
                   "<pangu_model ver=\"1\" up=\"y\"><keypoint name=\"k\" at=\"1 10 100\"/>"
                   "</pangu_model>"}});
  EXPECT_EQ(r.summary(), "");
  // upright (1, −100, 10), scaled (2, −300, 50), turned (300, 2, 50), moved; residual 1.2e-13
  expect_near(world_place(r, r.scene->keypoints[0].node, r.scene->keypoints[0].position),
              Vec3(301, 2, 50), 2e-13);
}

TEST(Level1, IncludesBringDefinitionsAndLookInTheirOwnFolder) {
  const Reading r =
      read_files({{"m.pxn",
                   "<pangu_model ver=\"1\"><include file=\"lib/parts.pxn\"/>"
                   "<param name=\"twice\" value=\"{2*gap}\"/>"
                   "<use part=\"bolt\" translate=\"{twice} 0 0\"/>"
                   "<sphere radius=\"1\" material=\"steel\"/></pangu_model>"},
                  {"lib/parts.pxn",
                   "<pangu_model ver=\"1\" units=\"mm\"><include file=\"deep.pxn\"/>"
                   "<param name=\"gap\" value=\"7mm\"/>"
                   "<part name=\"bolt\"><cylinder radius=\"3\" height=\"10\" "
                   "material=\"steel\"/></part></pangu_model>"},
                  {"lib/deep.pxn",
                   "<pangu_model ver=\"1\"><material name=\"steel\"><diffuse> 0.3 0.3 0.3 "
                   "</diffuse></material></pangu_model>"}});
  EXPECT_EQ(r.summary(), "");
  ASSERT_EQ(r.scene->instances.size(), 2u);
  EXPECT_EQ(r.scene->materials.size(), 1u);
  EXPECT_EQ(r.scene->materials[0].name, "steel");
  EXPECT_EQ(world_place(r, r.scene->instances[0].node), Vec3(0.014, 0, 0));
}

TEST(Level1, NamedMaterialsReplaceAndOverride) {
  const Reading r = read_model(R"(
    <material name="gold"><diffuse> 0.7 0.5 0.2 </diffuse><specular shine="20"> 0.2 0.2 0.2 </specular>
      <reflect> 0.8 0.2 0 </reflect></material>
    <material name="dull" base="gold"><specular shine="5"> 0.1 0.1 0.1 </specular></material>
    <node material="gold"><sphere radius="1"/><sphere radius="1" material="dull"/>
      <appearance><material><diffuse> 1 0 0 </diffuse></material><child><sphere radius="1"/></child></appearance>
    </node>
    <sphere radius="1"/>)");
  EXPECT_EQ(r.summary(), "");
  ASSERT_EQ(r.scene->instances.size(), 4u);
  const auto material = [&](std::size_t i) {
    return r.scene->materials[static_cast<std::size_t>(r.scene->instances[i].material)];
  };
  EXPECT_EQ(material(0).name, "gold");
  EXPECT_EQ(std::get<materials::BlinnPhong>(material(0).specular_brdf).shine, 20);
  EXPECT_EQ(material(1).name, "dull");
  EXPECT_EQ(material(1).diffuse, Vec3(0.7, 0.5, 0.2));
  EXPECT_EQ(std::get<materials::BlinnPhong>(material(1).specular_brdf).shine, 5);
  EXPECT_EQ(material(2).diffuse, Vec3(1, 0, 0));
  EXPECT_EQ(std::get<materials::BlinnPhong>(material(2).specular_brdf).shine, 20)
      << "an appearance inside overrides field by field";
  EXPECT_EQ(material(3).name, "default");
}

TEST(Level1, FramesAndKeypointsAreCalledByTheUsesAround) {
  const Reading r = read_model(R"(
    <part name="cam"><frame name="eye" translate="0 0 1" forward="1 0 0" up="0 0 2"/></part>
    <part name="head"><use part="cam" name="left"/><use part="cam"/></part>
    <use part="head" name="h"/><use part="cam" translate="0 0 4"/>
    <keypoint name="tip" at="1mm 2cm 3m"/>)");
  EXPECT_EQ(r.summary(), "");
  std::vector<std::string> names;
  for (const scene::Frame& frame : r.scene->frames) names.push_back(frame.name);
  EXPECT_EQ(names, (std::vector<std::string>{"h/left/eye", "h/cam/eye", "cam2/eye"}));
  EXPECT_EQ(r.scene->keypoints[0].position, Vec3(0.001, 0.02, 3));
  // x right, y down, z forward: forward +x and up +z make right −y and down −z
  const Quat q = r.scene->frames[0].rotation;
  expect_near(q * Vec3(0, 0, 1), Vec3(1, 0, 0), 3e-16);
  expect_near(q * Vec3(0, 1, 0), Vec3(0, 0, -1), 3e-16);
  expect_near(q * Vec3(1, 0, 0), Vec3(0, -1, 0), 3e-16);
}

TEST(Level1, TheBudgetOfTheTopFileHolds) {
  const Reading r = read_model(
      "<budget nearest=\"5m\" ifov=\"0.2mrad\" flux=\"0.1%\" centroid=\"0.01px\"/>"
      "<sphere radius=\"1\" tolerance=\"2mm\"/>");
  EXPECT_EQ(r.summary(), "");
  const scene::Budget& budget = r.scene->budget;
  EXPECT_EQ(budget.nearest, 5);
  EXPECT_EQ(budget.ifov, 0.0002);
  EXPECT_EQ(budget.pixels, 0.25) << "the default";
  EXPECT_EQ(budget.flux, 0.001);
  EXPECT_EQ(budget.centroid, 0.01);
  EXPECT_FALSE(budget.tolerance);
  EXPECT_EQ(r.scene->instances[0].tolerance, 0.002);
}

TEST(Level1, ParametersFromOutside) {
  Options options;
  options.parameters = {{"span", "3ft"}, {"count", "{1+1}"}};
  const std::string text =
      "<param name=\"span\" value=\"2m\"/><param name=\"half\" value=\"{span/2}\"/>"
      "<param name=\"count\" value=\"7\"/>"
      "<repeat count=\"{count}\"><box size=\"{half}\"/></repeat>";
  const Reading r = read_model(text, "", options);
  EXPECT_EQ(r.summary(), "");
  EXPECT_EQ(r.scene->instances.size(), 2u);
  EXPECT_NEAR(std::get<geometry::Box>(r.scene->shapes[0]).size.x, 0.4572, 1e-16);
  options.parameters = {{"spam", "3"}};
  const Reading wrong = read_model(text, "", options);
  EXPECT_THAT(wrong.summary(), HasSubstr("E1225"));
  EXPECT_THAT(wrong.summary(), HasSubstr("did you mean 'span'?"));
  options.parameters = {{"span", "3\"<&"}};
  EXPECT_TRUE(read_model(text, "", options).log.has_errors());
}

TEST(Level1, AParameterThatCannotBeReadIsOneProblem) {
  const Reading r = read_model(
      "<param name=\"a\" value=\"{1/0}\"/><param name=\"b\" value=\"{a*2}\"/>\n"
      "<box size=\"{b} {a} 1\"/><box size=\"1\"/><repeat count=\"{a}\"><box size=\"1\"/></repeat>");
  EXPECT_EQ(r.log.entries().size(), 1u) << r.summary();
  EXPECT_THAT(r.summary(), HasSubstr("E1223"));
  EXPECT_EQ(r.scene->instances.size(), 1u);
}

TEST(Level1, ADecalLiesOnTheShapesOfItsOwnRun) {
  const std::string pixel("P6\n1 1\n255\n\xff\xff\xff", 14);
  const auto decals = [&](const std::string& inside) {
    const Reading r = read_files(
        {{"m.pxn", "<pangu_model ver=\"1\">" + inside + "</pangu_model>"}, {"p.ppm", pixel}});
    EXPECT_EQ(r.summary(), "");
    std::vector<std::int32_t> on;
    for (const scene::Decal& decal : r.scene->decals) on.push_back(decal.instance);
    return on;
  };
  const std::string box = "<box name=\"b\" size=\"1\"/>";
  const std::string decal = "<decal on=\"b\" image=\"p.ppm\" at=\"0 0 1\" size=\"1\"/>";
  using Places = std::vector<std::int32_t>;
  EXPECT_EQ(decals("<repeat count=\"3\">" + decal + box + "</repeat>"), (Places{0, 1, 2}));
  EXPECT_EQ(decals(decal + "<repeat count=\"3\">" + box + "</repeat>"), (Places{0, 1, 2}));
  EXPECT_EQ(decals(box + "<repeat count=\"2\">" + decal + "</repeat>"), (Places{0, 0}));
  EXPECT_EQ(decals("<repeat count=\"2\">" + box + "<repeat count=\"2\">" + box + "</repeat>" +
                   decal + "</repeat>"),
            (Places{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(
      decals("<repeat count=\"2\">" + box + "<repeat count=\"2\">" + decal + "</repeat></repeat>"),
      (Places{0, 0, 1, 1}));
  EXPECT_EQ(decals("<repeat count=\"0\">" + box + "</repeat>" + decal), Places{});
}

TEST(Level1, AWithTwiceAndNamesOfTheLanguage) {
  const std::string part =
      "<part name=\"p\"><param name=\"a\" value=\"1\"/><box size=\"{a}\"/></part>";
  const Reading twice = read_model(
      part + "<use part=\"p\"><with name=\"a\" value=\"2\"/><with name=\"a\" value=\"3\"/></use>");
  EXPECT_EQ(twice.summary(), "2:119 E1210 'a' has a value already; the first one is used\n");
  EXPECT_EQ(std::get<geometry::Box>(twice.scene->shapes[0]).size, Vec3(2));
  const Reading names = read_model(
      "<param name=\"pi\" value=\"3\"/><param name=\"sin\" value=\"2\"/>\n"
      "<repeat count=\"2\" var=\"tau\"><box size=\"{1 + sin}\"/></repeat>\n"
      "<part name=\"p\"><param name=\"max\" value=\"3\"/><box size=\"{max}\"/></part><use "
      "part=\"p\"/>"
      "<param name=\"sine\" value=\"3\"/>");
  EXPECT_EQ(names.summary(),
            "2:14 E1210 'pi' is a constant of the language (give it another name)\n"
            "2:42 E1210 'sin' is a function of the language (give it another name)\n"
            "3:24 E1210 'tau' is a constant of the language (give it another name)\n"
            "4:29 E1210 'max' is a function of the language (give it another name)\n");
}

TEST(Level1, NamesThatAreMadeAreNotThoseThatAreWritten) {
  const Reading r =
      read_files({{"m.pxn", R"(<pangu_model ver="1">
    <part name="p"><keypoint name="k" at="0 0 0"/></part>
    <part name="p4"><use part="p"/></part>
    <use part="p"/><use part="p" name="p2"/><use part="p"/><use part="p4"/><use part="p"/>
    <use part="p4"/><node><use part="p" name="p5"/></node><include file="i.pxn"/>
    </pangu_model>)"},
                  {"i.pxn",
                   R"(<pangu_model ver="1"><part name="q"><keypoint name="k" at="0 0 0"/></part>
    <use part="q" name="p6"/></pangu_model>)"}});
  EXPECT_EQ(r.summary(), "");
  std::vector<std::string> names;
  for (const scene::Keypoint& k : r.scene->keypoints) names.push_back(k.name);
  EXPECT_EQ(names, (std::vector<std::string>{"p/k", "p2/k", "p3/k", "p4/p5/k", "p7/k", "p42/p8/k",
                                             "p5/k", "p6/k"}));
}

TEST(Level1, AProblemThatRepeatsIsSaidOnce) {
  const Reading twice = read_model(
      "<repeat count=\"20\"><keypoint name=\"k\" at=\"0 0 0\"/>"
      "<frame name=\"f\" forward=\"0 0 1\" up=\"0 1 0\"/></repeat>\n"
      "<keypoint name=\"k\" at=\"0 0 0\"/>");
  EXPECT_EQ(twice.summary(),
            "2:20 E1210 duplicate keypoint 'k'; this one is left out\n"
            "2:51 E1210 duplicate frame 'f'; this one is left out\n"
            "3:1 E1210 duplicate keypoint 'k'; this one is left out\n");
  for (const int length : {200, 250, 300}) {
    std::string chain = "<part name=\"p0\"><box size=\"1\"/></part>";
    for (int i = 1; i <= length; ++i)
      chain += "<part name=\"p" + std::to_string(i) + "\"><use part=\"p" + std::to_string(i - 1) +
               "\"/></part>";
    const std::string last = "<use part=\"p" + std::to_string(length) + "\"/>";
    const Reading r = read_model(chain + last + last);
    EXPECT_EQ(r.codes(), std::multiset<std::string>{"E1006"}) << r.summary();
  }
  EXPECT_EQ(read_model("<polygons><vertices> 0 0 0 1 0 0 0 1 0 </vertices></polygons>").codes(),
            std::multiset<std::string>{"E1103"});
  EXPECT_EQ(read_model("<box size=\"1\" translate=\"1e300 0 0\"/>").codes(),
            std::multiset<std::string>{"E1202"});
  const Reading element = read_model("<spere radius=\"1\"/>");
  EXPECT_THAT(element.summary(),
              HasSubstr("frame_s, appearance, texture, sphere, mesh, node, use, "
                        "repeat, import, frame, keypoint, lamp, decal, ellipsoid, box"));
}

TEST(Level1, AnglesAreShownInDegreesAndCountsWhereTheyStand) {
  const auto complaint = [](const std::string& shape) { return read_model(shape).summary(); };
  EXPECT_EQ(complaint("<sphere radius=\"1\" latitude=\"20 10\"/>"),
            "2:30 E2017 latitudes from 20 to 10 deg, expected -90 to 90 deg, the lowest "
            "first\n");
  EXPECT_EQ(complaint("<disc radius=\"1\" sector=\"10 500\"/>"),
            "2:26 E2017 a sector from 10 to 500 deg, expected an end after the beginning, by at "
            "most 360 deg\n");
  EXPECT_EQ(complaint("<disc radius=\"1\" sector=\"0 1e9\"/>"),
            "2:28 E1202 end of sector of <disc> is 1e9, expected -57200deg to 57200deg\n");
  EXPECT_EQ(complaint("<torus radius=\"1\" tube_radius=\"0.1\" segments=\"8\" rings=\"2\"/>"),
            "2:57 E2018 2 segments along the profile, expected at least 3\n");
  EXPECT_EQ(complaint("<torus radius=\"1\" tube_radius=\"0.1\" rings=\"2\"/>"),
            "2:44 E2018 2 segments along the profile, expected at least 3\n");
  EXPECT_EQ(complaint("<disc radius=\"1\" segments=\"1\"/>"),
            "2:28 E2018 1 segment about the axis, expected at least 3 for this sector\n");
  EXPECT_EQ(complaint("<sphere radius=\"1\" rings=\"8\" quads=\"2\"/>").substr(0, 9), "2:37 E120");
  EXPECT_EQ(
      complaint(
          "<sphere radius=\"1\" rings=\"8\" quads=\"3\" sector=\"0 360\" latitude=\"0 90\"/>"),
      "");
}

TEST(Level1, CyclesEndWithTheirNames) {
  EXPECT_THAT(read_model("<part name=\"a\"><use part=\"b\"/></part><part name=\"b\"><use "
                         "part=\"a\"/></part><use part=\"a\"/>")
                  .summary(),
              HasSubstr("E1312 the part 'a' uses itself through other parts"));
  EXPECT_THAT(read_model("<part name=\"a\"><use part=\"a\"/></part>").summary(),
              HasSubstr("E1312 the part 'a' uses itself"));
  EXPECT_THAT(read_model("<material name=\"m\" base=\"n\"/><material name=\"n\" base=\"m\"/>"
                         "<box size=\"1\" material=\"m\"/>")
                  .summary(),
              HasSubstr("E1312 the material 'm' is based on itself"));
}

TEST(Level1, BoundsHold) {
  EXPECT_THAT(read_model("<repeat count=\"1000000000\"><box size=\"1\"/></repeat>").summary(),
              HasSubstr("E1313"));
  // from the counts alone, and what else there is is read
  const Reading counted = read_model(
      "<repeat count=\"1000000\"><box size=\"1\"/></repeat>\n"
      "<repeat count=\"500\"><node><repeat count=\"1000\"><box size=\"1\"/><box size=\"2\"/>"
      "</repeat></node></repeat>\n<repeat count=\"0\"><repeat count=\"999999\"><box size=\"3\"/>"
      "</repeat></repeat><box size=\"4\"/>");
  EXPECT_EQ(
      counted.summary(),
      "2:16 E1313 1000000 repetitions of 1 node or more; a model has at most 1000000 with its "
      "root\n"
      "3:16 E1313 500 repetitions of 2001 nodes or more; a model has at most 1000000 with its "
      "root\n");
  EXPECT_EQ(counted.scene->instances.size(), 1u);
  Options options;
  options.limits.nodes = 1000;
  // repeats inside repeats, and parts that double
  EXPECT_THAT(read_model("<repeat count=\"100\"><repeat count=\"100\"><box size=\"1\"/></repeat>"
                         "</repeat>",
                         "", options)
                  .summary(),
              HasSubstr("E1313"));
  EXPECT_THAT(read_model("<repeat count=\"1000000\"><repeat count=\"1000000\"><repeat count=\"0\">"
                         "<box size=\"1\"/></repeat></repeat></repeat>")
                  .summary(),
              HasSubstr("E1313"));
  std::string doubling = "<part name=\"p0\"/>";
  for (int i = 1; i <= 40; ++i)
    doubling += "<part name=\"p" + std::to_string(i) + "\"><use part=\"p" + std::to_string(i - 1) +
                "\"/><use part=\"p" + std::to_string(i - 1) + "\"/></part>";
  EXPECT_THAT(read_model(doubling + "<use part=\"p40\"/>", "", options).summary(),
              HasSubstr("E1008"));
  std::string chain = "<part name=\"p0\"/>";
  for (int i = 1; i <= 5000; ++i)
    chain += "<part name=\"p" + std::to_string(i) + "\"><use part=\"p" + std::to_string(i - 1) +
             "\"/></part>";
  EXPECT_THAT(read_model(chain + "<use part=\"p5000\"/>").summary(), HasSubstr("E1006"));
}

TEST(Level1, LevelZeroStaysWhatItWas) {
  const Reading r = read_files({{"m.pxn",
                                 "<pangu_model ver=\"0\"><transform><translation> 1 2 3 "
                                 "</translation><child><group name=\"g\"/></child>"
                                 "</transform><box size=\"1\"/></pangu_model>"}});
  EXPECT_THAT(r.summary(), HasSubstr("E1106 'name' belongs to level 1"));
  EXPECT_THAT(r.summary(), HasSubstr("E1106 'box' belongs to level 1"));
  // and means the same in level 1
  const std::string inside =
      "<transform><scaling> 2 2 2 </scaling><rotation> 0 0 90 </rotation><translation> 1 2 3 "
      "</translation><child><group><sphere rings=\"4\" quads=\"4\"/></group></child></transform>";
  const Reading zero =
      read_files({{"m.pxn", "<pangu_model ver=\"0\">" + inside + "</pangu_model>"}});
  const Reading one =
      read_files({{"m.pxn", "<pangu_model ver=\"1\">" + inside + "</pangu_model>"}});
  EXPECT_EQ(one.summary(), "");
  ASSERT_EQ(zero.scene->nodes.size(), one.scene->nodes.size());
  for (std::size_t i = 0; i < zero.scene->nodes.size(); ++i)
    EXPECT_EQ(zero.scene->nodes[i].parent_from_node, one.scene->nodes[i].parent_from_node);
  EXPECT_EQ(zero.scene->shapes, one.scene->shapes);
}

}  // namespace
}  // namespace panwright::pxn::level1_test
