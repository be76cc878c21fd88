"""Fits the odds of a named effect to the verdicts on sets of practice rigs, and checks them on another.

    python tests/odds_fit.py TRUTH VERDICTS … TRUTH VERDICTS      the sets to fit, then the set to check

A named effect is right where the truth has it, or one that its entry cannot be told from, or where a piece of the clutter
may rightly be called by that name. The weights are those of a logistic regression with a ridge of one deviation's worth
of prior (variance 1), for the features of `crates/diagnose/src/select/odds.rs`, which prints them in `evidence`.
"""

import json
import re
import sys
from pathlib import Path

import numpy as np
from scipy.optimize import minimize

# As in `crates/diagnose/src/select/odds.rs`.
SMALL_VARIATION = 0.1
FEATURES = [
    "intercept",
    "ln(gain / rest)",
    "dropped share",
    "dropped deviations",
    "rest share",
    "effects",
    "scatter",
    "change",
    "matched",
    "variation",
]


def features(evidence):
    return [
        1.0,
        np.log1p(max(evidence["held_out_gain"], 0.0)) - np.log1p(max(evidence["rest_nats"], 0.0)),
        evidence["dropped_share"],
        np.clip(evidence["dropped_deviations"], -5.0, 10.0),
        0.0 if evidence["is_scatter"] else np.clip(evidence["rest_share"], 0.0, 1.0),
        evidence["effects"],
        float(evidence["is_scatter"]),
        float(evidence["is_change"]),
        float(evidence["is_matched"]),
        np.log1p(variation_share(evidence) / SMALL_VARIATION) * (1.0 - np.clip(evidence["rest_share"], 0.0, 1.0)),
    ]


def variation_share(evidence):
    """The variation of a parameter of a name; 0 where none varies significantly."""
    return evidence["variation"]["share"] if evidence["variation"] else 0.0


def entries(truth, verdicts):
    """The features of each named effect of a set, whether it is right, the kind of its rig, and its variation."""
    rows, right, kinds, variations = [], [], [], []
    for case in json.loads(Path(truth).read_text())["cases"]:
        there = {effect["name"] for effect in case["effects"]} | {piece["kin"] for piece in case.get("clutter", [])}
        answer = json.loads((Path(verdicts) / f"{case['case']}.json").read_text())
        for entry in answer["effects"]:
            rows.append(features(entry["evidence"]))
            right.append(bool(there & {entry["name"], *entry["indistinguishable_from"]}))
            kinds.append(case["kind"])
            variations.append(variation_share(entry["evidence"]))
    return np.array(rows), np.array(right), np.array(kinds), np.array(variations)


def loss(weights, rows, right):
    odds = rows @ weights
    value = np.sum(np.logaddexp(0.0, odds) - right * odds) + 0.5 * np.sum(weights[1:] ** 2)
    slope = rows.T @ (1.0 / (1.0 + np.exp(-odds)) - right)
    slope[1:] += weights[1:]
    return value, slope


def last_alone(rows, right):
    """The last weight with the others as they are in the program, without a ridge."""
    text = (Path(__file__).parent.parent / "crates/diagnose/src/select/odds.rs").read_text()
    others = np.array(json.loads(re.search(r"WEIGHTS: .* = (\[.*\]);", text)[1])[:-1])

    def odds(last):
        return rows @ np.append(others, last)

    last = minimize(lambda last: np.sum(np.logaddexp(0.0, odds(last)) - right * odds(last)), [0.0]).x[0]
    without, beside = (brier(1.0 / (1.0 + np.exp(-odds(one))), right) for one in (0.0, last))
    print(f"{last:8.3f}  {FEATURES[-1]} alone, the others as they are: Brier score {without:.3f} without it, {beside:.3f} with it")


def brier(probability, right):
    return np.mean((probability - right) ** 2)


def table(name, probability, right):
    print(f"{name}: {len(right)} entries, {right.mean():.0%} right, Brier score {brier(probability, right):.3f}")
    for low in np.arange(0.0, 1.0, 0.1):
        inside = (probability >= low) & ((probability < low + 0.1) | (low > 0.89))
        if inside.any():
            print(f"  {low:.1f} to {low + 0.1:.1f}  {inside.sum():4d}  said {probability[inside].mean():.2f}  right {right[inside].mean():.2f}")


def main(*sets):
    *to_fit, (check_truth, check_verdicts) = zip(sets[::2], sets[1::2])
    fitted = [entries(truth, verdicts) for truth, verdicts in to_fit]
    rows, right, variations = (np.concatenate([one[part] for one in fitted]) for part in (0, 1, 3))
    weights = minimize(loss, np.zeros(rows.shape[1]), (rows, right), "L-BFGS-B", jac=True).x
    for name, weight in zip(FEATURES, weights):
        print(f"{weight:8.3f}  {name}")
    print("[" + ", ".join(f"{weight:.3f}" for weight in weights) + "]")
    last_alone(rows, right)
    varying = variations > SMALL_VARIATION
    print(f"a parameter varies by more than {SMALL_VARIATION}: {(varying & right).sum()} of {right.sum()} right names, "
          f"{(varying & ~right).sum()} of {(~right).sum()} wrong ones")
    table("fitted", 1.0 / (1.0 + np.exp(-rows @ weights)), right)
    rows, right, kinds, _ = entries(check_truth, check_verdicts)
    probability = 1.0 / (1.0 + np.exp(-rows @ weights))
    table("checked", probability, right)
    for kind in sorted(set(kinds)):
        table(kind, probability[kinds == kind], right[kinds == kind])


if __name__ == "__main__":
    main(*sys.argv[1:])
