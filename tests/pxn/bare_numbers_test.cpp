// Bare numbers mean the root's units, inside braces as outside.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "base/math.h"
#include "tests/pxn/expressions.h"
#include "tests/pxn/reading.h"

namespace panwright::pxn::bare_numbers_test {
namespace {

using schemas::Dimension;
using testing::HasSubstr;

// What the units of roots are, written down anew.
struct Root {
  const char* length;
  double metres;
  const char* angle;
  double radians;
};
constexpr double kRadiansOfDegree = 3.14159265358979323846 / 180;
constexpr Root kRoots[] = {{"m", 1, "deg", kRadiansOfDegree},       {"m", 1, "rad", 1},
                           {"mm", 1e-3, "deg", kRadiansOfDegree},   {"mm", 1e-3, "rad", 1},
                           {"in", 0.0254, "deg", kRadiansOfDegree}, {"in", 0.0254, "rad", 1},
                           {"ft", 0.3048, "deg", kRadiansOfDegree}, {"ft", 0.3048, "rad", 1}};

std::string root_text(const std::string& length, const std::string& angle) {
  return "<pangu_model ver=\"1\" units=\"" + length + "\" angle=\"" + angle + "\">\n";
}

Reading read_in(const Root& root, const std::string& inside, const Options& options = {}) {
  return read_files({{"m.pxn", root_text(root.length, root.angle) + inside + "\n</pangu_model>\n"}},
                    options);
}
Reading read_in_mm(const std::string& inside, const Options& options = {}) {
  return read_in(kRoots[2], inside, options);
}

// The translation of the node of that name.
Vec3 place_of(const Reading& r, const std::string& name) {
  if (r.scene)
    for (const scene::Node& node : r.scene->nodes)
      if (node.name == name) return node.parent_from_node.translation;
  ADD_FAILURE() << "no node " << name << "\n" << r.summary();
  return Vec3(std::numeric_limits<double>::quiet_NaN());
}

// The angle about z of the node of that name.
double turn_of(const Reading& r, const std::string& name) {
  if (r.scene)
    for (const scene::Node& node : r.scene->nodes)
      if (node.name == name)
        return 2 * std::atan2(node.parent_from_node.rotation.z, node.parent_from_node.rotation.w);
  ADD_FAILURE() << "no node " << name << "\n" << r.summary();
  return std::numeric_limits<double>::quiet_NaN();
}

// ---- lengths

TEST(BareNumbers, AreLengthsOfTheRootInBraces) {
  const std::pair<const char*, double> cases[] = {
      {"{6}", 6},
      {"{W/2 - 4.25}", 226.3 / 2 - 4.25},
      {"{k*224}", 5 * 224},
      {"{W + k}", 226.3 + 5},
      {"{max(W, 300)}", 300},
      {"{min(W, 3, 300)}", 3},
      {"{hypot(30, 40)}", 50},
      {"{hypot(0*W + 30, 40)}", 50},
      {"{sqrt(W*W + 300*300)}", std::sqrt(226.3 * 226.3 + 9e4)},
      {"{sqrt(A)}", 226.3},
      {"{A/226.3 + 1}", 227.3},
      {"{W > 200 ? 7 : 8}", 7},
      {"{W > 300 ? W : 8}", 8},
      {"{mod(W, 100)}", std::fmod(226.3, 100)},
      {"{round(W)}", 226},
      {"{floor(W/100)*100 + 1}", 201},
      {"{2*pi*k}", 2 * 3.14159265358979323846 * 5},
  };
  for (const Root& root : kRoots)
    for (const auto& [text, expected] : cases) {
      const std::string unit = root.length;
      const Reading r = read_in(root, "<param name=\"W\" value=\"226.3" + unit +
                                          "\"/><param name=\"A\" value=\"{W*W}\"/>"
                                          "<param name=\"k\" value=\"5\"/><node name=\"n\" "
                                          "translate=\"" +
                                          text + " 0 0\"/>");
      EXPECT_EQ(r.summary(), "") << text;
      // measured: 1.9e-16
      const double got = place_of(r, "n").x, wanted = expected * root.metres;
      EXPECT_NEAR(got, wanted, 2.3e-16 * std::fabs(wanted)) << text << " in " << unit;
    }
}

// What is in braces has the bits of what is not, where the number itself is exact.
TEST(BareNumbers, HaveTheBitsOfThoseOutsideOfBraces) {
  std::mt19937 random(17);
  double worst = 0;
  for (const Root& root : kRoots) {
    std::string nodes;
    for (int i = 0; i < 200; ++i) {
      const std::string number = std::to_string(random() % 1000) + "." +
                                 (i % 2 == 0 ? "375" : std::to_string(random() % 100000));
      const std::string n = std::to_string(i);
      nodes += "<node name=\"a" + n + "\" translate=\"" + number + " 0 0\" rotate=\"0 0 " + number +
               "\"/><node name=\"b" + n + "\" translate=\"{" + number + "} 0 0\" rotate=\"0 0 {" +
               number + "}\"/>";
    }
    const Reading r = read_in(root, nodes);
    EXPECT_EQ(r.summary(), "");
    for (int i = 0; i < 200; ++i) {
      const std::string n = std::to_string(i);
      const double a = place_of(r, "a" + n).x, b = place_of(r, "b" + n).x;
      if (i % 2 == 0) {
        EXPECT_EQ(a, b) << root.length;
      }
      worst = std::max(worst, std::fabs(b / a - 1));
      EXPECT_EQ(turn_of(r, "a" + n), turn_of(r, "b" + n));
    }
  }
  // measured: 2.2e-16, of decimals that are rounded, multiplied and divided
  EXPECT_LE(worst, 2.3e-16);
}

// ---- angles

TEST(BareNumbers, AreAnglesOfTheRootInBraces) {
  struct Case {
    const char* text;
    double angle;    // in the root's unit
    double radians;  // besides
  };
  const double pi = 3.14159265358979323846;
  const Case cases[] = {
      {"{0.4}", 0.4, 0},
      {"{2*0.4 + T}", 0.8, 0.5},
      {"{T - k*0.1}", -0.5, 0.5},
      {"{-(0.3 + 0.2*k) + T}", -1.3, 0.5},
      {"{k > 3 ? T : 1}", 0, 0.5},
      {"{k > 7 ? T : 1}", 1, 0},
      {"{(k > 3 ? 1 : T) + 0.5}", 1.5, 0},
      {"{T + (k > 3 ? 1 : 0.2)}", 1, 0.5},
      {"{(k > 7 ? T : k > 3 ? 0.7 : 8) + T}", 0.7, 0.5},
      {"{max(0.001, T*2, 0.002)}", 0, 1},
      {"{asin(0.5)}", 0, pi / 6},
      {"{atan2(3, 4) + 1}", 1, std::atan2(3, 4)},
      {"{atan2(W, W*2)}", 0, std::atan2(1, 2)},
      {"{pi/4}", 0, pi / 4},
      {"{k*pi/180}", 0, pi / 36},
      {"{h*3}", 0, 3 * pi / 8},
      {"{tau/8 + T}", 0, pi / 4 + 0.5},
      {"{W*T/W*1rad}", 0, 0.5},
      {"{2mrad}", 0, 0.002},
  };
  double worst = 0;
  for (const Root& root : kRoots)
    for (const Case& c : cases) {
      const Reading r = read_in(
          root, std::string("<param name=\"W\" value=\"2m\"/><param name=\"T\" value=\"0.5rad\"/>"
                            "<param name=\"k\" value=\"5\"/><param name=\"h\" value=\"{pi/8}\"/>"
                            "<node name=\"n\" rotate=\"0 0 ") +
                    c.text + "\"/>");
      EXPECT_EQ(r.summary(), "") << c.text;
      const double wanted = c.angle * root.radians + c.radians;
      worst = std::max(worst, std::fabs(turn_of(r, "n") - wanted) / std::fabs(wanted));
      EXPECT_NEAR(turn_of(r, "n"), wanted, 4.5e-16 * std::fabs(wanted)) << c.text << root.angle;
    }
  // measured: 2.2e-16, of which libm has a part
  EXPECT_LE(worst, 4.5e-16);
}

TEST(BareNumbers, TrigonometryTakesUnits) {
  ExpressionFixture at;
  at.scope.set("i", {3, Dimension::none});
  at.scope.set("tilt", {0.2, Dimension::angle});
  at.scope.set("W", {2, Dimension::length});
  const std::pair<const char*, const char*> cases[] = {
      {"cos(i*90+45)", "cos(i*90deg+45deg), or cos(i*90rad+45rad)"},
      {"sin(45)", "sin(45deg), or sin(45rad)"},
      {"1 + tan(i)", "tan(i*1deg), or tan(i*1rad)"},
      {"sin(90*i - 5/2)", "sin(90deg*i - 5deg/2), or sin(90rad*i - 5rad/2)"},
      {"sin(i > 2 ? 3 : -(4))", "sin(i > 2 ? 3deg : -(4deg)"},
      {"cos(2^i)", "cos(2^i*1deg)"},
      {"cos(W/3m)", "cos((W/3m)*1deg), or cos((W/3m)*1rad)"},
      {"cos(sqrt(4))", "cos("},
      {"cos(max(1, 2))", "cos("},
  };
  for (const auto& [text, cure] : cases) {
    EXPECT_FALSE(at(text)) << text;
    EXPECT_EQ(at.problem.code, Code("E1212")) << text;
    EXPECT_THAT(at.problem.hint, HasSubstr(cure)) << text;
    EXPECT_THAT(at.problem.message, HasSubstr("may be degrees or radians")) << text;
  }
  // what is no bare number, or the same in every unit
  for (const char* text : {"sin(tilt)", "cos(45deg + i*90)", "sin(2*pi*i/8 + 0.1)", "cos(tau)",
                           "cos(0)", "tan(atan2(W, 3m))", "sin(asin(0.25))", "cos(i*tilt)"})
    EXPECT_TRUE(at(text)) << text << ": " << at.problem.message;
  EXPECT_NEAR(at.value("cos(45deg + i*90)"), std::cos(315 * kRadiansOfDegree), 2e-16);
  // what it writes is right: no complaint, and the value
  EXPECT_NEAR(at.value("cos(i*90deg+45deg)"), std::cos(315 * kRadiansOfDegree), 2e-16);
  EXPECT_NEAR(at.value("sin(90deg*i - 5deg/2)"), std::sin(267.5 * kRadiansOfDegree), 2e-16);
  at.expressions.set_units({find_unit("m"), find_unit("rad")});
  EXPECT_EQ(at.value("cos(i*90+45)"), det::cos(315));
  EXPECT_EQ(at.value("tan(i)"), det::tan(3));
}

TEST(BareNumbers, ARatioIsNoAngleInDegrees) {
  ExpressionFixture at;
  at.scope.set("W", {2, Dimension::length});
  at.scope.set("tilt", {0.2, Dimension::angle});
  const Need angle{Dimension::angle, false};
  for (const char* text : {"W/3m", "tilt + W/3m", "2*W*(1/1mm)", "tilt/2deg"}) {
    EXPECT_FALSE(at.expressions.evaluate(text, at.place++, &at.scope, at.problem, angle)) << text;
    EXPECT_EQ(at.problem.code, Code("E1212"));
    EXPECT_THAT(at.problem.hint, HasSubstr("*1deg, or ")) << text;
  }
  // where bare angles are radians in any case, and where it is a count
  const Need radians{Dimension::angle, true};
  EXPECT_TRUE(at.expressions.evaluate("W/3m", at.place++, &at.scope, at.problem, radians));
  const auto count =
      at.expressions.evaluate("90*floor(W/3mm)", at.place++, &at.scope, at.problem, angle);
  ASSERT_TRUE(count) << at.problem.message;
  EXPECT_NEAR(count->value, 90 * 666 * kRadiansOfDegree, 1e-11);
}

// ---- the same model with units and without

// Expressions whose numbers are all of one dimension, with and without their units. Sums only, of
// positive numbers: nothing cancels.
struct Twins {
  std::string bare;
  std::string full;
};

Twins random_twins(std::mt19937& random, int depth, const std::string& unit,
                   const std::string& name, bool lengths) {
  const unsigned kind = depth == 0 ? random() % 2 : random() % 10;
  const auto inner = [&] { return random_twins(random, depth - 1, unit, name, lengths); };
  if (kind == 0) return {name, name};
  if (kind <= 2) {
    const std::string number =
        std::to_string(1 + random() % 90) + "." + std::to_string(random() % 10);
    return {number, number + unit};
  }
  const Twins a = inner();
  const std::string plain = std::to_string(1 + random() % 4);
  if (kind == 3) return {"(" + a.bare + ")*" + plain, "(" + a.full + ")*" + plain};
  if (kind == 4) return {plain + "*(" + a.bare + ")/3", plain + "*(" + a.full + ")/3"};
  const Twins b = inner();
  if (kind == 5)
    return {"max(" + a.bare + ", " + b.bare + ")", "max(" + a.full + ", " + b.full + ")"};
  if (kind == 6) {
    // which of them is taken does not hang on a rounding
    const std::string which = random() % 2 == 0 ? "(1 ? " : "(0 ? ";
    return {which + a.bare + " : " + b.bare + ")", which + a.full + " : " + b.full + ")"};
  }
  if (kind == 7 && lengths)
    return {"hypot(" + a.bare + ", " + b.bare + ")", "hypot(" + a.full + ", " + b.full + ")"};
  return {a.bare + " + " + b.bare, a.full + " + " + b.full};
}

TEST(BareNumbers, TwinsWithTheirUnitsHaveTheSameValues) {
  std::mt19937 random(23);
  double worst = 0;
  std::size_t same = 0, all = 0;
  for (const Root& root : kRoots)
    for (const bool lengths : {true, false}) {
      ExpressionFixture at, metric;
      at.expressions.set_units({find_unit(root.length), find_unit(root.angle)});
      const Unit& unit = *find_unit(lengths ? root.length : root.angle);
      for (Scope* scope : {&at.scope, &metric.scope}) {
        scope->set("W", {2.5 * root.metres, Dimension::length});
        scope->set("T", {0.75, Dimension::angle});
      }
      const Need need{lengths ? Dimension::length : Dimension::angle, false};
      for (int i = 0; i < 2000; ++i) {
        const Twins twins =
            random_twins(random, 1 + i % 5, std::string(unit.name), lengths ? "W" : "T", lengths);
        const auto bare =
            at.expressions.evaluate(twins.bare, at.place++, &at.scope, at.problem, need);
        ASSERT_TRUE(bare) << twins.bare << ": " << at.problem.message;
        const auto full = metric.expressions.evaluate(twins.full, metric.place++, &metric.scope,
                                                      metric.problem, need);
        ASSERT_TRUE(full) << twins.full << ": " << metric.problem.message;
        const double si = lengths ? to_si(bare->value, unit) : bare->value;
        worst = std::max(worst, std::fabs(si / full->value - 1));
        same += si == full->value ? 1 : 0;
        ++all;
      }
    }
  // measured: 4.4e-16, and 27,829 of 32,000
  EXPECT_LE(worst, 4.5e-16);
  EXPECT_GT(same, all / 2);
}

TEST(BareNumbers, AModelInMillimetresIsTheSameInMetres) {
  const std::string bare = R"(
    <param name="W" value="226.3mm"/><param name="k" value="5"/><param name="t" value="3"/>
    <repeat count="{k}" var="i">
      <box name="b{i}" size="{W/2 - 4.25} {k*22} {W - 2*t}" translate="{W/2 - 4.25} {i*224 - 3} {t}"
           rotate="0 0 {i*90 + 45}"/>
      <cylinder name="c{i}" radius="{max(t, 2)}" height="{hypot(W, 30)}"
           translate="{60*cos(i*60deg)} {60*sin(i*60deg)} {sqrt(W*W + 16)}"/>
    </repeat>)";
  const std::string full = R"(
    <param name="W" value="226.3mm"/><param name="k" value="5"/><param name="t" value="3mm"/>
    <repeat count="{k}" var="i">
      <box name="b{i}" size="{W/2 - 4.25mm} {k*22mm} {W - 2*t}" translate="{W/2 - 4.25mm} {i*224mm - 3mm} {t}"
           rotate="0 0 {i*90deg + 45deg}"/>
      <cylinder name="c{i}" radius="{max(t, 2mm)}" height="{hypot(W, 30mm)}"
           translate="{60mm*cos(i*60deg)} {60mm*sin(i*60deg)} {sqrt(W*W + 16*1mm*1mm)}"/>
    </repeat>)";
  const Reading a = read_in_mm(bare), b = read_in(kRoots[0], full);
  ASSERT_EQ(a.summary(), "");
  ASSERT_EQ(b.summary(), "");
  ASSERT_EQ(a.scene->nodes.size(), b.scene->nodes.size());
  double worst = 0;
  for (std::size_t i = 0; i < a.scene->nodes.size(); ++i) {
    const scene::Transform& p = a.scene->nodes[i].parent_from_node;
    const scene::Transform& q = b.scene->nodes[i].parent_from_node;
    for (int k = 0; k < 3; ++k)
      worst = std::max(worst, std::fabs(p.translation[k] - q.translation[k]));
    worst = std::max(
        {worst, std::fabs(p.rotation.w - q.rotation.w), std::fabs(p.rotation.z - q.rotation.z)});
  }
  for (std::size_t i = 0; i < a.scene->shapes.size(); ++i) {
    const auto* box = std::get_if<geometry::Box>(&a.scene->shapes[i]);
    const auto* other = std::get_if<geometry::Box>(&b.scene->shapes[i]);
    ASSERT_EQ(box == nullptr, other == nullptr);
    for (int k = 0; box != nullptr && k < 3; ++k)
      worst = std::max(worst, std::fabs(box->size[k] - other->size[k]));
  }
  // metres; measured: 2.8e-17
  EXPECT_LE(worst, 5.6e-17);
}

