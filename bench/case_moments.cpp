// A plate with a normal map, seen from so far that the map has gone into the material: its flux
// against the mean over the map's texels.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <list>
#include <numbers>

#include "base/parallel.h"
#include "bench/bench.h"
#include "materials/brdf.h"
#include "pan/model.h"
#include "pan/writer.h"
#include "preview/renderer.h"
#include "tests/support/model_renderer.h"
#include "tests/support/view.h"

namespace panwright::bench::case_moments {

namespace {

constexpr std::uint32_t kSide = 128;  // texels
constexpr std::uint32_t kPixels = 32;

// ---- maps

enum class Bumps { isotropic, stretched, grooves };
constexpr const char* kBumpNames[] = {"bumps", "bumps stretched 4:1", "grooves"};

// A row or column made smooth: the mean over a Gaussian of so many texels, around the end.
void smooth(std::vector<double>& values, std::size_t step, std::size_t stride, double radius) {
  const int reach = static_cast<int>(std::ceil(4 * radius));
  std::vector<double> weight;
  for (int i = -reach; i <= reach; ++i)
    weight.push_back(std::exp(-0.5 * i * i / (radius * radius)));
  std::vector<double> line(kSide);
  for (std::size_t k = 0; k < kSide; ++k) {
    for (std::size_t i = 0; i < kSide; ++i) {
      line[i] = 0;
      for (int j = -reach; j <= reach; ++j)
        line[i] += weight[static_cast<std::size_t>(j + reach)] *
                   values[k * stride +
                          (i + kSide + static_cast<std::size_t>(j + static_cast<int>(kSide))) %
                              kSide * step];
    }
    for (std::size_t i = 0; i < kSide; ++i) values[k * stride + i * step] = line[i];
  }
}

// The codes of a normal map. slope: rms along the axis where it is largest
std::vector<std::uint8_t> map_of(Bumps bumps, double slope, std::uint32_t seed) {
  std::vector<double> height(kSide * kSide);
  if (bumps == Bumps::grooves) {
    for (std::size_t i = 0; i < height.size(); ++i)
      height[i] =
          std::sin(2 * std::numbers::pi * (static_cast<double>(i % kSide) + 0.3 * seed) / 16);
  } else {
    std::uint32_t state = seed;
    for (double& each : height) {
      for (int k = 0; k < 12; ++k) {
        state = state * 1664525u + 1013904223u;  // Numerical Recipes' quick generator
        each += state * 0x1p-32 - 0.5;
      }
    }
    smooth(height, 1, kSide, 3);
    smooth(height, kSide, 1, bumps == Bumps::stretched ? 12 : 3);
  }
  const auto at = [&](std::size_t x, std::size_t y) {
    return height[y % kSide * kSide + x % kSide];
  };
  std::vector<Vec2> slopes;
  double square = 0;
  for (std::size_t y = 0; y < kSide; ++y)
    for (std::size_t x = 0; x < kSide; ++x) {
      slopes.emplace_back(at(x + 1, y) - at(x + kSide - 1, y), at(x, y + 1) - at(x, y + kSide - 1));
      square += slopes.back().x * slopes.back().x / (kSide * kSide);
    }
  std::vector<std::uint8_t> codes(4 * kSide * kSide, std::uint8_t{255});
  for (std::size_t i = 0; i < slopes.size(); ++i) {
    const Vec2 s = slopes[i] * (slope / std::sqrt(square));
    const Vec3 n = glm::normalize(Vec3(-s, 1));
    // the image's rows go down
    std::uint8_t* code = &codes[4 * ((kSide - 1 - i / kSide) * kSide + i % kSide)];
    for (int k = 0; k < 3; ++k)
      code[k] = static_cast<std::uint8_t>(std::lround(127.5 * (n[k] + 1)));
  }
  return codes;
}

// ---- materials

materials::Material of(const materials::SpecularBrdf& brdf) {
  materials::Material material;
  material.weights = {0, 1, 0};
  material.specular_brdf = brdf;
  material.specular = Vec3(1);
  material.refract = Vec3(1.4);
  material.extinction = Vec3(7.5);
  return material;
}

std::vector<std::pair<std::string, materials::Material>> surfaces() {
  std::vector<std::pair<std::string, materials::Material>> all;
  materials::Material lambert;
  lambert.diffuse = Vec3(0.8);
  lambert.weights = {1, 0, 0};
  all.emplace_back("Lambert", lambert);
  all.emplace_back("Cook-Torrance 0.1", of(materials::CookTorrance{.alpha = 0.1}));
  all.emplace_back("Blinn-Phong 200", of(materials::BlinnPhong{.shine = 200}));
  all.emplace_back("GGX 0.06", of(materials::Ggx{0.06, 0.06}));
  all.emplace_back("GGX 0.05 x 0.2", of(materials::Ggx{0.05, 0.2}));
  materials::Material kapton = of(materials::Ggx{0.06, 0.06});
  kapton.coat = materials::Coat{1.7, 0.03, Vec3(0.2)};
  all.emplace_back("GGX 0.06 under a coat", kapton);
  for (auto& [name, material] : all) materials::fit(material);
  return all;
}

// ---- directions

struct Place {
  double phase = 0;  // degrees
  Vec3 to_sun{0};
  Vec3 to_viewer{0};
};

// Sun and viewer in planes that stand at 30 degrees to the map's u; their bisector along the
// plate's normal, and beside it along and across u.
std::vector<Place> places(bool quick) {
  std::vector<Place> all;
  const Vec2 beside[] = {{0, 0}, {8, 20}, {15, 110}};
  for (const double phase : {0.0, 45.0, 90.0, 120.0})
    for (const Vec2& tilt : beside) {
      if (quick && phase != 45) continue;
      const double t = glm::radians(tilt.x);
      const double a = glm::radians(tilt.y);
      const Vec3 middle(std::sin(t) * std::cos(a), std::sin(t) * std::sin(a), std::cos(t));
      const Vec3 u(std::cos(glm::radians(30.0)), std::sin(glm::radians(30.0)), 0);
      const Vec3 aside = glm::normalize(u - middle * glm::dot(u, middle));
      const double half = glm::radians(phase / 2);
      all.push_back({phase, std::cos(half) * middle + std::sin(half) * aside,
                     std::cos(half) * middle - std::sin(half) * aside});
    }
  return all;
}

// ---- the mean over the texels

// What the texels' facets show, each as large as it looks: the map as the geometry that it stands
// for, but for shadows and light between facets.
double mean_of(const std::vector<std::uint8_t>& codes, const materials::f64::CompiledBrdf& brdf,
               const Place& place) {
  std::vector<Vec2> rows(kSide);
  parallel_for(kSide, [&](std::size_t y) {
    for (std::size_t x = 0; x < kSide; ++x) {
      const std::uint8_t* code = &codes[4 * (y * kSide + x)];
      const Vec3 n = glm::normalize(Vec3(code[0], code[1], code[2]) / 127.5 - 1.0);
      const double seen = glm::dot(n, place.to_viewer) / n.z;
      if (!(seen > 0)) continue;
      const Vec3 u = glm::normalize(Vec3(1, 0, 0) - n * n.x);
      const double lit = std::max(glm::dot(n, place.to_sun), 0.0);
      const Vec3 f = brdf.brdf(materials::sunlight(place.to_sun), place.to_viewer, n, Vec3(1), {u});
      rows[y] += seen * Vec2(1, lit * f.x);
    }
  });
  Vec2 sum(0);
  for (const Vec2& row : rows) sum += row;
  return sum.y / sum.x;
}

// ---- the plate

// texels: of the map, a pixel at normal incidence
double drawn_mean(const std::shared_ptr<preview::Device>& gl, const pan::Contents& contents,
                  const std::vector<Place>& places, double texels, std::vector<double>& means) {
  DiagnosticLog log;
  auto model = pan::Model::from_bytes(pan::write_to_memory(contents), "plate", log);
  if (!model || !model->check(log)) return -1;
  support::ModelRenderer renderer(gl, *model);
  double seconds = 0;
  double mean = 0;
  for (const Place& place : places) {
    preview::View view;
    world::set_orthographic(view.camera, kPixels, kPixels,
                            kPixels * texels / (kSide * contents.materials[0].maps.repeat.x));
    view.camera.position = 10.0 * place.to_viewer;
    const auto turn = world::looking_at(view.camera.position, Vec3(0), Vec3(0, 1, 0), log);
    if (!turn) return -1;
    view.camera.world_from_camera = *turn;
    view.to_sun = place.to_sun;
    preview::RenderOptions options;
    options.samples = 1;
    const Timing timing = timed(
        [&] {
          const auto image = renderer.render(view, options, log);
          if (!image) return;
          mean = 0;
          for (std::size_t i = 0; i < image->pixels(); ++i)
            mean += image->radiance[3 * i] / static_cast<double>(image->pixels());
        },
        1);
    means.push_back(mean);
    seconds += timing.median;
  }
  return seconds / static_cast<double>(places.size());
}

pan::Contents plate(const materials::Material& material, const std::vector<std::uint8_t>& codes,
                    double texels) {
  pan::Contents contents;
  geometry::Mesh mesh;
  for (const Vec2& at : {Vec2(0, 0), Vec2(1, 0), Vec2(1, 1), Vec2(0, 1)}) {
    mesh.positions.push_back(Vec3(at - 0.5, 0));
    mesh.normals.push_back(Vec3(0, 0, 1));
    mesh.texcoords.push_back(at);
  }
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  contents.nodes.push_back({"root", -1, Vec3(0), Quat(1, 0, 0, 0), Vec3(1)});
  contents.meshes.push_back(pan::packed(mesh, "plate"));
  contents.materials.push_back(material);
  contents.materials[0].maps.normal = 0;
  contents.materials[0].maps.repeat = Vec2(texels);
  contents.instances.push_back({0, 0, 0, -1});
  pan::TextureContent texture;
  texture.name = "bumps";
  texture.width = texture.height = kSide;
  texture.linear = true;
  texture.rgba = codes;
  contents.textures.push_back(texture);
  return contents;
}

// ---- rows

struct Errors {
  double square = 0;
  double worst = 0;
  int count = 0;
  void add(double error) {
    square += error * error;
    worst = std::max(worst, std::fabs(error));
    ++count;
  }
  double rms() const { return std::sqrt(square / count); }
};

void run(Context& context) {
  DiagnosticLog log;
  auto gl = preview::Device::create(preview::ContextKind::automatic, log);
  if (!gl) return context.note("no OpenGL context: nothing measured");
  context.set_renderer((*gl)->context().renderer());
  const std::vector<Place> all_places = places(context.quick());
  const std::uint32_t seeds = context.quick() ? 1 : 12;
  context.note(
      "reference: the mean over the texels of level 0, each facet as large as it looks; no "
      "shadows, no light between facets; mean over 12 seeds on both sides");
  const auto materials = surfaces();
  for (const Bumps bumps : {Bumps::isotropic, Bumps::stretched, Bumps::grooves})
    for (const double slope : {0.05, 0.1, 0.2, 0.3}) {
      if (context.quick() && slope != 0.1) continue;
      std::vector<std::vector<std::uint8_t>> maps;
      for (std::uint32_t seed = 1; seed <= seeds; ++seed)
        maps.push_back(map_of(bumps, slope, seed));
      for (const auto& [name, material] : materials) {
        const materials::f64::CompiledBrdf brdf(material);
        std::vector<double> exact(all_places.size());
        for (const auto& codes : maps)
          for (std::size_t i = 0; i < all_places.size(); ++i)
            exact[i] += mean_of(codes, brdf, all_places[i]);
        for (const double texels : {8.0, 32.0, 128.0}) {
          // how far, of one material
          if (texels != 32 && name != "GGX 0.06") continue;
          std::vector<double> found(all_places.size());
          double seconds = 0;
          for (const auto& codes : maps) {
            std::vector<double> means;
            seconds += drawn_mean(*gl, plate(material, codes, texels), all_places, texels, means);
            if (means.size() != found.size()) return context.note("a plate could not be drawn");
            for (std::size_t i = 0; i < found.size(); ++i) found[i] += means[i];
          }
          for (const bool far : {false, true}) {
            Errors errors;
            for (std::size_t i = 0; i < found.size(); ++i)
              if ((all_places[i].phase > 90) == far) errors.add(found[i] / exact[i] - 1);
            if (errors.count == 0) continue;
            Row row{
                .case_name = "moments",
                .setting = fmt::format("{} slope {} {} {} texels a pixel, phase {}; worst {:.1f} %",
                                       kBumpNames[static_cast<int>(bumps)], slope, name, texels,
                                       far ? "120" : "0 to 90", 100 * errors.worst),
                .speed = 1e3 * seconds / seeds,
                .speed_unit = "ms/frame",
                .error = errors.rms(),
                .error_unit = "relative flux, rms",
                .reference = "mean over texels",
                .reference_error = 0,
                .runs = static_cast<int>(seeds),
                .must_error = bumps != Bumps::grooves && slope <= 0.2 && !far ? 0.03 : 0.0};
            context.add(row);
          }
        }
      }
    }
}

const bool kAdded = add_case({"moments", "far plates with normal maps, and their flux", run});

}  // namespace

}  // namespace panwright::bench::case_moments
