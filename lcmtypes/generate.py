#!/usr/bin/env python3
"""Generates code from the .lcm files in addition to lcm-gen.

generate.py FOLDER FILE.lcm ...

Writes into FOLDER/throng: `channels.hpp` (channels of a run), `messages.hpp` (all types, by channel and as lists) and
`layouts.hpp` (for each type a walk over the encoded bytes, its rules and the columns of its CSV table). Writes into
FOLDER/stubs: `_messages.pyi` and a file per type (type hints for Python). The build runs it.

Comments that begin with `//!` add properties to a .lcm file:

  //! channel NAME             above the struct: channel of the type in a run; the type begins with the common header.
                               `//! channel NAME on request`: sent by some runs only
  //! csv                      above the struct: `throng export --csv` has a table of it, with one column per field;
                               if fields are lists, with one row per item
  //! each NAME, NAME, ...     below a field of fixed length: names of its items
  //! RULE                     below a field: a condition of fields, numbers and operators of C++, for lists on each
                               item; comparisons may be chained (`0 <= a < b`)
"""
import os
import re
import sys

SIZES = {"int8_t": 1, "byte": 1, "boolean": 1, "int16_t": 2, "int32_t": 4, "float": 4, "int64_t": 8, "double": 8}
HEADER = [("int64_t", "utime"), ("int64_t", "run_id"), ("int64_t", "instance"), ("int64_t", "frame"),
          ("int64_t", "seq"), ("int32_t", "chunk"), ("int32_t", "chunk_count"), ("int32_t", "schema")]
# Length and terminating zero of an empty string.
MIN_STRING_BYTES = 5


class Field:
    def __init__(self, type_name, name, length):
        self.type, self.name, self.length = type_name, name, length
        self.each = []

    def is_list(self):
        return self.length is not None and not self.length.isdigit()

    def items(self):
        return int(self.length) if self.length and self.length.isdigit() else 1


class Struct:
    def __init__(self, file):
        self.file = file
        self.name, self.channel, self.on_request, self.csv = "", "", False, False
        self.fields, self.rules = [], []  # rules are (line, text)

    def fail(self, line, expected, found):
        sys.exit(f"{self.file}:{line}: expected {expected}, found '{found}'")

    def field(self, name):
        return next((field for field in self.fields if field.name == name), None)

    def lists(self):
        return [field for field in self.fields if field.is_list()]

    def is_count(self, field):
        return any(other.length == field.name for other in self.fields)


def note(struct, number, text):
    """Reads a comment that begins with //!."""
    channel = re.fullmatch(r"channel ([A-Z_]+)( on request)?", text)
    if channel:
        struct.channel, struct.on_request = channel[1], bool(channel[2])
    elif text == "csv":
        struct.csv = True
    elif text.startswith("each "):
        names = [name.strip() for name in text[5:].split(",")]
        if not struct.fields or struct.fields[-1].items() != len(names):
            struct.fail(number, "one name per item of the field above", text)
        struct.fields[-1].each = names
    else:
        struct.rules.append((number, text))


def read(path):
    struct = Struct(path)
    with open(path, encoding="utf-8") as file:
        lines = file.read().split("\n")
    for number, line in enumerate(lines, 1):
        code, _, comment = line.partition("//")
        code = code.strip()
        if comment.startswith("!"):
            note(struct, number, comment[1:].strip())
        if code in ("", "package throng;", "}"):
            continue
        begin = re.fullmatch(r"struct (\w+) {", code)
        field = re.fullmatch(r"(\w+) (\w+)(?:\[(\w+)\])?;", code)
        if begin:
            struct.name = begin[1]
        elif field and struct.name:
            length = field[3]
            if length and not length.isdigit() and not struct.field(length):
                struct.fail(number, "a length that is a number or a field above", length)
            struct.fields.append(Field(field[1], field[2], length))
        else:
            struct.fail(number, "a field 'TYPE NAME;' or 'TYPE NAME[LENGTH];'", code)
    if struct.name != os.path.splitext(os.path.basename(path))[0]:
        struct.fail(1, "a struct named after its file", struct.name)
    if struct.channel and [(field.type, field.name) for field in struct.fields[:8]] != HEADER:
        struct.fail(1, "the fields that every message of a run begins with", struct.name)
    return struct


