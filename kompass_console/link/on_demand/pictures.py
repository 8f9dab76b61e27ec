"""Pictures of cameras (sensor_msgs) as pictures for browsers: checked, made small, and encoded.

ValueError says in a sentence why a message is not shown.
"""

from __future__ import annotations

import io
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from PIL import Image

from kompass_console.schema.plain import plain

MOST_PIXELS = 16_000_000  # of one picture; it takes four bytes each while it is looked at
LARGEST = 50_000_000  # bytes of a message
LARGEST_COMPRESSED = 8_000_000

_QUALITY = 75  # of JPEG
_PIL = {"JPEG": "image/jpeg", "PNG": "image/png"}

Pixels = npt.NDArray[Any]


class Encoded(NamedTuple):
    """A picture as a browser takes it, and of what size it was before it was made small [px]."""

    data: bytes
    media_type: str
    width: int
    height: int


class _Encoding(NamedTuple):
    """How pixels lie in a message: numbers of a kind, so many of each, in an order of colours."""

    kind: str
    channels: int
    order: tuple[int, ...] | None  # of red, green and blue; None is one number, not a colour


_ENCODINGS: dict[str, _Encoding] = {
    "rgb8": _Encoding("u1", 3, (0, 1, 2)),
    "8UC3": _Encoding("u1", 3, (2, 1, 0)),  # as OpenCV has them
    "bgr8": _Encoding("u1", 3, (2, 1, 0)),
    "rgba8": _Encoding("u1", 4, (0, 1, 2)),
    "bgra8": _Encoding("u1", 4, (2, 1, 0)),
    "8UC4": _Encoding("u1", 4, (2, 1, 0)),
    "mono8": _Encoding("u1", 1, None),
    "8UC1": _Encoding("u1", 1, None),
    "mono16": _Encoding("u2", 1, None),
    "16UC1": _Encoding("u2", 1, None),
    "32FC1": _Encoding("f4", 1, None),
    # Two pixels share a colour: luma is in every second byte.
    "yuv422": _Encoding("u1", 2, None),
    "uyvy": _Encoding("u1", 2, None),
    "yuv422_yuy2": _Encoding("u1", 2, None),
    "yuyv": _Encoding("u1", 2, None),
}
_LUMA_SECOND = ("yuv422", "uyvy")
_YUV = (*_LUMA_SECOND, "yuv422_yuy2", "yuyv")
_DEPTH = ("mono16", "16UC1", "32FC1")


