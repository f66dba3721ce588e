#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/file.h"
#include "base/text.h"
#include "pxn/writer.h"
#include "tools/commands.h"
#include "tools/load.h"
#include "tools/session.h"

namespace panwright::tools {

int expand(const ExpandOptions& options) {
  Session session("expand", options.common);
  DiagnosticLog& log = session.log();
  const bool standard = options.output == "-";
  for (const std::string& path : {options.input, options.output})
    if (extension_of(path) != ".pxn" && !(standard && path == options.output))
      log.report(Code::E0202, {}, fmt::format("{} is not a .pxn file", in_quotes(path)));
  std::error_code ignored;
  if (std::filesystem::equivalent(options.input, options.output, ignored))
    log.report(Code::E0201, {}, "-o names the input: it would be overwritten");
  if (log.has_errors()) return session.finish();

  const auto scene = read_scene(options.input, options.read, session);
  if (!scene) return session.finish();
  const std::size_t errors = log.errors();
  session.step("write");
  std::vector<std::string> pictures;
  if (!standard) {
    auto written = pxn::write_pictures(*scene, options.output, log);
    if (!written) return session.finish();
    pictures = std::move(*written);
  }
  const std::string text = standard
                               ? pxn::to_text(*scene)
                               : pxn::to_text(*scene, [&](std::size_t i) { return pictures[i]; });
  const bool done = write_file(options.output, as_bytes(text), log);
  session.result()["output"] = options.output;
  session.result()["nodes"] = scene->nodes.size();
  session.result()["shapes"] = scene->instances.size();
  session.result()["pictures"] = pictures;
  if (!options.common.json && done && errors > 0)
    fmt::print(stderr, "panwright: wrote {} without what could not be read\n", options.output);
  return session.finish();
}

}  // namespace panwright::tools
