#!/usr/bin/env python3
"""Makes the reader tables, the XSD and the reference page of the pxn language from schemas/pxn.toml.

generate.py            writes schemas/generated/pxn_schema.h, schemas/pxn.xsd, docs/pxn-reference.md
generate.py --check    fails, and names the file, when one of them differs from what it would write
"""

import copy
import pathlib
import sys
import tomllib
from xml.sax.saxutils import escape, quoteattr

ROOT = pathlib.Path(__file__).resolve().parent.parent
NUMBER_KINDS = {"real", "integer"}
VALUE_KINDS = NUMBER_KINDS | {"word", "version", "path", "label", "quantity"}
DIMENSIONS = {"none", "length", "angle", "ratio", "pixels"}
RULE_KINDS = {"exclusive", "one_of", "any_of", "together", "requires"}
ELEMENT_KEYS = {"id", "name", "section", "level", "supported", "in", "doc", "notes", "example", "default", "text",
                "attribute", "attributes", "child", "rule"}
VALUE_KEYS = {"kind", "count", "names", "numbers", "min", "max", "above", "nonzero", "dimension", "bare", "one", "tuple",
              "least", "words", "name", "level", "supported", "required", "default", "doc"}
LARGEST = 1.7976931348623157e308


class SchemaError(Exception):
    """The schema contradicts itself."""


def need(condition, where, what):
    if not condition:
        raise SchemaError(f"{where}: {what}")


# ---- reading: defaults are filled in, references resolved, contradictions refused


def complete_value(value, where):
    """Gives a value all its keys; `numbers` becomes one entry for each number, or one for all."""
    unknown = set(value) - VALUE_KEYS
    need(not unknown, where, f"unknown keys {sorted(unknown)}")
    need(value.get("kind") in VALUE_KINDS, where, f"kind is {value.get('kind')}")
    value.setdefault("count", 1)
    value.setdefault("dimension", "none")
    value.setdefault("bare", "")
    value.setdefault("one", False)
    value.setdefault("tuple", 1)
    value.setdefault("least", 0)
    need(value["dimension"] in DIMENSIONS, where, f"dimension is {value['dimension']}")
    need(value["bare"] in ("", "rad"), where, f"bare is {value['bare']}")
    value.setdefault("words", [])
    need(bool(value["words"]) == (value["kind"] == "word"), where, "words belong to kind = \"word\"")
    if value["kind"] not in NUMBER_KINDS:
        value["numbers"] = []
        value["names"] = []
        return
    one = {key: value[key] for key in ("min", "max", "above", "nonzero") if key in value}
    numbers = value.get("numbers") or [dict(one, name=value.get("names", [value.get("name", "")])[0])]
    for number in numbers:
        number.setdefault("min", -LARGEST)
        number.setdefault("max", LARGEST)
        number.setdefault("above", False)
        number.setdefault("nonzero", False)
        need(number["min"] <= number["max"], where, "min is above max")
    need(len(numbers) in (1, value["count"]), where, "one number for all, or one for each")
    value["numbers"] = numbers
    if "names" not in value:
        value["names"] = [number["name"] for number in numbers]
    need(value["count"] == 0 or len(value["names"]) == value["count"], where, "one name for each number")


def complete_child(child, element, language):
    where = f"{element['id']}.child"
    child.setdefault("min", 0)
    child.setdefault("max", 1)
    child.setdefault("hint", "")
    need(("of" in child) != ("class" in child), where, "either of or class")
    child["label"] = child.get("class", "")
    if "class" in child:
        child["of"] = [other["id"] for other in language["element"] if child["class"] in other.get("in", [])]
    need(child["of"], where, "nothing may stand here")
    need(child["max"] == 0 or child["min"] <= child["max"], where, "min is above max")
    for name in child["of"]:
        need(name in language["by_id"], where, f"no element is called {name}")


def complete_rule(rule, element, language):
    where = f"{element['id']}.rule"
    need(rule["kind"] in RULE_KINDS, where, f"kind is {rule['kind']}")
    names = {language["by_id"][name]["name"] for child in element["child"] for name in child["of"]}
    names |= {"@" + attribute["name"] for attribute in element["attribute"]}
    for member in rule["members"]:
        need(member in names, where, f"{member} is neither a child nor an @attribute")


