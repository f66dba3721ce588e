#!/usr/bin/env python3
"""Makes schemas/generated/pan_layout.h, pan/generated/ and docs/pan-format.md from schemas/pan_layout.toml.

generate_pan.py            writes them
generate_pan.py --check    fails, and names the file, when one of them differs from what it would write
generate_pan.py --later GROWTH FILE   makes the header of a format that has grown: for tests of what later readers do
"""

import pathlib
import sys
import tomllib

import generated_files
import material_schema
import pan_tables
from generated_files import ROOT
from pan_tables import CPP

SIZES = {"u8": 1, "u16": 2, "u32": 4, "i32": 4, "u64": 8, "f32": 4, "f64": 8}
RULES = {"finite", "not_negative", "nonzero", "zero", "reference", "reference_or_none", "unit", "range", "mask"}


# records that are elements of big arrays, which are used as they lie in the file
ARRAY_ELEMENTS = ("Float2", "Float3")


class LayoutError(Exception):
    """The layout table contradicts itself."""


def place_fields(record):
    """Gives every field its offset, and refuses implicit padding and wrong sizes."""
    offset = 0
    alignment = 1
    since = 0
    for field in record["field"]:
        size = SIZES[field["type"]]
        field.setdefault("count", 1)
        field.setdefault("since", 0)
        if field["since"] < since or ("default" in field) != (field["since"] > 0):
            raise LayoutError(f"{record['name']}.{field['name']}: records grow at their end, by fields with a default")
        since = field["since"]
        if offset % size:
            raise LayoutError(f"{record['name']}.{field['name']}: offset {offset} is not aligned to {size}")
        field["offset"] = offset
        offset += size * field["count"]
        alignment = max(alignment, size)
    if offset != record["size"] or offset % alignment:
        raise LayoutError(f"{record['name']}: fields take {offset} bytes, size says {record['size']}")
    record["alignment"] = alignment
    # of the first format that had it: what no file's records are shorter than
    record["first_size"] = size_in(record, 0)


def size_in(record, minor):
    """The bytes of a record in format 1.minor."""
    return sum(SIZES[field["type"]] * field["count"] for field in record["field"] if field["since"] <= minor)


def check_growth(layout):
    """Only records of tables grow, whole, and by no more than a reader takes."""
    fixed = {"Header", "DirectoryEntry"} | set(ARRAY_ELEMENTS)
    most = next(c["value"] for c in layout["constant"] if c["name"] == "kMaxRecordBytes")
    for record in layout["record"]:
        name = record["name"]
        newest = record["field"][-1]["since"]
        if newest > layout["format"]["minor"] or record["size"] > most:
            raise LayoutError(f"{name} is newer or larger than the format allows")
        if newest > 0 and name in fixed:
            raise LayoutError(f"{name} keeps its size")
        for minor in range(newest + 1):
            if size_in(record, minor) % record["alignment"]:
                raise LayoutError(f"{name} in format 1.{minor} is no multiple of {record['alignment']} bytes")


def rule_parts(field):
    """('range', '1..5') for 'range:1..5'."""
    kind, _, argument = field.get("rule", "").partition(":")
    if kind and kind not in RULES:
        raise LayoutError(f"{field['name']}: no rule is called {kind}")
    return kind, argument


def resolve_enums(layout):
    """Rules of enumerations are ranges, which know the names of their values."""
    sizes = {enum["name"]: len(enum["values"]) for enum in layout["enum"]}
    for record in layout["record"]:
        for field in record["field"]:
            kind, _, name = field.get("rule", "").partition(":")
            if kind == "enum":
                if name not in sizes:
                    raise LayoutError(f"{record['name']}.{field['name']}: no enumeration is called {name}")
                field.update(rule=f"range:0..{sizes[name] - 1}", enum=name)


