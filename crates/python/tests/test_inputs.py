"""Columns of NumPy, lists, pandas, polars and Arrow are taken; what is no column is refused by the name of its argument."""

import datetime

import numpy as np
import pytest

import airball as ab

N = 200
T = np.arange(N) * 0.02
U = 21.4 + 0.1 * np.sin(T)
Y = 300.0 + 20 * np.cos(T)


def same(recording, t=T, u=U, y=Y):
    assert all(np.array_equal(got, given, equal_nan=True) for got, given in zip(recording, (t, u, y), strict=True))
    return True


def test_arrays_lists_and_columns_of_every_library_give_one_recording():
    pandas, polars, pyarrow = (pytest.importorskip(name) for name in ("pandas", "polars", "pyarrow"))
    assert same(ab.Recording(T, U, Y))
    assert same(ab.Recording(T.tolist(), tuple(U), Y[::-1].copy()[::-1]))
    assert same(ab.Recording(np.asfortranarray(T), U, Y.astype(np.float64, order="F")))
    columns = {"t": T, "u": U, "y": Y}
    for frame in (pandas.DataFrame(columns), polars.DataFrame(columns), pyarrow.table(columns)):
        assert same(ab.Recording(frame["t"], frame["u"], frame["y"])), type(frame)
        assert same(ab.Recording.from_frame(frame, time="t", input="u", position="y")), type(frame)
    assert same(ab.Recording(T, U, pyarrow.array(Y)))


def test_whole_numbers_and_single_precision_are_taken_as_they_are():
    whole = np.arange(N)
    assert same(ab.Recording(whole, U.astype(np.float32), Y), t=whole.astype(float), u=U.astype(np.float32).astype(float))


def test_scales_turn_columns_into_seconds_percent_and_millimetres():
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame({"ms": T * 1e3, "fraction": U / 100, "m": Y / 1e3})
    log = ab.Recording.from_frame(
        frame, time="ms", input="fraction", position="m", time_scale=1e-3, input_scale=100, scale=1000
    )
    assert np.allclose(log.t, T) and np.allclose(log.u, U) and np.allclose(log.y, Y)


def test_a_row_without_a_reading_is_said_to_be_one():
    pandas = pytest.importorskip("pandas")
    holes = Y.copy()
    holes[7] = np.nan
    with pytest.raises(ab.ArgumentError, match=r"^y\[7\] is nan, not a finite number \(1 such rows\); say missing='skip'"):
        ab.Recording(T, U, holes)
    for y in (holes, np.ma.masked_invalid(holes), pandas.array(holes, dtype="Float64"), pandas.Series(holes)):
        assert same(ab.Recording(T, U, y, missing="skip"), y=holes)
    with pytest.raises(ab.ArgumentError, match=r"^u\[7\] is nan"):
        ab.Recording(T, holes, Y, missing="skip")


def with_zone():
    pandas = pytest.importorskip("pandas")
    return pandas.Series(pandas.date_range("2026-01-01", periods=N, freq="20ms", tz="Europe/Berlin"))


def with_zone_of_polars():
    polars = pytest.importorskip("polars")
    start = datetime.datetime(2026, 1, 1)
    return polars.Series([start + datetime.timedelta(milliseconds=20 * k) for k in range(N)]).dt.replace_time_zone("UTC")


def with_zone_of_arrow():
    pyarrow = pytest.importorskip("pyarrow")
    return pyarrow.array(range(N), pyarrow.timestamp("ms", tz="UTC"))


@pytest.mark.parametrize(
    ("t", "said"),
    [
        (T[:-1], "u has 200 values and t has 199"),
        (np.array(T, dtype=object), "t holds Python objects"),
        ([*T[:-1], "late"], "t holds text"),
        (T.astype("datetime64[s]"), "t holds dates"),
        (T.astype("timedelta64[s]"), "t holds durations"),
        (T.reshape(-1, 2), r"t has the shape \(100, 2\)"),
        (3.0, r"t has the shape \(\)"),
        (T + 0j, "t holds complex numbers"),
        (T > 1, "t holds truth values"),
        ([[1], [2, 3]], "t is no column of numbers"),
        (None, "t is None"),
        (with_zone, "t has the time zone Europe/Berlin"),
        (with_zone_of_polars, "t has the time zone UTC"),
        (with_zone_of_arrow, "t has the time zone UTC"),
    ],
)
def test_what_is_no_time_is_refused_by_its_name(t, said):
    with pytest.raises(ab.ArgumentError, match=f"^{said}"):
        ab.Recording(t() if callable(t) else t, U, Y)


def test_a_name_that_two_columns_have_is_refused():
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame(np.column_stack([T, U, U, Y]), columns=["t", "u", "u", "y"])
    with pytest.raises(ab.ArgumentError, match="^input: the frame has 2 columns named 'u'"):
        ab.Recording.from_frame(frame, time="t", input="u", position="y")
    with pytest.raises(ab.ArgumentError, match="^position: the frame has no column 'Y'; its columns are 't'"):
        ab.Recording.from_frame(frame, time="t", input="t", position="Y")


def test_rows_that_are_no_recording_are_refused_with_the_words_of_the_program():
    with pytest.raises(ab.RecordingError, match="row 3"):
        ab.Recording(np.where(np.arange(N) == 2, -1.0, T), U, Y)
    with pytest.raises(ab.RecordingError):
        ab.Recording(T[:5], U[:5], Y[:5])
    with pytest.raises(ab.RecordingError):
        ab.Recording([], [], [])


def test_a_recording_of_rows_crosses_to_another_process_and_one_of_a_flight_does_not(stuck):
    import pickle

    log = ab.Recording(T, U, Y, name="mine")
    back = pickle.loads(pickle.dumps(log))
    assert same(back) and back.name == "mine"
    with pytest.raises(TypeError, match="hand its file to the other process"):
        pickle.dumps(stuck)
