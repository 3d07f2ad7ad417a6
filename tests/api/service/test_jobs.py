from __future__ import annotations

import os
import shutil
import signal
import sqlite3
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import pytest

from api.service.application import Entries
from api.service.job_folders import JobFolders
from api.service.job_store import JobStore, JobStoreError, State
from api.service.records import Job, MeasuredLevel
from api.service.settings import Limits, Settings
from scenes.gltf.annotation import read_annotations
from tests.api.service import strange_workers
from tests.api.service.running_service import PATIENCE_S, Json, Running, events, problem, record, running
from tests.small_level import small_level

LIMITS = replace(Limits(), queue=4, attempts=2, kept_jobs=50, measuring_idle_s=2.0)
STRANGE = Entries(strange_workers.read, strange_workers.measure)


@pytest.fixture(scope="module")
def desk(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Running]:
    with running(Settings(state=tmp_path_factory.mktemp("state"), readers=1, limits=LIMITS), STRANGE) as up:
        yield up


def running_job(up: Running, job: Json) -> Json:
    """Its record once it runs, and has said so."""
    until = time.monotonic() + PATIENCE_S
    while time.monotonic() < until:
        found = up.state(job["id"])
        if found["progress"]["total"]:
            return found
        time.sleep(0.02)
    raise AssertionError("it does not run")


def test_a_level_is_measured_from_beginning_to_end(service: Running, tmp_path: Path) -> None:
    level = small_level(tmp_path).read_bytes()
    options = {"resolution": "96x64", "rounds": "1", "technique": "SV", "name": "tower.glb"}
    response = service.level(level, "/v1/jobs", **options)
    assert response.status_code == 202, response.text
    job = Job.model_validate_json(response.content)
    assert response.headers["location"] == job.links.self == f"/v1/jobs/{job.id}"
    assert int(response.headers["retry-after"]) == 2
    assert (job.state, job.lights, job.level) == ("queued", 3, "tower.glb")
    with service.client.stream("GET", job.links.events) as stream:
        assert stream.headers["content-type"].startswith("text/event-stream")
        heard = list(events(stream.iter_lines()))
    assert [kind for _, kind, _ in heard if kind == "state"]
    assert heard[-1][2]["state"] == "done", heard[-1]
    assert len({one for one, *_ in heard}) == len(heard)
    done = Job.model_validate(heard[-1][2])
    assert done.progress.done == done.progress.total > 0
    result = MeasuredLevel.model_validate_json(service.client.get(done.links.result).content)
    assert (result.level, result.output, result.resolution) == ("tower.glb", "tower.annotated.glb", [96, 64])
    assert [one["chosen"]["label"] for one in result.lights] == ["SV"] * 3
    annotated = service.client.get(done.links.annotated)
    assert 'filename="tower.annotated.glb"' in annotated.headers["content-disposition"]
    assert len(read_annotations(annotated.content)) == 3
    report = service.client.get(done.links.report)
    assert report.headers["content-type"].startswith("text/html")
    assert report.headers["content-security-policy"].startswith("sandbox allow-scripts;")
    assert report.headers["cross-origin-opener-policy"] == "unsafe-none"
    assert "tower.glb" in report.text
    assert str(service.parts.settings.state) not in report.text + service.client.get(done.links.result).text


def test_a_bad_level_is_refused_before_it_is_queued(service: Running, tmp_path: Path) -> None:
    level = small_level(tmp_path).read_bytes()
    before = service.parts.desk.counts()
    problem(service.level(b"broken", "/v1/jobs"), 422, "bad-level")
    problem(service.level(level, "/v1/jobs", light="Moon"), 422, "bad-level")
    problem(service.level(level, "/v1/jobs", rounds=0), 422, "bad-value")
    assert service.parts.desk.counts() == before


def test_results_are_there_when_the_job_is_done(desk: Running) -> None:
    job = desk.job(b"stop")
    running_job(desk, job)
    for part in ("result", "annotated", "report"):
        response = desk.client.get(job["links"][part])
        assert "running" in problem(response, 409, "not-done")["known"]
        assert int(response.headers["retry-after"]) > 0
    record(desk.client.delete(job["links"]["self"]))
    assert "retry-after" not in desk.client.get(job["links"]["result"]).headers


