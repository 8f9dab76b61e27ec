"""Views: settings of a page's scene."""

from kompass_console.schema.models import LayersPatch, ViewPatch
from kompass_console.schema.roles import Role
from kompass_console.web.auth import LoginSession
from kompass_console.web.views import ViewRegistry

AVA = LoginSession("ava", Role.OPERATOR, "a" * 16, 0.0)


def test_a_patch_changes_what_it_names_and_nothing_else() -> None:
    views = ViewRegistry("dark")
    view = views.create(AVA)
    assert view.theme == "dark"
    changed = views.patch(view.id, AVA, ViewPatch(follow=True, layers=LayersPatch(scan=False)))
    assert changed is not None
    assert (changed.follow, changed.top, changed.theme) == (True, False, "dark")
    assert changed.layers.scan is False
    assert changed.layers.map is True
    again = views.patch(view.id, AVA, ViewPatch(layers=LayersPatch(map=False)))
    assert again is not None
    assert (again.layers.scan, again.layers.map) == (False, False)


def test_an_unknown_view_is_not_made_by_a_patch() -> None:
    assert ViewRegistry("light").patch("nobody", AVA, ViewPatch(top=True)) is None


def test_views_do_not_pile_up() -> None:
    views = ViewRegistry("light")
    first = views.create(AVA)
    for _ in range(500):
        newest = views.create(AVA)
    assert views.get(first.id, AVA) is None
    assert views.get(newest.id, AVA) is not None
