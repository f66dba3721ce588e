// pxn text → pan file, as whole processes.
#include <fmt/format.h>

#include <cmath>

#include "bench/bench.h"
#include "bench/scenes.h"
#include "pan/model.h"

namespace panwright::bench {

namespace {

struct Job {
  std::string setting;
  std::filesystem::path input;
  std::filesystem::path output;
};

int compile(const std::filesystem::path& tool, const Job& job, double* peak_bytes = nullptr) {
  return run_program(tool, {"compile", job.input.string(), "-o", job.output.string(), "--quiet"},
                     peak_bytes);
}

struct Counted {
  double worst_error = 0;  // metres
  std::uint64_t triangles = 0;
  double bytes = 0;
};

std::optional<Counted> counted_in(const std::filesystem::path& path) {
  DiagnosticLog log;
  const auto model = pan::Model::load(path, log);
  if (!model) return std::nullopt;
  Counted out;
  out.bytes = static_cast<double>(model->bytes().size());
  for (const auto& mesh : model->meshes()) out.worst_error = std::max(out.worst_error, mesh.error);
  for (const auto& instance : model->instances())
    out.triangles += model->meshes()[instance.mesh].triangle_count;
  return out;
}

void add_times(Context& context, const std::filesystem::path& tool) {
  constexpr int kSpheres = 1667;  // six elements each: 10,002
  const Job figure8{"figure8.pxn", context.source("examples/paper/figure8.pxn"),
                    context.scratch() / "figure8.pan"};
  const Job many{"elements=10002", write_scratch(context, "many.pxn", many_spheres_pxn(kSpheres)),
                 context.scratch() / "many.pan"};
  for (const Job* job : {&figure8, &many}) {
    if (job->input.empty() || compile(tool, *job) != 0) {
      context.note(fmt::format("{}: could not be compiled", job->setting));
      return;
    }
  }
  const std::vector<Timing> timings =
      interleaved({{figure8.setting, [&] { compile(tool, figure8); }},
                   {many.setting, [&] { compile(tool, many); }}},
                  context.quick() ? 3 : 31);
  if (const auto found = counted_in(figure8.output)) {
    Row row{.case_name = "compile",
            .setting = "process figure8.pxn",
            .speed_unit = "ms",
            .error = found->worst_error,
            .error_unit = "m",
            .reference = "sphere of radius 1 m, on float32 vertices",
            .reference_error = 1e-15,
            .must = 60,
            .must_is_least = false,
            .must_error = 1.494e-3};
    set_time(row, timings[0], 1e3);
    context.add(row);
  }
  if (const auto found = counted_in(many.output)) {
    const double expected = kSpheres * 2.0 * 12 * 7;
    Row row{.case_name = "compile",
            .setting = "process elements=10002",
            .speed_unit = "ms",
            .error = std::fabs(static_cast<double>(found->triangles) - expected),
            .error_unit = "triangles",
            .reference = "2·quads·(rings − 1) for each sphere",
            .must = 100,
            .must_is_least = false,
            .must_error = 0.5};
    set_time(row, timings[1], 1e3);
    context.add(row);
  }
}

void add_memory(Context& context, const std::filesystem::path& tool) {
  for (const std::uint32_t side : {1000u, 2237u}) {
    if (context.quick() && side > 1000) continue;
    const Job job{"", write_scratch(context, "large.pxn", sphere_pxn({side, side})),
                  context.scratch() / "large.pan"};
    double peak = 0;
    const Timing timing = timed(
        [&] {
          double bytes = 0;
          if (compile(tool, job, &bytes) == 0) peak = std::max(peak, bytes);
        },
        3);
    const auto found = counted_in(job.output);
    if (!found || peak == 0) {
      context.note("a large sphere could not be compiled");
      continue;
    }
    Row memory{.case_name = "compile",
               .setting = fmt::format("peak memory triangles={} output={:.0f} MB", found->triangles,
                                      found->bytes * 1e-6),
               .speed = peak * 1e-6,
               .speed_unit = "MB",
               .error = found->worst_error,
               .error_unit = "m",
               .reference = "sphere of radius 1 m, on float32 vertices",
               .reference_error = 1e-15,
               .runs = timing.runs,
               .must = 3e-6 * found->bytes + 100,
               .must_is_least = false};
    context.add(memory);
    Row rate = memory;
    rate.setting = fmt::format("process triangles={}", found->triangles);
    rate.speed_unit = "Mtri/s";
    rate.must = 0;
    set_rate(rate, timing, 1e-6 * static_cast<double>(found->triangles));
    context.add(rate);
  }
}

void run(Context& context) {
  const std::filesystem::path tool = context.program("panwright");
  if (tool.empty()) {
    context.note("panwright is not built beside this program: nothing measured");
    return;
  }
  add_times(context, tool);
  add_memory(context, tool);
}

const bool kAdded =
    add_case({"compile", "pxn text to pan file as a whole process; peak memory", run});

}  // namespace

}  // namespace panwright::bench
