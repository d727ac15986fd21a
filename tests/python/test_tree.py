"""The source tree: no machine in it, links that lead somewhere, short files, late imports."""
import re
import shutil
import subprocess
import sys


def tree(root):
    """Files under version control, or all but build folders where git is not there."""
    if shutil.which("git"):
        done = subprocess.run(["git", "-C", str(root), "ls-files"], capture_output=True, text=True)
        if done.returncode == 0 and done.stdout:
            return [root/name for name in done.stdout.splitlines() if (root/name).is_file()]
    hidden = re.compile(r"^(build.*|out|dist|\.venv|\.git|__pycache__)$")
    return [p for p in root.rglob("*") if p.is_file()
            and not any(hidden.match(part) for part in p.relative_to(root).parts)]


def test_no_file_knows_a_machine_or_a_registry(root):
    machine = re.compile("|".join([r"(?<![\w.])/(?:root|home|work)/\w+", r"pypi\." + "org",
                                   "python" + r"hosted\.org", "ana" + r"conda\.org",
                                   "arti" + "factory",
                                   "--index-" + "url", "--find-" + "links"]))
    wrong = []
    for path in tree(root):
        if path.name == "LICENSE" or path.suffix in (".png", ".svg", ".pdf", ".stl"):
            continue
        # Files of triangles may be binary; a name in their head shows all the same.
        bad = "replace" if path.suffix == ".stl" else "strict"
        for number, line in enumerate(path.read_text(encoding="utf-8", errors=bad).split("\n"),
                                      start=1):
            if machine.search(line) and path.name != "test_tree.py":
                wrong.append(f"{path.relative_to(root)}:{number}: {line.strip()[:80]}")
    assert not wrong, "\n".join(wrong)


def test_links_of_the_pages_lead_somewhere(root):
    """Files that Markdown links to, headings in them, and sources named in backticks."""
    def heading(text):
        return re.sub(r"[^\w -]", "", text.lower()).strip().replace(" ", "-")

    files = list(tree(root))
    names = {path.name for path in files}
    wrong = []
    for page in (path for path in files if path.suffix == ".md"):
        text = page.read_text(encoding="utf-8")
        for link in re.findall(r"\]\(([^)\s]+)\)", text):
            file, _, place = link.partition("#")
            target = page.parent/file if file else page
            if link.startswith("http"):
                continue
            if not target.exists():
                wrong.append(f"{page.name}: {link}")
            elif place and target.suffix == ".md":
                lines = target.read_text(encoding="utf-8").splitlines()
                if place not in {heading(line.lstrip("# ")) for line in lines if line[:1] == "#"}:
                    wrong.append(f"{page.name}: {link}")
        wrong += [f"{page.name}: {name}" for name in re.findall(r"`([\w./-]+\.(?:f90|py|inp))`", text)
                  if name.rpartition("/")[2] not in names | {"job.inp", "deck.inp"}]
    assert not wrong, "\n".join(wrong)


def test_python_files_stay_short_and_narrow(root):
    for path in sorted((root/"pydriver"/"lopin").rglob("*.py")):
        lines = path.read_text(encoding="utf-8").split("\n")
        assert len(lines) <= 400, path.name
        wide = [k for k, line in enumerate(lines, start=1) if len(line) > 100]
        assert not wide, (path.name, wide)


def test_optional_packages_are_imported_where_they_are_used(root):
    heavy = "meshio|matplotlib|scipy|pyvista|gmsh|pandas"
    top = re.compile(rf"^(?:import|from) (?:{heavy})\b", re.MULTILINE)
    wrong = [p.name for p in (root/"pydriver"/"lopin").rglob("*.py") if top.search(p.read_text())]
    assert not wrong
    code = f"import sys, lopin; print([m for m in '{heavy}'.split('|') if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_the_built_package_comes_before_its_sources(root):
    """The sources have no compiled part: workers that inherit `sys.path` would find none."""
    wrong = [path.name for folder in ("tests", "decks") for path in (root/folder).rglob("*.py")
             if re.search(r"sys\.path.*[\"']pydriver", path.read_text(encoding="utf-8"))]
    assert not wrong
