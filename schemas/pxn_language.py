"""The pxn language as schemas/pxn.toml has it: defaults filled in, references resolved, contradictions refused."""

import copy

NUMBER_KINDS = {"real", "integer"}
VALUE_KINDS = NUMBER_KINDS | {"word", "version", "path", "label", "quantity"}
DIMENSIONS = {"none", "length", "angle", "ratio", "pixels"}
RULE_KINDS = {"exclusive", "one_of", "any_of", "together", "requires"}
ELEMENT_KEYS = {"id", "name", "section", "level", "supported", "in", "doc", "notes", "example", "default", "text",
                "attribute", "attributes", "child", "rule", "grouped"}
VALUE_KEYS = {"kind", "count", "names", "numbers", "min", "max", "above", "nonzero", "dimension", "bare", "one", "tuple",
              "least", "words", "name", "level", "supported", "required", "default", "default_words", "default_in_units", "doc"}
LARGEST = 1.7976931348623157e308


class SchemaError(Exception):
    """The schema contradicts itself."""


def need(condition, where, what):
    if not condition:
        raise SchemaError(f"{where}: {what}")


def complete_default(value, where):
    """Splits a default into what readers of files take (`initial`, `initial_word`) and what people read."""
    default = value.get("default")
    value["initial"], value["initial_word"] = [], ""
    value.setdefault("default_in_units", False)
    if isinstance(default, (int, float, list)) and not isinstance(default, bool):
        value["initial"] = default if isinstance(default, list) else [default]
        need(len(value["initial"]) == value["count"], where, "one default for each number")
        words = " ".join(f"{number:g}" for number in value["initial"])
        value["default"] = value.get("default_words", words)
        need(not value["default_in_units"] or value["dimension"] != "none", where, "the default has no dimension")
    elif default is not None and value["kind"] == "word":
        need(default in value["words"], where, f"the default {default} is no word of it")
        value["initial_word"] = default
    elif default is not None and value["kind"] == "label":
        value["initial_word"] = default


def complete_value(value, where):
    """Gives a value all its keys; `numbers` becomes one entry for each number, or one for all."""
    unknown = set(value) - VALUE_KEYS - {"initial", "initial_word"}
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
    complete_default(value, where)
    need(bool(value["words"]) <= (value["kind"] in ("word", "real")), where, "words belong to words and numbers")
    need(value["words"] or value["kind"] != "word", where, "words are missing")
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
            # its own attribute of a name stands for the group's, in its place
            own = {each["name"]: each for each in element.setdefault("attribute", [])}
            shared = [own.get(each["name"]) or copy.deepcopy(each) for each in groups[name]["attribute"]]
            names = {each["name"] for each in shared}
            element["attribute"] = [each for each in element["attribute"] if each["name"] not in names] + shared
            element.setdefault("grouped", {}).update({each: name for each in names})
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


def number_text(value):
    if value == LARGEST:
        return "1.7976931348623157e308"
    if value == -LARGEST:
        return "-1.7976931348623157e308"
    return repr(value)