def test_a_job_is_cancelled_while_it_runs_and_while_it_waits(desk: Running) -> None:
    runs, waits, last = desk.job(b"stop"), desk.job(b"stop"), desk.job(b"work")
    running_job(desk, runs)
    for job in (waits, runs):
        response = desk.client.delete(job["links"]["self"])
        assert response.status_code == 200
        assert record(response)["state"] == "cancelled"
        problem(desk.client.delete(job["links"]["self"]), 409, "already-ended")
    assert desk.ended(last["id"])["state"] == "done"
    problem(desk.client.delete(last["links"]["self"]), 409, "already-ended")
    assert desk.state(runs["id"])["state"] == "cancelled"
    left = {path.name for path in (desk.parts.settings.state / "jobs").iterdir()}
    assert not left & {runs["id"], waits["id"]}


def test_a_job_without_an_answer_fails_with_the_reason(desk: Running) -> None:
    found = desk.ended(desk.job(b"refuse")["id"])
    assert found["state"] == "failed"
    assert found["problem"]["detail"] == "level.glb: No light casts a shadow."
    assert Job.model_validate(found)


def test_a_job_whose_process_dies_once_is_tried_again(desk: Running) -> None:
    assert desk.ended(desk.job(b"once")["id"])["state"] == "done"


@pytest.mark.parametrize("word", [b"crash", b"exit"])
def test_a_job_whose_process_always_dies_is_given_up(desk: Running, word: bytes) -> None:
    found = desk.ended(desk.job(word)["id"])
    assert found["state"] == "failed"
    assert "tried 2 times" in found["problem"]["known"]
    assert desk.ended(desk.job(b"work")["id"])["state"] == "done"


def test_a_job_that_hangs_is_given_up(desk: Running) -> None:
    found = desk.ended(desk.job(b"hang")["id"])
    assert found["state"] == "failed"
    assert found["problem"]["type"].endswith("too-long")


def test_the_queue_takes_only_so_many(desk: Running) -> None:
    jobs = [desk.job(b"stop") for _ in range(LIMITS.queue)]
    response = desk.level(b"work", "/v1/jobs")
    problem(response, 503, "queue-full")
    assert int(response.headers["retry-after"]) > 0
    for job in reversed(jobs):
        desk.client.delete(job["links"]["self"])
    assert desk.ended(desk.job(b"work")["id"])["state"] == "done"


def test_the_queue_is_not_overrun_by_many_at_once(desk: Running) -> None:
    with ThreadPoolExecutor(8) as threads:
        answers = list(threads.map(lambda _: desk.level(b"stop", "/v1/jobs"), range(12)))
    taken = [record(one) for one in answers if one.status_code == 202]
    assert {one.status_code for one in answers} <= {202, 503}
    assert 0 < len(taken) <= LIMITS.queue
    for job in reversed(taken):
        desk.client.delete(job["links"]["self"])


def test_events_are_taken_up_where_they_were_left(desk: Running) -> None:
    job = desk.job(b"stop")
    running_job(desk, job)
    with desk.client.stream("GET", job["links"]["events"]) as stream:
        name, kind, data = next(events(stream.iter_lines()))
    assert (kind, data["state"]) == ("state", "running")
    # Nothing has happened since, so nothing is said until something does.
    headers = {"Last-Event-ID": name}
    with desk.client.stream("GET", job["links"]["events"], headers=headers) as stream:
        desk.client.delete(job["links"]["self"])
        rest = list(events(stream.iter_lines()))
    assert [data["state"] for _, _, data in rest] == ["cancelled"]
    assert rest[0][0] != name
    with desk.client.stream("GET", job["links"]["events"], headers={"Last-Event-ID": rest[0][0]}) as stream:
        assert [data["state"] for _, _, data in events(stream.iter_lines())] == ["cancelled"]


