"""Conversion of arguments to arrays, with an InputError for unsuitable values."""

import os
from numbers import Real

import numpy

from ._errors import InputError


def input_error(where, expected, found):
    """Return the InputError to raise."""
    return InputError(f"{where}: expected {expected}, found {found}", where)


def abbreviated(value):
    """Return the beginning of a value, on one line."""
    try:
        text = " ".join(repr(value).split())
    except ValueError:  # a whole number of more than 4300 digits
        return f"a {type(value).__name__} too long to be written"
    return text if len(text) <= 60 else text[:57] + "..."


def _array(where, value, expected):
    try:
        array = numpy.asarray(value)
    except ValueError:  # rows of different lengths
        raise input_error(where, expected, abbreviated(value)) from None
    if array.dtype == object:  # None among them, whole numbers of more than 64 bits
        if not all(isinstance(item, Real) for item in array.flat):
            raise input_error(where, expected, abbreviated(value))
        array = array.astype(float)
    if array.dtype.kind not in "biuf":
        raise input_error(where, expected, f"an array of {array.dtype}")
    return array


def numbers(where, value, expected="numbers", shape=None):
    """Return an array of doubles. shape: lengths of its axes, None for any length."""
    array = _array(where, value, expected)
    fits = shape is None or (
        array.ndim == len(shape) and all(want in (None, have) for want, have in zip(shape, array.shape))
    )
    if not fits:
        raise input_error(where, expected, f"an array {array.shape}" if array.ndim else abbreviated(value))
    return numpy.ascontiguousarray(array, dtype=float).reshape(array.shape)


def integers(where, value, expected="whole numbers"):
    """Return a one-dimensional array of 64-bit integers, from any type with whole values."""
    array = _array(where, value, expected)
    if array.ndim != 1:
        raise input_error(where, f"{expected} in one row", f"an array {array.shape}" if array.ndim else abbreviated(value))
    if array.dtype.kind == "b" and len(array):
        raise input_error(where, expected, f"an array of {array.dtype}")
    invalid = numpy.zeros(len(array), dtype=bool)
    if array.dtype.kind == "f":
        invalid = ~(numpy.isfinite(array) & (array == numpy.floor(array)) & (numpy.abs(array) < 2.0**63))
    elif array.dtype.kind == "u":
        invalid = array > numpy.uint64(2**63 - 1)
    if invalid.any():
        first = int(invalid.argmax())
        raise input_error(f"{where}[{first}]", "a whole number", array[first])
    return array.astype(numpy.int64)


def integer(where, value, low, high=None):
    """Return a number from low to high. Like an index in Python it may have any integral type."""
    expected = f"a whole number from {low}" + ("" if high is None else f" to {high}")
    try:
        number = value.__index__()
    except (AttributeError, TypeError):
        raise input_error(where, expected, abbreviated(value)) from None
    if number < low or (high is not None and number > high):
        raise input_error(where, expected, number if number.bit_length() <= 256 else f"one of {number.bit_length()} bits")
    return number


def path_of(where, value, expected="the name of a file"):
    """Return a path as text."""
    try:
        path = os.fsdecode(os.fspath(value))
    except TypeError:
        raise input_error(where, expected, abbreviated(value)) from None
    if "\0" in path:
        raise input_error(where, expected, abbreviated(value))
    return path
