#include "compiler/internal/visibility_state.h"

namespace panwright::compiler::internal {

namespace {

constexpr std::uint64_t kRaysOfTriangle = 4;  // beyond max_rays, for each of a mesh

}  // namespace

VisibilityState::VisibilityState(const VisibilityModel& model, const VisibilityOptions& options,
                                 const Job& job)
    : model_(model), options_(options), job_(job), rays_(model, options, job) {
  mesh_first_.push_back(0);
  for (const auto& mesh : model_.meshes)
    mesh_first_.push_back(mesh_first_.back() + static_cast<std::uint32_t>(mesh->triangles.size()));
  triangles_.resize(mesh_first_.back(), State::unknown);
  directions_.resize(mesh_first_.back());
  parts_.resize(model_.parts.size(), State::unknown);
  parts_of_.resize(model_.meshes.size());
  for (std::uint32_t p = 0; p < parts_.size(); ++p) {
    const VisibilityPart& part = model_.parts[p];
    parts_of_[part.mesh].push_back(p);
    if (!part.candidate) parts_[p] = State::seen;
    if (!part.candidate || !model_.divisible[part.mesh])
      for (std::uint32_t i = mesh_first_[part.mesh]; i < mesh_first_[part.mesh + 1]; ++i)
        triangles_[i] = State::seen;
  }
  exposed_.resize(rays_.triangles(), 0);
  near_exposed_.resize(exposed_.size(), 0);
  side_seen_.resize(2 * std::size_t{rays_.triangles()}, 0);
  side_exposed_.resize(side_seen_.size(), 0);
  max_rays_ = options_.max_rays + kRaysOfTriangle * mesh_first_.back();
}

Visibility VisibilityState::result() const {
  Visibility out;
  for (const State state : parts_) out.part_visible.push_back(state != State::unknown);
  for (std::size_t m = 0; m < model_.meshes.size(); ++m) {
    auto& shown = out.shown.emplace_back();
    for (std::uint32_t i = mesh_first_[m]; i < mesh_first_[m + 1]; ++i)
      shown.push_back(triangles_[i] == State::seen || triangles_[i] == State::kept);
  }
  out.rays = cast_;
  out.last_found = last_found_;
  out.probes = done_;
  out.ambiguous = ambiguous_;
  out.capped = capped_;
  return out;
}

void VisibilityState::keep(std::uint32_t w) {
  if (!is_undecided(w)) return;
  ++ambiguous_;
  State& triangle = triangles_[index_of(w)];
  State& part = parts_[rays_.part_of(w)];
  if (triangle == State::unknown) triangle = State::kept;
  if (part == State::unknown) part = State::kept;
}

bool VisibilityState::mark(const Find& find) {
  const bool fresh = !is_seen(find.triangle);
  side_seen_[2 * std::size_t{find.triangle} + find.side] = 1;
  const std::uint32_t index = index_of(find.triangle);
  if (triangles_[index] == State::hidden_alone) return fresh;
  if (fresh) directions_[index] = find.direction;
  triangles_[index] = State::seen;
  parts_[rays_.part_of(find.triangle)] = State::seen;
  return fresh;
}

std::vector<std::uint32_t> VisibilityState::undecided(Which which) {
  std::vector<std::uint32_t> out;
  for (std::uint32_t w = 0; w < rays_.triangles(); ++w) {
    if (!is_undecided(w)) continue;
    if (exposed_[w] && keep_exposed_)
      keep(w);
    else if (which == Which::all || (which == Which::exposed) == (exposed_[w] != 0))
      out.push_back(w);
  }
  return out;
}

void VisibilityState::fit(std::vector<std::uint32_t>& items, std::uint64_t each) {
  const std::uint64_t left = max_rays_ > cast_ ? max_rays_ - cast_ : 0;
  if (items.size() * each <= left) return;
  const auto count = static_cast<std::size_t>(left / each);
  for (std::size_t i = count; i < items.size(); ++i) keep(items[i]);
  items.resize(count);
  capped_ = true;
}

}  // namespace panwright::compiler::internal
