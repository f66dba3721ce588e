#include "sensor/camera_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <span>
#include <vector>

#include "base/config_text.h"
#include "base/text.h"

namespace panwright::sensor {

namespace {

using Value = ConfigValue;
using Numbers = std::vector<double>;

// From the centre of a pixel, where the others count from, to its corner.
constexpr double kHalf = 0.5;
constexpr double kUmPerM = 1e6;

// Members of a camera's table. OpenCV and ROS put numbers into the member "data" of a matrix.
class TableReader : public ConfigTable {
 public:
  TableReader(const Value& table, DiagnosticLog& log)
      : ConfigTable(table, "a camera", Code("E0220"), log), log_(log) {}

  void ignored(const Value& at, const std::string& message) {
    log_.report(Code("W0221"), at.where, message);
  }

  // Of what is reported already.
  void refuse() { good_ = false; }
  bool ok() const { return good_ && ConfigTable::ok(); }

  std::optional<Numbers> numbers(const Value* value, std::string_view name,
                                 std::initializer_list<std::size_t> counts) {
    const Value* data = value == nullptr ? nullptr : value->find("data");
    return ConfigTable::numbers(data != nullptr ? data : value, name, counts);
  }

  // Whole numbers up to the largest image.
  std::optional<std::uint32_t> pixels(const Value* value, std::string_view name, double least = 1) {
    const auto number = ConfigTable::number(value, name);
    if (!number) return std::nullopt;
    if (*number >= least && *number <= kMostPixels && *number == std::floor(*number))
      return static_cast<std::uint32_t>(*number);
    fail(*value, fmt::format("{} is not a whole number from {} to {}", name, least, kMostPixels));
    return std::nullopt;
  }

