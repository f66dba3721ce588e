#include "importers/vrml/vrml.h"

#include <fmt/core.h>

#include "base/text.h"
#include "importers/vrml/internal/builder.h"

namespace panwright::importers::vrml {

Result<Imported> read(Files& files, const InputFile& file, const Options& options,
                      DiagnosticLog& log) {
  ReaderContext context(files, options, log);
  try {
    Document* document = context.open(file);
    if (document == nullptr) return failed;
    Builder builder(context);
    builder.enter(*document, {});
    builder.once = true;
    build(builder, *document, 0);
    return builder.finished(document->format, file.name);
  } catch (const OverLimit& over) {
    if (over.what.empty()) return failed;
    const std::string message =
        fmt::format("the model needs more {} than the limit allows", over.what);
    if (over.where.file == kNoFile)
      log.report_file(Code("E6002"), file.name, message);
    else
      log.report(Code("E6002"), over.where, message);
    return failed;
  }
}

}  // namespace panwright::importers::vrml
