"""The XSDs of the pxn language, one per level."""

import copy
from xml.sax.saxutils import escape, quoteattr

from pxn_language import LARGEST, number_text

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
        one = xsd_simple("real", "")
        plain = [one] if value["count"] else [f'<xs:simpleType><xs:list>{one}</xs:list></xs:simpleType>']
    else:
        plain = xsd_numbers(value, language["level"] > 0 and value["dimension"] != "none")
    members = plain + ([xsd_measured(value)] if language["level"] > 0 else [])
    if value["words"]:
        members.append(xsd_simple("xs:string", "".join(f"<xs:enumeration value={quoteattr(word)}/>"
                                                       for word in value["words"])))
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
