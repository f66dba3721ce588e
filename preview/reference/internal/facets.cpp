#include "preview/reference/internal/facets.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace panwright::preview::reference {

namespace {

// Slopes of variance 1, their weights.
struct SlopePlace {
  double s, t, weight;
};
constexpr double kRoot2 = 1.41421356237309504880, kRoot3 = 1.73205080756887729353;
constexpr SlopePlace kOne[] = {{0, 0, 1}};
constexpr SlopePlace kThree[] = {{kRoot2, 0, 1.0 / 3},
                                 {-kRoot2 / 2, kRoot2* kRoot3 / 2, 1.0 / 3},
                                 {-kRoot2 / 2, -kRoot2* kRoot3 / 2, 1.0 / 3}};
constexpr SlopePlace kSeven[] = {{0, 0, 1.0 / 2},        {2, 0, 1.0 / 12},  {1, kRoot3, 1.0 / 12},
                                 {-1, kRoot3, 1.0 / 12}, {-2, 0, 1.0 / 12}, {-1, -kRoot3, 1.0 / 12},
                                 {1, -kRoot3, 1.0 / 12}};

std::span<const SlopePlace> places_of(double variance) {
  constexpr double kFlat = 2e-4, kGentle = 0.015;
  if (variance < kFlat) return kOne;
  if (variance < kGentle) return kThree;
  return kSeven;
}

}  // namespace

std::optional<Facets> facets_of(const terrain::GroundRelief& relief, const Vec3& to_viewer) {
  Facets out;
  // of two independent slopes of variance 1 these are the relief's
  const double a = std::sqrt(std::max(relief.pp, 0.0));
  const double b = a > 0 ? relief.pq / a : 0;
  const double c = std::sqrt(std::max(relief.qq - b * b, 0.0));
  double sum = 0;
  for (const SlopePlace& place : places_of(relief.pp + relief.qq)) {
    // its length is the facet's area over that of its place on the map
    const Vec3 n = relief.up - (relief.p + a * place.s) * relief.right -
                   (relief.q + b * place.s + c * place.t) * relief.down;
    const double seen = place.weight * glm::dot(n, to_viewer);
    if (!(seen > 0)) continue;
    out.weights[out.count] = seen;
    out.normals[out.count++] = glm::normalize(n);
    sum += seen;
  }
  if (out.count == 0) return {};
  for (std::size_t k = 0; k < out.count; ++k) out.weights[k] /= sum;
  return out;
}

}  // namespace panwright::preview::reference
