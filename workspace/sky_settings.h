// Bodies of the sky, from settings (docs/sky.md, docs/sky-by-date.md).
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/result.h"
#include "light/body.h"
#include "light/stars.h"
#include "scenario/dated_sky.h"
#include "workspace/settings.h"

namespace panwright::workspace {

// State of the sky of a frame.
struct SkyState {
  std::vector<light::Body> bodies;
  bool sun_visible = false;
  light::Stars stars;
};

// Checks `planet`, `sky`, `date`, `orbit` and those of stars, without their files. Fails: E0201.
bool check_sky(const Settings& settings, DiagnosticLog& log);

// Returns whether a date changes the image: stars, an orbit, or bodies without a place of their
// own.
bool uses_date(const Settings& settings);
// Returns whether stars are drawn.
bool shows_stars(const Settings& settings);
// Returns whether the Sun's disc is drawn, and nothing but the date may say where.
bool shows_dated_sun(const Settings& settings);
// Returns whether bodies have no place of their own: an orbit and a date must give it.
bool needs_orbit(const Settings& settings);

// Returns the bodies about the origin of the world by `date` and `orbit`. Without an orbit: those
// about the Earth's centre if shows_dated_sun(), else nothing.
//
// Expects: check_sky(). Fails: E0201 for an orbit without a date, bodies without an orbit, dates
// outside 1972 to 2050.
Result<std::optional<scenario::DatedSky>> dated_sky_of(const Settings& settings,
                                                       DiagnosticLog& log);

// Makes the paths of maps and of a star catalogue those of files in a folder.
void place_sky_files(const std::filesystem::path& folder, Settings& settings);

// Returns whether there is a sky: an image of it needs no target.
bool shows_sky(const Settings& settings);

struct PlanetFiles;

// Reader of the sky, which keeps maps and catalogues by their paths.
class SkyReader {
 public:
  // Returns null where the settings have no sky.
  //
  //   dated  of dated_sky_of()
  // Expects: check_sky(). Reports: W5041 for stars beyond the catalogue; N5042, W5043 once for each
  // map. Fails: E0101, E0102, E3001, E3002, E5040; E0201 for a map that is not twice as wide as
  // high. A file is reported once.
  Result<std::shared_ptr<const SkyState>> read(const Settings& settings,
                                               const std::optional<scenario::DatedSky>& dated,
                                               DiagnosticLog& log);

 private:
  bool read_stars(const Settings& settings, const std::optional<scenario::DatedSky>& dated,
                  light::Stars& stars, DiagnosticLog& log);
  bool read_maps(const PlanetFiles& files, light::Body& body, DiagnosticLog& log);
  std::set<std::string> refused_;  // files that were reported
  std::map<std::string, std::shared_ptr<const light::BodyMap>> maps_;
  std::map<std::string, std::shared_ptr<const light::StarCatalogue>> catalogues_;
};

}  // namespace panwright::workspace
