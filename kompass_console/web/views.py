"""The pages' views: which there are and how each is to be shown."""

from __future__ import annotations

import secrets
import threading

from kompass_console.schema.models import Theme, View, ViewPatch

_MOST_VIEWS = 200


class ViewRegistry:
    """Views by id. The oldest go when there are too many; a page whose view has gone makes a new
    one."""

    def __init__(self, theme: Theme) -> None:
        self._theme: Theme = theme
        self._views: dict[str, View] = {}
        self._lock = threading.Lock()

    def create(self) -> View:
        view = View(id=secrets.token_urlsafe(9), theme=self._theme)
        with self._lock:
            self._views[view.id] = view
            while len(self._views) > _MOST_VIEWS:
                del self._views[next(iter(self._views))]
        return view

    def get(self, view_id: str) -> View | None:
        return self._views.get(view_id)

    def patch(self, view_id: str, patch: ViewPatch) -> View | None:
        """The view with the given settings changed, or None when it is not known."""
        with self._lock:
            view = self._views.get(view_id)
            if view is None:
                return None
            changes = patch.model_dump(exclude_none=True, exclude={"layers"})
            if patch.layers is not None:
                switched = patch.layers.model_dump(exclude_none=True)
                changes["layers"] = view.layers.model_copy(update=switched)
            view = view.model_copy(update=changes)
            self._views[view_id] = view
        return view
