"""The statistics across rigs, against published numbers, closed forms, SciPy, and simulated rigs of known truth."""

import itertools
import math
from types import SimpleNamespace

import numpy as np
import pytest

stats = pytest.importorskip("scipy.stats")
from scipy.cluster import hierarchy  # noqa: E402
from scipy.optimize import brentq  # noqa: E402
from scipy.spatial.distance import pdist  # noqa: E402

from airball.fleet._across import alike, pooled, segments  # noqa: E402
from airball.fleet._across.effects import Presence  # noqa: E402

#: Trials of the BCG vaccine: cases and others among the vaccinated, cases and others among the rest. Source: Colditz et
#: al., JAMA 271, 1994; the data set `dat.bcg` of the R package metafor.
BCG = np.array(
    [
        (4, 119, 11, 128),
        (6, 300, 29, 274),
        (3, 228, 11, 209),
        (62, 13536, 248, 12619),
        (33, 5036, 47, 5761),
        (180, 1361, 372, 1079),
        (8, 2537, 10, 619),
        (505, 87886, 499, 87892),
        (29, 7470, 45, 7232),
        (17, 1699, 65, 1600),
        (186, 50448, 141, 27197),
        (5, 2493, 3, 2338),
        (27, 16886, 29, 17825),
    ],
    dtype=float,
)


@pytest.fixture(scope="module")
def bcg():
    """Logarithms of the relative risks, and their variances."""
    a, b, c, d = BCG.T
    return np.log(a / (a + b)) - np.log(c / (c + d)), 1 / a - 1 / (a + b) + 1 / c - 1 / (c + d)


def test_the_spread_of_the_bcg_trials_is_the_published_one(bcg):
    values, variances = bcg
    assert pooled.between_rigs(values, variances) == pytest.approx(0.3181, abs=5e-5)
    # The published 95 % interval of τ², by the same Q at other quantiles: 0.1197 to 1.1115.
    ends = [pooled._solved(values, variances, stats.chi2.ppf(level, 12)) for level in (0.975, 0.025)]
    assert ends == pytest.approx([0.1197, 1.1115], abs=5e-5)
    # The published I² belongs to the τ² of REML, 0.3132.
    assert 100 * pooled.i_squared(variances, 0.3132) == pytest.approx(92.22, abs=0.01)


def test_the_class_is_what_its_equations_say(bcg):
    values, variances = bcg

    def q(between):
        weights = 1 / (variances + between)
        return (weights * (values - np.average(values, weights=weights)) ** 2).sum()

    between = brentq(lambda between: q(between) - 12, 0, 10, xtol=1e-14)
    weights = 1 / (variances + between)
    mean, error = np.average(values, weights=weights), weights.sum() ** -0.5
    found = pooled.pooled(values, variances)
    assert (found.spread**2, found.mean, found.mean_error) == pytest.approx((between, mean, error), rel=1e-9)
    # The factor of Hartung and Knapp is 1 at this τ².
    assert q(between) / 12 == pytest.approx(1, rel=1e-9)
    within = stats.t.ppf(0.95, 12) * error
    assert found.mean_interval == pytest.approx((mean - within, mean + within), rel=1e-9)
    targets = stats.chi2.ppf((0.95, 0.05), 12)
    ends = [math.sqrt(brentq(lambda between, target=target: q(between) - target, 0, 99)) for target in targets]
    assert found.spread_interval == pytest.approx(ends, rel=1e-9)
    new = stats.t.ppf(0.95, 11) * math.sqrt(between + error**2)
    assert found.new_rig == pytest.approx((mean - new, mean + new), rel=1e-9)


