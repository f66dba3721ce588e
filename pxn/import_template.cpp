#include "pxn/import_template.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "base/text.h"
#include "pxn/build/pattern.h"
#include "pxn/text/reference.h"

namespace panwright::pxn {

namespace {

struct Clue {
  std::string_view word;  // in lower case
  std::string_view preset;
};

// The first that a name holds decides; what is more special stands first.
constexpr Clue kClues[] = {
    {"beta", "mli_beta_cloth"},
    {"retro", "retroreflector"},
    {"osr", "osr_silica"},
    {"radiator", "osr_silica"},
    {"gaas", "cells_gaas"},
    {"solar", "cells_silicon"},
    {"cells", "cells_silicon"},
    {"photovolt", "cells_silicon"},
    {"black kapton", "mli_black"},
    {"black_kapton", "mli_black"},
    {"black mli", "mli_black"},
    {"black_mli", "mli_black"},
    {"silver mli", "mli_silver"},
    {"silver_mli", "mli_silver"},
    {"kapton", "mli_gold_kapton"},
    {"kaptan", "mli_gold_kapton"},
    {"black anodi", "aluminium_black_anodised"},
    {"black_anodi", "aluminium_black_anodised"},
    {"anodized black", "aluminium_black_anodised"},
    {"anodi", "aluminium_anodised"},
    {"brushed", "aluminium_brushed"},
    {"polish", "aluminium_polished"},
    {"chrome", "aluminium_polished"},
    {"mirror", "osr_silica"},
    {"gold plat", "gold_plating"},
    {"teflon", "teflon_silvered"},
    {"copper", "copper"},
    {"titan", "titanium"},
    {"cfrp", "cfrp"},
    {"carbon", "cfrp"},
    {"composite", "cfrp"},
    {"regolith", "regolith_lunar"},
    {"glass", "cover_glass"},
    {"lens", "cover_glass"},
    {"alumin", "aluminium_bare"},
    {"steel", "aluminium_bare"},
    {"metal", "aluminium_bare"},
};

// Shows the colour that it is given: a coat over it would swallow a third of a middle grey, and
// reflect more than it gets over white.
constexpr std::string_view kPlainPaint = "white_silicate";

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return out;
}

// Rough words for a linear colour.
struct Look {
  double bright;  // luminance, Rec. 709
  double vivid;   // 0 grey to 1
  bool yellow;    // from orange to yellow
  bool blue;
};

Look look_of(const Vec3& c) {
  const double most = std::fmax(c.x, std::fmax(c.y, c.z));
  const double least = std::fmin(c.x, std::fmin(c.y, c.z));
  return {0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z, most > 0 ? (most - least) / most : 0,
          c.x >= c.y && c.y > 1.3 * c.z, c.z >= c.y && c.z > 1.3 * c.x};
}

std::string_view foil(const std::string& name, const Look& look) {
  if (name.find("silver") != std::string::npos) return "mli_silver";
  if (name.find("black") != std::string::npos) return "mli_black";
  if (name.find("gold") != std::string::npos) return "mli_gold_kapton";
  if (look.bright < 0.04) return "mli_black";
  return look.yellow && look.vivid > 0.25 ? "mli_gold_kapton" : "mli_silver";
}

// In a comment: no two hyphens in a row.
std::string in_comment(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20) c = '?';
  for (std::size_t i = 1; i < text.size(); ++i)
    if (text[i] == '-' && text[i - 1] == '-') text[i] = '~';
  if (!text.empty() && text.back() == '-') text.back() = '~';
  return text;
}

// A name of our own, of letters, digits and underscores.
std::string own_name(std::string_view name, std::set<std::string>& taken) {
  std::string base;
  for (const char c : lower(name)) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
    if (plain)
      base += c;
    else if (!base.empty() && base.back() != '_')
      base += '_';
  }
  while (!base.empty() && base.back() == '_') base.pop_back();
  if (base.empty() || (base[0] >= '0' && base[0] <= '9')) base = "material_" + base;
  std::string out = base;
  for (int k = 2; !taken.insert(out).second; ++k) out = fmt::format("{}_{}", base, k);
  return out;
}

std::string_view kind_of(scene::JointKind kind) {
  switch (kind) {
    case scene::JointKind::fixed:
      return "fixed";
    case scene::JointKind::revolute:
      return "revolute";
    case scene::JointKind::continuous:
      return "continuous";
    case scene::JointKind::prismatic:
      return "prismatic";
    case scene::JointKind::ball:
      return "ball";
    case scene::JointKind::scale:
      return "scale";
  }
  return "";
}

