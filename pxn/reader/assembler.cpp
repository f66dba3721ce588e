#include "pxn/reader/assembler.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>

#include "base/file.h"
#include "base/hash.h"
#include "base/text.h"
#include "geometry/tessellate/tessellate.h"
#include "pxn/reader/attach.h"
#include "pxn/reader/blankets.h"
#include "pxn/reader/joints.h"
#include "pxn/reader/pattern.h"
#include "pxn/reader/surfaces.h"
#include "pxn/text/grammar.h"

namespace panwright::pxn {

namespace {

// What is around an item.
struct Context {
  std::int32_t node = 0;
  Surface surface;
  std::string prefix;         // of names of frames and keypoints: the uses around
  std::int32_t texture = scene::kNone;
  Mat4 texture_from_node{1};
  Mat4 world_from_node{1};
};

// One use of a part. The first one shares its file id with the part; others get theirs when
// something is reported.
struct Use {
  const Part* part;
  FileId file;
  bool own_file;
  Use* outer;
  SourceSpan included_at;
  bool used = false;   // a part in its file, not an included file
  bool named = false;  // in names of frames and keypoints inside
  // for decals: items and instances by the names of their shapes, in the order of items; and the
  // items of those decals
  std::map<std::string, std::vector<std::pair<std::uint32_t, std::int32_t>>, std::less<>> shapes;
  std::vector<std::uint32_t> decals;
  // for wraps: how many nodes there were before each item, and what was around each wrap
  std::vector<std::uint32_t> nodes_before;
  std::vector<std::pair<std::uint32_t, Context>> wraps;
};

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

class Assembler {
 public:
  Assembler(const Loader& loader, const Options& options, Reporter& reporter, scene::Scene& scene)
      : loader_(loader),
        options_(options),
        reporter_(reporter),
        scene_(scene),
        surfaces_(loader, options, reporter, scene),
        attached_{{}, CellGrids(scene), {}, {}, {}, {}},
        blankets_(scene, options.crease_angle, loader.foil_vertices(), options.cache,
                  loader.job()) {}

