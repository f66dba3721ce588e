#include "sensor/psf.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "sensor/internal/fourier.h"

namespace panwright::sensor {

namespace {

// Bessel function J1: the mean of cos(τ − x sin τ). The trapezoid rule is exact to the last digits
// with more points than the argument.
double bessel_j1(double x) {
  const int points = 32 + static_cast<int>(std::ceil(std::fabs(x)));
  double sum = 0;
  for (int k = 0; k < points; ++k) {
    const double t = 2 * kPi * (k + 0.5) / points;
    sum += det::cos(t - x * det::sin(t));
  }
  return sum / points;
}

double sinc(double x) {
  if (std::fabs(x) < 1e-8) return 1;
  return det::sin(kPi * x) / (kPi * x);
}

// Values at 0, step, 2·step, … between which it is nearly linear.
template <class Function>
class Table {
 public:
  static constexpr std::size_t kSteps = 1 << 14;
  Table(double most, const Function& function) : scale_(kSteps / most) {
    for (std::size_t k = 0; k <= kSteps + 1; ++k)
      values_.push_back(function(static_cast<double>(k) / scale_));
  }
  double operator()(double at) const {
    const double place = std::min(at * scale_, static_cast<double>(kSteps));
    const auto k = static_cast<std::size_t>(place);
    const double part = place - static_cast<double>(k);
    return values_[k] + part * (values_[k + 1] - values_[k]);
  }

