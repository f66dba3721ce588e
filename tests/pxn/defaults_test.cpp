// Defaults of the language: what the schema says of an absent attribute is what its absence does.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "base/text.h"
#include "geometry/tessellate/shape_parameters.h"
#include "importers/import.h"
#include "pxn/writer.h"
#include "schemas/generated/pxn_schema.h"
#include "tests/pxn/reading.h"

namespace panwright::pxn::defaults_test {
namespace {

using schemas::ElementId;

std::string brdf(const std::string& element) {
  return "<material name='m'>" + element + "</material><box size='1' material='m'/>";
}

std::string foil(const std::string& operation, const std::string& attributes = "") {
  return "<mli type='cone' " + attributes +
         "><mli_settings><width>1</width><height>0.5</height><xgrid>50</xgrid></mli_settings>"
         "<mli_operations><random>0.01</random>" +
         operation + "</mli_operations></mli>";
}

// A model with the element, whose attributes are to be put where @ stands.
const std::map<ElementId, std::string>& models() {
  static const std::map<ElementId, std::string> kModels = {
      {ElementId::pangu_model, "<sphere/><box size='1' rotate='1 2 3'/>"},
      {ElementId::sphere_1, "<sphere @/>"},
      {ElementId::mesh,
       "<mesh @><positions><vec3>0 0 0</vec3><vec3>1 0 0</vec3><vec3>0 1 0</vec3></positions>"
       "<tristrips><tristrip>0 1 2</tristrip></tristrips></mesh>"},
      {ElementId::ellipsoid, "<ellipsoid radii='1 2 3' @/>"},
      {ElementId::box, "<box size='1 2 3' @/>"},
      {ElementId::cylinder, "<cylinder radius='1' height='2' @/>"},
      {ElementId::cone, "<cone radius='1' height='2' @/>"},
      {ElementId::disc, "<disc radius='1' @/>"},
      {ElementId::torus, "<torus radius='1' tube_radius='0.1' @/>"},
      {ElementId::dish, "<dish diameter='1' focal_length='0.5' @/>"},
      {ElementId::plane, "<plane size='1 2' @/>"},
      {ElementId::tube, "<tube radius='0.1' @><path>0 0 0 0 0 1 0 1 2</path></tube>"},
      {ElementId::lathe, "<lathe @><profile>1 0 2 1 1 2</profile></lathe>"},
      {ElementId::extrude, "<extrude height='1' @><outline>0 0 1 0 0 1</outline></extrude>"},
      {ElementId::polygons,
       "<polygons @><vertices>0 0 0 1 0 0 0 1 0</vertices><face><outline>0 1 2</outline></face>"
       "</polygons>"},
      {ElementId::subdiv,
       "<subdiv @><vertices>0 0 0 1 0 0 0 1 0</vertices><face><outline>0 1 2</outline></face>"
       "</subdiv>"},
      {ElementId::cage_crease,
       "<subdiv><vertices>0 0 0 1 0 0 0 1 0 1 1 1</vertices><face><outline>0 1 2</outline></face>"
       "<face><outline>1 3 2</outline></face><crease @>1 2</crease></subdiv>"},
      {ElementId::cage_corner,
       "<subdiv><vertices>0 0 0 1 0 0 0 1 0 1 1 1</vertices><face><outline>0 1 2</outline></face>"
       "<face><outline>1 3 2</outline></face><corner @>1 2</corner></subdiv>"},
      {ElementId::mli, foil("", "@")},
      {ElementId::wrinkle, foil("<wrinkle wavelength='0.1' amplitude='0.01' @/>")},
      {ElementId::crease, foil("<crease density='100' depth='0.01' length='0.1' @/>")},
      {ElementId::fractal, foil("<fractal rms='0.01' @/>")},
      {ElementId::seam, foil("<seam position='0.2' width='0.05' height='0.01' @/>")},
      {ElementId::button, foil("<button pitch='0.3' reach='0.1' @/>")},
      {ElementId::node, "<node @><box size='1'/></node>"},
      {ElementId::use, "<part name='p'><box size='1'/></part><use part='p' @/>"},
      {ElementId::repeat, "<repeat count='3' name='r' @><box size='{i+1}'/></repeat>"},
      {ElementId::include_1, "<include file='part.pxn' @/>"},
      {ElementId::import, "<import file='a.wrl' @/>"},
      {ElementId::assign,
       "<material name='m'/><import file='a.wrl'><assign material='m' @/></import>"},
      {ElementId::joint,
       "<joint name='l' type='continuous'><joint name='j' type='continuous' @ "
       "mimic='l'><box size='1'/></joint></joint>"},
      {ElementId::import_joint,
       "<import file='a.wrl'><joint nodes='*' name='j' type='continuous' @ mimic='l'/></import>"
       "<joint name='l' type='continuous' value='0.5rad'/>"},
      {ElementId::transform_1, "<transform @><box size='1'/></transform>"},
      {ElementId::frame, "<frame name='f' @/>"},
      {ElementId::lamp, "<lamp name='l' type='spot' half_angle='0.3' intensity='2' @/>"},
      {ElementId::sun, "<scene><sun direction='1 0 0' @/></scene>"},
      {ElementId::coat,
       "<material name='m'><coat n='1.5' thickness='1mm' @/></material>"
       "<box size='1' material='m'/>"},
      {ElementId::named_material, "<material name='m' @/><box size='1' material='m'/>"},
      {ElementId::cutout,
       "<material name='m'><cutout image='a.ppm' @/></material>"
       "<plane size='1' material='m'/>"},
      {ElementId::cells,
       "<material name='m'><cells columns='2' rows='3' @/></material>"
       "<plane size='1' material='m'/>"},
      {ElementId::oren, brdf("<oren @>0.3</oren>")},
      {ElementId::hapke, brdf("<hapke @>0.3 0.1 1 0.2</hapke>")},
      {ElementId::beckmann, brdf("<beckmann @>0.3</beckmann>")},
      {ElementId::ggx, brdf("<ggx @>0.3</ggx>")},
      {ElementId::retroreflector, brdf("<retroreflector @/>")},
      {ElementId::specular, brdf("<specular @>0.3 0.3 0.3</specular>")},
  };
  return kModels;
}

// Elements whose defaults no scene shows: they are held elsewhere.
//   budget, decal   the compiler takes them: tests/compiler
//   planet          a scene keeps its words as they are given
//   terrain, dem, albedo   are no part of a scene: terrain_test.cpp
const std::set<ElementId> kElsewhere = {ElementId::budget,  ElementId::decal, ElementId::planet,
                                        ElementId::terrain, ElementId::dem,   ElementId::albedo};

Reading read_model(const std::string& nodes, const std::string& root = "") {
  std::string texture = "P6 2 2 255\n";
  for (int i = 0; i < 12; ++i) texture += static_cast<char>(20 * i);
  return read_files(
      {{"m.pxn", "<pangu_model ver='1' " + root + ">" + nodes + "</pangu_model>"},
       {"part.pxn", "<pangu_model ver='1'><box size='1'/></pangu_model>"},
       {"a.ppm", texture},
       {"a.wrl",
        "#VRML V2.0 utf8\nShape { appearance Appearance { material Material { diffuseColor 1 0 0 } "
        "texture ImageTexture { url \"a.ppm\" } } geometry IndexedFaceSet { coord Coordinate { "
        "point [0 0 0, 1 0 0, 0 1 0.2, 1 1 0] } coordIndex [0 1 2 -1 1 3 2 -1] } }\n"
        "Shape { geometry Cone {} }\n"}});
}

std::string with(std::string text, const std::string& attributes) {
  const std::size_t at = text.find('@');
  if (at != std::string::npos) text.replace(at, 1, attributes);
  return text;
}

// The default as a file would say it. Angles of these are written in radians, lengths in metres.
std::string written(const schemas::Attribute& attribute) {
  if (!attribute.initial_word.empty()) return std::string(attribute.initial_word);
  const bool angle = attribute.value.dimension == schemas::Dimension::angle;
  std::string out;
  for (const double number : attribute.initial)
    out += format_double(number) + (angle ? "rad " : " ");
  return out;
}

TEST(Defaults, GivenOnesChangeNothing) {
  int compared = 0;
  for (std::size_t id = 0; id < schemas::kPxn.elements.size(); ++id) {
    const schemas::Element& element = schemas::kPxn.elements[id];
    if (!element.supported || kElsewhere.contains(static_cast<ElementId>(id))) continue;
    for (const schemas::Attribute& attribute : element.attributes) {
      if (attribute.initial.empty() && attribute.initial_word.empty()) continue;
      const std::string what =
          fmt::format("{} {}='{}'", element.name, attribute.name, written(attribute));
      const auto model = models().find(static_cast<ElementId>(id));
      ASSERT_NE(model, models().end()) << "no model shows " << what;
      const bool root = static_cast<ElementId>(id) == ElementId::pangu_model;
      const std::string given = fmt::format("{}='{}'", attribute.name, written(attribute));
      const std::string& nodes = model->second;
      const Reading without = read_model(with(nodes, ""));
      const Reading with_it = read_model(with(nodes, root ? "" : given), root ? given : "");
      ASSERT_TRUE(without.scene && with_it.scene) << what << "\n" << with_it.summary();
      EXPECT_EQ(without.log.has_errors(), false) << what << "\n" << without.summary();
      EXPECT_EQ(scene_difference(*without.scene, *with_it.scene, Likeness::same), "") << what;
      EXPECT_EQ(to_text(*without.scene), to_text(*with_it.scene)) << what;
      ++compared;
    }
  }
  EXPECT_GT(compared, 100);
}

// Another value than the default does something: the comparison above sees these attributes.
TEST(Defaults, OthersDoChangeSomething) {
  for (const auto& [id, attribute] : std::initializer_list<std::pair<ElementId, std::string>>{
           {ElementId::sphere_1, "radius='2'"},
           {ElementId::sphere_1, "latitude='0 90'"},
           {ElementId::box, "bevel='0.1' edges='round'"},
           {ElementId::cone, "top_radius='0.5'"},
           {ElementId::cylinder, "caps='top'"},
           {ElementId::cylinder, "sector='0 90'"},
           {ElementId::tube, "closed='1'"},
           {ElementId::lathe, "curve='spline'"},
           {ElementId::extrude, "smooth='1'"},
           {ElementId::import, "crease='1'"},
           {ElementId::import, "up='z'"},
           {ElementId::import, "units='mm'"},
           {ElementId::import, "primitives='5'"},
           {ElementId::frame, "translate='1 2 3'"},
           {ElementId::lamp, "at='1 2 3'"},
           {ElementId::lamp, "state='off'"},
           {ElementId::node, "scale='2'"}}) {
    const std::string& nodes = models().at(id);
    const Reading without = read_model(with(nodes, ""));
    const Reading other = read_model(with(nodes, attribute));
    ASSERT_TRUE(without.scene && other.scene) << attribute << other.summary();
    EXPECT_NE(to_text(*without.scene), to_text(*other.scene)) << attribute;
  }
}

// In the root's units, not in metres.
TEST(Defaults, ARadiusInUnitsOfTheRoot) {
  const Reading r = read_model("<sphere/>", "units='mm'");
  ASSERT_TRUE(r.scene) << r.summary();
  EXPECT_EQ(std::get<geometry::Sphere>(r.scene->shapes[0]).radius, 1e-3);
  // and it is written: the text may come to stand in a file of other units
  EXPECT_NE(to_text(*r.scene).find("radius=\"0.001\""), std::string::npos);
}

TEST(Defaults, ImportersHaveTheSame) {
  const auto attributes =
      schemas::kPxn.elements[static_cast<std::size_t>(ElementId::import)].attributes;
  const importers::Options options;
  namespace attribute = schemas::attribute;
  EXPECT_EQ(attributes[attribute::import_crease].initial[0], options.crease_angle);
  EXPECT_EQ(attributes[attribute::import_deflection].initial[0], options.deflection);
  EXPECT_EQ(attributes[attribute::import_primitives].initial[0], options.primitives);
}

// ---- shapes: geometry/tessellate/shape_parameters.h and the schema name the same things

TEST(ShapeParameters, AreThoseOfTheSchema) {
  const auto check = []<class S>(const S& shape) {
    if constexpr (!std::same_as<S, geometry::MeshShape>) {
      const std::string_view kind = geometry::kind_name(geometry::Shape(shape));
      const schemas::Element* element = nullptr;
      for (const schemas::Element& each : schemas::kPxn.elements)
        if (each.shape && each.name == kind && each.level == 1) element = &each;
      ASSERT_NE(element, nullptr) << kind;
      std::set<std::string_view> unknown;
      for (const schemas::Attribute& attribute : element->attributes)
        unknown.insert(attribute.name);
      for (const schemas::Slot& slot : element->slots)
        for (const ElementId child : slot.elements)
          unknown.insert(schemas::kPxn.elements[static_cast<std::size_t>(child)].name);
      for (const std::string_view common :
           {"name", "material", "back", "tolerance", "translate", "rotate", "quat", "scale"})
        EXPECT_EQ(unknown.erase(common), 1u) << kind << " " << common;
      geometry::visit_parameters(shape, [&](std::string_view name, const auto&... members) {
        const bool known = unknown.erase(name) > 0;
        // what turns about an axis has counts along a profile, whether the language lets it or not
        EXPECT_TRUE(known || name == "rings") << kind << " " << name;
        const auto found = std::ranges::find(element->attributes, name, &schemas::Attribute::name);
        if (found == element->attributes.end()) return;
        // choices count the words from 0; their default is the first, as that of the members
        const auto check_word = [&](const auto& member) {
          using Member = std::decay_t<decltype(member)>;
          if constexpr (std::same_as<Member, bool> || std::same_as<Member, geometry::Caps>) {
            EXPECT_EQ(found->value.words[static_cast<std::size_t>(member)], found->initial_word)
                << kind << " " << name;
          }
        };
        (check_word(members), ...);
      });
      for (const std::string_view left : unknown)
        if (left != "foil" && left != "label")  // of what lies over it, and of images
          ADD_FAILURE() << kind << " " << left << " is no parameter of the shape";
    }
  };
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    (check(std::variant_alternative_t<I, geometry::Shape>{}), ...);
  }
  (std::make_index_sequence<std::variant_size_v<geometry::Shape>>());
}

// Shapes that differ in one parameter have other hashes, and each parameter is written and read.
TEST(ShapeParameters, EachOneCounts) {
  const auto check = []<class S>(const S& plain) {
    if constexpr (!std::same_as<S, geometry::MeshShape>) {
      int parameters = 0;
      geometry::visit_parameters(plain, [&](std::string_view, const auto&...) { ++parameters; });
      for (int which = 0; which < parameters; ++which) {
        S changed = plain;
        int at = 0;
        std::string_view name;
        geometry::visit_parameters(changed,
                                   [&](std::string_view each, auto& member, auto&... more) {
                                     if (at++ != which) return;
                                     name = each;
                                     using Member = std::decay_t<decltype(member)>;
                                     if constexpr (std::same_as<Member, double>)
                                       member += 0.25;
                                     else if constexpr (std::same_as<Member, Vec3>)
                                       member.y += 0.25;
                                     else if constexpr (std::same_as<Member, bool>)
                                       member = !member;
                                     else if constexpr (std::same_as<Member, geometry::Caps>)
                                       member = geometry::Caps::top;
                                     else if constexpr (std::same_as<Member, std::uint32_t>)
                                       member += 5;
                                     else
                                       member.emplace_back();
                                     ((more += 0.125), ...);
                                   });
        // the counts of a sphere go together
        if (name == "rings" || name == "quads")
          if constexpr (std::same_as<S, geometry::Sphere>) continue;
        EXPECT_FALSE(changed == plain) << geometry::kind_name(plain) << " " << name;
        EXPECT_NE(geometry::hash_of(changed), geometry::hash_of(plain))
            << geometry::kind_name(plain) << " " << name;
      }
    }
  };
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    (check(std::variant_alternative_t<I, geometry::Shape>{}), ...);
  }
  (std::make_index_sequence<std::variant_size_v<geometry::Shape>>());
}

}  // namespace
}  // namespace panwright::pxn::defaults_test
