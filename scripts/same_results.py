#!/usr/bin/env python3
"""Compare the results of two builds of throng, to the bit.

same_results.py OLD NEW [--seconds S] [--scene NAME ...]

Run every bundled scene with both programs. Compare event hashes, counters, and the shared columns of the tables that
`throng export` makes of the logs; then the counts of `throng paper`. Times, run ids and file sizes are ignored. Exit
code 1 if results differ. Use it before and after a change that must not change results.
"""
import argparse
import csv
import io
import json
import os
import re
import subprocess
import sys
import tempfile

TABLES = ("events", "states", "touching", "proximity", "contact_points", "separation", "frame_stats")
# Members of `run --json` that depend on time, memory or the build.
VARIES = re.compile(r"(_ms|_ns|wall_s|_bytes|_factor)$|^(throng|run_id|log|lcm|machine|threads)$")
# Members of `paper --json` that do not depend on time.
COUNTS = ("collisions", "n_v", "n_u", "false_positive_rate", "tests", "updates")


def without_times(value):
    if isinstance(value, dict):
        return {key: without_times(member) for key, member in value.items() if not VARIES.search(key)}
    if isinstance(value, list):
        return [without_times(member) for member in value]
    return value


def counts(tables):
    return {name: {key: row[key] for key in COUNTS if key in row} for name, row in tables.items()}


def read_json(program, arguments, path):
    done = subprocess.run([program, *arguments, "--json", path], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    if done.returncode != 0:
        sys.exit(f"{program} {' '.join(arguments)}: exit code {done.returncode}: {done.stderr}")
    with open(path) as file:
        return json.load(file)


def table_of(program, log, name):
    """Return a table of the log, by column."""
    done = subprocess.run([program, "export", log, "--csv", name], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if done.returncode != 0:
        sys.exit(f"{program} export --csv {name}: exit code {done.returncode}: {done.stderr}")
    names, *rows = csv.reader(io.StringIO(done.stdout))
    return dict(zip(names, zip(*rows))) if rows else dict.fromkeys(names, ())


def run_of(program, scene, seconds, folder):
    """Return the results of a run of `scene`: counters, hash, and a table for each channel of its log."""
    log = os.path.join(folder, "run.lcmlog")
    if os.path.exists(log):
        os.remove(log)
    arguments = ["run", scene, "--seconds", str(seconds), "--lcm", "off", "--log", log]
    found = {"run": without_times(read_json(program, arguments, os.path.join(folder, "run.json")))}
    for table in TABLES:
        found[table] = table_of(program, log, table)
    return found


def of_both(old, new):
    """Keep the columns that both runs have."""
    for table in TABLES:
        if table in old and table in new:
            shared = old[table].keys() & new[table].keys()
            old[table], new[table] = ({name: side[table][name] for name in shared} for side in (old, new))
    return old, new


def paper_of(program, folder):
    tables = read_json(program, ["paper"], os.path.join(folder, "paper.json"))
    return {"totals": tables["paper_totals"], "volumes": counts(tables["volumes"]),
            "strategies": counts(tables["strategies"])}


def differences(old, new, where=""):
    if isinstance(old, dict) and isinstance(new, dict):
        for key in sorted(old.keys() | new.keys()):
            yield from differences(old.get(key), new.get(key), f"{where}.{key}" if where else key)
    elif old != new:
        short = isinstance(old, (int, float, str)) and isinstance(new, (int, float, str))
        yield f"{where}: {old!r} and {new!r}" if short else f"{where} differs"


def compare(name, old, new):
    found = list(differences(*of_both(old, new)))
    hash_text = old["run"]["hash"] if "run" in old else ""
    print(f"{name:<24} {hash_text:<16} {'; '.join(found) if found else 'same'}", flush=True)
    return bool(found)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old", help="a build/.../throng")
    parser.add_argument("new", help="the build to compare with it")
    parser.add_argument("--seconds", type=float, default=2, help="simulated time of each scene [2]")
    parser.add_argument("--scene", nargs="+", help="these scenes only, without the paper's tables")
    options = parser.parse_args()

    bundled = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "scenes", "bundled")
    scenes = options.scene or sorted(name[:-5] for name in os.listdir(bundled) if name.endswith(".yaml"))
    unlike = 0
    with tempfile.TemporaryDirectory() as folder:
        for scene in scenes:
            runs = [run_of(program, scene, options.seconds, folder) for program in (options.old, options.new)]
            unlike += compare(scene, *runs)
        if not options.scene:
            unlike += compare("paper", *(paper_of(program, folder) for program in (options.old, options.new)))
    print(f"{unlike} differ" if unlike else "all the same")
    return 1 if unlike else 0


if __name__ == "__main__":
    sys.exit(main())
