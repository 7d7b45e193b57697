#!/usr/bin/env python3
"""Writes docs/reference/*.md and docs/gallery.md from a built tree:

    scripts/reference.py [--throng PROGRAM] [--out FOLDER]

PROGRAM [build/release/throng] prints options, keys and columns, and runs a small scene. FOLDER [docs] gets the pages.
Exit code 1 if the program prints a key or a column whose meaning scripts/reference_texts.py does not state.
"""

import argparse
import ast
import inspect
import pathlib
import re
import sqlite3
import struct
import sys
import tempfile
import textwrap

import printed_names
import reference_texts as texts
from printed_names import TOP

GENERATED = "<!-- Generated: scripts/docs.sh --update writes this page. -->\n"


class Unknown(Exception):
    """The program prints a name without a meaning."""


def cell(text):
    """Return text for a table: without a closing full stop, and with names in <> that Markdown would take for tags."""
    text = re.sub(r"<(?=\w)", "&lt;", text.replace("|", "\\|"))
    return text[:-1] if text.endswith(".") and not text.endswith("..") else text


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(cell(text) for text in row) + " |" for row in rows]) + "\n"


def code(text):
    return f"`{text}`"


def prose(text):
    return textwrap.fill(" ".join(text.split()), 118, break_long_words=False, break_on_hyphens=False) + "\n"


# ---------------------------------------------------------------- command line

def cli(program):
    top = program("--help")
    text = "# Command line\n\n" + prose(
        "Each section is the output of `throng COMMAND --help`. A default is in square brackets at the end of a line."
    )
    text += f"\n## throng\n\n```text\n{top.strip()}\n```\n"
    for command in printed_names.commands(program):
        if command != "help":
            text += f"\n## throng {command}\n\n```text\n{program(command, '--help').strip()}\n```\n"
    return text


# ---------------------------------------------------------------- keys of scene files

def number_text(value):
    return f"{value:g}" if isinstance(value, float) else str(value)


def limits(rule):
    above = rule.get("exclusiveMinimum")
    low = rule.get("minimum") if above is None else above
    high = rule.get("maximum")
    if high == 2**63 - 1:
        high = None
    if low is None and high is None:
        return ""
    low = f" above {number_text(low)}" if above is not None else f" from {number_text(low)}"
    return low + ("" if high is None else f" to {number_text(high)}")


def many(rule):
    least, most = rule.get("minItems", 0), rule.get("maxItems")
    if least and most:
        return f"list of {least}: " if least == most else f"list of {least} to {most}: "
    if least or most:
        return f"list of at least {least}: " if least else f"list of at most {most}: "
    return "list of "


def value_of(rule):
    """Return the values that a rule of the JSON Schema allows, in words."""
    if "$ref" in rule:
        name = rule["$ref"].rsplit("/", 1)[1]
        return f"[{name}](#{name})"
    if "enum" in rule:
        return ", ".join(code(word) for word in rule["enum"])
    if "anyOf" in rule and "type" not in rule:
        kinds = [each for each in rule["anyOf"] if each.get("$ref") != "#/$defs/fraction"]
        return "text" if len(kinds) == 3 else value_of(kinds[0])
    kind = rule["type"]
    if kind == "array":
        return many(rule) + value_of(rule["items"])
    names = {"boolean": "`true` or `false`", "string": "text", "integer": "integer"}
    return names.get(kind, kind) + (limits(rule) if kind in ("integer", "number") else "")


def links(text):
    """Return text with a link for each document that it names: docs/scenes.md, docs/scenes.md#doors."""
    return re.sub(r"docs/(\w+)\.md(#[\w-]+)?", r"[\1](../\1.md\2)", text)


