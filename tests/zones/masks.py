"""Masks as files, drawn with characters."""

from pathlib import Path

import numpy as np
from PIL import Image

from tests.support.stack import RECIPE


def mask_file(
    folder: Path, drawn: str, resolution: float, origin: tuple[float, float, float]
) -> Path:
    """A YAML file and its image: ``#`` is 100, a digit ten times itself, all else 0."""
    rows = [
        [100 if sign == "#" else 10 * int(sign) if sign.isdigit() else 0 for sign in line]
        for line in drawn.strip("\n").split("\n")
    ]
    pixels = np.rint(255.0 * (1.0 - np.array(rows) / 100.0)).astype(np.uint8)
    Image.fromarray(pixels).save(folder / "mask.png")
    file = folder / "mask.yaml"
    file.write_text(
        f"image: mask.png\nmode: scale\nresolution: {resolution}\norigin: {list(origin)}\n"
        "negate: 0\noccupied_thresh: 1.0\nfree_thresh: 0.0\n",
        encoding="utf-8",
    )
    return file


def masked_recipe(folder: Path, mask: Path, **fields: object) -> Path:
    """Recipe 01 with a mask, written into a folder."""
    given = {"file": str(mask), "name": "Stairs"} | fields
    text = RECIPE.read_text(encoding="utf-8")
    said = "launcher.robot = my_robot\n"
    assert text.count(said) == 1
    more = f"from kompass.config import Mask\nlauncher.masks = [Mask(**{given!r})]\n"
    recipe = folder / "masked.py"
    recipe.write_text(text.replace(said, said + more), encoding="utf-8")
    return recipe
