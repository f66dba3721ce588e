#include "importers/step/step.h"

namespace panwright::importers::step {

Result<Imported> read(const InputFile& file, const Options&, DiagnosticLog& log) {
  log.report_file(Code::E6601, file.name, "not read yet");
  return failed;
}

}  // namespace panwright::importers::step
