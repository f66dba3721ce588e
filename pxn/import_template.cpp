#include "pxn/import_template.h"

#include <fmt/core.h>

#include <map>
#include <set>

#include "base/text.h"
#include "pxn/material_guess.h"
#include "pxn/reader/pattern.h"
#include "pxn/reader/presets.h"
#include "pxn/text/reference.h"

namespace panwright::pxn {

namespace {

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return out;
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

std::string joint_lines(const importers::Imported& imported) {
  std::string out;
  for (const scene::Joint& joint : imported.scene.joints) {
    const std::string& node = imported.scene.nodes[static_cast<std::size_t>(joint.node)].name;
    out += "\n      ";
    out += in_comment(fmt::format("{} of node '{}', {} about {:.6g} {:.6g} {:.6g}",
                                  joint.name.empty() ? "(no name)" : pattern_of(joint.name),
                                  pattern_of(node), geometry::kind_name(joint.kind), joint.axis.x,
                                  joint.axis.y, joint.axis.z));
    if (joint.lower.size() == 1)
      out += fmt::format(", from {:.6g} to {:.6g}", joint.lower[0], joint.upper[0]);
  }
  return out;
}

}  // namespace

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
    const GuessInput input = guess_input(imported, i);
    const Guess guess = guessed_preset(input);
    const std::string seen = input.color_known
                                 ? fmt::format("colour {:.3g} {:.3g} {:.3g}", input.color.x,
                                               input.color.y, input.color.z)
                                 : std::string("colour not known");
    if (guess.preset.empty()) {
      assigns +=
          fmt::format("    <!-- {}, {}: as imported; {} -->\n",
                      in_comment(in_quotes(pattern_of(names[i]))), seen, in_comment(guess.reason));
      continue;
    }
    const std::string name = own_name(names[i], taken);
    // which side of a sheet is its front, files of CAD leave to chance
    const Preset* const preset = find_preset(guess.preset);
    materials += fmt::format("  <material name=\"{}\" preset=\"{}\"{}/>\n", name, guess.preset,
                             preset && !preset->back.empty() ? " back=\"none\"" : "");
    assigns +=
        fmt::format("    <!-- {}, {}: {}; {} -->\n", in_comment(in_quotes(pattern_of(names[i]))),
                    seen, guess.preset, in_comment(guess.reason));
    assigns += fmt::format("    <assign materials=\"{}\" material=\"{}\"/>\n",
                           markup_escaped(pattern_of(names[i])), name);
  }
  std::string out = "<pangu_model ver=\"1\">\n";
  if (!materials.empty()) out += "  <!-- guessed below from names and colours; check each -->\n";
  out += materials;
  if (!scene.joints.empty())
    out += "  <!-- joints of the file:" + joint_lines(imported) + "\n  -->\n";
  out += fmt::format("  <import file=\"{}\"{}", markup_escaped(file), attributes);
  out += assigns.empty() ? "/>\n" : ">\n" + assigns + "  </import>\n";
  return out + "</pangu_model>\n";
}

std::string attribute_value(std::string_view text) { return markup_escaped(text); }

}  // namespace panwright::pxn
