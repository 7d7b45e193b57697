#!/usr/bin/env python3
"""Draw which folder includes which: scripts/includes.py [OUT.svg] [--top FOLDER].

A row is a folder, a column an included folder, the number the count of includes. Folders are sorted by layer, so
that allowed includes are left of the diagonal; others are red. Needs only Python.
"""
import argparse
import re
import sys
from collections import Counter
from pathlib import Path

LAYERS = ["base", "kinematics", "culling", "avatars", "geometry", "recordings", "crowd", "scenes", "lcm_io",
          "analysis", "viewer", "python", "bench", "apps"]
CELL, LABEL = 18, 190


def folder_of(path):
    return str(Path(path).parent)


def read(top):
    """Count the includes between folders: {(from, to): count}."""
    counts = Counter()
    for layer in LAYERS:
        for file in sorted((top / layer).rglob("*")):
            if file.suffix not in (".h", ".cpp"):
                continue
            source = folder_of(file.relative_to(top))
            for name in re.findall(r'^#include "([^"]+)"', file.read_text(), re.M):
                if name.split("/")[0] in LAYERS and "/" in name:
                    counts[source, folder_of(name)] += 1
    return counts


def order(counts):
    """Sort by layer; within a layer, a folder after those that it includes, if possible."""
    names = {name for pair in counts for name in pair}

    def rank(name, seen=()):
        layer = name.split("/")[0]
        below = {b for a, b in counts if a == name and b != a and b.split("/")[0] == layer}
        return 1 + max((rank(b, seen + (name,)) for b in below if b not in seen), default=0)

    return sorted(names, key=lambda n: (LAYERS.index(n.split("/")[0]), rank(n), n))


def draw(counts):
    names = order(counts)
    place = {name: i for i, name in enumerate(names)}
    size = LABEL + CELL * len(names) + 10
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {size} {size}" '
           'font-family="sans-serif" font-size="11">',
           f'<rect width="{size}" height="{size}" fill="white"/>']
    for name, i in place.items():
        at = LABEL + CELL * i
        shade = "#f3f6fa" if LAYERS.index(name.split("/")[0]) % 2 else "#e6ecf4"
        out += [f'<rect x="0" y="{at}" width="{size}" height="{CELL}" fill="{shade}"/>',
                f'<text x="{LABEL - 6}" y="{at + 13}" text-anchor="end">{name}</text>',
                f'<text transform="translate({at + 13},{LABEL - 6}) rotate(-90)">{name}</text>',
                f'<rect x="{at}" y="{at}" width="{CELL}" height="{CELL}" fill="#9fb3c8"/>']
    for (source, target), count in sorted(counts.items()):
        x, y = LABEL + CELL * place[target], LABEL + CELL * place[source]
        colour = "#c0392b" if place[target] > place[source] else "#1f3a56"
        out.append(f'<text x="{x + CELL / 2}" y="{y + 13}" text-anchor="middle" '
                   f'font-size="9" fill="{colour}">{count}</text>')
    return "\n".join(out + ["</svg>", ""])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", nargs="?", help="file to write [stdout]")
    parser.add_argument("--top", type=Path, default=Path(__file__).resolve().parent.parent,
                        help="checkout to read [this one]")
    options = parser.parse_args()
    text = draw(read(options.top))
    if options.out:
        Path(options.out).write_text(text)
    else:
        sys.stdout.write(text)


if __name__ == "__main__":
    main()