def validate(layout):
    """Every record is placed; kinds, names and referred sections exist once."""
    resolve_enums(layout)
    for record in layout["record"]:
        place_fields(record)
    check_growth(layout)
    if fault := pan_tables.fault(layout, ARRAY_ELEMENTS):
        raise LayoutError(fault)
    sections = layout["section"] + layout.get("reserved", [])
    kinds = [section["kind"] for section in sections]
    values = [section["value"] for section in sections]
    if len(set(kinds)) != len(kinds) or sorted(values) != list(range(1, len(values) + 1)):
        raise LayoutError("section kinds must be unique and their values count from 1, reserved ones among them")
    if (order := [section["value"] for section in layout["section"]]) != sorted(order):
        raise LayoutError("sections stand by their values")
    for kind in layout.get("reserved", []):
        if kind["value"] != kind["fixed"]:
            raise LayoutError(f"files hold '{kind['kind']}' as kind {kind['fixed']}: it cannot move")
    known = set(kinds) | {"strings"}
    flags = {flags["name"] for flags in layout["flags"]}
    for record in layout["record"]:
        for field in record["field"]:
            kind, argument = rule_parts(field)
            if kind.startswith("reference") and argument not in known:
                raise LayoutError(f"{record['name']}.{field['name']}: no section is called {argument}")
            if kind == "unit" and (field["type"] != "f64" or field["count"] not in (3, 4)):
                raise LayoutError(f"{record['name']}.{field['name']}: 3 or 4 f64 are a unit vector")
            if kind == "mask" and argument not in flags:
                raise LayoutError(f"{record['name']}.{field['name']}: no flags are called {argument}")


def add_materials(layout):
    """Takes the record of materials and its enumerations from material.toml."""
    schema = material_schema.load()
    layout["enum"] = material_schema.pan_enums(schema) + layout["enum"]
    layout["record"] = [material_schema.pan_record(schema) if record.get("from") else record
                        for record in layout["record"]]
    add_features(layout, material_schema.pan_features(schema))
    layout["material_docs"] = material_schema.pan_docs(schema)


def add_features(layout, features):
    """Gives each required feature its place, those of BRDFs among them: every bit up to the last has one meaning."""
    flags = next(flags for flags in layout["flags"] if flags["name"] == "RequiredFeatures")
    for index, bit in enumerate(flags["bits"]):
        bit.setdefault("bit", index)
    flags["bits"] = sorted(flags["bits"] + features, key=lambda bit: bit["bit"])
    if [bit["bit"] for bit in flags["bits"]] != list(range(len(flags["bits"]))):
        raise LayoutError("the bits of RequiredFeatures must be unique and without gaps")
    for bit in flags["bits"]:
        if not 0 < bit["since"] <= layout["format"]["minor"]:
            raise LayoutError(f"{bit['name']}: no format 1.0 to 1.{layout['format']['minor']} added the feature")


def element_size(section, records):
    return SIZES.get(section["element"]) or records[section["element"]]["size"]


def grows(section, records):
    """Whether the section holds records of a table, which later versions may make longer."""
    return section["element"] in records and section["element"] not in ARRAY_ELEMENTS


def section_line(section, records):
    """The SectionInfo of a kind."""
    size = element_size(section, records)
    record = records.get(section["element"], {})
    alignment = record.get("alignment") or size
    optional = "true" if section.get("optional") else "false"
    table = "true" if grows(section, records) else "false"
    return (f"    {{SectionKind::{section['kind']}, \"{section['kind']}\", {size}, "
            f"{record.get('first_size', size)}, {alignment}, {table}, {optional}}},")


def default_lines(layout, records):
    """The FieldDefault of each field that some version added."""
    out = []
    for section in layout["section"]:
        for field in records.get(section["element"], {"field": []})["field"]:
            if field["since"] > 0:
                out.append(f"    {{SectionKind::{section['kind']}, {field['offset']}, FieldType::{field['type']}, "
                           f"{field['count']}, {field['default']}}},")
    return out


def feature_lines(layout):
    """The FeatureInfo of each required feature."""
    flags = next(flags for flags in layout["flags"] if flags["name"] == "RequiredFeatures")
    return [f"    {{{flags['prefix']}{bit['name']}, {bit['since']}, \"{bit['name']}\"}}," for bit in flags["bits"]]


def mask_of(layout, name):
    for flags in layout["flags"]:
        if flags["name"] == name:
            return (1 << len(flags["bits"])) - 1
    raise LayoutError(name)


def hex_literal(value):
    return f"0x{value:08x}u"


def wrapped(text, width, first, rest):
    """Breaks a text into lines of at most `width` characters."""
    lines, line = [], first
    for word in text.split():
        if len(line) + len(word) + 1 > width and line.strip() not in ("", "//"):
            lines.append(line.rstrip())
            line = rest
        line += word + " "
    return lines + [line.rstrip()]