def keys_of(rule):
    """Return the table of the keys of a map, and what may replace the map."""
    instead = [each for each in rule.get("anyOf", []) if "properties" not in each and "required" not in each]
    maps = printed_names.map_rule(rule)
    text = ""
    if instead:
        text += "\n" + prose(f"Instead of the map: {value_of(instead[0])}.")
    rows = []
    for key, value in maps["properties"].items():
        meaning, found, default = value["description"].rpartition("; without it: ")
        if not found:
            meaning, default = default.removesuffix("; required"), "required"
        rows.append((code(key), links(meaning), value_of(value), default))
    if rows:
        text += "\n" + table(("key", "meaning", "values", "default"), rows)
    if isinstance(maps.get("additionalProperties"), dict):
        text += "\n" + prose(f"Values of its keys: {value_of(maps['additionalProperties'])}.")
    choices = [" and ".join(code(key) for key in each["required"]) for each in maps.get("anyOf", []) if "required" in each]
    if choices:
        text += "\n" + prose(f"Required: {', or '.join(choices)}.")
    return text


def scene_keys(program):
    text = "# Scene keys\n\n" + prose(
        "A scene file is a YAML map with these keys. [Describe a scene](../scenes.md) shows how to use them. "
        "A number may be written as a fraction: `1/60`. An unknown key is an error. "
        "[scene.schema.json](../../scenes/scene.schema.json) states the same for editors."
    )
    for name, rule in printed_names.scene_maps(program).items():
        text += f"\n## {name}\n\n" + prose(rule["description"] + ".") + keys_of(rule)
    return text


# ---------------------------------------------------------------- columns of a study

def study_columns(program):
    head, times = program("study", "--columns").rstrip("\n").split("\n\n")

    def rows(text):
        return [(code(name), kind, meaning) for name, kind, meaning in
                (line.split(maxsplit=2) for line in text.splitlines())]

    text = "# Study columns\n\n" + prose(
        "The table of `throng study --out` has one row per run. `throng study --columns` prints its columns. An empty "
        "cell has nothing to measure."
    )
    text += "\n## Table\n\n" + table(("column", "type", "meaning"), rows(head))
    text += "\n## TABLE.times.csv\n\n" + prose(
        "Begins with `run`, `runs` and `study`. These columns depend on the machine and its load.")
    return text + "\n" + table(("column", "type", "meaning"), rows(times))


# ---------------------------------------------------------------- a small run with all outputs

class AllOutputs(printed_names.SmallRun):
    """Exports the log of the small run and runs a benchmark, for the names of columns and topics."""

    def __init__(self, program):
        super().__init__(program)
        program("export", "run.lcmlog", "--mcap", "run.mcap")
        program("bench", "--avatars", "30", "--frames", "1", "--engines", "none", "--csv", "bench.csv")

    def columns(self, file):
        return (self.folder / file).read_text().splitlines()[0].split(",")

    def channel(self, name):
        return self.program("export", "run.lcmlog", "--csv", name).splitlines()[0].split(",")

    def files(self):
        return sorted(str(file.relative_to(self.folder)) for name in ("contacts", "separation", "parts")
                      for file in (self.folder / name).iterdir())

    def sqlite(self):
        database = sqlite3.connect(self.folder / "run.sqlite")
        names = [row[0] for row in database.execute("SELECT name FROM sqlite_master WHERE type = 'table' ORDER BY rowid")]
        columns = {name: [(row[1], row[2]) for row in database.execute(f"PRAGMA table_info({name})")] for name in names}
        keys = [row[0] for row in database.execute("SELECT key FROM metadata ORDER BY rowid")]
        database.close()
        return columns, keys

    def topics(self):
        """Return topic and schema of each channel of the MCAP file, from its summary."""
        data = (self.folder / "run.mcap").read_bytes()
        schemas, topics, at = {}, {}, 8
        while at + 9 <= len(data) - 8:
            kind, size = data[at], struct.unpack_from("<Q", data, at + 1)[0]
            body = data[at + 9:at + 9 + size]
            at += 9 + size
            if kind == 3:
                schemas[struct.unpack_from("<H", body)[0]] = mcap_text(body, 2)
            elif kind == 4:
                topics[mcap_text(body, 4)] = schemas[struct.unpack_from("<H", body, 2)[0]]
        return topics


def mcap_text(body, at):
    size = struct.unpack_from("<I", body, at)[0]
    return body[at + 4:at + 4 + size].decode()


# ---------------------------------------------------------------- JSON of a run