def test_equal_errors_have_a_closed_form():
    values, variance = [1.0, 3.0, 8.0], 0.25
    found = pooled.pooled(values, [variance] * 3)
    between = np.var(values, ddof=1) - variance
    assert (found.mean, found.spread**2) == pytest.approx((4.0, between))
    assert found.i_squared == pytest.approx(between / (between + variance))
    theta, error, own = found.shrunken(8.0, variance)
    assert own == pytest.approx(between / (between + variance))
    assert theta == pytest.approx(own * 8 + (1 - own) * 4)
    assert error**2 == pytest.approx(own * variance + (1 - own) ** 2 * (between + variance) / 3)
    # A rig without an estimate of its own is a new rig of the class.
    assert found.shrunken(None, 0.0) == (found.mean, pytest.approx(math.sqrt(between + (between + variance) / 3)), 0.0)
    left_out = (8 - 2.0) / math.sqrt(variance + (2 - variance) + 2 / 2)
    assert pooled.residuals(values, [variance] * 3)[2] == pytest.approx(left_out)


def test_rigs_that_are_equal_or_alone_are_no_error():
    equal = pooled.pooled([2.0] * 4, [0.1] * 4)
    assert (equal.spread, equal.spread_interval, equal.i_squared) == (0.0, None, 0.0)
    # No differences at all are no reason for a smaller error than that of the estimates: the factor is not below 1.
    assert (equal.mean, equal.mean_error) == pytest.approx((2.0, math.sqrt(0.1 / 4)))
    assert equal.shrunken(2.0, 0.1)[2] == 0.0
    one = pooled.pooled([2.0], [0.1])
    assert (one.spread, one.mean_interval, one.i_squared, one.new_rig) == (None, None, None, None)
    assert one.shrunken(2.0, 0.1) == (2.0, pytest.approx(math.sqrt(0.1)), 1.0)
    two = pooled.pooled([1.0, 2.0], [0.1, 0.1])
    assert two.new_rig is None and pooled.residuals([1.0, 2.0], [0.1, 0.1]) is None


def test_intervals_cover_and_chance_makes_few_outliers():
    """Classes of 10 rigs of known truth. Bounds are three standard errors of 600 classes about the level."""
    rng, classes, rigs = np.random.default_rng(3), 600, 10
    counts = dict.fromkeys(["mean", "spread", "new", "outlier", "odd", "shrunken"], 0)
    for _ in range(classes):
        variances = rng.uniform(0.3, 1.5, rigs) ** 2
        truth = rng.normal(0, 2.0, rigs)
        values = truth + rng.normal(0, np.sqrt(variances))
        found = pooled.pooled(values, variances)
        counts["mean"] += found.mean_interval[0] < 0 < found.mean_interval[1]
        counts["spread"] += found.spread_interval[0] < 2 < found.spread_interval[1]
        counts["new"] += found.new_rig[0] < rng.normal(0, 2.0) < found.new_rig[1]
        theta, error, _ = found.shrunken(values[0], variances[0])
        counts["shrunken"] += abs(theta - truth[0]) < 1.645 * error
        counts["outlier"] += max(map(abs, pooled.residuals(values, variances))) > pooled.outlying(rigs)
        values[4] += 18
        odd = np.abs(pooled.residuals(values, variances))
        counts["odd"] += odd.argmax() == 4 and odd[4] > pooled.outlying(rigs)
    shares = {name: count / classes for name, count in counts.items()}
    for name in ("mean", "spread", "new", "shrunken"):
        assert shares[name] == pytest.approx(0.9, abs=0.037), shares
    assert shares["outlier"] == pytest.approx(0.05, abs=0.027) and shares["odd"] > 0.97, shares


def exhaustive(values, variances, penalty):
    """The least cost over all ways to cut, each tried."""
    logs, best = len(values), (math.inf, [])
    for inner in itertools.chain.from_iterable(itertools.combinations(range(1, logs), cuts) for cuts in range(logs)):
        begins = [0, *inner]
        cost = penalty * len(inner)
        for first, last in zip(begins, [*inner, logs], strict=True):
            y, v = values[first:last], variances[first:last]
            cost += ((y - np.average(y, weights=1 / v)) ** 2 / v).sum()
        best = min(best, (cost, begins))
    return best[1]


def test_change_points_are_the_best_of_all_ways_to_cut():
    rng, several = np.random.default_rng(5), 0
    for _ in range(40):
        variances = rng.uniform(0.2, 3.0, 9)
        # Far from 0, so that a difference of squares would lose its digits.
        values = 1e8 + np.repeat(rng.normal(0, 3, 3), 3) + rng.normal(0, np.sqrt(variances))
        penalty = stats.chi2.ppf(1 - segments.ALPHA_OF_NUMBERS / 8, 1)
        expected = exhaustive(values - 1e8, variances, penalty)
        assert segments.of_number(values, variances) == expected
        several += len(expected) > 2
    assert several > 5


