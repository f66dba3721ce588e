"""The part of JSON Schema that schemas/labels.schema.json uses: no validator is at hand everywhere."""

TYPES = {"string": str, "boolean": bool, "number": (int, float), "integer": int, "array": list, "object": dict, "null": type(None)}


def problems(value, schema, root, where="$"):
    if "$ref" in schema:
        yield from problems(value, root["$defs"][schema["$ref"].rsplit("/", 1)[1]], root, where)
    if "const" in schema and value != schema["const"]:
        yield f"{where}: {value} is not {schema['const']}"
    if "enum" in schema and value not in schema["enum"]:
        yield f"{where}: {value} is not of {schema['enum']}"
    names = schema.get("type", [])
    names = [names] if isinstance(names, str) else names
    if names and not any(isinstance(value, TYPES[name]) and (name == "boolean" or not isinstance(value, bool)) for name in names):
        yield f"{where}: {value!r} is not of type {names}"
        return
    if isinstance(value, dict):
        for name in schema.get("required", []):
            if name not in value:
                yield f"{where}: {name} is missing"
        for name, inner in value.items():
            if "properties" in schema and name not in schema["properties"]:
                yield f"{where}: {name} is not in the schema"
            elif "properties" in schema:
                yield from problems(inner, schema["properties"][name], root, f"{where}.{name}")
    if isinstance(value, list):
        if len(value) < schema.get("minItems", 0) or len(value) > schema.get("maxItems", len(value)):
            yield f"{where}: {len(value)} items"
        for number, inner in enumerate(value):
            yield from problems(inner, schema.get("items", {}), root, f"{where}[{number}]")
    if isinstance(value, (int, float)) and value < schema.get("minimum", value):
        yield f"{where}: {value} is too small"
    if isinstance(value, str) and len(value) < schema.get("minLength", 0):
        yield f"{where}: the text is empty"
