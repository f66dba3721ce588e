#include "geometry/mesh/diffuse_flux.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/parallel.h"

namespace panwright::geometry {
namespace {

constexpr std::size_t kViews = 24;
constexpr std::size_t kSuns = 7;  // for each; the first at the viewer
constexpr double kTenth = 0.1;
constexpr std::size_t kFluxBlock = 4096;  // triangles

struct View {
  Vec3 viewer{0};
  std::array<Vec3, kSuns> suns;
};

std::array<View, kViews> views() {
  std::array<View, kViews> out;
  const double golden = kPi * (3 - std::sqrt(5.0));
  for (std::size_t i = 0; i < kViews; ++i) {
    const double z = 1 - (2 * static_cast<double>(i) + 1) / kViews;
    const double r = std::sqrt(1 - z * z);
    const det::SinCos turn = det::sincos(golden * static_cast<double>(i));
    const Vec3 v(r * turn.cos, r * turn.sin, z);
    const Vec3 x =
        glm::normalize(glm::cross(std::fabs(v.z) < 0.9 ? Vec3(0, 0, 1) : Vec3(1, 0, 0), v));
    const Vec3 y = glm::cross(v, x);
    out[i].viewer = out[i].suns[0] = v;
    for (std::size_t k = 1; k < kSuns; ++k) {
      const det::SinCos phase = det::sincos(static_cast<double>((k + 2) / 3) * kPi / 3);
      const det::SinCos around =
          det::sincos((static_cast<double>(k % 3) + 0.25 * static_cast<double>(i)) * 2 * kPi / 3);
      out[i].suns[k] = phase.cos * v + phase.sin * (around.cos * x + around.sin * y);
    }
  }
  return out;
}

using Flux = std::array<std::array<double, kSuns>, kViews>;

void add(const Mesh& mesh, const Triangle& t, const std::array<View, kViews>& all, Flux& sum) {
  const Vec3& a = mesh.positions[t[0]];
  const Vec3 cross = glm::cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a);
  const double twice = glm::length(cross);
  if (!(twice > 0)) return;
  std::array<Vec3, 3> normals;
  for (std::size_t k = 0; k < 3; ++k)
    normals[k] = mesh.normals.empty() ? cross / twice : mesh.normals[t[k]];
  for (std::size_t i = 0; i < kViews; ++i) {
    const double shown = 0.5 * glm::dot(cross, all[i].viewer);
    if (shown <= 0 && mesh.closed) continue;
    const double side = shown < 0 ? -1 : 1;
    for (std::size_t k = 0; k < kSuns; ++k) {
      double lit = 0;
      for (const Vec3& n : normals) lit += std::max(side * glm::dot(n, all[i].suns[k]), 0.0);
      sum[i][k] += side * shown * lit / 3;
    }
  }
}

Flux flux_of(const Mesh& mesh, const std::array<View, kViews>& all, const Job& job) {
  std::vector<Flux> sums((mesh.triangles.size() + kFluxBlock - 1) / kFluxBlock, Flux{});
  parallel_for(
      sums.size(),
      [&](std::size_t block) {
        const std::size_t end = std::min(mesh.triangles.size(), (block + 1) * kFluxBlock);
        for (std::size_t i = block * kFluxBlock; i < end; ++i)
          add(mesh, mesh.triangles[i], all, sums[block]);
      },
      job);
  Flux out{};
  for (const Flux& sum : sums)
    for (std::size_t i = 0; i < kViews; ++i)
      for (std::size_t k = 0; k < kSuns; ++k) out[i][k] += sum[i][k];
  return out;
}

}  // namespace

double diffuse_flux_error(const Mesh& mesh, const Mesh& other, const Job& job) {
  const std::array<View, kViews> all = views();
  const Flux first = flux_of(mesh, all, job), second = flux_of(other, all, job);
  double most = 0, largest = 0;
  for (const auto& view : first) most = std::max(most, view[0]);
  for (std::size_t i = 0; i < kViews; ++i)
    for (std::size_t k = 0; k < kSuns; ++k) {
      const double least = std::max(first[i][k], kTenth * most);
      if (least > 0) largest = std::max(largest, std::fabs(second[i][k] - first[i][k]) / least);
    }
  return largest;
}

}  // namespace panwright::geometry
