#include "tests/support/oracles.h"

#include <cassert>
#include <cmath>

namespace panwright::oracles {

namespace {

double largest(const Vec3& v) { return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)}); }

// A sum and its first moments.
struct Moments {
  Vec3 sum{0};
  std::array<Vec3, 3> first{};

  void add(const Vec3& value, const Vec3& place) {
    sum += value;
    for (int c = 0; c < 3; ++c) first[c] += value[c] * place;
  }
  void add(const Moments& other) {
    sum += other.sum;
    for (int c = 0; c < 3; ++c) first[c] += other.first[c];
  }
  FarField field(double error) const {
    FarField out{sum, {}, error};
    for (int c = 0; c < 3; ++c)
      if (sum[c] != 0) out.centre[c] = first[c] / sum[c];
    return out;
  }
};

struct Rule {
  std::vector<double> node;  // in [-1, 1]
  std::vector<double> weight;
};

// Newton's iteration on Legendre polynomials.
Rule gauss_legendre(int order) {
  Rule rule;
  for (int i = 0; i < order; ++i) {
    double x = std::cos(kPi * (i + 0.75) / (order + 0.5));
    double slope = 1;
    for (int step = 0; step < 100; ++step) {
      double p0 = 1;
      double p1 = x;
      for (int n = 2; n <= order; ++n) {
        const double p2 = ((2 * n - 1) * x * p1 - (n - 1) * p0) / n;
        p0 = p1;
        p1 = p2;
      }
      if (order == 1) p0 = 1;
      slope = order * (x * p1 - p0) / (x * x - 1);
      const double change = p1 / slope;
      x -= change;
      if (std::fabs(change) < 1e-16) break;
    }
    rule.node.push_back(x);
    rule.weight.push_back(2 / ((1 - x * x) * slope * slope));
  }
  return rule;
}

// In photometric longitude (from the viewer towards the Sun) and latitude.
Moments lune(const Brdf& brdf, double phase, int order) {
  const Rule rule = gauss_legendre(order);
  const Vec3 to_viewer(1, 0, 0);
  const Vec3 to_light(std::cos(phase), std::sin(phase), 0);
  const double low = phase - kPi / 2;
  const double high = kPi / 2;
  Moments moments;
  for (int i = 0; i < order; ++i) {
    const double longitude = 0.5 * (low + high) + 0.5 * (high - low) * rule.node[i];
    for (int j = 0; j < order; ++j) {
      const double latitude = 0.5 * kPi * rule.node[j];
      const Vec3 n(std::cos(latitude) * std::cos(longitude),
                   std::cos(latitude) * std::sin(longitude), std::sin(latitude));
      const double weight =
          rule.weight[i] * rule.weight[j] * 0.5 * (high - low) * 0.5 * kPi * std::cos(latitude);
      const double mu0 = glm::dot(n, to_light);
      const double mu = glm::dot(n, to_viewer);
      moments.add(weight * mu0 * mu * brdf(n, to_light, to_viewer), n);
    }
  }
  return moments;
}

struct Corners {
  Vec3 position[3];
  Vec3 normal[3];
};

// Radon's rule: seven points, exact for polynomials of degree 5.
class MicrofacetQuadrature {
 public:
  MicrofacetQuadrature(const Brdf& brdf, const Vec3& to_light, const Vec3& to_viewer)
      : brdf_(brdf), to_light_(to_light), to_viewer_(to_viewer) {}

  // The mean of f·max(0, n·l) over a part of a facet, and of that times the place.
  Moments mean(const Corners& c) const {
    static const double root = std::sqrt(15.0);
    static const double a[2] = {(6 - root) / 21, (6 + root) / 21};
    static const double w[2] = {(155 - root) / 1200, (155 + root) / 1200};
    Moments moments;
    add_point(c, 1.0 / 3, 1.0 / 3, 9.0 / 40, moments);
    for (int k = 0; k < 2; ++k) {
      add_point(c, a[k], a[k], w[k], moments);
      add_point(c, 1 - 2 * a[k], a[k], w[k], moments);
      add_point(c, a[k], 1 - 2 * a[k], w[k], moments);
    }
    return moments;
  }

