// Users' tables of optical constants.
#include "materials/spectra_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace panwright::materials::spectra_file_test {
namespace {

std::string problem_of(std::string_view text, std::size_t line) {
  TableProblem problem;
  EXPECT_FALSE(read_optical_table(text, problem)) << text;
  EXPECT_EQ(problem.line, line) << text;
  return problem.message;
}

Conductor good(std::string_view text) {
  TableProblem problem;
  const auto read = read_optical_table(text, problem);
  EXPECT_TRUE(read) << text << ": " << problem.message;
  return read.value_or(Conductor{});
}

TEST(SpectraFile, PlainTables) {
  const char* const kTables[] = {
      "wavelength,n,k\n0.4,1,3\n0.6,2,5\n0.7,4,6\n",
      "\xEF\xBB\xBF# mine\r\n0.4; 1; 3\r\n0.6; 2; 5\r\n0.7; 4; 6\r\n",
      "\"um\" \"n\" \"k\"\n  0.4\t1\t3\n\n0.6 2 5\n0.7 4 6",
  };
  for (const char* table : kTables) {
    const Conductor read = good(table);
    EXPECT_NEAR(read.n.x, 3, 1e-12);
    EXPECT_NEAR(read.n.y, 1.75, 1e-12);
    EXPECT_NEAR(read.n.z, 1.25, 1e-12);
    EXPECT_NEAR(read.k.x, 5.5, 1e-12);
    EXPECT_NEAR(read.k.y, 4.5, 1e-12);
    EXPECT_NEAR(read.k.z, 3.5, 1e-12);
  }
  EXPECT_EQ(good("0.45 1.5\n0.65 1.5").n, Vec3(1.5));
  EXPECT_EQ(good("0.45 1.5\n0.65 1.5").k, Vec3(0));
}

TEST(SpectraFile, FilesOfRefractiveindexInfo) {
  Conductor read = good(
      "# comment\nREFERENCES: \"A. Author 5, 4 (1998)\"\nDATA:\n  - type: tabulated nk\n    data: "
      "|\n"
      "        0.3 1 2\n        0.5 2 2\n        0.8 5 2\nSPECS:\n    n_is_absolute: true\n");
  EXPECT_NEAR(read.n.y, 2.5, 1e-12);
  EXPECT_EQ(read.k, Vec3(2));
  // n and k in tables of their own
  read = good(
      "DATA:\n  - type: tabulated n\n    data: |\n        0.4 1.7\n        0.7 1.7\n"
      "  - type: tabulated k\n    data: |\n        0.4 0.3\n        0.7 0\n");
  EXPECT_NEAR(read.n.x, 1.7, 1e-12);
  EXPECT_NEAR(read.k.y, 0.15, 1e-12);
  // fused silica, I. H. Malitson 1965, as the site has it: n at 0.5876 um is 1.4585
  read = good(
      "DATA:\n  - type: formula 1\n    wavelength_range: 0.21 6.7\n"
      "    coefficients: 0 0.6961663 0.0684043 0.4079426 0.1162414 0.8974794 9.896161\n");
  EXPECT_NEAR(read.n.x, 1.4565, 1e-4);
  EXPECT_NEAR(read.n.y, 1.4599, 1e-4);
  EXPECT_NEAR(read.n.z, 1.4656, 1e-4);
  // the same by the second formula, whose poles are squared already
  const Conductor squared = good(
      "DATA:\n  - type: formula 2\n    wavelength_range: 0.21 6.7\n    coefficients: 0 0.6961663 "
      "0.00467914825849 0.4079426 0.01351206307396 0.8974794 97.93400253792099\n");
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(squared.n[k], read.n[k], 1e-12);
}

TEST(SpectraFile, BadTables) {
  using testing::HasSubstr;
  EXPECT_THAT(problem_of("", 0), HasSubstr("no row"));
  EXPECT_THAT(problem_of("0.4 1 2\n0.7 1 x\n", 2), HasSubstr("expected a row of"));
  EXPECT_THAT(problem_of("0.4 1 2\n0.7\n", 2), HasSubstr("expected a row of"));
  EXPECT_THAT(problem_of("0.4 1 2 3\n", 1), HasSubstr("expected a row of"));
  EXPECT_THAT(problem_of("0.4 1 2\n0.4 1 2\n", 2), HasSubstr("expected a larger one"));
  EXPECT_THAT(problem_of("0.4 1 2\n0.3 1 2\n", 2), HasSubstr("expected a larger one"));
  EXPECT_THAT(problem_of("-0.4 1 2\n", 1), HasSubstr("above 0"));
  EXPECT_THAT(problem_of("0.4 0 2\n", 1), HasSubstr("n is 0"));
  EXPECT_THAT(problem_of("0.4 1 -2\n", 1), HasSubstr("k is -2"));
  EXPECT_THAT(problem_of("0.4 nan 2\n", 1), HasSubstr("expected a row of"));
  EXPECT_THAT(problem_of("0.4 1 1e999\n", 1), HasSubstr("expected a row of"));
  EXPECT_THAT(problem_of("0.4 1 101\n", 1), HasSubstr("k is 101"));
  EXPECT_THAT(problem_of("0.5 1\n0.7 1\n", 0), HasSubstr("from 0.5 to 0.7"));
  EXPECT_THAT(problem_of("0.5 1\n", 0), HasSubstr("expected from 0.45 to 0.65"));
  EXPECT_THAT(problem_of("400 1\n700 1\n", 0), HasSubstr("nanometres"));
  EXPECT_THAT(problem_of("DATA:\n  - type: formula 5\n", 2), HasSubstr("'formula 5'"));
  EXPECT_THAT(problem_of("  - type: formula 1\n    coefficients: 0 1\n", 2), HasSubstr("odd"));
  EXPECT_THAT(problem_of("  - type: formula 1\n    coefficients: -9 1 0.1\n", 0),
              HasSubstr("no valid n"));
  EXPECT_THAT(
      problem_of("  - type: formula 1\n    wavelength_range: 1 2\n    coefficients: 0 1 0.1\n", 0),
      HasSubstr("from 1 to 2"));
  EXPECT_THAT(problem_of("  - type: tabulated nk\n    data: |\n      0.4 1\n", 3),
              HasSubstr("n and k"));
  std::string many;
  for (int i = 0; i <= 100000; ++i) many += std::to_string(0.3 + i * 1e-5) + " 1.5 0\n";
  EXPECT_THAT(problem_of(many, 100001), HasSubstr("100000"));
}

}  // namespace
}  // namespace panwright::materials::spectra_file_test
