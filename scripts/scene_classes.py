"""Prints python/throng/_scene_keys.py: a class for each map of scene files, from scenes/scene.schema.json, with
argument types that editors and mypy know."""

import json
import pathlib
import re
import textwrap

from printed_names import map_rule

SCHEMA = pathlib.Path(__file__).resolve().parent.parent / "scenes/scene.schema.json"

# Classes whose name is not that of their map.
NAMES = {"scene": "Scene", "box": "PartsBox", "recording": "RecordedPeople"}
AREAS = ("area", "ground", "goal")


def class_of(name):
    return NAMES.get(name) or "".join(word.capitalize() for word in name.split("_"))


def type_of(rule, maps):
    """Return the annotation of a value."""
    if "$ref" in rule:
        name = rule["$ref"].rsplit("/", 1)[1]
        kinds = [f'"{class_of(name)}"'] if is_class(map_rule(maps[name])) else []
        kinds += ["Shape"] if name in AREAS else []
        kinds += [type_of(each, maps) for each in maps[name].get("anyOf", []) if "type" in each and each["type"] != "object"]
        kinds += [type_of(each, maps) for each in maps[name].get("anyOf", []) if "enum" in each or "anyOf" in each]
        return f"Union[{', '.join([*kinds, 'Mapping[str, Any]'])}]"
    if "enum" in rule:
        return f"Literal[{', '.join(json.dumps(word) for word in rule['enum'])}]"
    if "anyOf" in rule and "type" not in rule:
        kinds = [each for each in rule["anyOf"] if each.get("$ref") != "#/$defs/fraction"]
        return "str" if len(kinds) == 3 else type_of(kinds[0], maps)
    kind = rule["type"]
    if kind == "array":
        inner = type_of(rule["items"], maps)
        return f"Sequence[{inner}]" if "Union" in inner else "npt.ArrayLike"
    return {"boolean": "bool", "string": "str", "integer": "int", "number": "float"}[kind]


def map_of(rule):
    """Return the name of the map that a value, or each item of a list, is; "" without one."""
    if rule.get("type") == "array":
        return map_of(rule["items"])
    return rule["$ref"].rsplit("/", 1)[1] if "$ref" in rule else ""


def is_class(rule):
    """Whether a map has keys of its own and no others."""
    return "properties" in rule and rule.get("additionalProperties") is False


def wrapped(text, indent):
    return "\n".join(textwrap.wrap(text, 110, initial_indent=indent, subsequent_indent=indent + "    ",
                                   break_on_hyphens=False))


def class_text(name, rule, maps):
    keys = map_rule(rule)["properties"]
    base = "SceneText" if name == "scene" else "SceneMap"
    meaning = re.sub(r"[`]", "", rule["description"]).rstrip(".")
    text = f'\n\nclass {class_of(name)}({base}):\n    """{meaning}.\n\n    Args:\n'
    for key, value in keys.items():
        described = value["description"].replace("; without it: ", " [").replace("`", "")
        described += "]" if " [" in described and not described.endswith("required") else ""
        text += wrapped(f"{key}: {described}.", "        ") + "\n"
    text += '    """\n\n'
    text += "    _keys = {" + ", ".join(f'"{key}": "{map_of(value)}"' for key, value in keys.items()) + "}\n"
    text += "".join(f"    {key}: Optional[{type_of(value, maps)}]\n" for key, value in keys.items())
    text += "\n    def __init__(\n        self,\n        *,\n"
    text += "".join(f"        {key}: Optional[{type_of(value, maps)}] = None,\n" for key, value in keys.items())
    text += "    ) -> None:\n"
    text += "        super().__init__(" + ", ".join(f"{key}={key}" for key in keys) + ")\n"
    return text


def main():
    schema = json.loads(SCHEMA.read_text())
    maps = {"scene": schema, **schema["$defs"]}
    classes = {name: rule for name, rule in maps.items() if is_class(map_rule(rule))}
    print('"""Classes of the maps in scene files. Written by scripts/docs.sh --update."""\n')
    print("# fmt: off")
    print("from typing import Any, Literal, Mapping, Optional, Sequence, Union\n")
    print("import numpy.typing as npt\n")
    print("from ._scene import SceneMap, SceneText\n")
    print("# A shapely geometry, or an array of N corners, N x 2.\nShape = Any", end="")
    for name, rule in classes.items():
        print(class_text(name, rule, maps), end="")
    print("\n\n# Classes by the name of their map.")
    print("MAPS = {" + ", ".join(f'"{name}": {class_of(name)}' for name in classes) + "}")


if __name__ == "__main__":
    main()
