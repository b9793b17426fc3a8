# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""The part of JSON Schema 2020-12 that monitor/app/openapi.json uses. A keyword that it does not know is an error, so that nothing
of a schema goes unnoticed."""
import re

ANNOTATIONS = {"description", "title", "example", "examples"}
TYPES = {
    "object": lambda v: isinstance(v, dict), "array": lambda v: isinstance(v, list), "string": lambda v: isinstance(v, str),
    "boolean": lambda v: isinstance(v, bool), "null": lambda v: v is None,
    "number": lambda v: isinstance(v, (int, float)) and not isinstance(v, bool),
    "integer": lambda v: (isinstance(v, int) and not isinstance(v, bool)) or (isinstance(v, float) and v.is_integer()),
}


def resolve(document, schema):
    """The schema, or what its $ref points at."""
    while "$ref" in schema:
        node = document
        for step in schema["$ref"].removeprefix("#/").split("/"):
            node = node[step]
        schema = node
    return schema


def problems(document, schema, value, where="$"):
    """What is wrong with `value`, one text each."""
    schema = resolve(document, schema)
    out = []
    for keyword, rule in schema.items():
        if keyword in ANNOTATIONS or keyword in ("properties", "additionalProperties"):
            continue
        if keyword == "type":
            if not any(TYPES[t](value) for t in ([rule] if isinstance(rule, str) else rule)):
                out.append(f"{where}: {value!r:.60} is not of type {rule}")
        elif keyword == "enum":
            if value not in rule:
                out.append(f"{where}: {value!r:.60} is none of {rule}")
        elif keyword == "const":
            if value != rule:
                out.append(f"{where}: {value!r:.60} is not {rule!r}")
        elif keyword == "required":
            out += [f"{where}: '{name}' is missing" for name in rule if isinstance(value, dict) and name not in value]
        elif keyword == "items":
            for i, item in enumerate(value if isinstance(value, list) else []):
                out += problems(document, rule, item, f"{where}[{i}]")
        elif keyword == "maxItems":
            if isinstance(value, list) and len(value) > rule:
                out.append(f"{where}: {len(value)} items, at most {rule}")
        elif keyword in ("minimum", "maximum"):
            if TYPES["number"](value) and (value < rule if keyword == "minimum" else value > rule):
                out.append(f"{where}: {value} is beyond its {keyword} {rule}")
        elif keyword == "minLength":
            if isinstance(value, str) and len(value) < rule:
                out.append(f"{where}: text shorter than {rule}")
        elif keyword == "pattern":
            if isinstance(value, str) and not re.search(rule, value):
                out.append(f"{where}: {value!r:.60} does not match {rule}")
        else:
            raise ValueError(f"{where}: this validator does not know the keyword '{keyword}'")
    if isinstance(value, dict):
        properties, others = schema.get("properties", {}), schema.get("additionalProperties", True)
        for name, item in value.items():
            if name in properties:
                out += problems(document, properties[name], item, f"{where}.{name}")
            elif others is False:
                out.append(f"{where}: '{name}' is not in the schema")
            elif isinstance(others, dict):
                out += problems(document, others, item, f"{where}.{name}")
    return out
