"""Logs: reading, checking and pictures."""

import html
import os
import tempfile

from . import _core
from ._validation import integer, numbers, path_of
from ._run import Run, progress_of


def read_log(file, trajectory_fps=None, trajectories=True, progress=None):
    """Read a log written by `throng run` or run(..., log=FILE); return a Run.

    The sound part of a damaged log is read. Run.summary["left_out"] counts the unreadable places, Run.notes describe
    the missing or altered parts, and check() reports them in full. Ctrl-C raises KeyboardInterrupt.

    Args:
        file: path of the log.
        trajectory_fps: positions per second in Run.trajectories [all in the log].
        trajectories: False leaves Run.trajectories empty.
        progress: as in run().
    """
    facts = _core.read_log(path_of("file", file), trajectory_fps, trajectories, progress_of(progress))
    facts["notes"] += _missing(**facts["summary"])
    return Run(facts, log=path_of("file", file), request={"source": path_of("file", file)})


def _missing(frames, finished, left_out, damage):
    """Return one line for each missing or altered part of a log."""
    notes = list(damage)
    if left_out:
        places, are = ("1 place", "is") if left_out == 1 else (f"{left_out} places", "are")
        notes.append(f"{places} of the log cannot be read and {are} left out; check() lists them")
    if not finished:
        count = "1 frame" if frames == 1 else f"{frames} frames"
        notes.append(f"the log breaks off after {count}: the end of the run and its hash are missing")
    return notes


class LogReport(dict):
    """Result of check(): a dict that is true if the log is sound and finished.

    Keys: sound, finished, cut_off (a sentence, or ""), problems (one line each), messages, bytes, begins, ends,
    open_pairs (contacts without an end), frames, seconds, ...
    """

    def __bool__(self):
        return self["sound"] and self["finished"]


def check(file):
    """Check numbering, checksums and paired events of a log, as `throng check` does; return a LogReport."""
    return LogReport(_core.check(path_of("file", file)))


def render(log, frame, width=1280, height=720, eye_m=None, target_m=None):
    """Return a picture of one frame of a log: height x width x 3, uint8 (red, green, blue).

    Args:
        log: path of the log.
        frame: number of the frame, from 0.
        width, height: size of the picture in pixels, 16 to 8192.
        eye_m, target_m: position of the camera and the point it looks at, x, y, z in metres [shows the whole crowd].
    """
    return _core.render(
        path_of("log", log), integer("frame", frame, 0, 2**63 - 1),
        integer("width", width, 16, 8192), integer("height", height, 16, 8192),
        *(value if value is None else numbers(name, value, "three numbers x, y, z in metres", (3,)).tolist()
          for name, value in (("eye_m", eye_m), ("target_m", target_m))),
    )


class Page:
    """Web page that shows a run in 3-D. A notebook shows it; save() writes it to a file.

    Attributes:
        html: text of the page.
        height: height in a notebook, in pixels.
    """

    def __init__(self, text, height=540):
        self.html = text
        self.height = height

    def save(self, file):
        with open(file, "w", encoding="utf-8") as out:
            out.write(self.html)

    def _repr_html_(self):
        return (
            f'<iframe srcdoc="{html.escape(self.html)}" width="100%" height="{self.height}" '
            'style="border: 0" allowfullscreen></iframe>'
        )

    def __repr__(self):
        return f"<throng.Page of {len(self.html) / 1e6:.1f} MB: a notebook shows it, save(FILE) writes it>"


def view(log, limit_mb=25, height=540):
    """Return the Page of a log, or of a Run made with view=True or log=FILE.

    Args:
        log: path of a log, or a Run.
        limit_mb: maximum size of the page of a log, in MB; a larger page is an InputError.
        height: height of the page in a notebook, in pixels.
    """
    if isinstance(log, Run):
        return log.view()
    with tempfile.TemporaryDirectory() as folder:
        page = os.path.join(folder, "page.html")
        _core.write_page(path_of("log", log), page, limit_mb)
        with open(page, encoding="utf-8") as file:
            return Page(file.read(), height)
