// Public kernels beside the checkout, against values of an independent reader (numpy, from the
// descriptions of the formats) and of CSPICE, written beside them.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/text.h"
#include "ephemeris/kernels.h"
#include "tests/ephemeris/corpus.h"
#include "tests/ephemeris/support.h"

namespace panwright::ephemeris::kernels_corpus_test {
namespace {

namespace fs = std::filesystem;

using testing_support::folder;
using testing_support::load;

class KernelsCorpus : public testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists(folder() / "expected_spk.tsv")) GTEST_SKIP() << "no kernels are at hand";
  }
};

std::vector<std::string> split(const std::string& line, char at) {
  std::vector<std::string> out;
  std::stringstream stream(line);
  for (std::string part; std::getline(stream, part, at);) out.push_back(part);
  return out;
}

// Rows of a table without comments.
std::vector<std::vector<std::string>> rows(const std::string& name) {
  std::vector<std::vector<std::string>> out;
  std::ifstream file(folder() / name);
  for (std::string line; std::getline(file, line);)
    if (!line.empty() && line[0] != '#') out.push_back(split(line, '\t'));
  return out;
}

std::vector<double> numbers(const std::string& text) {
  std::vector<double> out;
  std::stringstream stream(text);
  for (std::string word; stream >> word;)
    if (const auto value = parse_double(word)) out.push_back(*value);
  return out;
}

const Kernels& cached(const std::string& file) {
  static std::map<std::string, Kernels> kernels;
  const auto found = kernels.find(file);
  if (found != kernels.end()) return found->second;
  return kernels.emplace(file, *load({file})).first->second;
}

Vec3 vec(const std::vector<double>& n, std::size_t at) { return {n[at], n[at + 1], n[at + 2]}; }

double distance_to(const Mat3& m, const std::vector<double>& row_major, std::size_t at) {
  double out = 0;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      out = std::max(out, std::abs(m[k][i] - row_major[at + static_cast<std::size_t>(3 * i + k)]));
  return out;
}

// 1e-9 km or 1e-12 of the length, as the table states: residual over that, <= 1.
double share(const Vec3& found, const Vec3& expected) {
  return length(found - expected) / std::max(1e-9, 1e-12 * length(expected));
}

TEST_F(KernelsCorpus, Spk) {
  std::map<std::string, double> worst;
  std::size_t compared = 0, refused = 0;
  for (const auto& row : rows("expected_spk.tsv")) {
    if (row[0] == "file") continue;
    const Kernels& kernels = cached("spk/" + row[0]);
    const auto index = static_cast<std::size_t>(std::stoul(row[1]));
    const double et = *parse_double(row[6]);
    const auto infos = kernels.segments();
    ASSERT_LT(index, infos.size()) << row[0];
    EXPECT_EQ(infos[index].kind, "SPK type " + row[2]);
    EXPECT_EQ(std::to_string(infos[index].id), row[3]);
    EXPECT_EQ(std::to_string(infos[index].relative), row[4]);
    EXPECT_EQ(std::to_string(infos[index].frame), row[5]);
    const auto state = kernels.segment_state(index, et);
    if (row[7] == "REFUSE") {
      ++refused;
      EXPECT_FALSE(state) << row[0];
      EXPECT_FALSE(infos[index].read);
      std::string problem;
      EXPECT_FALSE(kernels.state(infos[index].id, infos[index].relative, kJ2000, et,
                                 Aberration::none, problem));
      EXPECT_NE(problem.find("type " + row[2] + ", which is not read"), problem.npos) << problem;
      continue;
    }
    ASSERT_TRUE(state) << row[0] << " " << row[1] << " " << et;
    std::vector<double> n;
    for (std::size_t i = 7; i < row.size(); ++i) n.push_back(*parse_double(row[i]));
    const double off =
        std::max(share(state->position, vec(n, 0)), share(state->velocity, vec(n, 3)));
    double& most = worst["type " + row[2]];
    most = std::max(most, off);
    EXPECT_LE(off, 1) << row[0] << " segment " << row[1] << " type " << row[2] << " at " << row[6]
                      << fmt::format(" position off {} km, velocity {}",
                                     length(state->position - vec(n, 0)),
                                     length(state->velocity - vec(n, 3)));
    ++compared;
  }
  EXPECT_GT(compared, 900u);
  EXPECT_GT(refused, 1u);
  for (const auto& [type, most] : worst)
    std::cout << type << ": largest share of the tolerance " << most << "\n";
  std::cout << compared << " states, " << refused << " refused\n";
}

