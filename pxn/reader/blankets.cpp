#include "pxn/reader/blankets.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numeric>
#include <set>

#include "base/axis_box.h"
#include "base/parallel.h"
#include "base/text.h"
#include "geometry/mesh/strip.h"
#include "geometry/tessellate/tessellate.h"
#include "pxn/reader/blanket_recipe.h"
#include "pxn/reader/metric.h"
#include "pxn/reader/shapes.h"

namespace panwright::pxn {

namespace {

// metres; the stand-off that is not given, and its largest part of a shape's diagonal
constexpr double kStandOff = 0.025, kShare = 1.0 / 40;
// what heights are scaled by under a stand-off that was not asked for
constexpr double kQuietScale = 0.5;
// of the stand-off: how far facets of a curved shape may lie from it
constexpr double kFacetShare = 0.02;
// of the stand-off: what is nearer to the faces is taken for them
constexpr double kSameSurface = 0.01;
// of the area: more that lies lower, below other parts, is a warning
constexpr double kHeldShare = 0.25;
constexpr double kAllTriangles = 3e6;  // of a model's blankets whose cells are not given
constexpr std::uint32_t kLevels = 6;

double diagonal_of(const geometry::Mesh& mesh) {
  AxisBox box;
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t v : t) box.add(mesh.positions[v]);
  return mesh.triangles.empty() ? 0 : box.diagonal();
}

geometry::Mesh stretched(const geometry::Mesh& mesh, const Mat3& by) {
  geometry::Mesh out;
  out.triangles = mesh.triangles;
  for (const Vec3& p : mesh.positions) out.positions.push_back(by * p);
  return out;
}

// Faces whose normal lies within 45 degrees of a chosen direction; all where none is chosen.
std::vector<std::uint32_t> chosen_faces(const geometry::Mesh& mesh, std::uint32_t directions,
                                        const Mat4& axes_from_shape) {
  std::vector<std::uint32_t> out;
  const Mat3 turn = glm::transpose(glm::inverse(Mat3(axes_from_shape)));
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    bool chosen = directions == 0;
    if (!chosen) {
      const auto& [a, b, c] = mesh.triangles[t];
      const Vec3 normal = turn * glm::cross(mesh.positions[b] - mesh.positions[a],
                                            mesh.positions[c] - mesh.positions[a]);
      const double length = glm::length(normal);
      for (int k = 0; k < 6; ++k)
        chosen =
            chosen || ((directions >> k & 1) != 0 && length > 0 &&
                       (k % 2 == 0 ? 1 : -1) * normal[k / 2] >= (std::sqrt(0.5) - 1e-9) * length);
    }
    if (chosen) out.push_back(t);
  }
  return out;
}

double covered_area(const geometry::Mesh& mesh, const std::vector<std::uint32_t>& faces) {
  double twice = 0;
  for (const std::uint32_t t : faces) {
    const auto& [a, b, c] = mesh.triangles[t];
    twice += glm::length(
        glm::cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]));
  }
  return twice / 2;
}

// Raises a number that other threads may raise at once.
void raise(std::atomic<double>& most, double value) {
  for (double known = most; value > known;)
    if (most.compare_exchange_weak(known, value)) return;
}

// Nodes as a text has them, each followed by what is below it, and instances in the order of their
// nodes.
void put_depth_first(scene::Scene& scene) {
  const std::size_t count = scene.nodes.size();
  std::vector<std::vector<std::int32_t>> below(count);
  std::vector<std::int32_t> next;
  for (std::size_t i = count; i-- > 0;) {
    const std::int32_t parent = scene.nodes[i].parent;
    (parent == scene::kNone ? next : below[static_cast<std::size_t>(parent)])
        .push_back(static_cast<std::int32_t>(i));
  }
  std::vector<std::int32_t> place(count);
  std::vector<scene::Node> nodes;
  while (!next.empty()) {
    const auto node = static_cast<std::size_t>(next.back());
    next.pop_back();
    place[node] = static_cast<std::int32_t>(nodes.size());
    nodes.push_back(std::move(scene.nodes[node]));
    next.insert(next.end(), below[node].begin(), below[node].end());
  }
  const auto move = [&](std::int32_t& node) {
    if (node != scene::kNone) node = place[static_cast<std::size_t>(node)];
  };
  for (scene::Node& node : nodes) move(node.parent);
  scene.nodes = std::move(nodes);
  for (scene::Instance& one : scene.instances) move(one.node);
  for (scene::Frame& frame : scene.frames) move(frame.node);
  for (scene::Keypoint& point : scene.keypoints) move(point.node);
  for (scene::Lamp& lamp : scene.lamps) move(lamp.node);
  for (scene::Joint& joint : scene.joints) move(joint.node);
  std::vector<std::size_t> order(scene.instances.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return scene.instances[i].node; });
  std::vector<std::int32_t> moved(order.size());
  std::vector<scene::Instance> instances;
  for (const std::size_t from : order) {
    moved[from] = static_cast<std::int32_t>(instances.size());
    instances.push_back(std::move(scene.instances[from]));
  }
  scene.instances = std::move(instances);
  for (scene::Decal& decal : scene.decals)
    decal.instance = moved[static_cast<std::size_t>(decal.instance)];
}

}  // namespace

