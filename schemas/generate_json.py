#!/usr/bin/env python3
"""Makes schemas/json/*.schema.json and docs/json-output.md from schemas/json_output.py.

generate_json.py            writes them
generate_json.py --check    fails, and names the file, when one of them differs from what it would write
"""

import json
import sys

import generate_pan
import generated_files
import json_output

INTRO = """# JSON output

Every command has `--json`: one object on standard output, whatever happens, and nothing else there. This page and the JSON schemas
(`schemas/json/COMMAND.schema.json`, installed as `share/panwright/schemas`) are made by `schemas/generate_json.py`; a test holds the
outputs of all commands against them.

**The promise.** `schema_id` is `panwright/COMMAND/VERSION`. Within a version members are never removed, renamed or given another type, unit or
meaning; new ones may come at any time, so readers ignore what they do not know. A change that breaks this raises the version of the command
that it concerns, is announced in `CHANGELOG.md`, and keeps nothing of the old version under its name. Texts (`message`, `hint`, `title`) are for people and may
change; `code` is for programs: one code, one meaning, never used again. Members are there whenever the exit code is 0, those with a `?` only where they apply; after an
error only those of every command are certain.

SARIF 2.1.0 of the diagnostics: `--sarif FILE`. The report of `panwright import --report FILE.json` is described in `docs/cleaning.md`.
"""


def type_of(name):
    if name.endswith("|null"):
        inner = type_of(name[: -len("|null")])
        if "type" in inner and isinstance(inner["type"], str):
            return inner | {"type": [inner["type"], "null"]}
        raise ValueError(name)
    if name.endswith("[]"):
        return {"type": "array", "items": type_of(name[:-2])}
    if name == "vec3":
        return {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3}
    if name == "any":
        return {}
    if name not in ("number", "integer", "string", "boolean", "object"):
        raise ValueError(name)
    return {"type": name}


def split(what):
    name, _, words = what.partition(": ")
    return name, words


def schema_of(what):
    if isinstance(what, str):
        name, words = split(what)
        return {"description": words} | type_of(name)
    words, inner = what
    if isinstance(inner, list):
        return {"description": words, "type": "array", "items": members(inner[0], required=True)}
    return {"description": words} | members(inner, required=True)


def members(fields, required):
    out = {"type": "object", "properties": {name.rstrip("?"): schema_of(what) for name, what in fields.items()}}
    always = [name for name in fields if not name.endswith("?")]
    if required and always:
        out["required"] = always
    return out


def command_schema(command, fields):
    common = members(json_output.COMMON, required=True)
    own = members(fields, required=False)
    properties = common["properties"] | own["properties"]
    properties["schema"] = properties["schema"] | {"const": 1}
    properties["schema_id"] = properties["schema_id"] | {"const": f"panwright/{command}/1"}
    properties["command"] = properties["command"] | {"const": command}
    schema = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": f"panwright/{command}/1",
        "title": f"panwright {command} --json",
        "type": "object",
        "properties": properties,
        "required": common["required"],
    }
    always = [name for name in fields if not name.endswith("?")]
    if always:
        schema["if"] = {"properties": {"exit_code": {"const": 0}}}
        if command in json_output.OTHER:
            schema["if"]["properties"][json_output.OTHER[command]] = {"const": False}
        schema["then"] = {"required": always}
    return json.dumps(schema, indent=1, ensure_ascii=False) + "\n"


def add_tables():
    """Members of info: the tables of a pan with `json` that are not listed by hand."""
    fields = json_output.COMMANDS["info"]
    for section in generate_pan.load_layout()["section"]:
        if "json" in section and section["kind"] not in fields:
            fields[section["kind"]] = f"object[]: {', '.join(section['json'])}: {section['doc'].rstrip('.')}"


def rows(fields, prefix=""):
    for name, what in fields.items():
        optional = "?" if name.endswith("?") else ""
        place = prefix + name.rstrip("?")
        if isinstance(what, str):
            kind, words = split(what)
            shown = kind.replace("|", " or ")
            yield f"| `{place}`{optional} | {shown} | {words} |"
            continue
        words, inner = what
        many = isinstance(inner, list)
        yield f"| `{place}`{optional} | {'list of objects' if many else 'object'} | {words} |"
        yield from rows(inner[0] if many else inner, place + ("[]." if many else "."))


def table(fields):
    return "| member | type | |\n|---|---|---|\n" + "\n".join(rows(fields)) + "\n"


def page():
    text = INTRO + "\n## Of every command\n\n" + table(json_output.COMMON)
    for command, fields in json_output.COMMANDS.items():
        text += f"\n## {command}\n\n" + table(fields)
    return text


def make():
    add_tables()
    files = {f"schemas/json/{command}.schema.json": command_schema(command, fields) for command, fields in json_output.COMMANDS.items()}
    return files | {"docs/json-output.md": page()}


if __name__ == "__main__":
    sys.exit(generated_files.run("generate_json.py", sys.argv[1:], make, (ValueError,), "schemas/json_output.py"))
