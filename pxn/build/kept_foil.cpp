#include "pxn/build/kept_foil.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "geometry/mesh/bytes.h"

namespace panwright::pxn {

namespace {

// Of the room: what takes no more is no different where there is more room. note: levels together
// are smaller than what they are levels of
constexpr double kRoomy = 0.25;

template <class T>
void write_plain(const T& value, ByteWriter& to) {
  to.list(std::span<const T>(&value, 1));
}

template <class T>
T read_plain(ByteReader& from) {
  std::vector<T> values;
  from.list(values);
  if (values.size() != 1) from.fail();
  return values.size() == 1 ? values[0] : T{};
}

bool same(const SourceSpan& a, const SourceSpan& b) {
  return a.file == b.file && a.begin == b.begin && a.end == b.end;
}

bool has_all(const geometry::Mesh& mesh) {
  return !mesh.triangles.empty() && !mesh.normals.empty() && !mesh.texcoords.empty();
}

bool write(const MadeFoil& made, const mli::RecipePlaces& places, ByteWriter& to) {
  write_plain(made.meshes.statistics, to);
  geometry::write(*made.meshes.finest, to);
  to.number(made.meshes.levels.size());
  for (const scene::FoilLevel& level : made.meshes.levels) {
    geometry::write(*level.mesh, to);
    to.real(level.detail);
    to.real(level.error);
  }
  to.real(made.meshes.vertices);
  to.number(made.said.size());
  for (const Diagnostic& entry : made.said) {
    if (entry.code != Code::W7002 || !same(entry.where, places.recipe) || !entry.object.empty())
      return false;
    to.number(static_cast<std::uint64_t>(entry.code));
    to.text(entry.message);
    to.text(entry.hint);
  }
  return true;
}

MadeFoil read_made(const mli::RecipePlaces& places, ByteReader& from) {
  const auto mesh = [&] {
    auto out = std::make_shared<geometry::Mesh>(geometry::read_mesh(from));
    if (!has_all(*out)) from.fail();
    return out;
  };
  MadeFoil out;
  out.meshes.statistics = read_plain<mli::Statistics>(from);
  out.meshes.finest = mesh();
  for (std::uint64_t left = from.number(); left > 0 && from.good(); --left) {
    auto level = mesh();
    const double detail = from.real();
    out.meshes.levels.push_back({std::move(level), detail, from.real()});
  }
  out.meshes.vertices = from.real();
  for (std::uint64_t left = from.number(); left > 0 && from.good(); --left) {
    Diagnostic& entry = out.said.emplace_back();
    const std::uint64_t code = from.number();
    if (code != static_cast<std::uint64_t>(Code::W7002)) from.fail();
    entry.code = Code::W7002;
    entry.where = places.recipe;
    entry.message = from.text();
    entry.hint = from.text();
  }
  return out;
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

bool write(const WovenFoil& woven, ByteWriter& to) {
  geometry::write(woven.blanket, to);
  to.list(woven.roots);
  to.list(woven.taped);
  to.number(woven.levels.size());
  for (const mli::WrapLevel& level : woven.levels) {
    geometry::write(level.blanket, to);
    to.list(level.taped);
    to.real(level.detail);
    to.real(level.error);
  }
  write(woven.tally, to);
  to.real(woven.recipe.width);
  to.real(woven.recipe.height);
  to.number(woven.recipe.xgrid);
  to.number(woven.recipe.seed);
  write_plain(woven.statistics, to);
  return true;
}

WovenFoil read_woven(ByteReader& from) {
  WovenFoil out;
  const auto fits = [&](const geometry::Mesh& mesh, const std::vector<char>& taped) {
    if (!mesh.triangles.empty() && !has_all(mesh)) from.fail();
    if (taped.size() != mesh.triangles.size()) from.fail();
  };
  out.blanket = geometry::read_mesh(from);
  from.list(out.roots);
  from.list(out.taped);
  fits(out.blanket, out.taped);
  if (out.roots.size() != out.blanket.positions.size()) from.fail();
  for (std::uint64_t left = from.number(); left > 0 && from.good(); --left) {
    mli::WrapLevel& level = out.levels.emplace_back();
    level.blanket = geometry::read_mesh(from);
    from.list(level.taped);
    level.detail = from.real();
    level.error = from.real();
    fits(level.blanket, level.taped);
  }
  out.tally = read_tally(from);
  out.recipe.width = from.real();
  out.recipe.height = from.real();
  out.recipe.xgrid = static_cast<std::uint32_t>(from.number());
  out.recipe.seed = static_cast<std::uint32_t>(from.number());
  out.statistics = read_plain<mli::Statistics>(from);
  return out;
}

void add_matrix(const Mat4& matrix, KeyHasher& key) {
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) key.real(matrix[column][row]);
}

// How far a blanket has asked for room, whatever was there: kept under what it is made of.
Hash128 reach_key(const WovenFrom& from) {
  KeyHasher key;
  geometry::add_to_key(from.metres, key);
  key.list(from.faces);
  key.list(from.how);
  return key.key();
}

Hash128 woven_key(const WovenFrom& from, const Hash128& made_of, double reach) {
  WorldBox box;
  for (const Vec3& p : from.metres.positions) box.add(Vec3(from.world_from_metres * Vec4(p, 1)));
  KeyHasher key;
  key.hash(made_of);
  key.real(reach);
  // note: with room for rounding, and for outlines that are a little larger than their shapes
  const double size = glm::length(box.high - box.low);
  // where nothing is near, the place does not matter
  if (from.obstacles.add_near(from.of, box, reach + 1e-3 * size, key))
    add_matrix(from.world_from_metres, key);
  return key.key();
}

}  // namespace

std::optional<MadeFoil> kept_or_made(const WorkCache* cache, const FoilSheet& foil,
                                     double crease_angle, double room,
                                     const std::function<std::optional<MadeFoil>()>& make) {
  const auto key = [&] {
    KeyHasher hasher;
    hasher.list(foil.key());
    hasher.real(crease_angle);
    return hasher.key();
  };
  const auto roomy = [&](const MadeFoil& made) {
    return static_cast<double>(made.meshes.finest->positions.size()) <= kRoomy * room;
  };
  return reused_or_made<MadeFoil>(
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

WovenFoil woven_from(mli::Wrap wrap) {
  WovenFoil out;
  out.tally.add(wrap);
  const mli::WrapGroup* largest = nullptr;
  for (const mli::WrapGroup& group : wrap.groups)
    if (group.accepted && (largest == nullptr || group.area > largest->area)) largest = &group;
  if (largest != nullptr) {
    out.recipe = largest->recipe;
    out.recipe.operations.clear();
    out.statistics = largest->statistics;
  }
  out.blanket = std::move(wrap.blanket);
  out.roots = std::move(wrap.roots);
  out.taped = std::move(wrap.taped);
  out.levels = std::move(wrap.levels);
  return out;
}

std::optional<WovenFoil> kept_or_woven(
    const WorkCache* cache, const WovenFrom& from,
    const std::function<std::optional<WovenFoil>(double& farthest)>& make) {
  double farthest = 0;
  if (cache == nullptr) return make(farthest);
  const Hash128 made_of = reach_key(from);
  const auto roomy = [&](const WovenFoil& woven) {
    return static_cast<double>(woven.blanket.triangles.size()) <= kRoomy * from.room;
  };
  // a blanket that asked no further than this sees the same if all is the same as far as this
  double reach = -1;
  if (const auto bytes = cache->find(Work::foil, made_of)) {
    ByteReader reader(*bytes);
    const double known = reader.real();
    if (reader.at_end() && known >= 0 && std::isfinite(known)) reach = known;
  }
  if (reach >= 0)
    if (const auto bytes = cache->find(Work::foil, woven_key(from, made_of, reach))) {
      ByteReader reader(*bytes);
      WovenFoil found = read_woven(reader);
      if (reader.at_end() && roomy(found)) {
        cache->count(Work::foil, true);
        return found;
      }
    }
  auto made = make(farthest);
  cache->count(Work::foil, false);
  if (!made || !roomy(*made) || !std::isfinite(farthest)) return made;
  if (farthest > reach) {
    ByteWriter writer;
    writer.real(farthest);
    cache->keep(Work::foil, made_of, writer.bytes());
  }
  ByteWriter writer;
  write(*made, writer);
  cache->keep(Work::foil, woven_key(from, made_of, std::max(reach, farthest)), writer.bytes());
  return made;
}

}  // namespace panwright::pxn
