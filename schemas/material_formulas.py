"""What the formulas and shaders know of materials, from schemas/material.toml."""

from material_schema import STORED, WIDTHS, brdfs
from material_text import MARK, PARTS, number, wrapped


def gpu_fields(schema):
    """(name, Real or Vec3, doc) of Surface, each once."""
    fields = {}
    owners = [schema["structs"]["Material"]] + schema["brdf"] + [struct for struct in schema["struct"]
                                                                 if struct["name"] != "Material"]
    for owner in owners:
        for parameter in owner["parameter"]:
            names = [parameter["gpu"]] if isinstance(parameter["gpu"], str) else parameter["gpu"]
            for index, name in enumerate(names):
                if not name:
                    continue
                doc = parameter["doc"].rstrip(".")
                if parameter["type"] == "real8":
                    for k in range(8):
                        fields.setdefault(f"{name}{k}", ["Real", []])[1].extend([doc] if k == 0 else [])
                    continue
                kind = "Vec3" if parameter["type"] == "vec3" else "Real"
                where = f"{owner['name']}: " if owner in schema["brdf"] else ""
                if parameter["stored"]:
                    where += {"tan": "tangent of ", "cos": "cosine of "}[parameter["stored"]]
                fields.setdefault(name, [kind, []])[1].append(where + (doc if index == 0 else "and across"))
    for context in schema["context"]:
        fields[context["name"]] = [{"real": "Real", "vec3": "Vec3"}[context["type"]], [context["doc"]]]
    return [(name, kind, "; ".join(dict.fromkeys(docs))) for name, (kind, docs) in fields.items()]


def parameters_glsl(schema):
    lines = [MARK.rstrip(), "", "// Parameters of a material in the formulas; fields as in docs/conventions.md.",
             "struct Surface {"]
    for name, kind, doc in gpu_fields(schema):
        if doc:
            lines += wrapped(doc, "  // ")
        lines.append(f"  {kind} {name};")
    return "\n".join(lines + ["};", ""])


def fields_def(schema):
    return MARK + "".join(f"{'VECTOR' if kind == 'Vec3' else 'REAL'}({name})\n"
                          for name, kind, _ in gpu_fields(schema))


def slot_default(parameter, schema, k):
    name, index = parameter["places"][k]
    default = schema["slots"][name]["default"]
    return default[index] if isinstance(default, list) else default


def load_lines(parameters, owner):
    """Statements that give Surface its fields from a struct."""
    lines = []
    for parameter in parameters:
        gpu = parameter["gpu"]
        if not gpu:
            continue
        value = f"{owner}.{parameter['name']}"
        if parameter["derived"]:
            lines.append(f"  s.{gpu} = real({parameter['derived']});")
        elif parameter["none"]:
            lines.append(f"  s.{gpu} = {value} ? rounded(*{value}) : Vec3(Real(0));")
        elif parameter["type"] == "vec3":
            lines.append(f"  s.{gpu} = rounded({value});")
        elif parameter["type"] == "real8":
            lines += [f"  s.{gpu}{k} = real({value}[{k}]);" for k in range(8)]
        elif parameter["type"] == "vec2":
            lines += [f"  s.{each} = real({STORED[parameter['stored']][0].format(value + '.' + axis)});"
                      for each, axis in zip(gpu, "xy")]
        else:
            lines.append(f"  s.{gpu} = real({STORED[parameter['stored']][0].format(value)});")
    return lines


