"""Places on disk: durable, bounded, one name once on a map, and nobody's change is lost unseen."""

from __future__ import annotations

import os
import random
import select
import signal
import sqlite3
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from kompass.places.change import DeletePlace, EditPlace, RestorePlace, SavePlace
from kompass.places.place import MOST_PLACES, MapIdentity, Place, PlacePose
from kompass.store import place_store as module
from kompass.store.errors import (
    EntryRefused,
    NoSuchEntry,
    StaleEntry,
    StoreBusy,
    StoreError,
    StoreUnwritable,
)
from kompass.store.place_store import PlaceStore
from kompass.store.schema import PLACES, PLACES_ID
from kompass.store.store import RuleStore
from tests.support.properties import few_or_many

HERE = MapIdentity(id="0" * 32, label="4.0 × 3.0 m")
THERE = MapIdentity(id="1" * 32, label="9.0 × 7.0 m")

WRITER = """
import sys
from pathlib import Path
from tests.store.test_places import save
from kompass.store.place_store import PlaceStore
with PlaceStore.open(Path(sys.argv[1])) as store:
    for number in range(int(sys.argv[2]), 10_000):
        print(save(f"place {number}").name, end="", flush=False)
        store.change(save(f"place {number}"), "ava")
        print(" ok", flush=True)
"""


def save(name: str, of_map: MapIdentity = HERE, x: float = 1.0) -> SavePlace:
    return SavePlace(name=name, pose=PlacePose(x=x, y=2.0, yaw=0.5), map=of_map)


def delete(place: Place) -> DeletePlace:
    return DeletePlace(id=place.id, version=place.version)


def names(store: PlaceStore) -> list[str]:
    return [place.name for place in store.book().places]


@pytest.fixture
def store(tmp_path: Path) -> Iterator[PlaceStore]:
    with PlaceStore.open(tmp_path / "robot", clock=lambda: 7.0) as opened:
        yield opened


def test_what_was_saved_is_there_after_a_restart(tmp_path: Path) -> None:
    with PlaceStore.open(tmp_path / "robot") as store:
        saved = store.change(save("Dock"), "ava")
        noted = store.change(EditPlace(id=saved.id, version=1, note="mind the step"), "ben")
    with PlaceStore.open(tmp_path / "robot") as store:
        book = store.book()
    assert book.places == (noted,)
    assert (noted.name, noted.pose, noted.author, noted.version) == ("Dock", saved.pose, "ben", 2)
    assert book.revision == 2
    assert oct((tmp_path / "robot" / "places.db").stat().st_mode & 0o777) == "0o600"


@few_or_many(12, few=3)
def test_killed_at_any_moment_it_keeps_all_that_was_acknowledged(
    tmp_path: Path, examples: int
) -> None:
    chance, folder, acknowledged = random.Random(3), tmp_path / "robot", 0
    for _ in range(examples):
        command = [sys.executable, "-c", WRITER, str(folder), str(acknowledged + 1)]
        with subprocess.Popen(command, stdout=subprocess.PIPE) as writer:
            assert writer.stdout is not None
            lines = [writer.stdout.readline()]  # it has begun
            until = time.monotonic() + chance.uniform(0.0, 0.03)
            while time.monotonic() < until and select.select([writer.stdout], [], [], 0.0)[0]:
                lines.append(writer.stdout.readline())
            os.kill(writer.pid, signal.SIGKILL)
            lines += writer.stdout.readlines()
        told = [line for line in lines if line.endswith(b" ok\n")]
        acknowledged += len(told)
        with PlaceStore.open(folder) as store:
            kept = names(store)
        assert kept[:acknowledged] == [f"place {n + 1}" for n in range(acknowledged)]
        assert len(kept) - acknowledged in (0, 1)  # one may be stored and not acknowledged
        acknowledged = len(kept)
        if acknowledged > MOST_PLACES // 2:
            break
    assert acknowledged > 0