  // Splits in four until halves agree. tolerance: of the mean, absolute.
  Moments refined(const Corners& c, const Moments& coarse, double tolerance, int depth,
                  double& error) const {
    const auto parts = split(c);
    std::array<Moments, 4> fine;
    Moments sum;
    for (int i = 0; i < 4; ++i) {
      fine[i] = quarter(mean(parts[i]));
      sum.add(fine[i]);
    }
    const double difference = largest(sum.sum - coarse.sum);
    if (difference <= tolerance || depth == 0) {
      error += difference;
      return sum;
    }
    Moments result;
    for (int i = 0; i < 4; ++i) {
      double part_error = 0;
      // note: a kink crosses about half of the parts, so halving the tolerance holds the total
      result.add(quarter(refined(parts[i], mean(parts[i]), 2 * tolerance, depth - 1, part_error)));
      error += 0.25 * part_error;
    }
    return result;
  }

 private:
  void add_point(const Corners& c, double u, double v, double weight, Moments& moments) const {
    const double t = 1 - u - v;
    const Vec3 n = glm::normalize(t * c.normal[0] + u * c.normal[1] + v * c.normal[2]);
    const double mu0 = glm::dot(n, to_light_);
    const Vec3 place = t * c.position[0] + u * c.position[1] + v * c.position[2];
    if (mu0 > 0) moments.add(weight * mu0 * brdf_(n, to_light_, to_viewer_), place);
  }

  static Moments quarter(Moments moments) {
    moments.sum *= 0.25;
    for (Vec3& first : moments.first) first *= 0.25;
    return moments;
  }

  // normals stay unnormalised here, so that they remain linear on the facet
  static std::array<Corners, 4> split(const Corners& c) {
    Corners middle;
    for (int k = 0; k < 3; ++k) {
      middle.position[k] = 0.5 * (c.position[k] + c.position[(k + 1) % 3]);
      middle.normal[k] = 0.5 * (c.normal[k] + c.normal[(k + 1) % 3]);
    }
    std::array<Corners, 4> parts;
    for (int k = 0; k < 3; ++k) {
      const int before = (k + 2) % 3;
      parts[k] = {{c.position[k], middle.position[k], middle.position[before]},
                  {c.normal[k], middle.normal[k], middle.normal[before]}};
    }
    parts[3] = middle;
    return parts;
  }

  const Brdf& brdf_;
  Vec3 to_light_;
  Vec3 to_viewer_;
};

// Twice the area of a facet along its normal.
Vec3 area_vector(const geometry::Mesh& mesh, const geometry::Triangle& t) {
  const Vec3& a = mesh.positions[t[0]];
  return glm::cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a);
}

}  // namespace

double lambert_sphere_intensity(double phase) {
  return 2 / (3 * kPi) * (std::sin(phase) + (kPi - phase) * std::cos(phase));
}

double lambert_sphere_photocentre(double phase) {
  return 3 * kPi / 16 * std::sin(phase) * (1 + std::cos(phase)) /
         (std::sin(phase) + (kPi - phase) * std::cos(phase));
}

double blinn_phong_sphere_intensity(double shine, double phase) {
  const double c = std::cos(0.5 * phase);
  const double s = std::sin(0.5 * phase);
  return 2 * kPi * c * c / (shine + 3) - 2 * kPi * s * s / ((shine + 1) * (shine + 3));
}

double beckmann_sphere_intensity(double slope, double phase) {
  (void)phase;  // the half vector is fixed, so the phase only decides what cuts the lobe
  const double x = 1 / slope;
  // erfcx; by its asymptotic series where exp and erfc leave the range of double
  const double scaled = x < 20 ? std::exp(x * x) * std::erfc(x)
                               : (1 - 0.5 / (x * x) + 0.75 / std::pow(x, 4) -
                                  1.875 / std::pow(x, 6) + 6.5625 / std::pow(x, 8)) /
                                     (x * std::sqrt(kPi));
  return 0.25 * (1 + 0.5 * std::sqrt(kPi) * slope * scaled);
}

std::optional<double> seed_lobe_intensity(double phase_deg) {
  static constexpr double kTable[] = {.010111275, .010131691, .010496167,
                                      .012699648, .022508200, .058747099};
  const double place = phase_deg / 30;
  if (place < 0 || place > 5 || place != std::floor(place)) return std::nullopt;
  return kTable[static_cast<int>(place)];
}

