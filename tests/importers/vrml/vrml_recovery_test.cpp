// Wrong texts: every problem has its place, and what stands around it is kept.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/importers/vrml/vrml_reading.h"

namespace panwright::importers::vrml::vrml_recovery_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// Two boxes, of which the second comes after what is wrong.
std::unique_ptr<Reading> with(const std::string& wrong) {
  return read97("Shape { geometry Box {} }\n" + wrong + "\nDEF Last Shape { geometry Box {} }\n");
}

TEST(VrmlRecovery, MisspeltFieldsHaveSuggestions) {
  const auto reading = with(
      "Shape {\n apperance Appearance { material DEF M Material {} }\n"
      " appearance Appearance { material Material { diffColor 1 0 0 transparency 0.5 } }\n"
      " geometry Sphere {} }");
  EXPECT_THAT(reading->places(), ElementsAre("4:2 E6104", "5:46 E6104", "5:35 W6008"));
  EXPECT_THAT(reading->log.entries()[0].hint, HasSubstr("'appearance'"));
  EXPECT_THAT(reading->log.entries()[1].hint, HasSubstr("'diffuseColor'"));
  ASSERT_EQ(reading->scene().instances.size(), 3u);
  EXPECT_EQ(reading->out->materials[1].opacity, 0.5);  // the field after the wrong one
  EXPECT_EQ(exit_code(reading->log), 1);
}

TEST(VrmlRecovery, TooFewNumbersLoseTheFieldAlone) {
  const auto reading =
      with("DEF T Transform {\n  translation 0 0\n  children [ Shape { geometry Box {} } ] }");
  EXPECT_THAT(reading->places(), ElementsAre("4:15 E6106"));
  EXPECT_THAT(reading->log.entries()[0].message, HasSubstr("needs 3 numbers, got 2"));
  EXPECT_EQ(reading->scene().instances.size(), 3u);
  EXPECT_EQ(reading->node("T")->parent_from_node, scene::Transform{});
}

TEST(VrmlRecovery, TooManyNumbersKeepTheFirst) {
  const auto reading = with("DEF T Transform { translation 1 2 3 4 }");
  EXPECT_THAT(reading->places(), ElementsAre("3:31 E6106"));
  EXPECT_EQ(reading->node("T")->parent_from_node.translation, Vec3(1, 2, 3));
}

TEST(VrmlRecovery, AListWithARemainderKeepsWholeItems) {
  const auto text = parsed97("Coordinate { point [ 1 2 3 4 5 ] }");
  EXPECT_TRUE(text->log.contains(Code("E6106")));
  EXPECT_THAT(text->top().numbers("point"), ElementsAre(1, 2, 3));
}

TEST(VrmlRecovery, EventsHaveNoValue) {
  const auto reading = with(
      "Shape { geometry IndexedFaceSet { set_coordIndex [ 0 1 2 -1 ]\n"
      " coord Coordinate { point [ 0 0 0 1 0 0 0 1 0 ] } coordIndex [ 0 1 2 -1 ] } }");
  EXPECT_THAT(reading->places(), ElementsAre("3:35 E6104"));
  EXPECT_EQ(reading->scene().instances.size(), 3u);
}

TEST(VrmlRecovery, LetterCaseAloneIsForgiven) {
  const auto reading = with("shape { Geometry Box { size 1 2 3 } }");
  EXPECT_THAT(reading->places(), ElementsAre("3:1 W6118", "3:9 W6118"));
  ASSERT_EQ(reading->scene().instances.size(), 3u);
  EXPECT_EQ(std::get<geometry::Box>(reading->scene().shapes[1]).size, Vec3(1, 2, 3));
}

TEST(VrmlRecovery, NumbersThatAreNone) {
  const auto text = parsed97("Coordinate { point [ 1 nan -inf 1.#IND 5 6 1e999 7 1.2.3, 0 0 0 ] }");
  EXPECT_EQ(text->log.errors(), 4u) << to_text(text->log);  // nan and -inf are counted together
  EXPECT_THAT(text->top().numbers("point"), ElementsAre(1, 0, 0, 0, 5, 6, 0, 7, 0, 0, 0, 0));
}

TEST(VrmlRecovery, WordsAndStringsInAListOfNumbers) {
  const auto text = parsed97("Coordinate { point [ 1 2 oops 3 \"4 5 6\" 4 5 6 ] }");
  EXPECT_EQ(text->log.errors(), 2u);
  EXPECT_THAT(text->top().numbers("point"), ElementsAre(1, 2, 3, 4, 5, 6));
}

