#include "pxn/reader/loader.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <utility>

#include "base/file.h"
#include "base/hash.h"
#include "base/text.h"
#include "pxn/named_files.h"
#include "pxn/reader/material_reader.h"
#include "pxn/reader/shapes.h"
#include "pxn/text/grammar.h"

namespace panwright::pxn {

namespace attribute = schemas::attribute;
using schemas::ElementId;

namespace {

// what one repeat may run; all of them together are held by the limit of nodes
constexpr std::uint64_t kMostRepetitions = 1'000'000;

// Line and column of every element, in one walk over the text.
// note: SourceMap::position counts columns from the start of the line each time, which takes for
// ever in a large file without line ends
std::vector<std::pair<std::uint32_t, std::uint32_t>> positions_of(const xml::Document& document) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> positions;
  positions.reserve(document.size());
  std::uint32_t offset = 0;
  std::uint32_t line = 1;
  std::uint32_t column = 1;
  for (std::uint32_t element = 0; element < document.size(); ++element) {
    for (; offset < document.elements[element].begin; ++offset) {
      const char c = document.bytes[offset];
      const bool pair = c == '\r' && document.bytes[offset + 1] == '\n';
      if ((c == '\n' || c == '\r') && !pair) {
        ++line;
        column = 1;
      } else if (document.encoding != Encoding::utf8 ||
                 (static_cast<unsigned char>(c) & 0xc0) != 0x80) {
        ++column;
      }
    }
    positions.emplace_back(line, column);
  }
  return positions;
}

bool is_shape(ElementId id) {
  return id != schemas::kNoElement && schemas::kPxn.elements[static_cast<std::size_t>(id)].shape;
}

// Whether an element stands among the items of its part.
bool makes_item(ElementId id) {
  switch (id) {
    case ElementId::group:
    case ElementId::node:
    case ElementId::joint:
    case ElementId::transform:
    case ElementId::transform_1:
    case ElementId::rotate:
    case ElementId::appearance:
    case ElementId::include:
    case ElementId::include_1:
    case ElementId::use:
    case ElementId::import:
    case ElementId::frame_s:
    case ElementId::frame:
    case ElementId::keypoint:
    case ElementId::lamp:
    case ElementId::decal:
      return true;
    default:
      return is_shape(id);
  }
}

}  // namespace

std::uint32_t child_of(const xml::Document& document, std::uint32_t element, ElementId id) {
  const std::uint32_t end = document.elements[element].next;
  for (std::uint32_t c = element + 1; c < end; c = document.elements[c].next)
    if (document.elements[c].id == id) return c;
  return 0;
}

std::optional<std::size_t> attribute_of(const xml::Document& document, std::uint32_t element,
                                        std::string_view name) {
  const auto id = static_cast<std::size_t>(document.elements[element].id);
  const auto known = schemas::kPxn.elements[id].attributes;
  for (std::size_t i = 0; i < known.size(); ++i)
    if (known[i].name == name) return i;
  return std::nullopt;
}

// ---- files

std::optional<std::uint32_t> Loader::load_top(const FoundFile& top) {
  const auto part = load(top, {}, 0);
  check_overrides();
  return complete_ ? part : std::nullopt;
}

std::optional<std::uint32_t> Loader::load(const FoundFile& found, SourceSpan included_at,
                                          std::uint32_t level) {
  auto& known = known_files_[found.key];
  auto bytes = files_.load(found, included_at, reporter_.log());
  if (!bytes) return std::nullopt;
  add_input(found, as_bytes(**bytes));
  if (const auto& uses = reporter_.log().files()) declare_named_files(found.name, **bytes, *uses);

  File& file = loaded_files_.emplace_back();
  file.found = found;
  file.level = level;
  const FileId id =
      reporter_.log().sources().add({found.name, *bytes, Encoding::utf8, included_at});
  const std::uint64_t left =
      options_.limits.elements - std::min(options_.limits.elements, elements_);
  file.document = xml::scan(id, {left, options_.limits.depth}, reporter_.log());
  elements_ += file.document.size();
  complete_ = complete_ && file.document.complete;
  const std::uint32_t index = add_part(file, 0);
  known = index;
  Part& part = parts_[index];
  part.height = file.document.height;
  const bool understood = check_grammar(file.document, schemas::kPxn, reporter_);
  if (understood) {
    file.positions = positions_of(file.document);
    file.values = std::make_unique<Values>(file.document, schemas::kPxn, reporter_);
    file.values->set_scope(&file.scope);
    read_root(file);
    Work work{file, part, &file.scope};
    walk_children(work, 0, 1);
    read_definitions(file);
  }
  part.loading = false;
  if (!understood) known_files_[found.key] = std::nullopt;
  return understood ? std::optional(index) : std::nullopt;
}