def surface_of_text(schema):
    """From a material in double to the parameters of one precision."""
    out = [MARK.rstrip(), "// The parameters of a fitted material, for the namespace of a precision.", "",
           "inline Real real(double value) { return static_cast<Real>(value); }",
           "inline Vec3 rounded(const panwright::Vec3& v) { return Vec3(real(v.x), real(v.y), real(v.z)); }", ""]
    for brdf in schema["brdf"]:
        lines = load_lines(brdf["parameter"], "b")
        arguments = f"SurfaceFields& s, const {brdf['struct']}& b" if lines else f"SurfaceFields&, const {brdf['struct']}&"
        out += [f"inline void load_brdf({arguments}) {{" + ("" if lines else "}")] + (lines + ["}"] if lines else [])
    out += ["", "inline SurfaceFields surface_of(const Material& material, const Vec3& tangent = Vec3(Real(0))) {",
            "  SurfaceFields s{};",
            "  // what a record has where nothing uses a slot"]
    seen = set()
    for brdf in schema["brdf"]:
        for parameter in brdf["parameter"]:
            if parameter["gpu"] and parameter["gpu"] not in seen:
                seen.add(parameter["gpu"])
                default = slot_default(parameter, schema, 0)
                if default:
                    out.append(f"  s.{parameter['gpu']} = Real({number(default)});")
    out += load_lines(schema["structs"]["Material"]["parameter"], "material")
    for part in PARTS:
        out.append(f"  std::visit([&](const auto& b) {{ load_brdf(s, b); }}, material.{part}_brdf);")
    for struct in schema["struct"]:
        if struct["name"] == "Material" or not any(each["gpu"] for each in struct["parameter"]):
            continue
        if not struct["optional"]:
            out += load_lines(struct["parameter"], f"material.{struct['field']}")
            continue
        for parameter in struct["parameter"]:
            if "absent" in parameter:
                out.append(f"  s.{parameter['gpu']} = Real({number(parameter['absent'])});")
        out += [f"  if (const auto& b = material.{struct['field']}) {{"]
        out += ["  " + line.replace("b.", "b->") for line in load_lines(struct["parameter"], "b")] + ["  }"]
    for context in schema["context"]:
        value = {"0": "tangent", "none": "Real(0)", "coat": "Real(material.coat ? 1 : 0)"}.get(
            context["value"], f"s.{context['value']}")
        out.append(f"  s.{context['name']} = {value};")
    return "\n".join(out + ["  return s;", "}", ""])


def glsl_place(parameter, schema, k):
    name, index = parameter["places"][k]
    at = schema["slots"][name]["offset"] // 4 + index
    return at // 4, "xyzw"[at % 4]


def loader_text(schema):
    """GLSL: from a record of the pan to the parameters. material_row(i) is its i-th vec4."""
    rows, lines = set(), []
    for owner in schema["brdf"] + schema["struct"]:
        for parameter in owner["parameter"]:
            gpu = parameter["gpu"]
            if not gpu:
                continue
            width = WIDTHS[parameter["type"]]
            places = [glsl_place(parameter, schema, k) for k in range(width)]
            rows.update(row for row, _ in places)
            names = gpu if isinstance(gpu, list) else [f"{gpu}{k}" for k in range(8)] if width == 8 else [gpu]
            if parameter["type"] != "vec3":
                lines += [f"  s.{name} = row{row}.{at};" for name, (row, at) in zip(names, places)]
            elif len({row for row, _ in places}) == 1:
                lines.append(f"  s.{gpu} = row{places[0][0]}.{''.join(at for _, at in places)};")
            else:
                lines.append(f"  s.{gpu} = vec3({', '.join(f'row{row}.{at}' for row, at in places)});")
    lines = list(dict.fromkeys(lines))
    for context in schema["context"]:
        value = {"0": "vec3(0.0)", "none": "0.0", "coat": "1.0"}.get(context["value"], f"s.{context['value']}")
        lines.append(f"  s.{context['name']} = {value};")
    accessors = []
    for slot in schema["slot"]:
        first = slot["offset"] // 4
        if slot["type"] == "f32" and slot["count"] <= 4 and first % 4 + slot["count"] <= 4:
            kind = "float" if slot["count"] == 1 else f"vec{slot['count']}"
            accessors.append(f"{kind} material_{slot['name']}(int row) {{ return material_row(row + {first // 4})."
                             f"{'xyzw'[first % 4:first % 4 + slot['count']]}; }}")
    declared = [f"  vec4 row{row} = material_row(row + {row});" for row in sorted(rows)]
    count = schema["record"]["size"] // 16
    text = "\n".join(["vec4 material_row(int i);", f"const int kMaterialRows = {count};", *accessors,
                      "Surface surface_of(int row) {", *declared, "  Surface s;", *lines,
                      "  return s;", "}", ""])
    return (MARK + "// GLSL that reads a record of a pan: material_SLOT(row) and surface_of(row).\n"
            "inline constexpr const char* kMaterialLoader = R\"glsl(\n" + text + ")glsl\";\n")


