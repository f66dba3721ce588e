#include "importers/meshes/meshes.h"

#include "importers/meshes/readers.h"

namespace panwright::importers::meshes {

Result<Imported> read(Files& files, const InputFile& file, Format format, const Options& options,
                      DiagnosticLog& log) {
  if (format == Format::stl) return read_stl(files, file, options, log);
  if (format == Format::ply) return read_ply(files, file, options, log);
  return read_obj(files, file, options, log);
}

}  // namespace panwright::importers::meshes
