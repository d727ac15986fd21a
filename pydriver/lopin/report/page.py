"""The HTML of a report."""
from __future__ import annotations

import json
from html import escape

import numpy as np

from .along import along, last_pressed
from .collect import Run
from .curves import chart
from .viewer import SCRIPT

STYLE = """
body{font:15px/1.45 system-ui,sans-serif;color:#1d2733;margin:0 auto;max-width:1020px;
padding:0 18px 40px}
h1{font-size:23px;margin:22px 0 6px}h2{font-size:17px;margin:30px 0 8px;
border-bottom:1px solid #d5dce4}
.banner{padding:12px 16px;border-radius:6px;color:#fff;font-size:17px;margin:12px 0}
.PASS{background:#00785a}.WARN{background:#9a6700}.FAIL,.bad{background:#b3261e}.none{color:#6a7683}
.banner.none{color:#fff;background:#35618e}
table{border-collapse:collapse;margin:6px 0}th,td{padding:3px 12px 3px 0;text-align:left;
vertical-align:top}
th{font-weight:600;color:#445}td.n,th.n{text-align:right;font-variant-numeric:tabular-nums}
tr.off td{color:#b3261e}code,pre{font:13px/1.4 ui-monospace,monospace;background:#f2f5f8;
padding:1px 4px}
pre{padding:6px 10px;overflow-x:auto;margin:4px 0}
svg{max-width:500px;width:100%}
.two{display:grid;grid-template-columns:repeat(auto-fit,minmax(400px,1fr));gap:18px}
.viewer canvas{width:100%;border:1px solid #d5dce4;border-radius:6px;background:#fff}
.viewer .row{display:flex;gap:12px;align-items:center;margin:6px 0}.viewer input[type=range]{flex:1}
.scale b{display:inline-block;width:120px;height:11px;
background:linear-gradient(90deg,#440154,#3b528b,#21918c,#5ec962,#fde725)}
.scale i,.legend i{display:inline-block;width:12px;height:12px;margin:0 5px 0 10px;
vertical-align:-1px}
.legend{font-size:13px}.grid{stroke:#e3e8ee}.axis{stroke:#667;fill:none}.tick{font-size:11px;
fill:#556}
.label{font-size:12.5px;fill:#334}.error b{color:#b3261e}.warning b{color:#9a6700}
.note b{color:#35618e}
.bar{background:#35618e;height:11px}details{margin:6px 0}
@media print{.viewer .row input,.viewer button{display:none}h2{break-after:avoid}}
"""

#: Lines of the certificate: what they are, beyond what they warn, whether less is better.
CERTIFICATE = {
    "penetration": ("deepest penetration / facet", None),
    "depth": ("deepest penetration of a slope / thinnest body", 0.02),
    "tension": ("largest tension / largest pressure", None),
    "complementarity": ("pressure across a gap, or penetration of hard contact", 1e-6),
    "cone": ("friction beyond its bound", 1e-6),
    "ramp": ("what slipping points lack of bounds that rise with the first pressure", None),
    "dissipation": ("least work of friction of a point (negative is wrong)", None),
    "pressure_error": ("estimated pressure error of a penalty", 0.02),
    "equilibrium": ("largest residual / forces", 1e-6),
    "action_reaction": ("sum of forces of both sides", 1e-6),
    "energy": ("work that is neither stored nor dissipated", 0.01),
    "traction": ("force that printed pressures do not carry", 0.02),
    "support": ("reaction of artificial supports", 1e-6),
    "artificial": ("work of what held floating bodies", 0.01),
    "corner": ("least scaled Jacobian of a corner (1 is square, 0 folded)", None),
}

#: Energies of the summary: what they are.
ENERGY = {
    "strain": "stored in the bodies",
    "external": "work of loads and prescribed motions",
    "thermal": "work of thermal strains",
    "contact": "stored in penalties of contact",
    "friction": "friction, by the tractions at the ends of increments",
    "friction_mean": "friction, by mean tractions: the rule of external",
    "plastic": "dissipated by plastic or viscous flow",
    "artificial": "of what held floating bodies",
    "lost": "external less all others; points that close within an increment add to it",
}