// ---- more than one meaning

TEST(BareNumbers, OneOfAnotherFileIsNoLengthHere) {
  const auto both = [](const std::string& outer, const std::string& inner,
                       const std::string& nodes) {
    return read_files({{"m.pxn", outer + "<include file=\"d.pxn\"/>" + nodes + "</pangu_model>"},
                       {"d.pxn", inner + "<param name=\"gap\" value=\"6\"/>"
                                         "<param name=\"turn\" value=\"30\"/>"
                                         "<param name=\"twice\" value=\"{2*gap}\"/>"
                                         "<param name=\"long\" value=\"{gap + 1mm}\"/>"
                                         "<part name=\"p\"><param name=\"x\" value=\"2\"/>"
                                         "<node name=\"in\" translate=\"{x} 0 0\"/></part>"
                                         "</pangu_model>"}});
  };
  const std::string m = root_text("m", "deg"), mm = root_text("mm", "deg");
  const std::string rad = root_text("mm", "rad");
  for (const char* text : {"{gap}", "{gap*2}", "{twice}", "{long + gap}", "{max(gap, 1mm)}",
                           "{gap > 1mm ? 3 : 4}", "{1 ? gap : 1mm}"}) {
    const std::string node = std::string("<node name=\"n\" translate=\"") + text + " 0 0\"/>";
    const Reading r = both(m, mm, node);
    EXPECT_EQ(r.codes(), (std::multiset<std::string>{"E1212"})) << text << r.summary();
    EXPECT_THAT(r.summary(), HasSubstr("of a file in mm")) << text;
    EXPECT_THAT(r.summary(), HasSubstr("*1mm, or ")) << text;
    EXPECT_THAT(r.summary(), HasSubstr("*1m)")) << text;
    EXPECT_EQ(both(mm, mm, node).summary(), "") << text;
  }
  const Reading angle = both(rad, mm, "<node rotate=\"{turn} 0 0\"/>");
  EXPECT_EQ(angle.codes(), (std::multiset<std::string>{"E1212"}));
  EXPECT_THAT(angle.summary(), HasSubstr("turn*1deg, or turn*1rad"));
  EXPECT_EQ(
      both(mm, rad, "<repeat count=\"1\"><node translate=\"{sin(turn)} 0 0\"/></repeat>").codes(),
      (std::multiset<std::string>{"E1212"}));
  // counts and factors are the same everywhere, and lengths know what they are
  const Reading fine = both(m, mm,
                            "<repeat count=\"{gap}\"><node translate=\"{gap*2m} 0 0\" "
                            "scale=\"{gap}\"/></repeat><node name=\"n\" translate=\"{long} "
                            "{twice*1mm} 0\"/>");
  EXPECT_EQ(fine.summary(), "");
  EXPECT_EQ(place_of(fine, "n"), Vec3(0.007, 0.012, 0));
  // what a use hands over
  EXPECT_EQ(both(m, mm, "<use part=\"p\"/>").summary(), "");
  EXPECT_EQ(place_of(both(m, mm, "<use part=\"p\"/>"), "in").x, 0.002);
  const std::string plain = "<use part=\"p\"><with name=\"x\" value=\"3\"/></use>";
  const std::string with_unit = "<use part=\"p\"><with name=\"x\" value=\"3m\"/></use>";
  EXPECT_EQ(both(m, mm, plain).codes(), (std::multiset<std::string>{"E1212"}));
  EXPECT_EQ(place_of(both(m, mm, with_unit), "in").x, 3);
  EXPECT_EQ(place_of(both(mm, mm, plain), "in").x, 0.003);
}

