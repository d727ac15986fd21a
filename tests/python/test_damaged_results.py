"""A result file that is cut off, changed or gone: one documented exception, whatever was hit."""
import shutil

import lopin
import numpy as np
import pytest

KINDS = {"summary": "*.json", "collection": "*.pvd", "history": "*_history.csv",
         "solid": "bar_gap_0001.vtu", "contact": "*_contact_*_0001.vtu"}


@pytest.fixture(scope="module")
def sound(core, root, tmp_path_factory):
    """The files of a small run."""
    folder = tmp_path_factory.mktemp("sound")
    lopin.run(root/"decks"/"bar_gap.inp", folder)
    return folder


def read_all(folder):
    """Everything that a result can be asked for."""
    result = lopin.open_result(folder)
    repr(result), result.warnings, result.history, result.names, result.pairs, result.times
    for k in range(len(result.times)):
        result.to_meshio(k)
        for name in result.names:
            result.at(k)[name]
        for pair in result.pairs:
            result.contact(pair).at(k)


def damaged(data, kind, rng):
    """A cut, a byte that changed, some bytes that changed, zeros, bytes twice."""
    data, at = bytearray(data), rng.integers(len(data))
    if kind == "cut":
        return data[:at]
    if kind == "flip":
        data[at] ^= 1 << rng.integers(8)
    elif kind == "noise":
        for k in rng.integers(len(data), size=20):
            data[k] = rng.integers(256)
    elif kind == "zeros":
        data[at:at + 64] = bytes(len(data[at:at + 64]))
    else:
        data[at:at] = data[at:at + 40]
    return data


@pytest.mark.parametrize("what", KINDS)
def test_a_damaged_file_raises_one_exception(sound, tmp_path, what):
    rng, refused = np.random.default_rng(0), 0
    copy = tmp_path/"copy"
    shutil.copytree(sound, copy)
    [path] = list(copy.glob(KINDS[what]))
    data = path.read_bytes()
    for kind in ("cut", "flip", "noise", "zeros", "twice")*24:
        path.write_bytes(damaged(data, kind, rng))
        try:
            read_all(copy)
        except lopin.DamagedResultError as problem:
            refused += 1
            assert copy.name in str(problem) and problem.code == 5
    assert refused >= 30
    path.write_bytes(data)
    read_all(copy)


@pytest.mark.parametrize("what", ["solid", "contact"])
def test_a_file_that_is_gone_is_named(sound, tmp_path, what):
    copy = tmp_path/"copy"
    shutil.copytree(sound, copy)
    [path] = list(copy.glob(KINDS[what]))
    path.unlink()
    with pytest.raises(lopin.DamagedResultError, match=path.name):
        read_all(copy)


def test_a_folder_without_a_result_is_no_damage(tmp_path):
    with pytest.raises(lopin.ResourceError, match="no result"):
        lopin.open_result(tmp_path)


@pytest.mark.parametrize("what", ["solid", "contact"])
def test_no_flipped_bit_of_a_field_goes_unnoticed(sound, tmp_path, what):
    [path] = list(sound.glob(KINDS[what]))
    data = path.read_bytes()
    end = data.rindex(b"<!-- CRC-32 ")
    vtu = pytest.importorskip("lopin.vtu")
    vtu.read_vtu(path)
    for at in np.random.default_rng(1).integers(end, size=100):
        other = bytearray(data)
        other[at] ^= 1 << int(at) % 8
        (tmp_path/"other.vtu").write_bytes(other)
        with pytest.raises(lopin.DamagedResultError):
            vtu.read_vtu(tmp_path/"other.vtu")
