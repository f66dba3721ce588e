#include "pxn/expression/kinds.h"

#include <fmt/core.h>

#include <cmath>

#include "pxn/expression/units.h"

namespace panwright::pxn {

using schemas::Dimension;
using Measure = QuantityKind::Measure;

namespace {

QuantityKind of_power(int power) {
  if (power == 0) return kPlain;
  if (power == 1) return {Measure::length, 0};
  if (power < -kMostPower || power > kMostPower) return {};
  return {Measure::other, power};
}

}  // namespace

int power_of(const QuantityKind& kind) {
  return kind.measure == Measure::length ? 1 : kind.measure == Measure::other ? kind.power : 0;
}

bool is_measured(const QuantityKind& kind) {
  return kind.measure != Measure::plain && kind.measure != Measure::unknown;
}

QuantityKind product(const QuantityKind& a, const QuantityKind& b) {
  if (a.measure == Measure::unknown || b.measure == Measure::unknown) return {};
  if (const int power = power_of(a) + power_of(b); power_of(a) != 0 || power_of(b) != 0)
    // an angle times a length is an arc
    return of_power(power);
  if (a.measure == Measure::plain) return b;
  if (b.measure == Measure::plain || b.measure == Measure::ratio) return a;
  if (a.measure == Measure::ratio) return b;
  return {};
}

QuantityKind quotient(const QuantityKind& a, const QuantityKind& b) {
  if (a.measure == Measure::unknown || b.measure == Measure::unknown) return {};
  if (power_of(a) != 0 || power_of(b) != 0) return of_power(power_of(a) - power_of(b));
  if (a == b) return kPlain;
  if (b.measure == Measure::plain || b.measure == Measure::ratio) return a;
  return {};
}

QuantityKind root(const QuantityKind& a) {
  if (a.measure == Measure::plain || a.measure == Measure::ratio) return kPlain;
  const int power = power_of(a);
  return power != 0 && power % 2 == 0 ? of_power(power / 2) : QuantityKind{};
}

QuantityKind to_the_power(const QuantityKind& a, std::optional<double> exponent) {
  if (a.measure == Measure::plain || a.measure == Measure::ratio) return kPlain;
  if (power_of(a) == 0 || !exponent) return {};
  const double power = power_of(a) * *exponent;
  if (power != std::floor(power) || std::fabs(power) > kMostPower) return {};
  return of_power(static_cast<int>(power));
}

QuantityKind quantity_kind_of(Dimension dimension) {
  switch (dimension) {
    case Dimension::length:
      return {Measure::length, 0};
    case Dimension::angle:
      return {Measure::angle, 0};
    case Dimension::ratio:
      return {Measure::ratio, 0};
    case Dimension::pixels:
      return {Measure::pixels, 0};
    case Dimension::none:
      break;
  }
  return kPlain;
}

std::string name_of(const QuantityKind& kind) {
  switch (kind.measure) {
    case Measure::length:
      return std::string(name_of(Dimension::length));
    case Measure::angle:
      return std::string(name_of(Dimension::angle));
    case Measure::ratio:
      return std::string(name_of(Dimension::ratio));
    case Measure::pixels:
      return std::string(name_of(Dimension::pixels));
    case Measure::other:
      if (kind.power == 2) return "an area";
      if (kind.power == 3) return "a volume";
      return fmt::format("a length to the power {}", kind.power);
    case Measure::plain:
    case Measure::unknown:
      break;
  }
  return std::string(name_of(Dimension::none));
}

}  // namespace panwright::pxn
