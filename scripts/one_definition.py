#!/usr/bin/env python3
"""Check that every name has one definition: scripts/one_definition.py compiles all programs and tests with the preset
lto, lets gcc read each program as a whole, and compares the compiled code. Exit code 1 if two definitions of one name
differ.

  -Wodr                classes and enumerations with different members, bases or virtual functions
  -Wlto-type-mismatch  functions and variables of different types
  bytes                different inline functions, templates and inline variables of one type, of which a linker
                       silently takes one

Planted violations of each kind must be found first. Nothing is optimised, because inlined functions are not compared.
Equal source text then has equal bytes, since all references are relocations. Only names in namespace throng are
compared by bytes: g++ evaluates some of Eigen at compile time, depending on the file. Names of the standard library are
excluded: g++ omits unwinding code if it has seen that nothing is thrown. Unused inline functions and templates are not
compared, nor names local to a file (static, unnamed namespaces), which may repeat.
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
NAMESPACE = b"6throng"  # in a mangled name
STANDARD = (b"_ZSt", b"_ZNSt", b"_ZNKSt", b"_ZN9__gnu_cxx", b"_ZNK9__gnu_cxx")  # at the beginning of a name

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
    """Errors of gcc for a whole program, "" if there are none. Writes no machine code."""
    with tempfile.TemporaryDirectory() as scratch:
        command = ["c++", *flags("CMAKE_CXX_FLAGS"), *flags("CMAKE_EXE_LINKER_FLAGS"), "-fno-fat-lto-objects",
                   "-flinker-output=rel", "-r", "-nostdlib", *inputs, "-o", f"{scratch}/whole.o"]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    return "" if done.returncode == 0 else done.stderr


def shared_definitions(data):
    """Yield name, size and bytes of definitions that other files may share, in a 64-bit little-endian ELF file."""
    table, = struct.unpack_from("<Q", data, 0x28)
    entry, count = struct.unpack_from("<HH", data, 0x3A)
    if count == 0:  # more than 16 bits: stored in the first section
        count, = struct.unpack_from("<Q", data, table + 0x20)
    sections = [struct.unpack_from("<IIQQQQII", data, table + i * entry) for i in range(count)]
    symbols, zeros, long_homes = 2, 8, 18  # kinds of sections
    weak, unique = 2, 10                   # bindings of shared symbols
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
    """Return a report of inline definitions that differ, and the number of compared ones."""
    found = collections.defaultdict(lambda: collections.defaultdict(list))
    for path in objects:
        for name, size, content in shared_definitions((folder / path).read_bytes()):
            if NAMESPACE in name and not name.startswith(STANDARD):
                found[name][size, hash(content)].append(path)
    report = []
    for name, kinds in sorted(found.items()):
        if len(kinds) > 1:
            report.append(subprocess.run(["c++filt", name.decode()], capture_output=True, text=True,
                                       check=True).stdout.strip())
            for (size, _), paths in kinds.items():
                more = f" and {len(paths) - 1} more" if len(paths) > 1 else ""
                report.append(f"  {size} bytes in {paths[0]}{more}")
    return "\n".join(report), len(found)


def check_planted():
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        for expected, texts in PLANTED.items():
            for name, text in zip("ab", texts):
                (folder / f"{name}.cpp").write_text(text)
            subprocess.run(["c++", *flags("CMAKE_CXX_FLAGS"), "-std=c++20", "-c", "a.cpp", "b.cpp"], cwd=folder,
                           check=True)
            objects = ["a.o", "b.o"]
            report = complaint_of_linker(objects, folder) or compare_bytes(objects, folder)[0]
            if expected not in report:
                sys.exit("scripts/one_definition.py: expected two definitions to be rejected with "
                         f"'{expected}', found '{report}'")


def ninja(*arguments):
    return subprocess.run(["ninja", "-C", str(BUILD), *arguments], capture_output=True, text=True,
                          check=True).stdout.splitlines()


def programs():
    """Yield each program with Throng's objects and archives that it is linked from."""
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
    report, compared = compare_bytes(objects, BUILD)
    print(report, end="\n" if report else "", flush=True)
    rejected = 0
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as workers:
        for program, complaint in zip(linked, workers.map(lambda inputs: complaint_of_linker(inputs, BUILD),
                                                          linked.values())):
            rejected += complaint != ""
            print(f"{program}: {complaint or 'one definition of every name'}", flush=True)
    print(f"{len(objects)} objects, {compared} inline definitions compared, {len(linked)} programs, {rejected} rejected")
    sys.exit(1 if report or rejected or not linked else 0)


main()
