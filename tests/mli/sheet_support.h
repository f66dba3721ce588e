// Sheets for tests.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "mli/sheet.h"

namespace panwright::mli::testing {

inline Recipe recipe(double width, double height, std::uint32_t xgrid,
                     std::vector<Operation> operations, std::uint32_t seed = 0) {
  Recipe out;
  out.width = width;
  out.height = height;
  out.xgrid = xgrid;
  out.seed = seed;
  out.operations = std::move(operations);
  return out;
}

// Makes a sheet, and expects success.
inline Sheet sheet_of(const Recipe& recipe, std::uint32_t cells = 0, const Job& job = {}) {
  DiagnosticLog log;
  auto sheet = made(recipe, {cells}, log, {}, job);
  EXPECT_TRUE(sheet.ok()) << to_text(log);
  return sheet ? std::move(*sheet) : Sheet{};
}

// Returns a recipe with every operation.
inline Recipe everything(std::uint32_t seed = 1) {
  Crease crease;
  crease.density = 2000;
  crease.depth = 0.002;
  crease.length = 0.03;
  return recipe(0.5, 0.3, 301,
                {Random{1e-4}, Smooth{11}, crease, Crush{0.05, 4e-4}, Wrinkle{0.04, 5e-4, 0.7, 3},
                 Fractal{0.7, 3e-4, 0.1}, Emboss{Pattern::quilt, 0.05, 1e-3},
                 Emboss{Pattern::diamond, 0.011, 1e-4}, Seam{true, 0.1, 0.02, 5e-4, 0.01, 2e-4},
                 SlopeRms{0.15}, Constant{0.004}, Button{0.1, 0.003, 0.03, 3e-4},
                 Taper{0.01, 0.03, 0.01, 0.03}},
                seed);
}

}  // namespace panwright::mli::testing
