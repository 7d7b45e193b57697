"""Exceptions of this module."""

import re


class Error(Exception):
    """Base class of InputError and EnvironmentFault."""


class InputError(Error, ValueError):
    """Invalid input: a file, a scene, an option or an array.

    ``str(error)`` is one line, "where: expected ..., found ...".

    Attributes:
        where: the beginning of the message: "file:line", a file, or an argument.
        file: the file, or None if the cause is not a file.
        line: the line in the file, from 1, or None.
    """

    def __init__(self, message, where=""):
        option = re.match(r"--[a-z]", where)
        # Messages of the compiled module name options as the command does.
        super().__init__(re.sub(r"--([a-z][a-z-]*)", lambda m: m[1].replace("-", "_"), message))
        self.where = where.lstrip("-").replace("-", "_") if option else where
        at_line = re.fullmatch(r"(?s)(.+):(\d+)", where)
        self.file = at_line[1] if at_line else None
        self.line = int(at_line[2]) if at_line else None
        if self.file is None and not option and _is_named_as_file(where):
            self.file = where

    def __reduce__(self):
        return (_restore, (type(self), self.args, self.__dict__))


def _is_named_as_file(where):
    return bool(re.search(r"/|\.[A-Za-z0-9]{1,7}$", where)) and " " not in where.strip()


def _restore(kind, args, state):
    error = kind.__new__(kind, *args)
    error.args = args
    error.__dict__.update(state)
    return error


class EnvironmentFault(Error, OSError):
    """A fault of the environment: a full disk, a missing folder, a missing program."""

    def __init__(self, message, where=""):
        super().__init__(message)


for _kind in (Error, InputError, EnvironmentFault):
    _kind.__module__ = "throng"
