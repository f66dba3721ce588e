#include "pan/diff.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <map>
#include <utility>

#include "base/text.h"
#include "pan/fields.h"
#include "pan/internal/material_limits.h"
#include "pan/internal/record_keys.h"
#include "pan/internal/report.h"

namespace panwright::pan {

namespace {

using internal::Keys;
using internal::Numbering;
using internal::Side;
using layout::FieldRule;
using layout::FieldRuleKind;
using layout::SectionKind;

auto words_of(SectionKind kind) {
  return [kind](const Model& model, std::size_t i) {
    return record_words(model, kind, static_cast<std::int64_t>(i));
  };
}

std::string image_words(const Model& model, std::int32_t texture) {
  return texture < 0 ? "no texture" : record_words(model, SectionKind::textures, texture);
}

std::string back_words(const Model& model, std::int32_t material) {
  return material < 0 ? "that of the front" : record_words(model, SectionKind::materials, material);
}

// The parameters of a BRDF by name, as single precision has them.
template <class Brdf>
std::vector<std::pair<std::string, std::string>> parameter_words(const Brdf& brdf) {
  std::vector<std::pair<std::string, std::string>> words;
  materials::visit_parameters(
      brdf, [&](const materials::Parameter& parameter, std::span<const double> values) {
        std::vector<float> rounded(values.begin(), values.end());
        words.emplace_back(parameter.name, fmt::format("{}", fmt::join(rounded, " ")));
      });
  return words;
}

class Comparison {
 public:
  Comparison(const Model& a, const Model& b, std::size_t limit) : a_(a), b_(b), limit_(limit) {}

  Differences run();

 private:
  void add(std::vector<Difference>& list, std::string where, std::string what) {
    if (list.size() < limit_)
      list.push_back({std::move(where), std::move(what)});
    else
      ++out_.hidden;
  }
  void add(std::string where, std::string what) {
    add(out_.model, std::move(where), std::move(what));
  }

  // Calls same(i, j) for each pair of records with one key, and lists the others.
  template <class Where, class Same>
  void match(std::vector<Difference>& list, const Keys& a, const Keys& b, Where where, Same same);

  // Numbers and texts of two records, but for the skipped fields and references to other tables.
  void fields(SectionKind kind, const std::string& where, std::size_t i, std::size_t j,
              const std::vector<std::string_view>& skipped);
  void references(SectionKind kind, const std::string& where, std::size_t i, std::size_t j,
                  const std::vector<std::string_view>& skipped);
  void table(SectionKind kind);

  void nodes();
  void meshes();
  void mesh(const std::string& where, std::size_t i, std::size_t j);
  void vertices(const std::string& where, std::size_t i, std::size_t j);
  bool other_image(std::int32_t a, std::int32_t b) const;
  void instances();
  void materials();
  void textures();
  void budget();
  void inputs();
  void build();
  void sources();
  void unknown_sections();
  void storage();
  bool same_contents() const;

