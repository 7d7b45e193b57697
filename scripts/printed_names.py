"""Names that `throng` prints or exports: commands, options, scene keys, the JSON of a small run, Python names.

scripts/reference.py documents them, tests/apps/stable_test.py keeps them stable.
"""

import ast
import json
import pathlib
import re
import subprocess

TOP = pathlib.Path(__file__).resolve().parent.parent

SCENE = """name: reference
step_s: 1/30
duration_s: 1/2
proximity_m: 1.2
closest_parts_m: 1
ground: {min_m: [-3, -2], max_m: [3, 2]}
groups:
  - {name: picker, model: PICKER, count: 1, radius_m: 0.5, control_channel: PICKER,
     spawn: {min_m: [-0.5, -0.5], max_m: [0.5, 0.5]}}
  - {name: people, count: 12, spawn: {min_m: [-3, -2], max_m: [3, 2]}, goals: [{min_m: [2, -2], max_m: [3, 2]}]}
separation: {reaction_s: 0.1, stopping_s: 0.1}
change_channel: CHANGES
"""
RECORDING = "id,t,x,y\n" + "".join(f"1,{i / 10},{i / 10},0\n" for i in range(8))


class ProgramError(Exception):
    """The program ended with an exit code other than 0."""


class Program:
    """Runs `throng` in a folder."""

    def __init__(self, file, folder):
        self.file, self.folder = pathlib.Path(file).resolve(), pathlib.Path(folder)

    def __call__(self, *arguments):
        """Return what the command writes to stdout."""
        result = subprocess.run([self.file, *arguments], cwd=self.folder, capture_output=True, text=True)
        if result.returncode != 0:
            raise ProgramError(f"throng {' '.join(arguments)}: exit code {result.returncode}\n{result.stderr}")
        return result.stdout


def commands(program):
    section = program("--help").split("Subcommands:\n")[1].split("\n\n")[0]
    return re.findall(r"^  (\w+) {2,}", section, re.M)


def options(program, command):
    return re.findall(r"^  (?:-\w,)?(--[\w-]+)", program(command, "--help"), re.M)


def scene_maps(program):
    """Return name and rule of each map of a scene file, from its JSON Schema; the first one is the file."""
    schema = json.loads(program("scenes", "--schema"))
    return {"scene": schema, **{name: rule for name, rule in schema["$defs"].items() if name != "fraction"}}


def map_rule(rule):
    """Return the rule of the map itself if a number or a word may replace the map."""
    return next((each for each in rule.get("anyOf", []) if "properties" in each), rule)


class SmallRun:
    """Runs a small scene, with and without a budget, and a recording; each writes a JSON file to the folder."""

    def __init__(self, program):
        self.program, self.folder = program, program.folder
        scene = SCENE.replace("PICKER,", str(TOP / "examples/picker.urdf") + ",", 1)
        (self.folder / "scene.yaml").write_text(scene)
        (self.folder / "tracks.csv").write_text(RECORDING)
        quiet = ("--lcm", "off", "--threads", "1")
        program("run", "scene.yaml", *quiet, "--exact", "--contact-points", "--publish-part-poses", "--pace", "1000",
                "--log", "run.lcmlog", "--trajectory", "run.csv", "--trajectory", "run.sqlite", "--contacts", "contacts",
                "--separation", "separation", "--part-pairs", "parts", "--trace-hash", "hashes.txt", "--json", "a.json")
        program("run", "scene.yaml", "--threads", "1", "--log", "off", "--lcm", "memq://", "--exact", "--budget-ms", "1000",
                "--budget-tests", "1000000", "--publish-for", "people:PEOPLE", "--json", "b.json")
        program("run", "tracks.csv", *quiet, "--log", "off", "--json", "c.json")

    def json_paths(self):
        """Return the path of every value, as in stranded.groups[].goal."""
        paths = {}
        for file in ("a.json", "b.json", "c.json"):
            _add_paths("", json.loads((self.folder / file).read_text()), paths)
        return list(paths)


def _add_paths(prefix, value, paths):
    """Add the path of every key to an ordered dict; empty maps and lists count as values."""
    if isinstance(value, dict) and value:
        for key, inner in value.items():
            _add_paths(f"{prefix}.{key}" if prefix else key, inner, paths)
    elif isinstance(value, list) and value and isinstance(value[0], dict):
        for inner in value:
            _add_paths(prefix + "[]", inner, paths)
    else:
        paths[prefix] = True


def python_places():
    """Return the file of each name that the Python module exports."""
    module = ast.parse((TOP / "python/throng/__init__.py").read_text())
    return next(ast.literal_eval(node.value) for node in module.body
                if isinstance(node, ast.Assign) and getattr(node.targets[0], "id", "") == "_PLACES")
