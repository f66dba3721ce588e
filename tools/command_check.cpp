#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/text.h"
#include "tools/commands.h"
#include "tools/load.h"
#include "tools/session.h"

namespace panwright::tools {

namespace {

void check_one(const std::string& path, const ReadOptions& options, Session& session) {
  DiagnosticLog& log = session.log();
  const std::string extension = extension_of(path);
  const std::size_t errors = log.errors(), warnings = log.warnings();
  std::string format, how;  // of a .pan
  if (extension == ".pan" || extension == ".pxn" || is_cad(path)) {
    ReadOptions read = options;
    read.prune = false;
    const auto model = load_model(path, read, session);  // a text is compiled too, to find it all
    if (model && extension == ".pan") {
      format = fmt::format("{}.{}", model->header().major, model->header().minor);
      if (model->compressed()) how = " (compressed)";
    }
  } else {
    log.report(Code::E0202, {},
               fmt::format("{} is no file of a model: .pan, .pxn and CAD files are checked",
                           in_quotes(path)));
  }
  const std::size_t found = log.errors() - errors;
  session.result()["files"].push_back({{"file", path},
                                       {"ok", found == 0},
                                       {"errors", found},
                                       {"warnings", log.warnings() - warnings}});
  if (!format.empty()) {
    session.result()["files"].back()["format"] = format;
    session.result()["files"].back()["compressed"] = !how.empty();
  }
  if (!session.options().json && found == 0) fmt::print("{}: ok{}\n", path, how);
}

}  // namespace

int check(const CheckOptions& options) {
  Session session("check", options.common);
  for (const std::string& path : options.inputs) check_one(path, options.read, session);
  return session.finish();
}

}  // namespace panwright::tools
