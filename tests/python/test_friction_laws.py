"""C9, the zoo of laws, on a block that is pressed and dragged: every law by every method, exact and
regularised.

The block has one row of elements and slides at 2 mm/s, so that the shear of every slave node is the
law's value for its own pressure, stress and speed; the tool's force is their sum.
"""
import numpy as np
import pytest

AREA, LENGTH, HEIGHT, ELEMENTS = 4.0, 4.0, 1.0, 4
SPEED, YIELD, MU, M, ALPHA, Q = 2.0, 200.0, 0.3, 0.2, 5.0, 0.2
SHEAR = M*YIELD/np.sqrt(3.0)
METHODS = ["DIRECT", "PENALTY", "PERTURBED LAGRANGE", "AUGMENTED LAGRANGE"]
# Law: data line and the shear of a node of pressure p and von Mises stress s.
LAWS = {
    "COULOMB": (f"{MU}", lambda p, s: MU*p),
    "TRESCA": (f"{M}", lambda p, s: SHEAR + 0.0*p),
    "COULOMB-OROWAN": (f"{MU}, {M}", lambda p, s: np.minimum(MU*p, SHEAR)),
    "CRISTESCU": (f"{M}", lambda p, s: M*s/np.sqrt(3.0)),
    "NORTON-HOFF": (f"{ALPHA}, {Q}", lambda p, s: ALPHA*SPEED**Q + 0.0*p),
}
CURVES = {"ARCTAN": lambda x: 2.0/np.pi*np.arctan(x), "TANH": np.tanh,
          "SQRT": lambda x: x/np.hypot(1.0, x)}


def block(law: str, words: str = "", method: str = "DIRECT", increments: int = 6,
          steps: str = "0.02") -> str:
    x = np.linspace(0.0, LENGTH, ELEMENTS + 1)
    n = len(x)
    nodes = "".join(f"{k + 1}, {v!r}, 0.\n{k + 1 + n}, {v!r}, {HEIGHT!r}\n"
                    for k, v in enumerate(map(float, x)))
    elements = "".join(f"{k}, {k}, {k + 1}, {k + 1 + n}, {k + n}\n" for k in range(1, n))
    plastic = f"*PLASTIC, ONLY=FRICTION\n{YIELD}, 0.\n" if law in ("TRESCA", "COULOMB-OROWAN",
                                                                   "CRISTESCU") else ""
    name = f", LAW={law}" if law != "COULOMB" else ""
    return f"""*NODE
{nodes}99, 0., 0.
*ELEMENT, TYPE=CPE4, ELSET=BLOCK
{elements}*NSET, NSET=TOP, GENERATE
{n + 1}, {2*n}
*SURFACE, NAME=FOOT
BLOCK, S1
*SURFACE, NAME=FLOOR, TYPE=SEGMENTS
START, -10., 0.
LINE, 20., 0.
*RIGID BODY, ANALYTICAL SURFACE=FLOOR, REF NODE=99
*MATERIAL, NAME=STEEL
*ELASTIC
210000., 0.
{plastic}*SOLID SECTION, ELSET=BLOCK, MATERIAL=STEEL
1.,
*SURFACE INTERACTION, NAME=GREASE
*SURFACE BEHAVIOR, {method}
*FRICTION{name}{words}
{LAWS[law][0]},
*CONTACT PAIR, INTERACTION=GREASE, SMALL SLIDING
FOOT, FLOOR
*BOUNDARY
99, 1, 2
99, 6
*STEP
*STATIC, DIRECT
1.E-3, 1.E-3
*BOUNDARY
TOP, 1
TOP, 2, 2, {-80.0*HEIGHT/210000.0!r}
*END STEP
*STEP
*STATIC, DIRECT
{float(steps)/increments!r}, {steps}
*BOUNDARY
TOP, 1, 1, {SPEED*float(steps)!r}
*NODE FILE
U, RF
*EL FILE
S
*CONTACT FILE
CDIS, CSTR
*END STEP
"""


@pytest.fixture
def drag(solve):
    """Force of the floor along and across, and what the law says of the nodes."""
    from lopin import Deck

    def run(law, words="", method="DIRECT", **options):
        result = solve(Deck.parse(block(law, words, method, **options), name="block"))
        h = result.history
        contact = result.contact(0).last
        mises = result["Mises"].ravel()
        order = np.argsort(contact.x[:, 0])
        pressure = np.asarray(contact.pressure)[order]
        foot = mises[:2*(ELEMENTS + 1):2]
        weight = np.full(ELEMENTS + 1, AREA/ELEMENTS)
        weight[[0, -1]] *= 0.5
        return abs(h["FLOOR.rf1"][-1]), abs(h["FLOOR.rf2"][-1]), weight @ LAWS[law][1](pressure,
                                                                                       foot)

    return run


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("law", LAWS)
def test_every_law_by_every_method(drag, sheet, law, method):
    along, across, expected = drag(law, method=method)
    sheet.compare("C9 law zoo", f"{law}, {method}: force that drags", along, expected, 1e-7)
    if law == "COULOMB":
        assert along == pytest.approx(MU*across, rel=1e-10)
    elif law == "TRESCA":
        assert along == pytest.approx(AREA*SHEAR, rel=1e-10)
    elif law == "NORTON-HOFF":
        assert along == pytest.approx(AREA*ALPHA*SPEED**Q, rel=1e-7)


@pytest.mark.parametrize("curve", CURVES)
@pytest.mark.parametrize("law", LAWS)
def test_every_law_regularised_by_speed(drag, sheet, law, curve):
    along, _, expected = drag(law, f", REGULARIZATION={curve}, V0={SPEED}")
    expected *= CURVES[curve](1.0)
    if law == "NORTON-HOFF":
        expected *= 2.0**(0.5*Q)
    sheet.compare("C9 law zoo", f"{law}, {curve} at V0: force that drags", along, expected, 1e-6)


@pytest.mark.parametrize("law", ["CRISTESCU", "NORTON-HOFF", "COULOMB-OROWAN"])
def test_the_number_of_increments_does_not_matter(drag, law):
    few, many = drag(law, increments=3)[0], drag(law, increments=12)[0]
    assert few == pytest.approx(many, rel=1e-7)