def page(runs: list[Run]) -> str:
    """The whole page of a run; more runs are laid beside it."""
    run = runs[0]
    body = [_banner(run), _box(run)]
    if len(runs) > 1:
        body.append(_beside(runs))
    body += [_picture(run), _contact(run), _surfaces(runs), _tools(runs), _energies(runs),
             _convergence(runs), _certificate(run), _timing(run), _diagnostics(run)]
    title = f"{run.name}: {run.status}"
    return (f"<!DOCTYPE html>\n<html lang='en'><head><meta charset='utf-8'><title>{escape(title)}"
            f"</title><style>{STYLE}</style></head><body>\n"
            + "\n".join(part for part in body if part)
            + f"\n<script>{SCRIPT}</script></body></html>\n")


def _number(value, key: str = "") -> str:
    """A number as the summary has it, to seven digits; its exact value beside it for programs."""
    if isinstance(value, bool) or value is None:
        return escape(str(value))
    mark = f" data-key='{escape(key)}'" if key else ""
    return f"<data{mark} value='{value!r}'>{value:.7g}</data>"


def _table(rows, head=()) -> str:
    """Rows of ready cells; numbers are those that begin with <data."""
    out = ["<table>"]
    if head:
        out.append("<tr>" + "".join(f"<th>{escape(word)}</th>" for word in head) + "</tr>")
    for row in rows:
        cells = (f"<td class=n>{cell}</td>" if str(cell).startswith("<data") else f"<td>{cell}</td>"
                 for cell in row)
        out.append("<tr>" + "".join(cells) + "</tr>")
    return "".join(out) + "</table>"


def _banner(run: Run) -> str:
    """What came of the run, in a line."""
    certificate = run.summary.get("certificate") or {}
    reason = certificate.get("reason") or ""
    errors = [d for d in run.diagnostics if d.get("severity") == "error"]
    warned = sorted({str(d.get("code")) for d in run.diagnostics if d.get("severity") == "warning"})
    colour = run.verdict or "none"
    finished = run.status == "finished"
    text = f"{run.status}"
    if run.verdict and finished:
        text += f"; certificate {run.verdict}"
    if not finished:
        colour = "none" if run.status == "running" else "bad"
    if errors:
        text += f": {errors[0]['code']}, {errors[0]['message']}"
    if run.verdict and not finished:
        text += f". Increments up to there: {run.verdict}"
    elif not errors and not finished:
        text += _so_far(run)
    elif run.verdict in ("WARN", "FAIL") and reason:
        text += (f": {reason} (step {certificate['step']}, increment {certificate['increment']}; "
                 f"{certificate.get('increments_warned', 0)} increments not PASS)")
    if warned:
        text += f"; warnings: {', '.join(warned)}"
        colour = "WARN" if colour == "PASS" else colour
    heading = str(run.summary.get("heading") or run.name)
    return (f"<h1>{escape(heading)}</h1><div class='banner {colour}' id='status' "
            f"data-status='{escape(run.status)}' data-verdict='{escape(run.verdict)}'>"
            f"{escape(text)}</div>"
            + "".join(f"<p class='warning'><b>left out</b>: {escape(trouble)}</p>"
                      for trouble in run.troubles))


def _so_far(run: Run) -> str:
    """How far a run has come that has not said its end: it goes on, or was killed."""
    if not run.steps:
        return ", no increment yet"
    step, increment, *_ = run.steps[-1]
    return (f", step {step:.0f}, increment {increment:.0f}, time {run.steps[-1][4]:g} so far (if "
            "it was killed, the same command with --resume goes on)")


