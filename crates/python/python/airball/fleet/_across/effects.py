"""Which effect acts in which rig, and since when."""

from __future__ import annotations

from dataclasses import dataclass

from .documents import Log
from .segments import FEWEST, of_effect

#: From this probability on an effect counts as named: it is then more probable than not.
NAMED = 0.5


@dataclass(frozen=True)
class Presence:
    """An effect in a rig, as it is now: over the logs since its last change point."""

    #: Logs that can tell: all but those whose verdict is `insufficient_data`.
    logs: tuple[Log, ...]
    #: Its probability in each of them, 0 where it is not named.
    series: tuple[float, ...]
    #: Where the segments begin, as indices of `logs`; the first is 0.
    begins: tuple[int, ...]
    #: Since the last change point: the effects that a log which names this one does not tell from it, and the greatest
    #: probability of a named effect that is not told from this one.
    indistinguishable_from: tuple[str, ...]
    alternative: float

    @property
    def probability(self) -> float:
        """The mean since the last change point."""
        now = self.series[self.begins[-1] :]
        return sum(now) / len(now)

    @property
    def named(self) -> int:
        """In how many logs it is named, over all time."""
        return sum(one >= NAMED for one in self.series)

    @property
    def is_present(self) -> bool:
        """Whether it acts now, as far as the logs say."""
        return self.probability >= NAMED

    @property
    def has_risen(self) -> bool:
        """Whether a greater share of the logs names it since the last change point than just before."""
        before, now = self.series[self.begins[-2] : self.begins[-1]], self.series[self.begins[-1] :]
        return _share_named(now) > _share_named(before)

    @property
    def _since(self) -> str:
        if self.has_risen:
            return "since" if self.is_present else "more often since"
        return "less often since" if _share_named(self.series[self.begins[-1] :]) > 0 else "gone since"

    @property
    def since(self) -> Log | None:
        """The first log after the last change point; None where nothing changes."""
        return self.logs[self.begins[-1]] if len(self.begins) > 1 else None

    def words(self) -> str:
        """Since when it acts, in words."""
        named, logs = self.named, len(self.series)
        if self.since is not None:
            return f"{self._since} {when(self.since)}"
        if named == logs:
            return "in all logs" if logs > 1 else "in the only log"
        if named == 0:
            return f"below {NAMED:.0%} in each log".replace("%", " %")
        return f"in {named} of {logs} logs"


def _share_named(series: tuple[float, ...]) -> float:
    return sum(one >= NAMED for one in series) / len(series)


def when(log: Log) -> str:
    """The date of a log, or its name where it has none."""
    if log.time is None:
        return log.name
    has_hours = (log.time.hour, log.time.minute, log.time.second) != (0, 0, 0)
    return log.time.strftime("%Y-%m-%d %H:%M" if has_hours else "%Y-%m-%d")


def presences(logs: list[Log], effects: list[str]) -> dict[str, Presence]:
    """Each effect that some log of the class names, in one rig; empty where no log of the rig can tell."""
    telling = [log for log in logs if log.can_tell]
    return {effect: _presence(telling, effect) for effect in effects} if telling else {}


def _presence(logs: list[Log], effect: str) -> Presence:
    series = [log.effects[effect].probability if effect in log.effects else 0.0 for log in logs]
    begins = of_effect([one >= NAMED for one in series]) if len(series) >= FEWEST else [0]
    now = [log.effects for log in logs[begins[-1] :]]
    indistinguishable_from = sorted({other for its in now if effect in its for other in its[effect].indistinguishable_from})
    others = [named.probability for its in now for named in its.values() if effect in named.indistinguishable_from]
    return Presence(tuple(logs), tuple(series), tuple(begins), tuple(indistinguishable_from), max(others, default=0.0))
