#include "workspace/known_import.h"

#include <utility>

#include "base/file.h"
#include "base/file_uses.h"
#include "pan/model.h"
#include "workspace/internal/stopwatch.h"

namespace panwright::workspace {

namespace {

// Whole files are no parts of a model: WorkCounts do not count them.
constexpr auto kWhole = static_cast<Work>(kWorks + 1);

// Of all that decides the file and what is said, the contents apart.
void add_options(const std::filesystem::path& path, const OpenOptions& options,
                 const WriteOptions& write, KeyHasher& key) {
  const CadOptions& cad = options.cad;
  key.text(path.string());  // messages name it
  for (const std::string& text : {cad.units, cad.up, cad.root, cad.scene, cad.animation, cad.assume,
                                  write.origin, pan::storage_name(write.storage)})
    key.text(text);
  for (const std::optional<double>& value : {cad.time, options.max_error}) {
    key.number(value.has_value());
    key.real(value.value_or(0));
  }
  for (const double value : {cad.weld, cad.crease_deg, cad.deflection, cad.max_seconds})
    key.real(value);
  for (const bool flag : {cad.no_weld, cad.crease_normals, cad.keep_hidden, cad.recentre,
                          options.prune, write.strip_sources, write.mesh_levels, write.check_size})
    key.number(flag);
  key.number(cad.primitives);
  key.number(options.max_triangles);
}

// One more than it may be: the pan file lies beside what is said of it.
Hash128 beside(const Hash128& key) { return {key.low, key.high + 1}; }

constexpr std::uint64_t compiler::Report::*kNumbers[] = {
    &compiler::Report::unique_meshes,    &compiler::Report::instances, &compiler::Report::triangles,
    &compiler::Report::unique_triangles, &compiler::Report::levels,    &compiler::Report::bytes};
constexpr std::uint64_t compiler::HiddenReport::*kHidden[] = {
    &compiler::HiddenReport::triangles_before,
    &compiler::HiddenReport::triangles_after,
    &compiler::HiddenReport::unique_before,
    &compiler::HiddenReport::unique_after,
    &compiler::HiddenReport::instances_before,
    &compiler::HiddenReport::instances_after,
    &compiler::HiddenReport::hidden,
    &compiler::HiddenReport::ambiguous,
    &compiler::HiddenReport::rays,
    &compiler::HiddenReport::reached};

void put(const KnownImport& made, ByteWriter& to) {
  const compiler::Report& report = made.report;
  for (const auto number : kNumbers) to.number(report.*number);
  to.real(report.worst_error);
  to.real(report.storage.position_error);
  to.real(report.storage.normal_error);
  to.number(report.storage.bytes);
  to.number(report.storage.meshes_with_more_bits);
  to.number(made.hidden.has_value());
  if (!made.hidden) return;
  for (const auto number : kHidden) to.number(*made.hidden.*number);
  to.number(made.hidden->capped);
  to.real(made.hidden->open_share);
  to.real(made.hidden->open_share_each);
}

KnownImport taken(ByteReader& from) {
  KnownImport out;
  compiler::Report& report = out.report;
  for (const auto number : kNumbers) report.*number = from.number();
  report.worst_error = from.real();
  report.storage.position_error = from.real();
  report.storage.normal_error = from.real();
  report.storage.bytes = from.number();
  report.storage.meshes_with_more_bits = from.number();
  if (from.number() == 0) return out;
  compiler::HiddenReport& hidden = out.hidden.emplace();
  for (const auto number : kHidden) hidden.*number = from.number();
  hidden.capped = from.number() != 0;
  hidden.open_share = from.real();
  hidden.open_share_each = from.real();
  hidden.cached = true;
  return out;
}

// What a log says from some entry on. False: it points into a text, or not all of it is there.
bool put(const DiagnosticLog& log, std::size_t first, ByteWriter& to) {
  if (log.has_errors() || log.hidden() > 0 || first > log.entries().size()) return false;
  to.number(log.entries().size() - first);
  for (std::size_t i = first; i < log.entries().size(); ++i) {
    const Diagnostic& entry = log.entries()[i];
    // what was not found may be there the next time
    if (entry.code == Code::W6004 || entry.code == Code::W6005) return false;
    const bool named = entry.where.file != kNoFile;
    if (named && log.sources().file(entry.where.file).bytes) return false;
    to.number(static_cast<std::uint64_t>(entry.code));
    to.text(named ? log.sources().file(entry.where.file).name : std::string());
    to.text(entry.message);
    to.text(entry.hint);
    to.text(entry.object);
  }
  return true;
}

std::vector<std::pair<std::string, Diagnostic>> said(ByteReader& from) {
  std::vector<std::pair<std::string, Diagnostic>> out;
  for (std::uint64_t left = from.number(); left > 0 && from.good(); --left) {
    Diagnostic entry{static_cast<Code>(from.number()), {}, {}, {}, {}};
    std::string file = from.text();
    entry.message = from.text();
    entry.hint = from.text();
    entry.object = from.text();
    out.emplace_back(std::move(file), std::move(entry));
  }
  return out;
}

void say(const std::string& file, Diagnostic entry, DiagnosticLog& log) {
  SourceSpan where;
  SourceMap& sources = log.sources();
  if (!file.empty()) {
    for (FileId id = 0; id < sources.size() && where.file == kNoFile; ++id)
      if (sources.file(id).name == file && !sources.file(id).bytes) where.file = id;
    if (where.file == kNoFile) where.file = sources.add({file, nullptr, Encoding::binary, {}});
  }
  log.report(entry.code, where, std::move(entry.message), std::move(entry.hint),
             std::move(entry.object));
}

// Whether the output is what would be written. It counts as written now.
bool is_there(const std::filesystem::path& output, std::uint64_t bytes, const Hash128& hash,
              DiagnosticLog& log) {
  DiagnosticLog apart;  // one that watches no files: an output is no input
  std::error_code error;
  if (!std::filesystem::is_regular_file(output, error)) return false;
  {
    const auto file = MappedFile::open(output, apart);
    if (!file || file->bytes().size() != bytes || hash128(file->bytes()) != hash) return false;
  }
  if (log.files() && !log.files()->may_write(output, log)) return false;
  std::filesystem::last_write_time(output, std::filesystem::file_time_type::clock::now(), error);
  return !error;
}

}  // namespace

ImportMemory::ImportMemory(const std::filesystem::path& path, const OpenOptions& options,
                           const WriteOptions& write, const DiagnosticLog& log)
    : origin_(write.origin), output_(write.output), said_(log.entries().size()) {
  if (options.cache.empty() || write.output == "-" || extension_of(path) != ".glb" ||
      !options.budget.empty() || !options.parameters.empty())
    return;
  DiagnosticLog apart = log.apart();
  const auto file = MappedFile::open(path, apart);
  if (!file) return;
  KeyHasher key;
  add_options(path, options, write, key);
  file_ = hash128(file->bytes());
  key.hash(file_);
  key_ = key.key();
  cache_.emplace(options.cache / "models");
}

std::optional<KnownImport> ImportMemory::recall(DiagnosticLog& log, OpenReport* report) const {
  if (!cache_) return std::nullopt;
  const auto words = cache_->find(kWhole, key_);
  if (!words) return std::nullopt;
  ByteReader reader(*words);
  KnownImport known = taken(reader);
  const auto entries = said(reader);
  const std::uint64_t low = reader.number();
  const Hash128 hash{low, reader.number()};
  if (!reader.at_end()) return std::nullopt;
  const Stopwatch watch(report, "found as an earlier run made it");
  if (!is_there(output_, known.report.bytes, hash, log)) {
    if (log.has_errors()) return std::nullopt;
    const auto pan = cache_->find(kWhole, beside(key_));
    if (!pan || pan->size() != known.report.bytes || !write_file(output_, *pan, log))
      return std::nullopt;
  }
  for (const auto& [file, entry] : entries) say(file, entry, log);
  return known;
}

void ImportMemory::keep(const scene::Scene& scene, const KnownImport& made,
                        const DiagnosticLog& log) const {
  if (!cache_ || scene.inputs.size() != 1) return;
  ByteWriter writer;
  put(made, writer);
  if (!put(log, said_, writer)) return;
  DiagnosticLog apart;  // one that watches no files: an output is no input
  auto pan = pan::Model::open(output_, apart);
  if (!pan || !pan->check(apart)) return;
  // another process may have written another model there meanwhile
  const bool own = pan->bytes().size() == made.report.bytes && pan->inputs().size() == 1 &&
                   pan->inputs()[0].hash[0] == file_.low &&
                   pan->inputs()[0].hash[1] == file_.high && pan->options().ends_with(origin_);
  if (!own) return;
  const Hash128 hash = hash128(pan->bytes());
  writer.number(hash.low);
  writer.number(hash.high);
  cache_->keep(kWhole, beside(key_), pan->bytes());
  cache_->keep(kWhole, key_, writer.bytes());
}

}  // namespace panwright::workspace
