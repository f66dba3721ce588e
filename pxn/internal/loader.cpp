#include "pxn/internal/loader.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/file.h"
#include "base/hash.h"
#include "base/text.h"
#include "pxn/internal/grammar.h"
#include "pxn/internal/image.h"
#include "pxn/internal/shapes.h"

namespace panwright::pxn {

using schemas::ElementId;
using schemas::kNoElement;

std::uint32_t child_of(const xml::Document& document, std::uint32_t element, ElementId id) {
  const std::uint32_t end = document.elements[element].next;
  for (std::uint32_t c = element + 1; c < end; c = document.elements[c].next)
    if (document.elements[c].id == id) return c;
  return 0;
}

// ---- files

std::optional<std::uint32_t> Loader::load_top(const FoundFile& top) {
  const auto part = load(top, {}, 0);
  return complete_ ? part : std::nullopt;
}

std::optional<std::uint32_t> Loader::load(const FoundFile& file, SourceSpan included_at,
                                          std::uint32_t level) {
  auto& known = known_parts_[file.key];
  auto bytes = files_.load(file, included_at, reporter_.log());
  if (!bytes) return std::nullopt;
  add_input(file, as_bytes(**bytes));

  const auto index = static_cast<std::uint32_t>(parts_.size());
  Part& part = parts_.emplace_back();
  known = index;
  part.file = file;
  const FileId id = reporter_.log().sources().add({file.name, *bytes, Encoding::utf8, included_at});
  const std::uint64_t left =
      options_.limits.elements - std::min(options_.limits.elements, elements_);
  part.document = xml::scan(id, {left, options_.limits.depth}, reporter_.log());
  elements_ += part.document.size();
  complete_ = complete_ && part.document.complete;
  part.height = part.document.height;
  const bool understood = check_grammar(part.document, schemas::kPxn, reporter_);
  if (understood) {
    Work work{part, Values(part.document, schemas::kPxn, reporter_), level};
    walk_children(work, 0, 1);
  }
  part.loading = false;
  if (!understood) known_parts_[file.key] = std::nullopt;
  return understood ? std::optional(index) : std::nullopt;
}

void Loader::add_input(const FoundFile& file, std::span<const std::byte> bytes) {
  scene_.inputs.push_back({file.path, hash128(bytes), bytes.size()});
}

std::optional<FoundFile> Loader::find(Work& work, std::uint32_t element, std::size_t attribute,
                                      const std::string& file) {
  FoundFile found;
  const Files::Outcome outcome = files_.find(file, work.part.file, found);
  if (outcome == Files::Outcome::found) return found;
  const SourceSpan where = work.values.value_place(element, attribute);
  const xml::Document& document = work.part.document;
  if (outcome == Files::Outcome::outside) {
    reporter_.report(Code::E1303, where, document, element, [&] {
      return Reporter::Text(fmt::format(
          "{} leaves the project; included files lie in the top file's folder or below it",
          in_quotes(file)));
    });
    return std::nullopt;
  }
  reporter_.report(Code::E1301, where, document, element, [&]() -> Reporter::Text {
    const std::string near = files_.near_name(file);
    std::string hint;
    if (!near.empty() && near != file)
      hint = fmt::format("did you mean '{}'?", near);
    else if (file.find('\\') != std::string::npos)
      hint = "folders are separated by '/'";
    return {
        fmt::format("there is no file {}, neither from the top file's folder nor from this file's",
                    in_quotes(file)),
        hint};
  });
  return std::nullopt;
}

void Loader::read_include(Work& work, std::uint32_t element, std::uint32_t depth) {
  namespace attribute = schemas::attribute;
  const auto type = work.values.text(element, attribute::include_type);
  const auto file = work.values.text(element, attribute::include_file);
  if (!type || !file) return;
  const auto found = find(work, element, attribute::include_file, *file);
  if (!found) return;
  const xml::Document& document = work.part.document;
  const SourceSpan where = work.values.value_place(element, attribute::include_file);
  const auto known = known_parts_.find(found->key);
  std::optional<std::uint32_t> index;
  if (known == known_parts_.end()) {
    if (work.level + 1 > options_.limits.include_depth) {
      reporter_.report(Code::E1304, where, document, element, [&] {
        return Reporter::Text(
            fmt::format("includes are nested deeper than {} files", options_.limits.include_depth));
      });
      return;
    }
    index = load(*found, where, work.level + 1);
  } else {
    index = known->second;
  }
  // what is wrong with the file itself has been said
  if (!index) return;
  const Part& inner = parts_[*index];
  if (inner.loading) {
    reporter_.report(Code::E1302, where, document, element, [&] {
      return Reporter::Text(fmt::format("{} includes itself{}", in_quotes(inner.file.name),
                                        &inner == &work.part ? "" : " through other files"));
    });
    return;
  }
  if (work.level + 1 + inner.include_height > options_.limits.include_depth) {
    reporter_.report(Code::E1304, where, document, element, [&] {
      return Reporter::Text(
          fmt::format("includes are nested deeper than {} files", options_.limits.include_depth));
    });
    return;
  }
  if (depth + inner.height > options_.limits.depth) {
    reporter_.report(Code::E1006, where, document, element, [&] {
      return Reporter::Text(fmt::format("with {} elements are nested deeper than {}",
                                        in_quotes(*file), options_.limits.depth));
    });
    return;
  }
  work.part.height = std::max(work.part.height, depth + inner.height);
  work.part.include_height = std::max(work.part.include_height, inner.include_height + 1);
  add_item(work, ItemKind::include, element, *index);
}

// ---- items

std::uint32_t Loader::add_item(Work& work, ItemKind kind, std::uint32_t element,
                               std::uint32_t data) {
  Part& part = work.part;
  const auto index = static_cast<std::uint32_t>(part.items.size());
  part.items.push_back({kind, element, index + 1, data, 0, 0});
  place_item(work, part.items.back());
  return index;
}

// note: SourceMap::position counts columns from the start of the line each time, which takes for
// ever in a large file without line ends
void Loader::place_item(Work& work, Item& item) {
  const xml::Document& document = work.part.document;
  const std::uint32_t target = document.elements[item.element].begin;
  for (; work.offset < target; ++work.offset) {
    const char c = document.bytes[work.offset];
    const bool pair = c == '\r' && document.bytes[work.offset + 1] == '\n';
    if ((c == '\n' || c == '\r') && !pair) {
      ++work.line;
      work.column = 1;
    } else if (document.encoding != Encoding::utf8 ||
               (static_cast<unsigned char>(c) & 0xc0) != 0x80) {
      ++work.column;
    }
  }
  item.line = work.line;
  item.column = work.column;
}

void Loader::walk_children(Work& work, std::uint32_t element, std::uint32_t depth) {
  const std::uint32_t end = work.part.document.elements[element].next;
  for (std::uint32_t c = element + 1; c < end; c = work.part.document.elements[c].next)
    walk(work, c, depth);
}

// Reads a node, or what holds one. depth: of the element's parents, the root included.
void Loader::walk(Work& work, std::uint32_t element, std::uint32_t depth) {
  Part& part = work.part;
  const xml::Document& document = part.document;
  const auto inside = [&](ItemKind kind, std::uint32_t data) {
    const std::uint32_t item = add_item(work, kind, element, data);
    const std::uint32_t child = child_of(document, element, ElementId::child);
    if (child != 0) walk_children(work, child, depth + 2);
    part.items[item].end = static_cast<std::uint32_t>(part.items.size());
  };
  switch (document.elements[element].id) {
    case ElementId::group:
      read_group(work, element, depth);
      break;
    case ElementId::transform:
      inside(ItemKind::transform, read_transform(work, element));
      break;
    case ElementId::rotate:
      inside(ItemKind::rotate, read_rotate(work, element));
      break;
    case ElementId::appearance: {
      const std::uint32_t material = child_of(document, element, ElementId::material);
      part.fields.push_back(material == 0 ? materials::Fields{}
                                          : read_material(document, material, work.values));
      inside(ItemKind::appearance, static_cast<std::uint32_t>(part.fields.size() - 1));
      break;
    }
    case ElementId::texture:
      if (const auto texture = read_texture(work, element)) {
        inside(ItemKind::texture, *texture);
      } else if (const std::uint32_t child = child_of(document, element, ElementId::child)) {
        walk_children(work, child, depth + 2);
      }
      break;
    case ElementId::frame_s:
      read_frame(work, element);
      break;
    case ElementId::sphere:
      read_sphere(work, element);
      break;
    case ElementId::mesh:
      read_mesh(work, element);
      break;
    case ElementId::include:
      read_include(work, element, depth + 1);
      break;
    default:
      break;
  }
}

void Loader::read_group(Work& work, std::uint32_t element, std::uint32_t depth) {
  const xml::Document& document = work.part.document;
  const auto count = work.values.integer(element, schemas::attribute::group_count);
  if (count) {
    // elements that are wrong or not supported stand there too
    std::uint64_t there = 0;
    const std::uint32_t end = document.elements[element].next;
    for (std::uint32_t c = element + 1; c < end; c = document.elements[c].next) ++there;
    if (*count != there) {
      const SourceSpan where = work.values.value_place(element, schemas::attribute::group_count);
      reporter_.report(Code::W1205, where, document, element, [&] {
        return Reporter::Text(
            fmt::format("count is {}, and the group holds {}", *count, counted(there, "node")));
      });
    }
  }
  const std::uint32_t item = add_item(work, ItemKind::group, element, 0);
  walk_children(work, element, depth + 1);
  work.part.items[item].end = static_cast<std::uint32_t>(work.part.items.size());
}

std::uint32_t Loader::read_transform(Work& work, std::uint32_t element) {
  const xml::Document& document = work.part.document;
  scene::Transform transform;
  Vec3 numbers(0);
  const auto read = [&](ElementId id) {
    const std::uint32_t child = child_of(document, element, id);
    return child != 0 && work.values.numbers(child, std::span(&numbers.x, 3));
  };
  if (read(ElementId::scaling)) transform.scale = numbers;
  if (read(ElementId::translation)) transform.translation = numbers;
  if (read(ElementId::rotation)) {
    transform.rotation = quat_from_fixed_xyz(numbers);
    const int turns = (numbers.x != 0) + (numbers.y != 0) + (numbers.z != 0);
    if (turns > 1) {
      const std::uint32_t child = child_of(document, element, ElementId::rotation);
      reporter_.report(Code::N1209, document.tag_span(child), document, child, [&] {
        return Reporter::Text(fmt::format(
            "rotation about {} axes is read as x first, then y, then z, about fixed axes", turns));
      });
    }
  }
  work.part.transforms.push_back(transform);
  return static_cast<std::uint32_t>(work.part.transforms.size() - 1);
}

std::uint32_t Loader::read_rotate(Work& work, std::uint32_t element) {
  // what public files round their quaternions to
  constexpr double kLengthTolerance = 1e-3;
  const xml::Document& document = work.part.document;
  scene::Transform transform;
  double q[4] = {1, 0, 0, 0};
  const std::uint32_t child = child_of(document, element, ElementId::quat);
  if (child != 0 && work.values.numbers(child, q)) {
    const double length = glm::length(Vec4(q[0], q[1], q[2], q[3]));
    if (std::abs(length - 1) <= kLengthTolerance) {
      transform.rotation = Quat(q[0] / length, q[1] / length, q[2] / length, q[3] / length);
    } else {
      reporter_.report(Code::E1206, document.tag_span(child), document, child, [&] {
        return Reporter::Text(fmt::format(
            "the quaternion has length {:.6g}; it takes w x y z of length 1, to 1e-3", length));
      });
    }
  }
  work.part.transforms.push_back(transform);
  return static_cast<std::uint32_t>(work.part.transforms.size() - 1);
}

void Loader::read_frame(Work& work, std::uint32_t element) {
  const auto label = work.values.text(element, schemas::attribute::frame_s_label);
  auto frame = read_frame_axes(work.part.document, element, work.values, reporter_);
  if (!label || !frame) return;
  frame->label = *label;
  work.part.frames.push_back(*frame);
  add_item(work, ItemKind::frame, element, static_cast<std::uint32_t>(work.part.frames.size() - 1));
}

// ---- shapes

void Loader::read_sphere(Work& work, std::uint32_t element) {
  const auto rings = work.values.integer(element, schemas::attribute::sphere_rings);
  const auto quads = work.values.integer(element, schemas::attribute::sphere_quads);
  if (!rings || !quads) return;
  const geometry::SphereCounts counts{static_cast<std::uint32_t>(*rings),
                                      static_cast<std::uint32_t>(*quads)};
  const auto [known, added] = known_spheres_.emplace(
      std::pair(counts.rings, counts.quads), static_cast<std::uint32_t>(scene_.shapes.size()));
  if (added) scene_.shapes.push_back(geometry::Sphere{1, counts});
  add_item(work, ItemKind::sphere, element, known->second);
}

void Loader::read_mesh(Work& work, std::uint32_t element) {
  geometry::MeshShape mesh =
      read_mesh_shape(work.part.document, element, options_.crease_angle, work.values, reporter_);
  if (!mesh) return;
  scene_.shapes.push_back(std::move(mesh));
  add_item(work, ItemKind::mesh, element, static_cast<std::uint32_t>(scene_.shapes.size() - 1));
}

// ---- textures

std::optional<std::uint32_t> Loader::read_texture(Work& work, std::uint32_t element) {
  namespace attribute = schemas::attribute;
  const xml::Document& document = work.part.document;
  const auto type = work.values.text(element, attribute::texture_type);
  const std::uint32_t data = child_of(document, element, ElementId::data);
  const std::uint32_t include = data == 0 ? 0 : child_of(document, data, ElementId::include_raw);
  if (include == 0) return std::nullopt;
  const auto raw = work.values.text(include, attribute::include_raw_type);
  const auto file = work.values.text(include, attribute::include_raw_file);
  if (!type || !raw || !file) return std::nullopt;
  const auto found = find(work, include, attribute::include_raw_file, *file);
  if (!found) return std::nullopt;
  const auto known = known_textures_.find(found->key);
  if (known != known_textures_.end()) return known->second;
  return known_textures_[found->key] = load_texture(work, include, *file, *found);
}

std::optional<std::uint32_t> Loader::load_texture(Work& work, std::uint32_t element,
                                                  const std::string& file, const FoundFile& found) {
  const SourceSpan where = work.values.value_place(element, schemas::attribute::include_raw_file);
  const auto bytes = files_.load(found, where, reporter_.log());
  if (!bytes) return std::nullopt;
  add_input(found, as_bytes(**bytes));
  const std::uint64_t left = options_.limits.texture_bytes - texture_bytes_;
  DecodedImage image;
  const ImageProblem problem = decode_image(as_bytes(**bytes), left, image);
  if (problem.code) {
    reporter_.report(*problem.code, where, work.part.document, element, [&] {
      return Reporter::Text(fmt::format("{}: {}", in_quotes(file), problem.message));
    });
    return std::nullopt;
  }
  texture_bytes_ += image.rgba.size();
  scene_.textures.push_back({file, image.width, image.height, std::move(image.rgba), false});
  return static_cast<std::uint32_t>(scene_.textures.size() - 1);
}

}  // namespace panwright::pxn
