// CAD files in a model: what stands where, in what, and what is left out.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "pxn/import_template.h"
#include "pxn/materials.h"
#include "pxn/pxn.h"
#include "pxn/reader/pattern.h"

namespace panwright::pxn::import_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::UnorderedElementsAre;

constexpr const char* kBoxes = R"(#VRML V2.0 utf8
DEF bus Transform { translation 0 2 0 children [
  Shape { appearance Appearance { material DEF Gold_Foil Material { diffuseColor 0.8 0.5 0.1 } }
          geometry DEF Plate IndexedFaceSet {
            coord Coordinate { point [ 0 0 0, 1 0 0, 1 1 0, 0 1 0 ] } coordIndex [ 0 1 2 3 ] } }
  DEF wing1 Transform { translation 3 0 0 children
    Shape { appearance Appearance { material DEF Blue_Cells Material { diffuseColor 0 0 0.2 } }
            geometry USE Plate } }
  DEF wing2 Transform { translation -3 0 0 children
    Shape { appearance Appearance { material USE Blue_Cells } geometry USE Plate } }
] }
)";

struct Reading {
  scene::Scene scene;
  DiagnosticLog log;
};

Reading reading(const std::string& body, const std::string& cad = kBoxes) {
  Reading out;
  const MemoryFile files[] = {
      {"model/top.pxn", "<pangu_model ver=\"1\">" + body + "</pangu_model>"},
      {"model/cad/sat.wrl", cad}};
  auto scene = read_memory(files, {}, out.log);
  if (scene) out.scene = std::move(*scene);
  EXPECT_EQ(scene::check(out.scene), "");
  return out;
}

// Instances by the names of their nodes' parents and of their materials.
std::multimap<std::string, std::string> dressed(const scene::Scene& scene) {
  std::multimap<std::string, std::string> out;
  for (const scene::Instance& instance : scene.instances) {
    std::int32_t node = instance.node;
    const auto named = [&](std::int32_t n) {
      const std::string& name = scene.nodes[static_cast<std::size_t>(n)].name;
      return name.starts_with("wing") || name == "bus";
    };
    while (node >= 0 && !named(node)) node = scene.nodes[static_cast<std::size_t>(node)].parent;
    out.emplace(node < 0 ? "?" : scene.nodes[static_cast<std::size_t>(node)].name,
                scene.materials[static_cast<std::size_t>(instance.material)].name);
  }
  return out;
}

using Pairs = std::pair<const std::string, std::string>;

bool matches(std::string_view pattern, std::string_view text) {
  return Pattern(pattern).fits(text);
}

TEST(Pattern, stars_and_question_marks) {
  EXPECT_TRUE(matches("", ""));
  EXPECT_TRUE(matches("*", ""));
  EXPECT_TRUE(matches("a*c", "abbbc"));
  EXPECT_TRUE(matches("a*b*c", "a-b-b-c"));
  EXPECT_TRUE(matches("p?nel*", "panel12"));
  EXPECT_TRUE(matches("**x", "aax"));
  EXPECT_FALSE(matches("a*c", "abb"));
  EXPECT_FALSE(matches("?", ""));
  EXPECT_FALSE(matches("panel", "Panel"));
  // one that would take for ever by trying
  EXPECT_FALSE(matches(std::string(40, '*') + "b", std::string(20000, 'a')));
}

TEST(Pattern, a_question_mark_is_a_whole_character) {
  EXPECT_TRUE(matches("?", "\xc3\xa4"));
  EXPECT_FALSE(matches("??", "\xc3\xa4"));
  EXPECT_TRUE(matches("a*?z", "a\xe2\x82\xacz"));
}

TEST(Pattern, what_is_escaped_is_plain) {
  EXPECT_TRUE(matches("a\\*", "a*"));
  EXPECT_FALSE(matches("a\\*", "ab"));
  EXPECT_TRUE(matches("\\?\\\\", "?\\"));
  EXPECT_TRUE(matches("\\x7bx\\x7D", "{x}"));
  EXPECT_TRUE(matches("a\\b", "a\\b"));
  EXPECT_TRUE(matches("\\x7", "\\x7"));
  EXPECT_TRUE(matches("a\\", "a\\"));
}

