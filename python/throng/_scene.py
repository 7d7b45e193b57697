"""Scenes built in code: the base of the classes in _scene_keys.py."""

import json
import os
import re
from difflib import get_close_matches

import numpy

from . import _core
from ._errors import InputError
from ._validation import abbreviated, input_error

# Maps that are areas: a shape may stand for them.
_AREAS = ("area", "ground", "goal")
# Name of a scene built in code in messages of the library.
_NAME = "scene"


class SceneMap:
    """Keys and values of a map in a scene file; the base of Scene, Group, Area, Obstacle, ...

    Each key is an argument and an attribute; None stands for a key that is not given.
    """

    # By key: the name of the map that its value, or each item of a list, is; "" without one.
    _keys = {}

    def __init__(self, **values):
        for name in self._keys:
            setattr(self, name, values.get(name))

    def __setattr__(self, name, value):
        if name not in self._keys:
            raise AttributeError(f"{type(self).__name__} has no key '{name}'{_near(name, self._keys)}")
        super().__setattr__(name, _converted(value, self._keys[name]))

    def __eq__(self, other):
        return type(self) is type(other) and self.to_dict() == other.to_dict()

    def __repr__(self):
        given = ", ".join(f"{name}={abbreviated(value)}" for name, value in vars(self).items() if value is not None)
        return f"{type(self).__name__}({given})"

    @classmethod
    def from_dict(cls, values):
        """Return the map with these values. Raises InputError for unknown keys."""
        return _from_dict(cls, values, cls.__name__)

    def to_dict(self):
        """Return the keys that are given, with dictionaries, lists, text and numbers as values."""
        given = {name: _converted(value, self._keys[name]) for name, value in vars(self).items() if value is not None}
        return {name: plain(value) for name, value in given.items()}


class SceneText(SceneMap):
    """Base of Scene: conversion to and from text."""

    @classmethod
    def from_yaml(cls, text):
        """Return the scene in the text of a scene file. Its values are checked when it runs."""
        return cls.from_dict(_typed(_core.parse_yaml(text, _NAME)))

    def to_yaml(self):
        """Return the text of a scene file."""
        return text_and_places(self.to_dict())[0]

    def save(self, file):
        """Write a scene file."""
        with open(file, "w", encoding="utf-8") as out:
            out.write(self.to_yaml())


def source_options(source):
    """Return the options that name a SceneText as the source of a run."""
    return {"source": _NAME, "scene_text": source.to_yaml()}


def goal_text(goal):
    """Return the text of a goal: of a Goal, an Area, a shape, several shapes, or a dictionary."""
    value = _converted(goal, "goal")
    if isinstance(value, list):
        value = {"any_of": [_converted(item, "area") for item in value]}
    return _scalar(plain(value), "goal")


class errors_of:
    """Context in which an InputError names the key of a scene built in code, not a line of its text."""

    def __init__(self, *sources):
        self._scenes = [source for source in sources if isinstance(source, SceneText)]

    def __enter__(self):
        return self

    def __exit__(self, kind, error, trace):
        if not isinstance(error, InputError) or error.file != _NAME or len(self._scenes) != 1:
            return
        places = text_and_places(self._scenes[0].to_dict())[1]
        place = places[min(error.line, len(places)) - 1]
        message = str(error).removeprefix(f"{error.where}: ")
        raise InputError(f"{place}: {message}", place) from None


def _near(name, names):
    near = get_close_matches(name, names, 1)
    return f"; did you mean '{near[0]}'?" if near else ""


def _from_dict(cls, values, place):
    if isinstance(values, cls):
        return values
    if not isinstance(values, dict):
        raise input_error(place, f"a dictionary of keys of {cls.__name__}", abbreviated(values))
    out = cls.__new__(cls)
    SceneMap.__init__(out)
    for name, value in values.items():
        if name not in cls._keys:
            raise input_error(place, f"a key of {cls.__name__}", f"'{name}'{_near(str(name), cls._keys)}")
        setattr(out, name, _nested(value, cls._keys[name], f"{place}.{name}"))
    return out


def _nested(value, map_name, place):
    """Return dictionaries within a value as instances of their classes."""
    from ._scene_keys import MAPS

    if map_name not in MAPS:
        return value
    if isinstance(value, dict):
        return _from_dict(MAPS[map_name], value, place)
    if isinstance(value, (list, tuple)) and all(isinstance(item, (dict, SceneMap)) for item in value):
        return [_nested(item, map_name, f"{place}[{i}]") for i, item in enumerate(value)]
    return value


