#include "importers/step/internal/read.h"

#include <fmt/core.h>

#include <string_view>
#include <vector>

#include "importers/step/internal/document.h"

namespace panwright::importers::step {

namespace {

// Entities within entities, for each level of the scene: a mapped item, its map, its shape and a
// relation between two.
constexpr std::uint32_t kEntitiesPerLevel = 4;

}  // namespace

Result<Imported> read_in_process(const InputFile& file, const Options& options, DiagnosticLog& log,
                                 const std::function<void()>& before_risk) {
  SourceFile source;
  source.name = file.name;
  source.bytes = file.bytes;
  source.included_at = file.included_at;
  const FileId id = log.sources().add(source);
  try {
    const std::uint32_t depth = kEntitiesPerLevel * options.limits.depth;
    Text text = checked(*file.bytes, id, depth, log);
    std::vector<std::uint64_t> without;
    while (text.usable) {
      const std::string_view bytes = text.repaired.empty() ? *file.bytes : text.repaired;
      if (before_risk) before_risk();
      try {
        return read_document(text, bytes, file.path, file.name, options, log, file.job);
      } catch (const Torn& torn) {
        // what they stand in may be torn by it in turn
        for (const std::uint64_t number : torn.numbers)
          log.report(Code("W6602"), place_of(text, number),
                     fmt::format("#{} has invalid contents; it is left out", number));
        without.insert(without.end(), torn.numbers.begin(), torn.numbers.end());
      }
      DiagnosticLog said;  // at the first reading
      text = checked(*file.bytes, id, depth, said, without);
    }
    if (!without.empty()) log.report_file(Code("E6601"), file.name, "it has no valid part");
    return failed;
  } catch (const OverLimit& over) {
    log.report_file(Code("E6002"), file.name,
                    fmt::format("the model needs more {} than the limit allows", over.what),
                    over.what == "triangles" ? "a larger --deflection makes fewer" : "");
    return failed;
  }
}

}  // namespace panwright::importers::step
