#!/usr/bin/env python3
"""Makes the record of settings, the JSON schema, the type for Python and the page of views from schemas/views.toml.

generate_views.py          writes workspace/generated/, schemas/views.schema.json, python/panwright/_views.py and docs/views.md
generate_views.py --check  fails, and names the file, when one of them differs from what it would write
"""

import json
import sys
import tomllib

import generated_files
from generated_files import ROOT
from settings_cpp import TableError, forms_of, header_texts, options_of


def form_schema(option, form):
    numbers = {"type": "integer" if option["type"] in ("integer", "size") and form == "number" else "number"}
    for key, name in (("least", "minimum"), ("most", "maximum"), ("above", "exclusiveMinimum"), ("below", "exclusiveMaximum")):
        if key in option:
            numbers[name] = option[key]
    text = {"type": "string"}
    if "pattern" in option:
        text["pattern"] = option["pattern"]
    if option["type"] == "choice":
        text = {"enum": option["words"]}
    if form == "number":
        return numbers
    if form == "text":
        return text
    if form == "flag":
        return {"type": "boolean"}
    if form == "numbers":
        count = forms_of(option)[2]
        size = {"minItems": count, "maxItems": count} if count else {"minItems": 1}
        return {"type": "array", "items": {"type": "number"}, **size}
    if form == "texts":
        return {"type": "array", "items": text, "minItems": 1}
    return {"type": "object", "additionalProperties": one_of([form_schema(option, each) for each in forms_of(option)[1]])}


def one_of(schemas):
    return schemas[0] if len(schemas) == 1 else {"anyOf": schemas}


def schema_text(table):
    properties = {}
    for option in options_of(table):
        schema = {"description": option["doc"], **one_of([form_schema(option, form) for form in forms_of(option)[0]])}
        properties[option["name"]] = schema
        other = option["name"].replace("-", "_")
        if other != option["name"]:
            properties[other] = {"$ref": f"#/$defs/view/properties/{option['name']}"}
    schema = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Views of panwright render --views",
        "description": "A list of views, each one image. With --views - each line of standard input is one of them.",
        "type": "array",
        "minItems": 1,
        "items": {"$ref": "#/$defs/view"},
        "$defs": {
            "view": {
                "type": "object",
                "properties": properties,
                "additionalProperties": False,
                "oneOf": [{"required": ["output"]}, {"required": ["outputs"]}],
            }
        },
    }
    return json.dumps(schema, indent=2, ensure_ascii=False) + "\n"


def python_type(option, form):
    """The type of a member's form in Python."""
    if form == "text" and option["type"] == "choice":
        return f"Literal[{', '.join(json.dumps(word) for word in option['words'])}]"
    if form == "map":
        inner = dict.fromkeys(python_type(option, each) for each in forms_of(option)[1])
        return f"Mapping[str, {' | '.join(inner)}]"
    return {"number": "float", "text": "str", "flag": "bool", "numbers": "Sequence[float]", "texts": "Sequence[str]"}[form]


def python_text(table):
    lines = ['"""Members of a view. Made by schemas/generate_views.py from schemas/views.toml."""', "",
             "from __future__ import annotations", "", "from typing import Literal, Mapping, Sequence, TypedDict", "", "",
             "class View(TypedDict, total=False):", '    """One image: docs/views.md. Angles are degrees, lengths metres."""', ""]
    for option in options_of(table):
        if option["name"] in ("output", "outputs", "targets"):
            continue  # of files
        forms = dict.fromkeys(python_type(option, form) for form in forms_of(option)[0])
        lines.append(f"    {option['name'].replace('-', '_')}: {' | '.join(forms)}  # {option['doc']}")
    return "\n".join(lines) + "\n"


def docs_text(table):
    lines = []
    for group in table["group"]:
        lines += [f"### {group['title']}", "", "| member | value | meaning |", "|---|---|---|"]
        for option in group["option"]:
            example = option["example"].replace("|", "\\|")
            lines.append(f"| `{option['name']}` | `{example}` | {option['doc']} |")
        lines.append("")
    intro = (ROOT / "schemas" / "views_intro.md").read_text(encoding="utf-8")
    if intro.count("@members@") != 1:
        raise TableError("views_intro.md holds @members@ other than once")
    return intro.replace("@members@\n", "\n".join(lines).rstrip("\n") + "\n")


def make():
    with open(ROOT / "schemas" / "views.toml", "rb") as file:
        table = tomllib.load(file)
    record, rules = header_texts(table)
    return {"workspace/generated/settings.h": record, "workspace/generated/settings_table.h": rules,
            "schemas/views.schema.json": schema_text(table), "python/panwright/_views.py": python_text(table), "docs/views.md": docs_text(table)}


if __name__ == "__main__":
    sys.exit(generated_files.run("generate_views.py", sys.argv[1:], make, TableError, "views.toml"))
