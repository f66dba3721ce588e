// Texts made to hurt: cut, flipped, deep, doubling.
#include <gtest/gtest.h>

#include <chrono>
#include <functional>

#include "base/clock.h"
#include "tests/importers/vrml/vrml_reading.h"

namespace panwright::importers::vrml::vrml_hostile_test {
namespace {

const std::string kModel = R"(#VRML V2.0 utf8
# every kind of statement and value
PROTO Arm [ exposedField SFVec3f at 0 0 0 field MFNode parts [ ] field SFString label "a\"b" ]
{ Transform { translation IS at children IS parts } WorldInfo { title IS label } }
EXTERNPROTO Far [ field SFFloat r ] [ "model.wrl#Arm" "other.wrl" ]
DEF T Transform { rotation 0 1 0 .5 scale 1 -2 3 children [
  DEF S Shape {
    appearance Appearance { material DEF M Material { diffuseColor .1 .2 .3 transparency 0.5 }
      texture PixelTexture { image 2 1 3 0xFF00FF 0x102030 } }
    geometry IndexedFaceSet { coord DEF C Coordinate { point [ 0 0 0, 1 0 0, 1 1 0, 0 1 0 ] }
      coordIndex [ 0 1 2 3 -1 ] color Color { color [ 1 0 0 ] } colorPerVertex FALSE } }
  USE S Arm { at 1 2 3 parts [ USE S Shape { geometry Cylinder { top FALSE } } ] label "x" }
  Switch { whichChoice 0 choice Inline { url "model.wrl" } }
  Shape { geometry ElevationGrid { xDimension 2 zDimension 2 height [ 0 1 2 3 ] } }
  Shape { geometry Extrusion { spine [ 0 0 0 0 1 0 1 1 0 ] } } ] }
DEF K Script { eventIn SFTime go field SFNode t USE T url "javascript: { }" }
DEF W TimeSensor { } ROUTE W.cycleTime TO K.go
Far { }
)";

Options small() {
  Options options;
  options.limits.nodes = 10'000;
  options.limits.memory = 16 << 20;
  options.limits.triangles = 100'000;
  options.limits.texture_bytes = 1 << 20;
  return options;
}

// Nothing but a sound scene, or errors.
void expect_sound(const std::string& text) {
  const auto reading = read_files({{"model.wrl", text}}, small());
  ASSERT_TRUE(reading->out || reading->log.has_errors());
  if (reading->out) {
    ASSERT_EQ(scene::check(reading->scene()), "");
  }
  (void)to_text(reading->log);
}

TEST(VrmlHostile, TheModelIsSoundAsItIs) {
  const auto reading = read_files({{"model.wrl", kModel}}, small());
  ASSERT_TRUE(reading->out);
  EXPECT_EQ(scene::check(reading->scene()), "");
  // the Inline of itself is the one error
  EXPECT_EQ(reading->log.errors(), 1u) << to_text(reading->log);
  EXPECT_TRUE(reading->log.contains(Code("E6109")));
  EXPECT_EQ(reading->scene().instances.size(), 6u);
}

TEST(VrmlHostile, CutAtEveryByte) {
  std::size_t silent = 0;
  for (std::size_t size = 0; size < kModel.size(); ++size) {
    SCOPED_TRACE(size);
    expect_sound(kModel.substr(0, size));
    if (HasFatalFailure()) return;
    const auto reading = read_files({{"model.wrl", kModel.substr(0, size)}}, small());
    silent += reading->log.errors() == 0 ? 1 : 0;
  }
  // only a cut between statements makes no error
  const std::size_t statements_end = kModel.find("DEF T");
  EXPECT_LT(silent, statements_end);
}

TEST(VrmlHostile, FlippedBytes) {
  std::uint64_t state = 7;
  for (int round = 0; round < 3000; ++round) {
    std::string text = kModel;
    for (int i = 0; i <= round % 4; ++i) {
      state = state * 6364136223846793005u + 1442695040888963407u;
      text[16 + (state >> 33) % (text.size() - 16)] = static_cast<char>(state >> 56);
    }
    SCOPED_TRACE(round);
    expect_sound(text);
    if (HasFatalFailure()) return;
  }
}

TEST(VrmlHostile, TokensMovedAbout) {
  const char* const tokens[] = {"{",  "}",    "[",        "]",           "DEF",  "USE", "PROTO",
                                "IS", "NULL", "ROUTE",    "Shape",       "T",    "1",   "-nan",
                                "\"", "#",    "children", "EXTERNPROTO", "TRUE", "."};
  std::uint64_t state = 3;
  for (int round = 0; round < 2000; ++round) {
    std::string text = kModel;
    for (int i = 0; i < 3; ++i) {
      state = state * 6364136223846793005u + 1442695040888963407u;
      const std::size_t at = text.find(' ', 16 + (state >> 33) % (text.size() - 20));
      if (at == text.npos) continue;
      text.insert(at + 1, std::string(tokens[(state >> 20) % std::size(tokens)]) + " ");
    }
    SCOPED_TRACE(round);
    expect_sound(text);
    if (HasFatalFailure()) return;
  }
}

template <class Work>
double seconds(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return seconds_since(start);
}

std::string repeated(const std::string& text, int count) {
  std::string out;
  for (int i = 0; i < count; ++i) out += text;
  return out;
}

// seconds: no hang, whatever the machine does besides; measured 0.2 at most, with sanitizers on a
// busy machine 9.5
constexpr double kMost = 120;

void expect_refused(const std::string& body, const Options& options = {}) {
  EXPECT_LT(seconds([&] {
              const auto reading = read97(body, options);
              EXPECT_TRUE(reading->log.contains(Code("E6002"))) << body.substr(0, 60);
            }),
            kMost);
}

TEST(VrmlHostile, DepthIsLimited) {
  expect_refused(repeated("Group { children [ ", 100'000));
  expect_refused(repeated("Unknown { ", 100'000));
  expect_refused(repeated("PROTO P [ ] { ", 100'000));
  std::string chain = "DEF N0 Group { }";
  for (int i = 1; i < 1000; ++i)
    chain +=
        "DEF N" + std::to_string(i) + " Group { children USE N" + std::to_string(i - 1) + " }\n";
  expect_refused(chain);
}

TEST(VrmlHostile, BracketsWithoutEnd) {
  for (const char* open : {"Foo { a [ ", "[ ", "{ ", "Coordinate { point [ "})
    EXPECT_LT(seconds([&] {
                const auto reading = read97(open + repeated("[ ", 500'000));
                EXPECT_TRUE(reading->log.has_errors());
              }),
              kMost)
        << open;
}

TEST(VrmlHostile, Doubling) {
  std::string text = "DEF N0 Group { children Shape { geometry Box {} } }\n";
  for (int i = 1; i < 60; ++i) {
    const std::string before = "USE N" + std::to_string(i - 1) + " ";
    text += "DEF N" + std::to_string(i) + " Group { children [ " + before + before + "] }\n";
  }
  Options options;
  options.limits.nodes = 100'000;
  expect_refused(text, options);

  std::string bomb =
      "PROTO P0 [ field SFFloat r 1 ] { Shape { geometry Sphere { radius IS r } } }\n";
  for (int i = 1; i < 40; ++i) {
    const std::string inner = "P" + std::to_string(i - 1) + " { r IS r } ";
    bomb += "PROTO P" + std::to_string(i) + " [ field SFFloat r 1 ] { Group { children [ " + inner +
            inner + "] } }\n";
  }
  expect_refused(bomb + "P39 { r 2 }", small());
}

TEST(VrmlHostile, FilesThatNameFiles) {
  std::vector<MemoryFile> files;
  for (int i = 0; i < 300; ++i)
    files.push_back(
        {"f" + std::to_string(i) + ".wrl",
         kHeader97 + repeated("Inline { url \"f" + std::to_string(i + 1) + ".wrl\" }", 2)});
  const auto reading = read_files(files, small());
  EXPECT_TRUE(reading->log.contains(Code("E6002")));
}

// One face set under many texture transforms is meshed for each of them: all of them count, also
// when the meshes are equal.
TEST(VrmlHostile, MeshesMadeAgain) {
  const auto model = [](int shapes, bool equal) {
    std::string text = "DEF P PixelTexture { image 1 1 3 0x102030 } ";
    for (int i = 0; i < shapes; ++i)
      text +=
          "Shape { appearance Appearance { texture USE P textureTransform TextureTransform { "
          "translation " +
          std::to_string(equal ? 0 : i) + " 0 } } geometry " +
          (i > 0 ? "USE F }\n"
                 : "DEF F IndexedFaceSet { coord Coordinate { point [ 0 0 0 1 0 0 1 1 0 ] } "
                   "coordIndex [ " +
                       repeated("0 1 2 -1 ", 500) + "] } }\n");
    return text;
  };
  Options options = small();
  for (const bool equal : {false, true}) {
    const auto fits = read97(model(200, equal), options);  // 100,000 triangles
    ASSERT_TRUE(fits->out) << to_text(fits->log);
    EXPECT_EQ(fits->scene().instances.size(), 200u);
    EXPECT_EQ(fits->scene().shapes.size(), equal ? 1u : 200u);
    expect_refused(model(210, equal), options);
  }
}

TEST(VrmlHostile, MemoryIsLimited) {
  Options options;
  options.limits.memory = 1 << 20;
  expect_refused("Coordinate { point [ " + repeated("1 2 3 ", 200'000) + "] }", options);
  expect_refused(repeated("Group { } ", 100'000), options);
}

TEST(VrmlHostile, SizesThatLie) {
  const auto image = read97(
      "Shape { appearance Appearance { texture PixelTexture { image 100000 100000 4 1 2 3 } } "
      "geometry Box {} }");
  EXPECT_TRUE(image->log.contains(Code("E6106")));
  const auto huge = read97(
      "Shape { appearance Appearance { texture PixelTexture { image 2147483647 2147483647 1 1 } } "
      "geometry Box {} }");
  EXPECT_TRUE(huge->log.has_errors());
  const auto grid = read97(
      "Shape { geometry ElevationGrid { xDimension 2147483647 zDimension 2147483647 height [ 1 ] } "
      "}");
  EXPECT_TRUE(grid->log.warnings() + grid->log.errors() > 0);
  EXPECT_TRUE(grid->out);
}

// Ten times as many take ten times as long, not a hundred: times beside each other, as the machine
// may be busy.
void expect_linear(const std::function<std::string(int)>& text, int count,
                   const std::string& what) {
  const auto time_of = [&](int n) {
    const std::string body = text(n);
    return seconds([&] {
      const auto reading = read97(body);
      EXPECT_GE(reading->log.errors() + reading->log.warnings(), 1u) << what;
    });
  };
  const double few = time_of(count / 10);
  EXPECT_LE(time_of(count), 35 * few + 1) << what;
}

TEST(VrmlHostile, MillionsOfProblems) {
  for (const char* junk : {"} ", "nan ", "USE x ", "Foo { } ", "\"a\" ", "ROUTE a.b TO c.d "})
    expect_linear([&](int n) { return repeated(junk, n); }, 100'000, junk);
  expect_linear(
      [](int n) {
        std::string names;
        for (int i = 0; i < n; ++i)
          names +=
              "DEF name" + std::to_string(i) + " Group { } USE nome" + std::to_string(i) + "\n";
        return names;
      },
      30'000, "names");
}

}  // namespace
}  // namespace panwright::importers::vrml::vrml_hostile_test