  bool run(std::uint32_t top) {
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

 private:
  void items_of(Use& use, const Context& context) {
    use.nodes_before.resize(use.part->items.size() + 1);
    const auto first = static_cast<std::uint32_t>(scene_.nodes.size());
    items(use, 0, static_cast<std::uint32_t>(use.part->items.size()), context);
    use.nodes_before.back() = static_cast<std::uint32_t>(scene_.nodes.size());
    for (const std::uint32_t index : use.decals) decal(use, use.part->items[index]);
    for (const auto& [index, around] : use.wraps) wrap(use, index, around, context.node, first);
  }

  void items(Use& use, std::uint32_t begin, std::uint32_t end, const Context& context) {
    for (std::uint32_t i = begin; i < end && !stopped_; i = use.part->items[i].end)
      item(use, i, context);
  }

  void item(Use& use, std::uint32_t index, const Context& context) {
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

  std::string numbered(const std::string& base) {
    return fmt::format("{}{}", base, ++counters_[base]);
  }

  // The name itself the first time, then with a number; never one that is written in the same
  // place.
  std::string named(const Use& use, const std::string& base) {
    for (;;) {
      const std::uint32_t count = ++counters_[base];
      std::string name = count == 1 ? base : fmt::format("{}{}", base, count);
      if (!is_written_in(use, name) && made_.insert(name).second) return name;
    }
  }

  bool is_written_in(const Use& use, const std::string& name) {
    const Use* place = &use;
    while (!place->named) place = place->outer;
    return written_in(*place->part).contains(name);
  }

  // The names of uses and includes in a part, and in what it includes without a name.
  const std::set<std::string>& written_in(const Part& part) {
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

  const NodeProperties* properties_of(const Use& use, const Item& item) const {
    return item.properties == kNoProperties ? nullptr : &use.part->properties[item.properties];
  }

  // As written, or after the element with a number.
  std::string name_of(const Use& use, const Item& item) {
    const NodeProperties* properties = properties_of(use, item);
    if (properties != nullptr && !properties->name.empty()) return properties->name;
    return numbered(std::string(use.part->file->document.name(item.element)));
  }

  scene::Transform transform_of(const Use& use, const Item& item) const {
    const NodeProperties* properties = properties_of(use, item);
    return properties != nullptr && properties->transform ? *properties->transform
                                                          : scene::Transform{};
  }

  scene::Source source_of(const Use& use, const Item& item) const {
    const auto& [line, column] = use.part->file->positions[item.element];
    return {use.part->file->found.path, line, column};
  }

  // Makes a node below the context's, and the context its own.
  bool enter(Use& use, const Item& item, std::string name, const scene::Transform& transform,
             Context& context) {
    if (scene_.nodes.size() >= options_.limits.nodes) {
      report(Code::E1008, use, item, [&] {
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
      report(Code::E2010, use, item, [&] {
        return Reporter::Text(
            "the transforms down to here together scale or move by less than 1e-30 or more than "
            "1e30; "
            "this one is left out");
      });
    }
    scene_.nodes.push_back(std::move(node));
    context.node = static_cast<std::int32_t>(scene_.nodes.size() - 1);
    if (const NodeProperties* properties = properties_of(use, item);
        properties && properties->material >= 0)
      context.surface = surfaces_.named(properties->material);
    return true;
  }

  void shape(Use& use, std::uint32_t index, Context& context) {
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
        use.shapes[properties->name].emplace_back(
            index, static_cast<std::int32_t>(scene_.instances.size()));
    }
    scene_.instances.push_back(std::move(instance));
    if (properties && !properties->foil.empty())
      cover(use, item.element, static_cast<std::int32_t>(scene_.instances.size() - 1),
            properties->foil, properties->material, source_of(use, item));
  }

  // ---- joints

  void joint(Use& use, const PartJoint& known, std::uint32_t element, std::int32_t node,
             const std::string& prefix) {
    SourceSpan where = use.part->file->document.tag_span(element);
    where.file = file_of(use);
    if (joints_.add(known, node, prefix, where, use.part->file->document, element, scene_)) return;
    if (!taken_.insert({use.part, element}).second) return;
    report_at(Code::E1210, use, element, [&] {
      return Reporter::Text(fmt::format("duplicate joint {}; the contents of this one stay at rest",
                                        in_quotes(prefix + known.joint.name)));
    });
  }

  // The joints that stand for PartImport::moved: the first node's, which those of others follow.
  void import_joints(Use& use, const PartImport& place, const Context& context) {
    std::map<std::size_t, std::string> leaders;
    for (const auto& [index, node] : attached_.moving) {
      const PartImport::Moved& moved = place.moved[index];
      PartJoint known = use.part->joints[moved.joint];
      const auto [leader, first] = leaders.try_emplace(index, known.joint.name);
      if (!first) known = joints_.follower(known, leader->second);
      joint(use, known, moved.rule, node, context.prefix);
    }
    for (const std::size_t index : attached_.sheared)
      report_at(Code::E1231, use, place.moved[index].rule, [&] {
        const PartJoint& known = use.part->joints[place.moved[index].joint];
        return Reporter::Text(
            fmt::format("joint {} moves a node that its parents shear; it stays at rest",
                        in_quotes(known.joint.name)));
      });
  }

  // ---- blankets

  // What all blankets of an element have in common.
  FoilWish wish_of(Use& use, std::uint32_t element) {
    FoilWish wish;
    wish.document = &use.part->file->document;
    wish.where = wish.document->tag_span(element);
    wish.where.file = file_of(use);
    wish.element = element;
    return wish;
  }

  // A blanket of a preset over all of an instance.
  void cover(Use& use, std::uint32_t element, std::int32_t instance, std::string_view preset,
             std::int32_t named, const scene::Source& source) {
    const auto node =
        static_cast<std::size_t>(scene_.instances[static_cast<std::size_t>(instance)].node);
    FoilWish wish = wish_of(use, element);
    wish.on = {{instance, scene_.nodes[node].name + "_foil"}};
    wish.how.preset = preset;
    wish.blanket.material =
        named >= 0 ? surfaces_.named_material(named) : surfaces_.usual_material(preset);
    wish.blanket.source = source;
    blankets_.wish(std::move(wish));
  }

  // Once all nodes of the part are there. first: of its nodes.
  void wrap(Use& use, std::uint32_t index, const Context& around, std::int32_t top,
            std::uint32_t first) {
    const Item& item = use.part->items[index];
    const PartWrap& known = use.part->wraps[item.data];
    std::vector<std::int32_t> on = wrapped_instances(use, known, top, first);
    if (on.empty()) return report_no_match(use, item, known, first);
    const NodeProperties* properties = properties_of(use, item);
    scene::Instance blanket;
    const bool bare = around.surface.name.empty() && around.surface.place.file == kNoFile;
    blanket.material =
        properties && properties->material >= 0 ? surfaces_.named_material(properties->material)
        : bare && !known.blanket.preset.empty() ? surfaces_.usual_material(known.blanket.preset)
                                                : surfaces_.material(around.surface);
    if (properties && properties->back)
      blanket.back = surfaces_.back_of(nullptr, blanket.material, *properties->back,
                                       [&] { return place_in(use, item); });
    blanket.source = source_of(use, item);
    const std::string name = properties && !properties->name.empty() ? properties->name : "foil";
    FoilWish wish = wish_of(use, item.element);
    for (const std::int32_t instance : on)
      wish.on.emplace_back(instance, on.size() == 1 ? name : numbered(name));
    wish.how = known.blanket;
    wish.axes_from_world = glm::inverse(around.world_from_node);
    wish.faces = known.faces;
    if (known.tape >= 0) wish.tape = surfaces_.named_material(known.tape);
    if (known.edge >= 0) wish.edge = surfaces_.named_material(known.edge);
    wish.blanket = std::move(blanket);
    blankets_.wish(std::move(wish));
  }

  // Of those in the innermost repeat's run that holds some, or else of the whole part.
  std::vector<std::int32_t> wrapped_instances(const Use& use, const PartWrap& wrap,
                                              std::int32_t top, std::uint32_t first) const {
    std::vector<char> named(scene_.nodes.size(), 1);
    if (wrap.on) named = matching_nodes(scene_, static_cast<std::uint32_t>(top), Pattern(*wrap.on));
    const Pattern material(wrap.materials.value_or("*"));
    const auto fit = [&](std::uint32_t begin, std::uint32_t end) {
      std::vector<std::int32_t> out;
      for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
        const scene::Instance& instance = scene_.instances[i];
        const auto node = static_cast<std::uint32_t>(instance.node);
        if (node >= begin && node < end && named[node] &&
            material.fits(scene_.materials[static_cast<std::size_t>(instance.material)].name))
          out.push_back(static_cast<std::int32_t>(i));
      }
      return out;
    };
    for (std::uint32_t run = wrap.run; run != kNoRun; run = use.part->runs[run].outer) {
      const Run& r = use.part->runs[run];
      if (auto out = fit(use.nodes_before[r.begin], use.nodes_before[r.end]); !out.empty())
        return out;
    }
    return fit(first, use.nodes_before.back());
  }

  void report_no_match(Use& use, const Item& item, const PartWrap& wrap, std::uint32_t first) {
    report_at(Code::W1501, use, item.element, [&]() -> Reporter::Text {
      std::set<std::string> names;
      for (std::size_t i = first; i < scene_.nodes.size() && wrap.on; ++i)
        names.insert(scene_.nodes[i].name);
      for (std::size_t i = 0; i < scene_.instances.size() && !wrap.on; ++i)
        names.insert(scene_.materials[static_cast<std::size_t>(scene_.instances[i].material)].name);
      const std::string& pattern = wrap.on ? *wrap.on : *wrap.materials;
      return {fmt::format("no shape is covered: none at or below a {} that fits {}{}",
                          wrap.on ? "node" : "material", in_quotes(pattern),
                          wrap.on && wrap.materials ? fmt::format(" has a material that fits {}",
                                                                  in_quotes(*wrap.materials))
                                                    : ""),
              near_names(pattern, names)};
    });
  }

  template <class Compose>
  void report_at(Code code, Use& use, std::uint32_t element, const Compose& compose) {
    const xml::Document& document = use.part->file->document;
    SourceSpan where = document.tag_span(element);
    where.file = file_of(use);
    reporter_.report(code, where, document, element, compose);
  }

  void frame(Use& use, const Item& item, const Context& context) {
    const PartFrame& known = use.part->frames[item.data];
    const std::string name = context.prefix + known.label;
    if (!labels_.insert(name).second) {
      if (!taken_.insert({use.part, item.element}).second) return;
      report(Code::E1210, use, item, [&] {
        return Reporter::Text(
            fmt::format("duplicate frame {}; this one is left out", in_quotes(name)));
      });
      return;
    }
    scene_.frames.push_back(
        {name, context.node, known.origin, known.rotation, source_of(use, item)});
  }

  // Those of the CAD file that was attached last.
  void import_frames(Use& use, const Item& item) {
    for (scene::Frame& frame : attached_.frames) {
      if (labels_.insert(frame.name).second) {
        scene_.frames.push_back(std::move(frame));
        continue;
      }
      if (!taken_.insert({use.part, item.element}).second) continue;
      report(Code::E1210, use, item, [&] {
        return Reporter::Text(fmt::format("duplicate frame {} of the import; this one is left out",
                                          in_quotes(frame.name)));
      });
    }
  }

  void keypoint(Use& use, const Item& item, const Context& context) {
    const PartKeypoint& known = use.part->keypoints[item.data];
    const std::string name = context.prefix + known.name;
    if (!keypoints_.insert(name).second) {
      if (!taken_.insert({use.part, item.element}).second) return;
      report(Code::E1210, use, item, [&] {
        return Reporter::Text(
            fmt::format("duplicate keypoint {}; this one is left out", in_quotes(name)));
      });
      return;
    }
    scene_.keypoints.push_back({name, context.node, known.position, source_of(use, item)});
  }

  // Once the shapes of the part are there.
  void decal(Use& use, const Item& item) {
    const PartDecal& known = use.part->decals[item.data];
    const auto on = use.shapes.find(known.on);
    if (on == use.shapes.end()) {
      if (missing_.insert({use.part, item.element}).second && !is_written(*use.part, known.on))
        report_missing_shape(use, item, known.on);
      return;
    }
    if (known.decal.texture == scene::kNone) return;  // wrong, which has been said
    const auto& all = on->second;
    auto first = all.begin();
    auto last = all.end();
    for (std::uint32_t run = known.run; run != kNoRun; run = use.part->runs[run].outer) {
      const auto before = [](const auto& shape, std::uint32_t index) {
        return shape.first < index;
      };
      const auto from = std::lower_bound(all.begin(), all.end(), use.part->runs[run].begin, before);
      const auto to = std::lower_bound(from, all.end(), use.part->runs[run].end, before);
      if (from == to) continue;
      first = from;
      last = to;
      break;
    }
    for (; first != last; ++first) {
      if (scene_.decals.size() >= options_.limits.nodes) {
        report(Code::E1008, use, item, [&] {
          return Reporter::Text(
              fmt::format("the model has more than {} decals", options_.limits.nodes));
        });
        stopped_ = true;
        return;
      }
      scene::Decal decal = known.decal;
      decal.instance = first->second;
      decal.source = source_of(use, item);
      scene_.decals.push_back(std::move(decal));
    }
  }

  // Whether a shape of that name stands in the part, though nothing came of it: it was wrong, which
  // has been said, or is repeated no times. Names with expressions may be any.
  static bool is_written(const Part& part, std::string_view name) {
    const xml::Document& document = part.file->document;
    const std::uint32_t end = document.elements[part.element].next;
    for (std::uint32_t e = part.element + 1; e < end; ++e)
      if (const xml::Attribute* given = find_attribute(document, e, "name")) {
        const std::string written = xml::decoded(document, given->value_begin, given->value_end);
        if (written == name && document.elements[e].id != schemas::ElementId::decal) return true;
        if (written.find('{') != std::string::npos &&
            name.substr(0, written.find('{')) == written.substr(0, written.find('{')))
          return true;
      }
    return false;
  }

  void report_missing_shape(Use& use, const Item& item, const std::string& name) {
    report(Code::E1311, use, item, [&]() -> Reporter::Text {
      std::vector<std::string_view> names;
      for (const auto& [other, instances] : use.shapes) names.push_back(other);
      const auto near = nearest_name(name, names);
      return {fmt::format("no shape of this {} has the name {}",
                          use.part->element == 0 ? "file" : "part", in_quotes(name)),
              near ? fmt::format("did you mean '{}'?", *near) : ""};
    });
  }

  // An included file or a used part.
  void part(Use& use, const Item& item, Context& context) {
    const bool used = item.kind == ItemKind::use;
    if (!used && ++includes_ > options_.limits.includes) {
      if (includes_ == options_.limits.includes + 1)
        report(Code::E1304, use, item, [&] {
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

  void import(Use& use, const Item& item, Context& context) {
    const PartImport& place = use.part->imports[item.data];
    const ImportedModel& model = loader_.model(place.model);
    const scene::Scene& from = model.imported.scene;
    if (!enter(use, item, name_of(use, item), transform_of(use, item), context)) return;
    if (scene_.nodes.size() + from.nodes.size() > options_.limits.nodes + 1) {
      report(Code::E1008, use, item, [&] {
        return Reporter::Text(fmt::format("with the import's {} the model has more than {}",
                                          counted(from.nodes.size(), "node"),
                                          options_.limits.nodes));
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

  // The file id of this use, so that the include stack below a message is the right one.
  FileId file_of(Use& use) {
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

  static SourceSpan place(const Use& use, const Item& item) {
    return use.part->file->document.tag_span(item.element);
  }
  SourceSpan place_in(Use& use, const Item& item) {
    SourceSpan where = place(use, item);
    where.file = file_of(use);
    return where;
  }
  static SourceSpan material_place(const Use& use, const Item& item) {
    const xml::Document& document = use.part->file->document;
    const std::uint32_t material = child_of(document, item.element, schemas::ElementId::material);
    return document.tag_span(material == 0 ? item.element : material);
  }

  template <class Compose>
  void report(Code code, Use& use, const Item& item, const Compose& compose) {
    reporter_.report(code, place_in(use, item), use.part->file->document, item.element, compose);
  }

  const Loader& loader_;
  const Options& options_;
  Reporter& reporter_;
  scene::Scene& scene_;
  std::map<std::string, std::uint32_t> counters_;
  std::set<std::string> labels_;
  std::set<std::string> keypoints_;
  std::set<std::pair<const Part*, std::uint32_t>> missing_;  // decals without a shape, said once
  std::set<std::pair<const Part*, std::uint32_t>> taken_;    // names of these, said once
  std::set<std::string> made_;                               // by named()
  std::map<const Part*, std::set<std::string>> written_;     // by written_in()
  std::set<std::uint32_t> used_;
  Surfaces surfaces_;
  AttachedShapes attached_;
  Blankets blankets_;
  Joints joints_;
  SourceSpan first_import_;
  std::uint64_t includes_ = 0;
  bool stopped_ = false;
};

}  // namespace

bool assemble(const Loader& loader, std::uint32_t top, const Options& options, Reporter& reporter,
              scene::Scene& scene) {
  return Assembler(loader, options, reporter, scene).run(top);
}

}  // namespace panwright::pxn