def formula_files(schema):
    """Files in an order in which they may stand: what is called stands before who calls it."""
    files = ["incidence", "common", "emission", "fresnel", "disc", "slopes"]
    for brdf in schema["brdf"]:
        if brdf["formula"] not in files:
            files.append(brdf["formula"])
    return files + ["coat"]


def choice_text(schema):
    """The choice of a BRDF in C++."""
    out = [MARK.rstrip(), "// Members of Composition: the BRDF of the models that are used."]
    directions = "to_light, to_viewer, normal"
    lobes = "light, to_viewer, normal, tilted, index"
    for part, kind, name, suffix, arguments in (("diffuse", "Vec3", "diffuse", "", "s, " + directions),
                                                ("specular", "Vec3", "lobe_from", "_from", "s, " + lobes),
                                                ("specular", "Real", "lobe", "", "s, from, " + lobes)):
        kinds = {"s": "Surface ", "light": "Incidence ", "index": "Real "}
        parameters = ", ".join(kinds.get(each, "Vec3 ") + each for each in arguments.split(", "))
        out += ["", f"{kind} {name}({parameters}) const {{", f"  switch (brdf_model.{part}) {{"]
        models = brdfs(schema, part)
        for brdf in models[1:]:
            out += [f"    case {part.capitalize()}Model::{brdf['name']}:",
                    f"      return {brdf['function']}{suffix}({arguments});"]
        out += ["    default:", "      break;", "  }", f"  return {models[0]['function']}{suffix}({arguments});", "}"]
    return "\n".join(out + [""])


def formula_table_text(schema):
    """What glsl_formulas() puts together."""
    files = formula_files(schema)
    out = [MARK.rstrip(), ""]
    for part in PARTS:
        names = ", ".join(f"\"{brdf['function']}\"" for brdf in brdfs(schema, part))
        out += wrapped(f"constexpr const char* k{part.capitalize()}Functions[] = {{{names}}};", "")
    out += ["", "// A file of formulas, and the models that need it; a shared one stands in every shader.",
            "struct FormulaFile {", "  const char* const* text;", "  bool shared;",
            "  int diffuse;   // model, or -1", "  int specular;  // model, or -1", "};", "",
            "const FormulaFile kFormulaFiles[] = {", "    {&parameters_text, true, -1, -1},"]
    for file in files:
        users = [brdf for brdf in schema["brdf"] if brdf["formula"] == file]
        shared = not users or any(brdf["shared"] for brdf in users)
        index = {part: -1 for part in PARTS}
        if not shared:
            index[users[0]["part"]] = brdfs(schema, users[0]["part"]).index(users[0])
        out.append(f"    {{&{file}_text, {'true' if shared else 'false'}, {index['diffuse']}, {index['specular']}}},")
    return "\n".join(out + ["};", ""])


def generated_formula_files(schema):
    files = formula_files(schema)
    includes = MARK + "".join(f'#include "materials/formulas/{file}.glsl"\n//\n'
                              for file in files[1:-1] + ["cells", "coat"])
    texts = MARK + "".join(f"extern const char* const {file}_text;\n"
                           for file in ["parameters"] + files + ["cells", "surface"])
    cmake = ("# Generated by schemas/generate_material.py from schemas/material.toml. Do not edit.\n"
             "set(formulas " + " ".join(files + ["cells", "surface"]) + ")\n")
    return includes, texts, cmake
