"""What a page across rigs is made of: names, times, rigs, and documents in which something is missing."""

import re
import subprocess
import sys
from datetime import datetime

import numpy as np
import pytest

import airball as ab
from across_documents import Strict, effect, number, write
from airball import fleet
from airball.fleet._across import drawn
from airball.fleet._across.documents import natural, time_of


BARE = {"drag_per_s": {"value": 1.0, "low": None, "high": None}}
WITH = {"drag_per_s": number(1.0, 0.1)}


def test_names_act_neither_as_markup_nor_as_a_scheme(tmp_path):
    rig = 'javascript:<b onclick="x">&'
    for log in range(6):
        later = effect("<i>odd", 0.9, size=(1.0 + log, 0.1))
        write(tmp_path, f"{rig}/{log}", {"<u>": number(1.0 + log, 0.1)}, [later] if log > 2 else [])
    page = fleet.across(tmp_path).page.read_text()
    assert not re.search(r"<b |<i>|<u>|onclick=\"", page)
    assert 'href="./javascript%3A%3Cb%20onclick%3D%22x%22%3E%26/0.html"' in page


@pytest.mark.parametrize(
    ("name", "time"),
    [
        ("r/2026-03-01.mcap", datetime(2026, 3, 1)),
        ("r/run_20260301_1405.csv", datetime(2026, 3, 1, 14, 5)),
        ("2026-03-01/2026-03-02T03:04:05Z.mcap", datetime(2026, 3, 2, 3, 4, 5)),
        ("2026-03-01/7.mcap", datetime(2026, 3, 1)),
        ("r/2026-02-30.mcap", None),
        ("r/12026030112.mcap", None),
        ("r/20260301123.mcap", None),
        ("r/7.mcap", None),
    ],
)
def test_the_time_of_a_log_is_the_date_in_its_name(name, time):
    assert time_of(name) == time


def test_logs_are_in_the_order_of_their_dates(tmp_path):
    for log in ("z-2026-03-01", "a-2026-03-08", "m-2026-03-04"):
        write(tmp_path, f"r/{log}", WITH)
    ((*logs,),) = fleet.across(tmp_path).folder.rigs.values()
    assert [log.name for log in logs] == ["r/z-2026-03-01", "r/m-2026-03-04", "r/a-2026-03-08"]


def test_without_dates_the_order_is_that_of_names_and_the_page_says_so(tmp_path):
    for log in range(12):
        write(tmp_path, f"r/run{log}", {"drag_per_s": number(1.0 if log < 9 else 2.0, 0.01)})
    found = fleet.across(tmp_path)
    ((_, _, its),) = found.changed_numbers
    assert its.segments[-1].logs[0].name == "r/run9"
    assert "their order is that of the names" in found.page.read_text()
    assert sorted(["a10", "a9", "a", "10"], key=natural) == ["10", "a", "a9", "a10"]


def test_the_rig_is_asked_of_a_function_or_a_pattern(tmp_path):
    for log in ("x-1", "x-2", "y-1"):
        write(tmp_path, log, {"drag_per_s": number(1.0, 0.1)})
    assert fleet.across(tmp_path).rigs == (".",)
    assert "all are taken as logs of one rig" in (tmp_path / "class.html").read_text()
    assert fleet.across(tmp_path, rig_of="^(.)-").rigs == fleet.across(tmp_path, rig_of=lambda name: name[0]).rigs == ("x", "y")
    assert fleet.across(tmp_path, rig_of="^.").rigs == ("x", "y")
    for wrong, words in [
        ("[", "no regular expression"),
        ("z", "matches no part of the log 'x-1'"),
        (lambda name: None, "it gives None for the log 'x-1'"),
        ("^(q?)", "it gives '' for the log 'x-1'"),
        (3, "int is neither"),
    ]:
        with pytest.raises(ab.ArgumentError, match=f"^rig_of: .*{re.escape(words)}"):
            fleet.across(tmp_path, rig_of=wrong)


