"""What users give as numbers, turned into arrays; what is none is refused in words."""

import os
from numbers import Real

import numpy

from ._errors import InputError


def refused(where, expected, found):
    """The InputError, to be raised."""
    return InputError(f"{where}: expected {expected}, found {found}", where)


def shown(value):
    """The beginning of what somebody gave, on one line."""
    try:
        text = " ".join(repr(value).split())
    except ValueError:  # a whole number of more than 4300 digits
        return f"a {type(value).__name__} too long to be written"
    return text if len(text) <= 60 else text[:57] + "..."


def _array(where, value, expected):
    try:
        array = numpy.asarray(value)
    except ValueError:  # rows of different lengths
        raise refused(where, expected, shown(value)) from None
    if array.dtype == object:  # None among them, whole numbers of more than 64 bits
        if not all(isinstance(item, Real) for item in array.flat):
            raise refused(where, expected, shown(value))
        array = array.astype(float)
    if array.dtype.kind not in "biuf":
        raise refused(where, expected, f"an array of {array.dtype}")
    return array


def numbers(where, value, expected="numbers", shape=None):
    """An array of doubles; shape: lengths of its axes, None where any will do."""
    array = _array(where, value, expected)
    fits = shape is None or (
        array.ndim == len(shape) and all(want in (None, have) for want, have in zip(shape, array.shape))
    )
    if not fits:
        raise refused(where, expected, f"an array {array.shape}" if array.ndim else shown(value))
    return numpy.ascontiguousarray(array, dtype=float).reshape(array.shape)


def wholes(where, value, expected="whole numbers"):
    """An array of 64-bit integers of one axis, of whatever type whose values are whole."""
    array = _array(where, value, expected)
    if array.ndim != 1:
        raise refused(where, f"{expected} in one row", f"an array {array.shape}" if array.ndim else shown(value))
    if array.dtype.kind == "b" and len(array):
        raise refused(where, expected, f"an array of {array.dtype}")
    odd = numpy.zeros(len(array), dtype=bool)
    if array.dtype.kind == "f":
        odd = ~(numpy.isfinite(array) & (array == numpy.floor(array)) & (numpy.abs(array) < 2.0**63))
    elif array.dtype.kind == "u":
        odd = array > numpy.uint64(2**63 - 1)
    if odd.any():
        first = int(odd.argmax())
        raise refused(f"{where}[{first}]", "a whole number", array[first])
    return array.astype(numpy.int64)


def whole(where, value, low, high=None):
    """One number from low to high; as an index of Python it may be of any integral type."""
    expected = f"a whole number from {low}" + ("" if high is None else f" to {high}")
    try:
        number = value.__index__()
    except (AttributeError, TypeError):
        raise refused(where, expected, shown(value)) from None
    if number < low or (high is not None and number > high):
        raise refused(where, expected, number if number.bit_length() <= 256 else f"one of {number.bit_length()} bits")
    return number


def path_of(where, value, expected="the name of a file"):
    """A path as text."""
    try:
        path = os.fsdecode(os.fspath(value))
    except TypeError:
        raise refused(where, expected, shown(value)) from None
    if "\0" in path:
        raise refused(where, expected, shown(value))
    return path
