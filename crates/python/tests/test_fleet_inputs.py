"""Where the logs of a fleet are: files and folders, patterns, and URLs that the workers read."""

import os
import subprocess
import sys

import pytest

import airball as ab

fsspec = pytest.importorskip("fsspec")
pytest.importorskip("distributed")
pytest.importorskip("pyarrow")
from airball import fleet  # noqa: E402
from airball._extras import extra  # noqa: E402
from airball.fleet._inputs import find, local_copy  # noqa: E402

STILL = "time_s,duty_percent,position_mm\n" + "".join(f"{0.02 * k:.2f},21.4,300\n" for k in range(300))
FILES = {"a.csv": STILL, "bad.csv": "time_s\n0\n", "monday/b.csv": STILL, "notes.md": ""}


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "logs" / "monday").mkdir(parents=True)
    for name, text in FILES.items():
        (tmp_path / "logs" / name).write_text(text)
    return tmp_path / "logs"


def fill():
    """Puts the files into the memory of this process, as a bucket."""
    files = fsspec.filesystem("memory")
    for name, text in FILES.items():
        files.pipe(f"/bucket/logs/{name}", text.encode())


def reports(folder):
    kept = (path for path in sorted(folder.rglob("*")) if path.is_file() and path.name != "results.parquet")
    return {str(path.relative_to(folder)): path.read_bytes() for path in kept}


def counts(made):
    return made.diagnosed, made.cannot_answer, made.failed


def test_a_pattern_and_a_url_find_the_logs_that_their_folder_holds(folder):
    fill()
    whole = find([str(folder)])
    assert [name for name, _ in whole] == ["a.csv", "bad.csv", "monday/b.csv"]
    assert find([f"{folder}/**/*.csv"]) == whole == find([folder.as_uri()])
    assert find([f"{folder}/mon*/*.csv"]) == [("monday/b.csv", str(folder / "monday/b.csv"))]
    assert [name for name, _ in find(["memory://bucket/logs"])] == [name for name, _ in whole]
    assert [name for name, _ in find(["memory://bucket/logs/*/*.csv"])] == ["monday/b.csv"]
    name, place = find(["memory://bucket/logs/a.csv"])[0]
    with local_copy(place) as path:
        assert (name, open(path).read()) == ("a.csv", STILL)
    assert not os.path.exists(path), "the copy is gone when it was read"
    odd = folder / "odd[1].csv"
    odd.write_text(STILL)
    assert find([str(odd)]) == [("odd[1].csv", str(odd))], "a file of that name is no pattern"


def test_workers_read_urls_and_write_what_one_machine_writes(folder, rig, tmp_path):
    fill()
    with fleet.local(2) as client:
        client.run(fill)
        local = fleet.diagnose(folder, model=rig, out=tmp_path / "local", client=client)
        remote = fleet.diagnose("memory://bucket/logs", model=rig, out=tmp_path / "remote", client=client)
        # A file that one process alone has is a row with the reason.
        fsspec.filesystem("memory").pipe("/bucket/more/c.csv", STILL.encode())
        lost = fleet.diagnose("memory://bucket/more", model=rig, out=tmp_path / "lost", client=client)
    assert counts(local) == counts(remote) == (0, 2, 1)
    assert reports(tmp_path / "remote") == reports(tmp_path / "local")
    reason = "cannot fetch c.csv: FileNotFoundError: /bucket/more/c.csv\n"
    assert lost.failed == 1 and (tmp_path / "lost/c.csv.error").read_text().endswith(reason.split(": ", 1)[1])


def test_names_that_cannot_be_told_apart_or_lead_out_of_the_folder_are_refused(folder):
    fill()
    with pytest.raises(ab.UsageError, match=r"a.csv have one name; name the folder that holds both$"):
        find([str(folder), "memory://bucket/logs/a.csv"])
    files = fsspec.filesystem("memory")
    files.store["/bucket/evil/../../x.csv"] = files.store["/bucket/logs/a.csv"]
    files.pseudo_dirs.append("/bucket/evil")
    try:
        with pytest.raises(ab.UsageError, match=r"'\.\.' in its name"):
            find(["memory://bucket/evil"])
    finally:
        del files.store["/bucket/evil/../../x.csv"]


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ("memory://nowhere", "^memory://nowhere: no log is in there"),
        ("no/such/*.csv", "no log is in there"),
        ("s4://bucket/logs", "s4://bucket/logs: Protocol not known: s4"),
    ],
)
def test_a_place_without_logs_is_named(given, words):
    with pytest.raises(ab.UsageError, match=words):
        find([given])


def test_a_missing_library_is_answered_with_its_extra_and_another_is_not():
    with pytest.raises(ab.MissingLibraryError, match=r"^s3fs is not installed; .* airball\[s3\]$"):
        with hidden("s3fs"):
            find(["s3://bucket/logs"])
    with pytest.raises(ab.MissingLibraryError, match=r"^gs://bucket/logs: .*gcsfs"):
        with hidden("gcsfs"):
            find(["gs://bucket/logs"])
    with pytest.raises(ModuleNotFoundError) as other, extra("fleet"):
        import no_such_module  # noqa: F401
    assert not isinstance(other.value, ab.Error)


class hidden:
    """A module that cannot be imported, for a while."""

    def __init__(self, name):
        self.name = name

    def __enter__(self):
        self.before = sys.modules.get(self.name)
        sys.modules[self.name] = None

    def __exit__(self, *_):
        del sys.modules[self.name]
        if self.before is not None:
            sys.modules[self.name] = self.before


def run(*arguments, hide="", **environment):
    command = f"import runpy, sys; [sys.modules.__setitem__(name, None) for name in {hide.split()!r}]; "
    command += f"sys.argv = ['fleet', *{[str(argument) for argument in arguments]!r}]; "
    command += "runpy.run_module('airball.fleet', run_name='__main__')"
    ended = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", command],
        env=os.environ | environment,
        capture_output=True,
        text=True,
        check=False,
    )
    return ended.returncode, ended.stderr


def test_the_command_names_the_extra_of_its_own_libraries_alone(folder, tmp_path):
    asked = (folder, "--config", "none.toml", "--out", tmp_path)
    assert run(*asked, "--local", 1, hide="distributed") == (
        1,
        "error: distributed is not installed; it comes with: pip install airball[fleet]\n",
    )
    assert run(*asked, "--slurm", 1, hide="dask_jobqueue") == (
        1,
        "error: dask_jobqueue is not installed; it comes with: pip install airball[slurm]\n",
    )
    code, said = run(*asked, "--local", 1, hide="tornado")
    assert code == 1 and "tornado" in said and "pip install" not in said


def test_wrong_flags_of_the_command_are_named(folder, tmp_path):
    asked = (folder, "--out", tmp_path)
    for flags, words in [
        ((), "one of --scheduler, --local and --slurm"),
        (("--local", 0), "0 workers do nothing"),
        (("--local", 1, "--walltime", "01:00:00"), "--memory and --walltime are for --slurm"),
    ]:
        code, said = run(*asked, *flags)
        assert code == 2 and words in said, said
    pytest.importorskip("dask_jobqueue")
    code, said = run(*asked, "--slurm", 1, PATH="/nowhere")
    assert (code, said) == (1, "error: there is no sbatch on this machine; run this where jobs are submitted to Slurm\n")
