#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <system_error>
#include <utility>

#include "base/file.h"
#include "base/text.h"
#include "image/arrays.h"
#include "labels/frame_files.h"
#include "labels/internal/flo.h"
#include "sensor/camera_file.h"

namespace panwright::labels {
namespace {

using JsonTree = nlohmann::json;

constexpr std::uint64_t kMostJsonBytes = 16u << 20;
constexpr std::uint64_t kMostMaskBytes = 2ull << 30;  // of a frame
constexpr std::size_t kMostNameBytes = 1000;
constexpr int kMostDepth = 8;
// note: a point close to the camera's plane may fall on any pixel
constexpr double kMostNumber = std::numeric_limits<double>::max();

// Reads members of a frame's JSON; the first wrong one is reported and ends all.
class FrameReader {
 public:
  FrameReader(std::string file, DiagnosticLog& log) : file_(std::move(file)), log_(log) {}

  bool fail(std::string_view where, std::string_view expected) {
    if (good_)
      log_.report_file(
          Code("E9001"), file_,
          fmt::format("member {} is missing or wrong, expected {}", in_quotes(where), expected));
    good_ = false;
    return false;
  }
  bool good() const { return good_; }

  const JsonTree& member(const JsonTree& object, std::string_view name) {
    static const JsonTree kNone;
    if (!object.is_object()) return kNone;
    const auto at = object.find(name);
    return at == object.end() ? kNone : *at;
  }

  double number(const JsonTree& json, const std::string& where, double least = -kMostNumber) {
    const double value = json.is_number() ? json.get<double>() : std::nan("");
    if (!(value >= least && value <= kMostNumber))
      fail(where, least < 0 ? "a number" : "a number that is not negative");
    return value;
  }

  std::uint64_t whole(const JsonTree& json, const std::string& where, std::uint64_t least,
                      std::uint64_t most) {
    const std::uint64_t value = json.is_number_unsigned() ? json.get<std::uint64_t>() : 0;
    if (!json.is_number_unsigned() || value < least || value > most)
      fail(where, fmt::format("a whole number from {} to {}", least, most));
    return value;
  }
  std::uint32_t whole32(const JsonTree& json, const std::string& where, std::uint32_t least,
                        std::uint32_t most) {
    return static_cast<std::uint32_t>(whole(json, where, least, most));
  }

  std::string text(const JsonTree& json, const std::string& where, bool may_be_empty = true) {
    if (!json.is_string()) return fail(where, "a text"), "";
    auto value = json.get<std::string>();
    if (value.size() > kMostNameBytes || (value.empty() && !may_be_empty))
      fail(where, fmt::format("a text of 1 to {} bytes", kMostNameBytes));
    return value;
  }

  bool boolean(const JsonTree& json, const std::string& where) {
    if (!json.is_boolean()) return fail(where, "true or false");
    return json.get<bool>();
  }

  template <std::size_t N>
  std::array<double, N> numbers(const JsonTree& json, const std::string& where) {
    std::array<double, N> out{};
    if (!json.is_array() || json.size() != N) {
      fail(where, fmt::format("{} numbers", N));
      return out;
    }
    for (std::size_t i = 0; i < N; ++i) out[i] = number(json[i], where);
    return out;
  }
  Vec2 vec2(const JsonTree& json, const std::string& where) {
    const auto v = numbers<2>(json, where);
    return {v[0], v[1]};
  }
  Vec3 vec3(const JsonTree& json, const std::string& where) {
    const auto v = numbers<3>(json, where);
    return {v[0], v[1], v[2]};
  }
  Quat unit(const JsonTree& json, const std::string& where) {
    const auto v = numbers<4>(json, where);
    const Quat q(v[0], v[1], v[2], v[3]);
    constexpr double kRounding = 1e-6;
    if (!(std::fabs(glm::dot(q, q) - 1) < kRounding)) fail(where, "a unit quaternion w x y z");
    return q;
  }

  std::optional<Box> box(const JsonTree& json, const std::string& where) {
    if (json.is_null()) return std::nullopt;
    const auto v = numbers<4>(json, where);
    if (v[2] < v[0] || v[3] < v[1]) fail(where, "left, top, right, bottom");
    return Box{v[0], v[1], v[2], v[3]};
  }

  Mask mask(const JsonTree& json, const std::string& where, const world::Camera& camera) {
    Mask out;
    out.left = whole32(member(json, "left"), where + ".left", 0, camera.width);
    out.top = whole32(member(json, "top"), where + ".top", 0, camera.height);
    out.width = whole32(member(json, "width"), where + ".width", 0, camera.width - out.left);
    out.height = whole32(member(json, "height"), where + ".height", 0, camera.height - out.top);
    if ((out.width == 0) != (out.height == 0)) fail(where, "a rectangle, or none of 0 x 0");
    return out;
  }