def complete(language):
    """Fills in every default and checks every reference."""
    elements = language["element"]
    language["by_id"] = {element["id"]: element for element in elements}
    need(len(language["by_id"]) == len(elements), "pxn.toml", "an id is used twice")
    classes = {entry["name"] for entry in language["class"]}
    groups = {group["name"]: group for group in language.get("attribute_group", [])}
    for element in elements:
        where = element["id"]
        for name in element.get("attributes", []):
            need(name in groups, where, f"no attribute group is called {name}")
            element.setdefault("attribute", []).extend(copy.deepcopy(groups[name]["attribute"]))
            element.setdefault("rule", []).extend(copy.deepcopy(groups[name].get("rule", [])))
        unknown = set(element) - ELEMENT_KEYS
        need(not unknown, where, f"unknown keys {sorted(unknown)}")
        element.setdefault("name", where)
        element.setdefault("level", 0)
        element.setdefault("supported", True)
        for key in ("attribute", "child", "rule", "in"):
            element.setdefault(key, [])
        need(set(element["in"]) <= classes, where, "in names no class")
        need(element.get("doc"), where, "a doc string is missing")
        if "text" in element:
            complete_value(element["text"], where)
            need(not element["child"], where, "holds both text and children")
        for attribute in element["attribute"]:
            complete_value(attribute, f"{where}.{attribute['name']}")
            need(attribute.get("doc"), f"{where}.{attribute['name']}", "a doc string is missing")
            attribute.setdefault("level", element["level"])
            attribute.setdefault("supported", True)
            attribute.setdefault("required", False)
    for element in elements:
        for child in element["child"]:
            complete_child(child, element, language)
        tags = [(language["by_id"][name]["name"], language["by_id"][name]["level"])
                for child in element["child"] for name in child["of"]]
        need(len(set(tags)) == len(tags), element["id"], "two children have the same tag and level")
        for rule in element["rule"]:
            complete_rule(rule, element, language)
    need(language["language"]["root"] in language["by_id"], "language", "the root does not exist")


# ---- the reader tables


def number_text(value):
    if value == LARGEST:
        return "1.7976931348623157e308"
    if value == -LARGEST:
        return "-1.7976931348623157e308"
    return repr(value)


def quoted(text):
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def flag(value):
    return "true" if value else "false"


class Tables:
    """Collects the constexpr arrays; equal arrays are written once."""

    def __init__(self):
        self.lines = []
        self.known = {}

    def array(self, kind, name, items):
        if not items:
            return "{}"
        key = (kind, tuple(items))
        if key not in self.known:
            self.known[key] = name
            self.lines.append(f"inline constexpr {kind} {name}[] = {{")
            self.lines += [f"    {item}," for item in items]
            self.lines.append("};")
        return self.known[key]

    def value(self, value, name):
        if value is None:
            return "{}"
        numbers = value["numbers"]
        if len(numbers) == 1:
            numbers = [dict(numbers[0], name=each) for each in value["names"]]
        numbers = [f"{{{quoted(number['name'])}, {number_text(number['min'])}, {number_text(number['max'])}, "
                   f"{flag(number['above'])}, {flag(number['nonzero'])}}}" for number in numbers]
        numbers = self.array("Number", f"kNumbers_{name}", numbers)
        words = self.array("std::string_view", f"kWords_{name}", [quoted(word) for word in value["words"]])
        return (f"{{ValueKind::{value['kind']}, {value['count']}, {numbers}, {words}, Dimension::{value['dimension']}, "
                f"{flag(value['bare'] == 'rad')}, {flag(value['one'])}, {value['tuple']}, {value['least']}}}")


