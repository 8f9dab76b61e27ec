"""Pictures of cameras: what is shown of each encoding, and what is refused with a sentence."""

from __future__ import annotations

import io

import numpy as np
import pytest
from PIL import Image as Pil
from sensor_msgs.msg import CompressedImage, Image

from kompass_console.link.on_demand.pictures import Encoded, encode_compressed, encode_image

RED = (220, 30, 40)


def image(encoding: str, pixels: np.ndarray, *, padding: int = 0, **more: object) -> Image:
    """A message of pixels (H, W, …) as they lie in memory, with so many bytes behind each row."""
    rows = pixels.reshape(len(pixels), -1).view(np.uint8)
    padded = np.pad(rows, ((0, 0), (0, padding)))
    message = Image(encoding=encoding, height=len(pixels), width=pixels.shape[1])
    message.step, message.data = padded.shape[1], padded.tobytes()
    for name, value in more.items():
        setattr(message, name, value)
    return message


def shown(encoded: Encoded) -> np.ndarray:
    """What a browser shows, (H, W, 3)."""
    return np.array(Pil.open(io.BytesIO(encoded.data)).convert("RGB"))


def filled(colour: tuple[int, ...], height: int = 12, width: int = 16) -> np.ndarray:
    return np.tile(np.array(colour, np.uint8), (height, width, 1))


@pytest.mark.parametrize(
    ("encoding", "pixel", "colour"),
    [
        ("rgb8", RED, RED),
        ("bgr8", RED[::-1], RED),
        ("rgba8", (*RED, 9), RED),
        ("bgra8", (*RED[::-1], 9), RED),
        ("8UC3", RED[::-1], RED),
        ("mono8", (77,), (77, 77, 77)),
        ("8UC1", (77,), (77, 77, 77)),
    ],
)
def test_colours_are_as_the_camera_saw_them_whatever_lies_between_rows(
    encoding: str, pixel: tuple[int, ...], colour: tuple[int, int, int]
) -> None:
    encoded = encode_image(image(encoding, filled(pixel), padding=5), 320)
    assert (encoded.width, encoded.height, encoded.media_type) == (16, 12, "image/jpeg")
    np.testing.assert_allclose(shown(encoded)[6, 8], colour, atol=6)


@pytest.mark.parametrize(
    ("encoding", "order"), [("yuv422", "UYVY"), ("yuv422_yuy2", "YUYV"), ("yuyv", "YUYV")]
)
def test_pixels_that_share_a_colour_are_shown_in_it(encoding: str, order: str) -> None:
    y, u, v = (int(part) for part in np.array(Pil.new("RGB", (1, 1), RED).convert("YCbCr"))[0, 0])
    seen = iter((u, v))
    pair = [y if letter == "Y" else next(seen) for letter in order]
    pixels = np.tile(np.array(pair, np.uint8).reshape(1, 2, 2), (12, 8, 1))
    np.testing.assert_allclose(shown(encode_image(image(encoding, pixels), 320))[6, 8], RED, atol=8)


@pytest.mark.parametrize(
    ("encoding", "kind"), [("16UC1", "<u2"), ("32FC1", "<f4"), ("mono16", ">u2")]
)
def test_depth_is_light_where_it_is_near_and_black_where_nothing_was_measured(
    encoding: str, kind: str
) -> None:
    depth = np.zeros((12, 24, 1))
    depth[:, 8:16], depth[:, 16:] = 500.0, 4000.0
    if kind == "<f4":
        depth[:, :4] = np.nan
        depth[:, 4:8] = np.inf
    message = image(encoding, depth.astype(kind), is_bigendian=int(kind[0] == ">"))
    picture = shown(encode_image(message, 320))
    nothing, near, far = (int(picture[6, x, 0]) for x in (3, 12, 20))
    assert nothing < 12
    assert near > 240
    assert nothing + 20 < far < near - 100


