// What maps, holes and decals cost, each beside its error: a fine plate that fills the image, seen
// straight, against sums over its images; and spheres of painted metal against the reference.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <list>

#include "bench/bench.h"
#include "bench/scenes.h"
#include "geometry/tessellate/tessellate.h"
#include "pan/model.h"
#include "pan/writer.h"
#include "preview/reference/reference.h"
#include "preview/renderer.h"
#include "tests/support/model_renderer.h"
#include "tests/support/view.h"

namespace panwright::bench::case_maps {

namespace {

constexpr double kAlbedo = 0.8;
constexpr std::uint32_t kSide = 256;  // texels

// A plate of 1 m in z = 0 of 2·quads² triangles.
geometry::Mesh fine_plate(std::uint32_t quads) {
  geometry::Mesh mesh;
  for (std::uint32_t y = 0; y <= quads; ++y)
    for (std::uint32_t x = 0; x <= quads; ++x) {
      const Vec2 at = Vec2(x, y) / static_cast<double>(quads);
      mesh.positions.push_back(Vec3(at - 0.5, 0));
      mesh.normals.push_back(Vec3(0, 0, 1));
      mesh.texcoords.push_back(at);
    }
  for (std::uint32_t y = 0; y < quads; ++y)
    for (std::uint32_t x = 0; x < quads; ++x) {
      const std::uint32_t i = y * (quads + 1) + x;
      mesh.triangles.push_back({i, i + 1, i + quads + 2});
      mesh.triangles.push_back({i, i + quads + 2, i + quads + 1});
    }
  return mesh;
}

// One way to dress the plate, with what it must reflect: π·radiance, mean over the image.
struct Dress {
  std::string name;
  pan::Contents contents;
  std::list<std::vector<std::uint8_t>> pixels;
  double expected = kAlbedo;

