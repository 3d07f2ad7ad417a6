"""Where the service is, and what is good enough."""

from __future__ import annotations

import bpy

from .client.address import DEFAULT_URL, Address
from .client.errors import AddressError

POLICIES = (
    ("speed", "Speed", "A shadow's edge may be off by 4 pixels"),
    ("balanced", "Balanced", "A shadow's edge may be off by 1.5 pixels"),
    ("quality", "Quality", "A shadow's edge may be off by half a pixel"),
)


class GnomonPreferences(bpy.types.AddonPreferences):
    """Set once, in Edit > Preferences > Add-ons > Gnomon."""

    bl_idname = __package__

    url: bpy.props.StringProperty(
        name="Service",
        description="Address of the service that `gnomon serve` starts",
        default=DEFAULT_URL,
    )
    token: bpy.props.StringProperty(
        name="Token",
        description="Needed only where the service was started with one. Blender stores it unencrypted",
        subtype="PASSWORD",
    )
    policy: bpy.props.EnumProperty(
        name="Policy",
        description="What is good enough: among the techniques that keep it, the fastest is recommended",
        items=POLICIES,
        default="balanced",
    )
    timeout_s: bpy.props.IntProperty(
        name="Seconds to wait",
        description="How long an answer may take",
        default=600,
        min=1,
        max=86_400,
    )

    def draw(self, context: bpy.types.Context) -> None:  # noqa: ARG002  Blender's signature
        """The preferences, and a sentence where they would not work."""
        for name in ("url", "token", "policy", "timeout_s"):
            self.layout.prop(self, name)
        problem = connection_problem(self)
        if problem:
            self.layout.label(text=problem, icon="ERROR")


def preferences(context: bpy.types.Context) -> GnomonPreferences:
    """The user's preferences."""
    found: GnomonPreferences = context.preferences.addons[__package__].preferences
    return found


def connection_problem(wanted: GnomonPreferences) -> str:
    """Why the service may not be asked; empty where it may.

    A service on this machine is no internet; any other one needs the user's consent to online access.
    """
    try:
        address = Address.of(wanted.url)
    except AddressError as error:
        return str(error)
    if not address.is_loopback and not bpy.app.online_access:
        return (
            f"{address.host} is not this machine, and Blender may not go online. "
            "Allow it in Preferences > System > Network, or use a service on this machine."
        )
    return ""


CLASSES = (GnomonPreferences,)
