"""The C++ structs of materials, their inheritance, keys and visiting by name, from schemas/material.toml."""

from material_schema import WIDTHS, brdfs
from material_text import MARK, PARTS, authored, number, wrapped

TYPES = {"real": "double", "vec2": "Vec2", "vec3": "Vec3", "real8": "std::array<double, 8>", "texture": "std::int32_t",
         "Compensation": "Compensation"}
DEGREE = "kDegree"


def initial(parameter):
    """A default as C++ writes it."""
    default, kind = parameter["default"], parameter["type"]
    if kind == "Compensation":
        return f" = Compensation::{default}"
    if kind == "real8":
        return "{}"
    if kind in ("vec2", "vec3"):
        return "{" + ", ".join(number(each) for each in (default if isinstance(default, list) else [default])) + "}"
    return f" = {number(default)}"


def member_lines(parameters):
    lines = []
    for parameter in authored(parameters):
        doc = parameter["doc"].rstrip(".")
        if parameter["unit"]:
            doc += f", {parameter['unit']}"
        kind = TYPES[parameter["type"]]
        if parameter["none"]:
            declaration = f"  std::optional<{kind}> {parameter['name']};"
        else:
            declaration = f"  {kind} {parameter['name']}{initial(parameter)};"
        if len(declaration) + len(doc) + 5 <= 100:
            lines.append(f"{declaration}  // {doc}")
        else:
            lines += wrapped(doc, "  // ") + [declaration]
    return lines


def struct_lines(name, doc, parameters, extra=()):
    return (wrapped(doc, "// ") + [f"struct {name} {{"] + member_lines(parameters) + [f"  {line}" for line in extra] +
            [f"  bool operator==(const {name}&) const = default;", "};", ""])


def variants(schema):
    lines = []
    for part in PARTS:
        models = brdfs(schema, part)
        lines += wrapped(f"The {part} BRDF models; the values are those of the pan and of the variant.", "// ")
        lines += [f"enum class {part.capitalize()}Model : std::uint32_t {{"]
        lines += [f"  {brdf['name']}," for brdf in models] + ["};", ""]
        types = ", ".join(brdf["struct"] for brdf in models)
        lines += wrapped(f"using {part.capitalize()}Brdf = std::variant<{types}>;", "")
        lines += [f"inline {part.capitalize()}Model model_of(const {part.capitalize()}Brdf& brdf) {{",
                  f"  return static_cast<{part.capitalize()}Model>(brdf.index());", "}", ""]
    return lines


HEADER = '''
//
// Parameters of materials. Read materials/material.h first.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/math.h"

namespace panwright::materials {
'''

FUNCTIONS = '''
// Description of a BRDF model.
struct ModelInfo {
  std::string_view name;   // in files and JSON
  std::string_view title;  // in words
  std::string_view tag;    // of its element in pxn; empty: none
  bool microfacet = false;  // half vectors: has a Fresnel term
  bool smith = false;       // Smith's masking: slopes along u and v, multiple scattering
};
const ModelInfo& info_of(DiffuseModel model);
const ModelInfo& info_of(SpecularModel model);

// Returns a model with its default parameters.
DiffuseBrdf default_brdf(DiffuseModel model);
SpecularBrdf default_brdf(SpecularModel model);

// Returns the model whose element has this tag; none if there is none.
std::optional<DiffuseModel> diffuse_model_of_tag(std::string_view tag);
std::optional<SpecularModel> specular_model_of_tag(std::string_view tag);

// Returns the authored parameters of a model, with its defaults.
DiffuseBrdf brdf_of(const Fields& fields, DiffuseModel model);
SpecularBrdf brdf_of(const Fields& fields, SpecularModel model);
void set_brdf(Fields& fields, const DiffuseBrdf& brdf);
void set_brdf(Fields& fields, const SpecularBrdf& brdf);
bool has_brdf(const Fields& fields, DiffuseModel model);
bool has_brdf(const Fields& fields, SpecularModel model);

// A parameter by name.
struct Parameter {
  std::string_view name;
  std::string_view unit;       // empty: none
  std::string_view attribute;  // of the model's element in pxn; empty: one of its numbers
  double pxn_unit = 1;         // size of the unit that pxn has
  double initial = 0;          // default, of every number
};
using ParameterVisitor = std::function<void(const Parameter&, std::span<const double>)>;
using ParameterEditor = std::function<void(const Parameter&, std::span<double>)>;

// Calls the visitor with every parameter, in the order of the schema; those that are integers or
// textures are left out.
@visits@
void edit_parameters(DiffuseBrdf& brdf, const ParameterEditor& edit);
void edit_parameters(SpecularBrdf& brdf, const ParameterEditor& edit);

// Returns all distinguishing numbers of a material, without names and derived numbers (fits): equal
// exactly for equal materials.
std::vector<double> key_of(const Material& material);
std::vector<double> key_of(const Fields& fields);

}  // namespace panwright::materials
'''