TEST(BareNumbers, AParameterHasOneMeaning) {
  const std::string k = "<param name=\"k\" value=\"5\"/>";
  const std::string length = "<node translate=\"{k} 0 0\"/>", count = "<repeat count=\"{k}\"/>";
  const std::string factor = "<node translate=\"{k*2mm} 0 0\"/>";
  const std::string angle = "<node rotate=\"{k} 0 0\"/>";
  const auto codes = [](const Root& root, const std::string& inside) {
    return read_in(root, inside).codes().count("E1212");
  };
  const Root& metres = kRoots[0];
  const Root& millimetres = kRoots[2];
  for (const std::string& other : {count, factor, angle}) {
    EXPECT_EQ(codes(millimetres, k + length + other), 1u) << other;
    EXPECT_EQ(codes(millimetres, k + other + length), 1u) << other;
  }
  EXPECT_EQ(codes(millimetres, k + count + factor), 0u);
  EXPECT_EQ(codes(millimetres, k + length + length), 0u);
  // metres and radians are what they are in every reading
  EXPECT_EQ(codes(metres, k + length + count + factor), 0u);
  EXPECT_EQ(codes(metres, k + angle + count), 1u);
  EXPECT_EQ(codes(kRoots[1], k + angle + count + length), 0u);
  EXPECT_THAT(
      read_in_mm(k + count + length).summary(),
      HasSubstr("the bare number k = 5 is a length here, and a plain number elsewhere (give "
                "it a unit, value=\"5mm\""));
  // variables of repeats are numbers in every place
  EXPECT_EQ(codes(millimetres,
                  "<repeat count=\"2\" var=\"i\"><node name=\"n{i}\" translate=\"{i} "
                  "{i*2mm} 0\" rotate=\"{i} 0 0\"/></repeat>"),
            0u);
}

