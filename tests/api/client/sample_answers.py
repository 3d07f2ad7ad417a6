"""What the service answers, for tests that need no service."""

from __future__ import annotations

from typing import Any

EXPECTED: dict[str, Any] = {
    "technique": "SM",
    "id": "shadow_map",
    "settings": {"map_size": 512, "filter": "2x2", "focus": "light"},
    "shadow_ms": 1.5,
    "shadow_ms_range": [1.0, 2],
    "edge_error_px": 0.75,
    "edge_error_px_range": [0.5, 1.25],
    "works": 1,
    "keeps_limit": 0.9,
    "cost": 1.1,
}
RECOMMENDATION: dict[str, Any] = {
    **EXPECTED,
    "source": "predicted",
    "mobility": "dynamic",
    "policy": "balanced",
    "max_edge_error_px": 1.5,
    "reason": "SM is the cheapest that keeps the edge within 1.5 px.",
    "confidence": 0.8,
    "margin": 0.4,
    "runner_up": EXPECTED,
    "alternatives": [EXPECTED],
    "refused": [{"technique": "PSM", "settings": {}, "reason": "The light shines all around."}],
    "decided_by": [{"feature": "map_texel", "group": "map", "value": 0.5, "words": "texels are small"}],
    "outside_training": [],
    "features": {"map_texel": 0.5},
}
LEVEL: dict[str, Any] = {
    "level": "room.glb",
    "digest": "d" * 64,
    "format": "glTF",
    "model": {"device": "llvmpipe", "generator": "gnomon 0.1.0", "training": "t"},
    "resolution": [640, 360],
    "policy": "balanced",
    "max_edge_error_px": 1.5,
    "lights": [
        {"light": "Lamp", "index": 0, "node": 3, "kind": "spot", "problem": "", **RECOMMENDATION},
        {
            "light": "Dark",
            "index": 1,
            "node": 4,
            "kind": "point",
            "problem": "No camera sees it.",
        },
    ],
}
JOB: dict[str, Any] = {
    "id": "abc",
    "state": "queued",
    "level": "room.glb",
    "created": "2030-01-02T03:04:05Z",
    "started": None,
    "finished": None,
    "progress": {"done": 0, "total": 10, "what": "waiting"},
    "options": {"policy": "balanced"},
    "problem": None,
    "lights": None,
    "links": {"self": "/v1/jobs/abc"},
}
MEASURED: dict[str, Any] = {
    "level": "room.glb",
    "format": "glTF",
    "digest": "d" * 64,
    "output": None,
    "written": [],
    "device": {"renderer": "llvmpipe"},
    "clock": "wall",
    "resolution": [640, 360],
    "rounds": 3,
    "max_edge_error_px": 1.5,
    "lights": [
        {
            "node": 3,
            "name": "Lamp",
            "kind": "spot",
            "verified_wrong_share": None,
            "chosen": {
                "technique": "shadow_volume",
                "label": "SV",
                "settings": {},
                "shadow_ms": 3.5,
                "edge_error_px": None,
            },
            "runner_up": None,
            "within_limit": True,
            "confidence": None,
            "reason": "SV is exact.",
            "mobility": "static",
            "views": ["Eye"],
            "candidates": [],
            "shadow_edge_seen": True,
        },
        {"node": 4, "name": "Dark", "kind": "point", "problem": "It lights nothing."},
    ],
    "problems": [],
}


def job(state: str, done: int = 0) -> dict[str, Any]:
    return {**JOB, "state": state, "progress": {"done": done, "total": 10, "what": "measuring"}}
