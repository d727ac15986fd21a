"""Cards whose row of the keyword table says `reported`: shown by the run, in the summary, and passed
on by `Model.read`. Today that is *LOPIN; tests/fortran/test_build_settings.f90 has rows of its own."""
import json
import subprocess

import lopin
from lopin.deck import Deck
from test_friction_laws import block

CARD = "*LOPIN, TARGET ERROR=0.05, PATH=FINITE\n"


def test_a_setting_is_shown_and_reported(executable, tmp_path):
    deck = tmp_path/"block.inp"
    deck.write_text(CARD + block("COULOMB"))
    done = subprocess.run([executable, "run", deck, "--output", tmp_path/"out"],
                          capture_output=True, text=True)
    assert done.returncode == 0
    assert "*LOPIN, TARGET ERROR: 0.05\n*LOPIN, PATH: FINITE\n" in done.stdout
    summary = json.loads((tmp_path/"out"/"block.json").read_text())
    assert summary["settings"] == {"LOPIN, TARGET ERROR": 0.05, "LOPIN, PATH": "FINITE"}


def test_a_deck_without_settings_reports_none():
    result = lopin.run(Deck.parse(block("COULOMB")))
    assert "settings" not in result.summary


def test_a_model_writes_the_settings_that_it_is_given():
    model = lopin.Model.read(Deck.parse(block("COULOMB")))
    model.setting("LOPIN", target_error=0.05)
    assert lopin.run(model).summary["settings"] == {"LOPIN, TARGET ERROR": 0.05}


def test_a_model_passes_on_what_it_has_no_method_for(monkeypatch):
    from lopin import model_read

    monkeypatch.setattr(model_read, "keywords", lambda: [{"name": "REPORT TITLE", "reported": 1}])
    title = "*REPORT TITLE\nOrder 4711,  second die: \u00e9tamp\u00e9\n"
    assert title in lopin.Model.read(Deck.parse(title + block("COULOMB"))).to_deck().text()