def struct_lines(record):
    out = wrapped(record["doc"], 98, "// ", "// ")
    out.append(f"struct {record['name']} {{")
    for field in record["field"]:
        count = f"[{field['count']}]" if field["count"] > 1 else ""
        unit = f"{field['unit']}: " if field.get("unit") else ""
        declaration = f"  {CPP[field['type']]} {field['name']}{count};"
        comment = unit + field["doc"]
        if comment:
            declaration = f"{declaration}  // {comment}"
        if len(declaration) > 100:
            out += wrapped(comment, 98, "  // ", "  // ")
            declaration = f"  {CPP[field['type']]} {field['name']}{count};"
        out.append(declaration)
    out.append("};")
    name = record["name"]
    out.append(f"static_assert(sizeof({name}) == {record['size']});")
    for field in record["field"]:
        out.append(f"static_assert(offsetof({name}, {field['name']}) == {field['offset']});")
    return out + [""]


def rule_line(section, field, layout):
    kind, argument = rule_parts(field)
    low, high, target = "0", "0", "build"
    if kind.startswith("reference"):
        target = "string_offsets" if argument == "strings" else argument
    elif kind == "range":
        low, high = (value + "u" for value in argument.split(".."))
    elif kind == "mask":
        high = hex_literal(mask_of(layout, argument))
    kind = kind or "any"
    name = field["name"]
    names = f"k{field['enum']}Names" if "enum" in field else "nullptr"
    return (f"    {{SectionKind::{section['kind']}, \"{name}\", {field['offset']}, FieldType::{field['type']}, "
            f"{field['count']},\n     FieldRuleKind::{kind}, SectionKind::{target}, {low}, {high}, "
            f"\"{field.get('at', '')}\", {names}}},")


