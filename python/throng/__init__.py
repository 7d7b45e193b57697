"""Which body part of whom touches which body part of whom, in crowds.

    run(source, ...)        a scene, a recording or a log, run to its end, as arrays
    Simulation(source, ...) the same step by step
    Model(urdf)             a robot or a person: parts, joints, kinematics of many postures at once
    Culler(bodies, ...)     own bodies and own poses, without any scene
    read_log, check, render, view
    Recording, compare, scenes

Lengths are metres, times seconds, angles radians; z points up; quaternions are (x, y, z, w). Errors are
InputError (a ValueError with .file and .line) and EnvironmentFault (an OSError).

The classes of LCM messages (events_t, run_chunk_t, ...) are here, too, and need no compiled half.
"""

import importlib.util as _util

if _util.find_spec("numpy") is None:
    raise ImportError("throng needs numpy: python3-numpy of Debian, or pip install numpy", name="numpy")

from ._errors import EnvironmentFault, Error, InputError
from ._messages import *  # noqa: F403 - the classes that lcm-gen makes

# What needs numpy and the compiled half, loaded when first asked for.
_PLACES = {
    "run": "_run",
    "scenes": "_run",
    "Run": "_run",
    "Simulation": "_simulation",
    "Frame": "_simulation",
    "Model": "_model",
    "Body": "_culler",
    "Culler": "_culler",
    "read_log": "_log",
    "check": "_log",
    "LogReport": "_log",
    "render": "_log",
    "view": "_log",
    "Page": "_log",
    "Recording": "_recording",
    "compare": "_recording",
    "Comparison": "_recording",
    "Table": "_table",
}

__all__ = ["EnvironmentFault", "Error", "InputError", *_PLACES]


def __getattr__(name):
    import importlib

    if name in _PLACES:
        value = getattr(importlib.import_module("." + _PLACES[name], __name__), name)
    elif name in ("__version__", "__commit__"):
        core = importlib.import_module("._core", __name__)
        value = core.version if name == "__version__" else core.commit
    else:
        raise AttributeError(f"module 'throng' has no attribute '{name}'")
    globals()[name] = value
    return value


def __dir__():
    return sorted(set(globals()) | set(__all__))
