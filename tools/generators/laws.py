"""What a law is, and the list of all of them."""

from collections.abc import Callable
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Law:
    """A hidden effect. `draw(rng, machine, size)` gives its parameters for one machine."""

    id: str
    fails_over: tuple
    """Variables over which a model without it fails, most telling first; () if by algebra none."""
    size: float
    """Usual size, a share: of what is said in the law's comment."""
    draw: Callable
    add: Callable | None = None
    """Adds to the balances; None where `Bench` holds the effect, or a sensor does."""
    neutral: dict = field(default_factory=dict)
    """Parameters of machines without the effect, where that is not 0."""
    known: bool = True
    """Whether drivescope's library has an effect of this kind."""


def signed(rng):
    return rng.choice([-1.0, 1.0])


def catalogue():
    """All laws by id, in a fixed order."""
    from . import electrical, friction, mechanism, position, sensing, unknown

    modules = (friction, position, electrical, mechanism, sensing, unknown)
    return {law.id: law for module in modules for law in module.LAWS}
