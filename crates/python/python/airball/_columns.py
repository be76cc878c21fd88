"""Columns of numbers, whatever library holds them, as NumPy arrays; what is no column is refused by its name."""

from __future__ import annotations

from typing import Any

import numpy as np

from .errors import ArgumentError

#: What a column is made of, in messages.
_RECIPES = {
    "M": "give seconds, for instance (t - t[0]) / numpy.timedelta64(1, 's')",
    "m": "give seconds, for instance t / numpy.timedelta64(1, 's')",
    "O": "convert it first, for instance numpy.asarray(column, dtype=float)",
    "U": "convert it first, for instance numpy.asarray(column, dtype=float)",
    "S": "convert it first, for instance numpy.asarray(column, dtype=float)",
    "c": "give its real part",
    "b": "give numbers",
}
_WORDS = {
    "M": "dates",
    "m": "durations",
    "O": "Python objects",
    "U": "text",
    "S": "bytes",
    "c": "complex numbers",
    "b": "truth values",
}


def column(name: str, values: Any, *, allow_nan: bool = False) -> np.ndarray:
    """The values as a contiguous array of doubles; `name` is the argument that messages name."""
    _refuse_time_zone(name, values)
    array = _array(name, values)
    if array.dtype.kind not in "fiu":
        kind = array.dtype.kind
        what = _WORDS.get(kind, f"dtype {array.dtype}")
        raise ArgumentError(f"{name} holds {what} (dtype {array.dtype}), not numbers; {_RECIPES.get(kind, 'convert it')}")
    if array.ndim != 1:
        raise ArgumentError(f"{name} has the shape {array.shape}, and one column is needed: a shape (n,)")
    array = np.ascontiguousarray(array, dtype=np.float64)
    _refuse_not_finite(name, array, allow_nan)
    return array


def _array(name: str, values: Any) -> np.ndarray:
    if isinstance(values, np.ma.MaskedArray):
        return np.asarray(values.astype(float).filled(np.nan))
    if hasattr(values, "to_pylist") and hasattr(values, "null_count"):  # Arrow
        if values.null_count:
            values = values.cast("float64")
        return np.asarray(values.to_numpy(zero_copy_only=False) if not hasattr(values, "chunks") else values.to_numpy())
    if type(values).__module__.startswith("pandas.") and str(values.dtype) in _PANDAS_NUMBERS:
        return np.asarray(values.to_numpy(dtype=float, na_value=np.nan))
    try:
        return np.asarray(values)
    except ValueError as error:
        raise ArgumentError(f"{name} is no column of numbers: {error}") from None


#: Types of pandas that mark what is missing.
_PANDAS_NUMBERS = {"Float32", "Float64"} | {f"{sign}Int{bits}" for sign in ("", "U") for bits in (8, 16, 32, 64)}


def _refuse_time_zone(name: str, values: Any) -> None:
    dtype = getattr(values, "dtype", getattr(values, "type", None))
    zone = getattr(dtype, "tz", None) or getattr(dtype, "time_zone", None)
    if zone is not None:
        raise ArgumentError(f"{name} has the time zone {zone}; give seconds, for instance (t - t[0]) as total seconds")


def _refuse_not_finite(name: str, array: np.ndarray, allow_nan: bool) -> None:
    wrong = np.isinf(array) if allow_nan else ~np.isfinite(array)
    if wrong.any():
        at = int(np.argmax(wrong))
        hint = "; say missing='skip' if rows without a number are rows without a reading" if np.isnan(array[at]) else ""
        raise ArgumentError(f"{name}[{at}] is {array[at]}, not a finite number ({int(wrong.sum())} such rows){hint}")


def same_length(columns: dict[str, np.ndarray | None]) -> None:
    """Refuses columns of different lengths."""
    known = {name: len(array) for name, array in columns.items() if array is not None}
    first, length = next(iter(known.items()))
    for name, other in known.items():
        if other != length:
            raise ArgumentError(f"{name} has {other} values and {first} has {length}; give columns of one length")


def of_frame(frame: Any, argument: str, name: str) -> Any:
    """The column of a frame that `argument` names."""
    names = list(frame.column_names if hasattr(frame, "column_names") else frame.columns)
    found = names.count(name)
    if found > 1:
        raise ArgumentError(f"{argument}: the frame has {found} columns named {name!r}; rename all but one")
    if not found:
        known = ", ".join(map(repr, names[:20]))
        raise ArgumentError(f"{argument}: the frame has no column {name!r}; its columns are {known}")
    return frame[name]
