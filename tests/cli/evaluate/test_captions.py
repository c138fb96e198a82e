"""`kinedex evaluate captions`: a file of sentences about clips."""

from __future__ import annotations

from pathlib import Path

from tests.cli.conftest import Kinedex


def test_clips_are_ranked_by_captions_beside_chance(kinedex: Kinedex, tmp_path: Path) -> None:
    every = kinedex("clips", "list", "--json").json()["items"]
    clips = [clip for clip in every if clip["state"] == "ready"]
    waves = clips[0]
    bows = next(clip for clip in clips if clip["task"] != waves["task"])
    label = kinedex("clips", "label", bows["id"], "--caption", "stored already", "--json")
    assert label.json()["captions"] == ["stored already"]
    file = tmp_path / "captions.csv"
    file.write_text(
        "id,caption\n"
        f"{waves['id']},somebody does a {waves['task']} | the man will {waves['task']} again\n"
        f"{bows['id']},this is {bows['task']}\n{bows['id']},stored already\nnobody,a walk\n"
        f"{bows['id']},qwertz\n",
        encoding="utf-8",
    )
    found = kinedex("evaluate", "captions", str(file), "--json").json()
    by_protocol = {one["protocol"]: one for one in found["figures"]}
    assert list(by_protocol) == ["all", "threshold", "distinct", "batches"]
    assert (by_protocol["all"]["captions"], by_protocol["all"]["clips"]) == (4, len(clips))
    assert by_protocol["all"]["recalls"][2] > by_protocol["all"]["chance_recalls"][2] - 0.3
    assert (found["unknown"], found["stored"], found["silent"]) == (["nobody"], 1, 1)
    printed = kinedex("evaluate", "captions", str(file))
    assert "R@10" in printed.out
    assert "chance" in printed.out
    empty = tmp_path / "empty.csv"
    empty.write_text("id,text\n", encoding="utf-8")
    assert "columns path or id or name" in kinedex("evaluate", "captions", str(empty)).err
