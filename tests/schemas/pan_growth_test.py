#!/usr/bin/env python3
"""What schemas/generate_pan.py says of records that grow: rightly, and in ways that no reader could follow."""

import copy
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "schemas"))
sys.dont_write_bytecode = True
import generate_pan  # noqa: E402
import material_schema  # noqa: E402


def layout_with(name, fields, size=None, minor=1):
    """The layout of today with more fields in a record."""
    layout = copy.deepcopy(LAYOUT)
    layout["format"]["minor"] = minor
    record = next(record for record in layout["record"] if record["name"] == name)
    record["field"] += fields
    record["size"] += size if size is not None else 4 * len(fields)
    return layout


def refused(what, layout):
    try:
        generate_pan.validate(layout)
    except generate_pan.LayoutError:
        return True
    print(f"accepted: {what}")
    return False


def field(name, **more):
    return {"name": name, "type": "u32", "doc": "", **more}


LAYOUT = generate_pan.load_layout()
new = {"since": 1, "default": 3}
grown = layout_with("Instance", [field("a", **new), field("b", **new)])
generate_pan.validate(grown)
header = generate_pan.header_text(grown)
sound = all(text in header for text in [
    '{SectionKind::instances, "instances", 24, 16, 4, true, false}',
    "{SectionKind::instances, 16, FieldType::u32, 1, 3}",
    "{SectionKind::instances, 20, FieldType::u32, 1, 3}",
    "std::array<FieldDefault, 2> kFieldDefaults",
])
sound &= "24 bytes (16 in 1.0, 24 in 1.1)" in generate_pan.docs_text(grown)
sound &= refused("a new field without a default", layout_with("Instance", [field("a", since=1)]))
sound &= refused("a default of an old field", layout_with("Instance", [field("a", default=1)]))
sound &= refused("an old field behind a new one", layout_with("Instance", [field("a", **new), field("b")]))
sound &= refused("a field of a format to come", layout_with("Instance", [field("a", since=2, default=0)]))
sound &= refused("a size off the alignment", layout_with("Node", [field("a", **new)]))
sound &= refused("a larger size than a reader takes",
                 layout_with("Instance", [field("a", count=1024, **new)], size=4096))


def layout_with_features(*features, minor=1):
    """The layout of today with more required features."""
    layout = copy.deepcopy(LAYOUT)
    layout["format"]["minor"] = minor
    generate_pan.add_features(layout, [{"name": "X", "doc": "", **feature} for feature in features])
    generate_pan.validate(layout)
    return layout


def features_refused(what, *features):
    try:
        layout_with_features(*features)
    except generate_pan.LayoutError:
        return True
    print(f"accepted: {what}")
    return False


free = len(next(flags for flags in LAYOUT["flags"] if flags["name"] == "RequiredFeatures")["bits"])
header = generate_pan.header_text(layout_with_features({"bit": free, "since": 2}, minor=2))
sound &= f"kFeatureX = 1u << {free};" in header and "{kFeatureX, 2, \"X\"}" in header
sound &= features_refused("a bit twice", {"bit": free - 1, "since": 1})
sound &= features_refused("a bit left out", {"bit": free + 1, "since": 1})
sound &= features_refused("a feature of a format to come", {"bit": free, "since": 2})
schema = material_schema.load()
for what, change in (("a later BRDF without a feature", {"since": 1}), ("a feature of 1.0", {"feature": 3}),
                     ("a later BRDF before one of 1.0", {"since": 1, "feature": 3})):
    changed = copy.deepcopy(schema)
    changed["brdf"][0].update(change)
    try:
        material_schema.check_versions(changed)
        print(f"accepted: {what}")
        sound = False
    except material_schema.SchemaError:
        pass
for fixed in ("Header", "DirectoryEntry", "Float3"):
    size = 8 if fixed != "Float3" else 4
    more = {"type": "u64", **new} if size == 8 else new
    sound &= refused(f"growth of {fixed}", layout_with(fixed, [field("a", **{**new, **more})], size=size))


def table(kind, **says):
    """The layout of today, where a section says more."""
    layout = copy.deepcopy(LAYOUT)
    next(section for section in layout["section"] if section["kind"] == kind).update(says)
    return layout


generate_pan.validate(table("frames", order=["node"], each="nodes"))
sound &= refused("a line with a field that is not there", table("frames", info="frame {nme}"))
sound &= refused("a key of a later section", table("instances", key=["texture"]))
sound &= refused("differences without a key", table("sources", diff=True, words="source {file}"))
sound &= refused("an order of an array", table("positions", order=["x"]))
sound &= refused("as many as a section that is not there", table("frames", each="framez"))
sound &= refused("two records exactly", table("budget", records="2"))


def next_table(value, tiles):
    """The layout of today with another table behind all, and the kind of terrain's tiles."""
    layout = copy.deepcopy(LAYOUT)
    frames = next(section for section in layout["section"] if section["kind"] == "frames")
    layout["section"].append({**frames, "kind": "others", "value": value})
    next(kind for kind in layout["reserved"] if kind["kind"] == "tiles")["value"] = tiles
    return layout


beyond = next_table(32, 31)
generate_pan.validate(beyond)
header = generate_pan.header_text(beyond)
sound &= all(text in header for text in [
    "kSectionKinds = 31;", "kLastKind = 32;", "return kind >= 1 && kind <= kLastKind && kind != 31;",
    "return kind - 1 - (kind > 31 ? 1 : 0);"])
sound &= refused("a table in place of terrain's tiles", next_table(31, 32))
sound &= refused("a table of a kind that is taken", next_table(31, 31))
sys.exit(0 if sound else 1)
