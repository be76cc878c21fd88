"""The class on the page: effects by rig, numbers that the rigs have in common, rigs that are alike."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .drawn import forest, heat
from .markup import ends, escaped, four, interval, percent, rig_link, spread, table
from .numbers import Number, OfRig

if TYPE_CHECKING:
    from .compare import Across

#: Rigs up to which the distances are drawn.
_MOST_RIGS = 60


def effects(found: Across) -> str:
    effects = found.effect_names
    if not effects:
        return "<p>No log names an effect.</p>\n"
    words = (
        "The probability is the mean over the logs since the last change, 0 in a log that does not name the effect. "
        "Sizes are shrunken estimates. “or” marks what a log does not tell from the effect that it names; – stands where no log of "
        "the rig can tell. Rigs that are alike stand together."
    )
    rows = [(rig_link(rig, found.rigs), *(_cell(found, rig, effect) for effect in effects)) for rig in found.order]
    heads = ["rig", *(f"<code>{escaped(effect)}</code>" for effect in effects)]
    return f"<p>{words}</p>\n" + table("Probability, since when, and size", heads, rows)


def _cell(found: Across, rig: str, effect: str) -> str:
    its = found.effects[rig].get(effect)
    if its is None:
        return "–"
    if its.named == 0 and its.probability == 0:
        return f"or, {percent(its.alternative)}" if its.alternative else ""
    sizes = "".join(
        f"<small>{escaped(name.partition('.')[2])} {_size(one.rigs[rig])}</small>"
        for name, one in found.numbers.items()
        if name.startswith(f"{effect}.") and rig in one.rigs
    )
    either = "".join(f"<small>or {escaped(other)}</small>" for other in its.indistinguishable_from)
    shade = f"background:rgba(var(--hit),{0.45 * its.probability:.2f})"
    return f'<td style="{shade}">{percent(its.probability)}<small>{escaped(its.words())}</small>{sizes}{either}</td>'


def _size(its: OfRig) -> str:
    return f"{four(its.shrunken.value)}{', from the class' if its.borrows else ''}"


def numbers(found: Across) -> str:
    if not found.numbers:
        return "<p>No log has a number with an interval, so nothing can be estimated together.</p>\n"
    words = (
        "The numbers of the rigs are taken as scattered about a mean of the class (random effects, τ² by Paule and Mandel, "
        "interval of the mean by Hartung and Knapp). I² is the share of the differences that is not the rigs' own error. "
        "“From log to log” is the scatter of a rig beyond the intervals of its logs. Spreads of positive numbers are relative. "
        "Numbers of an effect are those of the rigs that have it with 50 % or more."
    )
    heads = ["number", "rigs", "mean of the class", "spread between rigs", "I²", "a new rig, 90 %", "from log to log"]
    text = f"<p>{words}</p>\n" + table("Numbers of the class", heads, [_of_class(one) for one in found.numbers.values()])
    if found.unsized:
        names = ", ".join(f"<code>{escaped(name)}</code>" for name in found.unsized)
        text += f"<p>No log of these rigs has an interval for the following, so they are not estimated: {names}.</p>\n"
    return text + "".join(_of_number(found, one) for one in found.numbers.values())


def _of_class(one: Number) -> tuple[str, ...]:
    pooled = one.pooled
    low, high = (None, None) if pooled.mean_interval is None else map(one.back, pooled.mean_interval)
    between = spread(pooled.spread, one.is_log)
    if pooled.spread_interval is not None:
        between += " ({} to {})".format(*(spread(end, one.is_log) for end in pooled.spread_interval))
    return (
        f"<code>{escaped(one.name)}</code>",
        str(pooled.rigs),
        ends(one.back(pooled.mean), low, high),
        between,
        "–" if pooled.i_squared is None else percent(pooled.i_squared),
        "–" if pooled.new_rig is None else "{} to {}".format(*(four(one.back(end)) for end in pooled.new_rig)),
        spread(one.scatter, one.is_log),
    )


def _of_number(found: Across, one: Number) -> str:
    if len(one.rigs) < 2:
        return ""
    rows = [
        (
            rig_link(rig, found.rigs),
            interval(its.own),
            interval(its.shrunken),
            percent(its.from_class),
            _borrowed(its),
        )
        for rig, its in one.rigs.items()
    ]
    heads = ["rig", "its own estimate", "shrunken estimate", "from the class", "note"]
    legend = '<p class="faint">Black: own estimate. Blue: shrunken estimate. Orange: mean of the class with its interval.</p>\n'
    name = escaped(one.name)
    return (
        f"<details><summary><code>{name}</code> of each rig</summary>\n{legend}{forest(one)}"
        f"{table(f'{name} of each rig', heads, rows)}</details>\n"
    )


def _borrowed(its: OfRig) -> str:
    if its.own is None:
        return "its own logs do not say it: the class alone"
    return "borrows: more from the class than from its own logs" if its.borrows else ""


def alike(found: Across) -> str:
    if len(found.rigs) < 2:
        return "<p>There is one rig.</p>\n"
    words = (
        "The distance of two rigs is over the base numbers, in spreads between rigs, and over the effects, where 2 is an effect "
        "that one rig certainly has and the other lacks. The order is that of average linkage; dark is alike."
    )
    rows = []
    for rig in found.order:
        near = found.nearest(rig)
        if near is not None:
            rows.append((rig_link(rig, found.rigs), rig_link(near[0], found.rigs), f"{near[1]:.2f}"))
    drawn = heat(found.order, found.distances) if len(found.rigs) <= _MOST_RIGS else ""
    return f"<p>{words}</p>\n{drawn}" + table("The nearest rig", ["rig", "most alike", "distance"], rows)
