#include "base/text.h"

#include <gtest/gtest.h>

#include <clocale>
#include <cmath>
#include <cstdlib>

namespace panwright {
namespace {

TEST(ParseDouble, ReadsDecimalNumbersOnly) {
  EXPECT_EQ(parse_double("0.15"), 0.15);
  EXPECT_EQ(parse_double("-3"), -3.0);
  EXPECT_EQ(parse_double("+1e-4"), 1e-4);
  EXPECT_EQ(parse_double(".5"), 0.5);
  EXPECT_EQ(parse_double("5."), 5.0);
  for (const char* bad : {"", "+", "-", "nan", "NaN", "inf", "Infinity", "0x10", "1,5", "1e", "1 ",
                          " 1", "1e999", "-1e999", "+-1", "--1", "1.2.3", "1d3", "e5"})
    EXPECT_FALSE(parse_double(bad)) << bad;
}

TEST(ParseDouble, UnderflowIsZeroAndOverflowIsRefused) {
  EXPECT_EQ(parse_double("1e-999"), 0.0);
  EXPECT_EQ(parse_double("0." + std::string(400, '0') + "1"), 0.0);
  EXPECT_TRUE(std::signbit(*parse_double("-1e-999")));
  EXPECT_FALSE(parse_double("1" + std::string(400, '0')));
  EXPECT_FALSE(parse_double("1" + std::string(400, '0') + ".5"));
}

TEST(ParseDouble, RoundTripsEveryDouble) {
  // a multiplicative walk over exponents and mantissas
  double value = 4.9e-324;
  for (int i = 0; i < 20000 && std::isfinite(value); ++i) {
    EXPECT_EQ(parse_double(format_double(value)), value);
    value = value < 1e-300 ? value * 1.7 + 5e-324 : value * 1.0731;
  }
}

TEST(ParseDouble, IgnoresTheLocale) {
  const std::string before = std::setlocale(LC_ALL, nullptr);
  bool comma = false;
  for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8"})
    comma = comma || std::setlocale(LC_ALL, name) != nullptr;
  EXPECT_EQ(parse_double("1.5"), 1.5);
  EXPECT_EQ(format_double(1.5), "1.5");
  std::setlocale(LC_ALL, before.c_str());
}

TEST(InQuotes, EscapesAndCuts) {
  EXPECT_EQ(in_quotes("a\nb\x01"), "'a\\nb\\x01'");
  const std::string cut = in_quotes(std::string(59, 'x') + "äöü");
  EXPECT_EQ(cut, "'" + std::string(59, 'x') + "ä…'") << "a character must not be cut in two";
}

TEST(Counted, Plural) {
  EXPECT_EQ(counted(1, "triangle"), "1 triangle");
  EXPECT_EQ(counted(0, "triangle"), "0 triangles");
}

}  // namespace
}  // namespace panwright
