#include "bench/flip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>

#include "base/math.h"

namespace panwright::bench {
namespace {

// Rows of linear sRGB to CIE XYZ, D65.
const Mat3 kXyzFromRgb = glm::transpose(Mat3(0.4124564, 0.3575761, 0.1804375,  //
                                             0.2126729, 0.7151522, 0.0721750,  //
                                             0.0193339, 0.1191920, 0.9503041));
const Vec3 kWhite = kXyzFromRgb * Vec3(1);

// ---- colour spaces

Vec3 ycxcz_from_rgb(const Vec3& rgb) {
  const Vec3 xyz = kXyzFromRgb * rgb / kWhite;
  return {116 * xyz.y - 16, 500 * (xyz.x - xyz.y), 200 * (xyz.y - xyz.z)};
}

Vec3 rgb_from_ycxcz(const Vec3& c) {
  const double y = (c.x + 16) / 116;
  const Vec3 xyz(y + c.y / 500, y, y - c.z / 200);
  return glm::inverse(kXyzFromRgb) * (xyz * kWhite);
}

Vec3 lab_from_rgb(const Vec3& rgb) {
  const Vec3 xyz = kXyzFromRgb * rgb / kWhite;
  const auto f = [](double t) {
    const double delta = 6.0 / 29;
    return t > delta * delta * delta ? std::cbrt(t) : t / (3 * delta * delta) + 4.0 / 29;
  };
  const double y = f(xyz.y);
  return {116 * y - 16, 500 * (f(xyz.x) - y), 200 * (y - f(xyz.z))};
}

// Colours of dark places look less colourful.
Vec3 hunt(const Vec3& lab) { return {lab.x, 0.01 * lab.x * lab.y, 0.01 * lab.x * lab.z}; }

double hyab(const Vec3& a, const Vec3& b) {
  return std::fabs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z);
}

// ---- filters; outside of the image the edge repeats

using Plane = std::vector<double>;

struct Size {
  int width, height;
};

Plane filtered_along(const Plane& in, Size size, const std::vector<double>& kernel, bool rows) {
  const int radius = static_cast<int>(kernel.size() / 2);
  Plane out(in.size());
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      double sum = 0;
      for (int k = -radius; k <= radius; ++k) {
        const int px = rows ? std::clamp(x + k, 0, size.width - 1) : x;
        const int py = rows ? y : std::clamp(y + k, 0, size.height - 1);
        sum += kernel[static_cast<std::size_t>(k + radius)] *
               in[static_cast<std::size_t>(py) * static_cast<std::size_t>(size.width) +
                  static_cast<std::size_t>(px)];
      }
      out[static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width) +
          static_cast<std::size_t>(x)] = sum;
    }
  return out;
}

Plane separable(const Plane& in, Size size, const std::vector<double>& along,
                const std::vector<double>& across) {
  return filtered_along(filtered_along(in, size, along, true), size, across, false);
}

std::vector<double> kernel_of(int radius, const std::function<double(double)>& value) {
  std::vector<double> kernel;
  for (int i = -radius; i <= radius; ++i) kernel.push_back(value(i));
  return kernel;
}

void scale_to_one(std::vector<double>& kernel) {
  double sum = 0;
  for (const double value : kernel) sum += value;
  for (double& value : kernel) value /= sum;
}

// Positive weights add up to 1, negative ones to −1.
void balance(std::vector<double>& kernel) {
  double positive = 0, negative = 0;
  for (const double value : kernel) (value > 0 ? positive : negative) += value;
  for (double& value : kernel) value /= value > 0 ? positive : -negative;
}

// What the eye resolves of one opponent channel: Gaussians a √(π/b) exp(−π² x²/b), x in degrees.
struct Sensitivity {
  double a1, b1, a2, b2;
};
constexpr Sensitivity kAchromatic{1, 0.0047, 0, 1e-5};
constexpr Sensitivity kRedGreen{1, 0.0053, 0, 1e-5};
constexpr Sensitivity kBlueYellow{34.1, 0.04, 13.5, 0.025};