// Every name of up to three of these characters has a pattern that fits no other of them.
TEST(Pattern, of_a_name_fits_it_alone) {
  const std::string_view letters[] = {"a", "*",    "?",   "\\",       "{",           "}",
                                      " ", "\x01", "x7b", "\xc3\xa4", "\xef\xbf\xbe"};
  std::vector<std::string> names;
  for (const auto a : letters) {
    names.emplace_back(a);
    for (const auto b : letters) {
      names.push_back(std::string(a) + std::string(b));
      for (const auto c : letters)
        names.push_back(std::string(a) + std::string(b) + std::string(c));
    }
  }
  for (std::size_t i = 0; i < names.size(); i += 7) {
    const std::string text = pattern_of(names[i]);
    const Pattern pattern(text);
    for (const char c : text) EXPECT_TRUE(c >= ' ' || c < 0) << names[i];
    EXPECT_EQ(text.find_first_of("{}"), text.npos) << names[i];
    for (const std::string& name : names)
      if (pattern.fits(name) != (name == names[i])) ADD_FAILURE() << text << " and " << name;
  }
}

TEST(Pattern, numbers_tell_materials_of_one_name_apart) {
  std::vector<importers::CadMaterial> materials(7);
  const char* const names[] = {"foil", "", "foil", "foil#2", "", "foil", "#1"};
  for (std::size_t i = 0; i < 7; ++i) materials[i].name = names[i];
  EXPECT_THAT(numbered_names(materials),
              ElementsAre("foil", "#2", "foil#3", "foil#2", "#3", "foil#4", "#1"));
}

TEST(Import, stands_where_it_is_put_with_its_own_materials) {
  const Reading r = reading("<import file=\"cad/sat.wrl\" name=\"sat\" translate=\"0 0 10\"/>");
  EXPECT_EQ(r.log.errors(), 0u) << to_text(r.log);
  EXPECT_THAT(dressed(r.scene),
              UnorderedElementsAre(Pairs("bus", "Gold_Foil"), Pairs("wing1", "Blue_Cells"),
                                   Pairs("wing2", "Blue_Cells")));
  // y is up in the file, z here: (3, 2, 0) goes to (3, 0, 2), and the import to 10
  const auto world = scene::world_from_nodes(r.scene);
  bool found = false;
  for (const scene::Instance& instance : r.scene.instances) {
    const Vec3 at(world[static_cast<std::size_t>(instance.node)][3]);
    found = found || glm::length(at - Vec3(3, 0, 12)) < 1e-12;
    EXPECT_TRUE(instance.prunable);
  }
  EXPECT_TRUE(found);
  // one mesh, however often it stands there
  EXPECT_EQ(r.scene.shapes.size(), 1u);
  EXPECT_THAT(r.scene.inputs.back().path, "cad/sat.wrl");
}

TEST(Import, rules_apply_in_their_order) {
  const Reading r = reading(R"(
    <material name="metal" preset="aluminium_bare"/> <material name="cells" preset="cells_gaas"/>
    <import file="cad/sat.wrl"> <assign material="metal"/> <assign materials="*Cells" material="cells"/>
      <assign nodes="wing2" material="metal"/> </import>)");
  EXPECT_EQ(r.log.errors() + r.log.warnings(), 0u) << to_text(r.log);
  EXPECT_THAT(dressed(r.scene), UnorderedElementsAre(Pairs("bus", "metal"), Pairs("wing1", "cells"),
                                                     Pairs("wing2", "metal")));
}

TEST(Import, a_rule_for_a_node_holds_for_all_below) {
  const Reading all = reading(R"(<material name="metal" preset="aluminium_bare"/>
    <import file="cad/sat.wrl"> <assign nodes="bus" material="metal"/> </import>)");
  EXPECT_THAT(dressed(all.scene),
              UnorderedElementsAre(Pairs("bus", "metal"), Pairs("wing1", "metal"),
                                   Pairs("wing2", "metal")));
  const Reading one = reading(R"(<material name="metal" preset="aluminium_bare"/>
    <import file="cad/sat.wrl"> <assign nodes="*bus/wing?" material="metal"/> </import>)");
  EXPECT_THAT(dressed(one.scene),
              UnorderedElementsAre(Pairs("bus", "Gold_Foil"), Pairs("wing1", "metal"),
                                   Pairs("wing2", "metal")));
}

