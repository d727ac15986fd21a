"""The licences of the libraries that a repaired wheel holds, beside Lopin's own.

``python tests/add_licences.py WHEEL`` unpacks the wheel, finds the Debian package that each library
in lopin.libs came from, puts its copyright file into the wheel's licences, and packs it again in its
place. A library whose licence is not found is an error.
"""
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path


def package_of(library: str) -> str | None:
    """The Debian package of a shared library, by the name that the loader knows it by."""
    cache = subprocess.run(["/sbin/ldconfig", "-p"], capture_output=True, text=True).stdout
    for line in cache.splitlines():
        name, _, path = line.strip().partition(" => ")
        real = Path(path).resolve() if path else None
        if real is None or not (name.split()[0].startswith(library + ".so")
                                or real.name.startswith(library + ".so")):
            continue
        for where in (real, Path("/usr")/real.relative_to("/"), Path(path)):
            found = subprocess.run(["dpkg", "-S", str(where)], capture_output=True, text=True)
            if found.returncode == 0:
                return found.stdout.split(":")[0]
    return None


def main() -> int:
    """Add the licences; the exit code says whether all were found."""
    wheel = Path(sys.argv[1]).resolve()
    lost = []
    with tempfile.TemporaryDirectory() as place:
        subprocess.run([sys.executable, "-m", "wheel", "unpack", "-d", place, wheel], check=True,
                       stdout=subprocess.DEVNULL)
        root, = Path(place).iterdir()
        info, = root.glob("*.dist-info")
        (info/"licenses").mkdir(exist_ok=True)
        for path in sorted((root/"lopin.libs").glob("*.so*")):
            library = re.sub(r"-[0-9a-f]{8}(?=[.]|$)", "", path.name.partition(".so")[0])
            package = package_of(library)
            text = Path("/usr/share/doc")/(package or "")/"copyright"
            if package is None or not text.is_file():
                lost.append(library)
                continue
            shutil.copy(text, info/"licenses"/f"{package.partition(':')[0]}.txt")
        wheel.unlink()
        subprocess.run([sys.executable, "-m", "wheel", "pack", "-d", str(wheel.parent), str(root)],
                       check=True, stdout=subprocess.DEVNULL)
    for library in lost:
        print(f"no licence found of {library}", file=sys.stderr)
    return 1 if lost else 0


if __name__ == "__main__":
    sys.exit(main())
