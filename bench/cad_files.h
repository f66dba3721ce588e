// CAD files of known contents, of any size.
#pragma once

#include <cstdint>
#include <string>

#include "base/math.h"
#include "pan/model.h"

namespace panwright::bench {

// A band of a sphere of radius 1 about y, a net of `side` × `side` quads of two triangles, its seam
// closed; vertices as exporters write them, with six decimals.
class Band {
 public:
  explicit Band(std::uint32_t side) : side_(side) {}
  std::uint64_t triangles() const { return 2ull * side_ * side_; }
  std::uint64_t vertices() const { return std::uint64_t{side_} * (side_ + 1); }
  Vec3 at(std::uint32_t around, std::uint32_t along) const;  // rounded as written
  // Returns the distance of a place from its vertex.
  double off(const Vec3& place) const;

  std::string vrml() const;             // one IndexedFaceSet of VRML 97
  std::string glb(bool normals) const;  // one mesh of float positions and 32-bit indices
  std::string obj() const;
  std::string stl() const;  // binary
  std::string ply() const;  // little endian, double positions
  // Returns the bytes of a scene that holds it in double: positions, normals and triangles.
  double array_bytes(bool normals) const;

 private:
  // Calls add(a, b, c) for each triangle: corners by around + side·along.
  template <class Add>
  void each_triangle(const Add& add) const {
    for (std::uint32_t j = 0; j < side_; ++j)
      for (std::uint32_t i = 0; i < side_; ++i) {
        const std::uint32_t a = j * side_ + i, b = j * side_ + (i + 1) % side_;
        add(a, a + side_, b);
        add(b, a + side_, b + side_);
      }
  }

  std::uint32_t side_;
};

// Returns the largest Band::off() of the vertices of a compiled model, metres; infinite for another
// number of triangles.
double worst_place(const Band& band, const pan::Model& model);

}  // namespace panwright::bench
