#include "mli/sheet.h"

#include <fmt/core.h>

#include <bit>
#include <cmath>

#include "mli/internal/grid.h"

namespace panwright::mli {
namespace {

// Reports E7001 where the sheet is level.
bool scale_slopes(const SlopeRms& wanted, const Grid& grid, const SourceSpan& where,
                  DiagnosticLog& log, const Job& job) {
  const double slope = slope_rms(*grid.heights, grid.columns, {grid.cell, grid.cell}, job);
  if (!(slope > 0) && wanted.slope > 0) {
    log.report(Code("E7001"), where,
               fmt::format("operation {}, slope_rms: the sheet is flat here, expected an earlier "
                           "operation that makes wrinkles",
                           grid.index + 1));
    return false;
  }
  const double factor = slope > 0 ? wanted.slope / slope : 0;
  for_bands(grid, job, [&](std::size_t first, std::size_t end) {
    for (double* h = grid.row(first); h != grid.row(end); ++h) *h *= factor;
  });
  return true;
}

bool apply_all(const Recipe& recipe, Grid grid, DiagnosticLog& log, const RecipePlaces& places,
               const Job& job) {
  if (recipe.operations.empty()) return true;
  Phase phase(job, "making foil", recipe.operations.size());
  for (const Operation& operation : recipe.operations) {
    if (const auto* slope = std::get_if<SlopeRms>(&operation)) {
      const bool placed = grid.index < places.operations.size();
      if (!scale_slopes(*slope, grid, placed ? places.operations[grid.index] : places.recipe, log,
                        job))
        return false;
    } else {
      std::visit(
          [&](const auto& one) {
            if constexpr (!std::is_same_v<std::decay_t<decltype(one)>, SlopeRms>)
              apply(one, grid, job);
          },
          operation);
    }
    ++grid.index;
    phase.advance();
  }
  return true;
}

}  // namespace

Result<Sheet> made(const Recipe& recipe, const SheetOptions& options, DiagnosticLog& log,
                   const RecipePlaces& places, const Job& job) {
  if (!check(recipe, log, places)) return failed;
  return run_job(job, log, [&]() -> Result<Sheet> {
    Sheet sheet;
    sheet.columns = recipe.xgrid + 1;
    sheet.rows = static_cast<std::uint32_t>(recipe.ygrid()) + 1;
    sheet.spacing = {recipe.cell(), recipe.cell()};
    sheet.heights.resize(std::size_t{sheet.columns} * sheet.rows);
    Grid grid;
    grid.columns = sheet.columns;
    grid.rows = sheet.rows;
    grid.cell = recipe.cell();
    grid.seed = recipe.seed;
    grid.heights = &sheet.heights;
    if (!apply_all(recipe, grid, log, places, job)) return failed;
    sheet.statistics = measured(sheet.heights, sheet.columns, sheet.spacing, job);
    if (options.cells == 0 || options.cells >= recipe.xgrid) return sheet;
    return filtered(sheet, options.cells, job);
  });
}

std::uint64_t checksum(std::span<const double> numbers) {
  std::uint64_t sum = 14695981039346656037u;
  for (const double h : numbers) {
    sum = (sum ^ std::bit_cast<std::uint64_t>(h)) * 1099511628211u;
    sum ^= sum >> 32;  // a product keeps what differs in the upper bits there
  }
  return sum;
}

}  // namespace panwright::mli
