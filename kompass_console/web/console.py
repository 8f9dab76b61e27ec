"""Everything a route may need, in one place."""

from __future__ import annotations

import asyncio
from dataclasses import dataclass

from kompass_console.drills.drills import Drills
from kompass_console.link.drive import DriveAnswer
from kompass_console.link.goal_check import GoalChecker
from kompass_console.link.link import RosLink
from kompass_console.link.localisation import Localisation
from kompass_console.recordings import Recordings
from kompass_console.scene.scene import Scene
from kompass_console.schema.world import WorldModel
from kompass_console.settings import ConsoleSettings
from kompass_console.web.audit import AuditTrail
from kompass_console.web.auth import Authenticator, LoginLimiter
from kompass_console.web.control import Control
from kompass_console.web.hands import Hands
from kompass_console.web.joint_call import JointCall
from kompass_console.web.open_sockets import OpenSockets
from kompass_console.web.rules_feed import RulesFeed
from kompass_console.web.state_feed import StateFeed
from kompass_console.web.views import ViewRegistry
from kompass_console.webhooks.sender import Webhooks


@dataclass(frozen=True, slots=True)
class Console:
    """One running console.

    `recordings` is None where the robot's are not on this machine.
    """

    settings: ConsoleSettings
    auth: Authenticator
    limiter: LoginLimiter
    passwords: asyncio.Semaphore  # one is proved at a time: it takes 64 MiB and a processor
    open_stop: JointCall[DriveAnswer]  # of those who are not logged in
    audit: AuditTrail
    world: WorldModel
    link: RosLink
    checker: GoalChecker
    localisation: Localisation
    sockets: OpenSockets
    hands: Hands
    control: Control
    views: ViewRegistry
    scene: Scene
    feed: StateFeed
    rules_feed: RulesFeed
    recordings: Recordings | None
    drills: Drills
    webhooks: Webhooks