// ---- the command line and names

TEST(BareNumbers, OnTheCommandLineAreOfTheFileThatDeclaresThem) {
  const auto run = [](const char* value) {
    Options options;
    options.parameters = {{"gap", value}};
    return read_files(
        {{"m.pxn", root_text("m", "deg") + "<include file=\"d.pxn\"/></pangu_model>"},
         {"d.pxn", root_text("in", "deg") + "<param name=\"gap\" value=\"1\"/>"
                                            "<node name=\"n\" translate=\"{gap} {gap + 1} 0\"/>"
                                            "</pangu_model>"}},
        options);
  };
  EXPECT_EQ(place_of(run("3"), "n"), Vec3(0.0762, 0.1016, 0));
  EXPECT_EQ(place_of(run("{2 + 1}"), "n"), Vec3(0.0762, 0.1016, 0));
  EXPECT_EQ(place_of(run("{2in + 1}"), "n"), Vec3(0.0762, 0.1016, 0));
  EXPECT_EQ(place_of(run("2ft"), "n"), Vec3(0.6096, 0.635, 0));
}

TEST(BareNumbers, NamesHaveThemInTheRootsUnits) {
  const std::string nodes =
      "<param name=\"W\" value=\"12.7mm\"/><param name=\"T\" value=\"30deg\"/>"
      "<node name=\"w{W}t{T}u{T/2}v{asin(0.5)}\"/>";
  const std::pair<Root, const char*> cases[] = {
      {kRoots[0], "w0.0127t30u15v30"},
      {kRoots[2], "w12.7t30u15v30"},
      {kRoots[4], "w0.5t30u15v30"},
      {kRoots[3], "w12.7t0.5235987755982989u0.26179938779914946v0.5235987755982989"},
  };
  for (const auto& [root, name] : cases) {
    const Reading r = read_in(root, nodes);
    ASSERT_EQ(r.summary(), "");
    EXPECT_EQ(r.scene->nodes.back().name, name);
  }
}

