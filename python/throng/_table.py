"""Structured arrays that become data frames where pandas is there."""

import numpy


class Table(numpy.ndarray):
    """A structured array of numpy: ``table["begin_s"]`` is a column, ``table[3]`` a row.

    ``to_pandas()`` gives a DataFrame, with names beside the numbers of bodies, parts and groups. It can be pickled
    with these names.
    """

    def __new__(cls, rows, names=None):
        table = numpy.asarray(rows).view(cls)
        table._names = names
        return table

    def __array_finalize__(self, other):
        self._names = getattr(other, "_names", None)

    def __reduce__(self):
        rebuild, arguments, state = super().__reduce__()
        return rebuild, arguments, (state, self._names)

    def __setstate__(self, state):
        rows, self._names = state
        super().__setstate__(rows)

    def __getitem__(self, key):
        part = super().__getitem__(key)
        # A column, and what is worked out of one, is an array like any other.
        return part.view(numpy.ndarray) if isinstance(part, Table) and part.dtype.names is None else part

    def to_pandas(self):
        """A pandas.DataFrame with a column for each field, and names where there are any.

        A point or a direction becomes three columns: a_m gives point_a_x_m, point_a_y_m and point_a_z_m; normal gives normal_x, ...
        Of a table of some columns, ``table[["a", "part_a"]]``, those numbers are named whose columns are there: a
        part's needs its body's, too.
        """
        try:
            import pandas
        except ImportError as error:
            raise ImportError("to_pandas() needs pandas (python3-pandas of Debian)") from error
        frame = pandas.DataFrame(dict(_columns(self)))
        for name, values in (self._names(self) if self._names else {}).items():
            frame[name] = pandas.Categorical(values)
        return frame


def has_columns(table, *names):
    """Whether all of them are there: somebody may have selected others."""
    return all(name in table.dtype.names for name in names)


def _columns(table):
    """Names and values: of a field of several numbers each by itself, its unit last."""
    for name in table.dtype.names:
        values = numpy.asarray(table[name])
        if values.ndim == 1:
            yield name, values
            continue
        stem, unit = (name[:-2], "_m") if name.endswith("_m") else (name, "")
        for axis, letter in enumerate("xyz"):
            yield f"{stem}_{letter}{unit}", values[:, axis]