def run_json(run):
    def documented(path):
        for pattern, name in texts.RUN_JSON_NAMES:
            path = re.sub(pattern, name, path)
        # An empty list of maps stands for all of its keys.
        return path in texts.RUN_JSON or any(key.startswith((path + "[]", path + ".")) for key in texts.RUN_JSON)

    unknown = [path for path in run.json_paths() if not documented(path)]
    names = {name.removesuffix("[]") for path in [*texts.RUN_JSON, *run.json_paths()] for name in path.split(".")}
    # Some keys need a network or a controller, so the source is searched as well.
    source = (TOP / "apps/output/run_report.cpp").read_text()
    literals = set(re.findall(r'\{"(\w+)",', source)) | set(re.findall(r'\["(\w+)"\]', source))
    unknown += sorted(literals - names)
    if unknown:
        raise Unknown(f"throng run --json: RUN_JSON lacks {', '.join(unknown)}")
    text = "# JSON of a run\n\n" + prose(
        "`throng run --json FILE` writes one JSON map with these keys; `-` writes it to stdout and nothing else there. "
        "A dot separates the keys of nested maps, and `[]` stands for the items of a list. Names in capitals stand for "
        "several keys. Keys of an option exist only with that option."
    )
    text += "\n" + table(("key", "type", "meaning"),
                         [(code(path), kind, meaning) for path, (kind, meaning) in texts.RUN_JSON.items()])
    text += "\n" + table(("name", "values"), [
        ("`STAGE` of `stage_ms`", joined(run, r"^stage_ms\.(\w+)$")),
        ("`STAGE` of `stages`", joined(run, r"^stages\.(\w+)\.volume$")),
        ("`LEVEL`", joined(run, r"^budget\.pairs\.(\w+)$")),
        ("`REGION`", "region of the body, such as `head`"),
    ])
    return text + "\n" + prose(
        "The JSON of other commands begins with the same `throng.version` and `throng.commit`.")


def joined(run, pattern):
    return ", ".join(code(match[1]) for path in run.json_paths() if (match := re.match(pattern, path)))


# ---------------------------------------------------------------- files

def column_rows(file, columns):
    """Return rows of name and meaning. Names after parts, distances or stages share a row."""
    rows = {}
    for column in columns:
        name = column
        for pattern, replacement in texts.COLUMN_PATTERNS:
            if re.fullmatch(pattern, column):
                name = re.sub(pattern, replacement, column)
        if file in ("contacts/parts.csv", "contacts/parts_seconds.csv") and column not in ("part", "obstacle"):
            name = "PART"
        meaning = texts.COLUMNS.get(f"{file.rsplit('/', 1)[-1]}:{name}", texts.COLUMNS.get(name))
        if meaning is None:
            raise Unknown(f"{file}: COLUMNS lacks {column}")
        rows[name] = meaning
    return [(code(name), meaning) for name, meaning in rows.items()]


def columns_table(file, columns):
    return table(("column", "meaning"), column_rows(file, columns))