// ---- units themselves

TEST(BareNumbers, UnitsGoThereAndBack) {
  std::mt19937_64 random(29);
  double worst = 0;
  for (const Unit& unit : all_units()) {
    if (unit.dimension != Dimension::length && unit.dimension != Dimension::angle) continue;
    for (int i = 0; i < 2000; ++i) {
      const double x = static_cast<double>(random() % 100000) / 1000;
      const double si = to_si(x, unit);
      // the number that was written comes back
      EXPECT_EQ(from_si(si, unit), x) << unit.name;
      worst = std::max(worst, x == 0 ? 0 : std::fabs(si / (x * unit.factor) - 1));
      for (const Unit& other : all_units())
        if (unit.dimension == Dimension::length && other.dimension == unit.dimension)
          worst = std::max(
              worst,
              x == 0 ? 0
                     : std::fabs(in_unit(x, unit, other) * other.factor / (x * unit.factor) - 1));
    }
  }
  // against the rounded factors; measured: 4.4e-16
  EXPECT_LE(worst, 4.5e-16);
  EXPECT_EQ(read_length("6", *find_unit("mm"), *find_unit("mm")), 6);
  EXPECT_EQ(read_length("6", *find_unit("in"), *find_unit("mm")), 152.4);
  EXPECT_EQ(read_length("1", *find_unit("ft"), *find_unit("in")), 12);
  EXPECT_EQ(read_length("25.4", *find_unit("mm"), *find_unit("in")), 1);
  EXPECT_EQ(read_length("2.5", *find_unit("km"), *find_unit("um")), 2.5e9);
  EXPECT_EQ(read_length("1e308", *find_unit("km"), *find_unit("nm")), std::nullopt);
  EXPECT_EQ(read_length("x", *find_unit("km"), *find_unit("nm")), std::nullopt);
  EXPECT_EQ(to_si(1e308, *find_unit("in")), 1e308 / 1e4 * 254);
}

