#include "pan/internal/unpack.h"

#include <fmt/core.h>

#include <algorithm>
#include <cassert>
#include <cstring>
#include <new>

#include "base/parallel.h"
#include "pan/internal/mesh_stream.h"
#include "pan/internal/report.h"

namespace panwright::pan::internal {

namespace {

using layout::DirectoryEntry;
using layout::FieldDefault;
using layout::FieldType;
using layout::SectionKind;

std::size_t size_of(FieldType type) {
  constexpr std::size_t kSizes[] = {1, 2, 4, 4, 8, 4, 8};  // in the order of FieldType
  static_assert(static_cast<std::size_t>(FieldType::f64) + 1 == std::size(kSizes));
  return kSizes[static_cast<std::size_t>(type)];
}

template <class T>
void store(std::byte* to, double value) {
  const auto number = static_cast<T>(value);
  std::memcpy(to, &number, sizeof number);
}

void store_default(std::byte* to, FieldType type, double value) {
  switch (type) {
    case FieldType::u8:
      return store<std::uint8_t>(to, value);
    case FieldType::u16:
      return store<std::uint16_t>(to, value);
    case FieldType::u32:
      return store<std::uint32_t>(to, value);
    case FieldType::i32:
      return store<std::int32_t>(to, value);
    case FieldType::u64:
      return store<std::uint64_t>(to, value);
    case FieldType::f32:
      return store<float>(to, value);
    case FieldType::f64:
      return store<double>(to, value);
  }
}

Problem no_memory(const DirectoryEntry& entry, std::uint64_t bytes) {
  return {Code("E4015"),
          fmt::format("{} decompresses to {} bytes, which exceeds the available memory",
                      section_words(entry), bytes)};
}

// Unpacks every chunk of a section into `to`.
std::optional<Problem> unpack(const Model& model, const DirectoryEntry& entry,
                              std::span<std::byte> to) {
  const auto chunks = chunks_of(model, entry);
  if (!chunks)
    return Problem{Code("E4015"),
                   section_words(entry) + " has chunks whose lengths do not add up to its length"};
  std::vector<char> sound(chunks->count());
  parallel_for(sound.size(), [&](std::size_t i) { sound[i] = chunks->unpack(i, to); });
  const auto bad = std::find(sound.begin(), sound.end(), 0);
  if (bad == sound.end()) return {};
  return Problem{Code("E4015"),
                 fmt::format("{} cannot be decompressed: chunk {} of {} is damaged",
                             section_words(entry), bad - sound.begin(), sound.size())};
}

std::optional<Problem> resize(Model& model, const DirectoryEntry& entry,
                              std::span<const std::byte> records) {
  const SectionKind kind{entry.kind};
  const std::uint32_t stride = layout::kSections[layout::place_of(entry.kind)].stride;
  if (entry.count == 0) return {};
  const auto to = Unpacked::make(model, kind, entry.count * stride);
  if (to.empty()) return no_memory(entry, entry.count * stride);
  std::vector<FieldDefault> defaults;
  std::copy_if(layout::kFieldDefaults.begin(), layout::kFieldDefaults.end(),
               std::back_inserter(defaults),
               [&](const FieldDefault& field) { return field.section == kind; });
  resize_records(records, entry.stride, to, stride, defaults);
  return {};
}

std::optional<Problem> unpack_table(Model& model, const DirectoryEntry& entry) {
  const std::uint32_t stride = layout::kSections[layout::place_of(entry.kind)].stride;
  if (!has_codec(entry))
    return resize(model, entry, model.bytes().subspan(entry.offset, entry.raw_length));
  if (entry.stride == stride) {
    const auto to = Unpacked::make(model, SectionKind{entry.kind}, entry.raw_length);
    return to.empty() ? no_memory(entry, entry.raw_length) : unpack(model, entry, to);
  }
  const std::unique_ptr<std::byte[]> raw(new (std::nothrow) std::byte[entry.raw_length]);
  if (!raw) return no_memory(entry, entry.raw_length);
  const std::span<std::byte> records(raw.get(), entry.raw_length);
  if (auto problem = unpack(model, entry, records)) return problem;
  return resize(model, entry, records);
}

}  // namespace

std::span<std::byte> Unpacked::make(Model& model, SectionKind kind, std::uint64_t bytes) {
  const auto number = static_cast<std::uint32_t>(kind);
  auto& memory = model.unpacked_[number];
  auto& content = model.content_[number];
  if (!memory || content.size() != bytes) {
    memory.reset(new (std::nothrow) std::byte[bytes]);
    content =
        memory ? std::span<const std::byte>(memory.get(), bytes) : std::span<const std::byte>();
  }
  return {memory.get(), content.size()};
}

void Unpacked::drop(Model& model, SectionKind kind) {
  const auto number = static_cast<std::uint32_t>(kind);
  model.content_[number] = {};
  model.unpacked_[number].reset();
}

std::optional<PackedChunks> chunks_of(const Model& model, const DirectoryEntry& entry) {
  return PackedChunks::of(model.bytes().subspan(entry.offset, entry.packed_length),
                          plane_count(entry.kind, entry.stride), entry.raw_length);
}

void resize_records(std::span<const std::byte> from, std::uint32_t from_stride,
                    std::span<std::byte> to, std::uint32_t to_stride,
                    std::span<const FieldDefault> defaults) {
  const std::size_t count = to.size() / to_stride;
  assert(from.size() == count * from_stride && to.size() == count * to_stride);
  // the content of every record before its own bytes are copied over it
  std::vector<std::byte> lacking(to_stride);
  std::size_t kept = std::min(from_stride, to_stride);
  for (const FieldDefault& field : defaults) {
    const std::size_t size = size_of(field.type);
    const std::size_t end = field.offset + field.count * size;
    if (end <= from_stride) continue;
    kept = std::min<std::size_t>(kept, field.offset);
    for (std::size_t at = field.offset; at < end; at += size)
      store_default(&lacking[at], field.type, field.value);
  }
  for (std::size_t i = 0; i < count; ++i) {
    std::memcpy(&to[i * to_stride], lacking.data(), to_stride);
    std::memcpy(&to[i * to_stride], &from[i * from_stride], kept);
  }
}

Problems unpack_tables(Model& model, const Job& job) {
  Problems problems;
  for (const DirectoryEntry& entry : model.directory()) {
    if (!model.reads(entry) || is_array(entry.kind)) continue;
    if (!has_codec(entry) && entry.stride == layout::kSections[layout::place_of(entry.kind)].stride)
      continue;
    job.poll();
    if (auto problem = unpack_table(model, entry)) {
      Unpacked::drop(model, SectionKind{entry.kind});
      problems.push_back(*std::move(problem));
    }
  }
  return problems;
}

Problems unpack_streams(Model& model, const Job& job) {
  const auto streams = model.mesh_streams();
  const auto meshes = model.meshes();
  if (streams.empty()) return {};
  std::span<std::byte> to[3];
  constexpr SectionKind kKinds[] = {SectionKind::positions, SectionKind::normals,
                                    SectionKind::indices};
  const auto drop = [&] {
    for (const SectionKind kind : kKinds) Unpacked::drop(model, kind);
  };
  for (std::size_t k = 0; k < 3; ++k) {
    const DirectoryEntry& entry = *model.entry(kKinds[k]);
    to[k] = Unpacked::make(model, kKinds[k], entry.raw_length);
    if (!to[k].empty()) continue;
    drop();
    return {no_memory(entry, entry.raw_length)};
  }
  std::vector<char> sound(meshes.size());
  try {
    parallel_for(
        meshes.size(),
        [&](std::size_t i) {
          const layout::Mesh& mesh = meshes[i];
          const std::size_t vertex = std::size_t{12} * mesh.first_vertex;
          sound[i] = decode(
              streams[i], {mesh.vertex_count, mesh.triangle_count, mesh.index_size},
              model.stream_bytes().subspan(streams[i].offset, streams[i].length),
              {reinterpret_cast<float*>(to[0].data() + vertex),
               reinterpret_cast<float*>(to[1].data() + vertex), to[2].data() + mesh.index_offset});
        },
        job);
  } catch (const Cancelled&) {
    drop();
    throw;
  }
  const auto bad = std::find(sound.begin(), sound.end(), 0);
  if (bad == sound.end()) return {};
  drop();
  return {Problem{Code("E4015"),
                  fmt::format("the stream of meshes[{}] is damaged", bad - sound.begin())}};
}

}  // namespace panwright::pan::internal
