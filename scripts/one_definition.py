#!/usr/bin/env python3
"""One definition of everything: scripts/one_definition.py compiles all programs and tests as the preset lto
says, lets gcc read each program as a whole, and compares what was compiled. Exit code 1 where two definitions
of one name differ.

  -Wodr                classes and enumerations with other members, bases or virtual functions
  -Wlto-type-mismatch  functions and variables of another type
  bytes                inline functions, templates and inline variables of one type that say something else;
                       a linker takes one of them, and says nothing

Planted violations of each sort have to be found first. Nothing is optimised: a function that is inlined is not
compared, and the same text has the same bytes wherever it is compiled, for all that it refers to is a
relocation. Of bytes, only names with ours in them: g++ works out some of Eigen while it compiles, or not; and none
of the standard library's, whose text is one: g++ leaves out what unwinds where it has seen by then that nothing is
thrown. Out of reach are inline functions and templates that nobody calls, and names within one file (static, unnamed
namespaces), of which there may be as many as there are files.
"""
import collections
import concurrent.futures
import os
import pathlib
import re
import struct
import subprocess
import sys
import tempfile

BUILD = pathlib.Path("build/lto")
OURS = b"6throng"  # in a mangled name
STANDARD = (b"_ZSt", b"_ZNSt", b"_ZNKSt", b"_ZN9__gnu_cxx", b"_ZNK9__gnu_cxx")  # at its beginning

PLANTED = {
    "-Werror=odr": (
        "namespace throng { struct Pair { int a; int b; }; } int gap(throng::Pair);\n"
        "int main() { return gap({1, 2}); }\n",
        "namespace throng { struct Pair { double a; }; } int gap(throng::Pair pair) { return int(pair.a); }\n"),
    "-Werror=lto-type-mismatch": (
        "namespace throng { extern int lanes; } int main() { return throng::lanes; }\n",
        "namespace throng { double lanes = 8; }\n"),
    "throng::lanes()": (
        "namespace throng { inline int lanes() { return 8; } } int more();\n"
        "int main() { return throng::lanes() + more(); }\n",
        "namespace throng { inline int lanes() { return 16; } } int more() { return throng::lanes(); }\n"),
}


def build(*targets):
    subprocess.run(["bash", "scripts/build.sh", "lto", *targets], check=True)


def flags(name):
    cache = (BUILD / "CMakeCache.txt").read_text()
    return re.search(rf"^{name}:STRING=(.*)$", cache, re.MULTILINE)[1].split()


def complaint_of_linker(inputs, folder):
    """What gcc says about the whole of a program, "" if nothing. It writes no machine code."""
    with tempfile.TemporaryDirectory() as scratch:
        command = ["c++", *flags("CMAKE_CXX_FLAGS"), *flags("CMAKE_EXE_LINKER_FLAGS"), "-fno-fat-lto-objects",
                   "-flinker-output=rel", "-r", "-nostdlib", *inputs, "-o", f"{scratch}/whole.o"]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    return "" if done.returncode == 0 else done.stderr


def shared_definitions(data):
    """Name, size and bytes of what others may define, too, in a 64-bit little-endian ELF file."""
    table, = struct.unpack_from("<Q", data, 0x28)
    entry, count = struct.unpack_from("<HH", data, 0x3A)
    if count == 0:  # too many for 16 bits: they stand in the first section
        count, = struct.unpack_from("<Q", data, table + 0x20)
    sections = [struct.unpack_from("<IIQQQQII", data, table + i * entry) for i in range(count)]
    symbols, zeros, long_homes = 2, 8, 18  # sorts of sections
    weak, unique = 2, 10                   # how what is shared is bound
    homes = next((s[4] for s in sections if s[1] == long_homes), None)
    for section in sections:
        if section[1] != symbols:
            continue
        names = sections[section[6]][4]
        for i, at in enumerate(range(section[4], section[4] + section[5], 24)):
            name, info, _, home, value, size = struct.unpack_from("<IBBHQQ", data, at)
            if info >> 4 not in (weak, unique) or home == 0:
                continue
            if home == 0xFFFF:
                home, = struct.unpack_from("<I", data, homes + 4 * i)
            begin = sections[home][4] + value
            content = b"" if sections[home][1] == zeros else data[begin:begin + size]
            yield data[names + name:data.index(b"\0", names + name)], size, content


def compare_bytes(objects, folder):
    """What to say of inline definitions that differ, and how many there are."""
    found = collections.defaultdict(lambda: collections.defaultdict(list))
    for path in objects:
        for name, size, content in shared_definitions((folder / path).read_bytes()):
            if OURS in name and not name.startswith(STANDARD):
                found[name][size, hash(content)].append(path)
    said = []
    for name, kinds in sorted(found.items()):
        if len(kinds) > 1:
            said.append(subprocess.run(["c++filt", name.decode()], capture_output=True, text=True,
                                       check=True).stdout.strip())
            for (size, _), paths in kinds.items():
                more = f" and {len(paths) - 1} more" if len(paths) > 1 else ""
                said.append(f"  {size} bytes in {paths[0]}{more}")
    return "\n".join(said), len(found)


def check_planted():
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        for expected, texts in PLANTED.items():
            for name, text in zip("ab", texts):
                (folder / f"{name}.cpp").write_text(text)
            subprocess.run(["c++", *flags("CMAKE_CXX_FLAGS"), "-std=c++20", "-c", "a.cpp", "b.cpp"], cwd=folder,
                           check=True)
            objects = ["a.o", "b.o"]
            said = complaint_of_linker(objects, folder) or compare_bytes(objects, folder)[0]
            if expected not in said:
                sys.exit("scripts/one_definition.py: expected two definitions to be refused with "
                         f"'{expected}', found '{said}'")


def ninja(*arguments):
    return subprocess.run(["ninja", "-C", str(BUILD), *arguments], capture_output=True, text=True,
                          check=True).stdout.splitlines()


def programs():
    """Objects and archives of ours that each program is linked from."""
    for line in ninja("-t", "commands"):
        words = line.split()
        if "-o" in words and "-c" not in words:
            inputs = [word for word in words if re.fullmatch(r"[a-z][^=]*\.[oa]", word)]
            if inputs:
                yield words[words.index("-o") + 1], inputs


def main():
    os.chdir(pathlib.Path(__file__).resolve().parent.parent)
    build("throng_version")  # configures
    check_planted()
    build(*(line.split(":")[0] for line in ninja("-t", "targets", "all") if re.match(r"\S+\.[oa]: ", line)))

    linked = dict(programs())
    objects = sorted(str(path.relative_to(BUILD)) for path in BUILD.rglob("*.o"))
    said, compared = compare_bytes(objects, BUILD)
    print(said, end="\n" if said else "", flush=True)
    refused = 0
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as workers:
        for program, complaint in zip(linked, workers.map(lambda inputs: complaint_of_linker(inputs, BUILD),
                                                          linked.values())):
            refused += complaint != ""
            print(f"{program}: {complaint or 'one definition of everything'}", flush=True)
    print(f"{len(objects)} objects, {compared} inline definitions compared, {len(linked)} programs, {refused} refused")
    sys.exit(1 if said or refused or not linked else 0)


main()
