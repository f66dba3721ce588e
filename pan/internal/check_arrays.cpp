// Checksums of all sections and the contents of the big arrays, block by block: a block is still
// in the cache when its contents are checked.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>

#include "base/parallel.h"
#include "base/text.h"
#include "pan/internal/block_hash.h"
#include "pan/internal/report.h"
#include "pan/internal/scan.h"
#include "pan/internal/unpack.h"

namespace panwright::pan::internal {

namespace {

using layout::SectionKind;

// Invalid elements of one block of an array.
struct Found {
  Tally values;   // not finite, not unit, negative; elements of the array
  Tally outside;  // vertices outside their bounds; indices past the last vertex
};

// The mesh whose run holds an element, when runs tile the array. first: place of a mesh's run.
template <class First>
std::size_t mesh_of(const Model& model, std::uint64_t element, First first) {
  std::size_t from = 0, to = model.meshes().size();  // the first run behind the element is here
  while (from < to) {
    const std::size_t middle = from + (to - from) / 2;
    if (element < first(model, middle))
      to = middle;
    else
      from = middle + 1;
  }
  return from - 1;
}

std::uint64_t first_vertex(const Model& model, std::size_t m) { return model.first_vertex(m); }
std::uint64_t index_offset(const Model& model, std::size_t m) {
  return model.meshes()[m].index_offset;
}

bool finite(const layout::Float3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

void check_positions(const Model& model, std::uint64_t begin, std::uint64_t end, Found& found) {
  const auto positions = model.positions();
  const auto meshes = model.meshes();
  for (std::size_t m = mesh_of(model, begin, first_vertex); begin < end; ++m) {
    const layout::Mesh& mesh = meshes[m];
    const std::uint64_t stop =
        std::min<std::uint64_t>(end, model.first_vertex(m) + mesh.vertex_count);
    if (!all_within(&positions[begin].x, stop - begin, mesh.bounds_min, mesh.bounds_max)) {
      for (std::uint64_t i = begin; i < stop; ++i) {
        const layout::Float3& p = positions[i];
        if (!finite(p))
          found.values.add(i);
        else if (!all_within(&p.x, 1, mesh.bounds_min, mesh.bounds_max))
          found.outside.add(i);
      }
    }
    begin = stop;
  }
}

template <class Index>
void check_run(const Model& model, const layout::Mesh& mesh, std::uint64_t begin, std::uint64_t end,
               Found& found) {
  const std::byte* bytes = model.index_bytes().data();
  const auto* indices = reinterpret_cast<const Index*>(bytes + begin);
  const std::uint64_t run_end =
      mesh.index_offset + std::uint64_t{3} * mesh.triangle_count * sizeof(Index);
  const std::uint64_t stop = std::min(end, run_end);
  const std::size_t count = stop > begin ? (stop - begin) / sizeof(Index) : 0;
  if (!all_below(indices, count, mesh.vertex_count)) {
    for (std::size_t i = 0; i < count; ++i)
      if (indices[i] >= mesh.vertex_count) found.outside.add(begin + i * sizeof(Index));
  }
  for (std::uint64_t at = std::max(begin, run_end); at < end; ++at)
    if (bytes[at] != std::byte{0}) found.values.add(at);
}

void check_indices(const Model& model, std::uint64_t begin, std::uint64_t end, Found& found) {
  const auto meshes = model.meshes();
  for (std::size_t m = mesh_of(model, begin, index_offset); begin < end; ++m) {
    const std::uint64_t next =
        m + 1 < meshes.size() ? meshes[m + 1].index_offset : model.index_bytes().size();
    const std::uint64_t stop = std::min(end, next);
    if (meshes[m].index_size == 2)
      check_run<std::uint16_t>(model, meshes[m], begin, stop, found);
    else
      check_run<std::uint32_t>(model, meshes[m], begin, stop, found);
    begin = stop;
  }
}

// Elements [begin, end) of an array; for indices, bytes.
void check_elements(const Model& model, SectionKind kind, std::uint64_t begin, std::uint64_t end,
                    Found& found) {
  const std::size_t n = end - begin;
  switch (kind) {
    case SectionKind::positions:
      check_positions(model, begin, end, found);
      break;
    case SectionKind::normals: {
      const layout::Float3* first = &model.normals()[begin];
      if (all_unit(&first->x, n)) break;
      for (std::size_t i = 0; i < n; ++i)
        if (!all_unit(&first[i].x, 1)) found.values.add(begin + i);
      break;
    }
    case SectionKind::texcoords: {
      const layout::Float2* first = &model.texcoords()[begin];
      constexpr auto kMost = static_cast<float>(layout::kMaxNumber);
      if (all_between(&first->x, 2 * n, -kMost, kMost)) break;
      for (std::size_t i = 0; i < n; ++i)
        if (!all_between(&first[i].x, 2, -kMost, kMost)) found.values.add(begin + i);
      break;
    }
    case SectionKind::colors: {
      const layout::Float3* first = &model.colors()[begin];
      if (all_between(&first->x, 3 * n, 0, static_cast<float>(layout::kMaxColor))) break;
      for (std::size_t i = 0; i < n; ++i)
        if (!all_between(&first[i].x, 3, 0, static_cast<float>(layout::kMaxColor)))
          found.values.add(begin + i);
      break;
    }
    case SectionKind::indices:
      check_indices(model, begin, end, found);
      break;
    default:
      break;
  }
}

std::string others(const Tally& tally) {
  return tally.count > 1 ? fmt::format(" (and {} more)", tally.count - 1) : std::string();
}

std::string mesh_words(const Model& model, std::size_t m) {
  return fmt::format("meshes[{}] {}", m,
                     in_quotes(unchecked_string(model, model.meshes()[m].name)));
}

void describe_vertices(const Model& model, const Found& found, Problems& problems) {
  if (const Tally& bad = found.values; bad.count > 0) {
    const layout::Float3& p = model.positions()[bad.first];
    problems.push_back(
        {Code("E4012"), fmt::format("positions[{}] is {} {} {}, expected finite numbers{}",
                                    bad.first, p.x, p.y, p.z, others(bad))});
  }
  if (const Tally& bad = found.outside; bad.count > 0) {
    const layout::Float3& p = model.positions()[bad.first];
    const std::size_t m = mesh_of(model, bad.first, first_vertex);
    problems.push_back(
        {Code("E4013"), fmt::format("positions[{}] at {} {} {} lies outside the bounds of {}{}",
                                    bad.first, p.x, p.y, p.z, mesh_words(model, m), others(bad))});
  }
}

void describe_indices(const Model& model, const Found& found, Problems& problems) {
  if (const Tally& bad = found.values; bad.count > 0)
    problems.push_back(
        {Code("E4012"), fmt::format("byte {} of the padding between two runs of indices is not 0{}",
                                    bad.first, others(bad))});
  if (const Tally& bad = found.outside; bad.count > 0) {
    const std::size_t m = mesh_of(model, bad.first, index_offset);
    const layout::Mesh& mesh = model.meshes()[m];
    std::uint32_t value = 0;
    std::memcpy(&value, model.index_bytes().data() + bad.first, mesh.index_size);
    problems.push_back(
        {Code("E4010"), fmt::format("index {} of {} is {}, but the mesh has {} vertices{}",
                                    (bad.first - mesh.index_offset) / mesh.index_size,
                                    mesh_words(model, m), value, mesh.vertex_count, others(bad))});
  }
}

void describe(const Model& model, SectionKind kind, const Found& found, Problems& problems) {
  if (found.values.count == 0 && found.outside.count == 0) return;
  const std::uint64_t at = found.values.first;
  if (kind == SectionKind::positions) {
    describe_vertices(model, found, problems);
  } else if (kind == SectionKind::indices) {
    describe_indices(model, found, problems);
  } else if (kind == SectionKind::texcoords) {
    const layout::Float2& t = model.texcoords()[at];
    problems.push_back(
        {Code("E4012"), fmt::format("texcoords[{}] is {} {}, expected magnitudes of at most {}{}",
                                    at, t.x, t.y, layout::kMaxNumber, others(found.values))});
  } else {
    const bool normal = kind == SectionKind::normals;
    const layout::Float3& v = (normal ? model.normals() : model.colors())[at];
    problems.push_back(
        {Code("E4012"),
         fmt::format(
             "{}[{}] is {} {} {}, expected {}{}", normal ? "normals" : "colours", at, v.x, v.y, v.z,
             normal ? "a unit vector" : fmt::format("numbers from 0 to {}", layout::kMaxColor),
             others(found.values))});
  }
}

// One section while it is checked: its blocks and the problems of each.
struct Work {
  const layout::DirectoryEntry* entry;
  std::uint32_t element;  // bytes of an element; 0: contents are not checked
  std::size_t first_job;  // of its blocks among those of all sections
  std::vector<std::uint64_t> hashes;
  std::vector<Found> found;
};

void do_block(const Model& model, Work& work, std::size_t index) {
  const layout::DirectoryEntry& entry = *work.entry;
  work.hashes[index] =
      hash64(block(model.bytes().subspan(entry.offset, entry.stored_length), index));
  if (work.element == 0) return;
  // note: a block holds whole elements of each array, 8 and 12 bytes alike
  static_assert(layout::kHashBlock % 24 == 0);
  const std::uint64_t begin = index * layout::kHashBlock / work.element;
  const std::uint64_t end =
      std::min(begin + layout::kHashBlock / work.element, entry.raw_length / work.element);
  if (begin < end) check_elements(model, SectionKind{entry.kind}, begin, end, work.found[index]);
}

// Reports the invalid elements of the blocks or chunks of a section.
void describe_all(const Model& model, const layout::DirectoryEntry& entry,
                  const std::vector<Found>& parts, Problems& problems) {
  Found all;
  for (const Found& found : parts) {
    all.values.add(found.values);
    all.outside.add(found.outside);
  }
  describe(model, SectionKind{entry.kind}, all, problems);
}

void check_padding(const Model& model, const layout::DirectoryEntry& entry, Problems& problems) {
  const std::uint64_t used = has_codec(entry) ? entry.packed_length : entry.raw_length;
  const auto padding = model.bytes().subspan(entry.offset + used, entry.stored_length - used);
  if (std::any_of(padding.begin(), padding.end(), [](std::byte b) { return b != std::byte{0}; }))
    problems.push_back({Code("E4008"), section_words(entry) + " has padding bytes that are not 0"});
}

void finish(const Model& model, const Work& work, Problems& problems) {
  const layout::DirectoryEntry& entry = *work.entry;
  if (combined(work.hashes) != entry.hash) {
    problems.push_back({Code("E4009"), section_words(entry) + " does not match its checksum"});
    return;
  }
  check_padding(model, entry, problems);
  describe_all(model, entry, work.found, problems);
}

// Decompresses one array, and checks each chunk while it is in the cache.
std::optional<Problem> unpack_array(Model& model, const layout::DirectoryEntry& entry,
                                    Problems& problems, const Job& job) {
  const SectionKind kind{entry.kind};
  const auto chunks = chunks_of(model, entry);
  if (!chunks)
    return Problem{Code("E4015"),
                   section_words(entry) + " has chunks whose lengths do not add up to its length"};
  const auto to = Unpacked::make(model, kind, entry.raw_length);
  if (to.empty())
    return Problem{Code("E4015"),
                   fmt::format("{} decompresses to {} bytes, which exceeds the available memory",
                               section_words(entry), entry.raw_length)};
  std::vector<char> sound(chunks->count());
  std::vector<Found> found(chunks->count());
  parallel_for(
      chunks->count(),
      [&](std::size_t i) {
        sound[i] = chunks->unpack(i, to);
        if (sound[i])
          check_elements(model, kind, chunks->begin(i) / entry.stride,
                         chunks->end(i) / entry.stride, found[i]);
      },
      job);
  const auto bad = std::find(sound.begin(), sound.end(), 0);
  if (bad != sound.end())
    return Problem{Code("E4015"),
                   fmt::format("{} cannot be decompressed: chunk {} of {} is damaged",
                               section_words(entry), bad - sound.begin(), sound.size())};
  describe_all(model, entry, found, problems);
  return {};
}

// Checks an array that was made from streams, block by block.
void check_derived(const Model& model, const layout::DirectoryEntry& entry, Problems& problems,
                   const Job& job) {
  const std::uint64_t block = layout::kHashBlock / entry.stride;
  std::vector<Found> found(block_count(entry.raw_length));
  parallel_for(
      found.size(),
      [&](std::size_t i) {
        check_elements(model, SectionKind{entry.kind}, i * block,
                       std::min((i + 1) * block, entry.count), found[i]);
      },
      job);
  describe_all(model, entry, found, problems);
}

}  // namespace

std::string section_words(const layout::DirectoryEntry& entry) {
  const std::string name = kind_name(entry.kind);
  return fmt::format(
      "{} (bytes {} to {})",
      name.starts_with("kind ") ? "the section of " + name : "section '" + name + "'", entry.offset,
      entry.offset + entry.stored_length);
}

Problems section_problems(const Model& model, Part part, bool contents, std::uint32_t left,
                          const Job& cancel) {
  Problems problems;
  std::vector<Work> works;
  std::size_t jobs = 0;
  for (const layout::DirectoryEntry& entry : model.directory()) {
    if (is_array(entry.kind) != (part == Part::arrays)) continue;
    if (entry.kind == left && !has_codec(entry)) {
      check_padding(model, entry, problems);
      continue;
    }
    const std::size_t blocks = block_count(entry.stored_length);
    const bool look = contents && model.reads(entry) && !has_codec(entry);
    works.push_back({&entry, look ? entry.stride : 0, jobs, std::vector<std::uint64_t>(blocks),
                     std::vector<Found>(look ? blocks : 0)});
    jobs += blocks;
  }
  const auto work_of = [&](std::size_t job) -> Work& {
    const auto after =
        std::upper_bound(works.begin(), works.end(), job,
                         [](std::size_t j, const Work& work) { return j < work.first_job; });
    return *(after - 1);
  };
  const auto check_block = [&](std::size_t job) {
    Work& work = work_of(job);
    do_block(model, work, job - work.first_job);
  };
  const auto place_of = [&](std::size_t job) {
    const Work& work = work_of(job);
    return work.entry->offset + (job - work.first_job) * layout::kHashBlock;
  };
  // note: the memory of a part is given back before the next one is looked at
  constexpr std::size_t kPart = 512;  // blocks, 384 MiB
  for (std::size_t first = 0; first < jobs; first += kPart) {
    const std::size_t count = std::min(kPart, jobs - first);
    parallel_for(
        count, [&](std::size_t i) { check_block(first + i); }, cancel);
    const std::uint64_t begin = place_of(first), end = place_of(first + count - 1);
    model.release(model.bytes().subspan(begin, end + layout::kHashBlock > model.bytes().size()
                                                   ? model.bytes().size() - begin
                                                   : end + layout::kHashBlock - begin));
  }
  for (const Work& work : works) finish(model, work, problems);
  return problems;
}

Problems unpack_arrays(Model& model, const Job& job) {
  Problems problems = unpack_streams(model, job);
  if (!problems.empty()) return problems;
  for (const layout::DirectoryEntry& entry : model.directory()) {
    if (!model.reads(entry) || !is_array(entry.kind) || !has_codec(entry)) continue;
    try {
      if (is_derived(entry)) {
        check_derived(model, entry, problems, job);
        continue;
      }
      if (auto problem = unpack_array(model, entry, problems, job)) {
        Unpacked::drop(model, SectionKind{entry.kind});
        problems.push_back(*std::move(problem));
      }
    } catch (const Cancelled&) {
      Unpacked::drop(model, SectionKind{entry.kind});
      throw;
    }
  }
  return problems;
}

}  // namespace panwright::pan::internal