def element_line(element, tables):
    name = element["id"]
    attributes = []
    for attribute in element["attribute"]:
        value = tables.value(attribute, f"{name}_{attribute['name']}")
        attributes.append(f"{{{quoted(attribute['name'])}, {attribute['level']}, {flag(attribute['supported'])}, "
                          f"{flag(attribute['required'])}, {value}}}")
    slots = []
    for index, child in enumerate(element["child"]):
        ids = tables.array("ElementId", f"kChoice_{name}_{index}", [f"ElementId::{other}" for other in child["of"]])
        slots.append(f"{{{ids}, {quoted(child['label'])}, {child['min']}, {child['max']}, {quoted(child['hint'])}}}")
    rules = []
    for index, rule in enumerate(element["rule"]):
        members = tables.array("std::string_view", f"kMembers_{name}_{index}",
                               [quoted(member) for member in rule["members"]])
        rules.append(f"{{RuleKind::{rule['kind']}, {members}}}")
    return (f"{{{quoted(element['name'])}, {element['level']}, {flag(element['supported'])},\n"
            f"     {tables.value(element.get('text'), name)},\n"
            f"     {tables.array('Attribute', f'kAttributes_{name}', attributes)}, "
            f"{tables.array('Slot', f'kSlots_{name}', slots)}, "
            f"{tables.array('Rule', f'kRules_{name}', rules)}}}")


HEADER = '''// Generated by schemas/generate.py from schemas/pxn.toml. Do not edit.
//
// The pxn language as tables: what may stand where, and what values are. docs/pxn-reference.md
// says what it means. Plain data; a reader takes a Language and knows no name by itself.
// clang-format off
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace panwright::schemas {

enum class ElementId : std::uint16_t {
@ids@
};
// not an element: unknown, refused, or left out
inline constexpr ElementId kNoElement = static_cast<ElementId>(0xffff);

enum class ValueKind : std::uint8_t { none, real, integer, word, version, path, label, quantity };

enum class Dimension : std::uint8_t { none, length, angle, ratio, pixels };

struct Number {
  std::string_view name;
  double min;
  double max;
  bool above;    // min itself is not allowed
  bool nonzero;
};

// A value between tags or in an attribute.
struct Value {
  ValueKind kind = ValueKind::none;
  std::uint32_t count = 0;                   // of numbers; 0: any
  std::span<const Number> numbers;           // one for each; one for all where count is 0
  std::span<const std::string_view> words;
  Dimension dimension = Dimension::none;     // numbers are in metres, radians, 1, pixels
  bool bare_radians = false;                 // bare angles are radians, whatever the root says
  bool one = false;                          // one number stands for all
  std::uint32_t tuple = 1;                   // a list holds a multiple of so many
  std::uint32_t least = 0;                   // tuples of a list
};

struct Attribute {
  std::string_view name;
  std::uint8_t level;
  bool supported;
  bool required;
  Value value;
};

// A place for children: any of some elements, min to max of them together.
struct Slot {
  std::span<const ElementId> elements;
  std::string_view label;                    // name of the class, or empty
  std::uint32_t min;
  std::uint32_t max;                         // 0: any number
  std::string_view hint;                     // what to do about too many
};

enum class RuleKind : std::uint8_t { exclusive, one_of, any_of, together, requires_others };

// Members are names of children, or @names of attributes.
struct Rule {
  RuleKind kind;
  std::span<const std::string_view> members;
};

struct Element {
  std::string_view name;
  std::uint8_t level;
  bool supported;
  Value text;
  std::span<const Attribute> attributes;
  std::span<const Slot> slots;
  std::span<const Rule> rules;
};

struct Language {
  std::span<const Element> elements;         // by ElementId
  ElementId root;
  std::span<const std::string_view> versions;  // the index is the level
};

// Indices of attributes in their element.
namespace attribute {
@attributes@
}  // namespace attribute

namespace tables {
@tables@
inline constexpr Element kElements[] = {
@elements@
};
inline constexpr std::string_view kVersions[] = {@versions@};
}  // namespace tables

inline constexpr Language kPxn = {tables::kElements, ElementId::@root@, tables::kVersions};

}  // namespace panwright::schemas
'''


def header_text(language):
    tables = Tables()
    elements = [element_line(element, tables) for element in language["element"]]
    attributes = [f"inline constexpr std::size_t {element['id']}_{attribute['name']} = {index};"
                  for element in language["element"] for index, attribute in enumerate(element["attribute"])]
    ids = [f"  {element['id']}," for element in language["element"]]
    top = language["language"]
    text = HEADER
    for key, value in {
            "@ids@": "\n".join(ids),
            "@attributes@": "\n".join(attributes),
            "@tables@": "\n".join(tables.lines).replace("RuleKind::requires,", "RuleKind::requires_others,"),
            "@elements@": "\n".join(f"    {line}," for line in elements),
            "@versions@": ", ".join(quoted(version) for version in top["versions"]),
            "@root@": top["root"],
    }.items():
        text = text.replace(key, value)
    return text