std::string joint_lines(const importers::Imported& imported) {
  std::string out;
  for (const scene::Joint& joint : imported.scene.joints) {
    const std::string& node = imported.scene.nodes[static_cast<std::size_t>(joint.node)].name;
    out += "\n      ";
    out += in_comment(fmt::format("{} of node '{}', {} about {:.6g} {:.6g} {:.6g}",
                                  joint.name.empty() ? "(no name)" : pattern_of(joint.name),
                                  pattern_of(node), kind_of(joint.kind), joint.axis.x, joint.axis.y,
                                  joint.axis.z));
    if (joint.lower.size() == 1)
      out += fmt::format(", from {:.6g} to {:.6g}", joint.lower[0], joint.upper[0]);
  }
  return out;
}

}  // namespace

Guess guessed_preset(const importers::CadMaterial& material) {
  const std::string name = lower(material.name);
  const Look look = look_of(material.base_color);
  for (const std::string_view word : {"mli", "foil", "blanket", "gold"})
    if (name.find(word) != std::string::npos)
      return {word == "gold" ? "mli_gold_kapton" : foil(name, look),
              fmt::format("'{}' in its name", word)};
  for (const Clue& clue : kClues)
    if (name.find(clue.word) != std::string::npos)
      return {clue.preset, fmt::format("'{}' in its name", clue.word)};
  if (name.find("black") != std::string::npos) return {"black_polyurethane", "'black' in its name"};
  if (name.find("white") != std::string::npos) return {"white_silicone", "'white' in its name"};
  if (material.textured) return {kPlainPaint, "no better guess: a paint with its texture", true};
  if (material.metallic > 0.5) {
    if (look.yellow && look.vivid > 0.3) return {"gold_plating", "a metal of its colour"};
    return {"aluminium_bare", "a metal"};
  }
  if (look.bright < 0.03 && look.vivid < 0.5) return {"black_polyurethane", "its colour"};
  if (look.vivid < 0.2 && look.bright > 0.5) return {"white_silicone", "its colour"};
  if (look.blue && look.bright < 0.15) return {"cells_silicon", "its colour"};
  if (look.yellow && look.vivid > 0.5 && look.bright > 0.15)
    return {"mli_gold_kapton", "its colour"};
  return {kPlainPaint, "no better guess: a paint of its colour", true};
}

std::vector<std::string> numbered_names(std::span<const importers::CadMaterial> materials) {
  std::set<std::string, std::less<>> taken;
  for (const importers::CadMaterial& material : materials) taken.insert(material.name);
  std::map<std::string_view, std::size_t> count;
  std::vector<std::string> out;
  out.reserve(materials.size());
  for (const importers::CadMaterial& material : materials) {
    std::size_t& number = count[material.name];
    std::string name = material.name;
    if (++number > 1 || name.empty()) {
      name = fmt::format("{}#{}", material.name, number);
      while (!taken.insert(name).second) name = fmt::format("{}#{}", material.name, ++number);
    }
    out.push_back(std::move(name));
  }
  return out;
}

std::string import_template(const importers::Imported& imported, std::string_view file,
                            std::string_view attributes) {
  const scene::Scene& scene = imported.scene;
  std::vector<char> worn(scene.materials.size());
  for (const scene::Instance& instance : scene.instances)
    worn[static_cast<std::size_t>(instance.material)] = 1;
  // the names that patterns of the text are held against
  std::vector<importers::CadMaterial> named = imported.materials;
  for (importers::CadMaterial& cad : named) cad.name = to_utf8(cad.name, Encoding::utf8);
  const std::vector<std::string> names = numbered_names(named);
  std::string materials, assigns;
  std::set<std::string> taken;
  for (std::size_t i = 0; i < named.size(); ++i) {
    if (!worn[i]) continue;
    const importers::CadMaterial& cad = named[i];
    const Guess guess = guessed_preset(cad);
    const std::string name = own_name(names[i], taken);
    materials += fmt::format("  <!-- {}: {} -->\n  <material name=\"{}\" preset=\"{}\"",
                             in_comment(pattern_of(names[i])), guess.reason, name, guess.preset);
    materials +=
        guess.keeps_color
            ? fmt::format(">\n    <diffuse> {:.4g} {:.4g} {:.4g} </diffuse>\n  </material>\n",
                          cad.base_color.x, cad.base_color.y, cad.base_color.z)
            : "/>\n";
    assigns += fmt::format("    <assign materials=\"{}\" material=\"{}\"{}/>\n",
                           xml::escaped(pattern_of(names[i])), name,
                           cad.textured && guess.keeps_color ? " pictures=\"keep\"" : "");
  }
  std::string out = "<pangu_model ver=\"1\">\n";
  if (!materials.empty())
    out += "  <!-- guesses: hold each against what the surface is made of -->\n";
  out += materials;
  if (!scene.joints.empty())
    out += "  <!-- joints of the file:" + joint_lines(imported) + "\n  -->\n";
  out += fmt::format("  <import file=\"{}\"{}", xml::escaped(file), attributes);
  out += assigns.empty() ? "/>\n" : ">\n" + assigns + "  </import>\n";
  return out + "</pangu_model>\n";
}

}  // namespace panwright::pxn
