// Opening: the header, the directory and the lengths of sections; no content is checked.
#include <fmt/core.h>

#include <bit>
#include <cstring>

#include "base/text.h"
#include "pan/internal/block_hash.h"
#include "pan/internal/packing.h"
#include "pan/internal/report.h"
#include "pan/model.h"

namespace panwright::pan {

namespace {

using internal::is_derived;

using internal::has_codec;
using internal::known;

static_assert(std::endian::native == std::endian::little, "pan files are little endian");

bool begins_with(std::span<const std::byte> bytes, std::string_view text) {
  return bytes.size() >= text.size() && std::memcmp(bytes.data(), text.data(), text.size()) == 0;
}

// The signature after common text-mode transfers.
bool damaged_by_text_mode(std::span<const std::byte> bytes) {
  constexpr std::string_view kSeen[] = {
      "\x89PAN\r\r\n\x1a\r\n",  // line feeds became CR LF
      "\x89PAN\n\x1a\n",        // CR LF became line feeds
      "\x89PAN\n\n\x1a\n",      // carriage returns became line feeds
      "\x89PAN\r\r\x1a\r",      // line feeds became carriage returns
      "\tPAN\r\n\x1a\n",        // the eighth bit was lost
      "\xc2\x89PAN",            // read as ISO-8859-1, written as UTF-8
      "\xef\xbf\xbdPAN",        // read as UTF-8, bad bytes replaced
  };
  for (const std::string_view seen : kSeen)
    if (begins_with(bytes, seen)) return true;
  return false;
}

template <class T>
bool all_zero(const T& values) {
  for (const auto value : values)
    if (value != 0) return false;
  return true;
}

// Whether the elements lie in the file as this program uses them.
bool used_in_place(const layout::DirectoryEntry& entry) {
  return !has_codec(entry) &&
         entry.stride == layout::kSections[layout::place_of(entry.kind)].stride;
}

// Steps 1 and 2 of docs/pan-format.md, Reading: the first problem, or none.
struct Complaint {
  Code code;
  std::string message;
  std::string hint;
};

std::optional<Complaint> check_magic(std::span<const std::byte> bytes) {
  if (bytes.empty()) return Complaint{Code("E4001"), "the file is empty", {}};
  const std::string_view magic(reinterpret_cast<const char*>(layout::kMagic),
                               sizeof layout::kMagic);
  if (begins_with(bytes, magic.substr(0, std::min(bytes.size(), magic.size())))) {
    if (bytes.size() >= sizeof(layout::Header)) return {};
    return Complaint{
        Code("E4005"),
        fmt::format("the file is {} bytes long, expected at least the {} of the header",
                    bytes.size(), sizeof(layout::Header)),
        {}};
  }
  if (damaged_by_text_mode(bytes))
    return Complaint{Code("E4002"), "the first bytes show that the file was transferred as text",
                     "transfer the file again in binary mode"};
  std::string seen;
  for (const std::byte byte : bytes.first(std::min<std::size_t>(bytes.size(), 8)))
    seen += fmt::format(" {:02x}", static_cast<unsigned>(byte));
  return Complaint{Code("E4001"),
                   fmt::format("the file begins with{}, expected 89 50 41 4e 0d 0a 1a 0a", seen),
                   {}};
}

std::optional<Complaint> check_header(const layout::Header& header, std::uint64_t size) {
  constexpr std::uint32_t kSwapped = 0x01020304;
  if (header.endian == kSwapped)
    return Complaint{Code("E4003"), "the file is big-endian, expected little-endian", {}};
  if (header.header_hash != internal::header_hash(header))
    return Complaint{Code("E4007"), "the header (bytes 0 to 127) does not match its checksum", {}};
  if (header.complete != layout::kComplete)
    return Complaint{Code("E4006"), "the complete mark is missing: the writer was stopped", {}};
  if (header.endian != layout::kEndianTag || header.major != layout::kMajor)
    return Complaint{Code("E4003"),
                     fmt::format("the file has format {}.{}, expected {}.x", header.major,
                                 header.minor, layout::kMajor),
                     "compile the model again with this version of panwright"};
  const std::uint64_t unknown = header.required_features & ~layout::kKnownRequiredFeatures;
  if (unknown != 0)
    return Complaint{Code("E4004"),
                     fmt::format("the file (format {}.{}) requires the features {:#x}, which this "
                                 "program does not support",
                                 header.major, header.minor, unknown),
                     "update panwright, or compile the model again with this version"};
  if (!all_zero(header.reserved))
    return Complaint{Code("E4012"), "reserved words of the header (bytes 80 to 119) are not 0", {}};
  if (header.total_length != size)
    return Complaint{
        Code("E4005"),
        fmt::format("the file is {} bytes long, but its header says {}", size, header.total_length),
        {}};
  // note: compared so that nothing can overflow; total_length is the size of real bytes here
  const std::uint64_t offset = header.directory_offset;
  const std::uint64_t count = header.section_count;
  if (count > layout::kMaxSections || offset < sizeof(layout::Header) || offset > size ||
      offset % layout::kSectionAlignment != 0 ||
      size - offset != count * sizeof(layout::DirectoryEntry))
    return Complaint{Code("E4008"),
                     fmt::format("the directory of {} sections at byte {} does not end with the "
                                 "file at byte {}",
                                 count, offset, size),
                     {}};
  return {};
}

std::string section_name(const layout::DirectoryEntry& entry) {
  const std::string name = kind_name(entry.kind);
  return name.starts_with("kind ") ? "the section of " + name : "section '" + name + "'";
}

// The lengths of a compressed section, before anything is allocated for it.
std::optional<std::string> mispacked(const layout::DirectoryEntry& entry, const std::string& name) {
  const std::uint64_t chunks = internal::block_count(entry.raw_length);
  if (entry.raw_length == 0 || entry.packed_length > entry.stored_length ||
      entry.packed_length / sizeof(std::uint32_t) < chunks ||
      entry.stored_length != internal::packed_stored_length(entry.packed_length, entry.raw_length))
    return fmt::format("{} stores {} bytes, {} of them used, which cannot hold {} compressed bytes",
                       name, entry.stored_length, entry.packed_length, entry.raw_length);
  return {};
}

// A section that is made from mesh streams: what it may come to is judged when all are known.
std::optional<std::string> misderived(const layout::DirectoryEntry& entry,
                                      const std::string& name) {
  using layout::SectionKind;
  constexpr SectionKind kDerived[] = {SectionKind::positions, SectionKind::normals,
                                      SectionKind::indices};
  if (std::find(std::begin(kDerived), std::end(kDerived), SectionKind{entry.kind}) ==
      std::end(kDerived))
    return name + " cannot be made from mesh streams";
  if (entry.stride == 0 || entry.count > layout::kMaxUnpackedBytes / entry.stride ||
      entry.raw_length != entry.count * entry.stride)
    return fmt::format("{} has {} bytes, expected {} elements of {} bytes", name, entry.raw_length,
                       entry.count, entry.stride);
  if (entry.stored_length != 0 || entry.packed_length != 0)
    return fmt::format("{} stores {} bytes, expected none: it is made from mesh streams", name,
                       entry.stored_length);
  if (entry.flags != 0) return fmt::format("{} has reserved bits that are not 0", name);
  return {};
}

// Step 3, for one entry of any kind.
std::optional<std::string> misplaced(const layout::DirectoryEntry& entry, std::uint64_t begin,
                                     std::uint64_t end) {
  const std::string name = section_name(entry);
  if (entry.offset != begin)
    return fmt::format("{} begins at byte {}, but the one before it ends at {}", name, entry.offset,
                       begin);
  if (entry.stored_length > end - begin)
    return fmt::format("{} at byte {} has {} bytes, but {} are left before the directory", name,
                       entry.offset, entry.stored_length, end - begin);
  if (is_derived(entry)) return misderived(entry, name);
  // note: stored bytes are real ones, so that 256 times as many overflow nothing
  const std::uint64_t most = entry.stored_length * (has_codec(entry) ? layout::kMaxCompression : 1);
  if (entry.stride == 0 || entry.count > most / entry.stride ||
      entry.raw_length != entry.count * entry.stride)
    return fmt::format("{} has {} bytes, expected {} elements of {} bytes", name, entry.raw_length,
                       entry.count, entry.stride);
  if ((entry.flags & ~layout::kSectionOptional) != 0 ||
      (!has_codec(entry) && entry.packed_length != 0))
    return fmt::format("{} has reserved bits that are not 0", name);
  if (has_codec(entry)) return mispacked(entry, name);
  if (entry.stored_length != internal::plain_stored_length(entry.raw_length))
    return fmt::format("{} stores {} bytes, expected {} rounded up to a multiple of {}", name,
                       entry.stored_length, entry.raw_length, layout::kSectionAlignment);
  return {};
}

// The problem of the element size of a known section, if any.
std::optional<std::string> missized(const layout::DirectoryEntry& entry, std::uint64_t features) {
  const layout::SectionInfo& info = layout::kSections[layout::place_of(entry.kind)];
  if (entry.stride == info.first_stride) return {};
  if (!info.table || !(features & layout::kFeatureRecordSizes))
    return fmt::format("section '{}' has elements of {} bytes, expected {}", info.name,
                       entry.stride, info.first_stride);
  if (entry.stride < info.first_stride || entry.stride > layout::kMaxRecordBytes ||
      entry.stride % info.alignment != 0)
    return fmt::format(
        "section '{}' has records of {} bytes, expected a multiple of {} from {} to {}", info.name,
        entry.stride, info.alignment, info.first_stride, layout::kMaxRecordBytes);
  return {};
}

}  // namespace

Result<Model> Model::open(const std::filesystem::path& path, DiagnosticLog& log) {
  auto mapped = MappedFile::open(path, log);
  if (!mapped) return failed;
  Model model;
  model.name_ = path.string();
  model.mapped_.emplace(*std::move(mapped));
  model.bytes_ = model.mapped_->bytes();
  // the file may have shrunk since its length was taken; pages past its end cannot be touched
  std::error_code error;
  const std::uint64_t now = std::filesystem::file_size(path, error);
  if (!error && now < model.bytes_.size()) {
    log.report_file(Code("E4005"), model.name_,
                    fmt::format("the file shrank from {} to {} bytes while it was opened",
                                model.bytes_.size(), now));
    return failed;
  }
  if (!model.parse(log)) return failed;
  return model;
}

Result<Model> Model::from_mapping(MappedFile file, std::string name, DiagnosticLog& log) {
  Model model;
  model.name_ = std::move(name);
  model.mapped_.emplace(std::move(file));
  model.bytes_ = model.mapped_->bytes();
  if (!model.parse(log)) return failed;
  return model;
}

Result<Model> Model::read(const std::filesystem::path& path, std::uint64_t max_bytes,
                          DiagnosticLog& log) {
  const auto text = read_file(path, max_bytes, log);
  if (!text) return failed;
  auto model = from_bytes(as_bytes(*text), path.string(), log);
  if (!model) return failed;
  if (model->unpacked_bytes_ <= max_bytes) return model;
  log.report_file(Code("E0104"), model->name_,
                  fmt::format("its sections decompress to {} bytes, expected at most {}",
                              model->unpacked_bytes_, max_bytes));
  return failed;
}

Result<Model> Model::from_bytes(std::span<const std::byte> bytes, std::string name,
                                DiagnosticLog& log) {
  return from_bytes(std::vector<std::byte>(bytes.begin(), bytes.end()), std::move(name), log);
}

Result<Model> Model::from_bytes(std::vector<std::byte>&& bytes, std::string name,
                                DiagnosticLog& log) {
  Model model;
  model.name_ = std::move(name);
  model.owned_ = std::move(bytes);
  model.bytes_ = model.owned_;
  if (!model.parse(log)) return failed;
  return model;
}

Result<Model> Model::load(const std::filesystem::path& path, DiagnosticLog& log, const Job& job) {
  auto model = open(path, log);
  if (!model || !model->check(log, job)) return failed;
  return model;
}

// Step 3 for a section with a valid location: one that is read, or may be ignored.
bool Model::take_section(const layout::DirectoryEntry& found, std::uint32_t number,
                         DiagnosticLog& log) {
  const auto refuse = [&](Code code, const std::string& problem) {
    log.report_file(code, name_, problem,
                    code == Code("E4004")
                        ? "update panwright, or compile the model again with this version"
                        : "");
    return false;
  };
  const std::uint64_t features = header().required_features;
  if (is_derived(found) && !(features & layout::kFeatureMeshStreams))
    return refuse(Code("E4008"), section_name(found) +
                                     " is made from streams, but the header does not declare them");
  if (has_codec(found) && !is_derived(found) && !(features & layout::kFeatureCompressed))
    return refuse(Code("E4008"), section_name(found) +
                                     " is compressed, but the header does not declare compression");
  if (!known(found.kind) || found.version != 1) {
    if (found.flags & layout::kSectionOptional) return true;
    return refuse(Code("E4004"),
                  fmt::format("{} has version {}, which this program does not support",
                              section_name(found), found.version));
  }
  if (found.codec > static_cast<std::uint32_t>(layout::Codec::streams))
    return refuse(Code("E4004"),
                  fmt::format("{} is compressed by method {}, which this program does not support",
                              section_name(found), found.codec));
  if (const auto problem = missized(found, features)) return refuse(Code("E4008"), *problem);
  if (entry_of_kind_[found.kind] != 0)
    return refuse(Code("E4008"), section_name(found) + " is repeated");
  entry_of_kind_[found.kind] = number;
  if (used_in_place(found)) {
    content_[found.kind] = bytes_.subspan(found.offset, found.raw_length);
    return true;
  }
  // note: at most 1024 sections, each of at most 256 times a file's bytes and longer records
  const std::uint64_t stride = layout::kSections[layout::place_of(found.kind)].stride;
  if (has_codec(found)) unpacked_bytes_ += found.raw_length;
  if (found.stride != stride) unpacked_bytes_ += found.count * stride;
  return true;
}

// Whether all of the three sections are made from streams or none, and the streams are long enough
// for what they say.
bool Model::streams_fit(DiagnosticLog& log) {
  using layout::SectionKind;
  std::uint64_t raw = 0;
  int derived = 0;
  for (const SectionKind kind :
       {SectionKind::positions, SectionKind::normals, SectionKind::indices}) {
    const layout::DirectoryEntry* found = entry(kind);
    if (found == nullptr || !is_derived(*found)) continue;
    ++derived;
    raw += found->raw_length;
  }
  const layout::DirectoryEntry* bytes = entry(SectionKind::stream_bytes);
  const std::uint64_t stored = bytes ? bytes->stored_length : 0;
  const bool streams = entry(SectionKind::mesh_streams) != nullptr;
  std::string problem;
  if (derived != (streams ? 3 : 0) || streams != (bytes != nullptr))
    problem = fmt::format("{} of 3 sections are made from mesh streams, which the file has{}",
                          derived, streams && bytes ? "" : " not");
  else if (raw / layout::kMaxStreamed > stored)
    problem = fmt::format("section 'stream_bytes' stores {} bytes, too few for {} of meshes",
                          stored, raw);
  if (problem.empty()) return true;
  log.report_file(Code("E4008"), name_, problem);
  return false;
}

bool Model::parse(DiagnosticLog& log) {
  auto complaint = check_magic(bytes_);
  if (!complaint) complaint = check_header(header(), bytes_.size());
  if (!complaint &&
      header().directory_hash != internal::block_hash(bytes_.subspan(header().directory_offset)))
    complaint = Complaint{Code("E4007"),
                          fmt::format("the directory (from byte {}) does not match its checksum",
                                      header().directory_offset),
                          {}};
  if (complaint) {
    log.report_file(complaint->code, name_, complaint->message, complaint->hint);
    return false;
  }
  std::uint64_t begin = sizeof(layout::Header);
  std::uint32_t number = 0;
  for (const layout::DirectoryEntry& found : directory()) {
    ++number;
    if (const auto problem = misplaced(found, begin, header().directory_offset)) {
      log.report_file(Code("E4008"), name_, *problem);
      return false;
    }
    begin += found.stored_length;
    if (!take_section(found, number, log)) return false;
  }
  if (begin != header().directory_offset) {
    log.report_file(Code("E4008"), name_,
                    fmt::format("the sections end at byte {}, but the directory begins at {}",
                                begin, header().directory_offset));
    return false;
  }
  if (!streams_fit(log)) return false;
  if (unpacked_bytes_ > layout::kMaxUnpackedBytes) {
    log.report_file(Code("E4015"), name_,
                    fmt::format("the sections decompress to {} bytes, expected at most {}",
                                unpacked_bytes_, layout::kMaxUnpackedBytes));
    return false;
  }
  bool complete = true;
  for (const layout::SectionInfo& info : layout::kSections) {
    if (info.optional || entry(info.kind)) continue;
    log.report_file(Code("E4008"), name_, fmt::format("section '{}' is missing", info.name));
    complete = false;
  }
  return complete;
}

}  // namespace panwright::pan
