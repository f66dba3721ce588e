// Maps as records of charts and albedo maps hold them. Private to terrain.
#pragma once

#include <cstdint>

#include "terrain/map.h"

namespace panwright::terrain::internal {

// Members that both kinds of records have; of a raster without a map those of a plane.
template <class Record>
void store_map(const Map& map, Record& to) {
  const bool placed = map.is_placed();
  to.kind = static_cast<std::uint32_t>(placed ? map.kind : Map::Kind::none);
  to.radius = placed ? map.radius : 0;
  to.polar_radius = !placed ? 0 : map.polar_radius > 0 ? map.polar_radius : map.radius;
  to.center_longitude = map.center_longitude;
  to.standard_latitude = map.standard_latitude;
  to.dx = map.dx > 0 ? map.dx : 1;
  to.dy = map.dy > 0 ? map.dy : 1;
  to.domain = static_cast<std::uint32_t>(map.domain);
}

// The same back.
template <class Record>
Map stored_map(const Record& from) {
  Map map;
  map.kind = static_cast<Map::Kind>(from.kind);
  map.radius = from.radius;
  map.polar_radius = from.polar_radius;
  map.center_longitude = from.center_longitude;
  map.standard_latitude = from.standard_latitude;
  map.dx = from.dx;
  map.dy = from.dy;
  map.domain = static_cast<int>(from.domain);
  return map;
}

}  // namespace panwright::terrain::internal
