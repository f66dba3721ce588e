// Attitudes of frames, by their class.
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "base/text.h"
#include "ephemeris/internal/clocks.h"
#include "ephemeris/internal/data.h"
#include "ephemeris/internal/names.h"

namespace panwright::ephemeris {

namespace {

constexpr int kMostDepth = 16;  // frames relative to frames
constexpr double kDay = 86400;
constexpr double kCentury = 36525 * kDay;

// Value and rate by time of a polynomial in time / unit.
struct Angle {
  double value = 0, rate = 0;
};

Angle polynomial(const std::vector<double>& c, double time, double unit) {
  Angle out;
  const double x = time / unit;
  for (std::size_t i = c.size(); i-- > 0;) {
    out.rate = out.rate * x + out.value;
    out.value = out.value * x + c[i];
  }
  out.rate /= unit;
  return out;
}

// Number whose angles a body's sums are in: that of its planet's system.
int system_of(int body) {
  if (body >= 100 && body <= 999) return body / 100;
  return body >= 10000 && body <= 99999 ? body / 10000 : body;
}

// Angles of the sums, degrees: polynomials in centuries, of degree 1 or as stated.
std::vector<Angle> sum_angles(const Pool& pool, int body, double et) {
  const std::string system = fmt::format("BODY{}", system_of(body));
  const auto* const all = pool.numbers(system + "_NUT_PREC_ANGLES");
  std::vector<Angle> out;
  if (all == nullptr) return out;
  constexpr double kMostDegree = 10;
  const double degree = pool.number(system + "_MAX_PHASE_DEGREE").value_or(1);
  const auto terms =
      degree >= 1 && degree <= kMostDegree ? static_cast<std::size_t>(degree) + 1 : 2;
  for (std::size_t i = 0; i + terms <= all->size(); i += terms) {
    const auto first = all->begin() + static_cast<std::ptrdiff_t>(i);
    out.push_back(polynomial({first, first + static_cast<std::ptrdiff_t>(terms)}, et, kCentury));
  }
  return out;
}

// False: more factors than angles.
bool add_sums(const std::vector<double>* factors, const std::vector<Angle>& angles, bool by_cosine,
              Angle& out) {
  if (factors == nullptr) return true;
  for (std::size_t i = 0; i < factors->size(); ++i) {
    const double factor = (*factors)[i];
    if (factor == 0) continue;
    if (i >= angles.size()) return false;
    const det::SinCos t = det::sincos(kDegree * std::fmod(angles[i].value, 360.0));
    out.value += factor * (by_cosine ? t.cos : t.sin);
    out.rate += factor * (by_cosine ? -t.sin : t.cos) * kDegree * angles[i].rate;
  }
  return true;
}

std::optional<Mat3> fixed_matrix(const Pool& pool, const std::string& base, std::string& problem) {
  const std::string spec = pool.text(base + "SPEC").value_or("");
  if (const auto* const m = pool.numbers(base + "MATRIX"); spec == "MATRIX" && m && m->size() == 9)
    // its columns, of the frame's vectors in the other axes
    return transpose(
        Mat3((*m)[0], (*m)[1], (*m)[2], (*m)[3], (*m)[4], (*m)[5], (*m)[6], (*m)[7], (*m)[8]));
  if (const auto* const q = pool.numbers(base + "Q"); spec == "QUATERNION" && q && q->size() == 4) {
    const Quat turn((*q)[0], (*q)[1], (*q)[2], (*q)[3]);
    const double length = std::sqrt(dot(turn, turn));
    if (length > 0.5 && length < 2) return transpose(glm::mat3_cast(turn / length));
  }
  const auto* const angles = pool.numbers(base + "ANGLES");
  const auto* const axes = pool.numbers(base + "AXES");
  if (spec == "ANGLES" && angles && axes && angles->size() == 3 && axes->size() == 3) {
    const std::string unit = plain_name(pool.text(base + "UNITS").value_or("DEGREES"));
    double scale = 0;
    if (unit == "DEGREES") scale = kDegree;
    if (unit == "RADIANS") scale = 1;
    if (unit == "ARCSECONDS") scale = kDegree / 3600;
    if (unit == "ARCMINUTES") scale = kDegree / 60;
    if (unit == "HOURANGLE") scale = 15 * kDegree;
    Mat3 out(1);  // v_relative = [a1] [a2] [a3] v_frame
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t axis = whole_number((*axes)[i], 3);
      if (axis < 1 || axis > 3) scale = 0;
      out = out * turned_axes((*angles)[i] * scale, static_cast<int>(axis));
    }
    if (scale > 0) return transpose(out);
  }
  problem = fmt::format("{}SPEC has no sound MATRIX, ANGLES or QUATERNION", base);
  return std::nullopt;
}

}  // namespace

