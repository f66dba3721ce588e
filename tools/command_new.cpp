#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

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

// What is made, until all of it is there.
class Unfinished {
 public:
  ~Unfinished() {
    std::error_code ignored;
    for (auto made = made_.rbegin(); made != made_.rend(); ++made) fs::remove(*made, ignored);
  }
  void add(const fs::path& made) { made_.push_back(made); }
  void keep() { made_.clear(); }

  // Makes a folder and those around it.
  std::error_code make_folders(const fs::path& folder) {
    std::error_code error;
    std::vector<fs::path> missing;
    for (fs::path at = folder; !at.empty() && !fs::exists(at, error); at = at.parent_path())
      missing.push_back(at);
    for (auto at = missing.rbegin(); at != missing.rend(); ++at) {
      if (fs::create_directory(*at, error)) add(*at);
      if (error) break;
    }
    return error;
  }

 private:
  std::vector<fs::path> made_;
};

int run(const Options& options, const Host& host) {
  CommandContext context("new", options.common, host);
  DiagnosticLog& log = context.log();
  fs::path folder = fs::path(options.folder).lexically_normal();
  if (!folder.has_filename()) folder = folder.parent_path();
  const std::string name = folder.filename().string();
  if (!is_name(name)) {
    log.report(Code("E0201"), {},
               fmt::format("{} is not a valid model name, expected letters, digits, '_' and '-'",
                           in_quotes(name)));
    return context.finish();
  }
  std::error_code error;
  if (fs::exists(folder, error) &&
      !(fs::is_directory(folder, error) && fs::is_empty(folder, error))) {
    log.report_file(Code("E0103"), folder.string(), "it already exists and is not an empty folder");
    return context.finish();
  }
  Unfinished unfinished;
  if (const std::error_code failure = unfinished.make_folders(folder)) {
    log.report_file(Code("E0103"), folder.string(), failure.message());
    return context.finish();
  }
  std::string text = project_text();
  for (std::size_t at = 0; (at = text.find("@NAME@", at)) != std::string::npos;)
    text.replace(at, 6, name);
  const std::pair<fs::path, std::string> contents[] = {{folder / (name + ".pxn"), text},
                                                       {folder / "pxn.xsd", schema_text()}};
  for (const auto& [file, content] : contents) {
    if (!write_file(file, as_bytes(content), log)) return context.finish();
    unfinished.add(file);
  }
  unfinished.keep();
  context.result()["folder"] = folder.string();
  context.result()["files"] = nlohmann::ordered_json::array();
  for (const auto& [file, content] : contents) {
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