def _box(run: Run) -> str:
    """What was run, how, and what it took."""
    summary, model = run.summary, run.summary.get("model", {})
    steps = summary.get("steps", [])
    total = (summary.get("timing") or {}).get("total", 0.0)
    rows = [("result", f"<code>{escape(str(run.folder))}</code>, {escape(run.name)}"),
            ("model", f"{escape(str(model.get('kind', '')))}, "
             f"{_number(model.get('nodes'), 'nodes')} nodes, "
             f"{_number(model.get('elements'), 'elements')} elements"),
            *(("*" + escape(name), escape(str(value)))
              for name, value in (summary.get("settings") or {}).items()),
            ("plan", escape(str(summary.get("plan", "")))),
            ("time and memory", f"{_number(total, 'timing.total')} s, "
             f"{_number(summary.get('peak_memory_mib'), 'peak_memory_mib')} MiB"),
            ("checksum", f"<code>{escape(str(summary.get('checksum', '')))}</code> "
             "of all displacements"),
            ("again", f"<code>lopin run {escape(str(summary.get('deck', run.name + '.inp')))}"
             f"</code>, Lopin {escape(str(summary.get('version', '')))}")]
    if not model:   # a run that has not ended says no more
        rows = rows[:1]
    table = "<table>" + "".join(f"<tr><th>{k}</th><td>{v}</td></tr>" for k, v in rows) + "</table>"
    if not steps:
        return table
    head = ("step", "increments", "iterations", "factorisations", "back solves", "augmentations")
    words = ("increments", "iterations", "factorisations", "back_solves", "augmentations")
    return table + _table([[i + 1] + [_number(step.get(w), f"steps.{i}.{w}") for w in words]
                           for i, step in enumerate(steps)], head)


def _picture(run: Run) -> str:
    """The deformed part over time."""
    if run.shape is None or not run.shape.parts:
        return ""
    data = json.dumps(run.shape.data(), separators=(",", ":"))
    hint = "drag to move" if run.shape.dimensions == 2 else "drag to turn, with shift to move"
    return ("<h2>The deformed part</h2><div class='viewer'><div class='row'><select></select>"
            "<label><input type='checkbox' class='tools'> tools</label>"
            "<label><input type='checkbox' class='own'> colours of this time</label>"
            "<button class='close'>to the contact</button><button class='whole'>all</button>"
            "<span class='scale'></span><span class='value'></span></div>"
            "<canvas width='980' height='520'></canvas>"
            "<div class='row'><button class='play'>play</button>"
            "<input type='range' min='0' step='1'>"
            "<span class='time'></span></div>"
            f"<p class='none'>{len(run.shape.times)} of {len(run.history.get('time', []))} "
            f"increments; {hint}, wheel to zoom, point to read a value</p>"
            f"<script type='application/json'>{data}</script></div>")


def _contact(run: Run) -> str:
    """Every pair at the end."""
    rows = []
    words = ("area", "max_pressure", "max_penetration", "closed", "sticking", "traction")
    for i, pair in enumerate(run.summary.get("contact", [])):
        force = ", ".join(_number(f, f"contact.{i}.force.{k}")
                          for k, f in enumerate(pair.get("force", [])))
        rows.append([escape(pair.get("pair", "")), escape(pair.get("method", "")), force]
                    + [_number(pair.get(w), f"contact.{i}.{w}") for w in words]
                    + [_number(pair.get("peak", {}).get(w), f"contact.{i}.peak.{w}")
                       for w in ("force", "pressure")])
    if not rows:
        return ""
    note = "<p class='none'>Forces are on the full circumference.</p>" \
        if run.summary.get("forces") == "full circumference" else ""
    return "<h2>Contact at the end</h2>" + _table(rows, (
        "pair", "method", "force on the slave", "area", "largest pressure", "deepest penetration",
        "closed", "sticking", "not carried", "most of the run: force", "pressure")) + note


def _surfaces(runs: list[Run]) -> str:
    """Pressure along every slave surface of the plane, where it was last pressed."""
    pictures = []
    for name in dict.fromkeys(part.name for run in runs for part in _pressed(run)):
        curves: list = []
        for run in runs:
            for part in (p for p in _pressed(run) if p.name == name):
                frame = last_pressed(run.shape, part)
                label = run.folder.name if len(runs) > 1 else f"at time {run.shape.times[frame]:g}"
                for field in ("contact pressure", "friction traction")[:2 if len(runs) == 1 else 1]:
                    if np.abs(part.fields.get(field, [[0.0]]*(frame + 1))[frame]).max() > 0.0:
                        curves += [(f"{field} {label}", s, values, run is not runs[0])
                                   for s, values in along(part, frame, field)]
        pictures.append(f"<div><div><b>{escape(name)}</b></div>"
                        f"{chart(curves, 'length along the slave surface', 'traction')}</div>")
    return f"<h2>Contact pressure</h2><div class='two'>{''.join(pictures)}</div>" \
        if pictures else ""


