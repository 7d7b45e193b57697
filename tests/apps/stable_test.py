"""Interfaces that docs/stability.md lists are those of tests/apps/stable.txt.

Usage: stable_test.py ROOT BUILD [--update]. Collects commands and options, scene keys, fields of
`throng run --json`, LCM fingerprints, exported Python names and public headers. Prints what differs and exits with 1,
or with --update writes the list: an entry that disappears breaks programs of users.
"""
import pathlib
import re
import sys
import tempfile

ROOT, BUILD = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
LIST = ROOT / "tests/apps/stable.txt"
HEADERS = r"^\s*(?:HEADERS |throng_install\(\w+ HEADERS )([^\n)]*?)(?: REQUIRES|$)"

sys.dont_write_bytecode = True  # the tree of sources stays as it is
sys.path.insert(0, str(ROOT / "scripts"))
import printed_names  # noqa: E402


def command_line(program):
    for command in printed_names.commands(program):
        yield f"command {command}"
        if command != "help":
            for option in printed_names.options(program, command):
                yield f"option {command} {option}"


def scene_keys(program):
    for name, rule in printed_names.scene_maps(program).items():
        for key in printed_names.map_rule(rule)["properties"]:
            yield f"scene key {key}" if name == "scene" else f"scene key ({name}) {key}"


def run_fields(program):
    for path in printed_names.SmallRun(program).json_paths():
        yield f"run JSON {path}"


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
    for name in printed_names.python_places():
        yield f"Python {name}"


def headers():
    install = (ROOT / "cmake/Install.cmake").read_text()
    for names in re.findall(HEADERS, install, flags=re.M):
        for name in names.split():
            yield f"header {name}"


def main():
    try:
        with tempfile.TemporaryDirectory() as folder:
            program = printed_names.Program(BUILD / "throng", folder)
            printed = {*command_line(program), *scene_keys(program), *run_fields(program)}
    except printed_names.ProgramError as error:
        sys.exit(str(error))
    found = sorted({*printed, *fingerprints(), *python_names(), *headers()})
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
