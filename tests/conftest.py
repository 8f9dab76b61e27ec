"""Every run of the tests has ROS domains of its own, and leaves no process behind."""

import os
import signal
import uuid
from collections.abc import Generator, Iterator
from typing import Any

import pytest
from hypothesis import settings
from xdist.scheduler import LoadFileScheduling

from kompass.rclpy_ext.middleware import prepare_middleware
from kompass.store.robot_key import GIVEN
from tests.support.domains import next_domain
from tests.support.keys import give_key
from tests.support.order import TESTS, rank, scope
from tests.support.processes import ended, marked
from tests.support.stack import Stack
from tests.support.tester import Tester

# Inherited by everything that a test starts, so that orphans can be told from strangers.
MARK = f"KOMPASS_TEST_RUN={uuid.uuid4().hex}"

# Folders of tests of what is pure: as in pyproject.toml's `tool.coverage.run.source`.
PURE = {"rules", "rulebook", "algorithms", "store", "drills"}

# A busy machine takes its time for an example, too; that decides nothing.
settings.register_profile("untimed", parent=settings.default, deadline=None)
settings.load_profile("untimed")


def pytest_configure() -> None:
    # Started in the background of a script, the tests would hand down that Ctrl-C is ignored.
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    key, _, value = MARK.partition("=")
    os.environ[key] = value
    os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    prepare_middleware()
    os.environ["ROS_DOMAIN_ID"] = str(next_domain())
    os.environ.pop(GIVEN, None)  # never one of a robot that somebody uses
    give_key()


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Files that take longest come first; within a file the order stays.

    What is pure is covered by tests of its own: to trace the drives of others takes them twice the
    time.
    """
    items.sort(key=lambda item: rank(item.path))
    for item in items:
        if item.path.relative_to(TESTS).parts[0] not in PURE:
            item.add_marker("no_cover")


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """With ``--dist loadfile``: a file at a time to each worker, but all that draw to one."""
    if config.getvalue("dist") != "loadfile":
        return None
    scheduler = LoadFileScheduling(config, log)
    scheduler._split_scope = scope
    return scheduler


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item,
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """A failure beside a stack shows what that said, and where its robot was."""
    report = yield
    if report.failed:
        for name, value in getattr(item, "funcargs", {}).items():
            if isinstance(value, Stack):
                report.sections.append((f"what {name} printed last", value.output[-6000:]))
            elif isinstance(value, Tester) and "/simulator/ground_truth" in value.newest:
                where = f"truth {value.truth}, speed {value.speed}, contacts {value.contacts}"
                report.sections.append((f"where {name} was", where))
    return report


@pytest.fixture(scope="module", autouse=True)
def no_orphans() -> Iterator[None]:
    """A module that leaves a process behind has failed."""
    yield
    left = ended(lambda: marked(MARK), timeout=5.0)
    assert not left, f"processes left behind: {left}"
