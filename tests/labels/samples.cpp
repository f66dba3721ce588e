#include "tests/labels/samples.h"

#include <fmt/core.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <limits>

#include "image/arrays.h"
#include "image/png.h"
#include "labels/frame_files.h"
#include "tests/support/paths.h"

namespace panwright::labels {
namespace {

constexpr std::uint32_t kWidth = 64, kHeight = 48;

// Coverage of a disc by 16 x 16 points a pixel, with the place of its smallest rectangle.
struct Disc {
  double x, y, radius;
  double coverage(std::uint32_t i, std::uint32_t j) const {
    constexpr int kPoints = 16;
    int inside = 0;
    for (int a = 0; a < kPoints; ++a)
      for (int b = 0; b < kPoints; ++b) {
        const double dx = i + (a + 0.5) / kPoints - x, dy = j + (b + 0.5) / kPoints - y;
        inside += dx * dx + dy * dy < radius * radius;
      }
    return inside / double{kPoints * kPoints};
  }
};

template <class Coverage>
Mask mask_of(const Coverage& coverage) {
  std::vector<std::uint8_t> all(std::size_t{kWidth} * kHeight);
  std::uint32_t left = kWidth, top = kHeight, right = 0, bottom = 0;
  for (std::uint32_t j = 0; j < kHeight; ++j)
    for (std::uint32_t i = 0; i < kWidth; ++i) {
      const double value = coverage(i, j);
      if (value <= 0) continue;
      all[std::size_t{j} * kWidth + i] =
          static_cast<std::uint8_t>(std::max(1.0, std::round(255 * value)));
      left = std::min(left, i), right = std::max(right, i + 1);
      top = std::min(top, j), bottom = std::max(bottom, j + 1);
    }
  if (right == 0) return {};
  Mask mask{left, top, right - left, bottom - top, {}};
  for (std::uint32_t j = top; j < bottom; ++j)
    for (std::uint32_t i = left; i < right; ++i)
      mask.coverage.push_back(all[std::size_t{j} * kWidth + i]);
  return mask;
}

Keypoint keypoint_of(const char* name, const Vec3& position, const world::Pose& pose,
                     const world::Camera& camera, bool occluded) {
  Keypoint out{name, position, {}, {}, false, occluded, false};
  out.in_camera = pose.rotation * position + pose.translation;
  if (out.in_camera.z > 0)
    out.pixel = Vec2(camera.focal.x * out.in_camera.x / out.in_camera.z + camera.principal.x,
                     camera.focal.y * out.in_camera.y / out.in_camera.z + camera.principal.y);
  out.truncated = !out.pixel || out.pixel->x < 0 || out.pixel->x >= kWidth || out.pixel->y < 0 ||
                  out.pixel->y >= kHeight;
  out.lit = position.x > 0;
  return out;
}

Thing thing_of(std::uint32_t id, const char* target, const char* label, const Disc& disc,
               const std::vector<Disc>& before) {
  Thing out;
  out.id = id;
  out.target = target;
  out.label = label;
  out.amodal = mask_of([&](auto i, auto j) { return disc.coverage(i, j); });
  out.visible = mask_of([&](auto i, auto j) {
    double value = disc.coverage(i, j);
    for (const Disc& other : before) value = std::max(0.0, value - other.coverage(i, j));
    return value;
  });
  out.amodal_box =
      Box{disc.x - disc.radius, disc.y - disc.radius, disc.x + disc.radius, disc.y + disc.radius};
  const Mask& seen = out.visible;
  if (seen.width > 0)
    out.visible_box = Box{double(seen.left), double(seen.top), double(seen.left + seen.width),
                          double(seen.top + seen.height)};
  for (const std::uint8_t value : seen.coverage) out.visible_pixels += value / 255.0;
  out.amodal_pixels = std::max(out.visible_pixels, kPi * disc.radius * disc.radius);
  return out;
}

}  // namespace

SampleFolder::SampleFolder()
    : path_(std::filesystem::temp_directory_path() /
            fmt::format("panwright-labels-{}-{}", getpid(),
                        testing::UnitTest::GetInstance()->current_test_info()->name())) {
  std::filesystem::remove_all(path_);
  std::filesystem::create_directories(path_);
}

SampleFolder::~SampleFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::string file_bytes(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

FrameLabels sample_frame(std::uint64_t number) {
  FrameLabels frame;
  const double t = static_cast<double>(number);
  frame.name = fmt::format("{:06}", number);
  frame.image = frame.name + ".png";
  frame.number = number;
  frame.time = 0.1 * t;
  world::Camera& camera = frame.camera;
  camera.width = kWidth;
  camera.height = kHeight;
  camera.focal = {80, 90};
  camera.principal = {31.25, 24.5};
  camera.position = {1, 2, 3 + t / 3};
  camera.world_from_camera = glm::normalize(Quat(1, 0.5, -0.25, 0.125));
  frame.sun_in_camera = glm::normalize(Vec3(1, -2, -0.5));
  const Disc client{36 + 2 * t, 22.5, 9.3}, wing{42 + 2 * t, 26, 3.1};
  const Disc servicer{12.2 - 7 * t, 30, 11};
  // about the x axis, then a small turn: no symmetric attitude
  const world::Pose pose{{0.6 + 0.25 * t, -0.2, 10 + 0.5 * t},
                         glm::normalize(Quat(0.5, 0.7, 0.3 + t / 10, -0.1))};
  const world::Pose other{{-2.4 - 0.9 * t, 0.6, 8}, glm::normalize(Quat(0.1, 0.2, 0.9, 0.4))};
  frame.things = {thing_of(1, "client", "", client, {servicer}),
                  thing_of(2, "client", "wing", wing, {servicer}),
                  thing_of(3, "servicer", "", servicer, {})};
  frame.things[0].camera_from_thing = frame.things[1].camera_from_thing = pose;
  frame.things[2].camera_from_thing = other;
  frame.things[0].keypoints = {keypoint_of("tip", {1, 0.25, -0.5}, pose, camera, false),
                               keypoint_of("dock", {-0.5, 0.1, 0.3}, pose, camera, true),
                               keypoint_of("behind", {0.1, 0.2, 30}, pose, camera, false)};
  frame.things[1].keypoints = {frame.things[0].keypoints[0]};
  frame.things[2].keypoints = {keypoint_of("nozzle", {0.5, 0.5, 0.1}, other, camera, false)};
  const auto flow = [&](float step) {
    Flow out{kWidth, kHeight,
             std::vector<float>(std::size_t{2} * kWidth * kHeight,
                                std::numeric_limits<float>::quiet_NaN())};
    for (std::uint32_t j = 0; j < kHeight; ++j)
      for (std::uint32_t i = 0; i < kWidth; ++i) {
        if (client.coverage(i, j) <= 0.5) continue;
        const std::size_t at = 2 * (std::size_t{j} * kWidth + i);
        out.motion[at] = step + static_cast<float>(i) / 64;
        out.motion[at + 1] = -0.125f * static_cast<float>(j);
      }
    return out;
  };
  frame.forward = flow(2);
  if (number > 0) frame.backward = flow(-2);
  return frame;
}

void write_sample_frames(const std::filesystem::path& folder, std::uint64_t count) {
  for (std::uint64_t number = 0; number < count; ++number) {
    const FrameLabels frame = sample_frame(number);
    const std::size_t pixels = std::size_t{kWidth} * kHeight;
    std::vector<std::uint8_t> rgb(3 * pixels, 10);
    std::vector<float> depth(pixels, std::numeric_limits<float>::infinity());
    for (const Thing& thing : frame.things)
      for (std::size_t k = 0; k < thing.visible.coverage.size(); ++k) {
        const std::size_t at = (thing.visible.top + k / thing.visible.width) * kWidth +
                               thing.visible.left + k % thing.visible.width;
        if (thing.visible.coverage[k] < 128) continue;
        rgb[3 * at + thing.id % 3] = 200;
        depth[at] = thing.id == 3 ? 8.0f : 10.0f;
      }
    image::PngOptions options;
    options.channels = 3;
    std::ofstream(folder / frame.image, std::ios::binary)
        << image::png_file(kWidth, kHeight, rgb, options);
    const auto bytes = std::as_bytes(std::span(depth));
    const image::Array array{"depth", "<f4", {kHeight, kWidth}, {bytes.begin(), bytes.end()}};
    DiagnosticLog log;
    EXPECT_TRUE(image::write_arrays(folder / (frame.name + ".npz"), {&array, 1}, log));
    EXPECT_TRUE(write_frame(folder, frame, log));
  }
}

std::string difference(const FrameLabels& a, const FrameLabels& b) {
  if (a.name != b.name || a.image != b.image || a.number != b.number || a.time != b.time)
    return "names";
  const world::Camera &c = a.camera, &d = b.camera;
  if (c.width != d.width || c.height != d.height || c.projection != d.projection ||
      c.focal != d.focal || c.principal != d.principal || c.position != d.position ||
      c.world_from_camera != d.world_from_camera)
    return "camera";
  if (bool(c.distortion) != bool(d.distortion) ||
      (c.distortion && c.distortion->distortion() != d.distortion->distortion()))
    return "distortion";
  if (a.sun_in_camera != b.sun_in_camera) return "sun";
  if (a.things.size() != b.things.size()) return "number of things";
  for (std::size_t k = 0; k < a.things.size(); ++k)
    if (!(a.things[k] == b.things[k])) return fmt::format("things[{}]", k);
  for (const auto& [x, y] :
       {std::pair(&a.forward, &b.forward), std::pair(&a.backward, &b.backward)}) {
    if (x->has_value() != y->has_value()) return "flow";
    if (!*x) continue;
    const auto same = [](float p, float q) { return p == q || (std::isnan(p) && std::isnan(q)); };
    if ((*x)->width != (*y)->width || (*x)->height != (*y)->height ||
        !std::ranges::equal((*x)->motion, (*y)->motion, same))
      return "flow";
  }
  return {};
}

PeerAnswer peer(const std::string& script, const std::string& arguments) {
  PeerAnswer out;
  const std::string command = fmt::format("{} {}/tests/labels/{} {} 2>&1", PANWRIGHT_LABELS_PYTHON,
                                          PANWRIGHT_SOURCE_DIR, script, arguments);
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return out;
  std::array<char, 4096> buffer{};
  while (const std::size_t n = fread(buffer.data(), 1, buffer.size(), pipe))
    out.text.append(buffer.data(), n);
  const int status = pclose(pipe);
  out.skipped = WIFEXITED(status) && WEXITSTATUS(status) == 77;
  out.good = status == 0;
  return out;
}

}  // namespace panwright::labels
