"""What the process that all drives are forked from does first.

It ends with who asks for the drives, and imports all that a drive needs, once for all of them.
"""

import os
import signal

from kompass.drills.runner.lifeline import ASKS, end_with

# Before all else: the imports take seconds, in which who asks may end.
end_with(int(os.environ[ASKS]))
SERVER = os.getpid()
# Ctrl-C of a terminal is for all of a command's processes. Who asks ends the drill; those who drive
# end at once and say nothing, where Python would have each tell in many lines where it was.
signal.signal(signal.SIGINT, signal.SIG_DFL)

import kompass.drills.runner.run  # noqa: E402
import kompass.launch.launcher  # noqa: E402, F401