 private:
  double scale_;
  std::vector<double> values_;
};

// Frequency of an index, in cycles per step.
double frequency_of(std::size_t index, std::size_t side) {
  const double n = static_cast<double>(side);
  const double k = static_cast<double>(index);
  return (2 * index < side ? k : k - n) / n;
}

}  // namespace

double mtf_of_pixel(double frequency) { return sinc(frequency); }

double mtf_of_gaussian(double frequency, double rms_px) {
  return det::exp(-2 * kPi * kPi * rms_px * rms_px * frequency * frequency);
}

double mtf_of_diffraction(double frequency, double airy_px) {
  const double u = std::fabs(frequency) * airy_px;
  if (u >= 1) return 0;
  return 2 / kPi * (det::acos(u) - u * std::sqrt(1 - u * u));
}

double mtf_of_defocus(double frequency, double diameter_px) {
  const double x = kPi * diameter_px * std::fabs(frequency);
  return x < 1e-6 ? 1 : 2 * bessel_j1(x) / x;
}

double mtf_of_motion(double frequency, double length_px) { return sinc(length_px * frequency); }

double mtf_of_optics(const Optics& optics, double airy_px, double frequency) {
  double out = mtf_of_gaussian(frequency, optics.gaussian_px());
  if (optics.diffraction) out *= mtf_of_diffraction(frequency, airy_px);
  if (optics.defocus_px > 0) out *= mtf_of_defocus(frequency, optics.defocus_px);
  return out;
}

// 2 π r ∫ MTF(f) J1(2 π f r) df: the transform of a disc.
double encircled_energy(const Optics& optics, double airy_px, double radius_px) {
  if (!(radius_px > 0)) return 0;
  const double sigma = optics.gaussian_px();
  double end = 1e9;
  if (sigma > 0) end = std::min(end, 1.4 / sigma);
  if (optics.diffraction) end = std::min(end, 1 / airy_px);
  if (optics.defocus_px > 0) end = std::min(end, 60 / optics.defocus_px);
  if (end == 1e9) return 1;
  const int steps = 500 + static_cast<int>(std::min(20 * end * radius_px, 1e5));
  const double step = end / steps;
  double sum = 0;
  for (int k = 0; k < steps; ++k) {
    const double f = (k + 0.5) * step;
    sum += mtf_of_optics(optics, airy_px, f) * bessel_j1(2 * kPi * f * radius_px);
  }
  return 2 * kPi * radius_px * step * sum;
}

// Of what the renderer leaves to do, at the frequencies of a plane.
Blur::Plane Blur::transfer(const Optics& optics, double airy_px, std::size_t side,
                           bool sharpens) const {
  const double fine = fine_;
  const Table radial(0.7072 * fine, [&](double f) { return mtf_of_optics(optics, airy_px, f); });
  Plane plane(side * side);
  for (std::size_t y = 0; y < side; ++y)
    for (std::size_t x = 0; x < side; ++x) {
      const double u = frequency_of(x, side), v = frequency_of(y, side);
      const double f = std::sqrt(u * u + v * v);
      plane[y * side + x] = {radial(f * fine) / (sharpens ? mtf_of_gaussian(f, sigma_) : 1), 0};
    }
  return plane;
}

namespace {

// Spectrum of a measured kernel in steps of 1/fine pixels; empty: there is none.
std::vector<Complex> measured_spectrum(const PsfKernel& given, std::uint32_t fine,
                                       const Fourier& fourier) {
  if (given.side == 0) return {};
  const std::size_t plane = fourier.side();
  std::vector<Complex> out(plane * plane, Complex{});
  const std::size_t half = given.side / 2;
  const std::size_t spread = given.oversampling == 1 ? fine : fine > 1 ? 1 : 0;
  for (std::size_t y = 0; y < given.side; ++y)
    for (std::size_t x = 0; x < given.side; ++x) {
      // steps of pixels stand at their centres; finer ones fall together on whole pixels
      const auto place = [&](std::size_t at) {
        const long from = static_cast<long>(at) - static_cast<long>(half);
        const long to = spread > 0 ? from * static_cast<long>(spread)
                                   : std::lround(static_cast<double>(from) / given.oversampling);
        return static_cast<std::size_t>(to + 2 * static_cast<long>(plane)) % plane;
      };
      out[place(y) * plane + place(x)][0] += given.values[y * given.side + x];
    }
  fourier.forward(out);
  return out;
}

// Multiplies a real spectrum by another; empty: by nothing.
void multiply(std::span<Complex> plane, std::span<const Complex> by) {
  for (std::size_t i = 0; i < by.size(); ++i) {
    const double factor = plane[i][0];
    plane[i] = {by[i][0] * factor, by[i][1] * factor};
  }
}

}  // namespace

Blur::Blur(const Optics& optics, const std::array<double, kBands>& airy_px, std::uint32_t fine)
    : fine_(fine) {
  // the largest Gaussian whose removal amplifies nothing much
  constexpr double kLargest = 0.8, kMostGain = 2, kStep = 0.05;
  const double sharpest = *std::ranges::min_element(airy_px);
  for (sigma_ = fine > 1 ? kLargest : 0; sigma_ > 0; sigma_ = std::max(sigma_ - kStep, 0.0)) {
    double gain = 0;
    for (double f = 0; f <= 0.7072; f += 0.01)
      gain = std::max(
          gain, std::fabs(mtf_of_optics(optics, sharpest, f * fine)) / mtf_of_gaussian(f, sigma_));
    if (gain <= kMostGain) break;
  }
  // kernels of a large plane, cut where little is left
  constexpr std::size_t kPlane = 512;
  constexpr double kEnough = 0.995;
  constexpr std::uint32_t kMostReach = 48, kRings = 12;
  const Fourier fourier(kPlane);
  std::array<Plane, kBands> kernels;
  const Plane measured = measured_spectrum(optics.kernel, fine, fourier);
  std::uint32_t need = 1;
  for (std::size_t band = 0; band < kBands; ++band) {
    Plane& plane = kernels[band] = transfer(optics, airy_px[band], kPlane);
    multiply(plane, measured);
    fourier.backward(plane);
    // by the image of a point itself: what sharpens the renderer's Gaussian rings around it
    Plane point = transfer(optics, airy_px[band], kPlane, false);
    multiply(point, measured);
    fourier.backward(point);
    std::vector<double> rings(kPlane / 2 + 1);
    for (std::size_t y = 0; y < kPlane; ++y)
      for (std::size_t x = 0; x < kPlane; ++x) {
        const auto far = [](std::size_t k) { return k <= kPlane / 2 ? k : kPlane - k; };
        rings[std::max(far(x), far(y))] += point[y * kPlane + x][0];
      }
    double whole = 0, sum = rings[0];
    for (const double ring : rings) whole += ring;
    std::uint32_t reach = 0;
    while (reach < kMostReach && sum < kEnough * whole) sum += rings[++reach];
    need = std::max(need, std::min(reach + kRings, kMostReach));
  }
  reach_ = need;
  side_ = 64;
  while (side_ < 4 * std::size_t{reach_} && side_ < kPlane) side_ *= 2;
  const Fourier tiles(side_);
  for (std::size_t band = 0; band < kBands; ++band) {
    Plane& spectrum = spectra_[band];
    spectrum.assign(side_ * side_, Complex{});
    const long reach = reach_;
    for (long y = -reach; y <= reach; ++y)
      for (long x = -reach; x <= reach; ++x) {
        const auto wrap = [](long k, std::size_t side) {
          return static_cast<std::size_t>(k + static_cast<long>(side)) % side;
        };
        const double value = kernels[band][wrap(y, kPlane) * kPlane + wrap(x, kPlane)][0];
        energy_[band] += value;
        spectrum[wrap(y, side_) * side_ + wrap(x, side_)][0] = value;
      }
    tiles.forward(spectrum);
  }
}

std::vector<double> Blur::kernel(std::size_t band) const {
  Plane plane = spectra_[band];
  Fourier(side_).backward(plane);
  std::vector<double> out;
  const long reach = reach_;
  for (long y = -reach; y <= reach; ++y)
    for (long x = -reach; x <= reach; ++x) {
      const auto wrap = [&](long k) {
        return static_cast<std::size_t>(k + static_cast<long>(side_)) % side_;
      };
      out.push_back(plane[wrap(y) * side_ + wrap(x)][0]);
    }
  return out;
}

namespace {

// Spectra of two real planes that share a complex one are told apart by symmetry, multiplied each
// with its own and put together again.
void multiply_two(std::span<Complex> plane, std::size_t side, std::span<const Complex> first,
                  std::span<const Complex> second) {
  const auto times = [](const Complex& a, const Complex& b) {
    return Complex{a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]};
  };
  for (std::size_t y = 0; y < side; ++y)
    for (std::size_t x = 0; x < side; ++x) {
      const std::size_t here = y * side + x;
      const std::size_t there = (side - y) % side * side + (side - x) % side;
      if (there < here) continue;
      const Complex a = plane[here], b = plane[there];
      // of frequency `here`; at `there` they are conjugate
      const Complex one{0.5 * (a[0] + b[0]), 0.5 * (a[1] - b[1])};
      const Complex two{0.5 * (a[1] + b[1]), -0.5 * (a[0] - b[0])};
      const Complex p = times(one, first[here]), q = times(two, second[here]);
      plane[here] = {p[0] - q[1], p[1] + q[0]};
      plane[there] = {p[0] + q[1], -p[1] + q[0]};
    }
}

}  // namespace

