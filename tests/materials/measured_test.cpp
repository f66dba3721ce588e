// Tables of measured reflectance: reading, and BRDFs that are found again.

#include "materials/measured.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>

#include "materials/brdf.h"

namespace panwright::materials::measured_test {
namespace {

class Table : public testing::Test {
 protected:
  Table() {
    folder_ = std::filesystem::temp_directory_path() /
              ("panwright-measured-" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  ~Table() override { std::filesystem::remove_all(folder_); }
  std::string write(const std::string& text) {
    const auto path = folder_ / "t.csv";
    std::ofstream(path) << text;
    return path.string();
  }
  std::multiset<std::string> codes(const std::string& text) {
    DiagnosticLog log;
    EXPECT_FALSE(read_measured(write(text), log));
    std::multiset<std::string> out;
    for (const Diagnostic& entry : log.entries()) out.emplace(code_info(entry.code).name);
    return out;
  }
  std::filesystem::path folder_;
};

std::string many_lines(const std::string& line, int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += line + "\n";
  return text;
}

TEST_F(Table, ByteOrderMarksAreSkipped) {
  for (const char* const first : {"\xEF\xBB\xBF# words\n",
                                  "\xEF\xBB\xBF"
                                  "10 180 20 90 1e-2\n"}) {
    DiagnosticLog log;
    const auto readings = read_measured(write(first + many_lines("10 180 20 90 1e-2", 8)), log);
    ASSERT_TRUE(readings);
    EXPECT_EQ(log.entries().size(), 0u);
    EXPECT_EQ(readings->size(), first[3] == '#' ? 8u : 9u);
  }
}

TEST_F(Table, EveryParting) {
  DiagnosticLog log;
  const auto readings = read_measured(
      write("# words\nphi,theta\n30 0 -40 0 0.25\n30,0,-40,0,0.25\r\n 30;0;-40;0;0.25\n\n" +
            many_lines("10\t180\t20\t90\t1e-2", 8)),
      log);
  ASSERT_TRUE(readings);
  EXPECT_EQ(log.entries().size(), 0u);
  ASSERT_EQ(readings->size(), 11u);
  for (int i = 0; i < 3; ++i) {
    const Reading& r = (*readings)[static_cast<std::size_t>(i)];
    EXPECT_NEAR(r.to_light.x, 0.5, 1e-15);
    EXPECT_NEAR(r.to_viewer.x, -std::sin(40 * kDegree), 1e-15) << "the other side";
    EXPECT_EQ(r.reflectance, 0.25);
  }
  EXPECT_NEAR((*readings)[3].to_viewer.y, std::sin(20 * kDegree), 1e-15);
}

TEST_F(Table, BadInput) {
  using Codes = std::multiset<std::string>;
  EXPECT_EQ(codes(""), Codes{"E1409"});
  EXPECT_EQ(codes("# only words\n"), Codes{"E1409"});
  EXPECT_EQ(codes(many_lines("10 0 10 0 1", 7)), Codes{"E1409"}) << "too short";
  EXPECT_EQ(codes(many_lines("10 0 90 0 1", 20)), Codes{"E1409"}) << "all on the horizon";
  EXPECT_EQ(codes("10 0 10 0\n" + many_lines("10 0 10 0 1", 9)), Codes{"E1409"});
  EXPECT_EQ(codes("10 0 10 0 1 2\n" + many_lines("10 0 10 0 1", 9)), Codes{"E1409"});
  EXPECT_EQ(codes("10 0 10 0 nan\n" + many_lines("10 0 10 0 1", 9)), Codes{"E1409"});
  EXPECT_EQ(codes("10 0 10 0 -1\n" + many_lines("10 0 10 0 1", 9)), Codes{"E1409"});
  EXPECT_EQ(codes("100 0 10 0 1\n10 0 0 0 -1\n" + many_lines("10 0 10 0 1", 9)),
            (Codes{"E1409", "E1409"}))
      << "each kind is named";
  EXPECT_EQ(codes("10 0 10 0 1 2\n" + many_lines("10 0 10 0 1 2 3", 9)), Codes{"E1409"});
  EXPECT_EQ(codes(many_lines("10 0 10 0 1 2 3", 9) + "10 0 10 0 1\n"), Codes{"E1409"})
      << "five numbers after seven";
}

TEST_F(Table, AnErrorIsStatedOnce) {
  DiagnosticLog log;
  EXPECT_FALSE(read_measured(write("# one\n" + many_lines("10 0 10 0", 500)), log));
  ASSERT_EQ(log.entries().size(), 1u);
  EXPECT_EQ(log.entries()[0].message,
            "4 numbers, expected 5, or 7 with three bands, and 499 lines like it");
}

TEST_F(Table, ThreeBands) {
  DiagnosticLog log;
  const auto readings =
      read_measured(write("t_i p_i t_r p_r R G B\n" + many_lines("10,0,20,0,0.3,0.2,0.1", 8)), log);
  ASSERT_TRUE(readings);
  EXPECT_EQ((*readings)[0].rgb, Vec3(0.3, 0.2, 0.1));
  EXPECT_NEAR((*readings)[0].reflectance, 0.2, 1e-15);
  EXPECT_TRUE(has_color(*readings));
}

std::vector<Reading> synthetic(const Material& material, int step = 4) {
  std::vector<Reading> readings;
  for (const double light : {5.0, 30.0, 60.0})
    for (int viewer = -80; viewer <= 80; viewer += step) {
      Reading r;
      r.to_light = Vec3(-std::sin(light * kDegree), 0, std::cos(light * kDegree));
      r.to_viewer = Vec3(std::sin(viewer * kDegree), 0, std::cos(viewer * kDegree));
      r.rgb = f64::brdf(material, r.to_light, r.to_viewer, Vec3(0, 0, 1));
      r.reflectance = (r.rgb.x + r.rgb.y + r.rgb.z) / 3;
      readings.push_back(r);
    }
  return readings;
}

// What a BRDF made is found again, to the digits that the search stops at.
TEST(Fits, FindWhatMadeTheReadings) {
  Material m;
  m.diffuse = Vec3(1);
  m.specular = Vec3(1);
  m.specular_brdf = Ggx{0.17, 0.17};
  m.compensation = Compensation::off;
  m.weights = {0.35, 0.2, 0};
  fit(m);
  const std::vector<Fit> fits = fitted_brdfs(synthetic(m), 1e-6);
  EXPECT_EQ(fits.front().brdf, "GGX microfacets over Lambert");
  EXPECT_LT(fits.front().rms_decades, 1e-4);  // measured 3e-6
  EXPECT_NEAR(std::get<Ggx>(fits.front().material.specular_brdf).alpha_x, 0.17, 1e-4);
  EXPECT_NEAR(fits.front().material.weights.x, 0.35, 1e-4);
  EXPECT_NEAR(fits.front().material.weights.y, 0.2, 1e-4);
  for (std::size_t i = 1; i < fits.size(); ++i)
    EXPECT_GE(fits[i].rms_decades, fits[i - 1].rms_decades) << "the best first";
}

// The same with colours: gold microfacets over a bluish base. The mean of the channels is no BRDF
// of the family, so that the slope is near only.
TEST(Fits, FindTheColorsThatMadeTheReadings) {
  Material m;
  m.diffuse = {0.2, 0.3, 0.5};
  m.specular = {0.9, 0.7, 0.3};
  m.specular_brdf = Ggx{0.17, 0.17};
  m.compensation = Compensation::off;
  m.weights = {0.5, 0.5, 0};
  fit(m);
  const Fit best = fitted_brdfs(synthetic(m, 10), 1e-6).front();
  EXPECT_EQ(best.brdf, "GGX microfacets over Lambert");
  EXPECT_LT(best.rms_decades, 1e-3);
  for (const int k : {0, 1, 2}) {
    EXPECT_NEAR(best.material.weights.x * best.material.diffuse[k], 0.5 * m.diffuse[k], 1e-3);
    EXPECT_NEAR(best.material.weights.y * best.material.specular[k], 0.5 * m.specular[k], 1e-3);
  }
  EXPECT_LE(best.material.weights.x + best.material.weights.y, 1 + 1e-12);
}

// Of many readings some decide. Every fourth reading of this table is of another surface, and so
// are those of every fourth direction: a stride through it would see one of them only.
TEST(Fits, ALargeTableIsSeenEverywhere) {
  Material m;
  m.diffuse = Vec3(0.4);
  std::vector<Reading> readings;
  while (readings.size() < 30'000) {
    Reading r = synthetic(m)[readings.size() % 100];
    const bool dark = readings.size() % 4 == 0;
    if (dark) r.reflectance *= 1e-2;
    r.rgb = Vec3(r.reflectance);
    readings.push_back(r);
  }
  const std::vector<Fit> fits = fitted_brdfs(readings, 1e-6);
  const auto lambert =
      std::find_if(fits.begin(), fits.end(), [](const Fit& f) { return f.brdf == "Lambert"; });
  // the mean of the logarithms; measured 4e-5
  EXPECT_NEAR(std::log10(lambert->material.diffuse.y), std::log10(0.4) - 2.0 / 4, 1e-3);
}

TEST(Fits, FlatReadingsAreLambert) {
  Material m;
  m.diffuse = Vec3(0.4);
  const std::vector<Fit> fits = fitted_brdfs(synthetic(m), 1e-6);
  const auto lambert =
      std::find_if(fits.begin(), fits.end(), [](const Fit& f) { return f.brdf == "Lambert"; });
  EXPECT_NEAR(lambert->material.diffuse.y, 0.4, 1e-6);
  EXPECT_LT(lambert->rms_decades, 1e-6);
}

}  // namespace
}  // namespace panwright::materials::measured_test
