// Numbers with their derivatives by two variables. Private to sensor.
#pragma once

namespace panwright::sensor {

struct Dual {
  double value;
  double dx = 0;
  double dy = 0;
};

inline Dual operator+(const Dual& a, const Dual& b) {
  return {a.value + b.value, a.dx + b.dx, a.dy + b.dy};
}
inline Dual operator+(double a, const Dual& b) { return {a + b.value, b.dx, b.dy}; }
inline Dual operator*(double a, const Dual& b) { return {a * b.value, a * b.dx, a * b.dy}; }
inline Dual operator*(const Dual& a, const Dual& b) {
  return {a.value * b.value, a.dx * b.value + a.value * b.dx, a.dy * b.value + a.value * b.dy};
}
inline Dual operator/(const Dual& a, const Dual& b) {
  const double value = a.value / b.value;
  return {value, (a.dx - value * b.dx) / b.value, (a.dy - value * b.dy) / b.value};
}

}  // namespace panwright::sensor