def encode_image(message: Any, widest: int) -> Encoded:
    """sensor_msgs/Image as JPEG, at most so many pixels wide.

    Depth and other numbers become shades from the least to the greatest of the picture; what was
    not measured (0, or not finite) is black.
    """
    pixels = _pixels(message)
    height, width = pixels.shape[:2]
    encoding = str(message.encoding)
    if encoding in _YUV:
        picture = _of_yuv(pixels, encoding)
    else:
        # Before colours are looked at: what is not shown costs nothing then.
        step = max(1, width // widest)
        picture = _picture(pixels[::step, ::step], encoding)
    return Encoded(_as_jpeg(picture, widest), "image/jpeg", width, height)


def encode_compressed(message: Any, widest: int) -> Encoded:
    """sensor_msgs/CompressedImage as it is, where it is JPEG or PNG and small enough; else smaller.

    What it is comes from its bytes and not from what it says; it is read as a whole before.
    """
    data, said = bytes(message.data), plain(message.format, 60)
    if len(data) > LARGEST_COMPRESSED:
        raise ValueError(
            f"it has {len(data) / 1e6:.1f} MB, and at most {LARGEST_COMPRESSED / 1e6:g} MB are "
            "shown"
        )
    try:
        with Image.open(io.BytesIO(data), formats=tuple(_PIL)) as picture:
            width, height, kind = picture.width, picture.height, picture.format or ""
            if width * height > MOST_PIXELS:
                raise ValueError(_too_large(width, height))
            if kind == "JPEG":
                picture.draft(None, (widest, widest))  # decodes no more than is shown
            picture.load()
            if width <= widest and _says(said, kind):
                return Encoded(data, _PIL[kind], width, height)
            small = _shades(picture) if picture.mode.startswith(("I", "F")) else picture
            return Encoded(_as_jpeg(small.convert("RGB"), widest), "image/jpeg", width, height)
    except (OSError, SyntaxError, Image.DecompressionBombError) as error:
        raise ValueError(
            f"format = {said!r}: its bytes are no whole JPEG or PNG; have the camera send one"
        ) from error


def _says(said: str, kind: str) -> bool:
    """Whether a message says that it is what its bytes are; where not, it is made anew."""
    names = ("jpeg", "jpg") if kind == "JPEG" else ("png",)
    return any(name in said.lower() for name in names)


def _pixels(message: Any) -> Pixels:
    """The numbers of an image, (height, width, channels), without a copy."""
    name = str(message.encoding)
    encoding = _ENCODINGS.get(name)
    if encoding is None:
        raise ValueError(
            f"encoding = {plain(name, 40)!r} is not known here; have the camera send rgb8, bgr8, "
            "mono8, 16UC1 or 32FC1"
        )
    width, height, step = int(message.width), int(message.height), int(message.step)
    if width == 0 or height == 0:
        raise ValueError(f"it is {width} × {height} pixels: there is nothing to be seen")
    if width * height > MOST_PIXELS:
        raise ValueError(_too_large(width, height))
    kind = np.dtype((">" if message.is_bigendian else "<") + encoding.kind)
    row = width * encoding.channels * kind.itemsize
    if step < row:
        raise ValueError(f"step = {step}, and a row of {width} pixels of {name} has {row} bytes")
    data = np.frombuffer(message.data, np.uint8)
    needed = step * (height - 1) + row
    if data.size < needed:
        raise ValueError(f"data has {data.size} bytes, and {height} rows are {needed}")
    return np.ndarray(
        (height, width, encoding.channels),
        kind,
        data.data,
        0,
        (step, encoding.channels * kind.itemsize, kind.itemsize),
    )


def _picture(pixels: Pixels, name: str) -> Image.Image:
    order = _ENCODINGS[name].order
    if order is not None:
        return Image.fromarray(np.ascontiguousarray(pixels[..., list(order)]))
    numbers = pixels[..., 0]
    return _scaled(numbers) if name in _DEPTH else Image.fromarray(np.ascontiguousarray(numbers))


def _scaled(numbers: Pixels) -> Image.Image:
    """Numbers (H, W) as shades, by the least and the greatest that was measured."""
    values = numbers.astype(np.float32)
    measured = np.isfinite(values) & (values > 0.0)
    shades = np.zeros(values.shape, np.uint8)
    if measured.any():
        low, high = float(values[measured].min()), float(values[measured].max())
        share = (values[measured] - low) / max(high - low, 1e-9)
        # Near is light: what the robot may meet is seen first.
        shades[measured] = (255 - 215 * share).astype(np.uint8)
    return Image.fromarray(shades)


def _shades(picture: Image.Image) -> Image.Image:
    return _scaled(np.asarray(picture))


def _of_yuv(pixels: Pixels, name: str) -> Image.Image:
    """Two bytes a pixel, of which one is luma and the other by turns the two chromas."""
    even = pixels.shape[1] // 2 * 2
    if even == 0:
        raise ValueError(f"width = 1, and pixels of {name} come in pairs")
    luma, chroma = (1, 0) if name in _LUMA_SECOND else (0, 1)
    bands = [
        pixels[:, :even, luma],
        *(np.repeat(pixels[:, first:even:2, chroma], 2, axis=1) for first in (0, 1)),
    ]
    parts = [Image.fromarray(np.ascontiguousarray(band)) for band in bands]
    return Image.merge("YCbCr", parts).convert("RGB")


def _as_jpeg(picture: Image.Image, widest: int) -> bytes:
    if picture.width > widest:
        height = max(1, round(picture.height * widest / picture.width))
        picture = picture.resize((widest, height), Image.Resampling.BILINEAR)
    out = io.BytesIO()
    picture.save(out, "JPEG", quality=_QUALITY)
    return out.getvalue()


def _too_large(width: int, height: int) -> str:
    return (
        f"it is {width} × {height} pixels, and at most {MOST_PIXELS // 1_000_000} million are shown"
    )
