"""Benchmark D5: a shrink-fitted shaft turns in its hub."""
from __future__ import annotations

import numpy as np

import lopin
from lopin import mesh_make
from lopin.mesh import together
from sliding_scenes import deck, material, pair, sections, step

#: Radii and interference [mm].
BORE, FIT, RIM, DELTA = 10.0, 30.0, 50.0, 0.01
YOUNG, NU = 210e3, 0.3
#: Lame, plane strain.
PRESSURE = 22.792022


def bore_displacement() -> float:
    """Radial displacement of the bore of the shaft under the pressure at the fit (Lame)."""
    e, v = YOUNG/(1.0 - NU**2), NU/(1.0 - NU)
    a = -PRESSURE*FIT**2/(FIT**2 - BORE**2)
    return (1.0 - v)/e*a*BORE + (1.0 + v)/e*a*BORE


def driven(mesh, angle: float, increments: int) -> tuple[str, str]:
    """Amplitudes and boundaries that turn the bore; its radial displacement is Lame's."""
    amplitudes, held, moved = [], [], []
    shrink = bore_displacement()
    for i in mesh.point_sets["SHAFT.INNER"]:
        x, y = mesh.points[i]
        start = np.arctan2(y, x)
        for d, wave in ((1, np.cos), (2, np.sin)):
            way = (BORE + shrink)*wave(start
                                       + np.radians(angle)*np.arange(increments + 1)/increments)
            way -= BORE*wave(start)
            held.append(f"{i + 1}, {d}, {d}, {float(way[0])!r}")
            flat = [f"{v!r}" for k, w in enumerate(way) for v in (float(k)/increments, float(w))]
            amplitudes.append(f"*AMPLITUDE, NAME=A{i}D{d}\n"
                              + "\n".join(", ".join(flat[k:k + 8]) for k in range(0, len(flat), 8)))
            moved.append(f"*BOUNDARY, AMPLITUDE=A{i}D{d}\n{i + 1}, {d}, {d}, 1.")
    return "\n".join(amplitudes) + "\n", ("*BOUNDARY\n" + "\n".join(held) + "\n", "\n".join(moved)
                                          + "\n")


def rings(*, around=(48, 48), layers=4, quadratic=False, words="", friction=0.0, angle=90.0,
          increments=90,
          behaviour="*SURFACE BEHAVIOR, DIRECT", slave="shaft", start=0.0) -> lopin.Deck:
    """Shrink fit in the first step, a turn of the shaft in the second; angles in degrees."""
    shaft = mesh_make.ring(BORE, FIT + DELTA, (layers, around[0]), angles=(start, 360.0 + start),
                           quadratic=quadratic)
    hub = mesh_make.ring(FIT, RIM, (layers, around[1]), angles=(0.0, 360.0), quadratic=quadratic)
    mesh = together(SHAFT=shaft, HUB=hub)
    amplitudes, (held, moved) = driven(mesh, angle, increments)
    pins = []
    for k in range(4):
        a = np.pi/2*k
        far = RIM*np.array([np.cos(a), np.sin(a)])
        i = int(np.argmin(((mesh.points - far)**2).sum(1))) + 1
        pins.append(f"{i}, {2 - k % 2}")
    sides = ("SHAFT.OUTER", "HUB.INNER")[::1 if slave == "shaft" else -1]
    cards = (material(YOUNG, NU) + sections({"SHAFT": "M", "HUB": "M"}) + amplitudes
             + pair(*sides, behaviour=behaviour, friction=friction, words=words)
             + "*BOUNDARY\n" + "\n".join(pins) + "\n"
             + step("1., 1.", held) + step(f"{1.0/increments!r}, 1.", moved, direct=True))
    return deck(mesh, cards)


def pressures_and_torques(result) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Per increment: smallest and largest pressure, weighted mean, torque of the contact forces."""
    found, torques = [], []
    for k in range(len(result.times)):
        c = result.contact(0).at(k)
        w = np.asarray(c["WEIGHT"]).ravel()
        found.append((c.pressure.min(), c.pressure.max(), (w*c.pressure).sum()/w.sum()))
        x = np.asarray(c.x)[:, :2] + np.asarray(c["U"])[:, :2]
        f = np.asarray(c.force)
        torques.append(float((x[:, 0]*f[:, 1] - x[:, 1]*f[:, 0]).sum()))
    return np.array(found), np.array(torques), np.asarray(result.times)
