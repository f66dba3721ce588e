// Numbers with units and expressions, in the language of one made-up element.

#include "pxn/expression/values.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/math.h"
#include "tests/pxn/reading.h"

namespace panwright::pxn::values_test {
namespace {

using schemas::Attribute;
using schemas::Dimension;
using schemas::ElementId;
using schemas::Number;
using schemas::ValueKind;

constexpr Number kWide[] = {{"l", -1e30, 1e30, false, false}};
constexpr Number kAngle[] = {{"a", -1.5707963267948968, 1.5707963267948968, false, false}};
constexpr Number kPositive[] = {{"p", 0, 1000, true, false}};
constexpr Number kCount[] = {{"n", 1, 100, false, false}};
constexpr Number kXyz[] = {{"x", -1e30, 1e30, false, true},
                           {"y", -1e30, 1e30, false, true},
                           {"z", -1e30, 1e30, false, true}};
constexpr Number kItem[] = {{"number", -1e30, 1e30, false, false}};

constexpr Attribute kAttributes[] = {
    {"l", 0, true, false, {ValueKind::real, 1, kWide, {}, Dimension::length, false, false, 1, 0}},
    {"a", 0, true, false, {ValueKind::real, 1, kAngle, {}, Dimension::angle, false, false, 1, 0}},
    {"b", 0, true, false, {ValueKind::real, 1, kAngle, {}, Dimension::angle, true, false, 1, 0}},
    {"r", 0, true, false, {ValueKind::real, 1, kWide, {}, Dimension::ratio, false, false, 1, 0}},
    {"p",
     0,
     true,
     false,
     {ValueKind::real, 1, kPositive, {}, Dimension::length, false, false, 1, 0}},
    {"f", 0, true, false, {ValueKind::real, 1, kWide, {}, Dimension::none, false, false, 1, 0}},
    {"n", 0, true, false, {ValueKind::integer, 1, kCount, {}, Dimension::none, false, false, 1, 0}},
    {"s", 0, true, false, {ValueKind::real, 3, kXyz, {}, Dimension::none, false, true, 1, 0}},
    {"q", 0, true, false, {ValueKind::quantity, 1, {}, {}, Dimension::none, false, false, 1, 0}},
    {"name", 0, true, false, {ValueKind::label, 1, {}, {}, Dimension::none, false, false, 1, 0}},
    {"x", 0, true, false, {ValueKind::real, 1, kWide, {}, Dimension::pixels, false, false, 1, 0}}};
// The double nearest to π/6; kPi/6 is an ulp below.
constexpr double kThirty = 0.5235987755982989;

enum Index : std::size_t { kL, kA, kB, kR, kP, kF, kN, kS, kQ, kName, kX };

// One element <e>, whose text is a list of pairs of lengths, three of them or more.
struct Subject {
  explicit Subject(const std::string& text, Units units = {1, 1, kDegree}) {
    const FileId file = reading.log.sources().add(
        {"t.xml", std::make_shared<const std::string>(text), Encoding::utf8, {}});
    document = xml::scan(file, {}, reading.log);
    document.elements[0].id = ElementId{0};
    values.set_units(units);
    values.set_scope(&scope);
  }
  std::string summary() const { return reading.summary(); }

  static constexpr schemas::Value kText = {ValueKind::real, 0,     kItem, {}, Dimension::length,
                                           false,           false, 2,     3};
  static constexpr schemas::Element kElements[] = {{"e", 0, true, kText, kAttributes, {}, {}}};
  static constexpr std::string_view kVersions[] = {"0", "1"};
  static constexpr schemas::Language kLanguage = {kElements, ElementId{0}, kVersions};

