"""Interfaces that docs/stability.md lists are those of tests/apps/stable.txt.

stable_test.py ROOT BUILD [--update]: collects commands and options, scene keys, fields of
`throng run --json`, LCM fingerprints, exported Python names and public headers. Prints what differs and exits with 1,
or with --update writes the list: an entry that disappears breaks programs of users.
"""
import ast
import json
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT, BUILD = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
LIST = ROOT / "tests/apps/stable.txt"
HEADERS = r"^\s*(?:HEADERS |throng_install\(\w+ HEADERS )([^\n)]*?)(?: REQUIRES|$)"


def throng(*arguments, folder=None):
    done = subprocess.run([BUILD / "throng", *arguments], capture_output=True, text=True, cwd=folder)
    if done.returncode != 0:
        sys.exit(f"throng {' '.join(arguments)}: exit code {done.returncode}: {done.stderr}")
    return done.stdout


def options():
    commands = re.search(r"Subcommands:\n(.*?)(?:\n\n|\Z)", throng("--help"), flags=re.S).group(1)
    for command in re.findall(r"^  (\w+)", commands, flags=re.M):
        yield f"command {command}"
        if command != "help":
            for option in re.findall(r"^  (?:-\w,)?(--[\w-]+)", throng(command, "--help"), flags=re.M):
                yield f"option {command} {option}"


def scene_keys():
    schema = json.loads(throng("scenes", "--schema"))

    def walk(name, node):
        if isinstance(node, list):
            for child in node:
                yield from walk(name, child)
        elif isinstance(node, dict):
            for key, child in node.get("properties", {}).items():
                yield f"scene key {name}{key}"
                yield from walk(f"{name}{key}.", child)
            for key, child in node.items():
                if key not in ("properties", "$defs", "definitions"):
                    yield from walk(name, child)
            for table in ("$defs", "definitions"):
                for key, child in node.get(table, {}).items():
                    yield from walk(f"({key}) ", child)

    yield from walk("", schema)


def run_fields():
    with tempfile.TemporaryDirectory() as folder:
        throng("run", "robot_in_crowd", "--seconds", "0.1", "--exact", "--contact-points", "--proximity", "0.2",
               "--lcm", "off", "--log", "off", "--json", "run.json", folder=folder)
        report = json.loads((pathlib.Path(folder) / "run.json").read_text())

    def walk(name, node):
        if isinstance(node, dict):
            for key, child in node.items():
                yield f"run JSON {name}{key}"
                yield from walk(f"{name}{key}.", child)
        elif isinstance(node, list) and node:
            yield from walk(name, node[0])

    yield from walk("", report)


def fingerprints():
    for definition in (ROOT / "lcmtypes").glob("*_t.lcm"):
        header = BUILD / "lcmtypes/generated/throng" / (definition.stem + ".hpp")
        base = re.search(r"hash = (0x[0-9a-f]+)LL", header.read_text()).group(1)
        yield f"LCM {definition.stem} {base}"
    channels = (ROOT / "lcmtypes").glob("*.lcm")
    for text in (path.read_text() for path in channels):
        for channel in re.findall(r"^//! channel (\w+)", text, flags=re.M):
            yield f"LCM channel {channel}"


def python_names():
    module = ast.parse((ROOT / "python/throng/__init__.py").read_text())
    for node in module.body:
        if isinstance(node, ast.Assign) and node.targets[0].id == "_PLACES":
            for name in ast.literal_eval(node.value):
                yield f"Python {name}"


def headers():
    install = (ROOT / "cmake/Install.cmake").read_text()
    for names in re.findall(HEADERS, install, flags=re.M):
        for name in names.split():
            yield f"header {name}"


def main():
    found = sorted({*options(), *scene_keys(), *run_fields(), *fingerprints(), *python_names(), *headers()})
    if "--update" in sys.argv:
        LIST.write_text("".join(f"{line}\n" for line in found))
        return
    listed = LIST.read_text().splitlines()
    gone, new = sorted(set(listed) - set(found)), sorted(set(found) - set(listed))
    for line in gone:
        print(f"gone: {line}")
    for line in new:
        print(f"new:  {line}")
    print(f"{len(found)} interfaces")
    if gone or new:
        sys.exit("see docs/stability.md for what may change; --update writes tests/apps/stable.txt")


main()