@pytest.mark.parametrize("killed", [False, True], ids=["closed", "killed"])
def test_of_a_folder_that_cannot_be_written_they_are_read_and_not_changed(
    tmp_path: Path, killed: bool
) -> None:
    ended = "os._exit(9)" if killed else "store.close()"
    code = f"""
import os, sys
from pathlib import Path
from tests.store.test_places import save
from kompass.store.place_store import PlaceStore
store = PlaceStore.open(Path(sys.argv[1]))
store.change(save("North"), "ava")
{ended}
"""
    subprocess.run([sys.executable, "-c", code, str(tmp_path)], check=False)
    lock = tmp_path / module.LOCK
    lock.unlink()
    lock.mkdir()  # not even the superuser opens it for writing
    with PlaceStore.open(tmp_path) as left:
        assert names(left) == ["North"]
        assert "cannot write" in left.unwritable
        with pytest.raises(StoreUnwritable, match="cannot write"):
            left.change(save("South"), "ben")
        assert names(left) == ["North"]


def test_a_name_is_there_once_on_a_map_and_again_on_another(store: PlaceStore) -> None:
    first = store.change(save("Dock"), "ava")
    with pytest.raises(EntryRefused, match=r"'dOCK' is taken .* \('Dock'\); choose another"):
        store.change(save("dOCK"), "ava")
    other = store.change(save("Dock", THERE), "ava")
    with pytest.raises(EntryRefused, match="taken"):
        store.change(EditPlace(id=other.id, version=1, map=HERE), "ava")
    second = store.change(save("Door"), "ava")
    with pytest.raises(EntryRefused, match="taken"):
        store.change(EditPlace(id=second.id, version=1, name="DOCK"), "ava")
    assert store.change(EditPlace(id=first.id, version=1, name="dock"), "ava").name == "dock"
    assert names(store) == ["dock", "Dock", "Door"]
    assert store.book().revision == 4  # what was refused has changed nothing


def test_a_change_of_an_older_version_is_refused_and_names_who_was_faster(
    store: PlaceStore,
) -> None:
    place = store.change(save("Dock"), "ava")
    store.change(EditPlace(id=place.id, version=1, name="Dock A"), "ben")
    with pytest.raises(StaleEntry, match="'Dock A' was changed meanwhile, by ben"):
        store.change(EditPlace(id=place.id, version=1, name="Dock B"), "ava")
    with pytest.raises(StaleEntry, match="ben"):
        store.change(delete(place), "ava")
    assert names(store) == ["Dock A"]


def test_a_heading_can_be_given_and_taken_away(store: PlaceStore) -> None:
    place = store.change(save("Dock"), "ava")
    without = EditPlace(id=place.id, version=1, pose=PlacePose(x=3.0, y=4.0))
    assert store.change(without, "ava").pose == PlacePose(x=3.0, y=4.0, yaw=None)


def test_a_deleted_place_comes_back_as_it_was_and_once(store: PlaceStore) -> None:
    place = store.change(save("Dock"), "ava")
    assert store.change(delete(place), "ava") == place
    assert names(store) == []
    with pytest.raises(NoSuchEntry, match="somebody has deleted it"):
        store.change(EditPlace(id=place.id, version=1, name="x"), "ava")
    back = store.change(RestorePlace(id=place.id), "ben")
    assert (back.id, back.name, back.pose) == (place.id, "Dock", place.pose)
    with pytest.raises(NoSuchEntry, match="is there already"):
        store.change(RestorePlace(id=place.id), "ben")


def test_a_name_that_was_given_away_meanwhile_keeps_a_place_from_coming_back(
    store: PlaceStore,
) -> None:
    place = store.change(save("Dock"), "ava")
    store.change(delete(place), "ava")
    store.change(save("Dock"), "ben")
    with pytest.raises(EntryRefused, match="taken"):
        store.change(RestorePlace(id=place.id), "ava")


def test_there_is_an_end_to_places_and_to_those_that_were_deleted(
    store: PlaceStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "MOST_PLACES", 3)
    monkeypatch.setattr(module, "MOST_DELETED", 2)
    places = [store.change(save(name), "ava") for name in "abc"]
    with pytest.raises(EntryRefused, match="there are 3 places, and no robot keeps more; delete"):
        store.change(save("d"), "ava")
    for place in places:
        store.change(delete(place), "ava")
    with pytest.raises(NoSuchEntry, match="save it anew"):
        store.change(RestorePlace(id=places[0].id), "ava")
    for place in places[1:]:
        store.change(RestorePlace(id=place.id), "ava")
    assert names(store) == ["b", "c"]