std::string many_triangles(double triangles, double cell) {
  if (triangles <= 1.5 * kAllTriangles) return {};
  return fmt::format(
      "{:.3g} million triangles of foil with cells of {:.2g} m: cells of {:.2g} m, by "
      "<mli_settings> of <mli type=\"wrap\">, would make {:.0f} million",
      1e-6 * triangles, cell, cell * std::sqrt(triangles / kAllTriangles), 1e-6 * kAllTriangles);
}

void Blankets::make(std::uint64_t most_nodes, Reporter& reporter) {
  std::vector<std::int32_t> wrapped;
  double reach = 0;
  for (const FoilWish& wish : wishes_) {
    // note: heights above four stand-offs are seldom, and found to be free
    reach = std::max(reach, 4 * (wish.how.stand_off > 0 ? wish.how.stand_off : kStandOff));
    for (const auto& [instance, name] : wish.on) wrapped.push_back(instance);
  }
  if (wrapped.empty()) return;
  obstacles_.emplace(scene_, wrapped, reach, job_);
  share_triangles();
  find_corners();
  uses_.assign(scene_.shapes.size(), 0);
  for (const scene::Instance& one : scene_.instances) ++uses_[static_cast<std::size_t>(one.shape)];
  std::vector<Worn> worn;  // in the order of wishes
  std::map<std::pair<FileId, std::uint32_t>, std::size_t> known;
  for (const FoilWish& wish : wishes_) {
    const auto [at, fresh] = known.try_emplace({wish.where.file, wish.where.begin}, worn.size());
    if (fresh) worn.emplace_back().wish = &wish;
    Worn& out = worn[at->second];
    for (const auto& [instance, name] : wish.on) {
      ++out.asked;
      if (scene_.nodes.size() < most_nodes)
        cover(instance, name, wish, out);
      else if (out.problem.empty())
        out.problem = fmt::format("the model has more than {} nodes with its blankets", most_nodes);
    }
  }
  tell(worn, reporter);
  tell_cells(worn, reporter);
  put_depth_first(scene_);
}

// Sets the cell with which all blankets together that say none have kAllTriangles.
void Blankets::share_triangles() {
  double area = 0;
  std::set<Key> known;
  for (const FoilWish& wish : wishes_)
    for (const auto& [instance, name] : wish.on) {
      if (wish.how.cell > 0) continue;
      const scene::Instance& one = scene_.instances[static_cast<std::size_t>(instance)];
      const Mat4 world = world_from(one.node);
      const std::array<double, 6> metric = metric_of(world);
      if (!known.emplace(one.shape, metric, key_of(wish.how), std::vector<std::uint32_t>()).second)
        continue;
      job_.poll();
      const geometry::MeshShape mesh =
          mesh_of(scene_.shapes[static_cast<std::size_t>(one.shape)], 1e300);
      if (mesh)
        area += covered_area(stretched(*mesh, metres_of(metric)),
                             chosen_faces(*mesh, wish.how.faces, wish.axes_from_world * world));
    }
  least_cell_ = std::sqrt(kPerCell * area / kAllTriangles);
}

