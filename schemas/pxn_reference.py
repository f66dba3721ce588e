"""The reference page of the pxn language."""

from generated_files import ROOT
from pxn_language import LARGEST, need


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
    if kind == "quantity" and value["count"] == 0:
        return "numbers with units"
    if kind in ("path", "label", "quantity"):
        return {"path": "a path", "label": "a name", "quantity": "a number with a unit"}[kind]
    noun = "whole number" if kind == "integer" else "number"
    if value["count"] == 0:
        return f"{noun}s" + (f", {value['tuple']} by {value['tuple']}" if value["tuple"] > 1 else "")
    numbers = f"a {noun}" if value["count"] == 1 else f"{value['count']} {noun}s"
    return " or ".join([numbers] + [f"`{word}`" for word in value["words"]])


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
    lines = ["| children | number of them |", "|---|---|"]
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
