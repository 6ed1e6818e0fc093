"""Whether what is said to the user is as promised: one clear line, nothing of Python's, no control characters."""

import re

#: What no user may read: a traceback, a fault of ours, and Python's own words for what went wrong in a reader.
_OURS = re.compile(
    r"Traceback \(most recent|internal error|malformed or truncated \(|object has no attribute|ran out of memory"
)
_CONTROL = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069]")
#: Longer is no line that anyone reads.
LONGEST = 1000


def faults_of_message(message: str, begins: str = "") -> list[str]:
    """The faults of an error's message, which begins with the name of the file."""
    faults = []
    if "\n" in message:
        faults.append("the message has several lines")
    if begins and not message.startswith(begins):
        faults.append("the message does not name the file")
    if found := _OURS.search(message):
        faults.append(f"the message has {found.group()!r}")
    if len(message) > LONGEST:
        faults.append(f"the message has {len(message)} characters")
    return faults


def faults_of_output(text: str) -> list[str]:
    """The faults of all that a command printed."""
    faults = []
    if found := _OURS.search(text):
        faults.append(f"the output has {found.group()!r}")
    if found := _CONTROL.search(text):
        faults.append(f"the output has the control character {found.group()!r}")
    return faults
