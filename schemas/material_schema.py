"""The materials as schemas/material.toml has them: defaults filled in, references resolved, contradictions refused."""

import re
import tomllib

from generated_files import ROOT

WIDTHS = {"real": 1, "vec2": 2, "vec3": 3, "real8": 8, "texture": 1, "Compensation": 1}
SIZES = {"f32": 4, "u32": 4, "i32": 4}
PARAMETER_KEYS = {"name", "type", "slot", "slots", "gpu", "unit", "min", "max", "above", "must", "default", "stored",
                  "derived", "pxn", "pxn_name", "pxn_unit", "pxn_level", "pxn_default", "dimension", "bare", "doc",
                  "none", "field", "absent"}
BRDF_KEYS = {"part", "name", "struct", "title", "formula", "shared", "function", "microfacet", "smith", "doc",
             "pxn", "parameter", "since", "feature"}
STORED = {"": ("{}", "{}"), "tan": ("det::tan({})", "det::atan({})"), "cos": ("det::cos({})", "det::acos({})")}


class SchemaError(Exception):
    """The schema contradicts itself."""


def need(condition, where, what):
    if not condition:
        raise SchemaError(f"{where}: {what}")


def pascal(name):
    return "".join(word.capitalize() for word in name.split("_"))


def place_slots(schema):
    offset = 0
    for slot in schema["slot"]:
        slot.setdefault("count", 1)
        slot.setdefault("default", 0)
        slot["offset"] = offset
        offset += SIZES[slot["type"]] * slot["count"]
    need(offset == schema["record"]["size"], "record", f"slots take {offset} bytes")
    schema["slots"] = {slot["name"]: slot for slot in schema["slot"]}


def slot_place(text, schema, where):
    """('cook', 1) for 'cook[1]'."""
    match = re.fullmatch(r"(\w+)(?:\[(\d+)\])?", text)
    need(match and match[1] in schema["slots"], where, f"no slot is called {text}")
    return match[1], int(match[2] or 0)


def complete_parameter(parameter, where, schema):
    where = f"{where}.{parameter['name']}"
    unknown = set(parameter) - PARAMETER_KEYS
    need(not unknown, where, f"unknown keys {sorted(unknown)}")
    need(parameter.get("doc"), where, "a doc string is missing")
    kind = parameter.setdefault("type", "real")
    need(kind in WIDTHS, where, f"type is {kind}")
    for key, value in {"unit": "", "stored": "", "derived": "", "pxn": "", "gpu": "", "none": False, "above": False,
                       "pxn_unit": "", "field": parameter["name"]}.items():
        parameter.setdefault(key, value)
    parameter.setdefault("default", "automatic" if kind == "Compensation" else -1 if kind == "texture" else 0)
    need(parameter["stored"] in STORED, where, f"stored is {parameter['stored']}")
    must = parameter.setdefault("must", [])
    parameter["must"] = [must] if isinstance(must, str) else must
    names = parameter.get("slots") or [parameter["slot"]]
    parameter["places"] = [slot_place(name, schema, where) for name in names]
    if len(names) == 1:
        name, first = parameter["places"][0]
        parameter["places"] = [(name, first + k) for k in range(WIDTHS[kind])]
    need(len(parameter["places"]) == WIDTHS[kind], where, "one slot for each number")
    for name, index in parameter["places"]:
        need(index < schema["slots"][name]["count"], where, f"slot {name} has no [{index}]")


def check_gpu(schema):
    """A field of Surface has one slot and one type, whoever uses it."""
    known = {}
    for owner in schema["brdf"] + schema["struct"]:
        for parameter in owner["parameter"]:
            for field in [parameter["gpu"]] if isinstance(parameter["gpu"], str) else parameter["gpu"]:
                if not field:
                    continue
                field += "[]" if parameter["type"] == "real8" else ""
                what = (parameter["places"], parameter["type"], parameter["stored"])
                need(known.setdefault(field, what) == what, owner["name"], f"{field} stands elsewhere too")


def check_versions(schema):
    """What a later format adds stands behind what older ones have, and needs a feature of the file."""
    for part in ("diffuse", "specular"):
        since = 0
        for brdf in brdfs(schema, part):
            need(brdf["since"] >= since, brdf["name"], "BRDFs stand in the order of the versions that added them")
            need(("feature" in brdf) == (brdf["since"] > 0), brdf["name"], "`since` and `feature` go together")
            since = brdf["since"]


