"""Structured arrays that become data frames where pandas is there."""

import numpy


class Table(numpy.ndarray):
    """A structured array of numpy: ``table["begin_s"]`` is a column, ``table[3]`` a row.

    ``to_pandas()`` gives a DataFrame, with names beside the numbers of bodies, parts and groups.
    """

    def __new__(cls, rows, names=None):
        table = numpy.asarray(rows).view(cls)
        table._names = names
        return table

    def __array_finalize__(self, other):
        self._names = getattr(other, "_names", None)

    def __getitem__(self, key):
        part = super().__getitem__(key)
        # A column, and what is worked out of one, is an array like any other.
        return part.view(numpy.ndarray) if isinstance(part, Table) and part.dtype.names is None else part

    def to_pandas(self):
        """A pandas.DataFrame with a column for each field, and names where there are any."""
        try:
            import pandas
        except ImportError as error:
            raise ImportError("to_pandas() needs pandas (python3-pandas of Debian)") from error
        frame = pandas.DataFrame({name: numpy.asarray(self[name]) for name in self.dtype.names})
        for name, values in (self._names(self) if self._names else {}).items():
            frame[name] = pandas.Categorical(values)
        return frame
