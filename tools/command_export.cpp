#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/file.h"
#include "base/text.h"
#include "importers/gltf/export.h"
#include "tools/commands.h"
#include "tools/load.h"
#include "tools/session.h"

namespace panwright::tools {

int export_cad(const ExportOptions& options) {
  Session session("export", options.common);
  DiagnosticLog& log = session.log();
  if (extension_of(options.output) != ".glb")
    log.report(Code::E0202, {}, fmt::format("{} is not a .glb file", in_quotes(options.output)));
  std::error_code ignored;
  if (std::filesystem::equivalent(options.input, options.output, ignored))
    log.report(Code::E0201, {}, "-o names the input: it would be overwritten");
  if (log.has_errors()) return session.finish();
  const auto model = load_model(options.input, options.read, session);
  if (!model) return session.finish();
  session.step("write");
  const auto bytes = importers::glb_from(*model, log);
  if (!bytes || !write_file(options.output, *bytes, log)) return session.finish();
  session.result()["output"] = options.output;
  session.result()["bytes"] = bytes->size();
  return session.finish();
}

}  // namespace panwright::tools