def load():
    """The schema, complete."""
    with open(ROOT / "schemas" / "material.toml", "rb") as file:
        schema = tomllib.load(file)
    place_slots(schema)
    for brdf in schema["brdf"]:
        where = brdf["name"]
        unknown = set(brdf) - BRDF_KEYS
        need(not unknown, where, f"unknown keys {sorted(unknown)}")
        need(brdf["part"] in ("diffuse", "specular"), where, "part is diffuse or specular")
        brdf.setdefault("struct", pascal(brdf["name"]))
        brdf.setdefault("parameter", [])
        brdf.setdefault("since", 0)
        for key in ("shared", "microfacet", "smith"):
            brdf.setdefault(key, False)
        for parameter in brdf["parameter"]:
            complete_parameter(parameter, where, schema)
    for struct in schema["struct"]:
        struct.setdefault("optional", "")
        struct.setdefault("authored", True)
        for parameter in struct["parameter"]:
            complete_parameter(parameter, struct["name"], schema)
    check_gpu(schema)
    check_versions(schema)
    schema["structs"] = {struct["name"]: struct for struct in schema["struct"]}
    return schema


def brdfs(schema, part):
    return [brdf for brdf in schema["brdf"] if brdf["part"] == part]


# ---- what the pan schema takes


def pan_record(schema):
    """The record as an entry of pan_layout.toml."""
    fields = []
    for slot in schema["slot"]:
        rule = slot.get("rule", "")
        if rule.startswith("brdf:"):
            rule = f"enum:{rule.partition(':')[2].capitalize()}Model"
        field = {"name": slot["name"], "type": slot["type"], "count": slot["count"], "rule": rule, "doc": slot["doc"]}
        if slot.get("since"):
            field.update(since=slot["since"], default=slot["default"])
        fields.append(field)
    return {"name": "Material", "size": schema["record"]["size"], "gpu": True, "doc": schema["record"]["doc"],
            "field": fields}


def pan_enums(schema):
    """The models as enumerations of pan_layout.toml."""
    return [{"name": f"{part.capitalize()}Model", "doc": f"The BRDF model of the {part} part of a material.",
             "values": [{"name": brdf["name"], "doc": brdf["doc"].rstrip(".") + since_words(brdf)}
                        for brdf in brdfs(schema, part)]}
            for part in ("diffuse", "specular")]


def since_words(brdf):
    return f" (since 1.{brdf['since']})" if brdf["since"] else ""


def feature_name(brdf):
    """What pan_layout.toml calls the feature of a BRDF."""
    return "Brdf" + pascal(brdf["name"])


def pan_features(schema):
    """The required features of BRDFs as bits of pan_layout.toml."""
    return [{"name": feature_name(brdf), "bit": brdf["feature"], "since": brdf["since"],
             "doc": f"a material has the BRDF {brdf['name']}"} for brdf in schema["brdf"] if brdf["since"]]


def pan_docs(schema):
    """Which parameter stands where."""
    lines = ["## Parameters of materials", "", "What a BRDF model keeps in the slots of a material, and with what "
             "default. Angles are radians.", "", "| model | parameter | slot | unit | default | meaning |",
             "|---|---|---|---|---:|---|"]
    for brdf in schema["brdf"]:
        for parameter in brdf["parameter"]:
            name, index = parameter["places"][0]
            slot = f"{name}[{index}]" if schema["slots"][name]["count"] > 1 else name
            stored = {"": "", "tan": " (its tangent)", "cos": " (its cosine)"}[parameter["stored"]]
            default = "" if parameter["derived"] else f"{parameter['default']:g}"
            lines.append(f"| `{brdf['name']}` | `{parameter['name']}` | `{slot}` | {parameter['unit']} "
                         f"| {default} | {parameter['doc'].rstrip('.')}{stored} |")
    return lines + [""]


# ---- what the pxn schema takes


def pxn_number(parameter):
    number = {key: parameter[key] for key in ("min", "max", "above") if key in parameter}
    return dict(number, name=parameter.get("pxn_name", parameter["name"]))