void Blankets::find_corners() {
  std::set<std::int32_t> instances;
  for (const FoilWish& wish : wishes_)
    for (const auto& [instance, name] : wish.on) instances.insert(instance);
  if (instances.size() < 2) return;
  for (const FoilWish& wish : wishes_)
    for (const auto& [instance, name] : wish.on) {
      job_.poll();
      const scene::Instance& one = scene_.instances[static_cast<std::size_t>(instance)];
      const geometry::MeshShape mesh =
          mesh_of(scene_.shapes[static_cast<std::size_t>(one.shape)], 1e300);
      if (!mesh) continue;
      const Mat4 world = world_from(one.node);
      const auto at = [&](std::uint32_t v) { return Vec3(world * Vec4(mesh->positions[v], 1)); };
      // counter-clockwise from outside, whatever the node mirrors
      const bool mirrored = glm::determinant(Mat3(world)) < 0;
      for (const std::uint32_t t :
           chosen_faces(*mesh, wish.how.faces, wish.axes_from_world * world)) {
        const auto& [a, b, c] = mesh->triangles[t];
        corners_.add(at(a), at(mirrored ? c : b), at(mirrored ? b : c),
                     static_cast<std::uint32_t>(instance));
      }
    }
  corners_.build();
}

Mat4 Blankets::world_from(std::int32_t node) const {
  Mat4 out(1);
  for (; node != scene::kNone; node = scene_.nodes[static_cast<std::size_t>(node)].parent)
    out = scene_.nodes[static_cast<std::size_t>(node)].parent_from_node.matrix() * out;
  return out;
}

// What became of all wishes. Elements may be thousands: a kind of warning is told once, of the
// worst.
void Blankets::tell(const std::vector<Worn>& worn, Reporter& reporter) {
  struct Kind {
    const FoilWish* wish = nullptr;
    std::string text;
    double worst = 0;
    std::size_t count = 0;
  };
  std::array<Kind, 5> kinds;
  const auto say = [&](Code code, const FoilWish& wish, const std::string& text) {
    if (!text.empty())
      reporter.report(code, wish.where, *wish.document, wish.element,
                      [&] { return Reporter::Text(text); });
  };
  for (const Worn& one : worn) {
    const FoilWish& wish = *one.wish;
    if (one.instances == 0 && one.problem.empty() && !wish.faces.empty()) {
      say(Code("W1501"), wish,
          fmt::format("no face of {} looks along {}", counted(one.asked, "shape"),
                      in_quotes(wish.faces)));
      continue;
    }
    say(Code("E7001"), wish, one.problem);
    const auto warn = [&](std::size_t kind, double how_much, std::string text) {
      Kind& known = kinds[kind];
      if (text.empty()) return;
      if (known.count++ == 0 || how_much > known.worst)
        known = {&wish, std::move(text), how_much, known.count};
    };
    const mli::WrapTally& tally = one.tally;
    if (tally.groups > 0 && tally.refused == tally.groups)
      say(Code("E7001"), wish, tally.refusals());  // nothing is worn at all
    else
      warn(0, tally.area_refused, tally.refusals());
    warn(1, -tally.least, tally.scalings(one.enough));
    if (one.stand_off > 0)
      warn(2, one.stand_off / one.across,
           fmt::format("the stand-off is {:.4g} m, and the shape {:.3g} m across, expected "
                       "less than a quarter of that; without standoff= it is {:.2g} m",
                       one.stand_off, one.across, std::min(kStandOff, kShare * one.across)));
    const double area = tally.area - tally.area_refused;
    if (tally.held > kHeldShare * area) warn(3, tally.held / area, tally.holds());
    warn(4, one.triangles, many_triangles(one.triangles, one.finest_cell));
  }
  for (const Kind& kind : kinds)
    if (kind.count > 0)
      say(Code("W7002"), *kind.wish,
          kind.count == 1 ? kind.text
                          : fmt::format("{} (the worst of {} elements)", kind.text, kind.count));
}

// Of all elements together, which may be thousands.
void Blankets::tell_cells(const std::vector<Worn>& worn, Reporter& reporter) {
  const FoilWish* first = nullptr;
  std::size_t count = 0;
  double largest = 0;
  for (const Worn& one : worn) {
    if (one.coarsened == 0) continue;
    if (first == nullptr) first = one.wish;
    count += one.coarsened;
    largest = std::max(largest, one.largest_cell);
  }
  if (first == nullptr) return;
  reporter.report(Code("W7002"), first->where, *first->document, first->element, [&] {
    return Reporter::Text(
        fmt::format("cells of {} are up to {:.2g} m, too large for all wrinkles, within a million "
                    "triangles each and {:.0f} million of the model; set others by <mli_settings> "
                    "of <mli type=\"wrap\">",
                    counted(count, "blanket"), largest, 1e-6 * kAllTriangles));
  });
}

