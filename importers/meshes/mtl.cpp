#include "importers/meshes/mtl.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "base/text.h"
#include "importers/internal/xml_encoding.h"
#include "importers/meshes/text.h"

// note: tinyobjloader's reader of MTL is not used: it turns numbers that are none into 0, tells
// no place, does not say which numbers a file gives, and finds no names that hold blanks.

namespace panwright::importers::meshes {

namespace {

// Blinn-Phong's exponent as our materials have it.
constexpr double kMostShine = 128;
constexpr double kLargest = 1e6;  // exponent
constexpr std::string_view kOutside = "values outside of 0 to 1";
constexpr std::size_t kMostLost = 30;     // properties of a material that are told
constexpr std::size_t kMostHints = 50;    // unknown names that are looked for among the known,
constexpr std::size_t kMostNames = 1000;  // where these are no more

// How many words follow an option of a texture; those of o, s and t may be fewer.
constexpr std::pair<std::string_view, int> kImageOptions[] = {
    {"-blendu", 1},  {"-blendv", 1}, {"-boost", 1},  {"-mm", 2},         {"-o", 3},
    {"-s", 3},       {"-t", 3},      {"-texres", 1}, {"-clamp", 1},      {"-bm", 1},
    {"-imfchan", 1}, {"-type", 1},   {"-cc", 1},     {"-colorspace", 1},
};

// Maps that have no place in our materials.
constexpr std::pair<std::string_view, std::string_view> kLostMaps[] = {
    {"map_ka", "ambient map"},    {"map_ks", "specular map"},
    {"map_ns", "shininess map"},  {"map_ke", "emissive map"},
    {"map_d", "opacity map"},     {"map_tr", "opacity map"},
    {"map_bump", "bump map"},     {"bump", "bump map"},
    {"disp", "displacement map"}, {"decal", "decal map"},
    {"refl", "reflection map"},   {"map_refl", "reflection map"},
    {"map_pr", "roughness map"},  {"map_pm", "metallic map"},
    {"map_ps", "sheen map"},      {"ps", "sheen"},
    {"pc", "clearcoat"},          {"pcr", "clearcoat"},
    {"aniso", "anisotropy"},      {"anisor", "anisotropy"},
    {"map_rma", "packed map"},    {"map_orm", "packed map"},
};

// Words that say nothing of our surfaces: ambient light, filters, sharpness, antialiasing.
constexpr std::string_view kIgnoredStatements[] = {"ka", "tf", "sharpness", "map_aat", "kt", "km"};

// Whether a property names an image.
bool is_map(std::string_view key) {
  return key.starts_with("map_") || key == "bump" || key == "disp" || key == "decal" ||
         key == "refl";
}

// A number as exporters write one that they could not work out: nan, -inf, 1.#IND.
bool is_not_finite(std::string_view value) {
  std::string text = lower_case(value);
  if (text.starts_with('-') || text.starts_with('+')) text.erase(0, 1);
  return text.starts_with("nan") || text.starts_with("inf") || text.starts_with("1.#");
}

class MtlReader {
 public:
  MtlReader(ReaderContext& context, std::string path, SharedText bytes, FileId source,
            std::vector<MtlMaterial>& out)
      : s_(context), path_(std::move(path)), bytes_(std::move(bytes)), source_(source), out_(out) {}

  void read() {
    const std::size_t begin = out_.size();
    Lines lines(*bytes_);
    std::string_view line;
    while (lines.next(line)) read_line(line);
    settle_opacity(std::span(out_).subspan(begin));
  }

 private:
  SourceSpan at(std::string_view part) const {
    const auto begin = static_cast<std::uint32_t>(part.data() - bytes_->data());
    return {source_, begin, begin + static_cast<std::uint32_t>(part.size())};
  }

  void read_line(std::string_view line) {
    std::string_view rest = line;
    const std::string_view word = next_word(rest);
    if (word.empty()) return;
    if (word.starts_with('#')) {
      by_meshlab_ = by_meshlab_ || lower_case(line).find("meshlab") != std::string::npos;
      return;
    }
    const std::string key = lower_case(word);
    if (key == "newmtl") {
      out_.push_back({});
      out_.back().name = to_utf8(trimmed(rest), Encoding::utf8);
      out_.back().library = path_;
      out_.back().where = at(trimmed(rest).empty() ? word : trimmed(rest));
      return;
    }
    if (out_.empty() || out_.back().library != path_) {
      s_.trouble(Code("E6501"), "mtl begin", at(word), [&] {
        return fmt::format("{} is before the first 'newmtl' and is left out", in_quotes(word));
      });
      return;
    }
    read_property(key, word, rest);
  }

