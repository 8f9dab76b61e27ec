"""The rules beside the scene, in the words of who uses them."""

from __future__ import annotations

import re
from typing import Any

from playwright.sync_api import Locator, expect

from tests.browser.console_page import FIRST_PICTURE, ConsolePage


class RulesPage:
    """The rules of one page, opened."""

    def __init__(self, page: ConsolePage) -> None:
        self.page = page

    @classmethod
    def opened(cls, page: ConsolePage, token: str, button: str = "rules") -> RulesPage:
        """Follow the printed link, without the scene, and open the rules with a button."""
        page.open_flat(token)
        return cls.of(page, button)

    @classmethod
    def of(cls, page: ConsolePage, button: str = "rules") -> RulesPage:
        """Open the rules of a page that is logged in."""
        expect(page.get("pose")).to_contain_text("m/s", timeout=FIRST_PICTURE * 1000)
        page.get(button).click()
        expect(page.get("rule-table")).to_be_visible()
        return cls(page)

    def get(self, test_id: str) -> Locator:
        """An element by its test id."""
        return self.page.get(test_id)

    def rule(self, rule_id: str) -> Locator:
        """A rule's row in the table."""
        return self.get(f"rule-{rule_id}")

    def edit(self, rule_id: str) -> None:
        """Open the form of a rule from the table."""
        self.rule(rule_id).get_by_test_id("rule-edit").click()
        expect(self.get("rule-editor")).to_be_visible()

    def choose(self, picker: Locator, option: str | re.Pattern[str]) -> None:
        """Open a list and take what it offers under this name."""
        picker.click()
        self.page.page.get_by_role("option", name=option, exact=isinstance(option, str)).click()

    def review(self) -> None:
        """Go to the review, and wait until the robot has looked at the changes."""
        self.get("draft-review").click()
        expect(self.get("effect")).to_be_visible()
        expect(self.get("apply")).to_be_enabled()

    def apply(self, reason: str) -> int:
        """Apply with a reason; the revision that is then in force."""
        self.get("apply-reason").fill(reason)
        self.get("apply").click()
        expect(self.get("applied")).to_be_visible()
        found = re.search(r"Revision (\d+) is in force", self.get("applied").inner_text())
        assert found
        return int(found[1])

    def answers(self) -> bool:
        """Whether the robot answers for its rules."""
        return bool(self.page.page.context.request.get(f"{self.page.origin}/api/rules").ok)

    @property
    def view(self) -> Any:
        """What the robot itself answers for its rules."""
        answer = self.page.page.context.request.get(f"{self.page.origin}/api/rules")
        assert answer.ok, answer.text()
        return answer.json()

    @property
    def revision(self) -> int:
        """The revision in force on the robot."""
        return int(self.view["active"])

    def in_force(self, rule_id: str) -> Any:
        """A rule as it is in force on the robot."""
        [rule] = [each for each in self.view["table"]["rules"] if each["id"] == rule_id]
        return rule