TEST(VrmlRecovery, MissingBracketsAndBraces) {
  const auto list = with(
      "Shape { geometry IndexedFaceSet { coordIndex [ 0 1 2 -1\n"
      " coord Coordinate { point [ 0 0 0 1 0 0 0 1 0 } } }");
  EXPECT_THAT(list->places(), ElementsAre("4:2 E6103", "4:47 E6103"));
  EXPECT_EQ(list->scene().instances.size(), 3u);

  const auto children = with("Group { children [ Shape { geometry Box {} } }");
  EXPECT_THAT(children->places(), ElementsAre("3:46 E6103"));
  EXPECT_EQ(children->scene().instances.size(), 3u);

  const auto open =
      read97("Group { children [\nShape { geometry Box {}\nShape { geometry Box {} }");
  EXPECT_EQ(open->scene().instances.size(), 2u) << to_text(open->log);
  EXPECT_TRUE(open->log.contains(Code("E6112")));

  const auto close = with("} ] )");
  EXPECT_EQ(close->scene().instances.size(), 2u);
  EXPECT_TRUE(close->log.contains(Code("E6103")));
}

TEST(VrmlRecovery, NodesWithoutAFieldAreKept) {
  const auto reading = with("Group { Shape { geometry Box {} } }");
  EXPECT_THAT(reading->places(), ElementsAre("3:9 E6103"));
  EXPECT_EQ(reading->scene().instances.size(), 3u);
}

TEST(VrmlRecovery, UnknownNodesAreSkippedAndTheirNamesKept) {
  const auto reading = with(
      "KambiThing { foo 1 2 bar [ \"}\" ] # }\n baz DEF S Shape { geometry Box {} } x { y } }\n"
      "USE S");
  EXPECT_THAT(reading->places(), ElementsAre("3:1 W6105"));
  EXPECT_EQ(reading->scene().instances.size(), 3u);
  EXPECT_EQ(with("Bx {}")->log.entries()[0].hint, "did you mean 'Box'?");
  EXPECT_THAT(with("Separator {}")->log.entries()[0].hint, HasSubstr("VRML 1.0"));
}

TEST(VrmlRecovery, UnknownNamesAndStrayWords) {
  const auto reading = with("Group { children [ USE Nothing 5 foo ] }\nDEF USE\nROUTE a.b TO c.d");
  EXPECT_THAT(reading->places(), ElementsAre("3:24 E6108", "3:32 E6103", "3:34 E6103", "5:1 E6103",
                                             "5:7 E6117", "5:14 E6117"))
      << to_text(reading->log);
  EXPECT_EQ(reading->scene().instances.size(), 2u);
}

TEST(VrmlRecovery, AStringWithoutEndEndsWithItsLine) {
  const auto reading = read97("WorldInfo { title \"open }\n}\nShape { geometry Box {} }");
  EXPECT_THAT(reading->places(), ElementsAre("2:19 E6112"));
  EXPECT_EQ(reading->scene().instances.size(), 1u);
}

TEST(VrmlRecovery, AZeroByteIsSaid) {
  std::string body = "Shape { geometry Box {} }\nX\nShape { geometry Box {} }";
  body[26] = '\0';
  const auto reading = read97(body);
  EXPECT_THAT(reading->places(), ElementsAre("3:1 E6103"));
  EXPECT_EQ(reading->scene().instances.size(), 2u);
}

TEST(VrmlRecovery, RoutesAreChecked) {
  const std::string nodes =
      "DEF T Transform {} DEF P PositionInterpolator {} DEF S Script { eventIn SFVec3f at }\n";
  EXPECT_THAT(read97(nodes + "ROUTE P.value_changed TO T.set_translation")->places(), IsEmpty());
  EXPECT_THAT(read97(nodes + "ROUTE P.value_changed TO S.at")->places(), IsEmpty());
  EXPECT_THAT(read97(nodes + "ROUTE P.value_changed TO T.rotation")->places(),
              ElementsAre("3:26 E6117"));
  EXPECT_THAT(read97(nodes + "ROUTE P.wrong TO T.rotation")->places(), ElementsAre("3:7 E6117"));
}

// ---- prototypes that contradict themselves

TEST(VrmlRecovery, Prototypes) {
  const auto places = [](const std::string& body) { return read97(body)->places(); };
  EXPECT_THAT(places("PROTO P [ field SFBool a TRUE field SFInt32 a 1 ] { Group {} }"),
              ElementsAre("2:31 E6110"));
  EXPECT_THAT(places("PROTO P [ exposedField SFBool a TRUE eventIn SFBool set_a ] { Group {} }"),
              ElementsAre("2:38 E6110"));
  EXPECT_THAT(places("PROTO P [ field SFFloat r 1 ] { Shape { geometry Sphere { radius IS q } } }"),
              ElementsAre("2:69 E6110"));
  EXPECT_THAT(places("PROTO P [ field SFBool r TRUE ] { Sphere { radius IS r } }"),
              ElementsAre("2:54 E6110"));
  EXPECT_THAT(places("Group { children IS x }"), ElementsAre("2:21 E6110"));
  EXPECT_THAT(places("Script { exposedField SFBool x TRUE }"), ElementsAre("2:10 E6110"));
  EXPECT_THAT(places("PROTO P [ field SFNode a DEF G Group {} field SFNode b USE G ] { Group {} }"),
              ElementsAre("2:60 E6108"));
  EXPECT_THAT(places("DEF G Group {} PROTO P [ ] { Group { children USE G } }"),
              ElementsAre("2:51 E6108"));
}

}  // namespace
}  // namespace panwright::importers::vrml::vrml_recovery_test
