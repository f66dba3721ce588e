#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "importers/import.h"
#include "schemas/generated/pan_layout.h"
#include "tools/build_info.h"
#include "tools/command_context.h"
#include "tools/commands.h"
#include "tools/print.h"
#include "workspace/open.h"

namespace panwright::tools {

namespace command_version {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  CommonOptions common;
};

void declare_all(Arguments& arguments, Options& options) { declare(arguments, options.common); }

// Extensions that the program reads, of those that it knows.
Json extensions_read() {
  Json out{".pxn", ".pan"};
  for (const char* extension : {".wrl", ".wrz", ".vrml", ".gltf", ".glb", ".obj", ".stl", ".ply",
                                ".step", ".stp", ".urdf", ".mjcf", ".xml"}) {
    const std::string_view name(extension);
    const bool step = name == ".step" || name == ".stp";
    if (workspace::is_cad("model" + std::string(name)) && (!step || importers::reads_step()))
      out.push_back(extension);
  }
  return out;
}

int run(const Options& options, const Host& host) {
  CommandContext context("version", options.common, host);
  if (!options.common.json) {
    print("panwright {}{}\n", PANWRIGHT_VERSION,
          *kCommit == '\0' ? "" : fmt::format(" ({})", kCommit));
    return context.finish();
  }
  Json& out = context.result();
  out["name"] = "panwright";
  out["version"] = PANWRIGHT_VERSION;
  out["commit"] = *kCommit == '\0' ? Json(nullptr) : Json(kCommit);
  out["compiler"] = kCompiler;
  out["build_type"] = kBuildType;
  out["libraries"] = Json::object();
  for (const Library& library : kLibraries) out["libraries"][library.name] = library.version;
  out["pan_format"] = fmt::format("{}.{}", pan::layout::kMajor, pan::layout::kMinor);
  out["pxn_levels"] = {0, 1};
  out["features"] = {"compile", "import", "export", "check", "info", "diff"};
#ifdef PANWRIGHT_GL
  out["features"].push_back("render");
#endif
  out["features"].push_back("reference");
  if (importers::reads_step()) out["features"].push_back("step");
  out["reads"] = extensions_read();
  out["writes"] = {".pan", ".glb", ".pxn", ".png", ".exr", ".npy", ".npz"};
  return context.finish();
}

}  // namespace
}  // namespace command_version

Command version_command() {
  return command("version", "Print the version; with --json, how it was built too",
                 command_version::declare_all, command_version::run);
}

}  // namespace panwright::tools
