"""Curves as SVG: axes with round numbers, one colour a curve, a legend."""
from __future__ import annotations

from html import escape

import numpy as np

#: Told apart by people who see fewer colours, too (Okabe and Ito).
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000")
_WIDTH, _HEIGHT, _LEFT, _BOTTOM, _TOP, _RIGHT = 460, 290, 66, 44, 14, 14


def chart(curves, across: str, up: str, *, logarithmic: bool = False) -> str:
    """Curves ``(name, x, y[, dashed])`` in one picture."""
    curves = [(name, *_finite(x, y, logarithmic), bool(dashed and dashed[0]))
              for name, x, y, *dashed in curves]
    curves = [curve for curve in curves if len(curve[1])]
    if not curves:
        return "<p class='none'>nothing to draw</p>"
    x_low, x_high = _limits(np.concatenate([c[1] for c in curves]))
    y_low, y_high = _limits(np.concatenate([c[2] for c in curves]))
    if not logarithmic and 0.0 < y_low < 0.6*y_high:
        y_low = 0.0
    if not logarithmic and y_low < 0.6*y_high < 0.0 and y_high < 0.0:
        y_high = 0.0

    def place(x, y):
        return (_LEFT + (x - x_low)/(x_high - x_low)*(_WIDTH - _LEFT - _RIGHT),
                _HEIGHT - _BOTTOM - (y - y_low)/(y_high - y_low)*(_HEIGHT - _BOTTOM - _TOP))

    out = [f'<svg viewBox="0 0 {_WIDTH} {_HEIGHT}" role="img" aria-label="{escape(up)} against '
           f'{escape(across)}">']
    for value in ticks(x_low, x_high):
        x, _ = place(value, y_low)
        out.append(f'<path class="grid" d="M{x:.1f} {_TOP}V{_HEIGHT - _BOTTOM}"/>'
                   f'<text class="tick" text-anchor="middle" x="{x:.1f}" '
                   f'y="{_HEIGHT - _BOTTOM + 15}">{_short(value)}</text>')
    for value in ticks(y_low, y_high):
        _, y = place(x_low, value)
        label = _short(float(f"{10.0**value:.2g}")) if logarithmic else _short(value)
        out.append(f'<path class="grid" d="M{_LEFT} {y:.1f}H{_WIDTH - _RIGHT}"/><text class="tick" '
                   f'text-anchor="end" x="{_LEFT - 6}" y="{y + 4:.1f}">{label}</text>')
    out.append(f'<path class="axis" d="M{_LEFT} {_TOP}V{_HEIGHT - _BOTTOM}H{_WIDTH - _RIGHT}"/>'
               f'<text class="label" text-anchor="middle" x="{(_LEFT + _WIDTH)/2:.0f}" '
               f'y="{_HEIGHT - 8}">{escape(across)}</text><text class="label" text-anchor="middle" '
               f'transform="translate(14 {(_HEIGHT - _BOTTOM)/2:.0f}) rotate(-90)">'
               f'{escape(up)}</text>')
    for number, (name, x, y, dashed) in enumerate(curves):
        colour = COLOURS[number % len(COLOURS)]
        points = " ".join(f"{a:.1f},{b:.1f}" for a, b in (place(*p) for p in zip(x, y)))
        style = ' stroke-dasharray="6 4"' if dashed else ""
        mark = f'<circle cx="{points.split(",")[0]}" cy="{points.split(",")[1]}" r="3" ' \
               f'fill="{colour}"/>' if len(x) == 1 else ""
        out.append(f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="1.8"'
                   f'{style}/>{mark}')
    out.append("</svg>")
    legend = "".join(f'<span><i style="background:{COLOURS[i % len(COLOURS)]}"></i>'
                     f'{escape(c[0])}</span>' for i, c in enumerate(curves))
    return "".join(out) + f"<div class='legend'>{legend}</div>"


def ticks(low: float, high: float, about: int = 6) -> list[float]:
    """Round numbers between two values."""
    raw = (high - low)/about
    power = 10.0**np.floor(np.log10(raw))
    step = next(m*power for m in (1.0, 2.0, 2.5, 5.0, 10.0) if m*power >= raw*0.999)
    first = np.ceil(low/step - 1e-9)*step
    return [float(0.0 if abs(v) < step*1e-9 else v)
            for v in np.arange(first, high + step*1e-6, step)]


def _finite(x, y, logarithmic: bool):
    x, y = np.asarray(x, float), np.asarray(y, float)
    if logarithmic:
        y = np.log10(np.where(y > 0.0, y, np.nan))
    good = np.isfinite(x) & np.isfinite(y)
    return x[good], y[good]


def _limits(values) -> tuple[float, float]:
    low, high = float(values.min()), float(values.max())
    if high - low <= 1e-12*max(abs(low), abs(high)):
        pad = abs(high)*0.5 or 0.5
        return low - pad, high + pad
    return low, high


def _short(value: float) -> str:
    return f"{value:.6g}"
