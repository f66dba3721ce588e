// Findings of the reader of a format, before the meaning of numbers is settled. Private to terrain.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "base/file.h"
#include "terrain/internal/label.h"
#include "terrain/internal/samples.h"

namespace panwright::terrain {

// Stated edges of the map, degrees east.
struct Bounds {
  double west = 0, east = 0, south = 0, north = 0;
};

struct Found {
  DemInfo info;
  VoidRules rules;
  std::optional<double> unit;  // metres of a number; none: not stated
  RawLayout layout;            // used where `data` is given
  std::optional<MappedFile> data;
  std::shared_ptr<const RowSource> rows;  // used otherwise
  std::optional<Bounds> bounds;
  bool unknown_radius = false;  // the map needs one
  std::string cited;            // names in well-known text: of the system, its datum and ellipsoid
  double cited_radius = 0;      // metres, of that ellipsoid; 0: none
};

// A file that is being opened.
struct Opening {
  std::filesystem::path path;
  std::string name;  // for messages
  const DemOptions& options;
  DiagnosticLog& log;
  const Job& job;

  Failed fail(const std::string& message, std::string hint = {}) const {
    log.report_file(Code("E9601"), name, message, std::move(hint));
    return failed;
  }
  void warn(const std::string& message, std::string hint = {}) const {
    log.report_file(Code("W9603"), name, message, std::move(hint));
  }
  void note(const std::string& message, std::string hint = {}) const {
    log.report_file(Code("N9604"), name, message, std::move(hint));
  }
  // A file that the label names, in the label's folder, in any letter case.
  Result<MappedFile> beside(std::string_view file_name, DemInfo& info) const;
  // Checks width, height and bands, and sets the band that is asked for.
  bool check_size(DemInfo& info) const;
};

std::string_view text_of(const MappedFile& file);

// Readers. `file`: the one of `opening`.
Result<Found> read_pds3(const Opening& opening, MappedFile file);
Result<Found> read_pds4(const Opening& opening, MappedFile file);
Result<Found> read_isis(const Opening& opening, MappedFile file);
Result<Found> read_geotiff(const Opening& opening, MappedFile file);
Result<Found> read_envi(const Opening& opening, MappedFile file);
// Of numbers that are no elevations.
Result<Found> read_image(const Opening& opening, MappedFile file);
// By the program panwright-gdal.
Result<Found> read_gdal(const Opening& opening);

// Sphere, projection and its parameters of a coordinate system in well-known text (OGC 01-009 or
// 18-010), as far as they are there. Returns whether the map's coordinates are degrees.
struct WktPlace {
  bool degrees = false;
  double false_easting = 0, false_northing = 0;
  double metres = 1;  // of a number of the map
  std::string names;  // of the system, its datum and ellipsoid
  double radius = 0;  // metres, of the ellipsoid; 0: none
};
WktPlace read_wkt(std::string_view text, DemInfo& info);

// Scales a map whose metres were made with the ellipsoid's radius at the standard latitude. So its
// degrees are right. Notes that. Expects: placed.
void use_local_radius(const Opening& opening, Map& map);

// Places a raster whose coordinates are degrees: expects info.map.radius > 0, or sets `unknown`.
void place_in_degrees(DemInfo& info, double west, double north, double dx, double dy);

}  // namespace panwright::terrain
