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
  if (extension == ".pan" || extension == ".pxn") {
    (void)load_model(path, options, session);  // a pxn file is compiled too, to find it all
  } else {
    log.report(Code::E0202, {},
               fmt::format("{} is neither a .pan nor a .pxn file", in_quotes(path)));
  }
  const std::size_t found = log.errors() - errors;
  session.result()["files"].push_back({{"file", path},
                                       {"ok", found == 0},
                                       {"errors", found},
                                       {"warnings", log.warnings() - warnings}});
  if (!session.options().json && found == 0) fmt::print("{}: ok\n", path);
}

}  // namespace

int check(const CheckOptions& options) {
  Session session("check", options.common);
  for (const std::string& path : options.inputs) check_one(path, options.read, session);
  return session.finish();
}

}  // namespace panwright::tools
