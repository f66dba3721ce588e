#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tools/command_context.h"
#include "tools/commands.h"

namespace panwright::tools {

namespace command_view {
namespace {

namespace fs = std::filesystem;

constexpr const char* kProgram = "panwright-studio";

struct Options {
  CommonOptions common;
  std::vector<std::string> targets;  // FILE or NAME=FILE
  std::vector<std::string> defines;
  std::string owner;
  std::string camera;
  std::string script;
  std::string size;
  std::string scale;
  std::string gl = "auto";
};

void declare_all(Arguments& arguments, Options& options) {
  arguments
      .add("targets", options.targets,
           "Targets: .pan, .pxn or CAD files, reloaded when they change; NAME=FILE names a target "
           "(default: the file's name). A scenario or trajectory, as of `panwright run`, is played")
      .required()
      .type("[NAME=]FILE…");
  arguments
      .add("-D,--define", options.defines,
           "Set a <param> of the models, as -D span=2.4m; may be repeated")
      .type("NAME=VALUE")
      .one_value();
  arguments
      .add(
          "--owner", options.owner,
          "Owner of the positions or attitudes of an OEM or AEM: a target's name (default: camera)")
      .type("NAME");
  arguments
      .add("--camera-file", options.camera,
           "Camera of the image, as of `panwright render`: size, lens and, if it has one, detector")
      .type("FILE");
  arguments
      .add("--script", options.script,
           "JSON list of actions and screenshots to run in the window (docs/studio-scripts.md); "
           "the window "
           "closes after the last one")
      .type("FILE.json");
  arguments.add("--size", options.size, "Window size in pixels (default 1280x720)").type("WxH");
  arguments
      .add("--scale", options.scale,
           "Scale of text and widgets, as 1.5 (default: that of the screen)")
      .type("FACTOR");
  arguments
      .add("--gl", options.gl, "OpenGL context that draws images: auto (default), egl or osmesa")
      .one_of({"auto", "egl", "osmesa"})
      .type("KIND");
  declare(arguments, options.common);
}

// Beside this program, or where it is installed.
std::optional<fs::path> studio() {
  std::error_code error;
  const fs::path self = fs::read_symlink("/proc/self/exe", error).parent_path();
  for (const fs::path& folder : {self, self / PANWRIGHT_LIBEXEC_FROM_BIN})
    if (fs::is_regular_file(folder / kProgram, error)) return folder / kProgram;
  return std::nullopt;
}

int run(const Options& options, const Host& host) {
  CommandContext context("view", options.common, host);
  DiagnosticLog& log = context.log();
  const auto program = studio();
  if (!program) {
    log.report(Code("E5001"), {},
               fmt::format("{}, the program of the window, is not installed; building it requires "
                           "GLFW and Dear ImGui",
                           kProgram));
    return context.finish();
  }
  std::vector<std::string> words{kProgram, "--gl", options.gl};
  for (const auto& [option, value] :
       {std::pair{"--owner", &options.owner}, std::pair{"--camera-file", &options.camera},
        std::pair{"--script", &options.script}, std::pair{"--size", &options.size},
        std::pair{"--scale", &options.scale}})
    if (!value->empty()) words.insert(words.end(), {option, *value});
  for (const std::string& define : options.defines) words.insert(words.end(), {"-D", define});
  if (options.common.json) words.push_back("--json");
  words.push_back("--");
  words.insert(words.end(), options.targets.begin(), options.targets.end());
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  ::execv(program->c_str(), arguments.data());
  log.report(Code("E5001"), {},
             fmt::format("cannot start {}: {}", program->string(), std::strerror(errno)));
  return context.finish();
}

}  // namespace
}  // namespace command_view

Command view_command() {
  return command("view", "Show models, or play a scenario, in a window that follows their files",
                 command_view::declare_all, command_view::run);
}

}  // namespace panwright::tools
