"""A block of squares under a rigid tool: decks whose history is made by amplitudes and first
touch."""
import lopin

FLAT = "START, {b}, {y}\nLINE, -{b}, {y}"


def block(steps: str, cells=(4, 4), side=10.0, tool=FLAT, gap=0.0, mu=0.3, held="BOTTOM, 1, 2",
          behaviour="", before="", material="*ELASTIC\n1000., 0.", word="CPE4") -> lopin.Deck:
    """`tool` is a profile above the block, with {y} for the height of its lowest point and {b} for
    its half breadth; its reference node is 9001, at (0, 0)."""
    nx, ny = cells
    number = lambda i, j: 1 + i + (nx + 1)*j  # noqa: E731
    nodes = [f"{number(i, j)}, {side*i/nx!r}, {side*j/ny!r}" for j in range(ny + 1)
             for i in range(nx + 1)]
    elements = [f"{1 + i + nx*j}, {number(i, j)}, {number(i + 1, j)}, {number(i + 1, j + 1)}, "
                f"{number(i, j + 1)}" for j in range(ny) for i in range(nx)]
    name = {"BOTTOM": [number(i, 0) for i in range(nx + 1)],
            "TOP": [number(i, ny) for i in range(nx + 1)],
            "LEFT": [number(0, j) for j in range(ny + 1)],
            "RIGHT": [number(nx, j) for j in range(ny + 1)]}
    sets = "\n".join(f"*NSET, NSET={k}\n" + "\n".join(map(str, v)) for k, v in name.items())
    faces = "\n".join(f"{1 + i + nx*(ny - 1)}, S3" for i in range(nx))
    return lopin.Deck.parse(f"""*HEADING
A block under a tool
*NODE, NSET=ALL
{chr(10).join(nodes)}
*NODE, NSET=REF
9001, 0., 0.
*ELEMENT, TYPE={word}, ELSET=BLOCK
{chr(10).join(elements)}
{sets}
*SURFACE, NAME=FACE
{faces}
*MATERIAL, NAME=M
{material}
*SOLID SECTION, ELSET=BLOCK, MATERIAL=M
1.,
*SURFACE, NAME=TOOL, TYPE=SEGMENTS
{tool.format(y=side + gap, b=5*side)}
*RIGID BODY, ANALYTICAL SURFACE=TOOL, REF NODE=9001
*SURFACE INTERACTION, NAME=I
{behaviour}
*FRICTION
{mu!r},
*CONTACT PAIR, INTERACTION=I
FACE, TOOL
*BOUNDARY
{held}
9001, 6, 6
{before}
{steps}""".replace("\n\n", "\n"), "block")


def step(cards: str, static="1., 1.", words="", direct=False) -> str:
    """One step."""
    return (f"*STEP, INC=1000{words}\n*STATIC{', DIRECT' if direct else ''}\n{static}\n{cards}\n"
            "*END STEP\n")
