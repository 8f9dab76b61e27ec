"""Speaks viser's protocol as a page does, without a browser: sends cameras, keeps what is drawn."""

from __future__ import annotations

import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import msgspec
import numpy as np
import viser.transforms as tf
import zstandard
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect

from tests.support.processes import wait_until


def camera_message(
    position: tuple[float, float, float] = (3.0, 3.0, 3.0),
    look_at: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> dict[str, Any]:
    """What viser's client says of its camera."""
    z = np.subtract(look_at, position, dtype=float)
    z /= np.linalg.norm(z)
    x = np.cross(z, [0.0, 0.0, 1.0])
    x /= np.linalg.norm(x)
    rotation = np.column_stack([x, np.cross(z, x), z])
    return {
        "type": "ViewerCameraMessage",
        "wxyz": tf.SO3.from_matrix(rotation).wxyz.tolist(),
        "position": position,
        "image_height": 600,
        "image_width": 900,
        "fov": 0.7,
        "near": 0.01,
        "far": 1000.0,
        "look_at": look_at,
        "up_direction": (0.0, 0.0, 1.0),
    }


class CountedSocket(socket.socket):
    """Counts what came over the wire."""

    received = 0

    def recv(self, size: int, flags: int = 0) -> bytes:
        data = super().recv(size, flags)
        self.received += len(data)
        return data


class SceneClient:
    """One page's scene: messages by type, and nodes by name with their last position.

    It offers compression as browsers do, unless `packing` is off.
    """

    def __init__(self, port: int, view_id: str, cookie: str, packing: bool = True) -> None:
        self.wire = CountedSocket(fileno=socket.create_connection(("127.0.0.1", port)).detach())
        origin = f"http://127.0.0.1:{port}"
        self.socket: ClientConnection = connect(
            f"ws://127.0.0.1:{port}/scene/{view_id}",
            origin=origin,
            additional_headers={"Cookie": cookie},
            subprotocols=["viser-v1.1.1"],
            compression="deflate" if packing else None,
            sock=self.wire,
            max_size=None,
        )
        self.nodes: set[str] = set()
        self.removed: set[str] = set()
        self.positions: dict[str, tuple[float, ...]] = {}
        self.visible: dict[str, bool] = {}
        self.updates: dict[str, dict[str, Any]] = {}
        self.camera: dict[str, tuple[float, ...]] = {}
        self.dark = False
        self.messages = 0
        self.without_map = 0  # bytes of frames that have nothing to do with the map
        self._thread = threading.Thread(target=self._read, daemon=True)
        self._thread.start()

    def look(
        self,
        position: tuple[float, float, float] = (3.0, 3.0, 3.0),
        look_at: tuple[float, float, float] = (0.0, 0.0, 0.0),
    ) -> None:
        """Report a camera, as viser's client does on connecting and on every move."""
        self.send(**camera_message(position, look_at))

    def send(self, **message: object) -> None:
        self.socket.send(msgspec.msgpack.encode(message))

    def close(self) -> None:
        self.socket.close()
        self._thread.join(5.0)

    def _read(self) -> None:
        unpacker = zstandard.ZstdDecompressor()
        try:
            for frame in self.socket:
                assert isinstance(frame, bytes)
                packed = int.from_bytes(frame[8:16], "little")
                window = msgspec.msgpack.decode(unpacker.decompress(frame[16 : 16 + packed]))
                for message in window["messages"]:
                    self._keep(message)
                if not any("/map" in message.get("name", "") for message in window["messages"]):
                    self.without_map += len(frame)
                self.messages += 1
        except ConnectionClosed:
            return

    def _keep(self, message: dict[str, Any]) -> None:
        kind, name = message["type"], message.get("name", "")
        if kind == "SetPositionMessage":
            self.positions[name] = tuple(message["position"])
        elif kind == "SetSceneNodeVisibilityMessage":
            self.visible[name] = message["visible"]
        elif kind == "SceneNodeUpdateMessage":
            self.updates.setdefault(name, {}).update(message["updates"])
        elif kind == "RemoveSceneNodeMessage":
            self.nodes.discard(name)
            self.removed.add(name)
        elif kind == "ThemeConfigurationMessage":
            self.dark = message["dark_mode"]
        elif kind.startswith("SetCamera") and not message.get("initial"):
            value = message.get("position", message.get("look_at"))
            if value is not None:
                self.camera[kind] = tuple(value)
        elif "props" in message:
            self.nodes.add(name)


@contextmanager
def drawn(scene: SceneClient, **look: Any) -> Iterator[SceneClient]:
    """A scene once it is drawn, looked at from somewhere."""
    try:
        scene.look(**look)
        wait_until(lambda: "/world/robot" in scene.nodes, 5.0, "the scene is drawn")
        yield scene
    finally:
        scene.close()
