// Camera files as text.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/text.h"
#include "sensor/camera_file.h"

namespace panwright::sensor {

namespace {

// From the corner of a pixel to its centre.
constexpr double kToCentre = 0.5;

template <class Range>
std::string joined(const Range& numbers) {
  std::string out;
  for (const double number : numbers) {
    if (!out.empty()) out += ", ";
    // a name for whole numbers as well: 1.0, as TOML and YAML tell them from integers
    const std::string text = format_double(number);
    out += text.find_first_of(".e") == text.npos ? text + ".0" : text;
  }
  return "[" + out + "]";
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return out + '"';
}

// Terms of Brown's model up to the last that is not 0, in the counts that OpenCV takes.
std::vector<double> brown_terms(const Brown& brown) {
  std::size_t used = 14;
  while (used > 0 && brown.k[used - 1] == 0) --used;
  for (const std::size_t count : {4, 5, 8, 12, 14})
    if (used <= count) return {brown.k.begin(), brown.k.begin() + static_cast<long>(count)};
  return {};
}

std::string own_text(const CameraFile& camera) {
  const Lens& lens = camera.lens;
  std::string out = "# A camera of Panwright: pixels from the upper left corner of the image\n";
  if (!camera.name.empty()) out += fmt::format("name = {}\n", quoted(camera.name));
  out += fmt::format("size = [{}, {}]\n", camera.width, camera.height);
  if (camera.width_m > 0) {
    out += fmt::format("width_m = {}\n", camera.width_m);
  } else {
    out +=
        fmt::format("focal = {}\nprincipal = {}\n", joined(std::array{lens.focal.x, lens.focal.y}),
                    joined(std::array{lens.principal.x, lens.principal.y}));
  }
  if (camera.pixel_um && !camera.imager)
    out +=
        fmt::format("pixel_um = {}\n", joined(std::array{camera.pixel_um->x, camera.pixel_um->y}));
  const auto terms = [&](const char* name, const auto& k) {
    out += fmt::format("distortion = \"{}\"\ncoefficients = {}\n", name, joined(k));
  };
  if (const auto* brown = std::get_if<Brown>(&lens.distortion)) terms("brown", brown_terms(*brown));
  if (const auto* fisheye = std::get_if<Fisheye>(&lens.distortion)) terms("fisheye", fisheye->k);
  if (const auto* division = std::get_if<Division>(&lens.distortion))
    terms("division", std::array{division->k});
  if (const auto* powers = std::get_if<RadialPowers>(&lens.distortion)) {
    auto of_pixels = powers->k;
    double factor = 1;
    for (double& k : of_pixels) k /= factor, factor *= lens.focal.x;
    terms("powers", of_pixels);
  }
  if (const auto* cahvore = std::get_if<Cahvore>(&lens.distortion)) {
    const Vec3& o = cahvore->axis;
    out += fmt::format("distortion = \"cahvore\"\naxis = {}\nr = {}\ne = {}\nlinearity = {}\n",
                       joined(std::array{o.x, o.y, o.z}), joined(cahvore->r), joined(cahvore->e),
                       joined(std::array{cahvore->linearity}));
  }
  if (const Quat& q = camera.mount_from_camera; q != Quat(1, 0, 0, 0))
    out += fmt::format("mount = {}\n", joined(std::array{q.w, q.x, q.y, q.z}));
  if (camera.imager) out += imager_text(*camera.imager);
  return out;
}

// What the formats of others hold of a lens.
struct Plain {
  std::vector<double> matrix;  // row-major, pixels counted from the centre of the first
  std::vector<double> terms;   // empty: no distortion
  bool fisheye = false;
};

std::optional<Plain> plain(const Lens& lens) {
  Plain out;
  out.matrix = {lens.focal.x,
                0,
                lens.principal.x - kToCentre,
                0,
                lens.focal.y,
                lens.principal.y - kToCentre,
                0,
                0,
                1};
  if (std::holds_alternative<Pinhole>(lens.distortion)) return out;
  if (const auto* brown = std::get_if<Brown>(&lens.distortion)) {
    out.terms = brown_terms(*brown);
    return out;
  }
  if (const auto* fisheye = std::get_if<Fisheye>(&lens.distortion)) {
    out.terms.assign(fisheye->k.begin(), fisheye->k.end());
    out.fisheye = true;
    return out;
  }
  return std::nullopt;
}

std::string opencv_text(const CameraFile& camera, const Plain& lens) {
  const std::vector<double> terms = lens.terms.empty() ? std::vector<double>(5) : lens.terms;
  return fmt::format(
      "%YAML:1.0\n---\nimage_width: {}\nimage_height: {}\n"
      "camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: {}\n"
      "{}distortion_coefficients: !!opencv-matrix\n   rows: {}\n   cols: 1\n   dt: d\n   data: "
      "{}\n",
      camera.width, camera.height, joined(lens.matrix), lens.fisheye ? "fisheye_model: 1\n" : "",
      terms.size(), joined(terms));
}

std::string ros_text(const CameraFile& camera, const Plain& lens) {
  const std::vector<double> terms = lens.terms.empty() ? std::vector<double>(5) : lens.terms;
  std::vector<double> projection;
  for (std::size_t k = 0; k < 9; ++k) {
    projection.push_back(lens.matrix[k]);
    if (k % 3 == 2) projection.push_back(0);
  }
  return fmt::format(
      "image_width: {}\nimage_height: {}\ncamera_name: {}\n"
      "camera_matrix:\n  rows: 3\n  cols: 3\n  data: {}\n"
      "distortion_model: {}\n"
      "distortion_coefficients:\n  rows: 1\n  cols: {}\n  data: {}\n"
      "rectification_matrix:\n  rows: 3\n  cols: 3\n  data: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, "
      "0.0, 1.0]\n"
      "projection_matrix:\n  rows: 3\n  cols: 4\n  data: {}\n",
      camera.width, camera.height, quoted(camera.name), joined(lens.matrix),
      lens.fisheye       ? "equidistant"
      : terms.size() > 5 ? "rational_polynomial"
                         : "plumb_bob",
      terms.size(), joined(terms), joined(projection));
}

std::string kalibr_text(const CameraFile& camera, const Plain& lens) {
  const auto& m = lens.matrix;
  return fmt::format(
      "cam0:\n  camera_model: pinhole\n  intrinsics: {}\n  distortion_model: {}\n"
      "  distortion_coeffs: {}\n  resolution: [{}, {}]\n",
      joined(std::array{m[0], m[4], m[2], m[5]}),
      lens.fisheye         ? "equidistant"
      : lens.terms.empty() ? "none"
                           : "radtan",
      joined(lens.terms), camera.width, camera.height);
}

// Readers of SPEED+ ask for lengths in metres too, and for five coefficients.
constexpr Vec2 kSpeedPixelUm(5.86);  // of SPEED's own camera
constexpr double kMPerUm = 1e-6;

std::string speed_text(const CameraFile& camera, const Plain& lens) {
  const auto& m = lens.matrix;
  std::vector<double> terms = lens.terms;
  terms.resize(5);
  const Vec2 pitch = kMPerUm * camera.pixel_um.value_or(kSpeedPixelUm);
  return fmt::format(
      "{{\"Nu\": {}, \"Nv\": {}, \"ppx\": {}, \"ppy\": {}, \"fx\": {}, \"fy\": {}, \"ccx\": {}, "
      "\"ccy\": {}, \"cameraMatrix\": [{}, {}, {}], \"distCoeffs\": {}}}\n",
      camera.width, camera.height, format_double(pitch.x), format_double(pitch.y),
      format_double(m[0] * pitch.x), format_double(m[4] * pitch.y), format_double(m[2]),
      format_double(m[5]), joined(std::array{m[0], m[1], m[2]}),
      joined(std::array{m[3], m[4], m[5]}), joined(std::array{m[6], m[7], m[8]}), joined(terms));
}

}  // namespace

namespace {

struct Named {
  const char* name;
  std::vector<double> numbers;
};

Named named(const Distortion& distortion) {
  const auto list = [](const auto& k) { return std::vector<double>(k.begin(), k.end()); };
  if (const auto* brown = std::get_if<Brown>(&distortion)) return {"brown", brown_terms(*brown)};
  if (const auto* fisheye = std::get_if<Fisheye>(&distortion)) return {"fisheye", list(fisheye->k)};
  if (const auto* powers = std::get_if<RadialPowers>(&distortion))
    return {"powers", list(powers->k)};
  if (const auto* division = std::get_if<Division>(&distortion)) return {"division", {division->k}};
  if (const auto* c = std::get_if<Cahvore>(&distortion))
    return {"cahvore",
            {c->axis.x, c->axis.y, c->axis.z, c->r[0], c->r[1], c->r[2], c->e[0], c->e[1], c->e[2],
             c->linearity}};
  return {"", {}};
}

}  // namespace

std::string distortion_text(const Distortion& distortion) {
  const auto [name, numbers] = named(distortion);
  std::string out = name;
  for (const double number : numbers) out += " " + format_double(number);
  return out;
}

std::optional<Distortion> parse_distortion(std::string_view text) {
  constexpr std::string_view kBlanks = " \t,";
  std::vector<std::string_view> words;
  for (std::size_t at = text.find_first_not_of(kBlanks); at != text.npos;) {
    const std::size_t end = std::min(text.find_first_of(kBlanks, at), text.size());
    words.push_back(text.substr(at, end - at));
    at = text.find_first_not_of(kBlanks, end);
  }
  if (words.empty() || words.size() > 15) return std::nullopt;
  std::array<double, 14> k{};
  const std::size_t count = words.size() - 1;
  for (std::size_t i = 0; i < count; ++i) {
    const auto number = parse_double(words[i + 1]);
    if (!number) return std::nullopt;
    k[i] = *number;
  }
  const auto copied = [&](auto& to) { std::copy_n(k.begin(), to.size(), to.begin()); };
  if (words[0] == "brown" && count >= 1) return Brown{k};
  if (words[0] == "division" && count == 1) return Division{k[0]};
  if (words[0] == "fisheye" && count <= 4) {
    Fisheye fisheye;
    copied(fisheye.k);
    return fisheye;
  }
  if (words[0] == "powers" && count >= 1 && count <= 5) {
    RadialPowers powers;
    copied(powers.k);
    return powers;
  }
  if (words[0] != "cahvore" || count != 10) return std::nullopt;
  const Vec3 axis(k[0], k[1], k[2]);
  const double length = glm::length(axis);
  if (!(std::fabs(length - 1) < 1e-9 && axis.z >= 0.5 && std::fabs(k[9]) <= 1)) return std::nullopt;
  return Cahvore{axis, {k[3], k[4], k[5]}, {k[6], k[7], k[8]}, k[9]};
}

Result<std::string> camera_text(const CameraFile& camera, CameraFormat format, DiagnosticLog& log) {
  const auto fail = [&](const char* message, const char* hint = "write it as .toml") {
    log.report(Code("E0220"), {}, message, hint);
    return failed;
  };
  if (format == CameraFormat::toml) {
    if (std::holds_alternative<RadialPowers>(camera.lens.distortion) &&
        camera.lens.focal.x != camera.lens.focal.y)
      return fail("powers of pixels need square ones", "");
    return own_text(camera);
  }
  if (camera.width_m > 0) return fail("the format holds no orthographic camera");
  if (camera.mount_from_camera != Quat(1, 0, 0, 0))
    return fail("the format holds no misalignment of the camera");
  const auto lens = plain(camera.lens);
  if (!lens) return fail("the format holds pinhole, brown and fisheye lenses only");
  switch (format) {
    case CameraFormat::opencv:
      return opencv_text(camera, *lens);
    case CameraFormat::ros:
      return ros_text(camera, *lens);
    case CameraFormat::kalibr:
      if (!lens->fisheye && lens->terms.size() > 4)
        return fail("Kalibr's camchain has four terms of distortion");
      return kalibr_text(camera, *lens);
    default:
      if (lens->fisheye || lens->terms.size() > 5)
        return fail("SPEED's camera.json has five terms of distortion");
      return speed_text(camera, *lens);
  }
}

}  // namespace panwright::sensor
