#include "ephemeris/analytic.h"

#include <array>
#include <cmath>

#include "ephemeris/internal/data.h"
#include "ephemeris/internal/names.h"

namespace panwright::ephemeris {

namespace {

constexpr double kSecondsOfDay = 86400;
constexpr double kDaysOfCentury = 36525;
constexpr double kKilometresOfAu = 149597870.7;
constexpr double kArcsecondAngle = kDegree / 3600;
constexpr double kObliquity = 84381.406 * kArcsecondAngle;  // at J2000
constexpr double kEarthMoonRatio = 81.30056;                // of masses

double centuries(double et) { return et / (kSecondsOfDay * kDaysOfCentury); }

// Radians of degrees, without whole turns.
double angle_of(double degrees) { return kDegree * std::fmod(degrees, 360.0); }

double power_series(double t, double c0, double c1, double c2, double c3, double c4 = 0) {
  return c0 + t * (c1 + t * (c2 + t * (c3 + t * c4)));
}

// Axes of the mean equator and equinox of date: angles of Fukushima and Williams, radians.
struct Precession {
  double gamma, phi, psi, epsilon;
};

Precession precession(double t) {
  return {kArcsecondAngle * power_series(t, -0.052928, 10.556378, 0.4932044, -0.00031238),
          kArcsecondAngle * power_series(t, 84381.412819, -46.811016, 0.0511268, 0.00053289),
          kArcsecondAngle * power_series(t, -0.041775, 5038.481484, 1.5584175, -0.00018522),
          kArcsecondAngle * power_series(t, 84381.406, -46.836769, -0.0001831, 0.00200340)};
}

// Multiples of the Moon's elongation D, the Sun's anomaly M, the Moon's anomaly M' and its argument
// of latitude F; longitude in 1e-6 degrees by sines, distance in metres by cosines.
struct LongitudeTerm {
  int d, m, mm, f, longitude, distance;
};
constexpr LongitudeTerm kLongitude[] = {{0, 0, 1, 0, 6288774, -20905355},
                                        {2, 0, -1, 0, 1274027, -3699111},
                                        {2, 0, 0, 0, 658314, -2955968},
                                        {0, 0, 2, 0, 213618, -569925},
                                        {0, 1, 0, 0, -185116, 48888},
                                        {0, 0, 0, 2, -114332, -3149},
                                        {2, 0, -2, 0, 58793, 246158},
                                        {2, -1, -1, 0, 57066, -152138},
                                        {2, 0, 1, 0, 53322, -170733},
                                        {2, -1, 0, 0, 45758, -204586},
                                        {0, 1, -1, 0, -40923, -129620},
                                        {1, 0, 0, 0, -34720, 108743},
                                        {0, 1, 1, 0, -30383, 104755},
                                        {2, 0, 0, -2, 15327, 10321},
                                        {0, 0, 1, 2, -12528, 0},
                                        {0, 0, 1, -2, 10980, 79661},
                                        {4, 0, -1, 0, 10675, -34782},
                                        {0, 0, 3, 0, 10034, -23210},
                                        {4, 0, -2, 0, 8548, -21636},
                                        {2, 1, -1, 0, -7888, 24208},
                                        {2, 1, 0, 0, -6766, 30824},
                                        {1, 0, -1, 0, -5163, -8379},
                                        {1, 1, 0, 0, 4987, -16675},
                                        {2, -1, 1, 0, 4036, -12831},
                                        {2, 0, 2, 0, 3994, -10445},
                                        {4, 0, 0, 0, 3861, -11650},
                                        {2, 0, -3, 0, 3665, 14403},
                                        {0, 1, -2, 0, -2689, -7003},
                                        {2, 0, -1, 2, -2602, 0},
                                        {2, -1, -2, 0, 2390, 10056},
                                        {1, 0, 1, 0, -2348, 6322},
                                        {2, -2, 0, 0, 2236, -9884},
                                        {0, 1, 2, 0, -2120, 5751},
                                        {0, 2, 0, 0, -2069, 0},
                                        {2, -2, -1, 0, 2048, -4950},
                                        {2, 0, 1, -2, -1773, 4130},
                                        {2, 0, 0, 2, -1595, 0},
                                        {4, -1, -1, 0, 1215, -3958},
                                        {0, 0, 2, 2, -1110, 0},
                                        {3, 0, -1, 0, -892, 3258},
                                        {2, 1, 1, 0, -810, 2616},
                                        {4, -1, -2, 0, 759, -1897},
                                        {0, 2, -1, 0, -713, -2117},
                                        {2, 2, -1, 0, -700, 2354},
                                        {2, 1, -2, 0, 691, 0},
                                        {2, -1, 0, -2, 596, 0},
                                        {4, 0, 1, 0, 549, -1423},
                                        {0, 0, 4, 0, 537, -1117},
                                        {4, -1, 0, 0, 520, -1571},
                                        {1, 0, -2, 0, -487, -1739},
                                        {2, 1, 0, -2, -399, 0},
                                        {0, 0, 2, -2, -381, -4421},
                                        {1, 1, 1, 0, 351, 0},
                                        {3, 0, -2, 0, -340, 0},
                                        {4, 0, -3, 0, 330, 0},
                                        {2, -1, 2, 0, 327, 0},
                                        {0, 2, 1, 0, -323, 1165},
                                        {1, 1, -1, 0, 299, 0},
                                        {2, 0, 3, 0, 294, 0},
                                        {2, 0, -1, -2, 0, 8752}};

struct LatitudeTerm {
  int d, m, mm, f, latitude;  // 1e-6 degrees by sines
};
constexpr LatitudeTerm kLatitude[] = {
    {0, 0, 0, 1, 5128122}, {0, 0, 1, 1, 280602},  {0, 0, 1, -1, 277693}, {2, 0, 0, -1, 173237},
    {2, 0, -1, 1, 55413},  {2, 0, -1, -1, 46271}, {2, 0, 0, 1, 32573},   {0, 0, 2, 1, 17198},
    {2, 0, 1, -1, 9266},   {0, 0, 2, -1, 8822},   {2, -1, 0, -1, 8216},  {2, 0, -2, -1, 4324},
    {2, 0, 1, 1, 4200},    {2, 1, 0, -1, -3359},  {2, -1, -1, 1, 2463},  {2, -1, 0, 1, 2211},
    {2, -1, -1, -1, 2065}, {0, 1, -1, -1, -1870}, {4, 0, -1, -1, 1828},  {0, 1, 0, 1, -1794},
    {0, 0, 0, 3, -1749},   {0, 1, -1, 1, -1565},  {1, 0, 0, 1, -1491},   {0, 1, 1, 1, -1475},
    {0, 1, 1, -1, -1410},  {0, 1, 0, -1, -1344},  {1, 0, 0, -1, -1335},  {0, 0, 3, 1, 1107},
    {4, 0, 0, -1, 1021},   {4, 0, -1, 1, 833},    {0, 0, 1, -3, 777},    {4, 0, -2, 1, 671},
    {2, 0, 0, -3, 607},    {2, 0, 2, -1, 596},    {2, -1, 1, -1, 491},   {2, 0, -2, 1, -451},
    {0, 0, 3, -1, 439},    {2, 0, 2, 1, 422},     {2, 0, -3, -1, 421},   {2, 1, -1, 1, -366},
    {2, 1, 0, 1, -351},    {4, 0, 0, 1, 331},     {2, -1, 1, 1, 315},    {2, -2, 0, -1, 302},
    {0, 0, 1, 3, -283},    {2, 1, 1, -1, -229},   {1, 1, 0, -1, 223},    {1, 1, 0, 1, 223},
    {0, 1, -2, -1, -220},  {2, 1, -1, -1, -220},  {1, 0, 1, 1, -185},    {2, -1, -2, -1, 181},
    {0, 1, 2, 1, -177},    {4, 0, -2, -1, 176},   {4, -1, -1, -1, 166},  {1, 0, 1, -1, -164},
    {4, 0, 1, -1, 132},    {1, 0, -1, -1, -119},  {4, -1, 0, -1, 115},   {2, -2, 0, 1, 107}};

// Terms of the nutation: multiples of l, l', F, D and Omega; 1e-7 arcseconds, of sines of the
// longitude and cosines of the obliquity, and their change in a century.
struct NutationTerm {
  int l, ll, f, d, om;
  double longitude, longitude_rate, obliquity, obliquity_rate;
};
constexpr NutationTerm kNutation[] = {{0, 0, 0, 0, 1, -172064161, -174666, 92052331, 9086},
                                      {0, 0, 2, -2, 2, -13170906, -1675, 5730336, -3015},
                                      {0, 0, 2, 0, 2, -2276413, -234, 978459, -485},
                                      {0, 0, 0, 0, 2, 2074554, 207, -897492, 470},
                                      {0, 1, 0, 0, 0, 1475877, -3633, 73871, -184},
                                      {0, 1, 2, -2, 2, -516821, 1226, 224386, -677},
                                      {1, 0, 0, 0, 0, 711159, 73, -6750, 0},
                                      {0, 0, 2, 0, 1, -387298, -367, 200728, 18},
                                      {1, 0, 2, 0, 2, -301461, -36, 129025, -63},
                                      {0, -1, 2, -2, 2, 215829, -494, -95929, 299}};

// Longitude and obliquity, radians.
Vec2 nutation(double t) {
  const auto argument = [&](double at, double rate) {
    return kArcsecondAngle * std::fmod(at + rate * t, 1296000.0);
  };
  const double l = argument(485868.249036, 1717915923.2178),
               ll = argument(1287104.79305, 129596581.0481),
               f = argument(335779.526232, 1739527262.8478),
               d = argument(1072260.70369, 1602961601.2090),
               om = argument(450160.398036, -6962890.5431);
  Vec2 out(0);
  for (const NutationTerm& each : kNutation) {
    const det::SinCos s =
        det::sincos(each.l * l + each.ll * ll + each.f * f + each.d * d + each.om * om);
    out.x += (each.longitude + each.longitude_rate * t) * s.sin;
    out.y += (each.obliquity + each.obliquity_rate * t) * s.cos;
  }
  return out * (1e-7 * kArcsecondAngle);
}

// Attitude of the true equator and equinox of date.
Mat3 true_of_date(const Precession& p, const Vec2& nutation_angles) {
  return turned_axes(-(p.epsilon + nutation_angles.y), 1) *
         turned_axes(-(p.psi + nutation_angles.x), 3) * turned_axes(p.phi, 1) *
         turned_axes(p.gamma, 3);
}

}  // namespace

Vec3 moon_from_earth(double et) {
  const double t = centuries(et);
  const double mean = angle_of(power_series(t, 218.31665436, 481267.88123421, -0.0015786,
                                            1 / 538841.0, -1 / 65194000.0)),
               d = angle_of(power_series(t, 297.8501921, 445267.1114034, -0.0018819, 1 / 545868.0,
                                         -1 / 113065000.0)),
               m = angle_of(
                   power_series(t, 357.5291092, 35999.0502909, -0.0001536, 1 / 24490000.0)),
               mm = angle_of(power_series(t, 134.9633964, 477198.8675055, 0.0087414, 1 / 69699.0,
                                          -1 / 14712000.0)),
               f = angle_of(power_series(t, 93.2720950, 483202.0175233, -0.0036539, -1 / 3526000.0,
                                         1 / 863310000.0));
  const double a1 = angle_of(119.75 + 131.849 * t), a2 = angle_of(53.09 + 479264.290 * t),
               a3 = angle_of(313.45 + 481266.484 * t);
  // the eccentricity of the Earth's orbit shrinks
  const double e = power_series(t, 1, -0.002516, -0.0000074, 0);
  const std::array<double, 3> shrunk{1, e, e * e};
  double longitude = 3958 * det::sin(a1) + 1962 * det::sin(mean - f) + 318 * det::sin(a2);
  double latitude = -2235 * det::sin(mean) + 382 * det::sin(a3) + 175 * det::sin(a1 - f) +
                    175 * det::sin(a1 + f) + 127 * det::sin(mean - mm) - 115 * det::sin(mean + mm);
  double distance = 385000560;  // m
  for (const LongitudeTerm& each : kLongitude) {
    const det::SinCos s = det::sincos(each.d * d + each.m * m + each.mm * mm + each.f * f);
    const double factor = shrunk[static_cast<std::size_t>(std::abs(each.m))];
    longitude += factor * each.longitude * s.sin;
    distance += factor * each.distance * s.cos;
  }
  for (const LatitudeTerm& each : kLatitude)
    latitude += shrunk[static_cast<std::size_t>(std::abs(each.m))] * each.latitude *
                det::sin(each.d * d + each.m * m + each.mm * mm + each.f * f);
  const det::SinCos lon = det::sincos(mean + kDegree * 1e-6 * longitude),
                    lat = det::sincos(kDegree * 1e-6 * latitude);
  const Vec3 of_date = 1e-3 * distance * Vec3(lat.cos * lon.cos, lat.cos * lon.sin, lat.sin);
  // from the ecliptic of date
  const Precession p = precession(t);
  return transpose(turned_axes(-p.psi, 3) * turned_axes(p.phi, 1) * turned_axes(p.gamma, 3)) *
         of_date;
}

Vec3 sun_from_earth(double et) {
  const double t = centuries(et);
  const double a = 1.00000261 + 0.00000562 * t, e = 0.01671123 - 0.00004392 * t;
  const double inclination = kDegree * (-0.00001531 - 0.01294668 * t);
  const double perihelion = 102.93768193 + 0.32327364 * t;
  const double mean = angle_of(100.46457166 + 35999.37244981 * t - perihelion);
  double anomaly = mean;
  constexpr int kSteps = 8;
  for (int i = 0; i < kSteps; ++i) {
    const det::SinCos s = det::sincos(anomaly);
    anomaly -= (anomaly - e * s.sin - mean) / (1 - e * s.cos);
  }
  const det::SinCos s = det::sincos(anomaly);
  const Vec3 in_orbit(a * (s.cos - e), a * std::sqrt(1 - e * e) * s.sin, 0);
  // node at 0
  const Vec3 barycentre = transpose(turned_axes(kObliquity, 1)) *
                          (transpose(turned_axes(inclination, 1)) *
                           (transpose(turned_axes(angle_of(perihelion), 3)) * in_orbit));
  // the Earth goes around the barycentre of both
  return -kKilometresOfAu * barycentre + moon_from_earth(et) / (1 + kEarthMoonRatio);
}

Attitude earth_attitude(double et, double ut1) {
  const double t = centuries(et);
  const Precession p = precession(t);
  const Vec2 turns = nutation(t);
  const double days = ut1 / kSecondsOfDay;
  const double rotation =
      2 * kPi * std::fmod(0.7790572732640 + 0.00273781191135448 * days + std::fmod(days, 1.0), 1.0);
  const double sidereal =
      rotation + kArcsecondAngle * power_series(t, 0.014506, 4612.156534, 1.3915817, -0.00000044) +
      turns.x * det::cos(p.epsilon);
  Attitude out;
  out.from_j2000 = turned_axes(sidereal, 3) * true_of_date(p, turns);
  const Vec3 pole(out.from_j2000[0][2], out.from_j2000[1][2], out.from_j2000[2][2]);
  out.rate = 7.292115e-5 * pole;
  return out;
}

Attitude moon_attitude(double et) {
  const double d = et / kSecondsOfDay, t = centuries(et);
  constexpr std::array<std::array<double, 2>, 13> kArguments = {{{125.045, -0.0529921},
                                                                 {250.089, -0.1059842},
                                                                 {260.008, 13.0120009},
                                                                 {176.625, 13.3407154},
                                                                 {357.529, 0.9856003},
                                                                 {311.589, 26.4057084},
                                                                 {134.963, 13.0649930},
                                                                 {276.617, 0.3287146},
                                                                 {34.226, 1.7484877},
                                                                 {15.134, -0.1589763},
                                                                 {119.743, 0.0036096},
                                                                 {239.961, 0.1643573},
                                                                 {25.053, 12.9590088}}};
  constexpr std::array<double, 13> kAscension = {-3.8787, -0.1204, 0.0700,  -0.0172, 0, 0.0072, 0,
                                                 0,       0,       -0.0052, 0,       0, 0.0043};
  constexpr std::array<double, 13> kDeclination = {
      1.5419, 0.0239, -0.0278, 0.0068, 0, -0.0029, 0.0009, 0, 0, 0.0008, 0, 0, -0.0009};
  constexpr std::array<double, 13> kMeridian = {3.5610,  0.1208,  -0.0642, 0.0158, 0.0252,
                                                -0.0066, -0.0047, -0.0046, 0.0028, 0.0052,
                                                0.0040,  0.0019,  -0.0044};
  double ascension = 269.9949 + 0.0031 * t, declination = 66.5392 + 0.0130 * t,
         meridian = 38.3213 + 13.17635815 * d - 1.4e-12 * d * d;
  for (std::size_t i = 0; i < kArguments.size(); ++i) {
    const det::SinCos s = det::sincos(angle_of(kArguments[i][0] + kArguments[i][1] * d));
    ascension += kAscension[i] * s.sin;
    declination += kDeclination[i] * s.cos;
    meridian += kMeridian[i] * s.sin;
  }
  State angles;
  angles.position =
      Vec3(kDegree * (90 + ascension), kDegree * (90 - declination), angle_of(meridian));
  angles.velocity = Vec3(0, 0, kDegree * 13.17635815 / kSecondsOfDay);  // 1 part in 1000
  return attitude_of_angles(angles);
}

}  // namespace panwright::ephemeris
