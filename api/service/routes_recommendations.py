"""The route that answers from features alone, in this process."""

from __future__ import annotations

import math

import numpy as np
from fastapi import APIRouter, Request, Response

from api.predicting import EVERY_CANDIDATE_REFUSED
from api.prediction_records import answer_record
from api.service.asked import RecommendationRequest
from api.service.describing import problems
from api.service.problems import ProblemError, bytes_of
from api.service.records import Recommendation
from api.service.state import service_of
from features.table import NAMES
from models.examples import Question
from scenes.scene import LightKind
from selector.learning.predicting import Advisor, LightFacts
from selector.policy import policy

router = APIRouter()
KIND_FEATURES = {f"is_{kind}": kind for kind in LightKind}


@router.post(
    "/v1/recommendations",
    operation_id="recommend",
    tags=["recommendations"],
    response_model=Recommendation,
    responses=problems(400, 413, 415, 422),
)
async def recommend(request: Request, body: RecommendationRequest) -> Response:
    """What a light should use, from its features alone.

    A technique that would refuse the level (its edge lists too long, its meshes open) is not found out:
    nothing of the level is known here. Send the level itself to have such refusals looked for.
    """
    rows = np.array([[getattr(view, name) for name in NAMES] for view in body.views], np.float64)
    _check_kind(body.kind, rows)
    wanted = policy(body.policy, body.max_edge_error_px)
    question = Question(wanted.name, body.mobility, wanted.max_edge_error_px)

    def answered(advisor: Advisor) -> bytes | None:
        found = advisor.advise(LightFacts(LightKind(body.kind), rows), question, tuple(body.techniques))
        return None if found is None else bytes_of(answer_record(found))

    answer = await service_of(request).adviser.ask(answered)
    if answer is None:
        raise ProblemError("bad-value", EVERY_CANDIDATE_REFUSED, remedy="Allow more techniques.")
    return Response(answer, media_type="application/json")


def _check_kind(kind: str, rows: np.ndarray[tuple[int, int], np.dtype[np.float64]]) -> None:
    for name, of_kind in KIND_FEATURES.items():
        wanted = float(of_kind == kind)
        for index, value in enumerate(rows[:, NAMES.index(name)].tolist()):
            if not math.isclose(value, wanted):
                raise ProblemError(
                    "bad-value",
                    f"The features of view {index} are not those of a {kind} light.",
                    known=f"{name} is {value:g}.",
                    remedy=f"Set it to {wanted:g}, or change kind.",
                )