  world::Camera camera(const JsonTree& json) {
    world::Camera out;
    const auto at = [&](const char* name) -> const JsonTree& { return member(json, name); };
    out.width = whole32(at("width"), "camera.width", 1, sensor::kMostPixels);
    out.height = whole32(at("height"), "camera.height", 1, sensor::kMostPixels);
    const std::string projection = text(at("projection"), "camera.projection");
    if (projection == "orthographic")
      out.projection = world::Projection::orthographic;
    else if (projection != "perspective")
      fail("camera.projection", "perspective or orthographic");
    out.focal = vec2(at("focal"), "camera.focal");
    if (!(out.focal.x > 0 && out.focal.y > 0)) fail("camera.focal", "positive numbers");
    out.principal = vec2(at("principal"), "camera.principal");
    out.position = vec3(at("position"), "camera.position");
    out.world_from_camera = unit(at("world_from_camera"), "camera.world_from_camera");
    if (!at("distortion").is_null()) {
      const auto distortion = sensor::parse_distortion(text(at("distortion"), "camera.distortion"));
      if (!distortion)
        fail("camera.distortion", "a model and its numbers, as brown -0.2 0.1 0 0");
      else if (good_)
        out.distortion = std::make_shared<const sensor::DistortionMap>(*distortion);
    }
    return out;
  }

  Keypoint keypoint(const JsonTree& json, const std::string& where) {
    const auto at = [&](const char* name) -> const JsonTree& { return member(json, name); };
    Keypoint out;
    out.name = text(at("name"), where + ".name");
    out.position = vec3(at("position"), where + ".position");
    out.in_camera = vec3(at("in_camera"), where + ".in_camera");
    if (!at("pixel").is_null()) out.pixel = vec2(at("pixel"), where + ".pixel");
    out.truncated = boolean(at("truncated"), where + ".truncated");
    out.occluded = boolean(at("occluded"), where + ".occluded");
    out.lit = boolean(at("lit"), where + ".lit");
    return out;
  }

  Thing thing(const JsonTree& json, const std::string& where, const world::Camera& camera) {
    const auto at = [&](const char* name) -> const JsonTree& { return member(json, name); };
    Thing out;
    out.id = whole32(at("id"), where + ".id", 1, ~0u);
    if (!ids_.insert(out.id).second) fail(where + ".id", "a number of its own");
    out.target = text(at("target"), where + ".target", false);
    out.label = text(at("label"), where + ".label");
    const std::string pose = where + ".camera_from_thing";
    out.camera_from_thing.translation =
        vec3(member(at("camera_from_thing"), "translation"), pose + ".translation");
    out.camera_from_thing.rotation =
        unit(member(at("camera_from_thing"), "rotation"), pose + ".rotation");
    out.amodal = mask(at("amodal"), where + ".amodal", camera);
    out.visible = mask(at("visible"), where + ".visible", camera);
    out.amodal_box = box(at("amodal_box"), where + ".amodal_box");
    out.visible_box = box(at("visible_box"), where + ".visible_box");
    out.amodal_pixels = number(at("amodal_pixels"), where + ".amodal_pixels", 0);
    out.visible_pixels = number(at("visible_pixels"), where + ".visible_pixels", 0);
    const JsonTree& points = at("keypoints");
    if (!points.is_array()) fail(where + ".keypoints", "a list");
    for (std::size_t k = 0; good_ && k < points.size(); ++k)
      out.keypoints.push_back(keypoint(points[k], fmt::format("{}.keypoints[{}]", where, k)));
    return out;
  }

  FrameLabels frame(const JsonTree& json) {
    const auto at = [&](const char* name) -> const JsonTree& { return member(json, name); };
    FrameLabels out;
    if (at("schema_id") != "panwright/frame_labels/1")
      fail("schema_id", "panwright/frame_labels/1");
    out.name = text(at("name"), "name", false);
    out.image = text(at("image"), "image");
    const std::filesystem::path image(out.image);
    if (image.is_absolute() || std::ranges::find(image, "..") != image.end())
      fail("image", "a file below this folder");
    out.number = whole(at("number"), "number", 0, ~0ull);
    out.time = number(at("time"), "time");
    out.camera = camera(at("camera"));
    if (at("camera").contains("pixel_um")) {
      out.pixel_um = vec2(at("camera")["pixel_um"], "camera.pixel_um");
      if (!(out.pixel_um->x > 0 && out.pixel_um->y > 0))
        fail("camera.pixel_um", "positive numbers");
    }
    out.sun_in_camera = vec3(at("sun_in_camera"), "sun_in_camera");
    const JsonTree& things = at("things");
    if (!things.is_array()) fail("things", "a list");
    for (std::size_t k = 0; good_ && k < things.size(); ++k)
      out.things.push_back(thing(things[k], fmt::format("things[{}]", k), out.camera));
    return out;
  }

