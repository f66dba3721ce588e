#!/usr/bin/env python3
"""Makes the reader tables, the XSDs and the reference page of the pxn language from schemas/pxn.toml.

generate.py            writes schemas/generated/pxn_schema.h, schemas/pxn-0.xsd (level 0), schemas/pxn.xsd (level 1),
                       docs/pxn-reference.md
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
                "attribute", "attributes", "child", "rule", "grouped"}
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
            element.setdefault("grouped", {}).update({each["name"]: name for each in groups[name]["attribute"]})
            element.setdefault("rule", []).extend(copy.deepcopy(groups[name].get("rule", [])))
        unknown = set(element) - ELEMENT_KEYS
        need(not unknown, where, f"unknown keys {sorted(unknown)}")
        element.setdefault("name", where)
        element.setdefault("level", 0)
        element.setdefault("supported", True)
        for key in ("attribute", "child", "rule", "in"):
            element.setdefault(key, [])
        element.setdefault("grouped", {})
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


# ---- the XSDs, one for each level


NUMBER = r"[+\-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+\-]?[0-9]+)?"
BRACES = r"\{[^{}]*\}"
UNITS = {
    "none": "",
    "length": "km|m|cm|mm|um|µm|μm|nm|in|ft",
    "angle": "deg|rad|mrad|urad|µrad|μrad|arcmin|arcsec",
    "ratio": "%|ppm",
    "pixels": "px",
}


def at_level(language, level):
    """The language as files of one level have it: where two elements share a tag, the higher one."""
    out = copy.deepcopy(language)
    by_id = out["by_id"] = {element["id"]: element for element in out["element"]}
    for element in out["element"]:
        element["attribute"] = [each for each in element["attribute"] if each["level"] <= level]
        slots = [name for child in element["child"] for name in child["of"]]
        highest = {}
        for name in slots:
            if by_id[name]["level"] <= level:
                tag = by_id[name]["name"]
                if tag not in highest or by_id[name]["level"] > by_id[highest[tag]]["level"]:
                    highest[tag] = name
        for child in element["child"]:
            child["of"] = [name for name in child["of"] if name in highest.values()]
        element["child"] = [child for child in element["child"] if child["of"]]
    reached, waiting = set(), [out["language"]["root"]]
    while waiting:
        name = waiting.pop()
        if name not in reached:
            reached.add(name)
            waiting += [other for child in by_id[name]["child"] for other in child["of"]]
    out["element"] = [element for element in out["element"] if element["id"] in reached]
    out["level"] = level
    return out


def xsd_simple(base, facets):
    return f'<xs:simpleType><xs:restriction base="{base}">{facets}</xs:restriction></xs:simpleType>'


def xsd_number(kind, number, scaled):
    """A simple type of one number in its range; of a range in other units only the sign is known."""
    base = "integer" if kind == "integer" else "real"
    low = "minExclusive" if number["above"] else "minInclusive"
    facets = ""
    if number["min"] != -LARGEST and (not scaled or number["min"] == 0):
        facets += f'<xs:{low} value="{number_text(number["min"])}"/>'
    if number["max"] != LARGEST and not scaled:
        facets += f'<xs:maxInclusive value="{number_text(number["max"])}"/>'
    return xsd_simple(base, facets)


def xsd_numbers(value, scaled):
    """One number or a list, which takes the widest range of its numbers."""
    numbers = value["numbers"]
    widest = dict(numbers[0], min=min(number["min"] for number in numbers),
                  max=max(number["max"] for number in numbers), above=all(number["above"] for number in numbers))
    one = xsd_number(value["kind"], widest, scaled)
    if value["count"] == 1:
        return [one]
    if value["count"]:
        length = f'<xs:length value="{value["count"]}"/>'
    else:
        length = f'<xs:minLength value="{value["tuple"] * value["least"]}"/>' if value["least"] else ""
    many = (f'<xs:simpleType><xs:restriction><xs:simpleType><xs:list>{one}</xs:list></xs:simpleType>{length}'
            f'</xs:restriction></xs:simpleType>')
    return [one, many] if value["one"] else [many]


def xsd_measured(value):
    """Numbers of which one at least has a unit or is an expression in braces."""
    units = "|".join(filter(None, UNITS.values())) if value["kind"] == "quantity" else UNITS[value["dimension"]]
    number = r"[+\-]?[0-9]+" if value["kind"] == "integer" else NUMBER
    one = f"({number}" + (f"({units})?" if units else "") + f"|{BRACES})"
    count = value["count"]
    many = {0: r"(\s+" + one + ")*", 1: ""}.get(count, r"(\s+" + one + f"){{{count - 1}}}")
    if value["one"]:
        many = f"({many})?"
    marked = BRACES + (f"|[0-9.]({units})" if units else "")
    numbers = quoteattr(r"\s*" + one + many + r"\s*")
    anywhere = quoteattr(r"[\s\S]*(" + marked + r")[\s\S]*")
    first = xsd_simple("xs:string", f"<xs:pattern value={numbers}/>")
    return (f"<xs:simpleType><xs:restriction>{first}<xs:pattern value={anywhere}/></xs:restriction>"
            "</xs:simpleType>")


def xsd_value(value, language):
    """A simple type for a value."""
    kind = value["kind"]
    if kind in ("word", "version"):
        words = value["words"] or [language["language"]["versions"][language["level"]]]
        return xsd_simple("xs:string", "".join(f"<xs:enumeration value={quoteattr(word)}/>" for word in words))
    if kind in ("path", "label"):
        return xsd_simple("xs:string", '<xs:minLength value="1"/>')
    if kind == "quantity":
        plain = [xsd_simple("real", "")]
    else:
        plain = xsd_numbers(value, language["level"] > 0 and value["dimension"] != "none")
    members = plain + ([xsd_measured(value)] if language["level"] > 0 else [])
    return members[0] if len(members) == 1 else f'<xs:simpleType><xs:union>{"".join(members)}</xs:union></xs:simpleType>'


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
    if not element["supported"] and not attributes and not element["child"] and "text" not in element:
        # nothing is said about what it holds
        lines += ['  <xs:sequence><xs:any minOccurs="0" maxOccurs="unbounded" processContents="skip"/></xs:sequence>',
                  '  <xs:anyAttribute processContents="skip"/>']
    elif "text" in element:
        lines += ["  <xs:simpleContent>", f'    <xs:extension base="v_{element["id"]}">']
        lines += ["      " + line for line in attributes]
        lines += ["    </xs:extension>", "  </xs:simpleContent>"]
    else:
        lines += ["  " + line for line in xsd_children(element, language) + attributes]
    return lines + ["</xs:complexType>"]


def xsd_text(whole, level):
    language = at_level(whole, level)
    lines = ['<?xml version="1.0" encoding="UTF-8"?>',
             "<!-- Generated by schemas/generate.py from schemas/pxn.toml. Do not edit. -->",
             '<xs:schema xmlns:xs="http://www.w3.org/2001/XMLSchema">']
    root = language["language"]["root"]
    body = [f'<xs:element name="{language["by_id"][root]["name"]}" type="t_{root}"/>',
            f'<xs:simpleType name="real"><xs:restriction base="xs:double"><xs:pattern value="{NUMBER}"/>'
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
        return f"{noun}s" + (f", {value['tuple']} by {value['tuple']}" if value["tuple"] > 1 else "")
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
    return slug(title(element, language))


def slug(heading):
    """What a heading is called in links, as GitHub and others do it."""
    return "".join(c for c in heading.lower() if c.isalnum() or c in " -_").replace(" ", "-")


def owners_of(element, language):
    return [other["name"] for other in language["element"]
            if any(element["id"] in child["of"] for child in other["child"])]


def title(element, language):
    """The tag; where several elements share it, with its level or the elements that hold it."""
    others = [other for other in language["element"] if other["name"] == element["name"] and other is not element]
    owners = owners_of(element, language)
    words = f"`{element['name']}`"
    # one of several in the same place is told by its level, one in a place of its own by that
    if any(set(owners) & set(owners_of(other, language)) and other["level"] < element["level"] for other in others):
        return f"{words} (level {element['level']})"
    apart = [other for other in others if not set(owners) & set(owners_of(other, language))]
    return f"{words} in {' '.join(dict.fromkeys(owners))}" if apart and not element["in"] else words


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


ATTRIBUTE_TABLE = ["| attribute | value | must be there | meaning |", "|---|---|---|---|"]

# groups of attributes that are explained once, for all elements that have them
GROUPS = {
    "placement": "Placement attributes",
    "named": "Node attributes",
    "covered": "Material attribute",
    "shape": "Shape attributes",
}


def attribute_line(attribute, language, level):
    limits = range_words(attribute["numbers"][0]) if attribute["numbers"] else ""
    value = type_words(attribute, language) + (f", {limits}" if limits else "") + unit_words(attribute)
    if attribute["one"]:
        value += ", or one for all"
    must = "yes" if attribute["required"] else "no"
    meaning = attribute["doc"]
    if attribute.get("default"):
        meaning += f" Default: {attribute['default']}."
    if attribute["level"] > level:
        meaning = f"*Level {attribute['level']}.* {meaning}"
    if not attribute["supported"]:
        meaning += " *Not supported yet.*"
    return f"| `{attribute['name']}` | {value} | {must} | {meaning} |"


def attribute_lines(element, language):
    own = [each for each in element["attribute"] if element["grouped"].get(each["name"]) not in GROUPS]
    lines = []
    if own:
        lines += ATTRIBUTE_TABLE + [attribute_line(each, language, element["level"]) for each in own] + [""]
    groups = [name for name in dict.fromkeys(element["grouped"].values()) if name in GROUPS]
    if groups:
        level = max(each["level"] for each in element["attribute"] if element["grouped"].get(each["name"]) in groups)
        links = [f"[{GROUPS[name].lower()}](#{slug(GROUPS[name])})" for name in groups]
        links = " and ".join(filter(None, [", ".join(links[:-1]), links[-1]]))
        since = f" from level {level} on" if level > element["level"] else ""
        lines += [("Also" if own else "It takes") + f" the {links}{since}.", ""]
    return lines


def group_lines(language):
    """The attributes that many elements have."""
    lines = ["## Attributes of many elements", ""]
    for name, heading in GROUPS.items():
        holders = [element for element in language["element"] if name in element["grouped"].values()]
        if not holders:
            continue
        attributes = [each for each in holders[0]["attribute"] if holders[0]["grouped"].get(each["name"]) == name]
        lines += [f"### {heading}", "", *ATTRIBUTE_TABLE]
        lines += [attribute_line(each, language, each["level"]) for each in attributes]
        lines += ["", "Of " + ", ".join(link(element["id"], language) for element in holders) + ".", ""]
    return lines


def element_lines(element, language):
    lines = [f"### {title(element, language)}", ""]
    mark = f"*Level {element['level']}.* " if element["level"] > 0 else ""
    lines += [mark + element["doc"]]
    if not element["supported"]:
        lines += ["", "*Not supported yet: recognised, reported (E1106) and left out.*"]
    lines += [""]
    if "text" in element:
        lines += text_lines(element, language)
    lines += attribute_lines(element, language)
    lines += child_lines(element, language)
    lines += [rule_line(rule) for rule in element["rule"]] + ([""] if element["rule"] else [])
    if element.get("notes"):
        lines += [element["notes"].strip(), ""]
    if element.get("example"):
        lines += ["```xml", element["example"].strip(), "```", ""]
    return lines


# what a reader looks for first comes first; other sections follow
SECTIONS = ["Structure", "Definitions", "Placement", "Appearance", "Shapes"]


def by_section(language):
    """Sections with their elements; those that share a tag stand together."""
    names = list(dict.fromkeys(SECTIONS + [element["section"] for element in language["element"]]))
    out = {}
    for name in names:
        elements = [element for element in language["element"] if element["section"] == name]
        order = list(dict.fromkeys(element["name"] for element in elements))
        out[name] = sorted(elements, key=lambda element: order.index(element["name"]))
    return out


def docs_text(language):
    text = (ROOT / "schemas" / "pxn_reference_intro.md").read_text(encoding="utf-8")
    lines = ["<!-- Generated by schemas/generate.py from schemas/pxn.toml and schemas/pxn_reference_intro.md. Do not "
             "edit. -->", "", text.rstrip(), ""]
    sections = by_section(language)
    lines += ["## All elements", "", "| | |", "|---|---|"]
    for section, elements in sections.items():
        names = [f"[{title(element, language)}](#{anchor(element, language)})" for element in elements]
        lines.append(f"| {section} | {', '.join(names)} |")
    lines += ["", "## Nodes", ""]
    for entry in language["class"]:
        nodes = [element for element in language["element"] if entry["name"] in element["in"]]
        names = [f"[{title(element, language)}](#{anchor(element, language)})" for element in nodes]
        lines += [entry["doc"], "", ", ".join(names), ""]
    lines += group_lines(language)
    for section, elements in sections.items():
        lines += [f"## Elements: {section.lower()}", ""]
        for element in elements:
            lines += element_lines(element, language)
    headings = [slug(line.lstrip("# ")) for line in lines if line.startswith("#")]
    twice = {heading for heading in headings if headings.count(heading) > 1}
    need(not twice, "docs/pxn-reference.md", f"headings that stand twice: {sorted(twice)}")
    return "\n".join(lines).rstrip() + "\n"


def main(arguments):
    if arguments not in ([], ["--check"]):
        print("usage: generate.py [--check]", file=sys.stderr)
        return 2
    with open(ROOT / "schemas" / "pxn.toml", "rb") as file:
        language = tomllib.load(file)
    try:
        complete(language)
        texts = {"schemas/generated/pxn_schema.h": header_text(language), "schemas/pxn-0.xsd": xsd_text(language, 0),
                 "schemas/pxn.xsd": xsd_text(language, 1), "docs/pxn-reference.md": docs_text(language)}
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
