#include "importers/step/step.h"

#include <fmt/format.h>

#include <mutex>

#include "importers/step/internal/document.h"

namespace panwright::importers::step {

namespace {

// Entities within entities, for each level of the scene: a mapped item, its map, its shape and a
// relation between two.
constexpr std::uint32_t kEntitiesPerLevel = 4;

}  // namespace

Result<Imported> read(const InputFile& file, const Options& options, DiagnosticLog& log) {
  static std::mutex one_at_a_time;
  const std::lock_guard lock(one_at_a_time);
  SourceFile source;
  source.name = file.name;
  source.bytes = file.bytes;
  source.included_at = file.included_at;
  const FileId id = log.sources().add(source);
  try {
    const Text text = checked(*file.bytes, id, kEntitiesPerLevel * options.limits.depth, log);
    if (!text.usable) return failed;
    const std::string_view bytes = text.repaired.empty() ? *file.bytes : text.repaired;
    return read_document(text, bytes, file.path, file.name, options, log);
  } catch (const OverLimit& over) {
    log.report_file(Code::E6002, file.name,
                    fmt::format("the model needs more {} than the limit allows", over.what),
                    over.what == "triangles" ? "a larger --deflection makes fewer" : "");
    return failed;
  }
}

}  // namespace panwright::importers::step
