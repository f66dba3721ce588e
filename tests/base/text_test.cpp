#include "base/text.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <clocale>
#include <cmath>
#include <cstdlib>
#include <filesystem>

namespace panwright::text_test {
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

TEST(ParseDouble, IgnoresALocaleWithDecimalCommas) {
  const std::string folder = testing::TempDir() + "panwright-locale-" + std::to_string(getpid());
  ASSERT_EQ(mkdir(folder.c_str(), 0700), 0);
  const std::string make = "localedef -i de_DE -f UTF-8 --no-archive " + folder + "/de_DE.UTF-8";
  ASSERT_EQ(std::system(make.c_str()), 0) << "Debian's package locales is needed";
  setenv("LOCPATH", folder.c_str(), 1);
  const std::string before = std::setlocale(LC_ALL, nullptr);
  ASSERT_NE(std::setlocale(LC_ALL, "de_DE.UTF-8"), nullptr);
  EXPECT_EQ(std::strtod("1,5", nullptr), 1.5) << "the locale is not in force";
  EXPECT_EQ(parse_double("1.5"), 1.5);
  EXPECT_FALSE(parse_double("1,5"));
  EXPECT_EQ(format_double(1.5), "1.5");
  std::setlocale(LC_ALL, before.c_str());
  unsetenv("LOCPATH");
  std::filesystem::remove_all(folder);
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
}  // namespace panwright::text_test