def test_followers_count_before_they_are_told_anything(desk: Running) -> None:
    job = desk.job(b"stop")
    running_job(desk, job)
    unfollowed(desk)
    ends = [desk.parts.desk.follow() for _ in range(LIMITS.streams)]
    response = desk.client.get(job["links"]["events"])
    problem(response, 503, "busy")
    for end in ends:
        end()
    with desk.client.stream("GET", job["links"]["events"]) as stream:
        # An iterator that nobody holds closes the connection.
        heard = events(stream.iter_lines())
        next(heard)
        assert desk.parts.desk.followers == 1
    unfollowed(desk)
    desk.client.delete(job["links"]["self"])


def unfollowed(desk: Running) -> None:
    """That a client has left is noticed a moment later."""
    until = time.monotonic() + PATIENCE_S
    while desk.parts.desk.followers and time.monotonic() < until:
        time.sleep(0.02)
    assert desk.parts.desk.followers == 0


def test_words_of_progress_are_words(desk: Running) -> None:
    job = desk.job(b"babble")
    found = running_job(desk, job)
    assert 200 < len(found["progress"]["what"]) < 300
    desk.client.delete(job["links"]["self"])


def test_results_that_somebody_removed_are_gone(desk: Running) -> None:
    job = desk.ended(desk.job(b"work")["id"])
    shutil.rmtree(desk.parts.settings.state / "jobs" / job["id"])
    for part in ("result", "annotated", "report"):
        found = problem(desk.client.get(job["links"][part]), 410, "gone")
        assert found["remedy"] == "Send the level again."


def test_a_job_whose_level_somebody_removed_fails(desk: Running) -> None:
    first, waits = desk.job(b"stop"), desk.job(b"work")
    running_job(desk, first)
    shutil.rmtree(desk.parts.settings.state / "jobs" / waits["id"])
    desk.client.delete(first["links"]["self"])
    found = desk.ended(waits["id"])
    assert found["state"] == "failed"
    assert found["problem"]["type"].endswith("gone")
    assert "bug" not in found["problem"]["detail"]


@pytest.mark.parametrize("wanted", ["bytes=0-0", "bytes=9-2", "bytes=99999-", "lines=1-2", "bytes=0-0,0-0"])
def test_results_are_answered_whole(desk: Running, wanted: str) -> None:
    job = desk.ended(desk.job(b"work")["id"])
    response = desk.client.get(job["links"]["result"], headers={"Range": wanted, "If-Range": '"x"'})
    assert response.status_code == 200
    assert response.headers["accept-ranges"] == "none"
    assert response.json() == {"level": "level.glb"}


def test_heads_of_results_are_answered(desk: Running) -> None:
    job = desk.ended(desk.job(b"work")["id"])
    for path in (*job["links"].values(), "/", "/healthz", "/v1/policies"):
        response = desk.client.head(path)
        assert response.status_code == (405 if path.endswith("/events") else 200), path
        assert response.content == b""
    assert int(desk.client.head(job["links"]["result"]).headers["content-length"]) > 0
    problem_of_none = desk.client.head("/v1/jobs/none/result")
    assert problem_of_none.status_code == 404


def test_whoever_stops_listening_is_not_waited_for(desk: Running) -> None:
    job = desk.job(b"stop")
    running_job(desk, job)
    for _ in range(3):
        with desk.client.stream("GET", job["links"]["events"]) as stream:
            next(events(stream.iter_lines()))
    desk.client.delete(job["links"]["self"])
    until = time.monotonic() + PATIENCE_S
    while desk.parts.desk.listeners and time.monotonic() < until:
        time.sleep(0.02)
    assert desk.parts.desk.listeners == 0


def test_a_stop_and_a_start_resume_what_was_queued(tmp_path: Path) -> None:
    settings = Settings(state=tmp_path, readers=1, limits=LIMITS)
    with running(settings, STRANGE) as up:
        done = up.ended(up.job(b"work")["id"])
        interrupted, queued = up.job(b"stop"), up.job(b"work")
        running_job(up, interrupted)
    with running(settings, STRANGE) as up:
        assert up.state(done["id"]) == done
        again = running_job(up, interrupted)
        assert again["state"] == "running"
        up.client.delete(interrupted["links"]["self"])
        assert up.ended(queued["id"])["state"] == "done"


