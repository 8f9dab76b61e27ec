"""The methods and names that a class of components overrides, and mistakes in writing them.

A hook under a wrong name, with wrong parameters, or one that nothing would call, is an error when
the component is made: it would else be passed over without a word while the component says that it
is well.
"""

import difflib
import inspect
from functools import cache

# The transitions, and what is called without anything.
_PLAIN = (
    "init_variables",
    "create_interfaces",
    "custom_on_configure",
    "custom_on_activate",
    "custom_on_deactivate",
    "custom_on_cleanup",
    "custom_on_shutdown",
    "custom_on_error",
    "_execution_step",
    "_execute_once",
)
# How many arguments each is called with.
ARGUMENTS = {
    **dict.fromkeys(_PLAIN, 0),
    "wants_input": 1,
    "on_config_changed": 1,
    "on_feeder_lost": 1,
    "main_service_callback": 2,
    "main_action_callback": 1,
}
# These may be coroutine functions; nobody would await the others.
AWAITED = ("main_service_callback", "main_action_callback")
DECLARATIONS = (
    "config_class",
    "allowed_inputs",
    "allowed_outputs",
    "default_inputs",
    "default_outputs",
    "allowed_run_types",
    "ignored_settings",
    "ignored_inputs",
    "main_action_type",
    "main_srv_type",
    "longest_step",
)
# What each object sets for itself.
OF_THE_OBJECT = ("action_problem", "config", "fallbacks", "health", "node_name", "on_intent")
# Hooks of other stacks that nothing calls here, with what to write instead.
_MADE_HERE = "they are made from the inputs and outputs; make others in create_interfaces"
FOREIGN = {
    **{
        f"{verb}_all_{what}": _MADE_HERE
        for verb in ("create", "destroy")
        for what in (
            *("subscribers", "publishers", "timers", "services", "service_clients"),
            *("action_servers", "action_clients"),
        )
    },
    "attach_callbacks": "call attach_custom_callback in custom_on_activate",
}
# How like a known name another must be, and how many letters longer or shorter at most.
LIKENESS, LETTERS = 0.85, 2


def check_hooks(kind: type, base: type) -> None:
    """Look for mistakes in what a class and those between it and ``base`` define.

    Raises
    ------
    TypeError
        When a name is nearly one of ours or one that the component uses itself, a hook has other
        parameters, or nothing would call it.
    """
    text = _mistake(kind, base)
    if text:
        raise TypeError(text)


@cache
def _mistake(kind: type, base: type) -> str:
    known = {*ARGUMENTS, *DECLARATIONS}
    reserved = {
        name
        for name, value in vars(base).items()
        if (inspect.isfunction(value) or isinstance(value, property))
        and name not in known
        and not name.endswith("__")
    }.union(OF_THE_OBJECT)
    framework = {name for one in kind.__mro__ if is_ours(one) for name in dir(one)}
    for one in kind.__mro__:
        if is_ours(one) or not issubclass(one, base):
            continue
        for name, value in vars(one).items():
            where = f"{one.__name__}.{name}"
            if name in ARGUMENTS:
                text = _misfit(where, name, value)
                if text:
                    return text
            elif name in FOREIGN:
                return f"{where} would never be called: {FOREIGN[name]}"
            elif name in reserved:
                return f"{where}: that name is used by the component itself; give yours another one"
            elif name not in framework and not name.startswith("__"):
                near = difflib.get_close_matches(name, known, n=1, cutoff=LIKENESS)
                if near and abs(len(near[0]) - len(name)) <= LETTERS:
                    return (
                        f"{where} would never be used: did you mean '{near[0]}'? "
                        "If it is something else, give it a name that is less like it"
                    )
    return ""


def is_ours(kind: type) -> bool:
    """Whether a class is one of the stack, not of whoever uses it."""
    return kind.__module__.partition(".")[0] == "kompass"


def _misfit(where: str, name: str, value: object) -> str:
    function = value.__func__ if isinstance(value, staticmethod | classmethod) else value
    if not inspect.isfunction(function):
        return ""
    if inspect.iscoroutinefunction(function) and name not in AWAITED:
        return (
            f"{where} is an 'async def', which nobody awaits; only {' and '.join(AWAITED)} and "
            "component actions may be one"
        )
    count = ARGUMENTS[name] + (not isinstance(value, staticmethod))
    signature = inspect.signature(function)
    try:
        signature.bind(*range(count))
    except TypeError as error:
        words = {0: "no argument", 1: "one argument", 2: "two arguments"}[ARGUMENTS[name]]
        return f"{where}{signature} is called with {words} besides self: {error}"
    return ""
