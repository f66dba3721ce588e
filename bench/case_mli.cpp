// Sheets of foil: speed and memory against closed forms of their variances.
#include <fmt/core.h>

#include <cmath>

#include "bench/bench.h"
#include "mli/sheet.h"

namespace panwright::bench::case_mli {

namespace {

using mli::Operation;
using mli::Recipe;
using mli::Sheet;

struct Job {
  std::string setting;
  std::vector<Operation> operations;
  // relative, of a sheet
  double (*error)(const Sheet&);
  const char* reference;
  double must_error = 0;
  double must = 0;  // Mcells/s on one core
};

// Of the variance of heights, against `expected`.
double variance_error(const Sheet& sheet, double expected) {
  return std::fabs(std::pow(sheet.statistics.height_rms, 2) / expected - 1);
}

// The worse of heights and slopes of random 1 and smooth 4, away from the edges.
double smoothed_error(const Sheet& sheet) {
  double height = 0, slope = 0, count = 0;
  for (std::uint32_t j = 5; j + 5 < sheet.rows; ++j)
    for (std::uint32_t i = 5; i + 5 < sheet.columns; ++i) {
      height += std::pow(sheet.at(i, j), 2);
      slope += std::pow((sheet.at(i + 1, j) - sheet.at(i - 1, j)) / 2, 2);
      ++count;
    }
  return std::max(std::fabs(3 * height / count / .02846788 - 1),
                  std::fabs(3 * slope / count / .00415317 - 1));
}

mli::Crease creases() {
  mli::Crease crease;
  crease.density = 8000;
  crease.depth = 0.002;
  crease.length = 0.02;
  crease.spread = 0.3;
  crease.tail_share = 0;
  return crease;
}

std::vector<Job> jobs() {
  using namespace mli;
  return {
      {"random 1, smooth 4",
       {Random{1}, Smooth{4}},
       smoothed_error,
       "exact variances of heights and slopes",
       0.03,
       20},
      {"random 1, smooth 64",
       {Random{1}, Smooth{64}},
       [](const Sheet& s) {
         // a wide kernel is a Gaussian: passes·2/3 is its variance along an axis
         return variance_error(s, 1.0 / 3 / (4 * kPi * 64 * 2.0 / 3));
       },
       "variance of heights, a Gaussian kernel",
       0.03},
      {"wrinkle",
       {Wrinkle{0.02, 0.002, 0.5, 3}},
       [](const Sheet& s) { return variance_error(s, 2e-6); },
       "variance of heights, one seed",
       0.1},
      {"crease",
       {creases()},
       [](const Sheet& s) {
         const mli::Crease c = creases();
         return variance_error(s, c.density * 0.375 * std::pow(c.length * c.depth, 2) / 6 *
                                      std::exp(8 * c.spread * c.spread));
       },
       "variance of heights, Campbell's theorem, one seed",
       0.1},
      {"fractal 0.7",
       {Fractal{0.7, 0.002, 0.05}},
       [](const Sheet& s) { return variance_error(s, 4e-6); },
       "variance of heights, one seed",
       0.1},
      {"crush",
       {Crush{0.02, 0.002}},
       [](const Sheet& s) { return variance_error(s, 4e-6 * 1.3125); },
       "variance of heights, one seed",
       0.1},
      {"emboss quilt",
       {Emboss{Pattern::quilt, 0.05, 0.002}},
       [](const Sheet& s) { return std::fabs(s.statistics.height_mean / (0.002 * 4 / 9) - 1); },
       "mean height",
       0.01},
      {"seam, button, taper",
       {Seam{true, 0.5, 0.04, 0.002, 0.01, 0.001}, Button{0.25, 0.005, 0.05, 0.001},
        Taper{0.05, 0.1, 0.05, 0.1}},
       [](const Sheet& s) { return std::fabs(s.at(0, 0)) / 0.002; },
       "height of the edge",
       1e-9},
  };
}

Sheet made_of(const Job& job, std::uint32_t side, std::size_t threads) {
  Recipe recipe;
  recipe.width = recipe.height = 1;
  recipe.xgrid = side - 1;
  recipe.operations = job.operations;
  DiagnosticLog log;
  auto sheet = mli::made(recipe, {}, log, {}, panwright::Job({.threads = threads, .progress = {}}));
  return sheet ? std::move(*sheet) : Sheet{};
}

// The largest resident set of a program that makes one sheet of random 1 and smooth 4.
void add_memory(Context& context, std::uint32_t side, double error) {
  const std::filesystem::path program = context.program("mli_sheets");
  double bytes = 0;
  if (program.empty() || run_program(program, {"--side", std::to_string(side)}, &bytes) != 0) {
    context.note("mli_sheets is not built: memory was not measured");
    return;
  }
  context.add({.case_name = "mli",
               .setting = fmt::format("random 1, smooth 4, {0} x {0}, memory of the process", side),
               .speed = bytes * 1e-6,
               .speed_unit = "MB",
               .error = error,
               .error_unit = "relative",
               .reference = "exact variances of heights and slopes",
               .runs = 1,
               .must = 1000,
               .must_is_least = false,
               .must_error = context.quick() ? 0 : 0.03});
}

void run(Context& context) {
  const std::uint32_t side = context.quick() ? 257 : 2049;
  const std::vector<Job> all = jobs();
  double first_error = 0;
  for (const std::size_t threads : {std::size_t{1}, std::size_t{0}}) {
    std::vector<Sheet> results(all.size());
    std::vector<Variant> variants;
    for (std::size_t i = 0; i < all.size(); ++i)
      variants.push_back({all[i].setting, [&, i] { results[i] = made_of(all[i], side, threads); }});
    const std::vector<Timing> timings = interleaved(variants, context.quick() ? 1 : 5);
    for (std::size_t i = 0; i < all.size(); ++i) {
      Row row{.case_name = "mli",
              .setting = fmt::format("{}, {} x {}, {}", all[i].setting, side, side,
                                     threads == 1 ? "one core" : "all cores"),
              .speed_unit = "Mvertices/s",
              .error = all[i].error(results[i]),
              .error_unit = "relative",
              .reference = all[i].reference,
              .must = context.quick() || threads != 1 ? 0 : all[i].must,
              .must_error = context.quick() ? 0 : all[i].must_error};
      set_rate(row, timings[i], 1e-6 * side * side);
      if (i == 0) first_error = row.error;
      context.add(row);
    }
  }
  add_memory(context, context.quick() ? 257 : 4096, first_error);
}

const bool kAdded = add_case({"mli", "sheets of foil", run});

}  // namespace

}  // namespace panwright::bench::case_mli