Vec3 seed_lobe(const Vec3& normal, const Vec3& to_light, const Vec3& to_viewer) {
  const double nl = glm::dot(normal, to_light);
  const double nv = std::max(0.0, glm::dot(normal, to_viewer));
  if (nl <= 0) return Vec3(0);
  const Vec3 h = glm::normalize(to_light + to_viewer);
  const double nh = glm::dot(normal, h);
  const double vh = glm::dot(to_viewer, h);
  if (nh <= 0) return Vec3(0);
  const double m2 = 0.15 * 0.15;
  const double tan2 = (1 - nh * nh) / (nh * nh);
  const double d = std::exp(-tan2 / m2) / (kPi * m2 * nh * nh * nh * nh);
  // G/(4 nl nv) without a division by the smaller cosine
  const double larger = std::max(nl, nv);
  const double smaller = std::min(nl, nv);
  const double shadowed = nh / (2 * vh * larger);
  const double visibility =
      4 * larger * smaller * shadowed < 1 ? shadowed : 1 / (4 * larger * smaller);
  const double g = std::sqrt(1.5 * 1.5 + vh * vh - 1);
  const double r = (g - vh) / (g + vh);
  const double s = (vh * (g + vh) - 1) / (vh * (g - vh) + 1);
  return Vec3(0.5 * r * r * (1 + s * s) * d * visibility);
}

FarField sphere_sum(const Brdf& brdf, double phase, int order) {
  const Moments fine = lune(brdf, phase, order);
  const Moments coarse = lune(brdf, phase, std::max(1, order / 2));
  return fine.field(largest(fine.sum - coarse.sum));
}

FarField facet_sum(const geometry::Mesh& mesh, const Brdf& brdf, const Vec3& to_light,
                   const Vec3& to_viewer) {
  Moments total;
  for (const geometry::Triangle& t : mesh.triangles) {
    const Vec3 area = area_vector(mesh, t);
    const double length = glm::length(area);
    if (!(length > 0)) continue;
    const Vec3 n = area / length;
    const double mu0 = glm::dot(n, to_light);
    const double mu = glm::dot(n, to_viewer);
    if (mu0 <= 0 || mu <= 0) continue;
    const Vec3 centroid =
        (mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]) / 3.0;
    total.add(0.5 * length * mu0 * mu * brdf(n, to_light, to_viewer), centroid);
  }
  return total.field(0);
}

FarField smooth_sum(const geometry::Mesh& mesh, const Brdf& brdf, const Vec3& to_light,
                    const Vec3& to_viewer, double tolerance) {
  assert(mesh.normals.size() == mesh.positions.size());
  const MicrofacetQuadrature quadrature(brdf, to_light, to_viewer);
  struct Seen {
    Corners corners;
    double projected;  // m²
    Moments coarse;
  };
  std::vector<Seen> seen;
  double all_projected = 0;
  Vec3 estimate(0);
  for (const geometry::Triangle& t : mesh.triangles) {
    const double projected = 0.5 * glm::dot(area_vector(mesh, t), to_viewer);
    if (!(projected > 0)) continue;
    Corners c;
    for (int k = 0; k < 3; ++k) {
      c.position[k] = mesh.positions[t[k]];
      c.normal[k] = mesh.normals[t[k]];
    }
    seen.push_back({c, projected, quadrature.mean(c)});
    all_projected += projected;
    estimate += projected * seen.back().coarse.sum;
  }
  if (seen.empty()) return {};
  // the mean may be off by this on every facet
  const double allowed = tolerance * largest(estimate) / all_projected;
  Moments total;
  double error = 0;
  for (const Seen& facet : seen) {
    double microfacet_error = 0;
    Moments moments =
        quadrature.refined(facet.corners, facet.coarse, allowed, 10, microfacet_error);
    moments.sum *= facet.projected;
    for (Vec3& first : moments.first) first *= facet.projected;
    total.add(moments);
    error += facet.projected * microfacet_error;
  }
  return total.field(error);
}

}  // namespace panwright::oracles
