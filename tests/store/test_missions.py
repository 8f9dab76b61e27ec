"""Missions on disk: durable, bounded, one name once, and nobody's change is lost unseen."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from kompass.missions.change import DeleteMission, EditMission, RestoreMission, SaveMission
from kompass.missions.mission import MOST_MISSIONS, Wait
from kompass.missions.queue import MissionState, Queued
from kompass.store import mission_store
from kompass.store.errors import EntryRefused, NoSuchEntry, StaleEntry, StoreBusy, StoreCorrupt
from kompass.store.mission_store import MissionStore
from tests.missions.missions import fresh, plan


def save(name: str) -> SaveMission:
    return SaveMission(plan=plan((Wait(seconds=2.0),), (), name=name, rounds=3))


@pytest.fixture
def store(tmp_path: Path) -> Iterator[MissionStore]:
    with MissionStore.open(tmp_path / "robot", clock=lambda: 7.0) as opened:
        yield opened


def test_what_was_saved_is_there_after_a_restart(tmp_path: Path) -> None:
    with MissionStore.open(tmp_path / "robot") as store:
        saved = store.change(save("Rounds"), "ava", "operator")
        state = MissionState(
            runs=1,
            queuings=1,
            run=fresh(saved),
            queue=(Queued(number=1, mission=saved.id, by="ben", time=1.0),),
            left=3.0,
            notice="of now",
        )
        store.keep(state)
    with MissionStore.open(tmp_path / "robot") as store:
        assert store.book().missions == (saved,)
        assert store.state() == state.model_copy(update={"left": None, "notice": ""})
    assert oct((tmp_path / "robot" / "missions.db").stat().st_mode & 0o777) == "0o600"


def test_an_edit_that_began_from_another_version_is_refused(store: MissionStore) -> None:
    saved = store.change(save("Rounds"), "ava", "operator")
    edited = store.change(
        EditMission(id=saved.id, version=1, plan=save("Night").plan), "ben", "engineer"
    )
    assert (edited.name, edited.version, edited.author, edited.role) == (
        *("Night", 2, "ben", "engineer"),
    )
    with pytest.raises(StaleEntry, match="changed meanwhile, by ben"):
        store.change(DeleteMission(id=saved.id, version=1), "ava", "operator")
    assert store.book().missions == (edited,)


def test_a_deleted_mission_comes_back_with_the_rights_it_had(store: MissionStore) -> None:
    saved = store.change(save("Rounds"), "ava", "operator")
    store.change(DeleteMission(id=saved.id, version=1), "ben", "engineer")
    with pytest.raises(NoSuchEntry):
        store.change(DeleteMission(id=saved.id, version=2), "ben", "engineer")
    back = store.change(RestoreMission(id=saved.id), "ben", "engineer")
    assert (back.name, back.role, back.author) == ("Rounds", "operator", "ben")


def test_names_are_given_once_and_their_number_is_bounded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(mission_store, "MOST_MISSIONS", 1)
    with MissionStore.open(tmp_path / "robot") as store:
        store.change(save("Rounds"), "ava", "operator")
        with pytest.raises(EntryRefused, match="delete those that nobody needs"):
            store.change(save("Night"), "ava", "operator")
    monkeypatch.undo()
    assert MOST_MISSIONS > 1
    with MissionStore.open(tmp_path / "robot") as store:
        with pytest.raises(EntryRefused, match="taken by another mission"):
            store.change(save("ROUNDS"), "ava", "operator")
        assert [each.name for each in store.book().missions] == ["Rounds"]


def test_one_process_at_a_time_has_them(store: MissionStore, tmp_path: Path) -> None:
    with pytest.raises(StoreBusy):
        MissionStore.open(tmp_path / "robot")


def test_a_state_of_another_release_is_told_and_not_made_up(
    store: MissionStore, tmp_path: Path
) -> None:
    store._file.sql.execute("INSERT INTO state VALUES ('{\"new\": 1}')")
    with pytest.raises(StoreCorrupt, match="cannot read"):
        store.state()
