// Heights of made terrain.
#pragma once

namespace panwright::bench {

// Value noise in octaves from `longest` posts on, halved, down to `shortest`; its Hurst exponent is
// 0.8.
double rough(double x, double y, double longest, double shortest = 1);

}  // namespace panwright::bench
