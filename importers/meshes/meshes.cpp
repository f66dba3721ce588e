#include "importers/meshes/meshes.h"

#include <cassert>

#include "importers/meshes/readers.h"

namespace panwright::importers::meshes {

namespace {

Result<Imported> read_as(Files& files, const InputFile& file, Format format, const Options& options,
                         DiagnosticLog& log) {
  if (format == Format::stl) return read_stl(files, file, options, log);
  if (format == Format::ply) return read_ply(files, file, options, log);
  return read_obj(files, file, options, log);
}

}  // namespace

Result<Imported> read(Files& files, const InputFile& file, Format format, const Options& options,
                      DiagnosticLog& log) {
  auto imported = read_as(files, file, format, options, log);
  assert(!imported || scene::check(imported->scene).empty());
  return imported;
}

}  // namespace panwright::importers::meshes