std::uint32_t Loader::add_part(File& file, std::uint32_t element) {
  Part& part = parts_.emplace_back();
  part.file = &file;
  part.source = file.document.file;
  part.element = element;
  return static_cast<std::uint32_t>(parts_.size() - 1);
}

void Loader::add_input(const FoundFile& file, std::span<const std::byte> bytes) {
  if (inputs_.insert(file.key).second)
    scene_.inputs.push_back({file.path, hash128(bytes), bytes.size()});
}

std::optional<FoundFile> Loader::find(Work& work, std::uint32_t element, std::size_t attribute,
                                      const std::string& file) {
  FoundFile found;
  const bool own_folder = work.file.units.level >= 1;
  const Files::Outcome outcome = files_.find(file, work.file.found, own_folder, found);
  if (outcome == Files::Outcome::found) return found;
  const SourceSpan where = work.file.values->value_place(element, attribute);
  const xml::Document& document = work.file.document;
  if (outcome == Files::Outcome::outside) {
    reporter_.report(Code("E1303"), where, document, element, [&] {
      return Reporter::Text(
          fmt::format(
              "{} leaves the project; included files lie in the top file's folder or below it",
              in_quotes(file)),
          "--root DIR takes files from all of DIR");
    });
    return std::nullopt;
  }
  reporter_.report(Code("E1301"), where, document, element, [&]() -> Reporter::Text {
    const std::string near = files_.near_name(file, work.file.found, own_folder);
    std::string hint;
    if (!near.empty() && near != file)
      hint = fmt::format("did you mean '{}'?", near);
    else if (file.find('\\') != std::string::npos)
      hint = "folders are separated by '/'";
    const std::string_view where_looked =
        own_folder ? "in this file's folder"
                   : "neither from the top file's folder nor from this file's";
    return {own_folder ? fmt::format("file {} not found {}", in_quotes(file), where_looked)
                       : fmt::format("file {} not found, {}", in_quotes(file), where_looked),
            hint};
  });
  return std::nullopt;
}

// ---- items

std::optional<std::uint32_t> Loader::add_item(Work& work, ItemKind kind, std::uint32_t element,
                                              std::uint32_t data, std::uint32_t properties) {
  // note: the root is a node as well
  if (++items_ >= options_.limits.nodes && repeats_ > 0) {
    if (complete_)
      reporter_.report(Code("E1313"), work.file.document.tag_span(element), work.file.document,
                       element, [&] {
                         return Reporter::Text(
                             fmt::format("repeats make more than {} nodes", options_.limits.nodes));
                       });
    complete_ = false;
    return std::nullopt;
  }
  const auto index = static_cast<std::uint32_t>(work.part.items.size());
  work.part.items.push_back({kind, element, index + 1, data, properties});
  return index;
}

void Loader::walk_children(Work& work, std::uint32_t element, std::uint32_t depth) {
  const xml::Document& document = work.file.document;
  const std::uint32_t end = document.elements[element].next;
  for (std::uint32_t c = element + 1; c < end && complete_; c = document.elements[c].next)
    walk(work, c, depth);
}

