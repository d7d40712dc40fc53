"""Many motions on many machines: a planner in every Ray worker, and a queue of requests.

    python examples/generate_with_ray.py requests.yaml --out motions/
    python examples/generate_with_ray.py prompts.txt --seconds 4 --address auto --workers 32

The list is text (a sentence or timeline a line), JSON lines or a YAML list; an entry is a sentence,
a mapping {text, seconds, ...} or a whole request as in a request file. Every motion gets a folder
with the files of `Plan.save`, and a line in results.jsonl. Called again, it makes what is missing.
Needs the package and its weights on every machine, and Ray: pip install ray.
"""

from __future__ import annotations

import json
import logging
import os
import re
import shutil
import socket
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

import tyro
from rich.console import Console
from rich.progress import Progress

from motiondiffuse_ros.errors import InputError, MotionDiffuseError, RequestError
from motiondiffuse_ros.input_file import load_yaml
from motiondiffuse_ros.planner import Planner, PlannerConfig
from motiondiffuse_ros.request import MotionRequest

_RESTARTS = 3  # of a worker that dies; the request it worked on is reported as failed


@dataclass(frozen=True)
class Options:
    """Generate a motion for each of many requests, on the workers of a Ray cluster."""

    requests: Annotated[Path, tyro.conf.Positional]
    """List of requests: .yaml, .yml, .jsonl or text, one a line."""
    out: Path = Path("motions")
    """Folder of the results; written by this process, so no other machine has to see it."""
    seconds: float | None = None
    """Length of motions given by a sentence alone [s]; 6 if not given."""
    seed: int = 0
    """Entry i of the list has this plus i where it has no seed of its own."""
    address: str | None = None
    """Ray cluster to join ("auto" for the one of this machine); its own one if not given."""
    workers: int | None = None
    """Planners at work at once; as many as there are cores for, if not given."""
    threads: int = 1
    """Cores of each planner."""
    planner: PlannerConfig = field(default_factory=PlannerConfig)


@dataclass(frozen=True)
class Job:
    """One request and the name of its folder."""

    name: str
    request: MotionRequest


@dataclass(frozen=True)
class Outcome:
    """What became of a job: the files of its plan by name and a summary, or an error."""

    summary: dict[str, Any]
    files: dict[str, bytes] = field(default_factory=dict, repr=False)

    @property
    def failed(self) -> bool:
        """Whether there is no plan."""
        return "error" in self.summary


class PlanWorker:
    """A planner in a process of its own; Ray makes an actor of it."""

    def __init__(self, config: PlannerConfig, threads: int) -> None:
        from motiondiffuse_ros.diffusion.threads import Threads, use_threads

        use_threads(Threads.of(threads))
        self._planner = Planner(config)

    def plan(self, job: Job) -> Outcome:
        """Plan one request; what is wrong with it is an answer, not an exception."""
        try:
            plan = self._planner.plan(job.request)
        except MotionDiffuseError as error:
            return Outcome({"error": str(error)})
        with tempfile.TemporaryDirectory() as folder:
            plan.save(Path(folder))
            files = {path.name: path.read_bytes() for path in Path(folder).iterdir()}
        summary = {
            "seed": plan.seed,
            "verdict": plan.report.verdict,
            "score": round(plan.report.score, 3),
            "planned_s": round(plan.timings_s["total"], 2),
            "machine": socket.gethostname(),
        }
        return Outcome(summary, files)


def read_jobs(path: Path, seconds: float | None, seed: int) -> list[Job]:
    """Read a list of requests.

    Args:
        path: YAML, JSON lines or text.
        seconds: Length of motions of entries that do not say it, s.
        seed: Of the first entry, if it has none.

    Raises:
        RequestError: If the file cannot be read or one of its entries is no request; names it.
    """
    jobs = []
    try:
        for i, entry in enumerate(_entries(path)):
            try:
                request = _request(entry, seconds)
                request = request.with_defaults(seed=seed + i)
                request.validate()
            except RequestError as error:
                raise RequestError(f"{path}: entry {i + 1}: {error}") from error
            words = re.sub(r"[^a-z0-9]+", "-", request.segments[0].text.lower()).strip("-")
            jobs.append(Job(f"{i:05d}-{words[:40]}".rstrip("-"), request))
    except OSError as error:
        raise RequestError(f"{path}: cannot be read ({error.strerror})") from error
    if not jobs:
        raise RequestError(f"{path}: no requests in it")
    return jobs


def _entries(path: Path) -> list[Any]:
    if path.suffix in (".yaml", ".yml"):
        entries = load_yaml(path, RequestError)
        if not isinstance(entries, list):
            raise RequestError(f"{path}: must be a list of requests")
        return entries
    try:
        lines = [line.strip() for line in path.read_text(encoding="utf-8").splitlines()]
        lines = [line for line in lines if line and not line.startswith("#")]
        return [json.loads(line) for line in lines] if path.suffix == ".jsonl" else lines
    except ValueError as error:
        raise RequestError(f"{path}: not what its name says ({error})") from error