def _converted(value, map_name):
    """Return a value with shapes as areas, and arrays as lists."""
    if isinstance(value, SceneMap) or value is None:
        return value
    if map_name in _AREAS:
        shape = _shape_of(value)
        if shape is not None:
            return _nested(shape, map_name, map_name)
        if isinstance(value, (list, tuple)):
            return [_converted(item, map_name) for item in value]
    if hasattr(value, "__geo_interface__"):  # the value of `polygon`
        shape = _shape_of(value)
        if shape is None or set(shape) != {"polygon"}:
            raise input_error("polygon", "one polygon without holes; an area takes any", abbreviated(value))
        return shape["polygon"]
    if isinstance(value, (numpy.ndarray, numpy.generic)):
        return value.tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, (list, tuple)):
        return [_converted(item, map_name) for item in value]
    return value


def _shape_of(value):
    """Return the keys of an area for a shape: an object with __geo_interface__, or N points. None for other values."""
    if hasattr(value, "__geo_interface__"):
        return _area_of(value.__geo_interface__)
    if isinstance(value, numpy.ndarray) or (isinstance(value, (list, tuple)) and value and not hasattr(value[0], "keys")):
        try:
            points = numpy.asarray(value, dtype=float)
        except (TypeError, ValueError):
            return None
        if points.ndim == 2 and points.shape[1] == 2:
            return {"polygon": points.tolist()}
    return None


def _area_of(geometry):
    kind = geometry["type"]
    if kind == "Feature":
        return _area_of(geometry["geometry"])
    if kind == "Polygon":
        outline, *holes = [[list(map(float, point[:2])) for point in ring[:-1]] for ring in geometry["coordinates"]]
        return {"polygon": outline, "holes": holes} if holes else {"polygon": outline}
    if kind == "MultiPolygon":
        return {"wkt": f"MULTIPOLYGON ({', '.join(_rings_text(rings) for rings in geometry['coordinates'])})"}
    raise input_error("area", "a Polygon or MultiPolygon", kind)


def _rings_text(rings):
    return f"({', '.join('(' + ', '.join(f'{float(p[0])!r} {float(p[1])!r}' for p in ring) + ')' for ring in rings)})"


def plain(value):
    """Return a value as dictionaries, lists, text and numbers."""
    if isinstance(value, SceneMap):
        return value.to_dict()
    if isinstance(value, dict):
        return {str(name): plain(item) for name, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    return _converted(value, "")


def _typed(value):
    """Return values of _core.parse_yaml() with numbers and truth values."""
    if isinstance(value, dict):
        return {name: _typed(item) for name, item in value.items()}
    if isinstance(value, list):
        return [_typed(item) for item in value]
    if not isinstance(value, tuple):
        return value
    text = value[0]
    if text in ("true", "false"):
        return text == "true"
    if re.fullmatch(r"[+-]?[0-9]+", text):
        return int(text)
    if re.fullmatch(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?", text):
        return float(text)
    return text


def text_and_places(values):
    """Return the text of a YAML file, and for each of its lines the place in code, "groups[0].spawn"."""
    lines, places = [], []

    def write(text, place):
        lines.append(text)
        places.append(place)

    def is_block(value):
        return bool(value) and (
            isinstance(value, dict) or (isinstance(value, list) and any(isinstance(item, dict) for item in value))
        )

    def add(value, indent, place):
        pairs = value.items() if isinstance(value, dict) else enumerate(value)
        for name, item in pairs:
            if isinstance(value, dict):
                inner, head = f"{place}.{name}".lstrip("."), f"{indent}{_scalar(name, place)}:"
            else:
                inner, head = f"{place}[{name}]", f"{indent}-"
            if is_block(item):
                write(head, inner)
                add(item, indent + "  ", inner)
            else:
                write(f"{head} {_scalar(item, inner)}", inner)

    add(values, "", "")
    return "\n".join(lines) + "\n", places or [_NAME]


def _scalar(value, place):
    is_word = isinstance(value, str) and re.fullmatch(r"[A-Za-z_]([A-Za-z0-9_ ]*[A-Za-z0-9_])?", value)
    is_fraction = isinstance(value, str) and re.fullmatch(r"[+-]?[0-9.]+/[0-9.]+", value)
    if is_fraction or (is_word and value.lower() not in ("true", "false", "null", "yes", "no", "on", "off")):
        return value
    try:
        return json.dumps(value, ensure_ascii=False, allow_nan=False)
    except (TypeError, ValueError):
        raise input_error(place, "text, numbers, lists or maps", abbreviated(value)) from None
