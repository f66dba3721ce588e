#include "importers/meshes/meshes.h"

namespace panwright::importers::meshes {

Result<Imported> read(Files&, const InputFile& file, Format, const Options&, DiagnosticLog& log) {
  log.report_file(Code::E6501, file.name, "not read yet");
  return failed;
}

}  // namespace panwright::importers::meshes
