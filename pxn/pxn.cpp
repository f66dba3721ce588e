#include "pxn/pxn.h"

#include <fmt/core.h>

#include <cassert>

#include "pxn/reader/assembler.h"
#include "pxn/reader/files.h"
#include "pxn/reader/loader.h"
#include "pxn/reader/read_from.h"
#include "pxn/text/reporter.h"

namespace panwright::pxn {

Result<scene::Scene> read_from(Files& files, const FoundFile& top, const Options& options,
                               DiagnosticLog& log, const Job& job) {
  assert(options.limits.depth <= 1024);
  return run_job(job, log, [&]() -> Result<scene::Scene> {
    Reporter reporter(log);
    scene::Scene scene;
    Loader loader(files, options, reporter, scene, job);
    const auto part = loader.load_top(top);
    if (!part) return failed;
    if (!assemble(loader, *part, options, reporter, scene)) return failed;
    loader.check_approach();
    if (options.terrain && *options.terrain && scene.nodes.size() > 1) {
      const scene::Source& at = scene.nodes[1].source;
      log.report(Code("E9613"), {},
                 fmt::format("{}:{}:{}: a file with a <terrain> has no nodes", at.file, at.line,
                             at.column),
                 "a file of their own makes them a target beside the terrain");
      return failed;
    }
    return scene;
  });
}

Result<scene::Scene> read(const std::filesystem::path& path, const Options& options,
                          DiagnosticLog& log, const Job& job) {
  FoundFile top;
  const auto files = files_on_disk(path, options, top);
  return read_from(*files, top, options, log, job);
}

Result<scene::Scene> read_memory(std::span<const MemoryFile> files, const Options& options,
                                 DiagnosticLog& log, const Job& job) {
  assert(!files.empty());
  FoundFile top;
  const auto store = files_in_memory(files, options, top);
  return read_from(*store, top, options, log, job);
}

}  // namespace panwright::pxn
