#include "importers/import.h"

#include <fmt/core.h>

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <optional>
#include <string_view>
#include <vector>

#include "base/file.h"
#include "base/folder_names.h"
#include "base/text.h"
#include "importers/gltf/gltf.h"
#include "importers/internal/appearance.h"
#include "importers/internal/gzip.h"
#include "importers/internal/import_part.h"
#include "importers/internal/storable.h"
#include "importers/internal/xml_encoding.h"
#include "importers/meshes/meshes.h"
#include "importers/mjcf/mjcf.h"
#include "importers/other_formats.h"
#include "importers/step/step.h"
#include "importers/urdf/urdf.h"
#include "importers/vrml/vrml.h"
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace panwright::importers {

namespace {

namespace fs = std::filesystem;

// Extensions that tell a format, where its bytes may not.
constexpr std::pair<std::string_view, Format> kExtensions[] = {
    {".obj", Format::obj},   {".stl", Format::stl},   {".ply", Format::ply},
    {".urdf", Format::urdf}, {".mjcf", Format::mjcf}, {".stp", Format::step},
    {".step", Format::step}};

// The format of an extension; packed: of the last one that tells any, as ".obj" of "m.obj.gzip".
std::optional<Format> format_by_name(std::string_view path, bool packed) {
  for (fs::path file = fs::path(path).filename(); file.has_extension(); file = file.stem()) {
    const std::string extension = lower_case(file.extension().string());
    for (const auto& [known, format] : kExtensions)
      if (extension == known) return format;
    if (!packed && extension != ".gz") break;
  }
  return std::nullopt;
}

// By its first line that is no comment.
bool is_obj(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r\n";
  while (text.starts_with('#')) {
    text.remove_prefix(std::min(text.find('\n'), text.size()));
    text.remove_prefix(std::min(text.find_first_not_of(kBlank), text.size()));
  }
  const std::string_view word = text.substr(0, text.find_first_of(kBlank));
  constexpr std::string_view kWords[] = {"v", "vn", "vt", "mtllib", "usemtl", "o", "g", "s"};
  return std::ranges::find(kWords, word) != std::end(kWords);
}

// By the number of its triangles, which its size follows from.
bool is_binary_stl(std::string_view bytes) {
  constexpr std::size_t kHeader = 80, kTriangle = 50;
  std::uint32_t triangles = 0;
  if (bytes.size() < kHeader + sizeof triangles) return false;
  std::memcpy(&triangles, bytes.data() + kHeader, sizeof triangles);
  return triangles > 0 &&
         bytes.size() == kHeader + sizeof triangles + std::uint64_t{triangles} * kTriangle;
}

// By first bytes; by its name where a format has no mark, or one that others have too; else by
// what the rest looks like.
std::optional<Format> format_of(std::string_view bytes, std::string_view path, bool packed,
                                std::optional<Format> assume) {
  if (bytes.starts_with("glTF")) return Format::gltf;
  if (bytes.starts_with("#VRML")) return Format::vrml97;
  if (bytes.starts_with("\xef\xbb\xbf")) bytes.remove_prefix(3);
  const std::size_t first = bytes.find_first_not_of(" \t\r\n");
  const std::string_view text = first == bytes.npos ? std::string_view() : bytes.substr(first);
  if (text.starts_with("ISO-10303-21")) return Format::step;
  if (urdf::is_robot(text)) return Format::urdf;
  if (mjcf::is_model(text)) return Format::mjcf;
  if (starts_with_any(bytes, {"ply\n", "ply\r", "ply "})) return Format::ply;
  if (assume) return *assume;
  if (const auto format = format_by_name(path, packed)) return format;
  if (starts_with_any(text, {"solid ", "solid\n", "solid\r"})) return Format::stl;
  if (text.starts_with('{')) return Format::gltf;
  if (is_binary_stl(bytes)) return Format::stl;
  if (is_obj(text)) return Format::obj;
  return std::nullopt;
}

void report(Code code, const std::string& name, const std::string& message, SourceSpan where,
            DiagnosticLog& log, std::string hint = {}) {
  if (where.file == kNoFile)
    log.report_file(code, name, message, std::move(hint));
  else
    log.report(code, where, message, std::move(hint));
}

constexpr std::size_t kLarge = std::size_t{1} << 20;  // bytes of a text
constexpr std::size_t kHuge = std::size_t{16} << 20;

// What the lists of a file took stays with the allocator, beside a scene that is made into another.
void give_back_memory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

// Large texts of this reading (files from `first` on) that no diagnostic points into go with it.
void drop_texts(FileId first, DiagnosticLog& log) {
  SourceMap& sources = log.sources();
  std::vector<bool> needed(sources.size(), false);
  for (const Diagnostic& entry : log.entries())
    for (SourceSpan at = entry.where; at.file != kNoFile && !needed[at.file];
         at = sources.file(at.file).included_at)
      needed[at.file] = true;
  bool any = false;
  SourceMap kept;
  for (FileId id = 0; id < needed.size(); ++id) {
    SourceFile file = sources.file(id);
    if (id >= first && !needed[id] && file.bytes && file.bytes->size() >= kLarge) {
      file.bytes = nullptr;
      any = true;
    }
    kept.add(std::move(file));
  }
  if (any) sources = std::move(kept);
}

Result<Imported> read_as(Format format, Files& files, const InputFile& file, const Options& options,
                         DiagnosticLog& log) {
  switch (format) {
    case Format::vrml97:
    case Format::vrml1:
      return vrml::read(files, file, options, log);
    case Format::gltf:
      return gltf::read(files, file, options, log);
    case Format::obj:
    case Format::stl:
    case Format::ply:
      return meshes::read(files, file, format, options, log);
    case Format::urdf:
      return urdf::read(files, file, options, log);
    case Format::mjcf:
      return mjcf::read(files, file, options, log);
    case Format::step:
      break;
  }
  return step::read(file, options, log);
}

}  // namespace

namespace {

bool is_robot(Format format) { return format == Format::urdf || format == Format::mjcf; }

}  // namespace

UpAxis usual_up(Format format) {
  const bool z =
      format == Format::stl || format == Format::ply || format == Format::step || is_robot(format);
  return z ? UpAxis::z : UpAxis::y;
}

bool reads_step() { return step::is_available(); }

namespace {

// part: of a robot description
Result<Imported> imported_bytes(Files& files, const std::string& path, SharedText bytes, bool part,
                                const Options& options, DiagnosticLog& log, SourceSpan included_at,
                                const Job& job) {
  const std::string name = files.display_name(path);
  const Hash128 hash = hash128(as_bytes(*bytes));
  const std::uint64_t size = bytes->size();
  bytes.forget(0, size);
  const internal::Unpacked unpacked = internal::unpacked(bytes, options.limits.bytes);
  if (!unpacked.problem.empty()) {
    report(Code("E6003"), name, unpacked.problem, included_at, log);
    if (!unpacked.bytes) return failed;
  }
  const bool packed = unpacked.bytes->data() != bytes->data();
  const internal::Recoded recoded = internal::xml_in_utf8(unpacked.bytes);
  const std::string_view text = *recoded.bytes;
  const bool is_pan = text.starts_with(
      "\x89"
      "PAN");
  if (is_pan || text.substr(0, 4096).find("<pangu_model") != text.npos) {
    report(Code("E6001"), name,
           is_pan ? "this is a pan model, expected a CAD file"
                  : "this is a pxn model, expected a CAD file",
           included_at, log,
           is_pan ? "it is compiled already; use `panwright render` or `panwright info`"
                  : "use `panwright compile`, or <include> in a pxn file");
    return failed;
  }
  const auto format = format_of(text, path, packed, options.assume);
  if (part && format && is_robot(*format)) {
    report(Code("E6001"), name, "a robot description is not part of another one, expected a mesh",
           included_at, log);
    return failed;
  }
  auto other = options.assume || (format && is_robot(*format)) ? std::nullopt
                                                               : other_format_by_bytes(text, path);
  if (!other && !format) other = other_format_by_name(path);
  if (other) {
    report(Code("E6001"), name,
           fmt::format("{} is not supported, expected VRML, glTF, GLB, OBJ, STL, PLY, STEP, URDF "
                       "or MJCF",
                       other->name),
           included_at, log, std::string(other->advice));
    return failed;
  }
  const auto first = static_cast<FileId>(log.sources().size());
  const InputFile file{path, name, recoded.bytes, included_at, job};
  if (!recoded.deviation.empty() && format && is_robot(*format))
    report(Code("W6221"), name, recoded.deviation, included_at, log);
  job.poll();
  // what is nothing else is left to the reader of VRML, which says what is wrong
  auto imported = read_as(format.value_or(Format::vrml97), files, file, options, log);
  if (imported) {
    settle_appearance(*imported, name, log);
    make_storable(imported->scene, name, log);
    assert(scene::check(imported->scene).empty());
  }
  drop_texts(first, log);
  if (text.size() >= kHuge) give_back_memory();
  if (imported) imported->scene.inputs.insert(imported->scene.inputs.begin(), {path, hash, size});
  return imported;
}

Result<Imported> imported_from(Files& files, const std::string& path, const Options& options,
                               DiagnosticLog& log, SourceSpan included_at, const Job& job) {
  SharedText bytes;
  const std::string name = files.display_name(path);
  switch (files.read(path, bytes)) {
    case Files::Outcome::found:
      break;
    case Files::Outcome::too_large:
      report(Code("E0104"), name, fmt::format("{} is larger than the limit", in_quotes(name)),
             included_at, log);
      return failed;
    case Files::Outcome::missing:
    case Files::Outcome::outside:
    case Files::Outcome::unreadable:
      report(Code("E0101"), name, fmt::format("{} cannot be read", in_quotes(name)), included_at,
             log);
      return failed;
  }
  return imported_bytes(files, path, std::move(bytes), false, options, log, included_at, job);
}

}  // namespace

Result<Imported> import_part(Files& files, const std::string& path, SharedText bytes,
                             const Options& options, DiagnosticLog& log, SourceSpan included_at,
                             const Job& job) {
  return imported_bytes(files, path, std::move(bytes), true, options, log, included_at, job);
}

Result<Imported> import_from(Files& files, const std::string& path, const Options& options,
                             DiagnosticLog& log, SourceSpan included_at, const Job& job) {
  return run_job(job, log,
                 [&] { return imported_from(files, path, options, log, included_at, job); });
}

Result<Imported> import_file(const fs::path& path, const Options& options, DiagnosticLog& log,
                             const Job& job) {
  std::error_code error;
  if (!require_file(path, log)) return failed;
  if (!fs::is_regular_file(path, error)) {
    log.report_file(Code("E0101"), path.string(),
                    fmt::format("{} is not a regular file", in_quotes(path.string())));
    return failed;
  }
  fs::path folder = path.parent_path();
  std::string name = path.filename().generic_string();
  if (!options.root.empty()) {
    // note: a link that the user names is followed, and lies where it is
    const fs::path beside = fs::weakly_canonical(fs::absolute(path).parent_path(), error);
    const fs::path root = fs::weakly_canonical(fs::absolute(options.root), error);
    const fs::path relative =
        (beside.lexically_relative(root) / path.filename()).lexically_normal();
    if (error || relative.empty() || *relative.begin() == "..") {
      log.report_file(Code("E0101"), path.string(),
                      fmt::format("it does not lie in {}, the folder of --root",
                                  in_quotes(options.root.string())));
      return failed;
    }
    folder = options.root;
    name = relative.generic_string();
  }
  const auto files = files_in_folder(folder, options.limits.bytes, log, name);
  return import_from(*files, name, options, log, {}, job);
}

Result<Imported> import_memory(std::span<const MemoryFile> files, const Options& options,
                               DiagnosticLog& log, const Job& job) {
  const auto store = files_in_memory(files, options.limits.bytes);
  return import_from(*store, fs::path(files[0].path).lexically_normal().generic_string(), options,
                     log, {}, job);
}

}  // namespace panwright::importers