def test_a_folder_without_diagnoses_and_files_of_others_are_refused(tmp_path):
    with pytest.raises(ab.ArgumentError, match="^out: .* is no folder"):
        fleet.across(tmp_path / "none")
    (tmp_path / "other.json").write_text('{"schema": "airball.replay/1"}')
    (tmp_path / "list.json").write_text("[1]")
    with pytest.raises(ab.ArgumentError, match="^out: no diagnosis"):
        fleet.across(tmp_path)
    write(tmp_path, "a", {"drag_per_s": number(1.0, 0.1)})
    for name in ("class.html", "class.json"):
        (tmp_path / name).write_text("mine")
        with pytest.raises(ab.ArgumentError, match=f"^out: .*{name} exists"):
            fleet.across(tmp_path)
        assert (tmp_path / name).read_text() == "mine"
        (tmp_path / name).unlink()
    (tmp_path / "cut.json").write_text('{"schema": "airball.dia')
    (tmp_path / "odd.json").write_text('{"schema": "airball.diagnosis/2", "effects": [{}]}')
    found = fleet.across(tmp_path)
    assert [log for log, _ in found.folder.unread] == ["cut", "odd"]
    assert "its JSON is damaged" in found.page.read_text()


#: What each log of a rig is: numbers, effects, verdict.
SPARSE = {
    "one log": {"a": [(WITH, [], None)]},
    "no interval": {"a": [(BARE, [], None)] * 6, "b": [(BARE, [], None)]},
    "no record can tell": {"a": [(BARE, [], "insufficient_data")] * 2, "b": [(BARE, [], "insufficient_data")]},
    "all equal": {rig: [(WITH, [], None)] * 6 for rig in "abcd"},
    "no width": {rig: [({"drag_per_s": number(1.0, 0.0)}, [], None)] * 6 for rig in "abc"},
    "signs": {rig: [({"x": number(value, 0.1)}, [], None)] for rig, value in zip("abc", (-1.0, 0.0, 1.0), strict=True)},
    "far apart": {rig: [({"x": number(value, 0.1 * value)}, [], None)] for rig, value in zip("ab", (1e-200, 1e200), strict=True)},
    "to zero": {rig: [({"x": number(1.0, 0.9)}, [], None)] * 5 for rig in "abc"},
    "no numbers": {rig: [({}, [effect("fan_lag", 0.9, "removed", time_constant_s=(0.1, 0.1))], None)] * 5 for rig in "ab"},
    "same date": {"2026-03-01": [(WITH, [], None)] * 6},
    "unsure": {rig: [(WITH, [effect("fan_lag", 0.3, time_constant_s=(0.1, 0.1))], None)] * 5 for rig in "ab"},
    "sizes unknown": {
        "a": [(WITH, [effect("step", 0.9) | {"parameters": {"size": {"value": 1.0, "low": None, "high": 2.0}}}], None)] * 5
    },
}


@pytest.mark.parametrize("case", SPARSE)
def test_what_is_missing_or_equal_is_said_and_is_no_error(tmp_path, case):
    for rig, logs in SPARSE[case].items():
        for log, (base, effects, verdict) in enumerate(logs):
            write(tmp_path, f"{rig}/{log}", base, effects, verdict, page=False)
    with np.errstate(all="raise"):
        found = fleet.across(tmp_path)
    page = found.page.read_text()
    Strict().feed(page)
    assert not re.search(r"\bnan\b|\binf\b|None|href=\"\./", page)
    # Neither an absent effect nor an improbable one has a size that the rigs share.
    assert not [name for name in found.numbers if name.startswith("fan_lag")]
    assert found.outliers == [] and found.changed_numbers == [] and found.changed_effects == []
    words = {
        "one log": "no rig has as many",
        "same date": "With one rig there is no class",
        "unsure": "30\u00a0%<small>below 50\u00a0% in each log",
        "no interval": "No log has a number with an interval",
        "no record can tell": "No log names an effect",
        "no numbers": "<code>fan_lag removed</code>",
        "sizes unknown": "not estimated: <code>step.size</code>",
    }
    assert words.get(case, "rigs in") in page


