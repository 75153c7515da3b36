"""`latsch check` as a user meets it: our own FMUs are clean, wrong files have their exit codes."""

import json

import fmpy

from conftest import latsch, rewrite


def description(change):
    """A change of the description only."""
    return lambda name, data: change(data.decode()).encode() if name == "modelDescription.xml" else data


def test_shipped_fmus_are_clean(shipped):
    done = latsch("check", shipped, "--format", "json")
    assert done.returncode == 0, done.stdout + done.stderr
    report = json.loads(done.stdout)
    assert report["findings"] == [] and report["notes"] == []
    assert report["errors"] == report["warnings"] == 0
    assert {"run", "reset", "rollback", "serialize", "two-threads", "leak"} <= set(report["checks"])


def test_findings_look_like_a_compilers(fmu, tmp_path):
    names = [v.name for v in fmpy.read_model_description(str(fmu)).modelVariables]
    output = 1 + names.index("force_x")
    wrong = rewrite(
        fmu,
        tmp_path / "wrong.fmu",
        description(lambda x: x.replace(f'<Unknown index="{output}"/>', "").replace("kg=", "Kg=", 1)),
    )
    done = latsch("check", wrong, "--no-run")
    assert done.returncode == 1 and done.stderr == ""
    assert f"error[X9]: Outputs does not list the output {output}" in done.stdout
    assert "error[XSD]: <BaseUnit> has no attribute Kg; did you mean kg?" in done.stdout
    for words in ("--> modelDescription.xml:", "^^^", "= note: FMI 2.0.5, 2.2.8", "= help: "):
        assert words in done.stdout
    assert done.stdout.splitlines()[-1].startswith(str(wrong))

    report = json.loads(latsch("check", wrong, "--no-run", "--format", "json").stdout)
    assert report["errors"] == len(report["findings"]) == done.stdout.count("error[")
    finding = next(f for f in report["findings"] if f["rule"] == "X9")
    assert finding["level"] == "error" and finding["citation"] == "FMI 2.0.5, 2.2.8"
    assert finding["place"]["line"] > 1 and 'causality="output"' in finding["place"]["excerpt"]
    assert finding["what"] and finding["help"]


def test_the_binary_is_compared_with_the_description(fmu, tmp_path):
    wrong = rewrite(fmu, tmp_path / "guid.fmu", description(lambda x: x.replace('guid="{', 'guid="{0')))
    done = latsch("check", wrong)
    assert done.returncode == 1
    assert "error[M0]: fmi2Instantiate with the description's GUID returned NULL" in done.stdout
    assert "note: the other checks of the binary were left out" in done.stdout


def test_files_that_are_no_fmu(fmu, tmp_path):
    (tmp_path / "text.fmu").write_text("no archive")
    later = rewrite(fmu, tmp_path / "later.fmu", description(lambda x: x.replace('fmiVersion="2.0"', 'fmiVersion="3.0"')))
    mute = rewrite(fmu, tmp_path / "mute.fmu", lambda n, d: None if n.endswith(".xml") else d)
    for path, words in [
        (tmp_path / "text.fmu", "no zip archive"),
        (tmp_path / "absent.fmu", "cannot be read"),
        (later, "FMI 3.0"),
        (mute, "modelDescription.xml"),
    ]:
        done = latsch("check", path)
        assert done.returncode == 2, done.stdout
        assert words in done.stderr and path.name in done.stderr
    assert latsch("check", fmu, "--timeout", "0").returncode == 2