TEST_F(KernelsCorpus, Ck) {
  double of_matrix = 0, of_rate = 0;
  std::size_t compared = 0;
  for (const auto& row : rows("expected_ck.tsv")) {
    if (row[0] == "file") continue;
    const Kernels& kernels = cached("ck/" + row[0]);
    const auto index = static_cast<std::size_t>(std::stoul(row[1]));
    const auto infos = kernels.segments();
    EXPECT_EQ(infos[index].kind, "CK type " + row[2]);
    EXPECT_EQ(std::to_string(infos[index].id), row[3]);
    EXPECT_EQ(std::to_string(infos[index].relative), row[4]);
    const auto found = kernels.segment_pointing(index, *parse_double(row[5]));
    if (row[6] == "GAP") {
      EXPECT_FALSE(found);
      continue;
    }
    ASSERT_TRUE(found) << row[0] << " " << row[5];
    std::vector<double> n;
    for (std::size_t i = 6; i < row.size(); ++i)
      if (const auto value = parse_double(row[i])) n.push_back(*value);
    of_matrix = std::max(of_matrix, distance_to(found->from_j2000, n, 4));
    if (n.size() >= 16) {
      ASSERT_TRUE(found->rate);
      of_rate = std::max(of_rate, length(*found->rate - vec(n, 13)));
    }
    ++compared;
  }
  std::cout << compared << " attitudes: matrix " << of_matrix << ", rate " << of_rate << " rad/s\n";
  EXPECT_GT(compared, 20u);
  // 3.0e-12, where two pointings are 4e-9 apart and the table has the first one for both
  EXPECT_LE(of_matrix, 5e-12);
  EXPECT_LE(of_rate, 1e-15);
}

TEST_F(KernelsCorpus, BinaryPck) {
  double of_matrix = 0, of_rate = 0;
  std::size_t compared = 0;
  for (const auto& row : rows("expected_bpck.tsv")) {
    if (row[0] == "file") continue;
    const Kernels& kernels = cached("pck/" + row[0]);
    const auto index = static_cast<std::size_t>(std::stoul(row[1]));
    EXPECT_EQ(std::to_string(kernels.segments()[index].id), row[2]);
    EXPECT_EQ(std::to_string(kernels.segments()[index].relative), row[3]);
    std::vector<double> n;
    for (std::size_t i = 5; i < row.size(); ++i) n.push_back(*parse_double(row[i]));
    const auto angles = kernels.segment_state(index, *parse_double(row[4]));
    ASSERT_TRUE(angles);
    of_rate = std::max(of_rate, length(angles->velocity - vec(n, 3)));
    of_matrix = std::max(of_matrix, share(angles->position, vec(n, 0)) * 1e-12);
    if (row[3] == "1" || row[3] == "17") {  // and the rotation itself
      std::string problem;
      const auto axes = cached("pck/" + row[0])
                            .attitude(row[2] == "3000" ? 13000 : 0, *parse_double(row[4]), problem);
      if (axes && row[3] == "1")
        of_matrix = std::max(of_matrix, distance_to(axes->from_j2000, n, 6));
    }
    ++compared;
  }
  std::cout << compared << " angles: " << of_matrix << ", rates " << of_rate << " rad/s\n";
  EXPECT_GT(compared, 14u);
  EXPECT_LE(of_matrix, 1e-12);
  EXPECT_LE(of_rate, 1e-15);
}

