"""Bodies that nothing holds for a while: kept where they are, led to their contact, and what that
took told as a number."""
import pytest

import lopin
from test_driven_wheel import wheel

MODULUS, SQUEEZE, ABOVE, BELOW = 1000.0, 1e-3, 0.1, 0.05


def blocks(kind, sheets, long, height, length):
    """Nodes, elements and skins of flat sheets, one on the other with `BELOW` between them."""
    solid = kind.startswith("C3D")
    nx, ny, nz = 4, 2, 2 if solid else 0
    nodes, elements, top, bottom, left, front = [], [], [], [], [], []
    for s in range(sheets):
        first, base = 1 + 1000*s, s*(height + BELOW)

        def at(i, j, k, first=first):
            return first + i + (nx + 1)*(j + (ny + 1)*k)

        for k in range(nz + 1):
            for j in range(ny + 1):
                for i in range(nx + 1):
                    x = (long*i/nx, base + height*j/ny, long*k/max(nz, 1))
                    nodes.append((at(i, j, k), [v*length for v in x[:3 if solid else 2]]))
                    if i == 0:
                        left.append(at(i, j, k))
                    if k == 0:
                        front.append(at(i, j, k))
        label = 1000*s
        lower, upper = [], []
        for k in range(max(nz, 1)):
            for j in range(ny):
                for i in range(nx):
                    label += 1
                    ring = [at(i, j, k), at(i + 1, j, k), at(i + 1, j + 1, k), at(i, j + 1, k)]
                    elements.append([label, *ring] + ([n + (nx + 1)*(ny + 1) for n in ring]
                                                      if solid else []))
                    if j == 0:
                        lower.append((label, "S3" if solid else "S1"))
                    if j == ny - 1:
                        upper.append((label, "S5" if solid else "S3"))
        bottom.append(lower)
        top.append(upper)
    return nodes, elements, top, bottom, left, front


def closing(kind="CPE4", words="", static="0.25, 1.", length=1.0, modulus=MODULUS, mu=0.0,
            load=0.0, sheets=1, turned=False):
    """Sheets with clearance between two flat tools; the upper one closes and squeezes them."""
    solid = kind.startswith("C3D")
    height, long = 0.5, 5.0
    nodes, elements, top, bottom, left, front = blocks(kind, sheets, long, height, length)
    whole = sheets*height + (sheets - 1)*BELOW
    side, up = ((2, 1) if turned else (1, 2))

    def place(x):
        return [-x[1], x[0], *x[2:]] if turned else x

    def line(*values):
        return ", ".join(repr(float(v)) if isinstance(v, float) else str(v) for v in values)

    sign = -1.0 if turned else 1.0
    text = ["*NODE, NSET=N", *(line(n, *place(x)) for n, x in nodes),
            f"*ELEMENT, TYPE={kind}, ELSET=E", *(line(*e) for e in elements),
            f"*SOLID SECTION, ELSET=E, MATERIAL=M\n{length if not solid else ''!s},",
            f"*MATERIAL, NAME=M\n*ELASTIC\n{modulus!r}, 0.",
            "*NSET, NSET=LEFT", *(str(n) for n in left), f"*BOUNDARY\nLEFT, {side}"]
    if solid:
        text += ["*NSET, NSET=FRONT", *(str(n) for n in front), "*BOUNDARY\nFRONT, 3"]
    for s in range(sheets):
        text += [f"*SURFACE, NAME=T{s}", *(line(*f) for f in top[s]),
                 f"*SURFACE, NAME=B{s}", *(line(*f) for f in bottom[s])]
    for name, label, y, way in (("UP", 90001, whole + ABOVE, -1.0), ("LOW", 90002, -BELOW, 1.0)):
        a = [v*length for v in ((-20.0*way, y, 0.0) if solid else (-20.0*way, y))]
        b = [v*length for v in ((20.0*way, y, 0.0) if solid else (20.0*way, y))]
        text += [f"*NODE\n{line(label, *place(a))}"]
        if solid:
            at = [0.0, y*length, 0.0]
            axes = [place([u + length*v for u, v in zip(at, d)])
                    for d in ([way, 0.0, 0.0], [0.0, 0.0, 1.0])]
            text += [f"*SURFACE, NAME={name}, TYPE=CYLINDER\n{line(*place(at), *axes[0])}\n"
                     f"{line(*axes[1])}\nSTART, {-20.0*length!r}, 0.\nLINE, {20.0*length!r}, 0."]
        else:
            text += [f"*SURFACE, NAME={name}, TYPE=SEGMENTS\nSTART, {line(*place(a))}\n"
                     f"LINE, {line(*place(b))}"]
        text += [f"*RIGID BODY, ANALYTICAL SURFACE={name}, REF NODE={label}",
                 f"*BOUNDARY\n{label}, 1, 6"]
    text += ["*SURFACE INTERACTION, NAME=I", *([f"*FRICTION\n{mu!r}"] if mu else []),
             f"*CONTACT PAIR, INTERACTION=I\nT{sheets - 1}, UP\nB0, LOW"]
    text += [f"T{s}, B{s + 1}" for s in range(sheets - 1)]
    stroke = -sign*(ABOVE + sheets*BELOW + sheets*SQUEEZE*height)*length
    text += [f"*STEP, INC=1000{words}\n*STATIC\n{static}\n*BOUNDARY\n90001, {up}, {up}, {stroke!r}"]
    if load:
        text += ["*CLOAD", *(f"{n}, {up}, {-sign*load!r}" for n, _ in nodes)]
    return lopin.Deck.parse("\n".join([*text, "*END STEP"]), "floating")


