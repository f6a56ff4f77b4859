"""What is known about the last message of an input."""

from typing import NamedTuple

from ..inputs import UNKNOWN_AGE


class Receipt(NamedTuple):
    """The last message of an input and what is known about it.

    Attributes:
        message: the message, as the transport hands it out.
        at: monotonic seconds of receipt.
        received: messages so far.
        age: how old it was then, in seconds; ``UNKNOWN_AGE`` when it came on connecting from a
            latching publisher, and no header says when it was made.
    """

    message: object
    at: float
    received: int
    age: float = 0.0

    @property
    def latched(self) -> bool:
        """Whether it can be of any age."""
        return self.age == UNKNOWN_AGE

    def age_at(self, now: float) -> float:
        """Return how old the message is, in seconds."""
        return self.age + now - self.at