// ---- whatever is written

TEST(BareNumbers, AnyExpressionInAnyUnitsIsAnsweredFor) {
  const std::string_view tokens[] = {
      "a",    "b",     "c",     "d",      "e",    "pi",     "1",    "45",    "0",      "2.5",
      "6mm",  "30deg", "50%",   "3px",    "(",    "(",      ")",    ")",     "+",      "-",
      "*",    "/",     "^",     "<",      "==",   "&&",     "!",    "?",     ":",      ",",
      "sin(", "cos(",  "asin(", "atan2(", "min(", "hypot(", "mod(", "sqrt(", "floor(", " "};
  const Need needs[] = {{Dimension::length, false}, {Dimension::angle, false},
                        {Dimension::angle, true},   {Dimension::none, false},
                        {Dimension::ratio, false},  {Dimension::pixels, false}};
  std::mt19937 random(31);
  std::map<Code, int> seen;
  int good = 0;
  for (const Root& root : kRoots) {
    ExpressionFixture at;
    at.expressions.set_units({find_unit(root.length), find_unit(root.angle)});
    at.scope.set("a", {2, Dimension::length, 0.0254, kDegree});
    at.scope.set("b", {0.3, Dimension::angle});
    at.scope.set("c", {3, Dimension::none, 1e-3, kDegree});
    at.scope.set("d", {4, Dimension::none, 1, 1});
    at.scope.set("e", {0.5, Dimension::none, 0, 0, 1, true});
    for (int i = 0; i < 60000; ++i) {
      std::string text;
      const unsigned n = 1 + random() % 12;
      for (unsigned k = 0; k < n; ++k) text += tokens[random() % std::size(tokens)];
      const unsigned which = random() % (std::size(needs) + 1);
      std::optional<Need> need;
      if (which < std::size(needs)) need = needs[which];
      if (const auto measured =
              at.expressions.evaluate(text, at.place++, &at.scope, at.problem, need)) {
        ++good;
        ASSERT_TRUE(std::isfinite(measured->value)) << text;
        continue;
      }
      ++seen[at.problem.code];
      ASSERT_LE(at.problem.begin, at.problem.end) << text;
      ASSERT_LE(at.problem.end, text.size() + 1) << text;
      ASSERT_FALSE(at.problem.message.empty()) << text;
    }
  }
  EXPECT_GT(good, 5000);
  // measured: 17,409 and 1,026
  EXPECT_GT(seen[Code("E1212")], 500);
}

}  // namespace
}  // namespace panwright::pxn::bare_numbers_test