def header_text(schema):
    lines = []
    for enum in schema["enum"]:
        lines += wrapped(enum["doc"], "// ")
        lines += [f"enum class {enum['name']} : std::uint32_t {{ {', '.join(enum['values'])} }};", ""]
    for brdf in schema["brdf"]:
        lines += struct_lines(brdf["struct"], brdf["doc"], brdf["parameter"])
    lines += variants(schema)
    for struct in schema["struct"]:
        if struct["name"] == "Material":
            continue
        extra = []
        if struct["name"] == "Maps":
            maps = [each["name"] for each in struct["parameter"] if each["type"] == "texture"]
            extra = ["bool any() const {", "  return " + " || ".join(f"{name} >= 0" for name in maps) + ";", "}"]
        lines += struct_lines(struct["name"], struct["doc"], struct["parameter"], extra)
    lines += material_lines(schema) + fields_lines(schema)
    visits = "\n".join(f"void visit_parameters(const {name}&, const ParameterVisitor& visit);"
                       for name in ["DiffuseBrdf", "SpecularBrdf", "Coat", "Cells"])
    return MARK.rstrip() + HEADER + "\n" + "\n".join(lines) + FUNCTIONS.replace("@visits@", visits)


def material_lines(schema):
    struct = schema["structs"]["Material"]
    extra = ["DiffuseBrdf diffuse_brdf;", "SpecularBrdf specular_brdf;"]
    for other in schema["struct"]:
        if other["name"] == "Material":
            continue
        comment = "" if other["authored"] else "  // by fit()"
        kind = f"std::optional<{other['name']}>" if other["optional"] else other["name"]
        extra.append(f"{kind} {other['field']};{comment}")
    extra += ["DiffuseModel diffuse_model() const { return model_of(diffuse_brdf); }",
              "SpecularModel specular_model() const { return model_of(specular_brdf); }"]
    lines = struct_lines("Material", struct["doc"], struct["parameter"], extra)
    at = next(i for i, line in enumerate(lines) if line == "struct Material {")
    return lines[:at + 1] + ["  std::string name;"] + lines[at + 1:]


def with_element(schema):
    return [brdf for brdf in schema["brdf"] if brdf["name"] != "none"]


def fields_lines(schema):
    lines = wrapped("Authored fields; absent ones are inherited from the appearance or the material around. "
                    "Several models of one part may be given; resolved() selects one.", "// ")
    lines += ["struct Fields {"]
    for parameter in schema["structs"]["Material"]["parameter"]:
        lines.append(f"  std::optional<{TYPES[parameter['type']]}> {parameter['field']};")
    for struct in schema["struct"]:
        if struct["authored"] and struct["name"] != "Material":
            lines.append(f"  std::optional<{struct['name']}> {struct['field']};")
    lines += ["  // by model"]
    lines += [f"  std::optional<{brdf['struct']}> {brdf['name']};" for brdf in with_element(schema)]
    lines += ["  // a named model takes precedence"]
    lines += [f"  std::optional<{part.capitalize()}Model> {part}_model;" for part in PARTS]
    lines += ["  bool hapke_named = false;  // by level 1, in which its numbers have names",
              "  std::optional<std::string> preset;  // name of the library's material it comes from", "",
              "  // Returns the fields with those of `inner` on top. A model given inside replaces the",
              "  // choice outside.", "  Fields overridden_by(const Fields& inner) const;",
              "  bool operator==(const Fields&) const = default;", "};", ""]
    return lines


# ---- definitions


def span_of(parameter, owner):
    """(pointer, count) of a parameter's numbers."""
    value = f"{owner}.{parameter['name']}"
    width = WIDTHS[parameter["type"]]
    return (f"&{value}" if width == 1 else f"{value}.data()" if width == 8 else f"&{value}.x"), width


def parameter_line(parameter):
    unit = DEGREE if parameter["pxn_unit"] == "deg" else "1"
    default = parameter["default"]
    default = default[0] if isinstance(default, list) else default
    return f"{{\"{parameter['name']}\", \"{parameter['unit']}\", \"{parameter['pxn']}\", {unit}, {number(default)}}}"


