"""Names of sets without regard to case, as in Abaqus: BOTTOM of a deck is found as "bottom"."""

from __future__ import annotations

from typing import TypeVar

Value = TypeVar("Value")


class SetNames(dict[str, Value]):
    """A dict by name; an unknown name finds the only one that differs from it in case.

    `keys()` returns the names as written.
    """

    def __contains__(self, name: object) -> bool:
        return super().__contains__(name) or self.spelled(name) is not None

    def __missing__(self, name: str) -> Value:
        spelled = self.spelled(name)
        if spelled is None:
            raise KeyError(name)
        return self[spelled]

    def spelled(self, name: object) -> str | None:
        """The one name that differs from `name` in case at most; None if there is none, or several."""
        if not isinstance(name, str):
            return None
        if name in self.keys():
            return name
        alike = [known for known in self if known.casefold() == name.casefold()]
        return alike[0] if len(alike) == 1 else None