def force_of(result, turned=False):
    return abs(result.history["UP.rf1" if turned else "UP.rf2"][-1])


@pytest.mark.parametrize("words", ["", ", NLGEOM"], ids=["linear", "finite"])
@pytest.mark.parametrize("more", [
    {}, {"kind": "CPS4"}, {"kind": "CPE4R"}, {"kind": "CPE4I"}, {"kind": "C3D8"},
    {"kind": "C3D8R"}, {"static": "1., 1."}, {"static": "0.01, 1."}, {"static": "0.1, 1., 1e-5, 0.1"},
    {"length": 1e4, "modulus": 1e-3}, {"length": 1e-3, "modulus": 1e9}, {"turned": True},
    {"mu": 0.1}, {"mu": 0.1, "static": "0.02, 1."}],
    ids=["quads", "plane stress", "reduced", "modes", "bricks", "reduced bricks", "one increment",
         "many", "even", "large", "small", "turned", "friction", "friction, many"])
def test_a_sheet_with_clearance_between_closing_tools(solve, words, more):
    result = solve(closing(words=words, **more))
    length, modulus = more.get("length", 1.0), more.get("modulus", MODULUS)
    area = 5.0*(5.0 if "C3D" in more.get("kind", "") else 1.0)*length**2
    assert force_of(result, more.get("turned")) == pytest.approx(SQUEEZE*modulus*area, rel=3e-3)
    summary = result.summary
    assert abs(summary["energy"]["artificial"]) <= 1e-9*summary["energy"]["strain"]
    assert summary["certificate"]["verdict"] == "PASS"
    codes = [d["code"] for d in summary["diagnostics"]]
    # In one increment of the linear path the sheet is pressed before it ever floats.
    assert codes.count("N0511") == int(bool(words) or more.get("static") != "1., 1.")
    assert not any(c.startswith("W") for c in codes), codes


@pytest.mark.parametrize("words", ["", ", NLGEOM"], ids=["linear", "finite"])
@pytest.mark.parametrize("more", [{"load": 1e-6}, {"load": 1e-3}, {"load": -1e-3},
                                  {"kind": "C3D8", "load": 1e-4}, {"load": 1e-3, "static": "1., 1."}],
                         ids=["feather", "down", "up", "bricks", "one increment"])
def test_a_load_drives_the_sheet_to_a_tool_and_its_work_is_told(solve, words, more):
    result = solve(closing(words=words, **more))
    energy = result.summary["energy"]
    nodes = 45 if "kind" in more else 15
    total = nodes*abs(more["load"])
    if more.get("static") == "1., 1.":
        # Within one increment the tools push as much as the load.
        assert energy["artificial"] <= 0.5*total*(ABOVE + BELOW)
        return
    # It falls to the lower tool in the first increment, or up to the upper one, which comes down.
    stroke = ABOVE + BELOW + SQUEEZE*0.5
    way = BELOW if more["load"] > 0.0 else ABOVE - 0.25*stroke
    first = 0.5*0.25*total*way
    assert result.history["energy.artificial"][0] == pytest.approx(first, rel=1e-3)
    assert energy["artificial"] == pytest.approx(result.history["energy.artificial"][-1], rel=1e-12)


@pytest.mark.parametrize("words", ["", ", NLGEOM"], ids=["linear", "finite"])
@pytest.mark.parametrize("more", [{"sheets": 2}, {"sheets": 3, "static": "0.05, 1."},
                                  {"sheets": 2, "mu": 0.1}, {"sheets": 2, "load": 5e-5},
                                  {"kind": "C3D8", "sheets": 2}],
                         ids=["two", "three", "friction", "load", "bricks"])
def test_stacked_sheets_float_until_they_are_closed(solve, words, more):
    result = solve(closing(words=words, **more))
    area = 25.0 if "kind" in more else 5.0
    assert force_of(result) == pytest.approx(SQUEEZE*MODULUS*area, rel=3e-3)
    assert result.summary["certificate"]["verdict"] == "PASS"


@pytest.mark.parametrize("words", ["", ", NLGEOM"], ids=["linear", "finite"])
def test_what_no_contact_stops_is_named_in_the_plane(solve, words):
    text = closing(words=words, load=-1e-3).text().replace("T0, UP\n", "")
    with pytest.raises(lopin.LopinError, match="can move along y[^z]*(E|$|:)") as problem:
        solve(lopin.Deck.parse(text, "alone"))
    assert "along z" not in str(problem.value)


@pytest.mark.parametrize("more", [{"mu": 0.01, "static": "1., 1."}, {"mu": 0.02}],
                         ids=["one increment", "slides back"])
def test_a_wheel_that_friction_does_not_hold_is_warned_of(solve, more):
    result = solve(wheel(**{"nx": 40, **more}))
    said = [d["message"] for d in result.diagnostics if d["code"] == "W0532"]
    assert len(said) == 1 and "artificial" in said[0]
    assert result.summary["certificate"]["verdict"] == "WARN"


@pytest.mark.parametrize("mu", [0.3, 0.1])
def test_a_wheel_that_rolls_has_no_artificial_work(solve, mu):
    result = solve(wheel(mu=mu, nx=40, static="0.1, 1."))
    assert result.history["W0.u1"][-1] == pytest.approx(2.0, rel=2e-3)
    assert not any(d["code"] == "W0532" for d in result.diagnostics)
