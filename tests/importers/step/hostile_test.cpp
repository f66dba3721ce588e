// STEP texts that are damaged, too large, or made to do harm.

#include <fmt/core.h>
#include <gtest/gtest.h>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>

#include "tests/importers/step/reading.h"
#include "tests/importers/step/sample.h"

namespace panwright::importers::step::hostile_test {
namespace {

std::string half_cylinder() {
  return text_of(BRepPrimAPI_MakeCylinder(100, 300, kPi).Shape(), "half");
}

std::string two_parts() {
  Sample sample;
  const TDF_Label half = sample.part(BRepPrimAPI_MakeCylinder(100, 300, kPi).Shape(), "half");
  const TDF_Label box = sample.part(BRepPrimAPI_MakeBox(100, 200, 300).Shape(), "box");
  const TDF_Label top = sample.assembly("top");
  sample.place(top, half, gp_Trsf(), "a");
  sample.place(top, box, gp_Trsf(), "b");
  sample.color(half, {1, 0, 0});
  return sample.text();
}

// The text with one place changed; the place must be there.
std::string changed(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, text.npos) << from;
  if (at != text.npos) text.replace(at, from.size(), to);
  return text;
}

// The number in front of the entity that begins so, with "#".
std::string number_of(const std::string& text, const std::string& entity, std::size_t from = 0) {
  const std::size_t at = text.find(" = " + entity, from);
  EXPECT_NE(at, text.npos) << entity;
  const std::size_t begin = text.rfind('#', at);
  return text.substr(begin, at - begin);
}

// Bits of a counter (Steele and others' splitmix64).
std::uint64_t mixed(std::uint64_t n) {
  n = (n + 1) * 0x9e3779b97f4a7c15u;
  n = (n ^ n >> 30) * 0xbf58476d1ce4e5b9u;
  n = (n ^ n >> 27) * 0x94d049bb133111ebu;
  return n ^ n >> 31;
}

void expect_sound_or_refused(const std::string& text, const std::string& what) {
  Options options;
  options.limits.triangles = 1'000'000;
  const auto reading = read_here(text, options);
  if (reading->out)
    EXPECT_EQ(scene::check(reading->scene()), "") << what;
  else
    EXPECT_TRUE(reading->log.has_errors()) << what;
}

TEST(StepHostile, CutTextsAreReadAsFarAsTheyGo) {
  const std::string text = two_parts();
  std::size_t with_shapes = 0;
  for (std::size_t i = 0; i < 100; ++i) {
    const std::size_t size = text.size() * i / 100;
    const auto reading = read_here(text.substr(0, size));
    if (reading->out) {
      EXPECT_EQ(scene::check(reading->scene()), "") << size;
    }
    EXPECT_GE(reading->count(Code("E6601")), 1u) << size;
    if (reading->out && !reading->scene().instances.empty()) ++with_shapes;
  }
  RecordProperty("with_shapes", static_cast<int>(with_shapes));
}

TEST(StepHostile, ChangedBytes) {
  const std::string text = two_parts();
  const std::size_t data = text.find("DATA;");
  for (std::uint64_t i = 0; i < 300; ++i) {
    const std::uint64_t random = mixed(i);
    std::string damaged = text;
    char& byte = damaged[data + random % (text.size() - data)];
    // half of them stay digits, and so mostly sound statements of other meaning
    if (i % 2 == 0 || byte < '0' || byte > '9')
      byte = static_cast<char>(byte ^ static_cast<char>(1 + (random >> 40) % 127));
    else
      byte = static_cast<char>('0' + (random >> 40) % 10);
    expect_sound_or_refused(damaged, fmt::format("change {}", i));
  }
}

TEST(StepHostile, WhatIsNoStepIsRefused) {
  for (const char* text : {"ISO-10303-21", "ISO-10303-21;", "ISO-10303-21;\nHEADER;\nENDSEC;\n",
                           "ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\nENDSEC;\nEND-ISO-10303-21;\n",
                           "ISO-10303-21;DATA;#1=CARTESIAN_POINT('',(0.,0.,0.));ENDSEC;"
                           "END-ISO-10303-21;",
                           "ISO-10303-21;DATA;#1=NO_SUCH_ENTITY();ENDSEC;END-ISO-10303-21;",
                           "ISO-10303-21;DATA;/* #1=", "ISO-10303-21;DATA;#1=A('"}) {
    const auto reading = read(text);
    EXPECT_FALSE(reading->out) << text;
    EXPECT_GE(reading->count(Code("E6601")), 1u) << text;
  }
}

TEST(StepHostile, ABrokenStatementIsSaidAndTheRestRead) {
  const std::string text = half_cylinder();
  const std::string face = number_of(text, "ADVANCED_FACE");
  const auto reading = read(changed(text, face + " = ADVANCED_FACE(", face + " = ADVANCED_FACE(,"));
  EXPECT_GE(reading->count(Code("E6601")), 1u);
  EXPECT_GT(reading->line_of(Code("E6601")), 10u);
  ASSERT_TRUE(reading->out) << to_text(reading->log);
  EXPECT_EQ(scene::check(reading->scene()), "");
}

TEST(StepHostile, FacesThatFailAreNamed) {
  std::string text = half_cylinder();
  // a cylinder without a radius
  const std::size_t at = text.find("CYLINDRICAL_SURFACE");
  ASSERT_NE(at, text.npos);
  const std::size_t radius = text.rfind(',', text.find(';', at));
  text.replace(radius, text.find(')', radius) - radius, ",-1.");
  const auto reading = read(text);
  ASSERT_TRUE(reading->out) << to_text(reading->log);
  EXPECT_GE(reading->count(Code("W6602")), 1u) << to_text(reading->log);
  EXPECT_GT(reading->line_of(Code("W6602")), 10u);
  EXPECT_EQ(scene::check(reading->scene()), "");
}

// OpenCASCADE 7.6 follows these into nothing, and ends the process.
TEST(StepHostile, ReferencesToOtherKindsAreLeftOut) {
  const std::string text = two_parts();
  const std::string direction = number_of(text, "DIRECTION");
  for (const char* entity : {"DEFINITIONAL_REPRESENTATION('',(", "SURFACE_STYLE_USAGE(.BOTH.,",
                             "FILL_AREA_STYLE('',(", "ADVANCED_FACE('',("}) {
    const std::size_t at = text.find(entity);
    if (at == text.npos) {
      ADD_FAILURE() << entity;
      continue;
    }
    const std::size_t begin = at + std::string(entity).size();
    const std::size_t end = text.find_first_of(",)", begin);
    const auto reading = read(text.substr(0, begin) + direction + text.substr(end));
    ASSERT_TRUE(reading->out) << entity << to_text(reading->log);
    EXPECT_GE(reading->count(Code("W6602")), 1u) << entity;
    EXPECT_GT(reading->line_of(Code("W6602")), 10u) << entity;
    EXPECT_FALSE(reading->scene().instances.empty()) << entity;
  }
}

TEST(StepHostile, EntitiesThatContainThemselves) {
  const std::string text = half_cylinder();
  const std::string shell = number_of(text, "CLOSED_SHELL");
  const std::string face = number_of(text, "ADVANCED_FACE");
  const auto reading = read(
      changed(text, face + " = ADVANCED_FACE('',(", face + " = ADVANCED_FACE('',(" + shell + ","));
  EXPECT_FALSE(reading->out);
  EXPECT_EQ(reading->count(Code("E6601")), 1u);
  EXPECT_GT(reading->line_of(Code("E6601")), 10u);
}

TEST(StepHostile, AssembliesThatContainThemselves) {
  const std::string text = two_parts();
  const std::string use = "NEXT_ASSEMBLY_USAGE_OCCURRENCE(";
  const std::size_t begin = text.find(use);
  ASSERT_NE(begin, text.npos);
  const std::size_t end = text.find(';', begin);
  std::string statement = text.substr(begin, end - begin);
  // the part becomes the whole
  const std::size_t whole = statement.find('#');
  const std::size_t part = statement.find('#', whole + 1);
  const std::string name = statement.substr(whole, statement.find(',', whole) - whole);
  statement.replace(part, statement.find(',', part) - part, name);
  const auto reading = read(text.substr(0, begin) + statement + text.substr(end));
  EXPECT_FALSE(reading->out);
  EXPECT_EQ(reading->count(Code("E6601")), 1u) << to_text(reading->log);
}

TEST(StepHostile, DeepReferences) {
  std::string text = "ISO-10303-21;\nDATA;\n#1=DIRECTION('',(1.,0.,0.));\n";
  for (int i = 2; i <= 200'000; ++i)
    text += fmt::format("#{}=TRIMMED_CURVE('',#{},(),(),.T.,.CARTESIAN.);\n", i, i - 1);
  const auto reading = read(text + "ENDSEC;\nEND-ISO-10303-21;\n");
  EXPECT_FALSE(reading->out);
  EXPECT_EQ(reading->count(Code("E6002")), 1u);
}

TEST(StepHostile, LimitsHold) {
  const std::string text = two_parts();
  Options options;
  options.limits.triangles = 10;
  EXPECT_EQ(read(text, options)->count(Code("E6002")), 1u);
  options = {};
  options.limits.nodes = 3;
  EXPECT_EQ(read(text, options)->count(Code("E6002")), 1u);
  options = {};
  options.limits.depth = 1;
  EXPECT_GE(read(text, options)->count(Code("E6002")), 1u);
}

TEST(StepHostile, OtherFilesAreNotRead) {
  std::string text = half_cylinder();
  const std::string product = number_of(text, "PRODUCT_DEFINITION(");
  text = changed(text, "ENDSEC;\nEND-ISO",
                 "#900001=DOCUMENT_TYPE('');\n"
                 "#900002=DOCUMENT_FILE('/etc/hostname','/etc/hostname',$,#900001,'',$);\n"
                 "#900003=IDENTIFICATION_ROLE('external document id and location',$);\n"
                 "#900004=EXTERNAL_SOURCE(IDENTIFIER(''));\n"
                 "#900005=APPLIED_EXTERNAL_IDENTIFICATION_ASSIGNMENT('/etc/hostname',#900003,"
                 "#900004,(#900002));\n"
                 "#900006=DOCUMENT_REPRESENTATION_TYPE('digital',#900002);\n"
                 "#900007=APPLIED_DOCUMENT_REFERENCE(#900002,'',(" +
                     product + "));\nENDSEC;\nEND-ISO");
  const auto reading = read(text);
  ASSERT_TRUE(reading->out) << to_text(reading->log);
  EXPECT_EQ(reading->count(Code("W6004")), 1u);
  EXPECT_EQ(reading->scene().instances.size(), 1u);
}

// Nothing that OpenCASCADE prints reaches the terminal.
TEST(StepHostile, NothingIsPrinted) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  read(half_cylinder());
  read_here(half_cylinder());
  read_here("ISO-10303-21;DATA;#1=NO_SUCH_ENTITY();ENDSEC;END-ISO-10303-21;");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace panwright::importers::step::hostile_test
