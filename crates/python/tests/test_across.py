"""A page across rigs and time shows what was put into simulated documents."""

import json
import re
import subprocess
import sys
from datetime import date, timedelta

import numpy as np
import pytest

from across_documents import TRUTH, Strict, effect, number, write
from airball import fleet


def weekly(week):
    return (date(2026, 3, 2) + timedelta(weeks=week)).isoformat()


@pytest.fixture(scope="module")
def shop(tmp_path_factory):
    """Eight rigs of one class. `d` hovers at another duty; the gain of `c` falls by a fifth from week 6 on; in `b` a transport
    delay sets in with week 5, and `e` always has it; `g` alone has a lag of the fan; `h` has one log that says little of its
    drag, nothing of its gain."""
    folder, rng = tmp_path_factory.mktemp("shop"), np.random.default_rng(8)
    for rig in "abcdefgh":
        own = {key: value * np.exp(rng.normal(0, 0.03)) for key, value in TRUTH.items()}
        own["hover_duty_percent"] = 27.0 if rig == "d" else own["hover_duty_percent"]
        for week in range(1 if rig == "h" else 10):
            base = {key: number(value * np.exp(rng.normal(0, 0.005)), 0.005 * value) for key, value in own.items()}
            if rig == "c" and week >= 6:
                entry = base["gain_mm_per_s2_per_percent"]
                base["gain_mm_per_s2_per_percent"] = {key: 0.8 * value for key, value in entry.items()}
            if rig == "h":
                base["drag_per_s"] = number(3.0, 0.5)
                base["gain_mm_per_s2_per_percent"] |= {"low": None, "high": None}
            has = rig == "e" or (rig == "b" and week >= 5)
            delay = effect("transport_delay", 0.95, others=["sensor_delay"], delay_s=(0.08 + rng.normal(0, 0.002), 0.002))
            lag = effect("fan_lag", 0.8, time_constant_s=(0.2, 0.02))
            write(folder, f"{rig}/{weekly(week)}.mcap", base, [delay] * has + [lag] * (rig == "g"))
    return folder


@pytest.fixture(scope="module")
def compared(shop):
    return fleet.across(shop)


@pytest.fixture(scope="module")
def page(compared):
    return compared.page.read_text(encoding="utf-8")


def section(page, name):
    return page.split(f'<section id="{name}">')[1].split("</section>")[0]


def test_outliers_are_found_and_are_first(compared, page):
    # The gain of c is unlike the class as it is now, after its change.
    assert [(rig, one.name) for rig, one, _ in compared.outliers] == [
        ("c", "gain_mm_per_s2_per_percent"),
        ("d", "hover_duty_percent"),
    ]
    sizes = [abs(its.residual) for *_, its in compared.residuals]
    assert sizes == sorted(sizes, reverse=True) and len(sizes) == 7 + 8 + 8
    first = section(page, "outliers")
    assert page.index('id="outliers"') < page.index('id="changes"')
    assert re.findall(r'<tr><th scope="row"><a href="#rig-\d">(\w)</a>', first) == ["c", "d"]
    assert f'<a href="./d/{weekly(9)}.mcap.html">' in first
    assert compared.lone_effects == [("g", "fan_lag")]
    assert '<a href="#rig-6">g</a> is the only rig with <code>fan_lag</code>: 80\u00a0%, in all logs</li>' in first
    assert page.count("8 rigs in 71 logs: 2 rigs unlike the class, 2 rigs with a change") == 2


def test_changes_are_dated(compared, page):
    ((rig, one, its),) = compared.changed_numbers
    assert (rig, one.name) == ("c", "gain_mm_per_s2_per_percent")
    before, after = its.segments
    assert [len(before.logs), len(after.logs)] == [6, 4]
    assert after.value.value / before.value.value == pytest.approx(0.8, rel=0.01)
    assert [(rig, name, its.since.name) for rig, name, its in compared.changed_effects] == [
        ("b", "transport_delay", f"b/{weekly(5)}.mcap")
    ]
    changes = section(page, "changes")
    assert f'<code>transport_delay</code> sets in</td><td><a href="./b/{weekly(5)}.mcap.html">{weekly(5)}</a>' in changes
    assert f'<a href="./c/{weekly(6)}.mcap.html">{weekly(6)}</a>' in changes
    # The rig's own estimate is the one after the change.
    assert its.own.value == after.value.value
    # A plot of each, and in the plot a dot with a link for each log.
    plot = page.split('<h3 id="rig-2">')[1].split("<details>")[0]
    assert plot.count("<circle") == plot.count('<a href="./c/') == 10 and plot.count('class="change"') == 1


def test_effects_stand_in_a_table_of_rigs(compared, page):
    standing = {rig: its["transport_delay"] for rig, its in compared.effects.items()}
    assert {rig for rig, its in standing.items() if its.is_present} == {"b", "e"}
    assert standing["b"].probability == pytest.approx(0.95) and standing["b"].named == 5
    table = section(page, "effects")
    assert f"95\u00a0%<small>since {weekly(5)}</small>" in table and "95\u00a0%<small>in all logs</small>" in table
    assert table.count("<small>or sensor_delay</small>") == 2 and table.count("<small>delay_s 0.0") == 2
    assert compared.numbers["transport_delay.delay_s"].rigs.keys() == {"b", "e"}
    # The effect of the most rigs is first.
    assert compared.effect_names == ("transport_delay", "fan_lag")
    # Rigs that are alike stand together.
    places = [compared.order.index(rig) for rig in "be"]
    assert abs(places[0] - places[1]) == 1 and compared.nearest("b")[0] == "e"


