"""What is wrong with the values of a request, in sentences that say what is taken and what to do."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Any

from fastapi import Request

from api.service.problems import ProblemError
from api.wording import shortened

MOST_MISTAKES = 5
LONGEST_WORDS, LONGEST_NAME = 300, 60

# Type of pydantic -> what is said after the name; {} are of its context.
_WORDS = {
    "missing": "is missing",
    "string_pattern_mismatch": "must be WxH, each 16 to 4096, such as 640x360",
    "float_parsing": "must be a number",
    "float_type": "must be a number",
    "finite_number": "must be a finite number",
    "int_parsing": "must be a whole number",
    "int_parsing_size": "must be a whole number of fewer digits",
    "int_type": "must be a whole number",
    "int_from_float": "must be a whole number",
    "greater_than_equal": "must be at least {ge:,g}",
    "less_than_equal": "must be at most {le:,g}",
    "literal_error": "must be {expected}",
    "string_type": "must be text",
    "string_too_long": "may have at most {max_length} characters",
    "list_type": "must be a list",
    "too_long": "may have at most {max_length} entries",
    "too_short": "must have at least {min_length} entry",
    "model_type": "must be a JSON object",
    "model_attributes_type": "must be a JSON object",
    "dict_type": "must be a JSON object",
}

Json = dict[str, Any]


async def check_query(request: Request) -> None:
    """Refuse what a route does not know, and what is said twice of which only one could count.

    Raises:
        ProblemError: There is such a parameter.
    """
    given = Counter(name for name, _ in request.query_params.multi_items())
    known = parameters(request) if given else None
    if known is None:
        return
    for name, times in given.items():
        shown = shortened(name, LONGEST_NAME)
        if name not in known:
            raise _unknown(f"There is no parameter {shown!a} here.", known)
        if times > 1 and not known[name]:
            raise ProblemError(
                "bad-value", f"{name} is given {times} times.", remedy="Give it once: only one could count."
            )


def parameters(request: Request) -> dict[str, bool] | None:
    """The query parameters of a request's route, and whether each may be given again; None for the page."""
    route = request.scope.get("route")
    paths = request.app.openapi()["paths"].get(getattr(route, "path", ""), {})
    method = paths.get(request.scope["method"].lower())
    if method is None:
        return None
    return {
        one["name"]: one["schema"].get("type") == "array"
        for one in method.get("parameters", [])
        if one["in"] == "query"
    }


def invalid(request: Request, mistakes: Sequence[Any]) -> ProblemError:
    """The problem with values that are not what /openapi.json says."""
    words = list(dict.fromkeys(_words(one) for one in mistakes))
    more = len(words) - MOST_MISTAKES
    known = f"There are {more} more such mistakes." if more > 0 else ""
    if not known and any(one["loc"][0] == "query" for one in mistakes):
        known = f"The parameters here are {', '.join(parameters(request) or ['none'])}."
    detail = "; ".join(words[:MOST_MISTAKES]) + "."
    return ProblemError("bad-value", detail, known=known, remedy="/openapi.json says what is taken.")


def _unknown(detail: str, known: dict[str, bool]) -> ProblemError:
    listed = f"The parameters here are {', '.join(known)}." if known else "This route takes none."
    return ProblemError("bad-value", detail, known=listed, remedy="Correct its name, or leave it out.")


def _words(mistake: Any) -> str:
    place = _place(mistake["loc"])
    kind, context = mistake["type"], mistake.get("ctx", {})
    if kind == "extra_forbidden":
        return f"there is no {'parameter' if mistake['loc'][0] == 'query' else 'field'} {place}"
    if kind == "value_error":
        return shortened(f"{place}: {context.get('error', mistake['msg'])}".rstrip("."), LONGEST_WORDS)
    if kind in _WORDS:
        return shortened(f"{place} {_WORDS[kind].format(**context)}", LONGEST_WORDS)
    return shortened(f"{place}: {str(mistake['msg']).rstrip('.')}", LONGEST_WORDS)


def _place(location: Sequence[Any]) -> str:
    """`views[0].crowding` of a body; of a query only the parameter, whose entries nobody counts."""
    where, *parts = location
    if where != "body":
        return shortened(str(parts[0]) if parts else str(where), LONGEST_NAME)
    text = "".join(f"[{one}]" if isinstance(one, int) else f".{one}" for one in parts)
    return shortened(text.removeprefix("."), LONGEST_NAME) or "the body"
