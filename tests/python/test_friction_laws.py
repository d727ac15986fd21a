"""C9, the zoo of laws, on a block that is pressed and dragged: every law by every method, exact and
regularised.

The block has one row of elements and slides at 2 mm/s, so that the shear of every slave node is the
law's value for its own pressure, stress and speed; the tool's force is their sum.
"""
import numpy as np
import pytest

from lopin import _bridge
from lopin.closed_form.friction import dragged_tractions
from lopin.friction import law_words

AREA, LENGTH, HEIGHT, ELEMENTS = 4.0, 4.0, 1.0, 4
SPEED, YIELD, MU, M, ALPHA, Q = 2.0, 200.0, 0.3, 0.2, 5.0, 0.2
SHEAR = M*YIELD/np.sqrt(3.0)
DATA = {"mu": MU, "m": M, "alpha": ALPHA, "q": Q}
METHODS = ["DIRECT", "PENALTY", "PERTURBED LAGRANGE", "AUGMENTED LAGRANGE"]
LAWS = law_words()    # all that the core has, with the names of their data
CURVES = {"ARCTAN": lambda x: 2.0/np.pi*np.arctan(x), "TANH": np.tanh,
          "SQRT": lambda x: x/np.hypot(1.0, x)}


def shear_of(law: str, p, s):
    """Of nodes of pressure p and von Mises stress s, by the closed form; a law that has none there
    is compared with the kernel of its own."""
    formula = dragged_tractions(p, SPEED, yield_stress=YIELD, mises=s, **DATA).get(law)
    if formula is not None:
        return formula + 0.0*p
    return np.array([_bridge.probe_friction(law, 1e6*abs(pk) + 1e6, pk, yield_stress=YIELD, mises=sk,
                                            speed=SPEED, **DATA)[0, 0] for pk, sk in zip(p, s)])


def block(law: str, words: str = "", method: str = "DIRECT", increments: int = 6,
          steps: str = "0.02") -> str:
    x = np.linspace(0.0, LENGTH, ELEMENTS + 1)
    n = len(x)
    nodes = "".join(f"{k + 1}, {v!r}, 0.\n{k + 1 + n}, {v!r}, {HEIGHT!r}\n"
                    for k, v in enumerate(map(float, x)))
    elements = "".join(f"{k}, {k}, {k + 1}, {k + 1 + n}, {k + n}\n" for k in range(1, n))
    plastic = f"*PLASTIC, ONLY=FRICTION\n{YIELD}, 0.\n" if "m" in LAWS[law] else ""
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
{", ".join(str(DATA[name]) for name in LAWS[law])},
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
        return abs(h["FLOOR.rf1"][-1]), abs(h["FLOOR.rf2"][-1]), weight @ shear_of(law, pressure,
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


@pytest.mark.parametrize("law", LAWS)
def test_the_number_of_increments_does_not_matter(drag, law):
    few, many = drag(law, increments=3)[0], drag(law, increments=12)[0]
    assert few == pytest.approx(many, rel=1e-7)
