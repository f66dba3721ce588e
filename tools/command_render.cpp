#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/progress.h"
#include "base/text.h"
#include "preview/context.h"
#include "preview/image.h"
#include "preview/reference/reference.h"
#include "preview/renderer.h"
#include "tools/commands.h"
#include "tools/load.h"
#include "tools/session.h"
#include "tools/view.h"

namespace panwright::tools {

namespace {

// One picture to make.
struct Job {
  preview::View view;
  std::string output;
  double ev = 0;
};

// A PNG shows a white plate as white whatever the irradiance is measured in.
double stops_of_sun(const preview::View& view) {
  if (!view.sun_irradiance) return 0;
  const Vec3& e = *view.sun_irradiance;
  const double strongest = std::max({e.x, e.y, e.z});
  return strongest > 0 ? std::log2(strongest) : 0;
}

Result<std::vector<Job>> make_jobs(const RenderOptions& options, const pan::Model& model,
                                   DiagnosticLog& log) {
  const std::size_t errors = log.errors();
  std::vector<ViewOptions> views{options.view};
  if (!options.views.empty()) {
    if (options.view.output)
      log.report(Code::E0201, {}, "-o stands beside --views, whose views name their own outputs");
    auto read = read_views(options.views, options.view, log);
    if (!read) return failed;
    views = std::move(*read);
  }
  std::vector<Job> jobs;
  for (const ViewOptions& typed : views) {
    auto view = make_view(typed, model, log);
    const auto ev = parse_numbers(typed.ev.value_or("0"), 1);
    if (!ev)
      log.report(Code::E0201, {},
                 fmt::format("--ev is {}: it takes a number of stops", in_quotes(*typed.ev)));
    const std::string output = typed.output.value_or(
        std::filesystem::path(options.input).replace_extension(".png").string());
    if (!preview::image_format(output))
      log.report(Code::E0202, {},
                 fmt::format("{} is not a .png, .exr, .npy or .npz file", in_quotes(output)));
    if (view && ev) jobs.push_back({*view, output, (*ev)[0] - stops_of_sun(*view)});
  }
  if (log.errors() != errors) return failed;
  return jobs;
}

std::string words(const Vec3& v) { return fmt::format("{} {} {}", v.x, v.y, v.z); }

// What made a picture, for its header.
void describe(const Job& job, const RenderOptions& options, const pan::Model& model,
              preview::Image& image) {
  const Quat& q = job.view.camera.world_from_camera;
  const auto add = [&](const char* name, std::string value) {
    image.metadata.emplace_back(name, std::move(value));
  };
  add("panwright.build_id", model.build_id().hex());
  add("panwright.camera", words(job.view.camera.position));
  add("panwright.quat", fmt::format("{} {} {} {}", q.w, q.x, q.y, q.z));
  add("panwright.intrinsics",
      fmt::format("{},{},{},{}", job.view.camera.focal.x, job.view.camera.focal.y,
                  job.view.camera.principal.x, job.view.camera.principal.y));
  add("panwright.sun", words(job.view.to_sun));
  add("panwright.samples", fmt::format("{}", options.samples));
  if (options.reference) return;
  add("panwright.shadow_side", fmt::format("{}", options.no_shadows ? 0 : options.shadow_side));
}

bool write(const Job& job, const preview::Image& image, Session& session) {
  session.step("write " + job.output);
  double sync = 0;
  if (!preview::write_image(job.output, image, job.ev, session.log(), &sync)) return false;
  session.step({});
  session.add_timing("sync to disk", sync);
  session.result()["images"].push_back({{"output", job.output},
                                        {"width", image.width},
                                        {"height", image.height},
                                        {"unit", image.unit}});
  return true;
}

bool render_one(const Job& job, const RenderOptions& options, const pan::Model& model,
                preview::Renderer& renderer, Session& session) {
  preview::RenderOptions render;
  render.samples = options.samples;
  render.flat = options.flat;
  render.shadow_side = options.no_shadows ? 0 : options.shadow_side;
  render.max_bytes = options.max_image_bytes;
  render.truth = preview::stores_truth(*preview::image_format(job.output));
  session.step("render " + job.output);
  auto image = renderer.render(job.view, render, session.log());
  if (!image) return false;
  describe(job, options, model, *image);
  return write(job, *image, session);
}

// A share as typed: "0.1%" or "0.001".
std::optional<double> parse_share(std::string text) {
  const bool percent = !text.empty() && text.back() == '%';
  if (percent) text.pop_back();
  const auto number = parse_numbers(text, 1);
  if (!number) return std::nullopt;
  return percent ? (*number)[0] / 100 : (*number)[0];
}

Result<preview::ReferenceOptions> reference_options(const RenderOptions& options,
                                                    DiagnosticLog& log) {
  constexpr double kWidestPsf = 64;  // pixels
  const std::size_t errors = log.errors();
  preview::ReferenceOptions result;
  result.samples = std::max(options.samples * options.samples, 8u);
  result.max_samples = options.max_samples;
  result.seed = options.seed;
  result.bounces = options.bounces;
  result.sun_disc = !options.no_sun_disc;
  result.flat = options.flat;
  result.max_bytes = options.max_image_bytes;
  if (!options.until_error.empty()) {
    const auto share = parse_share(options.until_error);
    if (share && *share > 0 && *share < 1)
      result.until_error = *share;
    else
      log.report(Code::E0201, {},
                 fmt::format("--until-error is {}: it takes a share between 0 and 1, as 0.1%",
                             in_quotes(options.until_error)));
  }
  if (options.filter != "box") {
    const std::string prefix = "gaussian:";
    const auto sigma = options.filter.starts_with(prefix)
                           ? parse_numbers(options.filter.substr(prefix.size()), 1)
                           : std::nullopt;
    if (sigma && (*sigma)[0] > 0 && (*sigma)[0] <= kWidestPsf)
      result.psf_sigma = (*sigma)[0];
    else
      log.report(Code::E0201, {},
                 fmt::format("--filter is {}: it takes box, or gaussian:SIGMA of up to {} pixels",
                             in_quotes(options.filter), kWidestPsf));
  }
  if (log.errors() != errors) return failed;
  return result;
}

// Flux and error of each channel, and how fast.
void tell(const Job& job, const preview::ReferenceImage& result, Session& session) {
  const std::uint64_t rays = result.camera_rays + result.shadow_rays + result.bounce_rays;
  const double rate = static_cast<double>(rays) / std::max(result.seconds, 1e-9);
  const auto numbers = [](const Vec3& v) { return nlohmann::ordered_json{v.x, v.y, v.z}; };
  nlohmann::ordered_json& entry = session.result()["images"].back();
  entry["flux"] = numbers(result.flux);
  entry["flux_error"] = numbers(result.flux_error);
  entry["samples"] = result.samples;
  entry["rays"] = rays;
  entry["seconds"] = result.seconds;
  if (session.options().json) return;
  const bool unresolved = result.image.unit == "1/sr";
  const bool square = job.view.camera.projection == world::Projection::orthographic;
  fmt::print("{}: flux {:.6g} {:.6g} {:.6g} ± {:.1e} {:.1e} {:.1e} {}, {:.3g} M rays/s\n",
             job.output, result.flux.x, result.flux.y, result.flux.z, result.flux_error.x,
             result.flux_error.y, result.flux_error.z,
             square ? (unresolved ? "m^2/sr" : "W/sr") : (unresolved ? "of the Sun's" : "W/m^2"),
             1e-6 * rate);
}

bool trace_one(const Job& job, const RenderOptions& options,
               const preview::ReferenceOptions& traced, const world::World& world,
               preview::Reference& reference, Session& session) {
  preview::ReferenceOptions render = traced;
  render.truth = preview::stores_truth(*preview::image_format(job.output));
  session.step("render " + job.output);
  auto result = reference.render(world, job.view.camera, render, session.log());
  if (!result) return false;
  result->image.standard_error = std::move(result->standard_error);
  describe(job, options, *world[0].model(), result->image);
  if (!write(job, result->image, session)) return false;
  tell(job, *result, session);
  return true;
}

int render_reference(const RenderOptions& options, const world::ModelPtr& model,
                     const std::vector<Job>& jobs, Session& session) {
  const auto traced = reference_options(options, session.log());
  if (!traced) return session.finish();
  session.step("prepare " + options.input);
  preview::Reference reference;
  world::World world;
  if (!world.add("target", model, session.log())) return session.finish();
  reference.prepare(world);
  Progress progress("rendering", jobs.size());
  for (const Job& job : jobs) {
    world.set_pose(0, job.view.world_from_model);
    world.set_sun(
        {job.view.to_sun, job.view.sun_distance, job.view.sun_irradiance, options.limb_darkening});
    if (!trace_one(job, options, *traced, world, reference, session)) break;
    progress.advance();
  }
  return session.finish();
}

// An option of the other engine; nullptr: none.
const char* stray_option(const RenderOptions& options) {
  const RenderOptions none;
  if (options.reference) {
    if (options.no_shadows) return "--no-shadows";
    return options.shadow_side != none.shadow_side ? "--shadow-side" : nullptr;
  }
  if (options.until_error != none.until_error) return "--until-error";
  if (options.filter != none.filter) return "--filter";
  if (options.bounces != none.bounces) return "--bounces";
  if (options.seed != none.seed) return "--seed";
  if (options.limb_darkening != none.limb_darkening) return "--limb-darkening";
  return options.no_sun_disc ? "--no-sun-disc" : nullptr;
}

}  // namespace

int render(const RenderOptions& typed) {
  RenderOptions options = typed;
  if (options.samples == 0) options.samples = options.reference ? 8 : 1;
  Session session("render", options.common);
  DiagnosticLog& log = session.log();
  if (const char* stray = stray_option(options)) {
    log.report(Code::E0201, {},
               fmt::format("{} means nothing to --engine {}", stray,
                           options.reference ? "reference" : "gl"));
    return session.finish();
  }
  // what nobody outside sees costs a picture less than its removal
  ReadOptions read = options.read;
  read.prune = false;
  auto model = load_model(options.input, read, session);
  if (!model) return session.finish();
  const auto jobs = make_jobs(options, *model, log);
  if (!jobs) return session.finish();

  if (options.reference)
    return render_reference(options, std::make_shared<const pan::Model>(*std::move(model)), *jobs,
                            session);

  session.step("open an OpenGL context");
  auto context = preview::Context::create(*preview::context_kind_from_name(options.gl), log);
  if (!context) return session.finish();
  session.step("upload " + options.input);
  auto renderer = preview::Renderer::create(**context, *model, log);
  if (!renderer) return session.finish();
  session.result()["gl"] = {{"renderer", (*context)->renderer()},
                            {"version", (*context)->version()},
                            {"hardware", (*context)->is_hardware()}};
  Progress progress("rendering", jobs->size());
  for (const Job& job : *jobs) {
    if (!render_one(job, options, *model, *renderer, session)) break;
    progress.advance();
  }
  return session.finish();
}

}  // namespace panwright::tools
