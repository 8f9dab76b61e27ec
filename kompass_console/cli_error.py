"""What ends a command: one line, and an exit code."""


class CliError(Exception):
    """Something to tell in one line.

    Attributes
    ----------
    code
        Exit code: 1 when the stack could not start or run, 2 when something in the command is
        wrong, 3 when the recipe has an error.
    """

    def __init__(self, code: int, text: str) -> None:
        super().__init__(text)
        self.code = code