# ---- the XSD


def xsd_number(kind, number):
    """A simple type of one number in its range."""
    base = "integer" if kind == "integer" else "real"
    low = "minExclusive" if number["above"] else "minInclusive"
    facets = ""
    if number["min"] != -LARGEST:
        facets += f'<xs:{low} value="{number_text(number["min"])}"/>'
    if number["max"] != LARGEST:
        facets += f'<xs:maxInclusive value="{number_text(number["max"])}"/>'
    return f'<xs:simpleType><xs:restriction base="{base}">{facets}</xs:restriction></xs:simpleType>'


def xsd_value(value, language):
    """A simple type for a value. Lists take the widest range of their numbers."""
    kind = value["kind"]
    if kind == "word" or kind == "version":
        words = value["words"] or language["language"]["versions"]
        facets = "".join(f"<xs:enumeration value={quoteattr(word)}/>" for word in words)
        return f'<xs:simpleType><xs:restriction base="xs:string">{facets}</xs:restriction></xs:simpleType>'
    if kind not in NUMBER_KINDS:
        return ('<xs:simpleType><xs:restriction base="xs:string"><xs:minLength value="1"/></xs:restriction>'
                '</xs:simpleType>')
    numbers = value["numbers"]
    widest = dict(numbers[0], min=min(number["min"] for number in numbers),
                  max=max(number["max"] for number in numbers), above=all(number["above"] for number in numbers))
    one = xsd_number(kind, widest)
    if value["count"] == 1:
        return one
    length = f'<xs:length value="{value["count"]}"/>' if value["count"] else ""
    return (f'<xs:simpleType><xs:restriction><xs:simpleType><xs:list>{one}</xs:list></xs:simpleType>{length}'
            f'</xs:restriction></xs:simpleType>')


def xsd_element(name, language, low, high):
    bounds = f' minOccurs="{low}"' if low != 1 else ""
    bounds += f' maxOccurs="{"unbounded" if high == 0 else high}"' if high != 1 else ""
    return f'<xs:element name="{language["by_id"][name]["name"]}" type="t_{name}"{bounds}/>'


def xsd_children(element, language):
    """xs:all where each child stands once at most; else a choice, which leaves the order free too."""
    slots = element["child"]
    if not slots:
        return []
    if all(slot["max"] == 1 and len(slot["of"]) == 1 for slot in slots):
        inner = [xsd_element(slot["of"][0], language, slot["min"], 1) for slot in slots]
        return ["<xs:all>"] + ["  " + line for line in inner] + ["</xs:all>"]
    if len(slots) == 1:
        low, high = slots[0]["min"], slots[0]["max"]
    else:
        low, high = 0, 0
    inner = [xsd_element(name, language, 1, 1) for slot in slots for name in slot["of"]]
    upper = "unbounded" if high == 0 else high
    return [f'<xs:choice minOccurs="{low}" maxOccurs="{upper}">'] + ["  " + line for line in inner] + ["</xs:choice>"]


def xsd_attribute(attribute, language):
    use = ' use="required"' if attribute["required"] else ""
    return f'<xs:attribute name="{attribute["name"]}"{use}>{xsd_value(attribute, language)}</xs:attribute>'


def xsd_type(element, language):
    attributes = [xsd_attribute(attribute, language) for attribute in element["attribute"]]
    lines = [f'<xs:complexType name="t_{element["id"]}">',
             f'  <xs:annotation><xs:documentation>{escape(element["doc"])}</xs:documentation></xs:annotation>']
    if "text" in element:
        lines += ["  <xs:simpleContent>", f'    <xs:extension base="v_{element["id"]}">']
        lines += ["      " + line for line in attributes]
        lines += ["    </xs:extension>", "  </xs:simpleContent>"]
    else:
        lines += ["  " + line for line in xsd_children(element, language) + attributes]
    return lines + ["</xs:complexType>"]