class Types:
    def __init__(self, structs):
        self.by_name = {struct.name: struct for struct in structs}
        for struct in structs:
            for field in struct.fields:
                if field.type != "string" and field.type not in SIZES and field.type not in self.by_name:
                    struct.fail(1, "types of LCM or of a .lcm file", f"{field.type} {field.name}")
        self.structs = sorted(structs, key=self.depth)

    def depth(self, struct):
        inner = [self.by_name[field.type] for field in struct.fields if field.type in self.by_name]
        return 1 + max(map(self.depth, inner)) if inner else 0

    def min_bytes(self, field):
        """Returns the minimum size of one item."""
        if field.type == "string":
            return MIN_STRING_BYTES
        if field.type in SIZES:
            return SIZES[field.type]
        inner = self.by_name[field.type]
        return sum(0 if part.is_list() else self.min_bytes(part) * part.items() for part in inner.fields)

    def is_fixed(self, field):
        """Returns whether all items have the same size."""
        if field.type in self.by_name:
            return all(self.is_fixed(part) and not part.is_list() for part in self.by_name[field.type].fields)
        return field.type in SIZES

    def row_bytes(self, struct, count):
        return sum(self.min_bytes(field) for field in struct.fields if field.length == count.name)

    def has_rules(self, struct):
        return bool(struct.rules) or any(self.has_rules(self.by_name[field.type]) for field in struct.fields
                                         if field.type in self.by_name)

    def messages(self):
        """Returns the types that are not part of another."""
        inner = {field.type for struct in self.structs for field in struct.fields}
        return [struct for struct in self.structs if struct.name not in inner]

    def on_channels(self):
        return sorted((struct for struct in self.structs if struct.channel), key=lambda struct: struct.channel)


def constant(channel):
    """Returns kFrameStats for THRONG_FRAME_STATS."""
    return "k" + "".join(word.capitalize() for word in channel.split("_")[1:])


def wrapped(items, indent="    ", width=98):
    lines, line = [], indent
    for item in items:
        if len(line) + len(item) + 2 > width:
            lines.append(line.rstrip())
            line = indent
        line += item + ", "
    return "\n".join([*lines, line.rstrip(", ")])


def channels(types):
    known = types.on_channels()
    names = [f'"{struct.channel}"' for struct in known]
    on_request = [f"channel == Channel::{constant(struct.channel)}" for struct in known if struct.on_request]
    return f"""#include <array>
#include <cstdint>
#include <string_view>

namespace throng {{

/// Channels of a run, sorted by name.
enum class Channel : uint8_t {{
{wrapped(constant(struct.channel) for struct in known)}
}};
inline constexpr int kChannelCount = {len(known)};
inline constexpr std::array<Channel, kChannelCount> kAllChannels = {{
{wrapped("Channel::" + constant(struct.channel) for struct in known)}}};
inline constexpr std::array<std::string_view, kChannelCount> kChannelNames = {{
{wrapped(names)}}};

/// Returns whether only some runs send on the channel, on request.
constexpr bool is_on_request([[maybe_unused]] Channel channel) {{ return {" || ".join(on_request) or "false"}; }}

}}  // namespace throng
"""


def messages(types):
    includes = "\n".join(f'#include "throng/{name}.hpp"' for name in sorted(types.by_name))
    cases = "\n".join(f"    case Channel::{constant(struct.channel)}:\n      return f.template operator()<{struct.name}>();"
                      for struct in types.on_channels()[:-1])
    last = types.on_channels()[-1].name
    lines = ["#include <cstddef>\n", '#include "throng/channels.hpp"', includes, "", "namespace throng {", "",
             "/// X(TYPE) for every message, and for every type.",
             "#define THRONG_MESSAGES(X) " + " ".join(f"X({struct.name})" for struct in types.messages()),
             "#define THRONG_TYPES(X) " + " ".join(f"X({struct.name})" for struct in types.structs), "",
             "/// Channel of a type, or -1.", "template <class Message>",
             "inline constexpr int kChannelOf = -1;"]
    lines += [f"template <>\ninline constexpr int kChannelOf<{struct.name}> = static_cast<int>(Channel::{constant(struct.channel)});"
              for struct in types.on_channels()]
    lines += ["", "/// Calls f.operator()<TYPE>() with the type of the channel.", "template <class Function>",
              "decltype(auto) with_type_of(Channel channel, Function&& f) {", "  switch (channel) {", cases, "    default:",
              f"      return f.template operator()<{last}>();", "  }", "}", "",
              "/// Encoded bytes with fingerprint: without rows, and per row, for messages whose lists have one length.",
              "template <class Message>", "inline constexpr size_t kFixedBytes = 0;", "template <class Message>",
              "inline constexpr size_t kRowBytes = 0;"]
    for struct in types.messages():
        lists = struct.lists()
        if not lists or len({field.length for field in lists}) > 1 or not all(map(types.is_fixed, lists)):
            continue
        rest = [field for field in struct.fields if not field.is_list()]
        if not all(map(types.is_fixed, rest)):
            continue
        fixed = 8 + sum(types.min_bytes(field) * field.items() for field in rest)
        row = types.row_bytes(struct, struct.field(lists[0].length))
        lines += [f"template <>\ninline constexpr size_t kFixedBytes<{struct.name}> = {fixed};",
                  f"template <>\ninline constexpr size_t kRowBytes<{struct.name}> = {row};"]
    return "\n".join([*lines, "", "}  // namespace throng", ""])