  // The mean of value(texel) over the texture.
  double add_texture(const std::function<void(std::uint32_t, std::uint32_t, std::uint8_t*)>& texel,
                     const std::function<double(const std::uint8_t*)>& value) {
    std::vector<std::uint8_t>& rgba = pixels.emplace_back(4 * kSide * kSide, std::uint8_t{255});
    double mean = 0;
    for (std::uint32_t i = 0; i < kSide * kSide; ++i) {
      texel(i % kSide, i / kSide, &rgba[4 * i]);
      mean += value(&rgba[4 * i]) / (kSide * kSide);
    }
    pan::TextureContent texture;
    texture.name = "picture";
    texture.width = kSide;
    texture.height = kSide;
    texture.linear = true;
    texture.rgba = rgba;
    contents.textures.push_back(texture);
    return mean;
  }
};

void checker(std::uint32_t x, std::uint32_t y, std::uint8_t* texel) {
  std::fill_n(texel, 3, static_cast<std::uint8_t>((x + y) % 2 ? 230 : 20));
}
// mirrored bumps, whose mean normal is +z to the rounding of the codes
void bumps(std::uint32_t x, std::uint32_t y, std::uint8_t* texel) {
  const Vec3 n = glm::normalize(Vec3(0.5 * std::sin(0.4 * x + 0.3), 0.5 * std::sin(0.3 * y), 1));
  for (int k = 0; k < 3; ++k) texel[k] = static_cast<std::uint8_t>(std::lround(127.5 * (n[k] + 1)));
}
double outwards(const std::uint8_t* texel) {
  const Vec3 n = Vec3(texel[0], texel[1], texel[2]) / 127.5 - 1.0;
  return n.z / glm::length(n);
}
// 3 of 8 columns; alpha crosses ½ half way between texel centres, so these shares are exact
void stripes(std::uint32_t x, std::uint32_t, std::uint8_t* texel) {
  texel[3] = x % 8 < 3 ? 255 : 0;
}

pan::DecalContent decal_at(const Vec2& at, double side) {
  pan::DecalContent decal;
  decal.name = "decal";
  decal.origin = Vec3(at, 0);
  decal.width = decal.height = side;
  decal.depth = 0.01;
  return decal;
}

void add_decals(Dress& dress, int count, double side) {
  const double of_decal = dress.add_texture(checker, [](const auto* t) { return t[0] / 255.0; });
  for (int i = 0; i < count; ++i)
    dress.contents.decals.push_back(decal_at((Vec2(i % 10, i / 10) + 0.5) / 10.0 - 0.5, side));
  dress.expected += count * side * side * (of_decal - kAlbedo);
}

std::vector<Dress> dresses(std::uint32_t quads) {
  std::vector<Dress> all;
  const pan::PackedMesh mesh = pan::packed(fine_plate(quads), "plate");
  const auto add = [&](std::string name) -> Dress& {
    Dress& dress = all.emplace_back();
    dress.name = std::move(name);
    dress.contents.nodes.push_back({"root", -1, Vec3(0), Quat(1, 0, 0, 0), Vec3(1)});
    dress.contents.meshes.push_back(mesh);
    dress.contents.materials.push_back(lambert_material(kAlbedo));
    dress.contents.instances.push_back({0, 0, 0, -1});
    return dress;
  };
  const auto maps = [](Dress& dress) -> materials::Maps& {
    return dress.contents.materials[0].maps;
  };
  add("plain");
  Dress& albedo = add("albedo map");
  albedo.expected *= albedo.add_texture(checker, [](const auto* t) { return t[0] / 255.0; });
  maps(albedo).albedo = 0;
  Dress& rough = add("roughness map");
  rough.add_texture(checker, [](const auto*) { return 0.0; });
  maps(rough).roughness = 0;
  Dress& bumped = add("normal map");
  bumped.expected *= bumped.add_texture(bumps, outwards);
  maps(bumped).normal = 0;
  Dress& cut = add("cutout map");
  cut.expected *= cut.add_texture(stripes, [](const auto* t) { return t[3] / 255.0; });
  maps(cut).cutout = 0;
  add_decals(add("1 decal"), 1, 0.05);
  add_decals(add("100 decals"), 100, 0.05);
  for (Dress& dress : all) dress.contents.materials[0].maps.repeat = Vec2(4);
  return all;
}

// Metal under some paint, without images and with one.
std::vector<Dress> spheres() {
  std::vector<Dress> all;
  DiagnosticLog log;
  geometry::TessellationOptions options;
  options.texcoords = true;
  const geometry::Sphere shape{1.0, geometry::SphereCounts{90, 120}};
  const auto mesh = geometry::tessellated(shape, options, {}, log);
  if (!mesh) return all;
  materials::Material metal;
  metal.weights = {0.3, 0.7, 0};
  metal.specular_brdf = materials::Ggx{0.4, 0.4};
  metal.specular = Vec3(1);
  metal.refract = Vec3(1.4);
  metal.extinction = Vec3(7.5);
  materials::fit(metal);
  for (const char* name :
       {"metal sphere", "metal sphere, albedo map", "metal sphere, reflectance map"}) {
    Dress& dress = all.emplace_back();
    dress.name = name;
    dress.contents.nodes.push_back({"root", -1, Vec3(0), Quat(1, 0, 0, 0), Vec3(1)});
    dress.contents.meshes.push_back(pan::packed(*mesh, "sphere"));
    dress.contents.materials.push_back(metal);
    dress.contents.instances.push_back({0, 0, 0, -1});
    dress.add_texture(checker, [](const auto*) { return 0.0; });
  }
  all[1].contents.materials[0].maps.albedo = 0;
  all[2].contents.materials[0].maps.reflectance = 0;
  return all;
}

void run_spheres(Context& context, const std::shared_ptr<preview::Device>& gl) {
  DiagnosticLog log;
  const std::uint32_t size = context.quick() ? 200 : 1000;
  preview::View view;
  world::set_orthographic(view.camera, size, size, 2.05);
  view.camera.position = {0, 0, 10};
  if (const auto turn = world::looking_at(view.camera.position, Vec3(0), Vec3(0, 1, 0), log))
    view.camera.world_from_camera = *turn;
  view.to_sun = glm::normalize(Vec3(0.5, 0.2, 1));
  const std::vector<Dress> all = spheres();
  std::list<world::ModelPtr> models;
  std::list<support::ModelRenderer> renderers;
  std::vector<Vec3> ground_truth;
  for (const Dress& dress : all) {
    auto model = pan::Model::from_bytes(pan::write_to_memory(dress.contents), dress.name, log);
    if (!model || !model->check(log)) return context.note("a sphere could not be built");
    models.push_back(std::make_shared<const pan::Model>(*std::move(model)));
    renderers.emplace_back(gl, *models.back());
    preview::ReferenceOptions slow;
    slow.bounces = 0;
    slow.samples = 32;
    const auto image =
        preview::Reference().render(world_of(models.back(), view), view.camera, slow, log);
    if (!image) return context.note("a sphere could not be traced");
    ground_truth.push_back({image->flux.x, image->flux_error.x, 0});
  }
  const double area = std::pow(2.05 / size, 2);
  std::vector<double> flux(all.size());
  std::vector<Variant> variants;
  for (std::size_t i = 0; i < all.size(); ++i)
    variants.push_back({all[i].name, [&, i] {
                          const auto image = std::next(renderers.begin(), i)->render(view, {}, log);
                          if (!image) return;
                          flux[i] = 0;
                          for (std::size_t pixel = 0; pixel < image->pixels(); ++pixel)
                            flux[i] += image->radiance[3 * pixel];
                          flux[i] *= area;
                        }});
  const std::vector<Timing> timings = interleaved(variants, context.runs());
  for (std::size_t i = 0; i < variants.size(); ++i) {
    Row row{.case_name = "maps",
            .setting = fmt::format("{} {}x{}", variants[i].setting, size, size),
            .speed_unit = "ms/frame",
            .error = std::fabs(flux[i] / ground_truth[i].x - 1),
            .error_unit = "relative flux",
            .reference = "reference renderer",
            .reference_error = ground_truth[i].y / ground_truth[i].x,
            .must_error = 3e-3};
    set_time(row, timings[i], 1e3);
    context.add(row);
  }
}

void run(Context& context) {
  DiagnosticLog log;
  auto gl = preview::Device::create(preview::ContextKind::automatic, log);
  if (!gl) return context.note("no OpenGL context: nothing measured");
  context.set_renderer((*gl)->context().renderer());
  run_spheres(context, *gl);
  const std::uint32_t size = context.quick() ? 200 : 1000;
  const std::uint32_t quads = context.quick() ? 50 : 300;
  preview::View view;
  world::set_orthographic(view.camera, size, size, 1);
  view.camera.position = {0, 0, 10};
  if (const auto turn = world::looking_at(view.camera.position, Vec3(0), Vec3(0, 1, 0), log))
    view.camera.world_from_camera = *turn;
  view.to_sun = {0, 0, 1};

  const std::vector<Dress> all = dresses(quads);
  std::list<pan::Model> models;
  std::list<support::ModelRenderer> renderers;
  for (const Dress& dress : all) {
    auto model = pan::Model::from_bytes(pan::write_to_memory(dress.contents), dress.name, log);
    if (!model || !model->check(log)) return context.note("a plate could not be built");
    models.push_back(*std::move(model));
    renderers.emplace_back(*gl, models.back());
  }
  std::vector<double> mean(all.size());
  std::vector<Variant> variants;
  for (std::size_t i = 0; i < all.size(); ++i)
    variants.push_back({all[i].name, [&, i] {
                          const auto image = std::next(renderers.begin(), i)->render(view, {}, log);
                          if (!image) return;
                          mean[i] = 0;
                          for (std::size_t pixel = 0; pixel < image->pixels(); ++pixel)
                            mean[i] += image->radiance[3 * pixel];
                          mean[i] *= kPi / static_cast<double>(image->pixels());
                        }});
  const std::vector<Timing> timings = interleaved(variants, context.runs());
  for (std::size_t i = 0; i < all.size(); ++i) {
    Row row{
        .case_name = "maps",
        .setting = fmt::format("{} triangles={} {}x{}", all[i].name, 2 * quads * quads, size, size),
        .speed_unit = "ms/frame",
        .error = std::fabs(mean[i] / all[i].expected - 1),
        .error_unit = "relative flux",
        .reference = "sum over the image",
        .reference_error = 1e-12,
        .must_error = 3e-3};
    set_time(row, timings[i], 1e3);
    context.add(row);
  }
}

const bool kAdded = add_case({"maps", "what maps, holes and decals cost, and their flux", run});

}  // namespace

}  // namespace panwright::bench::case_maps