def header_text(layout):
    fmt = layout["format"]
    records = {record["name"]: record for record in layout["record"]}
    out = [
        "// Generated by schemas/generate_pan.py from schemas/pan_layout.toml. Do not edit.",
        "//",
        f"// Records of a pan file, format {fmt['major']}.{fmt['minor']}, as documented in docs/pan-format.md. All numbers are little",
        "// endian; no record has implicit padding.",
        "// clang-format off",
        "#pragma once",
        "",
        "#include <array>",
        "#include <cstddef>",
        "#include <cstdint>",
        "",
        "namespace panwright::pan::layout {",
        "",
        f"inline constexpr std::uint16_t kMajor = {fmt['major']};",
        f"inline constexpr std::uint16_t kMinor = {fmt['minor']};",
        "inline constexpr std::uint8_t kMagic[8] = {" + ", ".join(f"0x{b:02x}" for b in fmt["magic"]) + "};",
        f"inline constexpr std::uint32_t kEndianTag = {hex_literal(fmt['endian'])};",
        f"inline constexpr std::uint32_t kComplete = {hex_literal(fmt['complete'])};  // the bytes 'DONE'",
        f"inline constexpr std::uint64_t kHashBlock = {fmt['block']};  // bytes: 65,536 records of three floats",
    ]
    for constant in layout["constant"]:
        out.append(f"inline constexpr std::uint64_t {constant['name']} = {constant['value']};  // {constant['doc']}")
    out.append("")
    for enum in layout["enum"]:
        out += wrapped(enum["doc"], 98, "// ", "// ")
        out.append(f"enum class {enum['name']} : std::uint32_t {{")
        for index, value in enumerate(enum["values"]):
            out.append(f"  {value['name']} = {index},  // {value['doc']}")
        names = ", ".join(f'"{value["name"]}"' for value in enum["values"])
        out += ["};", f"inline constexpr const char* k{enum['name']}Names[] = {{{names}}};", ""]
    for flags in layout["flags"]:
        out += wrapped(flags["doc"], 98, "// ", "// ")
        for index, bit in enumerate(flags["bits"]):
            out.append(f"inline constexpr std::uint32_t {flags['prefix']}{bit['name']} = 1u << {index};  // {bit['doc']}")
        if flags["name"] == "RequiredFeatures":
            out.append(f"inline constexpr std::uint64_t kKnownRequiredFeatures = {hex_literal(mask_of(layout, flags['name']))};")
        out.append("")
    for record in layout["record"]:
        out += struct_lines(record)
    out += ["// Kinds of sections. The values are the file's.", "enum class SectionKind : std::uint32_t {"]
    out += [f"  {section['kind']} = {section['value']}," for section in layout["section"]]
    out += [
        "};",
        f"inline constexpr std::size_t kSectionKinds = {len(layout['section'])};",
        f"inline constexpr std::uint32_t kLastKind = {layout['section'][-1]['value']};",
        "",
        "// Returns whether this format has sections of a kind.",
        "constexpr bool is_known(std::uint32_t kind) {",
        "  return kind >= 1 && kind <= kLastKind" + "".join(
            f" && kind != {kind['value']}" for kind in layout.get("reserved", []) if kind["value"] < layout["section"][-1]["value"]) + ";",
        "}",
        "// Returns the place of a kind in kSections and kTables. Expects: is_known().",
        "constexpr std::size_t place_of(std::uint32_t kind) {",
        "  return kind - 1" + "".join(
            f" - (kind > {kind['value']} ? 1 : 0)" for kind in layout.get("reserved", []) if kind["value"] < layout["section"][-1]["value"]) + ";",
        "}",
        "",
        "struct SectionInfo {",
        "  SectionKind kind;",
        "  const char* name;",
        "  std::uint32_t stride;        // bytes of an element",
        "  std::uint32_t first_stride;  // the same in the first format that had the kind",
        "  std::uint32_t alignment;     // of an element, bytes",
        "  bool table;                  // records, which later formats may make longer",
        "  bool optional;               // may be absent",
        "};",
        "",
        "// Every kind of this format, in the order in which the writer stores them.",
        "inline constexpr SectionInfo kSections[kSectionKinds] = {",
    ]
    out += [section_line(section, records) for section in layout["section"]]
    reserved = layout.get("reserved", [])
    out += ["};", ""] + pan_tables.info_lines(layout, ARRAY_ELEMENTS) + [
        "// Kind of a later format, which readers may ignore.",
        "struct ReservedKind {",
        "  std::uint32_t value;",
        "  const char* name;",
        "};",
        "",
        f"inline constexpr std::array<ReservedKind, {len(reserved)}> kReservedKinds{{{{",
    ]
    out += [f"    {{{kind['value']}, \"{kind['kind']}\"}}," for kind in reserved]
    out += [
        "}};",
        "",
        "enum class FieldType { " + ", ".join(SIZES) + " };",
        "enum class FieldRuleKind { any, " + ", ".join(sorted(RULES)) + " };",
        "",
        "// Field of the records of a section, and its rule.",
        "struct FieldRule {",
        "  SectionKind section;",
        "  const char* name;",
        "  std::uint32_t offset;  // bytes from the record's beginning",
        "  FieldType type;",
        "  std::uint32_t count;",
        "  FieldRuleKind kind;",
        "  SectionKind target;  // of references; string_offsets for strings",
        "  std::uint32_t low;   // of ranges",
        "  std::uint32_t high;  // of ranges; the allowed bits of masks",
        "  const char* at;      // of references: the words before one in a difference",
        "  const char* const* names;  // of the values of an enumeration; or null",
        "};",
        "",
        "inline constexpr FieldRule kFieldRules[] = {",
    ]
    for section in layout["section"]:
        for field in records.get(section["element"], {"field": []})["field"]:
            out.append(rule_line(section, field, layout))
    defaults = default_lines(layout, records)
    features = feature_lines(layout)
    out += [
        "};",
        "",
        "// A required feature and the minor version that added it.",
        "struct FeatureInfo {",
        "  std::uint64_t bit;",
        "  std::uint16_t minor;",
        "  const char* name;",
        "};",
        "",
        f"inline constexpr std::array<FeatureInfo, {len(features)}> kRequiredFeatures{{{{",
    ]
    out += features
    out += [
        "}};",
        "",
        "// Default of a field missing in the shorter records of a file; exact.",
        "struct FieldDefault {",
        "  SectionKind section;",
        "  std::uint32_t offset;  // bytes from the record's beginning",
        "  FieldType type;",
        "  std::uint32_t count;",
        "  double value;",
        "};",
        "",
        f"inline constexpr std::array<FieldDefault, {len(defaults)}> kFieldDefaults{{{{",
    ]
    out += defaults
    out += ["}};", "", "}  // namespace panwright::pan::layout", ""]
    return "\n".join(out)


def rule_words(field):
    kind, argument = rule_parts(field)
    if "enum" in field:
        return f"a value of {field['enum']}"
    if kind == "range" and argument.endswith("4294967295"):
        return f"at least {argument.split('..', maxsplit=1)[0]}"
    return {
        "": "",
        "finite": "finite",
        "not_negative": "finite, >= 0",
        "nonzero": "finite, not 0",
        "unit": "of unit length, to 1e-12 in its square",
        "zero": "0",
        "reference": f"below the count of `{argument}`",
        "reference_or_none": f"-1, or below the count of `{argument}`",
        "range": argument.replace("..", " to "),
        "mask": f"no bits but those of {argument}",
    }[kind]