  Side a_, b_;
  std::size_t limit_;
  Differences out_;
};

template <class Where, class Same>
void Comparison::match(std::vector<Difference>& list, const Keys& a, const Keys& b, Where where,
                       Same same) {
  std::map<Hash128, std::size_t> in_b;
  for (std::size_t j = 0; j < b.size(); ++j) in_b.emplace(b[j], j);
  for (std::size_t i = 0; i < a.size(); ++i) {
    const auto found = in_b.find(a[i]);
    if (found == in_b.end()) {
      add(list, where(a_.model, i), "only in a");
      continue;
    }
    same(i, found->second);
    in_b.erase(found);
  }
  for (std::size_t j = 0; j < b.size(); ++j)
    if (in_b.contains(b[j])) add(list, where(b_.model, j), "only in b");
}

void Comparison::fields(SectionKind kind, const std::string& where, std::size_t i, std::size_t j,
                        const std::vector<std::string_view>& skipped) {
  const std::byte *a = record_at(a_.model, kind, i), *b = record_at(b_.model, kind, j);
  for (const FieldRule* field : fields_of(kind)) {
    if (field->kind == FieldRuleKind::zero || is_reference(*field) ||
        std::ranges::find(skipped, field->name) != skipped.end())
      continue;
    const auto words = [&](const Model& model, const std::byte* record) {
      return is_string(*field)
                 ? in_quotes(model.string(static_cast<std::uint32_t>(reference_of(*field, record))))
                 : value_words(*field, record);
    };
    const std::string in_a = words(a_.model, a), in_b = words(b_.model, b);
    if (in_a != in_b) add(where, fmt::format("{}: {} in a, {} in b", field->name, in_a, in_b));
  }
}

void Comparison::references(SectionKind kind, const std::string& where, std::size_t i,
                            std::size_t j, const std::vector<std::string_view>& skipped) {
  for (const FieldRule* field : fields_of(kind)) {
    if (!is_reference(*field) || std::ranges::find(skipped, field->name) != skipped.end()) continue;
    const SectionKind target = field->target;
    const std::int64_t a = reference_of(*field, record_at(a_.model, kind, i));
    const std::int64_t b = reference_of(*field, record_at(b_.model, kind, j));
    const auto key = [&](const Side& side, std::int64_t index) {
      return index < 0 ? Hash128{} : side.keys(target)[static_cast<std::size_t>(index)];
    };
    if (key(a_, a) == key(b_, b)) continue;
    std::string at = field->at;
    if (!at.empty()) at += ' ';
    const std::string again = field->kind == FieldRuleKind::reference ? at : "";
    add(where, fmt::format("{}{} in a, {}{} in b", at, record_words(a_.model, target, a), again,
                           record_words(b_.model, target, b)));
  }
}

void Comparison::table(SectionKind kind) {
  std::vector<std::string_view> keys;
  for (const FieldRule* field : fields_of(kind, table_info(kind).key)) keys.push_back(field->name);
  const auto words = words_of(kind);
  match(out_.model, a_.keys(kind), b_.keys(kind), words, [&](std::size_t i, std::size_t j) {
    const std::string where = words(a_.model, i);
    fields(kind, where, i, j, keys);
    references(kind, where, i, j, keys);
  });
}

void Comparison::nodes() {
  const auto words = words_of(SectionKind::nodes);
  match(out_.model, a_.keys(SectionKind::nodes), b_.keys(SectionKind::nodes), words,
        [&](std::size_t i, std::size_t j) {
          fields(SectionKind::nodes, words(a_.model, i), i, j, {"parent", "name"});
        });
}

Vec3 vec3(const layout::Float3& v) { return {v.x, v.y, v.z}; }
Vec3 vec3(const double* v) { return {v[0], v[1], v[2]}; }

// The largest distance of corresponding elements.
template <class Span, class Distance>
double largest(const Span& a, const Span& b, Distance distance) {
  double worst = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    const double d = distance(a[k], b[k]);
    worst = d > worst ? d : worst;
  }
  return worst;
}

void Comparison::vertices(const std::string& where, std::size_t i, std::size_t j) {
  const MeshView a = a_.model.mesh(i), b = b_.model.mesh(j);
  const Vec3 shift = vec3(a_.model.meshes()[i].origin) - vec3(b_.model.meshes()[j].origin);
  const double moved = largest(a.positions, b.positions, [&](const auto& p, const auto& q) {
    return glm::length(shift + (vec3(p) - vec3(q)));
  });
  if (moved > 0) add(where, fmt::format("vertices lie up to {:.6g} m apart", moved));
  const double turned = largest(a.normals, b.normals, [](const auto& p, const auto& q) {
    return angle_between(vec3(p), vec3(q));
  });
  if (turned > 0) add(where, fmt::format("normals differ by up to {:.6g} rad", turned));
  if (a.texcoords.size() == b.texcoords.size()) {
    const double slid = largest(a.texcoords, b.texcoords, [](const auto& p, const auto& q) {
      return glm::length(Vec2(p.x, p.y) - Vec2(q.x, q.y));
    });
    if (slid > 0) add(where, fmt::format("texcoords lie up to {:.6g} apart", slid));
  }
  if (a.colors.size() == b.colors.size()) {
    const double tinted = largest(a.colors, b.colors, [](const auto& p, const auto& q) {
      return glm::length(vec3(p) - vec3(q));
    });
    if (tinted > 0) add(where, fmt::format("colours differ by up to {:.6g}", tinted));
  }
}

void Comparison::mesh(const std::string& where, std::size_t i, std::size_t j) {
  const layout::Mesh& a = a_.model.meshes()[i];
  const layout::Mesh& b = b_.model.meshes()[j];
  fields(SectionKind::meshes, where, i, j,
         {"origin", "bounds_min", "bounds_max", "index_offset", "first_vertex", "index_size",
          "flags", "name", "first_texcoord", "first_color"});
  const auto flag = [&](std::uint32_t bit, const char* word) {
    if ((a.flags & bit) != (b.flags & bit))
      add(where, fmt::format("{} only in {}", word, a.flags & bit ? "a" : "b"));
  };
  flag(layout::kMeshClosed, "closed");
  flag(layout::kMeshTexcoords, "texcoords");
  flag(layout::kMeshColors, "colours");
  const auto needs_a = a_.model.mesh_tolerances(), needs_b = b_.model.mesh_tolerances();
  if (!needs_a.empty() && !needs_b.empty()) fields(SectionKind::mesh_tolerances, where, i, j, {});
  if (a.vertex_count == b.vertex_count) vertices(where, i, j);
  if (a.triangle_count == b.triangle_count) {
    const Indices in_a = a_.model.mesh(i).indices, in_b = b_.model.mesh(j).indices;
    std::size_t different = 0;
    for (std::size_t k = 0; k < in_a.size(); k += 3)
      different += in_a[k] != in_b[k] || in_a[k + 1] != in_b[k + 1] || in_a[k + 2] != in_b[k + 2];
    if (different > 0)
      add(where, fmt::format("{} of {} triangles differ in corners", different, a.triangle_count));
  }
}

void Comparison::meshes() {
  const auto words = words_of(SectionKind::meshes);
  match(out_.model, a_.keys(SectionKind::meshes), b_.keys(SectionKind::meshes), words,
        [&](std::size_t i, std::size_t j) { mesh(words(a_.model, i), i, j); });
}

bool Comparison::other_image(std::int32_t a, std::int32_t b) const {
  if (a < 0 || b < 0) return a != b;
  const auto &in_a = a_.keys(SectionKind::textures), &in_b = b_.keys(SectionKind::textures);
  return in_a[static_cast<std::size_t>(a)] != in_b[static_cast<std::size_t>(b)];
}

void Comparison::instances() {
  constexpr SectionKind kMaterials = SectionKind::materials;
  const auto words = words_of(SectionKind::instances);
  const auto other_material = [&](std::size_t a, std::size_t b) {
    return a_.keys(kMaterials)[a] != b_.keys(kMaterials)[b];
  };
  const auto same = [&](std::size_t i, std::size_t j) {
    const layout::Instance& a = a_.model.instances()[i];
    const layout::Instance& b = b_.model.instances()[j];
    if (other_material(a.material, b.material))
      add(words(a_.model, i),
          fmt::format("{} in a, {} in b", record_words(a_.model, kMaterials, a.material),
                      record_words(b_.model, kMaterials, b.material)));
    const std::int32_t back_a = a_.model.back_of(static_cast<std::uint32_t>(i));
    const std::int32_t back_b = b_.model.back_of(static_cast<std::uint32_t>(j));
    const bool both = back_a >= 0 && back_b >= 0;
    if (both ? other_material(static_cast<std::size_t>(back_a), static_cast<std::size_t>(back_b))
             : back_a != back_b)
      add(words(a_.model, i),
          fmt::format("on its back {} in a, {} in b", back_words(a_.model, back_a),
                      back_words(b_.model, back_b)));
    if (other_image(a.texture, b.texture))
      add(words(a_.model, i), fmt::format("{} in a, {} in b", image_words(a_.model, a.texture),
                                          image_words(b_.model, b.texture)));
  };
  match(out_.model, a_.keys(SectionKind::instances), b_.keys(SectionKind::instances), words, same);
}

void Comparison::materials() {
  const auto words = words_of(SectionKind::materials);
  const auto same = [&](std::size_t i, std::size_t j) {
    const std::string where = words(a_.model, i);
    const layout::Material& a = a_.model.materials()[i];
    const layout::Material& b = b_.model.materials()[j];
    std::vector<std::string_view> skipped{"flags", "name"};
    skipped.insert(skipped.end(), brdf_slots().begin(), brdf_slots().end());
    fields(SectionKind::materials, where, i, j, skipped);
    const auto brdfs = [&](const auto& in_a, const auto& in_b) {
      if (in_a.index() != in_b.index()) return;  // the models have been compared
      const auto words_a = parameter_words(in_a), words_b = parameter_words(in_b);
      for (std::size_t k = 0; k < words_a.size(); ++k)
        if (words_a[k] != words_b[k])
          add(where, fmt::format("{}: {} in a, {} in b", words_a[k].first, words_a[k].second,
                                 words_b[k].second));
    };
    const materials::Material material_a = material_from(a, {}), material_b = material_from(b, {});
    brdfs(material_a.diffuse_brdf, material_b.diffuse_brdf);
    brdfs(material_a.specular_brdf, material_b.specular_brdf);
    const auto map = [&](const char* name, std::int32_t in_a, std::int32_t in_b) {
      if (other_image(in_a, in_b))
        add(where, fmt::format("{}: {} in a, {} in b", name, image_words(a_.model, in_a),
                               image_words(b_.model, in_b)));
    };
    map("albedo_map", a.albedo_map, b.albedo_map);
    map("normal_map", a.normal_map, b.normal_map);
    map("roughness_map", a.roughness_map, b.roughness_map);
    map("reflectance_map", a.reflectance_map, b.reflectance_map);
    map("cutout_map", a.cutout_map, b.cutout_map);
  };
  match(out_.model, a_.keys(SectionKind::materials), b_.keys(SectionKind::materials), words, same);
}

void Comparison::textures() {
  const auto words = words_of(SectionKind::textures);
  const auto same = [&](std::size_t i, std::size_t j) {
    const std::string where = words(a_.model, i);
    const layout::Texture& a = a_.model.textures()[i];
    const layout::Texture& b = b_.model.textures()[j];
    fields(SectionKind::textures, where, i, j, {"offset", "bytes", "flags", "name"});
    if ((a.flags ^ b.flags) & layout::kTextureLinear)
      add(where, fmt::format("linear only in {}", a.flags & layout::kTextureLinear ? "a" : "b"));
    if (a.width != b.width || a.height != b.height) return;
    const auto in_a = a_.model.texels(i), in_b = b_.model.texels(j);
    std::size_t different = 0;
    int worst = 0;
    for (std::size_t k = 0; k < in_a.size(); k += 4) {
      different += std::memcmp(&in_a[k], &in_b[k], 4) != 0;
      for (std::size_t c = k; c < k + 4; ++c) worst = std::max(worst, std::abs(in_a[c] - in_b[c]));
    }
    if (different > 0)
      add(where, fmt::format("{} of {} texels differ, by up to {} of 255", different,
                             in_a.size() / 4, worst));
  };
  match(out_.model, a_.keys(SectionKind::textures), b_.keys(SectionKind::textures), words, same);
}

void Comparison::budget() {
  const auto only_in = [](bool in_a) { return in_a ? "only in a" : "only in b"; };
  const layout::Budget *a = a_.model.budget(), *b = b_.model.budget();
  if (a && b)
    fields(SectionKind::budget, "budget", 0, 0, {});
  else if (a || b)
    add("budget", only_in(a != nullptr));
  const bool in_a = !a_.model.mesh_tolerances().empty(), in_b = !b_.model.mesh_tolerances().empty();
  if (in_a != in_b) add("tolerances of the meshes", only_in(in_a));
}

void Comparison::build() {
  const auto text = [&](const char* where, std::string_view a, std::string_view b) {
    if (a != b)
      add(out_.provenance, where, fmt::format("{} in a, {} in b", in_quotes(a), in_quotes(b)));
  };
  text("version", a_.model.version(), b_.model.version());
  text("options", a_.model.options(), b_.model.options());
  if (a_.model.build_id() != b_.model.build_id())
    add(out_.provenance, "build identity",
        fmt::format("{} in a, {} in b", a_.model.build_id().hex(), b_.model.build_id().hex()));
}

void Comparison::inputs() {
  const auto keys = [](const Side& side) {
    Keys out;
    Numbering number;
    for (const layout::Input& input : side.model.inputs())
      out.push_back(number(side.strings[input.path]));
    return out;
  };
  const auto words = words_of(SectionKind::inputs);
  match(out_.provenance, keys(a_), keys(b_), words, [&](std::size_t i, std::size_t j) {
    const layout::Input& a = a_.model.inputs()[i];
    const layout::Input& b = b_.model.inputs()[j];
    if (a.hash[0] != b.hash[0] || a.hash[1] != b.hash[1] || a.bytes != b.bytes)
      add(out_.provenance, words(a_.model, i),
          fmt::format("contents differ: {} bytes in a, {} in b", a.bytes, b.bytes));
  });
}

void Comparison::sources() {
  const auto in_a = a_.model.sources(), in_b = b_.model.sources();
  if (in_a.empty() != in_b.empty()) {
    add(out_.provenance, "source locations", fmt::format("only in {}", in_a.empty() ? "b" : "a"));
    return;
  }
  if (in_a.size() != in_b.size()) return;  // the instances say it
  std::size_t different = 0;
  for (std::size_t k = 0; k < in_a.size(); ++k)
    different += in_a[k].line != in_b[k].line || in_a[k].column != in_b[k].column ||
                 a_.strings[in_a[k].file] != b_.strings[in_b[k].file];
  if (different > 0)
    add(out_.provenance, "source locations",
        fmt::format("{} of {} differ", different, in_a.size()));
}

void Comparison::unknown_sections() {
  const auto list = [](const Model& model, Keys& keys, std::vector<std::uint32_t>& kinds,
                       std::vector<std::uint64_t>& hashes) {
    Numbering number;
    for (const layout::DirectoryEntry& entry : model.directory()) {
      if (model.reads(entry)) continue;
      keys.push_back(number({entry.kind, entry.version}));
      kinds.push_back(entry.kind);
      hashes.push_back(entry.hash);
    }
  };
  Keys keys_a, keys_b;
  std::vector<std::uint32_t> kinds_a, kinds_b;
  std::vector<std::uint64_t> hashes_a, hashes_b;
  list(a_.model, keys_a, kinds_a, hashes_a);
  list(b_.model, keys_b, kinds_b, hashes_b);
  const auto where = [&](const Model& model, std::size_t i) {
    return fmt::format("section of kind {}", (&model == &a_.model ? kinds_a : kinds_b)[i]);
  };
  match(out_.model, keys_a, keys_b, where, [&](std::size_t i, std::size_t j) {
    if (hashes_a[i] != hashes_b[j]) add(where(a_.model, i), "contents differ");
  });
}

// "compressed, 12 of 64 bytes", "not compressed": how a model's file holds a section.
std::string storage_words(const layout::DirectoryEntry& entry) {
  std::string words =
      internal::is_derived(entry) ? std::string("made from mesh streams")
      : internal::has_codec(entry)
          ? fmt::format("compressed, {} of {} bytes", entry.packed_length, entry.raw_length)
          : std::string("not compressed");
  if (entry.stride != layout::kSections[layout::place_of(entry.kind)].stride)
    words += fmt::format(", records of {} bytes", entry.stride);
  return words;
}

void Comparison::storage() {
  const auto version = [](const Model& model) {
    return fmt::format("{}.{}", model.header().major, model.header().minor);
  };
  if (version(a_.model) != version(b_.model))
    add(out_.storage, "format",
        fmt::format("{} in a, {} in b", version(a_.model), version(b_.model)));
  for (const layout::SectionInfo& info : layout::kSections) {
    const layout::DirectoryEntry* a = a_.model.entry(info.kind);
    const layout::DirectoryEntry* b = b_.model.entry(info.kind);
    if (!a || !b) continue;  // the lists of what they hold say it
    const std::string in_a = storage_words(*a), in_b = storage_words(*b);
    if (in_a != in_b)
      add(out_.storage, fmt::format("section '{}'", info.name),
          fmt::format("{} in a, {} in b", in_a, in_b));
  }
}

bool Comparison::same_contents() const {
  return std::ranges::all_of(layout::kSections, [&](const layout::SectionInfo& info) {
    return std::ranges::equal(a_.model.section(info.kind), b_.model.section(info.kind));
  });
}

Differences Comparison::run() {
  nodes();
  meshes();
  instances();
  materials();
  textures();
  // decals lie over all that is before them
  for (const layout::SectionInfo& info : layout::kSections)
    if (table_info(info.kind).diff && info.kind != SectionKind::decals) table(info.kind);
  table(SectionKind::decals);
  budget();
  unknown_sections();
  build();
  inputs();
  sources();
  storage();
  const bool named = !out_.same_model() || !out_.provenance.empty();
  if (!named && (out_.storage.empty() || !same_contents()))
    add("file", "the contents are equal, but their order or storage differs");
  return std::move(out_);
}

}  // namespace

Differences diff(const Model& a, const Model& b, std::size_t limit) {
  assert(a.checked() && b.checked());
  if (std::ranges::equal(a.bytes(), b.bytes())) return {};
  return Comparison(a, b, limit).run();
}

}  // namespace panwright::pan
