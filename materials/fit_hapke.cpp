// H of one albedo as a few coefficients.
#include <algorithm>
#include <cmath>

#include "base/math.h"
#include "materials/hapke_h.h"
#include "materials/internal/fits.h"

namespace panwright::materials {
namespace {

constexpr std::size_t kTerms = 8;
constexpr std::size_t kNodes = 64;

using Row = std::array<double, kTerms>;

// x·(1, x, x², x³, and the same times ln(1 + 1/x)): what 1 − 1/H is a sum of.
Row terms(double x) {
  const double log = det::log((1 + x) / x);
  Row row;
  double power = x;
  for (std::size_t k = 0; k < kTerms / 2; ++k, power *= x) {
    row[k] = power;
    row[k + kTerms / 2] = power * log;
  }
  return row;
}

// Least squares by Householder's reflections. rows: as many as values, at least kTerms
Row solved_rows(std::vector<Row> rows, std::vector<double> values) {
  Row diagonal{};
  for (std::size_t c = 0; c < kTerms; ++c) {
    double norm = 0;
    for (std::size_t r = c; r < rows.size(); ++r) norm += rows[r][c] * rows[r][c];
    norm = std::sqrt(norm);
    if (rows[c][c] > 0) norm = -norm;
    diagonal[c] = norm;
    if (norm == 0) continue;
    rows[c][c] -= norm;
    const double half = -norm * rows[c][c];  // half the square of the reflector
    const auto reflect = [&](auto&& entry) {
      double product = 0;
      for (std::size_t r = c; r < rows.size(); ++r) product += rows[r][c] * entry(r);
      for (std::size_t r = c; r < rows.size(); ++r) entry(r) -= product / half * rows[r][c];
    };
    for (std::size_t k = c + 1; k < kTerms; ++k)
      reflect([&, k](std::size_t r) -> double& { return rows[r][k]; });
    reflect([&](std::size_t r) -> double& { return values[r]; });
  }
  Row result{};
  for (std::size_t c = kTerms; c-- > 0;) {
    double value = values[c];
    for (std::size_t k = c + 1; k < kTerms; ++k) value -= rows[c][k] * result[k];
    result[c] = diagonal[c] == 0 ? 0 : value / diagonal[c];
  }
  return result;
}

double fitted_value(const Row& coefficients, double x) {
  const Row row = terms(x);
  double sum = 0;
  for (std::size_t k = 0; k < kTerms; ++k) sum += coefficients[k] * row[k];
  return 1 / (1 - sum);
}

}  // namespace

HFit hapke_h_fit(double w) {
  HFit fit;
  if (!(w > 0)) return fit;
  const HapkeH exact(w);
  std::vector<Row> rows;
  std::vector<double> values;
  // Chebyshev's nodes of √x; weighted with H, so that residuals are relative errors of it
  for (std::size_t i = 0; i < kNodes; ++i) {
    const double root = 0.5 - 0.5 * det::cos(kPi * (static_cast<double>(i) + 0.5) / kNodes);
    const double h = exact(root * root);
    Row row = terms(root * root);
    for (double& term : row) term *= h;
    rows.push_back(row);
    values.push_back(h - 1);
  }
  fit.coefficients = solved_rows(std::move(rows), std::move(values));
  for (std::size_t i = 1; i <= 2 * kNodes; ++i) {
    const double root = static_cast<double>(i) / (2 * kNodes);
    const double x = root * root;
    fit.error = std::max(fit.error, std::fabs(fitted_value(fit.coefficients, x) / exact(x) - 1));
  }
  return fit;
}

HapkeHCorrection::HapkeHCorrection(double w, const std::array<double, 8>& coefficients) {
  const HapkeH exact(w);
  for (int i = -1; i <= kSteps + 1; ++i) {
    const double root = static_cast<double>(std::clamp(i, 0, kSteps)) / kSteps;
    const double x = std::max(root * root * root * root, 1e-30);
    ratios_.push_back(exact(x) / fitted_value(coefficients, x));
  }
  // beyond the ends as cubics go on
  const std::size_t last = ratios_.size() - 1;
  ratios_[0] = 3 * (ratios_[1] - ratios_[2]) + ratios_[3];
  ratios_[last] = 3 * (ratios_[last - 1] - ratios_[last - 2]) + ratios_[last - 3];
}

void fit_hapke(Material& material) {
  const auto* hapke = std::get_if<Hapke>(&material.diffuse_brdf);
  if (hapke == nullptr) return;
  const HFit fit = hapke_h_fit(hapke->w);
  material.fits.hapke_h = fit.coefficients;
  material.fits.error = std::max(material.fits.error, fit.error);
}

}  // namespace panwright::materials
