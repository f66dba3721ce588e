// Shares of a Gaussian in the pixels of a line. Private to sky.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace panwright::sky {

inline constexpr double kReach = 5.5;  // sigmas of a Gaussian: 3e-7 lie beyond

// Integrals of a Gaussian about a centre over pixels from `first` on.
struct Shares {
  std::int64_t first = 0;
  std::vector<double> of;
};

// The same Gaussian about many centres.
class PixelShares {
 public:
  // uses: about how many; of many they are read from a table, within 1e-10
  PixelShares(double sigma, std::size_t uses);

  void find(double centre, Shares& out) const;

 private:
  double sigma_ = 0;
  // Half the error function at the pixels' edges from low_ on, and its derivative, for centres at
  // multiples of 1 / nodes_ of a pixel.
  std::int64_t low_ = 0;
  std::size_t edges_ = 0;
  std::size_t nodes_ = 0;  // 0: no table
  std::vector<double> values_, slopes_;
};

}  // namespace panwright::sky
