#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/file.h"
#include "base/text.h"
#include "pxn/upgrade.h"
#include "tools/commands.h"
#include "tools/load.h"
#include "tools/session.h"

namespace panwright::tools {

int upgrade(const UpgradeOptions& options) {
  Session session("upgrade", options.common);
  DiagnosticLog& log = session.log();
  if (!options.output.empty() && options.inputs.size() > 1) {
    log.report(Code::E0201, {}, "-o takes one file; several are upgraded in place");
    return session.finish();
  }
  for (const std::string& input : options.inputs)
    if (extension_of(input) != ".pxn")
      log.report(Code::E0202, {}, fmt::format("{} is not a .pxn file", in_quotes(input)));
  if (log.has_errors()) return session.finish();

  session.step("upgrade and compare");
  pxn::Options read;
  read.root = options.root;
  read.limits.bytes = options.max_input;
  const auto files = pxn::upgraded(options.inputs, read, log);
  // nothing is written when one of them cannot be
  if (!files) return session.finish();
  session.step("write");
  for (const pxn::UpgradedFile& file : *files) {
    const bool already = file.text.empty();
    session.result()["files"].push_back(
        {{"file", file.path}, {"upgraded", !already}, {"paths_changed", file.paths}});
    if (already) {
      if (!options.common.json) fmt::print(stderr, "{}: is of level 1 already\n", file.path);
      continue;
    }
    write_file(options.output.empty() ? file.path : options.output, as_bytes(file.text), log);
  }
  return session.finish();
}

}  // namespace panwright::tools