// Reads a node, or what holds one. depth: of the element's parents, the root included.
void Loader::walk(Work& work, std::uint32_t element, std::uint32_t depth) {
  job_.poll();
  if (work.part.element != 0) work.part.height = std::max(work.part.height, depth + 1);
  switch (work.file.document.elements[element].id) {
    case ElementId::group:
      check_group_count(work, element);
      [[fallthrough]];
    case ElementId::node:
      read_node(work, element, depth, read_properties(work, element));
      break;
    case ElementId::joint:
      read_joint(work, element, depth);
      break;
    case ElementId::transform:
    case ElementId::transform_1:
    case ElementId::rotate: {
      const std::uint32_t properties = read_properties(work, element);
      auto& transform = work.part.properties[properties].transform;
      if (!transform) transform.emplace();
      read_placing_children(work, element, *transform);
      read_node(work, element, depth, properties);
      break;
    }
    case ElementId::appearance:
      read_appearance(work, element, depth);
      break;
    case ElementId::texture:
      read_texture(work, element, depth);
      break;
    case ElementId::repeat:
      read_repeat(work, element, depth);
      break;
    case ElementId::include:
    case ElementId::include_1:
      read_include(work, element, depth + 1);
      break;
    case ElementId::use:
      read_use(work, element, depth + 1);
      break;
    case ElementId::import:
      read_import(work, element);
      break;
    case ElementId::frame_s:
      read_frame_s(work, element);
      break;
    case ElementId::frame:
      read_frame(work, element);
      break;
    case ElementId::keypoint:
      read_keypoint(work, element);
      break;
    case ElementId::lamp:
      read_lamp(work, element);
      break;
    case ElementId::decal:
      read_decal(work, element);
      break;
    default:  // else definitions, and what has been reported
      if (is_shape(work.file.document.elements[element].id)) read_shape(work, element);
      break;
  }
}

void Loader::read_node(Work& work, std::uint32_t element, std::uint32_t depth,
                       std::uint32_t properties) {
  const auto item = add_item(work, ItemKind::node, element, 0, properties);
  if (!item) return;
  if (const std::uint32_t child = child_of(work.file.document, element, ElementId::child))
    walk_children(work, child, depth + 2);
  walk_children(work, element, depth + 1);
  work.part.items[*item].end = static_cast<std::uint32_t>(work.part.items.size());
}

void Loader::read_appearance(Work& work, std::uint32_t element, std::uint32_t depth) {
  const xml::Document& document = work.file.document;
  const std::uint32_t material = child_of(document, element, ElementId::material);
  work.part.fields.push_back(material == 0
                                 ? materials::Fields{}
                                 : read_material(document, material, *work.file.values, reporter_));
  const auto item = add_item(work, ItemKind::appearance, element,
                             static_cast<std::uint32_t>(work.part.fields.size() - 1));
  if (!item) return;
  if (const std::uint32_t child = child_of(document, element, ElementId::child))
    walk_children(work, child, depth + 2);
  work.part.items[*item].end = static_cast<std::uint32_t>(work.part.items.size());
}

void Loader::read_texture(Work& work, std::uint32_t element, std::uint32_t depth) {
  const auto texture = read_sphere_texture(work, element);
  std::optional<std::uint32_t> item;
  if (texture) {
    item = add_item(work, ItemKind::texture, element, *texture);
    if (!item) return;
  }
  if (const std::uint32_t child = child_of(work.file.document, element, ElementId::child))
    walk_children(work, child, depth + 2);
  if (item) work.part.items[*item].end = static_cast<std::uint32_t>(work.part.items.size());
}

void Loader::check_group_count(Work& work, std::uint32_t element) {
  const xml::Document& document = work.file.document;
  const auto count = work.file.values->integer(element, attribute::group_count);
  if (!count) return;
  // elements that are wrong or not supported stand there too
  std::uint64_t there = 0;
  const std::uint32_t end = document.elements[element].next;
  for (std::uint32_t c = element + 1; c < end; c = document.elements[c].next) ++there;
  if (*count == there) return;
  const SourceSpan where = work.file.values->value_place(element, attribute::group_count);
  reporter_.report(Code("W1205"), where, document, element, [&] {
    return Reporter::Text(
        fmt::format("count is {}, and the group holds {}", *count, counted(there, "node")));
  });
}