def files(run):
    known = set(texts.TABLES) | set(texts.OTHER_FILES)
    if unknown := [file for file in run.files() if file not in known]:
        raise Unknown(f"throng run: TABLES and OTHER_FILES lack {', '.join(unknown)}")
    text = "# Files\n\n" + prose(
        "Which option writes which file, and its contents. [Find contacts](../contacts.md) shows their use. CSV files "
        "begin with a line of column names. Lengths are metres, times seconds, angles radians. An empty cell is unknown.")
    text += "\n" + table(("option", "file", "contents"), [
        ("`throng run --log FILE`", "LCM log; default `out/SCENE.lcmlog`", "[every message of the run](#logs)"),
        ("`--trajectory FILE.csv`, `FILE.sqlite`", "table, database", "[positions](#trajectories)"),
        ("`--contacts DIR`", "folder", "[contact statistics](#contacts)"),
        ("`--separation DIR`", "folder", "[distances of robots from people](#separation)"),
        ("`--part-pairs DIR`", "folder", "[tests per pair of parts](#part-pairs)"),
        ("`--json FILE`", "JSON", "[results](run-json.md)"),
        ("`--html FILE`", "HTML", "the page of `throng view` with the run"),
        ("`--checkpoint FILE`", "checkpoint", "[state for `--resume`](#checkpoints)"),
        ("`--trace-hash FILE`", "text", "[hash per frame and stage](#trace-of-hashes)"),
        ("`throng export --csv CHANNEL`", "table", "[messages of a log](#exported-tables)"),
        ("`throng export --mcap FILE`", "MCAP", "[poses and contacts](#mcap)"),
        ("`throng study --out FILE`", "table or database", "[one row per run](study-columns.md)"),
        ("`throng bench --csv FILE`", "table", "[one row per engine](#benchmarks)"),
    ])
    text += "\n## Replaced files\n\n" + prose(
        "No file changes before all options and inputs are checked. An older log under the default name is kept as "
        "`out/SCENE.previous.lcmlog`. Every other named file is replaced, except `throng bench --csv`, which appends rows.")
    text += "\n" + table(("output", "time of replacement"), [
        ("`--log`, `--trajectory`, `--trace-hash`", "start of the run"),
        ("`contacts.csv`, `proximity.csv` and `*.tij` of `--contacts`, tables of `--separation`", "start of the run"),
        ("`--html`, `--json`, `--part-pairs`, other files of `--contacts`", "end of the run, when the new file is complete"),
        ("`--checkpoint`", "each checkpoint, when the new file is complete"),
    ])
    text += "\n" + prose("A run locks its log, trajectories, trace and folders. A second run that writes them ends with "
                         "exit code 3.")
    text += "\n## Logs\n\n" + prose(
        "A log is in LCM's own format and holds the messages of [every channel](lcm.md). The same scene, seed and options "
        "give the same bytes for any number of threads. Stamps are simulation time, `instance` and clock times are 0. "
        "`--flush-s` sets the maximum delay of a frame to the file.")
    text += "\n" + prose(
        "`THRONG_CHECKSUMS` makes damage visible: any flipped bit changes a checksum. `throng check LOG` verifies "
        "numbering, checksums, hash and pairs of events. `--repair FILE` copies the messages that are not damaged.")
    text += "\n## Trajectories\n\n" + prose(
        "One row per agent in the scene and frame. `--trajectory-fps` sets the rate [10]; a recording keeps its own.")
    text += "\nCSV, `FILE.csv`:\n\n" + columns_table("run.csv", run.columns("run.csv"))
    text += "\n" + prose("SQLite, `FILE.sqlite`: the schema of JuPedSim, which PedPy reads, and two more tables.")
    columns, keys = run.sqlite()
    rows = []
    for name, fields in columns.items():
        if name not in texts.SQLITE:
            raise Unknown(f"run.sqlite: SQLITE lacks {name}")
        meanings = dict(column_rows(name, [field for field, _ in fields]))
        rows += [(code(name) if i == 0 else "", code(field), kind, meanings[code(field)])
                 for i, (field, kind) in enumerate(fields)]
    text += "\n" + table(("table", "column", "type", "meaning"), rows)
    text += "\n" + table(("table", "rows"), [(code(name), texts.SQLITE[name]) for name in columns])
    if unknown := [key for key in keys if key not in texts.METADATA]:
        raise Unknown(f"run.sqlite: METADATA lacks {', '.join(unknown)}")
    text += "\n" + table(("key of `metadata`", "value"), [(code(key), what) for key, what in texts.METADATA.items()])
    for name, heading, option, intro in (
        ("contacts", "Contacts", "--contacts",
         "A contact of two people lasts from their first touching pair of parts to the last one. With `--exact` parts "
         "touch when their triangles intersect, otherwise when their volumes overlap. The density around a person counts "
         "people within 2 m over the visible part of that circle, once per second."),
        ("separation", "Separation", "--separation", "Needs a `separation` in the scene."),
        ("parts", "Part pairs", "--part-pairs", "Counts the tests of culling."),
    ):
        text += f"\n## {heading}\n\n" + prose(f"`{option} DIR` writes these files to the folder. {intro}")
        for file, what in texts.TABLES.items():
            folder, base = file.split("/")
            if folder == name:
                text += f"\n### {base}\n\nOne row per {what}.\n\n" + columns_table(file, run.columns(file))
        others = [(code(file.split("/")[1]), what) for file, what in texts.OTHER_FILES.items() if file.startswith(name + "/")]
        text += f"\n### Other files of {option}\n\n" + table(("file", "contents"), others)
        text += "\n" + prose("A figure without data is not drawn. Figures need gnuplot.")
    text += "\n## Checkpoints\n\n" + prose(
        "`--checkpoint FILE` stores the state of the run every 60 simulated seconds, or every `--checkpoint-every S`. "
        "`--resume FILE` continues with the same scene, seed and options, and gives the same events. A checkpoint of another "
        "run or another version of Throng is rejected. The format is not stable.")
    stages = []
    for line in (run.folder / "hashes.txt").read_text().splitlines()[1:]:
        stage = line.split()[1]
        if stage not in stages:
            stages.append(stage)
    text += "\n## Trace of hashes\n\n" + prose(
        "`--trace-hash FILE` writes the line `run RUN_ID`, then a line `FRAME STAGE HASH` per frame and stage: "
        + ", ".join(code(stage) for stage in stages) + ". The first differing line shows where two runs diverge.")
    text += "\n## Exported tables\n\n" + prose(
        "`throng export LOG --csv CHANNEL` writes the messages of one channel. The sound part of an incomplete log is "
        "exported, with exit code 1.")
    for name, what in texts.CHANNELS.items():
        text += f"\n### {name}\n\n" + prose(f"One row per {what}.") + "\n" + columns_table(name, run.channel(name))
    topics = run.topics()
    if unknown := [topic for topic in topics if topic not in texts.TOPICS]:
        raise Unknown(f"run.mcap: TOPICS lacks {', '.join(unknown)}")
    text += "\n## MCAP\n\n" + prose(
        "`throng export LOG --mcap FILE` writes messages in JSON with their schemas. Times are simulation time.")
    text += "\n" + table(("topic", "schema", "contents"),
                         [(code(topic), code(topics[topic]), what) for topic, what in texts.TOPICS.items()])
    text += "\n## Benchmarks\n\n" + prose("`throng bench --csv FILE` appends one row per engine, with the columns "
                                         + ", ".join(code(name) for name in run.columns("bench.csv")) + ".")
    return text


