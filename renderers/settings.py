"""What can be set on a technique: names, allowed values, defaults."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

from scenes.errors import GnomonError

Setting = str | int | float | bool
Settings = Mapping[str, Setting]
# Python would also read 1_0 and the digits of other scripts.
NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?", re.ASCII | re.IGNORECASE)


class SettingsError(GnomonError):
    """A technique was asked for something it does not have."""

    exit_code = 2


@dataclass(frozen=True)
class Option:
    """One setting of a technique.

    Attributes:
        default: Its value where nobody says another.
        meaning: What it does, in half a sentence.
        choices: Values it may have.
        bounds: Lowest and highest number it may have besides `choices`; none where None.
        replay: Whether it only reproduces the literature; such settings are never candidates.
    """

    default: Setting
    meaning: str
    choices: tuple[Setting, ...] = ()
    bounds: tuple[float, float] | None = None
    replay: bool = False

    @property
    def allowed(self) -> str:
        """The allowed values in words."""
        words = [str(choice) for choice in self.choices]
        if self.bounds is not None:
            words.append(f"{self.bounds[0]:g} to {self.bounds[1]:g}")
        return ", ".join(words)

    def accepts(self, value: Setting) -> bool:
        """Whether the setting may have this value."""
        if value in self.choices:
            return True
        if self.bounds is None or isinstance(value, (str, bool)):
            return False
        if isinstance(self.default, int) and not float(value).is_integer():
            return False
        return self.bounds[0] <= value <= self.bounds[1]

    def read(self, text: str) -> Setting | None:
        """The value that `text` stands for, None if it stands for none that is allowed."""
        for choice in self.choices:
            if text.lower() == str(choice).lower():
                return choice
        if not NUMBER.fullmatch(text):
            return None
        number = float(text)
        whole = isinstance(self.default, int) or number.is_integer()
        value: Setting = int(number) if whole and number.is_integer() else number
        return value if self.accepts(value) else None


Options = Mapping[str, Option]


def completed(options: Options, settings: Settings, label: str) -> Settings:
    """`settings` with the defaults of those it does not name, in the order of `options`.

    Raises:
        SettingsError: A setting is not among `options`, or has a value that it may not have.
    """
    for name, value in settings.items():
        check(options, name, value, label)
    return {name: settings.get(name, option.default) for name, option in options.items()}


def check(options: Options, name: str, value: Setting, label: str) -> None:
    """Refuse a setting that `options` do not allow.

    Raises:
        SettingsError: There is no such setting, or it may not have this value.
    """
    if name not in options:
        known = ", ".join(options) or "no settings"
        raise SettingsError(f'{label} has no setting "{name}".', known=f"It has {known}.")
    if not options[name].accepts(value):
        raise SettingsError(
            f'{label} cannot have {name} "{value}".', known=f"It may be {options[name].allowed}."
        )