def test_a_rig_that_says_little_borrows_and_says_so(compared, page):
    drag = compared.numbers["drag_per_s"]
    little = drag.rigs["h"]
    assert little.own.value == pytest.approx(3.0) and little.borrows
    assert abs(little.shrunken.value - drag.back(drag.pooled.mean)) < 0.1
    assert not any(its.borrows for rig, its in drag.rigs.items() if rig != "h")
    gain = compared.numbers["gain_mm_per_s2_per_percent"]
    nothing = gain.rigs["h"]
    assert nothing.own is None and nothing.from_class == 1.0 and nothing.residual is None
    assert nothing.shrunken.value == pytest.approx(gain.back(gain.pooled.mean))
    numbers = section(page, "numbers")
    assert numbers.count("borrows: more from the class than from its own logs") == 1 + 2  # and two delays that are equal
    assert numbers.count("its own logs do not say it: the class alone") == 1


def test_the_page_is_whole_and_leads_only_to_what_exists(shop, page):
    parsed = Strict()
    parsed.feed(page)
    assert parsed.open == [] and len(set(parsed.ids)) == len(parsed.ids)
    for link in parsed.links:
        assert link[1:] in parsed.ids if link.startswith("#") else (shop / link).is_file(), link
    logs = {f"./{path.relative_to(shop)}" for path in shop.rglob("*.mcap.html")}
    assert logs <= set(parsed.links)
    assert "<script" not in page and "http" not in page.replace("http-equiv", "").replace("http://www.w3.org/2000/svg", "")


def test_the_files_are_the_same_again_and_wherever_they_are(shop, compared, tmp_path):
    files = {name: (shop / name).read_bytes() for name in ("class.html", "class.json")}
    for path in shop.rglob("*.mcap.*"):
        copy = tmp_path / path.relative_to(shop)
        copy.parent.mkdir(exist_ok=True)
        copy.write_bytes(path.read_bytes())
    for folder in (tmp_path, tmp_path, shop):
        fleet.across(folder)
        assert files == {name: (folder / name).read_bytes() for name in files}
    document = json.loads(files["class.json"])
    assert document == compared.to_dict() and document["schema"] == "airball.class/1"
    # The last digits of a processor's logarithm do not show.
    assert max(len(digits.replace(".", "").lstrip("0")) for digits in re.findall(r"\d+\.\d+", files["class.json"].decode())) <= 10
    assert [one["rig"] for one in document["outliers"]] == ["c", "d"]


def test_a_diagnosis_is_read_as_the_package_gives_it(found, tmp_path):
    (tmp_path / "r").mkdir()
    (tmp_path / "r" / "2026-03-01.json").write_text(found.json())
    ((log,),) = fleet.across(tmp_path).folder.rigs.values()
    assert (log.verdict, list(log.effects)) == (found.verdict, [one.name for one in found.effects])
    first = found.effects[0]
    sizes = {f"{first.name}.{key}": value for key, value in first.parameters.items()}
    assert log.numbers.items() >= (found.parameters | sizes).items()
    assert log.effects[first.name].probability == first.probability


def test_the_command_compares_what_is_there_without_workers(shop, tmp_path):
    write(tmp_path, "x-1", {"drag_per_s": number(1.0, 0.1)})

    def run(*flags):
        words = [sys.executable, "-m", "airball.fleet", *map(str, flags)]
        return subprocess.run(words, capture_output=True, text=True, check=False)

    ran = run("--across", "--rig", "^(.)-", "--out", tmp_path)
    assert (ran.returncode, ran.stdout) == (0, f"1 rigs are compared, 0 outliers; page {tmp_path / 'class.html'}\n")
    assert json.loads((tmp_path / "class.json").read_text())["rigs"][0]["name"] == "x"
    ran = run("--across", "--rig", "z", "--out", tmp_path)
    assert ran.returncode == 1 and ran.stderr.startswith("error: rig_of: 'z' matches no part")
    for flags, words in [
        (["--out", tmp_path], "at least one LOG, or --across"),
        (["log", "--out", tmp_path], "one of --scheduler, --local and --slurm"),
        (["log", "--local", 1, "--rig", "z", "--out", tmp_path], "--rig is for --across"),
    ]:
        ran = run(*flags)
        assert ran.returncode == 2 and words in ran.stderr


def test_dates_of_changes_that_would_lie_on_each_other_are_left_out(tmp_path):
    for week in range(24):
        gain = 800.0 * 1.5 ** (week // 4)
        write(tmp_path, f"a/{weekly(week)}.mcap", {"gain_mm_per_s2_per_percent": number(gain, 1.0)}, [])
    fleet.across(tmp_path)
    plots = re.findall(r"<svg.*?</svg>", (tmp_path / "class.html").read_text(encoding="utf-8"), re.S)
    (plot,) = [plot for plot in plots if 'class="change"' in plot]
    dates = re.findall(r'<text x="([0-9.]+)" y="[0-9.]+" text-anchor="(start|end)"[^>]*>since ([0-9-]{10})<', plot)
    places = [(float(x) - (100 if anchor == "end" else 0)) for x, anchor, _ in dates]
    assert plot.count('class="change"') == 5 and 2 <= len(dates) < 5
    assert all(later - earlier >= 100 for earlier, later in zip(places, places[1:], strict=False))