// The items that an element makes at least, up to a limit; of a repeat, one run.
// note: what expressions say, and what is inside of parts and files, is not known here
std::uint64_t Loader::least_items(const File& file, std::uint32_t element, std::uint64_t limit) {
  const xml::Document& document = file.document;
  std::uint64_t items = 0;
  const std::uint32_t end = document.elements[element].next;
  for (std::uint32_t c = element + 1; c < end && items < limit; c = document.elements[c].next) {
    const ElementId id = document.elements[c].id;
    if (id == schemas::kNoElement) continue;
    std::uint64_t times = 1;
    if (id == ElementId::repeat) {
      const xml::Attribute* given = find_attribute(document, c, "count");
      if (given == nullptr) continue;
      const std::string text = xml::decoded(document, given->value_begin, given->value_end);
      const char* const last = text.data() + text.size();
      const auto [rest, error] = std::from_chars(text.data(), last, times);
      if (error != std::errc() || rest != last) continue;
    } else if (makes_item(id)) {
      ++items;
    }
    const std::uint64_t inside = least_items(file, c, limit);
    items += inside == 0 || times <= limit / inside ? times * inside : limit;
  }
  return std::min(items, limit);
}

// Whether so many runs of a repeat may fit; reported where they cannot.
bool Loader::fits_in_model(Work& work, std::uint32_t element, std::uint64_t count) {
  const std::uint64_t limit = options_.limits.nodes;
  const std::uint64_t inside = least_items(work.file, element, limit);
  if (inside == 0 || count < (limit + inside - 1) / inside) return true;
  const xml::Document& document = work.file.document;
  reporter_.report(Code("E1313"), work.file.values->value_place(element, attribute::repeat_count),
                   document, element, [&] {
                     return Reporter::Text(fmt::format(
                         "{} repetitions of {} or more; a model has at most {} with its root",
                         count, counted(inside, "node"), limit));
                   });
  return false;
}

void Loader::read_repeat(Work& work, std::uint32_t element, std::uint32_t depth) {
  Values& values = *work.file.values;
  const xml::Document& document = work.file.document;
  const auto count = values.integer(element, attribute::repeat_count);
  std::string variable(values.default_text(element, attribute::repeat_var));
  if (values.has(element, attribute::repeat_var)) {
    const auto given = values.text(element, attribute::repeat_var);
    if (!given) return;
    variable = *given;
  }
  if (!check_name(document, element, values.value_place(element, attribute::repeat_var), variable,
                  reporter_))
    return;
  if (!count) return;
  if (!fits_in_model(work, element, *count)) return;
  if (*count > kMostRepetitions) {
    reporter_.report(Code("E1313"), values.value_place(element, attribute::repeat_count), document,
                     element, [&] {
                       return Reporter::Text(fmt::format("{} repetitions, expected at most {}",
                                                         *count, kMostRepetitions));
                     });
    return;
  }
  Scope scope(work.scope);
  scope.set(variable, {});
  const Scope* const outer = work.scope;
  work.scope = &scope;
  values.set_scope(&scope);
  ++repeats_;
  const std::uint32_t outer_run = work.run;
  for (std::uint64_t i = 0; i < *count && complete_; ++i) {
    const auto number = static_cast<double>(i);
    scope.set(variable, {number, schemas::Dimension::none});
    // note: runs around nothing add no items
    if (++runs_ > kMostRepetitions) {
      reporter_.report(Code("E1313"), document.tag_span(element), document, element, [&] {
        return Reporter::Text(
            fmt::format("the repeats of this model run more than {} times", kMostRepetitions));
      });
      complete_ = false;
      break;
    }
    const Reporter::Repetition repetition(reporter_, variable, i);
    const auto first = static_cast<std::uint32_t>(work.part.items.size());
    const std::size_t seekers = work.part.decals.size() + work.part.wraps.size();
    work.run = static_cast<std::uint32_t>(work.part.runs.size());
    work.part.runs.push_back({first, first, outer_run});
    const std::uint32_t properties = read_properties(work, element);
    if (properties != kNoProperties)
      read_node(work, element, depth, properties);
    else
      walk_children(work, element, depth + 1);
    // those without decals and wraps are of no interest
    if (work.part.decals.size() + work.part.wraps.size() == seekers)
      work.part.runs.resize(work.run);
    else
      work.part.runs[work.run].end = static_cast<std::uint32_t>(work.part.items.size());
  }
  work.run = outer_run;
  --repeats_;
  work.scope = outer;
  values.set_scope(outer);
}