def xsd_text(language):
    lines = ['<?xml version="1.0" encoding="UTF-8"?>',
             "<!-- Generated by schemas/generate.py from schemas/pxn.toml. Do not edit. -->",
             '<xs:schema xmlns:xs="http://www.w3.org/2001/XMLSchema">']
    root = language["language"]["root"]
    body = [f'<xs:element name="{language["by_id"][root]["name"]}" type="t_{root}"/>',
            '<xs:simpleType name="real"><xs:restriction base="xs:double">'
            r'<xs:pattern value="[+\-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+\-]?[0-9]+)?"/>'
            '</xs:restriction></xs:simpleType>',
            '<xs:simpleType name="integer"><xs:restriction base="xs:integer"/></xs:simpleType>']
    for element in language["element"]:
        if "text" in element:
            body.append(xsd_value(element["text"], language).replace(
                "<xs:simpleType>", f'<xs:simpleType name="v_{element["id"]}">', 1))
    for element in language["element"]:
        body += xsd_type(element, language)
    return "\n".join(lines + ["  " + line for line in body] + ["</xs:schema>"]) + "\n"


# ---- the reference page


def readable(value):
    if isinstance(value, float) and value == int(value) and abs(value) < 1e6:
        value = int(value)
    mantissa, e, exponent = (f"{value:g}" if isinstance(value, float) else str(value)).partition("e")
    return (mantissa + e + (str(int(exponent)) if e else "")).replace("-", "−")


def range_words(number):
    low, high = number["min"], number["max"]
    words = ""
    if low == high:
        words = readable(low)
    elif low == -high and high != LARGEST:
        words = f"±{readable(high)}"
    elif low != -LARGEST and high != LARGEST:
        words = f"{'above ' if number['above'] else ''}{readable(low)} … {readable(high)}"
    elif low != -LARGEST:
        words = f"{'above' if number['above'] else 'at least'} {readable(low)}"
    return words + (", not 0" if number["nonzero"] else "")


def type_words(value, language):
    kind = value["kind"]
    if kind == "version":
        return " or ".join(f"`{version}`" for version in language["language"]["versions"])
    if kind == "word":
        return " or ".join(f"`{word}`" for word in value["words"])
    if kind in ("path", "label", "quantity"):
        return {"path": "a path", "label": "a name", "quantity": "a number with a unit"}[kind]
    noun = "whole number" if kind == "integer" else "number"
    if value["count"] == 0:
        return f"{noun}s"
    return f"a {noun}" if value["count"] == 1 else f"{value['count']} {noun}s"


def unit_words(value):
    words = {"none": "", "length": ", a length", "angle": ", an angle", "ratio": ", a ratio", "pixels": ", in pixels"}
    return words[value["dimension"]] + (" (bare numbers: radians)" if value["bare"] else "")


def text_lines(element, language):
    value = element["text"]
    kind = type_words(value, language)
    names = " ".join(value["names"]) if value["count"] and len(value["numbers"]) == 1 else ""
    line = f"Content: {kind}" + (f" `{names}`" if names and value["count"] > 1 else "")
    if len(value["numbers"]) == 1:
        limits = range_words(value["numbers"][0])
        line += f", {limits}" if limits else ""
        line += unit_words(value)
        lines = [line + "."]
    else:
        lines = [line + ":", ""]
        lines += [f"* {number['name']} ({range_words(number)})" for number in value["numbers"]]
    if element.get("default"):
        lines += ["", f"Default: {element['default']}."]
    return lines + [""]


def link(name, language):
    return f"[`{language['by_id'][name]['name']}`](#{anchor(language['by_id'][name], language)})"


def anchor(element, language):
    return title(element, language).replace("`", "").replace("(", "").replace(")", "").lower().replace(" ", "-")


def title(element, language):
    """The tag; where several elements share it, with the element that holds it."""
    same = [other for other in language["element"] if other["name"] == element["name"]]
    if len(same) == 1 or element["in"]:
        return f"`{element['name']}`"
    owners = [other["name"] for other in language["element"]
              if any(element["id"] in child["of"] for child in other["child"])]
    return f"`{element['name']}` in {' '.join(owners)}"


