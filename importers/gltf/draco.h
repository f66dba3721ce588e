// KHR_draco_mesh_compression. Private to importers/gltf.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/math.h"
#include "geometry/mesh.h"

namespace panwright::importers::gltf {

// Head of a Draco stream, read without decoding.
struct DracoHead {
  bool mesh = false;  // or a cloud of points
  std::uint64_t faces = 0;
  std::uint64_t points = 0;  // vertices that connectivity encodes; those of seams come on top
};
std::optional<DracoHead> draco_head(std::span<const std::byte> bytes);

// Decoding of an attribute's numbers.
struct DracoAttribute {
  std::uint32_t id = 0;       // Draco's unique one
  double scale = 1;           // of normalised integers
  bool clamped = false;       // at −1
  double* numbers = nullptr;  // width · points, filled in
  std::size_t width = 3;      // numbers of an element; missing ones stay 0
};

// A decoded stream. The library's own types stay in one source file.
class DracoMesh {
 public:
  // Decodes; nothing, with a message, for a damaged stream.
  static std::optional<DracoMesh> decoded(std::span<const std::byte> bytes, std::string& problem);

  std::uint64_t points() const;
  std::uint64_t faces() const;
  std::vector<geometry::Triangle> triangles() const;
  // Reads an attribute. False: there is none.
  bool read(const DracoAttribute& attribute) const;

 private:
  struct State;
  explicit DracoMesh(std::shared_ptr<State> state) : state_(std::move(state)) {}
  std::shared_ptr<State> state_;
};

}  // namespace panwright::importers::gltf