void Blur::apply(std::span<float> radiance, std::uint32_t width, std::uint32_t height) const {
  const std::vector<float> from(radiance.begin(), radiance.end());
  std::array<double, kBands> sum{};
  for (std::size_t i = 0; i < from.size(); ++i) sum[i % kBands] += from[i];
  const double pixels = double{1} * width * height;
  const std::size_t inner = side_ - 2 * reach_;
  const std::size_t across = (width + inner - 1) / inner, down = (height + inner - 1) / inner;
  const Fourier fourier(side_);
  parallel_for(across * down, [&](std::size_t tile) {
    const long x0 = static_cast<long>(tile % across * inner) - static_cast<long>(reach_);
    const long y0 = static_cast<long>(tile / across * inner) - static_cast<long>(reach_);
    for (std::size_t band = 0; band < kBands; band += 2) {
      const bool two = band + 1 < kBands;
      Plane plane(side_ * side_, Complex{});
      bool lit = false;
      for (std::size_t y = 0; y < side_; ++y)
        for (std::size_t x = 0; x < side_; ++x) {
          const long i = x0 + static_cast<long>(x), j = y0 + static_cast<long>(y);
          if (i < 0 || j < 0 || i >= width || j >= height) continue;
          const float* rgb =
              &from[3 * (static_cast<std::size_t>(j) * width + static_cast<std::size_t>(i))];
          plane[y * side_ + x] = {rgb[band], two ? rgb[band + 1] : 0};
          lit = lit || rgb[band] != 0 || (two && rgb[band + 1] != 0);
        }
      if (lit) {
        fourier.forward(plane);
        multiply_two(plane, side_, spectra_[band], spectra_[two ? band + 1 : band]);
        fourier.backward(plane);
      }
      for (std::size_t y = reach_; y < reach_ + inner; ++y)
        for (std::size_t x = reach_; x < reach_ + inner; ++x) {
          const long i = x0 + static_cast<long>(x), j = y0 + static_cast<long>(y);
          if (i >= width || j >= height) continue;
          float* rgb =
              &radiance[3 * (static_cast<std::size_t>(j) * width + static_cast<std::size_t>(i))];
          for (std::size_t k = 0; k < (two ? 2u : 1u); ++k) {
            const double halo = (1 - energy_[band + k]) * sum[band + k] / pixels;
            const double value = plane[y * side_ + x][k] + halo;
            rgb[band + k] = static_cast<float>(value);
          }
        }
    }
  });
}

}  // namespace panwright::sensor
