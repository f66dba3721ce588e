// Tokens, values and nodes of both versions.
#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstdlib>

#include "importers/vrml/internal/numbers.h"
#include "tests/importers/vrml/vrml_reading.h"

namespace panwright::importers::vrml::vrml_grammar_test {
namespace {

using testing::ElementsAre;

TEST(VrmlHeader, StandardOnesAreSilent) {
  for (const char* header : {"#VRML V2.0 utf8\n", "#VRML V2.0 utf8 made by hand\r\n",
                             "\xef\xbb\xbf#VRML V2.0 utf8\r", "#VRML V2.0 utf8"}) {
    const auto text = parsed(std::string(header) + "\nGroup {}");
    ASSERT_NE(text->document, nullptr) << header;
    EXPECT_EQ(text->document->format, Format::vrml97);
    EXPECT_TRUE(text->log.entries().empty()) << header << to_text(text->log);
  }
  const auto old = parsed("#VRML V1.0 ascii\nSeparator {}");
  ASSERT_NE(old->document, nullptr);
  EXPECT_EQ(old->document->format, Format::vrml1);
}

TEST(VrmlHeader, OddOnesAreReadWithAWarning) {
  const struct {
    const char* header;
    Format format;
  } cases[] = {{"#VRML    V2.0 utf8\n", Format::vrml97},
               {"#VRML Draft #2 V2.0 utf8\n", Format::vrml97},
               {"#VRML V2.0  utf8\n", Format::vrml97},
               {"#VRML V1.0 utf8\n", Format::vrml1}};
  for (const auto& c : cases) {
    const auto text = parsed(std::string(c.header) + "Group {}");
    ASSERT_NE(text->document, nullptr) << c.header;
    EXPECT_EQ(text->document->format, c.format);
    EXPECT_TRUE(text->log.contains(Code("W6102"))) << c.header;
  }
}

TEST(VrmlHeader, OthersAreRefused) {
  for (const std::string header :
       {"", "Group {}", "#VRML\n", "VRML V2.0 utf8\n", "#VRML V3.0 utf8\n", "\xff\xfe#\0V\0"}) {
    const auto text = parsed(header);
    EXPECT_EQ(text->document, nullptr) << header;
    EXPECT_TRUE(text->log.contains(Code("E6101"))) << header;
  }
}

TEST(VrmlHeader, AssumeStandsInForOne) {
  Options options;
  options.assume = Format::vrml97;
  const auto reading = read_files({{"m.wrl", "Shape { geometry Box {} }"}}, options);
  ASSERT_TRUE(reading->out);
  EXPECT_EQ(reading->scene().instances.size(), 1u);
  EXPECT_TRUE(reading->log.contains(Code("W6102")));
}

// ---- numbers, against the C library's

double library(const std::string& text) { return std::strtod(text.c_str(), nullptr); }

void expect_same(const std::string& text) {
  const char* p = text.c_str();
  double value = 0;
  ASSERT_EQ(read_number(p, value), NumberKind::good) << text;
  EXPECT_EQ(p, text.c_str() + text.size()) << text;
  EXPECT_EQ(std::bit_cast<std::uint64_t>(value), std::bit_cast<std::uint64_t>(library(text)))
      << text;
}

TEST(VrmlNumbers, SpellingsAsTheLibrary) {
  for (const char* text : {"0",
                           "-0",
                           "+1",
                           ".5",
                           "5.",
                           "-.5e-3",
                           "1e22",
                           "1e23",
                           "9007199254740993",
                           "1e-22",
                           "1E+5",
                           "123456789012345678901234567890",
                           "4.9e-324",
                           "2.2250738585072011e-308",
                           "1e-400",
                           "0e999999999999",
                           "0.000000000000000000000000000000000001e36",
                           "1.7976931348623157e308",
                           "179769313486231570000e288",
                           "6.02214076e23",
                           "0x",
                           "3.141592653589793238462643383279"}) {
    if (std::string(text) == "0x") continue;
    expect_same(text);
  }
}

TEST(VrmlNumbers, AMillionDigitsAsTheLibrary) {
  std::string text = "0.";
  for (int i = 0; i < 1'000'000; ++i) text += static_cast<char>('0' + i * 7 % 10);
  expect_same(text);
}

TEST(VrmlNumbers, PseudoRandomOnesAsTheLibrary) {
  std::uint64_t state = 1;
  for (int i = 0; i < 100'000; ++i) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    const auto bits = state ^ (state >> 29);
    const double value = std::bit_cast<double>(bits);
    if (!(std::abs(value) < 1e308)) continue;
    expect_same(fmt::format("{:.17g}", value));
    const double usual = static_cast<double>(static_cast<std::int32_t>(bits)) * 1e-6;
    expect_same(fmt::format("{:.6f}", usual));
    expect_same(fmt::format("{:.3e}", usual));
    if (HasFatalFailure()) return;
  }
}

TEST(VrmlNumbers, TooLargeIsSaid) {
  for (const char* text : {"1e309", "-1e400", "1e99999999999999999999", "0.001e400"}) {
    const char* p = text;
    double value = 0;
    EXPECT_EQ(read_number(p, value), NumberKind::too_large) << text;
  }
  const char* p = "4294967296";
  std::int32_t whole = 0;
  EXPECT_EQ(read_integer(p, whole), NumberKind::too_large);
}

TEST(VrmlNumbers, WholeOnes) {
  const struct {
    const char* text;
    std::int32_t value;
  } cases[] = {{"0", 0},
               {"-1", -1},
               {"+7", 7},
               {"0xFF", 255},
               {"0Xff00FF00", static_cast<std::int32_t>(0xff00ff00u)},
               {"2147483647", 2147483647},
               {"-2147483648", -2147483647 - 1}};
  for (const auto& c : cases) {
    const char* p = c.text;
    std::int32_t value = 0;
    EXPECT_EQ(read_integer(p, value), NumberKind::good) << c.text;
    EXPECT_EQ(value, c.value) << c.text;
  }
}

// ---- values

TEST(VrmlValues, BlanksCommasAndCommentsSeparate) {
  const auto text =
      parsed97("Coordinate {point[1 2,3,,4\r5\r\n6#7 8 9\n,\t-7 8e0 .9 # end\r]}# more\nGroup{}");
  EXPECT_TRUE(text->log.entries().empty()) << to_text(text->log);
  EXPECT_THAT(text->top().numbers("point"), ElementsAre(1, 2, 3, 4, 5, 6, -7, 8, 0.9));
  EXPECT_EQ(text->document->nodes.size(), 2u);
}

TEST(VrmlValues, OfEveryType) {
  const auto text = parsed97(R"(
PROTO All [
  field SFBool b TRUE field SFColor c 0.1 0.2 0.3 field SFFloat f 1.5 field SFInt32 i -3
  field SFImage p 2 1 3 0xFF0000 255 field SFRotation r 0 1 0 1.57 field SFString s "x # \"y\" \\ z"
  field SFTime t 12.5 field SFVec2f u 1 2 field SFVec3f v 1 2 3 field SFNode n NULL
  field MFColor mc [ 1 0 0, 0 1 0 ] field MFFloat mf 4 field MFInt32 mi [ ] field MFTime mt [1 2]
  field MFRotation mr [ 0 0 1 0 1 0 0 3 ] field MFString ms [ "a" "b", "two
lines" ] field MFVec2f mu [ 1 2 3 4 ] field MFVec3f mv 1 2 3 field MFNode mn [ Group {} ] ] { Group {} }
All {}
)");
  EXPECT_TRUE(text->log.entries().empty()) << to_text(text->log);
  const Node& all = text->top();
  const auto numbers = [&](const char* field) { return all.find(field)->value.numbers(); };
  EXPECT_THAT(all.find("b")->value.integers(), ElementsAre(1));
  EXPECT_THAT(numbers("c"), ElementsAre(0.1, 0.2, 0.3));
  EXPECT_THAT(all.find("i")->value.integers(), ElementsAre(-3));
  EXPECT_THAT(all.find("p")->value.integers(), ElementsAre(2, 1, 3, 0xff0000, 255));
  EXPECT_THAT(numbers("r"), ElementsAre(0, 1, 0, 1.57));
  EXPECT_EQ(all.find("s")->value.strings()[0], "x # \"y\" \\ z");
  EXPECT_TRUE(all.find("n")->value.nodes().empty());
  EXPECT_THAT(numbers("mc"), ElementsAre(1, 0, 0, 0, 1, 0));
  EXPECT_THAT(numbers("mf"), ElementsAre(4));
  EXPECT_TRUE(all.find("mi")->value.integers().empty());
  EXPECT_THAT(numbers("mr"), ElementsAre(0, 0, 1, 0, 1, 0, 0, 3));
  EXPECT_THAT(all.find("ms")->value.strings(), ElementsAre("a", "b", "two\nlines"));
  EXPECT_THAT(numbers("mv"), ElementsAre(1, 2, 3));
  EXPECT_EQ(all.find("mn")->value.nodes().size(), 1u);
}

TEST(VrmlValues, ATwoMegabyteLine) {
  std::string body = "Coordinate { point [";
  for (int i = 0; i < 100'000; ++i) body += fmt::format(" {}.25 -{} 1e-{},", i, i, i % 30);
  const auto text = parsed97(body + "] }");
  EXPECT_TRUE(text->log.entries().empty());
  const auto points = text->top().numbers("point");
  ASSERT_EQ(points.size(), 300'000u);
  EXPECT_EQ(points[3 * 77'777], 77777.25);
  EXPECT_EQ(points[3 * 99'999 + 2], library("1e-9"));
}

TEST(VrmlValues, Latin1InNamesStringsAndComments) {
  const auto text = parsed97("# gr\xfc\xdf\nDEF T\xfcr WorldInfo { title \"T\xfcr\" }");
  EXPECT_EQ(text->log.warnings(), 1u);
  EXPECT_TRUE(text->log.contains(Code("W6116")));
  EXPECT_EQ(text->top().name, "T\xc3\xbcr");
  EXPECT_EQ(text->top().string("title"), "T\xc3\xbcr");
}

TEST(VrmlValues, ListsOfWordsInVrml1) {
  const auto text = parsed(
      "#VRML V1.0 ascii\nSeparator { Cone { parts (SIDES | BOTTOM) } Cylinder { parts TOP } "
      "ShapeHints { shapeType SOLID creaseAngle 1 } Texture2 { image 1 1 1 0xF0 } }");
  EXPECT_TRUE(text->log.entries().empty()) << to_text(text->log);
  const auto children = text->top().children;
  ASSERT_EQ(children.size(), 4u);
  EXPECT_THAT(children[0]->strings("parts"), ElementsAre("SIDES", "BOTTOM"));
  EXPECT_THAT(children[1]->strings("parts"), ElementsAre("TOP"));
  EXPECT_EQ(children[2]->string("shapeType"), "SOLID");
  EXPECT_EQ(children[2]->string("faceType"), "CONVEX");
  EXPECT_THAT(children[3]->integers("image"), ElementsAre(1, 1, 1, 0xf0));
}

// ---- nodes

TEST(VrmlNodes, AllOfBothStandardsAreKnown) {
  EXPECT_EQ(specs97().size(), 54u);  // ISO/IEC 14772-1, table 6.1 … 6.54
  EXPECT_EQ(specs10().size(), 36u);  // VRML 1.0c, "Nodes"
  for (const NodeSpec& spec : specs97()) {
    const auto text = parsed97(std::string(spec.name) + " {}");
    EXPECT_TRUE(text->log.entries().empty()) << to_text(text->log);
    EXPECT_EQ(text->top().type, spec.name);
  }
  for (const NodeSpec& spec : specs10()) {
    const auto text = parsed("#VRML V1.0 ascii\n" + std::string(spec.name) + " {}");
    EXPECT_TRUE(text->log.entries().empty()) << to_text(text->log);
  }
}

TEST(VrmlNodes, DefaultsOfTheStandard) {
  const auto text = parsed97("Transform {} IndexedFaceSet {} Extrusion {} Material {}");
  EXPECT_THAT(text->top(0).numbers("rotation"), ElementsAre(0, 0, 1, 0));
  EXPECT_THAT(text->top(0).numbers("scale"), ElementsAre(1, 1, 1));
  EXPECT_TRUE(text->top(0).nodes("children").empty());
  EXPECT_TRUE(text->top(1).flag("ccw"));
  EXPECT_EQ(text->top(1).number("creaseAngle"), 0);
  EXPECT_EQ(text->top(1).node("coord"), nullptr);
  EXPECT_THAT(text->top(2).numbers("crossSection"), ElementsAre(1, 1, 1, -1, -1, -1, -1, 1, 1, 1));
  EXPECT_THAT(text->top(2).numbers("spine"), ElementsAre(0, 0, 0, 0, 1, 0));
  EXPECT_EQ(text->top(3).vec3("diffuseColor"), Vec3(0.8));
}

TEST(VrmlNodes, AUseIsTheSameNode) {
  const auto text =
      parsed97("Group { children [ DEF A Group {} USE A ] } DEF A Box {} Group { children USE A }");
  EXPECT_TRUE(text->log.entries().empty()) << to_text(text->log);
  const auto first = text->top(0).nodes("children");
  EXPECT_EQ(first[0], first[1]);
  // the last DEF of a name counts
  EXPECT_EQ(text->top(2).nodes("children")[0], &text->top(1));
}

TEST(VrmlNodes, PlacesOfItems) {
  const auto text = parsed97("Coordinate { point [\n 1 2 3, # 9 9 9\n 4 5 6 ] }");
  const SourceSpan second = place_of_item(text->log.sources(), *text->top().find("point"), 1);
  const Position p = text->log.sources().position(second.file, second.begin);
  EXPECT_EQ(p.line, 4u);
  EXPECT_EQ(p.column, 2u);
}

TEST(VrmlNodes, Vrml1UnknownNodesWithFieldsAndIsA) {
  const auto text = parsed(
      "#VRML V1.0 ascii\nSeparator { Ball { fields [ SFFloat size, MFString tags ] isA [ "
      "\"Sphere\" "
      "] size 3 tags [ \"a\" ] radius 2 } Cube {} }");
  const auto children = text->top().children;
  ASSERT_EQ(children.size(), 2u) << to_text(text->log);
  EXPECT_EQ(children[0]->spec, spec10("Sphere"));
  EXPECT_EQ(children[0]->number("radius"), 2);
  EXPECT_EQ(text->log.errors(), 0u) << to_text(text->log);
}

}  // namespace
}  // namespace panwright::importers::vrml::vrml_grammar_test