// The filter is a sum of two Gaussians over the plane, each of them separable.
Plane seen(const Plane& in, Size size, const Sensitivity& s, double ppd) {
  const int radius = static_cast<int>(std::ceil(3 * std::sqrt(0.04 / (2 * kPi * kPi)) * ppd));
  Plane out(in.size(), 0.0);
  double total = 0;
  std::array<std::pair<double, double>, 2> terms{{{s.a1, s.b1}, {s.a2, s.b2}}};
  for (const auto& [a, b] : terms) {
    if (a == 0) continue;
    auto kernel = kernel_of(radius, [&, width = b](double i) {
      const double x = i / ppd;
      return std::exp(-kPi * kPi * x * x / width);
    });
    double sum = 0;
    for (const double value : kernel) sum += value;
    const double weight = a * std::sqrt(kPi / b) * sum * sum;
    scale_to_one(kernel);
    const Plane part = separable(in, size, kernel, kernel);
    for (std::size_t i = 0; i < out.size(); ++i) out[i] += weight * part[i];
    total += weight;
  }
  for (double& value : out) value /= total;
  return out;
}

// ---- one image

struct PreparedImage {
  std::vector<Vec3> lab;  // filtered, with Hunt's adjustment
  Plane edges, points;    // strengths of features
};

PreparedImage prepared(const std::vector<float>& rgb, Size size, double ppd) {
  const std::size_t count = rgb.size() / 3;
  std::array<Plane, 3> planes;
  for (Plane& plane : planes) plane.resize(count);
  Plane grey(count);
  for (std::size_t i = 0; i < count; ++i) {
    Vec3 color(rgb[3 * i], rgb[3 * i + 1], rgb[3 * i + 2]);
    color = glm::clamp(color, 0.0, 1.0);
    const Vec3 opponent = ycxcz_from_rgb(color);
    for (int k = 0; k < 3; ++k) planes[static_cast<std::size_t>(k)][i] = opponent[k];
    grey[i] = (opponent.x + 16) / 116;
  }
  planes[0] = seen(planes[0], size, kAchromatic, ppd);
  planes[1] = seen(planes[1], size, kRedGreen, ppd);
  planes[2] = seen(planes[2], size, kBlueYellow, ppd);
  PreparedImage out;
  for (std::size_t i = 0; i < count; ++i)
    out.lab.push_back(hunt(lab_from_rgb(
        glm::clamp(rgb_from_ycxcz({planes[0][i], planes[1][i], planes[2][i]}), 0.0, 1.0))));

  // features as wide as the eye's peak of sensitivity, 0.082 degrees
  const double sigma = 0.5 * 0.082 * ppd;
  const int radius = static_cast<int>(std::ceil(3 * sigma));
  const auto gauss = [&](double x) { return std::exp(-x * x / (2 * sigma * sigma)); };
  auto smooth = kernel_of(radius, gauss);
  auto edge = kernel_of(radius, [&](double x) { return -x * gauss(x); });
  auto point =
      kernel_of(radius, [&](double x) { return (x * x / (sigma * sigma) - 1) * gauss(x); });
  scale_to_one(smooth);
  balance(edge);
  balance(point);
  const auto strength = [&](const std::vector<double>& kernel) {
    const Plane along = separable(grey, size, kernel, smooth);
    const Plane across = separable(grey, size, smooth, kernel);
    Plane both(count);
    for (std::size_t i = 0; i < count; ++i) both[i] = std::hypot(along[i], across[i]);
    return both;
  };
  out.edges = strength(edge);
  out.points = strength(point);
  return out;
}

}  // namespace

double mean_flip(const std::vector<float>& reference, const std::vector<float>& test,
                 std::uint32_t width, std::uint32_t height, double pixels_per_degree) {
  constexpr double kColorPower = 0.7, kFeaturePower = 0.5, kKnee = 0.4, kAtKnee = 0.95;
  const Size size{static_cast<int>(width), static_cast<int>(height)};
  const PreparedImage a = prepared(reference, size, pixels_per_degree);
  const PreparedImage b = prepared(test, size, pixels_per_degree);
  const double most = std::pow(
      hyab(hunt(lab_from_rgb(Vec3(0, 1, 0))), hunt(lab_from_rgb(Vec3(0, 0, 1)))), kColorPower);
  double sum = 0;
  for (std::size_t i = 0; i < a.lab.size(); ++i) {
    const double color = std::pow(hyab(a.lab[i], b.lab[i]), kColorPower);
    const double knee = kKnee * most;
    const double by_color = color < knee ? kAtKnee / knee * color
                                         : kAtKnee + (color - knee) / (most - knee) * (1 - kAtKnee);
    const double feature =
        std::max(std::fabs(a.edges[i] - b.edges[i]), std::fabs(a.points[i] - b.points[i]));
    const double by_feature = std::pow(feature / std::sqrt(2.0), kFeaturePower);
    sum += by_color > 0 ? std::pow(by_color, 1 - by_feature) : 0;
  }
  return sum / static_cast<double>(a.lab.size());
}

}  // namespace panwright::bench
