#include "pxn/reader/assembler.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>

#include "base/text.h"
#include "geometry/tessellate/tessellate.h"
#include "pxn/reader/internal/assembly.h"
#include "pxn/text/grammar.h"

namespace panwright::pxn {

namespace {

// y up to z up: (x, y, z) goes to (x, −z, y)
Quat z_up_from_y_up() { return Quat(std::sqrt(0.5), std::sqrt(0.5), 0, 0); }

// A placement followed by the turn of a y-up file: T·R·S·U = T·(R·U)·S', with S' along turned axes.
scene::Transform with_y_up(const scene::Transform& t) {
  return {t.translation, glm::normalize(t.rotation * z_up_from_y_up()),
          Vec3(t.scale.x, t.scale.z, t.scale.y)};
}

// Whether single precision holds the axes and the place of a node.
bool fits(const Mat4& world) {
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 3; ++r)
      if (!(std::abs(world[c][r]) <= geometry::kMaxCoordinate)) return false;
  for (int c = 0; c < 3; ++c)
    if (!(glm::length(Vec3(world[c])) >= geometry::kMinRadius)) return false;
  return true;
}

}  // namespace

Assembler::Assembler(const Loader& loader, const Options& options, Reporter& reporter,
                     scene::Scene& scene)
    : loader_(loader),
      options_(options),
      reporter_(reporter),
      scene_(scene),
      surfaces_(loader, options, reporter, scene),
      attached_{{}, CellGrids(scene), {}, {}, {}, {}},
      blankets_(scene, options.crease_angle, loader.foil_vertices(), options.cache, loader.job()) {}

bool Assembler::run(std::uint32_t top) {
  const Part& part = loader_.part(top);
  scene::Node root;
  root.name = "root";
  root.source = {part.file->found.path, 1, 1};
  if (part.file->y_up) root.parent_from_node = with_y_up({});
  scene_.nodes.push_back(std::move(root));
  Context context;
  context.world_from_node = scene_.nodes[0].parent_from_node.matrix();
  Use use{&part, part.source, true, nullptr, {}, false, true, {}, {}, {}, {}};
  items_of(use, context);
  if (!stopped_) joints_.connect(scene_, reporter_);
  if (!stopped_) blankets_.make(options_.limits.nodes, reporter_);
  attached_.cells.report(first_import_, reporter_.log());
  return !stopped_;
}

void Assembler::items_of(Use& use, const Context& context) {
  use.nodes_before.resize(use.part->items.size() + 1);
  const auto first = static_cast<std::uint32_t>(scene_.nodes.size());
  items(use, 0, static_cast<std::uint32_t>(use.part->items.size()), context);
  use.nodes_before.back() = static_cast<std::uint32_t>(scene_.nodes.size());
  for (const std::uint32_t index : use.decals) decal(use, use.part->items[index]);
  for (const auto& [index, around] : use.wraps) wrap(use, index, around, context.node, first);
}

void Assembler::items(Use& use, std::uint32_t begin, std::uint32_t end, const Context& context) {
  for (std::uint32_t i = begin; i < end && !stopped_; i = use.part->items[i].end)
    item(use, i, context);
}

void Assembler::item(Use& use, std::uint32_t index, const Context& context) {
  loader_.job().poll();
  const Item& item = use.part->items[index];
  use.nodes_before[index] = static_cast<std::uint32_t>(scene_.nodes.size());
  Context inner = context;
  switch (item.kind) {
    case ItemKind::appearance:
      inner.surface = {context.surface.fields.overridden_by(use.part->fields[item.data]),
                       {},
                       context.surface.back,
                       material_place(use, item)};
      break;
    case ItemKind::texture:
      inner.texture = static_cast<std::int32_t>(item.data);
      inner.texture_from_node = Mat4(1);
      break;
    case ItemKind::node:
      if (!enter(use, item, name_of(use, item), transform_of(use, item), inner)) return;
      break;
    case ItemKind::joint: {
      const PartJoint& known = use.part->joints[item.data];
      if (!enter(use, item, known.node.empty() ? known.joint.name : known.node,
                 transform_of(use, item), inner))
        return;
      joint(use, known, item.element, inner.node, context.prefix);
      break;
    }
    case ItemKind::shape:
      shape(use, index, inner);
      return;
    case ItemKind::frame:
      frame(use, item, context);
      return;
    case ItemKind::keypoint:
      keypoint(use, item, context);
      return;
    case ItemKind::lamp:
      lamp(use, item, context);
      return;
    case ItemKind::decal:
      use.decals.push_back(index);
      return;
    case ItemKind::import:
      import(use, item, inner);
      return;
    case ItemKind::wrap:
      use.wraps.emplace_back(index, context);
      return;
    case ItemKind::include:
    case ItemKind::use:
      part(use, item, inner);
      return;
  }
  items(use, index + 1, item.end, inner);
}