// Clock, PCK and leap second kernels.
TEST_F(KernelsCorpus, Text) {
  // Bennu has no frame that SPICE knows without a kernel
  const std::string frames = testing::TempDir() + "bennu_fixed.tf";
  std::ofstream(frames) << "KPL/FK\n\\begindata\nFRAME_IAU_BENNU = 1402101\n"
                           "FRAME_1402101_NAME = 'IAU_BENNU'\nFRAME_1402101_CLASS = 2\n"
                           "FRAME_1402101_CLASS_ID = 2101955\nFRAME_1402101_CENTER = 2101955\n";
  const auto kernels = load({"text/naif0012.tls", "text/cas00167.tsc", "text/vg200022.tsc",
                             "text/mgs_sclkscet_00061.tsc", "text/messenger_2548.tsc",
                             "pck/pck00010.tpc", frames, "pck/bennu_v16.tpc"});
  ASSERT_TRUE(kernels);
  std::map<std::string, double> worst;
  std::size_t compared = 0;
  int clock = 0;
  std::string problem;
  for (const auto& row : rows("expected_text.tsv")) {
    const auto words = split(row[0], ' ');
    double off = 1;
    if (words[0] == "utc2et") {
      off = std::abs(*kernels->et_of_utc(row[1], problem) - *parse_double(row[2]));
      EXPECT_LE(off, 1e-7) << row[1];
      // and back, to a nanosecond's text
      const auto text = kernels->utc_of_et(*parse_double(row[2]), problem);
      EXPECT_NEAR(*kernels->et_of_utc(*text, problem), *parse_double(row[2]), 2e-7) << *text;
    } else if (words[0] == "ticks2et") {
      clock = std::stoi(words[1]);
      const auto et = kernels->et_of_ticks(clock, *parse_double(row[1]), problem);
      ASSERT_TRUE(et) << problem;
      off = std::abs(*et - *parse_double(row[2]));
      EXPECT_LE(off, 2e-7) << row[0];
    } else if (words[0] == "et2ticks") {
      const auto ticks = kernels->ticks_of_et(std::stoi(words[1]), *parse_double(row[1]), problem);
      ASSERT_TRUE(ticks) << problem;
      off = std::abs(*ticks - *parse_double(row[2])) / std::max(1.0, std::abs(*ticks));
      EXPECT_LE(off, 1e-12) << row[0] << " " << row[1];
    } else if (words[0] == "iau") {
      const int body = std::stoi(words[1]);
      const auto frame = kernels->frame("IAU_" + kernels->body_name(body));
      const auto n = numbers(row[2]);
      ASSERT_TRUE(frame) << row[0];
      const auto axes = kernels->attitude(*frame, *parse_double(row[1]), problem);
      ASSERT_TRUE(axes) << problem;
      off = distance_to(axes->from_j2000, n, 3);
      // 5.7e-11 of Phobos, whose 1.1e7 degrees have steps of 3.2e-11
      EXPECT_LE(off, 1e-10) << row[0] << row[1];
    } else {
      continue;
    }
    double& most = worst[words[0]];
    most = std::max(most, off);
    ++compared;
  }
  EXPECT_EQ(compared, 64u);
  for (const auto& [what, most] : worst) std::cout << what << ": " << most << "\n";
  std::cout << compared << " rows\n";
}

// Values that CSPICE printed.
TEST_F(KernelsCorpus, Cspice) {
  std::string problem;
  const double et = 110617264.18401757;
  const auto mars = load({"spk/allspk_littleendian.bsp"});
  const auto seen = mars->state(499, 399, kJ2000, et, Aberration::none, problem);
  ASSERT_TRUE(seen) << problem;
  EXPECT_LE(
      length(seen->state.position - Vec3(7.38262164145559966564e07, -2.71280305524311661720e07,
                                         -1.87419738849752545357e07)),
      3e-8);
  EXPECT_LE(length(seen->state.velocity -
                   Vec3(-6.80950358877040429206, 7.51381423681132254444, 3.00129002640705921934)),
            1e-14);
  EXPECT_NEAR(seen->light_time, 269.70264751151603, 1e-12);
  const auto corrected = mars->state(499, 399, kJ2000, et, Aberration::lt_s, problem);
  EXPECT_LE(length(corrected->state.position - Vec3(73822235.31053550540400909424,
                                                    -27127918.99847228080034255981,
                                                    -18741306.30148987472057342529)),
            1e-7);
  EXPECT_NEAR(corrected->light_time, 269.6898813661505, 1e-12);
  // convergence moves Mars by a third of a kilometre
  const auto converged = mars->state(499, 399, kJ2000, et, Aberration::cn_s, problem);
  EXPECT_NEAR(length(converged->state.position - corrected->state.position), 0.33, 0.05);

  // Cassini at a record, and axes of a star tracker relative to it
  const auto cassini = load({"text/cas_v40.tf", "ck/allck.bc", "text/cas00167.tsc"});
  const double at = *cassini->et_of_ticks(-82, 267832537952, problem);
  const auto craft_axes = cassini->attitude(*cassini->frame("CASSINI_SC_COORD"), at, problem);
  ASSERT_TRUE(craft_axes) << problem;
  const std::vector<double> matrix{
      0.5064665782997639365,   -0.75794210739897316387, 0.41111478554891744963,
      -0.42372128242505308071, 0.19647683351734512858,  0.88422685364733510927,
      -0.7509672961490383436,  -0.6220294331642198804,  -0.22164725216423822652};
  // 1.5e-8: ticks from ET are rounded, and the craft turns by 3e-3 rad/s
  EXPECT_LE(distance_to(craft_axes->from_j2000, matrix, 0), 1e-7);
  EXPECT_LE(length(*craft_axes->rate -
                   Vec3(-0.00231258422150853885, -0.00190333614370416515, -0.00069657429072504716)),
            1e-7);
  const auto tracker = cassini->attitude(*cassini->frame("CASSINI_SRU-A"), at, problem);
  ASSERT_TRUE(tracker) << problem;
  // v_craft = R v_tracker
  EXPECT_LE(distance_to(craft_axes->from_j2000 * transpose(tracker->from_j2000),
                        {0, 0, 1, 0, 1, 0, -1, 0, 0}, 0),
            1e-15);
  const auto clementine = load({"spk/clementine_t8deg9.bsp"});
  const auto craft =
      clementine->state(-40, 301, kJ2000, -182119484.46283239, Aberration::none, problem);
  ASSERT_TRUE(craft) << problem;
  EXPECT_LE(length(craft->state.position -
                   Vec3(2161.5266437506739, 288.75625694252079, -368.62333558477275)),
            5e-9);

  const auto earth = load({"text/naif0012.tls", "pck/pck00010.tpc"});
  const double when = *earth->et_of_utc("1990-01-01T00:00:00", problem);
  const auto axes = earth->attitude(*earth->frame("IAU_EARTH"), when, problem);
  ASSERT_TRUE(axes);
  // geodetic 118.25 E 34.05 N
  const Vec3 radii = *earth->radii(399);
  const double e2 = 1 - radii.z * radii.z / (radii.x * radii.x);
  const double lon = 118.25 * kDegree, lat = 34.05 * kDegree;
  const double n = radii.x / std::sqrt(1 - e2 * std::sin(lat) * std::sin(lat));
  const Vec3 station(n * std::cos(lat) * std::cos(lon), n * std::cos(lat) * std::sin(lon),
                     n * (1 - e2) * std::sin(lat));
  EXPECT_LE(
      length(transpose(axes->from_j2000) * station - Vec3(-4131.45969, -3308.36805, 3547.02462)),
      2e-5);
}