def test_a_value_at_a_bound_or_of_a_silent_record_is_no_estimate(tmp_path):
    for rig, value in zip("abc", (1.0, 1.1, 0.9), strict=True):
        write(tmp_path, f"{rig}/1", {"drag_per_s": number(value, 0.1)}, [effect("fan_lag", 0.9, time_constant_s=(0.1, 0.01))])
    write(tmp_path, "d/1", {"drag_per_s": number(50.0, 0.1) | {"at_bound": 50.0}}, verdict="insufficient_data")
    found = fleet.across(tmp_path)
    assert found.numbers["drag_per_s"].pooled.rigs == 3 and found.numbers["drag_per_s"].rigs["d"].own is None
    # A record that cannot answer is no record without the effect.
    assert found.effects["d"] == {} and found.effects["a"]["fan_lag"].is_present
    # So it is no nearer to a rig without the effect than the class is.
    assert found.nearest("d")[1] == pytest.approx(0.0, abs=1e-9)


def test_a_positive_number_is_pooled_as_its_logarithm(tmp_path):
    for rig, value in zip("abc", (1.0, 10.0, 100.0), strict=True):
        base = {"drag_per_s": number(value, 0.01 * value), "x": number(value - 10, 0.1)}
        write(tmp_path, f"{rig}/1", base)
    numbers = fleet.across(tmp_path).numbers
    assert numbers["drag_per_s"].back(numbers["drag_per_s"].pooled.mean) == pytest.approx(10, rel=1e-3)
    assert numbers["drag_per_s"].pooled.spread == pytest.approx(np.log(10), rel=1e-3)
    # A number that may be negative is pooled as it is.
    assert numbers["x"].back(numbers["x"].pooled.mean) == pytest.approx(27, rel=1e-3)


def test_a_rig_borrows_where_more_comes_from_the_class(tmp_path):
    rigs = {"a": (-4.0, 0.1), "b": (0.0, 0.1), "c": (4.0, 0.1), "d": (0.0, 4.0), "e": (0.0, 2.0)}
    for rig, (value, error) in rigs.items():
        write(tmp_path, f"{rig}/1", {"x": number(value, error)})
    found = fleet.across(tmp_path).numbers["x"].rigs
    assert 0.5 < found["d"].from_class < 0.8 and 0.2 < found["e"].from_class < 0.5
    assert [rig for rig, its in found.items() if its.borrows] == ["d"]


def test_the_nearest_rig_has_the_nearest_numbers(tmp_path):
    for rig, value in {"a": -2.0, "b": 2.0, "c": -1.5, "d": 1.4}.items():
        write(tmp_path, f"{rig}/1", {"x": number(value, 0.01), "y": number(1.0, 0.1)})
    found = fleet.across(tmp_path)
    assert found.order == ("a", "c", "b", "d") and found.nearest("b")[0] == "d"
    # In spreads between the rigs; `y` differs in none.
    assert found.nearest("b")[1] == pytest.approx(0.6 / np.std([-2.0, 2.0, -1.5, 1.4], ddof=1), rel=1e-3)


def test_axes_have_round_ticks_also_where_all_is_equal():
    assert drawn._axis([5.0, 5.0], 0, 100)(5.0) == 50 and drawn._axis([0.0, 0.0], 0, 100)(0.0) == 50
    assert drawn._axis([0.0, 10.0], 0, 100).ticks() == [0, 5, 10]
    wide = drawn._axis([1.0, 100.0], 0, 100, is_log=True)
    assert wide.ticks() == pytest.approx([1, 2, 5, 10, 20, 50, 100]) and wide(10.0) == pytest.approx(50)
    # What lies beyond an axis is drawn at its end.
    assert wide(1e9) == 100


def test_without_scipy_the_workers_import_the_package_and_the_command_says_what_to_install(tmp_path):
    command = (
        "import runpy, sys; sys.modules['scipy'] = None; import airball.fleet; "
        f"sys.argv = ['fleet', '--across', '--out', {str(tmp_path)!r}]; runpy.run_module('airball.fleet', run_name='__main__')"
    )
    ended = subprocess.run([sys.executable, "-W", "ignore", "-c", command], capture_output=True, text=True, check=False)
    assert ended.returncode == 1, ended.stderr
    assert ended.stderr.startswith("error: scipy") and ended.stderr.endswith("pip install airball[fleet]\n")