// ---- nodes

std::string Assembler::numbered(const std::string& base) {
  return fmt::format("{}{}", base, ++counters_[base]);
}

std::string Assembler::named(const Use& use, const std::string& base) {
  for (;;) {
    const std::uint32_t count = ++counters_[base];
    std::string name = count == 1 ? base : fmt::format("{}{}", base, count);
    if (!is_written_in(use, name) && made_.insert(name).second) return name;
  }
}

bool Assembler::is_written_in(const Use& use, const std::string& name) {
  const Use* place = &use;
  while (!place->named) place = place->outer;
  return written_in(*place->part).contains(name);
}

const std::set<std::string>& Assembler::written_in(const Part& part) {
  const auto [known, added] = written_.try_emplace(&part);
  if (!added) return known->second;
  std::set<std::string> names;
  for (const Item& item : part.items) {
    if (item.kind != ItemKind::use && item.kind != ItemKind::include) continue;
    const bool has_properties = item.properties != kNoProperties;
    if (has_properties && !part.properties[item.properties].name.empty())
      names.insert(part.properties[item.properties].name);
    else if (item.kind == ItemKind::include)
      names.merge(std::set(written_in(loader_.part(item.data))));
  }
  return written_[&part] = std::move(names);
}

const NodeProperties* Assembler::properties_of(const Use& use, const Item& item) const {
  return item.properties == kNoProperties ? nullptr : &use.part->properties[item.properties];
}

std::string Assembler::name_of(const Use& use, const Item& item) {
  const NodeProperties* properties = properties_of(use, item);
  if (properties != nullptr && !properties->name.empty()) return properties->name;
  return numbered(std::string(use.part->file->document.name(item.element)));
}

scene::Transform Assembler::transform_of(const Use& use, const Item& item) const {
  const NodeProperties* properties = properties_of(use, item);
  return properties != nullptr && properties->transform ? *properties->transform
                                                        : scene::Transform{};
}

scene::Source Assembler::source_of(const Use& use, const Item& item) const {
  const auto& [line, column] = use.part->file->positions[item.element];
  return {use.part->file->found.path, line, column};
}

bool Assembler::enter(Use& use, const Item& item, std::string name,
                      const scene::Transform& transform, Context& context) {
  if (scene_.nodes.size() >= options_.limits.nodes) {
    report(Code("E1008"), use, item, [&] {
      return Reporter::Text(fmt::format(
          "the model has more than {} nodes, counting those of parts, repeats and includes",
          options_.limits.nodes));
    });
    stopped_ = true;
    return false;
  }
  scene::Node node;
  node.name = std::move(name);
  node.parent = context.node;
  node.source = source_of(use, item);
  const Mat4 local = transform.matrix();
  const Mat4 world = context.world_from_node * local;
  if (fits(world)) {
    node.parent_from_node = transform;
    context.world_from_node = world;
    context.texture_from_node = context.texture_from_node * local;
  } else {
    report(Code("E2010"), use, item, [&] {
      return Reporter::Text(
          "the transforms down to here together scale or move by less than 1e-30 or more than "
          "1e30; "
          "this one is left out");
    });
  }
  const NodeProperties* const properties = properties_of(use, item);
  if (properties) node.marks = properties->marks;
  scene_.nodes.push_back(std::move(node));
  context.node = static_cast<std::int32_t>(scene_.nodes.size() - 1);
  if (properties && properties->material >= 0)
    context.surface = surfaces_.named(properties->material);
  return true;
}

void Assembler::shape(Use& use, std::uint32_t index, Context& context) {
  const Item& item = use.part->items[index];
  if (!enter(use, item, name_of(use, item), transform_of(use, item), context)) return;
  scene::Instance instance;
  instance.node = context.node;
  instance.shape = static_cast<std::int32_t>(item.data);
  instance.material = surfaces_.material(context.surface);
  instance.texture = context.texture;
  if (context.texture != scene::kNone) {
    instance.mapping = scene::Mapping::sphere;
    instance.texture_from_shape = context.texture_from_node;
  }
  instance.source = source_of(use, item);
  const NodeProperties* const properties = properties_of(use, item);
  instance.back =
      surfaces_.back_of(&scene_.shapes[item.data], instance.material,
                        properties && properties->back ? *properties->back : context.surface.back,
                        [&] { return place_in(use, item); });
  if (properties) {
    instance.tolerance = properties->tolerance;
    if (!properties->name.empty())
      use.shapes[properties->name].emplace_back(index,
                                                static_cast<std::int32_t>(scene_.instances.size()));
  }
  scene_.instances.push_back(std::move(instance));
  if (properties && !properties->foil.empty())
    cover(use, item.element, static_cast<std::int32_t>(scene_.instances.size() - 1),
          properties->foil, properties->material, source_of(use, item));
}

