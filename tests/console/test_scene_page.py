"""viser's own page is made part of ours."""

from kompass_console.scene.client_page import SCENE_POLICY, scene_page


def test_the_page_is_viser_s_with_ours_before_it() -> None:
    page = scene_page().decode()
    ours, theirs = page.index("hasFocus"), page.index("data-p=")
    assert ours < theirs
    assert "kompass" in page[:theirs]


def test_only_this_console_may_frame_the_scene() -> None:
    assert "frame-ancestors 'self'" in SCENE_POLICY
    assert "default-src 'none'" in SCENE_POLICY
