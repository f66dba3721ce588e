#include "pan/writer.h"

#include <bit>
#include <cassert>
#include <cstring>

#include "pan/internal/block_hash.h"

namespace panwright::pan {

static_assert(std::endian::native == std::endian::little, "pan files are little endian");

std::uint32_t StringTable::id(std::string_view text) {
  const auto next = static_cast<std::uint32_t>(offsets_.size() - 1);
  const auto [place, added] = ids_.try_emplace(std::string(text), next);
  if (added) {
    assert(bytes_.size() + text.size() <= 0xffffffffu);
    bytes_ += text;
    offsets_.push_back(static_cast<std::uint32_t>(bytes_.size()));
  }
  return place->second;
}

struct Writer::State {
  std::optional<AtomicFile> file;  // none: in memory
  std::vector<std::byte> memory;
  std::uint64_t written = 0;  // bytes of the file so far
  std::vector<layout::DirectoryEntry> entries;
  bool open = false;               // a section is open
  bool broken = false;             // a call has failed
  bool finished = false;           // finish() was called
  std::vector<std::byte> pending;  // of the open section: less than a block
  std::vector<std::uint64_t> block_hashes;

  bool put(std::span<const std::byte> bytes, DiagnosticLog& log) {
    if (file)
      broken = broken || !file->write(bytes, log);
    else
      memory.insert(memory.end(), bytes.begin(), bytes.end());
    written += bytes.size();
    return !broken;
  }

  bool put_block(std::span<const std::byte> bytes, DiagnosticLog& log) {
    block_hashes.push_back(hash64(bytes));
    return put(bytes, log);
  }

  bool put_header(const layout::Header& header, DiagnosticLog& log) {
    const auto bytes = std::as_bytes(std::span(&header, 1));
    if (file)
      broken = broken || !file->write_at(0, bytes, log);
    else
      std::memcpy(memory.data(), bytes.data(), bytes.size());
    return !broken;
  }
};

namespace {

layout::Header empty_header() {
  layout::Header header{};
  std::memcpy(header.magic, layout::kMagic, sizeof header.magic);
  header.endian = layout::kEndianTag;
  header.major = layout::kMajor;
  header.minor = layout::kMinor;
  header.header_hash = internal::header_hash(header);
  return header;
}

}  // namespace

Writer::Writer(std::unique_ptr<State> state) : state_(std::move(state)) {}
Writer::Writer(Writer&&) noexcept = default;
Writer::~Writer() = default;

Result<Writer> Writer::create(const std::filesystem::path& path, DiagnosticLog& log) {
  auto file = AtomicFile::create(path, log);
  if (!file) return failed;
  auto state = std::make_unique<State>();
  state->file.emplace(*std::move(file));
  // a header without the complete mark: what a copy of the unfinished file is recognised by
  const layout::Header header = empty_header();
  if (!state->put(std::as_bytes(std::span(&header, 1)), log)) return failed;
  return Writer(std::move(state));
}

Writer Writer::in_memory() {
  auto state = std::make_unique<State>();
  DiagnosticLog unused;
  const layout::Header header = empty_header();
  state->put(std::as_bytes(std::span(&header, 1)), unused);
  return Writer(std::move(state));
}

bool Writer::begin(std::uint32_t kind, std::uint32_t stride, bool optional, DiagnosticLog&) {
  State& s = *state_;
  assert(!s.open && !s.finished && stride > 0 && s.entries.size() < layout::kMaxSections);
  layout::DirectoryEntry entry{};
  entry.kind = kind;
  entry.version = 1;
  entry.flags = optional ? static_cast<std::uint16_t>(layout::kSectionOptional) : 0;
  entry.offset = s.written;
  entry.stride = stride;
  s.entries.push_back(entry);
  s.open = true;
  return !s.broken;
}

bool Writer::append(std::span<const std::byte> bytes, DiagnosticLog& log) {
  State& s = *state_;
  assert(s.open);
  if (s.broken) return false;
  s.entries.back().raw_length += bytes.size();
  while (!bytes.empty()) {
    if (s.pending.empty() && bytes.size() >= layout::kHashBlock) {
      if (!s.put_block(bytes.first(layout::kHashBlock), log)) return false;
      bytes = bytes.subspan(layout::kHashBlock);
      continue;
    }
    const std::size_t room = layout::kHashBlock - s.pending.size();
    const auto piece = bytes.first(std::min(room, bytes.size()));
    s.pending.insert(s.pending.end(), piece.begin(), piece.end());
    bytes = bytes.subspan(piece.size());
    if (s.pending.size() == layout::kHashBlock) {
      if (!s.put_block(s.pending, log)) return false;
      s.pending.clear();
    }
  }
  return true;
}

bool Writer::end(DiagnosticLog& log) {
  State& s = *state_;
  assert(s.open);
  s.open = false;
  if (s.broken) return false;
  layout::DirectoryEntry& entry = s.entries.back();
  assert(entry.raw_length % entry.stride == 0);
  entry.count = entry.raw_length / entry.stride;
  const std::uint64_t over = entry.raw_length % layout::kSectionAlignment;
  const std::uint64_t padding = over == 0 ? 0 : layout::kSectionAlignment - over;
  entry.stored_length = entry.raw_length + padding;
  // note: a block is a multiple of the alignment, so padding never crosses into another block
  s.pending.resize(s.pending.size() + padding);
  if (!s.pending.empty() && !s.put_block(s.pending, log)) return false;
  entry.hash = internal::combined(s.block_hashes);
  s.pending.clear();
  s.block_hashes.clear();
  return true;
}

bool Writer::section(layout::SectionKind kind, std::span<const std::byte> bytes,
                     DiagnosticLog& log) {
  const auto value = static_cast<std::uint32_t>(kind);
  const layout::SectionInfo& info = layout::kSections[value - 1];
  assert(info.kind == kind);
  return begin(value, info.stride, info.optional, log) && append(bytes, log) && end(log);
}

bool Writer::finish(Hash128 build_id, DiagnosticLog& log, double* sync_seconds) {
  State& s = *state_;
  assert(!s.open && !s.finished);
  s.finished = true;
  if (s.broken) return false;
  const auto directory = std::as_bytes(std::span(s.entries));
  layout::Header header = empty_header();
  header.directory_offset = s.written;
  header.total_length = s.written + directory.size();
  header.section_count = static_cast<std::uint32_t>(s.entries.size());
  header.complete = layout::kComplete;
  header.directory_hash = internal::block_hash(directory);
  header.build_id[0] = build_id.low;
  header.build_id[1] = build_id.high;
  header.header_hash = internal::header_hash(header);
  if (!s.put(directory, log) || !s.put_header(header, log)) return false;
  return !s.file || s.file->commit(log, sync_seconds);
}

std::uint64_t Writer::bytes() const { return state_->written; }

std::vector<std::byte> Writer::take() && {
  assert(!state_->file && state_->finished && !state_->broken);
  return std::move(state_->memory);
}

}  // namespace panwright::pan
