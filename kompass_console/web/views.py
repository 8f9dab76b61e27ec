"""The pages' views: which there are, whose they are, and how each is to be shown."""

from __future__ import annotations

import secrets
import threading
from collections import Counter
from dataclasses import dataclass

from kompass_console.schema.models import Theme, View, ViewPatch
from kompass_console.schema.roles import Role
from kompass_console.web.auth import LoginSession

_MOST_OF_SESSION = 32
_MOST_OF_ROLE = 400


@dataclass(frozen=True, slots=True)
class _Owned:
    view: View
    session_id: str
    role: Role


class ViewRegistry:
    """Views by id; each belongs to the session that made it, and is unknown to all others.

    A session has only so many, and so have all sessions of a role together: the oldest go when
    there are too many, those of the session with the most of them first. A page whose view has
    gone makes a new one.
    """

    def __init__(self, theme: Theme) -> None:
        self._theme: Theme = theme
        self._views: dict[str, _Owned] = {}
        self._lock = threading.Lock()

    def create(self, session: LoginSession) -> View:
        """A new view of this session."""
        view = View(id=secrets.token_urlsafe(9), theme=self._theme)
        with self._lock:
            self._views[view.id] = _Owned(view, session.id, session.role)
            of_role = Counter(
                owned.session_id for owned in self._views.values() if owned.role is session.role
            )
            if of_role[session.id] > _MOST_OF_SESSION:
                self._drop_oldest_of(session.id)
            elif of_role.total() > _MOST_OF_ROLE:
                self._drop_oldest_of(of_role.most_common(1)[0][0])
        return view

    def find(self, view_id: str) -> View | None:
        """A view, whoever it belongs to."""
        owned = self._views.get(view_id)
        return None if owned is None else owned.view

    def get(self, view_id: str, session: LoginSession) -> View | None:
        """A view of this session; None when it has no such view."""
        owned = self._views.get(view_id)
        return owned.view if owned is not None and owned.session_id == session.id else None

    def patch(self, view_id: str, session: LoginSession, patch: ViewPatch) -> View | None:
        """The view with the given settings changed, or None when it has no such view."""
        with self._lock:
            view = self.get(view_id, session)
            if view is None:
                return None
            changes = patch.model_dump(exclude_none=True, exclude={"layers"})
            if patch.layers is not None:
                switched = patch.layers.model_dump(exclude_none=True)
                changes["layers"] = view.layers.model_copy(update=switched)
            view = view.model_copy(update=changes)
            self._views[view_id] = _Owned(view, session.id, session.role)
        return view

    def end(self, session: LoginSession) -> None:
        """Drop all views of a session."""
        with self._lock:
            of_session = [v for v, owned in self._views.items() if owned.session_id == session.id]
            for view_id in of_session:
                del self._views[view_id]

    def _drop_oldest_of(self, session_id: str) -> None:
        oldest = next(v for v, owned in self._views.items() if owned.session_id == session_id)
        del self._views[oldest]