  void read_property(const std::string& key, std::string_view word, std::string_view rest) {
    MtlMaterial& m = out_.back();
    if (key == "kd") return read_color(word, rest, m.diffuse);
    if (key == "ks") return read_color(word, rest, m.specular);
    if (key == "ke") return read_color(word, rest, m.emissive);
    if (key == "ns") return read_within(0, kLargest, word, rest, m.shine);
    if (key == "ni") return read_number(word, rest, m.index);
    if (key == "pr") return read_within(0, 1, word, rest, m.roughness);
    if (key == "pm") return read_within(0, 1, word, rest, m.metallic);
    if (key == "d" || key == "tr") {
      std::string_view ahead = rest;
      if (next_word(ahead) == "-halo") rest = ahead;
      std::optional<double>& value = key == "d" ? m.opacity : m.transparency;
      read_within(0, 1, word, rest, value);
      if (key == "tr" && value) tr_at_ = at(word);
      return;
    }
    if (key == "illum") {
      std::optional<double> value;
      read_number(word, rest, value);
      if (value) m.model = static_cast<int>(std::clamp(*value, 0.0, 100.0));
      return;
    }
    if (key == "map_kd") return read_texture(rest, m.albedo);
    if (key == "norm" || key == "map_kn") return read_texture(rest, m.normal);
    if (is_map(key)) {
      MtlTexture unused;  // it is named, and so no output takes its place
      read_texture(rest, unused);
    }
    for (const auto& [name, what] : kLostMaps)
      if (key == name) return lose(std::string(what), word);
    if (std::find(std::begin(kIgnoredStatements), std::end(kIgnoredStatements), key) ==
        std::end(kIgnoredStatements))
      lose(in_quotes(word), word);
  }

  // Where a file gives both, d holds. Tr is 1 − d; MeshLab means d by it, and so does a file that
  // would otherwise have no visible material.
  void settle_opacity(std::span<MtlMaterial> materials) {
    const auto is_invisible = [](const MtlMaterial& m) {
      return m.opacity ? *m.opacity <= 0 : m.transparency && *m.transparency >= 1;
    };
    const auto has_both = [](const MtlMaterial& m) { return m.opacity && m.transparency; };
    const bool swapped = std::ranges::none_of(materials, has_both) &&
                         (by_meshlab_ || std::ranges::all_of(materials, is_invisible)) &&
                         std::ranges::any_of(materials, [](const MtlMaterial& m) {
                           return !m.opacity && m.transparency.value_or(0) > 0;
                         });
    if (swapped)
      s_.trouble(Code("W6502"), "mtl tr", tr_at_,
                 [] { return "'Tr' is read as opacity, as MeshLab writes it"; });
    for (MtlMaterial& m : materials)
      if (!m.opacity && m.transparency) m.opacity = swapped ? *m.transparency : 1 - *m.transparency;
  }

  void lose(std::string what, std::string_view part) {
    std::vector<LostProperty>& lost = out_.back().lost;
    if (lost.size() < kMostLost && std::ranges::find(lost, what, &LostProperty::what) == lost.end())
      lost.push_back({std::move(what), at(part)});
  }

  void bad_number(std::string_view word, std::string_view value) {
    s_.trouble(Code("E6501"), "mtl number", at(value.empty() ? word : value), [&] {
      return fmt::format("{} is followed by {}, expected a number", in_quotes(word),
                         in_quotes(value));
    });
  }

  void read_number(std::string_view word, std::string_view rest, std::optional<double>& out) {
    const std::string_view value = next_word(rest);
    if (is_not_finite(value)) return lose(std::string(kOutside), value);
    const auto number = parse_double(value);
    if (!number) return bad_number(word, value);
    out = number;
  }

  // A number within bounds: others are clamped, and reported.
  void read_within(double low, double high, std::string_view word, std::string_view rest,
                   std::optional<double>& out) {
    read_number(word, rest, out);
    if (out && std::clamp(*out, low, high) != *out) lose(std::string(kOutside), word);
    if (out) out = std::clamp(*out, low, high);
  }

