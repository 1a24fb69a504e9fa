"""A log, asked in one way on cells of one size."""

from dataclasses import dataclass

from robotd.evaluation.division import Query
from robotd.evaluation.log_report import LogReport
from robotd.evaluation.map_facts import MapFacts
from robotd.evaluation.map_recipe import MapRecipe
from robotd.evaluation.protocol import Protocol
from robotd.evaluation.seeking import Seeking, SeekingSettings
from robotd.evaluation.tally import Tally
from robotd.evaluation.which_program import program
from robotd.grid.settings import GridSettings
from robotd.logs.scan import PoseSource, RecordedLog


@dataclass(frozen=True, slots=True, eq=False)
class AskedLog:
    """One line of the last table."""

    scans: int
    poses: PoseSource
    damaged_lines: int
    map_scans: int
    job: Seeking
    queries: tuple[Query, ...]

    @classmethod
    def of(
        cls,
        name: str,
        log: RecordedLog,
        protocol: Protocol,
        grid: GridSettings,
        settings: SeekingSettings,
        *,
        cases: int,
        seed: int,
    ) -> "AskedLog":
        """Draw what is asked of a log."""
        division = protocol.divide(log, cases, seed)
        recipe = MapRecipe(division.map_scans, settings.reach, grid, protocol.kind, seed)
        job = Seeking.of(name, recipe, settings, seed=seed, commit=program(), protocol=protocol.name)
        return cls(len(log.scans), log.poses, log.damaged_lines, len(division.map_scans), job, division.queries)

    def report(self, facts: MapFacts, tally: Tally) -> LogReport:
        """Return what its cases came to."""
        job = self.job
        counts = self.scans, self.map_scans, len(self.queries)
        return LogReport(job.log, job.protocol, job.digest, *counts, facts, tally, self.poses, self.damaged_lines)
