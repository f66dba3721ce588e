#include "preview/frame/sun_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace panwright::preview {

double light_within(double radius, double limb_darkening) {
  const double square = radius * radius;
  // ∫ (1 − u + u·sqrt(1 − r²)) 2 r dr; 1 − (1 − r²)^(3/2) without cancellation
  const double cosine = std::sqrt(std::max(1 - square, 0.0));
  const double darkened = square * (1 + cosine + cosine * cosine) / (1 + cosine);
  return ((1 - limb_darkening) * square + limb_darkening * (2.0 / 3.0) * darkened) /
         (1 - limb_darkening / 3);
}

// measured (tests/preview/sun_points_test.cpp): kError · points^-3/4, more with fewer than eight
constexpr double kError = 0.305;
constexpr double kOfFew = 1.15;

double error_of_sun_points(unsigned points) {
  if (points <= 1) return 0;
  return kError * (points < 8 ? kOfFew : 1) / std::pow(points, 0.75);
}

unsigned sun_points_for(double error) {
  const double eights = std::ceil(std::pow(kError / error, 4.0 / 3.0) / 8);
  return 8 * static_cast<unsigned>(std::clamp(eights, 1.0, kMostSunPoints / 8.0));
}

namespace {

// Orders each four points that follow each other so that every fourth point of all is a part of the
// disc with nearly the disc's centre.
void balance_quarters(std::vector<Vec2>& places) {
  std::array<Vec2, 4> sums{Vec2(0), Vec2(0), Vec2(0), Vec2(0)};
  for (std::size_t first = 0; first + 4 <= places.size(); first += 4) {
    std::array<int, 4> order{0, 1, 2, 3};
    std::array<int, 4> best = order;
    double least = INFINITY;
    do {
      double squares = 0;
      for (std::size_t part = 0; part < 4; ++part) {
        const Vec2 sum = sums[part] + places[first + static_cast<std::size_t>(order[part])];
        squares += glm::dot(sum, sum);
      }
      if (squares < least) {
        least = squares;
        best = order;
      }
    } while (std::next_permutation(order.begin(), order.end()));
    const std::array<Vec2, 4> four{places[first], places[first + 1], places[first + 2],
                                   places[first + 3]};
    for (std::size_t part = 0; part < 4; ++part) {
      places[first + part] = four[static_cast<std::size_t>(best[part])];
      sums[part] += places[first + part];
    }
  }
}

}  // namespace

void find_sun_points(const SunDisc& disc, unsigned points, std::vector<Vec2>& places) {
  places.assign(1, Vec2(0));
  if (points <= 1) return;
  places.clear();
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  for (unsigned i = 0; i < points; ++i) {
    const double share = (i + 0.5) / points;
    double low = 0;
    double high = 1;
    for (int step = 0; step < 60; ++step) {
      const double middle = 0.5 * (low + high);
      (light_within(middle, disc.limb_darkening) < share ? low : high) = middle;
    }
    const double radius = disc.tangent * 0.5 * (low + high);
    places.emplace_back(radius * std::cos(golden * i), radius * std::sin(golden * i));
  }
  balance_quarters(places);
}

}  // namespace panwright::preview
