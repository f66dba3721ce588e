#include "workspace/internal/kept_import.h"

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <utility>

namespace panwright::workspace {
namespace {

Hash128 import_key(const std::filesystem::path& path, std::span<const std::byte> bytes,
                   const OpenOptions& options) {
  KeyHasher key;
  key.text(path.string());  // messages name it, and its extension counts
  key.hash(hash128(bytes));
  key.text(options.root);
  key.text(options.budget);
  if (options.declared == nullptr)  // else those of a CAD file are left out
    for (const auto& [name, value] : options.parameters) {
      key.text(name);
      key.text(value);
    }
  key.number(options.max_error.has_value());
  key.real(options.max_error.value_or(0));
  key.number(options.max_triangles);
  key.number(options.prune);
  const CadOptions& cad = options.cad;
  for (const std::string* word : {&cad.units, &cad.up, &cad.scene, &cad.animation, &cad.assume})
    key.text(*word);
  key.number(cad.time.has_value());
  for (const double value :
       {cad.time.value_or(0), cad.weld, cad.crease_deg, cad.deflection, cad.max_seconds})
    key.real(value);
  key.number(cad.primitives);
  for (const bool flag : {cad.no_weld, cad.crease_normals, cad.keep_hidden, cad.recentre})
    key.number(flag);
  return key.key();
}

std::string_view mapped_text(const MappedFile& file) {
  return {reinterpret_cast<const char*>(file.bytes().data()), file.bytes().size()};
}

}  // namespace

KeptImport::KeptImport(const std::filesystem::path& path, const OpenOptions& options,
                       const WorkCache* cache, DiagnosticLog& log)
    : path_(path),
      cache_(cache),
      log_(log),
      entries_(log.entries().size()),
      hidden_(log.hidden()),
      errors_(log.errors()) {
  std::error_code error;
  if (cache_ == nullptr || !std::filesystem::is_regular_file(path, error)) return;
  DiagnosticLog apart = log.apart();
  auto file = MappedFile::open(path, apart);
  if (!file) return;  // its reader says why
  key_ = import_key(path, file->bytes(), options);
  file_.emplace(*std::move(file));
}

std::optional<std::vector<std::byte>> KeptImport::diagnostics() const {
  ByteWriter out;
  const SourceMap& sources = log_.sources();
  out.number(log_.entries().size() - entries_);
  for (std::size_t i = entries_; i < log_.entries().size(); ++i) {
    const Diagnostic& entry = log_.entries()[i];
    if (entry.code == Code("W6004") || entry.code == Code("W6005")) return std::nullopt;
    out.text(code_info(entry.code).name);
    out.text(entry.message);
    out.text(entry.object);
    out.text(entry.hint);
    out.number(entry.where.file);
    if (entry.where.file == kNoFile) continue;
    const SourceFile& source = sources.file(entry.where.file);
    const bool is_text = static_cast<bool>(source.bytes);
    if (source.included_at.file != kNoFile || (is_text && *source.bytes != mapped_text(*file_)))
      return std::nullopt;
    out.text(source.name);
    out.number(static_cast<std::uint64_t>(source.encoding));
    out.number(is_text);
    out.number(entry.where.begin);
    out.number(entry.where.end);
  }
  return out.take();
}

bool KeptImport::read_diagnostics(std::span<const std::byte> bytes) {
  ByteReader reader(bytes);
  found_.clear();
  for (std::uint64_t left = reader.number(); left > 0 && reader.good(); --left) {
    const auto code = code_from_name(reader.text());
    if (!code) return false;
    Entry& entry = found_.emplace_back(Entry{{*code, {}, {}, {}, {}}, kNoFile, {}, false});
    entry.said.message = reader.text();
    entry.said.object = reader.text();
    entry.said.hint = reader.text();
    entry.file = static_cast<FileId>(reader.number());
    if (entry.file == kNoFile) continue;
    entry.source.name = reader.text();
    entry.source.encoding = static_cast<Encoding>(reader.number());
    entry.is_text = reader.number() != 0;
    entry.said.where.begin = static_cast<std::uint32_t>(reader.number());
    entry.said.where.end = static_cast<std::uint32_t>(reader.number());
  }
  return reader.at_end();
}

FileId KeptImport::file_of(const Entry& entry) {
  SourceMap& sources = log_.sources();
  SourceFile source = entry.source;
  if (entry.is_text) {
    if (!text_) text_ = std::make_shared<const std::string>(mapped_text(*file_));
    source.bytes = text_;
  } else {
    for (FileId id = 0; id < sources.size(); ++id)
      if (sources.file(id).name == source.name && !sources.file(id).bytes) return id;
  }
  return sources.add(std::move(source));
}

void KeptImport::report_again() {
  std::map<FileId, FileId> files;  // then and now, in the order by which entries are sorted
  for (const Entry& entry : found_)
    if (entry.file != kNoFile) files.emplace(entry.file, kNoFile);
  for (auto& [then, now] : files) now = file_of(*std::ranges::find(found_, then, &Entry::file));
  for (Entry& entry : found_) {
    if (entry.file != kNoFile) entry.said.where.file = files.at(entry.file);
    log_.report(entry.said.code, entry.said.where, std::move(entry.said.message),
                std::move(entry.said.hint), std::move(entry.said.object));
  }
}

std::optional<std::vector<std::byte>> KeptImport::find() {
  if (!file_) return std::nullopt;
  auto kept = cache_->find(Work::imports, key_);
  if (!kept) return std::nullopt;
  ByteReader reader(*kept);
  std::vector<std::byte> said;
  reader.list(said);
  const std::uint64_t size = reader.number(), before = kept->size() - size;
  if (!reader.good() || size > kept->size() || before != 2 * sizeof size + said.size() ||
      !read_diagnostics(said))
    return std::nullopt;
  // moved in place: hundreds of megabytes of fresh memory cost more
  kept->erase(kept->begin(), kept->begin() + static_cast<std::ptrdiff_t>(before));
  return kept;
}

void KeptImport::keep(const pan::Model& model) const {
  if (!file_ || model.inputs().size() != 1 || log_.errors() != errors_ || log_.hidden() != hidden_)
    return;
  const auto said = diagnostics();
  if (!said) return;
  ByteWriter out;
  out.list(*said);
  out.list(model.bytes());
  cache_->keep(Work::imports, key_, out.bytes());
}

}  // namespace panwright::workspace