# ---------------------------------------------------------------- LCM messages

HEADER = ["utime", "run_id", "instance", "frame", "seq", "chunk", "chunk_count", "schema"]
BYTES = {"byte": 1, "int8_t": 1, "boolean": 1, "int16_t": 2, "int32_t": 4, "float": 4, "int64_t": 8, "double": 8}


def are_alike(field, other):
    """Return whether names differ in an axis or side only, and types are equal: x_m and y_m, part_a and part_b."""
    different = [pair for pair in zip(field[0], other[0]) if pair[0] != pair[1]]
    return field[1] == other[1] and len(field[0]) == len(other[0]) and len(different) == 1 and set(different[0]) <= set("abwxyz")


class Message:
    """A type of lcmtypes/: name, description, channel, and fields with type and meaning."""

    def __init__(self, file):
        self.name, self.lines, self.channel, self.fields = file.stem, [], "", []
        inside, note = False, []
        for line in file.read_text().splitlines():
            stripped = line.strip()
            if stripped.startswith("struct "):
                inside = True
            elif stripped.startswith("//! channel "):
                self.channel = stripped.split()[2]
            elif stripped.startswith("//!"):
                if inside and stripped.startswith("//! each "):
                    self.fields[-1][2] += "; each of " + stripped.removeprefix("//! each ")
            elif stripped.startswith("//"):
                (note if inside else self.lines).append(stripped.removeprefix("//").strip())
            elif inside and (match := re.match(r"(\w+)\s+(\w+)((?:\[\w+\])?);\s*(?://\s*(.*))?", stripped)):
                kind, name, size, meaning = match.groups()
                if not meaning:
                    meaning = texts.LCM_FIELDS.get(f"{self.name}.{name}", texts.LCM_FIELDS.get(name, ""))
                if not meaning and self.fields and are_alike(self.fields[-1], (name, kind + size)):
                    meaning = '"'
                if not meaning:
                    raise Unknown(f"{file.name}: {name} has no comment, and LCM_FIELDS lacks it")
                self.fields.append([name, kind + size, meaning])
                if note:
                    self.fields[-1][2] += ". " + " ".join(note).rstrip(".")
                note = []
        names = [field[0] for field in self.fields]
        self.has_header = names[:len(HEADER)] == HEADER

    def contents(self):
        """Return the description without the channel: "CHANNEL: text", or "CHANNEL (on request): text"."""
        head, text = " ".join(self.lines).split(": ", 1)
        return ("on request: " if head.endswith("(on request)") else "") + text

    def own_fields(self):
        """Return fields without the header. Equal types that share a comment share a row."""
        rows = []
        for name, kind, meaning in self.fields[len(HEADER) if self.has_header else 0:]:
            if meaning == '"':
                rows[-1][0] += f", {code(name)}"
            else:
                rows.append([code(name), code(kind), meaning])
        return rows

    def size(self):
        """Return "64 + 12 count", or an empty text if the size depends on more than numbers."""
        fixed, per = 8, {}
        for _, kind, _ in self.fields:
            base, _, count = kind.rstrip("]").partition("[")
            if base not in BYTES:
                return ""
            if not count or count.isdigit():
                fixed += BYTES[base] * int(count or 1)
            else:
                per[count] = per.get(count, 0) + BYTES[base]
        return " + ".join([str(fixed)] + [f"{size} × `{name}`" for name, size in per.items()])


