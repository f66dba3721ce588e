// What stands directly below the root: parameters, named materials, parts, the budget and the
// scene.

#include <fmt/format.h>

#include <algorithm>

#include "base/text.h"
#include "pxn/reader/loader.h"
#include "pxn/reader/material_reader.h"
#include "pxn/reader/presets.h"
#include "pxn/reader/shapes.h"
#include "pxn/text/grammar.h"
#include "pxn/text/reference.h"

namespace panwright::pxn {

namespace attribute = schemas::attribute;
using schemas::ElementId;

namespace {

double metres_of(std::string_view unit) {
  if (unit == "mm") return 1e-3;
  if (unit == "cm") return 1e-2;
  if (unit == "km") return 1e3;
  if (unit == "um") return 1e-6;
  if (unit == "in") return 0.0254;
  if (unit == "ft") return 0.3048;
  return 1;
}

}  // namespace

// Units first, then what includes bring, then parameters in their order, then names of definitions.
void Loader::read_root(File& file) {
  const xml::Document& document = file.document;
  Values& values = *file.values;
  file.units.level = schemas::kPxn.versions.size() - 1;  // where none is given, which was reported
  for (const schemas::Attribute& known : schemas::kPxn.elements[0].attributes)
    if (known.value.kind == schemas::ValueKind::version)
      if (const xml::Attribute* given = find_attribute(document, 0, known.name)) {
        const std::string version = xml::decoded(document, given->value_begin, given->value_end);
        const auto all = schemas::kPxn.versions;
        file.units.level = static_cast<std::size_t>(
            std::find(all.begin(), all.end(), std::string_view(version)) - all.begin());
      }
  values.set_units(file.units);
  if (file.units.level == 0) return;
  if (const auto unit = values.text(0, attribute::pangu_model_units))
    file.units.length = metres_of(*unit);
  if (const auto unit = values.text(0, attribute::pangu_model_angle))
    file.units.angle = *unit == "rad" ? 1 : kDegree;
  if (const auto up = values.text(0, attribute::pangu_model_up)) file.y_up = *up == "y";
  values.set_units(file.units);

  const std::uint32_t end = document.elements[0].next;
  const auto each = [&](ElementId id, const auto& read) {
    for (std::uint32_t c = 1; c < end; c = document.elements[c].next)
      if (document.elements[c].id == id) read(c);
  };
  each(ElementId::include_1, [&](std::uint32_t c) { import_definitions(file, c); });
  each(ElementId::param, [&](std::uint32_t c) { read_parameter(file, c); });
  each(ElementId::named_material,
       [&](std::uint32_t c) { define(file, c, attribute::named_material_name, file.materials); });
  each(ElementId::part,
       [&](std::uint32_t c) { define(file, c, attribute::part_name, file.parts); });
  each(ElementId::budget, [&](std::uint32_t c) { read_budget(file, c); });
  each(ElementId::scene, [&](std::uint32_t c) { read_scene(file, c); });
}

// Brings over what a file defines that the root includes. Whatever is wrong with the include itself
// is reported where it is read as a node.
void Loader::import_definitions(File& file, std::uint32_t element) {
  const xml::Attribute* given = find_attribute(file.document, element, "file");
  if (given == nullptr) return;
  const std::string name =
      to_utf8(xml::decoded(file.document, given->value_begin, given->value_end), Encoding::utf8);
  FoundFile found;
  if (files_.find(name, file.found, true, found) != Files::Outcome::found) return;
  if (file.level + 1 > options_.limits.include_depth) return;
  if (!known_files_.contains(found.key))
    load(found, file.values->value_place(element, attribute::include_1_file), file.level + 1);
  const auto index = known_files_.at(found.key);
  if (!index || parts_[*index].loading) return;
  const File& from = *parts_[*index].file;
  for (const auto& [parameter, value] : from.scope.own()) file.scope.set(parameter, value);
  merge(file, from.parts, file.parts, element);
  merge(file, from.materials, file.materials, element);
}

void Loader::merge(File& file, const Definitions& from, Definitions& to, std::uint32_t element) {
  for (const auto& each : from) {
    const Definition* const known = to.emplace(each).first->second;
    if (known == each.second) continue;
    reporter_.report(Code("E1210"), file.document.tag_span(element), file.document, element, [&] {
      return Reporter::Text(
          fmt::format("{} is defined by this file and by another that the root includes, {}",
                      in_quotes(each.first), in_quotes(known->file->found.name)));
    });
  }
}

// The name of a <param>, when it can be one and is not taken in its scope.
std::optional<std::string> Loader::parameter_name(File& file, std::uint32_t element,
                                                  const Scope& scope) {
  const auto name = file.values->text(element, attribute::param_name);
  if (!name) return std::nullopt;
  const SourceSpan where = file.values->value_place(element, attribute::param_name);
  if (!check_name(file.document, element, where, *name, reporter_)) return std::nullopt;
  if (!scope.has_own(*name)) return name;
  reporter_.report(Code("E1210"), where, file.document, element, [&] {
    return Reporter::Text(fmt::format("duplicate parameter {}", in_quotes(*name)));
  });
  return std::nullopt;
}

void Loader::read_parameter(File& file, std::uint32_t element) {
  const auto name = parameter_name(file, element, file.scope);
  auto value = file.values->quantity(element, attribute::param_value);
  if (!name) return;
  parameters_.insert(*name);
  for (const auto& [overridden, text] : options_.parameters)
    if (overridden == *name) value = overriding_value(*name, text, file.units);
  // one that cannot be read is there as well, so that its uses are no errors
  file.scope.set(*name, value.value_or(kUnread));
}

// The value of -D NAME=VALUE, read as that of a <param> of the file that declares it, so that it
// may hold what that may.
std::optional<Quantity> Loader::overriding_value(const std::string& name, const std::string& value,
                                                 const Units& units) {
  auto bytes = std::make_shared<const std::string>(fmt::format(
      "<param name=\"{}\" value=\"{}\"/>", markup_escaped(name), markup_escaped(value)));
  const FileId id =
      reporter_.log().sources().add({"-D " + name, std::move(bytes), Encoding::utf8, {}});
  xml::Document document = xml::scan(id, {16, 16}, reporter_.log());
  if (document.size() != 1) return std::nullopt;
  document.elements[0].id = ElementId::param;
  Values values(document, schemas::kPxn, reporter_);
  values.set_units(units);
  return values.quantity(0, attribute::param_value);
}

void Loader::check_overrides() {
  if (options_.declared != nullptr) {
    options_.declared->insert(parameters_.begin(), parameters_.end());
    return;
  }
  for (const auto& [name, value] : options_.parameters) {
    if (parameters_.contains(name)) continue;
    const std::vector<std::string_view> all(parameters_.begin(), parameters_.end());
    const auto near = nearest_name(name, all);
    reporter_.log().report_file(
        Code("E1225"), "",
        fmt::format("-D {}={}: {}", name, value,
                    all.empty()
                        ? "the model has no parameters"
                        : fmt::format("unknown parameter {}; there {} {}", in_quotes(name),
                                      all.size() == 1 ? "is" : "are", fmt::join(all, ", "))),
        near ? fmt::format("did you mean '{}'?", *near) : "");
  }
}

void Loader::define(File& file, std::uint32_t element, std::size_t attribute, Definitions& known) {
  const auto name = file.values->text(element, attribute);
  Definition& definition = file.definitions.emplace_back();
  definition.file = &file;
  definition.element = element;
  if (!name) return;
  definition.name = *name;
  const Definition* const first = known.emplace(*name, &definition).first->second;
  if (first == &definition) return;
  reporter_.report(Code("E1210"), file.values->value_place(element, attribute), file.document,
                   element, [&] {
                     const File& other = *first->file;
                     return Reporter::Text(
                         fmt::format("{} is defined already{}", in_quotes(*name),
                                     &other == &file ? "" : ", in " + in_quotes(other.found.name)));
                   });
}

void Loader::read_budget(File& file, std::uint32_t element) {
  Values& values = *file.values;
  scene::Budget budget;
  budget.tolerance = values.real(element, attribute::budget_tolerance);
  budget.nearest = values.real(element, attribute::budget_nearest);
  budget.ifov = values.real(element, attribute::budget_ifov);
  budget.pixels = values.real(element, attribute::budget_pixels);
  budget.flux = values.real(element, attribute::budget_flux);
  budget.centroid = values.real(element, attribute::budget_centroid);
  if (budget.nearest && budget.ifov && !budget.pixels &&
      !values.has(element, attribute::budget_pixels))
    budget.pixels = scene::Budget::kDefaultPixels;
  budget.source = {file.found.path, file.positions[element].first, file.positions[element].second};
  if (const auto approach = values.text(element, attribute::budget_approach))
    budget.approach = *approach;
  budget.corridor = values.real(element, attribute::budget_corridor).value_or(budget.corridor);
  if (file.level == 0) {
    scene_.budget = budget;
    budget_file_ = &file;
    budget_ = element;
    return;
  }
  reporter_.report(Code("N1314"), file.document.tag_span(element), file.document, element, [&] {
    return Reporter::Text("the budget of an included file is not used; the top file's holds");
  });
}

void Loader::check_approach() {
  std::string& approach = scene_.budget.approach;
  std::vector<std::string_view> names;
  for (const scene::Frame& frame : scene_.frames) names.push_back(frame.name);
  if (approach.empty() || std::ranges::find(names, approach) != names.end()) return;
  reporter_.report(Code("E1311"),
                   budget_file_->values->value_place(budget_, attribute::budget_approach),
                   budget_file_->document, budget_, [&]() -> Reporter::Text {
                     const auto near = nearest_name(approach, names);
                     return {fmt::format("unknown frame {}", in_quotes(approach)),
                             near            ? fmt::format("did you mean '{}'?", *near)
                             : names.empty() ? "the model has no <frame>"
                                             : ""};
                   });
  approach.clear();
}

// Reads what nothing has asked for, for its problems, and says which parts stay unused.
void Loader::read_definitions(File& file) {
  // a file that shows nothing itself is there for its definitions
  const std::vector<Item>& items = parts_[*known_files_.at(file.found.key)].items;
  const bool is_library =
      file.level > 0 || std::all_of(items.begin(), items.end(), [](const Item& item) {
        return item.kind == ItemKind::include;
      });
  for (Definition& definition : file.definitions) {
    if (file.document.elements[definition.element].id == ElementId::named_material) {
      material_of(definition);
      continue;
    }
    if (definition.parts.empty()) part_of(definition, {}, {});
    if (definition.used || is_library || definition.name.empty()) continue;
    reporter_.report(Code("W1315"), file.document.tag_span(definition.element), file.document,
                     definition.element, [&] {
                       return Reporter::Text(fmt::format("the part {} is not used by anything",
                                                         in_quotes(definition.name)));
                     });
  }
  read_backs(file);
  for (std::uint32_t c = 1; c < file.document.elements[0].next; c = file.document.elements[c].next)
    if (file.document.elements[c].id == ElementId::terrain) read_terrain(file, c);
}

std::optional<std::uint32_t> Loader::part_of(Definition& definition, const Arguments& arguments,
                                             SourceSpan used_at) {
  if (definition.reading) return std::nullopt;
  ArgumentsKey key;
  for (const auto& [name, value] : arguments)
    key.emplace_back(name, value.value, value.dimension, value.length, value.angle, value.pi,
                     value.ratio);
  const auto known = definition.parts.find(key);
  if (known != definition.parts.end()) return known->second;
  File& file = *definition.file;
  definition.reading = true;
  const Reporter::Elsewhere elsewhere(reporter_);
  const std::uint32_t index = add_part(file, definition.element);
  Part& part = parts_[index];
  part.name = definition.name;
  // its places know who used it first
  const FileId own = file.document.file;
  if (used_at.file != kNoFile) {
    SourceMap& sources = reporter_.log().sources();
    SourceFile copy = sources.file(own);
    copy.included_at = used_at;
    copy.used = true;
    part.source = sources.add(std::move(copy));
  }
  const Scope* const around = file.values->scope();
  const std::uint32_t repeats = std::exchange(repeats_, 0);
  Scope scope(&file.scope);
  file.document.file = part.source;
  file.values->set_scope(&scope);
  read_part_parameters(file, definition.element, arguments, scope);
  Work work{file, part, &scope};
  ++nesting_;
  walk_children(work, definition.element, 1);
  --nesting_;
  file.document.file = own;
  file.values->set_scope(around);
  repeats_ = repeats;
  part.loading = false;
  definition.reading = false;
  definition.parts.emplace(std::move(key), index);
  return index;
}

void Loader::read_part_parameters(File& file, std::uint32_t element, const Arguments& arguments,
                                  Scope& scope) {
  const xml::Document& document = file.document;
  const std::uint32_t end = document.elements[element].next;
  for (std::uint32_t c = element + 1; c < end; c = document.elements[c].next)
    if (document.elements[c].id == ElementId::param)
      if (const auto name = parameter_name(file, c, scope)) {
        const auto value = file.values->quantity(c, attribute::param_value);
        const auto given = arguments.find(*name);
        scope.set(*name, given != arguments.end() ? given->second : value.value_or(kUnread));
      }
}

// What a use gives to its part; false when a value cannot be read. A name that the part does not
// have is reported and left out.
bool Loader::read_arguments(Work& work, std::uint32_t element, const Definition& definition,
                            Arguments& arguments) {
  const xml::Document& document = work.file.document;
  Values& values = *work.file.values;
  const xml::Document& other = definition.file->document;
  bool ok = true;
  const std::uint32_t end = document.elements[element].next;
  for (std::uint32_t c = element + 1; c < end; c = document.elements[c].next) {
    if (document.elements[c].id != ElementId::with) continue;
    const auto name = values.text(c, attribute::with_name);
    const auto value = values.quantity(c, attribute::with_value);
    ok = ok && name && value;
    if (!name || !value) continue;
    std::vector<std::string> all;
    const std::uint32_t last = other.elements[definition.element].next;
    for (std::uint32_t p = definition.element + 1; p < last; p = other.elements[p].next)
      if (other.elements[p].id == ElementId::param)
        if (const xml::Attribute* given = find_attribute(other, p, "name"))
          all.push_back(xml::decoded(other, given->value_begin, given->value_end));
    if (std::find(all.begin(), all.end(), *name) != all.end()) {
      if (!arguments.emplace(*name, *value).second)
        reporter_.report(
            Code("E1210"), values.value_place(c, attribute::with_name), document, c, [&] {
              return Reporter::Text(
                  fmt::format("{} has a value already; the first one is used", in_quotes(*name)));
            });
      continue;
    }
    reporter_.report(Code("E1222"), values.value_place(c, attribute::with_name), document, c,
                     [&]() -> Reporter::Text {
                       const std::vector<std::string_view> names(all.begin(), all.end());
                       const auto near = nearest_name(*name, names);
                       return {fmt::format("the part {} has no parameter {}",
                                           in_quotes(definition.name), in_quotes(*name)),
                               near ? fmt::format("did you mean '{}'?", *near) : ""};
                     });
  }
  return ok;
}

std::optional<std::uint32_t> Loader::material_of(Definition& definition) {
  if (definition.index || definition.reading) return definition.index;
  File& file = *definition.file;
  const xml::Document& document = file.document;
  const std::uint32_t element = definition.element;
  const Scope* const around = file.values->scope();
  file.values->set_scope(&file.scope);
  definition.reading = true;
  materials::Fields fields;
  Provenance provenance;
  BackMaterial back;
  if (file.values->has(element, attribute::named_material_base)) {
    Definition* const base =
        look_up(file, element, attribute::named_material_base, file.materials, "material");
    if (base != nullptr && base->reading)
      reporter_.report(Code("E1312"),
                       file.values->value_place(element, attribute::named_material_base), document,
                       element, [&] {
                         return Reporter::Text(fmt::format(
                             "the material {} is based on itself{}", in_quotes(base->name),
                             base == &definition ? "" : " through others"));
                       });
    else if (base != nullptr && nesting_ >= options_.limits.depth)
      reporter_.report(
          Code("E1006"), file.values->value_place(element, attribute::named_material_base),
          document, element, [&] {
            return Reporter::Text(fmt::format("materials are based on each other deeper than {}",
                                              options_.limits.depth));
          });
    else if (base != nullptr) {
      ++nesting_;
      if (const auto index = material_of(*base)) {
        fields = materials_[*index].fields;
        provenance = materials_[*index].provenance;
      }
      --nesting_;
    }
  }
  if (const Preset* given = preset_of(file, element)) {
    fields = given->fields;
    provenance = given->provenance;
    back = {-1, given->back};
  }
  // note: files are read on the file's main part, which is there by now
  Work work{file, parts_[*known_files_.at(file.found.key)], &file.scope};
  materials::Fields own = read_material(document, element, *file.values, reporter_);
  read_spectra(work, element, own);
  fields = fields.overridden_by(own);
  const materials::Maps maps = read_maps(work, element, fields.maps.value_or(materials::Maps{}));
  if (maps.any()) fields.maps = maps;
  file.values->set_scope(around);
  definition.reading = false;
  definition.index = static_cast<std::uint32_t>(materials_.size());
  read_provenance(document, element, *file.values, provenance);
  materials_.push_back({definition.name, fields, document.tag_span(element), provenance, back});
  return definition.index;
}

// The backs of the file's materials, all of which have been read: two may be each other's.
void Loader::read_backs(File& file) {
  std::map<std::uint32_t, std::uint32_t> elements;  // by index: bases come first
  for (const Definition& definition : file.definitions)
    if (definition.index) elements[*definition.index] = definition.element;
  for (const auto& [index, element] : elements) {
    if (file.values->has(element, attribute::named_material_back)) {
      materials_[index].back = back_of(file, element, attribute::named_material_back);
    } else if (!file.values->has(element, attribute::named_material_preset)) {
      const auto base = file.values->text(element, attribute::named_material_base);
      const auto found = base ? file.materials.find(*base) : file.materials.end();
      if (found != file.materials.end() && found->second->index)
        materials_[index].back = materials_[*found->second->index].back;
    }
  }
}

// A named material of the file, or else one of the library.
BackMaterial Loader::back_of(File& file, std::uint32_t element, std::size_t which) {
  const auto name = file.values->text(element, which);
  if (!name || *name == "none") return {};
  if (const auto found = file.materials.find(*name); found != file.materials.end()) {
    const auto index = material_of(*found->second);
    return {index ? static_cast<std::int32_t>(*index) : -1, {}};
  }
  const std::vector<std::string_view> library = preset_names();
  if (const auto found = std::ranges::find(library, *name); found != library.end())
    return {-1, *found};
  reporter_.report(Code("E1311"), file.values->value_place(element, which), file.document, element,
                   [&]() -> Reporter::Text {
                     std::vector<std::string_view> names = library;
                     names.push_back("none");
                     for (const auto& [other, definition] : file.materials) names.push_back(other);
                     const auto near = nearest_name(*name, names);
                     return {fmt::format("unknown material {}", in_quotes(*name)),
                             near ? fmt::format("did you mean '{}'?", *near)
                                  : "it is none of the file's, nor of the library's, which "
                                    "`panwright material --list` lists"};
                   });
  return {};
}

// The library's material of a name, or whose name ends with it after "_"; empty: none, or several.
std::string_view preset_named(std::string_view name) {
  std::string_view found;
  for (const std::string_view each : preset_names()) {
    if (each == name) return each;
    if (name.size() < 4 || !each.ends_with(name) || each[each.size() - name.size() - 1] != '_')
      continue;
    if (!found.empty()) return {};
    found = each;
  }
  return found;
}

// The library's material that a named one starts from; nullptr where it names none.
const Preset* Loader::preset_of(File& file, std::uint32_t element) {
  const auto name = file.values->text(element, attribute::named_material_preset);
  if (!name) return nullptr;
  const Preset* const found = find_preset(*name);
  if (found == nullptr)
    reporter_.report(Code("E1311"),
                     file.values->value_place(element, attribute::named_material_preset),
                     file.document, element, [&]() -> Reporter::Text {
                       const auto near = nearest_name(*name, preset_names());
                       return {fmt::format("the library has no material {}", in_quotes(*name)),
                               near ? fmt::format("did you mean '{}'?", *near)
                                    : "`panwright material --list` lists its materials"};
                     });
  return found;
}

Definition* Loader::look_up(File& file, std::uint32_t element, std::size_t attribute,
                            const Definitions& known, std::string_view what) {
  const auto name = file.values->text(element, attribute);
  if (!name) return nullptr;
  const auto found = known.find(*name);
  if (found != known.end()) return found->second;
  reporter_.report(
      Code("E1311"), file.values->value_place(element, attribute), file.document, element,
      [&]() -> Reporter::Text {
        std::vector<std::string_view> names;
        for (const auto& [other, definition] : known) names.push_back(other);
        const auto near = nearest_name(*name, names);
        const auto preset = what == "material" ? preset_named(*name) : std::string_view();
        return {fmt::format("unknown {} {}", what, in_quotes(*name)),
                !preset.empty()
                    ? fmt::format("the library has it: <material name=\"{}\" preset=\"{}\"/> below "
                                  "the root",
                                  *name, preset)
                : near ? fmt::format("did you mean '{}'?", *near)
                : names.empty()
                    ? fmt::format("define it with <{} name=\"{}\"> below the root", what, *name)
                    : ""};
      });
  return nullptr;
}

}  // namespace panwright::pxn
