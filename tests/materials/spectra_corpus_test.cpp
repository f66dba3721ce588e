// The tables against the files they come from, where these are at hand.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>

#include "materials/spectra.h"

namespace panwright::materials {
namespace {

const std::string kFolder = PANWRIGHT_CORPUS_DIR "/optical-constants/";

struct Sample {
  double wavelength, n, k;
};

// Rows of three numbers.
std::vector<Sample> samples(const std::string& file) {
  std::vector<Sample> result;
  std::ifstream in(kFolder + "refractiveindex/" + file + ".yml");
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    Sample s{};
    std::string rest;
    if ((words >> s.wavelength >> s.n >> s.k) && !(words >> rest)) result.push_back(s);
  }
  return result;
}

double at(std::span<const double> values, double x) {
  const auto waves = wavelengths_um();
  std::size_t i = 1;
  while (i + 1 < waves.size() && waves[i] < x) ++i;
  const double t = (x - waves[i - 1]) / (waves[i] - waves[i - 1]);
  return (1 - t) * values[i - 1] + t * values[i];
}

double reflectance(double n, double k) {
  return ((n - 1) * (n - 1) + k * k) / ((n + 1) * (n + 1) + k * k);
}

// Interpolated, every sample of a source has its reflectance: measured 0.0138 for silver, whose
// reflectance rises from 0.1 to 0.8 between 320 and 350 nm, and 0.0084 for the others.
TEST(SpectraCorpus, TablesKeepTheReflectanceOfTheirSources) {
  if (samples("Al/Rakic").empty()) GTEST_SKIP() << "no tables at " << kFolder;
  const std::pair<const char*, const char*> rows[] = {
      {"Ag", "Ag/Rakic-BB"},        {"Al", "Al/Rakic"},
      {"Au", "Au/Johnson"},         {"Cu", "Cu/Johnson"},
      {"GaAs", "GaAs/Adachi"},      {"Ge", "Ge/Nunley"},
      {"Si", "Si/Green-2008"},      {"Ti", "Ti/Rakic-BB"},
      {"graphite", "C/Djurisic-o"}, {"steel", "alloys/stainless_steel/Karlsson-austenitic"}};
  for (const auto& [name, file] : rows) {
    const auto table = optical_constants(name);
    ASSERT_TRUE(table);
    double worst = 0;
    std::size_t count = 0;
    for (const Sample& s : samples(file)) {
      if (s.wavelength < 0.3 || s.wavelength > 2.5) continue;
      ++count;
      worst = std::max(
          worst, std::fabs(reflectance(at(table->n, s.wavelength), at(table->k, s.wavelength)) -
                           reflectance(s.n, s.k)));
    }
    std::printf("%s: %zu samples, %.4f\n", name, count, worst);
    EXPECT_GT(count, 20u) << name;
    EXPECT_LE(worst, std::string_view(name) == "Ag" ? 0.0145 : 0.009) << name;
  }
}

// Weighted by hats, the absorptance is that of a fine sum over the solar table.
TEST(SpectraCorpus, SolarAbsorptanceIsThatOfAFineSum) {
  std::ifstream in(kFolder + "solar/astm_e490_00a.dat");
  std::vector<std::pair<double, double>> sun;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    double x = 0, e = 0;
    if (words >> x >> e) sun.push_back({x, e});
  }
  if (sun.empty()) GTEST_SKIP() << "no solar table at " << kFolder;
  for (const auto& [name, file] : {std::pair{"Al", "Al/Rakic"}, std::pair{"Ag", "Ag/Rakic-BB"},
                                   std::pair{"Ti", "Ti/Rakic-BB"}}) {
    const std::vector<Sample> rows = samples(file);
    double absorbed = 0, all = 0;
    for (std::size_t i = 1; i < sun.size(); ++i) {
      const double x = 0.5 * (sun[i].first + sun[i - 1].first);
      if (x < 0.3 || x > 2.5) continue;
      std::size_t k = 1;
      while (k + 1 < rows.size() && rows[k].wavelength < x) ++k;
      const double t = (x - rows[k - 1].wavelength) / (rows[k].wavelength - rows[k - 1].wavelength);
      const double r = reflectance((1 - t) * rows[k - 1].n + t * rows[k].n,
                                   (1 - t) * rows[k - 1].k + t * rows[k].k);
      const double w =
          0.5 * (sun[i].second + sun[i - 1].second) * (sun[i].first - sun[i - 1].first);
      absorbed += w * (1 - r);
      all += w;
    }
    const double got = solar_absorptance({*optical_constants(name), {}, 0}, 1);
    std::printf("%s: %.5f, fine sum %.5f\n", name, got, absorbed / all);
    EXPECT_NEAR(got, absorbed / all, 1e-3) << name;  // measured 8.5e-4
  }
}

}  // namespace
}  // namespace panwright::materials
