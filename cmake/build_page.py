"""Build the page of the console into ``kompass_console/static``."""

from npm import WEB, install_packages, npm

INDEX = WEB.parent / "kompass_console" / "static" / "index.html"

if __name__ == "__main__":
    print("npm packages", flush=True)
    install_packages()
    print("tsc and vite", flush=True)
    npm("run", "--silent", "build", quiet=True)
    if not INDEX.is_file():
        raise SystemExit(f"The page was built, but {INDEX} is missing; see web/vite.config.ts")
