"""What every component can be told."""

import enum
from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Field, model_validator

from kompass.robot import RobotConfig, RobotFrames
from kompass.settings import Settings


class ComponentRunType(enum.Enum):
    """What makes a component work: the clock, a message, a request or a goal."""

    TIMED = "Timed"
    EVENT = "Event"
    SERVER = "Server"
    ACTION_SERVER = "ActionServer"

    @classmethod
    def read(cls, value: "str | ComponentRunType") -> "ComponentRunType":
        """The run type of a name, in any case.

        Raises
        ------
        ValueError
            For an unknown name.
        """
        if isinstance(value, cls):
            return value
        for member in cls:
            if str(value).lower() == member.value.lower():
                return member
        names = ", ".join(member.value for member in cls)
        raise ValueError(f"run_type = {value!r} is none of {names}")


def _read_level(value: Any) -> Any:
    name = value.strip().lower() if isinstance(value, str) else value
    return "warn" if name == "warning" else name


LogLevel = Annotated[
    Literal["debug", "info", "warn", "error", "fatal"], BeforeValidator(_read_level)
]

NO_ROBOT = (
    "nobody described the robot; set launcher.robot = RobotConfig(…) in the recipe, or give it in "
    "the section 'robot' of the configuration file"
)


class ComponentConfig(Settings):
    """Settings that all components share.

    ``loop_rate`` defaults differ by component; upstream's 100 Hz for all cost a third of a core
    while idle.
    """

    ignored_settings: ClassVar[Mapping[str, str]] = {
        "topic_try_wait_timeout": "nobody waits for a topic; a component starts without it",
        "executor_spin_timeout": "the executor sleeps until there is something to do",
        "wait_for_restart_time": "the supervisor decides when a process is started again",
        "core_log_level": "there is no other core than the components",
    }

    loop_rate: float = Field(default=10.0, ge=1e-4, le=1e3, description="Hz")
    status_rate: float = Field(
        default=5.0, ge=0.1, le=100, description="Hz; a change is published at once besides"
    )
    robot: RobotConfig | None = Field(
        default=None, description="what drives must be told; nothing of it is guessed"
    )
    frames: RobotFrames = Field(default_factory=RobotFrames)
    topic_subscription_timeout: float = Field(
        default=5.0, ge=1e-3, le=3600, description="s to wait for the first message of an input"
    )
    fallback_rate: float = Field(
        default=100.0,
        gt=0,
        le=1e3,
        description="Hz; fallbacks are tried no more often, nor than at 0.5 Hz",
    )
    log_level: LogLevel = Field(default="info", description="from which on its log is written")
    rclpy_log_level: LogLevel = Field(
        default="warn", description="of ROS' own log, for its whole process"
    )

    @property
    def described_robot(self) -> RobotConfig:
        """The robot, for what cannot work without one.

        Raises
        ------
        ValueError
            When nobody described it; with what to do about that.
        """
        if self.robot is None:
            raise ValueError(NO_ROBOT)
        return self.robot

    @classmethod
    def __pydantic_init_subclass__(cls, **kwargs: Any) -> None:
        """Refuse what would be no setting, though it looks like one.

        Raises
        ------
        TypeError
            When a default is a field of attrs; its validator would never be asked.
        """
        super().__pydantic_init_subclass__(**kwargs)
        for name, field in cls.model_fields.items():
            if type(field.default).__module__.partition(".")[0] in ("attr", "attrs"):
                raise TypeError(
                    f"{cls.__name__}.{name} is a field of attrs, and settings are models of "
                    f"pydantic: write '{name}: … = Field(default=…, ge=…, le=…)' with Field of "
                    "pydantic, and no @define"
                )

    @model_validator(mode="before")
    @classmethod
    def _refuse_run_type(cls, given: Any) -> Any:
        if isinstance(given, dict) and "_run_type" in given:
            raise ValueError(
                f"_run_type = {given['_run_type']!r} is no setting; say it of the component: "
                'component.run_type = "Server"'
            )
        return given
