"""Structured arrays that convert to data frames."""

from html import escape

import numpy

# Maximum number of rows that a notebook shows.
_SHOWN = 20


class Table(numpy.ndarray):
    """A structured numpy array: ``table["begin_s"]`` is a column, ``table[3]`` a row.

    ``to_pandas()`` returns a DataFrame and adds columns of names. A pickled table keeps these names.
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
        # A column, and any array computed from it, is a plain array.
        return part.view(numpy.ndarray) if isinstance(part, Table) and part.dtype.names is None else part

    def _repr_html_(self):
        shown = self if len(self) <= _SHOWN else self[[*range(_SHOWN // 2), *range(-_SHOWN // 2, 0)]]
        columns = {**dict(_columns(shown)), **(self._names(shown) if self._names else {})}
        rows = [f"<tr>{''.join(f'<td>{escape(_text(value))}</td>' for value in row)}</tr>" for row in zip(*columns.values())]
        if shown is not self:
            rows.insert(_SHOWN // 2, f"<tr>{'<td>...</td>' * len(columns)}</tr>")
        head = "".join(f"<th>{escape(name)}</th>" for name in columns)
        return f"<table><thead><tr>{head}</tr></thead><tbody>{''.join(rows)}</tbody></table><p>{len(self)} rows</p>"

    def to_pandas(self):
        """Return a pandas.DataFrame with a column per field, and columns of names.

        A point or direction becomes three columns: point_a_m becomes point_a_x_m, point_a_y_m and point_a_z_m; normal
        becomes normal_x, normal_y and normal_z. Names are added: body_a_name and body_a_is_person (False: a robot or an
        obstacle) to body_a, part_a_name to body_a and part_a, level_name to level.
        """
        try:
            import pandas
        except ImportError as error:
            raise ImportError("to_pandas() needs pandas (python3-pandas of Debian)") from error
        frame = pandas.DataFrame(dict(_columns(self)))
        for name, values in (self._names(self) if self._names else {}).items():
            frame[name] = values if values.dtype == bool else pandas.Categorical(values)
        return frame


def _text(value):
    return f"{value:.6g}" if isinstance(value, (float, numpy.floating)) else str(value)


def has_columns(table, *names):
    """Return whether the table has all these columns; callers may have selected others."""
    return all(name in table.dtype.names for name in names)


def _columns(table):
    """Yield names and values; a field of several numbers gives one column each, with its unit last."""
    for name in table.dtype.names:
        values = numpy.asarray(table[name])
        if values.ndim == 1:
            yield name, values
            continue
        stem, unit = (name[:-2], "_m") if name.endswith("_m") else (name, "")
        for axis, letter in enumerate("xyz"):
            yield f"{stem}_{letter}{unit}", values[:, axis]
