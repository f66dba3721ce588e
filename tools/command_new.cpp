#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>
#include <utility>

#include "base/file.h"
#include "base/text.h"
#include "tools/command_context.h"
#include "tools/commands.h"
#include "tools/print.h"
#include "tools/templates.h"

namespace panwright::tools {

namespace command_new {
namespace {

namespace fs = std::filesystem;

struct Options {
  CommonOptions common;
  std::string folder;
};

void declare_all(Arguments& arguments, Options& options) {
  arguments
      .add("folder", options.folder,
           "Folder to create, as probe or models/probe; its model is probe.pxn")
      .required()
      .type("NAME");
  declare(arguments, options.common);
}

// What stands in names of files, nodes and command lines without quotes.
bool is_name(std::string_view name) {
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-';
  };
  return !name.empty() && name[0] != '-' && std::all_of(name.begin(), name.end(), plain);
}

int run(const Options& options, const Host& host) {
  CommandContext context("new", options.common, host);
  DiagnosticLog& log = context.log();
  fs::path folder = fs::path(options.folder).lexically_normal();
  if (!folder.has_filename()) folder = folder.parent_path();
  const std::string name = folder.filename().string();
  if (!is_name(name)) {
    log.report(Code::E0201, {},
               fmt::format("{} is not a valid model name, expected letters, digits, '_' and '-'",
                           in_quotes(name)));
    return context.finish();
  }
  std::error_code error;
  if (fs::exists(folder, error) &&
      !(fs::is_directory(folder, error) && fs::is_empty(folder, error))) {
    log.report_file(Code::E0103, folder.string(), "it already exists and is not an empty folder");
    return context.finish();
  }
  fs::create_directories(folder, error);
  if (error) {
    log.report_file(Code::E0103, folder.string(), error.message());
    return context.finish();
  }
  std::string text = project_text();
  for (std::size_t at = 0; (at = text.find("@NAME@", at)) != std::string::npos;)
    text.replace(at, 6, name);
  context.result()["folder"] = folder.string();
  context.result()["files"] = nlohmann::ordered_json::array();
  for (const auto& [file, content] :
       {std::pair{folder / (name + ".pxn"), text}, std::pair{folder / "pxn.xsd", schema_text()}}) {
    if (!write_file(file, as_bytes(content), log)) return context.finish();
    context.wrote(file.string());
    context.result()["files"].push_back(file.string());
  }
  if (!options.common.json && !options.common.quiet)
    print("next: panwright view {}\n", (folder / (name + ".pxn")).string());
  return context.finish();
}

}  // namespace
}  // namespace command_new

Command new_command() {
  return command("new", "Write a small example model, and the schema for editors",
                 command_new::declare_all, command_new::run);
}

}  // namespace panwright::tools