  // One number stands for three.
  void read_color(std::string_view word, std::string_view rest, std::optional<Vec3>& out) {
    Vec3 color(0);
    std::string_view value = next_word(rest);
    if (value == "spectral" || value == "xyz") return lose(fmt::format("{} {}", word, value), word);
    for (int k = 0; k < 3; ++k) {
      if (k > 0) value = next_word(rest);
      if (k == 1 && value.empty()) {
        color = Vec3(color.x);
        break;
      }
      if (is_not_finite(value)) return lose(std::string(kOutside), value);
      const auto number = parse_double(value);
      if (!number) return bad_number(word, value);
      color[k] = *number;
    }
    out = glm::clamp(color, Vec3(0), Vec3(1));
    if (*out != color) lose(std::string(kOutside), word);
  }

  void read_texture(std::string_view rest, MtlTexture& out) {
    std::string_view ahead = rest;
    for (std::string_view word = next_word(ahead); word.starts_with('-'); word = next_word(ahead)) {
      const auto* option = std::find_if(std::begin(kImageOptions), std::end(kImageOptions),
                                        [&](const auto& known) { return known.first == word; });
      if (option == std::end(kImageOptions)) break;
      rest = ahead;
      read_option(*option, word, rest, out);
      ahead = rest;
    }
    const std::string_view name = trimmed(rest);
    if (name.empty()) return;
    out.name = name;
    out.where = at(name);
    declare(s_.files, path_, name, false);
  }

  // option_word: in the file
  void read_option(const std::pair<std::string_view, int>& option, std::string_view option_word,
                   std::string_view& rest, MtlTexture& out) {
    Vec3 numbers(option.first == "-s" ? 1.0 : 0.0);
    for (int k = 0; k < option.second; ++k) {
      std::string_view ahead = rest;
      const auto number = parse_double(next_word(ahead));
      if (option.second == 3 && !number) break;
      if (number) numbers[k] = *number;
      rest = ahead;
    }
    if (option.first == "-s")
      out.repeat = Vec2(numbers);
    else if ((option.first == "-o" || option.first == "-t") && numbers != Vec3(0))
      lose("offset of a texture", option_word);
  }

