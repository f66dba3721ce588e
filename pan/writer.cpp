#include "pan/writer.h"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>

#include "pan/internal/block_hash.h"
#include "pan/internal/packing.h"
#include "pan/internal/report.h"
#include "pan/model.h"

namespace panwright::pan {

static_assert(std::endian::native == std::endian::little, "pan files are little endian");

std::uint32_t StringTable::id(std::string_view text) {
  const auto next = static_cast<std::uint32_t>(offsets_.size() - 1);
  const auto [place, added] = ids_.try_emplace(std::string(text), next);
  if (added && text.size() > most_ - bytes_.size()) {
    ids_.erase(place);
    full_ = true;
    return 0;
  }
  if (added) {
    bytes_ += text;
    offsets_.push_back(static_cast<std::uint32_t>(bytes_.size()));
  }
  return place->second;
}

// A section that was set aside.
struct Reserved {
  std::size_t entry;               // among those of the directory
  std::uint64_t filled = 0;        // bytes, those of pending included
  std::vector<std::byte> pending;  // less than a block
  std::vector<std::uint64_t> block_hashes;
};

struct Writer::State {
  std::optional<AtomicFile> file;  // none: in memory
  std::string path;                // of the file
  std::vector<std::byte> memory;
  std::uint64_t written = 0;  // bytes of the file so far
  std::vector<layout::DirectoryEntry> entries;
  bool open = false;               // a section is open
  bool broken = false;             // a call has failed
  bool finished = false;           // finish() was called
  bool compress = false;           //
  std::uint64_t features = 0;      // required by the sections
  std::vector<std::byte> held;     // of the open section, all of it, when it may be compressed
  std::vector<std::byte> pending;  // of the open section: less than a block
  std::vector<std::uint64_t> block_hashes;
  std::vector<Reserved> reserved;

  // The block that ends at `filled` of a reserved section.
  bool put_reserved(Reserved& section, std::span<const std::byte> block, std::uint64_t filled,
                    DiagnosticLog& log) {
    section.block_hashes.push_back(hash64(block));
    const std::uint64_t at = entries[section.entry].offset + filled - block.size();
    if (file)
      broken = broken || !file->write_at(at, block, log);
    else
      std::memcpy(memory.data() + at, block.data(), block.size());
    return !broken;
  }

  bool extend(std::uint64_t length, DiagnosticLog& log) {
    if (file)
      broken = broken || !file->extend(length, log);
    else
      memory.resize(memory.size() + length);
    written += length;
    return !broken;
  }

  // Closes the reserved sections. False, once reported, when one is not full.
  bool close_reserved(DiagnosticLog& log) {
    for (Reserved& section : reserved) {
      layout::DirectoryEntry& entry = entries[section.entry];
      if (section.filled != entry.raw_length) {
        log.report_file(Code("E0103"), path,
                        fmt::format("section '{}' ends after {} of {} elements",
                                    layout::kSections[layout::place_of(entry.kind)].name,
                                    section.filled / entry.stride, entry.count));
        broken = true;
        return false;
      }
      // the padding is there, as zeros
      section.pending.resize(section.pending.size() + entry.stored_length - entry.raw_length);
      std::span<const std::byte> rest = section.pending;
      std::uint64_t at = entry.stored_length - rest.size();
      while (!rest.empty()) {
        const auto block = rest.first(std::min<std::size_t>(rest.size(), layout::kHashBlock));
        at += block.size();
        if (!put_reserved(section, block, at, log)) return false;
        rest = rest.subspan(block.size());
      }
      entry.hash = internal::combined(section.block_hashes);
    }
    return true;
  }

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

