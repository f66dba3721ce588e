#include "studio/samples.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

#include "compiler/compile.h"
#include "materials/brdf.h"
#include "materials/energy.h"
#include "materials/report.h"
#include "preview/reference/reference.h"
#include "studio/render_thread.h"
#include "workspace/material_scene.h"

namespace panwright::studio {
namespace {

Vec3 sample_direction(double degrees) {
  return {std::sin(degrees * kDegree), 0, std::cos(degrees * kDegree)};
}

void add_curves(const materials::Material& material, MaterialSample& sample) {
  const materials::f64::CompiledBrdf brdf(material);
  const materials::ShadingContext local{Vec3(1, 0, 0)};
  for (std::size_t i = 0; i < kSampleLights.size(); ++i)
    // steps of a degree, of a tenth near the mirror direction and the light
    for (int step = -890; step <= 890; ++step) {
      const double angle = 0.1 * step;
      const double glint =
          std::min(std::fabs(angle - kSampleLights[i]), std::fabs(angle + kSampleLights[i]));
      if (step % 10 != 0 && glint > 4) continue;
      const Vec3 f = brdf.brdf(materials::sunlight(sample_direction(-kSampleLights[i])),
                               sample_direction(angle), Vec3(0, 0, 1), Vec3(1), local);
      sample.lobes[i].emplace_back(angle, kPi * (f.x + f.y + f.z) / 3);
    }
  for (int degrees = 0; degrees <= 88; degrees += degrees < 70 ? 5 : 3) {
    const Vec3 albedo = materials::directional_albedo(material, std::cos(degrees * kDegree));
    for (std::size_t k = 0; k < 3; ++k)
      sample.albedo[k].emplace_back(degrees, albedo[static_cast<int>(k)]);
  }
  const Vec3 mean = materials::hemispherical_albedo(material);
  for (std::size_t k = 0; k < 3; ++k) sample.hemispherical[k] = mean[static_cast<int>(k)];
  const double mus[] = {1};
  sample.verdict = materials::verdict(materials::material_report(material, mus));
  sample.description = materials::brdf_in_words(material);
}

void add_sample_image(const pxn::DescribedMaterial& material, std::uint32_t width, const Job& job,
                      MaterialSample& sample) {
  DiagnosticLog log;
  const auto bytes = compiler::compiled(
      workspace::sample_scene(material, workspace::SampleLight::sun), {}, log, job);
  if (!bytes) return;
  auto model = pan::Model::from_bytes(*bytes, "samples", log);
  world::World world;
  if (!model || !model->check(log) ||
      !world.add("samples", std::make_shared<const pan::Model>(*std::move(model)), log))
    return;
  world.set_sun(workspace::sample_sun());
  preview::ReferenceOptions options;
  options.samples = 32;
  const auto drawn =
      preview::Reference().render(world, workspace::sample_camera(width), options, log, job);
  if (!drawn) return;
  sample.width = drawn->image.width;
  sample.height = drawn->image.height;
  sample.rgba = srgb_pixels(drawn->image, 0);
}

}  // namespace

MaterialSample sample_of(const pxn::DescribedMaterial& material, std::uint32_t width,
                         const Job& job) {
  MaterialSample sample;
  sample.name = material.material.name;
  add_curves(material.material, sample);
  add_sample_image(material, width, job, sample);
  return sample;
}

SheetSlopes slopes_of(const pan::Model& model, const std::string& name) {
  constexpr int kBins = 80;
  constexpr const char* kForms[] = {"flat", "tube", "cone", "disc", "box", "wrap"};
  SheetSlopes out;
  std::array<std::vector<double>, 2> counts;
  for (auto& each : counts) each.assign(2 * kBins + 1, 0);
  double total = 0, squares = 0, widest = 0;
  std::vector<const pan::layout::Sheet*> flat;
  for (const pan::layout::Sheet& sheet : model.sheets()) {
    bool known = name.empty();
    for (const pan::layout::Instance& instance : model.instances())
      if (instance.mesh == sheet.mesh)
        for (std::int32_t node = static_cast<std::int32_t>(instance.node); node >= 0 && !known;
             node = model.nodes()[static_cast<std::size_t>(node)].parent)
          known = model.node_name(static_cast<std::size_t>(node)) == name;
    if (!known) continue;
    out.sheets.push_back(fmt::format(
        "{} {:.3g} x {:.3g} m, {} x {} cells, seed {}: slope {:.3f} RMS, heights {:.3g} mm RMS",
        kForms[std::min(sheet.form, 5u)], sheet.width, sheet.height, sheet.columns, sheet.rows,
        sheet.seed, sheet.slope_rms, 1e3 * sheet.height_rms));
    if (sheet.form != 0) continue;
    flat.push_back(&sheet);
    widest = std::max(widest, 4 * sheet.slope_rms / std::sqrt(2));
  }
  if (flat.empty() || !(widest > 0)) return out;
  for (const pan::layout::Sheet* sheet : flat) {
    const pan::MeshView mesh = model.mesh(sheet->mesh);
    const auto corner = [&](std::size_t i) {
      const auto& p = mesh.positions[mesh.indices[i]];
      return Vec3(p.x, p.y, p.z);
    };
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
      const Vec3 twice = glm::cross(corner(i + 1) - corner(i), corner(i + 2) - corner(i));
      if (!(std::fabs(twice.z) > 0)) continue;
      const double area = std::fabs(twice.z);
      for (int axis = 0; axis < 2; ++axis) {
        const double slope = -twice[axis] / twice.z;
        squares += 0.5 * area * slope * slope;
        const double bin = std::round(slope / widest * kBins);
        if (std::fabs(bin) <= kBins)
          counts[static_cast<std::size_t>(axis)][static_cast<std::size_t>(bin + kBins)] += area;
      }
      total += area;
    }
  }
  if (!(total > 0)) return out;
  out.rms = std::sqrt(squares / total);
  for (std::size_t axis = 0; axis < 2; ++axis)
    for (int bin = -kBins; bin <= kBins; ++bin)
      out.density[axis].emplace_back(
          bin * widest / kBins,
          counts[axis][static_cast<std::size_t>(bin + kBins)] / total * kBins / widest);
  return out;
}

Samples::~Samples() {
  if (job_.state()) job_.cancel();
  if (running_.valid()) running_.wait();
}

void Samples::request(pxn::DescribedMaterial material, std::uint32_t width) {
  pending_.emplace(std::move(material), width);
  if (!running_.valid()) start();
}

void Samples::start() {
  job_ = Job(JobOptions{});
  running_ = std::async(std::launch::async, [work = std::move(*pending_), job = job_] {
    return sample_of(work.first, work.second, job);
  });
  pending_.reset();
}

bool Samples::poll() {
  if (!running_.valid() || running_.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
    return false;
  last_ = running_.get();
  if (pending_) start();
  return true;
}

}  // namespace panwright::studio
