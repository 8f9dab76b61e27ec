"""What the process that all drives are forked from does first.

It imports all that a drive needs, once for all of them, and ends with who asks for the drives.
"""

import os

import kompass.drills.runner.run
import kompass.launch.launcher  # noqa: F401
from kompass.drills.runner.lifeline import end_with

end_with(os.getppid())
