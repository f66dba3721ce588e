// Map of a raster: pixels to places on a body.
#pragma once

#include <optional>
#include <string>

#include "base/math.h"

namespace panwright::terrain {

// Degrees; longitude positive to the east.
struct LatLon {
  double latitude = 0, longitude = 0;
};

// Projection, and the place of the first pixel. Pixel (i, j) covers columns [i, i + 1) and rows
// [j, j + 1) and has its centre at + 0.5; rows run down the map. Source: Snyder 1987, "Map
// Projections: A Working Manual", 12 and 21; planetocentric latitudes.
struct Map {
  enum class Kind : std::uint8_t {
    none,         // unknown, or without a place on a body
    cylindrical,  // equirectangular: y = R·latitude, x = R·cos(standard)·longitude
    polar,        // polar stereographic
  };
  Kind kind = Kind::none;
  double radius = 0;             // metres, at the equator
  double polar_radius = 0;       // metres
  double center_longitude = 0;   // degrees east, of x = 0 (of a polar map: of its vertical axis)
  double standard_latitude = 0;  // degrees, of true scale
  bool north = false;            // of a polar map
  double left = 0, top = 0;      // metres, outer corner of the first pixel
  double dx = 0, dy = 0;         // metres of a pixel on the map, positive
  int domain = 180;              // longitudes lie in [-180, 180), or in [0, 360) where 360
  bool positive_west = false;    // the file counts longitudes to the west

  bool is_placed() const { return kind != Kind::none && radius > 0; }
  // Returns whether the columns of a cylindrical map go once round the body.
  bool is_whole_turn(double width) const;
  // Metres on the map of a point of the raster.
  Vec2 point(double column, double row) const { return {left + column * dx, top - row * dy}; }
  // Expects: is_placed().
  LatLon at(double column, double row) const;
  // Column and row of a place; of a cylindrical map in the turn that is nearest to its middle.
  // Expects: is_placed().
  Vec2 pixel(const LatLon& place, double width) const;
  // Metres on the body of one column and one row at a point of the raster; without a projection
  // those of the map. Of the sphere: 0.6 % off on Mars at its poles.
  Vec2 spacing(double column, double row) const;
};

}  // namespace panwright::terrain