// ---- joints

void Assembler::joint(Use& use, const PartJoint& known, std::uint32_t element, std::int32_t node,
                      const std::string& prefix) {
  SourceSpan where = use.part->file->document.tag_span(element);
  where.file = file_of(use);
  if (joints_.add(known, node, prefix, where, use.part->file->document, element, scene_)) return;
  if (!taken_.insert({use.part, element}).second) return;
  report_at(Code("E1210"), use, element, [&] {
    return Reporter::Text(fmt::format("duplicate joint {}; the contents of this one stay at rest",
                                      in_quotes(prefix + known.joint.name)));
  });
}

void Assembler::import_joints(Use& use, const PartImport& place, const Context& context) {
  std::map<std::size_t, std::string> leaders;
  for (const auto& [index, node] : attached_.moving) {
    const PartImport::Moved& moved = place.moved[index];
    PartJoint known = use.part->joints[moved.joint];
    const auto [leader, first] = leaders.try_emplace(index, known.joint.name);
    if (!first) known = joints_.follower(known, leader->second);
    joint(use, known, moved.rule, node, context.prefix);
  }
  for (const std::size_t index : attached_.sheared)
    report_at(Code("E1231"), use, place.moved[index].rule, [&] {
      const PartJoint& known = use.part->joints[place.moved[index].joint];
      return Reporter::Text(
          fmt::format("joint {} moves a node that its parents shear; it stays at rest",
                      in_quotes(known.joint.name)));
    });
}

void Assembler::frame(Use& use, const Item& item, const Context& context) {
  const PartFrame& known = use.part->frames[item.data];
  const std::string name = context.prefix + known.label;
  if (!labels_.insert(name).second) {
    if (!taken_.insert({use.part, item.element}).second) return;
    report(Code("E1210"), use, item, [&] {
      return Reporter::Text(
          fmt::format("duplicate frame {}; this one is left out", in_quotes(name)));
    });
    return;
  }
  scene_.frames.push_back({name, context.node, known.origin, known.rotation, source_of(use, item)});
}

void Assembler::import_frames(Use& use, const Item& item) {
  for (scene::Frame& frame : attached_.frames) {
    if (labels_.insert(frame.name).second) {
      scene_.frames.push_back(std::move(frame));
      continue;
    }
    if (!taken_.insert({use.part, item.element}).second) continue;
    report(Code("E1210"), use, item, [&] {
      return Reporter::Text(fmt::format("duplicate frame {} of the import; this one is left out",
                                        in_quotes(frame.name)));
    });
  }
}

void Assembler::keypoint(Use& use, const Item& item, const Context& context) {
  const PartKeypoint& known = use.part->keypoints[item.data];
  const std::string name = context.prefix + known.name;
  if (!keypoints_.insert(name).second) {
    if (!taken_.insert({use.part, item.element}).second) return;
    report(Code("E1210"), use, item, [&] {
      return Reporter::Text(
          fmt::format("duplicate keypoint {}; this one is left out", in_quotes(name)));
    });
    return;
  }
  scene_.keypoints.push_back({name, context.node, known.position, source_of(use, item)});
}

void Assembler::lamp(Use& use, const Item& item, const Context& context) {
  scene::Lamp lamp = use.part->lamps[item.data];
  lamp.name = context.prefix + lamp.name;
  if (!lamps_.insert(lamp.name).second) {
    if (!taken_.insert({use.part, item.element}).second) return;
    report(Code("E1210"), use, item, [&] {
      return Reporter::Text(
          fmt::format("duplicate lamp {}; this one is left out", in_quotes(lamp.name)));
    });
    return;
  }
  lamp.node = context.node;
  lamp.source = source_of(use, item);
  scene_.lamps.push_back(std::move(lamp));
}