def walk(types, struct):
    """Generates a walk over the fields; consecutive fields of fixed size are one step."""
    lines, fixed, rows = [], 0, {}

    def flush():
        nonlocal fixed, rows
        if fixed:
            lines.append(f"  c.skip({fixed});")
        for length, size in rows.items():
            lines.append(f"  c.array({length}, {size});")
        fixed, rows = 0, {}

    for field in struct.fields:
        if struct.is_count(field):
            flush()
            lines.append(f"  const size_t {field.name} = c.count({types.row_bytes(struct, field)});")
        elif types.is_fixed(field) and field.is_list():
            if fixed or (rows and field.length not in rows):
                flush()
            rows[field.length] = rows.get(field.length, 0) + types.min_bytes(field)
        elif types.is_fixed(field):
            if rows:
                flush()
            fixed += types.min_bytes(field) * field.items()
        else:
            flush()
            step = "c.string()" if field.type == "string" else f"walk(c, static_cast<const {field.type}*>(nullptr))"
            lines.append(f"  for (size_t i = 0; i < {field.length} && c.ok(); ++i) {step};" if field.length else f"  {step};")
    flush()
    return f"template <class Cursor>\nvoid walk(Cursor& c, const {struct.name}*) {{\n" + "\n".join(lines) + "\n}\n"


def condition(text):
    """Returns a rule in C++, with chained comparisons split."""
    parts = re.split(r"\s(<=|<|>=|>)\s", text)
    if len(parts) <= 3 or "&&" in text or "||" in text:
        return text
    return " && ".join(f"{parts[i]} {parts[i + 1]} {parts[i + 2]}" for i in range(0, len(parts) - 2, 2))


def rule(struct, number, text):
    names = list(dict.fromkeys(name for name in re.findall(r"[A-Za-z_]\w*", text)))
    fields = []
    for name in names:
        field = struct.field(name)
        if not field:
            struct.fail(number, f"fields of {struct.name}", name)
        fields.append(field)
    lengths = {field.length for field in fields if field.length}
    if not fields or len(lengths) > 1:
        struct.fail(number, "a rule of fields that have one length", text)
    access = {field.name: f"m.{field.name}[i]" if field.length else f"m.{field.name}" for field in fields}
    holds = re.sub(r"[A-Za-z_]\w*", lambda found: access[found[0]], condition(text))
    found = ", ".join(f"{name} {{}}" for name in names)
    values = ", ".join(access[name] for name in names)
    report = f'return fmt::format("expected {text}, found {found}", {values});'
    if not lengths:
        return f"  if (!({holds})) {report}"
    length = lengths.pop()
    count = length if length.isdigit() else f"static_cast<size_t>(m.{length})"
    return f"  for (size_t i = 0; i < {count}; ++i)\n    if (!({holds})) {report}"


def rules(types, struct):
    lines = [rule(struct, number, text) for number, text in struct.rules]
    for field in struct.fields:
        if field.type not in types.by_name or not types.has_rules(types.by_name[field.type]):
            continue
        if field.length:
            lines.append(f"  for (const auto& item : m.{field.name})\n"
                         "    if (std::string broken = broken_rule(item); !broken.empty()) return broken;")
        else:
            lines.append(f"  if (std::string broken = broken_rule(m.{field.name}); !broken.empty()) return broken;")
    unused = "" if lines else "[[maybe_unused]] "
    return f"inline std::string broken_rule({unused}const {struct.name}& m) {{\n" + "\n".join([*lines, '  return "";', "}", ""])


