"""``kompass-console``, also as ``python -m kompass_console``."""


def main() -> None:
    """Entry point: Ctrl-C ends it without a traceback also while the commands are imported."""
    try:
        from kompass_console.cli import main as command

        command()
    except KeyboardInterrupt:
        raise SystemExit(130) from None


if __name__ == "__main__":
    main()
