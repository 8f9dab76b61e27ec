"""Import names of recipes written for the kompass_core package; the things live in kompass."""

from kompass.porting import answer_absent_modules

__all__: list[str] = []

answer_absent_modules()