void Assembler::part(Use& use, const Item& item, Context& context) {
  const bool used = item.kind == ItemKind::use;
  if (!used && ++includes_ > options_.limits.includes) {
    if (includes_ == options_.limits.includes + 1)
      report(Code("E1304"), use, item, [&] {
        return Reporter::Text(
            fmt::format("the model makes more than {} includes; the rest is left out",
                        options_.limits.includes));
      });
    return;
  }
  const Part& part = loader_.part(item.data);
  const NodeProperties* properties = properties_of(use, item);
  const bool has_name = properties != nullptr && !properties->name.empty();
  std::string base =
      used ? part.name : std::filesystem::path(part.file->found.path).stem().string();
  if (base.empty()) base = "include";
  const std::string name = has_name ? properties->name : named(use, base);
  scene::Transform transform = transform_of(use, item);
  if (!used && part.file->y_up) transform = with_y_up(transform);
  if (!enter(use, item, name, transform, context)) return;
  if (used || has_name) context.prefix += name + "/";
  const bool first = used_.insert(item.data).second;
  SourceSpan at = use.part->file->document.tag_span(item.element);
  Use inner{&part, part.source, first, &use, at, used, used || has_name, {}, {}, {}, {}};
  items_of(inner, context);
}

// ---- CAD files

void Assembler::import(Use& use, const Item& item, Context& context) {
  const PartImport& place = use.part->imports[item.data];
  const ImportedModel& model = loader_.model(place.model);
  const scene::Scene& from = model.imported.scene;
  if (!enter(use, item, name_of(use, item), transform_of(use, item), context)) return;
  if (scene_.nodes.size() + from.nodes.size() > options_.limits.nodes + 1) {
    report(Code("E1008"), use, item, [&] {
      return Reporter::Text(fmt::format("with the import's {} the model has more than {}",
                                        counted(from.nodes.size(), "node"), options_.limits.nodes));
    });
    stopped_ = true;
    return;
  }
  std::vector<std::int32_t> materials(place.materials.size(), -1);
  std::vector<std::int32_t> backs(place.materials.size(), scene::kNone);
  for (std::size_t i = 0; i < materials.size(); ++i) {
    if (place.removed[i]) continue;
    materials[i] = place.materials[i] < 0
                       ? surfaces_.cad_material(place.model, model, from.instances[i].material)
                       : surfaces_.named_material(place.materials[i]);
    const auto shape = static_cast<std::size_t>(from.instances[i].shape);
    if (place.materials[i] >= 0)
      backs[i] = surfaces_.back_of(&scene_.shapes[static_cast<std::size_t>(model.shapes[shape])],
                                   materials[i], surfaces_.named(place.materials[i]).back,
                                   [&] { return place_in(use, item); });
    else if (from.instances[i].back != scene::kNone)
      backs[i] = surfaces_.cad_material(place.model, model, from.instances[i].back);
  }
  if (first_import_.file == kNoFile) {
    first_import_ = Assembler::place(use, item);
    first_import_.file = file_of(use);
  }
  attach(model, place, {materials, backs}, context.node, context.world_from_node, context.prefix,
         attached_, scene_);
  import_joints(use, place, context);
  import_frames(use, item);
  for (const auto& [instance, of] : attached_.foiled)
    cover(use, place.foils[of].rule, instance, place.foils[of].preset, place.materials[of],
          source_of(use, item));
}

// ---- reports

FileId Assembler::file_of(Use& use) {
  if (use.own_file) return use.file;
  SourceMap& sources = reporter_.log().sources();
  SourceSpan at = use.included_at;
  at.file = file_of(*use.outer);
  const SourceFile& original = sources.file(use.part->source);
  SourceFile copy{original.name, original.bytes, original.encoding, at, use.used};
  use.file = sources.add(std::move(copy));
  use.own_file = true;
  return use.file;
}

SourceSpan Assembler::place(const Use& use, const Item& item) {
  return use.part->file->document.tag_span(item.element);
}

SourceSpan Assembler::place_in(Use& use, const Item& item) {
  SourceSpan where = place(use, item);
  where.file = file_of(use);
  return where;
}

SourceSpan Assembler::material_place(const Use& use, const Item& item) {
  const xml::Document& document = use.part->file->document;
  const std::uint32_t material = child_of(document, item.element, schemas::ElementId::material);
  return document.tag_span(material == 0 ? item.element : material);
}

bool assemble(const Loader& loader, std::uint32_t top, const Options& options, Reporter& reporter,
              scene::Scene& scene) {
  return Assembler(loader, options, reporter, scene).run(top);
}

}  // namespace panwright::pxn
