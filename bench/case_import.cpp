// Whole processes from CAD files to models and images.
#include <fmt/core.h>
#include <sys/wait.h>
#include <unistd.h>

#include <limits>
#include <vector>

#include "base/file.h"
#include "bench/bench.h"
#include "bench/cad_files.h"
#include "bench/scenes.h"
#include "pan/model.h"

namespace panwright::bench::case_import {

namespace {

namespace fs = std::filesystem;

double worst_in(const Band& band, const fs::path& path) {
  DiagnosticLog log;
  auto model = pan::Model::load(path, log);
  return model ? worst_place(band, *model) : std::numeric_limits<double>::infinity();
}

// A program of another project, when it is installed.
fs::path installed(const char* name) {
  for (const char* const folder : {"/usr/bin", "/usr/local/bin"})
    if (fs::exists(fs::path(folder) / name)) return fs::path(folder) / name;
  return {};
}

struct Job {
  std::string setting;
  fs::path program;
  std::vector<std::string> arguments;
  double must_seconds = 0;
  fs::path model;  // to hold against the band; empty: none
  bool normals = false;
};

// Writes the band in every format, in a process of its own.
bool write_files(const Context& context, const Band& band) {
  // note: the largest size that this process ever had counts towards the peaks of those it starts
  const pid_t writer = ::fork();
  if (writer == 0) {
    const bool done = !write_scratch(context, "band.wrl", band.vrml()).empty() &&
                      !write_scratch(context, "plain.glb", band.glb(false)).empty() &&
                      !write_scratch(context, "lit.glb", band.glb(true)).empty() &&
                      !write_scratch(context, "band.obj", band.obj()).empty() &&
                      !write_scratch(context, "band.stl", band.stl()).empty() &&
                      !write_scratch(context, "band.ply", band.ply()).empty();
    ::_exit(done ? 0 : 1);
  }
  int status = 1;
  return writer >= 0 && ::waitpid(writer, &status, 0) == writer && status == 0;
}

std::vector<Job> jobs_of(const Context& context, const fs::path& panwright) {
  const fs::path wrl = context.scratch() / "band.wrl";
  const fs::path plain = context.scratch() / "plain.glb";
  const fs::path lit = context.scratch() / "lit.glb";
  const auto out = [&](const char* name) { return (context.scratch() / name).string(); };
  const std::string keep = "--keep-hidden", as_is = "--no-weld";
  std::vector<Job> jobs = {
      {"vrml to pan: weld, normals, reorder",
       panwright,
       {"import", wrl.string(), keep, "-o", out("a.pan")},
       1.0,
       out("a.pan"),
       true},
      {"vrml to pan: as it is",
       panwright,
       {"import", wrl.string(), keep, as_is, "-o", out("b.pan")},
       0,
       out("b.pan"),
       true},
      {"glb to pan",
       panwright,
       {"import", lit.string(), keep, as_is, "-o", out("c.pan")},
       0.25,
       out("c.pan"),
       true},
      {"glb without normals to pan",
       panwright,
       {"import", plain.string(), keep, as_is, "-o", out("d.pan")},
       0,
       out("d.pan"),
       true},
      {"glb to pan: weld, reorder",
       panwright,
       {"import", lit.string(), keep, "-o", out("e.pan")},
       0,
       out("e.pan"),
       true},
      {"obj to pan",
       panwright,
       {"import", out("band.obj"), keep, as_is, "-o", out("g.pan")},
       0,
       out("g.pan"),
       true},
      {"stl to pan",
       panwright,
       {"import", out("band.stl"), "--up-axis", "y", keep, as_is, "-o", out("h.pan")},
       0,
       out("h.pan"),
       true},
      {"ply to pan",
       panwright,
       {"import", out("band.ply"), "--up-axis", "y", keep, as_is, "-o", out("i.pan")},
       0,
       out("i.pan"),
       true},
      {"glb to an image of 1024 x 1024",
       panwright,
       {"render", lit.string(), keep, as_is, "--fov", "40", "-o", out("f.png")},
       0.8,
       {},
       true},
  };
  const fs::path assimp = installed("assimp");
  if (!assimp.empty())
    jobs.push_back({"assimp info of the glb", assimp, {"info", lit.string()}, 0, {}, true});
  return jobs;
}

// peak: memory of the process, bytes
void add_rows(Context& context, const Band& band, const Job& job, bool ours, double peak,
              const Timing& timing) {
  if (peak == 0) return context.note(job.setting + ": the program failed");
  Row row;
  row.case_name = "import";
  row.setting =
      fmt::format("{} Mtri={:.3g}", job.setting, static_cast<double>(band.triangles()) * 1e-6);
  set_time(row, timing, 1);
  row.speed_unit = "s a process";
  row.must_is_least = false;
  if (!context.quick()) row.must = job.must_seconds;
  if (job.model.empty()) {
    // errors of images are in other cases: here their memory
    row.error = peak / band.array_bytes(job.normals);
    row.error_unit = "memory over the scene's arrays";
    row.reference = "arrays of the mesh in double";
  } else {
    row.error = worst_in(band, job.model);
    row.error_unit = "m of 1 m";
    row.reference = "the numbers written";
    row.must_error = 1e-7;  // rounding to single precision about the middle of the mesh
  }
  context.add(row);
  if (job.model.empty() || !ours) return;
  Row memory = row;
  memory.setting = fmt::format("memory of: {}", row.setting);
  memory.error = peak / band.array_bytes(job.normals);
  memory.error_unit = "memory over the scene's arrays";
  memory.reference = "arrays of the mesh in double";
  memory.must = 0;
  memory.must_error = context.quick() ? 0 : 3;
  context.add(memory);
}

void run_import(Context& context) {
  const fs::path panwright = context.program("panwright");
  if (panwright.empty()) return context.note("the program is not built: nothing to time");
  const Band band(context.quick() ? 40 : 708);
  if (!write_files(context, band)) return context.note("the files cannot be written");
  std::vector<Job> jobs = jobs_of(context, panwright);
  std::vector<Variant> variants;
  std::vector<double> peaks(jobs.size());
  for (std::size_t i = 0; i < jobs.size(); ++i)
    variants.push_back({jobs[i].setting, [&, i] {
                          double peak = 0;
                          if (run_program(jobs[i].program, jobs[i].arguments, &peak) == 0)
                            peaks[i] = std::max(peaks[i], peak);
                        }});
  auto timings = interleaved(variants, context.quick() ? 1 : 7);
  // too slow to be run in turn with the others
  const fs::path castle = installed("tovrmlx3d");
  if (!castle.empty()) {
    const std::string wrl = (context.scratch() / "band.wrl").string();
    jobs.push_back({"tovrmlx3d of the vrml", castle, {wrl}, 0, {}, true});
    peaks.push_back(0);
    timings.push_back(timed([&] { run_program(castle, {wrl}, &peaks.back()); }, 1));
  }
  for (std::size_t i = 0; i < jobs.size(); ++i)
    add_rows(context, band, jobs[i], jobs[i].program == panwright, peaks[i], timings[i]);
}

const bool kAdded =
    add_case({"import", "CAD files to models and images, whole processes", run_import});

}  // namespace

}  // namespace panwright::bench::case_import
