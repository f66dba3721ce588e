#include "pxn/material_guess.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <span>
#include <utility>

#include "image/srgb.h"

namespace panwright::pxn {

namespace {

using Words = std::vector<std::string>;

// Rough words for a linear colour.
struct Look {
  double bright;  // luminance, Rec. 709
  double vivid;   // 0 grey to 1
  bool warm;      // from orange to yellow
  bool cold;      // blue
};

Look look_of(const Vec3& c) {
  const double most = std::fmax(c.x, std::fmax(c.y, c.z));
  const double least = std::fmin(c.x, std::fmin(c.y, c.z));
  return {0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z, most > 0 ? (most - least) / most : 0,
          c.x >= c.y && c.y >= c.z, c.z >= c.y && c.y >= 0.5 * c.x};
}

bool is_any(const Look&) { return true; }
bool is_golden(const Look& l) { return l.warm && l.vivid > 0.3 && l.bright > 0.02; }
bool is_reddish(const Look& l) { return l.warm && l.vivid > 0.2; }
bool is_grey(const Look& l) { return l.vivid < 0.35 && l.bright > 0.05; }
bool is_bright(const Look& l) { return l.vivid < 0.35 && l.bright > 0.15; }
bool is_dark(const Look& l) { return l.bright < 0.3 && (l.vivid < 0.35 || l.bright < 0.03); }
bool is_dark_grey(const Look& l) { return l.bright < 0.25 && l.vivid < 0.6; }
bool is_white(const Look& l) { return l.vivid < 0.2 && l.bright > 0.5; }
bool is_black(const Look& l) { return l.bright < 0.1; }
// blue, violet, grey or black
bool is_cell(const Look& l) {
  return l.bright < 0.5 && (l.cold || l.vivid < 0.35 || l.bright < 0.03);
}

bool is_blue(const Look& l) { return l.bright < 0.5 && l.cold && l.vivid > 0.4; }

// One way in which a name says a material.
struct Rule {
  std::string_view preset;
  std::string_view all;   // words that the name must have, apart by blanks, each "a|b|c"
  std::string_view none;  // words that it must not have, "a|b|c"
  bool (*agrees)(const Look&);
  std::string_view colors;  // that the rule takes
};

constexpr std::string_view kNotFoil = "no|non|not|without|nofoil|under|below";
// Parts of a solar array that are no cells, and colours that cells do not have.
constexpr std::string_view kNotCells =
    "back|backs|backside|rear|bracket|brackets|edge|edges|trim|frame|frames|hinge|hinges|base|core|"
    "support|supports|strut|struts|keel|shield|boom|arm|yoke|wall|walls|mount|bolt|bolts|gold|"
    "silver|sil|bronze|red|white|black|yellow|orange|substrate|drive|structure|rib|ribs|holder|"
    "joint|"
    "no|non|not|without|sensor|under";

constexpr std::string_view kNotCoveredCells =
    "back|backs|bracket|edge|edges|trim|frame|base|core|support|fuel|battery|load|substrate|no|not";

// The first that fits decides; what is more special stands first.
constexpr Rule kRules[] = {
    {"mli_beta_cloth", "beta cloth", "", is_bright, "bright"},
    {"teflon_silvered", "teflon silvered|silver", "", is_bright, "bright"},
    {"teflon_aluminised", "teflon aluminised|aluminized", "", is_bright, "bright"},
    {"retroreflector", "retroreflector|retroreflectors|retro", "bracket|mount|frame|base|rocket",
     is_any, "any"},
    {"osr_silica", "osr|osrs", "bracket|frame|edge|back", is_bright, "bright and grey"},
    {"mli_gold_kapton", "foil|foils|mli|kapton|kaptan|blanket|blankets gold|golden|orange|amber",
     kNotFoil, is_golden, "gold"},
    {"mli_silver", "foil|foils|mli|kapton|blanket|blankets silver|silvered|silvery", kNotFoil,
     is_bright, "bright and grey"},
    {"mli_black", "foil|foils|mli|kapton|blanket|blankets|krinkle|crinkle black", kNotFoil, is_dark,
     "dark"},
    {"mli_gold_kapton", "kapton|kaptan|mli|blanket|blankets", "no|non|not|without|under|below",
     is_golden, "gold"},
    {"cells_gaas", "gaas cell|cells|solar|panel|array", kNotCells, is_cell, "blue, grey or black"},
    {"cells_silicon", "solar cell|cells|panel|panels|array|arrays|face|faces", kNotCells, is_cell,
     "blue, grey or black"},
    {"cells_silicon",
     "solarpanel|solarpanels|solararray|solararrays|solarcell|solarcells|"
     "photovoltaic|photovoltaics",
     kNotCells, is_cell, "blue, grey or black"},
    {"cells_silicon", "cells", kNotCoveredCells, is_blue, "blue"},
    {"aluminium_black_anodised", "anodised|anodized|anodise|anodize|anodisation black", "",
     is_black, "black"},
    {"aluminium_anodised", "anodised|anodized alumin|aluminium|aluminum", "", is_grey, "grey"},
    {"aluminium_brushed", "brushed metal|aluminium|aluminum|grey|gray", "", is_grey, "grey"},
    {"aluminium_polished", "polished aluminium|aluminum", "", is_grey, "grey"},
    {"gold_plating", "gold plated|plating|plate", "", is_golden, "gold"},
    {"copper", "copper", "wire|wires|cable|cables|not|no", is_reddish, "red to yellow"},
    {"titanium", "titanium", "white|black|oxide|dioxide", is_grey, "grey"},
    {"cfrp", "cfrp", "", is_dark_grey, "dark and grey"},
    {"cfrp", "carbon fiber|fibre|fibers|fibres|composite", "", is_dark_grey, "dark and grey"},
    {"aluminium_bare", "aluminium|aluminum|alu|alodine",
     "oxide|foil|paint|painted|black|white|gold", is_grey, "grey"},
    {"white_silicone", "white paint|painted", "", is_white, "white"},
    {"black_polyurethane", "black paint|painted", "", is_black, "black"},
    {"regolith_lunar", "lunar regolith", "", is_any, "any"},
};

// Whether `word` is one of "a|b|c".
bool is_one_of(std::string_view word, std::string_view words) {
  while (!words.empty()) {
    const std::size_t bar = words.find('|');
    if (words.substr(0, bar) == word) return true;
    if (bar == words.npos) break;
    words.remove_prefix(bar + 1);
  }
  return false;
}

const std::string* find_one_of(const Words& words, std::string_view wanted) {
  const auto found = std::find_if(words.begin(), words.end(),
                                  [&](const std::string& w) { return is_one_of(w, wanted); });
  return found == words.end() ? nullptr : &*found;
}

// The words of the name that the rule stands on; empty: it does not fit.
std::vector<std::string_view> fitting(const Rule& rule, const Words& words) {
  std::vector<std::string_view> out;
  for (std::string_view all = rule.all; !all.empty();) {
    const std::size_t blank = all.find(' ');
    const std::string* found = find_one_of(words, all.substr(0, blank));
    if (found == nullptr) return {};
    out.emplace_back(*found);
    all.remove_prefix(blank == all.npos ? all.size() : blank + 1);
  }
  return out;
}

std::string quoted(std::span<const std::string_view> words) {
  std::string out;
  for (const std::string_view word : words)
    out += fmt::format("{}'{}'", out.empty() ? "" : " and ", word);
  return out;
}

bool is_lower(char c) { return c >= 'a' && c <= 'z'; }
bool is_upper(char c) { return c >= 'A' && c <= 'Z'; }

// Mean over the opaque parts of a texture, linear.
std::pair<Vec3, bool> mean_of(const scene::Texture& texture) {
  Vec3 sum(0);
  double weight = 0;
  for (std::size_t i = 0; i + 3 < texture.rgba.size(); i += 4) {
    const double a = texture.rgba[i + 3] / 255.0;
    const auto decoded = [&](std::size_t k) {
      return texture.linear ? texture.rgba[i + k] / 255.0
                            : image::srgb_decoded(texture.rgba[i + k]);
    };
    sum += a * Vec3(decoded(0), decoded(1), decoded(2));
    weight += a;
  }
  return {weight > 0 ? sum / weight : Vec3(1), weight > 0};
}

}  // namespace

std::vector<std::string> words_of(std::string_view name) {
  Words out;
  std::string word;
  const auto end_word = [&] {
    if (!word.empty()) out.push_back(std::move(word));
    word.clear();
  };
  for (std::size_t i = 0; i < name.size(); ++i) {
    const char c = name[i];
    if (!is_lower(c) && !is_upper(c)) {
      end_word();
      continue;
    }
    const bool before_lower = i + 1 < name.size() && is_lower(name[i + 1]);
    if (is_upper(c) && i > 0 && (is_lower(name[i - 1]) || (is_upper(name[i - 1]) && before_lower)))
      end_word();
    word += is_upper(c) ? static_cast<char>(c - 'A' + 'a') : c;
  }
  end_word();
  return out;
}

Guess guessed_preset(const GuessInput& input) {
  const Words words = words_of(input.name);
  const Look look = look_of(input.color);
  std::string against;  // why the first rule that fits the name is not followed
  for (const Rule& rule : kRules) {
    const std::vector<std::string_view> fits = fitting(rule, words);
    if (fits.empty()) continue;
    if (const std::string* veto = find_one_of(words, rule.none)) {
      if (against.empty()) against = fmt::format("{}, but also '{}'", quoted(fits), *veto);
      continue;
    }
    if (input.color_known && !rule.agrees(look)) {
      if (against.empty())
        against =
            fmt::format("{} in its name, but its colour is not {}", quoted(fits), rule.colors);
      continue;
    }
    return {rule.preset, fmt::format("{} in its name{}", quoted(fits),
                                     input.color_known ? ", and its colour agrees"
                                                       : "; its texture could not be read")};
  }
  // the metal itself: nothing but the word and numbers
  if (words.size() == 1 && words[0] == "gold" && (is_golden(look) || !input.color_known))
    return {"gold_plating", "its whole name, and its colour agrees"};
  if (!against.empty()) return {{}, against};
  return {{}, words.empty() ? "no word in its name" : "no word of its name is a known material"};
}

GuessInput guess_input(const importers::Imported& imported, std::size_t index) {
  const importers::CadMaterial& cad = imported.materials[index];
  GuessInput out{cad.name, cad.base_color, cad.metallic, true};
  if (!cad.textured) return out;
  const materials::Maps& maps = imported.scene.materials[index].maps;
  const auto& textures = imported.scene.textures;
  if (maps.reflectance >=
      0) {  // computed ones, which hold the base colour: Lambert's part and the metal's
    const auto [metal, any] = mean_of(textures[static_cast<std::size_t>(maps.reflectance)]);
    out.color = metal;
    if (maps.albedo >= 0)
      out.color += mean_of(textures[static_cast<std::size_t>(maps.albedo)]).first;
    out.color = glm::min(out.color, Vec3(1));
    out.color_known = any;
    return out;
  }
  std::int32_t texture = maps.albedo;
  for (const scene::Instance& instance : imported.scene.instances)
    if (texture < 0 && instance.material == static_cast<std::int32_t>(index))
      texture = instance.texture;
  out.color_known = false;
  if (texture < 0) return out;
  const auto [mean, known] = mean_of(textures[static_cast<std::size_t>(texture)]);
  out.color_known = known;
  out.color = cad.base_color * mean;
  return out;
}

}  // namespace panwright::pxn
