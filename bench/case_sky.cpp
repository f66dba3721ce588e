// Discs of planets, stars and ephemerides: processor time beside the error of the same work.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "base/text.h"
#include "bench/bench.h"
#include "ephemeris/kernels.h"
#include "sky/backdrop.h"
#include "sky/star_catalogue.h"
#include "sky/stars.h"

namespace panwright::bench::case_sky {

namespace {

constexpr double kRadius = 6371e3;

// Sets speed, spread and runs: seconds of processors of each run, times a factor.
void time_work(Row& row, int runs, double factor, const std::function<void()>& work) {
  std::vector<double> seconds;
  for (int k = -1; k < runs; ++k) {
    const std::clock_t start = std::clock();
    work();
    if (k >= 0) seconds.push_back(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  }
  std::ranges::sort(seconds);
  row.runs = runs;
  row.speed = factor * seconds[seconds.size() / 2];
  row.spread = 0.5 * factor * (seconds[3 * seconds.size() / 4] - seconds[seconds.size() / 4]);
}

world::Camera camera_of(std::uint32_t side, double degrees, const Vec3& toward) {
  world::Camera camera;
  world::set_field_of_view(camera, side, side, degrees * kDegree);
  DiagnosticLog log;
  camera.world_from_camera = *world::looking_at(Vec3(0), toward, std::nullopt, log);
  return camera;
}

world::World world_of(const Vec3& centre, const Vec3& sun) {
  world::World world;
  light::Body body = *light::body_preset("earth");
  body.air = false;  // closed forms are of the ground alone
  body.albedo = Vec3(0.3);
  body.radii = Vec3(kRadius);
  body.centre = centre;
  world.set_sky({body}, false);
  world.set_sun({.direction = sun});
  return world;
}

// Irradiance of a plane that faces the camera.
double flux_of(const std::vector<float>& image, const world::Camera& camera) {
  double sum = 0;
  for (std::uint32_t row = 0; row < camera.height; ++row)
    for (std::uint32_t column = 0; column < camera.width; ++column) {
      const Vec2 at = (Vec2(column + 0.5, row + 0.5) - camera.principal) / camera.focal;
      sum += static_cast<double>(image[3 * (std::size_t{row} * camera.width + column)]) *
             world::pixel_solid_angle(camera, column, row) / std::sqrt(1 + glm::dot(at, at));
    }
  return sum;
}

// The largest error of pixels that a limb crosses, in parts of the disc's brightest: means of 32 by
// 32 rays, each against the sphere.
double limb_error(const std::vector<float>& image, const world::World& world,
                  const world::Camera& camera) {
  const Vec3 centre = world.bodies()[0].centre;
  const Vec3 sun = glm::normalize(world.sun().direction);
  constexpr int kRays = 32;
  double worst = 0, brightest = 0;
  for (std::uint32_t row = camera.height / 2; row < camera.height / 2 + 8; ++row)
    for (std::uint32_t column = 0; column < camera.width; ++column) {
      double sum = 0;
      int hits = 0;
      for (int k = 0; k < kRays * kRays; ++k) {
        const Vec2 at(column + (k % kRays + 0.5) / kRays, row + (k / kRays + 0.5) / kRays);
        const geometry::Ray ray = world::pixel_ray(camera, at);
        const Vec3 d = glm::normalize(ray.direction);
        const double along = glm::dot(centre, d);
        const double left = kRadius * kRadius - (glm::dot(centre, centre) - along * along);
        if (!(left > 0) || !(along > 0)) continue;
        ++hits;
        const Vec3 normal = ((along - std::sqrt(left)) * d - centre) / kRadius;
        sum += 0.3 / kPi * std::max(glm::dot(normal, sun), 0.0);
      }
      brightest = std::max(brightest, sum / (kRays * kRays));
      if (hits == 0 || hits == kRays * kRays) continue;
      const double got = image[3 * (std::size_t{row} * camera.width + column)];
      worst = std::max(worst, std::fabs(got - sum / (kRays * kRays)));
    }
  return worst / brightest;
}

void add_discs(Context& context) {
  const std::uint32_t side = context.quick() ? 128 : 1024;
  for (const auto& [name, h, degrees] :
       {std::tuple("400 km", (kRadius + 400e3) / kRadius, 145.0), std::tuple("GEO", 6.618, 20.0),
        std::tuple("a million radii", 1e6, 20.0)}) {
    const world::Camera camera = camera_of(side, degrees, {0, 1, 0.01});
    const world::World world = world_of(Vec3(0, h * kRadius, 0), {0, -1, 0});
    const sky::Sky sky(world);
    std::vector<float> image;
    // of a nadir plate with the Sun behind it: exact
    const double c1 =
        h > 100 ? 2 / (3 * h * h)
                : 1 / (2 * h * h * h) + (1 + h * h) / (4 * h * h) -
                      std::pow(h * h - 1, 2) / (8 * h * h * h) * std::log((h + 1) / (h - 1));
    Row row{.case_name = "sky",
            .setting = fmt::format("disc, {}, {} x {}", name, side, side),
            .speed_unit = "ms of processors",
            .error_unit = "relative, flux",
            .reference = "closed form of a sphere",
            .must_error = 1e-3};
    time_work(row, context.runs(), 1e3, [&] { image = sky::backdrop(sky, camera, 0); });
    row.error = std::fabs(flux_of(image, camera) / (0.3 * c1 * std::cos(std::atan(0.01))) - 1);
    context.add(row);
    if (h > 100) continue;
    // lit from the side, so that the limb is bright
    const world::World lit = world_of(Vec3(0, h * kRadius, 0), {1, -1, 0});
    image = sky::backdrop(sky::Sky(lit), camera, 0);
    row.setting = fmt::format("limb, {}, {} x {}", name, side, side);
    row.error = limb_error(image, lit, camera);
    row.error_unit = "px";
    row.reference = "1024 rays a pixel";
    row.must_error = 0.02;
    context.add(std::move(row));
  }
}

// Largest distance in pixels of the centre of a star from that of a sampled Gaussian of 0.5 px.
double worst_centre(const world::Camera& camera, image::Image& image) {
  double worst = 0;
  for (int k = 0; k < 40; ++k) {
    const Vec2 pixel(50 + 0.025 * k, 50.3);
    const sky::StarInView star{0, {}, pixel, Vec3(1e-9)};
    image.radiance.assign(3 * image.pixels(), 0);
    sky::add_stars({&star, 1}, camera, 0.5, Vec3(1), image);
    double sum = 0, centre = 0;
    for (std::uint32_t y = 40; y < 61; ++y)
      for (std::uint32_t x = 40; x < 61; ++x) {
        const double light =
            static_cast<double>(image.radiance[3 * (std::size_t{y} * image.width + x)]) *
            world::pixel_solid_angle(camera, x, y);
        sum += light;
        centre += light * (x + 0.5);
      }
    const double exact =
        pixel.x + std::exp(-2 * kPi * kPi * 0.25) / kPi * std::sin(2 * kPi * pixel.x);
    worst = std::max(worst, std::fabs(centre / sum - exact));
  }
  return worst;
}

// All stars, in the six images of a cube; those of one image of 20 degrees.
void add_star_rows(Context& context) {
  light::Stars stars;
  stars.catalogue = sky::hipparcos_stars();
  std::vector<world::Camera> cameras;
  for (const Vec3& toward : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0),
                             Vec3(0, 0.01, 1), Vec3(0, 0.01, -1)})
    cameras.push_back(camera_of(context.quick() ? 128 : 1024, 90, toward));
  image::Image image;
  image.width = cameras[0].width;
  image.height = cameras[0].height;
  image.coverage.assign(image.pixels(), 0);
  image.radiance.assign(3 * image.pixels(), 0);
  double got = 0, want = 0;
  std::size_t count = 0;
  const auto draw = [&] {
    got = want = 0;
    count = 0;
    for (const world::Camera& camera : cameras) {  // into one image, which costs nothing by itself
      const auto seen = sky::stars_in_view(stars, camera, 0);
      sky::add_stars(seen, camera, 0.8, Vec3(1), image);
      count += seen.size();
    }
  };
  Row row{.case_name = "sky",
          .speed_unit = "ms of processors",
          .error_unit = "relative, flux",
          .reference = "sum of the stars' irradiance",
          .must = 5,
          .must_is_least = false,
          .must_error = 1e-6};
  time_work(row, context.runs(), 1e3 / static_cast<double>(cameras.size()), draw);
  row.setting = fmt::format("one of six images of {} stars, sigma 0.8", count);
  // away from borders, where light falls outside
  const world::Camera& camera = cameras[0];
  auto seen = sky::stars_in_view(stars, camera, -8);
  image.radiance.assign(3 * image.pixels(), 0);
  sky::add_stars(seen, camera, 0.8, Vec3(1), image);
  for (const sky::StarInView& star : seen) want += star.irradiance.y;
  for (std::uint32_t y = 0; y < image.height; ++y)
    for (std::uint32_t x = 0; x < image.width; ++x)
      got += static_cast<double>(image.radiance[3 * (std::size_t{y} * image.width + x) + 1]) *
             world::pixel_solid_angle(camera, x, y);
  row.error = std::fabs(got / want - 1);
  Row narrow = row;
  context.add(row);
  row.must = 0;
  const world::Camera tracker = camera_of(context.quick() ? 128 : 1024, 20, Vec3(1, 0, 0));
  time_work(narrow, context.runs(), 1e3, [&] {
    image.radiance.assign(3 * image.pixels(), 0);
    seen = sky::stars_in_view(stars, tracker, 0);
    sky::add_stars(seen, tracker, 0.8, Vec3(1), image);
  });
  narrow.setting = fmt::format("{} of {} stars, 20 degrees, sigma 0.8", seen.size(), count);
  context.add(std::move(narrow));
  row.setting = fmt::format("{} stars, centres at sigma 0.5", count);
  row.error = worst_centre(camera, image);
  row.error_unit = "px";
  row.reference = "closed form of a sampled Gaussian";
  row.must_error = 1e-3;
  context.add(std::move(row));
}

// States of kernels beside the checkout, by type, against an independent reader's.
void add_kernels(Context& context) {
  const char* corpus = std::getenv("PANWRIGHT_CORPUS");
  const std::filesystem::path folder =
      std::filesystem::path(corpus != nullptr ? corpus : "") / "spice";
  std::ifstream file(folder / "expected_spk.tsv");
  if (!file) return context.note("no kernels: PANWRIGHT_CORPUS names no folder with spice/");
  struct Type {
    std::vector<std::function<void()>> queries;
    double worst = 0;
  };
  std::map<int, Type> types;
  std::map<std::string, ephemeris::Kernels> kernels;
  DiagnosticLog log;
  for (std::string line; std::getline(file, line);) {
    std::vector<std::string> words;
    std::stringstream stream(line);
    for (std::string word; std::getline(stream, word, '\t');) words.push_back(word);
    if (words.size() < 13 || line[0] == '#' || words[0] == "file" || words[7] == "REFUSE") continue;
    auto found = kernels.find(words[0]);
    if (found == kernels.end()) {
      const std::filesystem::path path = folder / "spk" / words[0];
      auto loaded = ephemeris::Kernels::load({&path, 1}, log);
      if (!loaded) continue;
      found = kernels.emplace(words[0], *loaded).first;
    }
    const ephemeris::Kernels& from = found->second;
    const std::size_t segment = std::stoul(words[1]);
    const double et = *parse_double(words[6]);
    Type& type = types[std::stoi(words[2])];
    type.queries.push_back([&from, segment, et] { (void)from.segment_state(segment, et); });
    const auto state = from.segment_state(segment, et);
    const Vec3 want(*parse_double(words[7]), *parse_double(words[8]), *parse_double(words[9]));
    const double off = state ? glm::length(state->position - want) : NAN;
    type.worst = std::max(type.worst, off / std::max(glm::length(want), 1.0));
  }
  for (const auto& [number, type] : types) {
    Row row{.case_name = "sky",
            .setting = fmt::format("states of SPK type {}", number),
            .speed_unit = "us of processors a query",
            .error = type.worst,
            .error_unit = "relative, position",
            .reference = "an independent reader (numpy)",
            .must_error = 1e-12};
    const int times = context.quick() ? 10 : 2000;
    time_work(row, context.runs(), 1e6 / (times * static_cast<double>(type.queries.size())),
              [&, &type = type] {
                for (int k = 0; k < times; ++k)
                  for (const auto& query : type.queries) query();
              });
    context.add(std::move(row));
  }
}

void run(Context& context) {
  add_discs(context);
  add_star_rows(context);
  add_kernels(context);
}

const bool kAdded = add_case({"sky", "discs, stars, ephemerides", run});

}  // namespace

}  // namespace panwright::bench::case_sky