 private:
  DiagnosticLog& log_;
  bool good_ = true;
};

template <std::size_t N>
std::array<double, N> padded(const Numbers& from) {
  std::array<double, N> out{};
  std::copy_n(from.begin(), std::min(N, from.size()), out.begin());
  return out;
}

// K of a pinhole, row-major, into a lens.
void use_matrix(TableReader& reader, const Value* value, std::string_view name, Lens& lens) {
  const auto k = reader.numbers(value, name, {9});
  if (!k) return;
  const Numbers& m = *k;
  if (m[1] != 0 || m[3] != 0 || m[6] != 0 || m[7] != 0 || m[8] != 1)
    reader.fail(*value, fmt::format("{} is not [fx 0 cx; 0 fy cy; 0 0 1]", name));
  lens.focal = {m[0], m[4]};
  lens.principal = Vec2(m[2], m[5]) + kHalf;
}

void use_brown(TableReader& reader, const Value* value, std::string_view name, Lens& lens) {
  if (value == nullptr) return;
  if (const auto k = reader.numbers(value, name, {0, 4, 5, 8, 12, 14})) {
    if (std::ranges::any_of(*k, [](double each) { return each != 0; }))
      lens.distortion = Brown{padded<14>(*k)};
  }
}

void use_fisheye(TableReader& reader, const Value* value, std::string_view name, Lens& lens) {
  if (const auto k = reader.numbers(value, name, {4})) lens.distortion = Fisheye{padded<4>(*k)};
}

// ---- formats

void read_opencv(TableReader& reader, CameraFile& camera) {
  camera.width =
      reader.pixels(reader.require_any({"image_width", "width"}), "image_width").value_or(0);
  camera.height =
      reader.pixels(reader.require_any({"image_height", "height"}), "image_height").value_or(0);
  use_matrix(reader, reader.require_any({"camera_matrix", "cameramatrix", "k"}), "camera_matrix",
             camera.lens);
  const Value* k = reader.find_any({"distortion_coefficients", "dist_coeffs", "distcoeffs", "d"});
  const Value* fisheye = reader.find_any({"fisheye_model"});
  const auto is = [&](const auto& value) {
    const auto* found =
        fisheye == nullptr ? nullptr : std::get_if<std::decay_t<decltype(value)>>(&fisheye->data);
    return found != nullptr && *found == value;
  };
  const bool wide = is(true) || is(1.0);
  if (wide)
    use_fisheye(reader, k, "distortion_coefficients", camera.lens);
  else
    use_brown(reader, k, "distortion_coefficients", camera.lens);
}

void read_window(TableReader& reader, CameraFile& camera, DiagnosticLog& log) {
  Window window;
  const Value* at = nullptr;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const Value* binning = reader.find_any({axis == 0 ? "binning_x" : "binning_y"});
    if (const auto count = reader.pixels(binning, "binning", 0)) {
      window.binning[axis] = std::max(*count, 1u);
      if (*count > 1) at = binning;
    }
  }
  if (const Value* roi = reader.find_any({"roi"}); roi != nullptr) {
    TableReader part(*roi, log);
    constexpr std::string_view kNames[] = {"x_offset", "y_offset", "width", "height"};
    for (std::size_t k = 0; k < 4; ++k)
      window.region[k] = part.pixels(part.find_any({kNames[k]}), kNames[k], 0).value_or(0);
    if (!part.ok()) reader.fail(*roi, "the region of interest is wrong");
    if (window.region != decltype(window.region){}) at = roi;
  }
  if (at == nullptr || !reader.ok()) return;
  if (const auto part = windowed(camera, window))
    camera = *part;
  else
    reader.fail(*at, "region of interest and binning do not fit the image");
}

// A calibration's file, or a message CameraInfo as text: width, height, d, k, r.
void read_ros(TableReader& reader, CameraFile& camera, DiagnosticLog& log) {
  camera.name = reader.text(reader.find_any({"camera_name"}), "camera_name").value_or("");
  camera.width =
      reader.pixels(reader.require_any({"image_width", "width"}), "image_width").value_or(0);
  camera.height =
      reader.pixels(reader.require_any({"image_height", "height"}), "image_height").value_or(0);
  use_matrix(reader, reader.require_any({"camera_matrix", "k"}), "camera_matrix", camera.lens);
  const Value* model = reader.find_any({"distortion_model"});
  const std::string name = reader.text(model, "distortion_model").value_or("plumb_bob");
  const Value* k = reader.find_any({"distortion_coefficients", "d"});
  if (name == "equidistant")
    use_fisheye(reader, k, "distortion_coefficients", camera.lens);
  else if (name == "plumb_bob" || name == "rational_polynomial")
    use_brown(reader, k, "distortion_coefficients", camera.lens);
  else
    reader.fail(*model, fmt::format("distortion_model is {}, expected plumb_bob, "
                                    "rational_polynomial or equidistant",
                                    in_quotes(name)));
  if (const Value* turn = reader.find_any({"rectification_matrix", "r"}); turn != nullptr) {
    const auto m = reader.numbers(turn, "rectification_matrix", {9});
    if (m && *m != Numbers{1, 0, 0, 0, 1, 0, 0, 0, 1})
      reader.ignored(*turn, "the rectification is not applied: images are those of the camera");
  }
  read_window(reader, camera, log);
}

void read_kalibr(TableReader& reader, CameraFile& camera) {
  const Value* model = reader.find_any({"camera_model"});
  if (const std::string name = reader.text(model, "camera_model").value_or("pinhole");
      name != "pinhole")
    reader.fail(*model, fmt::format("camera_model is {}, expected pinhole", in_quotes(name)));
  if (const auto k = reader.numbers(reader.require_any({"intrinsics"}), "intrinsics", {4})) {
    camera.lens.focal = {(*k)[0], (*k)[1]};
    camera.lens.principal = Vec2((*k)[2], (*k)[3]) + kHalf;
  }
  if (const auto size = reader.numbers(reader.require_any({"resolution"}), "resolution", {2})) {
    const auto whole = [&](double side) {
      if (side >= 1 && side <= kMostPixels && side == std::floor(side))
        return static_cast<std::uint32_t>(side);
      reader.fail(*reader.find_any({"resolution"}),
                  "resolution is not two whole numbers of pixels");
      return 0u;
    };
    camera.width = whole((*size)[0]);
    camera.height = whole((*size)[1]);
  }
  const Value* distortion = reader.find_any({"distortion_model"});
  const Value* k = reader.find_any({"distortion_coeffs"});
  const std::string name = reader.text(distortion, "distortion_model").value_or("none");
  if (name == "radtan")
    use_brown(reader, k, "distortion_coeffs", camera.lens);
  else if (name == "equidistant" || name == "equi")
    use_fisheye(reader, k, "distortion_coeffs", camera.lens);
  else if (name != "none")
    reader.fail(*distortion, fmt::format("distortion_model is {}, expected radtan, equidistant "
                                         "or none",
                                         in_quotes(name)));
}

void read_speed(TableReader& reader, CameraFile& camera) {
  camera.width = reader.pixels(reader.require_any({"nu"}), "Nu").value_or(0);
  camera.height = reader.pixels(reader.require_any({"nv"}), "Nv").value_or(0);
  if (const Value* matrix = reader.find_any({"cameramatrix"}); matrix != nullptr) {
    use_matrix(reader, matrix, "cameraMatrix", camera.lens);
  } else {
    // metres, and metres a pixel
    double read[6] = {};
    constexpr std::string_view kNames[] = {"fx", "fy", "ppx", "ppy", "ccx", "ccy"};
    for (std::size_t k = 0; k < 6; ++k) {
      const double centre = (k == 4 ? camera.width : camera.height) / 2.0;
      const Value* value = k < 4 ? reader.require_any({kNames[k]}) : reader.find_any({kNames[k]});
      const auto one = reader.numbers(value, kNames[k], {1});
      read[k] = one ? one->front() : centre;
    }
    camera.lens.focal = {read[0] / read[2], read[1] / read[3]};
    camera.lens.principal = Vec2(read[4], read[5]) + kHalf;
  }
  const auto pitch = [&](const char* name) {
    return reader.numbers(reader.find_any({name}), name, {1}).value_or(Numbers{0}).front();
  };
  if (const Vec2 metres(pitch("ppx"), pitch("ppy")); metres.x > 0 && metres.y > 0)
    // of a decimal number of micrometres
    camera.pixel_um = glm::round(1e9 * (kUmPerM * metres)) / 1e9;
  use_brown(reader, reader.find_any({"distcoeffs"}), "distCoeffs", camera.lens);
}

// ---- our own

void read_own_size(TableReader& reader, CameraFile& camera) {
  const Value* value = reader.require("size");
  const auto size = reader.numbers(value, "size", {1, 2});
  if (!size) return;
  for (const double side : *size)
    if (!(side >= 1 && side <= kMostPixels && side == std::floor(side))) {
      reader.fail(*value, fmt::format("size is not of whole numbers from 1 to {}", kMostPixels));
      return;
    }
  camera.width = static_cast<std::uint32_t>(size->front());
  camera.height = static_cast<std::uint32_t>(size->back());
}

void read_own_focal(TableReader& reader, Lens& lens) {
  const Value* focal = reader.find("focal");
  const Value* length = reader.find("focal_length_mm");
  if ((focal == nullptr) == (length == nullptr)) {
    reader.require("focal");
    if (focal != nullptr) reader.fail(*length, "expected focal or focal_length_mm, not both");
    return;
  }
  if (focal != nullptr) {
    if (const auto f = reader.numbers(focal, "focal", {1, 2})) lens.focal = {f->front(), f->back()};
    return;
  }
  const auto f = reader.numbers(length, "focal_length_mm", {1});
  const auto pitch = reader.numbers(reader.require("pixel_um"), "pixel_um", {1, 2});
  if (f && pitch) lens.focal = 1e3 * f->front() / Vec2(pitch->front(), pitch->back());
}

void read_own_distortion(TableReader& reader, Lens& lens) {
  const Value* model = reader.find("distortion");
  const std::string name = reader.text(model, "distortion").value_or("none");
  const auto terms = [&](std::initializer_list<std::size_t> counts) {
    return reader.numbers(reader.require("coefficients"), "coefficients", counts)
        .value_or(Numbers{});
  };
  if (name == "brown") {
    lens.distortion = Brown{padded<14>(terms({1, 2, 4, 5, 8, 12, 14}))};
  } else if (name == "fisheye") {
    lens.distortion = Fisheye{padded<4>(terms({0, 1, 2, 3, 4}))};
  } else if (name == "division") {
    lens.distortion = Division{padded<1>(terms({1}))[0]};
  } else if (name == "powers") {
    RadialPowers powers{padded<5>(terms({1, 2, 3, 4, 5}))};
    if (lens.focal.x != lens.focal.y) reader.fail(*model, "powers of pixels need square ones");
    double factor = 1;
    for (double& k : powers.k) k *= factor, factor *= lens.focal.x;
    lens.distortion = powers;
  } else if (name == "cahvore") {
    Cahvore model_terms;
    if (const auto axis = reader.numbers(reader.find("axis"), "axis", {3})) {
      const Vec3 given((*axis)[0], (*axis)[1], (*axis)[2]);
      const double length = glm::length(given);
      if (!(length > 1e-100 && given.z >= 0.5 * length))
        reader.fail(*reader.find("axis"), "axis is more than 60 degrees off the boresight");
      model_terms.axis = given / length;
    }
    if (const auto r = reader.numbers(reader.find("r"), "r", {3})) model_terms.r = padded<3>(*r);
    if (const auto e = reader.numbers(reader.find("e"), "e", {3})) model_terms.e = padded<3>(*e);
    if (const auto l = reader.numbers(reader.find("linearity"), "linearity", {1}))
      model_terms.linearity = l->front();
    if (std::fabs(model_terms.linearity) > 1)
      reader.fail(*reader.find("linearity"), "linearity is not from -1 to 1");
    lens.distortion = model_terms;
  } else if (name != "none") {
    constexpr std::string_view kModels[] = {"none",     "brown",  "fisheye",
                                            "division", "powers", "cahvore"};
    const auto near = nearest_name(name, kModels);
    reader.fail(
        *model,
        fmt::format("distortion is {}, expected {}", in_quotes(name), fmt::join(kModels, ", ")),
        near ? fmt::format("did you mean '{}'?", *near) : "");
  }
}

// [detector] and [optics], of the lens before region and binning.
void read_own_imager(TableReader& reader, CameraFile& camera, DiagnosticLog& log) {
  const Value* detector = reader.find("detector");
  const Value* optics = reader.find("optics");
  if (detector == nullptr && optics == nullptr) return;
  if (detector == nullptr) return reader.fail(*optics, "[optics] needs a [detector]");
  if (camera.width_m > 0)
    return reader.fail(*detector,
                       "an orthographic camera has no aperture: expected a focal length");
  const auto imager =
      read_imager(*detector, optics, ImagerLens{camera.lens.focal.x, camera.pixel_um}, log);
  if (!imager) return reader.refuse();
  camera.imager = *imager;
  camera.pixel_um = imager->detector.pixel_um * static_cast<double>(imager->detector.binning);
}

// Of what is read: the window of the detector.
void check_own_imager(TableReader& reader, const Window& window, CameraFile& camera) {
  if (!camera.imager) return;
  const Value& detector = *reader.find("detector");
  const auto [across, down] = window.binning;
  if (across != down)
    return reader.fail(detector, fmt::format("binning is {} x {}, expected square blocks with a "
                                             "[detector]",
                                             across, down));
  if (across > 1) bin(*camera.imager, across);
  if (const std::string why = check_imager(*camera.imager, camera.width, camera.height);
      !why.empty())
    reader.fail(detector, why);
}

void read_own(TableReader& reader, CameraFile& camera, DiagnosticLog& log) {
  camera.name = reader.text(reader.find("name"), "name").value_or("");
  read_own_size(reader, camera);
  camera.lens.principal = Vec2(camera.width, camera.height) / 2.0;
  if (const Value* width = reader.find("width_m"); width != nullptr) {
    if (const auto metres = reader.numbers(width, "width_m", {1})) {
      camera.width_m = metres->front();
      if (!(camera.width_m > 0)) reader.fail(*width, "width_m is not above 0 m");
    }
    camera.lens.focal = Vec2(camera.width / camera.width_m);
  } else {
    read_own_focal(reader, camera.lens);
    if (const auto c = reader.numbers(reader.find("principal"), "principal", {2}))
      camera.lens.principal = {(*c)[0], (*c)[1]};
    read_own_distortion(reader, camera.lens);
  }
  if (const Value* value = reader.find("pixel_um"); value != nullptr) {
    const auto pitch = reader.numbers(value, "pixel_um", {1, 2});
    if (pitch) camera.pixel_um = Vec2(pitch->front(), pitch->back());
    if (pitch && !(pitch->front() > 0 && pitch->back() > 0))
      reader.fail(*value, "pixel_um is not above 0");
  }
  read_own_imager(reader, camera, log);
  if (const Value* mount = reader.find("mount"); mount != nullptr) {
    const Numbers q = reader.numbers(mount, "mount", {4}).value_or(Numbers{1, 0, 0, 0});
    const Quat given(q[0], q[1], q[2], q[3]);
    const double length = std::sqrt(glm::dot(given, given));
    if (!(std::fabs(length - 1) < 1e-6))
      reader.fail(*mount, "mount is not a unit quaternion w x y z");
    camera.mount_from_camera = given * (1 / length);
  }
  Window window;
  const auto whole = [&](const Value* value, auto& to, std::string_view name, double least) {
    const auto given = reader.numbers(value, name, {to.size()});
    if (!given) return;
    for (std::size_t k = 0; k < to.size(); ++k) {
      if (!((*given)[k] >= least && (*given)[k] <= kMostPixels &&
            (*given)[k] == std::floor((*given)[k])))
        reader.fail(*value, fmt::format("{} is not of whole numbers of pixels", name));
      else
        to[k] = static_cast<std::uint32_t>((*given)[k]);
    }
  };
  const Value* region = reader.find("region");
  const Value* binning = reader.find("binning");
  whole(region, window.region, "region", 0);
  whole(binning, window.binning, "binning", 1);
  if (reader.ok() && (region != nullptr || binning != nullptr)) {
    const Value& at = region != nullptr ? *region : *binning;
    if (const auto part = windowed(camera, window))
      camera = *part;
    else
      reader.fail(at, "region and binning do not fit the image");
    if (camera.width_m > 0 && (camera.lens.focal.x != camera.lens.focal.y ||
                               camera.lens.principal != Vec2(camera.width, camera.height) / 2.0))
      reader.fail(at, "an orthographic camera reads the middle of its image, in square blocks");
  }
  check_own_imager(reader, window, camera);
  reader.finish();
}

// Formats differ in a member each.
CameraFormat format_of(ConfigTable& table) {
  if (table.find_any({"nu"}) != nullptr) return CameraFormat::speed;
  if (table.find_any({"intrinsics"}) != nullptr) return CameraFormat::kalibr;
  return table.find_any({"distortion_model"}) != nullptr ? CameraFormat::ros : CameraFormat::opencv;
}

// A camchain holds its cameras as members cam0, cam1, …
const Value& first_camera(const Value& root, DiagnosticLog& log) {
  const Value* first = root.find("cam0");
  if (first == nullptr) return root;
  if (const Value* second = root.find("cam1"); second != nullptr)
    log.report(Code("W0221"), second->where, "only the first camera, cam0, is read");
  return *first;
}

// TOML has '=' between name and value; YAML and JSON ':'.
ConfigFormat text_format(std::string_view text) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line = text.substr(at, end - at);
    const std::size_t first = line.find_first_not_of(" \t\r");
    if (first != line.npos && line[first] != '#') {
      const std::size_t equals = line.find('='), colon = line.find(':');
      return equals < colon ? ConfigFormat::toml : ConfigFormat::yaml;
    }
    at = end + 1;
  }
  return ConfigFormat::toml;
}