def _pressed(run: Run) -> list:
    """Contact surfaces of the plane that were pressed."""
    return [part for part in (run.shape.parts if run.shape else ()) if part.kind == "contact"
            and last_pressed(run.shape, part) is not None]


def _tools(runs: list[Run]) -> str:
    """Force against travel of every tool."""
    pictures = []
    for name, moves in runs[0].tools().items():
        for dof, travel, _ in moves:
            curves, sense = [], -1.0 if np.sum(travel) < 0.0 else 1.0
            for run in runs:
                found = [m for m in run.tools().get(name, []) if m[0] == dof]
                curves += [(run.folder.name if len(runs) > 1 else f"{name}, dof {dof}",
                            np.append(0.0, sense*m[1]), np.append(0.0, sense*m[2]),
                            run is not runs[0])
                           for m in found]
            way = f"{'-' if sense < 0.0 else ''}{'xyz'[dof - 1]}"
            pictures.append(f"<div>{chart(curves, f'stroke of {name} along {way}', 'force')}</div>")
    if not pictures:
        return ""
    return f"<h2>Tools: force and travel</h2><div class='two'>{''.join(pictures)}</div>"


def _energies(runs: list[Run]) -> str:
    """Energies over time, and at the end."""
    curves = []
    for number, run in enumerate(runs):
        for word in ("external", "strain", "plastic", "friction", "contact", "artificial"):
            values = run.history.get(f"energy.{word}")
            if values is not None and np.abs(values).max(initial=0.0) > 0.0:
                name = word if len(runs) == 1 else f"{word}, {run.folder.name}"
                curves.append((name, np.append(0.0, run.history["time"]), np.append(0.0, values),
                               number > 0))
    energy = runs[0].summary.get("energy") or {}
    rows = [(escape(word), _number(value, f"energy.{word}"), ENERGY.get(word, ""))
            for word, value in energy.items()]
    if not rows and not curves:
        return ""
    return (f"<h2>Energies</h2><div class='two'><div>{chart(curves, 'time', 'energy')}</div>"
            f"<div>{_table(rows)}</div></div>")


def _convergence(runs: list[Run]) -> str:
    """Sizes of increments, iterations, residuals of the last ones, and what was cut."""
    run = runs[0]
    if not run.steps:
        return ""
    sizes, iterations = [], []
    for one in runs:
        label = one.folder.name if len(runs) > 1 else "increment"
        table = np.array(one.steps).reshape(-1, 9)
        sizes.append((label, table[:, 4], table[:, 6]))
        iterations.append((label.replace("increment", "iterations"), table[:, 4], table[:, 3]))
    history = [(f"{step}.{number}", np.arange(1, len(r) + 1), r)
               for step, number, r, _ in [a for a in run.attempts if len(a[2]) > 1][-5:]]
    cuts = [a for a in run.attempts if a[3]]
    text = ""
    if cuts:
        text = f"<details><summary>{len(cuts)} attempts were cut</summary>" + _table(
            [(step, number, escape(reason)) for step, number, _, reason in cuts[:40]],
            ("step", "increment", "because")) + "</details>"
    pictures = [chart(sizes, "time", "size of increments", logarithmic=True),
                chart(iterations, "time", "iterations")]
    if history:
        pictures.append(chart(history, "iteration", "residual, by step.increment",
                              logarithmic=True))
    return ("<h2>Convergence</h2><div class='two'>" + "".join(f"<div>{p}</div>" for p in pictures)
            + f"</div>{text}")


