"""From a material to its record in a pan and back, from schemas/material.toml."""

from material_schema import STORED, brdfs, feature_name
from material_text import MARK, PARTS, authored


def store_lines(parameters, owner, schema):
    lines = []
    for parameter in parameters:
        for k, (name, index) in enumerate(parameter["places"]):
            slot = schema["slots"][name]
            place = f"r.{name}" + (f"[{index}]" if slot["count"] > 1 else "")
            value = f"{owner}.{parameter['name']}"
            if parameter["derived"]:
                value = parameter["derived"]
            elif parameter["none"]:
                value = f"{value}->{'xyz'[k]}"
            elif parameter["type"] == "real8":
                value += f"[{k}]"
            elif parameter["type"] in ("vec2", "vec3"):
                value += "." + "xyz"[k]
            if parameter["type"] == "texture":
                lines.append(f"{place} = {value};")
            elif parameter["type"] == "Compensation":
                lines.append(f"{place} = static_cast<std::uint32_t>({value});")
            else:
                statement = f"{place} = static_cast<float>({STORED[parameter['stored']][0].format(value)});"
                lines.append(f"if ({owner}.{parameter['name']}) {statement}" if parameter["none"] else statement)
    return lines


def read_lines(parameters, owner, schema):
    lines = []
    for parameter in authored(parameters):
        places = []
        for name, index in parameter["places"]:
            place = f"r.{name}" + (f"[{index}]" if schema["slots"][name]["count"] > 1 else "")
            if parameter["type"] not in ("texture", "Compensation"):
                place = STORED[parameter["stored"]][1].format(f"double{{{place}}}")
            places.append(place)
        value = f"{owner}.{parameter['name']}"
        if parameter["type"] == "Compensation":
            lines.append(f"{value} = static_cast<materials::Compensation>({places[0]});")
        elif len(places) == 1:
            lines.append(f"{value} = {places[0]};")
        elif parameter["none"]:
            lines += [f"if (Vec3({', '.join(places)}) != Vec3(0))", f"  {value} = Vec3({', '.join(places)});"]
        else:
            lines.append(f"{value} = {{{', '.join(places)}}};")
    return lines


def limit_lines(parameters, owner, schema):
    """Checks of what a record must keep; `owner` is for the message."""
    lines = []
    for parameter in parameters:
        for k, (name, index) in enumerate(parameter["places"]):
            place = f"r.{name}" + (f"[{index}]" if schema["slots"][name]["count"] > 1 else "")
            part = f"[{k}]" if len(parameter["places"]) > 1 else ""
            for must in parameter["must"]:
                operator, limit = must.split()
                words = {">": "above", ">=": "at least", "<=": "at most"}[operator]
                lines.append(f"if (!({place} {operator} {float(limit)!r}F)) "
                             f"return broken(\"{owner}{parameter['name']}{part}\", {place}, \"{words} {limit}\");")
    return lines


PAN_HEAD = '''#include <fmt/format.h>

#include <optional>
#include <span>
#include <string>

#include "pan/internal/material_limits.h"
#include "pan/model.h"

namespace panwright::pan {
namespace {
'''


def slots_of_brdfs(schema):
    return dict.fromkeys(name for brdf in schema["brdf"] for parameter in brdf["parameter"]
                         for name, _ in parameter["places"])


def indented(lines, by="  "):
    return [by + line for line in lines]


