"""Import names of recipes written for the kompass_core package; the things live in kompass."""
