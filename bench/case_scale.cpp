// Large models, and models that were compiled before: as whole processes.
#include <fmt/core.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

#include "base/clock.h"
#include "base/file.h"
#include "base/hash.h"
#include "bench/bench.h"
#include "bench/cad_files.h"
#include "bench/scenes.h"
#include "pan/model.h"

namespace panwright::bench::case_scale {

namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

// Where the programs of this case keep what took long: none, or a folder of the case.
void use_cache(const std::string& folder) { setenv("PANWRIGHT_CACHE", folder.c_str(), 1); }

Hash128 hash_of_file(const fs::path& path) {
  DiagnosticLog log;
  const auto file = MappedFile::open(path, log);
  return file ? hash128(file->bytes()) : Hash128{};
}

struct Model {
  std::string name;
  Words first;    // what compiles it; -o FILE is added
  Words changed;  // the same with one part that is another; empty: none
  double most_ratio = 0;
  double most_changed = 0;
};

// Compiles once without anything kept, then again; then a changed model, and that again.
void run_again(Context& context, const fs::path& tool, const Model& model) {
  const fs::path cache = context.scratch() / "cache", output = context.scratch() / "again.pan";
  const auto words = [&](Words out) {
    for (const char* word : {"-o", output.c_str(), "--quiet"}) out.emplace_back(word);
    return out;
  };
  bool good = true;
  const auto time_of = [&](const Words& command) {
    return timed([&] { good = good && run_program(tool, words(command)) == 0; }, 1).median;
  };
  // note: timed() runs once more before; what is to be timed once is run by hand
  const auto once = [&](const Words& command) {
    const auto start = std::chrono::steady_clock::now();
    good = good && run_program(tool, words(command)) == 0;
    return seconds_since(start);
  };
  const auto plain_hash = [&](const Words& command) {
    Words plain = command;
    plain.emplace_back("--no-cache");
    once(plain);
    return hash_of_file(output);
  };
  use_cache(cache.string());
  const Hash128 plain = plain_hash(model.first);  // warms the file cache, too
  std::error_code ignored;
  fs::remove_all(cache, ignored);
  const double first = once(model.first);
  int different = hash_of_file(output) != plain;
  const double again = time_of(model.first);
  different += hash_of_file(output) != plain;
  const auto add = [&](const std::string& what, double speed, const char* unit, double must) {
    context.add({.case_name = "scale",
                 .setting = fmt::format("{} {}", model.name, what),
                 .speed = speed,
                 .speed_unit = unit,
                 .error = static_cast<double>(different),
                 .error_unit = "pan files with other bytes",
                 .reference = "the same with --no-cache",
                 .runs = 1,
                 .must = context.quick() ? 0 : must,
                 .must_is_least = false,
                 .must_error = 0.5});
  };
  double changed = 0;
  if (!model.changed.empty()) {
    changed = once(model.changed);
    const Hash128 with = hash_of_file(output);
    different += with != plain_hash(model.changed);
  }
  use_cache("off");
  if (!good) {
    context.note(model.name + " could not be compiled");
    return;
  }
  add("first", first, "s", 0);
  add("unchanged", again / first, "of the first", model.most_ratio);
  if (!model.changed.empty())
    add("one part changed", changed / first, "of the first", model.most_changed);
}

// Spheres of different radii, each its own mesh of 100,000 triangles.
std::string large_scene_pxn(std::uint32_t spheres, double first_radius) {
  return fmt::format(
      "<pangu_model ver=\"1\">\n<repeat count=\"{}\" var=\"i\">\n"
      "<sphere radius=\"{{{} + i/1000}}\" rings=\"201\" quads=\"250\" "
      "translate=\"{{3*mod(i, 25)}} {{3*floor(i/25)}} 0\"/>\n</repeat>\n</pangu_model>\n",
      spheres, first_radius);
}

void add_large(Context& context, const fs::path& tool, const std::string& name, const Words& words,
               double triangles) {
  const fs::path output = context.scratch() / "large.pan";
  Words all = words;
  for (const char* word : {"-o", output.c_str(), "--quiet"}) all.emplace_back(word);
  double peak = 0;
  const auto start = std::chrono::steady_clock::now();
  const bool good = run_program(tool, all, &peak) == 0;
  const double seconds = seconds_since(start);
  double found = 0, bytes = 0;
  {
    DiagnosticLog log;
    const auto model = pan::Model::open(output, log);
    if (!good || !model) {
      context.note(name + " could not be compiled");
      return;
    }
    bytes = static_cast<double>(model->bytes().size());
    for (const auto& mesh : model->meshes()) found += mesh.triangle_count;
  }
  Row row{
      .case_name = "scale",
      .setting = fmt::format("{} triangles={:.0f} output={:.0f} MB", name, triangles, bytes * 1e-6),
      .speed = seconds,
      .speed_unit = "s",
      .error = std::abs(found - triangles),
      .error_unit = "triangles",
      .reference = "those that were written",
      .runs = 1,
      .must_is_least = false,
      .must_error = 0.5};
  context.add(row);
  row.setting += ", peak memory";
  row.speed = peak * 1e-6;
  row.speed_unit = "MB";
  row.must = 4000;
  context.add(row);
}

void run(Context& context) {
  const fs::path tool = context.program("panwright");
  if (tool.empty()) {
    context.note("panwright is not built beside this program: no process measured");
    return;
  }
  use_cache("off");
  // note: Linux counts what this program held when it started another, so the large ones come first
  const std::uint32_t spheres = context.quick() ? 10 : 500;
  const fs::path scene = write_scratch(context, "large.pxn", large_scene_pxn(spheres, 1));
  add_large(context, tool, "distinct spheres", {"compile", scene.string()}, 1e5 * spheres);
  {
    const Band band(context.quick() ? 200 : 1500);
    const fs::path file = write_scratch(context, "large.glb", band.glb(true));
    add_large(context, tool, "one imported mesh",
              {"import", file.string(), "--units", "m", "--keep-hidden", "--max-triangles", "2e8"},
              static_cast<double>(band.triangles()));
  }
  run_again(
      context, tool,
      {.name = "10 spheres of 100,000 triangles",
       .first = {"compile", write_scratch(context, "ten.pxn", large_scene_pxn(10, 1)).string()},
       .changed = {},
       .most_ratio = 0});
  const std::string servicer = context.source("examples/servicer/servicer.pxn").string();
  run_again(context, tool,
            {.name = "servicer with foil",
             .first = {"compile", servicer},
             .changed = {"compile", servicer, "-D", "dish_diameter=1.2m"},
             .most_ratio = 0.1});
  const Words options[] = {{}, {"--mesh-levels"}};
  const char* const files[] = {"iss-draco-webp", "jwst-draco-webp"};
  for (std::size_t i = 0; i < (context.quick() ? 0 : 2); ++i) {
    const fs::path file =
        context.source(fmt::format("../shared/data/spacecraft-gltf/{}.glb", files[i]));
    if (file.empty()) {
      context.note(fmt::format("{} is not at hand", files[i]));
      continue;
    }
    Words words{"import", file.string()};
    words.insert(words.end(), options[i].begin(), options[i].end());
    run_again(context, tool,
              {.name = fmt::format("{}{}", files[i], i == 0 ? "" : " --mesh-levels"),
               .first = words,
               .changed = {},
               .most_ratio = 0.1});
  }
}

const bool kAdded =
    add_case({"scale", "50 million triangles; models that were compiled before", run});

}  // namespace

}  // namespace panwright::bench::case_scale
