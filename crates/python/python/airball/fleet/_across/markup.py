"""Words and markup of the page: escapes, links, numbers, tables, and the frame around them.

All names are escaped, and the policy in the head allows no script and no resource from elsewhere.
"""

from __future__ import annotations

import html
import math
from collections.abc import Iterable, Sequence
from urllib.parse import quote

from ... import _airball
from ..._diagnosis import Interval
from .documents import Log
from .effects import when
from .numbers import HIGHEST_LOG

#: The mark of a page of this program.
MAKER = '<meta name="generator" content="airball '

#: Colours are those of the reports: recorded, belief (here the class), mended (here the shrunken estimate), faint, lines.
_STYLE = """
:root { color-scheme: light dark; --text: #1c2028; --faint: #5d636e; --class: #b84a00; --shrunken: #0067a8; --line: #d9dbe0;
  --ground: #fff; --hit: 184,74,0; }
@media screen and (prefers-color-scheme: dark) { :root { --text: #f1f3f7; --faint: #a3abb8; --class: #ff9d52; --shrunken: #5cb8ff;
  --line: #343a45; --ground: #16191f; --hit: 255,157,82; } }
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 0 20px 48px; max-width: 1100px; color: var(--text); background: var(--ground);
  font: 16px/1.5 system-ui, -apple-system, "Segoe UI", Roboto, "Noto Sans", "DejaVu Sans", sans-serif;
  font-variant-numeric: tabular-nums; }
a { color: var(--shrunken); }
h1 { font-size: clamp(23px, 3.2vw, 34px); line-height: 1.2; margin: 18px 0 8px; }
h2 { font-size: 22px; margin: 0 0 8px; }
h3 { font-size: 16px; margin: 22px 0 4px; overflow-wrap: anywhere; }
p, li { max-width: 76ch; overflow-wrap: anywhere; }
section { padding-top: 26px; margin-top: 26px; border-top: 1px solid var(--line); }
nav ul { list-style: none; display: flex; flex-wrap: wrap; gap: 4px 18px; padding: 0; font-size: 14px; }
code { font: 13px/1.4 ui-monospace, Menlo, Consolas, "DejaVu Sans Mono", monospace; }
.faint, small { color: var(--faint); font-size: 13px; }
small { display: block; white-space: nowrap; }
.scroll { overflow-x: auto; max-width: 100%; margin: 0 0 14px; }
table { border-collapse: collapse; font-size: 14px; line-height: 1.35; }
th, td { text-align: left; padding: 5px 14px 5px 4px; border-bottom: 1px solid var(--line); vertical-align: top; }
thead th { font-size: 13px; color: var(--faint); vertical-align: bottom; }
tbody th { font-weight: 500; white-space: nowrap; }
caption { text-align: left; color: var(--faint); font-size: 13px; }
summary { cursor: pointer; overflow-wrap: anywhere; }
svg { display: block; font-size: 12.5px; }
svg text { fill: var(--faint); }
svg .name { fill: var(--text); }
svg .axis { stroke: var(--line); }
svg .own { stroke: var(--text); fill: var(--text); }
svg .open { stroke: var(--text); fill: var(--ground); }
svg .shrunken { stroke: var(--shrunken); fill: var(--shrunken); }
svg .class { stroke: var(--class); fill: var(--class); }
svg .band { stroke: none; fill-opacity: 0.16; }
svg .change { stroke: var(--class); stroke-dasharray: 4 3; }
"""


def escaped(text: object) -> str:
    """Text in which nothing is markup."""
    return html.escape(str(text), quote=True)


def address(name: str) -> str:
    """The address of a log's page beside this one; a name with a colon is no scheme."""
    return "./" + quote(name, safe="/-_.~") + ".html"


def link(log: Log, words: str | None = None) -> str:
    """A log as a link to its own page, or as its name where it has no page."""
    text = escaped(log.name if words is None else words)
    return f'<a href="{escaped(address(log.name))}">{text}</a>' if log.has_page else text


def dated(log: Log) -> str:
    """The date of a log as a link to its page."""
    return link(log, when(log))


def of(rig: str) -> str:
    """A rig in words."""
    return "(no folder)" if rig == "." else rig


def rig_link(rig: str, rigs: Sequence[str]) -> str:
    """A rig as a link to its part of the page."""
    return f'<a href="#rig-{rigs.index(rig)}">{escaped(of(rig))}</a>'


def four(value: float | None) -> str:
    """Four digits."""
    return "–" if value is None else f"{value:.4g}".replace("-", "−")


def ends(value: float | None, low: float | None, high: float | None) -> str:
    """A value with its interval."""
    return four(value) if low is None or high is None else f"{four(value)} ({four(low)} to {four(high)})"


def interval(one: Interval | None) -> str:
    """An estimate in words."""
    return "–" if one is None else ends(one.value, one.low, one.high)


def spread(value: float | None, is_log: bool) -> str:
    """A spread in words: in the unit of the number, or relative to it where it is one of the logarithm."""
    if value is None or not is_log:
        return four(value)
    # As a share while that is a usual way to say it, then as a factor.
    return f"{100 * math.expm1(value):.3g} %" if value < 1 else f"a factor of {math.exp(min(value, HIGHEST_LOG)):.3g}"


def percent(share: float) -> str:
    """A share in whole percent."""
    return f"{100 * share:.0f} %"


def count(number: int, one: str) -> str:
    """How many of a thing, as "no rig", "1 rig" and "2 rigs"."""
    return f"{number or 'no'} {one}{'s' if number > 1 else ''}"


def table(caption: str, heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table of markup; the first cell of a row is its head."""
    head = "".join(f'<th scope="col">{cell}</th>' for cell in heads)
    body = "".join(f'<tr><th scope="row">{first}</th>{"".join(map(_cell, rest))}</tr>\n' for first, *rest in rows)
    return (
        f'<div class="scroll"><table><caption>{caption}</caption><thead><tr>{head}</tr></thead>\n'
        f"<tbody>{body}</tbody></table></div>\n"
    )


def _cell(markup: str) -> str:
    """A cell; one with a style of its own is whole already."""
    return markup if markup.startswith("<td") else f"<td>{markup}</td>"


def _joined(text: str) -> str:
    """The text with no break between a number and its percent sign."""
    return text.replace(" %", "\u00a0%")


def framed(answer: str, first: str, sections: Sequence[tuple[str, str, str]]) -> str:
    """The whole page: the answer, what is below it, and sections of identifier, heading and markup."""
    contents = "".join(f'<li><a href="#{name}">{escaped(heading)}</a></li>' for name, heading, _ in sections)
    parts = "".join(
        f'<section id="{name}">\n<h2>{escaped(heading)}</h2>\n{body}</section>\n' for name, heading, body in sections
    )
    return _joined(f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
{MAKER}{escaped(_airball.VERSION)}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'">
<title>{escaped(answer)} – airball class</title>
<style>{_STYLE}</style>
</head>
<body>
<main>
<h1>{escaped(answer)}</h1>
{first}<nav aria-label="Sections of this page"><ul>{contents}</ul></nav>
{parts}</main>
</body>
</html>
""")
