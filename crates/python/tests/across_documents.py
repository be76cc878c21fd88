"""Documents of simulated diagnoses, and a reader of the page that refuses what is not closed."""

import json
from html.parser import HTMLParser

#: Half of a 90 % interval in standard errors.
Z = 1.6448536269514722
#: Base numbers of the class.
TRUTH = {"drag_per_s": 2.0, "gain_mm_per_s2_per_percent": 800.0, "hover_duty_percent": 20.0}


def number(value, error):
    return {"value": value, "low": value - Z * error, "high": value + Z * error}


def effect(name, probability, change="added", others=(), **sizes):
    parameters = {key: number(*size) for key, size in sizes.items()}
    return {
        "name": name,
        "change": change,
        "probability": probability,
        "indistinguishable_from": list(others),
        "parameters": parameters,
    }


def write(folder, log, base, effects=(), verdict=None, page=True):
    """A document as `airball diagnose` writes it, as far as it is read."""
    verdict = verdict or ("effect" if effects else "no_gap")
    parameters = {key: {"nominal": TRUTH.get(key, 0.0), **entry} for key, entry in base.items()}
    document = {"schema": "airball.diagnosis/2", "verdict": verdict, "effects": list(effects), "parameters": parameters}
    path = folder / f"{log}.json"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(document))
    if page:
        (folder / f"{log}.html").write_text("its page")


class Strict(HTMLParser):
    """Tags that are closed in their order, identifiers, and addresses."""

    def __init__(self):
        super().__init__()
        self.open, self.ids, self.links = [], [], []

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        self.ids += [values["id"]] if "id" in values else []
        self.links += [values["href"]] if "href" in values else []
        if tag != "meta":
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_startendtag(self, tag, attributes):
        assert tag in ("line", "circle", "rect")