  // Bytes of the open section as they are stored, block by block.
  bool store(std::span<const std::byte> bytes, DiagnosticLog& log) {
    while (!bytes.empty()) {
      if (pending.empty() && bytes.size() >= layout::kHashBlock) {
        if (!put_block(bytes.first(layout::kHashBlock), log)) return false;
        bytes = bytes.subspan(layout::kHashBlock);
        continue;
      }
      const std::size_t room = layout::kHashBlock - pending.size();
      const auto piece = bytes.first(std::min(room, bytes.size()));
      pending.insert(pending.end(), piece.begin(), piece.end());
      bytes = bytes.subspan(piece.size());
      if (pending.size() == layout::kHashBlock) {
        if (!put_block(pending, log)) return false;
        pending.clear();
      }
    }
    return !broken;
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

// of a section: sums of all stay below what a file system takes
constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 52;

// The lowest minor version that has what the sections need.
std::uint16_t minor_of(std::uint64_t features) {
  // note: which fields a longer record holds is not told, so it may be the newest
  if (features & layout::kFeatureRecordSizes) return layout::kMinor;
  std::uint16_t minor = 0;
  for (const layout::FeatureInfo& feature : layout::kRequiredFeatures)
    if (features & feature.bit) minor = std::max(minor, feature.minor);
  return minor;
}

layout::Header empty_header(std::uint64_t features) {
  layout::Header header{};
  std::memcpy(header.magic, layout::kMagic, sizeof header.magic);
  header.endian = layout::kEndianTag;
  header.major = layout::kMajor;
  header.minor = minor_of(features);
  header.required_features = features;
  header.header_hash = internal::header_hash(header);
  return header;
}

}  // namespace

Writer::Writer(std::unique_ptr<State> state) : state_(std::move(state)) {}
Writer::Writer(Writer&&) noexcept = default;
Writer::~Writer() = default;

Result<Writer> Writer::create(const std::filesystem::path& path, DiagnosticLog& log,
                              const WriteOptions& options) {
  auto file = AtomicFile::create(path, log);
  if (!file) return failed;
  auto state = std::make_unique<State>();
  state->file.emplace(*std::move(file));
  state->path = path.string();
  state->compress = options.compress;
  // a header without the complete mark: what a copy of the unfinished file is recognised by
  const layout::Header header = empty_header(0);
  if (!state->put(std::as_bytes(std::span(&header, 1)), log)) return failed;
  return Writer(std::move(state));
}

Writer Writer::in_memory(const WriteOptions& options, std::size_t expected) {
  auto state = std::make_unique<State>();
  state->compress = options.compress;
  constexpr std::size_t kRest = std::size_t{1} << 20;  // tables, texts, padding
  state->memory.reserve(expected > 0 ? expected + kRest : 0);
  DiagnosticLog unused;
  const layout::Header header = empty_header(0);
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
  if (internal::known(kind) && stride != layout::kSections[layout::place_of(kind)].first_stride)
    s.features |= layout::kFeatureRecordSizes;
  s.entries.push_back(entry);
  s.open = true;
  return !s.broken;
}

bool Writer::append(std::span<const std::byte> bytes, DiagnosticLog& log) {
  State& s = *state_;
  assert(s.open);
  if (s.broken) return false;
  s.entries.back().raw_length += bytes.size();
  if (!s.compress) return s.store(bytes, log);
  s.held.insert(s.held.end(), bytes.begin(), bytes.end());
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
  std::uint64_t used = entry.raw_length;
  entry.stored_length = internal::plain_stored_length(used);
  if (s.compress) {
    auto packed = internal::pack_section(s.held, internal::plane_count(entry.kind, entry.stride));
    if (!packed.empty()) {
      s.held = std::move(packed);
      used = entry.packed_length = s.held.size();
      entry.stored_length = internal::packed_stored_length(used, entry.raw_length);
      entry.codec = static_cast<std::uint32_t>(layout::Codec::chunks);
      s.features |= layout::kFeatureCompressed;
    }
    if (!s.store(s.held, log)) return false;
    s.held = {};
  }
  if (!s.store(std::vector<std::byte>(entry.stored_length - used), log)) return false;
  if (!s.pending.empty() && !s.put_block(s.pending, log)) return false;
  entry.hash = internal::combined(s.block_hashes);
  s.pending.clear();
  s.block_hashes.clear();
  return true;
}

bool Writer::section(layout::SectionKind kind, std::span<const std::byte> bytes,
                     DiagnosticLog& log) {
  const auto value = static_cast<std::uint32_t>(kind);
  const layout::SectionInfo& info = layout::kSections[layout::place_of(value)];
  assert(info.kind == kind);
  return begin(value, info.stride, info.optional, log) && append(bytes, log) && end(log);
}

bool Writer::reserve(layout::SectionKind kind, std::uint64_t count, DiagnosticLog& log) {
  State& s = *state_;
  const auto value = static_cast<std::uint32_t>(kind);
  const layout::SectionInfo& info = layout::kSections[layout::place_of(value)];
  if (!begin(value, info.stride, info.optional, log)) return false;
  s.open = false;
  if (count > kMostBytes / info.stride) {
    log.report_file(
        Code("E0103"), s.path,
        fmt::format("section '{}' would have {} elements of {} bytes, expected at most {}",
                    info.name, count, info.stride, kMostBytes / info.stride));
    s.broken = true;
    return false;
  }
  layout::DirectoryEntry& entry = s.entries.back();
  entry.count = count;
  entry.raw_length = count * info.stride;
  entry.stored_length = internal::plain_stored_length(entry.raw_length);
  s.reserved.push_back({s.entries.size() - 1, 0, {}, {}});
  return s.extend(entry.stored_length, log);
}

bool Writer::fill(layout::SectionKind kind, std::span<const std::byte> bytes, DiagnosticLog& log) {
  State& s = *state_;
  if (s.broken) return false;
  const auto section = std::ranges::find_if(s.reserved, [&](const Reserved& one) {
    return s.entries[one.entry].kind == static_cast<std::uint32_t>(kind);
  });
  assert(section != s.reserved.end());
  assert(bytes.size() <= s.entries[section->entry].raw_length - section->filled);
  while (!bytes.empty()) {
    const std::size_t room = layout::kHashBlock - section->pending.size();
    const auto piece = bytes.first(std::min(room, bytes.size()));
    section->filled += piece.size();
    bytes = bytes.subspan(piece.size());
    if (piece.size() == layout::kHashBlock) {
      if (!s.put_reserved(*section, piece, section->filled, log)) return false;
      continue;
    }
    section->pending.insert(section->pending.end(), piece.begin(), piece.end());
    if (section->pending.size() < layout::kHashBlock) continue;
    if (!s.put_reserved(*section, section->pending, section->filled, log)) return false;
    section->pending.clear();
  }
  return true;
}

bool Writer::derived(layout::SectionKind kind, std::uint64_t count, DiagnosticLog& log) {
  const auto value = static_cast<std::uint32_t>(kind);
  const std::uint32_t stride = layout::kSections[layout::place_of(value)].stride;
  if (!begin(value, stride, false, log)) return false;
  State& s = *state_;
  layout::DirectoryEntry& entry = s.entries.back();
  entry.count = count;
  entry.raw_length = count * stride;
  entry.codec = static_cast<std::uint32_t>(layout::Codec::streams);
  entry.hash = internal::combined(s.block_hashes);
  s.features |= layout::kFeatureMeshStreams;
  s.open = false;
  return !s.broken;
}

void Writer::require(std::uint64_t features) {
  assert(!state_->finished && !(features & ~layout::kKnownRequiredFeatures));
  state_->features |= features;
}

bool Writer::finish(Hash128 build_id, DiagnosticLog& log, double* sync_seconds, const Job* check) {
  State& s = *state_;
  assert(!s.open && !s.finished);
  s.finished = true;
  if (s.broken || !s.close_reserved(log)) return false;
  const auto directory = std::as_bytes(std::span(s.entries));
  layout::Header header = empty_header(s.features);
  header.directory_offset = s.written;
  header.total_length = s.written + directory.size();
  header.section_count = static_cast<std::uint32_t>(s.entries.size());
  header.complete = layout::kComplete;
  header.directory_hash = internal::block_hash(directory);
  header.build_id[0] = build_id.low;
  header.build_id[1] = build_id.high;
  header.header_hash = internal::header_hash(header);
  if (!s.put(directory, log) || !s.put_header(header, log)) return false;
  if (!s.file) return true;
  if (check) {
    auto mapped = s.file->map(log);
    if (!mapped) return false;
    auto model = Model::from_mapping(*std::move(mapped), s.path, log);
    if (!model || !model->check(log, *check)) return false;
  }
  return s.file->commit(log, sync_seconds);
}

std::uint64_t Writer::bytes() const { return state_->written; }

std::vector<std::byte> Writer::take() && {
  assert(!state_->file && state_->finished && !state_->broken);
  return std::move(state_->memory);
}

}  // namespace panwright::pan
