// Prototypes and inlined files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/importers/vrml/vrml_reading.h"

namespace panwright::importers::vrml::vrml_prototype_test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

double radius(const Reading& reading, std::size_t shape) {
  return std::get<geometry::Sphere>(reading.scene().shapes.at(shape)).radius;
}

const std::string kBall =
    "PROTO Ball [ field SFFloat size 2 exposedField SFVec3f at 0 0 0 field SFNode look NULL ] {\n"
    " Transform { translation IS at children Shape { appearance IS look geometry Sphere { radius "
    "IS size } } }\n TimeSensor {} }\n";

TEST(VrmlPrototypes, ValuesAndDefaults) {
  const auto reading = read97(
      kBall +
      "DEF A Ball {} DEF B Ball { size 5 at 1 2 3 look Appearance { material DEF Red Material "
      "{ diffuseColor 1 0 0 } } }");
  EXPECT_THAT(reading->places(), IsEmpty()) << to_text(reading->log);
  ASSERT_EQ(reading->scene().instances.size(), 2u);
  EXPECT_EQ(radius(*reading, 0), 2);
  EXPECT_EQ(radius(*reading, 1), 5);
  EXPECT_EQ(reading->node("B")->parent_from_node.translation, Vec3(1, 2, 3));
  EXPECT_EQ(reading->node("A")->parent_from_node.translation, Vec3(0));
  EXPECT_EQ(reading->out->materials[1].name, "Red");
}

TEST(VrmlPrototypes, Nested) {
  const auto reading =
      read97(kBall +
             "PROTO Pair [ field SFFloat s 1 field MFNode more [] ] {\n"
             " PROTO Inner [ field SFFloat r 9 ] { Ball { size IS r } }\n"
             " Group { children [ Inner { r IS s } Inner {} Group { children IS more } ] } }\n"
             "Pair { s 3 more [ Ball { size 4 } Pair {} ] }");
  EXPECT_THAT(reading->places(), IsEmpty()) << to_text(reading->log);
  std::vector<double> radii;
  for (const auto& instance : reading->scene().instances)
    radii.push_back(radius(*reading, static_cast<std::size_t>(instance.shape)));
  EXPECT_THAT(radii, ElementsAre(3, 9, 4, 1, 9));
}

TEST(VrmlPrototypes, SharedNodesInABodyStayShared) {
  const auto reading = read97(
      "PROTO P [ field SFFloat x 1 ] { Group { children [ DEF S Shape { geometry Sphere { radius "
      "IS "
      "x } } USE S ] } }\nP { x 2 } P { x 3 }");
  ASSERT_EQ(reading->scene().instances.size(), 4u);
  EXPECT_EQ(reading->scene().shapes.size(), 2u);
}

TEST(VrmlPrototypes, ANodeOfTheBodyOnlyAsFirst) {
  const auto reading = read97(
      "PROTO M [ field SFColor c 0 0 1 ] { Material { diffuseColor IS c } }\n"
      "Shape { appearance Appearance { material M { c 0 1 0 } } geometry Box {} }");
  EXPECT_THAT(reading->places(), IsEmpty()) << to_text(reading->log);
  EXPECT_EQ(reading->out->materials[0].base_color, Vec3(0, 1, 0));
}

TEST(VrmlPrototypes, ExternalOnes) {
  const std::string library = kHeader97 + kBall + "PROTO Second [] { Shape { geometry Box {} } }";
  const std::string top =
      kHeader97 +
      "EXTERNPROTO Mine [ field SFFloat size ] [ \"missing.wrl\" \"parts/lib.wrl\" ]\n"
      "EXTERNPROTO Other [ ] \"parts/lib.wrl#Second\"\n"
      "EXTERNPROTO None [ ] \"parts/lib.wrl#Third\"\n"
      "Mine { size 7 } Mine {} Other {} None {}";
  const auto reading = read_files({{"top.wrl", top}, {"parts/lib.wrl", library}});
  EXPECT_THAT(reading->places(), ElementsAre("4:13 E6010")) << to_text(reading->log);
  ASSERT_EQ(reading->scene().instances.size(), 3u);
  EXPECT_EQ(radius(*reading, 0), 7);
  EXPECT_EQ(radius(*reading, 1), 2);  // the default of the prototype itself
  ASSERT_EQ(reading->scene().inputs.size(), 2u);
  EXPECT_EQ(reading->scene().inputs[1].path, "parts/lib.wrl");
}

TEST(VrmlPrototypes, AFileMayNameItself) {
  const auto reading = read_files(
      {{"self.wrl", kHeader97 + "EXTERNPROTO E [ field SFFloat size ] \"self.wrl#Ball\"\n" + kBall +
                        "E { size 3 }"}});
  EXPECT_THAT(reading->places(), IsEmpty()) << to_text(reading->log);
  EXPECT_EQ(radius(*reading, 0), 3);
}

