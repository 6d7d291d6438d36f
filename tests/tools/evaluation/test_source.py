"""Two states of the program that may give different results have different digests."""

from surefoot.tools.evaluation import source


def test_the_digest_of_the_program_is_of_all_that_makes_results(tmp_path, monkeypatch):
    for path in ("hw/plant.py", "config/a.toml", "tools/evaluation/grader.py", "tools/screen.py"):
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_text("one")
    monkeypatch.setattr(source.surefoot, "__path__", [str(tmp_path)])
    before = source.source_digest()
    assert before == source.source_digest()
    (tmp_path / "tools/screen.py").write_text("two")
    assert source.source_digest() == before
    seen = {before}
    for path in ("hw/plant.py", "config/a.toml", "tools/evaluation/grader.py"):
        (tmp_path / path).write_text("two")
        seen.add(source.source_digest())
    assert len(seen) == 4