// Transfer files and the binary files made from them hold equal numbers.
TEST_F(KernelsCorpus, TransferFiles) {
  std::size_t files = 0;
  for (const auto& entry : fs::directory_iterator(folder() / "xfr")) {
    const bool orbit = entry.path().extension() == ".xsp";
    const std::string stem = entry.path().stem().string();
    const auto binary = load({(orbit ? "spk/" : "ck/") + stem + (orbit ? ".bsp" : ".bc")}),
               text = load({"xfr/" + entry.path().filename().string()});
    ASSERT_TRUE(binary && text);
    const auto infos = binary->segments(), others = text->segments();
    ASSERT_EQ(infos.size(), others.size());
    for (std::size_t i = 0; i < infos.size(); ++i) {
      EXPECT_EQ(infos[i].begin, others[i].begin);
      EXPECT_EQ(infos[i].name, others[i].name);
      for (const double part : {0.0, 0.3, 0.8, 1.0}) {
        const double at = infos[i].begin + part * (infos[i].end - infos[i].begin);
        if (orbit) {
          const auto a = binary->segment_state(i, at), b = text->segment_state(i, at);
          ASSERT_EQ(a.has_value(), b.has_value());
          EXPECT_TRUE(!a || (a->position == b->position && a->velocity == b->velocity));
        } else {
          const auto a = binary->segment_pointing(i, at), b = text->segment_pointing(i, at);
          ASSERT_EQ(a.has_value(), b.has_value());
          EXPECT_TRUE(!a || a->from_j2000 == b->from_j2000);
        }
      }
    }
    ++files;
  }
  EXPECT_GE(files, 12u);
}

// Each kernel cut at 100 places, and with other bytes at 100: refused or sound.
TEST_F(KernelsCorpus, Damaged) {
  std::size_t cut = 0, loaded = 0;
  std::string broken;
  for (const char* part : {"spk", "ck", "pck", "text", "xfr"})
    for (const auto& entry : fs::directory_iterator(folder() / part)) {
      if (entry.path().extension() == ".csv") continue;
      std::ifstream file(entry.path(), std::ios::binary);
      const std::string whole((std::istreambuf_iterator<char>(file)), {});
      for (std::size_t k = 0; k < 100; ++k) {
        loaded += testing_support::ask_all(whole.substr(0, whole.size() * k / 100), broken) ? 1 : 0;
        ++cut;
        if (whole.size() > 1u << 18 && k % 10 != 0) continue;
        std::string bytes = whole;
        const std::size_t reach =
            k % 2 == 0 ? bytes.size() : std::min<std::size_t>(bytes.size(), 2048);
        bytes[(k * 2654435761u + 17) % reach] ^= static_cast<char>(1 + k);
        testing_support::ask_all(bytes, broken);
      }
      EXPECT_EQ(broken, "") << entry.path();
    }
  std::cout << cut << " cut files, " << loaded << " of them loaded\n";
  EXPECT_GT(cut, 4000u);
}

TEST_F(KernelsCorpus, Das) {
  DiagnosticLog log;
  const std::vector<fs::path> paths{folder() / "spk/apophis_g_25000mm_rad_obj_0000n00000_v001.bds"};
  EXPECT_FALSE(Kernels::load(paths, log));
  EXPECT_TRUE(log.contains(Code("E8015"))) << to_text(log);
}

}  // namespace
}  // namespace panwright::ephemeris::kernels_corpus_test