def lcm():
    messages = [Message(file) for file in sorted((TOP / "lcmtypes").glob("*.lcm"))]
    header = next(message for message in messages if message.name == "states_t")
    url = re.search(r'kDefaultLcmUrl =\s*"([^"]+)"', (TOP / "lcm_io/codec/channels.h").read_text())[1]
    text = "# LCM messages\n\n" + prose(
        "A run is a stream of messages on these channels, on the network (`throng run --lcm URL`) and in a log "
        "(`--log FILE`). The types are the files of [lcmtypes](../../lcmtypes). [Control a robot](../control.md) and "
        "[Find contacts](../contacts.md) show their use.")
    text += f"\nThe default URL stays on this machine:\n\n```text\n{url}\n```\n"
    text += "\n" + prose(
        "Set `recv_buf_size` in every receiver; the default of Linux holds three large messages. LCM has no "
        "authentication: use it on trusted networks only. Throng checks every received message before it decodes it.")
    text += "\n## Channels\n\n" + table(("channel", "type", "contents"), [
        (code(each.channel), f"[{each.name}](#{each.name})", each.contents()) for each in messages if each.channel])
    text += "\n" + prose("A scene or an option names these channels:") + "\n" + table(("channel", "type", "meaning"), [
        ("`CHANNEL`", "[pose_command_t](#pose_command_t)", "commands to a group with `control_channel: CHANNEL`"),
        ("`CHANNEL`", "[crowd_change_t](#crowd_change_t)", "changes of the crowd of a scene with `change_channel: CHANNEL`"),
        ("`CHANNEL_REQUEST`", "[step_request_t](#step_request_t)", "`--lockstep`: Throng asks for the next poses"),
        ("`CHANNEL_REPLY`", "[step_reply_t](#step_reply_t)", "`--lockstep`: the controller answers"),
        ("`CHANNEL_EVENTS`", "[events_t](#events_t)", "`--publish-for WHO:CHANNEL`: events of these bodies"),
        ("`CHANNEL_PROXIMITY`", "[proximity_t](#proximity_t)", "`--publish-for`: proximity rows of these bodies"),
        ("`CHANNEL_STAMP`", "[stamp_t](#stamp_t)", "`--publish-for`: clock times, after the two others"),
    ])
    text += "\n## Common fields\n\nMessages of a run begin with these fields; the tables below omit them.\n\n" + table(
        ("field", "type", "meaning"), [(code(name), code(kind), meaning if meaning != '"' else "number of messages of the set")
                                       for name, kind, meaning in header.fields[:len(HEADER)]])
    text += "\n" + prose(
        "A message has at most 60 000 bytes and fits into one UDP datagram. Larger contents are split into chunks. Avatars "
        "have the body ids from 0, followed by the obstacles. Parts are numbered within their model.")
    text += "\n## Units\n\n" + table(("quantity", "encoding", "maximum error"), [
        ("position", "int32, 0.1 mm, up to 214 km from the origin", "0.05 mm per axis"),
        ("orientation", "quaternion, int16, 1/32767", "6.2e-5 rad"),
        ("joint position", "int16: `column_middle[c] + column_half[c] * q / 32767` of the model", "`column_half` / 65534"),
        ("speed", "float", "none"),
    ])
    text += "\n" + prose("A value out of range is set to the nearest in range and counted in `clamped`.")
    text += "\n## Sizes\n\nEncoded bytes of a message, with its fingerprint of 8 bytes.\n\n" + table(
        ("type", "bytes"), [(code(each.name), each.size()) for each in messages if each.has_header and each.size()])
    text += "\n## Types\n"
    for each in messages:
        text += f"\n### {each.name}\n\n" + prose(" ".join(each.lines)) + "\n" + table(("field", "type", "meaning"), each.own_fields())
    return text


