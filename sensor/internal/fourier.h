// Fourier transforms of square planes. Private to sensor.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace panwright::sensor {

using Complex = std::array<double, 2>;  // real, imaginary

// Transforms of planes of side², side a power of two, in place: forward without a factor, backward
// with 1/side². The same bits on every machine.
class Fourier {
 public:
  explicit Fourier(std::size_t side);
  std::size_t side() const { return side_; }
  void forward(std::span<Complex> plane) const { run(plane, false); }
  void backward(std::span<Complex> plane) const { run(plane, true); }

 private:
  void run(std::span<Complex> plane, bool back) const;
  void line(Complex* values, bool back) const;
  std::size_t side_;
  std::vector<Complex> roots_;
  std::vector<std::uint32_t> order_;
};

}  // namespace panwright::sensor