Attitude attitude_of_angles(const State& angles) {
  const double phi = angles.position.x;
  Attitude out;
  out.from_j2000 =
      turned_axes(angles.position.z, 3) * turned_axes(angles.position.y, 1) * turned_axes(phi, 3);
  const det::SinCos node = det::sincos(phi);
  const Vec3 pole(out.from_j2000[0][2], out.from_j2000[1][2], out.from_j2000[2][2]);
  out.rate = angles.velocity.x * Vec3(0, 0, 1) + angles.velocity.y * Vec3(node.cos, node.sin, 0) +
             angles.velocity.z * pole;
  return out;
}

Attitude composed(const Attitude& reference, const Mat3& from_reference,
                  const std::optional<Vec3>& rate_in_reference) {
  Attitude out{from_reference * reference.from_j2000, std::nullopt};
  if (reference.rate && rate_in_reference)
    out.rate = *reference.rate + transpose(reference.from_j2000) * *rate_in_reference;
  return out;
}

std::optional<int> Kernels::Data::frame_number(std::string_view name) const {
  const std::string plain = plain_name(name);
  if (const auto inertial = inertial_frame(plain)) return inertial;
  if (plain == "EME2000" || plain == "ICRF" || plain == "GCRF") return kJ2000;
  if (const auto found = frame_numbers.find(plain); found != frame_numbers.end())
    return found->second;
  if (plain == "ITRF93") return 13000;
  if (plain.starts_with("IAU ")) {
    const std::string body = plain.substr(4);
    if (const auto number = known_body(body)) return iau_frame_of(*number);
  }
  return std::nullopt;
}

std::string Kernels::Data::frame_text(int frame) const {
  if (const auto known = inertial_frame_name(frame); !known.empty()) return std::string(known);
  if (const auto name = pool.text(fmt::format("FRAME_{}_NAME", frame))) return *name;
  if (frame == 13000) return "ITRF93";
  if (const auto body = body_of_iau_frame(frame))
    return fmt::format("IAU_{}", known_body_name(*body));
  return fmt::format("frame {}", frame);
}

std::optional<Kernels::Data::FrameClass> Kernels::Data::class_of(int frame) const {
  if (!inertial_frame_name(frame).empty()) return FrameClass{1, frame};
  std::string base = fmt::format("FRAME_{}_", frame);
  auto kind = pool.number(base + "CLASS");
  if (!kind) {
    // by its name
    if (const auto name = pool.text(base + "NAME")) base = fmt::format("FRAME_{}_", *name);
    kind = pool.number(base + "CLASS");
  }
  if (kind && *kind >= 1 && *kind <= 6) {
    const double number = pool.number(base + "CLASS_ID").value_or(frame);
    if (!(std::abs(number) < 2e9)) return std::nullopt;
    return FrameClass{static_cast<int>(*kind), static_cast<int>(number)};
  }
  if (frame == 13000) return FrameClass{2, 3000};
  if (const auto body = body_of_iau_frame(frame)) return FrameClass{2, *body};
  return std::nullopt;
}

std::optional<int> Kernels::Data::centre_of(int frame) const {
  if (const auto body = body_of_iau_frame(frame)) return body;
  if (frame == 13000) return 399;
  const auto centre = pool.number(fmt::format("FRAME_{}_CENTER", frame));
  if (!centre || !(std::abs(*centre) < 2e9)) return std::nullopt;
  return static_cast<int>(*centre);
}

int Kernels::Data::clock_of(int instrument) const {
  const auto stated = pool.number(fmt::format("CK_{}_SCLK", instrument));
  constexpr int kOfCraft = 1000;
  if (stated && std::abs(*stated) < 2e9) return static_cast<int>(*stated);
  return instrument <= -kOfCraft ? instrument / kOfCraft : instrument;
}

std::optional<Attitude> Kernels::Data::attitude(int frame, double et, int depth,
                                                std::string& problem) const {
  if (depth > kMostDepth) {
    problem = fmt::format("{} is relative to itself", frame_text(frame));
    return std::nullopt;
  }
  const auto kind = class_of(frame);
  if (!kind) {
    problem = fmt::format("no kernel defines {} (.tf)", frame_text(frame));
    return std::nullopt;
  }
  switch (kind->kind) {
    case 1:
      if (inertial_frame_name(kind->number).empty()) break;
      return Attitude{inertial_from_j2000(kind->number), Vec3(0)};
    case 2:
      return by_angles(kind->number, et, depth, problem);
    case 3:
      return by_ck(kind->number, et, depth, problem);
    case 4:
      return by_text(frame, kind->number, et, depth, problem);
    default:
      break;
  }
  problem = fmt::format("{} is a frame of class {} ({}), which is not read", frame_text(frame),
                        kind->kind, kind->kind == 5 ? "dynamic" : "switch or unknown");
  return std::nullopt;
}