def test_a_killed_worker_costs_nothing_but_time(desk: Running) -> None:
    job = desk.job(b"work")
    running_job(desk, job)
    pid = desk.parts.desk.worker_pid
    if pid is not None:
        os.kill(pid, signal.SIGKILL)
    assert desk.ended(job["id"])["state"] == "done"


def test_results_that_nobody_has_told_of_count(tmp_path: Path) -> None:
    """The service is killed between the results' getting their name and its writing so into the queue."""
    settings = Settings(state=tmp_path, readers=1, limits=LIMITS)
    with running(settings, STRANGE) as up:
        job = up.ended(up.job(b"work")["id"])["id"]
    with closing(sqlite3.connect(tmp_path / "jobs.sqlite", isolation_level=None)) as db:
        db.execute("UPDATE jobs SET state = 'running', finished = NULL WHERE id = ?", (job,))
    with running(settings, STRANGE) as up:
        assert up.state(job)["state"] == "done"
    assert (tmp_path / strange_workers.FINISHES).read_text().split().count(job) == 1


def test_a_job_that_takes_the_service_along_is_given_up_in_the_end(tmp_path: Path) -> None:
    with closing(JobFolders(tmp_path)), JobStore(tmp_path) as store:
        store.add("a", "level.glb", "model/gltf-binary", {}, 1)
        for _ in range(10):
            assert store.begin("a")
            assert store.requeue("a", crashed=False)
        assert store.begin("a")
    with running(Settings(state=tmp_path, readers=1), STRANGE) as up:
        assert up.state("a")["state"] == "failed"


def test_nothing_ends_twice(tmp_path: Path) -> None:
    with JobStore(tmp_path) as store:
        store.add("a", "level.glb", "model/gltf-binary", {}, 1)
        assert store.begin("a")
        assert not store.begin("a")
        assert store.end("a", State.DONE)
        assert not store.end("a", State.CANCELLED)
        assert not store.end("a", State.DONE)
        assert not store.requeue("a", crashed=True)
        assert store.get("a").state is State.DONE  # type: ignore[union-attr]


def test_what_has_ended_is_kept_for_a_while(tmp_path: Path) -> None:
    limits = replace(LIMITS, kept_jobs=2)
    settings = Settings(state=tmp_path, readers=1, limits=limits)
    with running(settings, STRANGE) as up:
        jobs = [up.ended(up.job(b"work")["id"]) for _ in range(4)]
        until = time.monotonic() + PATIENCE_S
        while up.client.get(jobs[1]["links"]["self"]).status_code == 200 and time.monotonic() < until:
            time.sleep(0.02)
        for job in jobs[:2]:
            problem(up.client.get(job["links"]["self"]), 404, "not-found")
        for job in jobs[2:]:
            assert up.client.get(job["links"]["result"]).status_code == 200
    for more in ({"kept_s": 0.0}, {"kept_jobs": 9, "kept_bytes": 0}):
        with running(replace(settings, limits=replace(limits, **more)), STRANGE) as up:
            problem(up.client.get(jobs[-1]["links"]["self"]), 404, "not-found")
    assert list((tmp_path / "jobs").iterdir()) == []


def test_a_folder_serves_one_service(tmp_path: Path) -> None:
    with closing(JobFolders(tmp_path)), pytest.raises(JobStoreError, match="Another service"):
        JobFolders(tmp_path)


def test_a_queue_that_cannot_be_used_is_refused(tmp_path: Path) -> None:
    (tmp_path / "jobs.sqlite").write_bytes(b"This is no database." * 100)
    with pytest.raises(JobStoreError, match="cannot be opened"):
        JobStore(tmp_path)
    (tmp_path / "file").touch()
    with pytest.raises(JobStoreError, match="cannot be used"):
        JobFolders(tmp_path / "file")
    newer = tmp_path / "newer"
    newer.mkdir()
    with closing(sqlite3.connect(newer / "jobs.sqlite")) as db:
        db.execute("PRAGMA user_version=99")
    with pytest.raises(JobStoreError, match="newer Gnomon"):
        JobStore(newer)
