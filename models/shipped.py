"""Where the models lie that come with the program; `make models` builds them from the committed evidence."""

from __future__ import annotations

from pathlib import Path

SHIPPED_MODEL = Path(__file__).parent / "shipped" / "llvmpipe.model"
"""Learnt from times measured on Mesa's llvmpipe, the device that every machine has."""