def record_table(record):
    sizes = [f"{size_in(record, field['since'])} in 1.{field['since']}" for field in record["field"] if field["since"]]
    was = f" ({record['first_size']} in 1.0, {', '.join(sorted(set(sizes)))})" if sizes else ""
    lines = [f"### {record['name']}, {record['size']} bytes{was}", "", record["doc"], ""]
    lines += ["| offset | field | type | unit | meaning | must be |", "|---:|---|---|---|---|---|"]
    for field in record["field"]:
        kind = field["type"] + (f"[{field['count']}]" if field["count"] > 1 else "")
        doc = field["doc"]
        if field["since"]:
            doc += f" (since 1.{field['since']}; where a record is too short for it: {field['default']})"
        lines.append(f"| {field['offset']} | `{field['name']}` | {kind} | {field.get('unit', '')} "
                     f"| {doc} | {rule_words(field)} |")
    return lines + [""]


def docs_text(layout):
    text = (ROOT / "schemas" / "pan_format_intro.md").read_text(encoding="utf-8")
    records = {record["name"]: record for record in layout["record"]}
    lines = ["<!-- Generated by schemas/generate_pan.py from schemas/pan_layout.toml and schemas/pan_format_intro.md. "
             "Do not edit. -->", "", text.rstrip(), "", "## Records", ""]
    for record in layout["record"]:
        lines += record_table(record)
    lines += layout["material_docs"]
    lines += ["## Sections", "", "In the order in which the writer stores them; a reader accepts any order.", "",
              "| kind | name | element | bytes each | must be there | content | also holds |",
              "|---:|---|---|---:|---|---|---|"]
    for section in layout["section"]:
        needed = "no" if section.get("optional") else "yes"
        lines.append(f"| {section['value']} | `{section['kind']}` | {section['element']} "
                     f"| {element_size(section, records)} | {needed} | {section['doc']} | {section.get('also', '')} |")
    lines += ["", "**Reserved kinds**, which a later 1.x will define. Its writers mark such a section as one that readers may ignore "
              "where the model can be shown without it.", ""]
    lines += [f"* {kind['value']} `{kind['kind']}`: {kind['doc']}" for kind in layout.get("reserved", [])]
    lines += ["", "## Enumerations and flags", ""]
    for enum in layout["enum"]:
        lines += [f"**{enum['name']}**. {enum['doc']}", ""]
        lines += [f"* {index} `{value['name']}`: {value['doc']}" for index, value in enumerate(enum["values"])] + [""]
    for flags in layout["flags"]:
        lines += [f"**{flags['name']}**. {flags['doc']}", ""]
        lines += [f"* bit {index} `{bit['name']}`: {bit['doc']}" + (f" (since 1.{bit['since']})" if "since" in bit else "")
                  for index, bit in enumerate(flags["bits"])] + [""]
    lines += ["## Constants", "", "| name | value | meaning |", "|---|---:|---|"]
    lines += [f"| `{constant['name']}` | {constant['value']} | {constant['doc']} |" for constant in layout["constant"]]
    return "\n".join(lines) + "\n"


def load_layout():
    """The layout as the tables have it, not validated."""
    with open(ROOT / "schemas" / "pan_layout.toml", "rb") as file:
        layout = tomllib.load(file)
    add_materials(layout)
    return layout


def grow(layout, path):
    """Adds the fields of a table of growth to the ends of their records."""
    growth = tomllib.loads(path.read_text(encoding="utf-8"))
    layout["format"]["minor"] = growth["minor"]
    records = {record["name"]: record for record in layout["record"]}
    for name, fields in growth["record"].items():
        records[name]["field"] += fields
        records[name]["size"] += sum(SIZES[field["type"]] * field.get("count", 1) for field in fields)


def make():
    layout = load_layout()
    validate(layout)
    return {"schemas/generated/pan_layout.h": header_text(layout), "docs/pan-format.md": docs_text(layout),
            "pan/generated/tables.h": pan_tables.header_text(layout, ARRAY_ELEMENTS, wrapped),
            "pan/generated/table_records.cpp": pan_tables.source_text(layout, ARRAY_ELEMENTS)}


def write_later(growth, path):
    """The header of a format that has grown."""
    layout = load_layout()
    grow(layout, pathlib.Path(growth))
    validate(layout)
    pathlib.Path(path).write_text(header_text(layout), encoding="utf-8", newline="\n")


if __name__ == "__main__":
    if len(sys.argv) == 4 and sys.argv[1] == "--later":
        sys.exit(write_later(*sys.argv[2:]))
    sys.exit(generated_files.run("generate_pan.py", sys.argv[1:], make, (LayoutError, material_schema.SchemaError),
                                 "pan_layout.toml"))
