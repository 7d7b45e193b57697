"""Wording: how often the sources and documents use words that Throng avoids, against the most that is allowed.

wording_test.py ROOT [WHERE...]: reads ROOT/tests/structure/wording.txt, prints a line for each row, and exits with 1 if
a count is above its limit. WHERE restricts the count to these folders or files, and prints each place.
"""
import pathlib
import re
import sys

SUFFIXES = {".h", ".cpp", ".ts", ".py", ".md"}
SKIPPED = {"build", ".git", "node_modules", "out"}
GENERATED = ("docs/reference/", "python/throng/_scene_keys.py", "docs/gallery.md", "docs/paper/", "docs/validation/")
MAX_WORDS = 25


def files_of(root):
    for path in sorted(root.rglob("*")):
        inside = path.relative_to(root)
        if path.suffix in SUFFIXES and not SKIPPED & set(inside.parts) and path.is_file():
            if not str(inside).startswith(GENERATED):
                yield inside, path.read_text(encoding="utf-8")


def rows_of(table):
    for line in table.read_text(encoding="utf-8").splitlines():
        if line.strip() and not line.startswith("#"):
            limit, pattern, advice = (part.strip() for part in line.split("\t"))
            yield int(limit), pattern, advice


def prose_of_document(text):
    """Paragraphs and list items: no code blocks, tables, headings and comments."""
    text = re.sub(r"```.*?```", "\n\n", text, flags=re.S)
    text = re.sub(r"<!--.*?-->", "\n\n", text, flags=re.S)
    lines = ("" if re.match(r"\s*(\||#|!\[)", line) else line for line in text.splitlines())
    return re.split(r"\n\s*\n|\n\s*(?:[-*]|\d+\.) ", "\n".join(lines))


def prose_of_source(text, suffix):
    """Comments, neighbouring lines joined."""
    if suffix == ".py":
        found = re.findall(r'"""(.*?)"""', text, flags=re.S)
        mark = r"[ \t]*# ?(.*)"
    else:
        found = re.findall(r"/\*(.*?)\*/", text, flags=re.S)
        mark = r"[ \t]*//[/!]? ?(?!<)(.*)"
        found += re.findall(r"//[/!]< ?(.*)", text)
    block = []
    for line in text.splitlines() + [""]:
        match = re.fullmatch(mark, line)
        if match:
            block.append(match.group(1))
        elif block:
            found += re.split(r"\n\s*\n|\n\s*- ", "\n".join(block))
            block = []
    return found


def long_sentences(paragraphs):
    for paragraph in paragraphs:
        text = re.sub(r"`[^`]*`", "x", " ".join(paragraph.split()))
        for sentence in re.split(r"(?<=[.?!:;])\s+(?=[A-Z`(\"'0-9*\[])", text):
            if len(re.findall(r"[A-Za-z0-9][\w'\-./]*", sentence)) > MAX_WORDS:
                yield sentence


def main():
    root = pathlib.Path(sys.argv[1])
    chosen = tuple(sys.argv[2:])
    texts = [(name, text) for name, text in files_of(root) if not chosen or str(name).startswith(chosen)]
    failed = False

    def report(limit, count, what):
        nonlocal failed
        failed |= count > limit
        print(f"{count:6} of {limit:4}  {what}{'' if count <= limit else '  <- too many'}")

    for limit, pattern, advice in rows_of(root / "tests/structure/wording.txt"):
        expression = re.compile(pattern)
        count = 0
        for name, text in texts:
            for number, line in enumerate(text.splitlines(), 1):
                if expression.search(line):
                    count += 1
                    if chosen:
                        print(f"{name}:{number}: {line.strip()[:140]}")
        report(limit, count, f"{pattern}  ## {advice}")
    in_documents = in_comments = 0
    for name, text in texts:
        is_document = name.suffix == ".md"
        prose = prose_of_document(text) if is_document else prose_of_source(text, name.suffix)
        found = list(long_sentences(prose))
        if chosen:
            for sentence in found:
                print(f"{name}: long: {sentence[:160]}")
        if is_document:
            in_documents += len(found)
        else:
            in_comments += len(found)
    report(80, in_documents, f"sentences of more than {MAX_WORDS} words in documents")
    report(100, in_comments, f"sentences of more than {MAX_WORDS} words in comments")
    sys.exit(1 if failed else 0)


main()