std::optional<Attitude> Kernels::Data::by_angles(int number, double et, int depth,
                                                 std::string& problem) const {
  const auto found = angles.find(number);
  if (found != angles.end()) {
    if (const auto item = found->second.timeline.at(et)) {
      const OrbitSegment& segment = found->second.segments[*item];
      State read;
      if (segment.layout.type == 0 || !pck_angles(segment.layout, segment.data, et, read)) {
        problem = fmt::format("{} has no angles at that time: {}", infos[segment.info].file,
                              segment.layout.type == 0 ? "its type is not read" : "it is damaged");
        return std::nullopt;
      }
      const Attitude relative = attitude_of_angles(read);
      const auto reference = attitude(segment.frame, et, depth + 1, problem);
      if (!reference) return std::nullopt;
      return composed(*reference, relative.from_j2000, relative.rate);
    }
  }
  return body_attitude(number, et, problem);
}

std::optional<Attitude> Kernels::Data::body_attitude(int body, double et,
                                                     std::string& problem) const {
  const std::string base = fmt::format("BODY{}_", body);
  const auto* const ra = pool.numbers(base + "POLE_RA");
  const auto* const dec = pool.numbers(base + "POLE_DEC");
  const auto* const pm = pool.numbers(base + "PM");
  if (ra == nullptr || dec == nullptr || pm == nullptr) {
    problem = fmt::format("no PCK gives the rotation of {} at that time", body_text(body));
    return std::nullopt;
  }
  const int system = system_of(body);
  const double epoch =
      (pool.number(fmt::format("BODY{}_CONSTANTS_JED_EPOCH", system)).value_or(2451545) - 2451545) *
      kDay;
  const double reference =
      pool.number(fmt::format("BODY{}_CONSTANTS_REF_FRAME", system)).value_or(kJ2000);
  const std::vector<Angle> sums = sum_angles(pool, body, et - epoch);
  Angle a = polynomial(*ra, et - epoch, kCentury), d = polynomial(*dec, et - epoch, kCentury),
        w = polynomial(*pm, et - epoch, kDay);
  if (!add_sums(pool.numbers(base + "NUT_PREC_RA"), sums, false, a) ||
      !add_sums(pool.numbers(base + "NUT_PREC_DEC"), sums, true, d) ||
      !add_sums(pool.numbers(base + "NUT_PREC_PM"), sums, false, w) ||
      inertial_frame_name(static_cast<int>(whole_number(reference, 21))).empty()) {
    problem =
        fmt::format("the PCK of {} has sums without angles, or an unknown frame", body_text(body));
    return std::nullopt;
  }
  State angle;
  angle.position = kDegree * Vec3(90 + a.value, 90 - d.value, std::fmod(w.value, 360.0));
  angle.velocity = kDegree * Vec3(a.rate, -d.rate, w.rate);
  if (!is_finite(angle.position) || !is_finite(angle.velocity)) {
    problem = fmt::format("the PCK of {} gives no finite angles", body_text(body));
    return std::nullopt;
  }
  const Attitude out = attitude_of_angles(angle);
  return composed({inertial_from_j2000(static_cast<int>(reference)), Vec3(0)}, out.from_j2000,
                  out.rate);
}

std::optional<Attitude> Kernels::Data::by_ck(int number, double et, int depth,
                                             std::string& problem) const {
  const auto found = turning.find(number);
  if (found == turning.end()) {
    problem = fmt::format("no CK gives the attitude of instrument {}", number);
    return std::nullopt;
  }
  const auto ticks = ephemeris::ticks_of_et(pool, clock_of(number), et, problem);
  if (!ticks) return std::nullopt;
  for (auto segment = found->second.rbegin(); segment != found->second.rend(); ++segment) {
    if (!(segment->begin <= *ticks && *ticks <= segment->end)) continue;
    if (segment->layout.type == 0) {
      problem = fmt::format("{} of {} covers that time, and is not read", infos[segment->info].kind,
                            infos[segment->info].file);
      return std::nullopt;
    }
    const auto read = ck_pointing(segment->layout, segment->data, *ticks);
    if (!read) continue;  // in a gap, an earlier one holds
    const auto reference = attitude(segment->reference, et, depth + 1, problem);
    if (!reference) return std::nullopt;
    return composed(*reference, read->from_reference, read->rate);
  }
  problem = fmt::format("no CK gives the attitude of instrument {} at that time", number);
  return std::nullopt;
}

std::optional<Attitude> Kernels::Data::by_text(int frame, int number, double et, int depth,
                                               std::string& problem) const {
  std::string base = fmt::format("TKFRAME_{}_", number);
  if (!pool.text(base + "RELATIVE")) base = fmt::format("TKFRAME_{}_", frame_text(frame));
  const auto relative = pool.text(base + "RELATIVE");
  if (!relative) {
    problem = fmt::format("{} has no {}RELATIVE", frame_text(frame), base);
    return std::nullopt;
  }
  const auto other = frame_number(*relative);
  if (!other) {
    problem = fmt::format("no kernel defines {}, which {} is relative to", in_quotes(*relative),
                          frame_text(frame));
    return std::nullopt;
  }
  const auto matrix = fixed_matrix(pool, base, problem);
  if (!matrix) return std::nullopt;
  const auto reference = attitude(*other, et, depth + 1, problem);
  if (!reference) return std::nullopt;
  return composed(*reference, *matrix, Vec3(0));
}

}  // namespace panwright::ephemeris
