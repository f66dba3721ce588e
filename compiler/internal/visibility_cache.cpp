#include "compiler/internal/visibility_cache.h"

#include <optional>
#include <vector>

namespace panwright::compiler::internal {

namespace {

// About 30 ms. A shorter search is not worth a file.
constexpr std::uint64_t kLeastRays = 100'000;

// A bit per element.
void write_flags(const std::vector<char>& flags, ByteWriter& to) {
  std::vector<std::uint8_t> bits((flags.size() + 7) / 8);
  for (std::size_t i = 0; i < flags.size(); ++i)
    if (flags[i]) bits[i / 8] |= static_cast<std::uint8_t>(1 << (i % 8));
  to.number(flags.size());
  to.list(bits);
}

std::vector<char> read_flags(std::size_t count, ByteReader& from) {
  std::vector<std::uint8_t> bits;
  if (from.number() != count) from.fail();
  from.list(bits);
  if (bits.size() != (count + 7) / 8) from.fail();
  if (!from.good()) return {};
  std::vector<char> flags(count);
  for (std::size_t i = 0; i < count; ++i) flags[i] = static_cast<char>(bits[i / 8] >> (i % 8) & 1);
  return flags;
}

}  // namespace

Hash128 visibility_key(const VisibilityModel& model, const VisibilityOptions& options) {
  KeyHasher key;
  key.number(options.rays_per_triangle);
  key.number(options.max_rays);
  key.real(options.least_slack);
  key.number(model.meshes.size());
  for (std::size_t m = 0; m < model.meshes.size(); ++m) {
    key.number(model.divisible[m] != 0);
    key.list(model.meshes[m]->positions);
    key.list(model.meshes[m]->triangles);
  }
  key.number(model.parts.size());
  for (const VisibilityPart& part : model.parts) {
    key.number(part.mesh);
    for (int k = 0; k < 16; ++k) key.real(part.world_from_mesh[k / 4][k % 4]);
    key.number(part.transparent);
    key.number(part.candidate);
  }
  return key.key();
}

void write_visibility(const Visibility& found, ByteWriter& to) {
  for (const std::uint64_t value :
       {found.rays, found.last_found, found.probes, found.ambiguous, std::uint64_t{found.capped}})
    to.number(value);
  write_flags(found.part_visible, to);
  for (const std::vector<char>& shown : found.shown) write_flags(shown, to);
}

Visibility read_visibility(const VisibilityModel& model, ByteReader& from) {
  Visibility found;
  for (std::uint64_t* value : {&found.rays, &found.last_found, &found.probes, &found.ambiguous})
    *value = from.number();
  found.capped = from.number() != 0;
  found.part_visible = read_flags(model.parts.size(), from);
  for (std::size_t m = 0; m < model.meshes.size() && from.good(); ++m)
    found.shown.push_back(read_flags(model.meshes[m]->triangles.size(), from));
  return found;
}

Visibility cached_visibility_of(const VisibilityModel& model, const VisibilityOptions& options,
                                const WorkCache* cache, bool* known, const Job& job) {
  *known = true;
  return *remember<Visibility>(
      cache, Work::hidden, [&] { return visibility_key(model, options); },
      [&] {
        *known = false;
        return std::optional(visibility_of(model, options, job));
      },
      [](const Visibility& found, ByteWriter& to) {
        write_visibility(found, to);
        return found.rays >= kLeastRays;
      },
      [&](ByteReader& from) { return read_visibility(model, from); });
}

}  // namespace panwright::compiler::internal