def _request(entry: Any, seconds: float | None) -> MotionRequest:
    if isinstance(entry, str):
        return MotionRequest.from_text(entry, seconds)
    if not isinstance(entry, dict) or not isinstance(entry.get("text"), str):
        return MotionRequest.from_dict(entry)
    rest = {k: v for k, v in entry.items() if k not in ("text", "seconds")}
    request = MotionRequest.from_text(entry["text"], entry.get("seconds", seconds))
    return MotionRequest.from_dict({**request.to_dict(), **rest})


def finished(folder: Path, request: MotionRequest) -> bool:
    """Return whether a folder holds the plan of a request.

    Raises:
        RequestError: If it holds that of another one.
    """
    if not folder.exists():
        return False
    made = json.loads((folder / "plan.json").read_text(encoding="utf-8"))["request"]
    asked = json.loads(json.dumps(request.to_dict()))
    differing = [k for k, v in asked.items() if v is not None and made.get(k) != v]
    if differing:
        raise RequestError(
            f"{folder} holds a plan with another {', '.join(differing)}; choose another --out"
        )
    return True


def write(folder: Path, files: dict[str, bytes]) -> None:
    """Write the files of a plan; there is no folder of that name before all are in it."""
    partial = folder.with_name(f".{folder.name}.partial")
    shutil.rmtree(partial, ignore_errors=True)
    partial.mkdir(parents=True)
    for name, content in files.items():
        (partial / name).write_bytes(content)
    partial.rename(folder)


def run(jobs: Sequence[Job], options: Options) -> Iterator[tuple[Job, Outcome]]:
    """Yield jobs with what became of them, in the order in which they end."""
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
    try:
        import ray
        from ray.exceptions import RayError
    except ImportError as error:
        raise InputError("Ray is not installed here: pip install ray") from error
    own: dict[str, Any] = {} if options.address else {"include_dashboard": False}
    ray.init(address=options.address, log_to_driver=False, logging_level=logging.WARNING, **own)
    try:
        cores = int(ray.cluster_resources().get("CPU", 1))
        count = min(options.workers or max(1, cores // options.threads), len(jobs))
        actor = ray.remote(num_cpus=options.threads, max_restarts=_RESTARTS)(PlanWorker)
        idle = [actor.remote(options.planner, options.threads) for _ in range(count)]
        queue, running = iter(jobs), {}
        while True:
            for worker, job in zip(list(idle), queue, strict=False):
                idle.remove(worker)
                running[worker.plan.remote(job)] = worker, job
            if not running:
                return
            (done, *_), _ = ray.wait(list(running))
            worker, job = running.pop(done)
            idle.append(worker)
            try:
                outcome = ray.get(done)
            except RayError as error:  # the worker died, or has a bug
                outcome = Outcome({"error": str(error).strip().splitlines()[-1]})
            yield job, outcome
    finally:
        ray.shutdown()


def main() -> int:
    """Make what is missing; returns 0 if every request has a plan, 1 if not, 2 for bad input."""
    options = tyro.cli(Options, config=(tyro.conf.OmitArgPrefixes,))
    try:
        for name in ("workers", "threads"):
            value = getattr(options, name)
            if value is not None and value < 1:
                raise InputError(f"--{name} must be at least 1, got {value}")
        options.planner.validate()
        jobs = read_jobs(options.requests, options.seconds, options.seed)
        missing = [job for job in jobs if not finished(options.out / job.name, job.request)]
        return _make(missing, len(jobs), options)
    except InputError as error:
        print(f"generate_with_ray: {error}", file=sys.stderr)
        return 2


def _make(missing: Sequence[Job], total: int, options: Options) -> int:
    console = Console()
    console.print(f"{total} requests, {total - len(missing)} of them finished before")
    if not missing:
        return 0
    options.out.mkdir(parents=True, exist_ok=True)
    failures = 0
    with (
        (options.out / "results.jsonl").open("a", encoding="utf-8") as results,
        Progress(console=console) as bar,
    ):
        task = bar.add_task("motions", total=len(missing))
        for job, outcome in run(missing, options):
            if outcome.failed:
                failures += 1
            else:
                write(options.out / job.name, outcome.files)
            row = {"folder": job.name, **outcome.summary}
            results.write(json.dumps(row) + "\n")
            results.flush()
            told = ", ".join(f"{k} {v}" for k, v in outcome.summary.items())
            console.print(f"{job.name}: {told}", highlight=False, markup=False, soft_wrap=True)
            bar.advance(task)
    console.print(f"{len(missing) - failures} written to {options.out}, {failures} failed")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
