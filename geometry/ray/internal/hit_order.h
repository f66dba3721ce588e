// Order of hits along a ray. Private to geometry.
#pragma once

namespace panwright::geometry {

// Orders by distance; at equal distances the lower instance, then the lower triangle comes first.
template <class Hit>
bool comes_after(const Hit& a, const Hit& b) {
  if (a.distance != b.distance) return a.distance > b.distance;
  return a.instance != b.instance ? a.instance > b.instance : a.triangle > b.triangle;
}

}  // namespace panwright::geometry