def homes(store: PlaceStore) -> list[str]:
    return [place.name for place in store.book().places if place.home]


def make_home(store: PlaceStore, place: Place, home: bool = True) -> Place:
    return store.change(EditPlace(id=place.id, version=place.version, home=home), "ava")


def test_there_is_one_home_of_a_map_and_another_place_takes_over(store: PlaceStore) -> None:
    dock, gate = (store.change(save(name), "ava") for name in ("Dock", "Gate"))
    attic = store.change(save("Attic", THERE), "ava")
    make_home(store, attic)
    dock = make_home(store, dock)
    gate = make_home(store, gate)
    assert homes(store) == ["Gate", "Attic"]
    with pytest.raises(StaleEntry):
        store.change(delete(dock), "ben")  # it is no home any more, which ben has not seen
    gate = make_home(store, gate, home=False)
    assert homes(store) == ["Attic"]
    # Taken along to a map that has a home it is none.
    make_home(store, gate)
    (attic,) = (place for place in store.book().places if place.name == "Attic")
    store.change(EditPlace(id=attic.id, version=attic.version, map=HERE), "ava")
    assert homes(store) == ["Gate"]


def test_a_home_that_was_deleted_is_home_again_unless_there_is_another(store: PlaceStore) -> None:
    dock, gate = (store.change(save(name), "ava") for name in ("Dock", "Gate"))
    dock = make_home(store, dock)
    store.change(delete(dock), "ava")
    dock = store.change(RestorePlace(id=dock.id), "ava")
    assert homes(store) == ["Dock"]
    store.change(delete(dock), "ava")
    make_home(store, gate)
    assert not store.change(RestorePlace(id=dock.id), "ava").home
    assert homes(store) == ["Gate"]


def test_places_of_an_older_release_are_brought_up_to_date(tmp_path: Path) -> None:
    old = sqlite3.connect(tmp_path / module.FILE)
    old.executescript(f"PRAGMA application_id = {PLACES_ID}; {PLACES[0]} PRAGMA user_version = 1;")
    old.execute(
        "INSERT INTO places VALUES (1, 1, 'Dock', 'dock', '', 1, 2, NULL, ?, ?, 'ava', 5, NULL)",
        (HERE.id, HERE.label),
    )
    old.commit()
    old.close()
    with PlaceStore.open(tmp_path) as store:
        (dock,) = store.book().places
        assert (dock.name, dock.home) == ("Dock", False)
        assert make_home(store, dock).home


def test_a_number_is_never_another_place_s(store: PlaceStore) -> None:
    place = store.change(save("a"), "ava")
    store.change(delete(place), "ava")
    assert store.change(save("b"), "ava").id > place.id


def test_one_process_at_a_time_and_beside_the_rules(tmp_path: Path) -> None:
    folder = tmp_path / "robot"
    busy = pytest.raises(StoreBusy, match=r"store of places .* is in use by process")
    with RuleStore.open(folder), PlaceStore.open(folder), busy:
        PlaceStore.open(folder)
    PlaceStore.open(folder).close()


def test_a_damaged_file_is_set_aside_and_said(tmp_path: Path) -> None:
    with PlaceStore.open(tmp_path / "robot") as store:
        store.change(save("Dock"), "ava")
    file = tmp_path / "robot" / "places.db"
    file.write_bytes(b"hello" * 1000)
    with PlaceStore.open(tmp_path / "robot") as store:
        assert "places.db was damaged" in store.book().problem
        assert store.book().available
        assert names(store) == []
        store.change(save("Dock"), "ava")
    (aside,) = file.parent.glob("places.db.corrupt-*")
    assert aside.read_bytes() == b"hello" * 1000


def test_a_closed_store_says_so(tmp_path: Path) -> None:
    store = PlaceStore.open(tmp_path / "robot")
    store.close()
    with pytest.raises(StoreError, match="closed"):
        store.change(save("Dock"), "ava")
