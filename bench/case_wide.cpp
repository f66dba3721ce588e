// Sun shadows of models that are wide beside what a camera sees of them: what they cost beside the
// same view of a compact model, and how far off flux and image are.
#include <fmt/core.h>

#include <cmath>
#include <string>
#include <vector>

#include "bench/bench.h"
#include "compiler/compile.h"
#include "pan/model.h"
#include "preview/reference/reference.h"
#include "preview/renderer.h"
#include "pxn/pxn.h"
#include "tests/support/model_renderer.h"

namespace panwright::bench::case_wide {

namespace {

struct Subject {
  std::string name;
  std::string parts;  // pxn
  Vec3 camera{0.3, -0.9, 0.8};
  Vec3 target{0.05, 0.02, 0};
};

// A cube of 10 cm on a plate.
std::string on_plate(double side, const std::string& more = "") {
  return fmt::format(
      "<box size=\"{0} {0} 0.01\" translate=\"0 0 -0.005\"/>"
      "<box size=\"0.1 0.1 0.1\" translate=\"0 0 0.05\"/>{1}",
      side, more);
}

std::string boxes_at(double away) {
  return fmt::format(
      "<box size=\"0.5 0.5 0.5\" translate=\"{0} 0 0\"/>"
      "<box size=\"0.5 0.5 0.5\" translate=\"-{0} 0 0\"/>",
      away);
}

// A deck of 120 m with a rail on posts, seen from its near end.
std::string truss() {
  std::string text =
      "<box size=\"1 120 0.01\" translate=\"0 0 -0.005\"/>"
      "<box size=\"0.05 118 0.05\" translate=\"0.2 0 0.6\"/>";
  for (int i = 0; i < 60; ++i)
    text += fmt::format("<box size=\"0.05 0.05 0.6\" translate=\"0.2 {} 0.3\"/>", 2 * i - 58.7);
  return text;
}

Result<pan::Model> compiled(const std::string& parts, DiagnosticLog& log) {
  const std::string text =
      "<pangu_model ver=\"1\"><material name=\"white\"><diffuse>0.8 0.8 0.8</diffuse></material>"
      "<node name=\"all\" material=\"white\">" +
      parts + "</node></pangu_model>";
  const std::vector<pxn::MemoryFile> files = {{"wide.pxn", text}};
  const auto scene = pxn::read_memory(files, {}, log);
  if (!scene) return failed;
  const auto bytes = compiler::compiled(*scene, {}, log);
  auto model = bytes ? pan::Model::from_bytes(*bytes, "wide", log) : Result<pan::Model>(failed);
  if (!model || !model->check(log)) return failed;
  return model;
}

struct Errors {
  double flux = 0;   // relative
  double rmse = 0;   // of the image, over its RMS
  double noise = 0;  // of the reference, the same
};

Errors errors(const image::Image& image, const preview::ReferenceImage& truth) {
  double sum = 0;
  double off = 0;
  double square = 0;
  double square_off = 0;
  double noise = 0;
  for (std::size_t i = 0; i < image.radiance.size(); ++i) {
    const double t = truth.image.radiance[i];
    const double d = image.radiance[i] - t;
    const double e = truth.standard_error[i];
    sum += t;
    off += d;
    square += t * t;
    square_off += d * d;
    noise += e * e;
  }
  return {std::fabs(off / sum), std::sqrt(square_off / square), std::sqrt(noise / square)};
}

void run(Context& context) {
  DiagnosticLog log;
  auto gl = preview::Device::create(preview::ContextKind::automatic, log);
  if (!gl) return context.note("no OpenGL context: nothing measured");
  context.set_renderer((*gl)->context().renderer());
  const std::vector<Subject> subjects = {
      {"compact: a 10 cm cube on a plate of 1 m", on_plate(1)},
      {"boxes at 100 m on both sides", on_plate(1, boxes_at(100))},
      {"boxes at 1 km on both sides", on_plate(1, boxes_at(1e3))},
      {"boxes at 10 km on both sides", on_plate(1, boxes_at(1e4))},
      {"a plate of 200 m", on_plate(200)},
      {"a truss of 120 m from its end", truss(), {-0.6, -60, 0.9}, {0, -57, 0.1}},
  };
  std::vector<pan::Model> models;
  for (const Subject& subject : subjects) {
    auto model = compiled(subject.parts, log);
    if (!model) return context.note("a model could not be compiled: " + to_text(log));
    models.push_back(*std::move(model));
  }
  std::vector<support::ModelRenderer> renderers;
  for (const pan::Model& model : models) renderers.emplace_back(*gl, model);
  const auto view_of = [&](std::size_t i, std::uint32_t pixels) {
    preview::View view;
    world::set_field_of_view(view.camera, pixels, pixels, 25 * kDegree);
    view.camera.position = subjects[i].camera;
    if (const auto turn = world::looking_at(subjects[i].camera, subjects[i].target, {}, log))
      view.camera.world_from_camera = *turn;
    view.to_sun = {-1, -0.4, 1.1};
    return view;
  };
  const std::uint32_t large = context.quick() ? 128 : 1024;
  std::vector<Variant> variants;
  for (std::size_t i = 0; i < subjects.size(); ++i)
    variants.push_back({subjects[i].name, [&, i, turned = false]() mutable {
                          // another Sun for each image, so that the map is drawn again
                          preview::View view = view_of(i, large);
                          view.to_sun.z += turned ? 1e-9 : 2e-9;
                          turned = !turned;
                          static_cast<void>(renderers[i].render(view, {}, log));
                        }});
  const std::vector<Timing> timings = interleaved(variants, context.runs());
  for (std::size_t i = 0; i < subjects.size(); ++i) {
    const preview::View view = view_of(i, context.quick() ? 64 : 256);
    preview::RenderOptions options;
    options.samples = 4;
    const auto image = renderers[i].render(view, options, log);
    preview::ReferenceOptions exact;
    exact.bounces = 0;
    exact.sun_disc = false;
    exact.samples = context.quick() ? 8 : 128;
    world::World world =
        preview::world_of(std::make_shared<const pan::Model>(std::move(models[i])), view);
    const auto truth = preview::Reference().render(world, view.camera, exact, log);
    if (!image || !truth) return context.note("a view could not be drawn: " + to_text(log));
    const Errors found = errors(*image, *truth);
    Row row;
    row.case_name = "wide";
    row.setting = subjects[i].name;
    row.speed_unit = "ms/frame";
    set_time(row, timings[i], 1e3);
    row.reference = "reference renderer; 0 bounces, no disc";
    row.error = found.flux;
    row.error_unit = "flux";
    row.must_error = 2e-3;
    context.add(row);
    row.error = found.rmse;
    row.error_unit = "rmse";
    row.reference_error = found.noise;
    row.must_error = 0;
    context.add(row);
    row.reference = "the compact model";
    row.error = timings[i].median / timings[0].median;
    row.error_unit = "time, ratio";
    row.reference_error = 0;
    context.add(row);
  }
}

const bool kAdded = add_case({"wide", "Sun shadows of wide models against the reference", run});

}  // namespace

}  // namespace panwright::bench::case_wide