def test_a_large_picture_becomes_as_wide_as_was_asked_for_and_keeps_its_shape() -> None:
    encoded = encode_image(image("rgb8", filled(RED, 1080, 1920)), 320)
    assert (encoded.width, encoded.height) == (1920, 1080)
    assert shown(encoded).shape == (180, 320, 3)
    assert len(encoded.data) < 20_000


@pytest.mark.parametrize(
    ("message", "sentence"),
    [
        (image("bayer_rggb8", filled((1,))), "encoding = 'bayer_rggb8' is not known here"),
        (image("<b>" * 40, filled((1,))), "is not known here"),
        (image("rgb8", filled(RED), width=0), "there is nothing to be seen"),
        (image("rgb8", filled(RED), width=17), "step = 48, and a row of 17 pixels"),
        (image("rgb8", filled(RED), height=13), "data has 576 bytes, and 13 rows are 624"),
        (image("rgb8", filled(RED), height=2**31), "at most 16 million are shown"),
        (image("yuv422", filled((1, 2), 4, 1)), "come in pairs"),
    ],
)
def test_an_image_that_contradicts_itself_is_refused(message: Image, sentence: str) -> None:
    with pytest.raises(ValueError, match=sentence):
        encode_image(message, 320)


def compressed(kind: str, size: tuple[int, int] = (16, 12), mode: str = "RGB") -> bytes:
    out = io.BytesIO()
    colour = RED if mode == "RGB" else 4000
    Pil.new(mode, size, colour).save(out, kind)
    return out.getvalue()


@pytest.mark.parametrize(
    ("kind", "said"), [("JPEG", "rgb8; jpeg compressed bgr8"), ("PNG", "png"), ("JPEG", "jpg")]
)
def test_a_small_picture_that_is_what_it_says_goes_on_as_it_is(kind: str, said: str) -> None:
    data = compressed(kind)
    encoded = encode_compressed(CompressedImage(format=said, data=data), 320)
    assert encoded == Encoded(data, f"image/{kind.lower()}", 16, 12)


def test_a_large_one_or_one_that_is_something_else_is_made_anew() -> None:
    large = encode_compressed(
        CompressedImage(format="jpeg", data=compressed("JPEG", (1600, 1200))), 320
    )
    assert (large.width, large.height) == (1600, 1200)
    assert shown(large).shape == (240, 320, 3)
    other = encode_compressed(CompressedImage(format="jpeg", data=compressed("PNG")), 320)
    assert other.media_type == "image/jpeg"
    np.testing.assert_allclose(shown(other)[6, 8], RED, atol=6)
    depth = encode_compressed(
        CompressedImage(format="png", data=compressed("PNG", (640, 4), "I;16")), 320
    )
    assert shown(depth).shape == (2, 320, 3)


@pytest.mark.parametrize(
    ("data", "sentence"),
    [
        (b"", "no whole JPEG or PNG"),
        (b"<svg onload=alert(1)>", "no whole JPEG or PNG"),
        (compressed("JPEG")[:200], "no whole JPEG or PNG"),
        (compressed("PNG")[:-30], "no whole JPEG or PNG"),
        (compressed("JPEG", (300, 200))[:-200], "no whole JPEG or PNG"),
        (compressed("GIF"), "no whole JPEG or PNG"),
        (compressed("PNG", (5000, 4000)), "5000 × 4000 pixels, and at most 16 million are shown"),
        (bytes(8_000_001), "it has 8.0 MB, and at most 8 MB are shown"),
        # As compressed_depth_image_transport sends it: twelve bytes, and then a PNG.
        (bytes(12) + compressed("PNG"), "no whole JPEG or PNG"),
    ],
)
def test_bytes_that_are_no_picture_for_a_browser_are_refused(data: bytes, sentence: str) -> None:
    with pytest.raises(ValueError, match=sentence):
        encode_compressed(CompressedImage(format="jpeg", data=data), 320)