def table(struct):
    """Generates the columns of the fields after the header, and a function that adds the cells of a row."""
    columns, cells = [], []
    lengths = {field.length for field in struct.lists()}
    if len(lengths) > 1:
        struct.fail(1, "lists of one length for a table", ", ".join(sorted(lengths)))
    for field in struct.fields[len(HEADER):]:
        if struct.is_count(field):
            continue
        if field.is_list() or not field.length:
            columns.append(field.name)
            cells.append(f"  add(m.{field.name}{'[row]' if field.length else ''});")
        else:
            names = field.each or [f"item{i}" for i in range(field.items())]
            columns += [f"{name}_{field.name}" for name in names]
            cells.append(f"  for (const auto& cell : m.{field.name}) add(cell);")
    count = f"static_cast<size_t>(m.{lengths.pop()})" if lengths else "1"
    unused = "[[maybe_unused]] "
    return (f"inline constexpr const char* csv_columns(const {struct.name}*) {{\n"
            f'  return "{",".join(columns)}";\n}}\n'
            f"inline size_t csv_rows({unused}const {struct.name}& m) {{ return {count}; }}\n"
            f"template <class Add>\nvoid add_csv_cells(const {struct.name}& m, {unused}size_t row, const Add& add) {{\n"
            + "\n".join(cells) + "\n}\n")


def layouts(types):
    parts = ["""#include <fmt/format.h>

#include <cstddef>
#include <string>

#include "throng/messages.hpp"

namespace throng {

// walk(CURSOR, TYPE) steps over the encoded fields after the fingerprint.
"""]
    parts += [walk(types, struct) for struct in types.structs]
    parts.append("// Returns the first broken rule of the .lcm file, or \"\".\n")
    parts += [rules(types, struct) for struct in types.structs]
    parts.append("// CSV tables: columns after frame and time_s, number of rows of a message, cells of a row.\n")
    parts += [table(struct) for struct in types.on_channels() if struct.csv]
    parts.append("}  // namespace throng\n")
    return "\n".join(parts)


def python_type(field):
    words = {"float": "float", "double": "float", "boolean": "bool", "string": "str"}
    item = words.get(field.type) or ("int" if field.type in SIZES else field.type)
    if field.length is None:
        return item
    return "builtins.bytes" if field.type == "byte" else f"List[{item}]"


def stub(types, struct):
    """Type hints of the Python class that lcm-gen makes of a type."""
    used = sorted({field.type for field in struct.fields if field.type in types.by_name})
    imports = "".join(f"from .{name} import {name}\n" for name in used)
    fields = "".join(f"    {field.name}: {python_type(field)}\n" for field in struct.fields)
    # A field may be called bytes.
    return (f"import builtins\nfrom typing import BinaryIO, List, Union\n\n{imports}\nclass {struct.name}:\n"
            f"    __slots__: List[str]\n{fields}    def __init__(self) -> None: ...\n"
            "    def encode(self) -> builtins.bytes: ...\n    @staticmethod\n"
            f"    def decode(data: Union[builtins.bytes, BinaryIO]) -> {struct.name}: ...\n"
            "    @staticmethod\n    def _get_packed_fingerprint() -> builtins.bytes: ...\n")


def write_changed(path, text):
    """Keeps an unchanged file and its date, to avoid rebuilds."""
    if os.path.exists(path):
        with open(path, encoding="utf-8") as file:
            if file.read() == text:
                return
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


def main():
    folder, *files = sys.argv[1:]
    types = Types([read(path) for path in sorted(files)])
    classes = "".join(f"from .{name} import {name} as {name}\n" for name in sorted(types.by_name))
    made = {"throng/channels.hpp": channels(types), "throng/messages.hpp": messages(types),
            "throng/layouts.hpp": layouts(types), "stubs/_messages.pyi": classes}
    made.update((f"stubs/{struct.name}.pyi", stub(types, struct)) for struct in types.structs)
    for name, text in made.items():
        path = os.path.join(folder, name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        if name.endswith(".hpp"):
            text = "// Generated from the .lcm files by lcmtypes/generate.py.\n#pragma once\n\n" + text
        write_changed(path, text)


if __name__ == "__main__":
    main()