def visited(parameters):
    return [each for each in authored(parameters) if each["type"] in ("real", "vec2", "vec3")]


def visit_text(name, parameters, constant):
    qualifier, call = ("const ", "ParameterVisitor") if constant else ("", "ParameterEditor")
    function = "visit_one" if constant else "edit_one"
    body = []
    for parameter in visited(parameters):
        pointer, width = span_of(parameter, "b")
        body.append(f"  call({parameter_line(parameter)},\n       {{{pointer}, {width}}});")
    if not body:
        return f"void {function}({qualifier}{name}&, const {call}&) {{}}"
    return f"void {function}({qualifier}{name}& b, const {call}& call) {{\n" + "\n".join(body) + "\n}"


def key_text(parameters, owner):
    """Statements that append a struct's numbers."""
    lines = []
    for parameter in authored(parameters):
        value = f"{owner}.{parameter['name']}"
        if parameter["none"]:
            lines.append(f"  append(key, {value});")
        elif parameter["type"] in ("texture", "Compensation"):
            lines.append(f"  key.push_back(static_cast<double>({value}));")
        else:
            pointer, width = span_of(parameter, owner)
            lines.append(f"  append(key, std::span<const double>({pointer}, {width}));")
    return lines


SOURCE_HEAD = '''#include "materials/generated/material_record.h"

namespace panwright::materials {
namespace {

// note: + 0.0 makes one of both zeros
void append(std::vector<double>& key, std::span<const double> values) {
  for (const double value : values) key.push_back(value + 0.0);
}
void append(std::vector<double>& key, const std::optional<Vec3>& value) {
  key.push_back(value ? 1 : 0);
  const Vec3 numbers = value.value_or(Vec3(0));
  append(key, std::span<const double>(&numbers.x, 3));
}
'''


def source_text(schema):
    out = [MARK + SOURCE_HEAD]
    owners = [(brdf["struct"], brdf["parameter"]) for brdf in schema["brdf"]]
    structs = [struct for struct in schema["struct"] if struct["authored"] and struct["name"] != "Material"]
    for name, parameters in owners + [(struct["name"], struct["parameter"]) for struct in structs]:
        lines = key_text(parameters, "b")
        out.append(f"void append(std::vector<double>& key, const {name}& b) {{\n" + "\n".join(lines) + "\n}" if lines
                   else f"void append(std::vector<double>&, const {name}&) {{}}")
    out.append('''template <class T>
void append(std::vector<double>& key, const std::optional<T>& value) {
  key.push_back(value ? 1 : 0);
  if (value) append(key, *value);
}
''')
    for name, parameters in owners:
        out += [visit_text(name, parameters, True), visit_text(name, parameters, False)]
    infos = []
    for part in PARTS:
        infos.append(f"constexpr ModelInfo k{part.capitalize()}[] = {{")
        for brdf in brdfs(schema, part):
            flags = ", ".join("true" if each else "false" for each in (brdf["microfacet"], brdf["smith"]))
            infos.append(f"    {{\"{brdf['name']}\", \"{brdf['title']}\", "
                         f"\"{brdf.get('pxn', {}).get('tag', '')}\", {flags}}},")
        infos.append("};")
    out += ["\n".join(infos), "", "}  // namespace", ""]
    for part in PARTS:
        out.append(part_text(schema, part))
    for struct in structs:
        if struct["name"] in ("Coat", "Cells"):
            out.append(visit_text(struct["name"], struct["parameter"], True).replace("visit_one", "visit_parameters", 1))
    out += [overriding_text(schema), keys_text(schema), "}  // namespace panwright::materials", ""]
    return "\n".join(out)


