"""Counters and times for Prometheus."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from prometheus_client import CollectorRegistry, Counter, Gauge, Histogram, generate_latest
from prometheus_client.core import CounterMetricFamily
from prometheus_client.registry import Collector
from starlette.types import Scope

MEDIA_TYPE = "text/plain; version=0.0.4; charset=utf-8"
METHODS = ("GET", "POST", "DELETE", "HEAD", "OPTIONS", "PUT", "PATCH")
_SECONDS = (0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 30, 120)


class Metrics:
    """Those of one service."""

    def __init__(self) -> None:
        self._registry = CollectorRegistry()
        self._requests = Counter(
            "gnomon_requests", "Requests answered.", ("method", "route", "status"), registry=self._registry
        )
        self._seconds = Histogram(
            "gnomon_request_seconds",
            "How long they took.",
            ("method", "route"),
            buckets=_SECONDS,
            registry=self._registry,
        )

    def answered(self, scope: Scope, status: int, seconds: float) -> None:
        """Count a request: by its route, since paths hold what only one client may know."""
        route = getattr(scope.get("route"), "path", "other")
        method = scope["method"] if scope["method"] in METHODS else "other"
        self._requests.labels(method, route, str(status)).inc()
        self._seconds.labels(method, route).observe(seconds)

    def gauge(self, name: str, words: str, read: Callable[[], float]) -> None:
        """Show a number that is read when it is asked for."""
        Gauge(name, words, registry=self._registry).set_function(read)

    def counts(self, name: str, words: str, label: str, read: Callable[[], Mapping[str, int]]) -> None:
        """Show counts that are kept elsewhere."""
        self._registry.register(_Counts(name, words, label, read))

    def text(self) -> bytes:
        """All of them."""
        return generate_latest(self._registry)


class _Counts(Collector):
    def __init__(self, name: str, words: str, label: str, read: Callable[[], Mapping[str, int]]) -> None:
        self._name, self._words, self._label, self._read = name, words, label, read

    def collect(self) -> list[CounterMetricFamily]:
        """What there is now."""
        family = CounterMetricFamily(self._name, self._words, labels=[self._label])
        for label, count in self._read().items():
            family.add_metric([label], count)
        return [family]