  Reading reading;
  xml::Document document;
  Reporter reporter{reading.log};
  Scope scope;
  Values values{document, kLanguage, reporter};
};

double real(std::size_t attribute, const std::string& value, Units units = {1, 1, kDegree}) {
  Subject e("<e " + std::string(kAttributes[attribute].name) + "=\"" + value + "\"/>", units);
  const auto out = e.values.real(0, attribute);
  EXPECT_TRUE(out) << value << ": " << e.summary();
  return out.value_or(NAN);
}

std::string complaint(std::size_t attribute, const std::string& value,
                      Units units = {1, 1, kDegree}) {
  Subject e("<e " + std::string(kAttributes[attribute].name) + "=\"" + value + "\"/>", units);
  e.scope.set("gap", {0.5, Dimension::length});
  e.scope.set("tilt", {0.2, Dimension::angle});
  bool read = false;
  switch (kAttributes[attribute].value.kind) {
    case ValueKind::integer:
      read = e.values.integer(0, attribute).has_value();
      break;
    case ValueKind::quantity:
      read = e.values.quantity(0, attribute).has_value();
      break;
    case ValueKind::label:
      read = e.values.text(0, attribute).has_value();
      break;
    default:
      read = e.values.real(0, attribute).has_value();
  }
  EXPECT_NE(read, e.summary() != "") << value;
  return e.summary();
}

// ---- units

TEST(Values, EveryUnit) {
  const std::tuple<std::size_t, const char*, double> cases[] = {
      {kL, "2km", 2000},
      {kL, "2m", 2},
      {kL, "12cm", 0.12},
      {kL, "12mm", 0.012},
      {kL, "3um", 3e-6},
      {kL, "3\u00b5m", 3e-6},
      {kL, "3\u03bcm", 3e-6},
      {kL, "7nm", 7e-9},
      {kL, "-3in", -0.0762},
      {kL, "12ft", 3.6576},
      {kL, "1.5e-3m", 1.5e-3},
      {kL, "+5mm", 0.005},
      {kL, "0.1mm", 1e-4},
      {kL, ".5mm", 5e-4},
      {kL, "5.mm", 5e-3},
      {kL, "1e3mm", 1},
      {kL, "5", 5},
      {kA, "1rad", 1},
      {kA, "3mrad", 0.003},
      {kA, "5urad", 5e-6},
      {kA, "5\u00b5rad", 5e-6},
      {kA, "90deg", kPi / 2},
      {kA, "45deg", kPi / 4},
      {kA, "30", kThirty},
      {kA, "60arcmin", kDegree},
      {kA, "3600arcsec", kDegree},
      {kB, "0.5", 0.5},
      {kB, "30deg", kThirty},
      {kR, "5%", 0.05},
      {kR, "0.1%", 0.001},
      {kR, "250ppm", 2.5e-4},
      {kR, "0.5", 0.5},
      {kX, "0.25px", 0.25},
      {kX, "2", 2},
      {kF, "5", 5},
  };
  for (const auto& [attribute, text, expected] : cases)
    EXPECT_EQ(real(attribute, text), expected) << text;
  EXPECT_TRUE(std::signbit(real(kL, "-0mm")));
}

// Powers of ten against strtod of the same digits; inches and feet against the product in integers.
TEST(Values, DecimalUnitsAreRoundedOnce) {
  std::mt19937_64 random(5);
  struct Case {
    const char* unit;
    int shift;
    std::uint64_t times;
  };
  const Case cases[] = {{"mm", -3, 1}, {"cm", -2, 1},   {"km", 3, 1},    {"um", -6, 1},
                        {"nm", -9, 1}, {"in", -4, 254}, {"ft", -4, 3048}};
  for (const Case& c : cases)
    for (int i = 0; i < 3000; ++i) {
      const std::uint64_t digits = random() >> (12 + random() % 50);
      const int exponent = static_cast<int>(random() % 30) - 20;
      const std::string text = std::to_string(digits) + "e" + std::to_string(exponent);
      // digits · 3048 < 2^64
      const std::string si =
          std::to_string(digits * c.times) + "e" + std::to_string(exponent + c.shift);
      const auto got = read_number(text, find_unit(c.unit));
      ASSERT_TRUE(got);
      ASSERT_EQ(*got, std::strtod(si.c_str(), nullptr)) << text << c.unit;
    }
  // with a point, and more digits than a double has
  EXPECT_EQ(*read_number("0.000000000000000000000123456789012345678901234567890", find_unit("mm")),
            1.23456789012345678901234567890e-25);
  EXPECT_EQ(*read_number("123456789012345678901234567890.5", find_unit("in")),
            3135802440913580244091358024.4187);
  EXPECT_EQ(*read_number("1e310", find_unit("mm")), 1e307);
  EXPECT_EQ(*read_number("1e-400", find_unit("km")), 0);
  EXPECT_FALSE(read_number("1e306", find_unit("km")));
  EXPECT_FALSE(read_number("1e99999999999999999999", find_unit("km")));
  EXPECT_EQ(*read_number("1e-99999999999999999999", find_unit("km")), 0);
  EXPECT_FALSE(read_number("mm", find_unit("mm")));
  EXPECT_FALSE(read_number("", find_unit("mm")));
}

// Angles against long double, whose 64 bits leave half an ulp and 2^-11 of it.
TEST(Values, AnglesAreRoundedOnce) {
  std::mt19937_64 random(5);
  const long double pi = 3.14159265358979323846264338327950288L;
  const std::pair<const char*, long double> cases[] = {
      {"deg", pi / 180}, {"arcmin", pi / 10800}, {"arcsec", pi / 648000}};
  long double worst = 0;
  for (const auto& [unit, factor] : cases)
    for (int i = 0; i < 20000; ++i) {
      const double x = std::ldexp(static_cast<double>(random() >> 11), -44);
      char text[40];
      std::snprintf(text, sizeof text, "%.17g", x);
      const double got = *read_number(text, find_unit(unit));
      const double ulp = std::nextafter(got, 1e9) - got;
      worst = std::max(worst, std::abs((got - x * factor) / ulp));
    }
  // measured: 0.50049
  EXPECT_LE(worst, 0.5005L);
}

TEST(Values, BareNumbersHaveTheUnitOfTheRoot) {
  EXPECT_EQ(real(kL, "12", {1, 0.001, 1}), 0.012);
  EXPECT_EQ(real(kL, "0.3", {1, 0.001, 1}), 3e-4);  // 0.3/1000 is an ulp off
  EXPECT_EQ(real(kL, "12", {1, 0.0254, 1}), 0.3048);
  EXPECT_EQ(real(kL, "12m", {1, 0.001, 1}), 12);
  EXPECT_EQ(real(kL, "{12}", {1, 0.001, 1}), 0.012);
  EXPECT_EQ(real(kL, "{12m}", {1, 0.001, 1}), 12);
  EXPECT_EQ(real(kA, "{30}", {1, 1, kDegree}), kThirty);
  EXPECT_EQ(real(kB, "{0.5}", {1, 1, kDegree}), 0.5) << "radians, whatever the root says";
  EXPECT_EQ(real(kF, "{12}", {1, 0.001, 1}), 12);
  EXPECT_EQ(real(kA, "1", {1, 1, 1}), 1);
  EXPECT_EQ(real(kA, "30", {1, 1, 1 * kDegree}), kThirty);
  EXPECT_EQ(real(kF, "12", {1, 0.001, 1}), 12);
  EXPECT_EQ(real(kR, "12", {1, 0.001, 1}), 12);
  // a factor that is no unit's
  EXPECT_EQ(real(kL, "12", {1, 2, 1}), 24);
}

TEST(Values, LevelZeroHasNoUnits) {
  const Units zero;
  EXPECT_EQ(real(kL, "12", zero), 12);
  EXPECT_EQ(real(kA, "30", zero), kThirty);
  EXPECT_EQ(real(kB, "0.5", zero), 0.5);
  EXPECT_EQ(complaint(kL, "12mm", zero),
            "1:7 E1201 '12mm' is not a number, expected -1e+30 to 1e+30 for l of <e> (units belong "
            "to level 1 "
            "of the language: ver=\"1\")\n");
  EXPECT_EQ(complaint(kL, "{1}", zero),
            "1:7 E1201 '{1}' is not a number, expected -1e+30 to 1e+30 for l of <e>\n");
  Subject e("<e name=\"bolt{i}\"/>", zero);
  EXPECT_EQ(e.values.text(0, kName), "bolt{i}");
}

TEST(Values, UnitsOfTheWrongKind) {
  EXPECT_EQ(
      complaint(kL, "30deg"),
      "1:7 E1212 a length is needed here, got an angle (30deg) (its units: m, mm, cm, km, um, nm, "
      "in or ft)\n");
  EXPECT_EQ(
      complaint(kA, "3mm"),
      "1:7 E1212 an angle is needed here, got a length (3mm) (its units: deg, rad, mrad, urad, "
      "arcmin or arcsec)\n");
  EXPECT_EQ(
      complaint(kR, "3px"),
      "1:7 E1212 a ratio is needed here, got a number of pixels (3px) (its units: % or ppm)\n");
  EXPECT_EQ(complaint(kF, "3mm"), "1:7 E1212 a plain number is needed here, got a length (3mm)\n");
  EXPECT_EQ(complaint(kN, "3mm"), "1:7 E1212 a plain number is needed here, got a length (3mm)\n");
  EXPECT_EQ(complaint(kL, "{2*tilt}").substr(0, 69),
            "1:7 E1212 a length is needed here, got an angle ({2*tilt}) (its units");
  EXPECT_EQ(complaint(kL, "{gap*gap}").substr(0, 65),
            "1:7 E1212 a length is needed here, got an area ({gap*gap}) (its u");
  EXPECT_EQ(complaint(kL, "{gap^4}").substr(0, 73),
            "1:7 E1212 a length is needed here, got a length to the power 4 ({gap^4}) ");
  EXPECT_EQ(complaint(kF, "{gap}"),
            "1:7 E1212 a plain number is needed here, got a length ({gap}) (divide it by a "
            "length: (…)/1m)\n");
  EXPECT_EQ(complaint(kN, "{gap*2}"),
            "1:7 E1212 a plain number is needed here, got a length ({gap*2}) (divide it by "
            "a length: (…)/1m; gap is a length, 2 is a plain number)\n");
  EXPECT_EQ(complaint(kL, "{1px}").substr(0, 66),
            "1:7 E1212 a length is needed here, got a number of pixels ({1px}) ");
  EXPECT_EQ(complaint(kL, "{2*50%}").substr(0, 59),
            "1:7 E1212 a length is needed here, got a ratio ({2*50%}) (i");
  EXPECT_EQ(complaint(kA, "{gap + 1}").substr(0, 62),
            "1:7 E1212 an angle is needed here, got a length ({gap + 1}) (i");
  EXPECT_EQ(complaint(kA, "{2*(gap + 1deg)}").substr(0, 57),
            "1:11 E1212 a length and an angle cannot be added (a bare ");
  EXPECT_EQ(real(kF, "{50% + 1}"), 1.5) << "a part of 1 is a number";
  EXPECT_EQ(complaint(kF, "{gap/5mm}"), "");
  EXPECT_EQ(complaint(kL, "{gap + 1}"), "");
  EXPECT_EQ(complaint(kL, "{5}"), "");
}

TEST(Values, UnitsThatAreNotKnown) {
  EXPECT_EQ(complaint(kL, "3mn").substr(0, 28), "1:8 E1213 unknown unit 'mn' ");
  EXPECT_EQ(complaint(kA, "3degs"), "1:8 E1213 unknown unit 'degs' (did you mean 'deg'?)\n");
  EXPECT_EQ(
      complaint(kL, "3furlongs"),
      "1:8 E1213 unknown unit 'furlongs' (lengths: m, mm, cm, km, um, nm, in or ft; angles: deg, "
      "rad, mrad, urad, arcmin or arcsec)\n");
  EXPECT_EQ(
      complaint(kL, "3 mm"),
      "1:7 E1201 '3 mm' is not a number, expected -1e+30 to 1e+30 for l of <e> (a unit follows its "
      "number without a blank)\n");
}

TEST(Values, RangesAreShownInTheUnitOfTheNumber) {
  EXPECT_EQ(complaint(kP, "-2"), "1:7 E1202 p of <e> is -2, expected more than 0, up to 1000\n");
  EXPECT_EQ(complaint(kP, "-2mm"),
            "1:7 E1202 p of <e> is -2mm, expected more than 0mm, up to 1000000mm\n");
  EXPECT_EQ(complaint(kP, "1e6ft"),
            "1:7 E1202 p of <e> is 1e6ft, expected more than 0ft, up to 3280ft\n");
  EXPECT_EQ(complaint(kP, "-2", {1, 0.001, 1}),
            "1:7 E1202 p of <e> is -2, expected more than 0mm, up to 1000000mm\n");
  EXPECT_EQ(complaint(kA, "91"), "1:7 E1202 a of <e> is 91, expected -90deg to 90deg\n");
  EXPECT_EQ(complaint(kP, "1e6in"),
            "1:7 E1202 p of <e> is 1e6in, expected more than 0in, up to 39300in\n");
  EXPECT_EQ(complaint(kA, "2e3mrad"),
            "1:7 E1202 a of <e> is 2e3mrad, expected -1570mrad to 1570mrad\n");
  EXPECT_EQ(complaint(kP, "{gap - 1}"),
            "1:7 E1202 p of <e> is {gap - 1} = -0.5m, expected more than 0m, up to 1000m\n");
  EXPECT_EQ(complaint(kP, "1e400"),
            "1:7 E1202 p of <e> is 1e400, expected more than 0, up to 1000\n");
  // a computed quarter turn is an ulp too large
  EXPECT_GT(3 * (kThirty), kPi / 2);
  EXPECT_EQ(real(kA, "{3*30deg}"), 1.5707963267948968);
  EXPECT_EQ(complaint(kA, "{3*30.001deg}").substr(0, 9), "1:7 E1202");
}

// ---- expressions in their places

TEST(Values, PlacesInsideExpressions) {
  EXPECT_EQ(complaint(kL, "{1 + gpa}").substr(0, 9), "1:12 E122");
  // an entity is one character of the value, and four of the text
  EXPECT_EQ(complaint(kL, "{1 &lt; 2 ? gpa : 1}").substr(0, 10), "1:19 E1222");
  EXPECT_EQ(complaint(kL, "{1 &amp;&amp; gpa}").substr(0, 10), "1:21 E1222");
  EXPECT_EQ(complaint(kL, "{1 +"), "1:7 E1221 this brace is not closed\n");
  EXPECT_EQ(complaint(kL, "{1 + }"), "1:12 E1221 the expression ends where a value is needed\n");
  EXPECT_EQ(complaint(kL, "{}"), "1:8 E1221 no expression between the braces\n");
  EXPECT_EQ(complaint(kL, "{1 + {2}}"),
            "1:12 E1221 nested braces (inside braces, parentheses group)\n");
  EXPECT_EQ(complaint(kL, "{2}mm"),
            "1:7 E1221 a unit after an expression (units go inside the braces: {2*5mm})\n");
  EXPECT_EQ(
      complaint(kL, "-{2}"),
      "1:8 E1221 an expression is a number of its own (write it all in one pair of braces)\n");
  EXPECT_EQ(complaint(kL, "{1}{2}").substr(0, 9), "1:7 E1221");
  EXPECT_EQ(complaint(kL, "{1} {2}").substr(0, 9), "1:7 E1221");
  EXPECT_EQ(
      complaint(kL, "gap"),
      "1:7 E1201 'gap' is not a number, expected -1e+30 to 1e+30 for l of <e> (names go in braces: "
      "{gap})\n");
  EXPECT_EQ(complaint(kL, "3*gap").substr(0, 9), "1:7 E1201");
  // columns are characters, lines end as they may
  Subject e("<e>1 2\r\n 3 {\u00b5 + 1}\r\n{2*\u00b5}\t5mm {1\r\n + gpa} {7 7}</e>");
  std::vector<double> out;
  EXPECT_FALSE(e.values.list(0, out));
  EXPECT_EQ(e.summary(),
            "2:5 E1221 '\u00b5' is not allowed in an expression\n"
            "3:4 E1221 '\u00b5' is not allowed in an expression\n"
            "4:4 E1222 'gpa' is not a parameter or variable; there are none here\n"
            "4:12 E1221 an operator is missing before '7' (a product is written with *)\n");
}

TEST(Values, WholeNumbers) {
  Subject e("<e n=\"{i + 2*3}\"/>");
  for (int i = 0; i < 3; ++i) {
    e.scope.set("i", {static_cast<double>(i), Dimension::none});
    EXPECT_EQ(e.values.integer(0, kN), 6u + static_cast<unsigned>(i));
  }
  EXPECT_EQ(
      complaint(kN, "{0.1*3*10}"),
      "1:7 E1224 n of <e> is 3.0000000000000004, expected a whole number (floor, ceil and round "
      "make whole numbers)\n");
  EXPECT_EQ(complaint(kN, "{round(0.1*3*10)}"), "");
  EXPECT_EQ(complaint(kN, "{2.5}").substr(0, 9), "1:7 E1224");
  EXPECT_EQ(complaint(kN, "{1e300}").substr(0, 9), "1:7 E1224");
  EXPECT_EQ(complaint(kN, "{-1}"), "1:7 E1202 n of <e> is {-1} = -1, expected 1 to 100\n");
  EXPECT_EQ(complaint(kN, "{101}"), "1:7 E1202 n of <e> is {101} = 101, expected 1 to 100\n");
  EXPECT_EQ(complaint(kN, "2.0"),
            "1:7 E1201 '2.0' is not a whole number, expected 1 to 100 for n of <e> (it has no "
            "decimal point or "
            "exponent)\n");
}

TEST(Values, AttributesOfSeveralNumbers) {
  double out[3] = {};
  Subject three("<e s=\"1 {gap*2/gap} 3\"/>");
  three.scope.set("gap", {0.5, Dimension::length});
  EXPECT_TRUE(three.values.numbers(0, kS, out));
  EXPECT_EQ(out[1], 2);
  for (const char* text : {"<e s=\" 2 \"/>", "<e s=\"{ 1 + 1 }\"/>"}) {
    Subject one(text);
    EXPECT_TRUE(one.values.numbers(0, kS, out));
    EXPECT_EQ(Vec3(out[0], out[1], out[2]), Vec3(2)) << text;
  }
  Subject two("<e s=\"1 2\"/>");
  EXPECT_FALSE(two.values.numbers(0, kS, out));
  EXPECT_EQ(two.summary(),
            "1:2 E1203 s of <e>: expected 3 numbers (x y z) or one for all, found 2\n");
  Subject none("<e/>");
  EXPECT_FALSE(none.values.numbers(0, kS, out));
  EXPECT_EQ(none.summary(), "");
  Subject zero("<e s=\"1 {1 - 1} x\"/>");
  EXPECT_FALSE(zero.values.numbers(0, kS, out));
  EXPECT_EQ(zero.reading.codes(), (std::multiset<std::string>{"E1201", "E1211"}));
}

TEST(Values, Lists) {
  std::vector<double> out;
  Subject plain("<e>1 2\n3 4 5 -6e-1 </e>");
  EXPECT_TRUE(plain.values.list(0, out));
  EXPECT_EQ(out, (std::vector<double>{1, 2, 3, 4, 5, -0.6}));
  Subject mixed("<e>1 2mm {gap} {gap\n+ 1m} 5 6</e>", {1, 0.001, kDegree});
  mixed.scope.set("gap", {0.5, Dimension::length});
  EXPECT_TRUE(mixed.values.list(0, out)) << mixed.summary();
  EXPECT_EQ(out, (std::vector<double>{0.001, 0.002, 0.5, 1.5, 0.005, 0.006}));
  Subject odd("<e>1 2 3 4 5 6 7</e>");
  EXPECT_FALSE(odd.values.list(0, out));
  EXPECT_EQ(odd.summary(), "1:2 E1203 <e>: expected a multiple of 2 numbers, found 7\n");
  Subject few("<e>1 2 3 4</e>");
  EXPECT_FALSE(few.values.list(0, out));
  EXPECT_EQ(few.summary(), "1:2 E1203 <e>: expected at least 6 numbers, found 4\n");
  Subject empty("<e> </e>");
  EXPECT_FALSE(empty.values.list(0, out));
  Subject bad("<e>1 2 3 x 5 6deg</e>");
  EXPECT_FALSE(bad.values.list(0, out));
  EXPECT_EQ(bad.reading.codes(), (std::multiset<std::string>{"E1201", "E1212"}));
  // a CDATA section, and a comment between
  Subject pieces("<e>1 2 <![CDATA[{1 < 2]]><!-- x --> ? 3 : 4} 4 5 6</e>");
  EXPECT_TRUE(pieces.values.list(0, out)) << pieces.summary();
  EXPECT_EQ(out[2], 3);
}

TEST(Values, Quantities) {
  const auto read = [](const std::string& value) {
    Subject e("<e q=\"" + value + "\"/>");
    e.scope.set("gap", {0.5, Dimension::length});
    const auto q = e.values.quantity(0, kQ);
    EXPECT_TRUE(q) << value << e.summary();
    return q.value_or(Quantity{});
  };
  EXPECT_EQ(read("5"), (Quantity{5, Dimension::none, 1, kDegree}));
  EXPECT_EQ(read("-5e300"), (Quantity{-5e300, Dimension::none, 1, kDegree}));
  EXPECT_EQ(read("5mm"), (Quantity{0.005, Dimension::length, 1, kDegree}));
  EXPECT_EQ(read(" 30deg "), (Quantity{kThirty, Dimension::angle, 1, kDegree}));
  EXPECT_EQ(read("5%"), (Quantity{0.05, Dimension::ratio, 1, kDegree}));
  EXPECT_EQ(read("5px"), (Quantity{5, Dimension::pixels, 1, kDegree}));
  EXPECT_EQ(read("{2*gap + 1mm}"), (Quantity{1.001, Dimension::length, 1, kDegree}));
  EXPECT_EQ(read("{gap*gap}"), (Quantity{0.25, Dimension::none, 1, kDegree}));
  EXPECT_EQ(complaint(kQ, "abc"),
            "1:7 E1201 'abc' is not a number, expected a number, with or without a unit, or an "
            "expression in braces for value of <e>\n");
  EXPECT_EQ(complaint(kQ, "1e400").substr(0, 9), "1:7 E1202");
}

TEST(Values, Labels) {
  Subject e("<e name=\"cell_{row}_{2*i}{-i*0}-{i/4} \u00e9 {1 &lt; 2}\"/>");
  e.scope.set("row", {3, Dimension::none});
  e.scope.set("i", {7, Dimension::none});
  EXPECT_EQ(e.values.text(0, kName), "cell_3_140-1.75 \u00e9 1");
  EXPECT_EQ(complaint(kName, "bolt{j}"),
            "1:15 E1222 'j' is not a parameter or variable that is known here\n");
  EXPECT_EQ(complaint(kName, "bolt{1"), "1:14 E1221 this brace is not closed\n");
  EXPECT_EQ(complaint(kName, "bolt}"), "1:14 E1221 unmatched closing brace\n");
  EXPECT_EQ(complaint(kName, "{1}}"), "1:13 E1221 unmatched closing brace\n");
  EXPECT_EQ(complaint(kName, "{1/0} {k}"),
            "1:12 E1223 1 / 0 has no finite value (condition ? value : other can leave it out)\n"
            "1:17 E1222 'k' is not a parameter or variable that is known here\n");
}

// In ISO-8859-1 a micro sign is one byte.
TEST(Values, OtherEncodings) {
  const std::string head = "<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>";
  std::vector<double> out;
  Subject e(head + "<e l=\"3\xb5m\" a=\"{\xe9}\">1 2 3 4 5 6\xb5m</e>");
  EXPECT_EQ(e.values.real(0, kL), 3e-6);
  EXPECT_TRUE(e.values.list(0, out)) << e.summary();
  EXPECT_EQ(out[5], 6e-6);
  EXPECT_FALSE(e.values.real(0, kA));
  EXPECT_EQ(e.summary(), "1:59 E1221 '\u00e9' is not allowed in an expression\n");
}

TEST(Values, HostileTexts) {
  const auto code = [](std::size_t attribute, const std::string& value) {
    return complaint(attribute, value).substr(4, 5);
  };
  EXPECT_EQ(code(kL, std::string(1000000, '{')), "E1221");
  EXPECT_EQ(code(kL, "{" + std::string(1000000, '(') + "}"), "E1221");
  EXPECT_EQ(code(kL, std::string(1000000, '1') + "mm"), "E1202");
  EXPECT_EQ(code(kL, "1" + std::string(1000000, 'm')), "E1213");
  EXPECT_EQ(real(kL, "0." + std::string(1000000, '0') + "1e1000003mm"), 0.1);
  std::vector<double> out;
  std::string text = "<e>";
  for (int i = 0; i < 100000; ++i) text += "{1+} 1xx ";
  Subject e(text + "</e>");
  EXPECT_FALSE(e.values.list(0, out));
}

}  // namespace
}  // namespace panwright::pxn::values_test