void Blankets::cover(std::int32_t instance, const std::string& name, const FoilWish& wish,
                     Worn& out) {
  job_.poll();
  const auto index = static_cast<std::size_t>(instance);
  const std::int32_t node = scene_.instances[index].node;
  const Mat4 world = world_from(node);
  bool any = false;
  const auto made = this->made({instance, world, wish.axes_from_world * world}, wish, any);
  if (!any) return;
  ++out.instances;
  out.tally.add(made->tally);
  if (made->tally.scaled > 0) {
    mli::WrapOptions with;
    with.stand_off = made->stand_off;
    out.enough = std::max(out.enough, mli::enough_stand_off(with, made->tally.least));
  }
  constexpr double kMostShare = 0.25;  // of a shape's diagonal
  if (made->stand_off > kMostShare * made->across && out.stand_off == 0)
    out.stand_off = made->stand_off, out.across = made->across;
  if (made->cell > 0) ++out.coarsened, out.largest_cell = std::max(out.largest_cell, made->cell);
  if (out.problem.empty()) out.problem = made->problem;
  if (made->shape == scene::kNone && made->tape == scene::kNone && made->edge == scene::kNone)
    return;
  out.triangles += static_cast<double>(made->triangles);
  out.finest_cell =
      out.finest_cell > 0 ? std::min(out.finest_cell, made->used_cell) : made->used_cell;
  if (!std::holds_alternative<geometry::MeshShape>(
          scene_.shapes[static_cast<std::size_t>(scene_.instances[index].shape)])) {
    const double most = kFacetShare * made->stand_off;
    std::optional<double>& tolerance = scene_.instances[index].tolerance;
    if (!tolerance && scene_.budget.tolerance) tolerance = scene_.budget.tolerance;
    tolerance = std::min(tolerance.value_or(most), most);
  }
  const auto hang_part = [&](std::int32_t shape, std::int32_t material, const std::string& named) {
    if (shape == scene::kNone) return;
    scene::Instance part = wish.blanket;
    part.material = material;
    if (shape != made->shape) part.back = scene::kNone;  // tape and edges have none
    part.shape = shape;
    hang(node, named, std::move(part));
  };
  hang_part(made->shape, wish.blanket.material, name);
  hang_part(made->tape, wish.tape, name + "_tape");
  hang_part(made->edge, wish.edge, name + "_edge");
}

// Gives an instance a node of its own, beside what it covers or below.
void Blankets::hang(std::int32_t node, std::string name, scene::Instance what) {
  const bool beside = std::ranges::none_of(
      scene_.joints, [&](const scene::Joint& joint) { return joint.node == node; });
  scene::Node hanger;
  hanger.name = std::move(name);
  // note: beside a shape of its own node, so that this stays a leaf
  const scene::Node& covered = scene_.nodes[static_cast<std::size_t>(node)];
  if (beside && covered.parent != scene::kNone) {
    hanger.parent = covered.parent;
    hanger.parent_from_node = covered.parent_from_node;
    hanger.marks.label = covered.marks.label;
  } else {
    hanger.parent = node;
  }
  hanger.source = what.source;
  what.node = static_cast<std::int32_t>(scene_.nodes.size());
  scene_.nodes.push_back(std::move(hanger));
  scene_.instances.push_back(std::move(what));
}