def child_lines(element, language):
    if not element["child"]:
        return []
    lines = ["| children | how many |", "|---|---|"]
    for child in element["child"]:
        names = f"any [node](#nodes)" if child["label"] else ", ".join(link(name, language) for name in child["of"])
        low, high = child["min"], child["max"]
        many = {(0, 1): "at most one", (1, 1): "exactly one", (0, 0): "any number", (1, 0): "one or more"}.get(
            (low, high), f"{low} to {high}")
        lines.append(f"| {names} | {many} |")
    return lines + [""]


RULE_WORDS = {
    "exclusive": "at most one of {}",
    "one_of": "exactly one of {}",
    "any_of": "at least one of {}",
    "together": "{}: all of them or none",
}


def rule_line(rule):
    names = [f"`{member.removeprefix('@')}`" for member in rule["members"]]
    if rule["kind"] == "requires":
        words = f"{names[0]} needs {', '.join(names[1:])}"
    else:
        words = RULE_WORDS[rule["kind"]].format(", ".join(names))
    return f"* {rule['doc']} Rule: {words}."


def element_lines(element, language):
    lines = [f"### {title(element, language)}", "", element["doc"]]
    if not element["supported"]:
        lines += ["", "*Not supported yet: recognised, reported (E1106) and left out.*"]
    lines += [""]
    if "text" in element:
        lines += text_lines(element, language)
    if element["attribute"]:
        lines += ["| attribute | value | must be there | meaning |", "|---|---|---|---|"]
        for attribute in element["attribute"]:
            limits = range_words(attribute["numbers"][0]) if attribute["numbers"] else ""
            value = type_words(attribute, language) + (f", {limits}" if limits else "")
            value += unit_words(attribute)
            must = "yes" if attribute["required"] else "no"
            lines.append(f"| `{attribute['name']}` | {value} | {must} | {attribute['doc']} |")
        lines += [""]
    lines += child_lines(element, language)
    lines += [rule_line(rule) for rule in element["rule"]] + ([""] if element["rule"] else [])
    if element.get("notes"):
        lines += [element["notes"].strip(), ""]
    if element.get("example"):
        lines += ["```xml", element["example"].strip(), "```", ""]
    return lines


def docs_text(language):
    text = (ROOT / "schemas" / "pxn_reference_intro.md").read_text(encoding="utf-8")
    lines = ["<!-- Generated by schemas/generate.py from schemas/pxn.toml and schemas/pxn_reference_intro.md. Do not "
             "edit. -->", "", text.rstrip(), ""]
    sections = list(dict.fromkeys(element["section"] for element in language["element"]))
    lines += ["## All elements", "", "| | |", "|---|---|"]
    for section in sections:
        names = [f"[{title(element, language)}](#{anchor(element, language)})" for element in language["element"]
                 if element["section"] == section]
        lines.append(f"| {section} | {', '.join(names)} |")
    lines += ["", "## Nodes", ""]
    for entry in language["class"]:
        names = [link(element["id"], language) for element in language["element"] if entry["name"] in element["in"]]
        lines += [entry["doc"], "", ", ".join(names), ""]
    for section in sections:
        lines += [f"## {section}", ""]
        for element in language["element"]:
            if element["section"] == section:
                lines += element_lines(element, language)
    return "\n".join(lines).rstrip() + "\n"


def main(arguments):
    if arguments not in ([], ["--check"]):
        print("usage: generate.py [--check]", file=sys.stderr)
        return 2
    with open(ROOT / "schemas" / "pxn.toml", "rb") as file:
        language = tomllib.load(file)
    try:
        complete(language)
        texts = {"schemas/generated/pxn_schema.h": header_text(language), "schemas/pxn.xsd": xsd_text(language),
                 "docs/pxn-reference.md": docs_text(language)}
    except SchemaError as error:
        print(f"pxn.toml: {error}", file=sys.stderr)
        return 1
    stale = 0
    for name, text in texts.items():
        path = ROOT / name
        if arguments:
            if not path.exists() or path.read_text(encoding="utf-8") != text:
                print(f"{name} is not what schemas/generate.py makes: run it", file=sys.stderr)
                stale = 1
        else:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8", newline="\n")
    return stale


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
