#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "importers/import.h"
#include "schemas/generated/pan_layout.h"
#include "tools/commands.h"
#include "tools/print.h"

namespace panwright::tools {

int print_version(bool json) {
  if (!json) {
    print("panwright {}\n", PANWRIGHT_VERSION);
    return 0;
  }
  nlohmann::ordered_json out;
  out["schema"] = 1;
  out["name"] = "panwright";
  out["version"] = PANWRIGHT_VERSION;
  out["pan_format"] = fmt::format("{}.{}", pan::layout::kMajor, pan::layout::kMinor);
  out["pxn_levels"] = {0};
#ifdef PANWRIGHT_GL
  out["features"] = {"compile", "check", "info", "diff", "render"};
#else
  out["features"] = {"compile", "check", "info", "diff"};
#endif
  if (importers::reads_step()) out["features"].push_back("step");
  out["reads"] = {".pxn", ".pan"};
  out["writes"] = {".pan", ".png", ".exr", ".npy", ".npz"};
  print("{}\n", out.dump(2));
  return 0;
}

}  // namespace panwright::tools
