#include "ephemeris/internal/names.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>

namespace panwright::ephemeris {

namespace {

struct KnownBody {
  int id;
  std::string_view name;  // plain
};

// The first name of a number is the one shown.
constexpr KnownBody kBodies[] = {{0, "SOLAR SYSTEM BARYCENTER"},
                                 {0, "SSB"},
                                 {1, "MERCURY BARYCENTER"},
                                 {2, "VENUS BARYCENTER"},
                                 {3, "EARTH BARYCENTER"},
                                 {3, "EARTH MOON BARYCENTER"},
                                 {3, "EMB"},
                                 {4, "MARS BARYCENTER"},
                                 {5, "JUPITER BARYCENTER"},
                                 {6, "SATURN BARYCENTER"},
                                 {7, "URANUS BARYCENTER"},
                                 {8, "NEPTUNE BARYCENTER"},
                                 {9, "PLUTO BARYCENTER"},
                                 {10, "SUN"},
                                 {199, "MERCURY"},
                                 {299, "VENUS"},
                                 {399, "EARTH"},
                                 {301, "MOON"},
                                 {499, "MARS"},
                                 {401, "PHOBOS"},
                                 {402, "DEIMOS"},
                                 {599, "JUPITER"},
                                 {501, "IO"},
                                 {502, "EUROPA"},
                                 {503, "GANYMEDE"},
                                 {504, "CALLISTO"},
                                 {505, "AMALTHEA"},
                                 {699, "SATURN"},
                                 {601, "MIMAS"},
                                 {602, "ENCELADUS"},
                                 {603, "TETHYS"},
                                 {604, "DIONE"},
                                 {605, "RHEA"},
                                 {606, "TITAN"},
                                 {607, "HYPERION"},
                                 {608, "IAPETUS"},
                                 {609, "PHOEBE"},
                                 {799, "URANUS"},
                                 {701, "ARIEL"},
                                 {702, "UMBRIEL"},
                                 {703, "TITANIA"},
                                 {704, "OBERON"},
                                 {705, "MIRANDA"},
                                 {899, "NEPTUNE"},
                                 {801, "TRITON"},
                                 {802, "NEREID"},
                                 {999, "PLUTO"},
                                 {901, "CHARON"},
                                 {2000001, "CERES"},
                                 {2000004, "VESTA"},
                                 {2000433, "EROS"},
                                 {2025143, "ITOKAWA"},
                                 {2101955, "BENNU"},
                                 {2162173, "RYUGU"},
                                 {2099942, "APOPHIS"},
                                 {2065803, "DIDYMOS"},
                                 {1000012, "CHURYUMOV GERASIMENKO"},
                                 {-31, "VOYAGER 1"},
                                 {-32, "VOYAGER 2"},
                                 {-40, "CLEMENTINE"},
                                 {-41, "MARS EXPRESS"},
                                 {-48, "HUBBLE SPACE TELESCOPE"},
                                 {-61, "JUNO"},
                                 {-64, "OSIRIS REX"},
                                 {-74, "MRO"},
                                 {-74, "MARS RECON ORBITER"},
                                 {-77, "GALILEO ORBITER"},
                                 {-82, "CASSINI"},
                                 {-85, "LRO"},
                                 {-85, "LUNAR RECONNAISSANCE ORBITER"},
                                 {-86, "CHANDRAYAAN 1"},
                                 {-93, "NEAR"},
                                 {-94, "MARS GLOBAL SURVEYOR"},
                                 {-94, "MGS"},
                                 {-98, "NEW HORIZONS"},
                                 {-121, "BEPICOLOMBO MPO"},
                                 {-130, "HAYABUSA"},
                                 {-131, "KAGUYA"},
                                 {-37, "HAYABUSA2"},
                                 {-135, "DART"},
                                 {-143, "TGO"},
                                 {-152, "CHANDRAYAAN 2"},
                                 {-170, "JWST"},
                                 {-203, "DAWN"},
                                 {-226, "ROSETTA"},
                                 {-236, "MESSENGER"},
                                 {-28, "JUICE"},
                                 {-159, "EUROPA CLIPPER"},
                                 {-125544, "ISS"}};

constexpr std::array<std::string_view, 21> kFrames = {
    "J2000",  "B1950",   "FK4",        "DE-118",     "DE-96",  "DE-102",   "DE-108",
    "DE-111", "DE-114",  "DE-122",     "DE-125",     "DE-130", "GALACTIC", "DE-200",
    "DE-202", "MARSIAU", "ECLIPJ2000", "ECLIPB1950", "DE-140", "DE-142",   "DE-143"};

constexpr double kArcsecond = kDegree / 3600;

Mat3 three_turns(double a, int i, double b, int j, double c, int k) {
  return turned_axes(a * kArcsecond, i) * turned_axes(b * kArcsecond, j) *
         turned_axes(c * kArcsecond, k);
}

// NAIF, Frames Required Reading, appendix of built-in inertial frames: arcseconds.
std::array<Mat3, kFrames.size()> inertial_frames() {
  std::array<Mat3, kFrames.size()> out;
  const Mat3 b1950 = three_turns(1152.84248596724, 3, -1002.26108439117, 2, 1153.04066200330, 3);
  const auto of_b1950 = [&](double offset) { return turned_axes(offset * kArcsecond, 3) * b1950; };
  out[0] = Mat3(1);
  out[1] = b1950;
  constexpr std::array<double, 10> kOffsets = {0.525,  0.53155, 0.4107, 0.1359, 0.4775,
                                               0.5880, 0.5529,  0.5316, 0.5754, 0.5247};
  for (std::size_t i = 0; i < kOffsets.size(); ++i) out[2 + i] = of_b1950(kOffsets[i]);
  out[12] = three_turns(1177200, 3, 225360, 1, 1016100, 3) * out[2];
  out[13] = out[14] = Mat3(1);
  out[15] = three_turns(324000, 3, 133610.4, 2, -152348.4, 3);
  out[16] = turned_axes(84381.448 * kArcsecond, 1);
  out[17] = turned_axes(84404.836 * kArcsecond, 1) * b1950;
  out[18] = three_turns(1152.71013777252, 3, -1002.25042010533, 2, 1153.75719544491, 3);
  out[19] = three_turns(1152.72061453864, 3, -1002.25052830351, 2, 1153.74663857521, 3);
  out[20] = three_turns(1153.03919093833, 3, -1002.24822382286, 2, 1153.42900222357, 3);
  return out;
}

// Numbers of IAU frames from 10010 on: the bodies.
constexpr std::array<int, 17> kIauBodies = {10,  199, 299, 399, 499, 599, 699, 799, 899,
                                            999, 301, 401, 402, 501, 502, 503, 504};
constexpr int kFirstIau = 10010;

}  // namespace

std::string plain_name(std::string_view name) {
  std::string out;
  for (const char c : name) {
    const char plain =
        c == '_' ? ' ' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    if (plain == ' ' && (out.empty() || out.back() == ' ')) continue;
    out.push_back(plain);
  }
  if (out.ends_with(' ')) out.pop_back();
  return out;
}

std::optional<int> known_body(std::string_view plain) {
  for (const KnownBody& each : kBodies)
    if (each.name == plain) return each.id;
  return std::nullopt;
}

std::string_view known_body_name(int id) {
  for (const KnownBody& each : kBodies)
    if (each.id == id) return each.name;
  return {};
}

std::optional<int> inertial_frame(std::string_view plain) {
  for (std::size_t i = 0; i < kFrames.size(); ++i)
    if (kFrames[i] == plain) return static_cast<int>(i) + 1;
  return std::nullopt;
}

std::string_view inertial_frame_name(int id) {
  if (id < 1 || id > static_cast<int>(kFrames.size())) return {};
  return kFrames[static_cast<std::size_t>(id) - 1];
}

const Mat3& inertial_from_j2000(int id) {
  static const auto frames = inertial_frames();
  return frames[static_cast<std::size_t>(id) - 1];
}

std::optional<int> iau_frame_of(int body) {
  const auto found = std::ranges::find(kIauBodies, body);
  if (found == kIauBodies.end()) return std::nullopt;
  return kFirstIau + static_cast<int>(found - kIauBodies.begin());
}

std::optional<int> body_of_iau_frame(int frame) {
  if (frame < kFirstIau) return std::nullopt;
  const auto at = static_cast<std::size_t>(frame - kFirstIau);
  if (at >= kIauBodies.size()) return std::nullopt;
  return kIauBodies[at];
}

Mat3 turned_axes(double angle, int axis) {
  const det::SinCos t = det::sincos(angle);
  if (axis == 1) return {1, 0, 0, 0, t.cos, -t.sin, 0, t.sin, t.cos};
  if (axis == 2) return {t.cos, 0, t.sin, 0, 1, 0, -t.sin, 0, t.cos};
  return {t.cos, -t.sin, 0, t.sin, t.cos, 0, 0, 0, 1};
}

}  // namespace panwright::ephemeris
