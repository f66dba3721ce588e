// The sheets and forms of docs/mli-operations.md and docs/mli-forms.md: their checksums, or files
// of numpy.
//
//   mli_sheets THREADS          a line each: its name, checksums of heights and statistics, or of
//   positions mli_sheets --write FOLDER   FOLDER/NAME.npy: heights (rows, columns), row 0 at the
//   lower edge, or
//                               corners (triangles, 3, 3); metres
//   mli_sheets --side N         makes random 1, smooth 4 of N x N vertices, for bench/case_mli.cpp
#include <bit>
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include "mli/form.h"
#include "mli/levels.h"
#include "mli/sheet.h"

using namespace panwright;
using namespace panwright::mli;

namespace {

struct Named {
  const char* name;
  Recipe recipe;
  bool is_levelled = false;  // a level of detail of it is compared too
};

Crease creases(double density, double depth, double length) {
  Crease crease;
  crease.density = density;
  crease.depth = depth;
  crease.length = length;
  return crease;
}

// Half a metre square, cells of 0.8 mm.
Recipe square(std::vector<Operation> operations) {
  Recipe recipe;
  recipe.width = recipe.height = 0.5;
  recipe.xgrid = 600;
  recipe.seed = 1;
  recipe.operations = std::move(operations);
  return recipe;
}

std::vector<Named> sheets() {
  Recipe figure9;
  figure9.width = 120;
  figure9.height = 60;
  figure9.xgrid = 240;
  figure9.operations = {Random{1.0}, Smooth{4}, Constant{4.0}, Taper{5.0, 7.0, 2.5, 3.5}};
  const Operation slopes = SlopeRms{0.2};
  const std::vector<Operation> blanket = {creases(8000, 0.001, 0.02),
                                          Wrinkle{0.1, 0.0012, 0.6, 2},
                                          slopes,
                                          Constant{0.006},
                                          Seam{true, 0.36, 0.025, 0.0008, 0.012, 0.0004},
                                          Button{0.25, 0.003, 0.04, 0.0008},
                                          Taper{0.008, 0.03, 0.008, 0.03}};
  return {
      {"figure9", figure9, true},
      {"random", square({Random{0.001}, slopes})},
      {"smooth", square({Random{0.001}, Smooth{4}, slopes})},
      {"wrinkle", square({Wrinkle{0.05, 0.002, 0.5, 3}, slopes})},
      {"crease", square({creases(8000, 0.002, 0.02), slopes})},
      {"fractal", square({Fractal{0.8, 0.004}, slopes})},
      {"crush", square({Crush{0.05, 0.002}, slopes})},
      {"quilt", square({Emboss{Pattern::quilt, 0.06, 0.005}, creases(8000, 0.0003, 0.02)})},
      {"diamond", square({Emboss{Pattern::diamond, 0.02, 0.002}})},
      {"seam", square({creases(8000, 0.0004, 0.02), Seam{true, 0.25, 0.04, 0.002, 0.015, 0.0006}})},
      {"button",
       square({creases(8000, 0.0004, 0.02), Constant{0.006}, Button{0.2, 0.004, 0.06, 0.0015}})},
      {"slope_05", square({creases(8000, 0.002, 0.02), SlopeRms{0.05}})},
      {"slope_10", square({creases(8000, 0.002, 0.02), SlopeRms{0.1}})},
      {"slope_40", square({creases(8000, 0.002, 0.02), SlopeRms{0.4}})},
      {"blanket", square(blanket), true},
  };
}

struct NamedForm {
  const char* name;
  Form form;
};

// Of one sheet, 2.1 m by 1.5 m, cells of 4 mm, of 10.5 mm where compilers are compared.
std::vector<NamedForm> forms() {
  return {{"form_tube", Tube{0.25, 0.6, 0.05}},
          {"form_cone", Cone{0.3, 0.15, 0.45, 0.05}},
          {"form_disc", Disc{0.35, 0.06}},
          {"form_box", Box{{0.5, 0.4, 0.5}, 0.02}}};
}

Recipe form_recipe(std::uint32_t cells) {
  Recipe recipe;
  recipe.width = 2.1;
  recipe.height = 1.5;
  recipe.xgrid = cells;
  recipe.operations = {creases(6000, 0.003, 0.023), SlopeRms{0.16}, Constant{0.003}};
  return recipe;
}

bool write_npy(const std::string& path, const std::string& shape, std::span<const double> numbers) {
  std::string header = "{'descr': '<f8', 'fortran_order': False, 'shape': (" + shape + "), }";
  header.resize(128 - 10 - 1, ' ');
  header += '\n';
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (!file) return false;
  const unsigned char start[] = {0x93, 'N', 'U', 'M', 'P', 'Y', 1, 0, 128 - 10, 0};
  bool good = std::fwrite(start, sizeof start, 1, file) == 1;
  good = std::fwrite(header.data(), header.size(), 1, file) == 1 && good;
  good =
      std::fwrite(numbers.data(), sizeof(double), numbers.size(), file) == numbers.size() && good;
  return std::fclose(file) == 0 && good;
}

// folder: where files are written; null: nowhere, and checksums are printed
bool show_sheet(const Named& each, const char* folder, const Job& job, DiagnosticLog& log) {
  const auto sheet = made(each.recipe, {}, log, {}, job);
  if (!sheet) return false;
  if (folder)
    return write_npy(std::string(folder) + "/" + each.name + ".npy",
                     std::to_string(sheet->rows) + ", " + std::to_string(sheet->columns),
                     sheet->heights);
  const Sheet coarse = filtered(*sheet, 100, job);
  const Statistics& s = coarse.statistics;
  const double numbers[] = {s.height_rms,           s.slope_covariance.xy, s.slope_rms,
                            s.facet_slope_rms,      s.mean_normal.x,       s.mean_normal.y,
                            s.correlation_length.x, s.height_mean};
  std::printf("%s %016" PRIx64 " %016" PRIx64 " %016" PRIx64, each.name, checksum(sheet->heights),
              checksum(coarse.heights), checksum(numbers));
  // takes long, and the steps are the same for each sheet
  if (each.is_levelled)
    std::printf(" %016" PRIx64, checksum(similar(*sheet, 48, 30 * kDegree, job).sheet.heights));
  std::printf("\n");
  return true;
}

bool show_forms(const char* folder, const Job& job, DiagnosticLog& log) {
  const auto sheet = made(form_recipe(folder ? 525 : 200), {}, log, {}, job);
  if (!sheet) return false;
  for (const NamedForm& each : forms()) {
    const auto mesh = formed(*sheet, each.form, log);
    if (!mesh) return false;
    std::vector<double> corners;
    for (const geometry::Triangle& t : mesh->triangles)
      for (const std::uint32_t v : t)
        for (int k = 0; k < 3; ++k) corners.push_back(mesh->positions[v][k]);
    if (!folder)
      std::printf("%s %016" PRIx64 "\n", each.name, checksum(corners));
    else if (!write_npy(std::string(folder) + "/" + each.name + ".npy",
                        std::to_string(mesh->triangles.size()) + ", 3, 3", corners))
      return false;
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 3 && std::strcmp(argv[1], "--side") == 0) {
    Recipe recipe = square({Random{1}, Smooth{4}});
    recipe.xgrid = static_cast<std::uint32_t>(std::strtoul(argv[2], nullptr, 10)) - 1;
    DiagnosticLog log;
    return made(recipe, {}, log) ? 0 : 1;
  }
  const bool write = argc == 3 && std::strcmp(argv[1], "--write") == 0;
  if (argc != 2 && !write)
    return std::fputs("mli_sheets THREADS | --write FOLDER | --side N\n", stderr), 2;
  const Job job({.threads = write ? 0 : std::strtoul(argv[1], nullptr, 10), .progress = {}});
  DiagnosticLog log;
  bool good = true;
  for (Named each : sheets()) {
    // what compilers are compared by has fewer cells: without optimisation they take long
    if (!write && each.recipe.xgrid > 150) each.recipe.xgrid = 150;
    good = good && show_sheet(each, write ? argv[2] : nullptr, job, log);
  }
  good = good && show_forms(write ? argv[2] : nullptr, job, log);
  std::fputs(to_text(log).c_str(), stderr);
  return good ? 0 : 1;
}