def pan_text(schema):
    out = [MARK + PAN_HEAD]
    for brdf in schema["brdf"]:
        name = f"materials::{brdf['struct']}"
        for kind, lines in (("store", store_lines(brdf["parameter"], "b", schema)),
                            ("read", read_lines(brdf["parameter"], "b", schema))):
            record = "layout::Material&" if kind == "store" else "const layout::Material&"
            mine = f"const {name}&" if kind == "store" else f"{name}&"
            if lines:
                out += [f"void {kind}({record} r, {mine} b) {{"]
                out += indented([line.replace("porosity_factor", "materials::porosity_factor") for line in lines])
                out += ["}"]
            else:
                out.append(f"void {kind}({record}, {mine}) {{}}")
    out += ["", "std::optional<std::string> broken(const char* name, float value, const char* limit) {",
            "  return fmt::format(\"{} is {}, expected {}\", name, value, limit);", "}", "",
            "}  // namespace", "", "materials::Material material_from(const layout::Material& r, std::string_view name) {",
            "  materials::Material m;", "  m.name = name;"]
    out += indented(read_lines(schema["structs"]["Material"]["parameter"], "m", schema))
    for part in PARTS:
        model = f"materials::{part.capitalize()}Model"
        out += [f"  m.{part}_brdf = materials::default_brdf(static_cast<{model}>(r.{part}_brdf));",
                f"  std::visit([&](auto& b) {{ read(r, b); }}, m.{part}_brdf);"]
    for struct in schema["struct"]:
        if struct["name"] == "Material":
            continue
        if struct["optional"]:
            slot = schema["slots"][struct["optional"]]
            place = f"r.{slot['name']}" + ("[0]" if slot["count"] > 1 else "")
            out += [f"  if ({place} > 0) {{", f"    auto& b = m.{struct['field']}.emplace();"]
            out += indented(read_lines(struct["parameter"], "b", schema), "    ") + ["  }"]
        else:
            out += indented(read_lines(struct["parameter"], f"m.{struct['field']}", schema))
    out += ["  return m;", "}", "",
            "layout::Material record_from(const materials::Material& m, std::uint32_t name) {", "  layout::Material r{};"]
    for slot in schema["slot"]:
        defaults = slot["default"] if isinstance(slot["default"], list) else [slot["default"]] * slot["count"]
        for k, default in enumerate(defaults):
            if default:
                out.append(f"  r.{slot['name']}" + (f"[{k}]" if slot["count"] > 1 else "") + f" = {float(default)!r}F;")
    out += ["  r.name = name;"]
    out += indented(store_lines(schema["structs"]["Material"]["parameter"], "m", schema))
    for part in PARTS:
        out += [f"  r.{part}_brdf = static_cast<std::uint32_t>(m.{part}_brdf.index());",
                f"  std::visit([&](const auto& b) {{ store(r, b); }}, m.{part}_brdf);"]
    for struct in schema["struct"]:
        if struct["name"] == "Material":
            continue
        if struct["optional"]:
            out += [f"  if (m.{struct['field']}) {{", f"    const auto& b = *m.{struct['field']};"]
            out += indented(store_lines(struct["parameter"], "b", schema), "    ") + ["  }"]
        else:
            out += indented(store_lines(struct["parameter"], f"m.{struct['field']}", schema))
    out += ["  return r;", "}", "",
            "std::span<const std::string_view> brdf_slots() {",
            "  static constexpr std::string_view kSlots[] = {" + ", ".join(f'"{name}"' for name in slots_of_brdfs(schema)) + "};",
            "  return kSlots;", "}", "",
            "std::uint64_t features_of([[maybe_unused]] const layout::Material& r) {",
            "  std::uint64_t features = 0;"]
    for brdf in schema["brdf"]:
        if brdf["since"]:
            model = f"materials::{brdf['part'].capitalize()}Model::{brdf['name']}"
            out += [f"  if (r.{brdf['part']}_brdf == static_cast<std::uint32_t>({model}))",
                    f"    features |= layout::kFeature{feature_name(brdf)};"]
    out += ["  return features;", "}", "",
            "std::optional<std::string> material_limit_broken(const layout::Material& r) {"]
    for part in PARTS:
        out.append(f"  switch (static_cast<materials::{part.capitalize()}Model>(r.{part}_brdf)) {{")
        for brdf in brdfs(schema, part):
            lines = limit_lines(brdf["parameter"], "", schema)
            if lines:
                out += [f"    case materials::{part.capitalize()}Model::{brdf['name']}:"]
                out += indented(lines, "      ") + ["      break;"]
        out += ["    default:", "      break;", "  }"]
    for struct in schema["struct"]:
        lines = limit_lines(struct["parameter"], f"{struct['field']}." if "field" in struct else "", schema)
        if struct["optional"] and lines:
            slot = schema["slots"][struct["optional"]]
            places = [f"r.{slot['name']}[{k}] != 0" for k in range(slot["count"])] if slot["count"] > 1 else [
                f"r.{slot['name']} != 0"]
            # upper limits hold without it too: absent numbers are 0
            lower = [line for line in lines if " <= " not in line]
            out += [f"  if ({' || '.join(places)}) {{"] + indented(lower, "    ") + ["  }"]
            out += indented([line for line in lines if " <= " in line])
        else:
            out += indented(lines)
    return "\n".join(out + ["  return std::nullopt;", "}", "", "}  // namespace panwright::pan", ""])