# ---------------------------------------------------------------- Python module

def sections_of(doc):
    """Return the sections of a docstring: heading ("" for the text) and lines."""
    sections = [("", [])]
    for line in inspect.cleandoc(doc).splitlines():
        if match := re.fullmatch(r"(Args|Attributes|Returns|Raises|Columns|Methods):", line):
            sections.append((match[1], []))
        elif line[:1].strip() and sections[-1][0]:
            sections.append(("", [line]))  # text after a section
        else:
            sections[-1][1].append(line)
    return sections


def named_item(item):
    """Return name and meaning of "name: meaning." or "names (meaning)."."""
    name, found, meaning = item.partition(": ")
    if found:
        return name, meaning
    name, found, meaning = item.rstrip(".").partition(" (")
    return name, meaning.removesuffix(")")


def docstring(doc):
    text = ""
    heads = {"Args": "argument", "Attributes": "attribute", "Raises": "exception", "Columns": "column",
             "Methods": "method"}
    for heading, lines in sections_of(doc):
        body = "\n".join(lines)
        if not heading:
            for paragraph in re.split(r"\n\s*\n", body.strip()):
                text += ("\n" + prose(paragraph)) if paragraph.strip() else ""
            continue
        items = []
        for line in textwrap.dedent(body).splitlines():
            if line.startswith(" ") and items:
                items[-1] += " " + line.strip()
            elif line.strip():
                items.append(line.strip())
        if heading == "Returns":
            text += "\n" + prose("Returns: " + " ".join(items))
        else:
            text += "\n" + table((heads[heading], "meaning"), [named_item(item) for item in items])
    return text


def signature(name, node, is_method=False):
    arguments = ast.unparse(node.args)
    if is_method:
        arguments = re.sub(r"^self(, )?", "", arguments)
    text = f"{name}({arguments})"
    lines = textwrap.wrap(text, 110, subsequent_indent=" " * 4, break_long_words=False)
    return "\n```text\n" + "\n".join(lines) + "\n```\n"


def python_member(name, node):
    if isinstance(node, ast.FunctionDef):
        return f"\n## throng.{name}\n" + signature(name, node) + docstring(ast.get_docstring(node, clean=False) or "")
    methods = [each for each in node.body if isinstance(each, ast.FunctionDef)]
    text = f"\n## throng.{name}\n"
    start = next((each for each in methods if each.name == "__init__"), None)
    if start is not None and name not in ("Run", "Frame", "Comparison", "Page", "LogReport"):
        text += signature(name, start, is_method=True)
    return text + docstring(ast.get_docstring(node, clean=False) or "") + python_methods(name, node)