TEST(Import, paths_do_not_depend_on_units_and_axes) {
  for (const char* way : {"", " up=\"z\" units=\"m\"", " units=\"mm\""}) {
    const Reading r = reading(std::string("<material name=\"metal\" preset=\"aluminium_bare\"/>") +
                              "<import file=\"cad/sat.wrl\"" + way +
                              "> <assign nodes=\"bus/wing1\" material=\"metal\"/> </import>");
    // 7 mm in place of 7 m is plausible and reported
    const std::size_t expected = std::string_view(way).find("mm") == std::string_view::npos ? 0 : 1;
    EXPECT_EQ(r.log.warnings(), expected) << way << to_text(r.log);
    EXPECT_EQ(r.log.contains(Code("W6013")), expected == 1);
  }
}

TEST(Import, attributes_without_effect_are_noted) {
  const auto notes = [](const std::string& attributes) {
    const Reading r = reading("<import file=\"cad/sat.wrl\" " + attributes + "/>");
    EXPECT_EQ(r.log.errors(), 0u) << to_text(r.log);
    std::size_t count = 0;
    for (const Diagnostic& entry : r.log.entries())
      if (entry.code == Code("N1405")) ++count;
    return count;
  };
  EXPECT_EQ(notes("weld=\"1mm\" normals=\"crease\" primitives=\"20\""), 0u);
  EXPECT_EQ(notes("clean=\"no\""), 0u);
  EXPECT_EQ(notes("clean=\"no\" weld=\"1mm\" normals=\"crease\""), 2u);
  EXPECT_EQ(notes("scene=\"a\" deflection=\"1mm\""), 2u);
}

TEST(Import, our_own_files_are_no_cad_files) {
  const Reading r = reading("<import file=\"cad/sat.wrl\"/>", "<pangu_model ver=\"0\"/>");
  EXPECT_THAT(to_text(r.log), HasSubstr("<include> in a pxn file"));
}

TEST(Import, what_is_removed_is_gone_with_its_nodes) {
  const Reading r =
      reading(R"(<import file="cad/sat.wrl" hidden="keep"> <remove nodes="wing2"/> </import>)");
  EXPECT_THAT(dressed(r.scene),
              UnorderedElementsAre(Pairs("bus", "Gold_Foil"), Pairs("wing1", "Blue_Cells")));
  for (const scene::Node& node : r.scene.nodes) EXPECT_NE(node.name, "wing2");
  for (const scene::Instance& instance : r.scene.instances) EXPECT_FALSE(instance.prunable);
}

TEST(Import, a_pattern_that_fits_nothing_names_what_is_near) {
  const Reading r = reading(R"(<material name="metal" preset="aluminium_bare"/>
    <import file="cad/sat.wrl"> <assign materials="Gold_Foyl*" material="metal"/>
      <remove nodes="antenna"/> </import>)");
  EXPECT_TRUE(r.log.contains(Code("W1501")));
  const std::string text = to_text(r.log);
  EXPECT_THAT(text, HasSubstr("did you mean 'Gold_Foil'?"));
  EXPECT_THAT(text, HasSubstr("'wing1'"));
  EXPECT_EQ(r.scene.instances.size(), 3u);
}

TEST(Import, the_same_file_twice_is_stored_once) {
  const Reading r =
      reading(R"(<repeat count="3"> <import file="cad/sat.wrl" translate="{10*i} 0 0"/>
    </repeat> <import file="cad/sat.wrl" units="mm"/>)");
  EXPECT_EQ(r.log.errors(), 0u) << to_text(r.log);
  EXPECT_EQ(r.scene.instances.size(), 12u);
  EXPECT_EQ(r.scene.shapes.size(), 2u);  // the second way of taking it has its own
  std::size_t times = 0;
  for (const scene::Input& input : r.scene.inputs) times += input.path == "cad/sat.wrl";
  EXPECT_EQ(times, 1u);
}

TEST(Import, problems_of_the_file_say_who_imported_it) {
  const Reading r =
      reading("<import file=\"cad/sat.wrl\"/>", "#VRML V2.0 utf8\nShape { apperance NULL }\n");
  const std::string text = to_text(r.log);
  EXPECT_THAT(text, HasSubstr("cad/sat.wrl:2:9: error:"));
  EXPECT_THAT(text, HasSubstr("did you mean 'appearance'?"));
  EXPECT_THAT(text, HasSubstr("top.pxn:1:"));
}

TEST(Import, files_outside_and_missing_ones_are_refused) {
  EXPECT_TRUE(reading("<import file=\"cad/sta.wrl\"/>").log.contains(Code("E1301")));
  EXPECT_TRUE(reading("<import file=\"../sat.wrl\"/>").log.contains(Code("E1303")));
}