// any: whether a face is chosen; nothing is returned where none is.
std::optional<Blankets::Made> Blankets::made(const Place& place, const FoilWish& wish, bool& any) {
  const Blanket& how = wish.how;
  const std::int32_t shape = scene_.instances[static_cast<std::size_t>(place.instance)].shape;
  const std::array<double, 6> metric = metric_of(place.world_from_shape);
  const Mat3 in_metres = metres_of(metric);
  const geometry::Shape given = scene_.shapes[static_cast<std::size_t>(shape)];
  // note: facets of a curved shape follow from its size and the stand-off
  geometry::MeshShape mesh = mesh_of(given, 1e300);
  const double stretch = std::sqrt(std::max({metric[0], metric[1], metric[2]}));
  if (mesh && mesh->triangles.empty()) mesh = nullptr;
  const double diagonal = mesh ? diagonal_of(stretched(*mesh, in_metres)) : 0;
  const double stand_off =
      how.stand_off > 0 ? how.stand_off : std::min(kStandOff, kShare * diagonal);
  if (mesh && stand_off > 0 && stretch > 0 && !std::holds_alternative<geometry::MeshShape>(given))
    mesh = mesh_of(given, std::max(kFacetShare * stand_off, kFinest * diagonal) / stretch);
  any = false;
  if (!mesh || !(diagonal > 0)) return std::nullopt;
  const std::vector<std::uint32_t> faces = chosen_faces(*mesh, how.faces, place.axes_from_shape);
  any = !faces.empty();
  if (!any) return std::nullopt;
  const geometry::Mesh metres = stretched(*mesh, in_metres);
  const Surroundings around{
      metres,         faces,       place.world_from_shape * Mat4(glm::inverse(in_metres)),
      place.instance, *obstacles_, corners_};
  const Key key(shape, metric, key_of(how), how.faces == 0 ? std::vector<std::uint32_t>() : faces);
  const auto known = known_.find(key);
  if (known != known_.end() && is_clear(known->second, around, room_of(place, in_metres, stand_off),
                                        corners_of(place, in_metres))) {
    Made shared = known->second;
    shared.triangles = 0;  // which are there already
    return shared;
  }
  Made made = woven(place, around, in_metres, wish, stand_off);
  made.across = diagonal;
  if (!(made.tally.held > 0) && !made.cornered) known_.emplace(key, made);
  return made;
}

// Distances are those of the world: only directions differ.
mli::FreeRoom Blankets::room_of(const Place& place, const Mat3& in_metres, double stand_off) const {
  const Mat4 world = place.world_from_shape * Mat4(glm::inverse(in_metres));
  return [this, world, of = place.instance, least = kSameSurface * stand_off](
             const Vec3& from, const Vec3& along, double most) {
    return obstacles_->room(of, Vec3(world * Vec4(from, 1)), glm::normalize(Mat3(world) * along),
                            least, most);
  };
}

mli::OtherCorners Blankets::corners_of(const Place& place, const Mat3& in_metres) const {
  const Mat4 world = place.world_from_shape * Mat4(glm::inverse(in_metres));
  const auto owner = static_cast<std::uint32_t>(place.instance);
  return {[this, world, owner](const Vec3& from, const Vec3& along, double most) {
            return corners_.room(owner, Vec3(world * Vec4(from, 1)),
                                 glm::normalize(Mat3(world) * along), most);
          },
          [this, world, owner](const Vec3& a, const Vec3& b, double tolerance) {
            return corners_.crossed(owner, Vec3(world * Vec4(a, 1)), Vec3(world * Vec4(b, 1)),
                                    tolerance);
          }};
}

// Whether nothing is in the way of a blanket that was made elsewhere.
bool Blankets::is_clear(const Made& made, const Surroundings& around, const mli::FreeRoom& room,
                        const mli::OtherCorners& others) {
  if (!made.reach) return true;
  KeyHasher ignored;
  if (!around.add_near(made.reach->asked, ignored)) return true;
  obstacles_->build(job_);
  const std::vector<Vec3>&tops = made.reach->tops, &roots = made.reach->roots;
  std::atomic<bool> clear = true;
  constexpr std::size_t kBlock = 1024;
  parallel_for((tops.size() + kBlock - 1) / kBlock,
               [&](std::size_t block) {
                 const std::size_t end = std::min(tops.size(), (block + 1) * kBlock);
                 for (std::size_t v = block * kBlock; v < end && clear; ++v) {
                   const Vec3 up = tops[v] - roots[v];
                   const double height = glm::length(up), far = height / mli::kWrapReach;
                   if (height > 0 && (room(roots[v], up / height, far) < far ||
                                      others.room(roots[v], up / height, far) < far))
                     clear = false;
                 }
               },
               job_);
  return clear;
}

