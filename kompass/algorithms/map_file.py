"""Maps on disk, as map_server writes them: a YAML file beside a PGM or PNG image."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

import numpy as np
import yaml
from numpy.typing import NDArray
from PIL import Image, UnidentifiedImageError

from kompass.algorithms.grid import FREE, OCCUPIED, UNKNOWN, Grid

# What map_saver writes: brightness of occupied, unknown and free cells, and the thresholds that
# read them back as the same three.
_PIXEL_OCCUPIED, _PIXEL_UNKNOWN, _PIXEL_FREE = 0, 205, 254
_OCCUPIED_THRESHOLD, _FREE_THRESHOLD = 0.65, 0.196


class MapFileError(ValueError):
    """A map file that cannot be used; the message names file, field, value and remedy."""


def load_map(path: Path) -> Grid:
    """The map that a map_server YAML file describes.

    Fields: ``image`` (relative to the YAML file), ``resolution`` [m], ``origin`` [x, y, yaw],
    and optionally ``negate`` (0), ``occupied_thresh`` (0.65), ``free_thresh`` (0.196) and
    ``mode`` (trinary). The image's top row is the map's highest y.

    Raises
    ------
    MapFileError
        A file is missing or is no image, or a field is missing or unusable.
    """
    image = _read(Path(path))
    if image.mode != "trinary":
        raise MapFileError(f"{path}: mode: {image.mode!r} is not supported; use 'trinary'")
    return image.grid(image.trinary())


def load_mask(path: Path) -> Grid:
    """The mask that a YAML file as Nav2's costmap filters have it describes.

    As :func:`load_map`; in ``mode: scale`` cells between the thresholds have values from 0 to 100
    in proportion, and those that the image shows through are unknown; in ``mode: raw`` a cell has
    the image's value, and unknown are those above 100.

    Raises
    ------
    MapFileError
        As of :func:`load_map`; or the mode is none of the three.
    """
    image = _read(Path(path))
    if image.mode == "trinary":
        return image.grid(image.trinary())
    if image.mode == "raw":
        return image.grid(np.where(image.pixels <= OCCUPIED, image.pixels, UNKNOWN))
    if image.mode != "scale":
        raise MapFileError(
            f"{path}: mode: {image.mode!r} is not supported; use 'scale', 'trinary' or 'raw'"
        )
    low, high = image.thresholds
    share = np.clip((image.occupancy - low) / (high - low), 0.0, 1.0)
    cells = np.rint(OCCUPIED * share)
    cells[image.occupancy < low], cells[image.occupancy > high] = FREE, OCCUPIED
    return image.grid(np.where(image.opaque, cells, UNKNOWN))


@dataclass(frozen=True, eq=False)
class _MapImage:
    """What a YAML file and its image say: pixels (H, W) with the highest y on top."""

    mode: object
    pixels: NDArray[np.uint8]
    opaque: NDArray[np.bool_]
    negate: bool
    thresholds: tuple[float, float]  # free, occupied
    resolution: float
    origin: tuple[float, float, float]

    @property
    def occupancy(self) -> NDArray[np.float64]:
        brightness = self.pixels / 255.0
        return brightness if self.negate else 1.0 - brightness

    def trinary(self) -> NDArray[np.int8]:
        free, occupied = self.thresholds
        cells = np.full(self.pixels.shape, UNKNOWN, dtype=np.int8)
        cells[self.occupancy > occupied] = OCCUPIED
        cells[self.occupancy < free] = FREE
        return cells

    def grid(self, cells: NDArray[Any]) -> Grid:
        rows = np.ascontiguousarray(cells[::-1].astype(np.int8))
        return Grid(rows, self.resolution, self.origin)


def _read(path: Path) -> _MapImage:
    fields = _read_fields(path)
    resolution = _number(path, fields, "resolution", None)
    if resolution <= 0:
        raise MapFileError(f"{path}: resolution: {resolution}; give the cell size in metres, > 0")
    origin = fields.get("origin")
    if not isinstance(origin, list) or len(origin) != 3 or not all(map(_is_number, origin)):
        raise MapFileError(f"{path}: origin: {origin!r}; give [x, y, yaw] in metres and radians")
    negate = fields.get("negate", 0)
    if negate not in (0, 1):
        raise MapFileError(f"{path}: negate: {negate!r}; give 0 (dark is occupied) or 1")
    occupied_threshold = _number(path, fields, "occupied_thresh", _OCCUPIED_THRESHOLD)
    free_threshold = _number(path, fields, "free_thresh", _FREE_THRESHOLD)
    if not 0 <= free_threshold < occupied_threshold <= 1:
        raise MapFileError(
            f"{path}: free_thresh: {free_threshold}, occupied_thresh: {occupied_threshold}; "
            "they must satisfy 0 <= free_thresh < occupied_thresh <= 1"
        )
    pixels, opaque = _read_image(path, fields.get("image"))
    x, y, yaw = (float(value) for value in origin)
    return _MapImage(
        mode=fields.get("mode", "trinary"),
        pixels=pixels,
        opaque=opaque,
        negate=bool(negate),
        thresholds=(free_threshold, occupied_threshold),
        resolution=resolution,
        origin=(x, y, yaw),
    )


def save_map(grid: Grid, path: Path) -> None:
    """Write ``grid`` as ``path`` (YAML) and an image of the same name ending in ``.pgm``.

    The format has three values: cells of 65 and more are saved as occupied, 0 … 19 as free,
    the rest as unknown. A map of only -1, 0 and 100 is read back identical.

    Raises
    ------
    MapFileError
        ``path`` has no YAML ending, or its folder does not exist.
    """
    path = Path(path)
    if path.suffix not in (".yaml", ".yml"):
        raise MapFileError(f"{path}: ends in {path.suffix!r}; give a name ending in .yaml")
    if not path.parent.is_dir():
        raise MapFileError(f"{path}: folder {path.parent} does not exist; create it first")
    pixels = np.full(grid.cells.shape, _PIXEL_UNKNOWN, dtype=np.uint8)
    pixels[grid.cells >= 65] = _PIXEL_OCCUPIED
    pixels[(grid.cells >= 0) & (grid.cells < 20)] = _PIXEL_FREE
    image = path.with_suffix(".pgm")
    Image.fromarray(np.ascontiguousarray(pixels[::-1])).save(image)
    fields = {
        "image": image.name,
        "mode": "trinary",
        "resolution": float(grid.resolution),
        "origin": [float(value) for value in grid.origin],
        "negate": 0,
        "occupied_thresh": _OCCUPIED_THRESHOLD,
        "free_thresh": _FREE_THRESHOLD,
    }
    path.write_text(yaml.safe_dump(fields, sort_keys=False), encoding="utf-8")


def _read_fields(path: Path) -> dict[str, Any]:
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise MapFileError(f"{path}: cannot be read ({error}); check the path") from error
    try:
        fields = yaml.safe_load(text)
    except yaml.YAMLError as error:
        raise MapFileError(f"{path}: is not valid YAML ({error})") from error
    if not isinstance(fields, dict):
        raise MapFileError(f"{path}: holds no fields; expected image, resolution and origin")
    return fields


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def _number(path: Path, fields: dict[str, Any], name: str, default: float | None) -> float:
    value = fields.get(name, default)
    if not _is_number(value):
        raise MapFileError(f"{path}: {name}: {value!r}; give a number")
    number: float = float(cast("float", value))
    return number


def _read_image(path: Path, name: object) -> tuple[NDArray[np.uint8], NDArray[np.bool_]]:
    """Brightness and opaqueness (H, W) of the pixels."""
    if not isinstance(name, str) or not name:
        raise MapFileError(f"{path}: image: {name!r}; give the image's file name")
    file = path.parent / name
    try:
        with Image.open(file) as image:
            alpha = np.asarray(image.convert("RGBA").getchannel("A"), dtype=np.uint8)
            return np.asarray(image.convert("L"), dtype=np.uint8), alpha == 255
    except FileNotFoundError as error:
        raise MapFileError(
            f"{path}: image: {file} does not exist; paths are relative to the YAML file"
        ) from error
    except Image.DecompressionBombError as error:
        raise MapFileError(
            f"{path}: image: {file} has too many pixels to be read; cut it, or draw it coarser"
        ) from error
    except (UnidentifiedImageError, OSError) as error:
        raise MapFileError(f"{path}: image: {file} is no readable image ({error})") from error