def part_text(schema, part):
    part_name, models = part.capitalize(), brdfs(schema, part)
    fields = [brdf for brdf in models if brdf["name"] != "none"]
    lines = [f"const ModelInfo& info_of({part_name}Model model) {{",
             f"  return k{part_name}[static_cast<std::size_t>(model)];", "}", "",
             f"{part_name}Brdf default_brdf({part_name}Model model) {{", "  switch (model) {"]
    for brdf in models:
        lines += [f"    case {part_name}Model::{brdf['name']}:", f"      return {brdf['struct']}{{}};"]
    lines += ["  }", f"  return {models[0]['struct']}{{}};", "}", "",
              f"std::optional<{part_name}Model> {part}_model_of_tag(std::string_view tag) {{"]
    for brdf in models:
        if "pxn" in brdf:
            lines.append(f"  if (tag == \"{brdf['pxn']['tag']}\") return {part_name}Model::{brdf['name']};")
    lines += ["  return std::nullopt;", "}", "",
              f"{part_name}Brdf brdf_of(const Fields& fields, {part_name}Model model) {{", "  switch (model) {"]
    for brdf in fields:
        lines += [f"    case {part_name}Model::{brdf['name']}:",
                  f"      return fields.{brdf['name']}.value_or({brdf['struct']}{{}});"]
    if len(fields) < len(models):
        lines += ["    default:", "      break;"]
    lines += ["  }", f"  return {models[0]['struct']}{{}};", "}", "",
              f"bool has_brdf(const Fields& fields, {part_name}Model model) {{", "  switch (model) {"]
    for brdf in fields:
        lines += [f"    case {part_name}Model::{brdf['name']}:", f"      return fields.{brdf['name']}.has_value();"]
    if len(fields) < len(models):
        lines += ["    default:", "      break;"]
    lines += ["  }", "  return false;", "}", "", f"void set_brdf(Fields& fields, const {part_name}Brdf& brdf) {{"]
    for brdf in fields:
        lines.append(f"  if (const auto* given = std::get_if<{brdf['struct']}>(&brdf)) "
                     f"fields.{brdf['name']} = *given;")
    lines += ["}", "", f"void visit_parameters(const {part_name}Brdf& brdf, const ParameterVisitor& visit) {{",
              "  std::visit([&](const auto& b) { visit_one(b, visit); }, brdf);", "}", "",
              f"void edit_parameters({part_name}Brdf& brdf, const ParameterEditor& edit) {{",
              "  std::visit([&](auto& b) { edit_one(b, edit); }, brdf);", "}", ""]
    return "\n".join(lines)


def overriding_text(schema):
    lines = ["Fields Fields::overridden_by(const Fields& inner) const {", "  Fields merged = *this;",
             "  const auto replace = [](auto& field, const auto& by) {", "    if (by) field = by;", "  };"]
    for parameter in schema["structs"]["Material"]["parameter"]:
        if parameter["field"] != "extinction":
            lines.append(f"  replace(merged.{parameter['field']}, inner.{parameter['field']});")
    lines += ["  // n and k belong together", "  if (inner.refract) merged.extinction = inner.extinction;"]
    for struct in schema["struct"]:
        if struct["authored"] and struct["name"] != "Material":
            lines.append(f"  replace(merged.{struct['field']}, inner.{struct['field']});")
    for part in PARTS:
        models = [brdf["name"] for brdf in brdfs(schema, part) if brdf["name"] != "none"]
        lines += [f"  replace(merged.{name}, inner.{name});" for name in models]
        given = " || ".join(f"inner.{name}" for name in models + [f"{part}_model"])
        lines += [f"  if ({given})", f"    merged.{part}_model = inner.{part}_model;"]
    lines += ["  if (inner.hapke) merged.hapke_named = inner.hapke_named;", "  replace(merged.preset, inner.preset);",
              "  return merged;", "}", ""]
    return "\n".join(lines)


def keys_text(schema):
    lines = ["std::vector<double> key_of(const Material& m) {", "  std::vector<double> key;"]
    lines += key_text(schema["structs"]["Material"]["parameter"], "m")
    for part in PARTS:
        lines += [f"  key.push_back(static_cast<double>(m.{part}_brdf.index()));",
                  f"  std::visit([&](const auto& b) {{ append(key, b); }}, m.{part}_brdf);"]
    for struct in schema["struct"]:
        if struct["authored"] and struct["name"] != "Material":
            lines.append(f"  append(key, m.{struct['field']});")
    lines += ["  return key;", "}", "", "std::vector<double> key_of(const Fields& f) {", "  std::vector<double> key;"]
    for parameter in schema["structs"]["Material"]["parameter"]:
        if parameter["type"] == "vec3":
            lines.append(f"  append(key, f.{parameter['field']});")
        else:
            lines.append(f"  key.push_back(f.{parameter['field']} ? "
                         f"static_cast<double>(*f.{parameter['field']}) : -1);")
    for struct in schema["struct"]:
        if struct["authored"] and struct["name"] != "Material":
            value = f"f.{struct['field']}" + ("" if struct["optional"] else f".value_or({struct['name']}{{}})")
            lines.append(f"  append(key, {value});")
    lines += [f"  append(key, f.{brdf['name']});" for brdf in with_element(schema)]
    lines += [f"  key.push_back(f.{part}_model ? static_cast<double>(*f.{part}_model) : -1);" for part in PARTS]
    lines += ["  key.push_back(f.hapke_named ? 1 : 0);", "  return key;", "}", ""]
    return "\n".join(lines)
