#include "importers/gltf/gltf.h"

namespace panwright::importers::gltf {

Result<Imported> read(Files&, const InputFile& file, const Options&, DiagnosticLog& log) {
  log.report_file(Code::E6001, file.name, "not yet");
  return failed;
}

}  // namespace panwright::importers::gltf