Blankets::Made Blankets::woven(const Place& place, const Surroundings& around,
                               const Mat3& in_metres, const FoilWish& wish, double stand_off) {
  const Blanket& how = wish.how;
  const auto shape =
      static_cast<std::size_t>(scene_.instances[static_cast<std::size_t>(place.instance)].shape);
  Made out;
  out.stand_off = stand_off;
  const double room = kMaxFoilVertices - vertices_;
  if (room < 1) {
    out.problem = fmt::format("all sheets of a model may have {:.0f} vertices, and none is left",
                              kMaxFoilVertices);
    return out;
  }
  const double cell = cell_of(how, diagonal_of(around.metres),
                              covered_area(around.metres, around.faces), least_cell_, out.cell);
  // other shapes wear other sheets, and the same one after each change of the model
  const auto seed =
      how.seed + static_cast<std::uint32_t>(geometry::hash_of(scene_.shapes[shape]).low);
  mli::WrapOptions options;
  options.stand_off = out.stand_off;
  options.max_triangles = room;
  options.tell = false;
  options.tape = how.tape;
  options.edge = how.edge;
  options.normals = crease_angle_;
  options.levels = kLevels;
  DiagnosticLog log;
  const bool shared = uses_[shape] > 1;
  WovenFrom from{around, glm::inverse(in_metres), key_of(how), room, shared};
  for (const double number : {cell, static_cast<double>(seed), stand_off, crease_angle_})
    from.how.push_back(number);
  auto woven = kept_or_woven(cache_, from, [&] {
    return wrapped(place, around, in_metres, recipe_for(how, cell, seed), options, log);
  });
  job_.poll();
  if (!woven) {
    out.problem = log.entries().empty() ? "no blanket" : log.entries()[0].message;
    return out;
  }
  out.tally.add(woven->tally);
  out.cornered = woven->cornered;
  if (how.stand_off == 0 && out.tally.least >= kQuietScale) out.tally.scaled = 0;
  if (woven->triangles == 0) return out;
  if (shared)
    out.reach = std::make_shared<const Made::Reach>(
        Made::Reach{std::move(woven->tops), std::move(woven->roots), woven->asked});
  woven->recipe.operations = operations_for(how, woven->recipe.height, cell);
  scene::Foil foil{scene::kNone, woven->recipe,       mli::Flat{}, woven->meshes.statistics,
                   true,         wish.blanket.source, {}};
  out.used_cell = cell;
  out.triangles = woven->triangles;
  vertices_ += woven->meshes.vertices;
  auto& [cloth, tape, edge] = woven->meshes.parts;
  out.shape = add_shape(cloth, foil);
  out.tape = add_shape(tape, foil);
  out.edge = add_shape(edge, std::move(foil));
  return out;
}

// A blanket that is made now, and how far it asked.
std::optional<WovenFoil> Blankets::wrapped(const Place& place, const Surroundings& around,
                                           const Mat3& in_metres, const mli::RecipeFor& recipe,
                                           mli::WrapOptions options, DiagnosticLog& log) {
  obstacles_->build(job_);
  std::atomic<double> parts = 0, corners = 0;
  std::atomic<bool> cornered = false;
  const mli::FreeRoom room = room_of(place, in_metres, options.stand_off);
  options.room = [&](const Vec3& from, const Vec3& along, double most) {
    raise(parts, most);
    return room(from, along, most);
  };
  const mli::OtherCorners others = corners_of(place, in_metres);
  options.corners.room = [&](const Vec3& from, const Vec3& along, double most) {
    raise(corners, 2 * most);
    const double free = others.room(from, along, most);
    if (free < most) cornered = true;
    return free;
  };
  options.corners.crossed = [&](const Vec3& a, const Vec3& b, double tolerance) {
    raise(corners, tolerance);
    return others.crossed(a, b, tolerance);
  };
  auto wrap = mli::wrapped(around.metres, around.faces, recipe, options, log, {}, job_);
  if (!wrap) return std::nullopt;
  WovenFoil out = woven_from(*std::move(wrap), glm::inverse(in_metres));
  out.cornered = cornered;
  // note: what parts hold down asks less of corners, which shall not make it another blanket; and
  // is_clear() asks as far for both
  out.asked = {parts, std::max<double>(corners, 2 * parts)};
  return out;
}

// Of a blanket what shows one thing; kNone: there is nothing.
std::int32_t Blankets::add_shape(FoilMeshes::Part& part, scene::Foil foil) {
  if (!part.finest) return scene::kNone;
  foil.levels = std::move(part.levels);
  foil.shape = static_cast<std::int32_t>(scene_.shapes.size());
  scene_.shapes.emplace_back(std::move(part.finest));
  scene_.foils.push_back(std::move(foil));
  return scene_.foils.back().shape;
}

}  // namespace panwright::pxn