bool is_finite(const Lens& lens) {
  return std::isfinite(lens.focal.x + lens.focal.y + lens.principal.x + lens.principal.y);
}

}  // namespace

std::optional<CameraFile> windowed(const CameraFile& camera, const Window& window) {
  auto [x, y, width, height] = window.region;
  if (width == 0) width = x < camera.width ? camera.width - x : 0;
  if (height == 0) height = y < camera.height ? camera.height - y : 0;
  const Vec2 block(window.binning[0], window.binning[1]);
  if (window.binning[0] == 0 || window.binning[1] == 0) return std::nullopt;
  const bool inside =
      std::uint64_t{x} + width <= camera.width && std::uint64_t{y} + height <= camera.height;
  if (!inside || width < window.binning[0] || height < window.binning[1]) return std::nullopt;
  CameraFile part = camera;
  part.width = width / window.binning[0];
  part.height = height / window.binning[1];
  part.lens.focal /= block;
  if (part.pixel_um) *part.pixel_um *= block;
  part.width_m = part.width * block.x / camera.width * camera.width_m;
  part.lens.principal = (camera.lens.principal - Vec2(x, y)) / block;
  return part;
}

Result<CameraFile> read_camera(std::string_view text, const std::string& name, DiagnosticLog& log) {
  SourceFile source;
  source.name = name;
  source.bytes = std::make_shared<const std::string>(text);
  const FileId file = log.sources().add(std::move(source));
  const ConfigFormat format = text_format(text);
  const auto root = parse_config(text, format, file, Code("E0220"), log);
  if (!root) return failed;
  const Value& table = first_camera(*root, log);
  TableReader reader(table, log);
  CameraFile camera;
  if (!std::holds_alternative<Value::Map>(table.data))
    reader.fail(table, fmt::format("the text is {}, expected a camera", type_name(table)));
  else if (format == ConfigFormat::toml)
    read_own(reader, camera, log);
  else if (const CameraFormat kind = format_of(reader); kind == CameraFormat::speed)
    read_speed(reader, camera);
  else if (kind == CameraFormat::kalibr)
    read_kalibr(reader, camera);
  else if (kind == CameraFormat::ros)
    read_ros(reader, camera, log);
  else
    read_opencv(reader, camera);
  if (!reader.ok()) return failed;
  if (!(camera.lens.focal.x > 0 && camera.lens.focal.y > 0 && is_finite(camera.lens))) {
    reader.fail(table, "focal lengths are not above 0 and finite");
    return failed;
  }
  return camera;
}

}  // namespace panwright::sensor