def _certificate(run: Run) -> str:
    """The lines of the worst increment."""
    certificate = run.summary.get("certificate") or {}
    if not run.verdict:
        return ""
    rows = []
    for word, (meaning, limit) in CERTIFICATE.items():
        if word not in certificate:
            continue
        value = certificate[word]
        rows.append((f"<b>{word}</b>", _number(value, f"certificate.{word}"),
                     "" if limit is None else f"warns above {limit:g}",
                     "beyond" if limit is not None and value > limit else "", meaning))
    return (f"<h2>Certificate of the worst increment: {escape(run.verdict)}</h2><p>Step "
            f"{_number(certificate.get('step'), 'certificate.step')}, increment "
            f"{_number(certificate.get('increment'), 'certificate.increment')}; "
            f"{_number(certificate.get('increments_warned'), 'certificate.increments_warned')} "
            "increments are not PASS. "
            f"{escape(certificate.get('reason') or '')}</p>" + _table(rows))


def _timing(run: Run) -> str:
    """Where the time went."""
    timing = dict(run.summary.get("timing") or {})
    total = timing.pop("total", 0.0) or 1.0
    rows = [(escape(word), _number(value, f"timing.{word}"),
             f"<div class='bar' style='width:{300*value/total:.0f}px'></div>")
            for word, value in sorted(timing.items(), key=lambda item: -item[1]) if value > 0.0]
    return "<h2>Time [s]</h2>" + _table(rows) if rows else ""


def _diagnostics(run: Run) -> str:
    """Errors, warnings and notes with their deck lines."""
    if not run.diagnostics:
        return "<h2>Messages</h2><p class='none'>no error, no warning, no note</p>"
    out = ["<h2>Messages</h2>"]
    for item in run.diagnostics:
        place = ""
        if item.get("line"):
            place = f" <code>{escape(str(item.get('file')))}:{item['line']}</code>"
            text = run.lines.get((item.get("file"), item["line"]))
            if text is not None:
                place += f"<pre>{escape(text)}</pre>"
        help_ = f"<br>what to do: {escape(item['help'])}" if item.get("help") else ""
        kind = escape(str(item.get("severity")))
        out.append(f"<p class='{kind}'><b>{kind} {escape(str(item.get('code')))}</b>: "
                   f"{escape(str(item.get('message')))}{help_}{place}</p>")
    return "".join(out)


def _beside(runs: list[Run]) -> str:
    """The runs side by side."""
    def of(run, *path):
        value = run.summary
        for word in path:
            value = (value or {}).get(word) if isinstance(value, dict) else None
        return value

    names = [escape(run.folder.name) for run in runs]
    rows = [["status"] + [escape(run.status) for run in runs],
            ["certificate"] + [escape(run.verdict) for run in runs]]
    for word, path in (("time [s]", ("timing", "total")), ("equations", ("equations",)),
                       ("pressure error", ("certificate", "pressure_error")),
                       ("penetration / facet", ("certificate", "penetration")),
                       ("external work", ("energy", "external")),
                       ("strain energy", ("energy", "strain")),
                       ("work of friction", ("energy", "friction"))):
        values = [of(run, *path) for run in runs]
        if any(value is not None for value in values):
            rows.append([word] + ["" if v is None else _number(v, f"{n}:{'.'.join(path)}")
                                  for n, v in zip(range(len(runs)), values)])
    pairs = {pair.get("pair") for run in runs for pair in run.summary.get("contact", [])}
    for name in sorted(pairs):
        for word, key in (("largest pressure", "max_pressure"),
                          ("deepest penetration", "max_penetration")):
            found = [next((p.get(key) for p in run.summary.get("contact", [])
                           if p.get("pair") == name), None) for run in runs]
            rows.append([f"{escape(name)}: {word}"]
                        + ["" if v is None else _number(v) for v in found])
    increments = [sum(s.get("increments", 0) for s in run.summary.get("steps", [])) for run in runs]
    rows.insert(2, ["increments"] + [_number(n) for n in increments])
    return "<h2>The runs beside each other</h2>" + _table(rows, ["", *names])
