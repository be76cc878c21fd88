"""Prints docs/machines.md: what `airball diagnose` says of the rigs of tests/machines.py, beside what they are made of.

    python3 tests/machines_page.py TRUTH VERDICTS SEED      the answers of `airball diagnose --json`, one file a case
"""

import json
import math
import sys
from pathlib import Path

HEAD = """# Machines: practice rigs that are no ball in a pipe

Made by `scripts/machines`; do not edit. Carts, axes, pendulums and lifts with one degree of freedom and a good sensor, drawn by chance by
`tests/machines.py`, which shares no equation with the diagnosis. Each has one to four effects of the catalogue that its builder would name, and four to
seven small unmodelled pieces: friction that falls with speed, cogging, a load on a spring, a nonlinear scale, a slow amplifier, a tilt, uneven noise; and gusts. Its
owner believes in a linear machine without any of them, and is off by up to 30 % in its numbers. No effect was held back because it is too small to be
seen. Unless a seed is given, it is the sha256 over the sources of the diagnosis (`scripts/seed`), so that nobody can choose the rigs. The odds of a name
were fitted to other rigs, balls in pipes (see [the blind proof](blind.md)).
"""

EXPLAINED = """A name is right where the rig has that effect, or one that the answer says cannot be told from it, or a piece that may rightly be
called so: slight friction is `wall_friction`, gusts are `turbulence`, and noise that is uneven or well above the believed one is
`sensor_noise`. Intervals are Wilson's, 95 %.
"""


def wilson(good, of):
    if of == 0:
        return "–"
    z, share = 1.96, good / of
    middle = (share + z * z / (2 * of)) / (1 + z * z / of)
    half = z * math.sqrt(share * (1 - share) / of + z * z / (4 * of * of)) / (1 + z * z / of)
    low, high = 100 * max(middle - half, 0.0), 100 * min(middle + half, 1.0)
    return f"{good} of {of} | {100 * share:.0f} | {low:.0f} to {high:.0f}"


class Case:
    """A rig beside its answer."""

    def __init__(self, truth, answer):
        self.name, self.kind, self.verdict = truth["case"], truth["kind"], answer["verdict"]
        self.effects = [effect["name"] for effect in truth["effects"]]
        rightly = {*self.effects, *(piece["kin"] for piece in truth["clutter"])}
        self.named = []
        for entry in answer["effects"]:
            names = {entry["name"], *entry["indistinguishable_from"]}
            self.named.append((entry["name"], names, entry["probability"], bool(names & rightly)))
        errors = [rung["error_mm"][2] for rung in answer["ladder"]]
        self.believed, self.end = (errors[0], errors[-1]) if errors and None not in errors else (None, None)

    def confident(self):
        return [entry for entry in self.named if entry[2] >= 0.5]

    def finds(self, effect):
        return any(effect in names for _, names, _, _ in self.confident())


def table(cases):
    entries = [entry for case in cases for entry in case.named]
    confident = [entry for case in cases for entry in case.confident()]
    first = [case.confident()[0] for case in cases if case.confident()]
    drawn = [(case, effect) for case in cases for effect in case.effects]
    brier = sum((entry[2] - entry[3]) ** 2 for entry in entries) / max(len(entries), 1)
    open_gaps = [case for case in cases if case.believed]
    rows = [
        ("answered, not `insufficient_data`", wilson(sum(c.verdict != "insufficient_data" for c in cases), len(cases))),
        ("`unexplained`", wilson(sum(c.verdict == "unexplained" for c in cases), len(cases))),
        ("the first name with probability ≥ 0.5 is right", wilson(sum(e[3] for e in first), len(first))),
        ("names with probability ≥ 0.5 that are right", wilson(sum(e[3] for e in confident), len(confident))),
        ("effects of the rigs that are named with probability ≥ 0.5", wilson(sum(c.finds(e) for c, e in drawn), len(drawn))),
        ("forecasts 1 s ahead of less than half the error", wilson(sum(2 * c.end < c.believed for c in open_gaps), len(open_gaps))),
        ("forecasts 1 s ahead that are worse than the belief's", wilson(sum(c.end > c.believed for c in open_gaps), len(open_gaps))),
    ]
    lines = ["| share | of | % | 95 % interval |", "|---|---|---|---|"] + [f"| {name} | {value} |" for name, value in rows]
    return "\n".join([*lines, "", f"Brier score of the probabilities of {len(entries)} names: {brier:.3f}."])


def reliability(cases):
    entries = [entry for case in cases for entry in case.named]
    lines = ["| probability | names | right, % | 95 % interval |", "|---|---|---|---|"]
    for low, high in [(0.0, 0.5), (0.5, 0.8), (0.8, 0.9), (0.9, 0.97), (0.97, 1.01)]:
        inside = [entry for entry in entries if low <= entry[2] < high]
        lines.append(f"| {low:.2f} to {min(high, 1.0):.2f} | {wilson(sum(entry[3] for entry in inside), len(inside)).replace('–', '0 of 0 | – | –')} |")
    return "\n".join(lines)


def by_effect(cases):
    lines = ["| effect | rigs that have it | named with probability ≥ 0.5 | named so where it is not |", "|---|---|---|---|"]
    wrong = [entry[0] for case in cases for entry in case.confident() if not entry[3]]
    for effect in sorted({effect for case in cases for effect in case.effects} | set(wrong)):
        having = [case for case in cases if effect in case.effects]
        lines.append(f"| `{effect}` | {len(having)} | {sum(case.finds(effect) for case in having)} | {wrong.count(effect)} |")
    return "\n".join(lines)


def each(cases):
    lines = ["| rig | its effects | the answer, with probabilities | error at 1 s, believed → end, mm |", "|---|---|---|---|"]
    for case in cases:
        names = ", ".join(f"{name} {probability:.2f}{'' if right else ' **wrong**'}" for name, _, probability, right in case.named)
        error = "–" if case.believed is None else f"{case.believed:.3g} → {case.end:.3g}"
        lines.append(f"| {case.kind} | {', '.join(case.effects)} | `{case.verdict}`: {names or 'no name'} | {error} |")
    return "\n".join(lines)


def main():
    truth, verdicts, seed = sys.argv[1:4]
    drawn = json.loads(Path(truth).read_text())["cases"]
    answer = lambda case: json.loads((Path(verdicts) / f"{case['case']}.json").read_text())
    cases = [Case(case, answer(case)) for case in drawn]
    parts = [HEAD, f"{len(cases)} rigs of the seed `{seed}`.\n", EXPLAINED, table(cases), "\n## Reliability\n", reliability(cases)]
    print("\n".join([*parts, "\n## By effect\n", by_effect(cases), "\n## Every rig\n", each(cases)]))


if __name__ == "__main__":
    main()
