#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/progress.h"
#include "base/text.h"
#include "preview/context.h"
#include "preview/image.h"
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
  add("panwright.shadow_side", fmt::format("{}", options.no_shadows ? 0 : options.shadow_side));
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
  session.step("write " + job.output);
  double sync = 0;
  if (!preview::write_image(job.output, *image, job.ev, session.log(), &sync)) return false;
  session.step({});
  session.add_timing("sync to disk", sync);
  session.result()["images"].push_back({{"output", job.output},
                                        {"width", image->width},
                                        {"height", image->height},
                                        {"unit", image->unit}});
  return true;
}

}  // namespace

int render(const RenderOptions& options) {
  Session session("render", options.common);
  DiagnosticLog& log = session.log();
  const auto model = load_model(options.input, options.read, session);
  if (!model) return session.finish();
  const auto jobs = make_jobs(options, *model, log);
  if (!jobs) return session.finish();

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