  ReaderContext& s_;
  std::string path_;
  SharedText bytes_;
  FileId source_;
  std::vector<MtlMaterial>& out_;
  bool by_meshlab_ = false;
  SourceSpan tr_at_;
};

// The BRDFs of VRML's materials: Lambert, and Blinn and Phong's lobe where there is a specular
// colour and the illumination model wants one.
void set_brdfs(const MtlMaterial& from, materials::Material& m, CadMaterial& cad) {
  const bool highlights = from.model.value_or(2) >= 2;
  const Vec3 specular = highlights ? from.specular.value_or(Vec3(0)) : Vec3(0);
  if (specular != Vec3(0)) {
    const double shine = from.shine.value_or(0);
    m.specular = specular;
    m.specular_brdf = materials::BlinnPhong{std::min(shine, kMostShine)};
    m.weights.y = 1;
    if (shine > kMostShine) cad.lost.push_back({"shininess over 128", from.where});
    // α² = 2/(n + 2), and α is the square of the perceptual roughness
    cad.roughness = std::sqrt(std::sqrt(2 / (shine + 2)));
  }
  m.emissive = from.emissive.value_or(Vec3(0));
  if (m.emissive != Vec3(0)) m.weights.z = 1;
}

}  // namespace

void MtlLibraries::read(std::string_view names, SourceSpan where) {
  names = trimmed(names);
  if (names.empty() || !lines_.emplace(names).second) return;
  std::string_view rest = names;
  if (next_word(rest).size() == names.size()) return read_library(names, where);
  NamedFile whole = find_file(s_.files, library_name(names));
  if (whole.outcome == Files::Outcome::found) {
    s_.accept(whole, where);
    return add_library(whole, where);
  }
  rest = names;
  for (std::string_view name = next_word(rest); !name.empty(); name = next_word(rest))
    read_library(name, where);
}

FileName MtlLibraries::library_name(std::string_view name) const {
  return {.text = name, .including = {s_.file.path}};
}

void MtlLibraries::read_library(std::string_view name, SourceSpan where) {
  if (!asked_.emplace(name).second) return;
  const auto found = s_.read_named(library_name(name), where);
  if (found)
    add_library(*found, where);
  else
    any_missing_ = true;
}

void MtlLibraries::add_library(const NamedFile& found, SourceSpan where) {
  if (libraries_.insert(found.path).second) read_text(found.path, found.bytes, where);
}

void MtlLibraries::read_text(const std::string& path, const SharedText& bytes, SourceSpan where) {
  const SharedText text = internal::xml_in_utf8(bytes).bytes;
  const FileId source =
      s_.log.sources().add({s_.files.display_name(path), text, Encoding::utf8, where});
  const std::size_t begin = materials_.size();
  MtlReader(s_, path, text, source, materials_).read();
  for (std::size_t i = begin; i < materials_.size(); ++i)
    by_name_.try_emplace(materials_[i].name, static_cast<std::int32_t>(i));
}

std::int32_t MtlLibraries::number_of(std::string_view name, SourceSpan where) {
  const auto known = numbers_.find(name);
  if (known != numbers_.end()) return known->second;
  const auto number = static_cast<std::int32_t>(uses_.size());
  uses_.push_back({std::string(name), where});
  numbers_.emplace(name, number);
  return number;
}

void MtlLibraries::resolve_names() {
  std::vector<std::string_view> names;
  if (materials_.size() <= kMostNames)
    for (const auto& [name, index] : by_name_) names.push_back(name);
  std::size_t unknown = 0;
  for (Use& use : uses_) {
    const auto known = by_name_.find(to_utf8(use.name, Encoding::utf8));
    use.material =
        known != by_name_.end() ? known->second : static_cast<std::int32_t>(materials_.size());
    if (known != by_name_.end()) continue;
    materials_.push_back({});
    materials_.back().name = to_utf8(use.name, Encoding::utf8);
    if (any_missing_) continue;
    const auto near =
        ++unknown <= kMostHints ? nearest_name(use.name, names) : std::optional<std::string_view>();
    s_.log.report(Code("W6502"), use.where,
                  fmt::format("no material library has {}", in_quotes(use.name)),
                  near ? fmt::format("did you mean {}?", in_quotes(*near)) : std::string());
  }
}

std::int32_t MtlLibraries::scene_material(std::int32_t number, bool colored, bool texcoords) {
  if (number < 0) return assembly_.plain_material(colored);
  const std::int32_t index = uses_[static_cast<std::size_t>(number)].material;
  const MtlMaterial& from = materials_[static_cast<std::size_t>(index)];
  const bool textures = texcoords && (!from.albedo.name.empty() || !from.normal.name.empty());
  const auto [place, is_new] = made_.try_emplace({index, textures}, scene::kNone);
  if (!is_new) return place->second;
  const auto texture_name = [&](const MtlTexture& texture) {
    return FileName{.text = texture.name, .including = {from.library, s_.file.path}};
  };
  materials::Material m;
  CadMaterial cad;
  m.name = cad.name = from.name;
  cad.lost = from.lost;
  cad.where = from.where;
  cad.textured = !from.albedo.name.empty();
  const Vec3 usual = cad.textured ? Vec3(1) : m.diffuse;
  m.diffuse = from.diffuse.value_or(usual);
  if (cad.textured && m.diffuse == Vec3(0)) {
    // some programs write no colour beside a texture, and mean the texture's
    s_.trouble(Code("W6502"), "black", from.albedo.where,
               [] { return "a texture over a black 'Kd'; its own colours are taken"; });
    m.diffuse = Vec3(1);
  }
  set_brdfs(from, m, cad);
  if (textures && !from.albedo.name.empty()) {
    m.maps.albedo = assembly_.texture(texture_name(from.albedo), false, from.albedo.where);
    m.maps.repeat = from.albedo.repeat;
  }
  if (textures && !from.normal.name.empty())
    m.maps.normal = assembly_.texture(texture_name(from.normal), true, from.normal.where);
  cad.base_color = m.diffuse;
  cad.metallic = from.metallic.value_or(0);
  if (from.roughness) cad.roughness = *from.roughness;
  cad.opacity = from.opacity.value_or(1);
  cad.see_through =
      std::ranges::find(from.lost, "opacity map", &LostProperty::what) != from.lost.end();
  return place->second = assembly_.add_material(std::move(m), std::move(cad));
}

}  // namespace panwright::importers::meshes