TEST(VrmlPrototypes, OnesThatContainThemselves) {
  const auto values = read_files(
      {{"a.wrl", kHeader97 + "EXTERNPROTO A [ field SFFloat x ] \"b.wrl\"\nA { x 2 }"},
       {"b.wrl", kHeader97 +
                     "EXTERNPROTO A [ field SFFloat x ] \"b.wrl#B\"\n"
                     "PROTO B [ field SFFloat x 1 ] { Group { children [ A { x IS x } Shape "
                     "{ geometry Box {} } ] } }"}});
  ASSERT_TRUE(values->out);
  EXPECT_EQ(values->count(Code("E6109")), 1u) << to_text(values->log);
  EXPECT_EQ(values->scene().instances.size(), 1u);

  const auto plain = read_files(
      {{"b.wrl", kHeader97 + "EXTERNPROTO A [ ] \"b.wrl#B\"\nPROTO B [ ] { A {} }\nB {}\nShape { "
                             "geometry Box {} }"}});
  ASSERT_TRUE(plain->out);
  EXPECT_EQ(plain->count(Code("E6109")), 1u) << to_text(plain->log);
  EXPECT_EQ(plain->scene().instances.size(), 1u);
}

// ---- inlined files

TEST(VrmlInline, PathsAreThoseOfTheFileAround) {
  const auto reading = read_files(
      {{"model/top.wrl",
        kHeader97 + "Inline { url [ \"gone.wrl\" \"parts/a.wrl\" ] }\nInline { url \"../b.wrl\" }"},
       {"model/parts/a.wrl", kHeader97 + "DEF In Inline { url \"../../b.wrl\" }"},
       {"b.wrl", kHeader97 + "Shape { geometry Box {} }"}});
  EXPECT_THAT(reading->places(), IsEmpty()) << to_text(reading->log);
  EXPECT_EQ(reading->scene().instances.size(), 2u);
  EXPECT_EQ(reading->scene().shapes.size(), 1u);
  ASSERT_NE(reading->node("In"), nullptr);
  EXPECT_EQ(reading->scene().instances[0].source.file, "b.wrl");
}

TEST(VrmlInline, WithoutHeaderOrNotThere) {
  const auto reading = read_files(
      {{"top.wrl", kHeader97 +
                       "Inline { url \"a.wrl\" }\nInline { url \"no.wrl\" }\n"
                       "Inline { url \"../out.wrl\" }\nInline { url \"http://x.org/y.wrl\" }"},
       {"a.wrl", "Shape { geometry Box {} }"}});
  EXPECT_THAT(reading->places(), ElementsAre("1:1 W6102", "3:14 E6010", "4:14 E6010", "5:14 E6010"))
      << to_text(reading->log);
  EXPECT_NE(to_text(reading->log).find("--root"), std::string::npos);
  EXPECT_EQ(reading->scene().instances.size(), 1u);
}

TEST(VrmlInline, WhatIsNoVrmlIsNotReadAsSuch) {
  const auto reading = read_files(
      {{"top.wrl", kHeader97 + "Inline { url \"a.jpg\" }\nInline { url [ \"b.txt\" \"c.wrl\" ] }"},
       {"a.jpg", std::string("\xff\xd8\xff\xe0\0\0JFIF { } ] [", 18)},
       {"b.txt", "some words"},
       {"c.wrl", "Separator { Cube { } }"}});
  EXPECT_EQ(reading->log.errors(), 1u) << to_text(reading->log);
  EXPECT_EQ(reading->count(Code("E6010")), 1u);
  EXPECT_EQ(reading->count(Code("W6004")), 2u);
  EXPECT_EQ(reading->scene().instances.size(), 1u);
}

TEST(VrmlInline, Cycles) {
  const auto reading =
      read_files({{"a.wrl", kHeader97 + "Inline { url \"b.wrl\" }\nShape { geometry Box {} }"},
                  {"b.wrl", kHeader97 + "Inline { url \"a.wrl\" }\nInline { url \"b.wrl\" }\n"
                                        "Shape { geometry Sphere {} }"}});
  ASSERT_TRUE(reading->out);
  EXPECT_EQ(reading->count(Code("E6109")), 2u);
  EXPECT_EQ(reading->scene().instances.size(), 2u);
}

TEST(VrmlInline, TheOtherVersion) {
  const auto reading = read_files(
      {{"a.wrl", kHeader97 + "Transform { translation 0 0 5 children Inline { url \"b.wrl\" } }"},
       {"b.wrl", "#VRML V1.0 ascii\nSeparator { Cube {} WWWInline { name \"c.wrl\" } }"},
       {"c.wrl", kHeader97 + "Shape { geometry Sphere {} }"}});
  EXPECT_THAT(reading->places(), IsEmpty()) << to_text(reading->log);
  EXPECT_EQ(reading->scene().instances.size(), 2u);
}

}  // namespace
}  // namespace panwright::importers::vrml::vrml_prototype_test
