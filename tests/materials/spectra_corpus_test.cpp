// The tables against the files they come from, where these are at hand.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>

#include "materials/spectra.h"

namespace panwright::materials::spectra_corpus_test {
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

// The CIE 1931 observer (CIE 15): wavelength in nm, x, y, z.
constexpr double kObserver[][4] = {
    {380, 0.0014, 0.0000, 0.0065}, {390, 0.0042, 0.0001, 0.0201}, {400, 0.0143, 0.0004, 0.0679},
    {410, 0.0435, 0.0012, 0.2074}, {420, 0.1344, 0.0040, 0.6456}, {430, 0.2839, 0.0116, 1.3856},
    {440, 0.3483, 0.0230, 1.7471}, {450, 0.3362, 0.0380, 1.7721}, {460, 0.2908, 0.0600, 1.6692},
    {470, 0.1954, 0.0910, 1.2876}, {480, 0.0956, 0.1390, 0.8130}, {490, 0.0320, 0.2080, 0.4652},
    {500, 0.0049, 0.3230, 0.2720}, {510, 0.0093, 0.5030, 0.1582}, {520, 0.0633, 0.7100, 0.0782},
    {530, 0.1655, 0.8620, 0.0422}, {540, 0.2904, 0.9540, 0.0203}, {550, 0.4334, 0.9950, 0.0087},
    {560, 0.5945, 0.9950, 0.0039}, {570, 0.7621, 0.9520, 0.0021}, {580, 0.9163, 0.8700, 0.0017},
    {590, 1.0263, 0.7570, 0.0011}, {600, 1.0622, 0.6310, 0.0008}, {610, 1.0026, 0.5030, 0.0003},
    {620, 0.8544, 0.3810, 0.0002}, {630, 0.6424, 0.2650, 0},      {640, 0.4479, 0.1750, 0},
    {650, 0.2835, 0.1070, 0},      {660, 0.1649, 0.0610, 0},      {670, 0.0874, 0.0320, 0},
    {680, 0.0468, 0.0170, 0},      {690, 0.0227, 0.0082, 0},      {700, 0.0114, 0.0041, 0},
    {710, 0.0058, 0.0021, 0},      {720, 0.0029, 0.0010, 0},      {730, 0.0014, 0.0005, 0}};

// Rows of two numbers of one part of a file: the first is tabulated n, the second k.
std::vector<std::pair<double, double>> part_of(const std::string& file, const std::string& part) {
  std::vector<std::pair<double, double>> rows;
  std::ifstream in(kFolder + "refractiveindex/commercial_polymers/Kapton/" + file + ".yml");
  bool inside = false;
  for (std::string line; std::getline(in, line);) {
    if (line.find("type:") != std::string::npos) inside = line.ends_with("tabulated " + part);
    std::istringstream words(line);
    double x = 0, value = 0;
    if (inside && words >> x >> value) rows.emplace_back(x, value);
  }
  return rows;
}

double between(const std::vector<std::pair<double, double>>& rows, double x) {
  std::size_t i = 1;
  while (i + 1 < rows.size() && rows[i].first < x) ++i;
  const double t = (x - rows[i - 1].first) / (rows[i].first - rows[i - 1].first);
  return (1 - t) * rows[i - 1].second + t * rows[i].second;
}

// 51 um of Kapton over aluminium in sunlight, from the published files alone: chromaticity and
// luminance that tests/materials/spectra_test.cpp holds the coat against.
TEST(SpectraCorpus, AmberOfKapton) {
  const auto n = part_of("French", "n");
  auto k = part_of("Arakawa", "k");
  const std::vector<Sample> aluminium = samples("Al/Rakic");
  std::vector<std::pair<double, double>> sun;
  std::ifstream in(kFolder + "solar/astm_e490_00a.dat");
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    double x = 0, e = 0;
    if (words >> x >> e) sun.emplace_back(x, e);
  }
  if (n.empty() || k.empty() || aluminium.empty() || sun.empty())
    GTEST_SKIP() << "no tables at " << kFolder;
  // the two sets differ from 0.44 to 0.48 um: logarithms between them
  std::erase_if(k, [](const auto& row) { return row.first >= 0.44; });
  for (const auto& row : part_of("French", "k")) k.push_back(row);
  for (auto& row : k) row.second = std::log(std::max(row.second, 1e-9));
  Vec3 film(0), white(0);
  for (const auto& row : kObserver) {
    const double x = row[0] / 1000;
    std::size_t i = 1;
    while (i + 1 < aluminium.size() && aluminium[i].wavelength < x) ++i;
    const double outer = between(n, x);
    const double inner = aluminium[i].n / outer, dark = aluminium[i].k / outer;
    const double front = std::pow((outer - 1) / (outer + 1), 2);
    const double back =
        ((inner - 1) * (inner - 1) + dark * dark) / ((inner + 1) * (inner + 1) + dark * dark);
    const double t = std::exp(-8 * kPi * std::exp(between(k, x)) * 51 / x);
    const double r = front + (1 - front) * (1 - front) * t * back / (1 - front * back * t);
    for (int c = 0; c < 3; ++c) {
      film[c] += between(sun, x) * r * row[c + 1];
      white[c] += between(sun, x) * row[c + 1];
    }
  }
  const Vec3 adapted = film / white * Vec3(0.95047, 1, 1.08883);
  const double sum = adapted.x + adapted.y + adapted.z;
  std::printf("x %.4f y %.4f Y %.4f\n", adapted.x / sum, adapted.y / sum, adapted.y);
  // measured 3e-4, 0 and 2.0e-3
  EXPECT_NEAR(adapted.x / sum, 0.4483, 1e-3);
  EXPECT_NEAR(adapted.y / sum, 0.4443, 1e-3);
  EXPECT_NEAR(adapted.y, 0.5230, 4e-3);
}

}  // namespace
}  // namespace panwright::materials::spectra_corpus_test
