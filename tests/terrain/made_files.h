// Elevation files and shape models made by tests.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "base/math.h"
#include "terrain/tiles.h"

namespace panwright::terrain::testing_support {

// Bytes of a number in either byte order.
template <class T>
std::string bytes_of(T value, bool big) {
  std::string out(sizeof value, '\0');
  std::memcpy(out.data(), &value, sizeof value);
  return big ? std::string(out.rbegin(), out.rend()) : out;
}

// A PDS3 label of a 4 x 3 image; `more` are lines of its IMAGE object, `map` those that follow.
std::string pds3_label(const std::string& pointer, const std::string& more, const std::string& map);
// A cylindrical map of the whole Moon for it: pixels of 90 x 60 degrees are not square, so rows of
// 45 degrees are left out at the poles.
extern const std::string kMoonMap;

// A binary DSK with one segment of type 2: vertices in km, plates from 1.
std::string dsk_file(const std::vector<std::array<double, 3>>& vertices,
                     const std::vector<std::array<std::int32_t, 3>>& plates, bool big);

// Maps of posts, of a small sphere, so that curvature matters.
constexpr double kRadius = 50000;
enum class Kind { plane, cylindrical, polar };

// A place of a post by formulas of these tests: Snyder's for a sphere.
Vec3 place_of(Kind kind, std::uint32_t x, std::uint32_t y, double z, std::uint32_t width,
              std::uint32_t height);
// ENVI of a plane, whose posts are 10 m apart, else PDS3, of floats in a.dat or a.img.
std::string label_of(Kind kind, std::uint32_t width, std::uint32_t height);
// Tiles of such a file; null where a step failed, which is a failure of the test.
std::shared_ptr<const Tiles> tiles_of(Kind kind, const std::string& data, const std::string& label);

}  // namespace panwright::terrain::testing_support
