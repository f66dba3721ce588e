// How the parts of a model share its budget of flux.
#include <algorithm>
#include <cmath>
#include <variant>

#include "compiler/internal/fit.h"
#include "geometry/tessellate/tessellate.h"

namespace panwright::compiler::internal {
namespace {

using geometry::MeshShape;

constexpr double kLeastMesh = 64;   // triangles: smaller meshes stay
constexpr double kMeshPower = 0.5;  // how triangles of simplified meshes go with the error
constexpr double kMostFlux = 1;     // of a part: beyond, other terms decide
constexpr double kApart = 16;       // between the two plans
constexpr double kLeastWeight = 1e-12;

// Instances of one shape: triangles are count·error^(−power) of all of them together.
struct Group {
  double weight = 0;
  double instances = 0;
  double power = 0;
  double count = 0;
};

// Triangles of a shape whose flux may be off by a share.
double planned(const geometry::Shape& shape, double radius, double flux) {
  geometry::TessellationOptions options;
  options.max_error = std::clamp(flux * radius / kFluxFactor, 1e-60, 1e30);
  return geometry::planned_triangles(shape, options);
}

void set_power(Group& group, const geometry::Shape& shape, double flux) {
  if (const auto* mesh = std::get_if<MeshShape>(&shape)) {
    const auto triangles = static_cast<double>((*mesh)->triangles.size());
    if (triangles < kLeastMesh) return;
    group.power = kMeshPower;
    group.count = group.instances * triangles * std::sqrt(flux);
    return;
  }
  const auto radius = radius_of_curvature(shape);
  if (!radius || !(*radius > 0) || has_explicit_counts(shape)) return;
  const double fine = planned(shape, *radius, flux),
               coarse = planned(shape, *radius, kApart * flux);
  if (!(fine > coarse) || !(coarse > 0) || !std::isfinite(fine)) return;
  group.power = det::log(fine / coarse) / det::log(kApart);
  group.count = group.instances * fine * det::pow(flux, group.power);
}

// What a group may be off where a triangle costs `price`.
double error_of(const Group& group, double price) {
  if (!(group.power > 0)) return 0;
  const double weight = std::max(group.weight, kLeastWeight);
  return std::min(kMostFlux,
                  det::pow(price * group.power * group.count / weight, 1 / (group.power + 1)));
}

}  // namespace

std::vector<double> shares_of(const scene::Scene& scene, const std::vector<double>& weights) {
  std::vector<double> out(scene.instances.size(), kPartsShare);
  if (!scene.budget.flux) return out;
  const double flux = *scene.budget.flux;
  std::vector<Group> groups(scene.shapes.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    Group& group = groups[static_cast<std::size_t>(scene.instances[i].shape)];
    group.weight += weights[i];
    group.instances += 1;
  }
  for (std::size_t s = 0; s < groups.size(); ++s)
    if (groups[s].instances > 0) set_power(groups[s], scene.shapes[s], flux);
  for (const scene::Foil& foil : scene.foils)
    groups[static_cast<std::size_t>(foil.shape)].power = 0;
  const auto spent = [&](double price) {
    double sum = 0;
    for (const Group& group : groups) sum += group.weight * error_of(group, price);
    return sum;
  };
  double low = 1e-300, high = 1e300;
  for (int step = 0; step < 200; ++step) {
    const double middle = std::sqrt(low) * std::sqrt(high);
    (spent(middle) > kPartsShare * flux ? high : low) = middle;
  }
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Group& group = groups[static_cast<std::size_t>(scene.instances[i].shape)];
    if (group.power > 0) out[i] = error_of(group, low) / flux;
  }
  return out;
}

}  // namespace panwright::compiler::internal