def pxn_content(brdf):
    """The numbers between the tags."""
    content = [each for each in brdf["parameter"] if not each["pxn"] and not each["derived"]]
    if not content:
        return None
    numbers = [pxn_number(parameter) for parameter in content]
    text = {"kind": "real", "count": len(content)}
    for key in ("dimension", "bare"):
        if key in content[0]:
            text[key] = content[0][key]
    same = all({**number, "name": ""} == {**numbers[0], "name": ""} for number in numbers)
    if same:
        text.update({key: numbers[0][key] for key in ("min", "max", "above")})
        text["names"] = [number["name"] for number in numbers]
    else:
        text["numbers"] = numbers
    if brdf["pxn"].get("one"):
        text["one"] = True
    return text


def default_words(parameter):
    """A default as readers see it."""
    if "pxn_default" in parameter:
        return parameter["pxn_default"]
    default = parameter["default"]
    numbers = default if isinstance(default, list) else [default]
    words = " ".join(f"{number:g}" for number in numbers)
    return words + {"deg": " degrees"}.get(parameter["pxn_unit"], "")


def pxn_attribute(parameter):
    """The value of an attribute that gives a parameter."""
    out = {key: parameter[key] for key in ("min", "max", "above", "dimension", "bare") if key in parameter}
    if parameter["type"] == "vec3":
        out.update({"count": 3, "one": True, "names": ["r", "g", "b"]})
    if parameter["type"] == "vec2":
        out.update({"count": 2, "one": True, "names": ["u", "v"]})
    default = parameter["default"]
    count = out.get("count", 1)
    numbers = default if isinstance(default, list) else [default] * count
    return dict(out, kind="real", doc=parameter["doc"], default=numbers, default_words=default_words(parameter))


def pxn_element(brdf):
    pxn = brdf["pxn"]
    element = {"id": pxn["tag"], "section": pxn["section"], "level": pxn["level"], "doc": pxn["doc"], "attribute": []}
    for key in ("notes", "example"):
        if key in pxn:
            element[key] = pxn[key]
    text = pxn_content(brdf)
    if text:
        element["text"] = text
    for parameter in brdf["parameter"]:
        if parameter["pxn"]:
            attribute = dict(pxn_attribute(parameter), name=parameter["pxn"])
            if "pxn_level" in parameter:
                attribute["level"] = parameter["pxn_level"]
            element["attribute"].append(attribute)
    element["attribute"] += [dict(each) for each in pxn.get("attribute", [])]
    return element


def add_to_pxn(language):
    """Puts the BRDFs where pxn.toml has `brdfs`, and fills in attributes and texts that name a parameter."""
    schema = load()
    tags = [brdf for brdf in schema["brdf"] if "pxn" in brdf]
    elements = []
    for element in language["element"]:
        if "brdfs" in element:
            elements += [pxn_element(brdf) for brdf in tags if brdf["pxn"]["level"] == element["brdfs"]]
            continue
        children = []
        for child in element.get("child", []):
            if "brdfs" not in child:
                children.append(child)
                continue
            children += [{"of": [brdf["pxn"]["tag"]]} for brdf in tags if brdf["pxn"]["level"] == child["brdfs"]]
        if children:
            element["child"] = children
        for rule in element.get("rule", []):
            if "brdfs" in rule:
                part = rule.pop("brdfs")
                rule["members"] = [brdf["pxn"]["tag"] for brdf in tags if brdf["part"] == part]
        for attribute in element.get("attribute", []):
            if "parameter" in attribute:
                fill_in(attribute, attribute.pop("parameter"), schema)
        if "parameter" in element.get("text", {}):
            name = element["text"].pop("parameter")
            fill_in(element["text"], name, schema)
            element.setdefault("default", element["text"].pop("default_words"))
            element["text"].pop("default", None)
            del element["text"]["doc"]
            element["text"].pop("one", None)
        elements.append(element)
    language["element"] = elements


def fill_in(value, name, schema):
    """Gives a value of pxn.toml what the parameter `Owner.name`, or `Owner.name.x`, says, unless it says so itself."""
    owner, wanted, *component = name.split(".")
    owners = {**schema["structs"], **{brdf["struct"]: brdf for brdf in schema["brdf"]}}
    need(owner in owners, name, "no struct is called so")
    found = [each for each in owners[owner]["parameter"] if each["name"] == wanted]
    need(found, name, "no parameter is called so")
    parameter = dict(found[0], type="real") if component else found[0]
    for key, filled in pxn_attribute(parameter).items():
        value.setdefault(key, filled)
    if value.get("required"):
        value.pop("default", None)
        value.pop("default_words", None)
