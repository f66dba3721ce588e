#include "compiler/internal/visibility_cache.h"

#include <cstring>
#include <type_traits>

namespace panwright::compiler::internal {

namespace {

// About 30 ms. A shorter search is not worth a file.
constexpr std::uint64_t kLeastRays = 100'000;

template <class T>
std::span<const std::byte> bytes_of(const T& value) {
  static_assert(std::has_unique_object_representations_v<T> || std::is_same_v<T, double>);
  return std::as_bytes(std::span(&value, 1));
}

class Writer {
 public:
  void number(std::uint64_t value) {
    const auto bytes = bytes_of(value);
    out.insert(out.end(), bytes.begin(), bytes.end());
  }
  void flags(const std::vector<char>& values) {
    number(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (i % 8 == 0) out.push_back(std::byte{0});
      if (values[i]) out.back() |= std::byte{1} << (i % 8);
    }
  }
  std::vector<std::byte> out;
};

class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : left_(bytes) {}
  std::uint64_t number() {
    std::uint64_t value = 0;
    if (!has(sizeof value)) return 0;
    std::memcpy(&value, left_.data(), sizeof value);
    left_ = left_.subspan(sizeof value);
    return value;
  }
  // Expects as many as are wanted.
  std::vector<char> flags(std::size_t count) {
    const std::size_t bytes = count / 8 + (count % 8 != 0);
    if (number() != count || !has(bytes)) {
      good_ = false;
      return {};
    }
    std::vector<char> values(count);
    for (std::size_t i = 0; i < count; ++i)
      values[i] = (left_[i / 8] >> (i % 8) & std::byte{1}) != std::byte{0};
    left_ = left_.subspan(bytes);
    return values;
  }
  bool good() const { return good_; }
  bool at_end() const { return good_ && left_.empty(); }

 private:
  bool has(std::size_t bytes) { return good_ = good_ && left_.size() >= bytes; }
  std::span<const std::byte> left_;
  bool good_ = true;
};

}  // namespace

Hash128 visibility_key(const VisibilityModel& model, const VisibilityOptions& options) {
  Hasher hasher;
  const auto number = [&](std::uint64_t value) { hasher.update(bytes_of(value)); };
  const auto real = [&](double value) { hasher.update(bytes_of(value)); };
  number(kVisibilityVersion);
  number(options.rays_per_triangle);
  number(options.max_rays);
  real(options.least_slack);
  number(model.meshes.size());
  for (std::size_t m = 0; m < model.meshes.size(); ++m) {
    const geometry::Mesh& mesh = *model.meshes[m];
    number(model.divisible[m] != 0);
    number(mesh.positions.size());
    hasher.update(std::as_bytes(std::span(mesh.positions)));
    number(mesh.triangles.size());
    hasher.update(std::as_bytes(std::span(mesh.triangles)));
  }
  number(model.parts.size());
  for (const VisibilityPart& part : model.parts) {
    number(part.mesh);
    for (int column = 0; column < 4; ++column)
      for (int row = 0; row < 4; ++row) real(part.world_from_mesh[column][row]);
    number(part.transparent);
    number(part.candidate);
  }
  return hasher.digest128();
}

std::vector<std::byte> visibility_bytes(const Visibility& found) {
  Writer to;
  for (const std::uint64_t value :
       {found.rays, found.last_found, found.probes, found.ambiguous, std::uint64_t{found.capped}})
    to.number(value);
  to.flags(found.part_visible);
  for (const std::vector<char>& shown : found.shown) to.flags(shown);
  return std::move(to.out);
}

std::optional<Visibility> visibility_from(std::span<const std::byte> bytes,
                                          const VisibilityModel& model) {
  Reader from(bytes);
  Visibility found;
  found.rays = from.number();
  found.last_found = from.number();
  found.probes = from.number();
  found.ambiguous = from.number();
  found.capped = from.number() != 0;
  found.part_visible = from.flags(model.parts.size());
  for (std::size_t m = 0; m < model.meshes.size() && from.good(); ++m)
    found.shown.push_back(from.flags(model.meshes[m]->triangles.size()));
  if (!from.at_end()) return std::nullopt;
  return found;
}

Visibility cached_visibility_of(const VisibilityModel& model, const VisibilityOptions& options,
                                const FileCache* cache, bool* known, const Job& job) {
  *known = false;
  if (cache == nullptr) return visibility_of(model, options, job);
  const Hash128 key = visibility_key(model, options);
  if (const auto entry = cache->find(key))
    if (auto found = visibility_from(*entry, model)) {
      *known = true;
      return *std::move(found);
    }
  Visibility found = visibility_of(model, options, job);
  if (found.rays >= kLeastRays) cache->keep(key, visibility_bytes(found));
  return found;
}

}  // namespace panwright::compiler::internal
