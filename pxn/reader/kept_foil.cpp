#include "pxn/reader/kept_foil.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "base/axis_box.h"
#include "geometry/mesh/bytes.h"
#include "geometry/mesh/check.h"
#include "mli/trim.h"

namespace panwright::pxn {

namespace {

// Of the room: what takes no more is no different where there is more room. note: levels together
// are smaller than what they are levels of
constexpr double kRoomy = 0.25;
// of a mesh's diagonal: vertices that are welded, and rounding
constexpr double kSlack = 1e-5;

// What a key is of.
enum class Kept : std::uint64_t { sheet, asked, woven, reach };

// nothing that could be padding
static_assert(sizeof(mli::Statistics) == sizeof(double) * 19 + 8 * mli::Statistics::kBins);

void write(const mli::Statistics& statistics, ByteWriter& to) {
  to.list(std::span(&statistics, 1));
}

mli::Statistics read_statistics(ByteReader& from) {
  std::vector<mli::Statistics> values;
  from.list(values);
  if (values.size() == 1) return values[0];
  from.fail();
  return {};
}

bool same(const SourceSpan& a, const SourceSpan& b) {
  return a.file == b.file && a.begin == b.begin && a.end == b.end;
}

bool has_all(const geometry::Mesh& mesh) {
  return !mesh.triangles.empty() && !mesh.normals.empty() && !mesh.texcoords.empty();
}

geometry::MeshShape read_whole_mesh(ByteReader& from) {
  auto out = std::make_shared<geometry::Mesh>(geometry::read_mesh(from));
  if (!has_all(*out)) from.fail();
  return out;
}

void write(const FoilMeshes::Part& part, ByteWriter& to) {
  to.number(part.finest ? 1 : 0);
  if (part.finest) geometry::write(*part.finest, to);
  to.number(part.levels.size());
  for (const scene::FoilLevel& level : part.levels) {
    geometry::write(*level.mesh, to);
    to.real(level.detail);
    to.real(level.error);
  }
}

FoilMeshes::Part read_part(ByteReader& from) {
  FoilMeshes::Part part;
  if (from.number() != 0) part.finest = read_whole_mesh(from);
  for (std::uint64_t left = from.number(); left > 0 && from.good(); --left) {
    auto mesh = read_whole_mesh(from);
    const double detail = from.real();
    part.levels.push_back({std::move(mesh), detail, from.real()});
  }
  return part;
}

void write(const FoilMeshes& meshes, ByteWriter& to) {
  write(meshes.statistics, to);
  for (const FoilMeshes::Part& part : meshes.parts) write(part, to);
  to.real(meshes.vertices);
}

FoilMeshes read_meshes(ByteReader& from) {
  FoilMeshes meshes;
  meshes.statistics = read_statistics(from);
  for (FoilMeshes::Part& part : meshes.parts) part = read_part(from);
  meshes.vertices = from.real();
  if (!std::isfinite(meshes.vertices)) from.fail();
  return meshes;
}

bool is_empty(const FoilMeshes& meshes) {
  return std::ranges::none_of(meshes.parts,
                              [](const auto& part) { return part.finest != nullptr; });
}

void write(const mli::WrapTally& tally, ByteWriter& to) {
  for (const std::size_t count : {tally.groups, tally.refused, tally.scaled}) to.number(count);
  for (const double value : {tally.area, tally.area_refused, tally.held, tally.least})
    to.real(value);
  to.number(tally.reasons.size());
  for (const auto& [reason, count] : tally.reasons) {
    to.text(reason);
    to.number(count);
  }
}

mli::WrapTally read_tally(ByteReader& from) {
  mli::WrapTally tally;
  for (std::size_t* count : {&tally.groups, &tally.refused, &tally.scaled}) *count = from.number();
  for (double* value : {&tally.area, &tally.area_refused, &tally.held, &tally.least})
    *value = from.real();
  for (std::uint64_t left = from.number(); left > 0 && from.good(); --left) {
    const std::string reason = from.text();
    tally.reasons[reason] = from.number();
  }
  return tally;
}

void write(const Asked& asked, ByteWriter& to) {
  to.real(asked.parts);
  to.real(asked.corners);
}

Asked read_asked(ByteReader& from) {
  Asked asked;
  asked.parts = from.real();
  asked.corners = from.real();
  if (!(asked.parts >= 0 && asked.corners >= 0 && std::isfinite(asked.parts + asked.corners)))
    from.fail();
  return asked;
}

// Of what a blanket is made of, wherever it is: under it lies how far such blankets have asked.
Hash128 asked_key(const WovenFrom& from) {
  KeyHasher key;
  key.number(static_cast<std::uint64_t>(Kept::asked));
  geometry::add_to_key(from.around.metres, key);
  key.list(from.around.faces);
  for (int k = 0; k < 9; ++k) key.real(from.shape_from_metres[k / 3][k % 3]);
  key.list(from.how);
  return key.key();
}

Hash128 woven_key(const WovenFrom& from, const Hash128& made_of, const Asked& asked) {
  KeyHasher key;
  key.number(static_cast<std::uint64_t>(Kept::woven));
  key.hash(made_of);
  key.real(asked.parts);
  key.real(asked.corners);
  from.around.add_near(asked, key);
  return key.key();
}

// Of tops and roots, which are read where they are asked for alone.
Hash128 reach_key(const Hash128& woven) {
  KeyHasher key;
  key.number(static_cast<std::uint64_t>(Kept::reach));
  key.hash(woven);
  return key.key();
}

}  // namespace

bool write(const MadeFoil& made, const mli::RecipePlaces& places, ByteWriter& to) {
  write(made.meshes, to);
  to.number(made.said.size());
  for (const Diagnostic& entry : made.said) {
    if (entry.code != Code("W7002") || !same(entry.where, places.recipe) || !entry.object.empty())
      return false;
    to.text(entry.message);
    to.text(entry.hint);
  }
  return true;
}

MadeFoil read_made(const mli::RecipePlaces& places, ByteReader& from) {
  MadeFoil out;
  out.meshes = read_meshes(from);
  if (is_empty(out.meshes)) from.fail();
  for (std::uint64_t left = from.number(); left > 0 && from.good(); --left) {
    std::string message = from.text();
    out.said.push_back({Code("W7002"), places.recipe, std::move(message), {}, from.text()});
  }
  return out;
}

void write(const WovenFoil& woven, ByteWriter& to) {
  write(woven.meshes, to);
  to.number(woven.triangles);
  to.real(woven.recipe.width);
  to.real(woven.recipe.height);
  to.number(woven.recipe.xgrid);
  to.number(woven.recipe.seed);
  write(woven.tally, to);
  to.number(woven.cornered ? 1 : 0);
  write(woven.asked, to);
}

WovenFoil read_woven(ByteReader& from) {
  WovenFoil out;
  out.meshes = read_meshes(from);
  out.triangles = from.number();
  // where all groups are refused there is none
  if (is_empty(out.meshes) != (out.triangles == 0)) from.fail();
  out.recipe.width = from.real();
  out.recipe.height = from.real();
  out.recipe.xgrid = static_cast<std::uint32_t>(from.number());
  out.recipe.seed = static_cast<std::uint32_t>(from.number());
  out.tally = read_tally(from);
  out.cornered = from.number() != 0;
  out.asked = read_asked(from);
  return out;
}

std::optional<MadeFoil> kept_or_made(const WorkCache* cache, const FoilSheet& foil,
                                     double crease_angle, double room,
                                     const std::function<std::optional<MadeFoil>()>& make) {
  const auto key = [&] {
    KeyHasher hasher;
    hasher.number(static_cast<std::uint64_t>(Kept::sheet));
    hasher.list(foil.key());
    hasher.real(crease_angle);
    return hasher.key();
  };
  const auto roomy = [&](const MadeFoil& made) { return made.meshes.vertices <= kRoomy * room; };
  return remember<MadeFoil>(
      cache, Work::foil, key, make,
      [&](const MadeFoil& made, ByteWriter& to) {
        return roomy(made) && write(made, foil.places, to);
      },
      [&](ByteReader& from) {
        MadeFoil made = read_made(foil.places, from);
        if (!roomy(made)) from.fail();
        return made;
      });
}

bool Surroundings::add_near(const Asked& asked, KeyHasher& key) const {
  const auto world = [&](std::uint32_t v) {
    return Vec3(world_from_metres * Vec4(metres.positions[v], 1));
  };
  std::vector<AxisBox> boxes(faces.size());
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (const std::uint32_t v : metres.triangles[faces[i]]) boxes[i].add(world(v));
  AxisBox all;
  for (const Vec3& p : metres.positions) all.add(p);
  const double slack = all.empty() ? 0 : kSlack * glm::length(all.high - all.low);
  const auto widen = [&](double by) {
    for (AxisBox& box : boxes) box.widen(by);
  };
  widen(asked.parts + slack);
  const bool parts = obstacles.add_near(of, boxes, key);
  widen(asked.corners - asked.parts);
  const bool others = corners.add_near(static_cast<std::uint32_t>(of), boxes, key);
  if (!parts && !others) return false;
  for (int k = 0; k < 16; ++k) key.real(world_from_metres[k / 4][k % 4]);
  return true;
}

WovenFoil woven_from(mli::Wrap wrap, const Mat3& shape_from_metres) {
  WovenFoil out;
  out.tally.add(wrap);
  out.triangles = wrap.blanket.triangles.size();
  const mli::WrapGroup* largest = nullptr;
  for (const mli::WrapGroup& group : wrap.groups)
    if (group.accepted && (largest == nullptr || group.area > largest->area)) largest = &group;
  if (largest != nullptr) {
    out.recipe = largest->recipe;
    out.recipe.operations.clear();
    out.meshes.statistics = largest->statistics;
  }
  const Mat3 covector = glm::transpose(glm::inverse(shape_from_metres));
  const double scale = std::cbrt(std::fabs(glm::determinant(shape_from_metres)));
  for (std::size_t k = 0; k < mli::kCovers; ++k) {
    // null: there is none
    const auto part = [&](const geometry::Mesh& all, const std::vector<mli::Cover>& covers) {
      auto mesh =
          std::make_shared<geometry::Mesh>(mli::part_of(all, covers, static_cast<mli::Cover>(k)));
      if (mesh->triangles.empty()) return geometry::MeshShape();
      for (Vec3& p : mesh->positions) p = shape_from_metres * p;
      for (Vec3& n : mesh->normals) n = glm::normalize(covector * n);
      geometry::set_closed(*mesh);
      out.meshes.vertices += static_cast<double>(mesh->positions.size());
      return geometry::MeshShape(std::move(mesh));
    };
    FoilMeshes::Part& to = out.meshes.parts[k];
    to.finest = part(wrap.blanket, wrap.covers);
    if (!to.finest) continue;
    for (const mli::WrapLevel& level : wrap.levels)
      if (auto mesh = part(level.blanket, level.covers))
        to.levels.push_back({std::move(mesh), scale * level.detail, scale * level.error});
  }
  out.tops = std::move(wrap.blanket.positions);
  out.roots = std::move(wrap.roots);
  return out;
}

namespace {

// A blanket that was kept; nothing: there is none that is whole.
std::optional<WovenFoil> kept(const WorkCache& cache, const WovenFrom& from, const Hash128& key) {
  auto found = cache.recall<WovenFoil>(Work::foil, key, read_woven);
  if (!found || !from.shared) return found;
  const auto reach = cache.recall<bool>(Work::foil, reach_key(key), [&](ByteReader& reader) {
    reader.list(found->tops);
    reader.list(found->roots);
    if (found->tops.size() != found->roots.size()) reader.fail();
    return true;
  });
  if (!reach) found.reset();
  return found;
}

void keep(const WorkCache& cache, const WovenFoil& woven, const Hash128& key) {
  cache.store(Work::foil, key, woven, [](const WovenFoil& all, ByteWriter& to) { write(all, to); });
  cache.store(Work::foil, reach_key(key), woven, [](const WovenFoil& all, ByteWriter& to) {
    to.list(all.tops);
    to.list(all.roots);
  });
}

}  // namespace

std::optional<WovenFoil> kept_or_woven(const WorkCache* cache, const WovenFrom& from,
                                       const std::function<std::optional<WovenFoil>()>& make) {
  if (cache == nullptr) return make();
  const Hash128 made_of = asked_key(from);
  const auto roomy = [&](const WovenFoil& woven) {
    return static_cast<double>(woven.triangles) <= kRoomy * from.room;
  };
  // a blanket that asks no further than this sees the same if all is the same as far as this
  const auto known = cache->recall<Asked>(Work::foil, made_of, read_asked);
  if (known)
    if (auto found = kept(*cache, from, woven_key(from, made_of, *known)); found && roomy(*found)) {
      cache->count(Work::foil, true);
      return found;
    }
  auto made = make();
  cache->count(Work::foil, false);
  if (!made || !roomy(*made)) return made;
  Asked most = made->asked;
  if (known) most = {std::max(most.parts, known->parts), std::max(most.corners, known->corners)};
  if (!known || most.parts > known->parts || most.corners > known->corners)
    cache->store(Work::foil, made_of, most,
                 [](const Asked& asked, ByteWriter& to) { write(asked, to); });
  keep(*cache, *made, woven_key(from, made_of, most));
  return made;
}

}  // namespace panwright::pxn