 private:
  std::string file_;
  DiagnosticLog& log_;
  std::set<std::uint32_t> ids_;
  bool good_ = true;
};

// Puts the arrays of the archive into the masks, whose places are known.
bool take_masks(const std::filesystem::path& path, FrameLabels& frame, DiagnosticLog& log) {
  std::uint64_t total = 0;
  for (const Thing& thing : frame.things)
    for (const Mask* mask : {&thing.amodal, &thing.visible})
      total += std::uint64_t{mask->width} * mask->height;
  if (total == 0) return true;
  if (total > kMostMaskBytes) {
    log.report_file(Code("E0104"), path.string(), "the masks exceed 2 GiB");
    return false;
  }
  constexpr std::uint64_t kHeader = 1 << 10;
  auto arrays = image::read_arrays(path, {}, total + 2 * kHeader * frame.things.size(), log);
  if (!arrays) return false;
  const auto fail = [&](const std::string& name) {
    log.report_file(Code("E9001"), path.string(),
                    fmt::format("the mask {} is missing, or of another size", in_quotes(name)));
    return false;
  };
  std::size_t next = 0;
  for (Thing& thing : frame.things)
    for (const auto& [mask, word] :
         {std::pair(&thing.amodal, "amodal"), std::pair(&thing.visible, "visible")}) {
      if (mask->width == 0) continue;
      const std::string name = fmt::format("{}.{}", thing.id, word);
      if (next == arrays->size() || (*arrays)[next].name != name) return fail(name);
      const image::Array& array = (*arrays)[next++];
      if (array.type != "|u1" ||
          array.shape != std::vector<std::uint64_t>{mask->height, mask->width})
        return fail(name);
      mask->coverage.resize(array.data.size());
      std::memcpy(mask->coverage.data(), array.data.data(), array.data.size());
    }
  return true;
}

}  // namespace

Result<FrameLabels> read_frame(const std::filesystem::path& json, DiagnosticLog& log,
                               const FrameParts& parts) {
  const auto fail = [&](std::string message) {
    log.report_file(Code("E9001"), json.string(), std::move(message));
    return failed;
  };
  const std::string name = json.filename().string();
  if (!name.ends_with(kLabelsExtension) || name.size() == kLabelsExtension.size())
    return fail(fmt::format("the name is not NAME{}", kLabelsExtension));
  const auto text = read_file(json, kMostJsonBytes, log);
  if (!text) return failed;
  // what is nested deeper is no part of a frame, and not kept
  const auto shallow = [](int depth, JsonTree::parse_event_t, const JsonTree&) {
    return depth <= kMostDepth;
  };
  const JsonTree parsed = JsonTree::parse(*text, shallow, false);
  if (!parsed.is_object()) return fail("the text is no JSON object");
  FrameReader reader(json.string(), log);
  FrameLabels frame = reader.frame(parsed);
  const std::string stem = name.substr(0, name.size() - kLabelsExtension.size());
  if (reader.good() && frame.name != stem) reader.fail("name", "the name of the file");
  if (!reader.good()) return failed;
  const auto beside = [&](std::string_view extension) {
    return json.parent_path() / (stem + std::string(extension));
  };
  if (parts.masks && !take_masks(beside(kMasksExtension), frame, log)) return failed;
  if (!parts.flow) return frame;
  for (const auto& [flow, member, extension] :
       {std::tuple(&frame.forward, "forward", kForwardExtension),
        std::tuple(&frame.backward, "backward", kBackwardExtension)}) {
    if (reader.member(parsed, member).is_null()) continue;
    auto read = read_flo(beside(extension), frame.camera.width, frame.camera.height, log);
    if (!read) return failed;
    *flow = *std::move(read);
  }
  return frame;
}

bool has_whole_files(const std::filesystem::path& json, bool forward, bool backward) {
  DiagnosticLog none;
  const auto frame = read_frame(json, none, {true, false});
  if (!frame) return false;
  for (const auto& [expected, extension] :
       {std::pair(forward, kForwardExtension), std::pair(backward, kBackwardExtension)}) {
    const auto file = json.parent_path() / (frame->name + std::string(extension));
    std::error_code error;
    if (expected && std::filesystem::file_size(file, error) !=
                        flo_bytes(frame->camera.width, frame->camera.height))
      return false;
  }
  return true;
}

}  // namespace panwright::labels
