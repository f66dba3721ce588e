// Bodies of the sky, from settings (docs/sky.md).
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/result.h"
#include "light/body.h"
#include "light/stars.h"
#include "workspace/settings.h"

namespace panwright::workspace {

// State of the sky of a frame.
struct SkyState {
  std::vector<light::Body> bodies;
  bool sun_visible = false;
  light::Stars stars;
};

// Checks `planet`, `sky` and those of stars, without their files. Fails: E0201.
bool check_sky(const Settings& settings, DiagnosticLog& log);

// Returns whether there is a sky: an image of it needs no target.
bool shows_sky(const Settings& settings);

struct PlanetFiles;

// Reader of the sky, which keeps maps and catalogues by their paths.
class SkyReader {
 public:
  // Returns null where the settings have no sky. Of bodies of one name the last counts.
  //
  // Expects: check_sky(). Fails: E0101, E0102, E3001, E3002, E5040; E0201 for a map that is not
  // twice as wide as high. N5042, W5043 once for each map.
  Result<std::shared_ptr<const SkyState>> read(const Settings& settings, DiagnosticLog& log);

 private:
  bool read_stars(const Settings& settings, light::Stars& stars, DiagnosticLog& log);
  bool read_maps(const PlanetFiles& files, light::Body& body, DiagnosticLog& log);
  std::map<std::string, std::shared_ptr<const light::BodyMap>> maps_;
  std::map<std::string, std::shared_ptr<const light::StarCatalogue>> catalogues_;
};

}  // namespace panwright::workspace
