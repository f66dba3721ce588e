// pxn text → pan file, as whole processes.
#include <fmt/core.h>

#include <cmath>

#include "base/parallel.h"
#include "bench/bench.h"
#include "bench/scenes.h"
#include "compiler/compile.h"
#include "pan/model.h"

namespace panwright::bench::case_compile {

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

// One part of 100 k triangles, shown so many times.
std::string instances_pxn(int count) {
  return fmt::format(
      "<pangu_model ver=\"1\">\n<budget tolerance=\"0.0000235\"/>\n<repeat count=\"{}\" "
      "translate=\"3 0 0\">\n<torus radius=\"1\" tube_radius=\"0.2\"/>\n</repeat>\n"
      "</pangu_model>\n",
      count);
}

// Many instances of a part take the memory of one, in writing and in reading.
void add_instances(Context& context, const std::filesystem::path& tool) {
  double one_compile = 0, one_check = 0;
  for (const int count : {1, 1000}) {
    const std::string name = fmt::format("instances{}", count);
    const Job job{"", write_scratch(context, name + ".pxn", instances_pxn(count)),
                  context.scratch() / (name + ".pan")};
    double compiling = 0, checking = 0;
    const bool done = compile(tool, job, &compiling) == 0 &&
                      run_program(tool, {"check", job.output.string()}, &checking) == 0;
    const auto found = counted_in(job.output);
    if (!done || !found) {
      context.note("instances of a part could not be compiled");
      return;
    }
    if (count == 1) one_compile = compiling, one_check = checking;
    Row row{
        .case_name = "compile",
        .setting = fmt::format("peak memory instances={} triangles={}", count, found->triangles),
        .speed = compiling * 1e-6,
        .speed_unit = "MB",
        .error = found->worst_error,
        .error_unit = "m",
        .reference = "torus, on float32 vertices",
        .reference_error = 1e-15,
        .runs = 1,
        .must = count == 1 ? 0 : 1.2 * one_compile * 1e-6,
        .must_is_least = false,
        .must_error = 2.35e-5};
    context.add(row);
    row.setting = fmt::format("peak memory of check instances={}", count);
    row.speed = checking * 1e-6;
    row.must = count == 1 ? 0 : 1.2 * one_check * 1e-6;
    context.add(row);
  }
}

// Exact shapes to a written file, on one core.
void add_shapes(Context& context) {
  geometry::Torus torus;
  torus.tube_radius = 0.3;
  geometry::Ellipsoid ellipsoid;
  ellipsoid.radii = {1, 0.8, 0.6};
  geometry::Dish dish;
  dish.thickness = 0.01;
  geometry::Sphere sphere;
  const std::pair<geometry::Shape, double> shapes[] = {
      {sphere, 2e-6}, {torus, 2e-6}, {ellipsoid, 2e-6}, {dish, 5e-7}};
  const panwright::Job one_core({1, {}});
  for (const auto& [shape, tolerance] : shapes) {
    scene::Scene scene = sphere_scene({8, 8}, lambert_material(0.8));
    scene.shapes = {shape};
    scene.budget.tolerance = context.quick() ? 100 * tolerance : tolerance;
    compiler::Report report;
    const Timing timing = timed(
        [&] {
          DiagnosticLog log;
          const auto done =
              compiler::compile(scene, {}, context.scratch() / "shape.pan", log, one_core);
          if (done) report = *done;
        },
        context.runs());
    Row row{.case_name = "compile",
            .setting = fmt::format("one core {} triangles={}", geometry::kind_name(shape),
                                   report.triangles),
            .speed_unit = "Mtri/s",
            .error = report.worst_error,
            .error_unit = "m",
            .reference = "the exact shape, by the bound that the file stores",
            .must = context.quick() ? 0.0 : 5.0,
            .must_error = *scene.budget.tolerance};
    set_rate(row, timing, 1e-6 * static_cast<double>(report.triangles));
    context.add(row);
  }
}

void run(Context& context) {
  const std::filesystem::path tool = context.program("panwright");
  if (tool.empty()) {
    context.note("panwright is not built beside this program: no process measured");
  } else {
    // note: Linux counts what this program held when it started another, so small ones come first
    add_instances(context, tool);
    add_times(context, tool);
    add_memory(context, tool);
  }
  add_shapes(context);
}

const bool kAdded =
    add_case({"compile", "pxn text to pan file as a whole process; peak memory", run});

}  // namespace

}  // namespace panwright::bench::case_compile
