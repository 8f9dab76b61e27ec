"""From what a recipe says, in either generation of the API, to rules as data."""