def python_methods(name, node):
    """Return a section for each public method of a class."""
    text = ""
    for each in node.body:
        doc = ast.get_docstring(each, clean=False) if isinstance(each, ast.FunctionDef) else None
        if doc and not each.name.startswith("_"):
            text += f"\n### {name}.{each.name}\n" + signature(each.name, each, is_method=True) + docstring(doc)
    return text


def python_scenes(folder, names):
    """Return the section on the classes of scene keys, whose arguments are in the reference of these keys."""
    members = {node.name: node for node in ast.parse((folder / "_scene.py").read_text()).body if isinstance(node, ast.ClassDef)}
    text = "\n## Classes of scene keys\n\n" + prose(", ".join(code(f"throng.{name}") for name in names))
    text += "\n" + prose(
        "The arguments of a class are the keys of its map in the [reference of scene keys](scene-keys.md); each is also an "
        "attribute. A shapely geometry, or an array of N corners, stands for an area.")
    return text + python_methods("Scene", members["SceneText"]) + python_methods("Scene", members["SceneMap"])


def python():
    folder = TOP / "python/throng"
    places = printed_names.python_places()
    places.update({name: "_errors" for name in ("Error", "InputError", "EnvironmentFault")})
    text = "# Python module\n\n" + prose(
        "Every name of the module `throng`, from its docstrings. [Use Throng from Python](../python.md) has examples. "
        "Units are metres, seconds and radians; z points up. Quaternions are (x, y, z, w). A default is in square brackets. "
        "The module also has a class for each [LCM type](lcm.md).")
    for name, place in places.items():
        if place == "_scene_keys":
            continue
        nodes = ast.parse((folder / f"{place}.py").read_text()).body
        text += python_member(name, next(node for node in nodes if getattr(node, "name", None) == name))
    return text + python_scenes(folder, [name for name, place in places.items() if place == "_scene_keys"])


# ---------------------------------------------------------------- gallery

def gallery(program):
    text = "# Gallery\n\n" + prose(
        "The bundled scenes; `throng scenes` lists them. Each picture shows a frame of a log, drawn by the commands below it. "
        "[Describe a scene](scenes.md) explains their files.")
    descriptions = dict(line.split(maxsplit=1) for line in program("scenes").splitlines())
    for name in sorted(descriptions, key=lambda name: (name not in texts.PICTURES, name)):
        text += f"\n## {name}\n\n{descriptions[name]}. [{name}.yaml](../scenes/bundled/{name}.yaml)\n"
        if name in texts.PICTURES:
            seconds, frame, camera = texts.PICTURES[name]
            text += (f"\n![{name}](pictures/{name}.png)\n\n```sh\n"
                     f"throng run {name} --seconds {seconds} --lcm off --log {name}.lcmlog\n"
                     f"throng render {name}.lcmlog --frame {frame}{camera} --out {name}.png\n```\n")
        else:
            text += f"\n```sh\nthrong run {name} --lcm off --log {name}.lcmlog\n```\n"
    return text


# ---------------------------------------------------------------- all pages

def pages(program):
    run = AllOutputs(program)
    return {
        "reference/cli.md": cli(program),
        "reference/scene-keys.md": scene_keys(program),
        "reference/study-columns.md": study_columns(program),
        "reference/run-json.md": run_json(run),
        "reference/files.md": files(run),
        "reference/lcm.md": lcm(),
        "reference/python.md": python(),
        "gallery.md": gallery(program),
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--throng", default=TOP / "build/release/throng", help="program [build/release/throng]")
    parser.add_argument("--out", default=TOP / "docs", help="folder of the pages [docs]")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        try:
            written = pages(printed_names.Program(options.throng, folder))
        except (Unknown, printed_names.ProgramError) as error:
            print(f"scripts/reference.py: {error}", file=sys.stderr)
            return 1
    for name, text in written.items():
        file = pathlib.Path(options.out) / name
        file.parent.mkdir(parents=True, exist_ok=True)
        head, rest = text.split("\n", 1)
        file.write_text(f"{head}\n\n{GENERATED}{rest}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