def test_a_change_is_found_where_it_is_and_chance_makes_few():
    rng, rigs = np.random.default_rng(11), 300
    for logs in (6, 12, 30):
        false = right = 0
        for _ in range(rigs):
            known = [rng.uniform(0.5, 2.0, logs) ** 2 for _ in range(5)]
            # A log differs from the next one by 1 more than its interval says.
            series = [(rng.normal(0, np.sqrt(v + 1)), v) for v in known]
            values, variances = series[0]
            omega = segments.scatter(series)
            false += len(segments.of_number(values, variances + omega)) > 1
            series[0][0][logs // 2 :] += 8
            omega = segments.scatter(series)
            right += logs // 2 in segments.of_number(values, variances + omega)
        assert false / rigs <= 0.02 and right / rigs > 0.9, (logs, false, right)


def test_the_scatter_from_log_to_log_is_found_in_spite_of_changes():
    rng = np.random.default_rng(2)
    series = []
    for _ in range(40):
        variances = rng.uniform(0.5, 1.0, 20)
        values = rng.normal(0, np.sqrt(variances + 4)) + 30 * (np.arange(20) >= rng.integers(20))
        series.append((values, variances))
    # Rather too large than too small; the mean square of the same differences gives 26.
    assert 4 < segments.scatter(series) < 6.5
    assert segments.scatter([([1.0], [1.0])]) is None
    assert segments.scatter([([1.0, 1.0], [1.0, 1.0])]) == 0.0


def test_an_effect_sets_in_where_it_is_named_from_then_on():
    assert segments.of_effect([False] * 3 + [True] * 3) == [0, 3]
    assert segments.of_effect([True] * 6 + [False] * 4) == [0, 6]
    # Five logs are too few: one in eight rigs that name it in half of their logs has such a row.
    assert segments.of_effect([False] * 2 + [True] * 3) == [0]
    rng = np.random.default_rng(6)
    for logs in (5, 6, 8, 20):
        false = sum(len(segments.of_effect(rng.random(logs) < 0.5)) > 1 for _ in range(800))
        assert false / 800 < 0.05, (logs, false)
    # One log is no change, nor is now and then, nor what is always so.
    for logs in ([False] * 6 + [True], [False, True] * 5, [True] * 8, [False] * 8):
        assert segments.of_effect(logs) == [0], logs


def test_rigs_that_are_alike_stand_together_in_the_order_of_average_linkage():
    features = np.random.default_rng(4).normal(0, 1, (12, 3))
    order, between = alike.alike(features)
    assert np.allclose(between, np.linalg.norm(features[:, None] - features[None], axis=2))
    joins = hierarchy.average(pdist(features))
    for threshold in joins[:, 2]:
        groups = hierarchy.fcluster(joins, threshold + 1e-12, "distance")[order]
        assert len(list(itertools.groupby(groups))) == len(set(groups))


def test_one_rig_is_alike_to_itself_and_none_are_no_error():
    for rigs in (0, 1):
        order, between = alike.alike(np.zeros((rigs, 3)))
        assert order == list(range(rigs)) and between.tolist() == [[0.0]] * rigs


def test_an_effect_has_appeared_or_gone_by_the_logs_before_the_change():
    def words(before, after):
        series = tuple(before + after)
        logs = tuple(SimpleNamespace(name=f"log {at}", time=None) for at in range(len(series)))
        return Presence(logs, series, (0, len(before)), (), 0.0).words()

    assert words([0.0] * 5, [0.9] * 5) == "since log 5"
    assert words([0.9] * 5, [0.0] * 5) == "gone since log 5"
    assert words([0.9] * 5, [0.6, 0.0, 0.0, 0.0]) == "less often since log 5"
    assert words([0.0] * 20, [0.6, 0.0] * 5) == "more often since log 20"
