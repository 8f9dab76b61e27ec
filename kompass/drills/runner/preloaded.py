"""All that a drive needs, imported once for all of them."""

import kompass.drills.runner.run
import kompass.launch.launcher  # noqa: F401