TEST(Import, its_nodes_count_towards_the_limit) {
  Options options;
  options.limits.nodes = 6;
  const MemoryFile files[] = {
      {"top.pxn", "<pangu_model ver=\"1\"><import file=\"sat.wrl\"/></pangu_model>"},
      {"sat.wrl", kBoxes}};
  DiagnosticLog log;
  (void)read_memory(files, options, log);
  EXPECT_TRUE(log.contains(Code("E1008")) || log.contains(Code("E6002"))) << to_text(log);
}

// ---- templates of imports

TEST(Skeleton, reads_back_with_every_material_of_the_file_assigned) {
  const importers::MemoryFile files[] = {{"sat.wrl", kBoxes}};
  DiagnosticLog log;
  const auto imported = importers::import_memory(files, {}, log);
  ASSERT_TRUE(imported) << to_text(log);
  const std::string text = import_template(*imported, "sat.wrl", " units=\"m\"");
  const MemoryFile model[] = {{"top.pxn", text}, {"sat.wrl", kBoxes}};
  const auto scene = read_memory(model, {}, log);
  ASSERT_TRUE(scene);
  EXPECT_EQ(log.errors() + log.warnings(), 0u) << text << to_text(log);
  EXPECT_THAT(dressed(*scene),
              UnorderedElementsAre(Pairs("bus", "gold_foil"), Pairs("wing1", "blue_cells"),
                                   Pairs("wing2", "blue_cells")));
  EXPECT_THAT(text, HasSubstr("preset=\"mli_gold_kapton\""));
  EXPECT_THAT(text, HasSubstr("preset=\"cells_silicon\""));
}

// A row of triangles, each in a material with a name of its own kind.
std::string triangles_with(const std::vector<std::string>& names) {
  nlohmann::json out = {{"asset", {{"version", "2.0"}}}, {"scene", 0}};
  out["buffers"] = {{{"byteLength", 36},
                     {"uri",
                      "data:application/octet-stream;base64,"
                      "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}}};
  out["bufferViews"] = {{{"buffer", 0}, {"byteLength", 36}}};
  out["accessors"] = {{{"bufferView", 0},
                       {"componentType", 5126},
                       {"count", 3},
                       {"type", "VEC3"},
                       {"min", {0, 0, 0}},
                       {"max", {1, 1, 0}}}};
  for (std::size_t i = 0; i < names.size(); ++i) {
    nlohmann::json material = {
        {"pbrMetallicRoughness",
         {{"baseColorFactor", {0.6 + 0.01 * static_cast<double>(i), 0.3, 0.05, 1}},
          {"metallicFactor", 0}}}};
    if (!names[i].empty()) material["name"] = names[i];
    out["materials"].push_back(material);
    out["meshes"].push_back(
        {{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"material", i}}}}});
    out["nodes"].push_back({{"mesh", i},
                            {"name", "n" + std::to_string(i)},
                            {"translation", {2 * static_cast<double>(i), 0, 0}}});
    out["scenes"][0]["nodes"].push_back(i);
  }
  return out.dump();
}

TEST(Skeleton, each_material_is_assigned_its_own_whatever_its_name) {
  const std::vector<std::string> names = {
      "a<gold foil>&\"c\"", "50% {gold foil}",       " --gold foil-- ", "*gold foil",
      "gold foil 3",        "a<gold foil>&\"d\"",    "gold foil",       "gold foil",
      "gold foil\x01\x02",  "gold foil\xef\xbf\xbe", "?gold foil",      "\\*gold foil",
      "gold foil*"};
  const MemoryFile cad = {"sat.gltf", triangles_with(names)};
  const importers::MemoryFile files[] = {{cad.path, cad.bytes}};
  DiagnosticLog log;
  const auto imported = importers::import_memory(files, {}, log);
  ASSERT_TRUE(imported) << to_text(log);
  ASSERT_EQ(imported->materials.size(), names.size());
  const std::string text = import_template(*imported, "sat.gltf", "");
  const MemoryFile model[] = {{"top.pxn", text}, cad};
  const auto scene = read_memory(model, {}, log);
  ASSERT_TRUE(scene) << text << to_text(log);
  EXPECT_EQ(log.errors() + log.warnings(), 0u) << text << to_text(log);
  // as many materials as there were, one on each node
  std::set<std::string> worn;
  for (const auto& [node, material] : dressed(*scene)) worn.insert(material);
  EXPECT_EQ(worn.size(), names.size()) << text;
}

}  // namespace
}  // namespace panwright::pxn::import_test
