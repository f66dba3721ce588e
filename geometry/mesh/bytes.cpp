#include "geometry/mesh/bytes.h"

#include <algorithm>
#include <cmath>

namespace panwright::geometry {

namespace {

template <class To>
void put(const Mesh& mesh, To& to) {
  to.list(mesh.positions);
  to.list(mesh.normals);
  to.list(mesh.texcoords);
  to.list(mesh.colors);
  to.list(mesh.triangles);
  to.real(mesh.error);
  to.number(mesh.closed);
}

template <class V>
bool all_finite(const std::vector<V>& values) {
  return std::all_of(values.begin(), values.end(), [](const V& v) {
    for (int k = 0; k < v.length(); ++k)
      if (!std::isfinite(v[k])) return false;
    return true;
  });
}

}  // namespace

void add_to_key(const Mesh& mesh, KeyHasher& key) { put(mesh, key); }

void write(const Mesh& mesh, ByteWriter& to) { put(mesh, to); }

Mesh read_mesh(ByteReader& from) {
  Mesh mesh;
  from.list(mesh.positions);
  from.list(mesh.normals);
  from.list(mesh.texcoords);
  from.list(mesh.colors);
  from.list(mesh.triangles);
  mesh.error = from.real();
  mesh.closed = from.number() != 0;
  const std::size_t count = mesh.positions.size();
  const auto fits = [&](std::size_t size) { return size == 0 || size == count; };
  const bool sound =
      fits(mesh.normals.size()) && fits(mesh.texcoords.size()) && fits(mesh.colors.size()) &&
      all_finite(mesh.positions) && all_finite(mesh.normals) && all_finite(mesh.texcoords) &&
      all_finite(mesh.colors) && std::isfinite(mesh.error) &&
      std::all_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const Triangle& t) {
        return std::max({t[0], t[1], t[2]}) < count;
      });
  if (!sound) from.fail();
  return mesh;
}

}  // namespace panwright::geometry