// ---- includes and uses

void Loader::read_include(Work& work, std::uint32_t element, std::uint32_t depth) {
  Values& values = *work.file.values;
  const xml::Document& document = work.file.document;
  const bool modern = document.elements[element].id == ElementId::include_1;
  const std::size_t which = modern ? attribute::include_1_file : attribute::include_file;
  const auto type =
      values.text(element, modern ? attribute::include_1_type : attribute::include_type);
  const auto name = values.text(element, which);
  if ((!type && !modern) || !name) return;
  const auto found = find(work, element, which, *name);
  if (!found) return;
  const SourceSpan where = values.value_place(element, which);
  const auto too_deep = [&] {
    reporter_.report(Code("E1304"), where, document, element, [&] {
      return Reporter::Text(
          fmt::format("includes are nested deeper than {} files", options_.limits.include_depth));
    });
  };
  const auto known = known_files_.find(found->key);
  std::optional<std::uint32_t> index;
  if (known == known_files_.end()) {
    if (work.file.level + 1 > options_.limits.include_depth) return too_deep();
    index = load(*found, where, work.file.level + 1);
  } else {
    index = known->second;
  }
  // problems of the file itself are already reported
  if (!index) return;
  const Part& inner = parts_[*index];
  if (inner.loading) {
    reporter_.report(Code("E1302"), where, document, element, [&] {
      return Reporter::Text(fmt::format("{} includes itself{}", in_quotes(inner.file->found.name),
                                        inner.file == &work.file ? "" : " through other files"));
    });
    return;
  }
  if (work.file.level + 1 + inner.include_height > options_.limits.include_depth) return too_deep();
  if (!fits_in(work, element, where, inner, *name, depth)) return;
  work.part.include_height = std::max(work.part.include_height, inner.include_height + 1);
  const std::uint32_t properties = modern ? read_properties(work, element) : kNoProperties;
  add_item(work, ItemKind::include, element, *index, properties);
}

void Loader::read_use(Work& work, std::uint32_t element, std::uint32_t depth) {
  const xml::Document& document = work.file.document;
  Definition* const definition =
      look_up(work.file, element, attribute::use_part, work.file.parts, "part");
  if (definition == nullptr) return;
  definition->used = true;
  const SourceSpan where = work.file.values->value_place(element, attribute::use_part);
  if (definition->reading) {
    reporter_.report(Code("E1312"), where, document, element, [&] {
      const bool direct =
          definition->file == &work.file && work.part.element == definition->element;
      return Reporter::Text(fmt::format("the part {} uses itself{}", in_quotes(definition->name),
                                        direct ? "" : " through other parts"));
    });
    return;
  }
  const std::uint32_t properties = read_properties(work, element);
  Arguments arguments;
  if (!read_arguments(work, element, *definition, arguments)) return;
  if (nesting_ >= options_.limits.depth) {
    work.part.too_deep = true;
    reporter_.report(Code("E1006"), where, document, element, [&] {
      return Reporter::Text(
          fmt::format("parts use each other deeper than {}", options_.limits.depth));
    });
    return;
  }
  const auto index = part_of(*definition, arguments, document.tag_span(element));
  // problems of the part itself are already reported
  if (!index) return;
  const Part& inner = parts_[*index];
  if (!fits_in(work, element, where, inner, definition->name, depth)) return;
  work.part.include_height = std::max(work.part.include_height, inner.include_height);
  add_item(work, ItemKind::use, element, *index, properties);
}

bool Loader::fits_in(Work& work, std::uint32_t element, SourceSpan where, const Part& inner,
                     const std::string& name, std::uint32_t depth) {
  if (inner.too_deep) work.part.too_deep = true;
  if (depth + inner.height > options_.limits.depth) {
    if (std::exchange(work.part.too_deep, true)) return false;
    reporter_.report(Code("E1006"), where, work.file.document, element, [&] {
      return Reporter::Text(fmt::format("with {} elements are nested deeper than {}",
                                        in_quotes(name), options_.limits.depth));
    });
    return false;
  }
  work.part.height = std::max(work.part.height, depth + inner.height);
  return true;
}

}  // namespace panwright::pxn
